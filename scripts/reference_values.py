"""Reference values of one elastic adhesive asperity, before and in contact.

Writes tests/data/single_asperity.csv: the adhesion force, the external force and the contact radius of one
asperity as functions of the two numbers (lambda, delta), with the condition number of each. The laws are

* in contact, Maugis-Dugdale: D. Maugis, J. Colloid Interface Sci. 150 (1992) 243;
* before contact, the extended Maugis-Dugdale model (EMD): X. Shi and A. A. Polycarpou,
  J. Colloid Interface Sci. 281 (2005) 449, with the approach measured from the equilibrium spacing Z_0.

Both are written down here in closed form along a parameter, with no series and no half-angle forms; all
arithmetic has 80 digits instead, which leaves more than 50 correct ones after every cancellation.

Scaled quantities, with K = 4/3 E_r and g = pi * (work of adhesion):
    delta in (g^2 R / K^2)^(1/3), contact radius in (g R^2 / K)^(1/3), forces in g R,
    lambda = 2 sigma_0 (R / (g K^2))^(1/3), sigma_0 = 1.03 (work of adhesion) / Z_0.
"""

import functools

from fixtures import bisect, write
from mpmath import mp, mpf

mp.dps = 80

# The grid: 0.1 means the double next to it.
LAMBDAS = "0.001 0.01 0.1 0.5 0.9 0.95 1.0 2.5 5.0 10.0 100.0 1000.0".split()
DELTAS = (
    "-10000.0 -100.0 -10.0 -3.0 -1.5 -1.1 -1.04 -1.02 -0.99 -0.95 -0.9 -0.7 -0.5 -0.3 -0.1 -0.03 -0.01 "
    "0.0 0.01 0.1 1.0 3.0 10.0 100.0 1000.0"
).split()

KEYS = ["lambda", "delta", "branch"]
VALUES = ["adhesion_force", "external_force", "contact_radius"]
CONDITIONS = ["adhesion_condition", "radius_condition", "external_condition"]
VALUE_DIGITS = 25
CONDITION_DIGITS = 12

STRESS_FACTOR = mpf("1.03")  # sigma_0 Z_0 / (work of adhesion)
SMALLEST_ANGLE = mpf("1e-10")  # far below every angle of the grid: heaviest load, largest lambda
FOLD_LAMBDA = mp.cbrt(9 * mp.pi / (16 * (mp.pi - 1)))  # above it the contact branch of Maugis-Dugdale folds
SCAN_STEP = mpf(1) / 64  # in log(z - 1)
SCAN_END = mpf(-60)


def zone_radius(lam, theta):
    """Outer radius c of the adhesive zone at the angle theta = arccos(a / c)."""
    sin, cos = mp.sin(theta), mp.cos(theta)
    quadratic = lam / 2 * (sin * cos - theta * mp.cos(2 * theta))
    linear = 4 * lam**2 / 3 * (theta * sin + cos - 1)
    return 2 / (linear + mp.sqrt(linear**2 + 4 * quadratic))


def contact_state(lam, theta):
    """Approach, adhesion force and contact radius in contact, at the angle theta = arccos(a / c)."""
    sin, cos, zone = mp.sin(theta), mp.cos(theta), zone_radius(lam, theta)
    radius = zone * cos
    delta = radius**2 - 4 * lam / 3 * zone * sin
    adhesion = lam * zone**2 * (sin * cos + theta)
    return delta, adhesion, radius


def noncontact_state(lam, x):
    """Approach, adhesion force and contact radius (zero) before contact, at z = h_0 / Z_0 = 1 + e^x."""
    z = 1 + mp.exp(x)
    stress = mpf(8) / 3 * (z**-3 - z**-9) / STRESS_FACTOR  # sigma(h_0) / sigma_0
    energy = (4 * z**-2 - z**-8) / 3  # integral of sigma beyond h_0 / (work of adhesion)
    bending = 4 * (mp.pi - 2) / (3 * mp.pi) * lam * stress
    # positive root of zone^2 / 2 + bending * zone = 2 energy / (pi lam stress)
    level = 2 * energy / (mp.pi * lam * stress)
    zone = 2 * level / (bending + mp.sqrt(bending**2 + 2 * level))
    spacing = 2 * STRESS_FACTOR / (mp.pi * lam)  # Z_0 in units of delta
    delta = -((z - 1) * spacing + 4 * lam / 3 * stress * zone)
    adhesion = mp.pi / 2 * lam * stress * zone**2
    return delta, adhesion, mpf(0)


