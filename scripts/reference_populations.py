"""Reference values for surfaces whose asperities are not all alike.

Writes two tables into tests/data:

* heights.csv: density and distribution function of the standard forms of the laws of heights: law, shape, s,
  density, probability below s. A shape of the truncated normal law is its upper limit;
* populations.csv: the moments of one Hertz asperity over laws of heights and radii, with s = u/std, the
  relative radius r = R/R_mean and x = max(s - d, 0): heights, their shape, radii, their coefficient of
  variation or alpha, d, E[r^(1/2) x^(3/2)] (load), E[r x] (area) and E[r x^3] (square of the load).

Densities are written down from the textbook; integrals are adaptive quadrature with 30 digits, over radii
too, in other variables than the program's. Summits of a Gaussian surface are integrated from the joint
density of height and mean curvature at a point, weighted by the determinant of its Hessian (Nayak, J. Lubr.
Technol. 93 (1971) 398), and normalised numerically, so that no closed form of the program enters.
"""

import functools
import math

import numpy as np
from fixtures import write
from mpmath import erfc, exp, expm1, gamma, inf, log, mp, mpf, pi, quad, sqrt

mp.dps = 30
HEIGHTS = {
    "gaussian": [mpf(0)],
    "exponential": [mpf(0)],
    "weibull": [mpf(1), mpf("2.5"), mpf(8)],
    "lognormal": [mpf("0.05"), mpf("0.4"), mpf("1.2")],
    "truncated": [mpf(-1), mpf("1.5")],
}
PLACES = [mpf(s) for s in "-3 -1.2 -0.9 -0.3 0 0.4 1 1.4 2 3.5 6 9".split()]
SEPARATIONS = [mpf(d) for d in "-1 0.5 2 3.5".split()]


def normal(z):
    return exp(-z * z / 2) / sqrt(2 * pi)


def below(z):
    return erfc(-z / sqrt(2)) / 2


class Law:
    """The standard form of a law of heights: density, probability and support."""

    def __init__(self, name, shape):
        self.name, self.shape = name, shape
        if name == "weibull":
            self.mean = gamma(1 + 1 / shape)
            self.std = sqrt(gamma(1 + 2 / shape) - self.mean**2)
        elif name == "lognormal":
            self.mean = exp(shape**2 / 2)
            self.std = self.mean * sqrt(expm1(shape**2))
        elif name == "exponential":
            self.mean = self.std = mpf(1)

    def support(self):
        if self.name == "gaussian":
            return -inf, inf
        if self.name == "truncated":
            return -inf, self.shape
        return -self.mean / self.std, inf

    def density(self, s):
        low, high = self.support()
        if s < low or s > high:
            return mpf(0)
        if self.name == "gaussian":
            return normal(s)
        if self.name == "truncated":
            return normal(s) / below(self.shape)
        x = self.mean + self.std * s
        if self.name == "exponential":
            return self.std * exp(-x)
        if self.name == "weibull":
            return self.std * self.shape * x ** (self.shape - 1) * exp(-(x**self.shape))
        return self.std * normal(log(x) / self.shape) / (self.shape * x) if x > 0 else mpf(0)

    def probability(self, s):
        low, high = self.support()
        if s <= low or s >= high:
            return mpf(s >= high)
        if self.name == "gaussian":
            return below(s)
        if self.name == "truncated":
            return below(s) / below(self.shape)
        x = self.mean + self.std * s
        if self.name == "exponential":
            return -expm1(-x)
        if self.name == "weibull":
            return -expm1(-(x**self.shape))
        return below(log(x) / self.shape)

    def moment(self, power, d):
        """E[max(s - d, 0)^power]."""
        low, high = self.support()
        low = max(low, d)
        if high == inf:
            steps = [low + mpf(k)
                     for k in (0, mpf(1) / 8, mpf(1) / 2, 1, 2, 3, 5, 8, 13, 21, 40, 80, 160)] + [inf]
        else:
            steps = [low + (high - low) * k / 8 for k in range(9)] if low < high else [low, low]
        return quad(lambda s: (s - d) ** power * self.density(s), steps)


def radius_moment(name, variation, power):
    """E[r^power], by quadrature."""
    if name == "lognormal":
        shape = sqrt(log(1 + variation**2))
        steps = [mpf(k) for k in range(-20, 21, 2)]
        return quad(lambda z: normal(z) * exp(power * (shape * z - shape**2 / 2)), steps)
    shape = 1 / variation**2
    steps = [mpf(k) * shape / 4 for k in range(0, 40)] + [inf]
    return quad(lambda g: g ** (shape - 1 + power) * exp(-g), steps) / (gamma(shape) * shape**power)


