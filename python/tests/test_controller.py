"""The controller: the library's numbers, modes, limits, refusals."""

from __future__ import annotations

import math
from pathlib import Path

import hpf
import numpy as np
import pytest
from conftest import TASKS

LIMITS = {"force": 50.0, "offset": 0.2, "velocity": 1.0, "acceleration": 20.0, "position_min": -1.0, "position_max": 2.0}


@pytest.fixture(scope="module")
def skill() -> hpf.Policy:
    """Two axes."""
    return hpf.learn(hpf.Task.load(TASKS / "via_point.toml", learning={"method": "auto", "max_rollouts": 40})).policy


def test_it_makes_the_motion_that_the_library_makes(tmp_path: Path) -> None:
    # `hpf run --controller` steps hpf-core's Controller in the simulated environment: told the same readings, this one
    # commands the same positions, to the bit.
    task = hpf.Task.load(TASKS / "reach.toml", disturbance=None, learning={"updates": 5})
    run = hpf.learn(task)
    run.save(tmp_path / "run")
    import subprocess
    import sys

    settings = tmp_path / "settings.toml"
    settings.write_text("watch_position = false\n[limits]\nvelocity = 0.5\n[tank]\ncapacity = 2.0\n")
    command = [sys.executable, "-m", "hpf", "run", str(tmp_path / "run"), "--controller", "--settings", str(settings)]
    done = subprocess.run([*command, "--out", str(tmp_path / "out"), "--quiet"], check=False, capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr
    table = np.genfromtxt(tmp_path / "out/controller.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    controller = hpf.Controller(run.policy, limits={"velocity": 0.5}, tank={"capacity": 2.0})
    controller.start()
    for row in table:
        command_now = controller.update([0.0], 0.01)
        assert command_now.position[0] == row["x_command_m"]
        assert command_now.energy_j == row["energy_j"] and command_now.mode == row["mode"]


def test_modes_follow_requests(skill: hpf.Policy) -> None:
    controller = hpf.Controller(skill, limits=LIMITS)
    still = np.zeros(2)
    assert controller.mode == "idle" and controller.pending == 0
    controller.start()
    controller.hold()
    assert controller.pending == 2
    assert controller.update(still, 1e-3).mode == "run"
    assert controller.update(still, 1e-3).mode == "hold"
    controller.resume()
    assert controller.update(still, 1e-3).mode == "run"
    controller.start()
    refused = controller.update(still, 1e-3)
    assert refused.refused and "refused" in refused.events and controller.counters["refused"] == 1
    controller.stop()
    for _ in range(500):
        command = controller.update(still, 1e-3)
    assert command.mode == "stop" and command.rate == 0.0
    controller.reset(skill.start)
    assert controller.update(still, 1e-3).mode == "idle"
    assert repr(controller) == "<hpf.Controller: axes x, y, idle>"


def test_it_gives_way_and_stays_within_its_limits(skill: hpf.Policy) -> None:
    controller = hpf.Controller(skill, limits=LIMITS)
    controller.start()
    command = controller.command
    ended = False
    for i in range(6000):
        command = controller.update((10.0 * math.sin(0.01 * i), -30.0), 1e-3, measured_position=command.position)
        assert np.all(np.abs(command.velocity) <= 1.0 + 1e-12) and np.all(np.abs(command.offset) <= 0.2 + 1e-12)
        ended = ended or command.ended
    assert ended and command.stiffness.shape == (2,) and command.phase < 0.02
    assert any("offset" in axis for axis in command.limited) or np.abs(command.offset).max() < 0.2


def test_a_new_goal_and_a_tare(skill: hpf.Policy) -> None:
    controller = hpf.Controller(skill, limits=LIMITS)
    for _ in range(2000):
        command = controller.update([1.0, 0.5], 1e-3)
    assert command.tare_ready
    controller.tare()
    controller.update([1.0, 0.5], 1e-3)
    assert controller.bias == pytest.approx([1.0, 0.5])
    controller.goal([0.5, 0.5])
    controller.start()
    for _ in range(8000):
        command = controller.update([1.0, 0.5], 1e-3)
    assert command.position == pytest.approx([0.5, 0.5], abs=1e-2)


def test_bad_inputs_are_bridged_counted_and_then_a_fault(skill: hpf.Policy) -> None:
    controller = hpf.Controller(skill, limits=LIMITS)
    controller.start()
    for _ in range(100):
        controller.update([0.0, 0.0], 1e-3)
    for _ in range(1000):
        command = controller.update([math.nan, 0.0], 1e-3)
        assert np.all(np.isfinite(command.position))
    assert command.mode == "fault" and controller.counters["bad_force"] == 1000 and controller.counters["faults"] == 1


def test_another_law_and_other_settings(skill: hpf.Policy) -> None:
    first = hpf.Controller(skill, limits=LIMITS)
    second = hpf.Controller(skill, law={"mass": 2.0}, limits=LIMITS)
    for controller in (first, second):
        controller.start()
        for _ in range(50):
            controller.update([5.0, 0.0], 1e-3)
    assert 0 < second.command.offset[0] < first.command.offset[0]
    first.set(limits={**LIMITS, "velocity": 0.6})
    with pytest.raises(hpf.ControllerError):
        first.set(limits={**LIMITS, "position_max": first.command.position[0] - 0.01})
    rigid = hpf.Controller(skill, compliance=["rigid", "compliant"], limits=LIMITS)
    rigid.start()
    for _ in range(50):
        rigid.update([5.0, 5.0], 1e-3)
    assert rigid.command.offset[0] == 0.0 and rigid.command.offset[1] != 0.0


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"limits": {"forze": 1.0}}, "forze"),
        ({"limits": {"velocity": [1.0, 2.0, 3.0]}}, "3 entries for 2 axes"),
        ({"limits": {"position_max": -5.0}}, "outside its workspace"),
        ({"tank": {"capacity": -1.0}}, "capacity"),
        ({"port": {"force_delay": 1}}, "tank"),
        ({"press": 1e9}, "above its largest force"),
        ({"longest_step_s": 5.0}, "longest_step"),
    ],
)
def test_settings_that_cannot_be_are_refused(skill: hpf.Policy, settings: dict[str, object], words: str) -> None:
    with pytest.raises(hpf.ControllerError, match=words):
        hpf.Controller(skill, **settings)  # type: ignore[arg-type]


def test_shapes_that_do_not_fit_are_refused(skill: hpf.Policy) -> None:
    controller = hpf.Controller(skill, limits=LIMITS)
    for wrong in ([1.0], np.zeros(3), (1.0, 2.0, 3.0)):
        with pytest.raises(ValueError, match="for 2 axes"):
            controller.update(wrong, 1e-3)
    with pytest.raises(TypeError, match="2 numbers belong there"):
        controller.update("ab", 1e-3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="mass"):
        hpf.Controller(skill, law={"weight": 1.0})
    with pytest.raises(hpf.PolicyError, match="mass"):
        hpf.Controller(skill, law={"mass": -1.0})
    # Any array of numbers is one of the right shape.
    assert controller.update(np.zeros(4, np.float32)[::2], 1e-3).mode == "idle"
