"""Reference values of three rough surfaces: the direct integral of the hybrid asperity law, regime by regime.

Writes tests/data/rough_surface.csv for the three cases of Table 2 of X. Shi and A. A. Polycarpou, J. Colloid
Interface Sci. 290 (2005) 514. The laws are

* before contact, EMD: X. Shi and A. A. Polycarpou, J. Colloid Interface Sci. 281 (2005) 449, with the
  approach measured from the equilibrium spacing Z_0 and, above the lubricant, shifted by its thickness;
* in elastic contact, Maugis-Dugdale: D. Maugis, J. Colloid Interface Sci. 150 (1992) 243;
* above it, L. Kogut and I. Etsion, J. Appl. Mech. 69 (2002) 657 (load) and J. Colloid Interface Sci. 261
  (2003) 372 (adhesion), with the jumps of these fits; no adhesion in the plastic regime.

No law is inverted: before contact the integral runs in the gap z = h_0 / Z_0, in elastic contact in the angle
theta = arccos(a / c), smooth at a fold. Only the ends of branches are roots. Where the outer branch before
contact folds below the end of its regime (case II), the rest is taken from the inner branch.

All arithmetic has 40 digits; inputs are the exact decimals. Integrals run to where the Gaussian density falls
60 decades below its largest in the regime. Counts come from erfc of tails; the script stops unless the
quadrature gives each to 25 digits. Many values are below the range of a double.
"""

import itertools

from fixtures import bisect, write
from mpmath import mp, mpf
from mpmath.calculus.quadrature import GaussLegendre
from reference_values import FOLD_LAMBDA, STRESS_FACTOR, contact_state, noncontact_state

mp.dps = 40
E_R, HARDNESS, POISSON_RATIO = mpf("85.29e9"), mpf("2.5e9"), mpf("0.27")
AREA, Z0, LUBRICANT = mpf("1000e-12"), mpf("0.2e-9"), mpf("5e-10")
CASES = {  # radius, work of adhesion, height std of the surface, asperity density
    "I": ("1.66e-6", "0.01", "3.40e-9", "8.51e12"),
    "II": ("3.33e-6", "0.09", "1.619e-9", "7.39e12"),
    "III": ("6.38e-6", "0.30", "0.6541e-9", "9.87e12"),
}
H_STARS = ["0.0", "1.0", "2.0", "3.0", "4.0", "6.0"]
KEYS = ["case", "path", "lubricant_thickness_m", "h_star", "regime"]
VALUES = ["expected_count", "adhesion_force_N", "external_force_N"]

TAIL = 60 * mp.log(10)  # change of the exponent of the density from its largest value in the regime
FOLDS = mpf(8)  # its largest change over a panel in a tail
LOG_STEP, SCAN_STEP = mpf(1) / 4, mpf(1) / 64  # longest panel and scan step, in log(theta) and log(z - 1)
RULE = GaussLegendre(mp).calc_nodes(4, mp.prec)  # 24 nodes and weights on [-1, 1]


class Case:
    """One rough surface and the scales of its asperities."""

    def __init__(self, name):
        self.radius, work, std, density = map(mpf, CASES[name])
        modulus, ratio = 4 * E_R / 3, mp.pi * work
        self.asperities = density * AREA
        self.sigma = mp.sqrt(std**2 - mpf("3.717e-4") / (density * self.radius) ** 2)
        offset = mpf("0.045944") / (density * self.radius)
        self.separations = [mpf(h_star) * std - offset for h_star in H_STARS]
        self.lam = 2 * STRESS_FACTOR * work / Z0 * mp.cbrt(self.radius / (ratio * modulus**2))
        self.length = mp.cbrt(ratio**2 * self.radius / modulus**2)  # unit of the approach
        self.force = ratio * self.radius
        yielding = mp.pi * (mpf("0.454") + mpf("0.41") * POISSON_RATIO) * HARDNESS
        self.critical = (yielding / (2 * E_R)) ** 2 * self.radius
        self.critical_load = 2 * yielding * self.critical * self.radius / 3

    def reach(self, low, high):
        """The |u| at which the density is 60 decades below its largest value in low < u < high."""
        nearest = max(low, min(high, mpf(0)))
        return mp.sqrt(nearest**2 + 2 * TAIL * self.sigma**2)

    def probability(self, low, high):
        """The probability of low < u < high, from the tails."""
        if high <= 0:
            low, high = -high, -low
        below, above = (mp.erfc(abs(u) / self.sigma / mp.sqrt(2)) for u in (low, high))
        return (below - above) / 2 if low >= 0 else 1 - (below + above) / 2


def along(state, lam, x):
    """Approach, d(approach)/dx, adhesion force and contact force (scaled) of a branch."""
    delta, adhesion, radius = state(lam, x)
    return delta, mp.diff(lambda y: state(lam, y)[0], x), adhesion, radius**3


def contact(lam, x):
    """The state in contact at theta = e^x."""
    return along(lambda lam, x: contact_state(lam, mp.exp(x)), lam, x)


def noncontact(lam, x):
    """The state before contact at z = 1 + e^x."""
    return along(noncontact_state, lam, x)


def first(is_true, x):
    """The place where is_true first turns true on the way from x to smaller values."""
    while not is_true(x - SCAN_STEP):
        x -= SCAN_STEP
    return bisect(is_true, x, x - SCAN_STEP)


