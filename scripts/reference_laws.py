"""Reference values of the single-asperity laws of the rough-surface models.

Writes tests/data/laws.csv: the adhesion force, the external force and the contact radius of one asperity as
functions of lambda and delta, with the condition number of each, by the laws

* hertz, jkr, dmt: the classical elastic contacts; nothing acts before contact;
* idmt: the sphere under the Lennard-Jones stress, undeformed before contact, dmt in contact;
* md: D. Maugis, J. Colloid Interface Sci. 150 (1992) 243, in contact; nothing before;
* md_kim: md in contact, the Dugdale stress kept at sigma_0 before contact;
* ke: idmt before contact, in contact the fits of L. Kogut and I. Etsion to their elastic-plastic sphere;
* sbl: idmt before contact, in contact the Lennard-Jones stress integrated over the Hertz gap outside the
  contact, with the load and the contact radius of ke;
* ceb: idmt before contact, hertz with the adhesion force of sbl up to the critical interference; above it the
  contact of constant volume of W. R. Chang, I. Etsion and D. B. Bogy under their mean pressure, with the
  adhesion force of dmt.

They are written down in closed form, along a parameter where delta cannot be solved for, with no series; all
arithmetic has 80 digits instead. The one integral (sbl, ceb) is done twice, by different rules in different
variables.

Scaled quantities, with K = 4/3 E_r and g = pi * (work of adhesion):
    delta and omega_c in (g^2 R / K^2)^(1/3), contact radius in (g R^2 / K)^(1/3), forces in g R,
    lambda = 2 sigma_0 (R / (g K^2))^(1/3), sigma_0 = 1.03 (work of adhesion) / Z_0,
    hence Z_0 = 2.06 / (pi lambda) in the unit of delta.
The decimals of the table stand for the doubles nearest to them.
"""

import functools
from decimal import Decimal
from typing import NamedTuple

from fixtures import bisect, write
from mpmath import mp, mpf
from reference_values import (
    CONDITION_DIGITS, FOLD_LAMBDA, SMALLEST_ANGLE, STRESS_FACTOR, VALUE_DIGITS, VALUES, contact_end,
    contact_state, zone_radius,
)  # fmt: skip

mp.dps = 80

# The grid of the laws without plasticity, completed by points close to the ends of the branches (end_points).
LAMBDAS = "0.001 0.01 0.1 0.5 0.6 0.7 0.9 0.93 0.94 1.0 2.5 10.0 1000.0".split()
DELTAS = (
    "-1000.0 -630.0 -100.0 -10.0 -3.0 -2.0 -1.5 -1.1 -1.0 -0.95 -0.9 -0.8 -0.7 -0.5 -0.3 -0.1 -0.01 "
    "0.0 0.001 0.01 0.1 0.3 1.0 3.0 10.0 100.0 1000.0"
).split()
IDMT_LAMBDAS = "0.001 0.1 0.5 0.9 1.0 2.5 10.0 1000.0".split()  # idmt depends on lambda * delta only
ANY_LAMBDA = "1.0"  # hertz, jkr and dmt do not depend on lambda

# The grid of the laws with plasticity: a few delta, and multiples of omega_c on both sides of every joint.
PLASTIC_LAMBDAS = "0.001 0.1 0.9 2.5 1000.0".split()
MATERIALS = [("0.7", "0.27"), ("20.0", "0.4")]  # omega_c and Poisson's ratio
PLASTIC_DELTAS = "-1000.0 -3.0 -0.5 -0.01 0.0 1e-09 1e-05".split()
MULTIPLES = "0.001 0.03 0.3 0.99 1.01 2 4 5.99 6.01 12 50 109 111 300".split()

KEYS = ["law", "path", "lambda", "delta", "critical_interference", "poisson_ratio", "branch"]
CONDITIONS = ["adhesion_condition", "external_condition", "radius_condition"]

