"""The contact of one asperity against an independent implementation of the Maugis-Dugdale model.

That is the package Adhesion (https://github.com/ContactEngineering/Adhesion), which gives the force and the approach of
a contact radius in SI units, whereas the program gives the force and the radius of a scaled approach. Only one of its
modules is needed, which imports numpy and scipy alone:

    python -m pip install --no-deps Adhesion==0.93
"""

import csv
import importlib.metadata
import runpy
import subprocess
from pathlib import Path

import numpy as np
import pytest
from program import PROGRAM
from scipy.optimize import minimize_scalar

# Run as a file: importing it as part of the package would import the package, and that all its dependencies.
MODULE = importlib.metadata.distribution("Adhesion").locate_file("Adhesion/ReferenceSolutions/MaugisDugdale.py")
load_and_displacement = runpy.run_path(str(MODULE))["load_and_displacement"]

LAMBDAS = [0.1, 0.5, 0.9, 0.95, 1.0, 2.5, 10.0]
# R in m, E_r in Pa, work of adhesion in J/m^2. K = 4/3 E_r, R and w enter every scale with another power.
GEOMETRIES = {
    "units": (1.0, 1.0, 1.0),
    "disk": (3.33e-6, 85.29e9, 0.09),
    "tip": (2.7e-8, 1.1e11, 0.43),
    "gel": (1.3e-2, 2.1e5, 0.027),
}
BEYOND = np.geomspace(1e-3, 10.0, 40)  # radii, counted from the end of the stable branch
EPSILON = np.finfo(float).eps
ROUNDINGS = 16  # epsilons per quantity: 10 that the program may add, and 6 of the scales and sums of the package


def scales(geometry) -> tuple[float, float, float, float]:
    """Units of the approach, the contact radius, the force and the stress (sigma_0 in this unit is lambda)."""
    radius, modulus, work = geometry
    k, g = 4.0 / 3.0 * modulus, np.pi * work
    length, width, stress = (x ** (1 / 3) for x in [g**2 * radius / k**2, g * radius**2 / k, g * k**2 / radius])
    return length, width, g * radius, stress / 2


def reference(lam, radii, geometry):
    """Scaled approach and external force by the package, through its SI units."""
    length, width, force, stress = scales(geometry)
    loads, approaches = load_and_displacement(np.asarray(radii) * width, *geometry, lam * stress)
    return approaches / length, loads / force


def end_of_branch(lam) -> tuple[float, float]:
    """Radius and approach where the approach is least: the fold, or else first touch, at which the radius is 0."""

    def approach(radius):
        return reference(lam, [radius], GEOMETRIES["units"])[0][0]

    touch = approach(1e-7)  # of radius 0 to 1e-7
    fold = minimize_scalar(approach, bounds=(1e-7, 4.0), method="bounded", options={"xatol": 1e-7})
    return (fold.x, fold.fun) if fold.fun < touch else (0.0, touch)


def tolerances(lam, radii, geometry):
    """How far the radius and the external force at a given approach may differ, to first order.

    The package finds m, the outer radius of the Dugdale zone over the contact radius, with scipy's brentq at its
    default tolerances: to 2e-12 + 4 epsilon m. That counts through the slopes of approach and force by m, which grow
    with lambda as 1/sqrt(m^2 - 1), and through 1/(d approach / d radius), which grows towards the end of the branch.
    The rest is rounding: of lambda, of the radius, of the terms of each sum. In it is what the program may add, which
    its own tests bound by 10 epsilon (1 + condition number).
    """
    step = 1e-5
    approach, force = reference(lam, radii, geometry)

    def slopes(variable, lower, upper):
        return [(b - a) / (2 * step * variable) for a, b in zip(lower, upper)]

    low, high = 1.0 - step, 1.0 + step
    approach_by_radius, force_by_radius = slopes(
        radii, reference(lam, radii * low, geometry), reference(lam, radii * high, geometry)
    )
    approach_by_lambda, force_by_lambda = slopes(
        lam, reference(lam * low, radii, geometry), reference(lam * high, radii, geometry)
    )
    stiffness = force_by_radius / approach_by_radius

    # approach = A^2 - 4/3 A lambda mu, force = A^3 - lambda A^2 (mu + m^2 atan(mu)), mu^2 = m^2 - 1
    mu = 0.75 * (radii**2 - approach) / (radii * lam)
    m = np.sqrt(1.0 + mu**2)
    approach_by_m = -4 / 3 * radii * lam * m / mu
    force_by_m = -2 * lam * radii**2 * m * (1.0 / mu + np.arctan(mu))
    error_of_m = 2e-12 + (4 + ROUNDINGS) * EPSILON * m

    sums = 2 * radii**2 - approach, 2 * radii**3 - force  # of the absolute values of the terms
    rounding = ROUNDINGS * EPSILON
    approach_error = rounding * (sums[0] + lam * np.abs(approach_by_lambda) + radii * np.abs(approach_by_radius))
    force_error = rounding * (sums[1] + lam * np.abs(force_by_lambda - stiffness * approach_by_lambda))
    return (
        (np.abs(approach_by_m) * error_of_m + approach_error) / np.abs(approach_by_radius),
        np.abs(force_by_m - stiffness * approach_by_m) * error_of_m + force_error + np.abs(stiffness) * approach_error,
    )


