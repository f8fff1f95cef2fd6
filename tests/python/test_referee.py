"""The references of coupled asperities: what the files say of themselves, and the boundary-element package that made them.

tamaas (AGPL) is for this alone: `python -m pip install --only-binary :all: tamaas==2.9.0`.
"""

import json
import sys

import numpy as np
import pytest
from program import PROGRAM, ROOT

sys.path.insert(0, str(ROOT / "scripts"))
from coupled_asperities import LAWS, Asperities, Long, State, green_matrix, solve, solve_contact, stability  # noqa: E402
from referee import (  # noqa: E402
    ADHESIVE_ORDER,
    MODULUS,
    ORDER,
    adhesive_state,
    contacts_of,
    program_states,
    states_of,
    three_grids,
)

DATA = ROOT / "tests" / "data"
COUPLING, LIMITS, BEM, REFEREE = (
    json.loads((DATA / f"{name}.json").read_text()) for name in ("coupling", "coupling_limits", "coupled_bem", "referee")
)


@pytest.fixture
def elements():
    pytest.importorskip("tamaas", reason="tamaas is not installed: it has wheels for CPython on x86_64 Linux only")
    import boundary_elements

    return boundary_elements


@pytest.mark.parametrize("ensemble", COUPLING["ensembles"], ids=lambda e: f"{e['surface']} {e['law']} {e['coupling']}")
def test_states_meet_their_equations(ensemble):
    """In doubles: the force of the law at each approach, and the approach that all forces leave."""
    surface = COUPLING["surfaces"][ensemble["surface"]]
    asperity = Asperities(np.array(surface["radii"], Long), MODULUS, COUPLING["work_of_adhesion"], COUPLING["equilibrium_spacing"])
    green = green_matrix(surface["places"], MODULUS, surface["cell"] if ensemble["coupling"] == "periodic" else None).astype(float)
    for state in ensemble["states"]:
        approach, force = np.array(state["approaches"]), np.array(state["forces"])
        left = np.array(surface["heights"]) - state["separation"] - green @ force
        assert np.max(np.abs(left - approach)) < 1e-14 * np.max(np.abs(left) + np.abs(green @ force)) + 1e-25
        found, slope = LAWS[ensemble["law"]](asperity, approach.astype(Long))
        bound = 1e-14 * np.max(np.abs(force)) + 1e-15 * np.abs(slope) * np.max(np.abs(approach))
        rests = (approach == 0.0) & (ensemble["law"] == "dmt")
        assert np.all(np.where(rests, (found < force) & (force < 0), np.abs(found - force) < bound))


@pytest.mark.parametrize("pair", LIMITS["jkr_pairs"], ids=lambda pair: f"{pair['distance']:g} m")
def test_pairs_pull_off_where_the_closed_form_says(pair):
    """By the dense solution at the separation of pull-off, where the force is least: of point forces, and with the next orders."""
    places, heights = [[0.0, 0.0], [pair["distance"], 0.0]], np.zeros(2)
    asperity = Asperities(np.full(2, LIMITS["asperity_radius"], Long), MODULUS, LIMITS["work_of_adhesion"])
    start, jkr = np.full(2, -pair["single_separation"], Long), LAWS["jkr"]
    for step, exact in ((0.0, True), (1e-13, False), (-1e-13, False)):
        separation = pair["point_separation"] + step
        point = float(solve(jkr, asperity, heights, green_matrix(places, MODULUS, None), separation, start).force[0])
        separation = pair["contact_separation"] + step
        contact = float(solve_contact(jkr, asperity, heights, places, None, separation, start)[0].force[0])
        for force, pull_off in ((point, pair["point_pull_off"]), (contact, pair["contact_pull_off"])):
            assert -force == pytest.approx(pull_off, rel=1e-12) if exact else -pull_off < force < -pull_off * (1 - 1e-5)
    share = (pair["single_radius"] / pair["distance"]) ** 3
    assert pair["contact_pull_off"] / pair["point_pull_off"] - 1 == pytest.approx(2 / (3 * np.pi) * share, rel=0.5 * share + 1e-9)


@pytest.mark.parametrize("row", LIMITS["lattice"]["states"][:-2], ids=lambda row: f"{row['radius']:g} m")
def test_the_lattice_is_solved_densely_too(row):
    cell, asperity = LIMITS["lattice"]["cell"], Asperities(np.full(1, LIMITS["asperity_radius"], Long), MODULUS)
    start, place, hertz = np.full(1, row["radius"] ** 2 / LIMITS["asperity_radius"], Long), [[0.0, 0.0]], LAWS["hertz"]
    point = solve(hertz, asperity, np.zeros(1), green_matrix(place, MODULUS, cell), row["point_separation"], start).force[0]
    contact, radius = solve_contact(hertz, asperity, np.zeros(1), place, cell, row["contact_separation"], start)
    assert float(point) == pytest.approx(row["point_force"], rel=1e-12)
    assert float(contact.force[0]) == pytest.approx(row["contact_force"], rel=1e-12)
    assert float(radius[0]) == pytest.approx(row["radius"], rel=1e-12)


