"""Reference values of wet asperities whose tops are flattened, the law capillary.

Writes tests/data/wet_plastic.csv: the adhesion force, the contact force and the contact radius of one
asperity in a vapour that was pressed to the interference `largest` and is a `distance` from there, SI, with
25 digits of 60. A contact is at every moment an elastic wet contact of the outline of its top, which has the
radius rho at its apex and the interference g(a) without adhesion (reference_md_plastic.py):

* the solids in the liquid have W = (work of adhesion) - (share of) gamma s and the range H = Z_0/1.03. Their
  zone is that of Maugis around a, with the stress W/H and the edge c; less what they draw, their interference
  from the lowered apex is delta_1 = g(a) - 2 (W/H) sqrt(c^2 - a^2)/E. With no W above 0 there is none;
* the bridge has the tension p_c = gamma/r_K up to the gap h_0 - kappa/c at the edge c of the liquid, kappa =
  pi r_K^2/2 of faces that are wetted perfectly. It is the bridge of a sphere of the radius rho: with
  delta_1 > 0 its zone is that of Maugis around a_b = sqrt(rho delta_1), and draws the surfaces nearer by
  2 p_c sqrt(c^2 - a_b^2)/E; otherwise it is around the gap -delta_1 in the middle (Kim, McMeeking and
  Johnson, J. Mech. Phys. Solids 46 (1998) 243);
* delta = delta_1 + omega - g(a_0), less what the bridge draws;
* of gamma s and p_c there is the share h_0/H - 1, from 0 to 1.

Of two edges the larger is taken: it is searched for downwards from the edge without kappa.
"""

import random

from fixtures import write
from mpmath import mp, mpf
from reference_md_plastic import Apart, Outline, State, bare, critical_of, root_of, table_of, zone_of
from reference_plastic import jg, ke, pressure_factor, tn, zmc

KEYS = ["contact", "radius", "reduced_modulus", "work_of_adhesion", "equilibrium_spacing", "hardness",
        "poisson_ratio",
        "surface_tension", "kelvin_radius", "largest", "distance"]
VALUES = ["adhesion_force", "contact_force", "contact_radius"]

# Silicon in moist air, a metal that keeps adhesion in the liquid, steel in a film, and a metal between wet
# and dry: R, E, work of adhesion, Z_0, H, Poisson's ratio, gamma, r_K
ASPERITIES = [
    ("0.5e-6", "85.6e9", "0.02", "0.2e-9", "11e9", "0.22", "72.7e-3", "3.3e-9"),
    ("3.33e-6", "85.29e9", "0.3", "0.2e-9", "2.5e9", "0.27", "72.7e-3", "1.5e-9"),
    ("6.38e-6", "115e9", "0.05", "0.2e-9", "4e9", "0.3", "25e-3", "8e-9"),
    ("1e-6", "45e9", "0.5", "0.3e-9", "1e9", "0.42", "72.7e-3", "0.22e-9"),
]
LOADED = "1.05 1.85 1.905 2.5 4.0 10.0 40.0 130.0".split()  # omega over omega_c
RANDOM = 24