def run_program(folder: Path, lam: float, approaches) -> list[dict]:
    """Rows of the program for a table of approaches."""
    table = folder / "table.csv"
    table.write_text("lambda,delta\n" + "".join(f"{lam:.17g},{delta:.17g}\n" for delta in approaches))
    assert PROGRAM.is_file(), f"no program {PROGRAM}: run `cargo build --release` or set STICTION"
    command = [PROGRAM, "asperity", "--law", "md", "--path", "retraction", "--table", table]
    run = subprocess.run(command, capture_output=True, text=True, encoding="utf-8")
    assert run.returncode == 0, run.stderr
    rows = list(csv.DictReader(run.stdout.splitlines()))
    assert [float(row["delta"]) for row in rows] == list(approaches)
    assert {float(row["lambda"]) for row in rows} == {lam}
    return rows


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("lam", LAMBDAS)
def test_contact_is_that_of_the_package(tmp_path, lam, geometry):
    geometry = GEOMETRIES[geometry]
    radii = end_of_branch(lam)[0] + BEYOND
    approaches, forces = reference(lam, radii, geometry)
    assert np.all(np.diff(approaches) > 0.0)  # stable at given approach
    rows = run_program(tmp_path, lam, approaches)
    assert {row["branch"] for row in rows} == {"contact"}
    found, external, adhesion = (
        np.array([float(row[name]) for row in rows]) for name in ["contact_radius", "external_force", "adhesion_force"]
    )
    radius_tolerance, force_tolerance = tolerances(lam, radii, geometry)
    # The tolerances are small, and first order is enough for them.
    for relative in [radius_tolerance / radii, force_tolerance / (2 * radii**3 - forces)]:
        assert np.max(relative) < 1e-7 and np.median(relative) < 1e-9
    assert np.all(radius_tolerance < 1e-4 * BEYOND)
    for name, actual, expected, tolerance in [
        ("contact_radius", found, radii, radius_tolerance),
        ("external_force", external, forces, force_tolerance),
        ("adhesion_force", adhesion, radii**3 - forces, force_tolerance + 3 * radii**2 * radius_tolerance),
    ]:
        ratio = np.abs(actual - expected) / tolerance
        worst = np.argmax(ratio)
        where = f"{name} at delta {approaches[worst]}"
        assert ratio[worst] <= 1.0, f"{where}: {actual[worst]}, not {expected[worst]} +- {tolerance[worst]}"


@pytest.mark.parametrize("lam", LAMBDAS)
def test_contact_ends_where_the_approach_of_the_package_is_least(tmp_path, lam):
    """To 1e-6, well above what is left of first touch at the smallest radius taken."""
    radius, approach = end_of_branch(lam)
    assert (radius > 0.0) == (lam > (9 * np.pi / (16 * (np.pi - 1))) ** (1 / 3))
    before, after = run_program(tmp_path, lam, [approach - 1e-6, approach + 1e-6])
    assert before["branch"] != "contact" and float(before["contact_radius"]) == 0.0
    assert after["branch"] == "contact" and float(after["contact_radius"]) > radius
