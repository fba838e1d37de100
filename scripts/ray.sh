#!/usr/bin/env bash
# Rollouts on a cluster of Ray: two nodes on the loopback, one of them killed. In the environment that scripts/python.sh made.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/skip.sh"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

python="${HPF_VENV:-${CARGO_TARGET_DIR:-$PWD/target}/python-venv}/bin/python"
[ -x "$python" ] || skip "no environment of scripts/python.sh" "hpf.ray was not tested"
"$python" -m pip install --quiet "ray>=2.40" || skip "Ray cannot be installed" "hpf.ray was not tested"
"$python" -m pytest python/tests/test_ray.py
"$python" python/tests/ray_two_nodes.py
