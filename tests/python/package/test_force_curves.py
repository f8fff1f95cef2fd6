"""Force curves: of a cantilever against closed forms and the program's snaps; of files of instruments with forces, offsets and slopes that were put there."""

import io
import re
import shutil
from pathlib import Path

import afmformats
import numpy as np
import pandas as pd
import pytest
from igor2 import binarywave

import stiction
from stiction import FileError, SceneError, inference, plot
from stiction.force_curves import command, force_curve, pull_offs
from stiction.force_curves.recorded import written
from stiction.plot import command as plot_command
from stiction.tables import read

# Files of the tests of afmformats.
FILES = Path(__file__).parents[2] / "data/force_curves"
ASYLUM, PAUSED = FILES / "fmt-igor-fd_SiN_FD_plot.ibw", FILES / "fmt-jpk-sr_cell1-0008.jpk-force"
# A sphere near a flat with van der Waals forces: Hamaker constant, radius, closest distance, and the stiffness of the contact.
HAMAKER, RADIUS, CLOSEST, CONTACT = 1e-19, 1e-6, 0.3e-9, 2e3


def van_der_waals(step=2e-12, end=200e-9):
    """F = -HR/6d² down to the closest distance, and a stiff contact behind."""
    near = np.arange(-2e-9, 20e-9, step)
    d = np.concatenate([near, np.geomspace(20e-9, end, 4000)])
    outer = np.maximum(d, CLOSEST)
    return np.array([d, -HAMAKER * RADIUS / (6.0 * outer**2) + CONTACT * (outer - d)])


@pytest.mark.parametrize("stiffness", [0.5, 2.0, 40.0])
def test_a_cantilever_snaps_in_where_van_der_waals_forces_are_as_steep_as_it(stiffness):
    curve = van_der_waals()
    found = force_curve(curve, curve, stiffness)
    into, off = (found.isel(jump=np.flatnonzero(found.jump_way == way)) for way in ("approach", "retraction"))
    # HR/3d³ = k.
    at = (HAMAKER * RADIUS / (3.0 * stiffness)) ** (1.0 / 3.0)
    assert into.sizes["jump"] == off.sizes["jump"] == 1
    assert float(into.jump_separation[0]) == pytest.approx(at, abs=2e-12)
    # It lands on the contact: k d - F is there what it is at the snap, F = -HR/6d0² + s (d0 - d).
    deepest = HAMAKER * RADIUS / (6.0 * CLOSEST**2)
    level = stiffness * at + HAMAKER * RADIUS / (6.0 * at**2)
    lands = (level - deepest + CONTACT * CLOSEST) / (stiffness + CONTACT)
    assert float(into.jump_distance[0]) == pytest.approx(at - lands, abs=1e-11)
    # Pulled off at the closest distance with the force of Derjaguin's sphere, HR/6d0², and free where k d + HR/6d² has come to that.
    assert float(found.pull_off_force) == pytest.approx(deepest, rel=0.02)
    assert float(off.jump_separation[0]) == pytest.approx(CLOSEST, abs=2e-12)
    start = stiffness * CLOSEST + deepest
    stop = max(np.roots([stiffness, -start, 0.0, HAMAKER * RADIUS / 6.0]).real)
    stops = float(off.jump_separation[0] + off.jump_distance[0])
    if stop < curve[0, -1]:
        assert stops == pytest.approx(stop, rel=0.02)
    else:
        assert float(off.jump_force_after[0]) == 0.0 and stops > curve[0, -1]


@pytest.mark.parametrize("stiffness, share", [(1e-3, 3.0 / 2.0), (1e4, 5.0 / 6.0)])
def test_a_jkr_sphere_leaves_by_load_or_by_displacement(stiffness, share):
    """On a soft lever at the lowest force, -3/2 πwR, on a rigid one at the largest extension, where the force is -5/6 πwR."""
    w, r, e = 0.05, 1e-6, 1e6
    a = np.linspace(1e-9, 6e-7, 60001)
    delta = a**2 / r - np.sqrt(2.0 * np.pi * w * a / e)
    force = 4.0 * e * a**3 / (3.0 * r) - np.sqrt(8.0 * np.pi * w * e * a**3)
    stable = a >= a[delta.argmin()]
    retraction = np.array([-delta[stable], force[stable]])
    # Out of contact nothing pulls; in contact approach is as retraction.
    far = np.linspace(-delta[stable][0] * (1.0 + 1e-6), 3e-6, 50)
    retraction = np.hstack([retraction, [far, np.zeros_like(far)]])
    touches = retraction[0] < 0.0
    approach = np.array([retraction[0], np.where(touches, retraction[1], 0.0)])
    found = force_curve(approach, retraction, stiffness)
    assert float(found.pull_off_force) == pytest.approx(1.5 * np.pi * w * r, rel=1e-4)
    last = found.jump_force[found.jump_way == "retraction"].values[-1]
    assert last == pytest.approx(-share * np.pi * w * r, rel=2e-3)


