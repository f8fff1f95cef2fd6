"""What one patch shows of the parameters: its Fisher information, from patches simulated about the medians of the priors.

The density of the outcome over the parameters (`stiction.inference.density`) is fitted several times, to patches that the fits do not share. The
information is the mean of s_a s_bᵀ over further patches at the medians, with the scores s_a and s_b by two of the fits. Errors of the
fits are independent, so they average to nothing also in combinations that patches do not show. The square of one fit's score
would make every combination look measurable.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.stats import qmc

from ..inference.density import Density, fit, log_sum_exp
from ..inference.emulator import Patches, outcomes_of, simulate
from ..priors import Prior, Priors
from ..progress import Bar, work

__all__ = ["Curve", "Error", "Experiments", "Local", "Measured", "Shown", "simulated_experiments"]

Array = NDArray[np.float64]

# Patches about the medians, and at them.
_ABOUT, _AT = 16_000, 4000
# Half of the width of what is simulated, over the standard deviation of the prior, and of logarithms at least and at most.
_SPREAD, _NARROWEST, _WIDEST = 1.5, 0.2, 0.5
# Fits, and the parts of each, as `stiction infer` has them; draws of the posterior of a synthetic experiment.
_FITS, _PARTS, _DRAWS = 4, 6, 2048
# Step of a score, over the half width of what is simulated.
_STEP = 0.05
# Quantiles of Student's law for errors from that number of fits: of 95 % intervals, and of what is surely above 0.
_QUANTILE, _SURE = stats.t.ppf([0.975, 0.95], _FITS - 1)
#: The largest number of forces that is looked at.
MOST = 100_000
_COUNTS = np.geomspace(1.0, MOST, 401)


@dataclass(frozen=True)
class Error:
    """Standard deviation of the measurement of one force: of the force (N), or as a fraction of it."""

    value: float
    relative: bool

    def on(self, logs: Array, random: np.random.Generator) -> Array:
        """Logarithms of forces as they are measured; forces below the error are not resolved."""
        noise = self.value * random.standard_normal(logs.shape)
        result: Array = logs + noise if self.relative else np.log(np.maximum(np.exp(logs) + noise, self.value))
        return result


class Local:
    """The neighbourhood of the medians of priors, in natural parameters (`Priors.natural`).

    Attributes
    ----------
    middle, half : arrays (parameters,)
        Medians, and half widths of what is simulated.
    covariance : array (parameters, parameters)
        Of the priors.
    points : array (points, parameters)
        Places of simulated patches from −1 to 1; each has its mirror image, so that a slope takes no part of a curvature.
    """

    def __init__(self, priors: Priors, error: Error | None) -> None:
        self.priors, self.error = priors, error
        count = len(priors.priors)
        self.medians = np.array([[prior.median for prior in priors.priors]])
        self.middle: Array = priors.natural(self.medians)[0]
        drawn = priors.natural(priors.draw(qmc.Sobol(count, seed=1).random(2**13)))
        self.covariance: Array = np.cov(drawn.T).reshape(count, count)
        self.half: Array = np.array([_half(of, deviation) for of, deviation in zip(priors.priors, np.sqrt(np.diag(self.covariance)), strict=True)])
        # As many points as a polynomial of second degree has numbers, or more.
        pairs = max(2 ** math.ceil(math.log2((count + 1) * (count + 2) / 4)), 4)
        half = 2.0 * qmc.Sobol(count, seed=2).random(pairs) - 1.0
        self.points: Array = np.concatenate([half, -half])

    def scaled(self, values: Array) -> Array:
        """Parameters in SI units (n, parameters) from −1 to 1, and what is beyond at the ends."""
        result: Array = np.clip((self.priors.natural(values) - self.middle) / self.half, -1.0, 1.0)
        return result

    def logs(self, values: Array, settings: Mapping[str, Any], patches: int, seed: int, threads: int | None) -> Array:
        """Logarithms of the forces of patches at parameters, as they are measured: (points, patches, 1)."""
        floor = self.error.value if self.error and not self.error.relative else 0.0
        made: Patches = simulate(
            self.priors, (self._outcome(settings),), values, replicas=patches, seed=seed, threads=threads, floors=floor, conditions=settings,
        )  # fmt: skip
        return made.logs if self.error is None else self.error.on(made.logs, np.random.default_rng([seed, 1]))

    def _outcome(self, settings: Mapping[str, Any]) -> str:
        after = "pull_off_after_preload"
        has_preload = "preload" in self.priors.tables.get("instability", {})
        return after if has_preload and after in outcomes_of(self.priors, settings) else "pull_off_force"


def _half(prior: Prior, deviation: float) -> float:
    """Half of the width of what is simulated, of a natural parameter with that standard deviation: within the ends of its prior."""
    scale = 1.0 if prior.logarithmic else abs(prior.median) or np.inf
    ends = np.array(prior.distribution.support())
    with np.errstate(divide="ignore"):
        reach = float(np.abs(np.log(ends / prior.median) if prior.logarithmic else ends - prior.median).min())
    wide = max(_SPREAD * deviation, _NARROWEST * scale if np.isfinite(scale) else 0.0)
    return min(wide, _WIDEST * scale, 0.9 * reach)


@dataclass(frozen=True)
class Shown:
    """Fisher information of one patch for natural parameters, and what it rests on.

    Attributes
    ----------
    products : array (fits, fits, fits, parameters, parameters)
        Mean product of the scores by two fits, of each part of the patches at the medians.
    """

    products: Array

    def __add__(self, other: Shown) -> Shown:
        """Of two patches, half of each."""
        return Shown(0.5 * (self.products + other.products))

    def information(self, without: int | None = None) -> Array:
        """The information (parameters, parameters); `without` one of the fits and one of the parts of the patches."""
        kept = [place for place in range(_FITS) if place != without]
        pairs = [self.products[a, b, kept].mean(axis=0) for a in kept for b in kept if a != b]
        mean = np.mean(pairs, axis=0)
        result: Array = 0.5 * (mean + mean.T)
        return result


class Measured:
    """Patches of one kind, simulated about the medians, and fitted.

    Parameters
    ----------
    local : Local
        Where.
    settings : dict
        Keys of the scene that are other ones.
    seed, threads
        Of the simulation.
    """

    def __init__(self, local: Local, settings: Mapping[str, Any], *, seed: int, threads: int | None) -> None:
        self._local = local
        values = local.priors.values(local.middle + local.half * local.points)
        with work("patches about the medians"):
            self._about = local.logs(values, settings, _ABOUT // len(values), seed, threads)
        with work("patches at the medians"):
            at = local.logs(local.medians, settings, _AT, seed + 1, threads)[0]
        with Bar("density"):
            self.shown = self._shown(at)

    def _shown(self, at: Array) -> Shown:
        """Information from the scores of patches at the medians."""
        fits = [_fitted(self._local.points, of, 1) for of in np.array_split(self._about, _FITS, axis=1)]
        scores = np.stack([_scores(of, at, len(self._local.half)) / self._local.half[:, None] for of in fits])
        parts = np.array_split(scores, _FITS, axis=2)
        return Shown(np.stack([np.einsum("aip,bjp->abij", part, part) / part.shape[2] for part in parts], axis=2))

    def density(self) -> Density:
        """The density of all patches about the medians."""
        return _fitted(self._local.points, self._about, 2)


class Curve:
    """The standard deviation of a natural parameter by the number of forces: of (n I + C⁻¹)⁻¹.

    A combination of parameters whose information is not above 0 by its error counts as one that no number of forces shows.

    Parameters
    ----------
    shown : Shown
        What a patch shows.
    local : Local
        The priors.
    place : int
        Of the parameter among those with priors.
    known : int, optional
        A parameter that is taken as known exactly.

    Attributes
    ----------
    least : float
        The standard deviation after the largest number of forces.
    """

    def __init__(self, shown: Shown, local: Local, place: int, known: int | None = None) -> None:
        kept = [one for one in range(len(local.middle)) if one != known]
        factor = np.linalg.cholesky(np.linalg.inv(np.linalg.inv(local.covariance)[np.ix_(kept, kept)]))

        def scaled(without: int | None = None) -> Array:
            result: Array = factor.T @ shown.information(without)[np.ix_(kept, kept)] @ factor
            return result

        values, vectors = np.linalg.eigh(scaled())
        # Jackknife.
        others = np.stack([np.einsum("ik,ij,jk->k", vectors, scaled(without), vectors) for without in range(_FITS)])
        errors = np.sqrt((_FITS - 1) / _FITS * ((others - others.mean(axis=0)) ** 2).sum(axis=0))
        self._parts: Array = (factor @ vectors)[kept.index(place)] ** 2
        self._values: Array = np.where(values > _SURE * errors, values, 0.0)
        self._ends: Array = np.maximum(values + np.array([[1.0], [-1.0]]) * _QUANTILE * errors, 0.0)
        self.least = float(self._deviations(self._values)[-1])

    def _deviations(self, values: Array) -> Array:
        result: Array = np.sqrt((self._parts / (1.0 + _COUNTS[:, None] * values)).sum(axis=1))
        return result

    def forces(self, deviation: float) -> tuple[float, float, float]:
        """The number of forces with which the standard deviation is as wanted, and the ends of the number's 95 % interval; infinite for never."""
        number, low, high = (_crossing(self._deviations(of), deviation) for of in (self._values, *self._ends))
        return number, low, high


