"""The two cut-offs of a map: what pixels and tip resolve, and no shorter than a contact is wide."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .. import quantities
from ..errors import SceneError

__all__ = ["APART", "Cutoffs", "chosen", "contact_width"]

#: The larger cut-off over the smaller one.
APART = 2.0
# Largest cut-off over the shorter side, and steps of the search per factor of 2.
_SIDE, _STEPS = 0.25, 8


_RESOLVED = "the shortest that pixels and tip resolve"


@dataclass(frozen=True)
class Cutoffs:
    """The smaller of two cut-offs.

    Attributes
    ----------
    smaller : float
        It, m; the other is twice as long.
    width : float
        Width of contacts at pull-off on the surface behind it, m.
    why : str
        What decided.
    """

    smaller: float
    width: float
    why: str

    @property
    def both(self) -> tuple[float, float]:
        """The smaller and the larger one, m."""
        return self.smaller, APART * self.smaller


def contact_width(radius: float, work_of_adhesion: float, reduced_modulus: float) -> float:
    """Twice the unit of contact radius 2(πΔγR²/K)^(1/3), m: contacts of spheres at pull-off are about that wide.

    Parameters
    ----------
    radius, work_of_adhesion, reduced_modulus : float
        R, m; Δγ, J/m²; E*, Pa, with K = 4E*/3.
    """
    return 2.0 * math.cbrt(math.pi * work_of_adhesion * radius**2 / (4.0 / 3.0 * reduced_modulus))


def chosen(shortest: float, side: float, width: Callable[[float], float], given: float | None) -> Cutoffs:
    """The smallest cut-off that is resolved and no shorter than the contacts behind it are wide.

    Parameters
    ----------
    shortest : float
        The shortest wave that pixels and tip resolve, m.
    side : float
        Shorter side of the map, m, four or more times as long as the larger cut-off.
    width : callable
        Width of contacts, m, behind a cut-off, m.
    given : float, optional
        The smaller cut-off where it is given, m.

    Raises
    ------
    SceneError
        There is no room for two cut-offs.
    """
    most = _SIDE * side / APART
    if given is not None:
        if not shortest * (1.0 - 1e-9) <= given <= most:
            ends = [quantities.si(end, "m", 3) for end in (shortest, most)]
            raise SceneError(
                f"smooth = {quantities.si(given, 'm')}: the smaller of two cut-offs is between {ends[0]}, which pixels and tip resolve, "
                f"and {ends[1]}, an eighth of the side"
            )
        return Cutoffs(given, width(given), "as given")
    if not shortest <= most:
        raise SceneError(
            f"waves from {quantities.si(shortest, 'm', 3)} on are resolved, and an eighth of the side is {quantities.si(most, 'm', 3)}: "
            "no room for two cut-offs; a larger map, smaller pixels or a sharper tip are needed"
        )
    count = max(math.ceil(_STEPS * math.log2(most / shortest)), 1) + 1
    for cutoff in np.geomspace(shortest, most, count):
        if (wide := width(float(cutoff))) <= cutoff:
            return Cutoffs(float(cutoff), wide, _RESOLVED if cutoff == shortest else "as wide as contacts")
    return Cutoffs(shortest, width(shortest), _RESOLVED)