LARGEST_RADIUS = mpf(10000)
SNAP_LAMBDA = mp.cbrt(mpf(9) / 32)  # above it md_kim snaps from nothing straight into contact
NEAR = mpf("1e-4")  # relative distance of the end points from the ends
QUADRATURE_STEP = mpf(1) / 24
QUADRATURE_REACH = 40


class Quantity(NamedTuple):
    """A value, delta times its derivative with respect to delta, and lambda times that with respect to
    lambda."""

    value: mpf
    by_delta: mpf
    by_lambda: mpf

    def power(self, exponent):
        value = self.value**exponent
        slope = exponent * value / self.value if self.value else mpf(0)
        return Quantity(value, slope * self.by_delta, slope * self.by_lambda)

    def sensitivity(self):
        return abs(self.by_delta) + abs(self.by_lambda)


class State(NamedTuple):
    branch: str
    contact_force: Quantity
    adhesion: Quantity
    radius: Quantity


ZERO = Quantity(mpf(0), mpf(0), mpf(0))


def constant(value):
    return Quantity(mpf(value), mpf(0), mpf(0))


def noncontact(adhesion=ZERO):
    return State("noncontact", ZERO, adhesion, ZERO)


# Hertz, DMT, JKR


def hertz_contact(delta, adhesion):
    radius = Quantity(mp.sqrt(delta), mp.sqrt(delta) / 2, mpf(0))
    return State("contact", radius.power(3), adhesion, radius)


def hertz(path, lam, delta):
    return hertz_contact(delta, ZERO) if delta >= 0 else noncontact()


def dmt(path, lam, delta):
    return hertz_contact(delta, constant(2)) if delta >= 0 else noncontact()


JKR_END = mp.cbrt(mpf(1) / 6)  # the smallest stable contact radius


def jkr_delta(radius):
    return radius**2 - mpf(2) / 3 * mp.sqrt(6 * radius)


def jkr(path, lam, delta):
    if delta < (0 if path == "approach" else jkr_delta(JKR_END)):
        return noncontact()
    a = bisect(lambda a: jkr_delta(a) > delta, JKR_END, LARGEST_RADIUS)
    radius = Quantity(a, delta / (2 * a - mp.sqrt(6 / a) / 3), mpf(0))
    adhesion = radius.power(mpf(3) / 2)
    return State("contact", radius.power(3), Quantity(*(mp.sqrt(6) * part for part in adhesion)), radius)


# The undeformed sphere before contact


def spacing(lam):
    """Z_0 in the unit of delta."""
    return 2 * STRESS_FACTOR / (mp.pi * lam)


def rigid_sphere(lam, delta):
    """The state before contact at the gap Z_0 - delta under the Lennard-Jones stress."""
    ratio = 1 / (1 - delta / spacing(lam))
    force = mpf(8) / 3 * (ratio**2 - ratio**8 / 4)
    slope = mpf(8) / 3 * (2 * ratio - 2 * ratio**7) * ratio**2 * delta / spacing(lam)
    return noncontact(Quantity(force, slope, slope))


def idmt(path, lam, delta):
    return dmt(path, lam, delta) if delta >= 0 else rigid_sphere(lam, delta)


# Maugis-Dugdale


def letting_go(lam):
    """Approach at which the stable contact branch ends: first touch or, above FOLD_LAMBDA, the fold."""
    return contact_state(lam, contact_end(lam))[0]


def first_touch(lam):
    return contact_state(lam, mp.pi / 2)[0]


@functools.cache
def md_contact(lam, delta):
    """The stable contact branch, along which delta falls from infinity as the angle grows."""
    theta = bisect(lambda t: contact_state(lam, t)[0] <= delta, SMALLEST_ANGLE, contact_end(lam))
    values = contact_state(lam, theta)
    by_theta = [mp.diff(lambda t, i=i: contact_state(lam, t)[i], theta) for i in range(3)]
    by_lam = [mp.diff(lambda s, i=i: contact_state(s, theta)[i], lam) for i in range(3)]

    def quantity(i):
        slope = by_theta[i] / by_theta[0]
        return Quantity(values[i], delta * slope, lam * (by_lam[i] - slope * by_lam[0]))

    return State("contact", quantity(2).power(3), quantity(1), quantity(2))