def test_samples_lie_on_the_curve_and_jumps_at_one_piezo_position():
    curve = van_der_waals()
    found = force_curve(curve, curve, 2.0)
    np.testing.assert_allclose(found.piezo_position, found.separation - found.deflection, rtol=0, atol=1e-22)
    np.testing.assert_allclose(found.deflection * 2.0, found.force, rtol=1e-12)
    inside = found.separation <= curve[0, -1]
    np.testing.assert_allclose(found.force[inside], np.interp(found.separation, *curve)[inside], rtol=1e-9, atol=1e-20)
    for way, sign in (("approach", -1.0), ("retraction", 1.0)):
        piezo = found.piezo_position[found.way == way].values
        assert (sign * np.diff(piezo) >= -1e-20).all()
        for jump in np.flatnonzero(found.jump_way == way):
            at = float(found.jump_piezo_position[jump])
            assert np.isclose(piezo, at, rtol=0, atol=1e-18).sum() == 2
    for name, array in found.variables.items():
        assert name in ("way", "jump_way") or (array.attrs["long_name"] and array.attrs["units"])


def test_a_lever_that_the_separations_do_not_suit_is_refused():
    curve = van_der_waals()
    with pytest.raises(SceneError, match=r"stiffness = 1.00 µN/m: the tip has snapped in before the largest separation; .* larger h"):
        force_curve(curve, curve, 1e-6)
    outer = curve[:, curve[0] > 1e-9]
    with pytest.raises(SceneError, match=r"stiffness = 2.00 N/m: the tip snaps in beyond the smallest separation; .* smaller h"):
        force_curve(outer, outer, 2.0)
    for wrong in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(SceneError, match="a cantilever has one greater than 0"):
            force_curve(curve, curve, wrong)


@pytest.mark.parametrize("name, preload", [("spots", 1e-6), ("springs", 1e-3)])
def test_snaps_are_those_of_the_program(result, name, preload):
    run = result(name)
    replicas = run.group("replicas").sel(preload=preload).load()
    step = float(np.diff(replicas["separation"].values).max())
    # The program has the longest snap, of which there may be two alike.
    shortest, compared = float(run["instability"].attrs["smallest_snap"]) + 4.0 * step, 0
    for replica in replicas["replica"].values:
        for stiffness in (40.0,) if name == "spots" else (1e7, 3e7, 5e7):
            own = replicas.sel(replica=replica, stiffness=stiffness)
            curve = run.force_curve(float(stiffness), replica=int(replica), preload=preload)
            assert float(curve.pull_off_force) == pytest.approx(float(own["pull_off_after_preload"]), rel=1e-12)
            for way, snap in (("approach", "snap_in"), ("retraction", "snap_off")):
                begins, distance = float(own[f"{snap}_separation"]), float(own[f"{snap}_distance"])
                at, length, after = (curve[of].values[curve.jump_way == way] for of in ("jump_separation", "jump_distance", "jump_force_after"))
                if own[snap] != 1.0 or distance < shortest:
                    assert (length < shortest + 2.0 * step).all()
                    continue
                largest = int(length.argmax())
                # Folds are known to a step, and the lowest point, which is a sample of the curve here, lies within one.
                assert at[largest] == pytest.approx(begins, abs=2.0 * step)
                if np.isnan(distance):
                    assert after[largest] == 0.0
                else:
                    assert length[largest] == pytest.approx(distance, abs=2.0 * step)
                compared += 1
    assert compared >= 40


