"""Reference values of the figures by which the independence of asperities is judged, for laws whose integrals
are quadratures of closed forms.

Surfaces of DMT asperities, f(δ) = K√R δ^(3/2) − 2πRΔγ for δ ≥ 0 and 0 before, or of Hertz ones (Δγ = 0), with
Gaussian or exponential heights. Force, its derivatives by the separation, mean square of the force of one
asperity and area are integrals over the density of the heights, by quadrature with 30 digits; the pull-off is
the root of the first derivative, the largest attraction that of the second, or at the smallest separation
where there is no root. Then

    k_s = E* L/c, c = (4/π)(ln(1 + √2) + (1 − √2)/3), σ_u² = 2πη⟨f²⟩ ln(L/b)/(πE*)² with b = 1/(2√η), Λ_c =
    πE* L²/max(dF/dh).

Columns, SI: the surface (heights, work_of_adhesion, surface_height_std, asperity_height_std, nominal_area,
asperity_density, the first separation over surface_height_std), and the figures by their names in files.
Common to all: E* = 85.29 GPa, R = 3.33 um, no mean plane offset.

Writes tests/data/independence.csv.
"""

import mpmath as mp
from fixtures import bisect, write

mp.mp.dps = 30
MODULUS, RADIUS = mp.mpf("85.29e9"), mp.mpf("3.33e-6")
HERTZ = 4 * MODULUS / 3 * mp.sqrt(RADIUS)
SQUARE = 4 / mp.pi * (mp.log(1 + mp.sqrt(2)) + (1 - mp.sqrt(2)) / 3)
LAST = 8  # the largest separation over surface_height_std
SHIFT = mp.mpf("0.05")  # limit of the shift over surface_height_std
# Heights, work of adhesion, sigma, sigma_s, area, density, first separation over sigma.
SURFACES = [
    ("gaussian", "0.05", "1.619e-9", "1.4e-9", "1e-10", "7.39e12", "-1"),
    ("gaussian", "0.4", "0.9e-9", "0.8e-9", "1e-9", "7.39e12", "-1"),
    ("gaussian", "0", "1.619e-9", "1.4e-9", "1e-10", "7.39e12", "1"),
    ("exponential", "0.09", "0.4e-9", "0.3e-9", "1e-9", "7e12", "1"),
    ("exponential", "0", "0.4e-9", "0.3e-9", "1e-9", "7e12", "0.5"),
]
FIGURES = ["patch_side", "substrate_stiffness", "shift", "relative_shift", "attractive_stiffness",
           "relative_attractive_stiffness",
           "fluctuation", "relative_fluctuation", "longest_stable_wavelength", "contact_share",
           "closest_shift", "relative_closest_shift",
           "independent_from"]


class Ensemble:
    """N asperities over heights of a density."""

    def __init__(self, heights, energy, std, count):
        self.count, self.std = count, std
        self.pull = 2 * mp.pi * RADIUS * energy
        self.is_gaussian = heights == "gaussian"

    def density(self, u):
        s = u / self.std
        if self.is_gaussian:
            return mp.exp(-s * s / 2) / mp.sqrt(2 * mp.pi) / self.std
        return mp.exp(-(s + 1)) / self.std if s >= -1 else mp.mpf(0)

    def slope_of_density(self, u):
        return -u / self.std**2 * self.density(u) if self.is_gaussian else -self.density(u) / self.std

    def mean(self, d, of):
        """The expectation of a function of the interference over all that touch; x² is the interference in
        units of the spread."""
        inner = lambda x: of(x * x * self.std) * self.density(d + x * x * self.std) * 2 * x * self.std
        ends = [0, 0.5, 1, 2, 3, 4, 6, 9, 15] if not self.is_gaussian else [0, 0.5, 1, 1.5, 2, 3, 4, 5]
        return mp.quad(inner, ends)

    def force(self, d):
        return self.count * self.mean(d, lambda delta: HERTZ * delta ** mp.mpf(1.5) - self.pull)

    def slope(self, d):
        # Asperities that touch first add their attraction; the others lose load.
        return self.count * (self.pull * self.density(d)
                             - self.mean(d, lambda delta: 1.5 * HERTZ * mp.sqrt(delta)))

    def curvature(self, d):
        return mp.diff(self.slope, d, h=self.std * mp.mpf("1e-10"))

    def mean_square(self, d):
        return self.mean(d, lambda delta: (HERTZ * delta ** mp.mpf(1.5) - self.pull) ** 2)

    def area(self, d):
        return self.count * self.mean(d, lambda delta: mp.pi * RADIUS * delta)


def changes(f, places):
    """The places where f changes its sign between neighbours."""
    values = [f(place) for place in places]
    pairs = [k for k in range(len(places) - 1) if values[k] * values[k + 1] < 0]
    return [bisect(lambda at, rises=values[k] < 0: (f(at) > 0) == rises, *places[k : k + 2]) for k in pairs]


def figures(heights, *numbers):
    energy, sigma, std, area, density, first = map(mp.mpf, numbers)
    surface = Ensemble(heights, energy, std, mp.floor(density * area + mp.mpf(0.5)))
    places = [sigma * (first + (LAST - first) * k / 40) for k in range(41)]
    side = mp.sqrt(area)
    stiffness = MODULUS * side / SQUARE
    forces = [surface.force(place) for place in places]
    deepest = min(range(len(places)), key=lambda k: forces[k])
    around = places[max(deepest - 1, 0) : deepest + 2]
    place = (changes(surface.slope, around) or [places[deepest]])[0] if forces[deepest] < 0 else places[0]
    steep = [surface.slope(at) for at in [*changes(surface.curvature, places), places[0]]]
    attraction = max(max(steep), mp.mpf(0)) if energy > 0 else mp.mpf(0)
    eta = surface.count / area
    fluctuation = mp.sqrt(2 * mp.pi * eta * surface.mean_square(place)
                          * mp.log(side * 2 * mp.sqrt(eta))) / (mp.pi * MODULUS)
    limit = SHIFT * sigma * stiffness
    beyond = [k for k in range(len(places)) if abs(forces[k]) > limit]
    start = places[0]
    if beyond:
        start = bisect(lambda at: abs(surface.force(at)) < limit, *places[beyond[-1] : beyond[-1] + 2])
    shift, closest = surface.force(place) / stiffness, forces[0] / stiffness
    wavelength = mp.pi * MODULUS * area / attraction if attraction > 0 else mp.inf
    return [side, stiffness, shift, shift / sigma, attraction, attraction / stiffness, fluctuation,
            fluctuation / sigma, wavelength,
            surface.area(place) / area, closest, closest / sigma, start]


def table():
    for surface in SURFACES:
        yield [*surface, *(mp.nstr(value, 12, min_fixed=1, max_fixed=0) for value in figures(*surface))]


if __name__ == "__main__":
    keys = ["heights", "work_of_adhesion", "surface_height_std", "asperity_height_std", "nominal_area",
            "asperity_density", "first"]  # fmt: skip
    write("independence.csv", keys + FIGURES, table())
