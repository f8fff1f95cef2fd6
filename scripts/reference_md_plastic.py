"""Reference values of the elastic-plastic adhesion of flattened tops, the law md_plastic.

Writes tests/data/md_plastic.csv: the adhesion force, the contact force and the contact radius of one asperity
that was pressed to the interference `largest` and is a `distance` from there, with 25 digits of 60. A contact
is an elastic Maugis-Dugdale contact of the radius R1 = K a^3 / P of its top, with the load P and the contact
radius a of a plastic contact without adhesion at the interference omega:

* the edge of the adhesive zone, m = c/a, is where the gap is (work of adhesion)/sigma_0 (D. Maugis, J.
  Colloid Interface Sci. 150 (1992) 243);
* delta = omega - 2 sigma_0 a sqrt(m^2 - 1)/E, and a contact that unloads keeps R1;
* P is at most K a^3 / R and K R^(1/4) a^(1/2) omega^(5/4): a loop of a larger load would give out energy.

Settings are the cases of Shi and Polycarpou (2005), a soft and sticky metal, and asperities drawn at random.
Scaled quantities as in reference_plastic.py, whose plastic contacts these are.
"""

import random

from fixtures import write
from mpmath import mp, mpf
from reference_plastic import MODULUS, WORK, jg, ke, pressure_factor, tn, zmc
from reference_values import VALUE_DIGITS

KEYS = ["contact", "lambda", "critical_interference", "poisson_ratio", "hardness_ratio", "largest",
        "distance"]
VALUES = ["adhesion_force", "contact_force", "contact_radius"]

# R, E, work of adhesion, Z_0, H in SI, Poisson's ratio
ASPERITIES = [
    ("1.66e-6", "85.29e9", "0.01", "0.2e-9", "2.5e9", "0.27"),
    ("3.33e-6", "85.29e9", "0.09", "0.2e-9", "2.5e9", "0.27"),
    ("6.38e-6", "85.29e9", "0.30", "0.2e-9", "2.5e9", "0.27"),
    ("1e-6", "45e9", "1", "0.3e-9", "1e9", "0.42"),
]
LOADED = "0.3 1.0 1.05 1.85 1.89 1.905 1.95 2.5 4.0 10.0 40.0 130.0 300.0".split()  # omega over omega_c
RANDOM = 40
SMALL = mpf(10) ** -25


def scaled(*texts):
    """lambda, omega_c of Chang, Etsion and Bogy, Poisson's ratio and H/E of an asperity, as doubles."""
    radius, modulus, work, spacing, hardness, poisson = map(mpf, texts)
    stiffness = 4 * modulus / 3
    length = mp.cbrt((mp.pi * work / stiffness) ** 2 * radius)
    critical = (mp.pi * pressure_factor(poisson) * hardness / (2 * modulus)) ** 2 * radius
    lam = 2 * mpf("1.03") * work / spacing * mp.cbrt(radius / (mp.pi * work * stiffness**2))
    return tuple(repr(float(value)) for value in (lam, critical / length, poisson, hardness / modulus))


def critical_of(law, critical, poisson, hardness):
    """omega at which the contact begins to flow, over 1.9 for Jackson and Green's."""
    if law is jg:
        c = mpf("1.295") * mp.exp(mpf("0.736") * poisson)
        return critical * (c / (mpf("2.84") * pressure_factor(poisson))) ** 2
    return critical * (mpf("0.6") / pressure_factor(poisson)) ** 2 if law is zmc else critical


def bare(law, setting, omega):
    """P and a of the contact without adhesion."""
    _, load, radius = law(*setting, omega)
    if law is ke and omega <= setting[1]:
        load, radius = omega ** mpf("1.5"), mp.sqrt(omega)
    return min(load, radius**3, mp.sqrt(radius) * omega ** mpf("1.25")), radius


def gap_of(m, radius, flattened, stress):
    """The gap at m = c/a of a contact, under a stress over E."""
    root, angle = mp.sqrt(m * m - 1), mp.acos(1 / m)
    profile = radius**2 / (mp.pi * flattened) * (root + (m * m - 2) * angle)
    return profile + 4 * stress * radius / mp.pi * (root * angle - m + 1)


def zone_of(m, radius, stress):
    """The adhesion force of a zone of a stress to m = c/a, and E times the displacement by which it draws the
    surfaces."""
    root, angle = mp.sqrt(m * m - 1), mp.acos(1 / m)
    return 2 * stress * radius**2 * (root + m * m * angle), 2 * stress * radius * root


