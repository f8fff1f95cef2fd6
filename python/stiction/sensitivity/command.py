"""`stiction sensitivity SCENE.toml`: the influence of each number of a scene."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray

from .. import files, quantities
from ..scenes import named_files
from ..terminal import ended
from .figure import draw
from .study import QUANTITIES, sensitivity

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
    parser.add_argument("--samples", type=int, default=512, metavar="N",
                        help="rows of the design, a power of 2 from 128 on; N (k + 2) points of k keys; by default 512")  # fmt: skip
    parser.add_argument("--replicas", type=int, metavar="N", help="patches at each point, instead of the scene's")
    parser.add_argument("--seed", type=int, metavar="N", help="seed, instead of the scene's")
    parser.add_argument("--threads", type=int, metavar="N", help="threads; by default one per core")
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, computes, writes file and figure, and says what matters; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(arguments)
    output = given.output or Path(f"{given.scene.stem}_sensitivity.h5")
    picture = output.with_suffix(".png")
    if output.suffix.lower() not in (".h5", ".nc"):
        parser.error(f"--output {output}: a name that ends with .h5 or .nc is needed")
    return ended("stiction sensitivity", lambda: _study(given, output, picture))


def _study(given: argparse.Namespace, output: Path, picture: Path) -> None:
    inputs = named_files(given.scene)
    for path in (output, picture):
        files.check(path, force=given.force, inputs=inputs)
    found = sensitivity(
        given.scene, output, samples=given.samples, replicas=given.replicas, seed=given.seed, threads=given.threads,
        force=given.force,
    )  # fmt: skip
    with files.writing(picture, force=given.force, inputs=inputs) as part:
        draw(found).savefig(part, dpi=200)
    print(told(found))
    print(f"{output}, {picture}")


def told(found: xarray.Dataset) -> str:
    """A study in words."""
    level = 100.0 * float(found.attrs["interval_level"])
    lines = [f"Sobol indices of the mean over patches, with {level:g} % intervals"]
    width = max(len(str(key)) for key in found["key"].values) + 2
    for name in found["quantity"].values:
        one = found.sel(quantity=name)
        unit = str(one["unit"].item())
        mean, std = (quantities.si(one[what], unit) for what in ("mean", "standard_deviation"))
        lines.append(f"\n  {QUANTITIES[str(name)][0]}: {mean}; standard deviation of one patch, by numbers and by chance, {std}")
        lines.append(f"    {'':{width}}{'first order':26}total")
        least = one["total"] < one["first_order"] - _ROUNDED
        for key in found["key"].values:
            of = one.sel(key=key)
            columns = [_within(of[kind], of[f"{kind}_interval"]) for kind in ("first_order", "total")]
            lines.append(f"    {key:{width}}{columns[0]:26}{columns[1]}")
        lines.append(f"    {'scatter between patches, of all variance':{width + 26}}{_within(one['scatter'], one['scatter_interval'])}")
        if least.any():
            few = ", ".join(str(key) for key in found["key"].values[least.values])
            lines.append(f"    too few samples: the total of {few} is below its first order, which it contains; more --samples")
    return "\n".join(lines)


# Indices that differ by less are alike, as chance has them of numbers that act each by itself.
_ROUNDED = 0.01


def _within(value: xarray.DataArray, interval: xarray.DataArray) -> str:
    if np.isnan(float(value)):
        return "none"
    if np.isnan(interval.values).any():
        return f"{float(value):.3f} [not known]"
    low, high = (f"{float(end):.3f}" for end in interval.values)
    return f"{float(value):.3f} [{low}, {high}]".replace("-", "−")
