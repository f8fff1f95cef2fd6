"""`stiction plot FILE`: pictures of results of any kind."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence
from pathlib import Path

from .. import files, stored
from ..errors import FileError
from ..opened import open_run
from ..results import Finding
from ..terminal import ended
from .pages import OF_RUNS, OF_SWEEPS, of_replica, page, panels
from .style import inches, picture

__all__ = ["main"]

_ENDINGS = (".png", ".pdf", ".svg")
_OPTIONS = sorted({*OF_SWEEPS, *(name for names in OF_RUNS.values() for name in names)})


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction plot",
        description="Draw results: of runs, sweeps, patches of several sizes, asperities of maps, inferences, sensitivities, searches.",
        epilog="Examples: stiction plot case_ii.h5; stiction plot case_ii.h5 --what force --width 85mm -o force.pdf; "
        "stiction plot sweep.h5 --x material.hardness --by surface.lubricant_thickness. "
        "Exit codes: 0 done; 1 a picture cannot be written; 2 the command or a file is wrong.",
    )
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help="results of stiction")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT",
                        help="the picture, .png, .pdf or .svg; by default next to the file, with .png")  # fmt: skip
    parser.add_argument(
        "--what",
        metavar="NAME[,NAME]",
        help="which figures; by default all that fit, but none of a single replica; `list` prints their names",
    )
    parser.add_argument(
        "--width",
        default=None,
        metavar="LENGTH",
        help="width, such as 85mm; by default 180mm, for a single figure 90mm",
    )
    parser.add_argument("--x", metavar="KEY", help="for a sweep: the key for the axis, or a number that follows from it, such as asperity_plasticity_index")
    parser.add_argument("--by", metavar="KEY", help="for a sweep: the key that distinguishes the curves")
    parser.add_argument("--replica", type=int, metavar="N", help="for force_curve: the replica, by default 0")
    parser.add_argument("--stiffness", metavar="K", help="for force_curve: of the cantilever, such as '40 N/m'; by default the scene's spring")
    parser.add_argument("--preload", metavar="FORCE", help="for sweeps, pull_off and force_curve: the preload of the scene after which the surfaces retract; by default the largest that is reached")
    parser.add_argument("--title", action="store_true", help="the title of the scene above")
    parser.add_argument(
        "--dpi", type=int, default=200, metavar="N", help="dots per inch of .png, by default 200"
    )
    parser.add_argument("--force", action="store_true", help="overwrite pictures that are there")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, draws, and says where the pictures are; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(arguments)
    if given.output is not None:
        if len(given.files) > 1:
            parser.error("--output is for one file; without it each picture is next to its file")
        if given.output.suffix.lower() not in _ENDINGS:
            parser.error(f"--output {given.output}: a name that ends with {', '.join(_ENDINGS)} is needed")
    if not 10 <= given.dpi <= 2400:
        parser.error(f"--dpi {given.dpi}: a number from 10 to 2400 is needed")
    try:
        if given.width is not None:
            inches(given.width)
    except ValueError as error:
        parser.error(f"--{error}")
    return ended("stiction plot", lambda: _draw_all(given))


def _draw_all(given: argparse.Namespace) -> None:
    outputs = [given.output or path.parent / f"{path.stem}.png" for path in given.files]
    if given.what != "list":
        for output in outputs:
            if outputs.count(output) > 1:
                raise FileError(f"{output} would be written twice: draw the files one by one, with --output")
            files.check(output, force=given.force, inputs=given.files)
    for path, output in zip(given.files, outputs, strict=True):
        stored.try_first(path)
        # A damaged file ends the command with one line.
        with stored.reading(path), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            drawn = _drawn(path, output.suffix.lower(), given)
        if given.what == "list":
            print(drawn.decode())
            continue
        with files.writing(output, force=given.force, inputs=given.files) as part:
            part.write_bytes(drawn)
        print(output)


def _drawn(path: Path, ending: str, given: argparse.Namespace) -> bytes:
    """A picture of a result, or the names of its figures."""
    with open_run(path) as result:
        if isinstance(result, Finding):
            if given.what is not None or any(getattr(given, name) is not None for name in _OPTIONS):
                raise FileError(f"{path}: a result of `{result.format.made_by}` has one figure; leave out --what and {', '.join(f'--{name}' for name in _OPTIONS)}")
            return picture(page(result, given.width), ending, given.dpi)
        if given.what == "list":
            return "\n".join(panels(result) | of_replica(result)).encode()
        what = given.what.split(",") if given.what else None
        options = {name: value for name in _OPTIONS if (value := getattr(given, name)) is not None}
        drawn = page(result, given.width, what=what, title=given.title, **options)
        return picture(drawn, ending, given.dpi)