class Apart(Exception):
    """Contacts that their bridge does not reach."""


class Dry:
    """An asperity of R = K = 1, and the plastic contact that it has without adhesion."""

    LEAST, stiffness = mpf("0.02"), mpf(1)
    SHARES = "0.99 0.9 0.6 0.3".split()  # contact radius over the largest

    def __init__(self, law, texts):
        self.law, self.setting = law, tuple(mpf(float(text)) for text in texts)
        self.critical = critical_of(law, *self.setting[1:])
        lam = self.setting[0]
        zone = 4 * lam**2 * (mp.pi / 2 - 1) / 3
        self.touch = -mpf(4) / 3 * lam * 2 / (zone + mp.sqrt(zone**2 + mp.pi * lam))

    def bare(self, omega):
        return bare(self.law, self.setting, omega)

    def touches(self, delta):
        return delta >= self.touch

    def is_stable(self, slope, own, flattened):
        return slope > self.LEAST

    def state(self, load, radius):
        """The adhesion force, and the displacement by which it draws the surfaces nearer."""
        stress, flattened = self.setting[0] / 2, radius**3 / load

        # By the logarithm of m - 1, whose range is wide: bisection, then secants.
        def excess(place):
            return mp.log(gap_of(1 + mp.exp(place), radius, flattened, stress / MODULUS) * stress / WORK)

        low, high = mpf(-60), mpf(60)
        for _ in range(16):
            middle = (low + high) / 2
            low, high = (low, middle) if excess(middle) > 0 else (middle, high)
        place = mp.findroot(excess, (low, high), tol=mpf(10) ** -100, maxsteps=60, verify=False)
        force, drawn = zone_of(1 + mp.exp(place), radius, stress)
        return force, drawn / MODULUS


def derivative(state_at, place, delta):
    return (state_at(place * (1 + SMALL))[0] - delta) / (place * SMALL)


def history(contact, omega):
    """`largest`, `distance` and the state of a contact that is loaded to omega and unloaded, where delta is a
    double."""

    def loading(omega):
        load, radius = contact.bare(omega)
        force, drawn = contact.state(load, radius)
        return omega - drawn, (force, load, radius)

    try:
        delta, _ = loading(omega)
        slope = derivative(loading, omega, delta)
        if slope <= contact.LEAST:
            return
        omega += (mpf(float(delta)) - delta) / slope
        largest, (force, load, radius) = loading(omega)
    except Apart:
        return
    if not contact.touches(largest):
        return
    yield largest, mpf(0), (force, load, radius)
    flattened = contact.stiffness * radius**3 / load

    def unloading(own):
        own_load = contact.stiffness * own**3 / flattened
        own_force, drawn = contact.state(own_load, own)
        return omega - radius**2 / flattened + own**2 / flattened - drawn, (own_force, own_load, own)

    for share in contact.SHARES:
        own = radius * mpf(share)
        try:
            delta, _ = unloading(own)
            distance, slope = mpf(float(largest - delta)), derivative(unloading, own, delta)
            if distance > 0 and contact.is_stable(slope, own, flattened):
                yield largest, distance, unloading(own + (largest - distance - delta) / slope)[1]
        except Apart:
            continue


def table_of(kind, cases):
    """Rows of laws, inputs as texts and multiples of the interference at which contacts begin to flow."""
    for law, texts, multiples in cases:
        contact = kind(law, texts)
        for text in multiples:
            for largest, distance, state in history(contact, contact.critical * mpf(text)):
                yield [law.__name__, *texts,
                       *(mp.nstr(value, VALUE_DIGITS) for value in (largest, distance, *state))]


def cases():
    for asperity in ASPERITIES:
        for law in (jg, zmc, tn, ke):
            yield law, scaled(*asperity), LOADED if law is jg else LOADED[2::3]
    draw = random.Random(1)
    for number in range(RANDOM):
        lam, critical = 10 ** draw.uniform(-2, 2), 10 ** draw.uniform(-0.5, 2)
        texts = tuple(repr(value)
                      for value in (lam, critical, draw.uniform(0.1, 0.45), 10 ** draw.uniform(-3, -1.3)))
        omegas = [repr(10 ** draw.uniform(0.3, 2.47)) for _ in range(2)]
        yield (jg, zmc, tn, ke)[number % 4 if number % 2 else 0], texts, omegas


if __name__ == "__main__":
    write("md_plastic.csv", KEYS + VALUES, table_of(Dry, cases()))