def contact_ends(lam, path, critical):
    """log(theta) at both ends of the elastic regime."""
    touch = end = mp.log(mp.pi / 2)
    if lam > FOLD_LAMBDA:
        end = first(lambda x: contact(lam, x)[1] < 0, touch)
        if path == "approach":
            end = first(lambda x: contact(lam, x)[0] >= contact(lam, touch)[0], end)
    return first(lambda x: contact(lam, x)[0] >= critical, end), end


def noncontact_branches(lam, start, end):
    """Intervals of log(z - 1) from start to the approach end, on the outermost branch there is."""
    outer = first(lambda x: noncontact(lam, x)[0] >= end or noncontact(lam, x)[1] > 0, start)
    fold = noncontact(lam, outer)[0]
    if mp.almosteq(fold, end, mpf("1e-30")):
        return [(outer, start)]
    # Past the fold the approach falls before it rises again on the inner branch.
    valley = first(lambda x: noncontact(lam, x)[1] < 0, outer)
    inner = first(lambda x: noncontact(lam, x)[0] >= fold, valley)
    return [(first(lambda x: noncontact(lam, x)[0] >= end, inner), inner), (outer, start)]


def gauss(low, high, parts):
    """Abscissas and weights on equal panels between low and high."""
    half = (high - low) / (2 * parts)
    return [(low + half * (2 * i + 1 + x), half * w) for i in range(parts) for x, w in RULE]


def branch_nodes(case, state, ends, shift):
    """(approach, weight, F_s, P) along a branch, in panels of at most sigma / 2 and LOG_STEP."""
    nodes = []
    coarse = mp.linspace(*ends, int(mp.ceil((ends[1] - ends[0]) / LOG_STEP)) + 1)
    for low, high in zip(coarse, coarse[1:]):
        span = abs(state(case.lam, high)[0] - state(case.lam, low)[0]) * case.length
        for x, weight in gauss(low, high, int(mp.ceil(2 * span / case.sigma))):
            delta, slope, *forces = state(case.lam, x)
            weight *= abs(slope) * case.length
            nodes.append((delta * case.length - shift, weight, *(f * case.force for f in forces)))
    return nodes


def power_nodes(case, law, low, high, d):
    """(approach, weight, F_s, P) with F_s and P as powers of the approach, between low and high within the
    reach."""
    adhesion, adhesion_power, load, load_power = map(mpf, law)
    reach = case.reach(low + d, high + d)
    low, high = max(low, -reach - d), min(high, reach - d)
    parts = int(mp.ceil((high - low) / min(case.sigma / 2, FOLDS * case.sigma**2 / reach)))
    scaled = [(delta, weight, delta / case.critical) for delta, weight in gauss(low, high, parts)]
    return [(delta, w, adhesion * x**adhesion_power, load * x**load_power) for delta, w, x in scaled]


def regimes(case, path):
    """Name of each regime, its ends in the approach, its nodes as a function of d."""
    critical, unit, load, ratio = case.critical, 2 * case.force, case.critical_load, Z0 / case.critical
    ends = contact_ends(case.lam, path, critical / case.length)
    touch = contact(case.lam, ends[1])[0] * case.length  # -delta_A of this path
    wet = touch - LUBRICANT
    farthest = case.reach(-mp.inf, wet + case.separations[0]) + case.separations[-1]
    branches = noncontact_branches(case.lam, mp.log(farthest / Z0), touch / case.length)
    before = [n for b in branches for n in branch_nodes(case, noncontact, b, LUBRICANT)]
    elastic = branch_nodes(case, contact, ends, 0)
    first_law = unit * mpf("0.79") * ratio ** mpf("-0.321"), "0.356", load * mpf("1.03"), "1.425"
    second_law = unit * mpf("1.19") * ratio ** mpf("-0.332"), "0.093", load * mpf("1.40"), "1.263"

    def powers(name, low, high, law):
        return name, low, high, lambda d: power_nodes(case, law, low, high, d)

    return [
        ("noncontact", -mp.inf, wet, lambda d: before),
        powers("lubricant", wet, touch, (unit, 0, 0, 0)),
        ("elastic", touch, critical, lambda d: elastic),
        powers("elastoplastic1", critical, 6 * critical, first_law),
        powers("elastoplastic2", 6 * critical, 110 * critical, second_law),
        powers("plastic", 110 * critical, mp.inf, (0, 0, 2 * mp.pi * case.radius * HARDNESS * critical, 1)),
    ]


def integrate(case, d, low, high, nodes):
    """Expected count, adhesion force and external force of one regime at the asperity separation d."""
    deltas, weights, adhesions, loads = zip(*nodes(d))
    weights = [case.asperities * w * mp.npdf(delta + d, 0, case.sigma) for delta, w in zip(deltas, weights)]
    count = case.asperities * case.probability(low + d, high + d)
    if not mp.almosteq(mp.fsum(weights), count, mpf("1e-25")):
        raise ArithmeticError(f"the quadrature misses the count {mp.nstr(count, 6)}")
    adhesion = mp.fdot(weights, adhesions)
    return count, adhesion, mp.fdot(weights, loads) - adhesion


def table():
    """All rows, as text."""
    for name, path in itertools.product(CASES, ("approach", "retraction")):
        case = Case(name)
        laws = regimes(case, path)
        for (h_star, d), (regime, *law) in itertools.product(zip(H_STARS, case.separations), laws):
            values = integrate(case, d, *law)
            texts = (mp.nstr(v, 15, strip_zeros=False, min_fixed=1, max_fixed=0) for v in values)
            yield [name, path, "5e-10", h_star, regime, *texts]


if __name__ == "__main__":
    write("rough_surface.csv", KEYS + VALUES, table())
