"""A dense solver of elastically coupled asperities, for reference_coupling.py and referee.py; it shares
nothing with the program.

Asperity i at x_i with the height z_i, at the separation d, has the approach

    delta_i = z_i - d - u_i,    u_i = sum_j G_ij f_j,    f_j = f(delta_j)

where f is the external force of its law (compression positive) and G the displacement of an elastic
half-space under a unit force at another place: 1/(pi E* r) on a half-space (`patch`, G_ii = 0), and in a
square cell that repeats (`periodic`) that displacement without its mean, by the sum of Ewald, with the images
of asperity i itself in G_ii.

The sum of Ewald is that of mpmath. The equations are solved by Newton's method with dense matrices of
doubles, but residuals are computed with the 64 bits of np.longdouble (x86), so that the solution has some 17
digits: iterative refinement.
"""

import functools
import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import mpmath as mp
import numpy as np

Long = np.longdouble
PI = Long("3.14159265358979323846264338327950288")
ROUNDS = 200


# --- The substrate


def lattice(x, y, splitting=None):
    """pi E* L G of the unit cell at (x, y), without the mean, by the sum of Ewald in the working precision of
    mpmath.

    At (0, 0) the source itself is left out: that is the self term, 4 zeta(1/2) beta(1/2) = -3.90026492...
    """
    x, y = (mp.mpf(value) - mp.nint(value) for value in (x, y))
    a = mp.sqrt(mp.pi) if splitting is None else mp.mpf(splitting)
    reach = mp.sqrt((mp.mp.dps + 3) * mp.log(10))  # exp(-reach^2) is below the last digit
    total = -2 * mp.sqrt(mp.pi) / a
    near, far = int(reach / a) + 2, int(reach * a / mp.pi) + 2
    for i in range(-near, near + 1):
        for j in range(-near, near + 1):
            r = mp.hypot(x - i, y - j)
            if r == 0:
                total -= 2 * a / mp.sqrt(mp.pi)
            elif a * r < reach:
                total += mp.erfc(a * r) / r
    along, across = ([mp.cos(2 * mp.pi * m * value) for m in range(far + 1)] for value in (x, y))
    for m in range(far + 1):
        for n in range(far + 1):
            s = mp.sqrt(m * m + n * n)
            if 0 < mp.pi * s / a < reach:
                terms = (2 if m else 1) * (2 if n else 1)
                total += terms * mp.erfc(mp.pi * s / a) / s * along[m] * across[n]
    return total


@functools.cache
def smooth_part():
    """Chebyshev coefficients, in x and in y over 0 ... 1/2, of `lattice` less the terms 1/r of the nine
    nearest sources.

    The nearest source left is two cells away, so that 20 terms each way leave 1e-20.
    """
    count = 20
    with mp.workdps(28):
        angles = [mp.pi * (2 * i + 1) / (2 * count) for i in range(count)]
        places = [(1 + mp.cos(angle)) / 4 for angle in angles]
        values = [[lattice(x, y) - nearest(x, y, mp.hypot) for y in places] for x in places]
        basis = mp.matrix([[mp.cos(k * angle) * (1 if k == 0 else 2) / count for angle in angles]
                           for k in range(count)])
        coefficients = basis * mp.matrix(values) * basis.T
        return np.array([[long(coefficients[i, j]) for j in range(count)] for i in range(count)])


def nearest(x, y, hypot):
    """The sum of 1/r over the nine nearest sources, without the one at distance 0."""
    total = 0
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            r = hypot(x - i, y - j)
            total = total + (1 / np.where(r == 0, np.inf, r) if isinstance(r, np.ndarray) else 1 / r if r
                             else 0)
    return total


def lattice_of(x, y):
    """`lattice` of arrays of long doubles, to 1e-18."""
    x, y = (np.abs(value - np.rint(value)) for value in (x, y))
    return nearest(x, y, np.hypot) + np.polynomial.chebyshev.chebval2d(4 * x - 1, 4 * y - 1, smooth_part())


def green_matrix(places, modulus, cell):
    """G_ij in m/N as long doubles; `cell` is the side of the periodic cell in m, None on a half-space."""
    x, y = np.asarray(places, Long).T
    x, y = x[:, None] - x[None, :], y[:, None] - y[None, :]
    scale = PI * Long(modulus)
    if cell is not None:
        return lattice_of(x / Long(cell), y / Long(cell)) / (scale * Long(cell))
    return 1 / (scale * np.where(np.eye(len(x), dtype=bool), np.inf, np.hypot(x, y)))


