"""Ray: rollouts and runs on a cluster. Needs the extra ``hpf-robotics[ray]``, and hpf on every node.

``ray.init(...)`` comes first. Results are those of :func:`hpf.learn` on one machine, bit for bit: who makes a rollout,
in which order they end, and how often one is made again changes no number, as long as the same policy has the same
answer.
"""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, Literal, Union

import ray

from hpf import _hpf
from hpf.errors import HpfError, RolloutFailed
from hpf.records import Evaluation, History, Metric

_Path = Union[str, "PathLike[str]"]
_Progress = Union[bool, Callable[[Evaluation], object], None]
_Rollout = Callable[[Any], Any]
_engine: Any = ray
_GLANCE = 0.5
"""Time between looks for what takes too long [s]."""
_log = logging.getLogger("hpf.ray")


class WorkLost(RuntimeError):
    """Work was lost more often than it may be: its worker or node ended, or its time was over."""


@dataclass
class Cluster:
    """How work is handed out; what is lost with its worker or node is handed out again.

    A rollout that is lost in all its ``tries`` counts as a motion that failed, ``max_lost`` of them at most.
    """

    workers: int | None = None
    """Pieces of work at the same time; None: the CPUs of the cluster by those of a piece, as nodes come and go."""
    timeout_s: float | None = None
    """Longest time of a piece of work [s], from its handing out: with more workers than the cluster can serve, waiting
    counts too. One that takes longer is ended and handed out again."""
    tries: int = 3
    """How often a piece of work is handed out before it is given up."""
    max_lost: int = 20
    """Rollouts that may be given up."""
    options: Mapping[str, Any] = field(default_factory=dict)
    """Options of the remote function: ``{"num_cpus": 2, "resources": {"simulator": 1}}``."""

    def __post_init__(self) -> None:
        for name in ("workers", "timeout_s"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise ValueError(f"{name} is {value}: it must be above 0")
        if self.tries < 1 or self.max_lost < 0:
            raise ValueError("tries must be at least 1, max_lost at least 0")
        for foreign in ("max_retries", "retry_exceptions", "num_returns"):
            if foreign in self.options:
                raise ValueError(f"options: {foreign} is set by hpf; see tries")

    def places(self) -> int:
        """Pieces of work at the same time, now."""
        if self.workers is not None:
            return self.workers
        each = float(self.options.get("num_cpus", 1)) or 1.0
        return max(1, int(_engine.cluster_resources().get("CPU", 1.0) / each))

    def map(self, function: Any, pieces: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """The number and the result of each of ``pieces``, as they end: of one that was given up, a WorkLost.

        ``function`` is a reference to a callable. What it raises is raised here.
        """
        remote = _engine.remote(_call).options(**{**self.options, "max_retries": 0})
        waiting, tried = deque(range(len(pieces))), [0] * len(pieces)
        under_way: dict[Any, tuple[int, float]] = {}
        try:
            while waiting or under_way:
                places = self.places() if waiting else 0
                while waiting and len(under_way) < places:
                    k = waiting.popleft()
                    tried[k] += 1
                    under_way[remote.remote(function, pieces[k])] = k, time.monotonic()
                refs = list(under_way)
                _engine.wait(refs, num_returns=1, timeout=_GLANCE)
                ended, _ = _engine.wait(refs, num_returns=len(refs), timeout=0)
                lost = {ref: "its time was over" for ref in self._overdue(under_way) if ref not in ended}
                for ref in lost:
                    _engine.cancel(ref, force=True)
                for ref in ended:
                    try:
                        result = _engine.get(ref)
                    except _LOSSES as error:
                        lost[ref] = (
                            f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else 'no words'}"
                        )
                    else:
                        yield under_way.pop(ref)[0], result
                for ref, why in lost.items():
                    k, _ = under_way.pop(ref)
                    _log.warning("work %d was lost in try %d of %d: %s", k, tried[k], self.tries, why)
                    if tried[k] < self.tries:
                        waiting.appendleft(k)
                    else:
                        yield k, WorkLost(f"lost in {self.tries} tries; the last: {why}")
        finally:
            for ref in under_way:
                _engine.cancel(ref, force=True)

    def _overdue(self, under_way: Mapping[Any, tuple[int, float]]) -> list[Any]:
        if self.timeout_s is None:
            return []
        return [ref for ref, (_, since) in under_way.items() if time.monotonic() - since > self.timeout_s]


class Asked:
    """A policy that learning asks for, on another machine: what ``policy`` has, its ``draw``, the task of ``planned()``.

    A pickled hpf.Policy is its file, which has neither. ``policy`` is what hpf.Controller takes.
    """

    def __init__(self, policy: _hpf.Policy, draw: int | None, task: _hpf.Task) -> None:
        self.policy, self.draw, self._task = policy, draw, task

    def planned(self, task: _hpf.Task | None = None) -> _hpf.Motion:
        """The motion as planned, without forces."""
        return self.policy.planned(task or self._task)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or "policy" not in self.__dict__:
            raise AttributeError(name)
        return getattr(self.policy, name)


class _Rollouts:
    """Rollouts on the cluster, as a callable of hpf that takes a list of policies."""

    def __init__(self, task: _hpf.Task, rollout: _Rollout, batch: int, cluster: Cluster) -> None:
        _connected()
        if batch < 0:
            raise ValueError(f"batch is {batch}: the number of policies of a call, or 0 for one policy without a list")
        self.cluster, self.batch, self.lost = cluster, batch, 0
        self.function = _engine.put(_Several(task, rollout, batch > 0))

    def __call__(self, policies: list[_hpf.Policy]) -> list[Any]:
        size = max(1, self.batch)
        asked = [(policy, policy.draw) for policy in policies]
        pieces = [asked[k : k + size] for k in range(0, len(asked), size)]
        answers: list[list[Any]] = [[] for _ in pieces]
        for k, result in self.cluster.map(self.function, pieces):
            if isinstance(result, WorkLost):
                self.lost += len(pieces[k])
                if self.lost > self.cluster.max_lost:
                    raise result
                result = [RolloutFailed(str(result))] * len(pieces[k])
            if len(result) != len(pieces[k]):
                raise ValueError(f"{len(result)} answers to a batch of {len(pieces[k])} policies")
            answers[k] = result
        return [answer for several in answers for answer in several]


@dataclass
class _Several:
    """Answers to a list of policies."""

    task: _hpf.Task
    rollout: Callable[[Any], Any]
    is_batch: bool

    def __call__(self, asked: list[tuple[_hpf.Policy, int | None]]) -> list[Any]:
        policies = [Asked(policy, draw, self.task) for policy, draw in asked]
        if self.is_batch:
            return list(self.rollout(policies))
        answers = []
        for policy in policies:
            try:
                answers.append(self.rollout(policy))
            except RolloutFailed as failed:
                answers.append(failed)
        return answers


def learn(
    task: _hpf.Task,
    rollout: _Rollout,
    *,
    seed: int | None = None,
    start: _hpf.Policy | None = None,
    progress: _Progress = None,
    answers: Literal["costs", "trace", "residuals"] | None = None,
    batch: int = 0,
    out: _Path | None = None,
    force: bool = False,
    cluster: Cluster | None = None,
) -> _hpf.Run:
    """Learns a task by the rollouts of a callable on the cluster: :func:`hpf.learn` with ``rollout`` far away.

    ``rollout`` takes a policy as :class:`Asked`, or with ``batch=n`` a list of up to n of them, and answers as it does
    for hpf.learn. It is sent to the nodes once (cloudpickle). Raises what hpf.learn does; a RolloutError caused by
    WorkLost where more than ``cluster.max_lost`` rollouts were given up. With ``out`` it is gone on with by
    :func:`resume`.
    """
    rollouts = _Rollouts(task, rollout, batch, cluster or Cluster())
    return _hpf.learn(
        task,
        seed=seed,
        start=start,
        progress=progress,
        rollout=rollouts,
        answers=answers,
        batch=True,
        out=out,
        force=force,
    )


def resume(
    path: _Path,
    rollout: _Rollout,
    *,
    progress: _Progress = None,
    batch: int = 0,
    force: bool = False,
    cluster: Cluster | None = None,
) -> _hpf.Run:
    """Goes on with a run that was broken off, to the same bytes, wherever its rollouts were made before."""
    task = _hpf.Task.load(Path(path) / "task.toml")
    rollouts = _Rollouts(task, rollout, batch, cluster or Cluster())
    return _hpf.resume(path, progress=progress, rollout=rollouts, batch=True, force=force)


@dataclass(frozen=True, eq=False)
class SweepRun:
    """One run of a sweep."""

    settings: Mapping[str, Any]
    """The changes of the task."""
    seed: int
    policy: _hpf.Policy | None
    """What was learned; None where the run failed."""
    cost: float
    """Cost of the policy; not a number where the run failed."""
    metrics: dict[str, Metric]
    history: History | None
    error: str | None
    """Why it failed; None where it did not."""


def sweep(
    task: _hpf.Task,
    *,
    seeds: Iterable[int],
    settings: Sequence[Mapping[str, Any]] = ({},),
    rollout: _Rollout | None = None,
    answers: Literal["costs", "trace", "residuals"] | None = None,
    batch: bool = False,
    progress: Callable[[SweepRun], object] | None = None,
    cluster: Cluster | None = None,
) -> list[SweepRun]:
    """Learns a task with every one of ``settings`` and every one of ``seeds``, each run a piece of work on the cluster.

    Settings are changes as ``Task.replace`` takes them. Without ``rollout`` hpf simulates; with it, the run and its
    rollouts are made on the same node. Returns the runs in the order of settings, then seeds; ``progress`` is called
    with each as it ends. Raises TaskError for settings that cannot be, before anything is learned.
    """
    _connected()
    variants = [(dict(changes), task.replace(**changes)) for changes in settings]
    pieces = [
        (changes, variant, seed) for seed_list in (list(seeds),) for changes, variant in variants for seed in seed_list
    ]
    function = _engine.put(_Learner(rollout, answers, batch))
    runs: list[SweepRun | None] = [None] * len(pieces)
    for k, result in (cluster or Cluster()).map(function, pieces):
        changes, _, seed = pieces[k]
        run = _failed(changes, seed, str(result)) if isinstance(result, WorkLost) else result
        runs[k] = run
        if progress is not None:
            progress(run)
    return [run for run in runs if run is not None]


@dataclass
class _Learner:
    """A run of a sweep."""

    rollout: _Rollout | None
    answers: Literal["costs", "trace", "residuals"] | None
    batch: bool

    def __call__(self, piece: tuple[Mapping[str, Any], _hpf.Task, int]) -> SweepRun:
        changes, task, seed = piece
        try:
            if self.rollout is None:
                run = _hpf.learn(task, seed=seed)
            else:
                run = _hpf.learn(task, seed=seed, rollout=self.rollout, answers=self.answers, batch=self.batch)
        except HpfError as error:
            return _failed(changes, seed, str(error))
        return SweepRun(changes, seed, run.policy, run.cost, run.metrics, run.history, None)


def _failed(changes: Mapping[str, Any], seed: int, why: str) -> SweepRun:
    return SweepRun(changes, seed, None, float("nan"), {}, None, why)


def _call(function: Callable[[Any], Any], piece: Any) -> Any:
    """What a worker does."""
    return function(piece)


def _connected() -> None:
    if not _engine.is_initialized():
        raise RuntimeError(
            "hpf.ray: ray.init(...) comes before, with the address of the cluster or for this machine alone"
        )


_LOSSES: tuple[type[BaseException], ...] = (
    _engine.exceptions.WorkerCrashedError,
    _engine.exceptions.NodeDiedError,
    _engine.exceptions.LocalRayletDiedError,
    _engine.exceptions.OutOfMemoryError,
    _engine.exceptions.ObjectLostError,
    _engine.exceptions.TaskCancelledError,
)
"""What Ray raises where work is lost, and not the work's own fault."""
