"""Places of points that are the rows and columns of a grid."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from .declared import Raw
from .lengths import Steps, metres

__all__ = ["BLOCK", "MOST_AXES", "NAMED", "Places", "axes_of", "begin_with_grid", "on_grid", "placed", "points"]

# What messages say of points that are no grid.
_REGULAR = "only regular lists of points are read"
#: Most columns of a list of points.
MOST_AXES = 6
#: Fewest rows of what may be a map of its own.
BLOCK = 3
# The fraction of a step by which places of points may be off their grid, and rounded places of a whole grid.
_OFF, _OFF_ROUNDED = 0.02, 0.5

_AXES = {"x": "x", "y": "y", "z": "z", "height": "z"}
#: A name of a column with its unit.
NAMED = re.compile(r'"?([A-Za-z]+)"?\s*(?:[\[(]\s*([^\])]*?)\s*[\])]"?)?')

_Array = NDArray[np.float64]


@dataclass
class Axes:
    """Columns of a list of points: the axis of each, an empty text for others, and the unit of each axis."""

    names: list[str]
    units: dict[str, str]


@dataclass
class Places:
    """Which row or column of a grid each value is on, and their distance, by which part of it this may be wrong;
    `rounded` says that they are, if so."""

    name: str
    index: NDArray[np.intp]
    step: float
    off: float = 0.0
    rounded: str = ""

    @property
    def count(self) -> int:
        """How many rows or columns there are."""
        return int(self.index.max()) + 1


def axes_of(columns: list[str], *, line_scans: bool = False) -> Axes | None:
    """What names of columns such as ``X[nm]`` or ``height (nm)`` are; None if they are not of points x, y, z.

    With `line_scans` columns x and z alone are, too.
    """
    found = [NAMED.fullmatch(name.strip()) for name in columns]
    names = [_AXES.get(one[1].lower(), "") if one else "" for one in found]
    if not ({"x", "y", "z"} <= set(names) or (line_scans and names == ["x", "z"])):
        return None
    return Axes(names, {name: one[2] or "" for name, one in zip(names, found, strict=True) if name and one})


def on_grid(values: _Array, name: str) -> Places:
    """The rows or columns of a grid that values are on."""
    if not np.all(np.isfinite(values)):
        raise SceneError(f"a point x, y, z has no {name}")
    known = np.unique(values)
    steps = np.diff(known)
    if steps.size == 0:
        raise SceneError(f"all points x, y, z have one {name}: a line scan has a spectrum, but no asperities")
    # Rounding makes several values of one: steps that are far smaller than the largest are none.
    step = float(np.median(steps[steps > 0.2 * steps.max()]))
    index = (values - known[0]) / step
    rounded = np.rint(index)
    if np.abs(index - rounded).max() <= max(_OFF, 1e-6 * rounded.max()) and rounded.max() < 1 << 26:
        return Places(name, rounded.astype(np.intp), float((known[-1] - known[0]) / rounded.max()))
    # All places of a grid, each as its own value with few digits.
    step = float((known[-1] - known[0]) / steps.size)
    if np.abs(known - known[0] - step * np.arange(known.size)).max() > _OFF_ROUNDED * step:
        raise SceneError(f"its points x, y, z are no grid: {name} has no even steps; {_REGULAR}")
    said = f"its {name} is rounded, to steps of {steps.min():.4g} to {steps.max():.4g}"
    return Places(name, np.searchsorted(known, values), step, float(np.ptp(steps)) / np.ptp(known), said)


def points(values: _Array, units: tuple[str, str]) -> Raw:
    """Points on a grid as a map: y from row to row, x along the rows, both rising.

    Parameters
    ----------
    values : array (count, 3)
        x, y and z of each point, in any order.
    units : tuple of str
        Units of x and of y, empty where they are not known.

    Returns
    -------
    Raw
        Heights (ny, nx) in the unit of z, NaN where no point is.

    Raises
    ------
    SceneError
        The points are no grid, or two have one place.
    """
    x, y = (on_grid(values[:, axis], name) for axis, name in enumerate("xy"))
    shape = (y.count, x.count)
    points, places = len(values), x.count * y.count
    if points < places / 2 or min(shape) < 2:
        raise SceneError(
            f"its {points} points x, y, z are no grid: there would be {shape[0]} x {shape[1]} places; {_REGULAR}"
        )
    for axis in (x, y):
        if axis.rounded and points != places:
            raise SceneError(f"its points x, y, z are no grid: {axis.name} has no even steps; {_REGULAR}")
    heights = np.full(shape, np.nan)
    taken = np.zeros(shape, dtype=bool)
    taken[y.index, x.index] = True
    if taken.sum() != points:
        raise SceneError(f"{points - int(taken.sum())} of its points x, y, z have the place of another one")
    heights[y.index, x.index] = values[:, 2]
    found = placed(heights, x, y, units)
    if points < places:
        found.warnings.append(f"{places - points} of {places} places of the grid have no point: missing")
    return found


def placed(heights: _Array, x: Places, y: Places, units: tuple[str, str]) -> Raw:
    """Heights with the steps of their places as pixel, if these have units of length."""
    width, height = (metres(unit) for unit in units)
    found = Raw(heights)
    if width is not None and height is not None:
        found.pixel = (x.step * width, y.step * height)
    elif units[0] == units[1]:
        found.steps = Steps(x.step, y.step, units[0] or None, x.off + y.off)
    found.unsaid = x.rounded or y.rounded
    if found.unsaid:
        found.warnings.append(f"{found.unsaid}: taken as even")
    return found


def begin_with_grid(values: _Array) -> bool:
    """Whether rows of more than three numbers begin with places x, y of a grid, line by line, perhaps behind a number
    of the row; most places have to be there."""
    if not 3 < values.shape[1] <= MOST_AXES:
        return False
    order = values[:, 0]
    known = values[:, 1:3] if np.all(np.diff(order) == 1.0) and values.shape[1] > 3 else values[:, :2]
    counts = [np.unique(known[:, axis]).size for axis in (0, 1)]
    if not np.isfinite(known).all() or min(counts) < BLOCK or not 0.5 < len(values) / np.prod(counts) <= 1.0:
        return False
    return len(np.unique(known, axis=0)) == len(values) and any(
        np.count_nonzero(np.diff(known[:, axis])) == counts[axis] - 1 for axis in (0, 1)
    )
