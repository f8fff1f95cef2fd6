"""The posterior of a few parameters on a grid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..errors import StictionError

__all__ = ["on_grid"]

Array = NDArray[np.float64]
# Points along each of one to three parameters, coarse and fine; normal scores where the prior ends.
_COARSE, _FINE, _END = {1: 161, 2: 33, 3: 21}, {1: 401, 2: 71, 3: 41}, 6.0
# ln of the posterior over its largest, where it ends; most looks at a smaller range.
_LOWEST, _LOOKS = -14.0, 6


def on_grid(
    log_likelihood: Callable[[Array], Array], dimensions: int, draws: int, random: np.random.Generator, *, is_rough: bool = False
) -> tuple[Array, Array]:
    """Draws of a posterior from a grid of normal scores, which is narrowed to where the posterior is.

    Parameters
    ----------
    log_likelihood : callable
        ln of the likelihood at normal scores, (points, parameters) → (points,).
    dimensions : int
        From 1 to 3.
    draws : int
        Their number; they are stratified, so that they err less than independent ones.
    random : numpy.random.Generator
    is_rough : bool
        Whether steps of a third of the standard deviation do.

    Returns
    -------
    tuple of arrays (draws, parameters), (draws,)
        Normal scores, and ln of the posterior there up to a constant.

    Raises
    ------
    StictionError
        The likelihood is nowhere a number.
    """
    ends = np.tile([-_END, _END], (dimensions, 1))
    for look in range(_LOOKS):
        axes, logs = _table(log_likelihood, ends, _COARSE[dimensions])
        narrower = _within(axes, logs, ends)
        is_small = ((narrower[:, 1] - narrower[:, 0]) < 0.6 * (ends[:, 1] - ends[:, 0])).any()
        ends = narrower
        if look and not is_small:
            break
    if not is_rough:
        axes, logs = _table(log_likelihood, ends, _FINE[dimensions])
    probability = np.exp(logs - logs.max()).ravel()
    steps = np.cumsum(probability)
    cells = np.searchsorted(steps, (np.arange(draws) + random.random(draws)) / draws * steps[-1])
    random.shuffle(cells)
    at = np.unravel_index(np.minimum(cells, probability.size - 1), logs.shape)
    z = np.stack([axis[place] for axis, place in zip(axes, at, strict=True)], axis=1)
    cell = [axis[1] - axis[0] for axis in axes]
    return z + cell * (random.random(z.shape) - 0.5), logs[at]


def _table(log_likelihood: Callable[[Array], Array], ends: Array, count: int) -> tuple[list[Array], Array]:
    """Axes, and ln of the posterior over them."""
    axes = [np.linspace(low, high, count) for low, high in ends]
    z = np.stack([of.ravel() for of in np.meshgrid(*axes, indexing="ij")], axis=1)
    logs = log_likelihood(z) - 0.5 * (z**2).sum(axis=1)
    if not np.isfinite(logs.max()):
        raise StictionError("the density of the simulated patches is no number at the data: check the units of the data, and the priors")
    return axes, logs.reshape([count] * len(axes))


def _within(axes: list[Array], logs: Array, ends: Array) -> Array:
    """The range of each axis in which the posterior is, a step further on both sides."""
    here = np.argwhere(logs > logs.max() + _LOWEST)
    steps = [axis[1] - axis[0] for axis in axes]
    low = [axis[place] - 1.5 * step for axis, place, step in zip(axes, here.min(axis=0), steps, strict=True)]
    high = [axis[place] + 1.5 * step for axis, place, step in zip(axes, here.max(axis=0), steps, strict=True)]
    return np.stack([np.maximum(low, ends[:, 0]), np.minimum(high, ends[:, 1])], axis=1)
