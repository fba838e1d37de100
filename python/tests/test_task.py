"""Tasks and policies: read, changed, shown, pickled, refused."""

from __future__ import annotations

import pickle
from pathlib import Path

import hpf
import numpy as np
import pytest
from conftest import TASKS


def test_a_task_is_read_with_nested_changes() -> None:
    task = hpf.Task.load(
        TASKS / "cantilever.toml", learning={"method": "auto", "noise": {"movement": 3}}, axis={0: {"goal": 0.03}}
    )
    assert (task.name, task.method, task.axes, task.units) == ("cantilever", "auto", ("y",), ("m",))
    assert task.goal.tolist() == [0.03] and task.start.tolist() == [0.0]
    assert (task.duration_s, task.rate_hz, task.steps, task.contact) == (5.0, 100.0, 500, "cantilever")
    assert "movement = 3" in task.text and task.file == str(TASKS / "cantilever.toml")
    noise = task.to_dict()["learning"]["noise"]
    assert noise["movement"] == 3.0 and noise["stiffness"] == 20.0


def test_none_leaves_a_key_out() -> None:
    task = hpf.Task.load(TASKS / "reach.toml", disturbance=None, cost={"rest": None})
    assert "[[disturbance]]" not in task.text
    assert task.to_dict()["disturbance"] == []
    assert task.to_dict()["cost"]["rest"] == 0.0


def test_replace_makes_another_task_and_leaves_this_one(reach: hpf.Task) -> None:
    other = reach.replace(rate=200.0, accept={"max_goal_error": 1e-3})
    assert (other.rate_hz, reach.rate_hz) == (200.0, 100.0)
    assert other != reach and reach.replace() == reach and hash(reach.replace()) == hash(reach)


def test_reprs_say_what_a_thing_is(reach: hpf.Task) -> None:
    assert repr(reach) == "<hpf.Task \"reach\": axes x [m], 1 s at 100 Hz, simulation, method pi2>"
    assert repr(hpf.Policy.initial(reach)).startswith('<hpf.Policy of "reach": axes x [m], 1 s, ')


def test_every_mistake_of_a_file_comes_with_its_line_and_column(tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    text = (TASKS / "reach.toml").read_text().replace("rate = 100.0 ", "rate = -1.0 ").replace("min = 30.0", "mim = 30.0")
    path.write_text(text)
    with pytest.raises(hpf.TaskError) as refused:
        hpf.Task.load(path)
    error = refused.value
    assert error.file == str(path) and isinstance(error, ValueError) and len(error.mistakes) >= 2
    lines = text.splitlines()
    for mistake in error.mistakes:
        assert mistake.line is not None and mistake.column is not None and mistake.help
    places = {mistake.line for mistake in error.mistakes}
    assert 1 + next(i for i, line in enumerate(lines) if line.startswith("rate")) in places
    assert 1 + next(i for i, line in enumerate(lines) if line.startswith("mim")) in places
    assert error.line == error.mistakes[0].line and str(path) in str(error)


@pytest.mark.parametrize(
    "changes", [{"learning": {"mehtod": "auto"}}, {"axis": {5: {"goal": 1.0}}}, {"rate": "fast"}, {"rate": float("nan")}]
)
def test_changes_that_cannot_be_are_refused(changes: dict[str, object]) -> None:
    with pytest.raises(hpf.TaskError):
        hpf.Task.load(TASKS / "reach.toml", **changes)


def test_a_value_without_a_place_in_a_task_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="set"):
        hpf.Task.load(TASKS / "reach.toml", rate={1, 2})


def test_a_missing_file_is_named() -> None:
    with pytest.raises(hpf.TaskError, match="there is no such file") as refused:
        hpf.Task.load("nowhere.toml")
    assert refused.value.file == "nowhere.toml"


def test_tasks_and_policies_survive_a_pickle(reach: hpf.Task) -> None:
    task = pickle.loads(pickle.dumps(reach))
    assert task == reach and task.text == reach.text
    policy = hpf.Policy.initial(reach)
    again = pickle.loads(pickle.dumps(policy))
    assert again == policy and again.to_json() == policy.to_json() and again.sha256 == policy.sha256


def test_a_pickled_task_holds_its_force_table(tmp_path: Path) -> None:
    (tmp_path / "force.csv").write_text("time_s,force_n\n0.0,0.0\n0.5,-2.0\n1.0,0.0\n")
    path = tmp_path / "task.toml"
    text = (TASKS / "reach.toml").read_text().replace('kind = "step" ', 'kind = "table"\nfile = "force.csv" #')
    text = text.replace("amplitude = -2.0", "# ").replace("start = 0.5", "# ")
    path.write_text(text)
    task = hpf.Task.load(path, learning={"updates": 2})
    (tmp_path / "force.csv").unlink()
    again = pickle.loads(pickle.dumps(task))
    cost = hpf.learn(task, seed=2).cost
    assert hpf.learn(again, seed=2).cost == cost
    assert hpf.learn(again.replace(rate=200.0)).task.rate_hz == 200.0


def test_a_policy_has_weights_that_can_be_replaced(reach: hpf.Task, tmp_path: Path) -> None:
    policy = hpf.Policy.initial(reach)
    weights = policy.weights
    assert weights.shape == (60,) and weights.dtype == np.float64
    weights[20:40] = 200.0
    other = policy.with_weights(weights)
    assert other.weights.tolist() == weights.tolist() and policy.weights[20] == 100.0
    with pytest.raises(hpf.PolicyError, match="where 60 belong"):
        policy.with_weights(weights[:-1])
    weights[20] = 1e9
    with pytest.raises(hpf.PolicyError, match="stiffness"):
        policy.with_weights(weights)
    other.save(tmp_path / "policy.json")
    assert hpf.Policy.load(tmp_path / "policy.json") == other
    with pytest.raises(hpf.RunError, match="exists"):
        other.save(tmp_path / "policy.json")


def test_a_policy_text_that_is_none_is_refused_at_its_line() -> None:
    with pytest.raises(hpf.PolicyError) as refused:
        hpf.Policy.parse('{\n  "format": \n}')
    assert refused.value.line == 3


def test_a_policy_takes_forms_for_firmware(reach: hpf.Task) -> None:
    policy = hpf.Policy.initial(reach)
    assert "const" in str(policy.export("rust", scalar="f32"))
    assert isinstance(policy.export("binary"), bytes)
    with pytest.raises(ValueError, match="f16"):
        policy.export("c", scalar="f16")  # type: ignore[arg-type]
