#!/usr/bin/env bash
# Runs a skill on emulated microcontrollers (QEMU: Cortex-M4F and M7) and compares its bits with the host's.
# Installs what it needs: the Rust target by rustup, qemu-system-arm from Debian. Exits non-zero if a check fails; where
# the tools cannot be installed it says so and exits 0 with nothing checked, in CI
# with 1 (scripts/skip.sh).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/skip.sh"
cd "$(dirname "${BASH_SOURCE[0]}")/../firmware"

target=thumbv7em-none-eabihf
install_target "$target" || skip "the Rust target $target cannot be installed" "nothing was run on an emulated microcontroller"
if ! command -v qemu-system-arm >/dev/null; then
    install_packages qemu-system-arm ||
        skip "qemu-system-arm cannot be installed" "nothing was run on an emulated microcontroller"
fi

host=$(rustc -vV | sed -n 's/^host: //p')
echo "== golden bits on the host"
cargo test --locked --release --lib --target "$host" --quiet

run() { # name, machine, further compiler flags
    echo "== $1"
    RUSTFLAGS="-C link-arg=-Tlink.x $3" cargo build --locked --release --quiet
    timeout 120 qemu-system-arm -machine "$2" -nographic -monitor none -serial none \
        -semihosting-config enable=on,target=native -icount shift=6 \
        -kernel "${CARGO_TARGET_DIR:-target}/$target/release/hpf-firmware"
}
run "Cortex-M4F" mps2-an386 "-C target-cpu=cortex-m4"
run "Cortex-M7" mps2-an500 "-C target-cpu=cortex-m7"
