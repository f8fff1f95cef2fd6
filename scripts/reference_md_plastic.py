"""Reference values of the elastic-plastic adhesion of flattened tops, the law md_plastic.

Writes tests/data/md_plastic.csv: the adhesion force, the contact force and the contact radius of one asperity
that was pressed to the interference `largest` and is a `distance` from there, with 25 digits of 60. A contact
is an elastic Maugis-Dugdale contact of the outline of its top. Where a plastic contact without adhesion has
the load P_0 and the radius a_0 at the interference omega, it leaves

* the outline f(r) = r^2/(2 rho) + b r^4 up to a_0, and the paraboloid of R, lowered, beyond;
* at the apex the radius rho, which is R up to omega_c, R (1 + 1.275 (E/Y)^-0.216 (omega/omega_c - 1)) beyond,
  and at least K a_0^3/P_0 (I. Etsion, Y. Kligerman, Y. Kadin, Int. J. Solids Struct. 42 (2005) 3716). omega_c
  is Jackson and Green's, where a sphere first yields, for all four plastic contacts;
* b >= 0, with which the load of the outline at a_0 is P_0.

The edge c of the adhesive zone is where the gap is (work of adhesion)/sigma_0 (D. Maugis, J. Colloid
Interface Sci. 150 (1992) 243). A contact of the radius a has the interference g(a) = a^2/rho + (8/3) b a^4
without adhesion, and delta = omega - g(a_0) + g(a) - 2 sigma_0 sqrt(c^2 - a^2)/E. On loading a = a_0; a
contact that unloads keeps its outline.

a_0 is at least sqrt(R omega). P_0 is at most K a^3 / R and K R^(1/4) a^(1/2) omega^(5/4). The contact of both is
reached at this omega or before, so that the sphere around it does not sink; rho and delta have the omega at
which it is reached. Otherwise loops could give out energy. Kogut and Etsion's loads pass from one fit to the next where both are equal.

Settings are the cases of Shi and Polycarpou (2005), a soft and sticky metal, and asperities drawn at random.
A row is a state to which a loop leads: on loading delta is larger than at every smaller omega, on unloading
smaller than at every larger c. Scaled quantities as in reference_plastic.py, whose plastic contacts these
are.
"""

import random
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from fixtures import write
from mpmath import mp, mpf
from reference_plastic import WORK, jg, ke, pressure_factor, tn, zmc
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
COARSE = 25  # digits of the states on the way to a row
PARTS = 20  # of the way
SLIGHT = mpf("0.005")  # rise of delta by log(c), over omega


def scaled(*texts):
    """lambda, omega_c of Chang, Etsion and Bogy, Poisson's ratio and H/E of an asperity, as doubles."""
    radius, modulus, work, spacing, hardness, poisson = map(mpf, texts)
    stiffness = 4 * modulus / 3
    length = mp.cbrt((mp.pi * work / stiffness) ** 2 * radius)
    critical = (mp.pi * pressure_factor(poisson) * hardness / (2 * modulus)) ** 2 * radius
    lam = 2 * mpf("1.03") * work / spacing * mp.cbrt(radius / (mp.pi * work * stiffness**2))
    return tuple(repr(float(value)) for value in (lam, critical / length, poisson, hardness / modulus))


def critical_of(law, critical, poisson, hardness):
    """omega at which the contact begins to flow; that of Jackson and Green flows from 1.9 times that on."""
    if law is jg:
        c = mpf("1.295") * mp.exp(mpf("0.736") * poisson)
        return critical * (c / (mpf("2.84") * pressure_factor(poisson))) ** 2
    return critical * (mpf("0.6") / pressure_factor(poisson)) ** 2 if law is zmc else critical


def kogut_etsion(setting, omega):
    """Load and radius of Kogut and Etsion's contact, by the next fit once its load is the smaller."""
    _, critical, poisson, _ = setting
    x = omega / critical
    fits = [(mpf("1.03") * x ** mpf("1.425"), mpf("0.93") * x ** mpf("1.136")),
            (mpf("1.40") * x ** mpf("1.263"), mpf("0.94") * x ** mpf("1.146")),
            (3 * x / pressure_factor(poisson), 2 * x)]
    load, area = min(fits)
    return load * critical ** mpf("1.5"), mp.sqrt(area * critical)


def bare(law, setting, omega):
    """P_0 and a_0 that the contact without adhesion has at omega, and the omega at which they are reached."""
    hertz = mp.sqrt(omega)
    _, load, radius = law(*setting, omega)
    if law is ke:
        if omega <= setting[1]:
            return omega * hertz, hertz, omega
        load, radius = kogut_etsion(setting, omega)
    radius = max(radius, hertz)
    load = min(load, radius**3, mp.sqrt(radius) * omega ** mpf("1.25"))

    def sunk(omega):
        outline = outline_of(fitted(setting, mpf(1), omega), mpf(3) / 4, load, radius)
        return omega - outline.interference(radius) + outline.height(radius) - radius**2 / 2

    if sunk(omega) > 0:
        omega = root_of(sunk, omega / 3, omega)
    return load, radius, omega


