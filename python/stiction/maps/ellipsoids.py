"""Summits that are ellipsoids, in laws that are for spheres: a Hertz contact of principal curvatures κ₁ ≥
κ₂."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import special

from .summits import Summits

__all__ = ["Shape", "forces_of_spheres", "hertz_radius", "shape"]


def hertz_radius(sharp: float, blunt: float) -> float:
    """Radius of the sphere that has the Hertz force of an ellipsoid on a plane at every interference, m.

    P = (4/3) E* √R δ^(3/2) with R = π² R_D(0, k², 1)/(6 K³ κ₂) (Johnson 1985, section 4.2), where the ratio k
    = b/a of the half-widths of the contact follows from κ₁/κ₂ = R_D(0, 1, k²)/R_D(0, k², 1), and K = R_F(0,
    k², 1), in Carlson's elliptic integrals.

    Parameters
    ----------
    sharp, blunt : float
        Principal curvatures κ₁ ≥ κ₂ > 0, 1/m.

    Examples
    --------
    >>> round(hertz_radius(2e6, 2e6) * 2e6, 14)
    1.0
    """
    # The summary alone needs it, and it takes longer to import than all else here.
    from scipy import optimize

    ratio = max(sharp / blunt, 1.0)

    def off(log_k: float) -> float:
        square = math.exp(2.0 * log_k)
        first, second = special.elliprd(0.0, 1.0, square), special.elliprd(0.0, square, 1.0)
        return math.log(first / second) - math.log(ratio)

    # The ratio is between 1/k and 1/k².
    log_k = float(optimize.brentq(off, -math.log(ratio) - 1e-3, 1e-3, xtol=1e-15, rtol=1e-15))
    square = math.exp(2.0 * log_k)
    whole = special.elliprf(0.0, square, 1.0)
    return float(math.pi**2 * special.elliprd(0.0, square, 1.0) / (6.0 * whole**3 * blunt))


def forces_of_spheres(ratio: float) -> tuple[float, float]:
    """Hertz forces at an interference of two spheres over an ellipsoid's whose principal curvatures have this
    ratio.

    The spheres have R = 1/mean curvature and R = 1/√(κ₁κ₂); both forces are at most 1, and the second is the
    larger one.

    Examples
    --------
    >>> [round(force, 4) for force in forces_of_spheres(2.0)]
    [0.9614, 0.9901]
    """
    exact = hertz_radius(ratio, 1.0)
    return math.sqrt(2.0 / (1.0 + ratio) / exact), math.sqrt(1.0 / math.sqrt(ratio) / exact)


@dataclass(frozen=True)
class Shape:
    """Deviation of summits from spheres.

    Attributes
    ----------
    saddles : int
        Summits whose smaller principal curvature is not positive.
    ratio : float
        Median of the ratio of the others' principal curvatures; NaN if there are none.
    """

    saddles: int
    ratio: float


def shape(found: Summits) -> Shape:
    """Looks at the principal curvatures of summits."""
    sharp, blunt = found.principal_curvatures
    there = blunt > 0.0
    ratio = float(np.median(sharp[there] / blunt[there])) if there.any() else math.nan
    return Shape(saddles=int(np.count_nonzero(~there)), ratio=ratio)
