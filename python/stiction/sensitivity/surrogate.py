r"""Polynomials near a model of independent parameters, whose Sobol indices are known: control variates of the estimators in `indices`.

With Legendre polynomials that are orthonormal on the unit cube, :math:`g(u) = \sum_\alpha c_\alpha P_\alpha(u)` has the variance :math:`\sum_{\alpha \ne 0} c_\alpha^2`; the
terms of θ_k alone are the numerator of S_k, all with θ_k the one of T_k (Sudret 2008). What a block has for the model less what it has for g, plus what g has,
is unbiased whatever g is (Kucherenko et al. 2015), as long as g is from other blocks: each of four groups of blocks has a polynomial of the other three.
Its degree is the one that predicts left-out blocks best. Where that leaves more than a fifth of the variance it is a constant, so the estimators are as they are.

References: B. Sudret, *Reliab. Eng. Syst. Saf.* **93** (2008) 964; S. Kucherenko, B. Delpuech, B. Iooss, S. Tarantola, *Reliab. Eng. Syst. Saf.* **134** (2015) 251.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

__all__ = ["Polynomial", "of_others"]

Array = NDArray[np.float64]

# Groups of blocks, points for each term at least, degree, and points of a fit at most.
_GROUPS, _POINTS, _DEGREE, _MOST = 4, 4, 8, 4000
# Fraction of the variance that it may leave: a polynomial that is hardly near would make outliers of some blocks.
_LEFT = 0.2


@dataclass(frozen=True)
class Polynomial:
    """A polynomial in orthonormal Legendre polynomials on the unit cube.

    Attributes
    ----------
    powers : array (terms, k)
        Degrees of each term; the first term is the constant.
    coefficients : array (terms,)
    """

    powers: NDArray[np.intp]
    coefficients: Array

    @property
    def parts(self) -> Array:
        """Numerators of S and T of each parameter, the variance, and 0: what `indices` has of a block."""
        squares, has = self.coefficients**2, self.powers > 0
        alone = has & (has.sum(axis=1, keepdims=True) == 1)
        return np.concatenate([squares @ alone, squares @ has, [squares[1:].sum(), 0.0]])

    def at(self, points: Array) -> Array:
        """Values at points (…, k) of the unit cube."""
        flat = points.reshape(-1, points.shape[-1])
        values: Array = _terms(flat, self.powers) @ self.coefficients
        return values.reshape(points.shape[:-1])


def _terms(points: Array, powers: NDArray[np.intp]) -> Array:
    """The polynomials of some powers at points (n, k)."""
    highest = int(powers.max())
    scale = np.sqrt(2.0 * np.arange(highest + 1) + 1.0)
    single = [legendre.legvander(2.0 * column - 1.0, highest) * scale for column in points.T]
    whole = np.ones((len(points), len(powers)))
    for of, power in zip(single, powers.T, strict=True):
        whole *= of[:, power]
    return whole


def of_others(points: list[Array], means: list[Array]) -> list[Polynomial]:
    """For each block a polynomial that is fitted to blocks of other groups.

    Parameters
    ----------
    points : list of arrays (n, k)
        Points of each block in the unit cube.
    means : list of arrays (n,)
        The model there, without its mean.
    """
    groups = np.arange(len(points)) % _GROUPS
    k = points[0].shape[1]
    best = [Polynomial(np.zeros((1, k), dtype=int), np.zeros(1))] * len(points)
    least = _LEFT * sum(float(np.sum(y**2)) for y in means)
    before = np.inf
    for degree in range(1, _DEGREE + 1):
        powers = np.array(sorted((p for p in itertools.product(range(degree + 1), repeat=k) if sum(p) <= degree), key=sum))
        if len(powers) * _POINTS > sum(map(len, means)) * (1.0 - 1.0 / _GROUPS):
            break
        fits = []
        for group in range(_GROUPS):
            others = np.flatnonzero(groups != group)
            share = _MOST // len(others) + 1
            x, y = (np.concatenate([of[other][:share] for other in others]) for of in (points, means))
            # More threads would wait for each other longer than they compute.
            with threadpool_limits(1):
                fits.append(Polynomial(powers, np.linalg.lstsq(_terms(x, powers), y, rcond=None)[0]))
        found = [fits[group] for group in groups]
        error = sum(float(np.sum((y - one.at(x)) ** 2)) for x, y, one in zip(points, means, found, strict=True))
        if error >= before:
            break
        before = error
        if error < least:
            best, least = found, error
    return best
