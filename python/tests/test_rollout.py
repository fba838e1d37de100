"""A callable as the environment: answers of every form, faults by name, nothing lost."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from itertools import chain, repeat
from pathlib import Path
from typing import Any

import hpf
import numpy as np
import pytest
from conftest import TASKS


def total(policy: hpf.Policy) -> float:
    """A cost that wants the weights of the movement at 10."""
    return float(np.square(policy.weights[:20] - 10.0).sum() + 1e-4 * policy.weights[20:40].sum())


def steps(policy: hpf.Policy) -> tuple[np.ndarray[Any, np.dtype[np.float64]], float]:
    """The same by step: costs of each, and of the end."""
    return np.full(50, 0.5 * total(policy) / 50), 0.5 * total(policy)


def trace(policy: hpf.Policy) -> hpf.Trace:
    """A tool that lags behind its reference and is pushed by what it is off."""
    planned = policy.planned()
    position = planned.reference_position.copy()
    position[1:] = 0.5 * (position[1:] + position[:-1])
    return hpf.Trace(position, planned.reference_velocity, -5.0 * (position - planned.reference_position))


@pytest.mark.parametrize("method", ["pi2", "cma-es", "auto"])
def test_a_total_cost_is_enough(free: hpf.Task, method: str) -> None:
    learning = {"method": method, "updates": 30}
    run = hpf.learn(free.replace(learning=learning, cost=None, environment=hpf.CALLABLE), rollout=total)
    assert run.cost == pytest.approx(total(run.policy)) and run.cost < run.history.total[0]
    assert run.policy.draw is None and run.history.rollouts[-1] > 0


@pytest.mark.parametrize("method", ["pi2", "auto"])
def test_costs_of_the_steps_and_of_the_end(free: hpf.Task, method: str) -> None:
    learning = {"method": method, "updates": 12}
    run = hpf.learn(free.replace(learning=learning, cost=None, environment=hpf.CALLABLE), rollout=steps)
    assert run.cost == pytest.approx(total(run.policy)) and run.cost < run.history.total[0]


@pytest.mark.parametrize("method", ["pi2", "auto", "gauss-newton"])
def test_traces_become_costs_signals_and_measures(free: hpf.Task, method: str) -> None:
    task = free.replace(learning={"method": method}, accept={"max_goal_error": 0.5})
    run = hpf.learn(task, rollout=trace)
    assert run.cost < run.history.total[0] and run.cost_terms["goal"] >= 0
    measured = trace_of(run)
    assert np.array_equal(run.motion.position, np.asarray(measured.position))
    assert run.metrics["max_goal_error"].passed is not None


def trace_of(run: hpf.Run) -> hpf.Trace:
    planned = run.policy.planned(run.task)
    position = planned.reference_position.copy()
    position[1:] = 0.5 * (position[1:] + position[:-1])
    return hpf.Trace(position, planned.reference_velocity, np.zeros_like(position))


def test_every_motion_is_counted_and_the_first_one_is_made_once(free: hpf.Task) -> None:
    calls: list[tuple[int | None, bytes]] = []

    def counted(policy: hpf.Policy) -> hpf.Trace:
        calls.append((policy.draw, policy.weights.tobytes()))
        return trace(policy)

    for method in ("pi2", "auto", "cma-es"):
        calls.clear()
        run = hpf.learn(free.replace(learning={"method": method}), rollout=counted)
        assert len(calls) == run.summary["rollouts_total"], method


def test_batches_threads_and_single_calls_give_the_same_bytes(free: hpf.Task) -> None:
    free = free.replace(learning={"method": "gauss-newton"})  # a model of the environment asks for one motion at a time
    one = hpf.learn(free, rollout=trace)
    sizes: list[int] = []

    def batch(policies: list[hpf.Policy]) -> list[hpf.Trace]:
        sizes.append(len(policies))
        return [trace(policy) for policy in policies]

    threads: set[int] = set()

    def threaded(policy: hpf.Policy) -> hpf.Trace:
        threads.add(threading.get_ident())
        time.sleep(1e-3)
        return trace(policy)

    assert hpf.learn(free, rollout=batch, batch=True).policy.to_json() == one.policy.to_json()
    assert max(sizes) > 1
    assert hpf.learn(free, rollout=threaded, workers=3).policy.weights.tolist() == one.policy.weights.tolist()
    assert len(threads) > 1


def test_a_rollout_that_raises_is_named_and_what_was_learned_stays(free: hpf.Task, tmp_path: Path) -> None:
    calls = 0

    def faulty(policy: hpf.Policy) -> float:
        nonlocal calls
        calls += 1
        if calls == 20:
            raise OSError("the arm is unplugged")
        return total(policy)

    task = free.replace(learning={"method": "pi2"}, cost=None, environment=hpf.CALLABLE)
    with pytest.raises(hpf.RolloutError, match="raised OSError: the arm is unplugged") as broken:
        hpf.learn(task, rollout=faulty)
    assert isinstance(broken.value.__cause__, OSError)
    assert broken.value.run is not None and broken.value.run.cost > 0

    calls = 0
    with pytest.raises(hpf.RolloutError, match="hpf.resume"):
        hpf.learn(task, rollout=faulty, out=tmp_path / "run")
    again = hpf.resume(tmp_path / "run", rollout=total)
    whole = hpf.learn(task, rollout=total)
    assert again.policy.to_json() == whole.policy.to_json()
    with pytest.raises(hpf.RunError):
        hpf.resume(tmp_path / "run", rollout=total)


def test_the_program_and_a_missing_callable_do_not_go_on_with_a_run_of_a_callable(
    free: hpf.Task, tmp_path: Path
) -> None:
    def stop(one: hpf.Evaluation) -> None:
        raise KeyboardInterrupt

    task = free.replace(cost=None, environment=hpf.CALLABLE)
    with pytest.raises(KeyboardInterrupt):
        hpf.learn(task, rollout=total, out=tmp_path / "run", progress=stop)
    with pytest.raises(TypeError, match="made by a callable"):
        hpf.resume(tmp_path / "run")
    command = [sys.executable, "-m", "hpf", "learn", "--resume", str(tmp_path / "run")]
    refused = subprocess.run(command, capture_output=True, text=True, check=False)
    assert refused.returncode == 2 and "Python callable" in refused.stderr
    assert hpf.resume(tmp_path / "run", rollout=total).cost > 0


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (np.zeros(49), "49 costs for 50 steps"),
        (np.zeros((50, 2)), r"shape \[50, 2\]"),
        ("three", "returned str"),
        (None, "returned NoneType"),
        (hpf.Trace(np.zeros((50, 2)), np.zeros((50, 2)), np.zeros((50, 2))), "50 numbers of position"),
        (hpf.Trace(np.zeros((51, 3)), np.zeros((51, 3)), np.zeros((51, 3))), "3 axes"),
        (hpf.Trace(np.zeros((51, 2)), np.zeros((51, 1)), np.zeros((51, 2))), "axes in its signals"),
        ({"position": np.zeros((51, 2))}, "without velocity"),
    ],
)
def test_what_is_no_answer_is_named(free: hpf.Task, answer: Any, words: str) -> None:
    with pytest.raises(hpf.RolloutError, match=words):
        hpf.learn(free, rollout=lambda policy: answer)


def test_other_answers_than_before_and_short_batches_are_named(free: hpf.Task) -> None:
    measured = hpf.Trace(np.zeros((51, 2)), np.zeros((51, 2)), np.zeros((51, 2)))
    answers: Iterator[Any] = chain([1.0, 2.0], repeat(measured))
    with pytest.raises(hpf.RolloutError, match="where costs were answered before"):
        hpf.learn(free, rollout=lambda policy: next(answers))
    with pytest.raises(hpf.RolloutError, match="1 answers to a batch of"):
        hpf.learn(free, rollout=lambda policies: [1.0], batch=True)


def residuals(policy: hpf.Policy) -> hpf.Residuals:
    """Linear in the weights of the movement: the least half square is known."""
    weights = policy.weights[:20]
    return hpf.Residuals(np.concatenate([weights - 3.0, weights + 1.0]))


def test_residuals_are_learned_from_one_by_one(free: hpf.Task, tmp_path: Path) -> None:
    task = free.replace(cost=None, environment=hpf.CALLABLE, learning={"method": "gauss-newton", "max_rollouts": 300})
    run = hpf.learn(task, rollout=residuals, out=tmp_path / "run")
    # 20 weights, each at the mean of 3 and -1: 20 (2^2 + 2^2)/2.
    assert run.cost == pytest.approx(80.0, rel=1e-3)
    assert hpf.learn(task, rollout=residuals, answers="residuals").policy == run.policy
    batch = hpf.learn(task, rollout=lambda policies: [residuals(policy) for policy in policies], batch=True)
    assert batch.policy == run.policy

    session = hpf.Session(task, answers="residuals", residuals=40)
    while policies := session.ask():
        session.tell([{"residuals": residuals(policy).residuals} for policy in policies])
    assert session.policy.weights.tolist() == run.policy.weights.tolist()
    session.save(tmp_path / "session")
    assert hpf.Session.load(tmp_path / "session").answers == "residuals"


def test_residuals_that_do_not_fit_are_named(free: hpf.Task) -> None:
    task = free.replace(cost=None, environment=hpf.CALLABLE)
    counts = chain([2], repeat(3))
    with pytest.raises(hpf.RolloutError, match="3 residuals, where 2 were answered before"):
        hpf.learn(task, rollout=lambda policy: hpf.Residuals(np.zeros(next(counts))))
    with pytest.raises(hpf.RolloutError, match="returned costs, where hpf.Residuals belongs"):
        hpf.learn(task, rollout=lambda policy: 1.0, answers="residuals")
    with pytest.raises(ValueError, match="residuals is how many"):
        hpf.Session(task, answers="residuals")
    with pytest.raises(ValueError, match="residuals is how many"):
        hpf.Session(task, residuals=3)


def test_a_motion_that_fails_is_rejected_and_learning_goes_on(free: hpf.Task) -> None:
    calls = 0

    def shaky(policy: hpf.Policy) -> float:
        nonlocal calls
        calls += 1
        if calls % 5 == 2:
            raise hpf.RolloutFailed("joint limit")
        return float("nan") if calls % 5 == 4 else total(policy)

    run = hpf.learn(free.replace(learning={"method": "pi2"}, cost=None, environment=hpf.CALLABLE), rollout=shaky)
    assert run.summary["rejected_rollouts"] > 3 and run.cost < run.history.total[0]
    assert any("joint limit" in note for note in run.notes)
    assert any("not finite" in note for note in run.notes)


def test_where_every_motion_fails_the_error_says_so(free: hpf.Task) -> None:
    def failing(policy: hpf.Policy) -> float:
        raise hpf.RolloutFailed("no power")

    with pytest.raises(hpf.RolloutError, match="pass answers="):
        hpf.learn(free, rollout=failing)
    with pytest.raises(hpf.HpfError, match="no finite cost"):
        hpf.learn(free, rollout=failing, answers="costs")


def test_what_hpf_would_simulate_is_refused_beside_a_callable() -> None:
    task = hpf.Task.load(TASKS / "reach.toml")
    with pytest.raises(hpf.TaskError, match="disturbance=None"):
        hpf.learn(task, rollout=total)
    left_out: dict[str, Any] = {"disturbance": None, "accept": None, "cost": None}
    costs = hpf.Task.load(TASKS / "reach.toml", environment=hpf.CALLABLE, **left_out)
    assert costs.environment == "callable"
    with pytest.raises(TypeError, match="pass rollout"):
        hpf.learn(costs)
    assert hpf.learn(costs.replace(learning={"updates": 2}), rollout=total).cost > 0
    with pytest.raises(TypeError, match="rollout of your own"):
        hpf.learn(costs, batch=True)


def test_parameters_that_change_in_flight_are_refused(free: hpf.Task) -> None:
    with pytest.raises(hpf.TaskError, match="exploration"):
        hpf.learn(free.replace(learning={"method": "pi2", "exploration": "step"}), rollout=total, answers="costs")


SLOW = """
import signal
import sys
import time
import hpf
# What started the tests may have it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
task = hpf.Task.parse(open(sys.argv[1]).read(), cost=None, environment=hpf.CALLABLE)
def slow(policy):
    sys.stdout.write("call\\n")
    sys.stdout.flush()
    while True:
        time.sleep(0.01)
try:
    hpf.learn(task, rollout=slow, workers=int(sys.argv[2]), answers="costs")
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(130)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("workers", [1, 2])
def test_ctrl_c_ends_a_callable_that_hangs(free: hpf.Task, tmp_path: Path, workers: int) -> None:
    (tmp_path / "task.toml").write_text(free.text)
    command = [sys.executable, "-c", SLOW, str(tmp_path / "task.toml"), str(workers)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        child.stdout.readline()
        time.sleep(0.2)
        child.send_signal(signal.SIGINT)
        try:
            rest, _ = child.communicate(timeout=30)
        finally:
            child.kill()
        assert "interrupted" in rest and child.returncode == 130
