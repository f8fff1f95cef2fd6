"""Patches of several sizes: from how many asperities on the statistical integral is good enough.

`run` computes them, a sweep over the nominal area. `study` says from such a sweep how the pull-off of a patch
goes to the pull-off of the integral, with the power law that `Approach` is.
"""

from .patches import run
from .study import ACCURACIES, QUANTILES, Approach, NoApproach, is_study, reached, study

__all__ = ["ACCURACIES", "QUANTILES", "Approach", "NoApproach", "is_study", "reached", "run", "study"]
