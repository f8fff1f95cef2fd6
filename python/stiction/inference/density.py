"""The distribution of a patch's outcome over parameters: mixtures of Gaussians whose parts depend on the parameters.

Few asperities pull in steps: the logarithm of a small patch's pull-off has a peak where one asperity pulls, another where two do. In the
logarithm such peaks move with the parameters, and their fractions change, both smoothly. So the density of the logarithms **y** of the
outcomes at the parameters **x** is taken as

    p(y | x) = Σ_k w_k(x) Π_j φ((y_j − μ_kj(x)) / σ_kj(x)) / σ_kj(x),

where ln w_k (up to normalisation), μ_kj and ln σ_kj are linear in x, and all means μ_kj of an outcome have a quadratic form of x in common: a mixture density
network (C. M. Bishop, *Mixture density networks*, Aston University NCRG/94/004, 1994) whose networks are polynomials, fitted by maximum likelihood to all
simulated patches. Quadratic forms of each part would triple the coefficients of five parameters, and the scatter of posteriors with them, and describe patches
that were not fitted worse.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

__all__ = ["Density", "fit", "log_sum_exp"]

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


def _monomials(x: Array, degree: int) -> tuple[Array, Array]:
    """1 and the parameters, (points, 1 + parameters), and products of two of them, (points, monomials), of which there are none below the degree 2."""
    pairs = combinations_with_replacement(range(x.shape[1]), 2) if degree > 1 else ()
    columns = [x[:, one] * x[:, other] for one, other in pairs]
    return np.column_stack([np.ones(len(x)), x]), np.stack(columns, axis=1) if columns else np.empty((len(x), 0))


@dataclass(frozen=True)
class Density:
    """A fitted density.

    Attributes
    ----------
    slopes : array (1 + parameters, parts, 1 + 2 outcomes)
        Coefficients of 1 and the parameters, of each part: of the logit of its weight, the means, the logarithms of the widths.
    curvature : array (monomials, outcomes)
        Coefficients of products of two parameters, in the means of all parts; without any the means are linear.
    shift, scale : arrays (outcomes,)
        y = (ln outcome − shift) / scale is what the mixture is of.
    """

    slopes: Array
    curvature: Array
    shift: Array
    scale: Array

    def parts(self, x: Array) -> tuple[Array, Array, Array]:
        """Log weights (points, parts), means and widths (points, parts, outcomes) of ln outcome at x."""
        log_weights, means, log_widths = _parts(_monomials(x, 2 if len(self.curvature) else 1), self.slopes, self.curvature)
        return log_weights, self.shift + self.scale * means, self.scale * _width(log_widths)

    def draw(self, x: Array, random: np.random.Generator) -> Array:
        """One patch at each of the points x: logarithms of its outcomes, (points, outcomes)."""
        log_weights, means, widths = self.parts(x)
        steps = np.cumsum(np.exp(log_weights), axis=1)
        part = (random.random((len(x), 1)) * steps[:, -1:] > steps).sum(axis=1)
        chosen = np.arange(len(x)), part
        result: Array = means[chosen] + widths[chosen] * random.standard_normal(means[chosen].shape)
        return result


def _parts(table: tuple[Array, Array], slopes: Array, curvature: Array) -> tuple[Array, Array, Array]:
    """Log weights (points, parts), means and logarithms of widths (points, parts, outcomes) of scaled outcomes."""
    linear, quadratic = table
    outcomes = curvature.shape[1]
    raw = np.tensordot(linear, slopes, axes=1)
    means = raw[..., 1 : 1 + outcomes] + (quadratic @ curvature)[:, None]
    log_weights = raw[..., 0] - log_sum_exp(raw[..., 0], axis=1)[:, None]
    return log_weights, means, np.clip(raw[..., 1 + outcomes :], -30, 30)


def _width(raw: Array) -> Array:
    result: Array = np.exp(raw) + _SMALLEST_WIDTH
    return result


def fit(x: Array, logs: Array, weights: Array, *, parts: int, degree: int = 2) -> Density:
    """Fits a density to simulated patches.

    Parameters
    ----------
    x : array (points, parameters)
        Parameters, scaled to about −1 to 1.
    logs : array (points, replicas, outcomes)
        Logarithms of the outcomes of patches, independent between points and replicas.
    weights : array (points,)
        What a patch of each point counts: local fits have small ones far off.
    parts : int
        Parts of the mixture.
    degree : {1, 2}
        Degree of the means.
    """
    _, replicas, outcomes = logs.shape
    flat = logs.reshape(-1, outcomes)
    shift, scale = flat.mean(axis=0), flat.std(axis=0)
    y = (logs - shift) / scale
    table = _monomials(x, degree)
    every = np.repeat(weights[:, None], replicas, axis=1)
    return Density(*_maximised(_start(table, y, weights, parts), table, y, every), shift, scale)


def _start(table: tuple[Array, Array], y: Array, weights: Array, parts: int) -> tuple[Array, Array]:
    """Slopes and curvature of parts of equal fractions, from the first outcome's low tail to its high one."""
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
    means = np.stack([piece.mean(axis=1) for piece in pieces], axis=1)
    log_widths = np.log(np.maximum(np.stack([piece.std(axis=1) for piece in pieces], axis=1), least[:, None]))
    root, (linear, quadratic) = np.sqrt(weights)[:, None], table
    both = np.concatenate([linear, quadratic], axis=1)
    curvature = _least_squares(root * both, root * means.mean(axis=1))[linear.shape[1] :]
    wanted = np.concatenate([means - (quadratic @ curvature)[:, None], log_widths], axis=2)
    slopes = np.zeros((linear.shape[1], parts, 1 + 2 * outcomes))
    slopes[..., 1:] = _least_squares(root * linear, root * wanted.reshape(len(linear), -1)).reshape(-1, parts, 2 * outcomes)
    return slopes, curvature