STATES = {"contact": contact_state, "noncontact": noncontact_state}


@functools.cache
def contact_end(lam):
    """Angle at which the stable contact branch ends: first touch or, for large lambda, the fold before it."""
    first_touch = mp.pi / 2
    if lam <= FOLD_LAMBDA:
        return first_touch

    def is_unstable(theta):
        return mp.diff(lambda t: contact_state(lam, t)[0], theta) > 0

    # d(delta)/d(theta) vanishes at first touch for every lambda, hence the small distance from it.
    return bisect(is_unstable, SMALLEST_ANGLE, first_touch - mpf("1e-6"))


def contact_angle(lam, delta):
    """Angle on the stable contact branch, on which delta falls from infinity as theta grows."""
    return bisect(lambda theta: contact_state(lam, theta)[0] <= delta, SMALLEST_ANGLE, contact_end(lam))


def noncontact_gap(lam, delta):
    """log(z - 1) of the outermost gap z with this approach.

    The scan comes from far away, as the asperity does, and stops at the first crossing. Beyond a fold of the
    outer branch (0.888 < lambda < 1.116) that is the inner root, the only one there.
    """

    def has_arrived(x):
        return noncontact_state(lam, x)[0] >= delta

    x = mp.log(-delta * mp.pi * lam / (2 * STRESS_FACTOR))  # here the undeformed gap alone is -delta
    while not has_arrived(x - SCAN_STEP):
        x -= SCAN_STEP
        if x < SCAN_END:
            raise ValueError(f"no noncontact state at lambda = {lam}, delta = {delta}")
    return bisect(has_arrived, x, x - SCAN_STEP)


def branch_points(lam, delta):
    """The branches that exist at (lambda, delta), each with its parameter (angle or logarithm of the gap)."""
    if delta >= contact_state(lam, contact_end(lam))[0]:
        yield "contact", contact_angle(lam, delta)
    if delta < contact_state(lam, mp.pi / 2)[0]:
        yield "noncontact", noncontact_gap(lam, delta)


def conditions(state, lam, delta, parameter):
    """Condition numbers of adhesion force, contact radius and external force along the branch.

    With delta(lam, p) and f(lam, p) on the branch, the implicit function theorem gives
    df/d(delta) = f_p / delta_p and df/d(lam) = f_lam - f_p delta_lam / delta_p.
    """
    _, adhesion, radius = state(lam, parameter)
    by_parameter = [mp.diff(lambda p, i=i: state(lam, p)[i], parameter) for i in range(3)]
    by_lambda = [mp.diff(lambda s, i=i: state(s, parameter)[i], lam) for i in range(3)]

    def gradient(i):
        slope = by_parameter[i] / by_parameter[0]
        return slope, by_lambda[i] - slope * by_lambda[0]

    def sensitivity(by_delta, by_lam):
        return abs(delta * by_delta) + abs(lam * by_lam)

    of_adhesion, of_radius = gradient(1), gradient(2)
    of_external = [3 * radius**2 * r - a for a, r in zip(of_adhesion, of_radius)]  # of F = A^3 - F_s
    return (
        sensitivity(*of_adhesion) / adhesion,
        sensitivity(*of_radius) / radius if radius else mpf(0),
        sensitivity(*of_external) / (radius**3 + adhesion),
    )


def table():
    """All rows, as text."""
    for lam_text in LAMBDAS:
        for delta_text in DELTAS:
            lam, delta = mpf(float(lam_text)), mpf(float(delta_text))
            for branch, parameter in branch_points(lam, delta):
                state = STATES[branch]
                _, adhesion, radius = state(lam, parameter)
                values = (mp.nstr(v, VALUE_DIGITS) for v in (adhesion, radius**3 - adhesion, radius))
                numbers = (mp.nstr(v, CONDITION_DIGITS) for v in conditions(state, lam, delta, parameter))
                yield [lam_text, delta_text, branch, *values, *numbers]


if __name__ == "__main__":
    write("single_asperity.csv", KEYS + VALUES + CONDITIONS, table())
