"""Calibration of intervals: inferences from synthetic experiments whose parameters are known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from .. import priors as scenes
from ..priors import Priors
from .check import check_p_values
from .data import EXACT, Group
from .density import log_sum_exp
from .emulator import Emulator, design, simulate

__all__ = ["Calibration", "calibrate", "weighted_posterior"]

Array = NDArray[np.float64]
# What is measured.
_OUTCOMES = ("pull_off_force",)
# Draws of the prior that all experiments begin with, and draws of the last proposal.
_BANK, _DRAWS = 4000, 3000
# Draws of a posterior that its check looks at.
_CHECKED = 200


@dataclass(frozen=True)
class Calibration:
    """Ranks of the true parameters of synthetic experiments in their posteriors.

    Attributes
    ----------
    names : list of str
        Parameters.
    ranks : array (experiments, parameters)
        Shares of the posterior's draws below the true parameter: uniform on 0 to 1 if the posteriors are right (S. Talts and others, arXiv:1804.06788).
    checks : array (experiments,)
        p-values of the posterior-predictive check.
    """

    names: list[str]
    ranks: Array
    checks: Array

    def coverage(self, level: float) -> Array:
        """Share of the experiments in which the central interval of that probability contains the true parameter, (parameters,)."""
        result: Array = (np.abs(self.ranks - 0.5) <= 0.5 * level).mean(axis=0)
        return result

    def p_values(self) -> Array:
        """p-values of uniform ranks by the test of Kolmogorov and Smirnov, (parameters,)."""
        return np.array([stats.kstest(column, "uniform").pvalue for column in self.ranks.T])


def calibrate(
    scene: str | Path | Mapping[str, Any],
    *,
    experiments: int,
    patches: int,
    points: int = 512,
    replicas: int = 300,
    seed: int = 1,
    threads: int | None = None,
) -> Calibration:
    """Simulation-based calibration: parameters from the prior, pull-offs from the program at them, and the posterior from these.

    All posteriors have one density, fitted over the whole prior.

    Parameters
    ----------
    scene : path or dict
        A scene with priors.
    experiments, patches : int
        Synthetic experiments, and patches measured in each.
    points, replicas : int
        Parameter sets from which the density is fitted, and simulated patches at each.
    seed : int
        Of everything. Experiments and density share no random numbers.
    threads : int, optional
        Of the simulations.

    Raises
    ------
    SceneError
        The scene is wrong.
    """
    priors = scenes.read(scene)
    seeds = [int(one) for one in np.random.SeedSequence(seed).generate_state(6) >> 1]
    random = np.random.default_rng(seeds[0])
    made = simulate(priors, _OUTCOMES, design(priors, points, seeds[1]), replicas=replicas, seed=seeds[2], threads=threads)
    true = priors.of_scores(random.standard_normal((experiments, len(priors.priors))))
    data = simulate(priors, _OUTCOMES, true, replicas=patches, seed=seeds[3], threads=threads)
    emulator = Emulator(priors, [made], seed=seeds[4])
    bank = random.standard_normal((_BANK, len(priors.priors)))
    ranks, checks = [], []
    for place, values in enumerate(np.exp(data.logs)):
        groups = (Group({}, values, np.zeros_like(values), np.full(values.shape, EXACT)),)
        z, weights = weighted_posterior(emulator, groups, priors, bank, random)
        parameters = priors.of_scores(z)
        ranks.append(weights @ (parameters < true[place]))
        checks.append(check_p_values(emulator, groups, parameters[random.choice(len(z), _CHECKED, p=weights)], random)[0])
    return Calibration([prior.name for prior in priors.priors], np.array(ranks), np.array(checks))


def weighted_posterior(
    emulator: Emulator, groups: tuple[Group, ...], priors: Priors, bank: Array, random: np.random.Generator
) -> tuple[Array, Array]:
    """A posterior by adaptive importance sampling, for thousands of which chains would take hours.

    The proposal is a mixture of Student's t, with the weighted moments of the round before, and the prior (O. Cappé and others, *J. Comput. Graph. Stat.* 13
    (2004) 907).

    Parameters
    ----------
    bank : array (draws, parameters)
        Normal scores of the first round, draws of the prior.

    Returns
    -------
    tuple of arrays (draws, parameters), (draws,)
        Normal scores and their weights, which sum to 1.
    """
    dimensions = bank.shape[1]
    prior = stats.multivariate_normal(np.zeros(dimensions))
    z, logs = bank, _log_likelihood(emulator, groups, priors, bank)
    for round_of in range(3):
        # Tempered until several draws count.
        for power in 0.7 ** np.arange(40):
            weights = np.exp(power * (logs - log_sum_exp(logs, axis=0)))
            weights /= weights.sum()
            if 1.0 / (weights**2).sum() > 20.0 * dimensions:
                break
        centre = weights @ z
        spread = 1.3 * np.cov(z.T, aweights=weights, ddof=0).reshape(dimensions, -1) + 1e-9 * np.eye(dimensions)
        proposal = stats.multivariate_t(centre, spread, df=5)
        draws = _DRAWS if round_of == 2 else _DRAWS // 3
        from_prior = draws // 10
        z = np.concatenate(
            [np.atleast_2d(proposal.rvs(draws - from_prior, random_state=random)).reshape(-1, dimensions), random.standard_normal((from_prior, dimensions))]
        )
        density = np.logaddexp(proposal.logpdf(z) + np.log(0.9), prior.logpdf(z) + np.log(0.1))
        logs = _log_likelihood(emulator, groups, priors, z) + prior.logpdf(z) - density
    weights = np.exp(logs - log_sum_exp(logs, axis=0))
    return z, weights


def _log_likelihood(emulator: Emulator, groups: tuple[Group, ...], priors: Priors, z: Array) -> Array:
    values = priors.of_scores(z)
    return np.concatenate([emulator.log_likelihood(groups, piece) for piece in np.array_split(values, len(values) // 100)])
