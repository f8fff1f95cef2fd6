r"""Probabilities of patches that pull less than a threshold, by importance splitting.

A patch pulls less than x where *no* separation pulls more. So it is reached in steps: of the patches below a level some are below a lower one,

.. math:: P(F < x) = P(F < x_1) \prod_l P(F < x_{l+1} \mid F < x_l).

Patches below a level are copied and moved by a Markov chain that keeps their law: each asperity is drawn again with a probability q, and the patch that
results is taken if it is below the level. Levels and q are found by a first run that is not in the estimate. Runs of
fixed levels are unbiased, and their scatter is the error. How many there are is by the scatter of 16 others: to stop
where an error looks small favours runs that have missed the rarest patches.

A patch pulls little for one of two reasons: it has few tall asperities, or **one that is so tall that it holds the others apart**. Chains do not
go from one kind to the other. So patches are of a law in which the highest asperity is *raised*: the probability density of a patch is times

.. math:: r(z_{max}) = \tfrac12 + \frac{c}{2\,P(z_{max} > z)},

which makes each tenth of that probability as common as the next, down to 1e-12, and half of the patches remain. A patch weighs 1/r ≤ 2. A
second move draws the highest asperity alone again.

Heights are drawn here and not by the program. Heights that are within the steep part of the attraction are kept one by one, in steps of σ_s/2¹⁴ or less. Of
lower ones the number in each of some bins is kept, with the mean attraction there. Curves are known at the scene's separations, and at closer ones
where patches pull most; the maximum is also looked for where asperities jump, and then closer and closer about the best place.

References: S.-K. Au, J. L. Beck, *Prob. Eng. Mech.* **16** (2001) 263 (subset simulation); F. Cérou, A. Guyader, *Stoch. Anal. Appl.* **25** (2007) 417
(levels from the particles); Z. I. Botev, D. P. Kroese, *Methodol. Comput. Appl. Probab.* **10** (2008) 471 (a first run for levels, then fixed ones).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from .. import quantities
from ..errors import StictionError
from ..progress import Bar, steps
from .estimate import LEAST, NEVER, Probability, checked, shared
from .heights import Array

__all__ = ["Curves", "Splitting"]

Whole = NDArray[np.int64]

# Steps of heights and separations in σ_s, and in the part of the attraction that is above half of its largest: the smaller ones count.
_STEPS, _STEPS_WITHIN = 2**14, 2**8
# Width of the highest bin of low heights, in σ_s, and how much wider the next lower one is.
_BIN, _WIDER = 0.04, 1.06
# Separations within the part of the attraction that is above half of its largest.
_WITHIN = 16
# Jumps at which the maximum of a patch is looked for at most, and the distance below it of the curve next to them, in the largest attraction.
_JUMPS, _MARGIN = 32, 2.0
# The highest asperity is made more probable down to this probability.
_RAREST = 1e-12
# Tall heights of a patch at most.
_TALL = 20_000
# Terms that are looked up at once: what a cache holds.
_BLOCK = 2**18
# Patches of a run, their fraction below the next level, moves at each level, and how many of these are to be taken.
_PATCHES, _SHARE, _MOVES, _TAKEN = 250, 0.3, 6, 0.3
# Runs at least, more runs than the standard deviation of the first ones asks for, and as how many alike ones all weigh at least.
_RUNS, _MARGIN, _EFFECTIVE = 16, 1.5, 8.0


@dataclass
class _Some:
    """Patches: tall heights (n, width) in steps, numbers in bins (n, bins), attraction of tall ones at columns (n, columns), pull-off (n,)."""

    tall: Whole
    low: Whole
    sums: Array
    force: Array

    def of(self, at: Whole) -> _Some:
        return _Some(self.tall[at], self.low[at], self.sums[at], self.force[at])


class Curves:
    """Patches of explicit heights: their drawing, their moves, and their pull.

    Parameters
    ----------
    heights : scipy.stats distribution
        Law of heights, m.
    count : float
        Asperities of a patch.
    poisson : bool
        Whether their number varies about it.
    asperity : tuple of Array
        Interferences (m) and attraction there (N).
    columns : Array
        Separations from the mean plane of the summits, m, rising.
    where : tuple of float
        The least and the largest at which patches of the scene's law pull most.
    error : float
        Standard deviation that is left out where low heights are in bins, N.

    Raises
    ------
    StictionError
        A patch has too many tall asperities.

    Attributes
    ----------
    cut, step : float
        Height above which asperities are tall, and the step of their heights, m.
    nothing : int
        Value in tall heights where there is none.
    edges, separations : Array
        Of the bins of low heights, falling, and of the separations from the summits' mean plane at the columns, m.
    """

    def __init__(
        self, heights: Any, count: float, poisson: bool, asperity: tuple[Array, Array], columns: Array, where: tuple[float, float], error: float
    ) -> None:
        self.count, self.poisson = count if poisson else round(count), poisson
        at, values = asperity
        sigma, scale = float(heights.std()), float(values.max())
        strong = at[values > 0.5 * scale]
        step = min(sigma / _STEPS, (strong[-1] - strong[0]) / _STEPS_WITHIN)
        near = np.arange(*where, max((strong[-1] - strong[0]) / _WITHIN, 1e-3 * sigma))
        inside = (columns > where[0]) & (columns < where[1])
        if near.size > inside.sum():
            columns = np.sort(np.concatenate([columns[~inside], near]))
        self.columns: Whole = np.unique(np.round((columns - columns[0]) / step).astype(np.int64))
        span = int(self.columns[-1])
        d = columns[0] + self.columns * step

        # Low heights are in bins: from the highest on down, up to where their attraction is even enough within each, at 16 heights.
        lowest, cut = float(heights.ppf(1e-15)), where[0] + 2.0 * sigma
        widths = _BIN * sigma * _WIDER ** np.arange(200)
        while True:
            bins = int(np.searchsorted(np.cumsum(widths), cut - lowest)) + 1
            edges = cut - np.concatenate([[0.0], np.cumsum(np.repeat(widths[:bins] / 16, 16))])
            share = -np.diff(heights.cdf(edges)).reshape(bins, 16)
            self.low: Array = share.sum(axis=1)
            a = np.interp(0.5 * (edges[1:] + edges[:-1])[:, None] - d, at, values).reshape(bins, 16, -1)
            self.of_low: Array = np.einsum("bk,bkd->bd", share, a) / np.maximum(self.low, 1e-300)[:, None]
            variance = count * np.einsum("bk,bkd->d", share, (a - self.of_low[:, None, :]) ** 2)
            if variance[d >= where[0]].max() < error**2 or cut < lowest:
                break
            cut -= 0.1 * sigma

        self.cut, self.step, self.edges, self.separations = cut, step, edges[::16], d

        if count * float(heights.sf(cut)) > _TALL:
            raise StictionError(
                f"{count * float(heights.sf(cut)):.0f} asperities of a patch are near enough to pull one by one, and at most "
                f"{_TALL} are followed: a smaller surface.nominal_area is needed"
            )

        # Cells of tall heights, one step each; no separation tells the last ones apart.
        cells = int((d[-1] - cut + 8.0 * sigma) / step)
        self.beyond: Array = heights.sf(cut + step * np.arange(cells + 1))
        self.beyond[-1] = 0.0
        self.share = float(self.beyond[0])
        above = -np.expm1(-count * self.beyond if poisson else self.count * np.log1p(-np.minimum(self.beyond, 1.0 - 1e-15)))
        own = above[:-1] - above[1:]
        # The last is for patches without a tall height.
        rarity = np.append(1.0 / np.maximum(above[:-1], _RAREST), 1.0)
        self.ratio: Array = 0.5 + 0.5 * rarity / (own @ rarity[:-1] + 1.0 - above[0])
        self._highest = _cumulated(own * self.ratio[:-1])
        self._any = _cumulated(self.beyond[:-1] - self.beyond[1:])
        self._raised = _cumulated((self.beyond[:-1] - self.beyond[1:]) * self.ratio[:-1])

        # Attraction of a height in steps, counted from `cut` and with `span` added, less a column.
        table = np.interp(cut - d[0] + step * (np.arange(-span, cells) + 0.5), at, values)
        rise = np.diff(table)
        size = np.abs(rise)
        beside = np.maximum(np.pad(size[:-1], (1, 0)), np.pad(size[1:], (0, 1)))
        jumps = np.flatnonzero((size > 1e-3 * scale) & (size > 3.0 * beside))
        sides = np.where(rise[jumps] > 0.0, jumps + 1, jumps)
        self._jumps = np.unique([*sides[table[sides] > 0.1 * scale], int(np.argmax(table))])
        self._margin = _MARGIN * scale
        # Where there is no height, one that attracts nowhere.
        self.nothing = cells + 2 * span
        self._table = np.concatenate([table, np.zeros(span + 1)])

    def drawn(self, n: int, rng: np.random.Generator) -> _Some:
        """Patches whose highest asperity is raised."""
        cells = self.beyond.size - 1
        highest = _cell(self._highest, rng.random(n))
        has = highest < cells
        # The others are below it; below all cells where it is.
        at = np.minimum(highest, cells - 1)
        ceiling = np.where(has, self.beyond[at + 1] + rng.random(n) * (self.beyond[at] - self.beyond[at + 1]), self.share)
        total = rng.poisson(self.count * (1.0 - ceiling)) if self.poisson else int(self.count) - has
        others, number, low = self._fresh(total, rng, ceiling)
        tall = np.full((n, int(number.max()) + 17), self.nothing)
        tall[has, 0] = highest[has] + self.columns[-1]
        tall[:, 1:][np.arange(tall.shape[1] - 1) < number[:, None]] = others
        there = tall < self.nothing
        sums = self._sums(tall[there], there.sum(axis=1))
        return _Some(tall, low, sums, self._pull_off(tall, low, sums))

    def weights(self, some: _Some) -> Array:
        """Likelihood of patches under the scene's law over that with the highest asperity raised."""
        return 1.0 / self._ratio(some.tall)

    def moved(self, some: _Some, level: float, q: float, rng: np.random.Generator) -> float:
        """Moves patches that are below a level, in place; the fraction of moves that were taken."""
        taken = 0
        step = max(_BLOCK // max(some.tall.shape[1], self.columns.size), 1)
        for first in range(0, len(some.force), step):
            part = slice(first, first + step)
            old, low = some.tall[part], some.low[part]
            chosen = (old < self.nothing) & (rng.random(old.shape) < q)
            gone, less = chosen.sum(axis=1), rng.binomial(low, q)
            total = rng.poisson(q * self.count, len(old)) if self.poisson else gone + less.sum(axis=1)
            fresh, number, more = self._fresh(total, rng)
            low = low - less + more
            free = chosen | (old >= self.nothing)
            lack = int((number - free.sum(axis=1)).max())
            if lack > 0:
                some.tall = np.pad(some.tall, ((0, 0), (0, lack)), constant_values=self.nothing)
                old, free = some.tall[part], np.pad(free, ((0, 0), (0, lack)), constant_values=True)
            tall = np.where(free, self.nothing, old)
            tall[free & (np.cumsum(free, axis=1) <= number[:, None])] = fresh
            sums = some.sums[part] - self._sums(old[:, : chosen.shape[1]][chosen], gone) + self._sums(fresh, number)
            likely = rng.random(len(old)) * self._ratio(old) < self._ratio(tall)
            taken += self._take(some, first, likely, tall, low, sums, level)
            self._move_highest(some, part, level, rng)
        return taken / len(some.force)

    def _move_highest(self, some: _Some, part: slice, level: float, rng: np.random.Generator) -> None:
        """Draws the highest asperity of each patch again, above the next one."""
        tall = some.tall[part].copy()
        row, span = np.arange(len(tall)), self.columns[-1]
        heights = np.where(tall < self.nothing, tall, -1)
        place = heights.argmax(axis=1)
        old = tall[row, place]
        has = heights[row, place] >= 0
        heights[row, place] = -1
        next_one = np.maximum(heights.max(axis=1) - span, 0)
        new = np.where(has, _cell(self._raised, rng.random(len(tall)) * self._raised[::-1][next_one]) + span, old)
        tall[row, place] = new
        one = np.ones(len(tall), dtype=np.int64)
        self._take(some, part.start, has, tall, some.low[part], some.sums[part] - self._sums(old, one) + self._sums(new, one), level)

    def _take(self, some: _Some, first: int, may: NDArray[np.bool_], tall: Whole, low: Whole, sums: Array, level: float) -> int:
        """Puts patches below a level in the place of those from `first` on; returns their number."""
        at = np.flatnonzero(may & ((sums + low @ self.of_low).max(axis=1) < level))
        if at.size:
            force = self._pull_off(tall[at], low[at], sums[at])
            at, force = at[force < level], force[force < level]
            some.tall[first + at], some.low[first + at], some.sums[first + at], some.force[first + at] = tall[at], low[at], sums[at], force
        return int(at.size)

    def _fresh(self, total: Whole, rng: np.random.Generator, ceiling: Any = 0.0) -> tuple[Whole, Whole, Whole]:
        """Asperities of each patch, `total`: their tall heights one after the other, the numbers of these, and of those in bins.

        None is among the highest of the law, with the probability `ceiling`.
        """
        ceiling = np.broadcast_to(ceiling, total.shape)
        number = rng.binomial(total, np.clip((self.share - ceiling) / (1.0 - ceiling), 0.0, 1.0))
        low = rng.multinomial(total - number, self.low / max(self.low.sum(), 1e-300)) if self.low.any() else np.zeros((total.size, self.low.size), int)
        ceiling = np.repeat(ceiling, number)
        return _cell(self._any, ceiling + rng.random(ceiling.size) * (self.share - ceiling)) + self.columns[-1], number, low

    def _ratio(self, tall: Whole) -> Array:
        highest = np.where(tall < self.nothing, tall, -1).max(axis=1)
        ratio: Array = self.ratio[np.where(highest < 0, -1, highest - self.columns[-1])]
        return ratio

    def _sums(self, tall: Whole, number: Whole) -> Array:
        """Attraction of tall heights at the columns; `number` are of each patch, one after the other."""
        ends = np.concatenate([[0], np.cumsum(number)])
        found = np.empty((number.size, self.columns.size))
        first = 0
        while first < number.size:
            last = max(int(np.searchsorted(ends, ends[first] + _BLOCK // self.columns.size, side="right")) - 1, first + 1)
            z = tall[ends[first] : ends[last]]
            owner = sparse.csr_array((np.ones(z.size), np.arange(z.size), ends[first : last + 1] - ends[first]), shape=(last - first, z.size))
            found[first:last] = owner @ np.take(self._table, z[:, None] - self.columns)
            first = last
        return found

    def _pull_off(self, tall: Whole, low: Whole, sums: Array) -> Array:
        """The maximum of each curve."""
        of_low = low @ self.of_low
        curve = sums + of_low
        best: Array = curve.max(axis=1)
        place = self.columns[curve.argmax(axis=1)]

        def right(d: Whole) -> Whole:
            """The column behind each place."""
            return np.clip(np.searchsorted(self.columns, d), 1, self.columns.size - 1)

        def look(patch: Whole, d: Whole) -> None:
            """Takes the curves at places d where they are higher."""
            behind = right(d)
            share = (d - self.columns[behind - 1]) / (self.columns[behind] - self.columns[behind - 1])
            value = (1.0 - share) * of_low[patch, behind - 1] + share * of_low[patch, behind]
            step = max(_BLOCK // tall.shape[1], 1)
            for first in range(0, patch.size, step):
                part = slice(first, first + step)
                value[part] += np.take(self._table, tall[patch[part]] - d[part, None]).sum(axis=1)
            order = np.lexsort((value, patch))
            last = order[np.append(np.diff(patch[order]) > 0, True)] if order.size else order
            last = last[value[last] > best[patch[last]]]
            best[patch[last]], place[patch[last]] = value[last], d[last]

        highest, row = best.copy(), np.arange(len(tall))[:, None]
        for jump in self._jumps:
            d = tall - jump
            behind = right(d)
            inside = (tall < self.nothing) & (d >= 0) & (d <= self.columns[-1])
            beside = np.where(inside, np.maximum(curve[row, behind - 1], curve[row, behind]), -np.inf)
            least = highest - self._margin
            if beside.shape[1] > _JUMPS:
                least = np.maximum(least, np.partition(beside, -_JUMPS, axis=1)[:, -_JUMPS])
            patch, which = np.nonzero(beside >= least[:, None])
            look(patch, d[patch, which])
        behind = right(place)
        width = self.columns[behind] - self.columns[behind - 1]
        while (width := width // 4).any():
            beside = place[:, None] + np.array([-3, -2, -1, 1, 2, 3]) * width[:, None]
            look(np.repeat(row, 6), np.clip(beside, 0, self.columns[-1]).ravel())
        return best


def _cumulated(masses: Array) -> Array:
    """Masses of the last cells: none, one, ... all of them."""
    return np.concatenate([[0.0], np.cumsum(masses[::-1])])


def _cell(cumulated: Array, mass: Array) -> Whole:
    """The cell in which the mass of the last cells becomes `mass`; the number of cells if it does in none."""
    place = np.searchsorted(cumulated, mass, side="right")
    return np.where(place == cumulated.size, cumulated.size - 1, cumulated.size - 1 - place)


@dataclass
class _Runs:
    """Results of runs: pull-off of patches of the last level (N), their weights and totals, run by run."""

    forces: list[Array] = field(default_factory=list)
    weights: list[Array] = field(default_factory=list)
    totals: list[float] = field(default_factory=list)

    def below(self, threshold: float) -> Array:
        """The probability by each run."""
        return np.array([float(weights[forces <= threshold].sum()) for forces, weights in zip(self.forces, self.weights, strict=True)])


class Splitting:
    """Probabilities and quantiles of patches that pull little.

    Parameters
    ----------
    curves : Curves
        The patches.
    rng : numpy.random.Generator
        Draws all of them.
    """

    def __init__(self, curves: Curves, rng: np.random.Generator) -> None:
        self.curves, self.rng = curves, rng

    def probability(self, threshold: float, error: float, most: int) -> Probability:
        """The probability that a patch pulls less than a threshold, N; see `Patches.probability`."""
        with Bar("levels"):
            found = self._levels(lambda level, _: level <= threshold)
        if found is None:
            return NEVER
        levels, spent = found
        return self._sampled(levels, spent, lambda _: threshold, error, most)[0]

    def quantile(self, probability: float, error: float, most: int) -> tuple[float, tuple[float, float]]:
        """The force that a patch pulls less than with a probability, and its interval of 95 %, N."""

        def force(runs: _Runs, wanted: float = probability) -> float:
            forces, weights = np.concatenate(runs.forces), np.concatenate(runs.weights) / len(runs.forces)
            order = np.argsort(forces)
            place = np.searchsorted(np.cumsum(weights[order]), wanted)
            return float(forces[order[min(int(place), order.size - 1)]])

        with Bar("levels"):
            reached = self._levels(lambda _, below: below < probability)
        if reached is None:
            raise StictionError(f"no force was found below which a patch pulls with the probability {probability:g}")
        levels, spent = reached
        found, runs = self._sampled(levels, spent, force, error, most)
        low, high = (force(runs, probability * end / found.value) for end in found.interval)
        return force(runs), (low, high)

    def _levels(self, enough: Callable[[float, float], bool]) -> tuple[list[tuple[float, float]], int] | None:
        """Levels (N) with the fraction of asperities that moves draw again, until enough is said of a level and its probability; patches spent. None
        where that is rarer than `LEAST`.
        """
        some, q, reached = self.curves.drawn(_PATCHES, self.rng), 0.5, 1.0
        levels: list[tuple[float, float]] = []
        while True:
            forces = np.sort(some.force)
            level = float(forces[min(np.searchsorted(forces, forces[int(_SHARE * _PATCHES)], side="right"), _PATCHES - 1)])
            inside = np.flatnonzero(some.force < level)
            if enough(level, reached * float(self.curves.weights(some)[inside].sum()) / _PATCHES):
                return levels, _PATCHES * (1 + _MOVES * len(levels))
            reached *= inside.size / _PATCHES
            if reached < LEAST:
                return None
            some = some.of(self._copies(inside))
            for _ in range(_MOVES):
                q = min(q * float(np.exp(self.curves.moved(some, level, q, self.rng) - _TAKEN)), 1.0)
            levels.append((level, q))

    def _sampled(
        self, levels: list[tuple[float, float]], spent: int, threshold: Callable[[_Runs], float], error: float, most: int
    ) -> tuple[Probability, _Runs]:
        """Runs of fixed levels, as many as the error takes by the standard deviation of the first ones, which are thrown away."""
        patches = _PATCHES * (1 + _MOVES * len(levels))
        first = self._runs(levels, _RUNS, "trial")
        x = threshold(first)
        each = first.below(x)
        what = f"the probability of a pull-off below {quantities.si(x, 'N')}"
        if not each.any():
            raise StictionError(f"{what} is not known: no patch of {_RUNS} runs is below it")
        number = max(int(np.ceil(_MARGIN * each.var(ddof=1) / (error * each.mean()) ** 2)), _RUNS)
        spent += patches * (_RUNS + number)
        if spent > most:
            raise StictionError(
                f"{what} takes {spent} patches for an error of {100 * error:.0f} %, and {most} are allowed: a larger "
                "`error`, or `most` of more patches"
            )
        runs = self._runs(levels, number, "sampling")
        x = threshold(runs)
        each, totals = runs.below(x), np.array(runs.totals)
        value, standard_error, total, total_error = (
            float(one) for of in (each, totals) for one in (of.mean(), of.std(ddof=1) / number**0.5)
        )
        hits = sum(int((forces <= x).sum()) for forces in runs.forces)
        found = Probability(value, standard_error, spent, hits, total, total_error, *shared(each))
        return checked(found, what, _EFFECTIVE, "runs"), runs

    def _runs(self, levels: list[tuple[float, float]], number: int, words: str) -> _Runs:
        runs = _Runs()
        for _ in steps(range(number), words, "runs"):
            some, reached = self.curves.drawn(_PATCHES, self.rng), 1.0
            runs.totals.append(float(self.curves.weights(some).mean()))
            for level, q in levels:
                inside = np.flatnonzero(some.force < level)
                reached *= inside.size / _PATCHES
                if not inside.size:
                    break
                some = some.of(self._copies(inside))
                for _ in range(_MOVES):
                    self.curves.moved(some, level, q, self.rng)
            runs.forces.append(some.force)
            runs.weights.append(reached * self.curves.weights(some) / _PATCHES)
        return runs

    def _copies(self, at: Whole) -> Whole:
        """Patches, as many as in a run, each of some of them as often as the others or once more."""
        times, rest = divmod(_PATCHES, at.size)
        return np.concatenate([np.repeat(at, times), self.rng.choice(at, rest, replace=False)])
