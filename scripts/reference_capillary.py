"""Reference values of a wet asperity: an elastic sphere with two nested Dugdale zones around its contact.

Writes tests/data/capillary.csv: the adhesion force, the contact force and the contact radius of a sphere that
the solids attract with the stress sigma_1 as far as the gap is below H_1, W_SLS = sigma_1 H_1, and the liquid
with sigma_0 as far as it is below h_0, gamma s = sigma_0 h_0. The law `capillary` superposes two single zones
in their place; this says by how much it is off.

The contact of radius a, with zones to b and c, follows from the transform g of the normal displacement of a
half-space, u(r) = 2/pi int_0^r g(t)/sqrt(r^2 - t^2) dt: g = delta - t^2/R within the contact, and -2/E* sum
sigma_i sqrt(e_i^2 - t^2) up to the edges e_i of the zones outside. No stress is infinite where g is
continuous at a, which says delta(a, b, c); the gaps at b and c are H_1 and h_0, solved by a hybrid Powell
method to 1e-13; the force is 2 E* int g. With one zone this is Maugis' solution, which is checked.

Scaled quantities are as in reference_laws.py for the dry work of adhesion: R = K = 1, pi (work of
adhesion) = 1, Z_0 = 2.06/(pi lambda). `share` is gamma s over the work of adhesion, `range` h_0 over Z_0.

Writes tests/data/menisci.csv too: the force of a bridge between a rigid sphere and a flat by the
Young-Laplace equation, as a share of 2 pi R gamma s, at a distance D = `distance` h_0, of a Kelvin radius r_K
= `kelvin_radius` R and equal contact angles. The profile is integrated from the flat in its arc length, with
the mean curvature -1/(2 r_K), up to where it meets the sphere under the contact angle; the circle on the flat
follows from D, on the side of the larger circles. The force is 2 pi gamma x sin theta + pi x^2 gamma/r_K at
the flat.
"""

from math import acos, asin, cos, pi, radians, sin, sqrt

from fixtures import write
from mpmath import mpf
from reference_values import contact_angle, contact_state
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq, fsolve

E = 0.75
STRESS = 1.03
CASES = [
    (lam, share, reach)
    for lam in (0.03, 0.3, 1.0, 3.0)
    for share, reach in ((0.3, 5.0), (0.6, 5.0), (0.9, 5.0), (0.6, 20.0))
]


def beside(edge, a, r):
    """int_a^min(r, edge) sqrt(edge^2 - t^2)/sqrt(r^2 - t^2) dt, smooth in the angle of the smaller."""
    top = min(edge, r)
    lower = asin(min(1.0, a / top))
    if r <= edge:
        integrand = lambda angle: sqrt(max(edge**2 - (r * sin(angle)) ** 2, 0.0))
    else:
        integrand = lambda angle: (edge * cos(angle)) ** 2 / sqrt(r**2 - (edge * sin(angle)) ** 2)
    return quad(integrand, lower, pi / 2, epsabs=1e-14, epsrel=1e-13, limit=200)[0]


class Sphere:
    """A sphere of R = K = 1 with zones of (stress, range)."""

    def __init__(self, zones):
        self.zones = zones

    def displacement(self, a, edges):
        """The displacement at which no stress is infinite."""
        return a * a - 2 / E * sum(s * sqrt(max(e * e - a * a, 0.0)) for (s, _), e in zip(self.zones, edges))

    def gap(self, r, a, edges):
        """The gap at r > a."""
        delta = self.displacement(a, edges)
        angle = asin(min(1.0, a / r))
        inside = delta * angle - (r * r * angle / 2 - a * sqrt(r * r - a * a) / 2)
        outside = -2 / E * sum(s * beside(e, a, r) for (s, _), e in zip(self.zones, edges))
        return r * r / 2 - delta + 2 / pi * (inside + outside)

    def edges(self, a, start=None):
        """Edges of the zones of a contact of radius a."""
        start = start or [sqrt(a * a + 2 * reach) for _, reach in self.zones]

        def residual(x):
            edges = [a * (1 + v * v) if a > 0 else v * v for v in x]
            return [(self.gap(e, a, edges) - reach) / reach for e, (_, reach) in zip(edges, self.zones)]

        x = [sqrt(e / a - 1) for e in start]
        x, info, flag, text = fsolve(residual, x, xtol=1e-13, full_output=True)
        if max(abs(v) for v in info["fvec"]) > 1e-10:
            raise ArithmeticError(text)
        return [a * (1 + v * v) for v in x]

    def state(self, delta, low, high):
        """Adhesion force, contact force and contact radius at a displacement, of the contact between two
        radii."""
        a = brentq(lambda a: self.displacement(a, self.edges(a)) - delta, low, high, xtol=1e-14, rtol=1e-13)
        edges = self.edges(a)
        tails = sum(
            s * (e * e * acos(min(1.0, a / e)) - a * sqrt(max(e * e - a * a, 0.0))) / 2 for (s, _),
            e in zip(self.zones, edges)
        )
        force = 2 * E * (delta * a - a**3 / 3) - 4 * tails
        return a**3 - force, a**3, a

    def least(self, low=0.02, high=2.0, steps=200):
        """Contact radius and displacement at the end of the stable branch: the smallest displacement."""
        radii = [low * (high / low) ** (i / steps) for i in range(steps + 1)]
        deltas = [self.displacement(a, self.edges(a)) for a in radii]
        i = min(range(len(deltas)), key=lambda i: deltas[i])
        return radii[i], deltas[i]


