"""Learning: the same bytes as the program, results as arrays, Ctrl-C, going on."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import hpf
import numpy as np
import pytest
from conftest import ROOT, TASKS

SAME = ["policy.json", "learning.csv", "trajectory.csv", "task.toml", "plots/cost.png", "plots/path.png"]


def programs() -> list[list[str]]:
    """The program of the wheel, and the one that Rust built where there is one."""
    built = os.environ.get("HPF_PROGRAM")
    return [[sys.executable, "-m", "hpf"], *([[built]] if built else [])]


@pytest.mark.parametrize("task", ["reach", "via_point", "cantilever"])
def test_python_and_program_give_the_same_bytes(task: str, tmp_path: Path) -> None:
    path = TASKS / f"{task}.toml"
    run = hpf.learn(hpf.Task.load(path, learning={"updates": 12}), seed=7)
    run.save(tmp_path / "python")
    hpf.learn(hpf.Task.load(path, learning={"updates": 12}), seed=7, out=tmp_path / "directory")
    folders = ["directory"]
    for i, program in enumerate(programs()):
        out = str(tmp_path / f"program{i}")
        options = ["--set", "learning.updates=12", "--seed", "7", "--out", out, "--quiet"]
        done = subprocess.run([*program, "learn", str(path), *options], check=False, capture_output=True, text=True)
        assert done.returncode in (0, 3), done.stderr
        folders.append(f"program{i}")
    for name in SAME:
        bytes_of_python = (tmp_path / "python" / name).read_bytes()
        for folder in folders:
            assert (tmp_path / folder / name).read_bytes() == bytes_of_python, f"{folder}/{name}"
    assert (tmp_path / "python" / "policy.json").read_text() == run.policy.to_json()
    listed = [sorted(str(p.relative_to(tmp_path / f)) for p in (tmp_path / f).rglob("*")) for f in ("python", "program0")]
    assert listed[0] == listed[1]


def test_a_run_has_arrays_and_dataclasses(reach: hpf.Task) -> None:
    run = hpf.learn(reach, seed=1)
    history = run.history
    assert len(history) == 16 and history.update.tolist() == list(range(16))
    assert history.total.dtype == np.float64 and history.rollouts.dtype == np.int64
    assert run.cost == history.total.min() < history.total[0]
    assert sum(term[-1] for term in history.terms.values()) == pytest.approx(history.total[-1])
    assert sum(run.cost_terms.values()) == pytest.approx(run.cost)
    error = run.metrics["max_goal_error"]
    assert (error.unit, error.target) == ("m", 5e-3) and error.passed == (error.value <= 5e-3)
    assert run.missed == (error.passed is False) and run.summary["seed"] == 1
    assert run.directory is None and repr(run).startswith('<hpf.Run of "reach": cost ')
    assert run.task == reach.replace(learning={"seed": 1})


def test_a_run_is_read_again_as_it_was(reach: hpf.Task, tmp_path: Path) -> None:
    run = hpf.learn(reach, seed=2)
    run.save(tmp_path / "run")
    again = hpf.load(tmp_path / "run")
    assert again.policy == run.policy and again.cost == run.cost and again.metrics == run.metrics
    assert np.array_equal(again.history.total, run.history.total)
    assert np.array_equal(again.motion.position, run.motion.position)
    again.save(tmp_path / "copy")
    assert (tmp_path / "copy/summary.json").read_bytes() == (tmp_path / "run/summary.json").read_bytes()
    with pytest.raises(hpf.RunError, match="exists"):
        run.save(tmp_path / "run")
    with pytest.raises(hpf.RunError) as refused:
        hpf.load(tmp_path / "nowhere")
    assert refused.value.file is not None


def test_motions_are_columns_tables_and_logs(reach: hpf.Task, tmp_path: Path) -> None:
    run = hpf.learn(reach)
    motion = run.policy.rollout(reach, rate=1000.0)
    assert motion.dt_s == pytest.approx(1e-3) and motion.steps == 1000 and len(motion) > 1001
    assert motion.position.shape == (len(motion), 1) == motion.stiffness.shape
    assert np.array_equal(motion["x_position_m"], motion.position[:, 0])
    assert motion.columns[:3] == ("time_s", "phase", "x_reference_m")
    assert motion.metrics["max_goal_error"].unit == "m" and motion.cost > 0
    frame = motion.to_pandas()
    assert list(frame.columns) == list(motion.columns) and len(frame) == len(motion)
    motion.to_csv(tmp_path / "motion.csv")
    assert (tmp_path / "motion.csv").read_text().startswith("time_s,phase,x_reference_m")
    motion.to_mcap(tmp_path / "motion.mcap")
    assert (tmp_path / "motion.mcap").read_bytes().startswith(b"\x89MCAP")
    with pytest.raises(KeyError, match="there are time_s"):
        motion["y"]
    # The motion of the run is the one that its policy makes.
    assert np.array_equal(run.policy.rollout(reach).position, run.motion.position)
    pushed = run.policy.rollout(reach, disturbance={0: {"amplitude": -10.0}})
    assert pushed.metrics["max_goal_error"].value > motion.metrics["max_goal_error"].value
    with pytest.raises(hpf.TaskError, match="the policy decides `stiffness`"):
        run.policy.rollout(reach, stiffness={"max": 500.0})


def test_notebooks_show_figures(reach: hpf.Task) -> None:
    run = hpf.learn(reach)
    assert {"cost", "stiffness", "damping", "path"} <= set(run.figures)
    for shown in (run, run.motion, run.policy.rollout(reach)):
        assert shown._repr_png_().startswith(b"\x89PNG")
        assert shown._repr_svg_().lstrip().startswith("<")
    assert run.figure("cost", "svg").lstrip().startswith(b"<")
    with pytest.raises(KeyError, match="there are cost"):
        run.figure("smile")
    with pytest.raises(ValueError, match="gif"):
        run.figure("cost", "gif")  # type: ignore[arg-type]


def test_progress_sees_every_evaluation(reach: hpf.Task, capsys: pytest.CaptureFixture[str]) -> None:
    seen: list[hpf.Evaluation] = []
    run = hpf.learn(reach, progress=seen.append)
    assert [one.update for one in seen] == run.history.update.tolist()
    assert seen[-1].total == run.history.total[-1] and seen[-1].terms["goal"] == run.history.terms["goal"][-1]
    hpf.learn(reach, progress=True)
    assert "cost" in capsys.readouterr().err


def test_progress_that_raises_ends_learning_with_what_there_is(reach: hpf.Task) -> None:
    def stubborn(evaluation: hpf.Evaluation) -> None:
        if evaluation.update == 3:
            raise ValueError("enough")

    with pytest.raises(hpf.LearningError, match="enough") as broken:
        hpf.learn(reach.replace(learning={"updates": 5000}), progress=stubborn)
    assert isinstance(broken.value.__cause__, ValueError)
    assert broken.value.run is not None and broken.value.run.cost > 0


def test_learning_goes_on_from_another_policy(reach: hpf.Task, tmp_path: Path) -> None:
    first = hpf.learn(reach)
    further = hpf.learn(reach.replace(learning={"noise": {"movement": 1.0}}), start=first.policy, out=tmp_path / "run")
    assert further.history.total[0] == pytest.approx(first.cost) and further.cost <= first.cost
    start = hpf.Policy.parse((tmp_path / "run/start_policy.json").read_text())
    assert start.weights.tolist() == first.policy.weights.tolist()
    with pytest.raises(hpf.PolicyError, match="axes"):
        hpf.learn(hpf.Task.load(TASKS / "via_point.toml"), start=first.policy)


def test_workers_change_no_number(reach: hpf.Task) -> None:
    assert hpf.learn(reach, workers=1).policy == hpf.learn(reach, workers=3).policy


LONG = """
import signal
import sys
import hpf
# What started the tests may have it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
task = hpf.Task.load(sys.argv[1], learning={"method": "pi2", "updates": 200000, "rollouts": 20})
print("begun", flush=True)
try:
    hpf.learn(task, out=sys.argv[2], progress=lambda one: print(one.update, flush=True) if one.update < 20 else None)
