"""Smoothing: an areal Gaussian filter (ISO 16610-61) takes away what is shorter than a cut-off wavelength."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import fft, ndimage

from .. import quantities
from ..errors import SceneError
from .level import Grid

__all__ = ["cutoff_series", "smoothed"]

# Least cut-off, pixels, and the largest over the shorter side of a map.
_FEWEST, _LARGEST = 2.0, 0.5
# Largest cut-off of a series over the shorter side.
_LARGEST_OF_SERIES = 0.25
# Cut-offs beyond which weights are left out: of a profile they are 2.6e-11 of all.
_REACH = 1.25
# Part of a cut-off along the border within which weights are one-sided; a straight border there takes 0.4 %
# of them.
_BORDER = 0.5
# Weights from which on Fourier transforms are faster, and lines that are transformed at one time.
_LONG, _LINES = 200, 256


def _bounds(grid: Grid) -> tuple[float, float]:
    """Two pixels, and the shorter side of the map, m."""
    sides = [count * step for count, step in zip(grid.heights.shape, grid.steps, strict=True)]
    return _FEWEST * max(grid.pixel), min(sides)


def smoothed(grid: Grid, cutoff: float) -> Grid:
    """The map less what is shorter than a cut-off wavelength λ, m.

    The weights are exp(−π r²/(α²λ²)) with α² = ln 2/π at the middle of pixels, so that a wave of length λ
    keeps half of its amplitude. Next to the border and missing heights they are normalised over the heights
    that are there, a Gaussian regression of order zero (ISO 16610-71). A missing height stays missing. Half a
    cut-off along the border is left out of summits and moments.

    Raises
    ------
    SceneError
        The cut-off is below two pixels or above half the shorter side.
    """
    least, side = _bounds(grid)
    if not least <= cutoff <= _LARGEST * side:
        is_short = cutoff < least
        limit = (
            "below two pixels, which is the shortest wave of the map"
            if is_short
            else "above half the shorter side of the map"
        )
        allowed = quantities.si(least if is_short else _LARGEST * side, "m")
        raise SceneError(
            f"smooth = {quantities.si(cutoff, 'm')} is {limit}; "
            f"give {allowed} or {'more' if is_short else 'less'}"
        )
    kernels = [_kernel(cutoff / step) for step in grid.steps]
    known = ~np.isnan(grid.heights)
    if known.all():
        heights = _convolved(grid.heights, kernels)
        for axis, kernel in enumerate(kernels):
            weights = ndimage.correlate1d(np.ones(heights.shape[axis]), kernel, mode="constant")
            heights /= weights[:, np.newaxis] if axis == 0 else weights
    else:
        heights = _convolved(np.where(known, grid.heights, 0.0), kernels)
        np.divide(heights, _convolved(known.astype(float), kernels), out=heights, where=known)
        heights[~known] = np.nan
    down, along = (math.ceil(_BORDER * cutoff / step * (1.0 - 1e-12)) for step in grid.steps)
    return replace(grid, heights=heights, border=(down, along), measured=None)


def _kernel(cutoff: float) -> Any:
    """Weights of the pixels from −reach to reach, of a cut-off in pixels."""
    reach = math.ceil(_REACH * cutoff)
    return np.exp(-(math.pi**2) / math.log(2.0) * (np.arange(-reach, reach + 1) / cutoff) ** 2)


def _convolved(heights: Any, kernels: list[Any]) -> Any:
    for axis, kernel in enumerate(kernels):
        if kernel.size < _LONG:
            heights = ndimage.correlate1d(heights, kernel, axis=axis, mode="constant")
        else:
            heights = _transformed(heights, kernel) if axis else _transformed(heights.T, kernel).T
    return np.ascontiguousarray(heights)


def _transformed(lines: Any, kernel: Any) -> Any:
    """Lines under a long kernel, by Fourier transforms of some of them at a time."""
    count, reach = lines.shape[1], kernel.size // 2
    size = fft.next_fast_len(count + reach, real=True)
    weights, smooth = fft.rfft(kernel, size), np.empty(lines.shape)
    for first in range(0, len(lines), _LINES):
        part = slice(first, first + _LINES)
        # What wraps around is in front of the lines.
        smooth[part] = fft.irfft(fft.rfft(lines[part], size) * weights, size)[:, reach : reach + count]
    return smooth


def cutoff_series(grid: Grid, count: int) -> list[float]:
    """Cut-offs from two pixels to a quarter of the shorter side, m, by equal factors.

    Raises
    ------
    SceneError
        A quarter of the shorter side is no more than two pixels.
    """
    least, side = _bounds(grid)
    most = _LARGEST_OF_SERIES * side
    if not most > least * (1.0 + 1e-9):
        raise SceneError(
            f"cutoffs = {count}: there is no room between two pixels, {quantities.si(least, 'm')}, and a "
            f"quarter of the shorter side, {quantities.si(most, 'm')}; leave it out"
        )
    between = [least * (most / least) ** (i / (count - 1)) for i in range(1, count - 1)]
    return [least, *between, most]
