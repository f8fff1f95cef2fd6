"""`stiction asperities MAP`: from a measured height map to its asperities."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from ..errors import SceneError
from ..progress import Bar
from ..terminal import ended, given_words
from .figure import draw
from .file import write
from .moments import line_scan
from .options import READING, add, as_options, reading
from .reading import read_map
from .summary import of_line, summary
from .surface import check_outputs, found_on, steps_of

__all__ = ["main"]

_EPILOG = """Examples: stiction asperities configs/maps/polished.txt -o polished.h5; stiction asperities
scan.npy --pixel "9.8 nm" --height-unit nm. Exit codes: 0 done; 1 failed while running; 2 the command or the
map is wrong."""

# Of each option its names, the name of its value, and what it does.
_HELP = [
    (("-o", "--output"), "FILE.h5", "where the result goes; by default there is only the summary"),
    *READING,
    (("--smooth",), "WAVELENGTH",
     'smooth the levelled map: a cut-off wavelength, such as "200 nm", below which an areal Gaussian filter '
     "takes waves away (ISO 16610-61)"),
    (("--prominence",), "HEIGHT",
     "count only summits that are so high above the saddle on the way to higher ground, such as \"0.5 nm\""),
    (("--min-distance",), "LENGTH",
     'count only summits with no higher one nearer than that, such as "100 nm"'),
    (("--cutoffs",), "N",
     "report density, radius and scatter of the summits over N cut-offs too, from 2 pixels to a quarter of "
     "the map's side"),
    (("--figure",), "OUT", "a picture, .png, .pdf or .svg, of the map with its summits after each step"),
]  # fmt: skip


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction asperities",
        description="Find the asperities of a measured surface: a summary, and one HDF5 file if asked for. Of a "
        "line scan the spectral moments.",
        epilog=_EPILOG,
    )
    of_map = "the height map: a text, NPY, HDF5, netCDF; with `pip install "
    parser.add_argument(
        "map", type=Path, metavar="MAP", help=f"{of_map}stiction[maps]` TIFF and files of instruments"
    )
    add(parser, _HELP)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, finds the asperities and prints the summary; returns the exit code."""
    given = _parser().parse_args(given_words(arguments))

    def work() -> None:
        with as_options(given):
            _asperities(given)

    return ended("stiction asperities", work)


def _refuse_options_of_maps(given: argparse.Namespace) -> None:
    """A line scan has no asperities to write, and takes no step of maps."""
    names = ("output", "mask", "level_rows", "smooth", "prominence", "min_distance", "cutoffs", "figure")
    asked = [name for name in names if getattr(given, name) is not None]
    if given.level != "plane":
        asked.append("level")
    if asked:
        options = ", ".join(f"--{name.replace('_', '-')}" for name in asked)
        raise SceneError(
            f"{options}: {given.map} is a line scan, which has a spectrum, but no asperities; leave it out"
        )


def _asperities(given: argparse.Namespace) -> None:
    steps = steps_of(
        given.level, given.level_rows, smooth=given.smooth, prominence=given.prominence,
        min_distance=given.min_distance, cutoffs=given.cutoffs,
    )  # fmt: skip
    check_outputs(given.output, given.figure, force=given.force, inputs=[given.map])
    with Bar("map"):
        height_map = read_map(given.map, lines=True, **reading(given))
    if height_map.is_line:
        _refuse_options_of_maps(given)
        print(of_line(line_scan(height_map, str(given.map)), given.map))
        return
    with Bar("asperities"):
        surface = found_on(height_map, steps, str(given.map), keep=given.figure is not None)
    if given.output is not None:
        write(given.output, surface, given.height_unit or "", force=given.force, inputs=[given.map])
    if given.figure is not None:
        with Bar("figure"):
            draw(given.figure, surface, force=given.force, inputs=[given.map])
    print(summary(surface, given.map, given.output))
