"""Threads that make rollouts."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable


def interrupt(idents: Iterable[int]) -> None:
    """Raises KeyboardInterrupt in the threads ``idents``, at their next step of Python."""
    for ident in idents:
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(ident), ctypes.py_object(KeyboardInterrupt))
