# For scripts that try to get the tools they need. `skip REASON CONSEQUENCE` says that a check cannot be made here, and
# ends with 0; where CI is set, as .ci/run and .ci/long set it, a check that cannot be made has failed: it ends with 1.
# `CI= .ci/run` asks for the former.
skip() {
    echo "SKIPPED: $1; $2"
    if [ -n "${CI:-}" ]; then
        echo "FAILED: in CI every check is made"
        exit 1
    fi
    exit 0
}

# One at a time: scripts run side by side, and neither Debian's packages nor Rust's targets are installed by two at once.
exclusive() { flock "${TMPDIR:-/tmp}/hpf-installs.lock" "$@"; }

# Installs packages of Debian.
install_packages() {
    exclusive sh -c 'apt-get update && apt-get install -y --no-install-recommends "$@"' sh "$@"
}

# Installs a target of Rust, where it is not installed.
install_target() {
    rustup target list --installed 2>/dev/null | grep -qx "$1" || exclusive rustup target add "$1"
}
