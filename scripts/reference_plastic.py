"""Reference values of loading laws that flow, and of their unloading.

Writes tests/data/plastic.csv: the adhesion force, the contact force and the contact radius of one asperity
that was pressed to the interference `largest` and is a `distance` from there, with 25 digits of 60. Without
an unloading the distance is 0 and the state is that of the law on approach. The laws

* zmc: Y. Zhao, D. M. Maietta, L. Chang, J. Tribol. 122 (2000) 86;
* jg: R. L. Jackson, I. Green, J. Tribol. 127 (2005) 343, with the yield strength H/2.84;
* tn: C. Thornton, Z. Ning, Powder Technol. 99 (1998) 154, the load without adhesion, yielding at the pressure
  KH;
* ceb, ke: as in reference_laws.py,

all but ke with the adhesion force of the Lennard-Jones stress over the Hertz gap up to where they yield, and
2 beyond. The unloadings

* secant: the elastic part of the law for the radius R' = 4 E a^3 / (3 P), from the recovery 3 P / (4 E a);
* thornton_ning: JKR's contact of that radius, by its contact radius, which is found by bisection;
* mesarovic_johnson: S. D. Mesarovic, K. L. Johnson, J. Mech. Phys. Solids 48 (2000) 2009, by the contact
  radius, likewise.

Scaled quantities as in reference_laws.py: R, K = 4/3 E and pi (work of adhesion) are 1; hardness_ratio is H/E
of the asperity with dimensions, on which jg alone depends.
"""

from fixtures import bisect, write
from mpmath import mp, mpf
from reference_laws import hertz_profile_force, ke_contact, spacing
from reference_values import VALUE_DIGITS

mp.dps = 60

KEYS = ["law", "unloading", "lambda", "critical_interference", "poisson_ratio", "hardness_ratio", "largest",
        "distance"]
VALUES = ["adhesion_force", "contact_force", "contact_radius"]

# lambda, omega_c, Poisson's ratio, H/E
SETTINGS = [("0.1", "3.0", "0.27", "0.03"), ("2.5", "40.0", "0.4", "0.004")]
LOADED = "0.01 0.5 0.99 1.2 2.1 4.0 11.0 40.0 70.0 300.0".split()  # largest over omega_c
PRESSED = "4.5 20.0 120.0".split()
SHARES = "0.0 0.2 0.6 0.95".split()  # distance over the recovery

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


def ceb(lam, critical, poisson, hardness, delta):
    if delta <= critical:
        return elastic(lam, delta)
    square = 2 * delta - critical
    return mpf(2), mpf(3) / 2 * mp.sqrt(critical) * square, mp.sqrt(square)


def ke(lam, critical, poisson, hardness, delta):
    state = ke_contact(lam, delta, critical, poisson)
    return state.adhesion.value, state.contact_force.value, state.radius.value


def secant(law, lam, critical, load, radius, share):
    left = radius**3 / load
    recovery = load / radius
    delta = recovery * (1 - share)
    contact = (left**mpf("0.5") * delta ** mpf("1.5"), mp.sqrt(left * delta))
    if law is ke:
        own = critical * left
        pull = 2 * left * mpf("0.98") * (delta / own) ** mpf("0.298") * (spacing(lam) / own) ** mpf("-0.29")
    else:
        pull = left * ring(lam, delta)
    return recovery * share, (pull, *contact)


def thornton_ning(law, lam, critical, load, radius, share):
    left, recovery = radius**3 / load, load / radius
    distance = recovery * share

    def place(a):
        return a**2 / left - mp.sqrt(2 * mp.pi * a * WORK / MODULUS)

    stable = mp.cbrt(mp.pi * WORK * left**2 / (8 * MODULUS))
    a = bisect(lambda a: place(a) > recovery - distance, stable, 10 * radius)
    return distance, (mp.sqrt(8 * mp.pi * MODULUS * WORK * a**3), a**3 / left, a)


def mesarovic_johnson(law, lam, critical, load, radius, share):
    pressure = load / (mp.pi * radius**2)
    distance = 2 * pressure * radius / MODULUS * share
    opening = mp.sqrt(2 * mp.pi * radius * WORK / MODULUS)
    if distance <= opening:
        return distance, (2 * MODULUS * radius * distance, load, radius)

    def way(a):
        return 2 * pressure / MODULUS * mp.sqrt(radius**2 - a**2) + mp.sqrt(2 * mp.pi * a * WORK / MODULUS)

    # d(way)/da = 0
    fold = bisect(
        lambda a: 2 * pressure / MODULUS * a / mp.sqrt(radius**2
                                                       - a**2) > mp.sqrt(mp.pi * WORK / (2 * a * MODULUS)),
        mpf(0) + mpf(10) ** -30,
        radius * (1 - mpf(10) ** -40),
    )
    a = bisect(lambda a: way(a) < distance, fold, radius)
    pressed = 2 * pressure * (radius**2 * mp.asin(a / radius) - a * mp.sqrt(radius**2 - a**2))
    return distance, (mp.sqrt(8 * mp.pi * MODULUS * WORK * a**3), pressed, a)


def rows():
    for setting in SETTINGS:
        lam, critical, poisson, hardness = (mpf(float(text)) for text in setting)

        def row(law, unloading, largest, distance, state, setting=setting):
            numbers = [mp.nstr(value, VALUE_DIGITS) for value in (largest, distance, *state)]
            return [law.__name__, unloading, *setting, *numbers]

        for law in (zmc, jg, tn):
            for text in LOADED:
                largest = mpf(float(critical * mpf(text)))
                yield row(law, "", largest, mpf(0), law(lam, critical, poisson, hardness, largest))
        for unloading in (secant, thornton_ning, mesarovic_johnson):
            for law in (ke, ceb, zmc, jg, tn):
                for text in PRESSED:
                    largest = mpf(float(critical * mpf(text)))
                    _, load, radius = law(lam, critical, poisson, hardness, largest)
                    for share in SHARES:
                        distance, state = unloading(law, lam, critical, load, radius, mpf(share))
                        # The distance of the table is a double.
                        share = mpf(float(distance)) / distance * mpf(share) if distance else mpf(0)
                        distance, state = unloading(law, lam, critical, load, radius, share)
                        yield row(law, unloading.__name__, largest, distance, state)


if __name__ == "__main__":
    write("plastic.csv", KEYS + VALUES, rows())
