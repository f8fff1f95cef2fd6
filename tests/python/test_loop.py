"""Loops and instability: what a result holds, computed again from its curves with numpy and scipy.

Needs the packages of scripts/requirements.txt. The program is $STICTION, by default target/release/stiction.
"""

import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.stats
import xarray
from program import PATCH, PROGRAM, close, run_scene

REPLICAS, SEPARATIONS = 48, 41
STIFFNESS, PRELOAD = [0.0, 1e5, 8e5, 1.2e6, 1e8], [1e-4, 1e-2, 1e3]
SCENE = f"""format = 1
title = "Test loop"

{PATCH}
[model]
law = "md_plastic"
history = "loop"

[separation]
h_star = {{ from = 0.0, to = 6.0, count = {SEPARATIONS} }}

[ensemble]
replicas = {REPLICAS}
seed = 3

[instability]
stiffness = ["0 N/m", "100 kN/m", "800 kN/m", "1.2 MN/m", "100 MN/m"]
preload = ["0.1 mN", "10 mN", "1 kN"]

[output]
curves = true
"""
WAYS = ["", "retraction_"]


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> tuple[Path, str]:
    return run_scene(tmp_path_factory.mktemp("loop"), SCENE)


@pytest.fixture(scope="module")
def file(result):
    with h5py.File(result[0], "r") as file:
        yield file


def snap(places: np.ndarray, forces: np.ndarray, stiffness: float) -> tuple[float, float, float]:
    """The largest snap on the way through the points in their order: whether, where, how far. By the running maximum of kh − F: a
    stretch below it is passed by a snap. From the first point on it would have been passed before, so it is not known."""
    sign = np.sign(places[-1] - places[0])
    level = sign * (stiffness * places - forces)
    highest = np.maximum.accumulate(level)
    below = level < highest
    found = []
    for begin in np.flatnonzero(below & ~np.r_[False, below[:-1]]):
        end = begin + np.argmax(~below[begin:]) if (~below[begin:]).any() else None
        # A level that is only met again, not passed, does not stop the surface yet.
        while end is not None and level[end] <= highest[begin]:
            later = np.flatnonzero(level[end:] > highest[begin])
            end = end + later[0] if later.size else None
        if end is None:
            found.append((places[begin - 1], np.nan))
        else:
            share = (highest[begin] - level[end - 1]) / (level[end] - level[end - 1])
            stop = places[end - 1] + share * (places[end] - places[end - 1])
            found.append((places[begin - 1], abs(stop - places[begin - 1])))
    if not found:
        return 0.0, np.nan, np.nan
    largest = max(found, key=lambda one: np.inf if np.isnan(one[1]) else one[1])
    return (np.nan, np.nan, np.nan) if largest[0] == places[0] else (1.0, *largest)


def test_both_ways_have_the_same_datasets(file):
    for group in ["ensemble", "integral", "validation", "replicas"]:
        there = {name for name in file[group] if f"retraction_{name}" in file[group]}
        back = {name.removeprefix("retraction_") for name in file[group] if name.startswith("retraction_")}
        assert there == back
        for name in there:
            assert file[group][name].shape == file[group][f"retraction_{name}"].shape
            assert file[group][name].attrs["units"] == file[group][f"retraction_{name}"].attrs["units"]
    assert file.attrs["history"] == "loop"
    assert "retraction_external_force_mean" in file["ensemble"] and "retraction_regime_count" in file["integral"]


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_opens_the_instability(result, engine):
    with xarray.open_datatree(result[0], engine=engine) as run:
        probability = run["instability"].snap_off_probability
        assert probability.dims == ("preload", "stiffness")
        assert np.allclose(probability.stiffness, STIFFNESS) and np.allclose(probability.preload, PRELOAD)
        assert run["replicas"].snap_off.dims == ("replica", "preload", "stiffness")
        assert run["ensemble"].jump_in_count_mean.dims == ("step",)


def test_ensembles_are_the_moments_of_the_replicas(file):
    for way in WAYS:
        for name in ["external_force", "adhesion_force"]:
            curves = file[f"replicas/{way}{name}"][()]
            mean, std = curves.mean(axis=0), curves.std(axis=0, ddof=1)
            assert close(file[f"ensemble/{way}{name}_mean"][()], mean, np.abs(mean).max())
            assert close(file[f"ensemble/{way}{name}_std"][()], std, std.max())
        total = file[f"ensemble/{way}regime_adhesion_force_mean"][()].sum(axis=0)
        assert close(total, file[f"ensemble/{way}adhesion_force_mean"][()], total)


def test_the_ways_begin_together_and_end_together(file):
    there, back = (file[f"replicas/{way}external_force"][()] for way in WAYS)
    scale = file["replicas/adhesion_force"][()].max()
    assert close(there[:, 0], back[:, 0], np.abs(there[:, 0]) + scale)
    # Six standard deviations away only the lowered tops tell the two apart.
    assert close(there[:, -1], back[:, -1], np.abs(there[:, -1]).max(), 0.5)
    assert np.all(file["replicas/detachment_separation"][()] < file["ensemble/separation"][-1])
    assert np.all(file["replicas/touchdown_separation"][()] > file["ensemble/separation"][0])


