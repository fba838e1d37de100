"""Imitation: arrays, tables, frames, files and runs; mistakes with their lines."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import hpf
import numpy as np
import pandas as pd
import pytest
from conftest import TASKS

TIME = np.linspace(0.0, 2.0, 201)
SHAPE = 10 * (TIME / 2) ** 3 - 15 * (TIME / 2) ** 4 + 6 * (TIME / 2) ** 5
POSITION = 0.1 + 0.3 * SHAPE


def test_arrays_dicts_frames_and_files_give_the_same_policy(tmp_path: Path) -> None:
    columns = {"time_s": TIME, "x_m": POSITION}
    frame = pd.DataFrame(columns)
    file = tmp_path / "recording.csv"
    file.write_text("time_s,x_m\n" + "".join(f"{t!r},{x!r}\n" for t, x in zip(TIME.tolist(), POSITION.tolist())))
    fit = hpf.imitate(POSITION, time=TIME, name="wave")
    others = [hpf.imitate(columns, name="wave"), hpf.imitate(frame, name="wave"), hpf.imitate(file, name="wave")]
    assert all(other.policy == fit.policy for other in others)
    assert fit.metrics["demonstration_rmse"].value < 1e-4 and fit.policy.goal == pytest.approx([0.4])
    assert "demonstration" in fit.figures


def test_a_file_gives_the_program_s_bytes(tmp_path: Path) -> None:
    recording = TASKS / "demonstrations" / "wipe.csv"
    hpf.imitate(recording).save(tmp_path / "python")
    command = [sys.executable, "-m", "hpf", "imitate", str(recording), "--out", str(tmp_path / "program"), "--quiet"]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr
    for name in ("policy.json", "task.toml", "trajectory.csv", "demonstrations.csv"):
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "program" / name).read_bytes(), name


def test_several_recordings_and_several_axes() -> None:
    both = np.column_stack([POSITION, 1.0 - POSITION])
    fit = hpf.imitate([both, both + 0.01 * SHAPE[:, None]], time=TIME, axes=["a", "b"], stiffness_from="spread")
    assert fit.policy.axes == ("a", "b") and fit.task.duration_s == 2.0
    turned = hpf.imitate(POSITION, time=TIME, unit="rad", duration_s=1.0)
    assert turned.policy.units == ("rad",) and turned.policy.duration_s == 1.0


def test_learning_goes_on_from_an_imitation(tmp_path: Path) -> None:
    fit = hpf.imitate(POSITION, time=TIME, name="wave")
    run = hpf.learn(fit.task.replace(learning={"updates": 3}), start=fit.policy)
    assert run.history.total[0] == pytest.approx(fit.cost)
    fit.save(tmp_path / "fit")
    assert hpf.imitate(tmp_path / "fit", name="again").metrics["demonstration_rmse"].value < 1e-4


def test_a_recording_that_cannot_be_is_refused_at_its_line(tmp_path: Path) -> None:
    file = tmp_path / "bad.csv"
    file.write_text("time_s,x_m\n0,0\n1,zero\n2,1\n3,2\n4,3\n5,4\n")
    with pytest.raises(hpf.DemonstrationError) as refused:
        hpf.imitate(file)
    assert refused.value.line == 3 and refused.value.file == str(file)
    for wrong, words in (
        (dict(recordings=POSITION), "needs time="),
        (dict(recordings=np.zeros((4, 3, 2)), time=TIME), "shape"),
        (dict(recordings=POSITION, time=TIME[:-1]), "different lengths"),
        (dict(recordings=POSITION, time=TIME, axes=["a", "b"]), "2 names"),
    ):
        keywords = dict(wrong)
        recordings = keywords.pop("recordings")
        with pytest.raises(ValueError, match=words):
            hpf.imitate(recordings, **keywords)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="fit must be"):
        hpf.imitate(POSITION, time=TIME, fit="cubic")  # type: ignore[arg-type]
    with pytest.raises(hpf.DemonstrationError, match="at least two"):
        hpf.imitate(POSITION, time=TIME, stiffness_from="spread")