class Wet:
    """An asperity, and the plastic contact that it has without adhesion."""

    LEAST = mpf("0.05")
    SHARES = "0.99 0.8 0.5 0.2".split()  # of c, from that of a point to the largest

    def __init__(self, law, texts):
        self.law = law
        numbers = (mpf(float(text)) for text in texts)
        radius, modulus, work, spacing, hardness, poisson, tension, kelvin = numbers
        self.radius, self.modulus, self.stiffness = radius, modulus, 4 * modulus / 3
        reach, self.range = spacing / mpf("1.03"), 2 * kelvin
        share = min(max(self.range / reach - 1, 0), 1)
        solid = work - share * 2 * tension
        self.solid = (solid / reach, reach) if solid > 0 else None
        self.pressure, self.curvature = share * tension / kelvin, mp.pi / 2 * kelvin**2
        # Scaled quantities of the plastic contact: R and K are 1.
        own = (mp.pi * pressure_factor(poisson) * hardness / (2 * modulus)) ** 2
        self.setting = (mpf(1), own, poisson, hardness / modulus)
        self.critical = critical_of(law, *self.setting[1:]) * radius

    def bare(self, omega):
        load, radius, reached = bare(self.law, self.setting, omega / self.radius)
        return load * self.stiffness * self.radius**2, radius * self.radius, reached * self.radius

    def touches(self, delta):
        return delta > 0

    def edges(self, outline):
        """c of the solids in the liquid of a contact that is a point, and of that of the radius a_0."""
        if self.solid is None:
            return mpf(0), outline.widest
        return outline.first_edge(*self.solid), outline.edge(*self.solid)

    def radius_at(self, outline, c):
        return c if self.solid is None else outline.contact(c, *self.solid)

    def zone(self, sphere, a):
        """F_s of the bridge around a contact, and the displacement by which it draws the surfaces nearer."""

        def gap(place):
            return sphere.gap(a, a * (1 + mp.exp(place)), self.pressure) - self.range

        def excess(place):
            return gap(place) + self.curvature / (a * (1 + mp.exp(place)))

        high = root_of(gap, mpf(-60), mpf(60))
        # The larger of two edges is between that without kappa and the least excess.
        low = high
        while excess(low) >= 0 and low > high - 40:
            low -= mpf("0.05")
        force, drawn = zone_of(a, a * (1 + mp.exp(root_of(excess, low, high))), self.pressure)
        return force, drawn / self.modulus

    def bridge(self, inner, apex):
        """F_s of the bridge of a sphere, and the displacement by which it draws the surfaces nearer."""
        if self.pressure == 0:
            return mpf(0), mpf(0)
        if inner > 0:
            return self.zone(Outline(apex, self.modulus, mpf(0), apex, mpf(0)), mp.sqrt(apex * inner))
        beta = 4 * self.pressure / (mp.pi * self.modulus)

        def excess(c):
            drawn = (mp.pi / 2 - 1) * beta * c
            return c**2 / (2 * apex) + drawn + self.curvature / c - self.range - inner

        circle = mp.findroot(excess, mp.sqrt(2 * apex * self.range), tol=mpf(10) ** -90, maxsteps=100,
                             verify=False)
        if not (abs(excess(circle)) < mpf(10) ** (10 - mp.dps) * self.range and circle > 0):
            raise Apart
        return mp.pi * self.pressure * circle**2, mp.pi / 2 * beta * circle

    def state(self, outline, a, c):
        force, drawn = zone_of(a, c, self.solid[0] if self.solid else mpf(0))
        inner = outline.interference(a) - drawn / self.modulus
        pull, bent = self.bridge(inner, outline.apex)
        return State(inner - bent, inner, force + pull)


def cases():
    for asperity in ASPERITIES:
        for law in (jg, zmc, tn, ke):
            yield law, asperity, LOADED if law is jg else LOADED[2::3]
    draw = random.Random(2)
    for number in range(RANDOM):
        modulus = 10 ** draw.uniform(10.3, 11.3)
        values = (10 ** draw.uniform(-7, -5), modulus, 10 ** draw.uniform(-1.7, 0),
                  10 ** draw.uniform(-9.8, -9.4),
                  modulus * 10 ** draw.uniform(-2, -1.2), draw.uniform(0.15, 0.45),
                  10 ** draw.uniform(-1.7, -1.1),
                  10 ** draw.uniform(-9.2, -8.2))  # fmt: skip
        multiples = [repr(10 ** draw.uniform(0.3, 2.2)) for _ in range(2)]
        yield (jg, zmc, tn, ke)[number % 4 if number % 2 else 0], tuple(map(repr, values)), multiples


if __name__ == "__main__":
    write("wet_plastic.csv", KEYS + VALUES, table_of(Wet, cases()))