def test_energies_are_the_areas_of_the_loops(file):
    h, (there, back) = file["ensemble/separation"][()], (file[f"replicas/{way}external_force"][()] for way in WAYS)
    difference = there - back
    area = np.sum(0.5 * (difference[:, 1:] + difference[:, :-1]) * np.diff(h), axis=1)
    energy = file["replicas/dissipated_energy"][()]
    assert np.all(energy > 0.0) and close(energy, area, area)
    names = list(file["ensemble/scalar"].asstr()[()])
    assert close(file["ensemble/scalar_mean"][names.index("dissipated_energy")], energy.mean(), energy.mean())


def test_pull_off_is_that_of_the_retraction(file):
    h = file["ensemble/separation"][()]
    for way, name in [("retraction_", "pull_off"), ("", "approach_pull_off")]:
        curves = file[f"replicas/{way}external_force"][()]
        force, place = file[f"replicas/{name}_force"][()], file[f"replicas/{name}_separation"][()]
        assert np.all(force >= -curves.min(axis=1))
        # The curve of a small patch is jagged: between the samples it is deeper, but not another curve.
        assert np.all(force <= -1.5 * curves.min(axis=1))
        if way:
            assert np.all(np.abs(place - h[curves.argmin(axis=1)]) <= h[1] - h[0])


def test_jumps_are_the_changes_of_the_contacts(file):
    regimes = list(file["ensemble/regime"].asstr()[()])
    contact = [i for i, name in enumerate(regimes) if name not in ("noncontact", "lubricant")]
    for way, name in [("", "jump_in"), ("retraction_", "jump_off")]:
        for group, suffix in [("ensemble", "_mean"), ("integral", "")]:
            count = file[f"{group}/{way}regime_count{suffix}"][()][contact].sum(axis=0)
            jumps = file[f"{group}/{name}_count{suffix}"][()]
            assert close(jumps, -np.diff(count), count[0]) and np.all(jumps >= -1e-9)


def test_snaps_follow_the_curves(file):
    h, there = file["ensemble/separation"][()], file["replicas/external_force"][()]
    for r in range(REPLICAS):
        for i, stiffness in enumerate(STIFFNESS):
            expected = snap(h[::-1], there[r, ::-1], stiffness)
            found = [file[f"replicas/snap_in{part}"][r, i] for part in ("", "_separation", "_distance")]
            assert np.allclose(found, expected, rtol=1e-9, atol=1e-16, equal_nan=True), (r, stiffness)


def test_turns_are_where_the_preload_is_borne(file):
    h, there = file["ensemble/separation"][()], file["replicas/external_force"][()]
    turn = file["replicas/preload_separation"][()]
    for p, preload in enumerate(PRELOAD):
        for r in range(REPLICAS):
            reached = np.flatnonzero(there[r] >= preload)
            if reached.size == 0:
                assert np.isnan(turn[r, p])
                continue
            k = reached[-1]
            share = (preload - there[r, k + 1]) / (there[r, k] - there[r, k + 1])
            assert turn[r, p] == pytest.approx(h[k + 1] + share * (h[k] - h[k + 1]), rel=1e-12)
    assert list(file["instability/preload_reached_count"][()]) == [REPLICAS, REPLICAS, 0]
    assert np.all(turn[:, 1] < turn[:, 0])
    force = file["replicas/pull_off_after_preload"][()]
    # Pressed harder more flows, and what has flowed holds on to more.
    assert np.all(force[:, 1] > force[:, 0]) and np.isnan(force[:, 2]).all()
    assert close(file["instability/pull_off_after_preload_mean"][:2], force[:, :2].mean(axis=0), force[:, :2].max())
    assert close(file["instability/pull_off_after_preload_std"][:2], force[:, :2].std(axis=0, ddof=1), force[:, :2].max())


