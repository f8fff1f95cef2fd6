"""Reference values of the elastic-plastic adhesion of flattened tops, the law md_plastic.

Writes tests/data/md_plastic.csv: the adhesion force, the contact force and the contact radius of one asperity that was pressed
to the interference `largest` and is a `distance` from there, with 25 digits of 60. A contact is an elastic Maugis-Dugdale
contact of the radius R1 = K a^3 / P of its top, with the load P and the contact radius a of a plastic contact without adhesion
at the interference omega:

* the edge of the adhesive zone, m = c/a, is where the gap is (work of adhesion)/sigma_0 (D. Maugis, J. Colloid Interface Sci.
  150 (1992) 243);
* delta = omega - 2 sigma_0 a sqrt(m^2 - 1)/E, and a contact that unloads keeps R1;
* P is at most K a^3 / R and K R^(1/4) a^(1/2) omega^(5/4): a loop of a larger load would give out energy.

Settings are the cases of Shi and Polycarpou (2005), a soft and sticky metal, and asperities drawn at random. Scaled quantities
as in reference_plastic.py, whose plastic contacts these are.

Usage:
    uv run scripts/reference_md_plastic.py               write the table
    uv run scripts/reference_md_plastic.py -o OUT.csv    write it elsewhere
"""

# /// script
# requires-python = ">=3.9"
# dependencies = ["mpmath>=1.3"]
# ///

import argparse
import random
from pathlib import Path

from mpmath import mp, mpf
from reference_plastic import MODULUS, WORK, jg, ke, pressure_factor, tn, zmc
from reference_values import VALUE_DIGITS, write

KEYS = ["contact", "lambda", "critical_interference", "poisson_ratio", "hardness_ratio", "largest", "distance"]
VALUES = ["adhesion_force", "contact_force", "contact_radius"]

# R, E, work of adhesion, Z_0, H in SI, Poisson's ratio
ASPERITIES = [
    ("1.66e-6", "85.29e9", "0.01", "0.2e-9", "2.5e9", "0.27"),
    ("3.33e-6", "85.29e9", "0.09", "0.2e-9", "2.5e9", "0.27"),
    ("6.38e-6", "85.29e9", "0.30", "0.2e-9", "2.5e9", "0.27"),
    ("1e-6", "45e9", "1", "0.3e-9", "1e9", "0.42"),
]
LOADED = "0.3 1.0 1.05 1.85 1.89 1.905 1.95 2.5 4.0 10.0 40.0 130.0 300.0".split()  # omega over omega_c
SHARES = "0.99 0.9 0.6 0.3".split()  # contact radius over the largest
RANDOM = 40
SMALL = mpf(10) ** -25


def scaled(radius, modulus, work, spacing, hardness, poisson):
    """lambda, omega_c of Chang, Etsion and Bogy, Poisson's ratio and H/E of an asperity, as doubles."""
    radius, modulus, work, spacing, hardness, poisson = map(mpf, (radius, modulus, work, spacing, hardness, poisson))
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


def adhesive(lam, load, radius):
    """The adhesion force, and the displacement by which it draws the surfaces nearer."""
    stress, flattened = lam / 2, radius**3 / load

    def gap(m):
        root, angle = mp.sqrt(m * m - 1), mp.acos(1 / m)
        profile = radius**2 / (mp.pi * flattened) * (root + (m * m - 2) * angle)
        return profile + 4 * stress * radius / (mp.pi * MODULUS) * (root * angle - m + 1)

    # By the logarithm of m - 1, whose range is wide: bisection, then secants.
    def excess(place):
        return mp.log(gap(1 + mp.exp(place)) * stress / WORK)

    low, high = mpf(-60), mpf(60)
    for _ in range(16):
        middle = (low + high) / 2
        low, high = (low, middle) if excess(middle) > 0 else (middle, high)
    m = 1 + mp.exp(mp.findroot(excess, (low, high), tol=mpf(10) ** -100, maxsteps=60, verify=False))
    root, angle = mp.sqrt(m * m - 1), mp.acos(1 / m)
    return 2 * stress * radius**2 * (root + m * m * angle), 2 * stress * radius * root / MODULUS


def loading(law, setting, omega):
    """delta and the state of a contact that is loaded."""
    load, radius = bare(law, setting, omega)
    force, drawn = adhesive(setting[0], load, radius)
    return omega - drawn, (force, load, radius)


def at_double(state_at, place):
    """The state next to a place whose delta is a double; none where it is not stable."""
    delta, _ = state_at(place)
    slope = (state_at(place * (1 + SMALL))[0] - delta) / (place * SMALL)
    if slope <= mpf("0.02"):
        return None
    place += (mpf(float(delta)) - delta) / slope
    return (place, *state_at(place))


def rows_of(law, texts, omegas):
    setting = tuple(mpf(float(text)) for text in texts)
    lam = setting[0]
    zone = 4 * lam**2 * (mp.pi / 2 - 1) / 3
    touch = -mpf(4) / 3 * lam * 2 / (zone + mp.sqrt(zone**2 + mp.pi * lam))
    for text in omegas:
        omega = critical_of(law, *setting[1:]) * mpf(text)
        loaded = at_double(lambda omega: loading(law, setting, omega), omega)
        if loaded is None or loaded[1] < touch:
            continue
        omega, largest, (force, load, radius) = loaded
        yield (law, texts, largest, mpf(0), (force, load, radius))
        flattened, lowered = radius**3 / load, omega - load / radius

        def unloading(own):
            own_load = own**3 / flattened
            own_force, drawn = adhesive(lam, own_load, own)
            return lowered + own**2 / flattened - drawn, (own_force, own_load, own)

        for share in SHARES:
            delta, _ = unloading(radius * mpf(share))
            distance = mpf(float(largest - delta))
            slope = (unloading(radius * mpf(share) * (1 + SMALL))[0] - delta) / (radius * mpf(share) * SMALL)
            if distance <= 0 or slope <= mpf("0.02"):
                continue
            own = radius * mpf(share) + (largest - distance - delta) / slope
            yield (law, texts, largest, distance, unloading(own)[1])


def rows():
    for asperity in ASPERITIES:
        for law in (jg, zmc, tn, ke):
            yield from rows_of(law, scaled(*asperity), LOADED if law is jg else LOADED[2::3])
    draw = random.Random(1)
    for number in range(RANDOM):
        lam, critical = 10 ** draw.uniform(-2, 2), 10 ** draw.uniform(-0.5, 2)
        texts = tuple(repr(value) for value in (lam, critical, draw.uniform(0.1, 0.45), 10 ** draw.uniform(-3, -1.3)))
        omegas = [repr(10 ** draw.uniform(0.3, 2.47)) for _ in range(2)]
        yield from rows_of((jg, zmc, tn, ke)[number % 4 if number % 2 else 0], texts, omegas)


def main():
    default = Path(__file__).resolve().parent.parent / "tests" / "data" / "md_plastic.csv"
    parser = argparse.ArgumentParser(description="Reference values of the elastic-plastic adhesion of flattened tops.")
    parser.add_argument("-o", "--output", type=Path, default=default, metavar="OUT.csv", help="table to write")
    table = []
    for law, texts, largest, distance, state in rows():
        numbers = [mp.nstr(value, VALUE_DIGITS) for value in (largest, distance, *state)]
        table.append(dict(zip(KEYS + VALUES, [law.__name__, *texts, *numbers])))
    write(table, KEYS + VALUES, parser.parse_args().output)
    print(f"{len(table)} rows")


if __name__ == "__main__":
    main()
