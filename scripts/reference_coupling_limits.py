"""Limits of elastically coupled asperities that have closed forms or scalar roots: writes
tests/data/coupling_limits.json.

* `jkr_pairs`: two equal spheres of JKR under load. Under point forces the pull-off force of each is that of
  one sphere, F_c, and the separation at it is larger by F_c/(pi E* r). With the next orders the neighbour's
  pull flattens the sphere, 1/R_eff = 1/R + f/(2 pi E* r^3), so that f R_eff^-1 = -(3/2) pi work: a quadratic,
  f = -F_c [1 + (2/(3 pi)) (a_c/r)^3 + ...]. They tilt each other by g = f/(pi E* r^2), which lowers the feet
  by -(3/2) R g^2.
* `folds`: two equal spheres of IDMT. The pair jumps where 1 + f'/(pi E* r) = 0, which has two roots before
  contact: the jump-in on the way down, the jump-off on the way back; what each loses is the change of sum
  phi(delta_i) + sum f_i G_ij f_j / 2.
* `lattice`: one sphere of Hertz in a cell that repeats, along the contact radius, by point forces and with
  the next orders, and where the point forces have no state any more, a/L = pi/(-2 c), c the self term; at the
  same d the next orders change f by -(8 S/(15 pi)) (a/L)^3 to lowest order, S = sum 1/n^3 = 9.0336.
* `first_order`: coupling changes the total force by -sum_ij f'_i G_ij f_j to first order (of heights that are
  given), and of independent heights by -[<f><f'> sum_(i!=j) G_ij + <f f'> sum_i G_ii] on average.
* `hard_core`: pi E* L G averaged over the places of two asperities at least b apart in a cell, -I(b)/(L^2 -
  pi b^2) with the integral I over the disc; and of 30 by random sequential addition, sampled, with its
  standard error.
* `unstable_work`: the integral of F dDelta of Maugis' contact, scaled, along the unstable part of its force
  curve, from first touch to the end of its stable one.
* `contact`: states with the next orders, as `ensembles` of coupling.json; `third_order` ones with no more
  than 1/r^3.
"""

import mpmath as mp
import numpy as np
from coupled_asperities import (
    LAWS, Asperities, Distances, follow, green_matrix, lattice, lattice_of, solve_contact, steps,
)  # fmt: skip
from reference_coupling import MODULUS, RADIUS, SPACING, WORK, hard_core, surfaces, write_json

mp.mp.dps = 30
E, R, W = mp.mpf(MODULUS), mp.mpf(RADIUS), mp.mpf(WORK)
K = 4 * E / 3
CUBES = 4 * mp.zeta(mp.mpf(3) / 2) * mp.dirichlet(mp.mpf(3) / 2,
                                                  [0, 1, 0, -1])  # the sum of 1/n^3 over a square lattice


def load_shape(a, r):
    """u / f of the load of Hertz outside its contact."""
    return 3 / (4 * mp.pi * E * a**3) * ((2 * a**2 - r**2) * mp.asin(a / r) + a * mp.sqrt(r**2 - a**2))


def punch_shape(a, r):
    """u / f of a flat punch outside its contact."""
    return mp.asin(a / r) / (mp.pi * E * a)


def jkr_pair(distance):
    pull_off, r = 3 * mp.pi * W * R / 2, distance
    radius = mp.cbrt(9 * mp.pi * W * R**2 / (8 * E))

    def approach(radius, curvature):
        """Approach of JKR at pull-off, where 3/2 of the load of Hertz are against three of attraction."""
        return radius**2 * curvature - mp.sqrt(8 * mp.pi * W * radius / (3 * K))

    # f/R + f^2/(2 pi E r^3) = -(3/2) pi work
    bend = 2 * mp.pi * E * r**3
    force = (-1 / R + mp.sqrt(1 / R**2 - 4 * pull_off / R / bend)) * bend / 2
    curvature = 1 / R + force / bend
    wide = mp.cbrt(9 * mp.pi * W / (8 * E * curvature**2))
    load = K * wide**3 * curvature
    sunk = load * load_shape(wide, r) + (force - load) * punch_shape(wide, r)
    sunk -= 3 * R / 2 * (force / (mp.pi * E * r**2)) ** 2
    return {
        "distance": r, "single_pull_off": pull_off, "single_radius": radius,
        "single_separation": -approach(radius, 1 / R),
        "point_pull_off": pull_off, "point_separation": -approach(radius, 1 / R) + pull_off / (mp.pi * E * r),
        "contact_pull_off": -force, "contact_separation": -approach(wide, curvature) - sunk,
    }


