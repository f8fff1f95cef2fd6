"""Places of points that are the rows and columns of a grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

__all__ = ["BLOCK", "MOST_AXES", "REGULAR", "Places", "begin_with_grid", "on_grid"]

#: What messages say of points that are no grid.
REGULAR = "only regular lists of points are read"
#: Most columns of a list of points.
MOST_AXES = 6
#: Fewest rows of what may be a map of its own.
BLOCK = 3
# The share of a step by which places of points may be off their grid, and rounded places of a whole grid.
_OFF, _OFF_ROUNDED = 0.02, 0.5

_Array = NDArray[np.float64]


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
        raise SceneError(f"its points x, y, z are no grid: {name} has no even steps; {REGULAR}")
    said = f"its {name} is rounded, to steps of {steps.min():.4g} to {steps.max():.4g}"
    return Places(name, np.searchsorted(known, values), step, float(np.ptp(steps)) / np.ptp(known), said)


def begin_with_grid(values: _Array) -> bool:
    """Whether rows of more than three numbers begin with each place x, y of a grid once, in order."""
    if not 3 < values.shape[1] <= MOST_AXES:
        return False
    known, counts = values[:, :2], [np.unique(values[:, axis]).size for axis in (0, 1)]
    if min(counts) < BLOCK or counts[0] * counts[1] != len(values) or not np.isfinite(known).all():
        return False
    return len(np.unique(known, axis=0)) == len(values) and any(
        np.count_nonzero(np.diff(known[:, axis])) == counts[axis] - 1 for axis in (0, 1)
    )
