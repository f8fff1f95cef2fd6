"""`stiction force-curves PATH`: a table of the pull-offs of recorded force curves."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from .. import files
from ..quantities import counted
from ..terminal import ended, given_words
from .recorded import SLOPES, listed, pull_offs, remarks, written

__all__ = ["main"]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction force-curves",
        description="Read the force curves of an AFM and write the pull-off force of each as CSV, for stiction "
        "infer. afmformats reads the files. The pull-off is measured from the baseline of the retraction. Where "
        "noise hides it, the table has an upper limit, such as <0.5. A curve without baseline and a file that "
        "cannot be read have an empty cell and a remark with the reason.",
        epilog="Examples: stiction force-curves spots -o pull_offs.csv; stiction force-curves map.jpk-force-map "
        "--slope drift. Exit codes: 0 done; 1 failed while running; 2 the command or a file is wrong, or no curve "
        "gives a number.",
    )
    parser.add_argument("path", type=Path, metavar="PATH", help="a file of force curves, or a folder of such")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="OUT.csv", help="the table; by default it is printed"
    )
    parser.add_argument(
        "--slope",
        choices=SLOPES,
        default="shift",
        help="what the slope of the baseline follows: the height over the surface (shift), the time (drift), or "
        "nothing (none); by default shift. Approach and retraction that disagree get a remark",
    )
    parser.add_argument(
        "--spring-constant",
        metavar="K",
        help="of the cantilever, such as '40 N/m', for files that do not say it",
    )
    parser.add_argument("--force", action="store_true", help="overwrite a table that is there")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line and the curves, and writes the table; returns the exit code."""
    given = _parser().parse_args(given_words(arguments))
    return ended("stiction force-curves", lambda: _table(given))


def _table(given: argparse.Namespace) -> None:
    if given.output is not None:
        files.check(given.output, force=given.force, inputs=[given.path])
    found = pull_offs(given.path, slope=given.slope, spring_constant=given.spring_constant)
    left_out = [one.name for one in found.attrs["left_out"]]
    if left_out:
        print(f"left out, as no force curves: {listed(left_out)}", file=sys.stderr)
    for remark in remarks(found):
        print(remark, file=sys.stderr)
    text = written(found)
    if given.output is None:
        print(text, end="")
        return
    read = [given.path / one if given.path.is_dir() else given.path for one in found["file"].unique()]
    with files.writing(given.output, force=given.force, inputs=read) as part:
        part.write_text(text, encoding="utf-8")
    seen = int((found["pull_off_force"] > found["resolution"]).sum())
    print(f"{counted(len(found), 'curve')} of {counted(found['file'].nunique(), 'file')}, {seen} with a pull-off\n{given.output}")
