#!/usr/bin/env bash
# Runs the tests of hpf-core and the golden bits of firmware/ as a 64-bit ARM Linux program under qemu-user; arguments are
# those of the tests, such as `--skip energy::`.
# Installs what it needs: the Rust target by rustup, a linker, its C library and qemu-user from Debian. Exits non-zero if
# a test fails; where the tools cannot be installed it says so and exits 0 with nothing checked, in CI
# with 1 (scripts/skip.sh).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/skip.sh"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

target=aarch64-unknown-linux-gnu
library=/usr/aarch64-linux-gnu
install_target "$target" || skip "the Rust target $target cannot be installed" "no test was run on an emulated ARM Linux"
if ! { command -v qemu-aarch64 && command -v aarch64-linux-gnu-gcc && [ -e "$library/lib/libc.so.6" ]; } >/dev/null; then
    install_packages gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user ||
        skip "gcc-aarch64-linux-gnu, libc6-dev-arm64-cross or qemu-user cannot be installed" "no test was run on an emulated ARM Linux"
fi

unset RUSTFLAGS CARGO_ENCODED_RUSTFLAGS
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
# Of two C libraries in one program the first thread never returns: a time limit, instead of a check that hangs.
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="timeout 1800 qemu-aarch64 -L $library"
# Emulation is slow: fewer updates of the long tests than on the host.
export HPF_CAMPAIGN_UPDATES=${HPF_CAMPAIGN_UPDATES:-200000} HPF_HOUR_SECONDS=${HPF_HOUR_SECONDS:-20}
echo "== tests of hpf-core, $target"
cargo test --locked --quiet --package hpf-core --tests --target "$target" -- "$@"
echo "== golden bits, $target"
cd firmware
cargo test --locked --quiet --lib --target "$target"
