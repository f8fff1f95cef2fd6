r"""Patches that pull more than a threshold, by tilted heights.

The heights of a patch are independent, and without coupling its attraction on retraction is a sum, S(h) = Σ_i a(z_i; h), with the attraction a (minus the external
force) of one asperity of the height z at the separation h, and its pull-off F about the largest S. Heights are drawn from tilted laws

.. math:: q_j(z) = p(z) \exp(\theta_j\, a(z; h_j) - \psi_j), \qquad \psi_j = \log \operatorname{E} \exp(\theta_j\, a(z; h_j)),

under which a patch has the likelihood ratio exp(Σ_i θ_j a(z_i; h_j) − ψ_j), whatever its pull-off is by the program: on approach, after a
loop, or after a preload; also of coupled asperities, which have their places at random. Patches of all laws are weighed together (balance heuristic),

.. math:: \hat p = \frac1n \sum_i \frac{1[F_i > x]}{\sum_j \alpha_j \exp(\theta_j S_i(h_j) - N \psi_j)},

which is unbiased for any shares α_j and tilts that do not depend on these patches. F above x is a union over
separations. For each of them θ is that of Chernoff's bound, the supremum of θx − Nψ(θ), which makes x the mean of S(h):
all asperities that pull together are drawn more often, not the highest alone.

**Every separation at which the event happens has a law.** An asperity pulls over a part of a nanometre only. A patch
whose best separation is between the laws, or beyond the last one, would have a large weight that few samples see. So
laws are much closer than the attraction is wide, as far as bounds are within e⁻⁸ of the largest. They have a
fifth of the patches in equal shares, and a tenth is of the scene's own heights: weights are bounded.

**The number of patches does not depend on the estimate.** A pilot gives the shares of the laws by cross-entropy (how
probable it is that a patch of the event is of each) and the second moment of the weights, and that the number of patches
for an error. Then it is thrown away. Laws have their shares of the patches by systematic sampling, so few patches do for many laws.

Heights are in cells, in which the attraction of one asperity counts as that of the middle: the likelihood ratio is exact for what is drawn.

References: D. Siegmund, *Ann. Stat.* **4** (1976) 673; D. Q. Naiman, C. E. Priebe, *J. Comput. Graph. Stat.* **10**
(2001) 296 (maxima); E. Veach, L. J. Guibas, *Proc. SIGGRAPH* (1995) 419; A. Owen, Y. Zhou, *J. Am. Stat. Assoc.* **95**
(2000) 135 (mixtures with a defensive part); R. Y. Rubinstein, D. P. Kroese, *The Cross-Entropy Method* (2004).
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, special

from ..progress import Bar
from .estimate import LEAST, Probability, shared
from .heights import Array

__all__ = ["Cells", "Drawn", "Mixture", "Tilts"]

# Cells of heights.
_CELLS = 2**12
# Heights, and numbers in cells, at once.
_HEIGHTS, _NUMBERS = 8_000_000, 20_000_000
# Tilted laws within the part of the attraction that is above half of its largest, and at most in all.
_WITHIN, _LAWS = 4, 128
# ln of the least bound over the largest.
_REACH = 8.0
# Shares of the scene's own heights, and of all laws alike.
_OWN, _ALIKE = 0.1, 0.2


class Cells:
    """A law of heights in cells of equal width, the last one without end.

    Parameters
    ----------
    law : scipy.stats distribution
        Law of heights, m.
    low, high : float
        Where the first cell begins, and the last but one ends, m.

    Attributes
    ----------
    z, masses : Array
        Middle of each cell, m, and its probability.
    """

    def __init__(self, law: Any, low: float, high: float) -> None:
        self._law, edges = law, np.linspace(low, high, _CELLS)
        self._edges = edges
        beyond, below, upper = law.sf(edges), law.cdf(edges), edges[1:] > float(law.median())
        inner = np.where(upper, beyond[:-1] - beyond[1:], below[1:] - below[:-1])
        self.masses = np.append(inner, beyond[-1])
        self.masses /= self.masses.sum()
        with np.errstate(divide="ignore"):
            self.log_masses = np.log(self.masses)
            density = law.logpdf(edges)
        # How much less dense heights are at the end of a cell than where it begins, ln.
        self._fall: Array = np.nan_to_num(density[:-1] - density[1:], nan=0.0, posinf=0.0, neginf=0.0)
        self.z = np.append(0.5 * (edges[1:] + edges[:-1]), high)

    def drawn(self, cells: NDArray[np.int64], rng: np.random.Generator) -> Array:
        """Heights in cells, m, of a density that falls evenly in each."""
        share, inner = rng.random(cells.size), np.minimum(cells, _CELLS - 2)
        fall = self._fall[inner]
        steep = np.abs(fall) > 1e-6
        safe = np.where(steep, fall, 1.0)
        place = np.where(steep, -np.log1p(share * np.expm1(-safe)) / safe, share)
        z = self._edges[inner] + place * (self._edges[1] - self._edges[0])
        last = cells == _CELLS - 1
        z[last] = self._law.isf(share[last] * self._law.sf(self._edges[-1]))
        return np.asarray(z)


@dataclass(frozen=True)
class Drawn:
    """Patches of a mixture: pull-off (N), and ln of the likelihood by each law over the scene's own (n, laws)."""

    pull_off: Array
    likelihood: Array

    def and_more(self, more: Drawn) -> Drawn:
        """These patches and more of the mixture."""
        return Drawn(np.append(self.pull_off, more.pull_off), np.concatenate([self.likelihood, more.likelihood]))


