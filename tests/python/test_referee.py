"""The references of coupled asperities: what the files say of themselves, and the boundary-element package that made them.

tamaas (AGPL) is for this alone: `python -m pip install --only-binary :all: tamaas==2.9.0`.
"""

import json
import sys

import numpy as np
import pytest
from program import PROGRAM, ROOT

sys.path.insert(0, str(ROOT / "scripts"))
from coupled_asperities import LAWS, Asperities, Long, green_matrix  # noqa: E402
from referee import MODULUS, ORDER, adhesive_state, program_states, states_of, three_grids  # noqa: E402

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


@pytest.mark.parametrize("part, law", [("paraboloids", "gw"), ("adhesive", "md_kim")])
def test_the_program_has_the_independent_force_and_area(part, law):
    """To the roundings of its separations, which are a nanometre higher than those of the surface."""
    name = {"paraboloids": "thirty", "adhesive": "four"}[part]
    surface = REFEREE[part][name]
    separations = [row["separation"] for row in surface["states"]]
    if part == "paraboloids":
        expected = states_of(surface, separations, "independent")
        areas = [float(np.sum(np.pi * np.array(surface["radii"]) * np.maximum(state.approach, 0))) for state in expected]
    else:
        expected = [adhesive_state(surface, separation, False) for separation in separations]
        areas = None
    found = program_states(PROGRAM, surface, separations, law, None)
    for index, (state, row) in enumerate(zip(expected, found)):
        assert row["external_force"] == pytest.approx(float(state.force.sum()), rel=1e-11)
        assert areas is None or row["contact_area"] == pytest.approx(areas[index], rel=1e-11)


def test_the_referee_says_it_again(elements):
    """One small surface on three grids, and the twelve paraboloids on one."""
    one = REFEREE["paraboloids"]["one"]
    row = one["states"][1]
    again = three_grids(lambda heights, owner: elements.press(heights, owner, one["cell"], MODULUS, row["pressure"]),
                        lambda points, shift: elements.paraboloids(one, points, shift), 128, ORDER)
    assert again["separation"] == pytest.approx(row["separation"], rel=1e-7)
    assert again["area"] == pytest.approx(row["area"], rel=1e-3)
    twelve, state = REFEREE["paraboloids"]["twelve"], BEM["states"][0]
    found = elements.press(*elements.paraboloids(twelve, BEM["grid"], 0.0), BEM["cell"], MODULUS, state["pressure"], 1e-12)
    assert found.separation == pytest.approx(state["bem_mean_displacement"], rel=1e-9)
    assert np.max(np.abs(found.loads - state["loads"])) < 1e-9 * max(state["loads"])
