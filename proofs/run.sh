#!/usr/bin/env bash
# Proves by linking that a step of hpf-core and an update of its controller cannot panic and do not allocate, then that
# the proof can fail.
# Needs cargo and gcc. One line per proof; exits non-zero on any surprise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

export CARGO_TARGET_DIR="$PWD/target"
unset RUSTFLAGS CARGO_ENCODED_RUSTFLAGS CARGO_BUILD_TARGET
log=target/proof.log
mkdir -p target

build() { cargo build --locked --release --quiet "$@" >"$log" 2>&1; }

# No runtime library but C's own: what Rust code needs, it must bring along.
link() {
    gcc -std=c11 -O1 -Wall -Werror main.c target/release/libhpf_proofs.a -o target/proof \
        -nodefaultlibs -Wl,--gc-sections -lc >"$log" 2>&1
}

surprise() {
    echo "FAILED  $1"
    cat "$log"
    exit 1
}

build || surprise "the step does not build without an allocator"
echo "proved  building, stepping and unpacking a skill and a controller, and a step of orientation, needs no allocator: there is none"

link || surprise "a panic is reachable from the step, or it needs more than C's library"
echo "proved  building, stepping and unpacking a skill and a controller, and a step of orientation, reaches no panic: the program links"

target/proof || { : >"$log"; surprise "the linked program computes something else"; }
echo "proved  the linked program runs and settles where it should, in f32 and f64"

for control in negative-panic negative-panic-update negative-panic-unpack negative-panic-pose; do
    build --features $control || surprise "the control $control does not build"
    if link; then surprise "an index out of bounds links: the proof proves nothing"; fi
    grep -q hpf_panic_is_reachable "$log" || surprise "an index out of bounds fails to link for another reason"
done
echo "control an index that can be out of bounds does not link, in step, update, unpack nor pose"

if build --features negative-alloc; then surprise "code that allocates builds: the proof proves nothing"; fi
grep -q "no global memory allocator" "$log" || surprise "code that allocates fails to build for another reason"
echo "control code that allocates does not build"
