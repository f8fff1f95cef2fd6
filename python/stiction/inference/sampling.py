"""The posterior of the parameters by emcee, until its numbers are as sure as wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import arviz
import emcee
import numpy as np
from numpy.typing import NDArray
from scipy import stats

from ..errors import StictionError
from ..progress import Bar, steps
from .density import log_sum_exp

__all__ = ["Chains", "independent", "rough", "sample", "weighted"]

Array = NDArray[np.float64]
# Independent ensembles of walkers. R̂ compares them; effective sample sizes are by the autocorrelation of every walker.
_ENSEMBLES = 4
# Walkers for each parameter: more of them tell densities better, fewer begin sooner.
_WALKERS = 48
# Draws between two looks at the chains, the most draws, and steps from one draw to the next.
_BLOCK, _MOST_DRAWS, _THIN = 20, 400, 4
# How far apart walkers begin at least, in standard deviations, and steps after which they have forgotten where.
_APART, _FORGOTTEN = 1e-3, 100
_LEAST_EFFECTIVE = 1600.0
_R_HAT = 1.01
# Draws of importance sampling that have to count; where fewer do, walkers go on.
_COUNTING = 400.0
# Draws of the prior that importance sampling begins with, draws of its last proposal, and rounds of proposals at most.
_BANK, _DRAWS, _ROUNDS = 4000, 6000, 20


@dataclass(frozen=True)
class Chains:
    """Draws of the posterior.

    Attributes
    ----------
    z : array (chains, draws, parameters)
        Normal scores of the parameters. A chain is an ensemble: one walker after the other at each step, steps so far apart that draws are
        nearly independent.
    log_probability : array (chains, draws)
        ln of prior times likelihood, up to a constant.
    acceptance : float
        Share of the proposals that were taken; 1 of draws from a grid.
    r_hat, effective : arrays (parameters,)
        Rank-normalised split R̂, and the smaller one of bulk and tail effective sample size (A. Vehtari and others, *Bayesian Anal.* 16 (2021) 667).
    end_errors : array (parameters,)
        Monte Carlo error of the worse end of the 95 % interval over its width.
    """

    z: Array
    log_probability: Array
    acceptance: float
    r_hat: Array
    effective: Array
    end_errors: Array


def sample(
    log_likelihood: Callable[[Array], Array],
    start: Array,
    *,
    seed: int,
    end_error: float = 0.02,
    effective: float = _LEAST_EFFECTIVE,
    r_hat: float = _R_HAT,
) -> Chains:
    """Samples the posterior by several independent ensembles of walkers (density estimates and differential evolution).

    Parameters
    ----------
    log_likelihood : callable
        ln of the likelihood at normal scores, which have a standard normal prior: (points, parameters) → (points,).
    start : array (points, parameters)
        Normal scores of a rough posterior, where the walkers begin.
    seed : int
        Seed of starts and proposals.
    end_error : float
        The Monte Carlo error of the ends of each 95 % interval over its width at which it ends, with R̂ below `r_hat`; or at the largest number
        of draws.
    effective : float
        The least effective sample size at which it ends.

    Raises
    ------
    StictionError
        The chains do not agree after the largest number of draws.
    """
    random = np.random.default_rng(seed)
    samplers, states = [], []
    for _ in steps(range(_ENSEMBLES), "first steps", "ensembles"):
        sampler, state = _ensemble(log_likelihood, start, random)
        samplers.append(sampler)
        states.append(state)
    draws = 0
    with Bar("posterior", _MOST_DRAWS, "draws", at_most=True) as bar:
        while True:
            for place, sampler in enumerate(samplers):
                states[place] = sampler.run_mcmc(states[place], _BLOCK, thin_by=_THIN, skip_initial_state_check=True)
            draws += _BLOCK
            bar.to(draws)
            # The first quarter is dropped.
            skip = draws // 4
            z = np.stack([sampler.get_chain()[skip:] for sampler in samplers])  # (ensembles, draws, walkers, parameters)
            logs = np.stack([sampler.get_log_prob()[skip:] for sampler in samplers])
            acceptance = float(np.mean([sampler.acceptance_fraction.mean() for sampler in samplers]))
            judged = _judged(z, logs, acceptance)
            enough = judged.effective.min() >= effective and judged.end_errors.max() <= end_error
            if enough and judged.r_hat.max() < r_hat:
                return judged
            if draws >= _MOST_DRAWS:
                if judged.r_hat.max() < r_hat:
                    # The error that was reached is reported with the result.
                    return judged
                raise StictionError(
                    f"the chains do not agree after {draws} draws of {_ENSEMBLES} ensembles: R̂ = {judged.r_hat.max():.3f}, below {r_hat:g} is needed. "
                    "Narrower priors help where the posterior has several maxima"
                )


def _ensemble(log_likelihood: Callable[[Array], Array], start: Array, random: np.random.Generator) -> tuple[Any, Any]:
    """An ensemble of walkers that have forgotten where they began."""
    dimensions = start.shape[1]
    walkers = _WALKERS * dimensions

    def log_probability(z: Array) -> Array:
        result: Array = log_likelihood(z) - 0.5 * (z**2).sum(axis=1)
        return result

    # Proposals from a density estimate of the other walkers forget where a walker was; the others reach where that is thin.
    moves = [(emcee.moves.KDEMove(), 0.6), (emcee.moves.DEMove(), 0.3), (emcee.moves.DESnookerMove(), 0.1)]
    sampler = emcee.EnsembleSampler(walkers, dimensions, log_probability, vectorize=True, moves=moves)
    begin = start[random.choice(len(start), walkers, replace=False)]
    # Between walkers at equal places no direction leads.
    begin = begin + _APART * start.std(axis=0) * random.standard_normal(begin.shape)
    state = emcee.State(begin, random_state=np.random.RandomState(random.integers(2**31)).get_state())
    return sampler, sampler.run_mcmc(state, _FORGOTTEN, store=False, skip_initial_state_check=True)


def _judged(z: Array, logs: Array, acceptance: float) -> Chains:
    ensembles, draws, walkers, dimensions = z.shape
    apart = z.transpose(0, 2, 1, 3).reshape(ensembles * walkers, draws, dimensions)

    def each(function: Callable[..., Any], of: Array, **options: Any) -> Array:
        return np.array([float(function(of[:, :, k], **options)) for k in range(dimensions)])

    effective = np.minimum(each(arviz.ess, apart, method="bulk"), each(arviz.ess, apart, method="tail"))
    ends = [each(arviz.mcse, apart, method="quantile", prob=prob) for prob in (0.025, 0.975)]
    widths = np.diff(np.quantile(apart.reshape(-1, dimensions), [0.025, 0.975], axis=0), axis=0)[0]
    r_hat = each(arviz.rhat, z.reshape(ensembles, -1, dimensions), method="rank")
    stride = min(max(round(apart.shape[0] * draws / effective.min()), 1), draws)
    kept = z[:, ::stride].reshape(ensembles, -1, dimensions), logs[:, ::stride].reshape(ensembles, -1)
    return Chains(*kept, acceptance, r_hat, effective, np.maximum(*ends) / widths)


def independent(z: Array, logs: Array) -> Chains:
    """Independent draws, (draws, parameters), as chains."""
    ensembles, draws = _ENSEMBLES, len(z) // _ENSEMBLES
    count = ensembles * draws
    return _judged(z[:count].reshape(ensembles, draws, 1, -1), logs[:count].reshape(ensembles, draws, 1), 1.0)


def rough(
    log_likelihood: Callable[[Array], Array], dimensions: int, count: int, random: np.random.Generator, *, about: Array | None = None
) -> Array:
    """Draws of a rough posterior, (count, parameters): by importance sampling, and by walkers where few of its draws count.

    It takes the arguments of `weighted`. Posteriors that are thin and curved are far from every proposal.
    """
    z, weights = weighted(log_likelihood, dimensions, random, about=about)
    if 1.0 / (weights**2).sum() >= _COUNTING:
        return np.asarray(z[random.choice(len(z), count, p=weights)])
    _, tempered = _tempered(np.log(np.maximum(weights, 1e-300)), _COUNTING)
    sampler, state = _ensemble(log_likelihood, z[random.choice(len(z), count, p=tempered)], random)
    sampler.run_mcmc(state, -(-count // (_WALKERS * dimensions)), thin_by=_THIN, skip_initial_state_check=True)
    return np.asarray(sampler.get_chain(flat=True)[:count])


def weighted(
    log_likelihood: Callable[[Array], Array], dimensions: int, random: np.random.Generator, *, about: Array | None = None, draws: int = _DRAWS
) -> tuple[Array, Array]:
    """A rough posterior by adaptive importance sampling, where chains would take long.

    The proposal is a mixture of Student's t, with the weighted moments of the round before, and the prior (O. Cappé and others, *J. Comput. Graph. Stat.* 13
    (2004) 907).

    Parameters
    ----------
    log_likelihood : callable
        As of `sample`.
    dimensions : int
        Number of parameters.
    random : numpy.random.Generator
    about : array (points, parameters), optional
        Normal scores where it begins, in the place of draws of the prior.
    draws : int
        Draws of the last proposal.

    Returns
    -------
    tuple of arrays (draws, parameters), (draws,)
        Normal scores and their weights, which sum to 1.
    """
    prior = stats.multivariate_normal(np.zeros(dimensions))
    z = random.standard_normal((_BANK, dimensions)) if about is None else about
    logs = log_likelihood(z)
    rounds_at_posterior = 0
    for round_of in range(_ROUNDS):
        power, weights = _tempered(logs, 20.0 * dimensions)
        rounds_at_posterior += bool(power == 1.0)
        is_last = rounds_at_posterior == 2 or round_of == _ROUNDS - 1
        centre = weights @ z
        spread = 1.3 * np.cov(z.T, aweights=weights, ddof=0).reshape(dimensions, -1) + 1e-9 * np.eye(dimensions)
        proposal = stats.multivariate_t(centre, spread, df=5)
        count = draws if is_last else draws // 3
        from_prior = count // 10
        z = np.concatenate(
            [np.atleast_2d(proposal.rvs(count - from_prior, random_state=random)).reshape(-1, dimensions), random.standard_normal((from_prior, dimensions))]
        )
        density = np.logaddexp(proposal.logpdf(z) + np.log(0.9), prior.logpdf(z) + np.log(0.1))
        logs = log_likelihood(z) + prior.logpdf(z) - density
        if is_last:
            break
    weights = np.exp(logs - log_sum_exp(logs, axis=0))
    return z, weights


def _tempered(logs: Array, count: float) -> tuple[float, Array]:
    """Weights to the largest power, of at most 1, with which `count` draws count: the power and the weights."""
    for power in 0.7 ** np.arange(40):
        weights = np.exp(power * (logs - log_sum_exp(logs, axis=0)))
        weights /= weights.sum()
        if 1.0 / (weights**2).sum() > count:
            break
    return float(power), weights
