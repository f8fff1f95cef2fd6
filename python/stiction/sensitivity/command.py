"""`stiction sensitivity SCENE.toml`: the influence of each number of a scene."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from .. import files
from ..scenes import named_files
from ..terminal import ended, given_words, real, whole
from .figure import draw
from .study import sensitivity

__all__ = ["main"]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction sensitivity",
        description="Find which number of a scene matters most: Sobol indices of pull-off, stiffness and energy over numbers that have "
        "priors, and the scatter between patches as a term of its own.",
        epilog="Example: stiction sensitivity configs/inference/sensitivity.toml. Leaves a file and a figure with its name. "
        "Exit codes: 0 done; 1 failed while running; 2 the command or the scene is wrong.",
    )
    parser.add_argument("scene", type=Path, metavar="SCENE", help="a scene with priors for up to 6 numbers")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.h5",
                        help="the file; by default the name of the scene with _sensitivity.h5, in this folder")  # fmt: skip
    parser.add_argument("--interval", type=real, default=0.1, metavar="X",
                        help="largest width of the 95 %% intervals of all indices: samples are doubled, from 64 on, until it is reached; by default 0.1")  # fmt: skip
    parser.add_argument("--samples", type=whole, metavar="N",
                        help="samples at most, a power of 2 from 64 on, of k + 2 points each (2k + 2 of correlated priors); by default the most of a sweep")  # fmt: skip
    parser.add_argument("--replicas", type=whole, metavar="N", help="patches at each point, instead of the scene's")
    parser.add_argument("--seed", type=whole, metavar="N", help="seed, instead of the scene's")
    parser.add_argument("--threads", type=whole, metavar="N", help="threads; by default one per core")
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, computes, writes file and figure, and says what matters; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(given_words(arguments))
    output = given.output or Path(f"{given.scene.stem}_sensitivity.h5")
    picture = output.with_suffix(".png")
    if output.suffix.lower() not in (".h5", ".nc"):
        parser.error(f"--output {output}: a name that ends with .h5 or .nc is needed")
    return ended("stiction sensitivity", lambda: _study(given, output, picture), is_long=True)


def _study(given: argparse.Namespace, output: Path, picture: Path) -> None:
    inputs = named_files(given.scene)
    for path in (output, picture):
        files.check(path, force=given.force, inputs=inputs)
    found = sensitivity(
        given.scene, output, interval=given.interval, samples=given.samples, replicas=given.replicas, seed=given.seed,
        threads=given.threads, force=given.force,
    )  # fmt: skip
    with files.writing(picture, force=given.force, inputs=inputs) as part:
        draw(found).savefig(part, dpi=200)
    print(found.attrs["summary"])
    print(f"{output}, {picture}")
