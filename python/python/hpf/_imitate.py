"""Recorded motions of any form, as the tables that HPF reads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike

from hpf._hpf import Run, Task, _imitate

Recording = Union[str, "PathLike[str]", ArrayLike, Mapping[str, ArrayLike], Any]
"""A file or a run directory; an array of positions, shape (samples,) or (samples, axes); a dict or a pandas.DataFrame with
the columns of a recording: time_s, and for each axis x_m, x_force_n, x_stiffness_n_m, ... (docs/demonstrations.md)."""


def imitate(
    recordings: Recording | Sequence[Recording],
    /,
    *,
    time: ArrayLike | None = None,
    axes: Sequence[str] | None = None,
    unit: Literal["m", "rad"] = "m",
    task: Task | None = None,
    name: str | None = None,
    path: Literal["position", "reference"] = "position",
    fit: Literal["ridge", "lwr"] = "ridge",
    smooth_hz: float | Literal["off"] | None = None,
    basis: int = 20,
    duration_s: float | None = None,
    rate_hz: float | None = None,
    scaling: Literal["goal", "unit", "range"] | None = None,
    via_points: int = 4,
    stiffness_from: Literal["columns", "spread", "emg", "force", "constant"] | None = None,
    damping_from: Literal["columns", "force", "ratio", "constant"] | None = None,
    stiffness: tuple[float, float, float] = (100.0, 30.0, 400.0),
    damping: tuple[float, float, float] = (50.0, 10.0, 100.0),
    damping_ratio: float = 1.0,
    mass_kg: float = 1.0,
) -> Run:
    """Fits a policy that imitates ``recordings``, one or a list of them, and returns the run of it: nothing is learned.

    Arrays need ``time`` [s], shape (samples,), rising; ``axes`` names their columns (x, y, z where left out), in ``unit``.
    ``task`` is the task to imitate into; where left out one is made, with ``stiffness`` [N/m] and ``damping`` [N s/m]
    as initial, least and largest value, ``basis`` functions and ``via_points``. All else is as `hpf imitate --help` says.

    Source: docs/demonstrations.md. Raises DemonstrationError with the line and column of a table, TaskError.
    """
    many = isinstance(recordings, (list, tuple)) and bool(recordings) and not np.isscalar(recordings[0])
    each: Sequence[Recording] = recordings if many else [recordings]  # type: ignore[assignment]
    sources = [_table(one, i, time, axes, unit) for i, one in enumerate(each)]
    is_outlined = task is None
    options = {
        "name": name if name is not None else (_name(each[0]) if is_outlined else None),
        "path": path,
        "fit": fit,
        "smooth": smooth_hz if isinstance(smooth_hz, (int, float)) else None,
        "is_smoothed": smooth_hz != "off",
        "basis": basis,
        "duration": duration_s,
        "rate": rate_hz,
        "scaling": scaling,
        "via_points": via_points,
        "stiffness_from": stiffness_from,
        "damping_from": damping_from,
        "stiffness": stiffness,
        "damping": damping,
        "damping_ratio": damping_ratio,
        "mass": mass_kg,
    }
    return _imitate(sources, task, options)


def _name(recording: Recording) -> str | None:
    if not isinstance(recording, (str, PathLike)):
        return None
    stem = Path(recording).stem
    return "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in stem)[:100] or None


def _table(
    recording: Recording, i: int, time: ArrayLike | None, axes: Sequence[str] | None, unit: str
) -> tuple[str, str, float | None]:
    """The name and the text of a recording, and the time after which it is cut [s]."""
    if isinstance(recording, (str, PathLike)):
        file = Path(recording)
        file = file / "trajectory.csv" if file.is_dir() else file
        # A run is a demonstration: its trajectory, without the rest time after the movement.
        own = file.with_name("task.toml")
        movement = Task.load(own).duration_s if file.name == "trajectory.csv" and own.is_file() else None
        return str(file), file.read_text(encoding="utf-8"), movement
    name = f"recording {i}"
    if hasattr(recording, "columns") and hasattr(recording, "__getitem__"):
        columns = {str(column): np.asarray(recording[column], float) for column in recording.columns}
        return name, _csv(columns), None
    if isinstance(recording, Mapping):
        return name, _csv({str(key): np.asarray(value, float) for key, value in recording.items()}), None
    positions = np.asarray(recording, float)
    positions = positions[:, np.newaxis] if positions.ndim == 1 else positions
    if positions.ndim != 2:
        raise ValueError(f"an array of shape {positions.shape}, where (samples,) or (samples, axes) belongs")
    if time is None:
        raise ValueError("an array needs time=, the time of each sample [s]")
    names = list(axes) if axes is not None else _names(positions.shape[1])
    if len(names) != positions.shape[1]:
        raise ValueError(f"{len(names)} names of axes for {positions.shape[1]} columns")
    columns = {"time_s": np.asarray(time, float)}
    columns.update((f"{axis}_{unit}", positions[:, a]) for a, axis in enumerate(names))
    return name, _csv(columns), None


def _names(count: int) -> list[str]:
    return ["x", "y", "z"][:count] if count <= 3 else [f"q{a + 1}" for a in range(count)]


def _csv(columns: Mapping[str, Any]) -> str:
    """Columns as the text of a table: numbers read back to the same bits."""
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"columns of different lengths: {lengths}")
    rows = zip(*(column.tolist() for column in columns.values()))
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    return "\n".join(lines) + "\n"
