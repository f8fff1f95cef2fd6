r"""Sobol indices of a model whose outcome scatters, from blocks of points that share their random numbers.

Outcome Y(θ, ω) of parameters θ and of a patch ω; m(θ) = E[Y | θ]. By the law of total variance

.. math:: \operatorname{Var} Y = \operatorname{Var}_\theta m(\theta) + \operatorname{E}_\theta \operatorname{Var}[Y \mid \theta],

of which the second term is the scatter between patches: what is left of the variance where all parameters are known. The first is split
by Sobol's indices of m,

.. math:: S_k = \operatorname{Var} \operatorname{E}[m \mid \theta_k] / \operatorname{Var} m, \qquad
          T_k = \operatorname{E} \operatorname{Var}[m \mid \theta_{\sim k}] / \operatorname{Var} m.

**Correlated parameters** have the same two indices (Kucherenko et al. 2012): S_k is the fraction that goes if θ_k were known, with what its correlation
says of the others; T_k is the fraction that remains if all others were known. Then S_k may be above T_k. Parameters have a Gaussian copula: their normal scores
are z = Lξ with LLᵀ the correlation and ξ independent. Two points A and B give a third, ξ_A + d d·(ξ_B − ξ_A) with a unit vector d, which has the law of both.
With d the row k of L it has z_k of B, and of the others of A the part that is independent of z_k: for S_k. With d along the column k of L⁻¹ all but z_k is of A: for T_k.
Of independent parameters both are A with θ_k from B.

**Scatter as a noise term.** Only means over r patches are known, and every numerator is a mean of products of two of them, such as
m(B) (m(A_k) − m(A)) of Saltelli et al. (2010) and (m(A) − m(A_k))²/2 of Jansen (1999). With ȳ in the place of m such a product q is off by
the covariance of its factors over r: the noise. Products of *different* patches are not, and their mean over all pairs i ≠ j is

.. math:: \hat q = \frac{1}{r(r-1)} \sum_{i \ne j} q(y_i, y_j) = \frac{r^2\, q(\bar y, \bar y) - \sum_i q(y_i, y_i)}{r(r-1)},

which is unbiased for q(m, m) for any r ≥ 2, whether or not the points have the same patches. If they have (common random numbers),
differences between points have far less noise, as patch i at A and at A_k is the same surface but for parameter k: then the variance of
q̂ is that of the interaction between patch and parameter alone.

**Only differences between points count.** What patch i has everywhere more than others is in no difference, so it should be in no
numerator. T has differences alone. Of S the factor m(B) is taken from its mean over the block; as the Sobol points of a block are stratified
in each coordinate, that changes the mean of the product by O(n⁻²) of n rows or less. The variance is that of pairs, (m(A_j) − m(B_l))²/2 over all
j and l: coordinates are scrambled independently, so all A are independent of all B. Blocks of fewer than 8 rows are not stratified enough for that:
there m(B) is taken from the mean of all blocks.

**Blocks.** A block is a scrambled Sobol sequence of its own, with patches of its own; blocks are independent, and identically
distributed. Intervals are by bootstrap over the blocks, so they hold both what is left of the points and of the patches, and they take
no notice of how points within a block belong together.

References: A. Saltelli et al., *Comput. Phys. Commun.* **181** (2010) 259, table 2 b and f; M. J. W. Jansen, *Comput. Phys. Commun.*
**117** (1999) 35; S. Kucherenko, S. Tarantola, P. Annoni, *Comput. Phys. Commun.* **183** (2012) 937; A. B. Owen, *J. Complexity* **14** (1998) 466 (scrambling); B. Efron, *J. Am. Stat. Assoc.* **82** (1987) 171 (BCa).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from SALib.sample import sobol
from scipy import special, stats

from . import surrogate

__all__ = ["Estimated", "estimated", "points"]

Array = NDArray[np.float64]

# Rows of a block at least that has a mean of its own.
_STRATIFIED = 8
# The nearest to 0 and 1 that a point may be: its normal scores are finite.
_EDGE = 2.0**-53


@dataclass(frozen=True)
class Estimated:
    """Indices of one outcome, and the parts of its variance.

    Attributes
    ----------
    mean : float
        Mean over parameters and patches.
    variance : float
        Var Y of one patch with unknown parameters, in the unit of the outcome squared.
    scatter, scatter_interval : float, array (2,)
        Fraction of that variance that is between patches with equal parameters.
    first_order, total : array (k,)
        Indices of the mean over patches, S and T; NaN where the mean does not vary with the parameters, and there are none.
    first_order_interval, total_interval : array (k, 2)
        Their bootstrap intervals.
    """

    mean: float
    variance: float
    scatter: float
    scatter_interval: Array
    first_order: Array
    first_order_interval: Array
    total: Array
    total_interval: Array


def points(keys: int, rows: int, blocks: int, seed: int, correlation: ArrayLike | None = None) -> Array:
    """Points of each block. Fewer rows of a seed are the first ones of more.

    Parameters
    ----------
    keys, rows, blocks : int
        Number k of parameters, of rows n of a block (a power of 2), and of blocks.
    seed : int
        Of the scramblings.
    correlation : array (k, k), optional
        Of the normal scores of the parameters.

    Returns
    -------
    array (blocks, n, k + 2, k)
        In the unit cube: of each row A, A with each parameter in turn from B, B; these are Saltelli's points. With a correlation
        (blocks, n, 2k + 2, k), as `stiction.priors.Priors.draw` takes them: A, the k points for first-order indices, the k ones for total indices, B.

    Examples
    --------
    >>> points(3, 4, 2, seed=1).shape, points(3, 4, 2, seed=1, correlation=np.eye(3)).shape
    ((2, 4, 5, 3), (2, 4, 8, 3))
    """
    problem = {"num_vars": keys, "names": [str(key) for key in range(keys)], "bounds": [[0.0, 1.0]] * keys}
    seeds = [int(one.generate_state(1)[0]) for one in np.random.SeedSequence(seed).spawn(blocks)]
    drawn = [sobol.sample(problem, rows, calc_second_order=False, scramble=True, seed=one) for one in seeds]
    of = np.stack(drawn).reshape(blocks, rows, keys + 2, keys)
    if correlation is None:
        return of
    factor = np.linalg.cholesky(np.asarray(correlation, dtype=float))
    alone = np.linalg.inv(factor).T
    directions = np.concatenate([factor, alone / np.linalg.norm(alone, axis=1, keepdims=True)])
    a, b = special.ndtri(np.clip(of[:, :, [0, -1]], _EDGE, 1.0 - _EDGE)).transpose(2, 0, 1, 3)
    moved = a[:, :, None] + ((b - a) @ directions.T)[..., None] * directions
    return np.concatenate([of[:, :, :1], special.ndtr(moved), of[:, :, -1:]], axis=2)


def estimated(
    outcomes: ArrayLike, *, keys: int | None = None, at: ArrayLike | None = None, level: float = 0.95, resamples: int = 2000, seed: int = 1
) -> Estimated:
    """Indices from outcomes at the points of `points`.

    Parameters
    ----------
    outcomes : array (blocks, rows, k + 2, r) or (blocks, rows, 2k + 2, r)
        At the points of each row; of r ≥ 2 patches, equal for all points of a block or not. A row with a value that is not finite is left out.
    keys : int, optional
        Number k of parameters; by default they are independent, and it is that of the k + 2 points.
    at : array (blocks, rows, k + 2, k), optional
        The `points` of independent parameters. With them a polynomial near the outcomes is a control variate (`stiction.sensitivity.surrogate`).
    level : float
        Probability that an interval is to have.
    resamples, seed : int
        Of the bootstrap.

    Raises
    ------
    ValueError
        There is one patch, or fewer than two blocks have a row that is whole.

    Examples
    --------
    A sum of two parameters, of which the second varies twice as much, and equal patches:

    >>> of = points(2, 256, 8, seed=1) @ [1.0, 2.0]
    >>> found = estimated(np.stack([of, of], axis=-1))
    >>> found.first_order.round(2).tolist(), found.scatter
    ([0.2, 0.8], 0.0)
    """
    y = np.asarray(outcomes, dtype=float)
    if y.ndim != 4 or y.shape[0] < 2 or y.shape[3] < 2:
        raise ValueError(f"outcomes of the shape {y.shape}: (blocks, rows, points, patches) with at least 2 blocks and patches is needed")
    whole = np.isfinite(y).all(axis=(2, 3))
    blocks = [block[rows] for block, rows in zip(y, whole, strict=True) if rows.any()]
    if len(blocks) < 2:
        raise ValueError(f"outcomes: {len(blocks)} blocks have a row of finite values, at least 2 are needed")
    k = y.shape[2] - 2 if keys is None else keys
    # Sums over blocks of what is large would lose digits that differences need.
    centre = float(np.mean([block.mean() for block in blocks]))
    # One row for each block; indices are of their means.
    parts = np.stack([_parts(block - centre, k) for block in blocks])
    if at is not None:
        places = [block[rows] for block, rows in zip(np.asarray(at, dtype=float), whole, strict=True) if rows.any()]
        parts += _control([block.mean(axis=-1) - centre for block in blocks], places)
    mean = centre + float(np.mean([block[:, [0, -1]].mean() - centre for block in blocks]))

    found = _indices(parts.mean(axis=0))
    intervals = _intervals(parts, level, resamples, seed)
    return Estimated(
        mean=mean,
        variance=float(found[-1]),
        scatter=float(found[-2]),
        scatter_interval=intervals[-2],
        first_order=found[:k],
        first_order_interval=intervals[:k],
        total=found[k : 2 * k],
        total_interval=intervals[k : 2 * k],
    )


def _parts(y: Array, k: int) -> Array:
    """What the indices of a block are made of: k numerators each of S and T, the variance of the mean, that between patches."""
    a, mixed, b = y[:, 0], y[:, 1:-1], y[:, -1]
    change = mixed - a[:, None]
    middle = b.mean(axis=0) if len(b) >= _STRATIFIED else 0.0
    first = _pairs((b - middle)[:, None], change[:, :k]).mean(axis=0)
    total = 0.5 * _pairs(change[:, -k:], change[:, -k:]).mean(axis=0)
    of_mean = 0.5 * (_pairs(a, a) + _pairs(b, b)).mean() - _pairs(a.mean(axis=0), b.mean(axis=0))
    scatter = y[:, [0, -1]].var(axis=-1, ddof=1).mean()
    return np.concatenate([first, total, [of_mean, scatter]])


def _control(means: list[Array], places: list[Array]) -> Array:
    """What polynomials near the means have for exact parts, less what they have at the points of each block."""
    k = places[0].shape[-1]
    near = surrogate.of_others([of.reshape(-1, k) for of in places], [of.ravel() for of in means])
    at = [np.repeat(one.at(place)[..., None], 2, axis=-1) for one, place in zip(near, places, strict=True)]
    return np.stack([one.parts - _parts(of, k) for one, of in zip(near, at, strict=True)])


def _intervals(parts: Array, level: float, resamples: int, seed: int) -> Array:
    """Bootstrap intervals over the blocks, the first axis, of what `_indices` finds, (…, 2)."""
    found = _indices(parts.mean(axis=0))
    generator = np.random.default_rng(seed)
    intervals = np.empty((found.size, 2))
    others = np.array([np.delete(np.arange(len(parts)), block) for block in range(len(parts))])
    for place in range(found.size):

        def statistic(chosen: NDArray[np.intp], axis: int = -1, place: int = place) -> Array:
            of: Array = _indices(parts[chosen].mean(axis=-2))[..., place]
            return of

        without_one = statistic(others)
        if not np.isfinite(without_one).all() or np.ptp(without_one) == 0.0:
            # Equal in all blocks, such as no variance between patches at all. Where one block has all of the variance, nothing is known.
            intervals[place] = found[place] if np.ptp(without_one) == 0.0 else np.nan
            continue
        interval = stats.bootstrap(
            (np.arange(len(parts)),), statistic, confidence_level=level, n_resamples=resamples, vectorized=True,
            method="BCa", rng=generator,
        ).confidence_interval  # fmt: skip
        intervals[place] = interval.low, interval.high
    return intervals


def _pairs(first: Array, second: Array) -> Array:
    """Mean of the products of outcomes of different patches, which are the last axis."""
    r = first.shape[-1]
    whole: Array = (first.sum(axis=-1) * second.sum(axis=-1) - (first * second).sum(axis=-1)) / (r * (r - 1))
    return whole


def _indices(means: Array) -> Array:
    """S, T, fraction of the variance between patches and Var Y from the means of the parts of blocks, the last axis."""
    of_mean, scatter = means[..., -2], means[..., -1]
    whole = of_mean + scatter

    def share(part: Array, of: Array) -> Array:
        nothing = np.full(np.broadcast_shapes(part.shape, of.shape), np.nan)
        return np.asarray(np.divide(part, of, out=nothing, where=of > 0.0))

    shares = share(means[..., :-2], of_mean[..., None])
    return np.concatenate([shares, np.stack([share(scatter, whole), whole], axis=-1)], axis=-1)
