"""Reference values of one asperity where solving is hard: at the ends of branches, in the limits of lambda,
far and deep.

Writes tests/data/stability.csv: the adhesion force, the external force and the contact radius of one asperity
as functions of lambda and delta, region by region, with the condition number of each and the distance to the
nearest place where the history changes the branch. The law `emd` is in reference_values.py
(Maugis-Dugdale in contact, extended Maugis-Dugdale before it), the other laws are in reference_laws.py;
the equations are written down there. What this file adds is the folds, found by the derivatives of those
equations at 80 digits, so that a row 1e-15 from a fold is on the right side of it.

Scaled quantities are as in reference_values.py. Every lambda and delta is a double, written with the
digits that give it back, and the rows are the truth for exactly these doubles.
"""

import functools
from typing import NamedTuple

import reference_laws
from fixtures import bisect, write
from mpmath import mp, mpf
from reference_laws import FOLD_LAMBDA, first_touch, jkr_delta, kim_ends
from reference_values import (
    CONDITIONS, SMALLEST_ANGLE, STATES, STRESS_FACTOR, VALUES, conditions, contact_state, noncontact_state,
)  # fmt: skip

EPSILON = mpf(2) ** -52
LAMBDAS = (
    "1e-06 1e-05 0.0001 0.001 0.01 0.1 0.3 0.6 0.85 0.888 0.889 0.89 0.9 0.92 0.937 0.94 0.95 1.0 1.05 "
    "1.1 1.115 1.117 1.15 1.3 2.0 2.5 3.0 5.0 10.0 30.0 100.0 1000.0 10000.0 100000.0 1000000.0"
).split()
FAR = "-1e6 -1e5 -1e4 -1e3 -100 -30".split()
BEFORE = "-10 -4 -3.001 -2.5 -1.5 -1.2 -1.05 -1.01 -0.95 -0.8 -0.5 -0.1 -0.01 -1e-3".split()
ORDINARY = "-0.9 -0.7 -0.3 -0.1 -1e-3 -1e-9 0 1e-15 1e-6 1e-2 0.1 0.5 1 3 10".split()
DEEP = "30 100 1e3 1e4 1e5 1e6".split()
SHIFTS = [mpf(10) ** -k for k in (1, 2, 3, 4, 6, 8, 10, 12, 13, 14, 15)]
FEW_SHIFTS = [mpf(10) ** -k for k in (2, 5, 8, 11, 13, 15)]
CUSP_GAPS = "0.5 0.8 0.95 1 1.05 1.3 2".split()  # multiples of lambda^(3/7)
CRITICAL, POISSON = "0.7", "0.27"

KEYS = ["region", "law", "path", "lambda", "delta", "critical_interference", "poisson_ratio", "branch"]
VALUE_DIGITS = 20
CONDITION_DIGITS = 5

# The slope of the noncontact curve has its only hump between the folds, which appear at lambda = 0.88832.
# Between these lambda the hump is narrow and between these logarithms of z - 1; log(0.4) is outside the outer
# fold for every lambda.
SINGLE, NARROW = mpf("0.88"), mpf("0.95")
HUMP = (mpf("-2.4"), mpf("-1.3"))
OUTSIDE = mp.log(mpf("0.4"))
SCAN_STEP = mpf(1) / 16
HALVINGS = 40


class Point(NamedTuple):
    region: str
    law: str
    path: str
    lam: float
    delta: float


# The curves of the law emd, and where their branches end


def noncontact_slope(lam, x):
    return mp.diff(lambda y: noncontact_state(lam, y)[0], x)


@functools.cache
def hump(lam):
    """log(z - 1) where the slope of the noncontact curve is largest, for SINGLE <= lambda <= NARROW."""

    def falls(x):
        return mp.diff(lambda y: noncontact_state(lam, y)[0], x, 2) < 0

    return bisect(falls, *HUMP)


