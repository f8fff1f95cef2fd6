"""Boundary-element solutions of surfaces on a plane that repeats, or of one alone, by the package tamaas, for
referee.py.

tamaas (L. Frérot and others, J. Open Source Softw. 5 (2020) 2121; PyPI, AGPL) solves the contact of a rough
surface with a flat elastic half-space by conjugate gradients on a regular grid, with the response of the
substrate in Fourier space; alone on a half-space it is a convolution over twice the grid. Lengths are in nm
and stresses in GPa here, so that forces are in nN; what goes in and comes out is in SI units.

Grids end in errors of the pixels at the edges of contacts. Each result is the mean over two positions of the
surface on the grid, half a pixel apart both ways, on three grids, each twice as fine as the one before; from
the last two it is extrapolated.
"""

import time
import warnings
from typing import NamedTuple

import numpy as np
import tamaas

tamaas.set_log_level(tamaas.LogLevel.error)
warnings.filterwarnings("ignore", category=DeprecationWarning)
NM, GPA = 1e-9, 1e9
SHIFTS = (0.0, 0.5)


class Solution(NamedTuple):
    """Separation of the mean planes in m, load by owner in N, contact area in m^2, time in s."""

    separation: float
    loads: np.ndarray
    area: float
    seconds: float


def paraboloids(surface, points, shift, reach = np.inf):
    """Heights in nm on the grid, and which paraboloid is the highest at each point. `shift` is in pixels.

    Of many paraboloids each is drawn as far as `reach` in m; what none reaches is as low as the lowest point
    that one does.
    """
    cell = surface["cell"] / NM
    axis, pixel = (np.arange(points) - shift) * cell / points, cell / points
    heights, owner = np.full((points, points), -np.inf), np.zeros((points, points), np.int32)
    half = min(points // 2, int(min(reach / NM / pixel, points)))
    for index, ((x, y), z, radius) in enumerate(zip(surface["places"], surface["heights"], surface["radii"])):
        near = [np.arange(half * 2 if half * 2 < points else points) + int(p / NM / pixel + shift) - half
                for p in (x, y)]
        window = np.ix_(*(values % points for values in near))
        along, across = (gap - cell * np.rint(gap / cell)
                         for gap in (axis[near[0] % points] - x / NM, axis[near[1] % points] - y / NM))
        height = z / NM - (along[:, None] ** 2 + across[None, :] ** 2) / (2 * radius / NM)
        higher = height > heights[window]
        heights[window] = np.where(higher, height, heights[window])
        owner[window] = np.where(higher, index, owner[window])
    return np.maximum(heights, heights[np.isfinite(heights)].min()), owner


def under_sphere(surface, points, shift):
    """`paraboloids` of a plane in a cell about the middle of a sphere, less the sphere's own. The cell leaves
    room around them: they repeat, the sphere does not."""
    cell, middle = surface["cell"], surface["cell"] / 2
    heights, owner = paraboloids({**surface, "places": np.add(surface["places"], middle)}, points, shift)
    squares = (((np.arange(points) - shift) * cell / points - middle) / NM) ** 2
    return heights - (squares[:, None] + squares[None, :]) / (2 * surface["body_radius"] / NM), owner


def refined(heights, times):
    """A periodic map on a grid that is finer by a whole number, by its Fourier series."""
    count = len(heights)
    transformed, half = np.fft.fft2(heights), count // 2
    finer = np.zeros((count * times, count * times), complex)
    low, high = slice(0, half), slice(-half, None)
    for rows in (low, high):
        for columns in (low, high):
            finer[rows, columns] = transformed[rows, columns]
    return np.fft.ifft2(finer).real * times**2


def contact_area(pressed, pixel):
    """Area of the points under pressure, less that of their edges: V. A. Yastrebov and others, Tribol. Int.
    114 (2017) 161."""
    edge = sum(int(np.sum(pressed != np.roll(pressed, 1, axis))) for axis in (0, 1))
    return (float(pressed.sum()) - (np.pi - 1 + np.log(2)) / 24 * edge) * pixel**2


def model_of(points, cell, modulus):
    model = tamaas.Model(tamaas.model_type.basic_2d, [cell / NM] * 2, [points] * 2)
    model.E, model.nu = modulus / GPA, 0.0
    return model


def press(heights, owner, cell, modulus, pressure, tolerance = 1e-10):
    """Without adhesion under a mean pressure in Pa."""
    model, pixel = model_of(len(heights), cell, modulus), cell / len(heights)
    begin = time.perf_counter()
    solver = tamaas.PolonskyKeerRey(model, heights, tolerance)
    solver.max_iter = 10000
    if not solver.solve(pressure / GPA) <= tolerance:
        raise ValueError(f"tamaas does not settle at {pressure} Pa")
    seconds = time.perf_counter() - begin
    traction = np.array(model.traction) * GPA
    loads = np.bincount(owner.ravel(), traction.ravel()) * pixel**2
    separation = float(np.mean(np.array(model.displacement))) * NM
    return Solution(separation, loads, contact_area(traction > 0, pixel), seconds)


def press_alone(heights, owner, cell, modulus, force, work = 0.0, stress = 0.0):
    """Alone on a half-space under a force in N, the separation being that from the half-space far away; with
    the adhesion of Maugis if a theoretical stress is given.

    The stress acts where the gap is below work/stress, from nowhere on until these points stay. What is left
    is a contact without adhesion on heights that are higher by what the stress lifts.
    """
    model, pixel, begin = model_of(len(heights), cell, modulus), cell / len(heights), time.perf_counter()
    tamaas.ModelFactory.registerNonPeriodic(model, "alone")
    respond, lifted, pulled = model.operators["alone"], np.zeros(heights.shape), np.zeros(heights.shape, bool)
    tolerance = 1e-7 if stress else 1e-10
    while True:
        solver = tamaas.PolonskyKeerRey(model, heights + lifted, tolerance)
        solver.setIntegralOperator("alone")
        solver.max_iter = 10000
        if not solver.solve(force / (GPA * cell**2) + stress / GPA * float(pulled.mean())) <= tolerance:
            raise ValueError(f"tamaas does not settle at {force} N")
        near = (np.array(model["gap"]) * NM * stress < work) & (stress > 0)
        if np.array_equal(near, pulled):
            break
        pulled = near
        respond(pulled * stress / GPA, lifted)
    sunk = np.zeros(heights.shape)
    respond(np.array(model.traction), sunk)
    separation = float(np.mean(np.array(model.displacement) - sunk)) * NM
    traction = np.array(model.traction) * GPA
    loads = np.bincount(owner.ravel(), (traction - stress * pulled).ravel()) * pixel**2
    return Solution(separation, loads, contact_area(traction > 0, pixel), time.perf_counter() - begin)


def hold(heights, owner, cell, modulus, work, stress, separation):
    """With the adhesion of Maugis, the theoretical stress up to the gap work/stress, at a separation in m."""
    model, pixel, tolerance = model_of(len(heights), cell, modulus), cell / len(heights), 1e-7
    gaps = tamaas.PolonskyKeerRey.gap
    solver = tamaas.PolonskyKeerRey(model, heights, tolerance, gaps, gaps)
    solver.max_iter = 10000
    adhesion = tamaas.MaugisAdhesionFunctional(heights)
    adhesion.parameters = {"rho": work / stress / NM, "surface_energy": work / (GPA * NM)}
    solver.addFunctionalTerm(adhesion)
    begin = time.perf_counter()
    if not solver.solve(separation / NM - float(heights.mean())) <= tolerance:
        raise ValueError(f"tamaas does not settle at the separation {separation}")
    seconds = time.perf_counter() - begin
    traction = np.array(model.traction) * GPA
    loads = np.bincount(owner.ravel(), traction.ravel()) * pixel**2
    return Solution(separation, loads, contact_area(np.array(model["gap"]) <= 0.0, pixel), seconds)


def over_shifts(solve, surface_at):
    """The mean of the solutions of a surface over its positions on the grid; `surface_at(shift)` gives
    heights and owners."""
    found = [solve(*surface_at(shift)) for shift in SHIFTS]
    return Solution(*(np.mean([getattr(one, name) for one in found], axis=0) for name in Solution._fields))


def extrapolated(coarse, middle, fine, order):
    """The limit of fine grids by an order, how far it is from the finest, and the order that the three grids
    show."""
    coarse, middle, fine = (np.asarray(value, float) for value in (coarse, middle, fine))
    limit = fine + (fine - middle) / (2.0**order - 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        seen = np.log2(np.abs((coarse - middle) / (middle - fine)))
    return limit, np.abs(limit - fine), seen