def test_a_spot_turns_at_its_preload(result):
    run = result("spots")
    for preload in (1e-6, 1e-5, 1e-4):
        curve = run.force_curve(preload=preload, replica=3)
        assert float(curve.force.max()) == pytest.approx(preload, rel=1e-12) and float(curve.preload) == preload
        # To the piezo that is its deflection and the separation there.
        turn = float(run["replicas/preload_separation"].sel(replica=3, preload=preload))
        assert float(curve.piezo_position.min()) == pytest.approx(turn - preload / 40.0, rel=1e-9)
    # By default the largest that is reached, on the one spring of the scene.
    assert float(run.force_curve(replica=3).preload) == 1e-4 and float(run.force_curve().stiffness) == 40.0
    texts = run.force_curve("0.04 kN/m", replica=3, preload="100 uN")
    assert texts.equals(run.force_curve(replica=3))


def test_forces_after_a_preload_are_those_of_a_loop_to_there(result, tmp_path):
    """The replica of a loop that ends where it reaches the preload has the forces that the file has after that preload."""
    scene = stiction.run({**CASE, "instability": {"preload": "1 mN"}, "output": {"curves": True}}, tmp_path / "turned.h5")
    after = scene["replicas/external_force_after_preload"].isel(preload=0)
    assert after.dims == ("replica", "separation")
    turn = float(scene["replicas/preload_separation"].isel(replica=1, preload=0))
    steps = [turn, *scene["replicas/separation"].values[scene["replicas/separation"].values > turn]]
    whole = stiction.run({**CASE, "separation": {"h": [f"{h!r} m" for h in map(float, steps)]}, "output": {"curves": True}}, tmp_path / "whole.h5")
    expected = whole["replicas/retraction_external_force"].isel(replica=1).values
    own = after.isel(replica=1).values
    assert np.isnan(own).sum() == own.size - (len(steps) - 1)
    np.testing.assert_allclose(own[np.isfinite(own)], expected[1:], rtol=1e-6, atol=1e-9 * abs(expected).max())


CASE = {
    "material": {"reduced_modulus": "85.29 GPa", "hardness": "2.5 GPa", "poisson_ratio": 0.27, "work_of_adhesion": "0.09 J/m^2"},
    "surface": {"asperity_radius": "3.33 um", "asperity_density": "7.39 /um^2", "surface_height_std": "1.619 nm", "nominal_area": "100 um^2"},
    "model": {"history": "loop"},
    "separation": {"h_star": {"from": -1.0, "to": 5.0, "count": 121}},
    "ensemble": {"replicas": 4, "seed": 3},
}  # fmt: skip


def test_what_a_file_does_not_have_is_said(result, tmp_path):
    with pytest.raises(FileError, match="records one spot, no mean over spots; run with curves = true in \\[output\\]"):
        result("instability").force_curve("40 N/m")
    with pytest.raises(FileError, match='went one way; a force curve needs both, history = "loop" in \\[model\\]'):
        result("curves").force_curve("40 N/m")
    run = result("spots")
    for given, message in (
        ({"replica": 20}, "replica = 20: one from 0 to 19 is needed"),
        ({"replica": -1}, "replica = -1: one from 0 to 19 is needed"),
        ({"preload": "3 uN"}, "preload = 3 uN: the file has 1.000 µN, 10.00 µN, 100.0 µN; name one of them"),
        ({"preload": "3 um"}, "preload = '3 um': a number with a unit such as N is needed"),
        ({"stiffness": "40 Pa"}, "stiffness = '40 Pa': a number with a unit such as N/m is needed"),
    ):
        with pytest.raises(SceneError, match=re.escape(message)):
            run.force_curve(**given)
    with pytest.raises(SceneError, match=r"stiffness: the scene has 10.0 MN/m, .*; name one, that of the cantilever"):
        result("springs").force_curve()
    with pytest.raises(FileError, match="reaches no preload"):
        stiction.run({**CASE, "instability": {"preload": "1 N"}, "output": {"curves": True}}, tmp_path / "far.h5").force_curve(1e9)