@dataclass(frozen=True)
class Patch:
    """What patches are made of, and their pull-off.

    Attributes
    ----------
    cells : Cells
        Law of heights.
    count : float
        Asperities of a patch.
    poisson : bool
        Whether their number varies about it.
    one : callable
        Attraction of one asperity, N, (separations, cells), on the unloading branch at separations h, m.
    pull_off : callable
        Pull-off force of patches, N, by their heights (n, asperities), m, with NaN where there is none.
    """

    cells: Cells
    count: float
    poisson: bool
    one: Callable[[Array], Array]
    pull_off: Callable[[Array], Array]


@dataclass(frozen=True)
class Mixture:
    """Tilted laws, the scene's own first: ln of their masses over the scene's own (laws, cells), and the fraction of the
    patches that each has.
    """

    patch: Patch
    ratios: Array
    shares: Array

    def drawn(self, patches: int, rng: np.random.Generator, words: str) -> Drawn:
        """Draws patches, from each law its fraction of them on average; `words` name their progress."""
        places = (np.arange(patches) + rng.random()) / patches
        laws = np.searchsorted(np.cumsum(self.shares), places, side="right").clip(0, self.shares.size - 1)
        step = max(min(int(_HEIGHTS / self.patch.count), _NUMBERS // _CELLS), 1)
        parts = []
        with Bar(words, patches, "patches") as bar:
            for first in range(0, patches, step):
                parts.append(self._part(laws[first : first + step], rng))
                bar.to(first + parts[-1][0].size)
        forces, likelihoods = (np.concatenate(of) for of in zip(*parts, strict=True))
        return Drawn(forces, likelihoods)

    def _part(self, laws: NDArray[np.int64], rng: np.random.Generator) -> tuple[Array, Array]:
        """Pull-off and likelihoods of patches of laws."""
        patch = self.patch
        number = rng.poisson(patch.count, laws.size) if patch.poisson else np.full(laws.size, round(patch.count))
        heights = np.full((laws.size, int(number.max())), np.nan)
        in_cells = np.zeros((laws.size, _CELLS))
        for law in np.unique(laws):
            rows = np.flatnonzero(laws == law)
            cumulated = np.cumsum(patch.cells.masses * np.exp(self.ratios[law]))
            cells = np.searchsorted(cumulated, rng.random(int(number[rows].sum())) * cumulated[-1]).clip(0, _CELLS - 1)
            of = np.repeat(np.arange(rows.size), number[rows])
            in_cells[rows] = np.bincount(of * _CELLS + cells, minlength=rows.size * _CELLS).reshape(rows.size, _CELLS)
            own = np.full((rows.size, heights.shape[1]), np.nan)
            own[np.arange(heights.shape[1]) < number[rows, None]] = patch.cells.drawn(cells, rng)
            heights[rows] = own
        return patch.pull_off(heights), in_cells @ self.ratios.T

    def weights(self, drawn: Drawn) -> Array:
        """Likelihood of patches under the scene's own law over that under this mixture."""
        return np.asarray(np.exp(-special.logsumexp(drawn.likelihood, axis=1, b=self.shares)))

    def fitted(self, pilot: Drawn, threshold: float) -> Mixture:
        """The mixture whose fractions are the probabilities that a patch of the event is of each law."""
        if self.shares.size == 1:
            return self
        weights = self.weights(pilot)
        of = np.exp(pilot.likelihood) * self.shares * weights[:, None]
        return Mixture(self.patch, self.ratios, _shares((weights * (pilot.pull_off > threshold)) @ of[:, 1:]))

    def patches(self, pilot: Drawn, by: Mixture, threshold: float, alike: float) -> int:
        """The number of patches of this mixture of which those in the event weigh as many alike ones, from a pilot by another one."""
        weights = by.weights(pilot) * (pilot.pull_off > threshold)
        second = float((weights * self.weights(pilot)).mean() / weights.mean() ** 2)
        return int(alike * second) + 1

    def estimate(self, drawn: Drawn, threshold: float) -> Probability:
        """The probability of patches above a threshold, N."""
        weights, inside, n = self.weights(drawn), drawn.pull_off > threshold, drawn.pull_off.size
        (value, error), (total, total_error) = ((float(of.mean()), float(of.std(ddof=1)) / n**0.5) for of in (weights * inside, weights))
        return Probability(value, error, n, int(inside.sum()), total, total_error, *shared(weights[inside]))


class Tilts:
    """The tilted laws of patches.

    Parameters
    ----------
    patch : Patch
        What they are made of.
    separations : Array
        Separations h at which bounds are looked at first, m, rising.
    """

    def __init__(self, patch: Patch, separations: Array) -> None:
        self.patch, self._separations = patch, separations

    @functools.cached_property
    def _coarse(self) -> Array:
        return self.patch.one(self._separations)

    def mixture(self, x: float) -> Mixture | None:
        """The laws for patches above x (N); none where such patches are rarer than `LEAST`."""
        rates = np.array([self._chernoff(x, a)[1] for a in self._coarse])
        if rates.min() > -np.log(LEAST):
            return None
        own = np.zeros((1, _CELLS))
        if not (rates > 1.0).all():
            return Mixture(self.patch, own, np.ones(1))
        near = np.flatnonzero(rates < rates.min() + _REACH)
        h, z = self._separations, self.patch.cells.z
        low, high = float(h[max(near[0] - 1, 0)]), float(h[min(near[-1] + 1, h.size - 1)])
        best = self._coarse[rates.argmin()]
        strong = z[best > 0.5 * best.max()]
        # As close as laws are to be, and not closer.
        step = max(float(strong[-1] - strong[0]) / _WITHIN, float(z[1] - z[0]))
        places = np.linspace(low, high, int(np.clip(np.ceil((high - low) / step), 1, _LAWS - 1)) + 1)
        attraction = self.patch.one(places)
        found = [self._chernoff(x, a) for a in attraction]
        tilts, rates = np.transpose(found)
        used = np.flatnonzero(tilts > 0.0)
        exponents = tilts[used, None] * attraction[used]
        ratios = exponents - special.logsumexp(exponents + self.patch.cells.log_masses, axis=1, keepdims=True)
        return Mixture(self.patch, np.concatenate([own, ratios]), _shares(np.exp(rates.min() - rates[used])))

    def _chernoff(self, x: float, a: Array) -> tuple[float, float]:
        """θ ≥ 0 (1/N) and the supremum of θx − Nψ(θ) for the attraction of cells."""
        count, scale, cells = self.patch.count, float(a.max()), self.patch.cells
        if count * float(cells.masses @ a) >= x:
            return 0.0, 0.0
        if scale * count <= x:
            return 0.0, np.inf

        def cost(t: float) -> float:
            exponents = t / scale * a + cells.log_masses
            most = exponents.max()
            return count * float(most + np.log(np.exp(exponents - most).sum())) - t * x / scale

        found = optimize.minimize_scalar(cost, bounds=(0.0, 200.0), method="bounded", options={"xatol": 1e-4})
        return float(found.x) / scale, -float(found.fun)


def _shares(fitted: Array) -> Array:
    """Shares of the scene's own law and of the tilted ones: as fitted, but for what all have alike."""
    return np.append(_OWN, (1.0 - _OWN - _ALIKE) * fitted / fitted.sum() + _ALIKE / fitted.size)
