"""The distribution of a patch's outcome over parameters: mixtures of Gaussians whose parts depend on the parameters.

Few asperities pull in steps: the logarithm of a small patch's pull-off has a peak where one asperity pulls, another where two do. In the
logarithm such peaks move with the parameters, and their fractions change, both smoothly. So the density of the logarithms **y** of the
outcomes at the parameters **x** is taken as

    p(y | x) = Σ_k w_k(x) Π_j φ((y_j − μ_kj(x)) / σ_kj(x)) / σ_kj(x),

where ln w_k (up to normalisation), μ_kj and ln σ_kj are polynomials of x: a mixture density network (C. M. Bishop, *Mixture density
networks*, Aston University NCRG/94/004, 1994) whose networks are polynomials, fitted by maximum likelihood to all simulated patches.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import log_ndtr

__all__ = ["Density", "features", "fit", "log_sum_exp"]

Array = NDArray[np.float64]
_HALF_LOG_2PI = 0.5 * np.log(2.0 * np.pi)
# The least width of a part, over the standard deviation of all outcomes.
_SMALLEST_WIDTH = 3e-3
# The pull of every coefficient towards the beginning of the fit, in patches of unit information.
_RIDGE = 1.0
# Steps of a fit at most.
_STEPS = 400


def log_sum_exp(logs: Array, axis: int) -> Array:
    """ln Σ exp of finite numbers along an axis. SciPy's, which knows every kind of array, takes several times as long for small ones.

    Examples
    --------
    >>> log_sum_exp(np.log([[1.0, 3.0]]), axis=1).round(6) == np.log(4.0).round(6)
    array([ True])
    """
    top = logs.max(axis=axis, keepdims=True)
    result: Array = np.log(np.exp(logs - top).sum(axis=axis)) + top.squeeze(axis)
    return result


def features(x: Array, degree: int) -> Array:
    """Monomials of parameters.

    Parameters
    ----------
    x : array (points, parameters)
        Parameters, scaled to about −1 to 1.
    degree : int
        The largest total degree.

    Returns
    -------
    array (points, monomials)
        The constant first.

    Examples
    --------
    >>> features(np.array([[2.0, 3.0]]), 2)
    array([[1., 2., 3., 4., 6., 9.]])
    """
    columns = [np.ones(len(x))]
    for order in range(1, degree + 1):
        for which in combinations_with_replacement(range(x.shape[1]), order):
            columns.append(np.prod(x[:, which], axis=1))
    return np.stack(columns, axis=1)


@dataclass(frozen=True)
class Density:
    """A fitted density.

    Attributes
    ----------
    coefficients : array (monomials, parts, 1 + 2 outcomes)
        Of each part: the logit of its weight, the means, the logarithms of the widths.
    degree : int
        Degree of the polynomials.
    shift, scale : arrays (outcomes,)
        y = (ln outcome − shift) / scale is what the mixture is of.
    """

    coefficients: Array
    degree: int
    shift: Array
    scale: Array

    def parts(self, x: Array) -> tuple[Array, Array, Array]:
        """Log weights (points, parts), means and widths (points, parts, outcomes) of ln outcome at x."""
        raw = np.tensordot(features(x, self.degree), self.coefficients, axes=1)
        outcomes = len(self.shift)
        logits, means, widths = raw[..., 0], raw[..., 1 : 1 + outcomes], raw[..., 1 + outcomes :]
        log_weights = logits - log_sum_exp(logits, axis=-1)[..., None]
        return log_weights, self.shift + self.scale * means, self.scale * _width(np.clip(widths, -30, 30))

    def cumulative(self, x: Array, logs: Array) -> Array:
        """P(outcome j ≤ e^logs) at each of the points x; (points, outcomes) of logs of that shape."""
        log_weights, means, widths = self.parts(x)
        each = np.exp(log_ndtr((logs[:, None, :] - means) / widths) + log_weights[..., None])
        result: Array = each.sum(axis=1)
        return result

    def draw(self, x: Array, random: np.random.Generator) -> Array:
        """One patch at each of the points x: logarithms of its outcomes, (points, outcomes)."""
        log_weights, means, widths = self.parts(x)
        steps = np.cumsum(np.exp(log_weights), axis=1)
        part = (random.random((len(x), 1)) * steps[:, -1:] > steps).sum(axis=1)
        chosen = np.arange(len(x)), part
        result: Array = means[chosen] + widths[chosen] * random.standard_normal(means[chosen].shape)
        return result


def _width(raw: Array) -> Array:
    return np.exp(raw) + _SMALLEST_WIDTH


def fit(
    x: Array,
    logs: Array,
    weights: Array,
    *,
    parts: int,
    degree: int,
) -> Density:
    """Fits a density to simulated patches.

    Parameters
    ----------
    x : array (points, parameters)
        Parameters, scaled to about −1 to 1.
    logs : array (points, replicas, outcomes)
        Logarithms of the outcomes of patches, independent between points and replicas.
    weights : array (points,)
        What a patch of each point counts: local fits have small ones far off.
    parts, degree : int
        Parts of the mixture and degree of its polynomials.
    """
    _, replicas, outcomes = logs.shape
    flat = logs.reshape(-1, outcomes)
    shift, scale = flat.mean(axis=0), flat.std(axis=0)
    y = (logs - shift) / scale
    table = features(x, degree)
    start = _start(table, y, weights, parts)
    every = np.repeat(weights[:, None], replicas, axis=1)
    return Density(_maximised(start, table, y, every), degree, shift, scale)


def _start(table: Array, y: Array, weights: Array, parts: int) -> Array:
    """Coefficients of parts of equal fractions, from the first outcome's low tail to its high one."""
    _, replicas, outcomes = y.shape
    order = np.argsort(y[:, :, 0], axis=1)
    y = np.take_along_axis(y, order[:, :, None], axis=1)
    share = max(replicas // parts, 1)
    pieces = [
        y[:, slice(*np.clip([k * share, (k + 1) * share if k < parts - 1 else replicas], 0, replicas))]
        for k in range(parts)
    ]
    # A single patch has no standard deviation: a part is at least as wide as a fraction of the point's own.
    least = 0.03 * y.std(axis=1) / parts + 1e-6
    root = np.sqrt(weights)[:, None]
    result = np.zeros((table.shape[1], parts, 1 + 2 * outcomes))
    for k, piece in enumerate(pieces):
        wanted = np.concatenate([piece.mean(axis=1), np.log(np.maximum(piece.std(axis=1), least))], axis=1)
        result[:, k, 1:] = np.linalg.lstsq(root * table, root * wanted, rcond=1e-8)[0]
    return result


def _maximised(begin: Array, table: Array, y: Array, weights: Array) -> Array:
    shape, outcomes = begin.shape, y.shape[2]
    total = weights.sum()

    def objective(flat: Array) -> tuple[float, Array]:
        coefficients = flat.reshape(shape)
        raw = np.tensordot(table, coefficients, axes=1)  # (points, parts, 1 + 2 outcomes)
        logits, means, log_widths = raw[..., 0], raw[..., 1 : 1 + outcomes], np.clip(raw[..., 1 + outcomes :], -30, 30)
        log_weights = logits - log_sum_exp(logits, axis=1)[:, None]
        widths = _width(log_widths)
        deviation = (y[:, None] - means[:, :, None]) / widths[:, :, None]  # (points, parts, replicas, outcomes)
        each = (log_weights - np.log(widths).sum(axis=2))[:, :, None] - 0.5 * (deviation**2).sum(axis=3)
        top = each.max(axis=1, keepdims=True)
        each = np.exp(each - top)
        sums = each.sum(axis=1, keepdims=True)
        value = float((weights * (np.log(sums) + top)[:, 0]).sum())
        share = each / sums * weights[:, None]  # (points, parts, replicas)
        of_part = share.sum(axis=2)
        slope = np.empty_like(raw)
        slope[..., 0] = of_part - np.exp(log_weights) * weights.sum(axis=1)[:, None]
        slope[..., 1 : 1 + outcomes] = np.einsum("pkr,pkrj->pkj", share, deviation) / widths
        slope[..., 1 + outcomes :] = (
            np.einsum("pkr,pkrj->pkj", share, deviation**2) - of_part[..., None]
        ) * (np.exp(log_widths) / widths)
        pull = coefficients - begin
        value -= 0.5 * _RIDGE * float((pull**2).sum())
        gradient = np.tensordot(table.T, slope, axes=1) - _RIDGE * pull
        return -value / total, -gradient.ravel() / total

    found: Any = minimize(
        objective, begin.ravel(), jac=True, method="L-BFGS-B", options={"maxiter": _STEPS, "maxcor": 20, "ftol": 1e-9}
    )
    result: Array = found.x.reshape(shape)
    return result
