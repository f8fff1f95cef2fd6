"""Whether pull-offs of a map can be trusted: each criterion with its limit, and the factor that is left."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import quantities
from ..maps.level import Grid
from ..maps.spectrum import Moments
from ..maps.surface import ANISOTROPIC, KURTOSIS, SKEWNESS
from ..results import Run
from .cutoffs import Cutoffs
from .ways import Way

__all__ = [
    "ELEMENTS",
    "LARGEST_FACTOR",
    "Criterion",
    "Sampling",
    "factor_of",
    "of_contacts",
    "of_shape",
    "of_spread",
    "of_surface",
    "sampling",
]

#: Largest factor of an answer.
LARGEST_FACTOR = 3.0
# Convention: by md the shipped map has 1.4 times the pull-off of boundary elements (docs/my-afm-map.md); of loads it is up to 1.25
# (docs/coupling.md).
_SHAPE = 1.6
# Wave from maximum to maximum over the cut-off: white noise has 0.96, a self-affine surface with a Hurst exponent of 0 has 1.36.
_NOISE = 1.2
# Largest α that was compared with boundary elements (docs/measured.md, the contact-mechanics challenge).
_ALPHA = 76.0
# Fewest summits on a map, and fraction of patches of the size of the map that are beyond it.
_SUMMITS, _BEYOND = 20.0, 0.01
# Standard errors from which on a skewness or kurtosis is no chance.
_ERRORS = 3.0

ELEMENTS, _COUPLE, _SCAN, _MORE = "boundary elements", "couple", "scan", "more maps"


@dataclass(frozen=True)
class Criterion:
    """One criterion of the assessment.

    Attributes
    ----------
    name, text : str
        Its name, and what was found, with its limit.
    factor : float
        By which the pull-off may be off for it, 1 or more.
    advice : str
        Where to go instead, where it is not met; empty where it is met.
    """

    name: str
    text: str
    factor: float = 1.0
    advice: str = ""


@dataclass(frozen=True)
class Sampling:
    """Standard errors of a map as a sample of a Gaussian surface: of σ, relative; of skewness and excess kurtosis."""

    std: float
    skewness: float
    kurtosis: float


def sampling(grid: Grid) -> Sampling:
    """Standard errors by the autocorrelation ρ of a levelled map (ny, nx), m: of N heights √(Σρ²/2N), √(6Σρ³/N), √(24Σρ⁴/N).

    ρ is that of the map, whose noise doubles Σρ²; levelling takes as much from long waves: on maps like the shipped one σ has
    7.2 %, and 6.4 % from map to map.
    """
    heights = np.nan_to_num(grid.heights - np.nanmean(grid.heights))
    power = np.abs(np.fft.rfft2(heights)) ** 2
    correlation = np.fft.irfft2(power, heights.shape)
    correlation /= correlation[0, 0]
    second, third, fourth = (float(np.sum(correlation**power)) / heights.size for power in (2, 3, 4))
    return Sampling(math.sqrt(0.5 * second), math.sqrt(6.0 * max(third, 0.0)), math.sqrt(24.0 * fourth))


def of_surface(of: Moments, errors: Sampling) -> Iterator[Criterion]:
    """Whether the heights of a map are Gaussian and isotropic, as patches of its spectrum are."""
    skew, kurtosis = max(SKEWNESS, _ERRORS * errors.skewness), max(KURTOSIS, _ERRORS * errors.kurtosis)
    is_far = abs(of.skewness) > skew or abs(of.excess_kurtosis) > kurtosis
    yield Criterion(
        "Gaussian",
        f"skewness {_n(of.skewness)} (to {_n(skew)}), excess kurtosis {_n(of.excess_kurtosis)} (to {_n(kurtosis)})",
        advice=_MORE if is_far else "",
    )
    ratio = (
        max(of.slope_x, of.slope_y) / min(of.slope_x, of.slope_y)
        if min(of.slope_x, of.slope_y) > 0.0
        else math.inf
    )
    yield Criterion(
        "isotropic",
        f"mean square slopes along x and y differ {_n(ratio)} times (to {_n(ANISOTROPIC)})",
        advice=_MORE if ratio > ANISOTROPIC else "",
    )


def of_shape(wave: float, alpha: float, cutoffs: Cutoffs) -> Iterator[Criterion]:
    """Noise, bandwidth and the width of contacts, of the surface behind the smaller cut-off.

    Parameters
    ----------
    wave : float
        Mean distance from maximum to maximum of a profile, m.
    alpha : float
        Nayak's parameter.
    cutoffs : Cutoffs
        The cut-offs.
    """
    ratio = wave / cutoffs.smaller
    yield Criterion(
        "noise",
        f"maxima are {_n(ratio)} cut-offs apart (from {_n(_NOISE)}; noise has 0.96)",
        advice=_SCAN if ratio < _NOISE else "",
    )
    yield Criterion(
        "bandwidth", f"alpha = {_n(alpha)} (to {_n(_ALPHA)})", advice=ELEMENTS if alpha > _ALPHA else ""
    )
    wide = cutoffs.width / cutoffs.smaller
    yield Criterion(
        "merging", f"contacts are {_n(wide)} cut-offs wide (to 1)", advice=ELEMENTS if wide > 1.0 else ""
    )


def of_contacts(ways: Sequence[Way], count: float) -> Iterator[Criterion]:
    """Number of summits on the map, and independence of asperities at the worst of all ways."""
    yield Criterion(
        "summits",
        f"{count:.0f} on the map with the larger cut-off (from {_SUMMITS:.0f})",
        advice=_SCAN if count < _SUMMITS else "",
    )
    if all("coupling" in way.run for way in ways):
        yield Criterion("independence", "asperities are coupled")
        return
    order = ("good", "a shift", "invalid")
    worst = max(ways, key=lambda way: order.index(str(way.run.independence.attrs["verdict"])))
    word = str(worst.run.independence.attrs["verdict"])
    yield Criterion("independence", f"{word}: {_coupling(worst.run)}", advice=_independent(worst.run, word))


def _coupling(run: Run) -> str:
    """The figure that is nearest to its limit, or furthest beyond."""
    words = {
        "relative_attractive_stiffness": ("attraction {} k_s (to {})", 1.0),
        "relative_fluctuation": ("fluctuation {} sigma (to {})", 1.0),
        "contact_share": ("{} % of the area in contact (to {} %)", 100.0),
    }
    limits = {name: float(run.independence.attrs[f"invalid_{name}"]) for name in words}
    worst = max(words, key=lambda name: float(run.independence[name]) / limits[name])
    said, factor = words[worst]
    return said.format(_n(factor * float(run.independence[worst])), _n(factor * limits[worst]))


def _independent(run: Run, word: str) -> str:
    if word != "invalid":
        return ""
    return (
        ELEMENTS
        if float(run.independence["contact_share"]) >= float(run.independence.attrs["invalid_contact_share"])
        else _COUPLE
    )


def of_spread(ways: Sequence[Way], is_own_area: bool, of_sigma: float, error: float) -> Iterator[Criterion]:
    """What the pull-off depends on: the cut-off, the size of the map, the plastic contact, and the place of the map itself.

    Parameters
    ----------
    ways : sequence of Way
        All of them.
    is_own_area : bool
        Whether patches are as large as the map.
    of_sigma, error : float
        Ratio of pull-offs with σ lower and higher by its relative standard error, and that error.
    """
    patches, own = ([way for way in ways if way.name == name] for name in ("patches", "map"))
    medians = [float(np.nanmedian(way.forces)) for way in patches]
    apart = max(medians) / min(medians) if min(medians) > 0.0 else math.inf
    yield Criterion("cut-off", f"pull-offs with both cut-offs differ {_n(apart)} times", math.sqrt(apart))
    yield Criterion(
        "map size",
        f"sigma is known to {_n(100.0 * error)} %, pull-off to {_n(of_sigma)} times (95 %)",
        of_sigma,
    )
    ends = [_model_range(way.run) for way in own]
    if any(ratio > 1.0 for ratio in ends):
        yield Criterion("plasticity", f"plastic contacts differ {_n(max(ends))} times", max(ends))
    yield Criterion("shape", f"summits are no spheres: {_SHAPE:g} times between asperities and boundary elements", _SHAPE)
    if own and is_own_area:
        below = float(
            np.mean([np.mean(patch.forces <= way.forces[0]) for patch, way in zip(patches, own, strict=True)])
        )
        yield Criterion(
            "this map",
            f"adheres more than {_n(100.0 * below)} % of patches ({100.0 * _BEYOND:g} to {100.0 * (1.0 - _BEYOND):g} %)",
            advice="" if _BEYOND <= below <= 1.0 - _BEYOND else _MORE,
        )


def _model_range(run: Run) -> float:
    """Largest over smallest pull-off by any plastic contact; 1 where nothing yields."""
    if run.model_range is None or "pull_off_force" not in run.model_range:
        return 1.0
    of = run.model_range["pull_off_force"]
    low, high = float(of.min()), float(of.max())
    return high / low if low > 0.0 else 1.0


def factor_of(criteria: Sequence[Criterion]) -> float:
    """The factor of the answer: independent factors add as squares of their logarithms."""
    squares: list[Any] = [math.log(one.factor) ** 2 for one in criteria]
    return math.exp(math.sqrt(math.fsum(squares)))


def _n(value: float) -> str:
    return quantities.number(value, 2)
