"""Summits: pixels that are higher than their 8 neighbours (Greenwood 1984)."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from scipy import ndimage
from scipy.spatial import KDTree

from .level import Grid
from .prominence import prominences

__all__ = ["Measured", "Summits", "apart", "measured", "prominent", "summits"]

_AROUND = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], dtype=bool)


@dataclass(frozen=True)
class Summits:
    """Summits of a map, row by row.

    Attributes
    ----------
    row, column : array of int (summits,)
        Their pixels.
    height : array (summits,)
        Height above the mean plane of the surface, m.
    curvature_y, curvature_x : array (summits,)
        −∂²z/∂y² and −∂²z/∂x² by the pixels on either side, 1/m; positive.
    curvature_xy : array (summits,)
        −∂²z/∂x∂y by the pixels at the corners, 1/m.
    prominence : array (summits,), optional
        Height above the key saddle, m, where a least one is asked for.
    """

    row: Any
    column: Any
    height: Any
    curvature_y: Any
    curvature_x: Any
    curvature_xy: Any
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
    """The pixels that are higher than each of their 8 neighbours by more than rounding, and the area
    searched, m².

    Pixels of the border and those next to a missing height are not compared, and their area does not count.
    Plateaus of equally high pixels are no summits."""
    z, within = grid.heights, grid.within(1)
    is_missing = np.isnan(z)
    around = ndimage.maximum_filter(
        np.where(is_missing, np.inf, z) if is_missing.any() else z, footprint=_AROUND
    )[within]
    compared = np.isfinite(around) & ~is_missing[within]
    row, column = np.nonzero(compared & (z[within] - around > grid.resolution))
    row, column = row + within[0].start, column + within[1].start
    height = z[row, column]
    dx, dy = grid.pixel

    def bend(before: Any, after: Any) -> Any:
        return (height - before) + (height - after)

    rising = (z[row - 1, column - 1] - z[row - 1, column + 1]) + (
        z[row + 1, column + 1] - z[row + 1, column - 1]
    )
    found = Summits(
        row=row,
        column=column,
        height=height,
        curvature_y=bend(z[row - 1, column], z[row + 1, column]) / (dy * dy),
        curvature_x=bend(z[row, column - 1], z[row, column + 1]) / (dx * dx),
        curvature_xy=-0.25 * rising / (dx * dy),
    )
    return found, float(np.count_nonzero(compared) * dy * dx)


def prominent(grid: Grid, found: Summits, least: float | None) -> Summits:
    """The summits of a least prominence, m, with the prominence of each; all, and none of it, where it is
    None."""
    if least is None:
        return found
    found = replace(found, prominence=prominences(grid.heights, found.row, found.column))
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
