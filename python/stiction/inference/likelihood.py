"""The likelihood of all data: patches of the model, outliers among them, and batches that differ."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import special, stats
from scipy.interpolate import CubicSpline

from ..priors import Priors
from .data import ABOVE, BELOW, EXACT, Group, Measurements
from .density import log_sum_exp
from .emulator import Emulator

__all__ = ["Likelihood", "outlier_range"]

Array = NDArray[np.float64]
# Ends of the ranges of the fraction of outliers, of each of which the middle counts.
_FRACTIONS = np.array([0.0, 0.002, 0.007, 0.015, 0.03, 0.06, 0.12, 0.24, 0.5])
# ln of the ratio of two densities at most, and below which there is none.
_MOST_RATIO, _NOWHERE = 600.0, -5e8
# Deviations of a batch at which patches are evaluated, and at which their sum is interpolated.
_DEVIATIONS, _FINE = np.linspace(-4.0, 4.0, 17), np.linspace(-4.0, 4.0, 129)
_BETWEEN = CubicSpline(_DEVIATIONS, np.eye(len(_DEVIATIONS)))(_FINE)
_LOG_NORMAL = stats.norm.logpdf(_FINE) - special.logsumexp(stats.norm.logpdf(_FINE))
# Points whose batches are summed at once.
_POINTS = 64


def outlier_range(measured: Measurements, logs: list[Array]) -> Array:
    """Ends of ln outcome between which outliers lie, (2, outcomes): a factor of 10 beyond data and simulated patches."""
    data = np.log(np.concatenate([group.values for group in measured.groups]))
    low = np.minimum(np.nanmin(data, axis=0), np.min([of.min(axis=(0, 1)) for of in logs], axis=0))
    high = np.maximum(np.nanmax(data, axis=0), np.max([of.max(axis=(0, 1)) for of in logs], axis=0))
    return np.stack([low - np.log(10.0), high + np.log(10.0)])


class Likelihood:
    r"""ln of the likelihood of data over the normal scores of the parameters.

    A datum is an outlier with the probability ε, and then uniform in the logarithm of its outcome:
    :math:`p_i = (1 - ε) p(y_i | θ) + ε u(y_i)` (D. W. Hogg, J. Bovy, D. Lang, arXiv:1008.4686). The fraction ε has the prior Beta(1, 1/m − 1)
    with the mean m, and is summed over. Where a parameter differs between batches, batch b has the value θ exp(τ v_b) with a standard normal v_b, which
    is integrated over; τ is a parameter of its own, with a half-normal prior.

    Parameters
    ----------
    emulator : Emulator
    measured : Measurements
    priors : Priors
    outliers : float
        The mean m of the prior of the fraction; 0 without outliers.
    spread : array (2, outcomes)
        Ends of ln outcome of outliers.
    """

    def __init__(self, emulator: Emulator, measured: Measurements, priors: Priors, outliers: float, spread: Array) -> None:
        self.emulator, self.measured, self.priors = emulator, measured, priors
        self._groups, self._spread = measured.groups, spread
        self._outlier = np.concatenate([_uniform(group.values, group.kinds, spread) for group in measured.groups])
        middles = 0.5 * (_FRACTIONS[1:] + _FRACTIONS[:-1])
        self.fractions = middles if outliers > 0.0 else np.zeros(1)
        shares = np.diff(stats.beta(1.0, 1.0 / outliers - 1.0).cdf(_FRACTIONS)) if outliers > 0.0 else np.ones(1)
        self._log_shares = np.log(shares / shares.sum())

    @property
    def dimensions(self) -> int:
        """Number of parameters: of the priors, and τ where batches differ."""
        return len(self.priors.priors) + (self.priors.of_batch is not None)

    def values(self, z: Array) -> Array:
        """The parameters of the priors, SI, from normal scores (points, parameters)."""
        return self.priors.of_scores(z[:, : len(self.priors.priors)])

    def spread_of_batches(self, z: Array) -> Array:
        """τ at normal scores, (points,)."""
        assert self.priors.of_batch is not None
        result: Array = self.priors.of_batch.log_std * special.ndtri(0.5 + 0.5 * np.minimum(special.ndtr(z[:, -1]), 1.0 - 1e-15))
        return result

    def __call__(self, z: Array) -> Array:
        """ln of the likelihood at normal scores (points, parameters): (points,)."""
        result: Array = np.concatenate([log_sum_exp(self._of_fractions(piece), axis=1) for piece in self._pieces(z)])
        return result

    @property
    def _mean(self) -> float:
        """The mean fraction of outliers."""
        return float(np.exp(self._log_shares) @ self.fractions)

    def mixed(self, place: int, group: Group, values: Array) -> Array:
        """ln p of patches of a set of conditions at parameters, SI, with the mean fraction of outliers: (points, patches), up to a constant of each patch."""
        logs = self.emulator.of_group(place).log_densities((group,), values) - _uniform(group.values, group.kinds, self._spread)
        return _mixed(np.minimum(logs, _MOST_RATIO), self._mean)

    def log_densities(self, z: Array) -> Array:
        """ln p of each patch, of a batch at random and with the mean fraction of outliers: (points, patches)."""
        result = [log_sum_exp(_mixed(self._ratios(piece), self._mean) + self._weights[:, None], axis=1) for piece in self._pieces(z)]
        logs: Array = np.concatenate(result) + self._outlier
        return logs

    def doubts(self, z: Array) -> tuple[Array, float]:
        """The probability of each patch to be an outlier, (patches,), and the mean fraction of outliers, over draws of the posterior."""
        if self.fractions[-1] == 0.0:
            return np.zeros(self.measured.size), 0.0
        doubts, means = [], []
        for piece in self._pieces(z):
            of = self._of_fractions(piece)
            weights = np.exp(of - log_sum_exp(of, axis=1)[:, None])
            ratios = log_sum_exp(self._ratios(piece) + self._weights[:, None], axis=1)
            outlying = np.exp(np.log(self.fractions)[:, None] - _mixed(ratios[:, None], self.fractions[:, None]))
            doubts.append((weights[:, :, None] * outlying).sum(axis=1))
            means.append(weights @ self.fractions)
        return np.concatenate(doubts).mean(axis=0), float(np.concatenate(means).mean())

    def of_batches(self, z: Array, random: np.random.Generator) -> Array:
        """Parameters of each batch, SI, drawn from their posterior at each of the points z: (points, batches, parameters)."""
        values = np.repeat(self.values(z)[:, None], max(len(self.measured.batches), 1), axis=1)
        of_batch = self.priors.of_batch
        if of_batch is None:
            return values
        deviations = []
        for piece in self._pieces(z):
            fine = self._of_deviations(piece)
            whole = log_sum_exp(fine, axis=3).sum(axis=2) + self._log_shares
            fraction = _drawn(whole, random)
            deviations.append(_FINE[_drawn(fine[np.arange(len(piece)), fraction], random)])
        values[..., of_batch.place] *= np.exp(self.spread_of_batches(z)[:, None] * np.concatenate(deviations))
        return values

    def cumulative(self, values: Array) -> Array:
        """P(measured outcome ≤ the data's) at parameters of each batch: (points, patches, outcomes), as `Emulator.cumulative`."""
        return self._by_batch([self.emulator.cumulative(self._groups, values[:, batch]) for batch in range(values.shape[1])])

    def predicted(self, values: Array, random: np.random.Generator) -> Array:
        """Data like the given ones at parameters of each batch: (points, patches, outcomes), as `Emulator.measured`."""
        return self._by_batch([self.emulator.measured(self._groups, values[:, batch], random) for batch in range(values.shape[1])])

    def _by_batch(self, of: list[Array]) -> Array:
        """Of each patch the numbers of its batch."""
        if len(of) == 1:
            return of[0]
        result: Array = np.stack(of)[self._batches, :, np.arange(self.measured.size)].transpose(1, 0, 2)
        return result

    @cached_property
    def _batches(self) -> NDArray[np.int64]:
        return np.concatenate([group.batches for group in self._groups])

    def _pieces(self, z: Array) -> Iterator[Array]:
        """Points of which tables over patches, fractions and deviations have a bearable size."""
        size = self.measured.size * len(self.fractions) * len(self._weights)
        yield from np.array_split(z, max(-(-len(z) * size // 4_000_000), 1))

    @cached_property
    def _weights(self) -> Array:
        """ln of the weights of the deviations of a batch; without batches one."""
        if self.priors.of_batch is None:
            return np.zeros(1)
        logs = stats.norm.logpdf(_DEVIATIONS)
        return np.asarray(logs - special.logsumexp(logs))

    def _ratios(self, z: Array) -> Array:
        """ln of p of the model over p of an outlier: (points, deviations of a batch, patches)."""
        values, of_batch = self.values(z), self.priors.of_batch
        if of_batch is not None:
            factors = np.exp(self.spread_of_batches(z)[:, None] * _DEVIATIONS)
            values = np.repeat(values[:, None], len(_DEVIATIONS), axis=1)
            values[..., of_batch.place] *= factors
        logs = self.emulator.log_densities(self._groups, values.reshape(-1, len(self.priors.priors)))
        return np.clip(logs.reshape(len(z), -1, self.measured.size) - self._outlier, -2e9, _MOST_RATIO)

    def _of_fractions(self, z: Array) -> Array:
        """ln of prior times likelihood of each fraction of outliers: (points, fractions)."""
        if self.priors.of_batch is None:
            whole = _mixed(self._ratios(z), self.fractions[:, None]).sum(axis=-1)
        else:
            whole = log_sum_exp(self._of_deviations(z), axis=3).sum(axis=2)
        result: Array = whole + self._outlier.sum() + self._log_shares
        return result

    def _of_deviations(self, z: Array) -> Array:
        """ln of prior times likelihood of each deviation of each batch: (points, fractions, batches, deviations)."""
        mixed = _mixed(self._ratios(z)[:, None], self.fractions[:, None, None])  # (points, fractions, deviations, patches)
        sums = np.stack([mixed[..., self._batches == batch].sum(axis=-1) for batch in range(len(self.measured.batches))], axis=2)
        result: Array = np.maximum(sums, -1e7) @ _BETWEEN.T + _LOG_NORMAL
        return result


def _drawn(logs: Array, random: np.random.Generator) -> NDArray[np.int64]:
    """Places along the last axis, drawn by their probabilities."""
    result: NDArray[np.int64] = (logs + random.gumbel(size=logs.shape)).argmax(axis=-1)
    return result


def _mixed(ratios: Array, fraction: Array | float) -> Array:
    """ln of p of a patch over p of an outlier, where a fraction are outliers."""
    kept = np.log1p(-np.asarray(fraction))
    if np.all(np.asarray(fraction) == 0.0):
        return np.asarray(ratios + kept)
    mixed = np.log(np.exp(ratios + kept) + fraction)
    # Where the densities do not hold a patch is no outlier, either.
    result: Array = np.where(ratios < _NOWHERE, ratios, mixed)
    return result


def _uniform(values: Array, kinds: NDArray[np.int64], spread: Array) -> Array:
    """ln p of each patch as an outlier: uniform in the logarithms, (patches,)."""
    low, high = spread
    logs, width = np.log(values), high - low
    below = np.log(np.clip((logs - low) / width, 1e-12, 1.0))
    above = np.log(np.clip((high - logs) / width, 1e-12, 1.0))
    each = np.select([kinds == EXACT, kinds == BELOW, kinds == ABOVE], [-logs - np.log(width), below, above], 0.0)
    result: Array = each.sum(axis=1)
    return result
