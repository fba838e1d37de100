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
