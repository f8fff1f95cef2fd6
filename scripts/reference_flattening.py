"""The flattened summit of an asperity by finite elements, beside the published fit of its radius.

Writes tests/data/flattening.csv. A rigid flat presses a sphere without friction to the interference omega = x
omega_c and leaves it again (flattening_elements.py: large deformations, J2, perfectly plastic, nu = 0.3).
The table has the depth of the apex below where it was before contact, and the radius of the summit: that of
r^2/(2 rho) + b r^4 fitted to the outline for r <= a0/2, with a0 the largest contact radius. omega_c is that
of R. L. Jackson and I. Green, J. Tribol. 127 (2005) 343, (pi C Y/(2 E*))^2 R with C = 1.295 exp(0.736 nu).
The fit is that of I. Etsion, Y. Kligerman and Y. Kadin, Int. J. Solids Struct. 42 (2005) 3716:

    rho = R [1 + 1.275 (E/Y)^(-0.216) (x - 1)], and at least K a0^3/P0.

The integration of the plastic strain is of first order in the step, so each row is extrapolated from two
numbers of steps. The contact radius is where the gap to the power 2/3 of the next nodes outside extrapolates
to 0.

Pull-off is that of an elastic Maugis-Dugdale contact: the least force over contact radii a <= a0, for the
outline r^2/(2 rho) + b r^4 up to a0 and the paraboloid of R beyond, with b such that the load at a0 is P0. It
is given for rho by finite elements over rho by the fit, and for the whole outline by finite elements over the
same, with R, E*, work of adhesion and Z_0 of the cases I and II of Shi and Polycarpou (2005): lambda is
theirs, and Y that of the row.

    python scripts/reference_flattening.py            10 minutes on one core
    python scripts/reference_flattening.py --check    Hertz's contact, and elements of twice the width
"""

import sys

import numpy as np
from fixtures import write
from flattening_elements import POISSON, YOUNG, Body, half_sphere
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import brentq, minimize_scalar

COLUMNS = ["young_over_yield", "interference", "load", "contact_radius", "residual_depth", "apex_radius",
           "law_apex_radius", "radius_pull_off_1", "radius_pull_off_2", "outline_pull_off_1",
           "outline_pull_off_2"]
RATIOS = (50, 100, 200, 500, 1000)  # E/Y
INTERFERENCES = (2, 6, 10, 30, 100)  # omega/omega_c
WIDEST = 0.4  # a0/R above which the paraboloid of the law is no sphere
FINE = dict.fromkeys(INTERFERENCES, 24)  # elements to a0
STEPS = dict.fromkeys(INTERFERENCES, 16)  # from omega_c to omega, and twice as many
UNLOADING = 8  # steps of the elastic recovery
INNER = 0.5  # part of a0 on which the apex radius is fitted
# R, E*, work of adhesion, Z_0
CASES = [(1.66e-6, 85.29e9, 0.01, 0.2e-9), (3.33e-6, 85.29e9, 0.09, 0.2e-9)]


class Fits:
    """Jackson and Green's contact of a sphere of R = E* = 1, and the published residual radius."""

    def __init__(self, ratio):
        self.ratio, self.strength = ratio, YOUNG / ratio
        self.factor = 1.295 * np.exp(0.736 * POISSON)
        self.critical = (np.pi * self.factor * self.strength / 2) ** 2
        self.critical_load = 4 / 3 * self.critical**1.5

    def contact(self, x):
        """P/P_c and a."""
        if x <= 1.9:
            return x**1.5, np.sqrt(x * self.critical)
        radius = np.sqrt(self.critical * x * (x / 1.9) ** (0.14 * np.exp(23 * self.strength)))
        hardness = 2.84 * (1 - np.exp(-0.82 * radius**-0.7))
        load = np.exp(-(x ** (5 / 12)) / 4) * x**1.5
        return load + 4 * hardness / self.factor * (1 - np.exp(-(x ** (5 / 9)) / 25)) * x, radius

    def apex_radius(self, x, load, radius):
        """rho of the law."""
        published = 1 + 1.275 * self.ratio**-0.216 * (x - 1) if x > 1 else 1.0
        return max(published, 4 / 3 * radius**3 / load)


