"""The program as a process: where it is, how it is called, its progress, errors and interruption."""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import sysconfig
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from . import child
from .errors import SceneError, StictionError
from .progress import Bar

__all__ = ["call", "find"]

# The exit code of a run that was interrupted.
_INTERRUPTED = 130
# Options that messages tell to give, as Python has them.
_ARGUMENTS = {"--force": "force=True", "--resume": "resume=True", "another name with -o": "another output"}


def find() -> str:
    """The path of the program.

    The environment variable ``STICTION`` names it; without it, it is next to this Python, where the wheel
    puts it, or on the PATH.

    Raises
    ------
    StictionError
        It is in none of these places.
    """
    named = os.environ.get("STICTION")
    if named:
        found = shutil.which(named)
        if found is None:
            raise StictionError(f"STICTION = {named}: no such program")
        return found
    folders = [sysconfig.get_path("scripts"), str(Path(sys.executable).parent)]
    user = sysconfig.get_path("scripts", sysconfig.get_preferred_scheme("user"))
    # Folders by their whole names: the one at hand may be anybody's.
    searched = [folder for folder in os.get_exec_path() if os.path.isabs(folder)]
    for folder in [*folders, user, *searched]:
        found = child.in_folder(folder)
        if found is not None:
            return found
    raise StictionError(
        f"the program stiction is neither in {folders[0]} nor on the PATH: `pip install stiction` has it, "
        "or name it in the environment variable STICTION"
    )


def call(arguments: Sequence[str], *, text: str = "", progress: bool | None = False) -> str:
    """Calls the program and returns what it prints.

    Parameters
    ----------
    arguments : sequence of str
        The words behind `stiction` on the command line.
    text : str
        Standard input.
    progress : bool, optional
        Whether progress is shown, for commands that compute, as in `progress.Bar`.

    Raises
    ------
    SceneError
        The command or the scene is wrong (exit code 2).
    StictionError
        It failed (exit codes 1 and 3), or is not there.
    KeyboardInterrupt
        It was interrupted, here or by a signal of its own; what was done is kept where it keeps it.
    """
    for argument in arguments:
        _check_text(argument)
    with (
        tempfile.TemporaryFile("w+", encoding="utf-8") as given,
        tempfile.TemporaryFile("w+", encoding="utf-8") as out,
    ):
        given.write(text)
        given.seek(0)
        process = child.begun([find(), *arguments], given, out)
        said = child.lines(process)
        lines: list[str] = []
        try:
            _read(said, lines, _Bars(progress))
            code = process.wait()
        except BaseException as stop:
            child.interrupt(process)
            try:
                _read(said, lines, _Bars(progress=False))
                process.wait()
            except KeyboardInterrupt:
                process.kill()
                process.wait()
            if not isinstance(stop, KeyboardInterrupt):
                raise
            raise KeyboardInterrupt(_message(lines)) from None
        finally:
            assert process.stderr is not None
            process.stderr.close()
        out.seek(0)
        printed = out.read()
    if code == 0:
        return printed
    message = _message(lines) or f"{' '.join(arguments[:1])}: the program ended with code {code}"
    if code == _INTERRUPTED:
        raise KeyboardInterrupt(message)
    raise (SceneError if code == 2 else StictionError)(message, code)


def _check_text(argument: str) -> None:
    """Refuses an argument that no program can be given."""
    try:
        fits = b"\0" not in os.fsencode(argument)
    except UnicodeEncodeError:
        fits = False
    if not fits:
        raise SceneError(f"{argument[:100]!r}: a text cannot have the character NUL, nor half of a surrogate pair")


def _message(lines: Sequence[str]) -> str:
    """The message of an error, without commands to give, and with options as Python has them."""
    text = re.split(r"\n\n(?:Usage:|For more information)|; to go on:\n", "\n".join(lines).strip())[0]
    for option, argument in _ARGUMENTS.items():
        text = text.replace(option, argument)
    text = re.sub(r"(?<!\S)--set (?=\S)", "", text)
    # Tables are handed over like this; nobody has seen their lines.
    text = re.sub(r"standard input: (line \d+: )?", "", text)
    text = re.sub(r"(?<![\w-])--([a-z][a-z-]*)", lambda found: found[1].replace("-", "_"), text)
    text = re.sub(r"invalid value '(.*?)' for '(\w+) <\w+>': (.*)", r"\2 = \1: \3", text)
    text = re.sub(r"(?<=: )\S+ is not in (\d+)\.\.=(\d+)", r"a whole number from \1 to \2 is needed", text)
    return text.removeprefix("stiction: ").removeprefix("error: ")


def _read(lines: Iterable[str], kept: list[str], bars: _Bars) -> None:
    """Reads standard error to its end: progress is shown, the rest kept."""
    try:
        for line in lines:
            if line.startswith("{"):
                bars.show(json.loads(line))
            else:
                kept.append(line.rstrip("\n"))
    finally:
        bars.close()


class _Bars:
    """The bar of the phase at hand; of a sweep, one of all its points."""

    def __init__(self, progress: bool | None) -> None:
        self.progress = progress
        self.bar: Bar | None = None
        self.phase = ""

    def show(self, event: dict[str, Any]) -> None:
        point = re.fullmatch(r"point (\d+) of (\d+)", event["run"])
        done, total = event["done"], event["total"]
        if point is None:
            if self.bar is None or self.phase != event["phase"]:
                self._begin(event["phase"], total, "replicas", done or 0)
            if self.bar is not None and total is not None:
                self.bar.to(done)
            return
        before = int(point[1]) - 1
        if self.bar is None:
            self._begin("", int(point[2]), "points", before)
        # A point ends where the next one begins: its last phases have no count.
        share = done / total if event["phase"] == "ensemble" and total else 0.0
        if self.bar is not None:
            self.bar.to(max(self.bar.done, before + min(share, 0.99)))

    def _begin(self, phase: str, total: int | None, unit: str, done: int) -> None:
        self.close()
        self.phase, self.bar = phase, Bar(phase, total, unit, done=done, progress=self.progress)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()
        self.bar = None


def options(**named: Any) -> Iterable[str]:
    """Options of the command line from keyword arguments: None and False are left out, True has no value."""
    for name, value in named.items():
        if value is None or value is False:
            continue
        option = f"--{name.replace('_', '-')}"
        # In one, as a negative number by itself would be read as an option.
        yield option if value is True else f"{option}={value}"
