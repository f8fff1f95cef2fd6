"""An estimated probability."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from ..errors import StictionError

__all__ = ["LEAST", "NEVER", "Probability", "checked", "shared"]

# Share of the largest weight at most.
_LARGEST = 0.2

#: Events that are rarer count as those that never are.
LEAST = 1e-18


@dataclass(frozen=True)
class Probability:
    """The probability of an event, and its errors.

    Attributes
    ----------
    value, standard_error : float
        Estimate and its standard error; 0 for an event that is impossible, or rarer than `LEAST`.
    replicas : int
        Patches that were computed for it; below a threshold each time that one is moved counts.
    hits : int
        Patches of them in the event; below a threshold of the last patches of each run.
    total : float
        Mean weight of all drawn patches; 1 within its error.
    total_error : float
        Its standard error.
    effective : float
        The number of alike patches (below a threshold: runs) that weigh as much as the event's, (Σw)²/Σw².
    largest : float
        Share of the largest weight in the sum of them.
    """

    value: float
    standard_error: float
    replicas: int
    hits: int
    total: float
    total_error: float
    effective: float
    largest: float

    @property
    def relative_error(self) -> float:
        """Standard error over the value."""
        return self.standard_error / self.value if self.value > 0.0 else float("inf")

    @property
    def interval(self) -> tuple[float, float]:
        """Interval that contains the probability in 95 of 100 cases.

        It is Student's in the logarithm, by the number of patches that decide. Where all patches are in the event, the
        lower end is the probability with which one in 40 ensembles would be so.
        """
        if self.hits == self.replicas:
            return (0.025 ** (1.0 / self.replicas), 1.0) if self.replicas else (0.0, LEAST)
        spread = float(np.exp(stats.t.ppf(0.975, self.effective - 1.0) * self.relative_error))
        return self.value / spread, min(self.value * spread, 1.0)


#: No patch is in the event, or they are rarer than `LEAST`.
NEVER = Probability(0.0, 0.0, 0, 0, 1.0, 0.0, 0.0, 0.0)


def shared(weights: NDArray[np.float64]) -> tuple[float, float]:
    """The number of alike weights that weights count as, and the fraction of the largest."""
    if not weights.any():
        return 0.0, 1.0
    return float(weights.sum() ** 2 / (weights**2).sum()), float(weights.max() / weights.sum())


def checked(found: Probability, what: str, least: float, units: str) -> Probability:
    """A probability that rests on enough patches or runs.

    Raises
    ------
    StictionError
        It rests on few of them, so that neither value nor error is known.
    """
    if found.effective >= least and found.largest <= _LARGEST:
        return found
    raise StictionError(
        f"{what} rests on few {units}: the effective sample size is {found.effective:.1f}, and the largest has "
        f"{100.0 * found.largest:.0f} % of the weight, where {least:.0f} and {100.0 * _LARGEST:.0f} % are the limits: a "
        "smaller `error` draws more"
    )
