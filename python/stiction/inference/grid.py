"""The posterior of a few parameters on a grid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..errors import StictionError

__all__ = ["on_grid"]

Array = NDArray[np.float64]
# Points along each of one to three axes, coarse and fine, and standard deviations to both sides.
_COARSE, _FINE, _END = {1: 161, 2: 41, 3: 21}, {1: 401, 2: 71, 3: 41}, 6.0
# Standard deviations of what a grid is about, over its first steps' unit.
_ABOUT = 0.6
# Cells along an axis that a density fills at least where it is resolved, as a Gaussian of one step.
_CELLS = 3.5
# Most looks at a smaller range, and by how much a look may narrow or widen axes that are good.
_LOOKS, _ALIKE = 20, 1.5


def on_grid(
    log_likelihood: Callable[[Array], Array], dimensions: int, draws: int, random: np.random.Generator, *,
    about: Array | None = None, is_rough: bool = False,
) -> tuple[Array, Array] | None:
    """Draws of a posterior from a grid of normal scores along its own axes, or None where it is too thin and curved for one.

    The grid is narrowed step by step: of the largest power of the likelihood that it resolves, the mean and the covariance are the next one's middle
    and axes, so that a posterior that is thin and lies askew is found, too.

    Parameters
    ----------
    log_likelihood : callable
        ln of the likelihood at normal scores, (points, parameters) → (points,); −∞ where it is not known.
    dimensions : int
        From 1 to 3.
    draws : int
        Their number; they are stratified, so that they err less than independent ones.
    random : numpy.random.Generator
    about : array (points, parameters), optional
        Normal scores about which the likelihood is known; without them the prior.
    is_rough : bool
        Whether steps of a third of the standard deviation do.

    Returns
    -------
    tuple of arrays (draws, parameters), (draws,), or None
        Normal scores, and ln of the posterior there up to a constant.

    Raises
    ------
    StictionError
        The likelihood is nowhere a number.
    """
    middle: Array = np.zeros(dimensions)
    axes: Array = np.eye(dimensions, dtype=np.float64)
    if about is not None:
        middle = about.mean(axis=0)
        axes = np.asarray(_ABOUT * np.linalg.cholesky(np.cov(about.T).reshape(dimensions, -1)), dtype=np.float64)
    whole_frame = None
    for _ in range(_LOOKS):
        frame = middle, axes
        places, z, logs = _table(log_likelihood, frame, _COARSE[dimensions])
        power, probability = _resolved(logs, z)
        centre = probability @ z
        away = z - centre
        found = np.linalg.cholesky((probability[:, None] * away).T @ away + 1e-18 * np.eye(dimensions))
        spread = np.linalg.svd(np.linalg.solve(axes, found), compute_uv=False)
        whole_frame = frame if power == 1.0 else whole_frame
        if power == 1.0 and spread.max() < _ALIKE and spread.min() > 1.0 / _ALIKE:
            break
        middle, axes = centre, np.asarray(found, dtype=np.float64)
    if whole_frame is None:
        return None
    # Of a posterior with several maxima, or flat ends, axes may stay apart: the last grid that resolves it will do.
    if not is_rough or whole_frame is not frame:
        places, z, logs = _table(log_likelihood, whole_frame, (_COARSE if is_rough else _FINE)[dimensions])
    whole = logs - 0.5 * (z**2).sum(axis=1)
    steps = np.cumsum(np.exp(whole - whole.max()))
    cells = np.searchsorted(steps, (np.arange(draws) + random.random(draws)) / draws * steps[-1])
    random.shuffle(cells)
    cells = np.minimum(cells, len(steps) - 1)
    step = places[1] - places[0]
    return z[cells] + (step * (random.random((draws, dimensions)) - 0.5)) @ whole_frame[1].T, whole[cells]


def _table(log_likelihood: Callable[[Array], Array], frame: tuple[Array, Array], count: int) -> tuple[Array, Array, Array]:
    """Places along each axis, normal scores (points, parameters), and ln of the likelihood there."""
    middle, axes = frame
    places = np.linspace(-_END, _END, count)
    u = np.stack([of.ravel() for of in np.meshgrid(*[places] * len(middle), indexing="ij")], axis=1)
    z = middle + u @ axes.T
    logs = log_likelihood(z)
    if not np.isfinite(logs.max()):
        raise StictionError("the density of the simulated patches is no number at the data: check the units of the data, and the priors")
    return places, z, logs


def _resolved(logs: Array, z: Array) -> tuple[float, Array]:
    """The largest power of the likelihood that the points resolve, and its posterior probabilities, (points,)."""
    known = np.isfinite(logs)
    before = np.where(known, -0.5 * (z**2).sum(axis=1), -np.inf)
    logs = np.where(known, logs, 0.0)
    power, probability = 1.0, np.empty(0)
    for power in 0.7 ** np.arange(60):
        whole = power * logs + before
        probability = np.exp(whole - whole.max())
        probability /= probability.sum()
        if 1.0 / (probability**2).sum() > _CELLS ** z.shape[1]:
            break
    return float(power), probability
