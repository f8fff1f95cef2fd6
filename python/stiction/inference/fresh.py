"""How far a density is off where it is used: by fresh patches at the posterior."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from .data import EXACT, MISSING, Group
from .emulator import Patches, as_measured
from .likelihood import Likelihood

__all__ = ["Misfit", "gain", "misfit", "scatter", "scores"]

Array = NDArray[np.float64]
# Steps of differences along the posterior's axes, in its standard deviations.
_STEP = 0.2


@dataclass(frozen=True)
class Misfit:
    """What fresh patches say of a density.

    Attributes
    ----------
    share : float
        Shift of the posterior's mean by the density's error over the posterior's standard deviation, or relative error of that: the largest of all
        parameters, without what the finite number of fresh patches adds.
    noise : float
        Standard error of it, from the number of fresh patches.
    distance : float
        The largest distance of the distribution of the patches' probability integral transform from the uniform one.
    """

    share: float
    noise: float
    distance: float


def misfit(likelihood: Likelihood, fresh: list[Patches], covariance: Array, random: np.random.Generator) -> Misfit:
    """Compares a density with patches that it was not fitted to, at parameters of the posterior.

    At the true parameters the mean of ∂ ln p(y | θ)/∂θ over patches is zero if p is right. If it is g + G (θ − θ̄) over the posterior with the mean θ̄, n patches
    shift that mean by C n g, with its covariance C, and change C by C n G C: the influence of a misspecified likelihood
    (H. White, *Econometrica* 50 (1982) 1). g and G are the regression of the scores of fresh patches at draws of the posterior.

    Parameters
    ----------
    likelihood : Likelihood
        Of the data, with the density.
    fresh : list of Patches
        For each set of conditions patches at draws of the posterior.
    covariance : array (parameters, parameters)
        Of the posterior of natural parameters; where batches differ of one of them.
    random : numpy.random.Generator
        It draws errors of the measurement, and outliers.
    """
    std = np.sqrt(np.diag(covariance))
    root = np.asarray(np.linalg.cholesky(covariance))
    shifts, squares, distance = np.zeros((len(std), 1 + len(std))), np.zeros((len(std), 1 + len(std))), 0.0
    for place, (group, patches) in enumerate(zip(likelihood.measured.groups, fresh, strict=True)):
        each = np.stack([
            scores(likelihood, place, as_measured(group, likelihood.with_outliers(logs, random), random), values, root)
            for values, logs in zip(patches.values, patches.logs, strict=True)
        ])  # fmt: skip
        natural = likelihood.priors.natural(patches.values)
        places = np.linalg.solve(root, (natural - natural.mean(axis=0)).T).T
        table = np.concatenate([np.ones((len(places), 1)), places], axis=1)
        count = len(group.values) * likelihood.largest_batch
        found, errors = _regression(table, each)
        shifts += count * found
        squares += (count * errors) ** 2
        distance = max(distance, _distance(likelihood, place, patches, random))
    # Of the standardised posterior to each parameter's own.
    own = root / std[:, None]
    shift, shift_noise = own @ shifts[:, 0], np.sqrt(own**2 @ squares[:, 0])
    widths = shifts[:, 1:] + shifts[:, 1:].T
    width, width_noise = 0.25 * np.einsum("ki,ij,kj->k", own, widths, own), 0.5 * np.sqrt(np.einsum("ki,ij,kj->k", own**2, squares[:, 1:], own**2))
    noises = np.concatenate([shift_noise, width_noise])
    # Without what the finite number of fresh patches adds.
    errors = np.sqrt(np.maximum(np.concatenate([shift, width]) ** 2 - noises**2, 0.0))
    worst = int(errors.argmax()) if errors.any() else int(noises.argmax())
    return Misfit(float(errors[worst]), float(noises[worst]), distance)


def gain(one: Likelihood, other: Likelihood, fresh: list[Patches], seed: int) -> float:
    """Gain of the expected ln of the likelihood of data like the given ones by `other` over `one`, less two standard errors.

    The expectation is over patches to which neither was fitted.
    """
    random, found, square = np.random.default_rng(seed), 0.0, 0.0
    for place, (group, patches) in enumerate(zip(one.measured.groups, fresh, strict=True)):
        each = []
        for values, logs in zip(patches.values, patches.logs, strict=True):
            measured = as_measured(group, one.with_outliers(logs, random), random)
            each.append(other.mixed(place, measured, values[None]) - one.mixed(place, measured, values[None]))
        found += len(group.values) * float(np.mean(each))
        square += len(group.values) ** 2 * float(np.var(each)) / np.size(each)
    return found - 2.0 * float(np.sqrt(square))


def _regression(table: Array, each: Array) -> tuple[Array, Array]:
    """Coefficients of scores (points, patches, parameters) over a table (points, terms), and their standard errors: (parameters, terms)."""
    patches = each.shape[1]
    inverse = np.linalg.inv(table.T @ table) @ table.T
    found = inverse @ each.mean(axis=1)
    errors = np.sqrt(inverse**2 @ each.var(axis=1, ddof=1) / patches)
    return found.T, errors.T


def scatter(likelihood: Likelihood, patches: list[Patches], z: Array) -> float:
    """The scatter of the posterior's means or widths by the finite number of patches in the fit, over its standard deviation, the largest of all parameters.

    Half of the difference between fits to two halves of the patches has it as its standard deviation; it is from three ways to halve their rows.

    Parameters
    ----------
    likelihood : Likelihood
        Of the data, with densities fitted to all patches.
    patches : list of Patches
        These.
    z : array (draws, parameters)
        Draws of its posterior.
    """
    whole = likelihood(z)
    z, whole = z[np.isfinite(whole)], whole[np.isfinite(whole)]
    natural = likelihood.priors.natural(likelihood.values(z))
    squares = 0.0
    for way in (1, 2, 3):
        one, other = (_moments(likelihood.refitted([_half(of, way, which) for of in patches])(z) - whole, natural) for which in (0, 1))
        squares += (0.5 * (one - other) / natural.std(axis=0)) ** 2 / 3.0
    return float(np.sqrt(squares).max())


def _half(of: Patches, way: int, which: int) -> Patches:
    """The first (0) or the second (1) half of the rows, by the sum of binary digits of their numbers: the last digit, the one before it, or both, for the ways 1, 2 and 3."""
    rows = np.bitwise_count(np.arange(len(of.values)) & way) % 2 == which
    return Patches(of.values[rows], of.logs[rows])


def _moments(logs: Array, values: Array) -> Array:
    """Means and standard deviations of draws with weights whose logarithms are given: (2, parameters)."""
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    mean = weights @ values
    return np.stack([mean, np.sqrt(weights @ (values - mean) ** 2)])


def scores(likelihood: Likelihood, place: int, group: Group, values: Array, axes: Array) -> Array:
    """∂ ln p/∂x of each patch at a point, with natural parameters θ + axes x, (patches, axes).

    Parameters are often known far worse than a combination of them, over which the posterior's own axes are short: differences are along the axes.

    Parameters
    ----------
    likelihood : Likelihood
        Its densities and its mean fraction of outliers are taken.
    place : int
        The set of conditions.
    group : Group
        The patches.
    values : array (parameters,)
        The point, SI.
    axes : array (parameters, axes)
        Of the posterior of natural parameters: its covariance is axes axesᵀ.
    """
    priors = likelihood.priors
    at = priors.natural(values[None])
    points = priors.values(np.concatenate([at + sign * _STEP * axes.T for sign in (0.5, -0.5)]))
    up, down = np.split(likelihood.mixed(place, group, points), 2)
    result: Array = ((up - down) / _STEP).T
    return result


def _distance(likelihood: Likelihood, place: int, patches: Patches, random: np.random.Generator) -> float:
    """Kolmogorov's distance of P(outcome ≤ a patch's measured one) over patches from the uniform distribution, the largest of all outcomes."""
    group, emulator, each = likelihood.measured.groups[place], likelihood.emulator.of_group(place), []
    # Limits would leave the upper or lower ones alone.
    group = dataclasses.replace(group, kinds=np.where(group.kinds == MISSING, MISSING, EXACT))
    for values, logs in zip(patches.values, patches.logs, strict=True):
        measured = as_measured(group, logs, random)
        each.append(np.where(measured.kinds == EXACT, emulator.cumulative((measured,), values[None])[0], np.nan))
    columns = (column[~np.isnan(column)] for column in np.concatenate(each).T)
    return max((float(stats.ks_1samp(column, stats.uniform.cdf).statistic) for column in columns if column.size), default=0.0)
