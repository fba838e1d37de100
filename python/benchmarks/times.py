"""What crossing between Python and Rust costs: prints a line per measure, and fails where one is above its bound.

    python python/benchmarks/times.py [--program PATH] [--no-bounds]

--program is the program that Rust built, of the same profile, for the comparison of learning times.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import hpf
import numpy as np

TASKS = Path(__file__).parents[2] / "tasks"
UPDATE_US = 2.0
ROLLOUT_US = 50.0
LEARNING_SHARE = 1.05


def update_us() -> float:
    """Processor time of a Controller.update of two axes, arrays in [us]: the least of 20 stretches."""
    policy = hpf.learn(hpf.Task.load(TASKS / "via_point.toml", learning={"method": "auto", "max_rollouts": 30})).policy
    controller = hpf.Controller(policy, limits={"force": 50.0, "velocity": 1.0}, tank={"capacity": 5.0})
    controller.start()
    force, position = np.array([1.0, -1.0]), np.array([0.0, 0.0])
    update = controller.update
    count = 5_000
    times = []
    for _ in range(20):
        begun = time.process_time()
        for _ in range(count):
            update(force, 1e-3, measured_position=position)
        times.append((time.process_time() - begun) / count * 1e6)
    return min(times)


def rollout_us(kind: str) -> float:
    """Processor time of a rollout of 150 steps by a callable that does nothing [us]: the call, reading its answer, and the
    share of learning by PI2. The least of 5 runs."""
    text = (TASKS / "reach.toml").read_text()
    learning = {"method": "pi2", "updates": 50, "rollouts": 20}
    changes: dict[str, Any] = {"disturbance": None, "accept": None, "rate": 150.0, "learning": learning}
    task = hpf.Task.parse(text, environment=hpf.CALLABLE, **changes)
    costs, signal = np.full(150, 0.1), np.zeros((151, 1))
    measured = hpf.Trace(signal, signal, signal)
    answer = {"total": 1.0, "costs": costs, "trace": measured}[kind]

    def constant(policy: hpf.Policy) -> object:
        return answer

    shares: list[float] = []
    for _ in range(5):
        begun = time.process_time()
        run = hpf.learn(task, rollout=constant)  # type: ignore[arg-type]
        spent = time.process_time() - begun
        shares.append(spent / int(run.history.rollouts[-1]) * 1e6)
    return min(shares)


def learning_s(program: str | None) -> tuple[float, float]:
    """Wall time of the learning alone, here and by the program [s]: medians of 7."""
    task = hpf.Task.load(TASKS / "cantilever.toml")
    here, there = [], []
    with tempfile.TemporaryDirectory() as folder:
        for i in range(7):
            here.append(float(hpf.learn(task).summary["learning_s"]))
            out = Path(folder) / str(i)
            command = [program] if program else [sys.executable, "-m", "hpf"]
            command += ["learn", str(TASKS / "cantilever.toml"), "--out", str(out), "--quiet"]
            subprocess.run(command, check=False, stdout=subprocess.DEVNULL)
            there.append(float(json.loads((out / "summary.json").read_text())["learning_s"]))
    return statistics.median(here), statistics.median(there)


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--program")
    arguments.add_argument("--no-bounds", action="store_true")
    options = arguments.parse_args()
    update = update_us()
    print(f"Controller.update, 2 axes: {update:.2f} us (bound {UPDATE_US} us)")
    missed = update > UPDATE_US
    for kind in ("total", "costs", "trace"):
        rollout = rollout_us(kind)
        print(f"a rollout of 150 steps by a callable, {kind}, learning included: {rollout:.1f} us (bound {ROLLOUT_US} us)")
        missed |= rollout > ROLLOUT_US
    here, there = learning_s(options.program)
    share = f"{here / there:.2f} (bound {LEARNING_SHARE})"
    print(f"learning the cantilever: {here:.4f} s here, {there:.4f} s by the program, {share}")
    missed |= here / there > LEARNING_SHARE
    return int(missed and not options.no_bounds)


if __name__ == "__main__":
    sys.exit(main())