def pressed(ratio, x, fine, steps):
    """P0, a0, and the outline after unloading: radius and depth of the nodes."""
    fits = Fits(ratio)
    load, radius = fits.contact(x)
    body = Body(half_sphere(radius / fine, fine * 5 // 4, 1.3), fits.strength, load * fits.critical_load)
    for step in range(steps + 1):
        omega = fits.critical * (1 + (np.sqrt(x) - 1) * step / steps) ** 2
        load = body.press(omega)
    r, z = body.outline()
    outside = slice(body.touching.sum() + 1, body.touching.sum() + 4)
    slope, level = np.polyfit(r[outside], (z[outside] - omega) ** (2 / 3), 1)
    radius = -level / slope
    recovery = load / (2 * radius) / UNLOADING
    while body.touching.any():
        body.press(body.omega - recovery)
    body.equilibrium(None)
    return load, radius, *body.outline()


def flattened(ratio, x, fine):
    """The same, extrapolated to steps of no length."""
    coarse, close = (pressed(ratio, x, fine, steps) for steps in (STEPS[x], 2 * STEPS[x]))
    return tuple(2 * b - a for a, b in zip(coarse, close, strict=True))


def apex(r, z, reach):
    """rho and the depth of the apex. The node on the axis is left out: its neighbours are on one side."""
    inner = (r <= reach) & (r > 0)
    terms = np.stack([np.ones(inner.sum()), r[inner] ** 2 / 2, r[inner] ** 4], axis=1)
    depth, curvature, _ = np.linalg.lstsq(terms, z[inner], rcond=None)[0]
    return 1 / curvature, depth


class Outline:
    """An axisymmetric outline f(r), by the slope f'(r) at equal distances, of a contact with E* = 1."""

    ANGLES, WEIGHTS = np.polynomial.legendre.leggauss(60)
    ANGLES, WEIGHTS = (ANGLES + 1) / 2, WEIGHTS / 2

    def __init__(self, r, slope):
        self.r, self.slope = r, slope
        self.f = cumulative_trapezoid(slope, r, initial=0)
        angle = self.ANGLES * np.pi / 2
        around = np.interp(r[:, None] * np.sin(angle), r, slope)
        self.g = r * (around @ self.WEIGHTS) * np.pi / 2
        self.load = 2 * r**2 * (around * np.sin(angle) ** 2 @ self.WEIGHTS) * np.pi / 2

    @classmethod
    def of_law(cls, load, radius, rho):
        """r^2/(2 rho) + b r^4 to a0, with the load there, and the paraboloid of R = 1 beyond."""
        b = (load / 2 - 2 * radius**3 / (3 * rho)) * 15 / (32 * radius**5)
        r = np.linspace(0, 3 * radius, 6001)
        return cls(r, np.where(r <= radius, r / rho + 4 * b * r**3, r))

    @classmethod
    def of_nodes(cls, radius, r, z):
        """The outline of nodes. A polynomial to 0.8 a0 takes away the waves of the width of an element."""
        powers, part = np.arange(2, 7), r / radius
        inner = (part < 0.85) & (part > 0)
        terms = np.concatenate([np.ones((inner.sum(), 1)), part[inner, None] ** powers], axis=1)
        terms = np.linalg.lstsq(terms, z[inner], rcond=None)[0][1:]
        grid = np.linspace(0, 3 * radius, 6001)
        between = np.interp(grid, (r[1:] + r[:-1]) / 2, np.diff(z) / np.diff(r))
        smooth = ((grid[:, None] / radius) ** (powers - 1)) @ (terms * powers) / radius
        return cls(grid, np.where(grid < 0.8 * radius, smooth, between))

    def force(self, radius, stress, reach):
        """The external force of a contact of a radius, under a stress over E* to the gap `reach`."""
        g, load = (np.interp(radius, self.r, values) for values in (self.g, self.load))

        def gap(place):
            m = 1 + np.exp(place)
            edge, angle, root = m * radius, np.arcsin(1 / m), np.sqrt(m * m - 1)
            drawn = np.interp(edge * np.sin(angle * self.ANGLES), self.r, self.g) @ self.WEIGHTS * angle
            # Beyond the nodes the paraboloid goes on.
            f = np.interp(edge, self.r, self.f) + max(edge**2 - self.r[-1] ** 2, 0) / 2
            zone = 4 * stress * radius / np.pi * (root * np.arccos(1 / m) - m + 1)
            return f - g + 2 / np.pi * (g * angle - drawn) + zone - reach

        m = 1 + np.exp(brentq(gap, -40, 20, xtol=1e-12))
        return load - 2 * stress * radius**2 * (np.sqrt(m * m - 1) + m * m * np.arccos(1 / m))

    def pull_off(self, largest, case):
        """The largest pull of contacts up to a radius, and the radius that it has."""
        scale, modulus, work, spacing = case
        stress, reach = 1.03 * work / (spacing * modulus), spacing / (1.03 * scale)
        radii = np.geomspace(1e-3 * largest, largest, 80)
        forces = [self.force(radius, stress, reach) for radius in radii]
        least = int(np.argmin(forces))
        ends = radii[max(least - 1, 0)], radii[min(least + 1, len(radii) - 1)]
        best = minimize_scalar(self.force, bounds=ends, args=(stress, reach), method="bounded",
                               options={"xatol": 1e-6 * largest})
        return -min(best.fun, forces[least])


def row(ratio, x):
    """A row of the table, or None where the contact is too wide."""
    fits = Fits(ratio)
    if fits.contact(x)[1] > WIDEST:
        return None
    load, radius, r, z = flattened(ratio, x, FINE[x])
    rho, depth = apex(r, z, INNER * radius)
    law = fits.apex_radius(x, load, radius)
    outlines = [Outline.of_law(load, radius, law), Outline.of_law(load, radius, rho),
                Outline.of_nodes(radius, r, z)]
    pulls = np.array([[outline.pull_off(radius, case) for case in CASES] for outline in outlines])
    values = [load / fits.critical_load, radius, depth / (x * fits.critical), rho, law,
              *(pulls[1] / pulls[0]), *(pulls[2] / pulls[0])]
    print(ratio, x, *(f"{value:.4f}" for value in values), flush=True)
    return [ratio, x, *(f"{value:.5g}" for value in values)]


def check():
    """Prints what the elements give where the answer is known, and with elements of twice the width."""
    for fine in (FINE[6] // 2, FINE[6]):
        fits = Fits(1000)
        body = Body(half_sphere(np.sqrt(fits.critical) / fine, fine * 5 // 4, 1.3), 1.0, fits.critical_load)
        load = body.press(fits.critical)
        r, z = body.outline()
        outside = slice(body.touching.sum() + 1, body.touching.sum() + 4)
        slope, level = np.polyfit(r[outside], (z[outside] - fits.critical) ** (2 / 3), 1)
        print(f"Hertz, {fine} elements: load {load / fits.critical_load:.4f},",
              f"radius {-level / slope / np.sqrt(fits.critical):.4f}")
    for fine in (FINE[6] // 2, FINE[6]):
        load, radius, r, z = flattened(200, 6, fine)
        rho, depth = apex(r, z, INNER * radius)
        fits = Fits(200)
        print(f"E/Y = 200, x = 6, {fine} elements: load {load / fits.critical_load:.4f} (Jackson and Green",
              f"{fits.contact(6)[0]:.4f}), a0 {radius:.6f}, depth {depth / (6 * fits.critical):.4f},",
              f"rho {rho:.4f}", flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["--check"]:
        check()
    else:
        rows = [row(ratio, x) for ratio in RATIOS for x in INTERFERENCES]
        write("flattening.csv", COLUMNS, [row for row in rows if row])