@functools.cache
def noncontact_fold(lam):
    """log(z - 1) and the approach at the outer fold of the noncontact curve, or None."""
    if lam < SINGLE:
        return None
    if lam <= NARROW:
        inside = hump(lam)
        if noncontact_slope(lam, inside) <= 0:
            return None
    else:
        inside = OUTSIDE
        while noncontact_slope(lam, inside) <= 0:
            inside -= SCAN_STEP
    x = bisect(lambda y: noncontact_slope(lam, y) < 0, inside, OUTSIDE)
    return x, noncontact_state(lam, x)[0]


@functools.cache
def cusp_lambda():
    """lambda at which the folds of the noncontact curve appear, 0.88832..."""
    with mp.workdps(30):
        return bisect(lambda lam: noncontact_slope(lam, hump(lam)) > 0, mpf("0.888"), mpf("0.889"))


@functools.cache
def contact_end(lam):
    """Angle and approach at the end of the stable contact branch.

    The closed form of FOLD_LAMBDA says on which side of it lambda is, so the angle may be as close to first
    touch as it likes.
    """
    angle = mp.pi / 2
    if lam > FOLD_LAMBDA:

        def is_unstable(theta):
            return mp.diff(lambda t: contact_state(lam, t)[0], theta) > 0

        angle = bisect(is_unstable, SMALLEST_ANGLE, angle - mpf("1e-25"))
    return angle, contact_state(lam, angle)[0]


def end(path, lam):
    """Approach at which contact begins on approach or ends on retraction."""
    return first_touch(lam) if path == "approach" else contact_end(lam)[1]


def invert(state, lam, delta, low, high):
    """The parameter between low and high at which delta, which falls from low to high or rises, is met.

    Halvings to 1e-12 of the bracket, then Newton's rule to the digits of mp; a step that leaves the bracket
    is a halving too.
    """
    rises = state(lam, high)[0] > state(lam, low)[0]
    below, above = (low, high) if rises else (high, low)
    for count in range(HALVINGS + 1000):
        x = (below + above) / 2 if count < HALVINGS else x
        value = state(lam, x)[0] - delta
        if value == 0:
            return x
        below, above = (x, above) if value < 0 else (below, x)
        if count < HALVINGS:
            continue
        slope = mp.diff(lambda p: state(lam, p)[0], x)
        step = value / slope if slope else mp.inf
        # The next step would be of the order of the square of this one; near a fold, of that over the
        # distance to it.
        if abs(step) < abs(x) * mpf(10) ** -55:
            return x - step
        # Every third step halves the bracket, so that no flat place can hold the search.
        inside = min(below, above) < x - step < max(below, above)
        x = x - step if inside and count % 3 else (below + above) / 2
    raise ValueError(f"no convergence at lambda = {lam}, delta = {delta}")


def emd_parameter(path, lam, delta):
    """Branch and parameter (angle or log of the gap) that the history selects."""
    if delta >= end(path, lam):
        last, approach = contact_end(lam)
        if delta == approach:
            return "contact", last
        return "contact", invert(contact_state, lam, delta, SMALLEST_ANGLE, last)
    undeformed = mp.log(-delta * mp.pi * lam / (2 * STRESS_FACTOR))  # here the undeformed gap alone is -delta
    fold = noncontact_fold(lam)
    if fold and delta < fold[1]:
        return "noncontact", invert(noncontact_state, lam, delta, fold[0], undeformed)
    innermost = undeformed
    while noncontact_state(lam, innermost)[0] < delta:
        innermost -= 8
    return "noncontact", invert(noncontact_state, lam, delta, innermost,
                                min(fold[0], undeformed) if fold else undeformed)


