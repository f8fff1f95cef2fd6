"""Reference values of the attraction of mean planes: quadratures over the gaps of a rough surface.

Writes tests/data/background.csv. Between planes that are z apart act

* van der Waals forces, W = A / [12 pi z^2 (1 + b z)] with b = 5.32 / wavelength or 0 (J. Gregory, J. Colloid
  Interface Sci. 83 (1981) 138), whose pressure is found here as -dW/dz by differentiation;
* a voltage, p = e0 V^2 / 2 (g + t)^2, t the sum of thickness over relative permittivity, and g = 0 where the
  gap is closed; e0 = 8.8541878128e-12 F/m (CODATA 2018).

Gaps are h + sigma x with a normal deviate x. Dispersion acts across gaps above a smallest one, at z = gap +
contact distance. Of asperities whose attraction has no end a share s of the area is theirs: the mean planes
act on the rest, and of every asperity 2 pi R W(D + rho^2 / 2R), pi eta rho^2 = s, is taken off, with the
Lennard-Jones attraction W = work [4/3 (z0/z)^2 - 1/3 (z0/z)^8], as a mean over normal heights.

The slope is a numerical derivative of the pressure by the separation. The energy is the integral of the
pressure from there to infinity, in the other order: of a gap g the pressure counts with the probability that
the gap is larger at the separation, so that energies between planes are not used. All arithmetic has 30
digits; inputs are the exact decimals.
"""

from fixtures import write
from mpmath import erfc, exp, inf, mp, mpf, pi, quad, sqrt

mp.dps = 30
VACUUM_PERMITTIVITY = mpf("8.8541878128e-12")
COLUMNS = "term,std,separation,strength,length,cut,share,energy,pressure,slope"
# All lengths of the rows in nm. Of dispersion, `strength` is A in J, `length` the wavelength or 0, `cut` the
# smallest gap; faces of gap 0 are 0.2 nm apart. `share` is that of caps, with the asperities below; 0 without
# caps. Of a voltage, `strength` is V and `length` is t.
CONTACT, WORK, SPACING = mpf("0.2e-9"), mpf("0.09"), mpf("0.2e-9")
RADIUS, DENSITY, HEIGHT_STD, OFFSET = mpf("3.33e-6"), mpf("7.39e12"), mpf("1.417e-9"), mpf("1.867e-9")
ROWS = [
    ("dispersion", "1", "5", "1e-19", "0", "1", "0"),
    ("dispersion", "1", "5", "1e-19", "100", "0.2", "0"),
    ("dispersion", "1", "0.5", "1e-19", "100", "0.2", "0"),
    ("dispersion", "1", "-1", "1e-19", "0", "0.2", "0"),
    ("dispersion", "0.5", "40", "4e-20", "100", "0.2", "0"),
    ("dispersion", "1.619", "5", "1e-19", "0", "0.2", "0.75"),
    ("dispersion", "1.619", "2", "1e-19", "100", "0.2", "1"),
    ("dispersion", "1.619", "12", "1e-19", "100", "0.2", "0.25"),
    ("voltage", "1", "5", "1", "0.5", "0", "0"),
    ("voltage", "1", "0.5", "1", "0.5", "0", "0"),
    ("voltage", "6", "0", "10", "28.6", "0", "0"),
    ("voltage", "6", "200", "10", "28.6", "0", "0"),
    ("voltage", "2", "1000", "5", "0", "0", "0"),
]


def density(x):
    return exp(-x * x / 2) / sqrt(2 * pi)


def upper(x):
    return erfc(x / sqrt(2)) / 2


def over(low, high, f, sigma, kink=None):
    """Integral over deviates from low to high, in panels, one of which ends at a kink; towards that f rises
    steeply."""
    low, high = max(low, -mpf(14)), min(high, mpf(14))
    if low >= high:
        return mpf(0)
    ends = [low + (high - low) * i / 14 for i in range(15)]
    if kink is not None:
        ends = sorted({*ends, *(x for x in (kink - mpf(1) / 2**i for i in range(6)) if low < x < high),
                       *([kink] if low < kink < high else [])})
    return quad(lambda x: density(x) * f(sigma * x), ends, method="gauss-legendre", maxdegree=5)


