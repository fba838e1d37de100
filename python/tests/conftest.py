"""What the tests share."""

from __future__ import annotations

from pathlib import Path

import hpf
import pytest

ROOT = Path(__file__).parents[2]
TASKS = ROOT / "tasks"


@pytest.fixture
def reach() -> hpf.Task:
    """The smallest task, few updates."""
    return hpf.Task.load(TASKS / "reach.toml", learning={"method": "pi2", "updates": 15, "rollouts": 8})


@pytest.fixture
def free() -> hpf.Task:
    """A task for rollouts of one's own: two axes, nothing simulated, cost and targets left out."""
    return hpf.Task.parse(FREE)


FREE = """
name = "free"
duration = 1.0
rate = 50.0

[[axis]]
name = "x"
start = 0.0
goal = 0.3

[[axis]]
name = "q"
unit = "rad"
start = 0.1
goal = 0.4

[stiffness]
initial = 100.0
min = 30.0
max = 400.0

[damping]
initial = 50.0
min = 10.0
max = 100.0

[cost]
goal = 1e4
stiffness = 1e-5

[learning]
updates = 6
rollouts = 6
seed = 3
"""
