"""Options of the commands that read maps: how a map is read and levelled."""

from __future__ import annotations

import argparse
import contextlib
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..errors import StictionError
from ..terminal import whole
from .level import LEVELS, ROWS

__all__ = ["READING", "add", "as_options", "reading"]

#: Of each option its names, the name of its value, and what it does.
READING = [
    (("--pixel",), "DX[,DY]",
     'size of a pixel, such as "9.8 nm", or its width and height, "9.8 nm,10 nm"; by default what the '
     "file says"),
    (("--height-unit",), "UNIT", "unit of the heights, such as nm; by default what the file says"),
    (("--channel",), "NAME", "name, or number from 0, of the channel or dataset, where a file has several"),
    (("--factor",), "X", 'what numbers are multiplied by, or a length per count or volt, such as "12 nm/V"'),
    (("--mask",), "FILE", "a map in which all but 0 marks heights that are left out"),
    (("--level-rows",), "HOW",
     f"what is subtracted from each row before: {', '.join(ROWS)} (the sum of median steps between rows)"),
    (("--level",), "HOW", f"what is subtracted from the heights: {', '.join(LEVELS)}; by default plane"),
]  # fmt: skip
_KINDS: dict[str, Any] = {
    "--output": Path, "--mask": Path, "--figure": Path, "--cutoffs": whole,
    "--scene": Path, "--replicas": whole, "--seed": whole, "--threads": whole,
}  # fmt: skip


def add(parser: argparse.ArgumentParser, options: list[Any]) -> None:
    """Adds options to the parser of a command."""
    for names, value, words in options:
        parser.add_argument(*names, type=_KINDS.get(names[-1], str), metavar=value, help=words)
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")
    parser.set_defaults(level="plane")


def reading(given: argparse.Namespace) -> dict[str, Any]:
    """The arguments of `read_map` that options give."""
    return {name: getattr(given, name) for name in ("pixel", "height_unit", "channel", "factor", "mask")}


@contextlib.contextmanager
def as_options(given: argparse.Namespace) -> Iterator[None]:
    """Errors name options of the command where they named arguments."""
    # `ended` has its own words for force=True.
    names = "|".join(sorted(vars(given).keys() - {"force"}, key=len, reverse=True))
    try:
        yield
    except StictionError as error:
        said = re.sub(rf"(?<![\w-])({names}) ?= ?", lambda found: f"--{found[1].replace('_', '-')} ", str(error))
        raise type(error)(said, error.exit_code) from None