@pytest.mark.parametrize("pair", LIMITS["folds"], ids=lambda pair: f"{pair['distance']:g} m")
def test_pairs_jump_where_stability_ends(pair):
    asperity = Asperities(np.full(2, pair["radius"], Long), MODULUS, pair["work_of_adhesion"], LIMITS["equilibrium_spacing"])
    green, law = green_matrix([[0.0, 0.0], [pair["distance"], 0.0]], MODULUS, None), LAWS["idmt"]
    for jump in (pair["jump_in"], pair["jump_off"]):
        for side in ("before", "after"):
            approach = np.full(2, jump[f"approach_{side}"], Long)
            state = State(jump["separation"], approach, law(asperity, approach)[0])
            assert np.max(np.abs(approach + jump["separation"] + green @ state.force)) < 1e-15 * LIMITS["equilibrium_spacing"]
            assert float(state.force[0]) == pytest.approx(jump[f"force_{side}"], rel=1e-13)
            left = stability(law, asperity, green, state)
            assert abs(left) < 1e-12 if side == "before" else left > 0.1
        assert jump["energy_lost"] > 0


def test_two_origins_say_the_same():
    """The boundary elements of both files, the dense solution and the order of (a/L)^3."""
    for state, other in zip(BEM["states"], REFEREE["paraboloids"]["twelve"]["states"]):
        largest = max(other["loads"])
        assert np.max(np.abs(np.array(state["loads"]) - other["loads"])) < 3e-4 * largest  # 512 x 512 points, not extrapolated
        assert np.max(np.abs(np.array(state["coupled_loads"]) - other["loads"])) < 1e-3 * largest
        assert abs(state["coupled_separation"] - other["separation"]) < 1e-11
    one = REFEREE["paraboloids"]["one"]
    for row in one["states"][1:4]:
        point, contact = (states_of(one, [row["separation"]], kind)[0].force[0] for kind in ("point", "contact"))
        ratio = (row["area"] / np.pi / one["cell"] ** 2) ** 1.5  # (a/L)^3
        assert abs(contact / row["force"] - 1) < 0.05 * abs(point / row["force"] - 1)
        assert 0.9 < (point / row["force"] - 1) / (-LIMITS["lattice"]["order_three"] * ratio) < 2.5


@pytest.mark.parametrize("part, law", [("paraboloids", "gw"), ("adhesive", "md_kim"), ("probes", "gw")])
def test_the_program_has_the_independent_force_and_area(part, law):
    """To the roundings of its separations, which are a nanometre higher than those of the surface."""
    name = {"paraboloids": "thirty", "adhesive": "four", "probes": "fine"}[part]
    surface = REFEREE[part][name]
    separations = [row["separation"] for row in surface["states"]]
    if part != "adhesive":
        met = contacts_of(surface) if part == "probes" else surface
        expected = states_of(met, separations, "independent")
        areas = [float(np.sum(np.pi * np.array(met["radii"]) * np.maximum(state.approach, 0))) for state in expected]
    else:
        expected = [adhesive_state(surface, separation, False) for separation in separations]
        areas = None
    found = program_states(PROGRAM, surface, separations, law, None)
    for index, (state, row) in enumerate(zip(expected, found)):
        assert row["external_force"] == pytest.approx(float(state.force.sum()), rel=1e-11)
        assert areas is None or row["contact_area"] == pytest.approx(areas[index], rel=1e-11)


@pytest.mark.parametrize("name", ["twelve", "thirty", "two hundred"])
def test_the_program_has_the_loads_of_the_referee(name):
    """Where less than 2 % of the area are in contact: each load to 1e-3 of the largest, and that of point forces to 1e-9."""
    surface = REFEREE["paraboloids"][name]
    rows = [row for row in surface["states"] if row["area"] < 0.02 * surface["cell"] ** 2]
    assert rows
    separations = [row["separation"] for row in rows]
    point = states_of(surface, separations, "point")
    for row, dense, found in zip(rows, point, program_states(PROGRAM, surface, separations, "gw", "tolerance = 1e-10")):
        largest = max(row["loads"])
        assert np.max(np.abs(found["loads"] - row["loads"])) < 1e-3 * largest
        assert np.max(np.abs(found["loads"] - dense.force.astype(float))) < 1e-9 * largest


