#!/usr/bin/env bash
# Builds the core of pages and what they hold of it, into the folder that is named.
set -euo pipefail
place="$1"
cd "$(dirname "${BASH_SOURCE[0]}")"
. ../scripts/skip.sh
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
install_target wasm32-unknown-unknown
# Every browser of the last three years has these instructions; the numbers are the same without. No path of this machine
# goes into a page.
cargo_home="${CARGO_HOME:-$HOME/.cargo}"
export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="-C target-feature=+simd128 \
    --remap-path-prefix=$cargo_home=cargo --remap-path-prefix=$(cd .. && pwd)=hpf"
cargo build --locked --quiet --release --target wasm32-unknown-unknown -p hpf-web
cargo run --locked --quiet -p hpf-web-bundle -- \
    "$CARGO_TARGET_DIR/wasm32-unknown-unknown/release/hpf_web.wasm" "$place"
