#!/usr/bin/env bash
# Reads tasks, learns and rolls out in a WebAssembly sandbox that gives nothing but memory, and compares with the host to
# the bit. Needs cargo; installs the target.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../proofs/wasm"
target=wasm32-unknown-unknown
export CARGO_TARGET_DIR="$PWD/../target/wasm"
rustup target list --installed | grep -qx "$target" || rustup target add "$target"
cargo build --locked --release --quiet --lib --target "$target"
cargo run --locked --release --quiet -- "$CARGO_TARGET_DIR/$target/release/hpf_wasm_proof.wasm"
