"""Checks of whether the model may have made the data."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .data import ABOVE, BELOW, MISSING
from .likelihood import Likelihood

__all__ = ["anderson_darling", "check_p_values"]

Array = NDArray[np.float64]


def check_p_values(likelihood: Likelihood, values: Array, random: np.random.Generator) -> Array:
    """Posterior-predictive p-value of each outcome.

    The discrepancy is Anderson and Darling's of P(outcome ≤ the measured one), which are uniform if the model made the data (D. Rubin, *Ann. Statist.* 12
    (1984) 1151; X.-L. Meng, *ibid.* 22 (1994) 1142). In the place of a limit is a number within it, drawn as the model has them. As the parameters are
    fitted to the same data, small values are rarer than they say. It is the sum over the conditions, so that what is too low under one and too high under
    another is seen.

    Parameters
    ----------
    likelihood : Likelihood
        Of the data.
    values : array (draws, batches, parameters)
        Draws of the posterior, in SI units.
    random : numpy.random.Generator

    Returns
    -------
    array (outcomes,)
    """
    cumulative = np.concatenate([likelihood.cumulative(piece) for piece in np.array_split(values, max(len(values) // 50, 1))])
    groups = likelihood.measured.groups
    kinds = np.concatenate([group.kinds for group in groups])
    within = random.random(cumulative.shape)
    uniform = np.where(kinds == BELOW, cumulative * within, np.where(kinds == ABOVE, 1.0 - (1.0 - cumulative) * within, cumulative))
    ends = np.cumsum([len(group.kinds) for group in groups])[:-1]
    result = []
    for j in range(kinds.shape[1]):
        known = np.split(kinds[:, j] != MISSING, ends)
        each = [of[:, which] for of, which in zip(np.split(uniform[:, :, j], ends, axis=1), known, strict=True) if which.any()]
        drawn = np.sum([anderson_darling(random.random(of.shape)) for of in each], axis=0)
        result.append(float((drawn >= np.sum([anderson_darling(of) for of in each], axis=0)).mean()))
    return np.array(result)


def anderson_darling(uniform: Array) -> Array:
    """A² of each row of numbers against the uniform distribution on 0 to 1 (T. W. Anderson, D. A. Darling, *J. Am. Stat. Assoc.* 49 (1954) 765).

    Examples
    --------
    >>> anderson_darling(np.array([[0.25, 0.5, 0.75]])).round(4)
    array([0.2694])
    """
    ordered = np.sort(np.clip(uniform, 1e-15, 1.0 - 1e-15), axis=1)
    count = ordered.shape[1]
    odd = 2.0 * np.arange(1, count + 1) - 1.0
    result: Array = -count - (odd * (np.log(ordered) + np.log1p(-ordered[:, ::-1]))).mean(axis=1)
    return result
