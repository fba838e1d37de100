#!/usr/bin/env bash
# A wheel of the Python package for this platform, for every Python from 3.10 on: target/wheels/hpf_robotics-*.whl.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../python"

export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/../target}"
venv="${HPF_VENV:-$CARGO_TARGET_DIR/python-venv}"
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/python" -m pip install --quiet "maturin>=1.9.4,<2"
"$venv/bin/maturin" build --release --locked --out "$CARGO_TARGET_DIR/wheels"
