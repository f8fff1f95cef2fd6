"""Prominence: how high a summit is above the saddle on the way to higher ground."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

__all__ = ["prominences"]

# Rows whose passes are sorted at one time.
_ROWS = 256
# Neighbours by row and column, in the order of the pixels, and the half of them that comes later.
_LATER = [(0, 1), (1, -1), (1, 0), (1, 1)]


def prominences(heights: Any, row: Any, column: Any) -> Any:
    """Topographic prominence of summits, array (summits,), m.

    It is the height above the key saddle, the highest one over which a path from pixel to pixel, 8-connected,
    leads to higher ground. All known heights are ground, on the border too; paths lead over known heights
    alone. The highest summit that known heights connect has its height above the lowest of these. Among
    equally high pixels the first, row by row, is the higher one.

    Each pixel belongs to the peak that an ascent from it ends at. Of the highest pass between every two such
    basins a spanning tree keeps the ones that saddles are among; by these, from the highest down, the lower
    of two peaks ends.

    Parameters
    ----------
    heights : array (ny, nx)
        Heights, m; NaN where one is missing.
    row, column : array of int (summits,)
        Pixels that are higher than their neighbours; of a plateau the highest one, the first of such.
    """
    basins, peaks = _basins(heights)
    tree = _tree(_passes(heights, basins), peaks.size)
    saddles, survivors = _ended(tree, peaks.size)
    # The highest peak of connected ground is above its lowest pixel.
    lowest, known = np.full(peaks.size, np.inf), ~np.isnan(heights)
    np.minimum.at(lowest, survivors[basins[known]], heights[known])
    saddles = np.where(np.isnan(saddles), lowest, saddles)
    return heights[row, column] - saddles[basins[row, column]]


def _basins(heights: Any) -> tuple[Any, Any]:
    """The number of the peak of each pixel, array (ny, nx), counted from the highest peak, and the pixels of
    the peaks."""
    ground = np.where(np.isnan(heights), -np.inf, heights)
    columns = heights.shape[1]
    best, step = ground.copy(), np.zeros(heights.shape, dtype=np.int32)
    # Of equally high neighbours an earlier one is higher, a later one is not.
    for down, along in [*reversed(_LATER), *((-down, -along) for down, along in _LATER)]:
        own, other = _shifted(down, along)
        is_later = (down, along) in _LATER
        takes = ground[other] > best[own] if is_later else ground[other] >= best[own]
        np.copyto(best[own], ground[other], where=takes)
        np.copyto(step[own], down * columns + along, where=takes)
    del best
    step[np.isneginf(ground)] = 0
    parent = step.ravel() + np.arange(heights.size, dtype=np.int32)
    is_peak = (step.ravel() == 0) & ~np.isneginf(ground.ravel())
    del step
    while True:
        further = parent[parent]
        if np.array_equal(further, parent):
            break
        parent = further
    peaks = np.flatnonzero(is_peak)
    peaks = peaks[np.argsort(-ground.ravel()[peaks], kind="stable")]
    number = further
    number[peaks] = np.arange(peaks.size, dtype=np.int32)
    # Peaks are parents of themselves, so that their number is read before anything else is.
    return number[parent].reshape(heights.shape), peaks


def _shifted(down: int, along: int) -> tuple[Any, Any]:
    """The pixels of a map that have a neighbour there, and these neighbours."""

    def cut(step: int) -> tuple[slice, slice]:
        return slice(max(-step, 0), -step if step > 0 else None), slice(
            max(step, 0), step if step < 0 else None
        )

    (own_rows, rows), (own_columns, columns) = cut(down), cut(along)
    return (own_rows, own_columns), (rows, columns)


@dataclass(frozen=True)
class _Passes:
    """Pairs of basins, the lower number first, and the height of the highest pass between them, m."""

    one: Any
    other: Any
    height: Any


def _passes(heights: Any, basins: Any) -> _Passes:
    """The highest pass of every two basins that touch; its height is the lower one of two neighbouring
    pixels."""
    found = [_highest(*part) for part in _touching(heights, basins)]
    keys, levels = (np.concatenate([part[i] for part in found]) for i in range(2))
    keys, levels = _highest(keys, levels)
    return _Passes(keys >> 32, keys & 0xFFFFFFFF, levels)


def _touching(heights: Any, basins: Any) -> Iterator[tuple[Any, Any]]:
    """Pairs of basins as one number, and the heights of their passes, rows by rows."""
    for first in range(0, heights.shape[0], _ROWS):
        rows = slice(first, first + _ROWS + 1)
        keys, levels = [], []
        for down, along in _LATER:
            own, other = _shifted(down, along)
            one, two = basins[rows][own], basins[rows][other]
            level = np.minimum(heights[rows][own], heights[rows][other])
            if not down:
                # The last row is the first of the next part.
                one, two, level = one[:_ROWS], two[:_ROWS], level[:_ROWS]
            meets = (one != two) & ~np.isnan(level)
            one, two = one[meets].astype(np.int64), two[meets].astype(np.int64)
            keys.append(np.minimum(one, two) << 32 | np.maximum(one, two))
            levels.append(level[meets])
        yield np.concatenate(keys), np.concatenate(levels)


def _highest(keys: Any, levels: Any) -> tuple[Any, Any]:
    """Every key once, with its highest level."""
    if not keys.size:
        return keys, levels
    order = np.argsort(keys)
    keys = keys[order]
    first = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]]))
    return keys[first], np.maximum.reduceat(levels[order], first)


def _tree(passes: _Passes, peaks: int) -> _Passes:
    """The passes of a spanning tree of highest passes, from the highest down."""
    order = np.argsort(-passes.height, kind="stable")
    # The rank is a weight that is never 0, which would be no edge.
    rank = np.arange(1.0, order.size + 1.0)
    graph = sparse.coo_array((rank, (passes.one[order], passes.other[order])), shape=(peaks, peaks))
    ranks = csgraph.minimum_spanning_tree(graph.tocsr()).data
    kept = order[np.sort(ranks).astype(np.int64) - 1]
    return _Passes(passes.one[kept], passes.other[kept], passes.height[kept])


def _ended(tree: _Passes, peaks: int) -> tuple[Any, Any]:
    """The height at which each peak meets a higher one, NaN where it does not, and the highest that it is
    connected to."""
    above, saddles = list(range(peaks)), [np.nan] * peaks

    def top(peak: int) -> int:
        while above[peak] != peak:
            above[peak] = above[above[peak]]
            peak = above[peak]
        return peak

    for one, other, height in zip(tree.one.tolist(), tree.other.tolist(), tree.height.tolist(), strict=True):
        one, other = top(one), top(other)
        higher, lower = (one, other) if one < other else (other, one)
        above[lower], saddles[lower] = higher, height
    return np.array(saddles), np.array([top(peak) for peak in range(peaks)])
