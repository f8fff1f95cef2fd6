"""The likelihood of all data: patches of the model, outliers among them, and batches that differ."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from ..priors import Priors
from .data import ABOVE, BELOW, EXACT, Group, Measurements
from .density import log_sum_exp
from .emulator import Emulator, Patches, log_density

__all__ = ["Likelihood", "outlier_range"]

Array = NDArray[np.float64]
# Ends of the ranges of the fraction of outliers, of each of which the middle counts.
_FRACTIONS = np.array([0.0, 0.002, 0.007, 0.015, 0.03, 0.06, 0.12, 0.24, 0.5])
# ln of the ratio of two densities at most, and below which there is none.
_MOST_RATIO, _NOWHERE = 600.0, -5e8
# Values of a parameter that differs between batches over which it is integrated.
_NODES = 129
# Points of which draws are made at once, and numbers of a table at most.
_POINTS, _MOST_NUMBERS = 64, 4_000_000


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
    with the mean m, and is summed over. Where a parameter differs between batches, batch b has the value θ_b = θ exp(τ v_b) with a standard normal v_b;
    ln θ_b is integrated over, and τ is a parameter of its own, with a half-normal prior.

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

    def refitted(self, patches: list[Patches], parts: int | None = None) -> Likelihood:
        """The likelihood by densities that are fitted to other patches, or have another number of parts."""
        other = copy.copy(self)
        other.emulator = self.emulator.refitted(patches, parts)
        return other

    @property
    def dimensions(self) -> int:
        """Number of parameters: of the priors, and τ where batches differ."""
        return len(self.priors.priors) + (self.priors.of_batch is not None)

    @property
    def largest_batch(self) -> float:
        """The fraction of the patches that have the parameters of one batch."""
        return float(np.bincount(self._batches).max() / self.measured.size) if self.priors.of_batch is not None else 1.0

    @property
    def is_gridded(self) -> bool:
        """Whether there are one or two priors, so that a grid has the posterior."""
        return len(self.priors.priors) <= 2

    def values(self, z: Array) -> Array:
        """The parameters of the priors, SI, from normal scores (points, parameters)."""
        return self.priors.of_scores(z[:, : len(self.priors.priors)])

    def spread_of_batches(self, z: Array) -> Array:
        """τ at normal scores, (points,)."""
        assert self.priors.of_batch is not None
        return self.priors.of_batch.spread(z[:, -1])

    def __call__(self, z: Array) -> Array:
        """ln of the likelihood at normal scores (points, parameters): (points,); −∞ where the densities do not hold."""
        of = self._of_fractions(z) if self.priors.of_batch is None else self._integrated(z)[0]
        result: Array = log_sum_exp(of + self._log_shares, axis=1) + self._outlier.sum()
        if self.priors.of_batch is None:
            result[~self.emulator.holds(self.values(z))] = -np.inf
        return result

    @property
    def _mean(self) -> float:
        """The mean fraction of outliers."""
        return float(np.exp(self._log_shares) @ self.fractions)

    def mixed(self, place: int, group: Group, values: Array) -> Array:
        """ln p of patches of a set of conditions at parameters, SI, with the mean fraction of outliers: (points, patches), up to a constant of each patch."""
        emulator = self.emulator.of_group(place)
        logs = log_density(emulator.densities[0], group, emulator.scaled(values)) - _uniform(group.values, group.kinds, self._spread)
        return _mixed(np.minimum(logs, _MOST_RATIO), self._mean)

    def with_outliers(self, logs: Array, random: np.random.Generator) -> Array:
        """Outcomes of patches, (patches, outcomes), of which the mean fraction are outliers in their place."""
        low, high = self._spread
        outlying = random.random((len(logs), 1)) < self._mean
        return np.where(outlying, low + (high - low) * random.random(logs.shape), logs)

    def log_densities(self, values: Array) -> Array:
        """ln p of each patch at parameters of its batch, SI, (points, batches, parameters), with the mean fraction of outliers: (points, patches)."""
        logs: Array = _mixed(self._by_own(values), self._mean) + self._outlier
        return logs

    def doubts(self, values: Array) -> tuple[Array, float]:
        """The probability of each patch to be an outlier, (patches,), and the mean fraction of outliers, over draws (points, batches, parameters), SI."""
        if self.fractions[-1] == 0.0:
            return np.zeros(self.measured.size), 0.0
        doubts, means = [], []
        for piece in np.array_split(values, max(len(values) // _POINTS, 1)):
            logs = _mixed(self._by_own(piece)[:, None], self.fractions[:, None])  # (points, fractions, patches)
            of = logs.sum(axis=2) + self._log_shares
            weights = np.exp(of - log_sum_exp(of, axis=1)[:, None])
            outlying = np.exp(np.log(self.fractions)[:, None] - logs)
            doubts.append((weights[:, :, None] * outlying).sum(axis=1))
            means.append(weights @ self.fractions)
        return np.concatenate(doubts).mean(axis=0), float(np.concatenate(means).mean())

    def _by_own(self, values: Array) -> Array:
        """As `_single` of each patch at the parameters of its batch."""
        return self._by_batch([self._single(values[:, batch])[..., None] for batch in range(values.shape[1])])[..., 0]

    def of_batches(self, z: Array, random: np.random.Generator) -> Array:
        """Parameters of each batch, SI, drawn from their posterior at each of the points z: (points, batches, parameters)."""
        values = np.repeat(self.values(z)[:, None], max(len(self.measured.batches), 1), axis=1)
        if (of_batch := self.priors.of_batch) is not None:
            drawn = np.concatenate([self._integrated(piece, random)[1] for piece in np.array_split(z, max(len(z) // _POINTS, 1))])
            values[..., of_batch.place] = np.exp(drawn)
        return values

    def of_any_batch(self, z: Array, random: np.random.Generator) -> Array:
        """Parameters of a batch that was not measured, SI, at each of the points z: (points, parameters)."""
        values = self.values(z)
        if (of_batch := self.priors.of_batch) is not None:
            values[:, of_batch.place] *= np.exp(self.spread_of_batches(z) * random.standard_normal(len(z)))
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
        """Points of which tables over patches and fractions have a bearable size."""
        yield from np.array_split(z, max(-(-len(z) * self.measured.size * len(self.fractions) // _MOST_NUMBERS), 1))

    def _single(self, values: Array) -> Array:
        """ln of p of the model over p of an outlier at parameters, SI: (points, patches)."""
        ratios: Array = np.clip(self.emulator.log_densities(self._groups, values) - self._outlier, -2e9, _MOST_RATIO)
        return ratios

    def _of_fractions(self, z: Array) -> Array:
        """ln of the likelihood of each fraction of outliers, without batches: (points, fractions)."""
        of = [_mixed(self._single(self.values(piece))[:, None], self.fractions[:, None]).sum(axis=2) for piece in self._pieces(z)]
        return np.concatenate(of)

    @cached_property
    def _nodes(self) -> Array:
        """ln of the values that a batch may have."""
        assert self.priors.of_batch is not None
        low, high = self.emulator.reach(self.priors.of_batch.place)
        return np.linspace(np.log(max(low, 1e-3 * high)), np.log(high), _NODES)

    def _weights(self, z: Array) -> Array:
        """ln of the probability of the values that a batch may have: (points, values)."""
        of_batch = self.priors.of_batch
        assert of_batch is not None
        middle = np.log(self.values(z)[:, of_batch.place])
        # Not narrower than the values are apart.
        spread = np.hypot(self.spread_of_batches(z), 0.5 * (self._nodes[1] - self._nodes[0]))
        logs = -0.5 * ((self._nodes - middle[:, None]) / spread[:, None]) ** 2
        # Of a middle beyond the values hardly any is within.
        whole = np.maximum(log_sum_exp(logs, axis=1), np.log(spread / (self._nodes[1] - self._nodes[0]) * np.sqrt(2.0 * np.pi)))
        result: Array = logs - whole[:, None]
        return result

    def _integrated(self, z: Array, random: np.random.Generator | None = None) -> tuple[Array, Array]:
        """ln of the likelihood of each fraction of outliers, (points, fractions), and with `random` draws of ln of the value of each batch, (points, batches).

        Points that differ in the parameter and its scatter between batches alone have one table.
        """
        assert self.priors.of_batch is not None
        natural = self.priors.natural(self.values(z))
        others = np.delete(natural, self.priors.of_batch.place, axis=1)
        _, first, back = np.unique(others, axis=0, return_index=True, return_inverse=True)
        weights, result, drawn = np.exp(self._weights(z)), np.empty((len(z), len(self.fractions))), np.empty((len(z), len(self.measured.batches)))
        order = np.argsort(back.ravel(), kind="stable")
        for points in np.split(order, np.cumsum(np.bincount(back.ravel()))[:-1]):
            table = self._table(z[first[back.ravel()[points[0]]]][None])  # (fractions, batches, values)
            top = table.max(axis=2, keepdims=True)
            sums = np.einsum("pv,fbv->pfb", weights[points], np.exp(table - top), optimize=True)
            logs = np.log(sums + 1e-300) + top[..., 0]
            result[points] = logs.sum(axis=2)
            if random is not None:
                fraction = _drawn(result[points] + self._log_shares, random)
                each = np.log(weights[points] + 1e-300)[:, None] + table[fraction]
                step = self._nodes[1] - self._nodes[0]
                drawn[points] = self._nodes[_drawn(each, random)] + step * (random.random(each.shape[:2]) - 0.5)
        return result, drawn

    def _table(self, z: Array) -> Array:
        """ln of the likelihood of the patches of each batch at the values that it may have, at one point: (fractions, batches, values)."""
        assert self.priors.of_batch is not None
        values = np.repeat(self.values(z), _NODES, axis=0)
        values[:, self.priors.of_batch.place] = np.exp(self._nodes)
        mixed = _mixed(self._single(values), self.fractions[:, None, None])  # (fractions, values, patches)
        return np.stack([mixed[..., self._batches == batch].sum(axis=2) for batch in range(len(self.measured.batches))], axis=1)


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
