"""Laws of heights of a scene, and the attraction of an asperity."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from .. import single
from ..errors import SceneError

# Attributes of a run that `asperity` takes by their names.
_ASPERITY = ("reduced_modulus", "work_of_adhesion", "equilibrium_spacing", "hardness", "poisson_ratio", "lubricant_thickness", "law")

__all__ = ["LAWS", "Array", "attraction", "law"]

Array = NDArray[np.float64]

# Laws of heights whose densities are known.
LAWS = ("gaussian", "truncated", "exponential", "weibull", "lognormal")


def law(given: Any, sigma: float) -> Any:
    """The law of heights of a scene, of mean 0 and the standard deviation σ_s, as the program has it."""
    table = {"law": given} if isinstance(given, str) else dict(given)
    name = table["law"]
    if name == "gaussian":
        return stats.norm(scale=sigma)
    if name == "truncated":
        return stats.truncnorm(table.get("lower", -np.inf), table.get("upper", np.inf), scale=sigma)
    if name == "exponential":
        law = stats.expon()
    else:
        law = (stats.weibull_min if name == "weibull" else stats.lognorm)(table["shape"])
    scale = sigma / float(law.std())
    # The law about its mean and in metres.
    return law.dist(*law.args, loc=-scale * float(law.mean()), scale=scale)


def attraction(run: Mapping[Any, Any], low: float, high: float) -> tuple[Array, Array]:
    """Interferences (m) and the attraction of an asperity there (N), close where it jumps.

    `run` are the attributes of a run, with the numbers of its asperities.
    """
    # Without a hardness nothing yields.
    known = (key for key in _ASPERITY if key == "law" or np.isfinite(run[key]))
    law = {key: run[key] for key in known} | {"radius": run["asperity_radius"]}

    def solved(at: Array) -> Array:
        values: Array = -single.asperity(interference=at, **law).external_force.values
        return values

    at = np.linspace(low, high, 2**16)
    values = solved(at)
    scale = float(values.max())
    if not scale > 0.0:
        raise SceneError(f"model.law = {law['law']!r}: an asperity of this law does not attract, so nothing pulls off")
    for _ in range(14):
        jumps = np.flatnonzero((np.abs(np.diff(values)) > 2e-3 * scale) & (values[1:] > -2.0 * scale))
        if not jumps.size:
            break
        middle = 0.5 * (at[jumps] + at[jumps + 1])
        at, values = np.insert(at, jumps + 1, middle), np.insert(values, jumps + 1, solved(middle))
    return at, values
