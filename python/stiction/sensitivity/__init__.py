"""Which number of a scene matters most: Sobol indices of what patches do, and the scatter between patches beside them.

`sensitivity` computes them for a scene with priors (`stiction.priors`), `draw` draws them, `indices.estimated` finds them from outcomes
of any other model. Needs ``pip install stiction[inference]``.
"""

from .figure import draw
from .study import QUANTITIES, sensitivity

__all__ = ["QUANTITIES", "draw", "sensitivity"]
