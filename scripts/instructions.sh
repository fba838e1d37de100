#!/usr/bin/env bash
# Counts the instructions of an update of the controller on this machine under valgrind: 2 or 6 axes, 3 primitives of 20
# functions, limits, filter and tank on. Fails where a count is above its bound. A count is the same at every run, whatever
# else the machine does. Installs valgrind from Debian; where it cannot be had, says so and exits 0 with nothing checked.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

skip() {
    echo "SKIPPED: $1; no instruction was counted"
    exit 0
}
[ "$(uname -m)" = x86_64 ] || skip "the bounds are for x86-64"
if ! command -v valgrind >/dev/null; then
    { apt-get update && apt-get install -y --no-install-recommends valgrind; } || skip "valgrind cannot be installed"
fi

unset RUSTFLAGS CARGO_ENCODED_RUSTFLAGS
program=$(cargo bench --locked --quiet --package hpf-core --bench instructions --no-run --message-format json |
    sed -n 's/.*"executable":"\([^"]*instructions-[^"]*\)".*/\1/p')

collected() { # scalar, family, axes, movements
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" "$@" 2>&1 | sed -n 's/.*Collected *: *//p'
}

sound=true
echo "scalar family axes: instructions per update, mean over a movement (bound)"
while read -r scalar family axes bound; do
    # Bounds: what was counted with Rust 1.95, and 5 %. The second movement alone: start and end of the program cancel.
    one=$(collected "$scalar" "$family" "$axes" 1)
    two=$(collected "$scalar" "$family" "$axes" 2)
    each=$(((two - one) / 2000))
    echo "$scalar $family $axes: $each ($bound)"
    if [ "$each" -le 0 ] || [ "$each" -gt "$bound" ]; then sound=false; fi
done <<'BOUNDS'
f32 phase 2 2540
f32 time 2 1440
f32 phase 6 5240
f32 time 6 3760
f64 phase 2 3020
f64 time 2 1660
f64 phase 6 6060
f64 time 6 4790
BOUNDS
$sound || { echo "FAILED: a count is above its bound"; exit 1; }
