#!/usr/bin/env bash
# Counts instructions on this machine under valgrind: of an update of the controller (2 or 6 axes, 3 primitives of 20
# functions, limits, filter and tank on), of eight rollouts as a batch, and of an update of PI2 from them, in AVX2, the best
# that valgrind knows. Fails where a count is above its bound: a kernel of a batch that is no longer inlined doubles it. A
# count is the same at every run, whatever else the machine does. Installs valgrind from Debian; where it cannot be had,
# says so and exits 0 with nothing checked, in CI
# with 1 (scripts/skip.sh).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/skip.sh"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[ "$(uname -m)" = x86_64 ] || skip "the bounds are for x86-64" "no instruction was counted"
if ! command -v valgrind >/dev/null; then
    install_packages valgrind || skip "valgrind cannot be installed" "no instruction was counted"
fi

unset RUSTFLAGS CARGO_ENCODED_RUSTFLAGS
built() { # package
    cargo bench --locked --quiet --package "$1" --bench instructions --no-run --message-format json |
        sed -n 's/.*"executable":"\([^"]*instructions-[^"]*\)".*/\1/p'
}
collected() { # program and its arguments
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 | sed -n 's/.*Collected *: *//p'
}

sound=true
# Bounds: what was counted with Rust 1.95, and 5 %.
check() { # name, instructions, bound
    echo "$1: $2 ($3)"
    if [ "$2" -le 0 ] || [ "$2" -gt "$3" ]; then sound=false; fi
}

echo "scalar family axes: instructions per update, mean over a movement (bound)"
controller=$(built hpf-core)
while read -r scalar family axes bound; do
    # The second movement alone: start and end of the program cancel.
    one=$(collected "$controller" "$scalar" "$family" "$axes" 1)
    two=$(collected "$controller" "$scalar" "$family" "$axes" 2)
    check "$scalar $family $axes" $(((two - one) / 2000)) "$bound"
done <<'BOUNDS'
f32 phase 2 2540
f32 time 2 1540
f32 phase 6 5240
f32 time 6 3760
f64 phase 2 3020
f64 time 2 1760
f64 phase 6 6060
f64 time 6 4790
BOUNDS

if grep -q avx2 /proc/cpuinfo; then
    echo "task part: instructions per step, eight rollouts together (bound)"
    learner=$(built hpf-sim)
    while read -r task part steps bound; do
        # Starting a thread costs more or less: over forty times that is nothing.
        few=$(collected "$learner" "$task" "$part" 2)
        more=$(collected "$learner" "$task" "$part" 42)
        check "$task $part" $(((more - few) / 40 / steps)) "$bound"
    done <<'BOUNDS'
cantilever rollouts 500 1840
cantilever update 500 740
via_point rollouts 500 3040
via_point update 500 1250
BOUNDS
fi
$sound || { echo "FAILED: a count is above its bound"; exit 1; }
