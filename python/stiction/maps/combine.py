"""`stiction.combine_spectra`: one power spectrum of several scans of a surface, of each scan where it is reliable.

Conventions: C(q) is the two-dimensional power spectral density of an isotropic surface (m⁴), with the variance of heights
m₀ = ∫qC dq/2π; hence m₂ = ∫q³C dq/4π and m₄ = 3∫q⁵C dq/16π of its profiles. q = 2π/λ, 1/m. Sources: T. D. B. Jacobs, T. Junge,
L. Pastewka, Surf. Topogr.: Metrol. Prop. 5 (2017) 013001; of the tip A. Sanner and others, Appl. Surf. Sci. Adv. 7 (2022) 100190.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import quantities
from ..errors import SceneError
from .lengths import length
from .moments import SpectralMoments, in_numbers

if TYPE_CHECKING:
    from .level import Grid
    from .surface import Surface

__all__ = ["PowerSpectrum", "ScanSpectrum", "combine_spectra", "combined", "of_scan", "read_scans", "tip_radius"]

Array = NDArray[np.float64]

# Bins of wavevectors per factor of 10.
_BINS = 24
# Waves over the shorter side that levelling and the window leave alone; pixels of the shortest reliable wave.
_SIDE, _PIXELS = 1.0 / 3.0, 4.0
# Curvature of peaks over that of the tip from which on the scan shows the tip (Sanner and others 2022).
_OF_TIP = 0.5
# Largest fraction of heights that may be missing, and largest gap between scans, as a ratio of waves.
_MISSING, _GAP = 0.05, 2.0
# Steps of integrals per factor of e.
_STEPS = 100


@dataclass(frozen=True)
class ScanSpectrum:
    """Radial power spectrum of one scan.

    Attributes
    ----------
    name : str
        The scan.
    side : float
        Its shorter side, m.
    wavevector, density : numpy.ndarray
        Mean q of each bin, (n,), 1/m, rising, and C(q), (n,), m⁴, the mean over directions.
    modes : numpy.ndarray
        Fourier components of each bin, (n,).
    longest, shortest : float
        Waves between which it is reliable, m: a third of its side, and the larger of four pixels and what the tip resolves.
    """

    name: str
    side: float
    wavevector: Array
    density: Array
    modes: Array
    longest: float
    shortest: float

    @property
    def reliable(self) -> NDArray[np.bool_]:
        """Which bins are reliable, (n,)."""
        wave = 2.0 * math.pi / self.wavevector
        return np.asarray((wave <= self.longest) & (wave >= self.shortest))


@dataclass(frozen=True)
class PowerSpectrum:
    """Power spectrum of a surface from scans of several sizes.

    Attributes
    ----------
    wavevector, density : numpy.ndarray
        q, (n,), 1/m, rising, and C(q), (n,), m⁴: the mean over the scans that are reliable there, each with the weight of its
        Fourier components. Beyond all limits it is that of the largest and of the finest scan.
    scans : list of ScanSpectrum
        The scans, from the largest to the smallest.
    warnings : list of str
        What should be looked at, a sentence each.
    """

    wavevector: Array
    density: Array
    scans: list[ScanSpectrum]
    warnings: list[str] = field(default_factory=list)

    @property
    def shortest(self) -> float:
        """The shortest reliable wave of all scans, m."""
        return min(scan.shortest for scan in self.scans)

    def moments(self, cutoff: Any = 0.0) -> SpectralMoments:
        """Moments of the surface behind the Gaussian filter of `find_asperities`; by default without it.

        Parameters
        ----------
        cutoff : float or str
            Its cut-off wavelength, a number in m or a text with a unit.
        """
        from .spectrum import Moments

        cut = length("cutoff", cutoff)
        if not 0.0 <= cut < math.inf:
            raise SceneError(f"cutoff = {cutoff!r}: a cut-off wavelength is 0 or longer")
        first, last = math.log(self.wavevector[0]), math.log(self.wavevector[-1])
        at = np.linspace(first, last, max(math.ceil(_STEPS * (last - first)), 2))
        q, density = np.exp(at), np.exp(np.interp(at, np.log(self.wavevector), np.log(self.density)))
        density = density * 4.0 ** -((q * cut / (2.0 * math.pi)) ** 2)
        m0, m2, m4 = (
            share * float(np.trapezoid(q ** (power + 2) * density, at))
            for power, share in ((0, 0.5 / math.pi), (2, 0.25 / math.pi), (4, 3.0 / (16.0 * math.pi)))
        )
        return in_numbers(Moments(m0, m2, m2, m4, 0.0, 0.0))


def combine_spectra(
    scans: Sequence[Any],
    *,
    tip: Any = None,
    pixel: Any = None,
    height_unit: str | None = None,
    channel: str | int | None = None,
    factor: Any = None,
    mask: Any = None,
    level_rows: str | None = None,
    level: str = "plane",
) -> PowerSpectrum:
    """Combines scans of several sizes of one surface into one power spectrum, each where it is reliable.

    A scan counts for waves from the larger of four pixels and what its tip resolves up to a third of its side. The tip resolves
    waves as long as the stencil at which no second difference along the rows is below −1/2R (Sanner and others 2022) or longer.

    Parameters
    ----------
    scans : sequence of maps
        As `find_asperities` takes them, one or more; arrays of one pixel, or with coordinates.
    tip : float or str, optional
        Radius R of the tip, a number in m or a text with a unit. By default pixels alone limit the waves.
    pixel, height_unit, channel, factor, mask, level_rows, level : optional
        As of `find_asperities`, for all scans; a list `pixel` has one for each.

    Returns
    -------
    PowerSpectrum
        With its moments up to a cut-off.

    Raises
    ------
    SceneError
        An argument or a scan is wrong, or a scan is nowhere reliable.

    Examples
    --------
    >>> import stiction
    >>> found = stiction.combine_spectra(["configs/maps/polished.txt"])
    >>> round(found.moments("200 nm").radius * 1e6)
    8
    """
    if isinstance(scans, str | Path) or not isinstance(scans, Sequence) or not scans:
        raise SceneError("scans: a list of maps is needed, such as ['1um.spm', '10um.spm']")
    reading = {"pixel": pixel, "height_unit": height_unit, "channel": channel, "factor": factor, "mask": mask}
    return read_scans(scans, reading, {"level": level, "level_rows": level_rows}, tip)[1]


def read_scans(
    scans: Sequence[Any], reading: Mapping[str, Any], levelling: Mapping[str, Any], tip: Any
) -> tuple[list[Surface], PowerSpectrum]:
    """The levelled scans in their order, and their combined spectrum.

    Parameters
    ----------
    scans : sequence of maps
        As `find_asperities` takes them, one or more.
    reading, levelling : mapping
        Arguments of `read_map`, and `level` and `level_rows`; a list `pixel` has one for each of several scans.
    tip : float or str, optional
        As of `combine_spectra`.

    Raises
    ------
    SceneError
        As of `combine_spectra`.
    """
    # SciPy takes as long to import as the rest of the package.
    from .reading import read_map
    from .surface import found_on, steps_of

    radius = tip_radius(tip)
    steps = steps_of(**levelling, smooth=None, prominence=None, min_distance=None, cutoffs=None)
    surfaces = []
    for scan, pixel in zip(scans, _pixels(reading["pixel"], len(scans)), strict=True):
        called = str(scan) if isinstance(scan, str | Path) else "map"
        surfaces.append(found_on(read_map(scan, **{**reading, "pixel": pixel}), steps, called))
    return surfaces, combined([of_scan(one.grid, one.map.name, radius) for one in surfaces])


def _pixels(given: Any, count: int) -> list[Any]:
    """The pixel of each scan: a list has one for each of several scans, everything else is of all."""
    if count == 1 or not isinstance(given, list):
        return [given] * count
    if len(given) != count:
        raise SceneError(f"pixel = {given!r}: one for each of the {count} scans is needed")
    return given


def tip_radius(tip: Any) -> float | None:
    """The radius of a tip, m, from a number in m or a text with a unit; None stays.

    Raises
    ------
    SceneError
        It is no length above 0.
    """
    if tip is None:
        return None
    radius = length("tip", tip)
    if not 0.0 < radius < math.inf:
        raise SceneError(f'tip = {tip!r}: the radius of a tip is above 0, such as "10 nm"')
    return radius


def of_scan(grid: Grid, name: str, tip: float | None) -> ScanSpectrum:
    """The radial spectrum of a levelled map (ny, nx), m, under a Hann window along both sides.

    Raises
    ------
    SceneError
        Too many heights are missing, or pixels or tip leave no reliable wave; the message begins with `name`.
    """
    heights, sides = grid.heights, [n * step for n, step in zip(grid.heights.shape, grid.steps, strict=True)]
    known = ~np.isnan(heights)
    if not known.mean() > 1.0 - _MISSING:
        raise SceneError(
            f"{name}: {100.0 * (1.0 - known.mean()):.0f} % of the heights are missing; a spectrum needs a map with 5 % at most"
        )
    window = np.outer(*(np.hanning(n + 2)[1:-1] for n in heights.shape)) * known
    filled = np.where(known, heights, 0.0)
    weighted = window * (filled - (window * filled).sum() / window.sum())
    power = np.abs(np.fft.fft2(weighted)) ** 2 * math.prod(grid.steps) / np.sum(window**2)
    down, along = (
        2.0 * math.pi * np.fft.fftfreq(n, step) for n, step in zip(heights.shape, grid.steps, strict=True)
    )
    q = np.hypot(down[:, np.newaxis], along).ravel()
    used = (q > 0.0) & (q <= math.pi / max(grid.steps))
    bins = np.floor(_BINS * np.log10(q[used])).astype(int)
    bins -= bins.min()
    modes = np.bincount(bins)
    some = modes > 0
    mean_q, mean = (
        np.bincount(bins, weights=of)[some] / modes[some] for of in (q[used], power.ravel()[used])
    )
    longest = _SIDE * min(sides)
    shortest = max(_PIXELS * max(grid.steps), _tip_wave(grid, tip) if tip else 0.0)
    if not shortest < longest:
        raise SceneError(
            f"{name}: no wave is reliable: pixels{' and tip' if tip else ''} need {quantities.si(shortest, 'm', 3)} or more, "
            f"and a third of the side is {quantities.si(longest, 'm', 3)}; leave this scan out, or take a larger one"
        )
    return ScanSpectrum(name, min(sides), mean_q, mean, modes[some].astype(float), longest, shortest)


def _tip_wave(grid: Grid, tip: float) -> float:
    """The shortest wave that a tip of a radius, m, resolves, m; 0 where it shows nowhere."""
    heights, step = grid.heights, grid.pixel[0]
    spans = np.unique(np.geomspace(1, max(heights.shape[1] // 2 - 1, 1), 60).astype(int))
    shows = 0.0
    for span in spans:
        bent = heights[:, 2 * span :] - 2.0 * heights[:, span:-span] + heights[:, : -2 * span]
        if np.nanmin(bent, initial=0.0) < -_OF_TIP / tip * (span * step) ** 2:
            shows = 2.0 * span * step
    return shows


def combined(scans: list[ScanSpectrum]) -> PowerSpectrum:
    """One spectrum of the scans, each where it is reliable."""
    scans = sorted(scans, key=lambda scan: -scan.side)
    finest = min(scans, key=lambda scan: scan.shortest)
    weights: dict[int, list[Any]] = {}
    for scan in scans:
        wave = 2.0 * math.pi / scan.wavevector
        ends = (scan is scans[0]) & (wave > scan.longest) | (scan is finest) & (wave < scan.shortest)
        for at in np.flatnonzero(scan.reliable | ends):
            place = math.floor(_BINS * math.log10(scan.wavevector[at]))
            weights.setdefault(place, []).append((scan.wavevector[at], scan.density[at], scan.modes[at]))
    q, density = [], []
    for place in sorted(weights):
        mean, values, modes = np.array(weights[place]).T
        q.append(np.average(mean, weights=modes))
        density.append(np.average(values, weights=modes))
    return PowerSpectrum(np.array(q), np.array(density), scans, list(_gaps(scans)))


def _gaps(scans: list[ScanSpectrum]) -> Iterator[str]:
    """Waves between two scans of which none is reliable."""
    reached = scans[0].shortest
    for scan in scans[1:]:
        if scan.longest * _GAP < reached:
            ends = [quantities.si(wave, "m", 3) for wave in (scan.longest, reached)]
            yield f"no scan is reliable from {ends[0]} to {ends[1]}: the spectrum is interpolated there; add a scan of a size between"
        reached = min(reached, scan.shortest)
