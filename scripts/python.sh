#!/usr/bin/env bash
# The Python package: built and installed into an environment of its own, tested, its types checked. What is built is built
# as the tests of the workspace are, in the same target directory: the crates of others are compiled once.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/skip.sh"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
venv="${HPF_VENV:-$CARGO_TARGET_DIR/python-venv}"
python="$venv/bin/python"
# Without build isolation pip looks for maturin where programs are.
export PATH="$venv/bin:$PATH"
if ! [ -x "$python" ]; then
    python3 -m venv "$venv" || skip "no Python with venv" "the Python package was not built"
fi
"$python" -m pip install --quiet "maturin>=1.9.4,<2" numpy pytest mypy pandas pandas-stubs gymnasium \
    "ray>=2.40" ||
    skip "the packages that the tests need cannot be installed" "the Python package was not built"

echo "== build and install"
"$python" -m pip install --quiet --no-build-isolation --no-deps --force-reinstall \
    --config-settings=build-args="--profile dev --locked" ./python
# The program that the tests of the workspace built, where they did.
if [ -x "$CARGO_TARGET_DIR/debug/hpf" ]; then
    export HPF_PROGRAM="$CARGO_TARGET_DIR/debug/hpf"
fi
cd python
echo "== tests"
"$python" -m pytest "$@"
echo "== types"
"$python" -m mypy