def long(value):
    """The long double nearest to a number of mpmath."""
    return Long(mp.nstr(mp.mpf(value), 24))


# --- Laws of one asperity


@dataclass
class Asperities:
    """The input of the laws: radii in m (one of each asperity or one of all), E* in Pa, work of adhesion in
    J/m^2, Z_0 in m."""

    radius: np.ndarray
    modulus: float
    work: float = 0.0
    spacing: float = 0.0

    @property
    def stiffness(self):
        return 4 * Long(self.modulus) / 3

    @property
    def length(self):
        """Unit of the approach of the scaled laws, (pi^2 work^2 R / K^2)^(1/3)."""
        return np.cbrt((PI * Long(self.work) / self.stiffness) ** 2 * Long(1) * self.radius)


def hertz(asperity, delta):
    inside = np.maximum(delta, 0)
    factor = asperity.stiffness * np.sqrt(Long(1) * asperity.radius)
    return factor * inside * np.sqrt(inside), Long(3) / 2 * factor * np.sqrt(inside)


def dmt(asperity, delta):
    force, slope = hertz(asperity, delta)
    return np.where(delta >= 0, force - 2 * PI * asperity.radius * Long(asperity.work), 0), slope


def idmt(asperity, delta):
    """The undeformed sphere under the Lennard-Jones stress before contact, dmt in contact."""
    unit = PI * asperity.radius * Long(asperity.work)
    s = Long(asperity.spacing) / (Long(asperity.spacing) - np.minimum(delta, 0))
    before = -Long(8) / 3 * unit * (s**2 - s**8 / 4)
    slope = -Long(8) / 3 * unit * 2 * (s**3 - s**9) / Long(asperity.spacing)
    force, contact_slope = dmt(asperity, delta)
    touched = delta >= 0
    return np.where(touched, force, before), np.where(touched, contact_slope, slope)


def jkr_radius(scaled):
    """A of JKR on the stable branch under given displacement, Delta = A^2 - (2/3) sqrt(6 A), A > 6^(-1/3)."""
    scaled = np.asarray(scaled, Long)
    if np.any(scaled <= JKR_END):
        raise ValueError("beyond the end of the branch of JKR")
    radius = 1 + np.sqrt(np.maximum(scaled, 0))
    for _ in range(100):
        root = np.sqrt(6 * radius)
        step = (radius**2 - 2 * root / 3 - scaled) / (2 * radius - 2 / root)
        radius = radius - step
        if np.max(np.abs(step) / radius) < 1e-19:
            break
    return radius


JKR_END = -3 * Long(6) ** (-Long(2) / 3)  # the least Delta


def jkr(asperity, delta):
    length, unit = asperity.length, PI * Long(asperity.work) * asperity.radius
    radius = jkr_radius(delta / length)
    root = np.sqrt(6 * radius)
    slope = (3 * radius**2 - Long(3) / 2 * root) / (2 * radius - 2 / root)
    return unit * (radius**3 - radius * root), unit / length * slope


def dugdale_state(theta, lam):
    """Delta, F and A of Maugis and Dugdale at the angle theta = arccos(a/c)."""
    sine, cosine = np.sin(theta), np.cos(theta)
    alpha = lam / 2 * (sine * cosine - theta * np.cos(2 * theta))
    beta = 4 * lam**2 / 3 * (theta * sine + cosine - 1)
    outer = 2 / (beta + np.sqrt(beta**2 + 4 * alpha))
    radius = outer * cosine
    pull = lam * outer**2 * (sine * cosine + theta)
    return radius**2 - 4 * lam / 3 * outer * sine, radius**3 - pull, radius


def dugdale(stress):
    """The law of Maugis and Dugdale in contact, to 1e-9, for lambda below 0.9379, where Delta falls with
    theta all the way."""

    def law(asperity, delta):
        modulus, length = asperity.stiffness, asperity.length
        lam = 2 * stress * np.cbrt(asperity.radius / (PI * asperity.work * modulus**2))
        low, high = np.full(delta.shape, Long(1e-3)), np.full(delta.shape, PI / 2)
        for _ in range(60):
            middle = (low + high) / 2
            deeper = dugdale_state(middle, lam)[0] > delta / length
            low, high = np.where(deeper, middle, low), np.where(deeper, high, middle)
        step, unit = Long(1e-5), PI * asperity.work * asperity.radius
        near, far = dugdale_state(low - step, lam), dugdale_state(np.minimum(low + step, PI / 2), lam)
        return unit * dugdale_state(low, lam)[1], unit / length * (far[1] - near[1]) / (far[0] - near[0])

    return law