def fold(distance, radius, work):
    """Case III: both jumps of a pair whose heights are 0; d = -delta - G f."""
    z0, unit, green = mp.mpf(SPACING), mp.pi * radius * work, 1 / (mp.pi * E * distance)

    def force(delta):
        if delta >= 0:
            return K * mp.sqrt(radius) * mp.sqrt(delta) ** 3 - 2 * unit
        s = z0 / (z0 - delta)
        return -mp.mpf(8) / 3 * unit * (s**2 - s**8 / 4)

    def energy(delta):
        """The integral of the force from afar, and what the substrate holds, of one of the two."""
        s = z0 / (z0 - min(delta, 0))
        inner = -mp.mpf(8) / 3 * unit * z0 * (s - s**7 / 28)
        contact = mp.mpf(2) / 5 * K * mp.sqrt(radius) * mp.sqrt(max(delta, 0)) ** 5 - 2 * unit * max(delta, 0)
        return inner + contact + force(delta) * green * force(delta) / 2

    def place(delta):
        return -delta - green * force(delta)

    steepest = mp.mpf(3) ** (-mp.mpf(1) / 6)  # s at which the gradient is largest
    slopes = lambda s: 1 / green - mp.mpf(16) / 3 * unit / z0 * (s**3 - s**9)  # noqa: E731
    outer, inner = (z0 - z0 / bisect(slopes, *ends)
                    for ends in ((mp.mpf("1e-3"), steepest), (steepest, mp.mpf(1))))
    jumps = {}
    for name, before, ends in [("jump_in", outer, (inner, 100 * z0)),
                               ("jump_off", inner, (-1000 * z0, outer))]:
        after = bisect(lambda x, d=place(before): place(x) - d, *ends)
        jumps[name] = {"separation": place(before), "approach_before": before, "force_before": force(before),
                       "approach_after": after,
                       "force_after": force(after), "energy_lost": 2 * (energy(before) - energy(after))}
    largest = mp.mpf(16) / 3 * unit / z0 * (steepest**3 - steepest**9)
    return {"distance": distance, "radius": radius, "work_of_adhesion": work, "largest_gradient": largest,
            "largest_distance": largest / (mp.pi * E), **jumps}


def bisect(f, low, high):
    rises = f(high) > f(low)
    if (f(high) > 0) == (f(low) > 0):
        raise ValueError("no change of sign")
    while high - low > mp.mpf(10) ** -27 * (abs(high) + abs(low)):
        middle = (low + high) / 2
        low, high = (low, middle) if (f(middle) > 0) == rises else (middle, high)
    return (low + high) / 2


def hertz_lattice(cell):
    own, rows = lattice(0, 0), []
    distances = Distances([[0, 0]], 1.0)
    for ratio in map(mp.mpf, "0.01 0.02 0.05 0.1 0.15 0.2 0.25 0.3 0.35 0.4".split()):
        a = ratio * cell
        point = K * a**3 / R
        curvature = 1 / (R * (1 - CUBES * K * a**3 / (2 * mp.pi * E * cell**3)))
        force = K * a**3 * curvature
        sunk = force / (mp.pi * E
                        * cell) * (own
                                   + mp.mpf(str(distances.beyond(np.longdouble(str(ratio)), "load")[0, 0])))
        rows.append({"radius": a, "point_separation": -(a**2 / R + own * point / (mp.pi * E * cell)),
                     "point_force": point,
                     "contact_separation": -(a**2 * curvature + sunk), "contact_force": force})
    end = -mp.pi / (2 * own) * cell
    return {"cell": cell, "states": rows, "cubes": CUBES, "order_three": -8 * CUBES / (15 * mp.pi),
            "end_radius": end,
            "end_separation": -end**2 / R * (1 + own * K * end / (mp.pi * E * cell)),
            "end_force": K * end**3 / R}


