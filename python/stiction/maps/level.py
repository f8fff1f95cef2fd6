"""Levelling of rows and of the whole map, and what the measurement has left out or not resolved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import ndimage

from .. import quantities
from ..errors import SceneError

__all__ = [
    "LEVELS",
    "ROWS",
    "SMALLEST",
    "Grid",
    "fitted",
    "flaws",
    "levelled",
    "offset_lines",
    "raised_by_rows",
    "rows_levelled",
]

#: The surface that is subtracted, by the name of the levelling.
LEVELS = {
    "none": "mean",
    "plane": "plane of least squares",
    "quadratic": "quadratic surface of least squares",
}
#: What is subtracted from each row, by the name of the row levelling.
ROWS = {"median": "median of each row", "differences": "median of differences between rows"}
#: Fewest rows and columns of a map.
SMALLEST = 8

# Powers of u along the rows and v along the columns: the terms of each surface are the first 1, 3 or 6.
_TERMS = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
_COUNTS = {"none": 1, "plane": 3, "quadratic": 6}
# Smallest eigenvalue of the normal equations over the largest with which heights determine the surface.
_DETERMINED = 1e-9
# Share of pixels, or of pairs of them, from which a flaw is said.
_NOTED = 0.01
# Relative rise of the standard deviation from which on it is said.
_RAISED = 1e-3
# Steps of a row over their typical size, and over the standard deviation of its pixels' own steps: of one, and of most.
_OUTLYING, _JUMP, _UNSTEADY = 5.0, 1.0, 0.5
# Standard deviation of a Gaussian over its median absolute deviation.
_GAUSSIAN = 1.4826


@dataclass(frozen=True)
class Grid:
    """Heights of a map on their way to asperities.

    Attributes
    ----------
    heights : array (ny, nx)
        Heights, m; NaN where one is missing.
    pixel : pair of float
        Width and height of a pixel, m.
    resolution : float
        Heights that differ by no more, m, are equally high.
    border : pair of int
        Rows and columns along each side that have no part in summits and moments.
    measured : array (ny, nx), optional
        Heights by which pixels are higher than others or equally high, m, where those are in steps that
        levelling has tilted; by default `heights`.
    """

    heights: Any
    pixel: tuple[float, float]
    resolution: float
    border: tuple[int, int] = (0, 0)
    measured: Any = None

    @property
    def steps(self) -> tuple[float, float]:
        """Height and width of a pixel, m, in the order of the axes of `heights`."""
        return self.pixel[1], self.pixel[0]

    @property
    def inner(self) -> Any:
        """The heights within the border, a view."""
        return self.heights[self.within(0)]

    def within(self, least: int) -> tuple[slice, slice]:
        """Rows and columns within the border, which is `least` wide or wider."""
        down, along = (
            slice(max(side, least), count - max(side, least))
            for side, count in zip(self.border, self.heights.shape, strict=True)
        )
        return down, along


def rows_levelled(heights: Any, how: str, slopes: Any = 0.0) -> Any:
    """Heights less an offset of each row: its median, or the sum of the median steps from row to row.

    Parameters
    ----------
    heights : array (ny, nx)
        Heights, m; NaN where one is missing.
    how : {"median", "differences"}
        Which offset.
    slopes : array (ny, nx), optional
        Surface, m, that offsets are measured from: the median of a tilted row is no offset, but the height of about
        one pixel in its middle.

    Returns
    -------
    array (ny, nx)
        A row without a height stays as it is; a step next to one counts as none.
    """
    flat = heights - slopes
    if how == "median":
        offsets = _medians(flat)
    else:
        offsets = np.concatenate([[0.0], np.cumsum(np.nan_to_num(_medians(np.diff(flat, axis=0))))])
    return heights - np.nan_to_num(offsets)[:, np.newaxis]


def raised_by_rows(before: Any, after: Any) -> list[str]:
    """That levelling of rows has raised the standard deviation of levelled heights, m, which it is to lower."""
    was, now = (float(np.nanstd(heights)) for heights in (before, after))
    if not now > (1.0 + _RAISED) * was:
        return []
    shown = " to ".join(quantities.si(one, "m") for one in (was, now))
    return [
        f"levelling of rows raises the standard deviation of the heights, from {shown}: it adds offsets that the rows "
        "do not have; leave it out, or level rows in another way"
    ]


def _medians(values: Any) -> Any:
    """The median of each row without its NaN; NaN of a row that has nothing else."""
    medians = np.median(values, axis=1)
    for row in np.flatnonzero(np.isnan(medians)):
        known = values[row][~np.isnan(values[row])]
        medians[row] = np.median(known) if known.size else np.nan
    return medians


def levelled(grid: Grid, level: str) -> Grid:
    """The map less the surface of least squares through its known heights.

    Parameters
    ----------
    grid : Grid
        The map.
    level : {"none", "plane", "quadratic"}
        The surface.

    Raises
    ------
    SceneError
        The known heights do not determine the surface, or nothing is left.
    """
    heights = grid.heights.copy()
    # The second fit, of what the first has left, takes its rounding away.
    for _ in range(2):
        heights -= fitted(heights, level)
    if not np.nanmax(np.abs(heights)) > grid.resolution:
        raise SceneError("the levelled map is flat: no height differs from the others by more than rounding")
    in_steps = _tilt(grid.heights - heights) < _step(grid)
    return replace(grid, heights=heights, measured=grid.heights if in_steps else None)


def _tilt(surface: Any) -> float:
    """The largest step of a smooth surface from a pixel to any of its neighbours, m."""
    return sum(float(np.nanmax(np.abs(np.diff(surface, axis=axis)), initial=0.0)) for axis in (0, 1))


def _step(grid: Grid) -> float:
    """The smallest step between neighbouring pixels that is no rounding, m."""
    least = np.inf
    for axis in (0, 1):
        rises = np.abs(np.diff(grid.heights, axis=axis))
        least = min(least, float(np.min(rises, initial=np.inf, where=rises > grid.resolution)))
    return least


def fitted(heights: Any, level: str) -> Any:
    """The surface of least squares through the known heights (ny, nx), m, in their unit and shape.

    Raises
    ------
    SceneError
        The known heights do not determine it.
    """
    # By the normal equations; u and v go from −1 to 1 over columns and rows.
    terms = _TERMS[: _COUNTS[level]]
    v, u = (np.vander(np.linspace(-1.0, 1.0, count), 5, increasing=True) for count in heights.shape)
    known = ~np.isnan(heights)
    if known.all():
        weights, sums = np.outer(v.sum(axis=0), u.sum(axis=0)), v.T @ (heights @ u)
    else:
        weights, sums = v.T @ (known @ u), v.T @ (np.where(known, heights, 0.0) @ u)
    matrix = np.array([[weights[b + d, a + c] for a, b in terms] for c, d in terms])
    values, vectors = np.linalg.eigh(matrix)
    if not values[0] > _DETERMINED * values[-1]:
        count, pixels = np.count_nonzero(known), heights.size
        raise SceneError(
            f"{count} of {pixels} heights are known, and they do not determine the {LEVELS[level]}"
            + ("" if level == "none" else '; try level="none"')
        )
    solved = vectors @ ((vectors.T @ np.array([sums[b, a] for a, b in terms])) / values)
    coefficients = np.zeros((3, 3))
    for (a, b), coefficient in zip(terms, solved, strict=True):
        coefficients[b, a] = coefficient
    return v[:, :3] @ coefficients @ u[:, :3].T


def flaws(heights: Any) -> list[str]:
    """A line for each thing that the measurement has left out or not resolved; of heights as measured, m."""
    return [*_missing(heights), *_equal(heights), *_frozen(heights)]


def _missing(heights: Any) -> Iterator[str]:
    share = np.count_nonzero(np.isnan(heights)) / heights.size
    if share > _NOTED:
        yield f"{100.0 * share:.1f} % of the heights are missing"


def _equal(heights: Any) -> Iterator[str]:
    """The fraction of pairs of pixels side by side that are equally high, along x or y."""
    known = ~np.isnan(heights)
    share = 0.0
    for one, other in ((np.s_[:, 1:], np.s_[:, :-1]), (np.s_[1:], np.s_[:-1])):
        pairs = int(np.count_nonzero(known[one] & known[other]))
        share = max(share, int(np.count_nonzero(heights[one] == heights[other])) / max(pairs, 1))
    if share > _NOTED:
        yield (
            f"{100.0 * share:.1f} % of neighbouring pixels are equally high: steps of height make summits "
            "too sharp or too blunt, unless a cut-off smooths over some steps"
        )


def _frozen(heights: Any) -> Iterator[str]:
    """Rows and columns that repeat the one before in every known pixel."""
    for name, lines in (("rows", heights), ("columns", heights.T)):
        alike = (lines[1:] == lines[:-1]) | np.isnan(lines[1:]) | np.isnan(lines[:-1])
        pairs = np.count_nonzero(~np.isnan(lines[1:]) & ~np.isnan(lines[:-1]), axis=1)
        count = np.count_nonzero(alike.all(axis=1) & (pairs >= SMALLEST))
        noun = f"{name} repeat" if count > 1 else f"{name[:-1]} repeats"
        if count:
            yield f"{count} {noun} the one before: frozen lines of a scan make false plateaus and ridges"


def offset_lines(heights: Any, lines: Sequence[str] = ("rows", "columns")) -> list[str]:
    """A sentence for rows, and for columns, that are offset against each other.

    A step from line to line is the median of the steps of its pixels. It is an offset where it differs from
    the steps next to it by more than its pixels' steps do among each other; so are all where most differ
    nearly as much."""
    return [said for name in lines for said in _offset(name, heights if name == "rows" else heights.T)]


def _offset(name: str, lines: Any) -> Iterator[str]:
    steps = np.diff(lines, axis=0)
    jumps = _medians(steps)
    scatter = _GAUSSIAN * _medians(np.abs(steps - jumps[:, np.newaxis]))
    known = ~np.isnan(jumps)
    jumps, scatter = jumps[known], scatter[known]
    if jumps.size < SMALLEST:
        return
    jumps = np.abs(jumps - ndimage.median_filter(jumps, size=5, mode="nearest"))
    typical = _GAUSSIAN * float(np.median(jumps))
    advice = "; levelling of rows takes offsets away" if name == "rows" else ""
    if typical > _UNSTEADY * float(np.median(scatter)) > 0.0:
        yield f"{name} are offset against each other, or the surface has a lay along them{advice}"
        return
    count = np.count_nonzero((jumps > _OUTLYING * typical) & (jumps > _JUMP * scatter) & (scatter > 0.0))
    if count:
        noun, verb = (name, "are") if count > 1 else (name[:-1], "is")
        yield f"{count} {noun} {verb} offset against the one before{advice}"
