"""Summits: pixels, or plateaus of equally high ones, that are higher than all around (Greenwood 1984)."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from scipy import ndimage
from scipy.spatial import KDTree

from .level import Grid
from .prominence import prominences

__all__ = ["Measured", "Summits", "apart", "measured", "prominent", "summits"]

_AROUND = np.ones((3, 3), dtype=bool)


@dataclass(frozen=True)
class Summits:
    """Summits of a map, row by row.

    Attributes
    ----------
    row, column : array of int (summits,)
        Their pixels, of plateaus the one nearest to the middle.
    height : array (summits,)
        Height above the mean plane of the surface, m.
    curvature_y, curvature_x : array (summits,)
        −∂²z/∂y² and −∂²z/∂x² by the first lower pixels on either side, 1/m; positive.
    curvature_xy : array (summits,)
        −∂²z/∂x∂y by the pixels at the corners, 1/m.
    peak : array of int (summits,)
        Places, row by row, of the highest pixels of their plateaus.
    prominence : array (summits,), optional
        Height above the key saddle, m, where a least one is asked for.
    """

    row: Any
    column: Any
    height: Any
    curvature_y: Any
    curvature_x: Any
    curvature_xy: Any
    peak: Any
    prominence: Any = None

    def __len__(self) -> int:
        return int(self.height.size)

    def __getitem__(self, which: Any) -> Summits:
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return Summits(**{name: None if value is None else value[which] for name, value in values.items()})

    @property
    def mean_curvature(self) -> Any:
        """Mean curvatures, array (summits,), 1/m."""
        return 0.5 * (self.curvature_y + self.curvature_x)

    @property
    def radius(self) -> Any:
        """Reciprocals of the mean curvatures, array (summits,), m."""
        return 1.0 / self.mean_curvature

    @property
    def principal_curvatures(self) -> tuple[Any, Any]:
        """The larger and the smaller principal curvatures, arrays (summits,), 1/m; the smaller of a saddle is
        not positive."""
        sharp = self.mean_curvature + np.hypot(0.5 * (self.curvature_x - self.curvature_y), self.curvature_xy)
        # The product is the determinant: the difference of mean and root would lose the digits of a ridge.
        return sharp, (self.curvature_y * self.curvature_x - self.curvature_xy**2) / sharp

    @property
    def equivalent_radius(self) -> Any:
        """Geometric means of the principal radii, array (summits,), m; of a saddle the radius of its mean
        curvature."""
        sharp, blunt = self.principal_curvatures
        is_saddle = ~(blunt > 0.0)
        return np.where(
            is_saddle, self.radius, 1.0 / (np.sqrt(sharp) * np.sqrt(np.where(is_saddle, 1.0, blunt)))
        )


def summits(grid: Grid) -> tuple[Summits, float]:
    """The plateaus of equally high pixels, most of a single one, whose neighbours are all lower by more than
    rounding, and the area searched, m².

    A summit is at the pixel that is nearest to the middle of its plateau; of equally near ones the first, row
    by row. Its curvatures are by the first pixels beyond the plateau along x and y. Pixels of the border and
    those next to a missing height are not compared, and their area does not count."""
    z = grid.heights
    found, area = _plateaus(grid)
    row, column = found.row, found.column
    height = z[row, column]
    up, down, left, right = (_edge(found, *way) for way in ((-1, 0), (1, 0), (0, -1), (0, 1)))
    dy, dx = grid.steps

    def bend(before: Any, after: Any, steps: tuple[Any, Any]) -> Any:
        falls = (height - before) / steps[0] + (height - after) / steps[1]
        return 2.0 * falls / (steps[0] + steps[1])

    rising = (z[row - up, column - left] - z[row - up, column + right]) + (
        z[row + down, column + right] - z[row + down, column - left]
    )
    of_map = Summits(
        row=row,
        column=column,
        height=height,
        curvature_y=bend(z[row - up, column], z[row + down, column], (up, down)) / (dy * dy),
        curvature_x=bend(z[row, column - left], z[row, column + right], (left, right)) / (dx * dx),
        # Beyond a plateau a corner may be missing, and tells nothing.
        curvature_xy=-np.nan_to_num(rising) / ((up + down) * (left + right)) / (dx * dy),
        peak=found.peak,
    )
    return of_map, area


@dataclass(frozen=True)
class _Plateaus:
    """Plateaus that are summits, row by row: the pixel nearest to the middle of each, the place of its
    highest pixel, and its label among `labels` of all pixels."""

    labels: Any
    own: Any
    row: Any
    column: Any
    peak: Any


def _plateaus(grid: Grid) -> tuple[_Plateaus, float]:
    """The summits, and the area searched, m²."""
    z = grid.heights if grid.measured is None else grid.measured
    is_missing = np.isnan(z)
    z = np.where(is_missing, np.inf, z) if is_missing.any() else z
    inner = grid.within(1)
    around = _around(z, inner)
    is_compared, is_top = np.isfinite(around), np.zeros(z.shape, dtype=bool)
    is_top[inner] = is_compared & (z[inner] >= around - grid.resolution)
    del around
    labels, count = ndimage.label(is_top, _AROUND)
    places = np.flatnonzero(is_top)
    own, is_whole = labels.ravel()[places], np.ones(count + 1, dtype=bool)
    # A plateau is none where it goes on in pixels that have a higher neighbour or are not compared.
    is_whole[own[_goes_on(z.ravel(), is_top, places, grid.resolution)]] = False
    places, own = places[is_whole[own]], own[is_whole[own]]
    row, column = np.divmod(places, labels.shape[1])
    sizes = np.maximum(np.bincount(own, minlength=count + 1), 1)
    away = [
        (of - (np.bincount(own, of, minlength=count + 1) / sizes)[own]) * step
        for of, step in zip((row, column), grid.steps, strict=True)
    ]
    middle = _least(own, away[0] ** 2 + away[1] ** 2)
    peak = places[_least(own, -grid.heights.ravel()[places])]
    order = np.argsort(places[middle])
    middle, peak = middle[order], peak[order]
    found = _Plateaus(labels, own[middle], row[middle], column[middle], peak)
    return found, float(np.count_nonzero(is_compared) * grid.steps[0] * grid.steps[1])


def _around(z: Any, inner: tuple[slice, slice]) -> Any:
    """The highest of the 3 x 3 pixels around each of the inner ones."""
    z = z[tuple(slice(side.start - 1, side.stop + 1) for side in inner)]
    rows = np.maximum(np.maximum(z[:-2], z[1:-1]), z[2:])
    return np.maximum(np.maximum(rows[:, :-2], rows[:, 1:-1]), rows[:, 2:])


def _goes_on(z: Any, is_top: Any, places: Any, resolution: float) -> Any:
    """Whether pixels, row by row, have a neighbour that is as high and no top."""
    columns, is_top = is_top.shape[1], is_top.ravel()
    level, found = z[places] - resolution, np.zeros(places.size, dtype=bool)
    for step in (-columns - 1, -columns, -columns + 1, -1, 1, columns - 1, columns, columns + 1):
        found |= (z[places + step] >= level) & ~is_top[places + step]
    return found


def _least(own: Any, values: Any) -> Any:
    """Where each label has its least value, the first of equal ones; in the order of the labels."""
    order = np.lexsort((values, own))
    return order[np.flatnonzero(np.diff(own[order], prepend=0))]


def _edge(found: _Plateaus, down: int, along: int) -> Any:
    """How many pixels it is from each summit to the first one beyond its plateau, along a direction."""
    steps, inside = np.ones(found.own.size, dtype=np.intp), np.arange(found.own.size)
    while inside.size:
        beyond = found.labels[
            found.row[inside] + down * steps[inside], found.column[inside] + along * steps[inside]
        ]
        inside = inside[beyond == found.own[inside]]
        steps[inside] += 1
    return steps


def prominent(grid: Grid, found: Summits, least: float | None) -> Summits:
    """The summits of a least prominence, m, with the prominence of each; all, and none of it, where it is
    None."""
    if least is None:
        return found
    peaks = np.unravel_index(found.peak, grid.heights.shape)
    found = replace(found, prominence=prominences(grid.heights, *peaks))
    return found[found.prominence >= least]


def apart(grid: Grid, found: Summits, distance: float | None) -> Summits:
    """The summits with none that is higher, and counts itself, nearer than a distance, m.

    From the highest down each takes away the lower ones around it; of equally high ones the first, row by
    row, is the higher one."""
    if distance is None or not len(found):
        return found
    dx, dy = grid.pixel
    places = np.column_stack([found.row * dy, found.column * dx])
    tree, counts = KDTree(places), np.ones(len(found), dtype=bool)
    for place in np.argsort(-found.height, kind="stable"):
        if counts[place]:
            counts[tree.query_ball_point(places[place], distance * (1.0 - 1e-9))] = False
            counts[place] = True
    return found[counts]


@dataclass(frozen=True)
class Measured:
    """Density and moments of the summits themselves.

    Attributes
    ----------
    density : float
        Summits over the area searched, 1/m².
    radius : float
        Reciprocal of the mean of the mean curvatures, m.
    height_mean, height_std : float
        Mean and standard deviation of the heights, m; of one summit the latter is NaN.
    curvature_std : float
        Standard deviation of the mean curvatures, 1/m; NaN of one summit.
    """

    density: float
    radius: float
    height_mean: float
    height_std: float
    curvature_std: float


def measured(found: Summits, area: float) -> Measured:
    """Density and moments of summits, one or more, on an area, m²."""
    curvature = found.mean_curvature

    def std(values: Any) -> float:
        return float(np.std(values, ddof=1)) if len(found) > 1 else float("nan")

    return Measured(
        density=len(found) / area,
        radius=float(1.0 / np.mean(curvature)),
        height_mean=float(np.mean(found.height)),
        height_std=std(found.height),
        curvature_std=std(curvature),
    )
