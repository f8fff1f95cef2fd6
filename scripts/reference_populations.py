"""Reference values for surfaces whose asperities are not all alike.

Writes two tables into tests/data:

* heights.csv: density and distribution function of the standard forms of the laws of heights: law, shape, s, density,
  probability below s. A shape of the truncated normal law is its upper limit;
* populations.csv: the moments of one Hertz asperity over laws of heights and radii, with s = u/std, the relative radius
  r = R/R_mean and x = max(s - d, 0): heights, their shape, radii, their coefficient of variation or alpha, d,
  E[r^(1/2) x^(3/2)] (load), E[r x] (area) and E[r x^3] (square of the load).

Densities are written down from the textbook; integrals are adaptive quadrature with 30 digits, over radii too, in
other variables than the program's. Summits of a Gaussian surface are integrated from the joint density of height and mean
curvature at a point, weighted by the determinant of its Hessian (Nayak, J. Lubr. Technol. 93 (1971) 398), and
normalised numerically, so that no closed form of the program enters.

Usage:
    uv run scripts/reference_populations.py            write the tables
"""

# /// script
# requires-python = ">=3.9"
# dependencies = ["mpmath>=1.3"]
# ///

import csv
from pathlib import Path

from mpmath import erfc, exp, expm1, gamma, inf, log, mp, mpf, pi, quad, sqrt

mp.dps = 30
DATA = Path(__file__).resolve().parent.parent / "tests" / "data"
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
            steps = [low + mpf(k) for k in (0, mpf(1) / 8, mpf(1) / 2, 1, 2, 3, 5, 8, 13, 21, 40, 80, 160)] + [inf]
        else:
            steps = [low + (high - low) * k / 8 for k in range(9)] if low < high else [low, low]
        return quad(lambda s: (s - d) ** power * self.density(s), steps)


def radius_moment(name, variation, power):
    """E[r^power], by quadrature."""
    if name == "common":
        return mpf(1)
    if name == "lognormal":
        shape = sqrt(log(1 + variation**2))
        steps = [mpf(k) for k in range(-20, 21, 2)]
        return quad(lambda z: normal(z) * exp(power * (shape * z - shape**2 / 2)), steps)
    shape = 1 / variation**2
    steps = [mpf(k) * shape / 4 for k in range(0, 40)] + [inf]
    return quad(lambda g: g ** (shape - 1 + power) * exp(-g), steps) / (gamma(shape) * shape**power)


def nayak_moments(alpha, d):
    """E[r^(1/2) x^(3/2)], E[r x], E[r x^3] of summits, with u in units of their standard deviation about their mean.

    At a point height and mean curvature t = kappa/sqrt(m4) are jointly normal: Var t = 2/3, Cov(xi, t) = 1/sqrt(alpha).
    A point is a summit with the weight of det(Hessian) > 0: the difference r of the principal curvatures has
    r^2 exponential of mean 2/3 in units of m4, so the weight is the integral of (t^2 - r^2) over r < t.
    """
    slope = 3 / (2 * sqrt(alpha))
    std = sqrt(1 - 3 / (2 * alpha))
    weight = lambda t: exp(-3 * t * t / 4) * (t * t - mpf(2) / 3 * (1 - exp(-3 * t * t / 2)))
    steps = [mpf(k) / 2 for k in range(0, 17)]
    total = quad(weight, steps)
    mean_t = quad(lambda t: t * weight(t), steps) / total
    mean_xi = slope * mean_t
    second = quad(lambda t: ((slope * t) ** 2 + std**2) * weight(t), steps) / total
    scale = sqrt(second - mean_xi**2)

    def conditional(power, t):
        # xi = mean_xi + scale * s; given t it is normal about slope * t.
        place = (mean_xi + scale * d - slope * t) / std
        nodes = [place, place + 1, place + 2, place + 4, place + 8, place + 16, place + 32]
        if place < -8:
            nodes = [place] + [mpf(k) for k in (-8, -4, -2, 0, 2, 4, 8, 12)]
        return quad(lambda z: ((z - place) * std / scale) ** power * normal(z), nodes)

    def moment(radius_power, power):
        function = lambda t: weight(t) * (mean_t / t) ** radius_power * conditional(power, t)
        return quad(function, [mpf(k) / 1000 for k in (1, 250, 500, 1000, 1500, 2000, 3000, 4000, 6000)]) / total

    with mp.workdps(15):
        return moment(mpf(1) / 2, mpf(3) / 2), moment(mpf(1), mpf(1)), moment(mpf(1), mpf(3))


def digits(value, count=17):
    return mp.nstr(mpf(value), count, min_fixed=0, max_fixed=0)


def main():
    with (DATA / "heights.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["law", "shape", "s", "density", "probability"])
        for name, shapes in HEIGHTS.items():
            for law in (Law(name, shape) for shape in shapes):
                for s in PLACES:
                    values = [law.density(s), law.probability(s)]
                    table.writerow([name, digits(law.shape), digits(s), *map(digits, values)])
    with (DATA / "populations.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["heights", "shape", "radii", "parameter", "d", "load", "area", "square"])
        for name, shapes in HEIGHTS.items():
            for law in (Law(name, shape) for shape in shapes):
                for d in SEPARATIONS:
                    values = [law.moment(mpf(3) / 2, d), law.moment(1, d), law.moment(3, d)]
                    table.writerow([name, digits(law.shape), "common", "0", digits(d), *map(digits, values)])
        law = Law("gaussian", mpf(0))
        for radii in ("lognormal", "gamma"):
            for variation in (mpf("0.1"), mpf("0.5"), mpf(1)):
                half, one = (radius_moment(radii, variation, power) for power in (mpf(1) / 2, 1))
                for d in SEPARATIONS:
                    values = [half * law.moment(mpf(3) / 2, d), one * law.moment(1, d), one * law.moment(3, d)]
                    table.writerow(["gaussian", "0", radii, digits(variation), digits(d), *map(digits, values)])
        for alpha in (mpf("1.6"), mpf("3.83"), mpf(20)):
            for d in SEPARATIONS:
                values = nayak_moments(alpha, d)
                table.writerow(["gaussian", "0", "nayak", digits(alpha), digits(d), *(digits(v, 12) for v in values)])


if __name__ == "__main__":
    main()