def _crossing(deviations: Array, wanted: float) -> float:
    """The number of forces with which falling standard deviations are as wanted."""
    if deviations[-1] > wanted:
        return math.inf
    logs = np.interp(-math.log(wanted), -np.log(deviations), np.log(_COUNTS))
    return float(math.ceil(math.exp(logs) - 1e-9))


@dataclass(frozen=True)
class Experiments:
    """Synthetic experiments at the medians.

    Attributes
    ----------
    halves : array (experiments,)
        Half of the 95 % interval of the parameter, in its SI unit.
    held : int
        How many of the intervals contain the median.
    """

    halves: Array
    held: int


def simulated_experiments(local: Local, place: int, logs: Array, density: Density, information: Array) -> Experiments:
    """Posteriors of synthetic experiments, by importance sampling about the medians.

    Parameters
    ----------
    local, place
        As of `Curve`.
    logs : array (experiments, patches, 1)
        What is measured.
    density : Density
        Of these patches over the parameters.
    information : array (parameters, parameters)
        Of one of them.
    """
    dimensions = len(local.middle)
    # In normal scores the prior is a normal law.
    steps = 1e-3 * np.eye(dimensions)
    slopes = (local.priors.natural(local.priors.of_scores(steps)) - local.priors.natural(local.priors.of_scores(-steps))).T / 2e-3
    values, vectors = np.linalg.eigh(slopes.T @ information @ slopes)
    # Twice the variance, since the posterior of an experiment is about as far off the medians as it is wide.
    covariance = 2.0 * (vectors / (1.0 + logs.shape[1] * np.maximum(values, 0.0))) @ vectors.T
    scores = qmc.MultivariateNormalQMC(np.zeros(dimensions), covariance, seed=3).random(_DRAWS)
    weigh = -0.5 * (scores**2).sum(axis=1) - stats.multivariate_normal(np.zeros(dimensions), covariance).logpdf(scores)
    parameters = local.priors.of_scores(scores)
    x, order = local.scaled(parameters), np.argsort(parameters[:, place])
    halves, held = [], 0
    for one in logs:
        of = (weigh + _log_likelihood(density, x, one))[order]
        weights = np.exp(of - of.max())
        low, high = np.interp([0.025, 0.975], (np.cumsum(weights) - 0.5 * weights) / weights.sum(), parameters[order, place])
        halves.append(0.5 * (high - low))
        held += int(low <= local.medians[0, place] <= high)
    return Experiments(np.array(halves), held)