except KeyboardInterrupt as stopped:
    print("interrupted", stopped.run.history.update[-1], flush=True)
    sys.exit(130)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_leaves_a_run_that_can_go_on(tmp_path: Path) -> None:
    out = tmp_path / "run"
    command = [sys.executable, "-c", LONG, str(TASKS / "reach.toml"), str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        while (line := child.stdout.readline().strip()) != "10":
            assert line, "it ended by itself"
        child.send_signal(signal.SIGINT)
        begun = time.monotonic()
        try:
            rest, _ = child.communicate(timeout=60)
        finally:
            child.kill()
        assert child.returncode == 130 and "interrupted" in rest
        assert time.monotonic() - begun < 20
    assert (out / "checkpoint").is_file()
    summary = json.loads((out / "summary.json").read_text())
    assert summary["stopped_because"] == "it was interrupted" and summary["updates"] >= 10
    ended = hpf.load(out)
    seen: list[int] = []

    def two_more(one: hpf.Evaluation) -> None:
        seen.append(one.update)
        if len(seen) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        hpf.resume(out, progress=two_more)
    assert seen[0] == ended.history.update[-1] + 1


def test_a_resumed_run_ends_with_the_same_bytes(reach: hpf.Task, tmp_path: Path) -> None:
    def early(one: hpf.Evaluation) -> None:
        if one.update == 4:
            raise KeyboardInterrupt

    whole = hpf.learn(reach.replace(learning={"updates": 3000}), out=tmp_path / "whole")
    with pytest.raises(KeyboardInterrupt):
        hpf.learn(reach.replace(learning={"updates": 3000}), out=tmp_path / "run", progress=early)
    assert hpf.load(tmp_path / "run").history.update[-1] < 3000
    again = hpf.resume(tmp_path / "run")
    assert again.policy.to_json() == whole.policy.to_json()
    assert (tmp_path / "run/learning.csv").read_bytes() == (tmp_path / "whole/learning.csv").read_bytes()
    with pytest.raises(hpf.RunError, match="finished"):
        hpf.resume(tmp_path / "run")


def test_a_process_is_an_environment_too(tmp_path: Path) -> None:
    task = hpf.Task.load(ROOT / "examples/process/point_mass.toml", learning={"updates": 2, "rollouts": 4})
    assert task.environment == "process"
    run = hpf.learn(task, out=tmp_path / "run")
    assert run.cost == hpf.learn(task).cost > 0
