"""hpf.ray against a cluster that is played: what is lost is made again, and the numbers are those of one machine.

Ray itself, on two nodes: ray_two_nodes.py.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import hpf
import numpy as np
import pytest
from test_rollout import trace

pytest.importorskip("ray")

import hpf.ray
from ray import exceptions

Fate = Callable[[int], str]


class Played:
    """What hpf.ray takes of Ray. The fate of the n-th piece handed out: "done", "lost" or "hangs"."""

    def __init__(self, fate: Fate) -> None:
        self.fate, self.handed, self.canceled = fate, 0, 0
        self.exceptions = exceptions
        self.connected = True

    def is_initialized(self) -> bool:
        return self.connected

    def cluster_resources(self) -> dict[str, float]:
        return {"CPU": 3.0}

    def put(self, value: object) -> bytes:
        return pickle.dumps(value)

    def remote(self, call: Callable[..., Any]) -> Any:
        def hand_out(function: bytes, piece: object) -> SimpleNamespace:
            self.handed += 1
            work = call, function, pickle.dumps(piece)
            return _Ref(work=work, fate=self.fate(self.handed))

        def options(**said: Any) -> Any:
            assert said["max_retries"] == 0
            return SimpleNamespace(remote=hand_out)

        return SimpleNamespace(options=options)

    def wait(self, refs: list[Any], num_returns: int, timeout: float) -> tuple[list[Any], list[Any]]:
        ended = [ref for ref in refs if ref.fate != "hangs"][::-1][
            :num_returns
        ]  # the last first: order does not matter
        return ended, [ref for ref in refs if ref not in ended]

    def get(self, ref: Any) -> Any:
        if ref.fate == "lost":
            raise exceptions.WorkerCrashedError
        call, function, piece = ref.work
        return pickle.loads(pickle.dumps(call(pickle.loads(function), pickle.loads(piece))))

    def cancel(self, ref: Any, force: bool) -> None:
        assert force
        self.canceled += 1


class _Ref(SimpleNamespace):
    __hash__ = object.__hash__  # type: ignore[assignment]
    __eq__ = object.__eq__


def play(monkeypatch: pytest.MonkeyPatch, fate: Fate = lambda n: "done") -> Played:
    played = Played(fate)
    monkeypatch.setattr(hpf.ray, "_engine", played)
    monkeypatch.setattr(hpf.ray, "_GLANCE", 0.01)
    return played


def with_draw(policy: hpf.Policy) -> float:
    """A cost that asks for all that a policy has only where it is asked for."""
    draw = -1 if policy.draw is None else policy.draw
    return float(np.square(policy.weights - 10.0).sum() + draw + policy.planned().stiffness.sum())


def in_batch(policies: list[hpf.Policy]) -> Iterator[float]:
    return (with_draw(policy) for policy in policies)


@pytest.fixture
def costs(free: hpf.Task) -> hpf.Task:
    return free.replace(learning={"method": "pi2"}, cost=None, environment=hpf.CALLABLE)


@pytest.mark.parametrize("fate", [lambda n: "done", lambda n: "lost" if n % 7 == 0 else "done"])
def test_far_rollouts_learn_what_near_ones_do(monkeypatch: pytest.MonkeyPatch, costs: hpf.Task, fate: Fate) -> None:
    play(monkeypatch, fate)
    near = hpf.learn(costs, rollout=with_draw)
    far = hpf.ray.learn(costs, with_draw)
    assert far.policy.to_json() == near.policy.to_json() and far.history.total.tolist() == near.history.total.tolist()
    several = hpf.ray.learn(costs, in_batch, batch=4)
    assert several.policy.to_json() == near.policy.to_json()


def test_far_traces_learn_what_near_ones_do(monkeypatch: pytest.MonkeyPatch, free: hpf.Task) -> None:
    play(monkeypatch)
    assert hpf.ray.learn(free, trace).policy.to_json() == hpf.learn(free, rollout=trace).policy.to_json()


def test_what_is_lost_in_all_tries_is_a_motion_that_failed(monkeypatch: pytest.MonkeyPatch, costs: hpf.Task) -> None:
    played = play(monkeypatch, lambda n: "lost" if 10 <= n < 12 else "done")
    run = hpf.ray.learn(costs, with_draw, cluster=hpf.ray.Cluster(tries=1))
    assert run.summary["rejected_rollouts"] == 2 and played.handed == run.summary["rollouts_total"]
    play(monkeypatch, lambda n: "lost" if n >= 10 else "done")
    with pytest.raises(hpf.RolloutError) as caught:
        hpf.ray.learn(costs, with_draw, cluster=hpf.ray.Cluster(max_lost=2))
    assert isinstance(caught.value.__cause__, hpf.ray.WorkLost)


def test_what_takes_too_long_is_ended_and_made_again(monkeypatch: pytest.MonkeyPatch, costs: hpf.Task) -> None:
    played = play(monkeypatch, lambda n: "hangs" if n == 9 else "done")
    run = hpf.ray.learn(costs, with_draw, cluster=hpf.ray.Cluster(timeout_s=0.05))
    assert played.canceled == 1 and run.policy.to_json() == hpf.learn(costs, rollout=with_draw).policy.to_json()


def test_a_run_that_was_broken_off_goes_on_anywhere(
    monkeypatch: pytest.MonkeyPatch, costs: hpf.Task, tmp_path: Path
) -> None:
    play(monkeypatch)

    def stop(evaluation: hpf.Evaluation) -> None:
        if evaluation.update == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        hpf.ray.learn(costs, with_draw, progress=stop, out=tmp_path / "run")
    again = hpf.ray.resume(tmp_path / "run", with_draw)
    assert again.policy.to_json() == hpf.learn(costs, rollout=with_draw).policy.to_json()


def broken(policy: hpf.Policy) -> float:
    raise LookupError("no such robot")


def test_what_a_rollout_raises_far_away_is_the_cause(monkeypatch: pytest.MonkeyPatch, costs: hpf.Task) -> None:
    play(monkeypatch)
    with pytest.raises(hpf.RolloutError) as caught:
        hpf.ray.learn(costs, broken)
    assert isinstance(caught.value.__cause__, LookupError)


def test_a_sweep_is_its_runs(monkeypatch: pytest.MonkeyPatch, costs: hpf.Task) -> None:
    play(monkeypatch, lambda n: "lost" if n in (2, 5) else "done")
    settings: list[Mapping[str, Any]] = [{"learning": {"rollouts": 4}}, {"learning": {"updates": 3}}]
    ended: list[hpf.ray.SweepRun] = []
    runs = hpf.ray.sweep(costs, seeds=(1, 2), settings=settings, rollout=with_draw, progress=ended.append)
    assert [(run.settings, run.seed) for run in runs] == [(one, seed) for one in settings for seed in (1, 2)]
    assert len(ended) == 4
    for run in runs:
        alone = hpf.learn(costs.replace(**run.settings), seed=run.seed, rollout=with_draw)
        assert run.policy is not None and run.history is not None
        assert run.policy.to_json() == alone.policy.to_json() and run.cost == alone.cost
        assert run.history.total.tolist() == alone.history.total.tolist()


def test_a_sweep_names_the_runs_that_failed(monkeypatch: pytest.MonkeyPatch, costs: hpf.Task) -> None:
    play(monkeypatch, lambda n: "lost" if n == 1 else "done")
    first, second = hpf.ray.sweep(costs, seeds=(1, 2), rollout=with_draw, cluster=hpf.ray.Cluster(workers=1, tries=1))
    assert first.policy is None and (first.error or "").startswith("lost in 1 tries; the last: WorkerCrashedError")
    assert second.policy is not None and second.error is None
    with pytest.raises(hpf.TaskError):
        hpf.ray.sweep(costs, seeds=(1,), settings=[{"learning": {"rollouts": -1}}])


def test_wrong_settings_and_no_cluster_are_refused_by_name(monkeypatch: pytest.MonkeyPatch, costs: hpf.Task) -> None:
    wrongs: list[tuple[str, dict[str, Any]]] = [("tries", {"tries": 0}), ("workers", {"workers": 0})]
    wrongs += [("timeout_s", {"timeout_s": 0.0}), ("max_retries", {"options": {"max_retries": 3}})]
    for name, wrong in wrongs:
        with pytest.raises(ValueError, match=name):
            hpf.ray.Cluster(**wrong)
    play(monkeypatch).connected = False
    with pytest.raises(RuntimeError, match="ray.init"):
        hpf.ray.learn(costs, with_draw)
