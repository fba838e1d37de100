"""Sessions: asked, answered, saved, loaded."""

from __future__ import annotations

from pathlib import Path

import hpf
import numpy as np
import pytest
from test_rollout import total, trace


def finish(session: hpf.Session) -> hpf.Session:
    while batch := session.ask():
        session.tell([trace(policy) if session.answers == "trace" else total(policy) for policy in batch])
    return session


@pytest.mark.parametrize("method", ["pi2", "auto", "cma-es"])
def test_a_conversation_learns_what_a_callable_learns(free: hpf.Task, method: str) -> None:
    task = free.replace(learning={"method": method})
    session = finish(hpf.Session(task, answers="trace"))
    run = hpf.learn(task, rollout=trace)
    assert session.done and session.stopped_because and session.ask() == []
    assert session.policy.weights.tolist() == run.policy.weights.tolist() and session.cost == run.cost
    assert np.array_equal(session.history.total, run.history.total)
    assert session.updates == run.summary["updates"] and session.rollouts == run.summary["rollouts_total"] - 1


def test_a_session_that_is_saved_at_any_moment_goes_on_to_the_same_numbers(free: hpf.Task, tmp_path: Path) -> None:
    task = free.replace(learning={"method": "pi2"}, cost=None, environment=hpf.CALLABLE)
    whole = finish(hpf.Session(task, seed=5))
    session = hpf.Session(task, seed=5)
    place = tmp_path / "session"
    days = 0
    while batch := session.ask():
        assert [policy.weights.tolist() for policy in batch] == [policy.weights.tolist() for policy in session.ask()]
        session.tell([total(policy) for policy in batch])
        session.save(place)
        session = hpf.Session.load(place)
        days += 1
    assert days > 5 and session.policy == whole.policy and session.history.total.tolist() == whole.history.total.tolist()
    with pytest.raises(hpf.RunError, match="exists"):
        hpf.Session(task).save(place)
    hpf.Session(task).save(place, force=True)
    assert hpf.Session.load(place).rollouts == 0


def test_a_session_of_a_policy_keeps_where_it_started(free: hpf.Task, tmp_path: Path) -> None:
    first = hpf.learn(free, rollout=trace)
    session = hpf.Session(free, answers="trace", start=first.policy)
    assert session.ask()[0].weights.tolist() == first.policy.weights.tolist()
    session.save(tmp_path / "session")
    assert hpf.Session.load(tmp_path / "session").ask()[0].weights.tolist() == first.policy.weights.tolist()


def test_answers_that_are_none_change_nothing(free: hpf.Task) -> None:
    session = hpf.Session(free.replace(cost=None, environment=hpf.CALLABLE))
    with pytest.raises(RuntimeError, match=r"ask\(\) comes before"):
        session.tell([1.0])
    batch = session.ask()
    for wrong, words in (([], "0 answers"), (["one"] * len(batch), "answer 0: the rollout returned str")):
        with pytest.raises(hpf.RolloutError, match=words):
            session.tell(wrong)
    assert session.rollouts == 0
    session.tell([total(policy) for policy in batch])
    assert session.rollouts == len(batch) and session.cost > 0
    assert session.policy.planned(session.task).position.shape == (51, 2)


def test_a_motion_that_failed_is_told_as_such(free: hpf.Task) -> None:
    session = hpf.Session(free.replace(learning={"method": "pi2"}, cost=None, environment=hpf.CALLABLE))
    session.tell([total(policy) for policy in session.ask()])
    answers: list[float | hpf.RolloutFailed] = [total(policy) for policy in session.ask()]
    answers[0] = hpf.RolloutFailed("dropped")
    session.tell(answers)
    assert session.rejected == 1
    assert repr(session).startswith('<hpf.Session of "free", told costs: cost ')


def test_a_damaged_session_is_refused_by_name(free: hpf.Task, tmp_path: Path) -> None:
    session = hpf.Session(free.replace(cost=None, environment=hpf.CALLABLE))
    session.tell([total(policy) for policy in session.ask()])
    session.save(tmp_path / "session")
    task = tmp_path / "session/task.toml"
    task.write_text(task.read_text().replace("seed = 3", "seed = 4"))
    with pytest.raises(hpf.RunError, match="task.toml is not what this run began with"):
        hpf.Session.load(tmp_path / "session")
    with pytest.raises(hpf.RunError):
        hpf.Session.load(tmp_path / "nowhere")