def md(path, lam, delta):
    end = first_touch(lam) if path == "approach" else letting_go(lam)
    return md_contact(lam, delta) if delta >= end else noncontact()


# MD-Kim: before contact delta = C^2 / 2 - (8 lambda / 3 pi) C - 2 / (pi lambda), C the radius of the adhesive
# zone


def kim_reach(lam):
    """Approach at which the Dugdale stress first reaches across the gap (C = 0)."""
    return -2 / (mp.pi * lam)


def kim_fold(lam):
    """Approach at which the outer zone of md_kim ends (C = 8 lambda / 3 pi)."""
    return kim_reach(lam) - 32 * lam**2 / (9 * mp.pi**2)


def kim_gap(lam, delta):
    """The state before contact, with the larger of the two zones."""
    at_fold = 8 * lam / (3 * mp.pi)
    beyond = mp.sqrt(2 * (delta - kim_fold(lam)))
    zone = at_fold + beyond
    assert zone <= zone_radius(lam, mp.pi / 2)
    force = mp.pi / 2 * lam * zone**2
    by_lam = (8 * zone / (3 * mp.pi) - 2 / (mp.pi * lam**2)) / beyond
    return noncontact(
        Quantity(force, 2 * force * delta / (zone * beyond), force * (1 + 2 * lam * by_lam / zone))
    )


def kim_ends(path, lam):
    """Approaches at which contact and the zone before contact end."""
    if path == "retraction":
        contact = letting_go(lam)
        return contact, kim_fold(lam) if lam <= FOLD_LAMBDA else contact
    reach = kim_reach(lam)
    return (first_touch(lam) if lam <= SNAP_LAMBDA else reach), reach


def md_kim(path, lam, delta):
    contact, zone = kim_ends(path, lam)
    if delta >= contact:
        return md_contact(lam, delta)
    return kim_gap(lam, delta) if delta >= zone else noncontact()


def end_points(lam_text):
    """Decimals close to the ends of the branches of md and md_kim, on both sides and between them."""
    lam = mpf(float(lam_text))
    ends = [first_touch(lam), kim_reach(lam), kim_fold(lam) if lam <= FOLD_LAMBDA else letting_go(lam)]
    points = [f"{float(end * (1 + shift)):.10g}" for end in ends for shift in (-NEAR, NEAR)]
    between = [(a + b) / 2 for a, b in [(ends[0], ends[2]), (ends[1], ends[2])]]
    return points + [repr(float(middle)) for middle in between]


# Kogut-Etsion: up to which delta / omega_c, then (factor, exponent) of the load over P_c, of the contact area
# over pi R omega_c, and (factor, exponent, exponent of Z_0 / omega_c) of the adhesion force over 2 pi R (work
# of adhesion)

KE_PIECES = [
    ("1", ("1", "1.5"), ("1", "1"), ("0.98", "0.298", "-0.29")),
    ("6", ("1.03", "1.425"), ("0.93", "1.136"), ("0.79", "0.356", "-0.321")),
    ("110", ("1.40", "1.263"), ("0.94", "1.146"), ("1.19", "0.093", "-0.332")),
]