@functools.lru_cache
def legendre(count):
    return np.polynomial.legendre.leggauss(count)


def nodes(ends, count):
    """Places and weights of Gauss-Legendre quadrature on panels."""
    ends = np.asarray(ends)
    x, w = legendre(count)
    half = 0.5 * np.diff(ends)[:, None]
    return (0.5 * (ends[1:] + ends[:-1])[:, None] + half * x).ravel(), (half * w).ravel()


def nayak_moments(alpha, d, fine=1):
    """E[r^(1/2) x^(3/2)], E[r x], E[r x^3] of summits, with u in units of their standard deviation about
    their mean.

    At a point height xi and mean curvature t = kappa/sqrt(m4) are jointly normal: Var t = 2/3, Cov(xi, t) =
    1/sqrt(alpha). A point is a summit with the weight of det(Hessian) > 0: half the difference r of the
    principal curvatures has r^2 exponential of mean 2/3 in units of m4, so the weight is the mean of t^2 -
    r^2 over r < t. Two nested Gauss rules in double precision, on panels so narrow that halving them (fine =
    2) changes nothing in the first 11 digits.
    """
    slope, std = 1.5 / math.sqrt(alpha), math.sqrt(1 - 1.5 / alpha)
    t, w = nodes(np.concatenate([[1e-5, 1e-3, 1e-2, 0.05], np.arange(0.1, 8.0, 0.1 / fine)]), 30)
    square = 1.5 * t * t
    # t^2 - (2/3)(1 - exp(-q)), by its series where that cancels.
    series = sum((-1.0) ** k * square**k / math.factorial(k) for k in range(2, 14))
    difference = np.where(square < 0.5, series, np.expm1(-square) + square) / 1.5
    w = w * np.exp(-0.5 * square) * difference
    w /= w.sum()
    mean_t = (w * t).sum()
    mean_xi = slope * mean_t
    scale = math.sqrt((w * ((slope * t) ** 2 + std**2)).sum() - mean_xi**2)

    def conditional(power, t):
        # xi = mean_xi + scale * s; given t it is normal about slope * t. The root at its lower end is taken
        # out.
        place = (mean_xi + scale * d - slope * t) / std
        low = max(place, -13.0)
        if low > 13.0:
            return 0.0
        y, w = nodes(np.linspace(math.sqrt(low - place), math.sqrt(13.0 - place), 60 * fine + 1), 20)
        z = place + y * y
        return float((w * 2.0 * y * (y * y * std / scale) ** power
                      * np.exp(-0.5 * z * z)).sum()) / math.sqrt(2 * math.pi)

    def moment(radius_power, power):
        return float((w * (mean_t / t) ** radius_power
                      * np.array([conditional(power, each) for each in t])).sum())

    return moment(0.5, 1.5), moment(1.0, 1.0), moment(1.0, 3.0)


def digits(value, count=17):
    return mp.nstr(mpf(value), count, min_fixed=0, max_fixed=0)


def laws():
    return [Law(name, shape) for name, shapes in HEIGHTS.items() for shape in shapes]


def heights():
    for law in laws():
        for s in PLACES:
            yield [law.name, *map(digits, (law.shape, s, law.density(s), law.probability(s)))]


def populations():
    def row(law, shape, radii, d, means=(1, 1)):
        moments = law.moment(mpf(3) / 2, d), law.moment(1, d), law.moment(3, d)
        values = (mean * moment for mean, moment in zip((*means, means[1]), moments))
        return [law.name, shape, *radii, digits(d), *map(digits, values)]

    for law in laws():
        yield from (row(law, digits(law.shape), ("common", "0"), d) for d in SEPARATIONS)
    gaussian = Law("gaussian", mpf(0))
    for radii in ("lognormal", "gamma"):
        for variation in (mpf("0.1"), mpf("0.5"), mpf(1)):
            means = [radius_moment(radii, variation, power) for power in (mpf(1) / 2, 1)]
            yield from (row(gaussian, "0", (radii, digits(variation)), d, means) for d in SEPARATIONS)
    for alpha in (mpf("1.6"), mpf("3.83"), mpf(20)):
        for d in SEPARATIONS:
            values = nayak_moments(float(alpha), float(d))
            yield ["gaussian", "0", "nayak", digits(alpha), digits(d), *(digits(v, 11) for v in values)]


if __name__ == "__main__":
    write("heights.csv", ["law", "shape", "s", "density", "probability"], heights())
    write("populations.csv", ["heights", "shape", "radii", "parameter", "d", "load", "area", "square"],
          populations())
