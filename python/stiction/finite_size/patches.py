"""Patches of several sizes: sweeps over the nominal area."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import experiments
from ..errors import SceneError
from ..opened import Run, Sweep
from ..scenes import Scene
from .study import KEY

__all__ = ["run"]

_COUNTS = "10:1e6:11"
_MOST_SIZES, _LARGEST = 100, 10**8


def run(
    scene: Scene,
    counts: Sequence[int] | str = _COUNTS,
    output: str | Path | None = None,
    *,
    replicas: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    resume: bool = False,
    force: bool = False,
    progress: bool | None = None,
    **overrides: Any,
) -> Sweep:
    """Computes patches of several sizes: a sweep over the nominal area, with sums by moments where these
    are as good.

    All other arguments are as of `stiction.run`.

    Parameters
    ----------
    counts : sequence of int, or str
        Numbers of asperities, or a text of numbers and of ranges ``FROM:TO:COUNT`` spaced by equal factors,
        with commas between them.

    Examples
    --------
    >>> from stiction import finite_size
    >>> patches = finite_size.run("configs/case_ii.toml", [30, 100, 300], replicas=20)
    >>> bias = finite_size.study(patches)["bias"].values
    >>> bool(bias[0] > bias[2])
    True
    """
    sizes = _counts(counts)
    # A lattice is for the numbers of asperities, and not for the area of the scene.
    alone = experiments.run(scene, replicas=0, progress=False, **{**overrides, "substrate.coupling": "none"})
    if not isinstance(alone, Run):
        raise SceneError(
            "the scene has a table [sweep]: leave it out; patches of several sizes are a sweep of their own"
        )
    if not float(alone.tree["integral"].attrs["pull_off_force"]) > 0.0:
        raise SceneError("the integral has no pull-off, so patches have none to be compared with")
    density = float(alone.attrs["asperity_density"])
    areas = [f"{count / density!r} m^2" for count in sizes]
    options: dict[str, Any] = {
        "replicas": replicas,
        "seed": seed,
        "threads": threads,
        "resume": resume,
        "force": force,
    }
    moments = {"solver.summation": "moments", **experiments.ONE_MODEL, **overrides}
    return experiments.sweep(scene, {KEY: areas}, output, progress=progress, **options, **moments)


def _counts(given: Sequence[int] | str) -> list[int]:
    """Numbers of asperities, rising."""
    listed = given if isinstance(given, str) else ",".join(str(count) for count in given)
    try:
        sizes = sorted({count for item in listed.split(",") for count in _of_item(item)})
        if not 2 <= len(sizes) <= _MOST_SIZES:
            raise ValueError(f"{len(sizes)} different numbers of asperities; 2 to {_MOST_SIZES} are needed")
    except ValueError as error:
        raise SceneError(f"counts {listed}: {error}, such as 10,100,1e4 or {_COUNTS}") from None
    return sizes


def _of_item(item: str) -> list[int]:
    parts = item.split(":")
    if len(parts) == 1:
        return [_whole(item)]
    if len(parts) != 3:
        raise ValueError(f"`{item}` is neither a number nor a range FROM:TO:COUNT")
    low, high, count = (_whole(part) for part in parts)
    if not (high > low and 2 <= count <= _MOST_SIZES):
        raise ValueError(f"a range rises, and has 2 to {_MOST_SIZES} numbers")
    return [round(low * (high / low) ** (i / (count - 1))) for i in range(count)]


def _whole(text: str) -> int:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (1.0 <= value <= _LARGEST and value.is_integer()):
        raise ValueError(f"`{text.strip()}` is no whole number from 1 to {_LARGEST:.0e}".replace("e+0", "e"))
    return int(value)