@functools.cache
def switches(law, path, lam):
    """Approaches at which the branch changes, each with lambda times its derivative by lambda."""
    if law == "emd":
        ends = [(contact_state, mp.pi / 2 if path == "approach" else contact_end(lam)[0])]
        fold = noncontact_fold(lam)
        if fold and fold[1] < end(path, lam):
            ends.append((noncontact_state, fold[0]))
        # At a fold the parameter may be held fixed, because the approach does not depend on it to first
        # order.
        return [(state(lam, p)[0], lam * mp.diff(lambda s: state(s, p)[0], lam)) for state, p in ends]
    if law == "md_kim":
        count = range(2)
        return [(kim_ends(path, lam)[i], lam * mp.diff(lambda s, i=i: kim_ends(path, s)[i], lam))
                for i in count]
    if law == "jkr":
        return [(mpf(0) if path == "approach" else jkr_delta(reference_laws.JKR_END), mpf(0))]
    if law == "ke":
        return [(mpf(x) * mpf(float(CRITICAL)), mpf(0)) for x in (0, 1, 6, 110)]
    return [(mpf(0), mpf(0))]


def margin(law, path, lam, delta):
    """Distance to the nearest switch in roundings of the inputs: epsilon (|delta| + |lambda
    d(switch)/d(lambda)|)."""

    def distance(place, by_lam):
        size = EPSILON * (abs(place) + abs(by_lam))
        return abs(delta - place) / size if size else (mpf(0) if delta == place else mpf(10) ** 30)

    return min(distance(*switch) for switch in switches(law, path, lam))


# Points


def beside(place, shifts=SHIFTS):
    """Doubles on both sides of an approach, and the one nearest to it."""
    return [float(place * (1 + sign * shift)) for shift in shifts for sign in (-1, 1)] + [float(place)]


def emd_points(lam_double):
    lam = mpf(lam_double)
    touch, last = first_touch(lam), contact_end(lam)[1]
    fold = noncontact_fold(lam)

    def points(region, deltas, *paths):
        for path in paths:
            yield from (Point(region, "emd", path, lam_double, float(delta)) for delta in deltas)

    def before(deltas):
        return [delta for delta in map(float, deltas) if delta < touch]

    yield from points("first touch", beside(touch), "approach")
    yield from points("far", before(FAR), "approach")
    yield from points("before contact", before(BEFORE), "approach")
    yield from points("ordinary contact", [d for d in map(float, ORDINARY) if d >= last], "retraction")
    yield from points("deep", DEEP, "approach")
    if lam > FOLD_LAMBDA:
        yield from points("contact fold", beside(last), "retraction")
        between = [last + (touch - last) * mpf(share) / 4 for share in (1, 2, 3)]
        yield from points("hysteresis", between, "approach", "retraction")
    if fold and fold[1] < touch:
        yield from points("noncontact fold", beside(fold[1]), "approach")
        if fold[1] < last:
            yield from points("noncontact fold", beside(fold[1], FEW_SHIFTS), "retraction")
        yield from points("gap", [fold[1] + (touch - fold[1]) * mpf(share) / 8 for share in range(1, 8)],
                          "approach")
    if lam > 2:
        gaps = [mp.log(mpf(x) * lam ** (mpf(3) / 7) - 1) for x in CUSP_GAPS
                if mpf(x) * lam ** (mpf(3) / 7) > 1.3]
        yield from points("near-cusp", before(noncontact_state(lam, x)[0] for x in gaps), "approach")


def near_special_lambdas():
    """Points at lambda next to the places where folds appear."""
    for shift in [0] + [sign * mpf(10) ** -k for k in (3, 6, 9, 12, 15) for sign in (-1, 1)]:
        lam = float(FOLD_LAMBDA * (1 + shift))
        place = first_touch(mpf(lam))
        for path in ("approach", "retraction"):
            for delta in beside(place, FEW_SHIFTS):
                yield Point("lambda_f", "emd", path, lam, delta)
    for shift in [0] + [sign * mpf(10) ** -k for k in (4, 6, 9, 12, 15) for sign in (-1, 1)]:
        lam = float(cusp_lambda() * (1 + shift))
        place = noncontact_state(mpf(lam), hump(mpf(lam)))[0]
        yield from (Point("noncontact cusp", "emd", "approach", lam, delta)
                    for delta in beside(place, FEW_SHIFTS))


