"""Sensitivity of patches to the numbers of a scene: Sobol indices of their outcomes, and the variance between patches.

`sensitivity` computes them for a scene with priors (`stiction.priors`), `draw` draws them, `indices.estimated` finds them from outcomes
of any other model. Needs ``pip install stiction[inference]``.
"""

from .figure import draw
from .study import sensitivity
from .words import QUANTITIES

__all__ = ["QUANTITIES", "draw", "sensitivity"]