def ke_contact(lam, delta, critical, poisson):
    x = Quantity(delta / critical, delta / critical, mpf(0))
    ratio = Quantity(spacing(lam) / critical, mpf(0), -spacing(lam) / critical)

    def scaled(factor, quantity):
        return Quantity(*(factor * part for part in quantity))

    for limit, load, area, adhesion in KE_PIECES:
        if x.value <= mpf(limit):
            near = x.power(mpf(adhesion[1]))
            far = ratio.power(mpf(adhesion[2]))
            product = Quantity(near.value * far.value, near.by_delta * far.value, near.value * far.by_lambda)
            force = scaled(2 * mpf(adhesion[0]), product)
            break
    else:
        load, area, force = (3 / (mpf("0.454") + mpf("0.41") * poisson), "1"), ("2", "1"), ZERO
    return State(
        "contact",
        scaled(critical ** mpf("1.5") * mpf(load[0]), x.power(mpf(load[1]))),
        force,
        scaled(mp.sqrt(critical * mpf(area[0])), x.power(mpf(area[1]) / 2)),
    )


def ke(path, lam, delta, critical, poisson):
    return ke_contact(lam, delta, critical, poisson) if delta >= 0 else rigid_sphere(lam, delta)


# Lennard-Jones stress over the Hertz gap. With r = a sec(phi), t = tan(phi), a^2 = R delta and p = delta /
# (pi Z_0) the gap is Z = Z_0 (1 + p G), G = t + (t^2 - 1) arctan(t), and the adhesion force in units of pi R
# (work of adhesion)     (16 pi / 3) p * integral of [(1 + p G)^-3 - (1 + p G)^-9] t dt over t > 0.


@functools.cache
def hertz_gap(k):
    """t and G at the k-th node, log(t) = k QUADRATURE_STEP."""
    t = mp.exp(k * QUADRATURE_STEP)
    return t, t + (t**2 - 1) * mp.atan(t)


@functools.cache
def hertz_profile_force(p):
    """Adhesion force and p times its derivative, by the trapezoidal rule in log(t), which converges
    exponentially."""
    typical = min(mp.cbrt(3 / (4 * p)), mp.sqrt(2 / (mp.pi * p))) if p > 1 else mp.sqrt(2 / (mp.pi * p))
    middle = int(mp.nint(mp.log(typical) / QUADRATURE_STEP))
    reach = int(QUADRATURE_REACH / QUADRATURE_STEP)
    force = slope = mpf(0)
    for k in range(middle - reach, middle + reach + 1):
        t, gap = hertz_gap(k)
        u = p * gap
        near = 1 / (1 + u)
        stress = near**3 - near**9
        force += t**2 * stress
        slope += t**2 * (stress + u * (9 * near**10 - 3 * near**4))
    factor = 16 * mp.pi / 3 * p * QUADRATURE_STEP
    return factor * force, factor * slope


def hertz_profile_force_again(p):
    """That adhesion force in the variable q = Z_0 / Z, by the double-exponential rule.

    As dG = 2 t (arctan(t) + t / (1 + t^2)) dt, it is 16/3 times the integral of (q - q^7) w over 0 < q < 1,
    with w = (pi / 2) / (arctan(t) + t / (1 + t^2)) at the t where p G(t) = 1 / q - 1; w = 1 gives the DMT
    value 2.
    """

    def integrand(q):
        gap = (1 - q) / (q * p)
        # G is convex, smaller than 4/3 t^3 and than pi/2 t^2: Newton's rule falls from above onto the root
        t = max(mp.cbrt(3 * gap / 4), mp.sqrt(2 * gap / mp.pi)) * 2 + mpf(10) ** -30
        for _ in range(200):
            bend = mp.atan(t) + t / (1 + t**2)
            step = (t + (t**2 - 1) * mp.atan(t) - gap) / (2 * t * bend)
            t -= step
            if abs(step) <= t * mpf(10) ** -30:  # the next correction would be its square
                break
        return (q - q**7) * mp.pi / 2 / (mp.atan(t) + t / (1 + t**2))

    with mp.workdps(2 * mp.dps):
        breaks = sorted({mpf(0), mpf(1), *(1 / (1 + p * mpf(10) ** j) for j in (-3, -2, -1, 0, 1, 2))})
        return mpf(16) / 3 * mp.quad(integrand, breaks, maxdegree=8)


