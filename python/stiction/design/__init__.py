"""How rare is a patch that pulls too hard, or not enough; and which roughness, film or size makes it as rare as wanted.

`probability` finds probabilities down to 1e-6 and below, by tilted heights above a threshold and importance splitting below one; `design`
the value of a number of a scene with which that is as rare as wanted, `best` that with the least or largest pull-off. Needs
``pip install stiction[inference]``.
"""

from .estimate import Probability
from .rare import Patches
from .search import Best, Design, best, design, probability

__all__ = ["Best", "Design", "Patches", "Probability", "best", "design", "probability"]