def test_probabilities_are_shares_with_their_intervals(file):
    for name in ["snap_in", "snap_off"]:
        is_one = file[f"replicas/{name}"][()]
        count, taken = (is_one == 1.0).sum(axis=0), np.isfinite(is_one).sum(axis=0)
        group = file["instability"]
        assert np.array_equal(group[f"{name}_count"], count)
        for place in np.ndindex(count.shape):
            ends = [group[f"{name}_probability{end}"][place] for end in ("", "_low", "_high")]
            if taken[place] == 0:
                assert np.isnan(ends).all()
                continue
            interval = scipy.stats.binomtest(int(count[place]), int(taken[place])).proportion_ci(method="exact")
            assert ends == pytest.approx([count[place] / taken[place], interval.low, interval.high], abs=1e-12)
    # A constant load pulls the surfaces in from beyond the separations, and lets them snap off; nothing that stiff does.
    assert np.all(np.isnan(file["replicas/snap_in"][:, 0])) and np.all(file["replicas/snap_in"][:, -1] == 0.0)
    assert np.all(file["replicas/snap_off"][:, 1, 0] == 1.0) and np.all(file["replicas/snap_off"][:, 1, -1] == 0.0)
    assert np.all(np.isnan(file["replicas/snap_off_distance"][:, 1, 0])), "nothing stops a constant load"
    assert np.array_equal(file["instability/fly_off_count"][:, 0], [REPLICAS, REPLICAS, 0])
    pulled = file["replicas/pull_off_after_preload_separation"][:, 1]
    off = file["replicas/snap_off_separation"][:, 1, 0]
    # A snap begins at the deepest sample, the pull-off may be a jump between two others.
    step = file["ensemble/separation"][1] - file["ensemble/separation"][0]
    assert np.mean(np.abs(pulled - off) <= 1.01 * step) > 0.9


def test_the_joint_test_looks_at_both_ways(file):
    forces = ["adhesion_force", "external_force"]
    score = 0.0
    for way in WAYS:
        for name in forces:
            difference = file[f"ensemble/{way}{name}_mean"][()] - file[f"integral/{way}{name}"][()]
            score = score + file[f"validation/{way}probe_{name}"][()] @ difference
            z = file[f"validation/{way}z_{name}"][()]
            error = file[f"integral/{way}{name}_std"][()] / np.sqrt(REPLICAS)
            assert close(z, difference / error, 1.0, 1e-6)
    assert np.any(file["validation/retraction_probe_external_force"][()] != 0.0)
    statistic = REPLICAS * score @ score
    assert file["validation"].attrs["statistic"] == pytest.approx(statistic, rel=1e-6)
    assert file["validation"].attrs["verdict"] == "agree"  # a false alarm once in 1000; the seed is fixed


def test_validate_and_summary_speak_of_both_ways(result):
    path, summary = result
    validate = subprocess.run([PROGRAM, "validate", path], capture_output=True, text=True)
    assert validate.returncode == 0 and "on retraction" in validate.stdout
    for part in ["md_plastic on loop", "per cycle: mean", "snap-in", "snap-off", "after a preload", "no patch reaches it"]:
        assert part in summary, part
    check = subprocess.run([PROGRAM, "check", path.parent / "scene.toml"], capture_output=True, text=True)
    assert "held by" in check.stdout and "3 values from 100.0 µN to 1.000 kN" in check.stdout
    info = subprocess.run([PROGRAM, "info", path], capture_output=True, text=True)
    assert info.returncode == 0 and "snap_off_probability" in info.stdout


@pytest.mark.parametrize("path_name, has, lacks", [("approach", "in", "off"), ("retraction", "off", "in")])
def test_one_way_snaps_one_way(tmp_path, path_name, has, lacks):
    text = SCENE.replace('"loop"', f'"{path_name}"').replace('preload = ["0.1 mN", "10 mN", "1 kN"]\n', "")
    path, _ = run_scene(tmp_path, text)
    with h5py.File(path, "r") as file:
        assert f"snap_{has}" in file["replicas"] and f"snap_{lacks}" not in file["replicas"]
        h, force = file["ensemble/separation"][()], file["replicas/external_force"][()]
        order = slice(None, None, -1) if has == "in" else slice(None)
        for i, stiffness in enumerate(STIFFNESS):
            place = (0, i) if has == "in" else (0, 0, i)
            found = [file[f"replicas/snap_{has}{part}"][place] for part in ("", "_separation", "_distance")]
            assert np.allclose(found, snap(h[order], force[0, order], stiffness), rtol=1e-9, equal_nan=True)
        if has == "off":
            assert np.isnan(file["replicas/preload"][()]).all()


@pytest.mark.slow
def test_short_snaps_need_not_count(tmp_path, file):
    """0.5 nm is two steps and a half: what is shorter is none, and what is longer is as it was."""
    path, _ = run_scene(tmp_path, SCENE.replace("preload = [", 'smallest_snap = "0.5 nm"\npreload = ['))
    check = subprocess.run([PROGRAM, "check", path.parent / "scene.toml"], capture_output=True, text=True)
    assert "of at least 500.0 pm" in check.stdout
    with h5py.File(path, "r") as other:
        assert other["instability"].attrs["smallest_snap"] == 0.5e-9
        for name in ["snap_in", "snap_off"]:
            is_one, distance = file[f"replicas/{name}"][()], file[f"replicas/{name}_distance"][()]
            counts = (is_one == 1.0) & ~(distance < 0.5e-9)
            assert np.array_equal(other[f"replicas/{name}"][()] == 1.0, counts)
            assert np.array_equal(other[f"replicas/{name}_distance"][()][counts], distance[counts], equal_nan=True)
            assert 0 < counts.sum() < (is_one == 1.0).sum()
