r"""Patches that pull more than a threshold, by tilted heights.

The asperities of a patch are independent, so its force is a sum, and its pull-off F the largest attraction over all
separations: F = max_h S(h), S(h) = Σ_i a(z_i − d), with the attraction a(δ) of one asperity (minus its external force)
at the interference δ = z − d. Heights are drawn from tilted laws

.. math:: q_j(z) = p(z) \exp(\theta_j\, a(z - d_j) - \psi_j), \qquad \psi_j = \log \operatorname{E} \exp(\theta_j\, a(z - d_j)),

under which a patch of N asperities has the likelihood ratio exp(Nψ_j − θ_j S(d_j)): a number of *the curve of the patch
itself*. Patches of all laws are weighed together (balance heuristic),

.. math:: \hat p = \frac1n \sum_i \frac{1[F_i > x]}{\sum_j \alpha_j \exp(\theta_j S_i(d_j) - N \psi_j)},

which is unbiased for any shares α_j and tilts that do not depend on these patches. F above x is a union over
separations. For each of them θ is that of Chernoff's bound, the supremum of θx − Nψ(θ), which makes x the mean of S(d):
all tops that pull together are drawn more often, not the highest alone.

**Every separation at which the event happens has a law.** An asperity pulls over a part of a nanometre only. A patch
whose best separation is between the laws, or beyond the last one, would have a large weight that few samples see. So
laws are much closer than the attraction is wide, as far as bounds are within e⁻⁸ of the largest. They have a
fifth of the patches in equal shares, and a tenth is of the scene's own heights: weights are bounded.

**The number of patches does not depend on the estimate.** A pilot gives the shares of the laws by cross-entropy (how
probable it is that a patch of the event is of each) and the second moment of the weights, and that the number of patches
for an error. Then it is thrown away.

Patches are explicit heights as below a threshold: see `splitting`.

References: D. Siegmund, *Ann. Stat.* **4** (1976) 673; D. Q. Naiman, C. E. Priebe, *J. Comput. Graph. Stat.* **10**
(2001) 296 (maxima); E. Veach, L. J. Guibas, *Proc. SIGGRAPH* (1995) 419; A. Owen, Y. Zhou, *J. Am. Stat. Assoc.* **95**
(2000) 135 (mixtures with a defensive part); R. Y. Rubinstein, D. P. Kroese, *The Cross-Entropy Method* (2004).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, special

from .estimate import LEAST, Probability, shared
from .heights import Array, Quadrature
from .splitting import Curves, Tilt

__all__ = ["Drawn", "Mixture", "Tilts"]

# Points of the quadrature over heights at which tilts are looked for.
_GRID = 2**12
# Tilted laws within the part of the attraction that is above half of its largest, and at most in all.
_WITHIN, _LAWS = 4, 128
# Steps between separations at which bounds are looked at first, in σ_s; ln of the least bound over the largest.
_SCAN, _REACH = 0.25, 8.0
# Shares of the scene's own heights, and of all laws alike.
_OWN, _ALIKE = 0.1, 0.2
# Patches of an estimate at least, and as how many alike ones those in the event are to weigh.
_PATCHES, _ALIKE_PATCHES = 500, 200
# More patches than a pilot says, as it knows the second moment of weights no better than so.
_MARGIN = 2.0


@dataclass(frozen=True)
class Drawn:
    """Patches of a mixture: pull-off (N), ln of the likelihood by each law over the scene's own (n, laws),
    and the law that each is of.
    """

    pull_off: Array
    likelihood: Array
    law: NDArray[np.int64]


@dataclass(frozen=True)
class Mixture:
    """Tilted laws, the scene's own first, and how many of the patches each has."""

    curves: Curves
    laws: list[Tilt]
    shares: Array

    def drawn(self, patches: int, rng: np.random.Generator) -> Drawn:
        """Patches, of each law as many as its share, rounded up."""
        columns, theta, psi = (np.array([getattr(law, name) for law in self.laws]) for name in ("column", "theta", "psi"))
        sizes = np.maximum(np.ceil(patches * self.shares), 2).astype(int)
        forces, likelihoods = [], []
        for law, size in zip(self.laws, sizes, strict=True):
            some = self.curves.tilted(law, int(size), rng)
            forces.append(some.force)
            # At the separations of the laws alone.
            attraction = some.sums[:, columns] + some.low @ self.curves.of_low[:, columns]
            likelihoods.append(theta * attraction - self.curves.number(some)[:, None] * psi)
        laws = np.repeat(np.arange(sizes.size), sizes)
        return Drawn(np.concatenate(forces), np.concatenate(likelihoods), laws)

    def _weights(self, drawn: Drawn, shares: Array) -> Array:
        return np.asarray(np.exp(-special.logsumexp(drawn.likelihood, axis=1, b=shares)))

    def weights(self, drawn: Drawn) -> Array:
        """Likelihood of patches of this mixture under the scene's own law over that under the mixture."""
        return self._weights(drawn, np.bincount(drawn.law) / drawn.law.size)

    def fitted(self, pilot: Drawn, threshold: float) -> Mixture:
        """The mixture whose shares are the probabilities that a patch of the event is of each law."""
        if len(self.laws) == 1:
            return self
        weights = self.weights(pilot)
        of = np.exp(pilot.likelihood) * self.shares * weights[:, None]
        return Mixture(self.curves, self.laws, _shares((weights * (pilot.pull_off > threshold)) @ of[:, 1:]))

    def patches(self, pilot: Drawn, by: Mixture, threshold: float, error: float) -> int:
        """The number of patches of this mixture that an error takes, from a pilot by another one."""
        weights = by.weights(pilot) * (pilot.pull_off > threshold)
        second = float((weights * self._weights(pilot, self.shares)).mean() / weights.mean() ** 2)
        return int(max(_MARGIN * (second - 1.0) / error**2, _ALIKE_PATCHES * second, _PATCHES)) + 1

    def estimate(self, drawn: Drawn, threshold: float) -> Probability:
        """The probability of patches above a threshold, N."""
        weights, inside, n = self.weights(drawn), drawn.pull_off > threshold, drawn.law.size
        value = variance = total = total_variance = 0.0
        for law in range(len(self.laws)):
            of = drawn.law == law
            size = int(of.sum())
            share, weight = size / n, weights[of]
            counted = weight * inside[of]
            value += share * float(counted.mean())
            total += share * float(weight.mean())
            variance += share**2 * float(counted.var(ddof=1)) / size
            total_variance += share**2 * float(weight.var(ddof=1)) / size
        hits, found = int(inside.sum()), shared(weights[inside])
        return Probability(value, variance**0.5, n, hits, total, total_variance**0.5, *found)


