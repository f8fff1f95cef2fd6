"""How far a density is off where it is used: by fresh patches at the posterior."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .data import Group
from .emulator import Emulator, Patches, as_measured
from .likelihood import Likelihood

__all__ = ["Misfit", "misfit", "scores"]

Array = NDArray[np.float64]
# Steps of differences, in standard deviations of the posterior.
_STEP = 0.2


@dataclass(frozen=True)
class Misfit:
    """What fresh patches say of a density.

    Attributes
    ----------
    share : float
        Shift of the posterior's mean by the density's error, over the posterior's standard deviation: the largest of all parameters.
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

    At the true parameters the mean of ∂ ln p(y | θ)/∂θ over patches is zero if p is right. If it is g, n patches shift the mean of the posterior by
    C n g, with its covariance C: the influence function of a misspecified likelihood (H. White, *Econometrica* 50 (1982) 1).

    Parameters
    ----------
    likelihood : Likelihood
        Of the data, with the density.
    fresh : list of Patches
        For each set of conditions patches at draws of the posterior.
    covariance : array (parameters, parameters)
        Of the posterior of natural parameters; where batches differ of one of them.
    random : numpy.random.Generator
        It draws errors of the measurement.
    """
    std = np.sqrt(np.diag(covariance))
    slope, scatter, distance = np.zeros(len(std)), np.zeros_like(covariance), 0.0
    for place, (group, patches) in enumerate(zip(likelihood.measured.groups, fresh, strict=True)):
        each = np.concatenate([
            scores(likelihood, place, as_measured(group, logs, random), values, _STEP * std)
            for values, logs in zip(patches.values, patches.logs, strict=True)
        ])  # fmt: skip
        count = len(group.values) * likelihood.largest_batch
        slope += count * each.mean(axis=0)
        scatter += count**2 / len(each) * np.cov(each.T).reshape(scatter.shape)
        distance = max(distance, _distance(likelihood.emulator.of_group(place), patches))
    shift, noise = covariance @ slope / std, np.sqrt(np.diag(covariance @ scatter @ covariance)) / std
    worst = int(np.abs(shift).argmax())
    return Misfit(float(abs(shift[worst])), float(noise[worst]), distance)


def scores(likelihood: Likelihood, place: int, group: Group, values: Array, steps: Array) -> Array:
    """∂ ln p/∂θ of each patch at a point, over natural parameters, (patches, parameters).

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
    steps : array (parameters,)
        Differences are over these steps of natural parameters.
    """
    priors = likelihood.priors
    at = priors.natural(values[None])
    points = priors.values(np.concatenate([at + sign * np.diag(steps) for sign in (0.5, -0.5)]))
    up, down = np.split(likelihood.mixed(place, group, points), 2)
    result: Array = ((up - down) / steps[:, None]).T
    return result


def _distance(emulator: Emulator, patches: Patches) -> float:
    """Kolmogorov's distance of the patches' P(outcome ≤ theirs) from the uniform distribution, the largest of all outcomes."""
    (density,) = emulator.densities
    x = emulator.scaled(np.repeat(patches.values, patches.logs.shape[1], axis=0))
    uniform = np.sort(density.cumulative(x, patches.logs.reshape(len(x), -1)), axis=0)
    places = np.arange(len(uniform))[:, None] / len(uniform)
    return float(max((places + 1.0 / len(uniform) - uniform).max(), (uniform - places).max()))
