"""`stiction asperities MAP`: from a measured height map to its asperities."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path

from ..errors import StictionError
from ..terminal import ended
from .figure import draw
from .file import write
from .find import check_outputs, found_on, steps_of
from .level import LEVELS, ROWS
from .reading import read_map
from .summary import summary

__all__ = ["main"]

# Options that messages name as arguments.
_OPTIONS = ("pixel", "height_unit", "dataset", "factor", "level_rows", "level", "smooth", "prominence", "min_distance", "cutoffs", "figure")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction asperities",
        description="Find the asperities of a measured surface: a summary, and one HDF5 file if asked for.",
        epilog='Examples: stiction asperities configs/maps/polished.txt -o polished.h5; stiction asperities scan.npy --pixel "9.8 nm" '
        "--height-unit nm. Exit codes: 0 done; 1 failed while running; 2 the command or the map is wrong.",
    )
    add = parser.add_argument
    add("map", type=Path, metavar="MAP", help="the height map: a text with a row of the map on each line, NPY, HDF5; with `pip "
        "install stiction[maps]` the files of instruments")  # fmt: skip
    add("-o", "--output", type=Path, metavar="FILE.h5", help="where the result goes; by default there is only the summary")
    add("--pixel", metavar="DX[,DY]", help='size of a pixel, such as "9.8 nm", or its width and height, "9.8 nm,10 nm"; by default '
        "what the file says")  # fmt: skip
    add("--height-unit", metavar="UNIT", help="unit of the heights, such as nm; by default what the file says")
    add("--dataset", metavar="NAME", help="which dataset of an HDF5 file, or channel of an instrument's, is the map")
    add("--factor", metavar="X", help='what the numbers are multiplied by, or a length per count or volt, such as "12 nm/V"')
    add("--mask", type=Path, metavar="FILE", help="a map in which all but 0 marks heights that are left out")
    add("--level-rows", metavar="HOW", help=f"what is subtracted from each row before: {', '.join(ROWS)} (from row to row)")
    add("--level", default="plane", metavar="HOW", help=f"what is subtracted from the heights: {', '.join(LEVELS)}; by default plane")
    add("--smooth", metavar="WAVELENGTH", help='smooth the levelled map: a cut-off wavelength, such as "200 nm", below which an areal '
        "Gaussian filter takes waves away (ISO 16610-61)")  # fmt: skip
    add("--prominence", metavar="HEIGHT", help="count only summits that are so high above the saddle on the way to higher ground, such "
        'as "0.5 nm"')  # fmt: skip
    add("--min-distance", metavar="LENGTH", help='count only summits with no higher one nearer than that, such as "100 nm"')
    add("--cutoffs", type=int, metavar="N", help="report density, radius and scatter of the summits over N cut-offs too, from 2 pixels "
        "to a quarter of the map's side")  # fmt: skip
    add("--figure", type=Path, metavar="OUT", help="a picture, .png, .pdf or .svg, of the map with its summits after each step")
    add("--force", action="store_true", help="overwrite files that are there")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, finds the asperities and prints the summary; returns the exit code."""
    given = _parser().parse_args(arguments)

    def work() -> None:
        try:
            _asperities(given)
        except StictionError as error:
            raise type(error)(_as_options(str(error)), error.exit_code) from None

    return ended("stiction asperities", work)


def _as_options(message: str) -> str:
    """A message with the arguments that it names as options."""
    options = rf"(?<![\w-])({'|'.join(_OPTIONS)}) ?= ?"
    return re.sub(options, lambda found: f"--{found[1].replace('_', '-')} ", message)


def _asperities(given: argparse.Namespace) -> None:
    steps = steps_of(
        given.level, given.level_rows, smooth=given.smooth, prominence=given.prominence,
        min_distance=given.min_distance, cutoffs=given.cutoffs,
    )  # fmt: skip
    check_outputs(given.output, given.figure, force=given.force, inputs=[given.map])
    height_map = read_map(
        given.map, pixel=given.pixel, height_unit=given.height_unit, channel=given.dataset, factor=given.factor,
        mask=given.mask,
    )  # fmt: skip
    surface = found_on(height_map, steps, str(given.map), keep=given.figure is not None)
    if given.output is not None:
        write(given.output, surface, given.height_unit or "", force=given.force, inputs=[given.map])
    if given.figure is not None:
        draw(given.figure, surface, force=given.force, inputs=[given.map])
    print(summary(surface, given.map, given.output))
