from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypeAlias, Union

import numpy as np
import pandas
from numpy.typing import ArrayLike, NDArray

from hpf.errors import RolloutFailed
from hpf.records import Evaluation, History, Metric, Residuals, Trace

__version__: str

_Path: TypeAlias = Union[str, PathLike[str]]
_Array: TypeAlias = NDArray[np.float64]
_PerAxis: TypeAlias = Union[float, Sequence[float], NDArray[np.floating[Any]]]
_Kind: TypeAlias = Literal["costs", "trace", "residuals"]
_Answer: TypeAlias = Union[
    float, ArrayLike, tuple[ArrayLike, float], Trace, Residuals, Mapping[str, ArrayLike], RolloutFailed
]
_Rollout: TypeAlias = Union[Callable[[Policy], _Answer], Callable[[list[Policy]], Iterable[_Answer]]]
_Progress: TypeAlias = Union[bool, Callable[[Evaluation], object], None]

class Task:
    """What to learn, in which environment, at what price: a task file, read and checked.

    It never changes; ``replace(**changes)`` makes another one. Keys and units: docs/task-file.md.
    """

    @staticmethod
    def load(path: _Path, /, **changes: Any) -> Task:
        """Reads and checks a task file, with changes: ``learning={"method": "auto"}``, ``axis={0: {"goal": 0.4}}``.

        None leaves a key out. Raises TaskError with every mistake, its line and column.
        """

    @staticmethod
    def parse(text: str, /, folder: _Path = "", **changes: Any) -> Task:
        """The same of the text of a task file; the files it names lie in ``folder``."""

    def replace(self, **changes: Any) -> Task:
        """The same task with other keys."""

    def to_dict(self) -> dict[str, Any]:
        """All keys with their values, as the task file has them."""

    @property
    def text(self) -> str:
        """The text of the task as it will run, TOML."""

    @property
    def file(self) -> str | None:
        """The file it was read from."""

    @property
    def name(self) -> str: ...
    @property
    def duration_s(self) -> float:
        """Duration of the movement [s]."""

    @property
    def rate_hz(self) -> float:
        """Control and logging rate [Hz]."""

    @property
    def steps(self) -> int:
        """Steps of the movement, N; a signal of it has N + 1 samples."""

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes, in their order."""

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the axes: "m" or "rad"."""

    @property
    def start(self) -> _Array:
        """Where the movement of each axis starts [axis unit], shape (axes,)."""

    @property
    def goal(self) -> _Array:
        """Where the movement of each axis ends [axis unit], shape (axes,)."""

    @property
    def method(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def contact(self) -> Literal["wall", "cantilever"] | None: ...
    @property
    def environment(self) -> Literal["simulation", "process", "callable"]: ...
    @staticmethod
    def _restore(text: str, tables: list[tuple[str, str]], file: str | None) -> Task: ...

class Policy:
    """A learned skill: where to go, how softly to hold it, how much to damp it. It never changes."""

    @staticmethod
    def load(path: _Path) -> Policy:
        """Reads a policy file, or that of a run directory. Raises PolicyError."""

    @staticmethod
    def parse(text: str) -> Policy:
        """Reads the text of a policy file. Raises PolicyError with line and column."""

    @staticmethod
    def initial(task: Task) -> Policy:
        """The policy before learning: the bare pull to the goal."""

    def save(self, path: _Path, *, force: bool = False) -> None: ...
    def to_json(self) -> str:
        """The text of its file: numbers read back to the same bits."""

    def export(self, form: Literal["rust", "c", "binary"], *, scalar: Literal["f32", "f64"] = "f64") -> str | bytes:
        """A form for firmware, as ``hpf export`` writes it."""

    def rollout(self, task: Task, rate: float | None = None, **changes: Any) -> Motion:
        """The motion in the environment of ``task``, simulated with steps of 1/rate [Hz]."""

    def planned(self, task: Task | None = None) -> Motion:
        """The motion as planned, without forces. ``task`` may be left out for a policy that learning asks for."""

    def with_weights(self, weights: _Array) -> Policy:
        """The same policy with other weights, shape (n,)."""

    @property
    def weights(self) -> _Array:
        """All weights, shape (n,): axis by axis movement, stiffness [N/m], damping [N s/m]."""

    @property
    def draw(self) -> int | None:
        """The number of the random circumstances it is asked for under; None for an evaluation."""

    @property
    def task(self) -> str: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def axes(self) -> tuple[str, ...]: ...
    @property
    def units(self) -> tuple[str, ...]: ...
    @property
    def start(self) -> _Array: ...
    @property
    def goal(self) -> _Array: ...
    @property
    def cost(self) -> float: ...
    @property
    def updates(self) -> int: ...
    @property
    def seed(self) -> int: ...
    @property
    def sha256(self) -> str: ...

class Motion:
    """The signals of a motion: N + 1 samples of the movement, and those of the rest time after it.

    ``motion["x_position_m"]`` is a column of trajectory.csv, shape (samples,).
    """

    def __getitem__(self, name: str) -> _Array: ...
    def __len__(self) -> int: ...
    @property
    def columns(self) -> tuple[str, ...]: ...
    @property
    def time_s(self) -> _Array:
        """Time [s], shape (samples,)."""

    @property
    def dt_s(self) -> float: ...
    @property
    def steps(self) -> int: ...
    @property
    def position(self) -> _Array:
        """Position of the tool [axis unit], shape (samples, axes)."""

    @property
    def velocity(self) -> _Array:
        """Velocity of the tool [axis unit/s], shape (samples, axes)."""

    @property
    def reference_position(self) -> _Array:
        """Position of the reference [axis unit], shape (samples, axes)."""

    @property
    def reference_velocity(self) -> _Array:
        """Velocity of the reference [axis unit/s], shape (samples, axes)."""

    @property
    def force(self) -> _Array:
        """Force that the admittance sees [N or N m], shape (samples, axes)."""

    @property
    def stiffness(self) -> _Array:
        """Stiffness [N/m or N m/rad], shape (samples, axes)."""

    @property
    def damping(self) -> _Array:
        """Damping [N s/m or N m s/rad], shape (samples, axes)."""

    @property
    def cost(self) -> float: ...
    @property
    def metrics(self) -> dict[str, Metric]: ...
    @property
    def task(self) -> Task: ...
    def to_pandas(self) -> pandas.DataFrame:
        """A row per sample, the columns of trajectory.csv."""

    def to_csv(self, path: _Path, *, force: bool = False) -> None: ...
    def to_mcap(self, path: _Path, *, force: bool = False) -> None:
        """Writes a log that Foxglove, Rerun and PlotJuggler open."""

    @property
    def figures(self) -> list[str]: ...
    def figure(self, name: str, format: Literal["png", "svg"] = "png") -> bytes: ...
    def _repr_png_(self) -> bytes: ...
    def _repr_svg_(self) -> str: ...

class Run:
    """What learning led to: policy, cost, measures, history and the motion of the policy."""

    @property
    def task(self) -> Task: ...
    @property
    def policy(self) -> Policy: ...
    @property
    def cost(self) -> float: ...
    @property
    def cost_terms(self) -> dict[str, float]: ...
    @property
    def metrics(self) -> dict[str, Metric]: ...
    @property
    def history(self) -> History: ...
    @property
    def motion(self) -> Motion: ...
    @property
    def missed(self) -> bool:
        """Whether a target of [accept] was missed."""

    @property
    def notes(self) -> list[str]: ...
    @property
    def directory(self) -> Path | None: ...
    @property
    def summary(self) -> dict[str, Any]:
        """What summary.json says (docs/files.md)."""

    def save(self, path: _Path, *, force: bool = False) -> None:
        """Writes a run directory: the same bytes as the program's, but for wall times."""

    @property
    def figures(self) -> list[str]: ...
    def figure(self, name: str, format: Literal["png", "svg"] = "png") -> bytes: ...
    def _repr_png_(self) -> bytes: ...
    def _repr_svg_(self) -> str: ...

class Session:
    """Learning by asking and telling: ``ask()`` for policies, make a motion with each, ``tell()`` what came of them."""

    def __init__(
        self,
        task: Task,
        *,
        answers: _Kind = "costs",
        residuals: int | None = None,
        start: Policy | None = None,
        seed: int | None = None,
    ) -> None: ...
    def ask(self) -> list[Policy]:
        """The policies to make a motion with; none where learning is over. The same until they are answered."""

    def tell(self, answers: Iterable[_Answer]) -> Evaluation | None:
        """Tells what came of them, an answer each. Returns the evaluation where one was complete."""

    @property
    def done(self) -> bool: ...
    @property
    def stopped_because(self) -> str | None: ...
    @property
    def policy(self) -> Policy: ...
    @property
    def cost(self) -> float: ...
    @property
    def rollouts(self) -> int: ...
    @property
    def updates(self) -> int: ...
    @property
    def rejected(self) -> int: ...
    @property
    def history(self) -> History: ...
    @property
    def task(self) -> Task: ...
    @property
    def answers(self) -> _Kind: ...
    def save(self, path: _Path | None = None, *, force: bool = False) -> None:
        """Saves all answers so far as a folder, whole or not at all."""

    @staticmethod
    def load(path: _Path) -> Session:
        """The session that was saved; it goes on to the same numbers. Raises RunError."""

class Command:
    """The command of one step. Arrays have shape (axes,)."""

    @property
    def position(self) -> _Array:
        """Commanded position [axis unit]."""

    @property
    def velocity(self) -> _Array:
        """Commanded velocity [axis unit/s]."""

    @property
    def stiffness(self) -> _Array:
        """Stiffness [N/m or N m/rad]."""

    @property
    def damping(self) -> _Array:
        """Damping [N s/m or N m s/rad]."""

    @property
    def offset(self) -> _Array:
        """Commanded minus reference position [axis unit]."""

    @property
    def force(self) -> _Array:
        """Force as the model saw it [N or N m]."""

    @property
    def phase(self) -> float: ...
    @property
    def rate(self) -> float: ...
    @property
    def energy_j(self) -> float: ...
    @property
    def port_energy_j(self) -> float: ...
    @property
    def mode(self) -> Literal["idle", "run", "hold", "stop", "fault"]: ...
    @property
    def events(self) -> tuple[str, ...]: ...
    @property
    def refused(self) -> bool: ...
    @property
    def ended(self) -> bool: ...
    @property
    def tare_ready(self) -> bool: ...
    @property
    def limited(self) -> tuple[tuple[str, ...], ...]: ...

class Controller:
    """Runs a policy on a robot: measured force in, commands out, within limits, energy and modes (docs/embedding.md)."""

    def __init__(
        self,
        policy: Policy,
        position: _PerAxis | None = None,
        *,
        law: Literal["first_order"] | Mapping[str, _PerAxis] | None = None,
        limits: Mapping[str, _PerAxis] | None = None,
        trips: Mapping[str, _PerAxis] | None = None,
        readings: Mapping[str, _PerAxis] | None = None,
        tank: Mapping[str, float] | None = None,
        port: Mapping[str, _PerAxis] | None = None,
        timing: Mapping[str, float] | None = None,
        compliance: str | Sequence[str] | None = None,
        press: _PerAxis | None = None,
        longest_step_s: float = 0.01,
    ) -> None:
        """For a robot at rest at ``position`` [axis unit]; None: at the policy's start. Raises ControllerError."""

    def update(
        self,
        force: _PerAxis,
        dt: float,
        *,
        measured_position: _PerAxis | None = None,
        force_age: int = 0,
        rate: float = 1.0,
    ) -> Command:
        """One step of ``dt`` [s]: force of the environment on the tool [N or N m], shape (axes,)."""

    def start(self) -> None: ...
    def hold(self) -> None: ...
    def resume(self) -> None: ...
    def stop(self) -> None: ...
    def tare(self) -> None: ...
    def goal(self, position: _PerAxis) -> None: ...
    def reset(self, position: _PerAxis) -> None: ...
    def set(
        self,
        *,
        limits: Mapping[str, _PerAxis] | None = None,
        trips: Mapping[str, _PerAxis] | None = None,
        readings: Mapping[str, _PerAxis] | None = None,
        tank: Mapping[str, float] | None = None,
        port: Mapping[str, _PerAxis] | None = None,
        timing: Mapping[str, float] | None = None,
        compliance: str | Sequence[str] | None = None,
        press: _PerAxis | None = None,
        longest_step_s: float = 0.01,
    ) -> None: ...
    @property
    def mode(self) -> Literal["idle", "run", "hold", "stop", "fault"]: ...
    @property
    def command(self) -> Command: ...
    @property
    def pending(self) -> int: ...
    @property
    def bias(self) -> _Array: ...
    @property
    def counters(self) -> dict[str, int]: ...

def learn(
    task: Task,
    *,
    seed: int | None = None,
    start: Policy | None = None,
    progress: _Progress = None,
    rollout: _Rollout | None = None,
    answers: _Kind | None = None,
    workers: int | None = None,
    batch: bool = False,
    out: _Path | None = None,
    force: bool = False,
) -> Run:
    """Learns a task, in its simulation or by the rollouts of a callable (docs/python.md).

    Raises TaskError, LearningError, RolloutError; KeyboardInterrupt on Ctrl-C.
    """

def resume(
    path: _Path,
    *,
    progress: _Progress = None,
    rollout: _Rollout | None = None,
    workers: int | None = None,
    batch: bool = False,
    force: bool = False,
) -> Run:
    """Goes on with a run that was broken off, to the same bytes."""

def load(path: _Path) -> Run:
    """Reads a run directory. Raises RunError."""

def _imitate(sources: list[tuple[str, str, float | None]], task: Task | None, options: Mapping[str, Any]) -> Run: ...
def _main(arguments: Sequence[str]) -> int: ...
