"""`stiction plot FILE`: pictures of results of any kind."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..errors import FileError, StictionError
from ..results import Sweep, open_run
from .pages import page, panels
from .style import context, inches

__all__ = ["main"]

_ENDINGS = (".png", ".pdf", ".svg")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction plot",
        description="Draw results: of runs, sweeps, comparisons, patches of several sizes, asperities of maps.",
        epilog="Examples: stiction plot case_ii.h5; stiction plot case_ii.h5 --what force --width 85mm -o force.pdf; "
        "stiction plot sweep.h5 --x material.hardness --by surface.lubricant_thickness. "
        "Exit codes: 0 done; 1 a picture cannot be written; 2 the command or a file is wrong.",
    )
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help="results of stiction")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT",
                        help="the picture, .png, .pdf or .svg; by default the name of the file with .png, beside it")  # fmt: skip
    parser.add_argument(
        "--what",
        metavar="NAME[,NAME]",
        help="which figures; by default all that fit; `list` tells their names",
    )
    parser.add_argument(
        "--width",
        default=None,
        metavar="LENGTH",
        help="width, such as 85mm; by default 180mm, of a single figure 90mm",
    )
    parser.add_argument("--x", metavar="KEY", help="of a sweep: the key for the axis, or a number that follows from it, such as plasticity_index")
    parser.add_argument("--by", metavar="KEY", help="of a sweep: the key that curves are told by")
    parser.add_argument("--title", action="store_true", help="the title of the scene above")
    parser.add_argument(
        "--dpi", type=int, default=200, metavar="N", help="dots per inch of .png, by default 200"
    )
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, draws, and says where the pictures are; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(arguments)
    if given.output is not None:
        if len(given.files) > 1:
            parser.error("--output is for one file; without it each picture is beside its file")
        if given.output.suffix.lower() not in _ENDINGS:
            parser.error(f"--output {given.output}: a name that ends with {', '.join(_ENDINGS)} is needed")
    if not 10 <= given.dpi <= 2400:
        parser.error(f"--dpi {given.dpi}: a number from 10 to 2400 is needed")
    try:
        if given.width is not None:
            inches(given.width)
    except ValueError as error:
        parser.error(f"--{error}")
    for path in given.files:
        try:
            _draw(path, given)
        except (StictionError, OSError) as error:
            text = str(error)
            told = text if str(path) in text else f"{path}: {text}"
            print(f"stiction plot: {' '.join(told.split())}", file=sys.stderr)
            return 1 if isinstance(error, OSError) else 2
    return 0


def _draw(path: Path, given: argparse.Namespace) -> None:
    with open_run(path) as result:
        if given.what == "list":
            print("\n".join(panels(result)))
            return
        options: dict[str, Any] = {}
        for name in ("x", "by"):
            if getattr(given, name) is not None:
                if not isinstance(result, Sweep):
                    raise FileError(f"--{name}: this is no sweep, whose keys it names")
                options[name] = getattr(given, name)
        what = given.what.split(",") if given.what else None
        figure = page(result, given.width, what=what, title=given.title, **options)
        output = given.output or path.with_suffix(".png")
        with context():
            figure.savefig(output, dpi=given.dpi, metadata=_UNDATED.get(output.suffix.lower()))
    print(output)


# The same result gives the same bytes.
_UNDATED: dict[str, dict[str, Any]] = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