def law_points():
    """The other laws at the ends of their branches and in the limits of lambda."""
    for path in ("approach", "retraction"):
        jkr_place = mpf(0) if path == "approach" else jkr_delta(reference_laws.JKR_END)
        jkr_deltas = beside(jkr_place) if jkr_place else []
        jkr_deltas += [float(d) for d in ["0", "-1e-15", "1e-15", *DEEP]]
        yield from (Point("jkr", "jkr", path, 1.0, delta) for delta in jkr_deltas)
        for lam in map(float, "1e-06 0.001 0.1 0.5 0.65 0.66 0.9 0.94 1.0 2.5 10.0 1000.0 1000000.0".split()):
            contact, zone = kim_ends(path, mpf(lam))
            for place in {contact, zone}:
                yield from (Point("md_kim", "md_kim", path, lam, delta)
                            for delta in beside(place, FEW_SHIFTS))
    tiny = ["-1e-300", "-1e-15", "-1e-9", "-1e-3", "0", "1e-15", "1e-300"]
    for law in ("hertz", "dmt"):
        yield from (Point(law, law, "approach", 1.0, float(d)) for d in tiny + DEEP)
    for lam in map(float, "1e-06 0.001 1.0 1000.0 1000000.0".split()):
        for delta in map(float, tiny + FAR + ["-1", "-10"]):
            yield Point("idmt", "idmt", "approach", lam, delta)
        joints = [float(mpf(x) * mpf(float(CRITICAL)) * (1 + sign * shift))
                  for x in ("1", "6", "110") for shift in (mpf("1e-2"), mpf("1e-9"),
                                                           mpf("1e-14")) for sign in (-1, 1)]
        for law in ("ke", "sbl"):
            for delta in joints + [float(d)
                                   for d in ("-1e6", "-1e-15", "0", "1e-300", "1e-15", "1e-9", "1e-3", "1e3",
                                             "1e6")]:
                yield Point(law, law, "approach", lam, delta)


def points():
    for lam in LAMBDAS:
        yield from emd_points(float(lam))
    yield from near_special_lambdas()
    yield from law_points()


# Rows


def emd_values(path, lam, delta):
    branch, parameter = emd_parameter(path, lam, delta)
    state = STATES[branch]
    _, adhesion, radius = state(lam, parameter)
    if mp.diff(lambda p: state(lam, p)[0], parameter):
        numbers = conditions(state, lam, delta, parameter)
    else:
        numbers = (mp.inf,) * 3
    return branch, (adhesion, radius**3 - adhesion, radius), numbers


def other_values(point, lam, delta):
    plastic = (mpf(float(CRITICAL)), mpf(float(POISSON))) if point.law in ("ke", "sbl") else ()
    state = getattr(reference_laws, point.law)(point.path, lam, delta, *plastic)
    force, adhesion, radius = state.contact_force, state.adhesion, state.radius
    external = [f - a for f, a in zip(force, adhesion)]

    def condition(quantity, size):
        return (abs(quantity[1]) + abs(quantity[2])) / size if size and quantity[0] else mpf(0)

    numbers = (condition(adhesion, adhesion.value), condition(radius, radius.value),
               condition(external, force.value + adhesion.value))
    return state.branch, (adhesion.value, external[0], radius.value), numbers


def row(point):
    lam, delta = mpf(point.lam), mpf(point.delta)
    found = emd_values(point.path, lam, delta) if point.law == "emd" else other_values(point, lam, delta)
    branch, values, numbers = found
    plastic = (CRITICAL, POISSON) if point.law in ("ke", "sbl") else ("", "")
    numbers = [mp.nstr(v, CONDITION_DIGITS) for v in (*numbers, margin(point.law, point.path, lam, delta))]
    keys = [point.region, point.law, point.path, repr(point.lam), repr(point.delta), *plastic, branch]
    return keys + [mp.nstr(v, VALUE_DIGITS) for v in values] + numbers


if __name__ == "__main__":
    write("stability.csv", KEYS + VALUES + CONDITIONS + ["margin"], map(row, dict.fromkeys(points())))