def _fitted(x: Array, logs: Array, degree: int) -> Density:
    return fit(x, logs, np.ones(len(x)), parts=_PARTS, degree=degree)


def _log_likelihood(density: Density, x: Array, logs: Array) -> Array:
    """ln of the likelihood of outcomes (patches, 1) at points (points, parameters): (points,)."""
    pieces = np.array_split(logs, len(logs) // 200 + 1)
    result: Array = np.sum([_log_densities(density, x, piece).sum(axis=1) for piece in pieces], axis=0)
    return result


def _log_densities(density: Density, x: Array, logs: Array) -> Array:
    """ln of the density of outcomes (patches, 1) at points (points, parameters): (points, patches)."""
    log_weights, means, widths = (of.reshape(len(x), 1, -1) for of in density.parts(x))
    result: Array = log_sum_exp(log_weights - np.log(widths) - 0.5 * ((logs - means) / widths) ** 2, axis=2)
    return result


def _scores(density: Density, logs: Array, dimensions: int) -> Array:
    """Slopes of ln of the density in the scaled parameters, in the middle: (parameters, patches)."""
    steps = _STEP * np.eye(dimensions)
    result: Array = (_log_densities(density, steps, logs) - _log_densities(density, -steps, logs)) / (2.0 * _STEP)
    return result