@dataclass
class Outline:
    """The outline of a top: R, E, a_0, rho and b."""

    radius: mpf
    modulus: mpf
    widest: mpf
    apex: mpf
    quartic: mpf

    def height(self, r):
        """f(r)."""
        inner = min(r, self.widest)
        return inner**2 / (2 * self.apex) + self.quartic * inner**4 + (r**2 - inner**2) / (2 * self.radius)

    def interference(self, a):
        """g(a)."""
        return a**2 / self.apex + 8 * self.quartic * a**4 / 3

    def load(self, a):
        """P(a)."""
        return 2 * self.modulus * (2 * a**3 / (3 * self.apex) + 32 * self.quartic * a**5 / 15)

    def gap(self, a, c, stress):
        """The gap at c around a contact of the radius a, under a stress from there on."""
        root, angle = mp.sqrt(c**2 - a**2), mp.asin(a / c)
        second = c**2 / 2 * angle - a / 2 * root
        fourth = 3 * c**4 / 8 * angle - a / 8 * root * (2 * a**2 + 3 * c**2)
        pressed = self.interference(a) * angle - second / self.apex - 8 * self.quartic * fourth / 3
        drawn = 4 * stress / (mp.pi * self.modulus) * (root * mp.acos(a / c) - c + a)
        return self.height(c) - self.interference(a) + 2 / mp.pi * pressed + drawn

    def edge(self, stress, opening):
        """c where the gap around a_0 rises through an opening."""

        def excess(place):
            return self.gap(self.widest, self.widest * (1 + mp.exp(place)), stress) - opening

        return self.widest * (1 + mp.exp(root_of(excess, mpf(-60), mpf(60))))

    def first_edge(self, stress, opening):
        """c of a contact that is a point."""

        def excess(place):
            return self.gap(mpf(0), self.widest * mp.exp(place), stress) - opening

        return self.widest * mp.exp(root_of(excess, mpf(-60), mpf(60)))

    def contact(self, c, stress, opening):
        """a of which the gap at c is an opening: at a given c the gap falls with a."""

        def excess(place):
            return self.gap(c * mp.cos(mp.exp(place)), c, stress) - opening

        return c * mp.cos(mp.exp(root_of(excess, mpf(-60), mp.log(mp.pi / 2))))


def fitted(setting, radius, omega):
    """R and rho after omega by the fit to finite elements, of the setting of an asperity."""
    critical, (_, _, poisson, hardness) = critical_of(jg, *setting[1:]), setting
    slope = mpf("1.275") * ((1 - poisson**2) * mpf("2.84") / hardness) ** mpf("-0.216")
    return radius, radius * (1 + slope * max(omega / (critical * radius) - 1, 0))


def outline_of(fitted, modulus, load, widest):
    """The outline that a plastic contact of P_0 and a_0 leaves, from R and rho by the fit."""
    radius, fit = fitted
    apex = max(fit, 4 * modulus * widest**3 / (3 * load))
    quartic = (load / (2 * modulus) - 2 * widest**3 / (3 * apex)) * 15 / (32 * widest**5)
    return Outline(radius, modulus, widest, apex, max(quartic, mpf(0)))


class State(NamedTuple):
    """A contact: its displacement from the lowered apex, that of the solids in a liquid, and F_s."""

    interference: mpf
    inner: mpf
    force: mpf


def zone_of(a, c, stress):
    """The adhesion force of a zone of a stress from a to c, and E times the displacement by which it draws
    the surfaces nearer."""
    root = mp.sqrt(c**2 - a**2)
    return 2 * stress * (a * root + c**2 * mp.acos(a / c)), 2 * stress * root


def root_of(rising, low, high):
    """The root of a rising function: bisection, then secants."""
    for _ in range(14):
        middle = (low + high) / 2
        low, high = (low, middle) if rising(middle) > 0 else (middle, high)
    return mp.findroot(rising, (low, high), tol=mpf(10) ** -90, maxsteps=80, verify=False)


class Apart(Exception):
    """Contacts that their bridge does not reach."""


