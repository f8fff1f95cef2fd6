"""Progress: a bar on terminals and in notebooks, lines in logs."""

from __future__ import annotations

import contextlib
import contextvars
import sys
import threading
import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

__all__ = ["Bar", "of_command", "steps", "work"]

T = TypeVar("T")

# Seconds until the first line of a log, and at least and at most between lines: each interval is twice the one before.
_FIRST, _APART, _MOST = 10.0, 10.0, 60.0
# Seconds between times that a bar shows, and characters of its words; the words of the work around it are cut first.
_SHOWN, _WORDS = 1.0, 42


@dataclass
class _Log:
    """The lines of this process: their first word, whether a command writes them unasked, the seconds before the next
    one, and when that is due."""

    name: str = "stiction"
    is_command: bool = False
    apart: float | None = None
    due: float | None = None

    def wait(self) -> float:
        """Seconds until the next line."""
        if self.apart is None:
            self.apart = _FIRST
        if self.due is None:
            self.due = time.monotonic() + self.apart
        return max(self.due - time.monotonic(), 0.0)

    def write(self, text: str) -> None:
        self.apart = min(max(2.0 * (self.apart or 0.0), _APART), _MOST)
        self.due = time.monotonic() + self.apart
        # Nobody may be there to read it.
        with contextlib.suppress(OSError, ValueError, AttributeError):
            print(f"{self.name}: {text}", file=sys.stderr, flush=True)


_log = _Log()
# Whether bars are shown of the work at hand, and its words.
_around: contextvars.ContextVar[tuple[bool | None, str]] = contextvars.ContextVar("around", default=(None, ""))


def of_command(name: str, first: float | None = None) -> None:
    """Begins the command of a name, such as ``stiction infer``: where there is no terminal its progress is lines, the
    first one after some seconds."""
    global _log
    _log = _Log(name, is_command=True, apart=first)


@contextlib.contextmanager
def work(words: str = "", progress: bool | None = None) -> Iterator[None]:
    """Work whose bars have its words before their own.

    Parameters
    ----------
    words : str
        Such as ``batch 2``; none of their own.
    progress : bool, optional
        Whether its bars are shown, as in `Bar`; None: as the work around it shows its own.
    """
    shown, before = _around.get()
    token = _around.set((shown if progress is None else progress, ": ".join(part for part in (before, words) if part)))
    try:
        yield
    finally:
        _around.reset(token)


class Bar:
    """How much of some work is done, and since when; on leaving a `with` statement it goes.

    Parameters
    ----------
    words : str
        What is done.
    total, unit : int and str, optional
        Steps in all, and what they are; without them only the time is shown.
    done : float
        Steps that are done.
    progress : bool, optional
        Whether it is shown: as a bar on terminals and in notebooks, else as lines. None: as the work around says,
        and without that on terminals, in notebooks, and as lines of commands.
    at_most : bool
        Whether fewer steps may do: then nothing is said of the time that is left.
    expected : float, optional
        Seconds that all steps are expected to take, for the time that is left until the first of them is done.
    """

    def __init__(
        self, words: str, total: int | None = None, unit: str = "", *, done: float = 0, progress: bool | None = None,
        at_most: bool = False, expected: float = 0.0,
    ) -> None:  # fmt: skip
        shown, before = _around.get()
        shown = shown if progress is None else progress
        self._words = ": ".join(part for part in (before, words) if part)
        self._total, self._unit, self._at_most, self._expected = total, unit, at_most, expected
        self.done = self._before = done
        self._begun = time.monotonic()
        self._bar: Any = None
        self._end = threading.Event()
        self._thread: threading.Thread | None = None
        has_bars = (sys.stderr is not None and sys.stderr.isatty()) or "ipykernel" in sys.modules
        if shown is not False and has_bars:
            self._bar = self._drawn()
        elif shown is False or (shown is None and not _log.is_command):
            return
        self._thread = threading.Thread(target=self._tell, daemon=True)
        self._thread.start()

    def __enter__(self) -> Bar:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def to(self, done: float) -> None:
        """Shows the number of steps that are done."""
        self.done = done
        if self._bar is not None:
            self._bar.bar_format = self._form()
            self._bar.update(done - self._bar.n)

    def close(self) -> None:
        """Takes the bar away."""
        self._end.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        if self._bar is not None:
            self._bar.close()
            self._bar = None

    def _drawn(self) -> Any:
        with warnings.catch_warnings():
            # Without ipywidgets a notebook has bars of text.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
        words = self._words
        while len(words) > _WORDS and ": " in words:
            words = words.partition(": ")[2]
        return tqdm(
            desc=words, total=self._total, initial=self.done, bar_format=self._form(), miniters=0, smoothing=0.0,
            dynamic_ncols=True, leave=False,
        )  # fmt: skip

    def _form(self) -> str:
        words = "{desc}: " if self._words else ""
        if self._total is None:
            return words + "{elapsed}"
        left = "" if self._at_most else f", {self._first_left() or '{remaining}'} left"
        return f"{words}{{bar}} {self._count()}, {{elapsed}}{left}"

    def _count(self) -> str:
        return f"{int(self.done)} of {'at most ' if self._at_most else ''}{self._total} {self._unit}"

    def _first_left(self) -> str:
        """The time that is left before any step is done, if it is known."""
        left = self._begun + self._expected - time.monotonic()
        return f"about {_lasting(left)}" if self.done == self._before and left > 0.0 else ""

    def _line(self) -> str:
        past, own = time.monotonic() - self._begun, self.done - self._before
        parts = [self._count()] if self._total is not None else []
        parts.append(f"{_lasting(past)} so far")
        if self._total is not None and not self._at_most and own > 0:
            parts.append(f"about {_lasting(past * (self._total - self.done) / own)} left")
        elif first := self._first_left():
            parts.append(f"{first} left")
        return ": ".join(part for part in (self._words, ", ".join(parts)) if part)

    def _tell(self) -> None:
        """Shows the time, in a thread: the work itself may be long silent."""
        while not self._end.wait(_SHOWN if self._bar is not None else _log.wait()):
            if self._bar is not None:
                self._bar.bar_format = self._form()
                self._bar.refresh()
            else:
                _log.write(self._line())


def steps(of: Sequence[T], words: str, unit: str, progress: bool | None = None) -> Iterator[T]:
    """The elements of a sequence, with their progress."""
    with Bar(words, len(of), unit, progress=progress) as bar:
        for done, one in enumerate(of):
            yield one
            bar.to(done + 1)


def _lasting(seconds: float) -> str:
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5970.0 else f"{seconds / 3600.0:.1f} h"