def _least_squares(table: Array, wanted: Array) -> Array:
    return np.asarray(np.linalg.lstsq(table, wanted, rcond=1e-8)[0])


def _maximised(begin: tuple[Array, Array], table: tuple[Array, Array], y: Array, weights: Array) -> tuple[Array, Array]:
    """Slopes and curvature of the largest likelihood."""
    (slopes, curvature), outcomes = begin, y.shape[2]
    total, start = weights.sum(), np.concatenate([of.ravel() for of in begin])

    def split(flat: Array) -> tuple[Array, Array]:
        one, other = np.split(flat, [slopes.size])
        return one.reshape(slopes.shape), other.reshape(curvature.shape)

    def objective(flat: Array) -> tuple[float, Array]:
        log_weights, means, log_widths = _parts(table, *split(flat))
        widths = _width(log_widths)
        deviation = (y[:, None] - means[:, :, None]) / widths[:, :, None]  # (points, parts, replicas, outcomes)
        each = (log_weights - np.log(widths).sum(axis=2))[:, :, None] - 0.5 * (deviation**2).sum(axis=3)
        top = each.max(axis=1, keepdims=True)
        each = np.exp(each - top)
        sums = each.sum(axis=1, keepdims=True)
        value = float((weights * (np.log(sums) + top)[:, 0]).sum())
        share = each / sums * weights[:, None]  # (points, parts, replicas)
        of_part = share.sum(axis=2)
        slope = np.empty((*of_part.shape, 1 + 2 * outcomes))
        slope[..., 0] = of_part - np.exp(log_weights) * weights.sum(axis=1)[:, None]
        slope[..., 1 : 1 + outcomes] = np.einsum("pkr,pkrj->pkj", share, deviation) / widths
        slope[..., 1 + outcomes :] = (
            np.einsum("pkr,pkrj->pkj", share, deviation**2) - of_part[..., None]
        ) * (np.exp(log_widths) / widths)
        gradient = np.tensordot(table[0].T, slope, axes=1), table[1].T @ slope[..., 1 : 1 + outcomes].sum(axis=1)
        pull = flat - start
        value -= 0.5 * _RIDGE * float(pull @ pull)
        return -value / total, (_RIDGE * pull - np.concatenate([of.ravel() for of in gradient])) / total

    found: Any = minimize(objective, start, jac=True, method="L-BFGS-B", options={"maxiter": _STEPS, "maxcor": 20, "ftol": 1e-9})
    return split(found.x)
