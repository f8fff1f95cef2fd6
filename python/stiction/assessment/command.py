"""`stiction map FILE`: one answer from a map."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from .. import files
from ..maps.options import READING, add, as_options, reading
from ..maps.surface import check_outputs
from ..scenes import setting
from ..terminal import ended, given_words
from .assess import assess_map

__all__ = ["main"]

_EPILOG = """Examples: stiction map configs/maps/polished.txt --above "3 uN"; stiction map scan.npy --pixel "9.8 nm"
--height-unit nm --scene MY.toml --area "100 um^2"; stiction map 1um.spm 10um.spm 90um.spm --tip "10 nm". Exit codes: 0 done, whatever
the assessment; 1 failed while running; 2 the command, a map or the scene is wrong."""

_HELP = [
    (("--area",), "AREA", 'nominal area, such as "100 um^2"; by default that of the largest map'),
    (("--above",), "FORCE", 'also the probability that the pull-off exceeds a force, such as "100 nN"'),
    (("--scene",), "SCENE.toml",
     "material, model, history and preload, of a scene whose surface is replaced; by default of the template measured-map"),
    (("--tip",), "RADIUS", 'radius of the tip, such as "10 nm": waves that it does not resolve are left out'),
    (("--smooth",), "WAVELENGTH", 'the smaller of both cut-offs, such as "100 nm", in place of the one that is chosen'),
    *READING,
    (("--replicas",), "N", "patches for each cut-off; by default 200"),
    (("--seed",), "N", "seed, instead of the scene's"),
    (("--threads",), "N", "threads; by default one per core"),
    (("-o", "--output"), "FILE.h5", "where the answer goes, for `stiction plot`, `info` and `report`; by default it is only printed"),
    (("--figure",), "OUT", "a picture, .png, .pdf or .svg, of map, spectrum, pull-offs and probability over force"),
]  # fmt: skip


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction map",
        description="Find the pull-off of patches of a measured surface with two cut-offs, and assess how far it can be trusted. Scans of "
        "several sizes are combined, each where it is reliable.",
        epilog=_EPILOG,
    )
    parser.add_argument(
        "maps",
        type=Path,
        nargs="+",
        metavar="MAP",
        help="a height map, as of `stiction asperities`, or several scans of one surface, with `--pixel \"4 nm; 20 nm\"` in their order",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="set a key of the scene; may be given several times",
    )
    add(parser, _HELP)
    parser.add_argument("--quiet", action="store_true", help="no progress")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, computes and prints the answer; returns the exit code."""
    given = _parser().parse_args(given_words(arguments))

    def work() -> None:
        with as_options(given):
            _map(given)

    return ended("stiction map", work, is_long=True)


def _map(given: argparse.Namespace) -> None:
    check_outputs(given.output, given.figure, force=given.force, inputs=given.maps)
    options = {
        name: getattr(given, name)
        for name in ("area", "above", "tip", "smooth", "level", "level_rows", "seed", "threads", "force")
    }
    if given.pixel is not None and ";" in given.pixel:
        given.pixel = [one.strip() for one in given.pixel.split(";")]
    if given.replicas is not None:
        options["replicas"] = given.replicas
    found = assess_map(
        given.maps, given.scene, output=given.output, progress=False if given.quiet else None,
        **options, **reading(given), **dict(setting(text) for text in given.set),
    )  # fmt: skip
    print(found.words)
    if given.figure is not None:
        from ..plot.style import picture
        from .figure import draw

        drawn = picture(draw(found.tree.to_dataset()), Path(given.figure).suffix)
        with files.writing(given.figure, force=given.force, inputs=given.maps) as part:
            part.write_bytes(drawn)
    for path in (given.output, given.figure):
        if path is not None:
            print(f"  {'written':<18}{path}")