LAWS = {"hertz": hertz, "dmt": dmt, "idmt": idmt, "jkr": jkr}


# --- The equations


class State(NamedTuple):
    """One solution: separation and approaches in m, external forces in N."""

    separation: float
    approach: np.ndarray
    force: np.ndarray


def stability(law, asperity, green, state):
    """The least real part of an eigenvalue of I + G K, K being the slopes of the law: above 0 in a stable
    state."""
    slope = law(asperity, state.approach)[1].astype(float)
    return float(np.linalg.eigvals(np.eye(len(slope)) + green.astype(float) * slope).real.min())


def solve(law, asperity, heights, green, separation, start):
    """The state at a separation from approaches that are near it; ValueError where Newton's method does not
    settle."""
    heights, delta = np.asarray(heights, Long), np.array(start, Long)
    target, identity, coarse = heights - Long(separation), np.eye(len(heights)), green.astype(float)
    best, factor = np.inf, 1.0
    for _ in range(ROUNDS):
        force, slope = law(asperity, delta)
        residual = delta - target + green @ force
        size = float(np.max(np.abs(residual)))
        step = np.linalg.solve(identity + coarse * slope.astype(float), residual.astype(float))
        factor = 1.0 if size < best else max(factor / 2, 0.02)
        best = min(best, size)
        delta = delta - Long(factor) * step
        if max(np.max(np.abs(step)) / 2, size / 5) <= 1e-18 * np.max(np.abs(target) + np.abs(delta)):
            return State(separation, delta, law(asperity, delta)[0])
    raise ValueError(f"no state at the separation {separation}: residual {size} m")


def follow(law, asperity, heights, green, separations, start=None):
    """States at separations one after the other, each from the one before, the first from asperities without
    coupling."""
    delta = np.asarray(heights, Long) - Long(separations[0]) if start is None else start
    states = []
    for separation in separations:
        states.append(solve(law, asperity, heights, green, separation, delta))
        delta = states[-1].approach
    return states


def steps(start, end, step):
    """Separations from one to another, no step longer than given."""
    return np.linspace(start, end, max(2, math.ceil(abs(end - start) / step)) + 1).tolist()


# --- Contacts that are not small

# u pi E* r / f outside the contact circle of the radius s r: the load of Hertz, and the attraction of JKR,
# that of a flat punch.
SERIES = {  # in s^2
    "load": [Long(v) for v in (1, Long(1) / 10, Long(9) / 280, Long(5) / 336, Long(35) / 4224)],
    "punch": [Long(v) for v in (1, Long(1) / 6, Long(3) / 40, Long(5) / 112, Long(35) / 1152)],
}


def beyond_point(s, kind):
    """u pi E* r / f - 1 at s = a/r: by its series where the closed form cancels."""
    s = np.minimum(np.asarray(s, Long), 1)
    series = sum(c * s ** (2 * k) for k, c in enumerate(SERIES[kind]) if k)
    wide = np.where(s > 0.03, s, 1)
    if kind == "load":
        closed = Long(3) / 4 * ((2 / wide - 1 / wide**3) * np.arcsin(wide)
                                + np.sqrt(1 - wide**2) / wide**2) - 1
    else:
        closed = np.arcsin(wide) / wide - 1
    return np.where(s > 0.03, closed, series)


def laplacian(coefficients):
    """The Laplacian of a series in Chebyshev polynomials of 4 x - 1 and 4 y - 1."""
    twice = np.polynomial.chebyshev.chebder
    along, across = (twice(coefficients, 2, 4, axis) for axis in (0, 1))
    return np.pad(along, ((0, 2), (0, 0))) + np.pad(across, ((0, 0), (0, 2)))


