"""What can go wrong, by whose doing; an error of a text says where: file, line and column."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hpf._hpf import Run


@dataclass(frozen=True)
class Mistake:
    """One mistake in a text: where it is, what is wrong, and what is allowed."""

    file: str | None
    line: int | None
    """Counted from 1."""
    column: int | None
    """Counted from 1."""
    message: str
    help: str

    def __str__(self) -> str:
        place = ":".join(str(part) for part in (self.file, self.line, self.column) if part is not None)
        text = f"{place}: {self.message}" if place else self.message
        return f"{text}; {self.help}" if self.help else text


class HpfError(Exception):
    """Any error of HPF. file, line and column are those of the first mistake, None where there is no place."""

    mistakes: tuple[Mistake, ...] = ()
    """Every mistake found, in the order of the text."""

    @property
    def file(self) -> str | None:
        return self.mistakes[0].file if self.mistakes else None

    @property
    def line(self) -> int | None:
        return self.mistakes[0].line if self.mistakes else None

    @property
    def column(self) -> int | None:
        return self.mistakes[0].column if self.mistakes else None


class TaskError(HpfError, ValueError):
    """A task that cannot be."""


class PolicyError(HpfError, ValueError):
    """A policy that cannot be, or does not go with the task."""


class DemonstrationError(HpfError, ValueError):
    """A recording that cannot be imitated."""


class ControllerError(HpfError, ValueError):
    """Settings that a controller refuses."""


class RunError(HpfError):
    """A run directory that cannot be read, gone on with or replaced."""


class WorkError(HpfError):
    """Work that failed by itself."""


class LearningError(HpfError):
    """Learning that broke off."""

    run: Run | None = None
    """What was learned until then, where there is something."""


class RolloutError(LearningError):
    """A rollout of the caller's own that raised, or whose answer is none; what it raised is the cause."""


class RolloutFailed(Exception):
    """Raised or returned by a rollout: the motion failed, and would again. It is rejected, and learning goes on."""


def make(
    name: str, text: str, mistakes: Iterable[tuple[str | None, int | None, int | None, str, str]]
) -> HpfError:
    """The error ``name`` with its mistakes."""
    kinds: dict[str, type[HpfError]] = {kind.__name__: kind for kind in _KINDS}
    error = kinds[name](text)
    error.mistakes = tuple(Mistake(*mistake) for mistake in mistakes)
    return error


_KINDS = (
    TaskError,
    PolicyError,
    DemonstrationError,
    ControllerError,
    RunError,
    WorkError,
    LearningError,
    RolloutError,
)
