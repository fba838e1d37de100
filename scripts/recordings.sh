#!/usr/bin/env bash
# The table of sources in docs/demonstrations.md: one motion in many formats, made by independent writers (rosbags, numpy,
# pandas), imitated by hpf, the RMSE calculated by numpy. Prints the table; fails where a source is not read, or read wrong.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/skip.sh"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

target="${CARGO_TARGET_DIR:-$PWD/target}"
venv="${HPF_RECORDINGS_VENV:-$target/recordings-venv}"
if ! [ -x "$venv/bin/python" ]; then
    python3 -m venv "$venv" || skip "no Python with venv" "no source was tried"
fi
"$venv/bin/python" -c 'import numpy, pandas, rosbags' 2>/dev/null ||
    "$venv/bin/pip" install --quiet numpy pandas "rosbags>=0.10" ||
    skip "the packages that write the sources cannot be installed" "no source was tried"
# The program that the tests built, where they did.
program="${HPF_PROGRAM:-$target/debug/hpf}"
[ -x "$program" ] || cargo build --quiet --bin hpf
"$venv/bin/python" scripts/recordings.py "$program"