def test_the_figure_shows_the_samples_and_names_the_pull_off(result, tmp_path, capsys):
    run = result("spots")
    curve = run.force_curve(replica=2, preload="1 uN")
    ax = plot.force_curve(run, replica=2, preload="1 uN")
    drawn = {str(line.get_label()): line for line in ax.lines}
    for way in ("approach", "retraction"):
        own = curve.isel(sample=np.flatnonzero(curve.way == way))
        x, y = (np.asarray(of, float) for of in drawn[way].get_data())
        np.testing.assert_allclose(x[np.isfinite(x)] * 1e-9, own.piezo_position, rtol=1e-12)
        np.testing.assert_allclose(y[np.isfinite(y)] * 1e-6, own.force, rtol=1e-12)
        assert np.isnan(x).sum() == (curve.jump_way == way).sum()
    dashed = [line for line in ax.lines if len(line.get_xdata()) == 2 and line.get_linestyle() == "--"]
    jumps = [line for line in dashed if np.ptp(line.get_xdata()) < 1e-9]
    assert len(jumps) == curve.sizes["jump"]
    (name,) = (name for name in drawn if name.startswith("pull-off, "))
    assert name == f"pull-off, {stiction.quantities.si(float(curve.pull_off_force), 'N')}"
    # The axes hold the whole curve, and jumps in and off begin at symbols of one size, each jump at its own.
    assert ax.get_ylim()[1] * 1e-6 > float(curve.force.max()) and ax.get_ylim()[0] * 1e-6 < float(curve.force.min())
    begun = [line for line in ax.lines if line.get_marker() == "o" and line.get_markerfacecolor() == "white"]
    assert sorted(x for line in begun for x in line.get_xdata() * 1e-9) == pytest.approx(sorted(curve.jump_piezo_position.values))
    assert len({line.get_markersize() for line in begun}) == 1 == len({line.get_linewidth() for line in jumps})
    assert "force_curve" not in plot.panels(run) and len(plot.page(run).axes) == len(plot.panels(run))
    path = str(run.path)
    assert plot_command.main([path, "--what", "force_curve,pull_off", "--replica", "2", "--preload", "1 uN", "-o", str(tmp_path / "a.svg")]) == 0
    assert plot_command.main([path, "--replica", "2", "-o", str(tmp_path / "b.svg")]) == 2
    assert "replica: it is of force_curve alone, and none of these is drawn" in capsys.readouterr().err
    assert plot_command.main([str(result("loop").path), "--what", "force_curve", "-o", str(tmp_path / "b.svg")]) == 2
    assert "curves = true in [output]" in capsys.readouterr().err and not (tmp_path / "b.svg").exists()
    assert plot_command.main([path, "--what", "list"]) == 0
    assert "force_curve" in capsys.readouterr().out.split()


def recorded(path, pull=1.3e-6, *, stiffness=40.0, setpoint=2e-6, offset=3e-7, shift=0.0, drift=0.0, drag=0.0, noise=2e-9, kept=slice(None), curves=1, broken=None, calibrated=True):
    """Writes force curves of a lever against a wall, with a baseline of their own, of which some samples are `kept`; afmformats writes them."""
    n = 1500
    one = np.linspace(300e-9, -setpoint / stiffness, n)
    piezo, segment = np.concatenate([one, one[::-1]]), np.repeat([0, 1], n)
    force = np.where(piezo < 0.0, -stiffness * piezo, 0.0)
    held = (segment == 1) & (piezo >= 0.0) & (piezo <= pull / stiffness)
    # The last sample that is held has the pull-off.
    held[np.flatnonzero(held)[-1:] + 1] = pull > 0.0
    force[held] = -np.linspace(0.0, pull, held.sum())
    time = np.arange(2 * n) / 1000.0
    path.unlink(missing_ok=True)
    for curve in range(curves):
        shown = force + noise * np.random.default_rng(curve).standard_normal(2 * n)
        # The slope follows the place of the tip.
        shown = shown + offset + shift * (piezo + force / stiffness) + drift * time + np.where(segment == 0, drag, -drag)
        if curve == broken:
            shown[100] = np.nan
        columns = {"force": shown, "height (measured)": piezo, "segment": segment.astype(np.uint8), "time": time}
        columns = {name: values[kept] for name, values in columns.items()}
        about = {"path": path, "enum": curve, "imaging mode": "force-distance", "point count": columns["time"].size, "position x": 1e-6 * curve, "position y": 2e-6}
        if calibrated:
            about["spring constant"] = stiffness
        data = afmformats.AFMForceDistance(columns, about)
        if path.suffix == ".tab":
            data.export_data(path)
        else:
            import h5py

            with h5py.File(path, "a") as file:
                data.export_data(file, fmt="h5")
    return path


