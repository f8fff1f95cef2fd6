"""The posterior of the parameters by emcee, until its numbers are as sure as wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import arviz
import emcee
import numpy as np
from numpy.typing import NDArray

from ..errors import StictionError
from ..priors import Priors
from ..progress import Bar, steps

__all__ = ["Chains", "sample"]

Array = NDArray[np.float64]
# Independent ensembles of walkers. R̂ compares them; effective sample sizes are by the autocorrelation of every walker.
_ENSEMBLES = 4
# Walkers for each parameter: more of them tell densities better, fewer begin sooner.
_WALKERS = 48
# Draws between two looks at the chains, the most draws, and steps from one draw to the next.
_BLOCK, _MOST_DRAWS, _THIN = 20, 400, 4
_LEAST_EFFECTIVE = 1600.0
_R_HAT = 1.01


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
        Share of the proposals that were taken.
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
    priors: Priors,
    *,
    seed: int,
    end_error: float = 0.02,
    effective: float = _LEAST_EFFECTIVE,
    r_hat: float = _R_HAT,
    start: Array | None = None,
) -> Chains:
    """Samples the posterior by several independent ensembles of walkers (density estimates and differential evolution).

    Parameters
    ----------
    log_likelihood : callable
        ln of the likelihood at parameters in SI units, (points, parameters) → (points,).
    priors : Priors
        Their normal scores are what is sampled, with a standard normal prior.
    seed : int
        Seed of starts and proposals.
    end_error : float
        The Monte Carlo error of the ends of each 95 % interval over its width at which it ends, with R̂ below `r_hat`; or at the largest number
        of draws.
    effective : float
        The least effective sample size at which it ends.
    start : array (points, parameters), optional
        Normal scores of a former posterior to begin at; without it the best of many draws of the prior.

    Raises
    ------
    StictionError
        The chains do not agree after the largest number of draws.
    """
    dimensions = len(priors.priors)
    walkers = _WALKERS * dimensions

    def log_probability(z: Array) -> Array:
        result: Array = log_likelihood(priors.of_scores(z)) - 0.5 * (z**2).sum(axis=1)
        return result

    random = np.random.default_rng(seed)
    # Proposals from a density estimate of the other walkers forget where a walker was; the others reach where that is thin.
    moves = [(emcee.moves.KDEMove(), 0.6), (emcee.moves.DEMove(), 0.3), (emcee.moves.DESnookerMove(), 0.1)]
    samplers, states = [], []
    for _ in steps(range(_ENSEMBLES), "first steps", "ensembles"):
        sampler = emcee.EnsembleSampler(walkers, dimensions, log_probability, vectorize=True, moves=moves)
        begin = _spread(log_probability, start, walkers, dimensions, random)
        state = emcee.State(begin, random_state=np.random.RandomState(random.integers(2**31)).get_state())
        # Steps that walkers need to forget where they began.
        states.append(sampler.run_mcmc(state, 100, store=False, skip_initial_state_check=True))
        samplers.append(sampler)
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


def _spread(log_probability: Callable[[Array], Array], start: Array | None, walkers: int, dimensions: int, random: Any) -> Array:
    """Starts of the walkers: draws of a former posterior, or draws of the prior by their probability, tempered until they are several."""
    if start is not None:
        return np.asarray(start[random.choice(len(start), walkers, replace=False)])
    z = random.standard_normal((2000, dimensions))
    logs = np.concatenate([log_probability(piece) for piece in np.array_split(z, 10)]) + 0.5 * (z**2).sum(axis=1)
    if not np.isfinite(logs.max()):
        raise StictionError("the density of the simulated patches is no number at the data: check the units of the data, and the priors")
    for power in 0.5 ** np.arange(12):
        weights = np.exp(power * (logs - logs.max()))
        if weights.sum() ** 2 / (weights**2).sum() > 2 * walkers:
            break
    chosen = random.choice(len(z), walkers, p=weights / weights.sum())
    return np.asarray(z[chosen] + 0.02 * random.standard_normal((walkers, dimensions)))


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
