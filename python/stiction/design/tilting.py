r"""Patches that pull more than a threshold, by tilted heights.

The asperities of a patch are independent, so its force is a sum, and its pull-off F the largest attraction over all separations: F = max_h
S(h), S(h) = Σ_i a(z_i − d), with the attraction a(δ) of one asperity (minus its external force) at the interference δ = z − d. Heights are drawn
from tilted laws

.. math:: q_j(z) = p(z) \exp(\theta_j\, a(z - d_j) - \psi_j), \qquad \psi_j = \log \operatorname{E} \exp(\theta_j\, a(z - d_j)),

under which a patch of N asperities has the likelihood ratio exp(Nψ_j − θ_j S(d_j)): a number that *the curve of the patch itself*
tells. So the program draws and solves patches as ever, from lists of heights of these laws, and its own exact pull-off decides which are in the
event. Replicas of all laws are weighed together (balance heuristic),

.. math:: \hat p = \frac1n \sum_i \frac{1[F_i > x]}{\sum_j (n_j/n) \exp(\theta_j S_i(d_j) - N \psi_j)},

which is unbiased for any choice of the tilts. F above x is a union over separations. For each of them θ > 0 is that of Chernoff's bound, the
supremum of θx − Nψ(θ), which makes x the mean of S(d); separations are in the mixture as their bounds exp(−rate) are large. Where S is above x
at one of these, the weight is at most the bound over the share of its law.

References: D. Siegmund, *Ann. Stat.* **4** (1976) 673; D. Q. Naiman, C. E. Priebe, *J. Comput. Graph. Stat.* **10** (2001)
296 (maxima); E. Veach, L. J. Guibas, *Proc. SIGGRAPH* (1995) 419; A. Owen, Y. Zhou, *J. Am. Stat. Assoc.* **95** (2000) 135 (mixtures).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import optimize, special

from .estimate import LEAST, Probability
from .heights import Array, Quadrature

__all__ = ["OWN", "Drawn", "Law", "Tilts", "estimate", "joined", "weights"]

# Heights of a list: more than a patch has by far, so that those of a patch hardly come from the same one.
_LIST = 2**19
# Points of the quadrature over heights, and those at which tilts are looked for.
_GRID, _COARSE = 2**18, 2**12
# Tilted laws of one mixture.
_LAWS = 8


@dataclass(frozen=True)
class Law:
    """Heights tilted by θ (1/N) at a separation of the scene, by its index; log-moment ψ."""

    at: int
    theta: float
    psi: float


# The scene's own heights.
OWN = Law(0, 0.0, 0.0)


@dataclass(frozen=True)
class Drawn:
    """Patches of one law: pull-off (n,), attraction (n, separations), number of asperities (n,)."""

    pull_off: Array
    attraction: Array
    count: Array


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

    def __init__(self, heights: Any, ends: tuple[float, float], count: float, asperity: tuple[Array, Array], tops: Array) -> None:
        self.count, self.tops, self._asperity = count, tops, asperity
        self._grid, self._coarse = (Quadrature(heights, *ends, size) for size in (_GRID, _COARSE))
        self._of_separations = np.interp(self._coarse.z[None, :] - tops[:, None], *asperity)

    def laws(self, x: float) -> tuple[list[Law], Array] | None:
        """The tilted laws for patches above x, and how many of the replicas each has; none where they are rarer than `LEAST`."""
        best = [self._chernoff(x, place) for place in range(self.tops.size)]
        rates = np.array([rate for _, rate in best])
        if rates.min() > -np.log(LEAST):
            return None
        if not (rates > 1.0).all():
            return [], np.array([])
        bound = np.exp(rates.min() - rates)
        # As many places as laws, each in the middle of an equal part of the sum of bounds.
        parts = np.cumsum(bound) / bound.sum()
        places, number = np.unique(np.searchsorted(parts, (np.arange(_LAWS) + 0.5) / _LAWS), return_counts=True)
        laws = [self._tilted(int(place), best[place][0]) for place in places]
        return laws, number / number.sum()

    def _chernoff(self, x: float, place: int) -> tuple[float, float]:
        """θ ≥ 0 (1/N) and the supremum of θx − Nψ(θ) at a separation."""
        a, scale = self._of_separations[place], float(self._asperity[1].max())
        mean = self.count * self._coarse.mean(a)
        if mean >= x:
            return 0.0, 0.0
        if a.max() * self.count <= x:
            return 0.0, np.inf

        def cost(t: float) -> float:
            return self.count * self._coarse.log_moment(t / scale * a) - t * x / scale

        found = optimize.minimize_scalar(cost, bounds=(0.0, 200.0), method="bounded", options={"xatol": 1e-4})
        return float(found.x) / scale, -float(found.fun)

    def heights(self, law: Law, rng: np.random.Generator) -> Array:
        """A list of heights of a tilted law, m."""
        return self._grid.drawn(self._exponent(law.at, law.theta), rng.random(_LIST))

    def _tilted(self, at: int, theta: float) -> Law:
        return Law(at, theta, self._grid.log_moment(self._exponent(at, theta)))

    def _exponent(self, at: int, theta: float) -> Array:
        exponent: Array = theta * np.interp(self._grid.z - self.tops[at], *self._asperity)
        return exponent


def joined(first: Drawn, second: Drawn) -> Drawn:
    """Patches of two draws."""
    return Drawn(
        np.concatenate([first.pull_off, second.pull_off]),
        np.concatenate([first.attraction, second.attraction]),
        np.concatenate([first.count, second.count]),
    )


def weights(laws: list[Law], drawn: list[Drawn]) -> list[Array]:
    """Likelihood of each patch under the scene's own law over that under the mixture of all."""
    sizes = np.array([len(of.pull_off) for of in drawn], dtype=float)
    found = []
    for of in drawn:
        logs = [law.theta * of.attraction[:, law.at] - of.count * law.psi for law in laws]
        found.append(np.exp(-special.logsumexp(logs, axis=0, b=(sizes / sizes.sum())[:, None])))
    return found


def estimate(laws: list[Law], drawn: list[Drawn], threshold: float, below: bool) -> Probability:
    """The probability of patches above (or below) a threshold, N."""
    n = sum(len(of.pull_off) for of in drawn)
    value = variance = total = total_variance = 0.0
    hits = 0
    for of, weight in zip(drawn, weights(laws, drawn), strict=True):
        size = len(of.pull_off)
        if size < 2:
            continue
        inside = of.pull_off < threshold if below else of.pull_off > threshold
        hits += int(inside.sum())
        value += size / n * float((weight * inside).mean())
        total += size / n * float(weight.mean())
        variance += (size / n) ** 2 * float((weight * inside).var(ddof=1)) / size
        total_variance += (size / n) ** 2 * float(weight.var(ddof=1)) / size
    return Probability(value, variance**0.5, n, hits, total, total_variance**0.5)