@pytest.mark.parametrize(
    "baseline, slope",
    [({}, "none"), ({}, "shift"), ({"offset": -9e-7}, "none"), ({"drift": 2e-7}, "drift"), ({"drift": -2e-7}, "drift"), ({"shift": 0.5}, "shift"), ({"shift": -0.5}, "shift"),
     *(({"drag": drag}, slope) for drag in (1e-7, 1e-6) for slope in ("shift", "drift", "none"))],
)  # fmt: skip
def test_pull_offs_are_recovered_from_under_offset_and_slope(baseline, slope, tmp_path):
    table = pull_offs(recorded(tmp_path / "one.tab", **baseline), slope=slope)
    # The lowest of noisy samples, of 2 nN.
    assert table.pull_off_force[0] == pytest.approx(1.3e-6, abs=1e-8)
    assert table.spring_constant[0] == 40.0 and list(table.file) == ["one.tab"]
    assert 4e-9 < table.resolution[0] < 3e-8 and table.remark[0] == ""


@pytest.mark.parametrize("slope", ["shift", "drift", "none"])
def test_drag_is_no_pull_off(slope, tmp_path):
    """In a liquid the lowest force lies twice the drag under the baseline of the approach also where nothing adheres."""
    table = pull_offs(recorded(tmp_path / "liquid.tab", 0.0, drag=1e-7), slope=slope)
    assert table.pull_off_force[0] < table.resolution[0] < 3e-8
    assert float(written(table).splitlines()[1].split(",")[2].removeprefix("<")) < 30.0


@pytest.mark.parametrize("slope", ["shift", "drift"])
def test_an_approach_without_baseline_confirms_no_slope(slope, tmp_path):
    """Only contact is left of the approach."""
    path = recorded(tmp_path / "one.tab", kept=slice(1350, None))
    with pytest.raises(FileError, match=r"one.tab curve 0: has no baseline on approach .*; take slope none"):
        pull_offs(path, slope=slope)
    assert pull_offs(path, slope="none").pull_off_force[0] == pytest.approx(1.3e-6, abs=1e-8)


@pytest.mark.parametrize("slope", ["shift", "drift", "none"])
@pytest.mark.parametrize("end", [1600, 1700, 1770])
def test_a_retraction_that_ends_before_the_pull_off_gives_no_number(slope, end, tmp_path):
    """The lever turns at sample 1500, leaves contact at 1714 and lets go at 1853."""
    with pytest.raises(FileError, match=r"one\.tab curve 0: "):
        pull_offs(recorded(tmp_path / "one.tab", kept=slice(end)), slope=slope)


@pytest.mark.parametrize(
    "baseline, wrong, right, note",
    [({"drift": 2e-7}, "shift", "drift", "differ in their slope over the height; slope drift fits"),
     ({"shift": 0.5}, "drift", "shift", "differ in their slope over the time; slope shift fits"),
     ({"drift": 2e-7}, "none", "drift", "has a baseline with a slope; slope drift fits")],
)  # fmt: skip
def test_slopes_of_approach_and_retraction_that_disagree_are_said(baseline, wrong, right, note, tmp_path, capsys):
    path = recorded(tmp_path / "one.tab", **baseline)
    table = pull_offs(path, slope=wrong)
    assert note in table.remark[0] and pull_offs(path, slope=right).remark[0] == ""
    assert command.main([str(path), "--slope", wrong]) == 0
    said = capsys.readouterr()
    assert note in said.out and said.err.startswith("one.tab curve 0: ") and note in said.err
    # A pull-off that the other slope would change as much gives no number.
    recorded(path, 0.1e-6, **baseline)
    with pytest.raises(FileError, match=note):
        pull_offs(path, slope=wrong)
    assert pull_offs(path, slope=right).pull_off_force[0] == pytest.approx(0.1e-6, abs=1e-8)


def test_a_slope_that_is_left_in_is_in_the_pull_off(tmp_path):
    path = recorded(tmp_path / "one.tab", drift=2e-7)
    assert abs(pull_offs(path, slope="none").pull_off_force[0] - 1.3e-6) > 5e-8
    with pytest.raises(SceneError, match="slope = tilt: one of shift, drift, none is needed"):
        pull_offs(path, slope="tilt")