@pytest.mark.parametrize("kernel, error", [("point", 1.2e-3), ("contact", 2e-4)])
@pytest.mark.parametrize("name", ["coarse", "fine"])
def test_the_program_has_the_probes_of_the_referee(name, kernel, error):
    """Rough spheres: each load, and their sum relative to it, to what contacts leave out; loads of point forces to 1e-9."""
    surface = REFEREE["probes"][name]
    separations = [row["separation"] for row in surface["states"]]
    found = program_states(PROGRAM, surface, separations, "gw", f'kernel = "{kernel}"\ntolerance = 1e-10')
    dense = states_of(contacts_of(surface), separations, kernel)
    for row, own, state in zip(surface["states"], found, dense):
        largest = max(row["loads"])
        assert np.max(np.abs(own["loads"] - row["loads"])) < error * largest
        assert own["external_force"] == pytest.approx(row["force"], rel=error)
        if kernel == "point":
            assert np.max(np.abs(own["loads"] - state.force.astype(float))) < 1e-9 * largest


def test_the_program_has_the_adhesive_probe_of_the_referee():
    """Point forces with the adhesion of Maugis under a sphere, to what separations round off; the referee to 0.5 %."""
    surface = REFEREE["probes"]["coarse"]
    (row,) = surface["adhesive_states"]
    (found,) = program_states(PROGRAM, surface, [row["separation"]], "md_kim", "tolerance = 1e-10")
    state = adhesive_state(contacts_of(surface), row["separation"])
    assert np.max(np.abs(found["loads"] - state.force.astype(float))) < 1e-9 * row["force"]
    assert np.max(np.abs(found["loads"] - row["loads"])) < 5e-3 * max(row["loads"])
    assert found["external_force"] == pytest.approx(row["force"], rel=5e-3)


@pytest.mark.parametrize("name", ["two", "four"])
def test_the_program_has_the_adhesive_spheres_of_the_referee(name):
    """Point forces with the adhesion of Maugis, to what separations a nanometre higher round off; the referee to its own error and theirs."""
    surface = REFEREE["adhesive"][name]
    separations = [row["separation"] for row in surface["states"]]
    largest = max(abs(row["force"]) for row in surface["states"])
    for row, found in zip(surface["states"], program_states(PROGRAM, surface, separations, "md_kim", "tolerance = 1e-10")):
        dense = float(adhesive_state(surface, row["separation"]).force.sum())
        assert found["external_force"] == pytest.approx(dense, abs=1e-9 * largest)
        assert found["external_force"] == pytest.approx(row["force"], abs=row["force_error"] + 0.01 * largest)


@pytest.mark.parametrize("tops", ["summits", pytest.param("map_summits", marks=pytest.mark.slow)])
def test_the_program_has_the_summits_of_the_map(tops):
    """Each load of coupled summits of radii of their own as the dense solution has it."""
    surface, rows = REFEREE["map"][tops], REFEREE["map"]["states"][:2]
    surface = {**surface, "reduced_modulus": MODULUS}
    separations = [row["separation"] for row in rows]
    point = states_of(surface, separations, "point")
    for dense, found in zip(point, program_states(PROGRAM, surface, separations, "gw", "tolerance = 1e-10")):
        force = dense.force.astype(float)
        assert np.max(np.abs(found["loads"] - force)) < 1e-9 * np.max(force)


def test_the_referee_says_it_again(elements):
    """One small surface on three grids."""
    one = REFEREE["paraboloids"]["one"]
    row = one["states"][1]
    again = three_grids(lambda heights, owner: elements.press(heights, owner, one["cell"], MODULUS, row["pressure"]),
                        lambda points, shift: elements.paraboloids(one, points, shift), 128, ORDER)
    assert again["separation"] == pytest.approx(row["separation"], rel=1e-7)
    assert again["area"] == pytest.approx(row["area"], rel=1e-3)


@pytest.mark.slow
def test_the_referee_says_larger_ones_again(elements):
    """A rough sphere on three grids, without and with adhesion, and the twelve paraboloids on one."""
    probe = REFEREE["probes"]["coarse"]
    adhesion = probe["work_of_adhesion"], probe["theoretical_stress"]
    for (row, *_), points, order, adhesion, error in [(probe["states"], 64, ORDER, (), 1e-4),
                                                      (probe["adhesive_states"], 32, ADHESIVE_ORDER, adhesion, 5e-3)]:
        again = three_grids(
            lambda heights, owner: elements.press_alone(heights, owner, probe["cell"], MODULUS, row["force"], *adhesion),
            lambda points, shift: elements.under_sphere(probe, points, shift), points, order)
        assert again["separation"] == pytest.approx(row["separation"], rel=error)
    twelve, state = REFEREE["paraboloids"]["twelve"], BEM["states"][0]
    found = elements.press(*elements.paraboloids(twelve, BEM["grid"], 0.0), BEM["cell"], MODULUS, state["pressure"], 1e-12)
    assert found.separation == pytest.approx(state["bem_mean_displacement"], rel=1e-9)
    assert np.max(np.abs(found.loads - state["loads"])) < 1e-9 * max(state["loads"])
