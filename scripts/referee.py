"""Surfaces solved by a boundary-element package that is not ours, tamaas, extrapolated in the grid
(boundary_elements.py).

Usage: python scripts/referee.py [paraboloids adhesive map times]      writes tests/data/referee.json, 20
minutes in all

* `paraboloids`: spheres of one radius on a plane that repeats, under mean pressures;
* `adhesive`: two and four of them with the adhesion of Maugis (the stress up to the gap work/stress), at
  separations;
* `map`: the shipped map without its tilt, refined by its Fourier series, and its summits;
* `times`: what tamaas took, by grid, at the error of the total force.

Parts that are not named stay as they are. The asperities of the program and of coupled_asperities.py on these
surfaces are below, for plot_referee.py and the tests.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from coupled_asperities import (
    Asperities, Long, dugdale, follow, green_matrix, hertz, solve, solve_contact, steps,
)  # fmt: skip
from fixtures import DATA
from reference_coupling import hard_core, text
from synthesise_map import MAP, PIXEL, TILT

FILE = DATA / "referee.json"
MODULUS = 85.29e9  # Pa
ORDER, ADHESIVE_ORDER = 2.0, 1.0  # of the extrapolation in the grid
PRESSURES = {"twelve": (256, [1e6, 5e6, 2e7]), "thirty": (256, [5e6, 2e7, 5e7, 1e8]),
             "two hundred": (256, [2e6, 1e7, 5e7]),
             "one": (128, [4.27e6, 3.41e7, 1.15e8, 2.73e8, 5.33e8, 9.22e8])}
STRESS = 1.03 * 0.09 / 0.2e-9  # Pa, of case II
SEPARATIONS = [-4e-10, -2e-10, 0.0, 1e-10]
SPHERES = {
    "two": {"cell": 6e-7, "places": [[2e-7, 2.5e-7], [3.5e-7, 3e-7]], "heights": [0.0, -1e-10]},
    "four": {"cell": 6e-7, "places": [[1.2e-7, 1.1e-7], [4e-7, 1.4e-7], [2.1e-7, 3.6e-7], [4.6e-7, 4.1e-7]],
             "heights": [0.0, -1e-10, 5e-11, -5e-11]},
}
MAP_PRESSURES = [2e6, 1e7, 5e7, 2e8]


# --- Surfaces


def surfaces():
    """The paraboloids that are solved."""
    drawn = json.loads((DATA / "coupling.json").read_text())["surfaces"]
    twelve = json.loads((DATA / "coupled_bem.json").read_text())
    twelve = {"cell": twelve["cell"], "places": twelve["x"], "heights": twelve["z"],
              "radii": [twelve["radius"]] * len(twelve["z"])}
    return {"twelve": twelve, **{name: drawn[name] for name in ("thirty", "two hundred", "one")}}


def level_map():
    """Heights of the shipped map in m without its tilt, so that it is periodic, rows along x; and its side in
    m."""
    heights = np.loadtxt(MAP).T
    heights -= TILT * PIXEL * np.arange(len(heights))[:, None]
    return (heights - heights.mean()) * 1e-9, PIXEL * len(heights) * 1e-6


def summits(heights, cell):
    """Points that are higher than their eight neighbours, over the border too; radii from second differences,
    as the program has them."""
    pixel = cell / len(heights)
    around = [np.roll(heights, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    highest = np.all([heights > other for other in around], axis=0)
    curvature = -sum(np.roll(heights, 1, axis) - 2 * heights + np.roll(heights, -1, axis)
                     for axis in (0, 1)) / (2 * pixel**2)
    x, y = np.nonzero(highest)
    return {"cell": cell, "places": np.stack([x, y], 1) * pixel, "heights": heights[highest],
            "radii": 1 / curvature[highest]}


# --- Fixtures


def three_grids(solve, surface_at, coarsest, order):
    """Loads, area and separation extrapolated from three grids, with their distance from the finest and the
    orders seen."""
    import boundary_elements as be

    found = [be.over_shifts(solve, lambda shift, n=coarsest * 2**k: surface_at(n, shift)) for k in range(3)]
    row = {"points": coarsest * 4, "seconds": found[-1].seconds}
    for name in ("separation", "loads", "area"):
        limit, error, seen = be.extrapolated(*(getattr(one, name) for one in found), order)
        row[name], row[f"{name}_error"] = limit.tolist(), float(np.max(error))
        if name == "loads":
            totals = be.extrapolated(*(float(np.sum(one.loads)) for one in found), order)
            row["force"], row["force_error"] = float(totals[0]), float(totals[1])
            seen = totals[2]
        row[f"{name}_order"] = float(seen) if np.isfinite(seen) else None
    return row


def paraboloids():
    import boundary_elements as be

    rows = {}
    for name, surface in surfaces().items():
        coarsest, pressures = PRESSURES[name]
        states = []
        for pressure in pressures:
            print(name, pressure, file=sys.stderr, flush=True)
            states.append({"pressure": pressure, **three_grids(
                lambda heights, owner, p=pressure: be.press(heights, owner, surface["cell"], MODULUS, p),
                lambda points, shift: be.paraboloids(surface, points, shift), coarsest, ORDER)})
        rows[name] = {**surface, "reduced_modulus": MODULUS, "states": states}
    return rows


def adhesive():
    import boundary_elements as be

    rows = {}
    for name, surface in SPHERES.items():
        surface = {**surface, "radii": [3.33e-6] * len(surface["heights"])}
        states = []
        for separation in SEPARATIONS:
            print(name, separation, file=sys.stderr, flush=True)
            states.append(three_grids(
                lambda heights, owner,
                d=separation: be.hold(heights, owner, surface["cell"], MODULUS, 0.09, STRESS, d),
                lambda points, shift: be.paraboloids(surface, points, shift), 128, ADHESIVE_ORDER))
        material = {"reduced_modulus": MODULUS, "work_of_adhesion": 0.09, "theoretical_stress": STRESS}
        rows[name] = {**surface, **material, "states": states}
    return rows


def whole_map():
    """The map on grids 1, 2 and 4 times as fine; its summits are from the finest, which the coarse pixels
    cut off."""
    import boundary_elements as be

    heights, cell = level_map()
    states = []
    for pressure in MAP_PRESSURES:
        print("map", pressure, file=sys.stderr, flush=True)
        found = []
        for times in (1, 2, 4):
            fine = be.refined(heights, times) / be.NM
            found.append(be.press(fine, np.zeros(fine.shape, int), cell, MODULUS, pressure))
        row = {"pressure": pressure}
        for name in ("separation", "area"):
            limit, error, seen = be.extrapolated(*(getattr(one, name) for one in found), ORDER)
            row[name], row[f"{name}_error"], row[f"{name}_order"] = float(limit), float(error), float(seen)
        states.append(row)
    tops = {"summits": summits(be.refined(heights, 4), cell), "map_summits": summits(heights, cell)}
    return {"reduced_modulus": MODULUS, **tops, "states": states}


def case_ii():
    """Asperities, as many as case II has, 7390 on 1000 um^2."""
    rng, side = np.random.Generator(np.random.PCG64(21)), 3.1622777e-5
    places = hard_core(rng, 7390, side, 0.184e-6)
    heights = 1.6e-9 * rng.standard_normal(len(places))
    return {"cell": side, "places": places, "heights": heights, "radii": [3.33e-6] * len(places)}


def times():
    """One state by grid: seconds of one solution, and its error of the total force at equal separation
    against the finest grids."""
    import boundary_elements as be

    rows, pressure = [], 1e7
    hundreds = surfaces()["two hundred"]
    for name, surface, grids in [("two hundred", hundreds, (128, 256, 512, 1024, 2048)),
                                 ("case II", case_ii(), (512, 1024, 2048))]:
        drawn, found = {points: be.paraboloids(surface, points, 0.0, 1e-6) for points in grids}, []
        for points in grids:
            print("times", name, points, file=sys.stderr, flush=True)
            found.append(be.press(*drawn[points], surface["cell"], MODULUS, pressure, 1e-8))
        true = float(be.extrapolated(*(one.separation for one in found[-3:]), ORDER)[0])
        near = be.press(*drawn[grids[1]], surface["cell"], MODULUS, 1.01 * pressure, 1e-8).separation
        slope = np.log(1.01) / (near - found[1].separation)  # of the logarithm of the force
        grids = [{"points": n, "seconds": one.seconds, "force_error": abs((one.separation - true) * slope)}
                 for n, one in zip(grids, found)]
        rows.append({"surface": name, "asperities": len(surface["heights"]), "pressure": pressure,
                     "grids": grids})
    return rows


# --- Asperities


def states_of(surface, separations, kind):
    """States of Hertz asperities at separations that fall: `point` forces, with the next orders (`contact`),
    or `independent`."""
    asperity = Asperities(np.array(surface["radii"], Long), MODULUS)
    green = green_matrix(surface["places"], MODULUS, surface["cell"]) * (kind != "independent")
    places = [max(surface["heights"]), *separations]
    path = places[:1] + [d for a, b in zip(places, places[1:]) for d in steps(a, b, 4e-10)[1:]]
    states = {state.separation: state for state in follow(hertz, asperity, surface["heights"], green, path)}
    if kind == "contact":
        for d in separations:
            states[d] = solve_contact(hertz, asperity, surface["heights"], surface["places"], surface["cell"],
                                      d, states[d].approach)[0]
    return [states[d] for d in separations]


def adhesive_state(surface, separation, coupled = True):
    """State of spheres of Maugis and Dugdale on the way down: each touches where the stress begins to reach
    it, at Delta = -2/(pi lambda)."""
    asperity = Asperities(np.array(surface["radii"], Long), MODULUS, surface["work_of_adhesion"])
    reach = asperity.work / surface["theoretical_stress"]  # nothing acts across a wider gap
    green = green_matrix(surface["places"], MODULUS, surface["cell"]) * coupled
    inner, heights = dugdale(surface["theoretical_stress"]), np.array(surface["heights"], Long)
    touched, delta = heights - Long(separation) >= -reach, heights - Long(separation) + Long(1e-10)

    def law(asperity, delta):
        force, slope = inner(asperity, delta)
        return force * touched, slope * touched

    state = solve(law, asperity, heights, green, separation, delta)
    if np.any(state.approach[~touched] >= -reach):
        raise ValueError(f"another sphere touches at {separation} m")
    return state


# --- The program


def write_asperities(path, surface):
    """A file of asperities as `stiction asperities` writes it; what the surface around them is like is made
    up."""
    import h5py

    heights, radii, places = (np.array(surface[name], float) for name in ("heights", "radii", "places"))
    area = surface["cell"] ** 2
    mean, density = heights.mean(), len(heights) / area
    spread = heights.std(ddof=1) if len(heights) > 1 else np.nan
    groups = {
        "asperities": {"asperity": np.arange(len(heights), dtype=float), "height": heights, "radius": radii,
                       "x": places[:, 0],
                       "y": places[:, 1], "curvature_x": 1 / radii, "curvature_y": 1 / radii},
        "surface": {"m0": 1e-18, "m2": 1e-4, "m4": 1e10, "slope_x": 1e-4, "slope_y": 1e-4, "alpha": 100.0,
                    "skewness": 0.0,
                    "excess_kurtosis": 0.0},
        "measured": {"asperity_density": density, "asperity_radius": 1 / np.mean(1 / radii),
                     "asperity_height_mean": mean,
                     "asperity_height_std": spread, "asperity_curvature_std": 0.0},
        "equivalent": {"asperity_density": density, "asperity_radius": radii.mean(),
                       "asperity_height_mean": mean,
                       "asperity_height_std": spread},
    }
    with h5py.File(path, "w") as file:
        file.attrs.update(format="stiction-asperities", format_version=np.array([2, 0], np.int32),
                          nominal_area=area, mean_plane_offset=mean,
                          map_shape=np.array([1, 1], np.uint64), pixel_size=np.full(2, surface["cell"]))
        for group, datasets in groups.items():
            for name, values in datasets.items():
                file[f"{group}/{name}"] = values


SCENE = """format = 1
[material]
reduced_modulus = "85.29 GPa"
hardness = "250 GPa"
poisson_ratio = 0.27
work_of_adhesion = "0.09 J/m^2"
equilibrium_spacing = "0.2 nm"
[surface]
asperities = {{ path = "asperities.h5", sample = "whole" }}
[model]
law = "{law}"
history = "approach"
[separation]
h = {{ from = "{low!r} m", to = "{high!r} m", count = 40 }}
[ensemble]
replicas = 1
seed = 1
"""
SUBSTRATE = '[substrate]\ncoupling = "periodic"\nloads_at = ["{low!r} m"]\n{more}\n'


def program_states(program, surface, separations, law = "gw", substrate = ""):
    """The program's results for a surface at separations, one run each down to it: force, area, and if
    coupled the load of each asperity.

    `substrate` is more of the table, None is without.
    """
    import h5py

    # The program wants summits above the mean plane.
    states, lift = [], max(0.0, 1e-9 - float(np.mean(surface["heights"])))
    surface = {**surface, "heights": [z + lift for z in surface["heights"]]}
    with tempfile.TemporaryDirectory() as folder:
        scene, result = Path(folder) / "scene.toml", Path(folder) / "run.h5"
        write_asperities(Path(folder) / "asperities.h5", surface)
        for separation in separations:
            high = max(surface["heights"]) + 1e-9
            text_of = SCENE.format(law=law, low=separation + lift, high=high)
            scene.write_text(text_of
                             + ("" if substrate is None
                                else SUBSTRATE.format(low=separation + lift, more=substrate)))
            result.unlink(missing_ok=True)
            run = subprocess.run([program, "run", scene, "-o", result], capture_output=True, text=True)
            if run.returncode != 0:
                raise ValueError(run.stderr.strip())
            with h5py.File(result) as file:
                states.append({name: float(file["ensemble"][f"{name}_mean"][0])
                               for name in ("external_force", "contact_area")})
                if substrate is not None:
                    states[-1]["loads"] = file["asperities/external_force"][0]
    return states


PARTS = {"paraboloids": paraboloids, "adhesive": adhesive, "map": whole_map, "times": times}


def main():
    import tamaas

    content = json.loads(FILE.read_text()) if FILE.exists() else {}
    content["origin"] = f"scripts/referee.py, tamaas {tamaas.__version__}"
    for name in sys.argv[1:] or PARTS:
        content[name] = PARTS[name]()
    FILE.write_text(text(content) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
