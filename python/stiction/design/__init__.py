"""Probabilities of rare patches; the roughness, film or size that makes them as rare as wanted.

`probability` finds probabilities down to 1e-6 and below, by tilted heights above a threshold and importance splitting below one; `design`
the value of a number of a scene with a wanted probability, `best` the value with the least or largest pull-off. Needs
``pip install stiction[inference]``.
"""

from .estimate import Probability
from .rare import Patches
from .search import Best, Design, best, design, probability

__all__ = ["Best", "Design", "Patches", "Probability", "best", "design", "probability"]