MENISCI = [
    (angle, kelvin, distance)
    for angle, kelvin in ((0, 1e-3), (0, 1e-2), (30, 1e-3), (60, 5e-3), (80, 1e-3))
    for distance in (0.0, 0.3, 0.6)
]


def meniscus(circle, angle, kelvin):
    """D and the share of 2 pi R gamma s, R = 1, of a meniscus that meets the flat at a circle, or none."""

    def profile(_, at):
        return [cos(at[2]), sin(at[2]), -1 / kelvin - sin(at[2]) / at[0]]

    def down(_, at):
        return at[2] + 1.4

    down.terminal = True
    found = solve_ivp(profile, [0, 12 * kelvin], [circle, 0, pi - angle], events=[down], rtol=1e-12,
                      atol=1e-14 * kelvin,
                      dense_output=True, max_step=kelvin / 3)

    def excess(s):
        x, _, slope = found.sol(s)
        return slope - asin(min(1.0, x)) - angle

    if excess(found.t[-1]) > 0:
        return None
    x, z, _ = found.sol(brentq(excess, 0, found.t[-1], xtol=1e-16, rtol=1e-14))
    share = (2 * pi * circle * sin(angle) + pi * circle**2 / kelvin) / (4 * pi * cos(angle))
    return z - (1 - sqrt(1 - x * x)), share


def bridge(angle, kelvin, distance):
    """The share of 2 pi R gamma s at D = distance h_0, on the stable branch."""
    reach = 2 * cos(angle) * kelvin
    largest = sqrt(2 * (1 - distance) * reach)
    circles = [largest * (1.3 - i / 60) for i in range(60)]
    states = [(circle, meniscus(circle, angle, kelvin)) for circle in circles]
    outer = [circle for circle, state in states if state and state[0] < distance * reach]
    inner = min(outer) - largest / 60
    circle = brentq(lambda circle: meniscus(circle, angle, kelvin)[0] - distance * reach, inner, min(outer),
                    xtol=1e-15, rtol=1e-12)
    return meniscus(circle, angle, kelvin)[1]


def check(lam, delta):
    """One zone is Maugis' solution."""
    adhesion, _, radius = Sphere([(lam / 2, 2 / (pi * lam))]).state(delta, 0.05, 5)
    _, *expected = contact_state(mpf(lam), contact_angle(mpf(lam), mpf(delta)))
    assert abs(adhesion / expected[0] - 1) < 1e-9 and abs(radius / expected[1] - 1) < 1e-9, lam


def table():
    for lam, share, reach in CASES:
        spacing = 2 * STRESS / (pi * lam)
        liquid = (share / pi / (reach * spacing), reach * spacing)
        sphere = Sphere([((1 - share) / pi * STRESS / spacing, spacing / STRESS), liquid])
        begin, least = sphere.least()
        for delta in (0.9 * least, 0.6 * least, 0.3 * least, 0.0, 0.3, 1.0, 3.0):
            delta = float(f"{delta:.12g}")
            values = sphere.state(delta, begin * 1.0000001, 6.0)
            yield [lam, share, reach, delta] + [f"{value:.10e}" for value in values]


if __name__ == "__main__":
    check(0.3, 0.5)
    check(2.0, 1.0)
    keys = "lambda,share,range,delta,adhesion_force,contact_force,contact_radius"
    write("capillary.csv", keys.split(","), table(), "\r\n")
    rows = ([*case, f"{bridge(radians(case[0]), *case[1:]):.10f}"] for case in MENISCI)
    write("menisci.csv", ["contact_angle_deg", "kelvin_radius", "distance", "force"], rows, "\r\n")