def sbl(path, lam, delta, critical, poisson):
    if delta < 0:
        return rigid_sphere(lam, delta)
    state = ke_contact(lam, delta, critical, poisson)
    if delta == 0:
        return state._replace(adhesion=constant(2))
    force, slope = hertz_profile_force(delta / (mp.pi * spacing(lam)))
    return state._replace(adhesion=Quantity(force, slope, slope))


def ceb(path, lam, delta, critical, poisson):
    if delta < 0:
        return rigid_sphere(lam, delta)
    if delta <= critical:
        force, slope = hertz_profile_force(delta / (mp.pi * spacing(lam))) if delta else (mpf(2), mpf(0))
        return hertz_contact(delta, Quantity(force, slope, slope))
    # A = pi R (2 delta - omega_c), P = K H A, where K H A = 3/2 P_c at A = pi R omega_c
    radius = mp.sqrt(2 * delta - critical)
    pressure = mpf(3) / 2 * mp.sqrt(critical)
    load = Quantity(pressure * radius**2, 2 * pressure * delta, mpf(0))
    return State("contact", load, constant(2), Quantity(radius, delta / radius, mpf(0)))


def cases():
    """Law, path and the texts of the inputs of every row."""
    both = ("approach", "retraction")

    def ordered(texts):
        return sorted({float(text): text for text in texts}.values(), key=float)

    jkr_end = jkr_delta(JKR_END)
    jkr_deltas = ordered(DELTAS + [f"{float(jkr_end * (1 + shift)):.10g}" for shift in (-NEAR, NEAR)])
    for law, lams, deltas, paths in [
        (hertz, [ANY_LAMBDA], DELTAS, both[:1]),
        (jkr, [ANY_LAMBDA], jkr_deltas, both),
        (dmt, [ANY_LAMBDA], DELTAS, both[:1]),
        (idmt, IDMT_LAMBDAS, DELTAS, both[:1]),
        (md, LAMBDAS, None, both),
        (md_kim, LAMBDAS, None, both),
    ]:
        for path in paths:
            for lam in lams:
                for delta in deltas or ordered(DELTAS + end_points(lam)):
                    yield law, path, lam, delta, "", ""
    for law in (ke, sbl, ceb):
        for critical, poisson in MATERIALS:
            multiples = [str(float(Decimal(critical) * Decimal(x))) for x in MULTIPLES]
            for lam in PLASTIC_LAMBDAS:
                for delta in ordered(PLASTIC_DELTAS + multiples):
                    yield law, both[0], lam, delta, critical, poisson


def table():
    """All rows, as text."""
    for law, path, *inputs in cases():
        state = law(path, *(mpf(float(text)) for text in inputs if text))
        force, adhesion, radius = state.contact_force, state.adhesion, state.radius
        external = Quantity(*(f - a for f, a in zip(force, adhesion)))
        quantities = adhesion, external, radius
        scales = adhesion.value, force.value + adhesion.value, radius.value
        numbers = [q.sensitivity() / scale if scale and q.value else mpf(0) for q,
                   scale in zip(quantities, scales)]
        values = [mp.nstr(q.value, VALUE_DIGITS) for q in quantities]
        yield [law.__name__, path, *inputs, state.branch, *values,
               *(mp.nstr(n, CONDITION_DIGITS) for n in numbers)]


def main():
    write("laws.csv", KEYS + VALUES + CONDITIONS, table())
    ratios = [hertz_profile_force_again(mpf(10) ** n) / hertz_profile_force(mpf(10) ** n)[0]
              for n in (-12, -6, -2, 0, 1, 4, 7)]
    print(f"sbl: the two quadratures agree within {mp.nstr(max(abs(ratio - 1) for ratio in ratios), 2)}")


if __name__ == "__main__":
    main()
