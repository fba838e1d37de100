"""The program inside the wheel."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from pathlib import Path

import hpf
import pytest
from conftest import TASKS


def program(*arguments: str) -> subprocess.CompletedProcess[str]:
    script = Path(sysconfig.get_path("scripts")) / "hpf"
    command = [str(script)] if script.exists() else [sys.executable, "-m", "hpf"]
    return subprocess.run([*command, *arguments], capture_output=True, text=True, check=False)


def test_the_console_script_is_the_program() -> None:
    printed = program("--version")
    assert printed.returncode == 0 and printed.stdout == f"hpf {hpf.__version__}\n"
    assert program("check", str(TASKS / "reach.toml")).returncode == 0


def test_its_exit_codes_are_the_program_s(tmp_path: Path) -> None:
    assert program().returncode == 2
    refused = program("learn", "nowhere.toml")
    assert refused.returncode == 2 and "there is no such file" in refused.stderr
    path = str(tmp_path / "run")
    missed = program("learn", str(TASKS / "reach.toml"), "--set", "accept.max_goal_error=1e-12", "--out", path, "--quiet")
    assert missed.returncode == 3


def test_the_help_names_the_program() -> None:
    assert "hpf learn tasks/cantilever.toml" in program("--help").stdout


@pytest.mark.parametrize("name", ["learn", "Task", "Policy", "Controller", "Session", "Motion", "Run", "imitate"])
def test_what_is_public_says_what_it_is(name: str) -> None:
    documentation = getattr(hpf, name).__doc__
    assert documentation and len(documentation) > 60
