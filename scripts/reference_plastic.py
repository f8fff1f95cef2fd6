"""Reference values of loading laws that flow.

Writes tests/data/plastic.csv: the adhesion force, the contact force and the contact radius of one asperity at the
interference `delta` on approach, with 25 digits of 60. The laws

* zmc: Y. Zhao, D. M. Maietta, L. Chang, J. Tribol. 122 (2000) 86;
* jg: R. L. Jackson, I. Green, J. Tribol. 127 (2005) 343, with the yield strength H/2.84;
* tn: C. Thornton, Z. Ning, Powder Technol. 99 (1998) 154, the load without adhesion, yielding at the pressure
  KH

have the adhesion force of the Lennard-Jones stress over the Hertz gap up to where they yield, and 2 beyond.

Scaled quantities as in reference_laws.py: R, K = 4/3 E and pi (work of adhesion) are 1; hardness_ratio is H/E
of the asperity with dimensions, on which jg alone depends.
"""

from fixtures import write
from mpmath import mp, mpf
from reference_laws import hertz_profile_force, ke_contact, spacing
from reference_values import VALUE_DIGITS

mp.dps = 60

KEYS = ["law", "lambda", "critical_interference", "poisson_ratio", "hardness_ratio", "delta"]
VALUES = ["adhesion_force", "contact_force", "contact_radius"]

# lambda, omega_c, Poisson's ratio, H/E
SETTINGS = [("0.1", "3.0", "0.27", "0.03"), ("2.5", "40.0", "0.4", "0.004")]
LOADED = "0.01 0.5 0.99 1.2 2.1 4.0 11.0 40.0 70.0 300.0".split()  # delta over omega_c

MODULUS = mpf(3) / 4  # K = 1
WORK = 1 / mp.pi


def ring(lam, delta):
    """The adhesion force around a Hertz contact, in the unit of that of an asperity of radius 1."""
    return hertz_profile_force(delta / (mp.pi * spacing(lam)))[0]


def pressure_factor(poisson):
    return mpf("0.454") + mpf("0.41") * poisson


def elastic(lam, delta):
    return ring(lam, delta), delta ** mpf("1.5"), mp.sqrt(delta)


def zmc(lam, critical, poisson, hardness, delta):
    k = mpf("0.4")
    pressure = 3 * mp.sqrt(critical) / (2 * mp.pi
                                        * pressure_factor(poisson))  # H, for K H = 3 P_c/(2 pi omega_c)
    first = (3 * mp.pi * k * pressure / (4 * MODULUS)) ** 2
    last = 54 * first
    if delta <= first:
        return elastic(lam, delta)
    if delta > last:
        return mpf(2), pressure * 2 * mp.pi * delta, mp.sqrt(2 * delta)
    u = (delta - first) / (last - first)
    square = delta * (1 - 2 * u**3 + 3 * u**2)
    mean = pressure * (1 - (1 - k) * (mp.log(last) - mp.log(delta)) / (mp.log(last) - mp.log(first)))
    return mpf(2), mp.pi * square * mean, mp.sqrt(square)


def jg(lam, critical, poisson, hardness, delta):
    e = hardness / mpf("2.84")
    c = mpf("1.295") * mp.exp(mpf("0.736") * poisson)
    own = critical * (c * e / (pressure_factor(poisson) * hardness)) ** 2
    x = delta / own
    if x <= mpf("1.9"):
        return elastic(lam, delta)
    square = x * (x / mpf("1.9")) ** (mpf("0.14") * mp.exp(23 * e))  # a^2 over R omega_c
    over_radius = mp.pi * c * e / 2 * mp.sqrt(square)
    over_yield = mpf("2.84") * (1 - mp.exp(-mpf("0.82") * over_radius ** mpf("-0.7")))
    load = mp.exp(-(x ** (mpf(5) / 12)) / 4) * x ** mpf("1.5")
    load += 4 * over_yield / c * (1 - mp.exp(-(x ** (mpf(5) / 9)) / 25)) * x
    return mpf(2), load * own ** mpf("1.5"), mp.sqrt(square * own)


def tn(lam, critical, poisson, hardness, delta):
    if delta <= critical:
        return elastic(lam, delta)
    yielding = 2 * MODULUS / mp.pi * mp.sqrt(critical)  # a_y = pi p_y/(2 E)
    return mpf(2), critical ** mpf("1.5") + mp.pi * yielding * (delta - critical), mp.sqrt(delta)


def ke(lam, critical, poisson, hardness, delta):
    state = ke_contact(lam, delta, critical, poisson)
    return state.adhesion.value, state.contact_force.value, state.radius.value


def rows():
    for setting in SETTINGS:
        lam, critical, poisson, hardness = (mpf(float(text)) for text in setting)
        for law in (zmc, jg, tn):
            for text in LOADED:
                delta = mpf(float(critical * mpf(text)))
                state = law(lam, critical, poisson, hardness, delta)
                yield [law.__name__, *setting, *(mp.nstr(value, VALUE_DIGITS) for value in (delta, *state))]


if __name__ == "__main__":
    write("plastic.csv", KEYS + VALUES, rows())
