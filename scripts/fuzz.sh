#!/usr/bin/env bash
# Fuzzes everything that reads files, the controller and its C interface: scripts/fuzz.sh [seconds per target, 60 if not given] [targets, all if not given]
# First the seeds (fuzz/seeds) and what earlier runs found worth keeping (fuzz/corpus) are replayed, then each target
# runs for its time, as many at once as there are cores. Exits non-zero with the input that broke a target; where
# cargo-fuzz cannot be installed it says so and exits 0 with nothing fuzzed, in CI
# with 1 (scripts/skip.sh).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/skip.sh"
cd "$(dirname "${BASH_SOURCE[0]}")/../fuzz"

seconds=${1:-60}
targets=("${@:2}")
[ ${#targets[@]} -gt 0 ] || targets=(task overrides policy packed tables demonstrations mcap controller border)

if ! cargo fuzz --version >/dev/null 2>&1; then
    cargo install --locked cargo-fuzz || skip "cargo-fuzz cannot be installed" "nothing was fuzzed"
fi
# Coverage and the address sanitizer are flags of the nightly compiler; the stable one takes them so.
export RUSTC_BOOTSTRAP=1
host=$(rustc -vV | sed -n 's/^host: //p')
cargo fuzz build --fuzz-dir .
binaries=${CARGO_TARGET_DIR:-target}/$host/release

fuzz() {
    local target=$1 log=artifacts/$1.log status=0
    mkdir -p "artifacts/$target" "corpus/$target"
    # Ten seconds or two gigabytes for one input are findings as well.
    "$binaries/$target" "corpus/$target" "seeds/$target" -artifact_prefix="artifacts/$target/" -max_len=65536 \
        -timeout=10 -rss_limit_mb=2048 -max_total_time="$seconds" -print_final_stats=1 >"$log" 2>&1 || status=$?
    if [ "$status" -ne 0 ]; then
        tail -n 40 "$log"
        echo "FAILED: $target; replay with: fuzz/$binaries/$target fuzz/artifacts/$target/<input>"
        return 1
    fi
    echo "$target: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs, no finding"
}
export -f fuzz
export binaries seconds
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I{} bash -c 'fuzz {}'
