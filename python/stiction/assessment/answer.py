"""The answer of a map: what `record` keeps and `summary` prints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..maps.combine import PowerSpectrum
from ..maps.surface import Surface
from .criteria import Criterion
from .cutoffs import Cutoffs
from .ways import Way

__all__ = ["Answer"]


@dataclass(frozen=True)
class Answer:
    """What was found: material and scans, cut-offs, ways, criteria.

    Attributes
    ----------
    names : list of str
        The scans, the largest first.
    template : bool
        Whether material and model come from the template.
    surfaces : list of Surface
        Of a single map behind both cut-offs, of several scans the largest one levelled.
    spectrum : PowerSpectrum
        Of all scans.
    cutoffs : Cutoffs
        Both cut-offs.
    area : float
        The area asked for, m².
    above : float or None
        The force asked for, N.
    material : dict
        E*, Pa, Δγ, J/m², and with a hardness that, Pa.
    ways : list of Way
        The map itself, where there is one map, and patches, with both cut-offs; none where boundary elements are needed in any case.
    criteria : list of Criterion
        All of them.
    factor : float
        By which the pull-off may be off.
    changed : float or None
        By which fraction the history changes the pull-off of the map itself, where patches are computed on approach for it.
    warnings : list of str
        Of the maps.
    """

    names: list[str]
    template: bool
    surfaces: list[Surface]
    spectrum: PowerSpectrum
    cutoffs: Cutoffs
    area: float
    above: float | None
    material: dict[str, float]
    ways: list[Way]
    criteria: list[Criterion]
    factor: float
    changed: float | None
    warnings: list[str]

    @property
    def patches(self) -> list[Way]:
        """The ways that are patches of the area asked for."""
        return [way for way in self.ways if way.name == "patches"]

    @property
    def forces(self) -> Any:
        """The one distribution: pull-offs of the patches with both cut-offs in equal parts, (2 replicas,), N."""
        return np.concatenate([way.forces for way in self.patches] or [np.zeros(0)])

    @property
    def failed(self) -> list[Criterion]:
        """The criteria that are not met."""
        return [one for one in self.criteria if one.advice]