@pytest.mark.parametrize("slope", ["shift", "none"])
def test_the_retraction_of_an_asylum_file_is_that_of_its_note(slope, tmp_path):
    wave = binarywave.load(ASYLUM)["wave"]
    deflection = wave["wData"][:, 1] * 1.1841
    # From sample 1008 on it retracts; in air the baseline of the approach is that of the retraction.
    expected = deflection[:100].mean() - deflection[1008:].min()
    assert expected == pytest.approx(12.85e-9, rel=1e-3)
    table = pull_offs(ASYLUM, slope=slope)
    assert table.pull_off_force[0] == pytest.approx(expected, rel=0.01) and table.resolution[0] < 0.02 * expected
    # A direction 0 is a pause, and a direction 1 approach.
    for direction, message in ((b"NaN,1,0 ", "has a pause between"), (b"NaN,1,1 ", "has no retraction")):
        (tmp_path / "a.ibw").write_bytes(ASYLUM.read_bytes().replace(b"NaN,1,-1", direction))
        with pytest.raises(FileError, match=message):
            pull_offs(tmp_path / "a.ibw", slope=slope)


def test_a_folder_becomes_a_table_that_infer_reads(tmp_path, capsys):
    folder = tmp_path / "spots"
    (folder / "day 2").mkdir(parents=True)
    recorded(folder / "a.tab")
    recorded(folder / "day 2" / "map.h5", 0.6e-6, curves=3)
    recorded(folder / "none.tab", 0.0)
    (folder / "notes.md").write_text("no curve")
    output = tmp_path / "pull_offs.csv"
    assert command.main([str(folder), "-o", str(output)]) == 0
    said = capsys.readouterr()
    assert said.out == f"5 curves of 3 files, 4 with a pull-off\n{output}\n" and "left out, as no force curves: notes.md" in said.err
    table = pd.read_csv(output)
    assert list(table.columns) == ["file", "curve", "pull_off_force (nN)", "spring_constant (N/m)", "position_x (um)", "position_y (um)"]
    assert list(table.file) == ["a.tab", *["day 2/map.h5"] * 3, "none.tab"] and list(table.curve) == [0, 0, 1, 2, 0]
    assert list(table["position_x (um)"]) == [0, 0, 1, 2, 0] and set(table["spring_constant (N/m)"]) == {40}
    # `infer` takes the forces in N, and the limit of the curve without a pull-off.
    data = inference.data.read(output, outcomes={"pull_off_force": "N"})
    (group,) = data.groups
    assert list(group.kinds[:, 0]) == [inference.data.EXACT] * 4 + [inference.data.BELOW]
    np.testing.assert_allclose(group.values[:4, 0], [1.3e-6, 0.6e-6, 0.6e-6, 0.6e-6], atol=1e-8)
    assert group.samples[1] == "day 2/map.h5"
    # Without an output it is printed; a second time it is in the way.
    assert command.main([str(folder)]) == 0
    assert pd.read_csv(io.StringIO(capsys.readouterr().out)).equals(table)
    assert command.main([str(folder), "-o", str(output)]) == 2
    assert "exists; --force overwrites it" in capsys.readouterr().err


def test_a_curve_without_retraction_is_an_empty_cell(tmp_path):
    recorded(tmp_path / "a.tab")
    recorded(tmp_path / "b.tab", kept=slice(1500))
    output = tmp_path / "out.csv"
    assert command.main([str(tmp_path), "-o", str(output)]) == 0
    with pytest.raises(FileError, match=r"out.csv, line 3, column 3 \(pull_off_force\): nothing: a gap"):
        inference.data.read(output)
    assert inference.data.read(output, missing="drop").gaps == 1
    (column,) = (one for one in read(output).columns if one.name == "pull_off_force")
    assert column.cells[1] == ""


