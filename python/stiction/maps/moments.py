"""`stiction.spectral_moments`: the spectral moments of profiles of a map or a line scan."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import SceneError

if TYPE_CHECKING:
    from .reading import HeightMap
    from .spectrum import Moments

__all__ = ["LineScan", "SpectralMoments", "in_numbers", "line_scan", "spectral_moments"]

# Fewer maxima of a line scan leave its moments uncertain.
_FEWEST_MAXIMA = 100


@dataclass(frozen=True)
class SpectralMoments:
    """Spectral moments of profiles, and the asperities of the random isotropic surface that has them.

    Attributes
    ----------
    m0 : float
        Mean square height, m².
    m2 : float
        Mean square slope.
    m4 : float
        Mean square second derivative, 1/m².
    alpha : float
        m0 m4/m2².
    density : float
        Summits per area, 1/m².
    radius : float
        Reciprocal of the mean curvature of summits, m.
    height_mean, height_std : float
        Mean and standard deviation of the heights of summits above the mean plane, m.
    """

    m0: float
    m2: float
    m4: float
    alpha: float
    density: float
    radius: float
    height_mean: float
    height_std: float

    @property
    def toml(self) -> str:
        """The line of a scene's `[surface]`."""
        m0, m4 = (_decimal(of) for of in (1e18 * self.m0, 1e-12 * self.m4))
        return f'spectrum = {{ m0 = "{m0} nm^2", m2 = {_decimal(self.m2)}, m4 = "{m4} /um^2" }}'


def _decimal(value: float) -> str:
    """Six digits, as TOML and quantities have them."""
    mantissa, _, exponent = f"{value:.6g}".partition("e")
    return f"{mantissa}e{int(exponent)}" if exponent else mantissa


@dataclass(frozen=True)
class LineScan:
    """A line scan less its straight line of least squares: length, m, number of heights, moments and what its
    parameters do not meet."""

    length: float
    count: int
    missing: int
    moments: Moments
    warnings: list[str]


def spectral_moments(
    source: Any,
    *,
    pixel: Any = None,
    height_unit: str | None = None,
    channel: str | int | None = None,
    factor: Any = None,
) -> SpectralMoments:
    """Spectral moments of profiles, of a map less its plane, or of a line scan less its straight line.

    Parameters
    ----------
    source : path, array_like, pint.Quantity, xarray.DataArray, xarray.Dataset or SurfaceTopography topography
        A map, as `find_asperities` takes it, or a line scan: an array of one dimension, a text with one column
        or with the columns x and z, a line scan of an instrument.
    pixel : float, str, or pair of them, optional
        Width, or width and height, of a pixel: numbers in m, or texts with a unit. Needed for arrays.
    height_unit : str, optional
        Unit of the heights; for arrays m by default, for files the unit that they give.
    channel : str or int, optional
        Name, or number from 0, of the channel, where a file has several.
    factor : float, str, optional
        Factor for the numbers, such as 2 or ``"12 nm/V"``.

    Returns
    -------
    SpectralMoments
        In SI units.

    Raises
    ------
    SceneError
        An argument or the source is wrong.

    Examples
    --------
    >>> import stiction
    >>> of = stiction.spectral_moments("configs/maps/polished.txt")
    >>> round(of.alpha, 2), of.toml
    (8.83, 'spectrum = { m0 = "2.37296 nm^2", m2 = 6.25954e-5, m4 = "0.0145844 /um^2" }')
    """
    from .level import levelled
    from .reading import read_map
    from .spectrum import moments
    from .surface import grid_of

    height_map = read_map(
        source, pixel=pixel, height_unit=height_unit, channel=channel, factor=factor, lines=True
    )
    called = str(source) if isinstance(source, str | Path) else "source"
    if height_map.is_line:
        return in_numbers(line_scan(height_map, called).moments)
    try:
        return in_numbers(moments(levelled(grid_of(height_map), "plane")))
    except SceneError as error:
        raise SceneError(f"{called}: {error}") from None


def in_numbers(of: Moments) -> SpectralMoments:
    """Moments with the asperities that follow from them."""
    from .spectrum import equivalent

    theirs = equivalent(of)
    return SpectralMoments(
        of.m0, of.m2, of.m4, of.alpha, theirs.density, theirs.radius, theirs.height_mean, theirs.height_std
    )


def line_scan(height_map: HeightMap, called: str) -> LineScan:
    """Levels a line scan and takes its moments.

    Raises
    ------
    SceneError
        It has too few heights, or is flat; the message begins with `called`.
    """
    import numpy as np

    from .spectrum import moments, profile_levelled
    from .surface import grid_of

    try:
        grid = profile_levelled(grid_of(height_map))
        of = moments(grid)
    except SceneError as error:
        raise SceneError(f"{called}: {error}") from None
    count = grid.heights.size
    length = (count - 1) * grid.pixel[0]
    missing = int(np.count_nonzero(np.isnan(grid.heights)))
    return LineScan(length, count, missing, of, [*height_map.warnings, *_caveats(of, length, grid.pixel[0])])


def _caveats(of: Moments, length: float, pixel: float) -> Iterator[str]:
    from .surface import FEWEST_PIXELS, far_from_theory, wrong_unit

    yield from wrong_unit(math.sqrt(of.m2))
    if (pixels := of.wavelength / pixel) < FEWEST_PIXELS:
        yield (
            f"{pixels:.1f} pixels from one maximum to the next, fewer than {FEWEST_PIXELS:g}: pixels are too "
            "coarse for slopes and curvatures"
        )
    if (maxima := length / of.wavelength) < _FEWEST_MAXIMA:
        yield f"few maxima ({maxima:.0f}): moments are uncertain by {100.0 / math.sqrt(maxima):.0f} % or more"
    yield from far_from_theory(of)
