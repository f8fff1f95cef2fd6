"""Spectral moments of profiles, and the asperities of the surface that is equivalent by them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import SceneError
from .level import Grid

__all__ = ["Equivalent", "Moments", "equivalent", "moments", "profile_levelled"]

# σ_s² = (1 − 0.8968/α) m₀ (Bush, Gibson and Thomas 1975; McCool 1987).
_SUMMIT_VARIANCE = 0.8968


@dataclass(frozen=True)
class Moments:
    """Spectral moments of profiles along both directions (Nayak 1971), and the distribution of heights.

    Attributes
    ----------
    m0 : float
        Mean square height, m².
    slope_y, slope_x : float
        Mean square slope along each direction, from pixel to pixel.
    m4 : float
        Mean square second derivative over both directions, 1/m².
    skewness, excess_kurtosis : float
        0 for Gaussian heights.
    """

    m0: float
    slope_y: float
    slope_x: float
    m4: float
    skewness: float
    excess_kurtosis: float

    @property
    def m2(self) -> float:
        """Mean square slope over both directions."""
        return 0.5 * (self.slope_y + self.slope_x)

    @property
    def alpha(self) -> float:
        """Nayak's bandwidth parameter m0 m4/m2²; 3/2 or more for a random isotropic surface."""
        return self.m0 * (self.m4 / self.m2) / self.m2

    @property
    def wavelength(self) -> float:
        """Mean distance between maxima of a profile, 2π√(m2/m4), m."""
        return 2.0 * math.pi * math.sqrt(self.m2 / self.m4)


def moments(grid: Grid) -> Moments:
    """The moments of a levelled map within its border, or of a line scan, a map of a single row, from
    differences of neighbouring pixels.

    Raises
    ------
    SceneError
        Missing heights leave no slope or curvature, or the map is flat.
    """
    known = _known(grid.inner)
    square = known * known
    m0, third, fourth = square.mean(), np.dot(square, known) / known.size, np.dot(square, square) / known.size
    slopes, curvatures = [], []
    for axis, step in enumerate(grid.steps):
        if grid.inner.shape[axis] == 1:
            continue
        rises = np.diff(grid.inner, axis=axis)
        slopes.append(_mean_square(rises) / (step * step))
        curvatures.append(_mean_square(np.diff(rises, axis=axis)) / (step * step) / (step * step))
    m4 = 0.5 * (curvatures[0] + curvatures[-1])
    if not (slopes[0] + slopes[-1] > 0.0 and m4 > 0.0):
        raise SceneError("the levelled map is flat: no height differs from the others by more than rounding")
    skewness, kurtosis = third / (m0 * math.sqrt(m0)), fourth / (m0 * m0) - 3.0
    return Moments(float(m0), slopes[0], slopes[-1], m4, float(skewness), float(kurtosis))


def profile_levelled(grid: Grid) -> Grid:
    """A line scan, a map of a single row, less the straight line of least squares through its known heights.

    Raises
    ------
    SceneError
        Fewer than two heights are known, or nothing is left.
    """
    heights, places = grid.heights[0], np.arange(grid.heights.size)
    known = ~np.isnan(heights)
    if np.count_nonzero(known) < 2:
        raise SceneError("fewer than two heights are known, and they do not determine a straight line")
    # The second fit, of what the first has left, takes its rounding away.
    for _ in range(2):
        heights = heights - np.polynomial.Polynomial.fit(places[known], heights[known], 1)(places)
    if not np.nanmax(np.abs(heights)) > grid.resolution:
        raise SceneError(
            "the levelled profile is flat: no height differs from the others by more than rounding"
        )
    return replace(grid, heights=heights[np.newaxis])


def _known(values: Any) -> Any:
    """The values that are no NaN, one after the other."""
    missing = np.isnan(values)
    return values[~missing] if missing.any() else values.ravel()


def _mean_square(differences: Any) -> float:
    known = _known(differences)
    if not known.size:
        raise SceneError("missing heights leave no neighbouring pixels to take slopes and curvatures from")
    return float(np.dot(known, known) / known.size)


@dataclass(frozen=True)
class Equivalent:
    """Asperities of the Greenwood-Williamson surface that has given spectral moments.

    Attributes
    ----------
    density : float
        m4/(6π√3 m2), 1/m².
    radius : float
        3√π/(8√m4), the reciprocal of the mean curvature of summits, m.
    height_mean : float
        Mean height of summits above the mean plane of the surface, 4√(m0/(πα)), m.
    height_std : float
        √((1 − 0.8968/α) m0), m; 0 where α is too small for any.
    """

    density: float
    radius: float
    height_mean: float
    height_std: float


def equivalent(of: Moments) -> Equivalent:
    """The asperities that follow from moments (McCool 1987; mean height by Bush, Gibson and Thomas 1975)."""
    return Equivalent(
        density=of.m4 / of.m2 / (6.0 * math.pi * math.sqrt(3.0)),
        radius=3.0 * math.sqrt(math.pi) / (8.0 * math.sqrt(of.m4)),
        height_mean=4.0 * math.sqrt(of.m0 / (math.pi * of.alpha)),
        height_std=math.sqrt(max(1.0 - _SUMMIT_VARIANCE / of.alpha, 0.0) * of.m0),
    )
