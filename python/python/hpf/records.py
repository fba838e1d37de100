"""Results as plain data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Metric:
    """One measure of a motion."""

    name: str
    value: float
    unit: str
    """Its unit; empty for a number without one."""
    target: float | None
    """The largest value that passes, where the task names one in [accept]."""
    passed: bool | None
    """Whether it passes; None without a target."""


@dataclass(frozen=True)
class Evaluation:
    """A policy on the way, evaluated."""

    update: int
    """Updates made."""
    rollouts: int
    """Motions made, evaluations included."""
    total: float
    """Total cost."""
    terms: dict[str, float]
    """Cost by term."""
    exploration: float
    """Scale of the exploration, 1 at the start."""


@dataclass(frozen=True, eq=False)
class History:
    """The evaluations of a run, the start first: arrays of shape (evaluations,), the columns of learning.csv."""

    update: NDArray[np.int64]
    """Updates made."""
    rollouts: NDArray[np.int64]
    """Motions made, evaluations included."""
    total: NDArray[np.float64]
    """Total cost."""
    terms: dict[str, NDArray[np.float64]]
    """Cost by term."""
    exploration: NDArray[np.float64]
    """Scale of the exploration, 1 at the start."""

    def __len__(self) -> int:
        return len(self.total)

    def __repr__(self) -> str:
        if not len(self):
            return "<hpf.History: no evaluation yet>"
        first, last = float(self.total[0]), float(self.total.min())
        return f"<hpf.History: {len(self)} evaluations, {self.rollouts[-1]} motions, cost {first:.4g} to {last:.4g}>"


@dataclass(frozen=True, eq=False)
class Trace:
    """What a rollout of the caller's own measured: each of shape (N + 1, axes), or (N + 1,) of one axis.

    At the start and after every step of the task. A number that is not finite makes it a motion that failed.
    """

    position: ArrayLike
    """Position of the tool [axis unit]."""
    velocity: ArrayLike
    """Its velocity [axis unit/s]."""
    force: ArrayLike
    """Force of the environment on the tool [N or N m]."""


@dataclass(frozen=True, eq=False)
class Residuals:
    """What a rollout of the caller's own left of a least-squares problem: half the sum of the squares is the cost.

    As many in every rollout. A number that is not finite makes it a motion that failed.
    """

    residuals: ArrayLike
    """The residuals, of shape (residuals,): each in units of its own tolerance."""


def metrics(rows: Iterable[tuple[str, float, str, float | None, bool | None]]) -> dict[str, Metric]:
    """Measures by name."""
    return {row[0]: Metric(*row) for row in rows}


def evaluation(
    update: int, rollouts: int, total: float, terms: Iterable[tuple[str, float]], exploration: float
) -> Evaluation:
    """An evaluation, its terms by name."""
    return Evaluation(update, rollouts, total, dict(terms), exploration)