class Dry:
    """An asperity of R = K = 1, and the plastic contact that it has without adhesion."""

    LEAST, radius, stiffness = mpf("0.02"), mpf(1), mpf(1)
    SHARES = "0.99 0.9 0.7 0.4 0.2 0.1".split()  # of c, from that of a point to the largest

    def __init__(self, law, texts):
        self.law, self.setting = law, tuple(mpf(float(text)) for text in texts)
        self.critical = critical_of(law, *self.setting[1:])
        lam = self.setting[0]
        zone = 4 * lam**2 * (mp.pi / 2 - 1) / 3
        self.touch = -mpf(4) / 3 * lam * 2 / (zone + mp.sqrt(zone**2 + mp.pi * lam))
        self.zone = (lam / 2, 2 * WORK / lam)

    def bare(self, omega):
        return bare(self.law, self.setting, omega)

    def touches(self, delta):
        return delta >= self.touch

    def edges(self, outline):
        """c of a contact that is a point, and of that of the radius a_0."""
        return outline.first_edge(*self.zone), outline.edge(*self.zone)

    def radius_at(self, outline, c):
        return outline.contact(c, *self.zone)

    def state(self, outline, a, c):
        force, drawn = zone_of(a, c, self.zone[0])
        interference = outline.interference(a) - drawn / outline.modulus
        return State(interference, interference, force)


class Pressed:
    """A contact that was loaded to omega, and what it passes when it unloads."""

    def __init__(self, contact, omega):
        self.contact, self.omega = contact, omega
        load, widest, reached = contact.bare(omega)
        fit = fitted(contact.setting, contact.radius, reached)
        self.outline = outline_of(fit, 3 * contact.stiffness / 4, load, widest)
        self.first, self.edge = contact.edges(self.outline)
        self.state = contact.state(self.outline, widest, self.edge)
        self.delta = reached - self.outline.interference(widest) + self.state.interference

    def unloaded(self, c):
        """a, and the state of the contact of the edge c."""
        a = self.contact.radius_at(self.outline, c)
        return a, self.contact.state(self.outline, a, c)

    def distance(self, c):
        return self.state.interference - self.unloaded(c)[1].interference

    def edges(self):
        """Edges at which the contact is looked at: by shares, and between a_0 and the edge around it."""
        yield from (self.first + mpf(share) * (self.edge - self.first) for share in self.contact.SHARES)
        least = max(self.outline.widest, self.first)
        if least < self.edge:
            yield (least + self.edge) / 2

    def is_stable(self, c):
        """Whether delta clearly rises with c, and a not much faster."""
        (a, state), (wider, beyond) = self.unloaded(c), self.unloaded(c * (1 + SMALL))
        rise, inner = (beyond.interference - state.interference) / SMALL, (beyond.inner - state.inner) / SMALL
        least = max(SLIGHT * self.omega * max((wider / a - 1) / SMALL, 1),
                    self.contact.LEAST * c**2 / self.outline.apex)
        return min(rise, inner) > least

    @cached_property
    def passed(self):
        """Edges that the contact passes when it unloads, the largest first, and its states."""
        kink, states = min(max(self.outline.widest, self.first), self.edge), []
        with mp.workdps(COARSE):
            for low, high in ((kink, self.edge), (self.first, kink)):
                for part in range(PARTS):
                    c = high - (high - low) * (mpf(part) / PARTS) ** 2
                    try:
                        states.append((c, self.unloaded(c)[1]))
                    except Apart:
                        return states
        return states

    def is_led_to(self, c):
        """Whether the contact passes no smaller displacement on the way to an edge."""
        own = self.unloaded(c)[1]
        return all(own.interference < state.interference and own.inner < state.inner
                   for before, state in self.passed if before > c)


def is_loaded_to(contact, omega, delta):
    """Whether loading to omega has passed no larger displacement."""
    with mp.workdps(COARSE):
        for part in range(1, PARTS):
            try:
                if Pressed(contact, omega * (mpf(part) / PARTS) ** 2).delta >= delta:
                    return False
            except Apart:
                continue
    return True


def slope_of(curve, place):
    return (curve(place * (1 + SMALL)) - curve(place)) / (place * SMALL)


def history(contact, omega):
    """`largest`, `distance` and the state of a contact that is loaded to omega and unloaded, where delta is a
    double."""

    def loading(omega):
        return Pressed(contact, omega).delta

    try:
        delta, slope = loading(omega), slope_of(loading, omega)
        if slope <= contact.LEAST or not contact.touches(delta):
            return
        top = Pressed(contact, omega + (mpf(float(delta)) - delta) / slope)
        if not contact.touches(top.delta) or not is_loaded_to(contact, top.omega, top.delta):
            return
    except Apart:
        return
    widest = top.outline.widest
    yield top.delta, mpf(0), (top.state.force, top.outline.load(widest), widest)
    for c in sorted(top.edges(), reverse=True):
        try:
            exact = top.distance(c)
            distance = mpf(float(exact))
            if distance > 0 and top.is_stable(c) and top.is_led_to(c):
                a, state = top.unloaded(c + (distance - exact) / slope_of(top.distance, c))
                yield top.delta, distance, (state.force, top.outline.load(a), a)
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
