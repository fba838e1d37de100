"""Progress as a line."""

from __future__ import annotations

import sys
import time

from hpf.records import Evaluation


class Line:
    """Shows evaluations on one line of stderr, at most ten times a second."""

    def __init__(self) -> None:
        self.shown = 0.0

    def __call__(self, evaluation: Evaluation) -> None:
        now = time.monotonic()
        if now - self.shown < 0.1:
            return
        self.shown = now
        text = f"update {evaluation.update}: {evaluation.rollouts} motions, cost {evaluation.total:.6g}"
        sys.stderr.write(f"\r{text:<70}")
        sys.stderr.flush()

    def close(self) -> None:
        if self.shown:
            sys.stderr.write("\n")