class Tilts:
    """The tilted laws of a scene.

    Parameters
    ----------
    heights : scipy.stats distribution
        Law of heights, m.
    ends : tuple of float
        Heights between which all are, m.
    count : float
        Asperities of a patch.
    asperity : tuple of Array
        Interferences (m) and attraction there (N).
    tops : Array
        Separations of the tops, m.
    """

    def __init__(
        self, heights: Any, ends: tuple[float, float], count: float, asperity: tuple[Array, Array], tops: Array
    ) -> None:
        self.count, self.tops, self._asperity = count, tops, asperity
        self._sigma = float(heights.std())
        self._grid = Quadrature(heights, *ends, _GRID)
        at, values = asperity
        strong = at[values > 0.5 * values.max()]
        self._width = float(strong[-1] - strong[0])
        # Beyond the highest asperity nothing happens.
        low = float(tops.min())
        self._range = low, max(min(float(tops.max()), ends[1] - float(strong[0])), low)

    def mixture(self, x: float, curves: Callable[[tuple[float, float]], Curves]) -> Mixture | None:
        """The laws for patches above x (N), with curves that are close between two separations; none where such
        patches are rarer than `LEAST`.
        """
        low, high = self._range
        inside = self.tops[(self.tops > low) & (self.tops < high)]
        scan = np.unique([*np.arange(low, high, _SCAN * self._sigma), *inside, high])
        rates = np.array([self._chernoff(x, top)[1] for top in scan])
        if rates.min() > -np.log(LEAST):
            return None
        near = np.flatnonzero(rates < rates.min() + _REACH)
        where = float(scan[max(near[0] - 1, 0)]), float(scan[min(near[-1] + 1, scan.size - 1)])
        found = curves(where)
        own = found.tilt(0, 0.0)
        if not (rates > 1.0).all():
            return Mixture(found, [own], np.ones(1))
        d = found.separations
        places = np.flatnonzero((d >= where[0] - found.step) & (d <= where[1] + found.step))
        # As close as laws are to be, and not closer.
        step = max(self._width / _WITHIN, (where[1] - where[0]) / _LAWS)
        places = places[np.unique(np.floor((d[places] - where[0]) / step + 1e-9), return_index=True)[1]]
        tilts, rates = np.transpose([self._chernoff(x, float(d[place])) for place in places])
        laws = [found.tilt(int(place), tilt) for place, tilt in zip(places, tilts, strict=True) if tilt > 0.0]
        return Mixture(found, [own, *laws], _shares(np.exp(rates.min() - rates[tilts > 0.0])))

    def _chernoff(self, x: float, top: float) -> tuple[float, float]:
        """θ ≥ 0 (1/N) and the supremum of θx − Nψ(θ) at a separation."""
        a, scale = np.interp(self._grid.z - top, *self._asperity), float(self._asperity[1].max())
        mean = self.count * self._grid.mean(a)
        if mean >= x:
            return 0.0, 0.0
        if a.max() * self.count <= x:
            return 0.0, np.inf

        def cost(t: float) -> float:
            return self.count * self._grid.log_moment(t / scale * a) - t * x / scale

        found = optimize.minimize_scalar(cost, bounds=(0.0, 200.0), method="bounded", options={"xatol": 1e-4})
        return float(found.x) / scale, -float(found.fun)


def _shares(fitted: Array) -> Array:
    """Shares of the scene's own law and of the tilted ones: as fitted, but for what all have alike."""
    return np.append(_OWN, (1.0 - _OWN - _ALIKE) * fitted / fitted.sum() + _ALIKE / fitted.size)