class Distances:
    """Distances of asperities from each other; in a cell that repeats from the nine nearest images, and what
    all others sum to."""

    def __init__(self, places, cell):
        x, y = np.asarray(places, Long).T
        apart, self.rest, self.slope = np.array([x[:, None] - x[None, :], y[:, None] - y[None, :]]), {}, 0
        ways = apart[None]
        if cell is not None:
            side, chebyshev = Long(cell), np.polynomial.chebyshev
            apart = apart / side - np.rint(apart / side)
            images = [np.array([[[i]], [[j]]]) for i in (-1, 0, 1) for j in (-1, 0, 1)]
            ways = side * np.array([apart - image for image in images])
            # The Laplacian of 1/r is 1/r^3, that of 1/r^3 is 9/r^5, and so on.
            at, coefficients = 4 * np.abs(apart) - 1, smooth_part()
            slopes = [chebyshev.chebval2d(*at, chebyshev.chebder(coefficients, 1, 4, k)) for k in (0, 1)]
            self.slope = np.sign(apart) * np.array(slopes) / side**2
            for power in (3, 5, 7):
                coefficients = laplacian(coefficients) / (power - 2) ** 2
                self.rest[power] = chebyshev.chebval2d(*at, coefficients) / side**power
        near = np.hypot(ways[:, 0], ways[:, 1])
        self.ways, self.near = ways, np.where(near == 0, np.inf, near)

    def slopes(self):
        """The sum of the gradient of 1/r over all images, along x and along y."""
        return self.slope - np.sum(self.ways / self.near[:, None] ** 3, axis=0)

    def cubes(self):
        """The sum of 1/r^3 over all images."""
        return np.sum(1 / self.near**3, axis=0) + self.rest.get(3, 0)

    def beyond(self, radius, kind):
        """The sum over all images of u pi E* / f less that of point forces; `radius` is that of the contact
        of each column."""
        total = np.sum(beyond_point(radius / self.near, kind) / self.near, axis=0)
        for power, values in self.rest.items():
            total = total + SERIES[kind][(power - 1) // 2] * radius ** (power - 1) * values
        return total


def contact_radius(law, asperity, delta):
    """Radius of the contact in m of `hertz` or `jkr`."""
    if law is jkr:
        return np.cbrt(PI * Long(asperity.work)
                       * asperity.radius**2 / asperity.stiffness) * jkr_radius(delta / asperity.length)
    return np.sqrt(asperity.radius * np.maximum(delta, 0))


def solve_contact(
    law, asperity, heights, places, cell, separation, start, is_whole = True
):
    """Solves as `solve`, with the next orders: contacts of finite size, the curvature and the tilt of the
    substrate under each.

    The load of a contact acts as that of Hertz, its attraction as that of a flat punch, and the others'
    forces bend the substrate: 1/R_eff = 1/R + sum_j f_j / (2 pi E* r_ij^3). By their gradient g a contact
    moves to s = -R g from its place, at most an eighth of the distance of the nearest. There it is deeper by
    R g^2 / 2, and displaces others by -f s grad(1 / pi E* r) more. Also returns the radii of the contacts in
    m. Of what contacts displace only the order after point forces is taken unless it `is_whole`:
    M / (4 pi E* r^3), M the second moment of the pressure.
    """
    green, distances = green_matrix(places, asperity.modulus, cell), Distances(places, cell)
    scale, cubes, slopes = PI * Long(asperity.modulus), distances.cubes(), distances.slopes()
    furthest = np.min(distances.near, axis=(0, 2)) / 8  # circles overlap
    heights, bent, sunk, delta = np.asarray(heights, Long), asperity, Long(0), np.array(start, Long)
    for _ in range(ROUNDS):
        state = solve(law, bent, heights - sunk, green, separation, delta)
        radius = contact_radius(law, bent, state.approach)
        load = bent.stiffness * radius**3 / bent.radius
        before, delta = sunk, state.approach
        if is_whole:
            sunk = (distances.beyond(radius, "load") @ load
                    + distances.beyond(radius, "punch") @ (state.force - load)) / scale
        else:
            sunk = cubes @ (radius**2 * (2 * load / 5 + 2 * (state.force - load) / 3)) / (4 * scale)
        tilt = slopes @ state.force / scale
        steep = np.maximum(np.hypot(*tilt), np.finfo(Long).tiny)
        arm = np.minimum(asperity.radius, furthest / steep)
        sunk = sunk - arm * (1 - arm / (2 * asperity.radius)) * steep**2
        sunk = sunk + np.einsum("kij,kj->i", slopes, arm * state.force * tilt) / scale
        curvature = 1 / (Long(1) * asperity.radius) + cubes @ state.force / (2 * scale)
        bent = replace(asperity, radius=1 / curvature)
        if np.max(np.abs(sunk - before)) <= 1e-16 * np.max(np.abs(sunk) + np.abs(delta)):
            return state, radius
    raise ValueError(f"the next orders do not settle at the separation {separation}")
