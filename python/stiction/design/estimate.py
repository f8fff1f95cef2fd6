"""An estimated probability."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["LEAST", "NEVER", "Probability"]

#: Events that are rarer count as those that never are.
LEAST = 1e-18


@dataclass(frozen=True)
class Probability:
    """The probability of an event, and how well it is known.

    Attributes
    ----------
    value, standard_error : float
        Estimate and its standard error; 0 of an event that is impossible, or rarer than `LEAST`.
    replicas : int
        Patches that were computed for it; below a threshold each time that one is moved counts.
    hits : int
        Those of them in the event; below a threshold of the last patches of each run.
    total : float
        Mean weight of all patches that are drawn, which is 1 but for chance.
    total_error : float
        Its standard error.
    """

    value: float
    standard_error: float
    replicas: int
    hits: int
    total: float
    total_error: float

    @property
    def relative_error(self) -> float:
        """Standard error over the value."""
        return self.standard_error / self.value if self.value > 0.0 else float("inf")

    @property
    def interval(self) -> tuple[float, float]:
        """What holds the probability in 95 of 100 cases: normal in the logarithm, never below 0."""
        spread = float(np.exp(1.96 * self.relative_error))
        return self.value / spread, min(self.value * spread, 1.0)


#: No patch is in the event, or they are rarer than `LEAST`.
NEVER = Probability(0.0, 0.0, 0, 0, 1.0, 0.0)
