"""The walk-through runs: every block of docs/python.md, one after the other, as one program."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import ROOT

BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_the_walk_through_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (ROOT / "docs" / "python.md").read_text()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tasks").symlink_to(ROOT / "tasks")
    blocks = list(BLOCK.finditer(text))
    assert len(blocks) > 10
    names: dict[str, object] = {"__name__": "walk_through"}
    for block in blocks:
        line = text[: block.start(1)].count("\n")
        exec(compile("\n" * line + block.group(1), "docs/python.md", "exec"), names)


def test_the_readme_s_lines_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (ROOT / "python" / "README.md").read_text()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tasks").symlink_to(ROOT / "tasks")
    (block,) = BLOCK.finditer(text)
    exec(compile(block.group(1), "python/README.md", "exec"), {"__name__": "readme"})