def first_order(drawn):
    rows = []
    for name, law, separation in [("thirty", "hertz", 2e-9), ("thirty", "idmt", 2e-9),
                                  ("two hundred", "hertz", 1e-9)]:
        surface, law_of = drawn[name], LAWS[law]
        asperity = Asperities(np.array(surface["radii"], np.longdouble), MODULUS, WORK, SPACING)
        force, slope = law_of(asperity,
                              np.array(surface["heights"], np.longdouble) - np.longdouble(separation))
        for coupling in ("patch", "periodic"):
            green = green_matrix(surface["places"], MODULUS,
                                 surface["cell"] if coupling == "periodic" else None)
            # The change by solving, with substrates that are 1000 and 2000 times stiffer:
            totals = [sum(follow(law_of, asperity, surface["heights"], green / n, [separation])[0].force)
                      for n in (1000, 2000)]
            change, base = -slope @ green @ force, force.sum()
            slopes = [(total - base) * n for total, n in zip(totals, (1000, 2000))]
            if abs(2 * slopes[1] - slopes[0] - change) > 1e-5 * abs(change):
                raise ValueError("the first order is another")
            rows.append({"surface": name, "law": law, "coupling": coupling, "separation": separation,
                         "independent": base, "change": change,
                         "green_sum": green.sum() - np.trace(green), "green_own": np.trace(green)})
    return rows


def hertz_means(std, separations):
    """<f>, <f'> and <f f'> of one Hertz asperity of case II over Gaussian heights."""
    rows, s, factor = [], mp.mpf(std), K * mp.sqrt(R)
    for separation in separations:
        d = mp.mpf(separation) / s

        def mean(power, d=d):
            density = lambda x: mp.exp(-(x**2) / 2) / mp.sqrt(2 * mp.pi)  # noqa: E731
            return s**power * mp.quad(lambda x: x ** (2 * power) * density(x * x + d) * 2 * x,
                                      [0, 1, 2, 3, 4, 5])

        rows.append({"separation": separation, "force": factor * mean(mp.mpf(3) / 2),
                     "slope": mp.mpf(3) / 2 * factor * mean(mp.mpf(1) / 2),
                     "force_times_slope": mp.mpf(3) / 2 * factor**2 * mean(mp.mpf(2))})
    return rows


def hard_core_means():
    rows = []
    for b in map(mp.mpf, ("0.05", "0.1", "0.3")):
        # On circles the lattice sum has the mean 1/r + c + sum_k [(2k-1)!!/(2k)!!]^2 S_(2k+1) r^2k, S over
        # the lattice of 1/n^(2k+1).
        disc = 2 * mp.pi * b + lattice(0, 0) * mp.pi * b**2
        for k in range(1, 40):
            order = mp.mpf(2 * k + 1) / 2
            cubes = 4 * mp.zeta(order) * mp.dirichlet(order, [0, 1, 0, -1])
            share = (mp.fac2(2 * k - 1) / mp.fac2(2 * k)) ** 2
            disc += share * cubes * 2 * mp.pi * b ** (2 * k + 2) / (2 * k + 2)
        rows.append({"count": 2, "minimum_distance": b, "mean": -disc / (1 - mp.pi * b**2)})
    rng, pairs, draws = np.random.Generator(np.random.PCG64(20)), np.triu_indices(30, 1), []
    for _ in range(2000):
        x, y = np.array(hard_core(rng, 30, 1.0, 0.09)).T
        draws.append(np.mean(lattice_of(x[pairs[0]] - x[pairs[1]], y[pairs[0]] - y[pairs[1]]).astype(float)))
    rows.append({"count": 30, "minimum_distance": 0.09, "mean": float(np.mean(draws)),
                 "standard_error": float(np.std(draws, ddof=1) / np.sqrt(len(draws)))})
    return rows


