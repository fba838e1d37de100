"""HPF, the Hybrid Primitive Framework: compliant robot skills, learned from a cost.

A skill says where to go, how softly to hold it and how much to damp it. The distribution is called ``hpf-robotics``;
another one is called ``hpf``. The walk-through is docs/python.md, the equations are in docs/method.md.

Units are SI and stand in names: m, s, N, N/m, N s/m; of an axis in rad: rad, N m, N m/rad, N m s/rad.
"""

from typing import Final

from hpf import errors
from hpf._hpf import (
    Command,
    Controller,
    Motion,
    Policy,
    Run,
    Session,
    Task,
    __version__,
    learn,
    load,
    resume,
)
from hpf._imitate import imitate
from hpf.errors import (
    ControllerError,
    DemonstrationError,
    HpfError,
    LearningError,
    Mistake,
    PolicyError,
    RolloutError,
    RolloutFailed,
    RunError,
    TaskError,
    WorkError,
)
from hpf.records import Evaluation, History, Metric, Residuals, Trace

CALLABLE: Final = {"kind": "process", "command": ["(a Python callable)"]}
"""The environment of a task whose rollouts a callable makes, as in ``Task.load(path, environment=hpf.CALLABLE)``: it needs
no [cost] where costs are what the callable answers with."""

__all__ = [
    "CALLABLE",
    "Command",
    "Controller",
    "ControllerError",
    "DemonstrationError",
    "Evaluation",
    "History",
    "HpfError",
    "LearningError",
    "Metric",
    "Mistake",
    "Motion",
    "Policy",
    "PolicyError",
    "RolloutError",
    "RolloutFailed",
    "Run",
    "RunError",
    "Session",
    "Task",
    "TaskError",
    "Residuals",
    "Trace",
    "WorkError",
    "__version__",
    "errors",
    "imitate",
    "learn",
    "load",
    "resume",
]
