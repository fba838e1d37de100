#!/usr/bin/env bash
# Compiles and runs the C and C++ examples against the static and the shared library, warnings denied, every program in C
# of the documentation, and the skeleton of a ros2_control controller; compiles the header as C89 and as C++98; tries the
# CMake recipe; proves by linking that no function of the interface reaches a panic.
# Ends with 0 only if all of it holds.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/skip.sh"
cd "$(dirname "${BASH_SOURCE[0]}")"
unset RUSTFLAGS CARGO_ENCODED_RUSTFLAGS CARGO_BUILD_TARGET
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$(cd ../.. && pwd)/target}/hpf-c"
warnings=(-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror)

surprise() {
    echo "FAILED  $1"
    exit 1
}

denied=(-Wall -Wextra -Wpedantic -Werror)
cc -std=c89 "${denied[@]}" -Iinclude check/header.c -o "$work/c89"
c++ -std=c++98 "${denied[@]}" -Iinclude -x c++ check/header.c -o "$work/cpp98"
"$work/c89" && "$work/cpp98" || surprise "the header prepares what it should not"
echo "passed  the header as C89 and as C++98"

cargo build --quiet --release --package hpf-c
built="$CARGO_TARGET_DIR/release"
cc -std=c99 "${warnings[@]}" -Iinclude -c examples/reach.c -o "$work/c.o"
c++ -std=c++17 "${warnings[@]}" -Iinclude -c examples/reach.cpp -o "$work/cpp.o"
cc "$work/c.o" "$built/libhpf_c.a" -lpthread -ldl -lm -o "$work/c_static"
c++ "$work/cpp.o" "$built/libhpf_c.a" -lpthread -ldl -lm -o "$work/cpp_static"
cc "$work/c.o" -L"$built" -Wl,-rpath,"$built" -lhpf_c -lm -o "$work/c_shared"
c++ "$work/cpp.o" -L"$built" -Wl,-rpath,"$built" -lhpf_c -lm -o "$work/cpp_shared"
"$work/c_static"
"$work/cpp_static"
"$work/c_shared" >/dev/null
"$work/cpp_shared" >/dev/null
echo "passed  C and C++ examples, static and shared"

# Each block of C in the documentation is a whole program; check/robot.c is the robot that must get to its goal.
programs=0
for page in README.md ../../README.md ../../docs/*.md; do
    awk -v stem="$work/page_$((++programs))" \
        '/^```c$/ { name = stem "_" ++count ".c"; next } /^```$/ { name = "" } name { print > name }' "$page"
done
programs=0
for program in "$work"/page_*.c; do
    cc -std=c89 "${denied[@]}" -Iinclude -Iexamples "$program" check/robot.c "$built/libhpf_c.a" -lpthread -ldl -lm \
        -o "$work/program"
    "$work/program" || surprise "a program of the documentation does not get the tool to its goal"
    programs=$((programs + 1))
done
[ "$programs" -ge 2 ] || surprise "the documentation lacks its programs in C"
echo "passed  $programs programs of the documentation, as C89: the robot moves to its goal"

cc -std=c89 "${denied[@]}" -Iinclude check/domain.c "$built/libhpf_c.a" -lpthread -ldl -lm -o "$work/domain"
"$work/domain" || surprise "a command leaves its limits, or a skill that no step could bear is taken"
echo "passed  damping down to subnormal numbers"

skeleton=examples/ros2_control
c++ -std=c++17 "${warnings[@]}" -Iinclude -I$skeleton/stub $skeleton/hpf_controller.cpp $skeleton/check.cpp \
    "$built/libhpf_c.a" -lpthread -ldl -lm -o "$work/ros2_control"
"$work/ros2_control"
echo "passed  ros2_control skeleton, against stand-ins for the headers of ROS 2"

# The interface without the standard library, every function named, dead code dropped. The panic handler calls a function
# that exists nowhere: a program from which it can be reached does not link.
bare() { # features, further arguments
    CARGO_PROFILE_RELEASE_PANIC=abort CARGO_PROFILE_RELEASE_LTO=fat CARGO_PROFILE_RELEASE_CODEGEN_UNITS=1 \
        cargo rustc --quiet --release --package hpf-c --crate-type staticlib --target-dir "$CARGO_TARGET_DIR/bare" \
        --features "$1" "${@:2}"
}
link() { # program, source
    cc -std=c99 -O1 -Iinclude "$2" "$CARGO_TARGET_DIR/bare/release/libhpf_c.a" -nodefaultlibs -Wl,--gc-sections -lc -lm \
        -o "$work/$1" 2>"$work/link.log"
}
{
    echo '#include "hpf.h"'
    echo 'typedef void (*entry)(void); volatile entry used; int main(void) {'
    grep -oE '\bhpf_[a-z0-9_]+\(' include/hpf.h | sort -u | sed 's/\(.*\)(/  used = (entry)\1;/'
    echo '  return 0; }'
} >"$work/all.c"
[ "$(grep -c 'used = ' "$work/all.c")" -ge 31 ] || surprise "the header lacks functions"
bare negative-panic
if link control "$work/all.c"; then surprise "an index out of bounds links: the proof proves nothing"; fi
grep -q hpf_panic_is_reachable "$work/link.log" || surprise "the control fails to link for another reason"
bare prove
link all "$work/all.c" || { cat "$work/link.log"; surprise "a panic is reachable, or more than C's library is needed"; }
echo "proved  no function of the interface reaches a panic; the control, an index out of bounds, does not link"

size_of() { size "$1" | awk 'NR == 2 { print $1 }'; }
link one examples/reach.c
"$work/one" >/dev/null
echo "size    text of the C example with one instance: $(size_of "$work/one") bytes; of all 14: $(size_of "$work/all")"

if command -v cmake >/dev/null; then
    { cmake -S . -B "$work/cmake" && cmake --build "$work/cmake" && ctest --test-dir "$work/cmake"; } \
        >"$work/cmake.log" 2>&1 || { cat "$work/cmake.log"; surprise "the CMake recipe"; }
    echo "passed  CMake recipe"
else
    (skip "there is no cmake here" "the recipe was not tried")
fi

if [ -d "$(rustc --print sysroot)/lib/rustlib/thumbv7em-none-eabihf" ]; then
    bare bare --target thumbv7em-none-eabihf
    echo "passed  builds for thumbv7em-none-eabihf"
else
    (skip "the target thumbv7em-none-eabihf is not installed" "the build for it was not tried")
fi
