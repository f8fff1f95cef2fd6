"""Reference values of rough spheres: the contact of Greenwood and Tripp (1967), and the pull-off of Fuller and Tabor (1975) under
a flat face and under a sphere.

Greenwood and Tripp: a smooth sphere of the radius R_m presses on asperities of the radius R, density η and normal heights; the
half-space gives way under their mean pressure p(r),

    p(r) = (4/3) η E* √R σ^(3/2) F_3/2(u(r)/σ), u(r) = d + r²/2R_m + w(r), F_n(x) = ∫_x^∞ (z − x)^n φ(z) dz,

with w the displacement by p, here of rings whose pressure is uniform, by Newton's method. An asperity is pressed down by all others,
but p has its own load too: `load_of_others` is that of w less the displacement 2f/(πE* b) by a load f on a disc of the area
πb² = 1/η in its middle. `radius` is (16/3π) ∫p r dA/∫p dA, which of Hertz's contact is a.

Fuller and Tabor: asperities with JKR's force down to the end of its stable branch under a face at d. Relative pull-offs are over
those of asperities of one height, of the number N for the flat face, and 2πR_m ησ for the sphere, below which the mean force is an
integral over the depths, too.

    δ/σ = θ^(-2/3) (A² − √(2πA)), P = RΔγ ((4/3)A³ − √(8πA³)), θ = E* σ^(3/2)/(√R Δγ)

Writes tests/data/greenwood_tripp.csv, tests/data/fuller_tabor.csv.
"""

import numpy as np
from fixtures import write
from scipy.integrate import quad
from scipy.optimize import minimize_scalar
from scipy.special import ellipe, ellipkm1, ndtr

MODULUS, RADIUS, BODY, DENSITY = 1e9, 10e-9, 100e-6, 500e12
RINGS, FURTHEST = 400, 6.0
# Roughness and separation, m.
SPHERES = [(1e-9, -8e-9), (1e-9, -4e-9), (2e-9, -4e-9), (2e-9, 0.0), (4e-9, 0.0), (4e-9, 4e-9)]
THETAS = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0]


def touching_moment(x):
    """F_3/2 of a standard normal law, for an array."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    ends = np.sqrt(np.maximum(9.0 - x, 0.0))[:, None]
    t = 0.5 * (nodes + 1.0) * ends
    return np.sum(
        0.5 * weights * ends * 2.0 * t**4 * np.exp(-0.5 * (x[:, None] + t * t) ** 2), axis=1
    ) / np.sqrt(2.0 * np.pi)


def disc(radius, place):
    """Displacement, times E*, of places, m, by a unit pressure on a disc of a radius, m: Johnson, Contact Mechanics, 3.4."""
    ratio = place / radius
    inside = 4.0 * radius / np.pi * ellipe(np.minimum(ratio, 1.0) ** 2)
    other = np.minimum(1.0 / np.maximum(ratio, 1e-300), 1.0) ** 2
    beyond = 4.0 * place / np.pi * (ellipe(other) - (1.0 - other) * ellipkm1(np.maximum(1.0 - other, 1e-300)))
    return np.where(ratio < 1.0, inside, beyond)


def rough_sphere(sigma, separation, own):
    """Load, radius and central pressure of Greenwood and Tripp's contact; `own` takes the displacement by its own load off."""
    apex, touching = BODY + RADIUS, 1.0 / (1.0 / RADIUS + 1.0 / BODY)
    edges = np.linspace(0.0, np.sqrt(2.0 * apex * (FURTHEST * sigma - separation)), RINGS + 1)
    r, area = 0.5 * (edges[1:] + edges[:-1]), np.pi * np.diff(edges**2)
    discs = disc(edges[None, 1:], r[:, None])
    matrix = np.diff(discs, axis=1, prepend=0.0) / MODULUS
    matrix -= own * 2.0 * np.sqrt(np.pi * DENSITY) / (np.pi * MODULUS * DENSITY) * np.eye(RINGS)
    scale = 4.0 / 3.0 * DENSITY * MODULUS * np.sqrt(touching) * sigma**1.5

    def pressure(w):
        return scale * touching_moment((separation + r * r / (2.0 * apex) + w) / sigma)

    w, step = np.zeros(RINGS), 1e-4 * sigma
    for _ in range(100):
        slope = (pressure(w + step) - pressure(w - step)) / (2.0 * step)
        change = np.linalg.solve(matrix * slope - np.eye(RINGS), matrix @ pressure(w) - w)
        w -= change
        if np.max(np.abs(change)) < 1e-9 * sigma:
            break
    else:
        raise ValueError(f"no solution for {sigma} m at {separation} m")
    p = pressure(w)
    load = np.sum(p * area)
    return load, 16.0 / (3.0 * np.pi) * np.sum(p * area * r) / load, p[0]


def soft_pull_off(theta, weight):
    """The relative pull-off of asperities, of which there are `weight(x)` with heights about x standard deviations."""
    stretch = theta ** (-2.0 / 3.0)
    fold = (np.sqrt(2.0 * np.pi) / 4.0) ** (2.0 / 3.0)

    def force(d):
        def of_radius(a):
            height = d + stretch * (a * a - np.sqrt(2.0 * np.pi * a))
            load = 4.0 / 3.0 * a**3 - np.sqrt(8.0 * np.pi * a**3)
            return load * weight(height) * stretch * (2.0 * a - 0.5 * np.sqrt(2.0 * np.pi / a))

        # Contacts of heights of 9 standard deviations.
        last = 2.0 + np.sqrt(max(9.0 - d, 1.0) / stretch)
        return quad(of_radius, fold, last, limit=400, epsabs=1e-13, epsrel=1e-11)[0]

    places = np.linspace(-8.0 - 8.0 * stretch, 6.0 + 2.0 * stretch, 400)
    best = int(np.argmin([force(d) for d in places]))
    least = minimize_scalar(
        force, bounds=(places[best - 1], places[best + 1]), method="bounded", options={"xatol": 1e-8}
    )
    return -least.fun / (1.5 * np.pi)


def main():
    rows = []
    for sigma, separation in SPHERES:
        load, radius, pressure = rough_sphere(sigma, separation, 0.0)
        others = rough_sphere(sigma, separation, 1.0)[0]
        rows.append([sigma, separation, *(f"{value:.6e}" for value in (load, others, radius, pressure))])
    write(
        "greenwood_tripp.csv",
        ["sigma", "separation", "load", "load_of_others", "radius", "central_pressure"],
        rows,
    )

    def density(x):
        return np.exp(-0.5 * x * x) / np.sqrt(2.0 * np.pi)

    pulls = [
        [theta, *(f"{soft_pull_off(theta, of):.9e}" for of in (density, lambda x: ndtr(-x)))]
        for theta in THETAS
    ]
    write("fuller_tabor.csv", ["theta", "flat", "sphere"], pulls)


if __name__ == "__main__":
    main()
