"""Messages and exit codes of the commands of the package."""

from __future__ import annotations

import argparse
import codecs
import contextlib
import io
import os
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence

from . import progress
from .errors import StictionError

__all__ = ["ended", "given_words", "real", "whole"]

# The exit code of a command that was interrupted.
_INTERRUPTED = 130
# What is printed for characters that an output has not, as GBK has no micro sign; for others a question mark.
_PLAIN = {"\u00b5": "u", "\u2212": "-", "\u2013": "-", "\u00d7": "x", "\u03b1": "a", "\u03c3": "s"}


def _plain(error: UnicodeError) -> tuple[str, int]:
    assert isinstance(error, UnicodeEncodeError)
    return "".join(_PLAIN.get(one, "?") for one in error.object[error.start : error.end]), error.end


codecs.register_error("stiction", _plain)


def given_words(arguments: Sequence[str] | None) -> list[str]:
    """The words of a command line for argparse, which takes a quantity below 0, such as ``-5 nm``, for an option."""
    words: list[str] = []
    for word in sys.argv[1:] if arguments is None else arguments:
        if words and re.fullmatch(r"--[a-z-]+", words[-1]) and re.match(r"-\.?[0-9]", word):
            words[-1] += f"={word}"
        else:
            words.append(word)
    return words


def whole(text: str) -> int:
    """A whole number of a command line."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: a whole number is needed") from None


def real(text: str) -> float:
    """A number of a command line."""
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: a number without a unit is needed") from None


def ended(name: str, work: Callable[[], None], *, is_long: bool = False) -> int:
    """Does the work of a command, says in a line on standard error what went wrong; returns the exit code.

    Parameters
    ----------
    name : str
        The command, such as ``stiction plot``.
    work : callable
        Prints its results; they are lost to nobody unless an error says so.
    is_long : bool
        Whether it takes minutes: then logs have the first line of progress at once.
    """
    progress.of_command(name, 1.0 if is_long else None)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors != "surrogateescape":
            stream.reconfigure(errors="stiction")
    try:
        if sys.stdout is None:
            raise OSError("standard output is closed")
        with _interrupted_by_signals():
            work()
            sys.stdout.flush()
        return 0
    except BrokenPipeError:
        # Nobody reads it any more.
        _silence()
        return 0
    except StictionError as error:
        code, said = error.exit_code, str(error)
    except KeyboardInterrupt as interruption:
        code, said = _INTERRUPTED, str(interruption) or "interrupted"
    except MemoryError:
        code, said = 1, "not enough memory"
    except OSError as error:
        # Files are named in their errors.
        is_of_output = error.errno is not None and error.filename is None
        code, said = 1, f"cannot write to standard output: {error}" if is_of_output else str(error)
        _silence()
    line = " ".join(said.replace("force=True", "--force").replace("resume=True", "--resume").split())
    if sys.stderr is not None:
        print(f"{name}: {''.join(one if one.isprintable() else '�' for one in line)}", file=sys.stderr)
    return code


@contextlib.contextmanager
def _interrupted_by_signals() -> Iterator[None]:
    """SIGTERM and SIGHUP interrupt as Ctrl-C does, unless they are ignored: temporary folders are then deleted."""
    named = [signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])]
    is_main = threading.current_thread() is threading.main_thread()
    taken = [one for one in named if is_main and signal.getsignal(one) == signal.SIG_DFL]
    for one in taken:
        signal.signal(one, signal.default_int_handler)
    try:
        yield
    finally:
        for one in taken:
            signal.signal(one, signal.SIG_DFL)


def _silence() -> None:
    """Leaves nothing to write to a standard output that fails: Python would try it once more at its end."""
    try:
        sys.stdout.flush()
    except (OSError, AttributeError):
        if sys.stdout is not None:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
