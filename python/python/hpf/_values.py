"""Values of Python as TOML."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np


def toml(value: object) -> str:
    """``value`` as a value of TOML, on one line."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, str):
        return json.dumps(value).replace("\x7f", "\\u007f")
    if isinstance(value, np.ndarray):
        return toml(value.tolist())
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(one) for one in value) + "]"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {toml(one)}" for key, one in value.items()) + " }"
    raise TypeError(f"a {type(value).__name__} has no place in a task: numbers, texts, lists and dicts have")


def _key(key: object) -> str:
    if not isinstance(key, str) or not key.replace("_", "").replace("-", "").isalnum():
        raise TypeError(f"{key!r} is no key of a table")
    return key


def changes(keywords: Mapping[str, Any]) -> tuple[list[str], list[str]]:
    """Nested keywords as ``key.path=value``, and the paths of those that are None."""
    made: list[str] = []
    removed: list[str] = []

    def walk(path: str, value: object) -> None:
        if value is None:
            removed.append(path)
        elif isinstance(value, Mapping) and value:
            for key, one in value.items():
                if not isinstance(key, (str, int)) or "=" in str(key):
                    raise TypeError(f"{path}: {key!r} is no key: a name, or the place in a list, from 0")
                walk(f"{path}.{key}", one)
        else:
            made.append(f"{path}={toml(value)}")

    for key, value in keywords.items():
        walk(key, value)
    return made, removed


def document(keywords: Mapping[str, Any]) -> str:
    """Keywords as a text of TOML; those that are None are left out."""
    return "".join(f"{_key(key)} = {toml(value)}\n" for key, value in keywords.items() if value is not None)
