"""Progress: a bar on terminals and in notebooks, a line a minute in the logs of commands."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from typing import Any, TypeVar

__all__ = ["Bar", "of_command", "steps"]

T = TypeVar("T")

# Seconds between the lines of a log.
_APART = 60.0
# The command that runs, whose logs have lines.
_command = ""


def of_command(name: str) -> None:
    """Begins the command of a name, such as ``stiction infer``."""
    global _command
    _command = name


class Bar:
    """How much of some work is done.

    Parameters
    ----------
    total, done : int
        Steps in all, and those that are done.
    words, unit : str
        What is done, and what it is counted in.
    progress : bool, optional
        Whether it is shown as a bar; None: on terminals and in notebooks, and in logs of commands as lines.
    is_all : bool
        Whether it is all of the work: else nothing is said of the time that is left.
    """

    def __init__(
        self, total: int, words: str, unit: str, *, done: int = 0, progress: bool | None = None, is_all: bool = True
    ) -> None:
        self._is_all = is_all
        self.total, self.done, self._words = total, done, f"{words}: " if words else ""
        self._unit, self._first, self._begun = unit, done, time.monotonic()
        self._next = self._begun + _APART
        self._bar: Any = None
        shown = (sys.stderr.isatty() or "ipykernel" in sys.modules) if progress is None else progress
        self._is_log = progress is None and not shown and _command != ""
        if shown:
            from tqdm.auto import tqdm

            self._bar = tqdm(total=total, initial=done, desc=words, unit=f" {unit}", leave=False)

    def to(self, done: int) -> None:
        """Shows the number of steps that are done."""
        if self._bar is not None:
            self._bar.update(done - self.done)
        self.done = done
        now = time.monotonic()
        if self._is_log and now >= self._next and done > self._first:
            self._next = now + _APART
            past = now - self._begun
            left = f", about {_lasting(past * (self.total - done) / (done - self._first))} left" if self._is_all else ""
            print(
                f"{_command}: {self._words}{done} of {self.total} {self._unit}, {_lasting(past)} so far{left}",
                file=sys.stderr, flush=True,
            )  # fmt: skip

    def close(self) -> None:
        """Takes the bar away."""
        if self._bar is not None:
            self._bar.close()


def steps(of: Sequence[T], words: str, unit: str, progress: bool | None = None, *, is_all: bool = True) -> Iterator[T]:
    """The elements of a sequence, with their progress."""
    bar = Bar(len(of), words, unit, progress=progress, is_all=is_all)
    try:
        for done, one in enumerate(of):
            yield one
            bar.to(done + 1)
    finally:
        bar.close()


def _lasting(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 99.5 else f"{seconds / 60.0:.0f} min"