def test_what_cannot_be_read_is_named_and_the_rest_is_read(tmp_path, capsys):
    folder, output = tmp_path / "spots", tmp_path / "pull_offs.csv"
    folder.mkdir()
    recorded(folder / "a.tab")
    recorded(folder / "b.tab", calibrated=False)
    (folder / "c.tab").write_text("# BEGIN METADATA\n# {\n# END METADATA\n# force\ttime\n1\t2\n")
    recorded(folder / "d.h5", curves=3, broken=1)
    shutil.copy(PAUSED, folder / "e.jpk-force")
    reasons = {
        "b.tab curve 0": "has no spring constant; give it",
        "c.tab": "cannot be read (",
        "d.h5 curve 1": "has samples that are no numbers",
        "e.jpk-force curve 0": "has a pause between approach and retraction",
    }
    assert command.main([str(folder), "-o", str(output)]) == 0
    said = capsys.readouterr()
    assert said.out.startswith("7 curves of 5 files, 3 with a pull-off\n")
    for line, (where, reason) in zip(said.err.splitlines(), reasons.items(), strict=True):
        assert line.startswith(f"{where}: {reason}")
    table = pd.read_csv(output)
    read_ones = table["pull_off_force (nN)"].notna()
    assert list(table.file[read_ones]) == ["a.tab", "d.h5", "d.h5"] and list(table.curve[read_ones]) == [0, 0, 2]
    np.testing.assert_allclose(table["pull_off_force (nN)"][read_ones], 1300.0, atol=10.0)
    for note, reason in zip(table.remark[~read_ones], reasons.values(), strict=True):
        assert note.startswith(reason)
    # `infer` takes the rest where it is asked to.
    data = inference.data.read(output, outcomes={"pull_off_force": "N"}, missing="drop")
    assert data.gaps == 4 and data.size == 3
    for name in ("a.tab", "d.h5"):
        (folder / name).unlink()
    assert command.main([str(folder)]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert f"{folder / 'b.tab'} curve 0: has no spring constant" in said and said.endswith("; 3 curves and files give no number")


@pytest.mark.parametrize(
    "name, content, message",
    [
        ("absent.tab", None, "absent.tab: no such file or folder"),
        ("foreign.xyz", b"1 2 3", r"foreign.xyz: has no force curves in a format that afmformats reads \(.*\.jpk-force.*\); export it in one of these"),
        ("empty.tab", b"", "empty.tab: has no force curves"),
        ("cut.jpk-force", b"PK\3\4 cut off", "cut.jpk-force: (cannot be read|has no force curves)"),
        ("broken.tab", b"# BEGIN METADATA\n# {\n# END METADATA\n# force\ttime\n1\t2\n", "broken.tab: cannot be read .*; export it again"),
    ],
)  # fmt: skip
def test_files_that_are_no_force_curves_are_named(name, content, message, tmp_path):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(FileError, match=message):
        pull_offs(tmp_path / name)


def test_an_empty_folder_and_a_missing_spring_constant_are_named(tmp_path):
    with pytest.raises(FileError, match="no file in it has force curves"):
        pull_offs(tmp_path)
    path = recorded(tmp_path / "soft.tab", calibrated=False)
    with pytest.raises(FileError, match=r'soft\.tab curve 0: has no spring constant; give it, such as "40 N/m"'):
        pull_offs(path)
    for wrong in ("0 N/m", "40 m", "stiff"):
        with pytest.raises(SceneError, match="spring_constant = "):
            pull_offs(path, spring_constant=wrong)


def test_a_computed_curve_is_read_as_an_instrument_would_have_recorded_it(result, tmp_path):
    """The curve of a spot, sampled as a ramp of the piezo and written as a file, gives the pull-off of the result."""
    run = result("spots")
    curve = run.force_curve(replica=4, preload="1 uN")
    columns = {"force": [], "height (measured)": [], "segment": []}
    for number, way in enumerate(("approach", "retraction")):
        own = curve.isel(sample=np.flatnonzero(curve.way == way))
        piezo, force = own.piezo_position.values, own.force.values
        ramp = np.linspace(piezo[0], piezo[-1], 4000)
        order = np.argsort(piezo, kind="stable")
        columns["height (measured)"] += list(ramp)
        columns["force"] += list(np.interp(ramp, piezo[order], force[order]))
        columns["segment"] += [number] * ramp.size
    arrays = {name: np.array(values, dtype=np.uint8 if name == "segment" else float) for name, values in columns.items()}
    arrays["time"] = np.arange(8000) / 1000.0
    about = {"path": "a.tab", "enum": 0, "imaging mode": "force-distance", "point count": 8000, "spring constant": 40.0}
    afmformats.AFMForceDistance(arrays, about).export_data(tmp_path / "spot.tab")
    expected = float(run["replicas/pull_off_after_preload"].sel(replica=4, preload=1e-6))
    assert pull_offs(tmp_path / "spot.tab", slope="none").pull_off_force[0] == pytest.approx(expected, rel=0.02)
