"""Probabilities of rare patches; the roughness, film or size that makes them as rare as wanted; the number of forces to measure.

`probability` finds probabilities down to 1e-6 and below, by tilted heights above a threshold and importance splitting below one; `design`
the value of a number of a scene with a wanted probability, `best` the value with the least or largest pull-off, `measurements` the number of
forces with which a parameter is known as well as wanted. Needs
``pip install stiction[inference]``.
"""

from .estimate import Probability
from .needed import Choice, Limit, Needed, measurements
from .rare import Patches
from .search import Best, Design, best, design, probability

__all__ = ["Best", "Choice", "Design", "Limit", "Needed", "Patches", "Probability", "best", "design", "measurements", "probability"]
