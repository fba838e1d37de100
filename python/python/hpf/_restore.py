"""What pickles call."""

from __future__ import annotations

from hpf._hpf import Policy, Task


def task(text: str, tables: list[tuple[str, str]], file: str | None) -> Task:
    return Task._restore(text, tables, file)


def policy(text: str) -> Policy:
    return Policy.parse(text)
