"""A scene with priors at the points of a design: sweeps of the program, a block each, and their outcomes."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from .. import experiments, priors
from ..errors import SceneError, StictionError
from ..progress import Bar
from . import indices
from .words import QUANTITIES

__all__ = ["BLOCKS", "LEAST", "Design", "points_of_row"]

Array = NDArray[np.float64]

#: Independent blocks of points.
BLOCKS = 32
#: Samples at least: with one row a block, intervals of 95 % hold the truth in 80 to 90 % of designs only.
LEAST = 64
# Fraction of the samples that may be left out: their points are no sample of the priors any more.
_MOST_LEFT_OUT = 0.05


@dataclass
class Design:
    """Rows of points that grow, and their outcomes.

    Attributes
    ----------
    outcomes : array (outcomes, blocks, rows, points of a row, patches)
        SI; NaN in all of a row that is left out.
    cube : array (blocks, rows, points of a row, k)
        The points, of the unit cube.
    left_out : list of str
        Why, for each such row.
    """

    found: priors.Priors
    tables: dict[str, Any]
    patches: int
    seed: int
    threads: int | None
    outcomes: Array = field(init=False)
    cube: Array = field(init=False)
    left_out: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.outcomes = np.empty((len(QUANTITIES), BLOCKS, 0, points_of_row(self.found), self.patches))

    @property
    def samples(self) -> int:
        """Rows of all blocks."""
        return BLOCKS * int(self.outcomes.shape[2])

    def double(self, forecast: int, progress: bool | None) -> None:
        """Computes as many rows again, or the least number of them; progress is shown as a part of a forecast of samples."""
        before = self.outcomes.shape[2]
        rows = max(2 * before, LEAST // BLOCKS)
        correlation = None if self.found.are_independent else self.found.correlation
        self.cube = indices.points(len(self.found.priors), rows, BLOCKS, self.seed, correlation)
        seeds = np.random.SeedSequence([self.seed, 1]).generate_state(BLOCKS)
        most = _MOST_LEFT_OUT * BLOCKS * rows
        new = []
        with Bar("", max(forecast, BLOCKS * rows), "samples", done=self.samples, progress=progress) as bar:
            for block in range(BLOCKS):
                new.append(self._block(self.cube[block, before:], int(seeds[block]), most))
                bar.to(self.samples + (block + 1) * (rows - before))
        self.outcomes = np.concatenate([self.outcomes, np.stack(new, axis=1)], axis=2)

    def _block(self, cube: Array, seed: int, most: float) -> Array:
        """Outcomes of rows of a block, (outcomes, rows, points, patches), from points of the unit cube, (rows, points, k)."""
        values = np.full((len(QUANTITIES), *cube.shape[:2], self.patches), np.nan)
        rows = np.arange(len(cube))
        while rows.size:
            numbers = self.found.draw(cube[rows].reshape(-1, cube.shape[2]))
            try:
                of = experiments.patches(
                    self.tables, self.found.axes(numbers), replicas=self.patches, seed=seed, threads=self.threads, progress=False,
                    **experiments.ONE_MODEL,
                )  # fmt: skip
            except StictionError as error:
                point = re.search(r"\bat point (\d+) of \d+ ", str(error))
                if point is None:
                    raise
                self._leave_out(str(error).replace(point[0], "at "), most)
                rows = np.delete(rows, (int(point[1]) - 1) // cube.shape[1])
                continue
            values[:, rows] = _outcomes(of).reshape(len(QUANTITIES), len(rows), *values.shape[2:])
            break
        for row in rows:
            if (lacks := np.argwhere(~np.isfinite(values[:, row]))).size:
                name, number = list(QUANTITIES)[lacks[0, 0]], self.found.draw(cube[row])[lacks[0, 1]]
                at = ", ".join(f"{prior.key} = {prior.text(value)}" for prior, value in zip(self.found.priors, number, strict=True))
                self._leave_out(f"no {QUANTITIES[name][0]} of a patch at {at}", most)
                values[:, row] = np.nan
        return values

    def _leave_out(self, why: str, most: float) -> None:
        self.left_out.append(why)
        if len(self.left_out) > most:
            raise SceneError(
                f"more than {100.0 * _MOST_LEFT_OUT:g} % of the samples have a point without an outcome, the first: {self.left_out[0]}; "
                "narrow the priors to where every patch has one, or reach it with [separation]"
            )


def points_of_row(found: priors.Priors) -> int:
    """The number of points of a row, which is a sample."""
    k = len(found.priors)
    return k + 2 if found.are_independent else 2 * k + 2


def _outcomes(group: xarray.Dataset) -> Array:
    """Outcomes of each patch, (outcomes, points, patches), SI."""
    of = {str(name): values.transpose("point", "replica", ...).values for name, values in group.data_vars.items()
          if {"point", "replica"} <= set(values.dims)}  # fmt: skip
    if "dissipated_energy" in of:
        of["energy"] = of["dissipated_energy"]
    else:
        h = group["separation"].transpose("point", "separation_index").values
        of["energy"] = _work(of["external_force"], h[:, None, :])
    return np.stack([of[name] for name in QUANTITIES])


def _work(force: Array, h: Array) -> Array:
    """The largest work to part surfaces from a separation to the last one, by the trapezoidal rule (N m).

    Parameters
    ----------
    force, h : array (…, separations)
        External force, compressive positive (N), at rising separations (m).

    Examples
    --------
    >>> _work(np.array([2.0, 0.0, -1.0, -1.0]), np.array([0.0, 1.0, 2.0, 3.0])).item()
    1.5
    """
    steps = -0.5 * (force[..., 1:] + force[..., :-1]) * np.diff(h, axis=-1)
    from_here = np.cumsum(steps[..., ::-1], axis=-1)
    best: Array = np.maximum(from_here.max(axis=-1), 0.0)
    return best