def contact_states(drawn):
    cases = [("pair", "hertz", [-5e-10, -2e-9]), ("pair", "jkr", [-1e-9, -2e-10]),
             ("thirty", "hertz", [3e-9, 2e-9, 1e-9]),
             ("thirty radii", "hertz", [2e-9]), ("thirty smooth", "jkr", [-4e-10, -2e-10])]
    rows = []
    for name, law, separations in cases:
        surface = drawn[name]
        asperity = Asperities(np.array(surface["radii"], np.longdouble), MODULUS, WORK)
        for coupling in ("patch", "periodic"):
            cell, states = surface["cell"] if coupling == "periodic" else None, []
            green = green_matrix(surface["places"], MODULUS, cell)
            for separation in separations:
                begin = min(surface["heights"]) - 1e-9 if law == "jkr" else max(surface["heights"])
                start = follow(LAWS[law], asperity, surface["heights"], green,
                               steps(begin, separation, 1e-10))[-1].approach
                whole, third = (
                    solve_contact(law=LAWS[law], asperity=asperity, heights=surface["heights"],
                                  places=surface["places"],
                                  cell=cell, separation=separation, start=start, is_whole=is_whole)
                    for is_whole in (True, False)
                )
                states.append({"separation": separation, "approaches": whole[0].approach,
                               "forces": whole[0].force, "radii": whole[1],
                               "third_order_approaches": third[0].approach,
                               "third_order_forces": third[0].force,
                               "third_order_radii": third[1]})
            rows.append({"surface": name, "law": law, "coupling": coupling, "states": states})
    return rows


def unstable_work(lam):
    """Work on the unstable branch by the angle theta, with c = a / cos(theta); pi/2 is first touch."""

    def state(theta):
        m, root = mp.sec(theta), mp.tan(theta)
        square, line = lam / 2 * (root + (m**2 - 2) * theta), 4 * lam**2 / 3 * (root * theta - m + 1)
        a = (-line + mp.sqrt(line**2 + 4 * square)) / (2 * square)
        return a**2 - mp.mpf(4) / 3 * a * lam * root, a**3 - lam * a**2 * (root + m**2 * theta)

    slope = lambda theta: mp.diff(lambda x: state(x)[0], theta, h=mp.mpf(10) ** -12)  # noqa: E731
    places = [mp.pi / 800 * k for k in range(1, 400)]
    lowest = min(range(1, 398), key=lambda k: state(places[k])[0])
    fold = bisect(slope, places[lowest - 1], places[lowest + 1])
    work = mp.quad(lambda theta: state(theta)[1] * slope(theta), [mp.pi / 2 - mp.mpf(10) ** -9, fold])
    return {"adhesion_parameter": lam, "end": state(fold)[0], "work": work}


def content():
    drawn = surfaces()
    return {
        "origin": "scripts/reference_coupling_limits.py", "reduced_modulus": MODULUS,
        "asperity_radius": RADIUS, "work_of_adhesion": WORK,
        "equilibrium_spacing": SPACING,
        "jkr_pairs": [jkr_pair(mp.mpf(float(r))) for r in (1e-7, 1.5e-7, 3e-7, 1e-6)],
        "folds": [fold(mp.mpf(r), mp.mpf(6.38e-6), mp.mpf(0.3)) for r in (5e-8, 1e-7, 2e-7)],
        "lattice": hertz_lattice(mp.mpf(1e-6)),
        "first_order": first_order(drawn),
        "hertz_means": {"std": 1.6e-9, "separations": hertz_means(1.6e-9, [0.0, 2e-9, 4e-9])},
        "unstable_work": [unstable_work(mp.mpf(lam)) for lam in (1, 2, 5, 10, 100)],
        "hard_core": hard_core_means(), "contact": contact_states(drawn),
    }


if __name__ == "__main__":
    write_json("coupling_limits.json", content())