def beyond(low, middle, sigma, f):
    """Integral of f from low to infinity, weighted by the probability of a normal variate to be larger than
    middle less the place."""
    # Below the first the probability is less than 1e-43.
    ends = [max(low, middle - 14 * sigma)]
    ends += [end for end in (middle + sigma * x for x in range(-12, 15, 2)) if end > ends[0]]
    # The pressure rises steeply towards the smallest gap.
    ends = sorted({*ends,
                   *(low + sigma * x for x in (mpf("0.25"), mpf("0.5"), 1, 2, 3)
                     if low + sigma * x > ends[0])})
    ends += [ends[-1] * 2**i for i in range(1, 80)]
    weighted = lambda g: f(g) * upper((middle - g) / sigma)
    return sum(quad(weighted, pair, method="gauss-legendre", maxdegree=5) for pair in zip(ends, ends[1:]))


def of_planes(hamaker, wavelength):
    """W and -dW/dz, by the logarithmic derivative of W."""
    b = mpf("5.32") / wavelength if wavelength else mpf(0)
    work = lambda z: hamaker / (12 * pi * z**2 * (1 + b * z))  # noqa: E731
    return work, lambda z: work(z) * (2 / z + b / (1 + b * z))


def lennard_jones(z):
    q = SPACING / max(z, SPACING)
    return WORK * (4 * q**2 - q**8) / 3


def dispersion(sigma, hamaker, wavelength, cut, share):
    _, planes = of_planes(hamaker, wavelength)

    def pressure(h):
        mean = over((cut - h) / sigma, inf, lambda d: planes(h + d + CONTACT), sigma)
        if not share:
            return mean
        depth = share / (2 * pi * DENSITY * RADIUS)
        kink = (CONTACT + h - OFFSET + depth - SPACING) / HEIGHT_STD
        tail = over(-inf, inf, lambda u: lennard_jones(CONTACT + h - OFFSET - u + depth), HEIGHT_STD, kink)
        return (1 - share) * mean - 2 * pi * DENSITY * RADIUS * tail

    def energy(h):
        mean = beyond(cut, h, sigma, lambda g: planes(g + CONTACT))
        if not share:
            return mean
        nearest = CONTACT + h - OFFSET + share / (2 * pi * DENSITY * RADIUS)
        low = nearest - 14 * HEIGHT_STD
        # Where faces touch W is constant: a panel ends there.
        split = max(low, SPACING)
        tail = beyond(split, nearest, HEIGHT_STD, lennard_jones)
        if low < split:
            ends = [low + (split - low) * i / 8 for i in range(9)]
            tail += quad(lambda z: WORK * upper((nearest - z) / HEIGHT_STD), ends, method="gauss-legendre")
        return (1 - share) * mean - 2 * pi * DENSITY * RADIUS * tail

    return pressure, energy


def voltage(sigma, volts, dielectric):
    def pressure(h):
        of = lambda gap: VACUUM_PERMITTIVITY * volts**2 / (2 * (gap + dielectric) ** 2)
        low = -h / sigma
        closed = erfc(-low / sqrt(2)) / 2 * of(mpf(0)) if dielectric else mpf(0)
        return closed + over(low, inf, lambda d: of(h + d), sigma)

    def energy(h):
        of = lambda gap: VACUUM_PERMITTIVITY * volts**2 / (2 * (max(gap, 0) + dielectric) ** 2)
        # Bare electrodes are so far apart that no gap is closed.
        low = h - 14 * sigma
        closed = mpf(0)
        if low < 0:
            ends = [low + -low * i / 8 for i in range(9)]
            closed = quad(lambda g: of(g) * upper((h - g) / sigma), ends, method="gauss-legendre")
        return closed + beyond(max(low, mpf(0)), h, sigma, of)

    return pressure, energy


def row(fields):
    term, *numbers = fields
    std, separation, strength, length, cut, share = map(mpf, numbers)
    nm = mpf("1e-9")
    sigma, h = std * nm, separation * nm
    if term == "dispersion":
        pressure, energy = dispersion(sigma, strength, length * nm, cut * nm, share)
    else:
        pressure, energy = voltage(sigma, strength, length * nm)
    step = sigma * mpf("1e-4")
    # Central differences of 4th order in two steps, and Richardson's extrapolation.
    central = lambda s: (8 * (pressure(h + s) - pressure(h - s)) - pressure(h + 2 * s)
                         + pressure(h - 2 * s)) / (12 * s)
    slope = (16 * central(step) - central(2 * step)) / 15
    values = [energy(h), pressure(h), slope]
    return [*fields, *(mp.nstr(value, 15) for value in values)]


if __name__ == "__main__":
    write("background.csv", COLUMNS.split(","), map(row, ROWS))
