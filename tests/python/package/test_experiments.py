"""Calls of the program: the same results as on the command line, its errors as exceptions, interruptions."""

import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pint
import pytest
from conftest import CONFIGS, begun

import stiction
from stiction import FileError, SceneError, StictionError
from stiction.program import call, find

QUICK = CONFIGS / "quick.toml"
TABLES = tomllib.loads(QUICK.read_text())


def same(one, other):
    """Whether two files have the same datasets, diagnostics aside."""
    with h5py.File(one) as first, h5py.File(other) as second:
        names = []
        first.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        names = [name for name in names if not name.startswith("diagnostics")]
        assert names
        return all(
            np.array_equal(first[name][()], second[name][()], equal_nan=first[name].dtype.kind == "f")
            for name in names
        )


def test_a_scene_is_a_path_or_its_tables(tmp_path):
    subprocess.run(
        [find(), "run", QUICK, "-o", tmp_path / "plain.h5", "--replicas", "20", "--quiet"],
        check=True,
        capture_output=True,
    )
    stiction.run(QUICK, tmp_path / "path.h5", replicas=20)
    stiction.run(TABLES, tmp_path / "tables.h5", replicas=20, threads=1)
    assert same(tmp_path / "plain.h5", tmp_path / "path.h5") and same(tmp_path / "plain.h5", tmp_path / "tables.h5")
    other = stiction.run(QUICK, tmp_path / "other.h5", replicas=20, seed=5)
    assert not same(tmp_path / "plain.h5", other.path)


def test_counts_and_shares_are_numbers(tmp_path):
    """20 replicas as 2e1 and a Poisson's ratio of 0.196 in percent, in a file and in tables."""
    stiction.run(TABLES, tmp_path / "plain.h5", replicas=20)
    text = QUICK.read_text().replace("replicas = 200", "replicas = 2e1").replace("0.196", '"19.6 %"')
    (tmp_path / "scene.toml").write_text(text)
    tables = tomllib.loads(text)
    assert (tables["ensemble"]["replicas"], tables["material"]["poisson_ratio"]) == (20.0, "19.6 %")
    for source in (tmp_path / "scene.toml", tables):
        found = stiction.run(source, tmp_path / "found.h5", force=True)
        assert same(tmp_path / "plain.h5", found.path)
    for key, value, said in (
        ("ensemble.replicas", "2e1 %", "a whole number from"),
        ("ensemble.replicas", 2.5, "a whole number from"),
        ("material.poisson_ratio", "19.6 nm", "poisson_ratio"),
    ):
        with pytest.raises(SceneError, match=said):
            stiction.run(TABLES, **{key: value})


def test_overrides_of_paths_and_tables_are_one(tmp_path):
    ureg = pint.UnitRegistry()
    for value in ("0.05 J/m^2", ureg("50 mJ/m^2"), ureg.Quantity(0.05, "N/m")):
        overrides = {"material.work_of_adhesion": value, "output.curves": True}
        one = stiction.run(QUICK, tmp_path / "one.h5", replicas=10, force=True, **overrides)
        tables = {**TABLES, "material": {**TABLES["material"], "work_of_adhesion": value}, "output": {"curves": True}}
        two = stiction.run(tables, tmp_path / "two.h5", replicas=10, force=True)
        assert same(one.path, two.path)
        assert "external_force" in one.curves
    assert one.scene["material"]["work_of_adhesion"] in ("0.05 J/m^2", "0.05 N/m")


def test_arrays_of_heights_and_radii_are_scenes(tmp_path):
    random = np.random.default_rng(3)
    heights, radii = random.normal(0.0, 1.4e-9, 200), random.lognormal(np.log(3e-6), 0.2, 5)
    surface = {
        key: value
        for key, value in TABLES["surface"].items()
        if key not in ("asperity_radius", "surface_height_std")
    }
    scene = {**TABLES, "surface": {**surface, "heights": heights, "radii": radii, "mean_plane_offset": "1.8 nm"}}
    run = stiction.run(scene, tmp_path / "arrays.h5", replicas=10)
    again = stiction.run(scene, tmp_path / "again.h5", replicas=10)
    assert same(run.path, again.path)
    assert run.attrs["asperity_radius"] == pytest.approx(radii.mean(), rel=1e-12)
    text = run.scene["surface"]["heights"]
    assert Path(text["path"]).parent == tmp_path and text["unit"] == "m"
    stiction.run(scene, replicas=10)
    with pytest.raises(SceneError, match=r"surface\.heights: an array of one dimension"):
        stiction.run({**scene, "surface": {**scene["surface"], "heights": heights.reshape(2, 100)}})


def test_found_asperities_are_a_surface(result, tmp_path):
    found = result("asperities")
    surface = {"asperities": found, "nominal_area": "30 um^2", "lubricant_thickness": "0.5 nm"}
    run = stiction.run({**TABLES, "surface": surface}, tmp_path / "measured.h5", replicas=10)
    assert run.attrs["asperity_radius"] == pytest.approx(found.radius.mean(), rel=1e-9)


def test_sweeps_of_paths_and_tables_are_one(tmp_path):
    axes = {"surface.lubricant_thickness": ["0 nm", "0.5 nm"]}
    one = stiction.sweep(QUICK, axes, tmp_path / "one.h5", replicas=10)
    two = stiction.sweep(TABLES, axes, tmp_path / "two.h5", replicas=10)
    assert same(one.path, two.path) and one.keys == ["surface.lubricant_thickness"]
    with pytest.raises(SceneError, match="axes: a dict of values"):
        stiction.sweep(QUICK, {})


def test_the_integral_alone_is_that_of_the_run(result):
    curve = stiction.integral(QUICK)
    run = result("run")
    assert np.array_equal(curve.external_force, run.integral.external_force)
    assert float(curve.pull_off_force) == run.pull_off.of_integral
    assert float(curve.external_force.sel(h_star=2.8, method="nearest")) < 0.0


def test_a_run_of_the_integral_alone_has_no_replicas(result):
    alone = result("alone")
    assert not alone.has_replicas and "of the integral alone" in repr(alone)
    with pytest.raises(FileError, match="no group /ensemble"):
        alone.group("ensemble")
    curve = stiction.integral(CONFIGS / "loop.toml")
    assert np.array_equal(curve.retraction_external_force, alone.integral.retraction_external_force)
    assert float(curve.pull_off_force) == alone["integral"].attrs["pull_off_force"]
    points = result("alone_sweep")
    assert list(points.pull_off.data_vars) == ["of_integral"] and "of the integral alone" in repr(points)


def test_a_comparison_without_laws_is_of_the_scenes(result):
    assert list(stiction.compare(QUICK)["model_law"].values) == ["hybrid"]
    assert list(stiction.compare(QUICK, "hybrid,emd")["model_law"].values) == ["hybrid", "emd"]
    with pytest.raises(SceneError, match="nolaw"):
        stiction.compare(QUICK, ["nolaw"])


def test_check_shows_what_the_program_says():
    text = stiction.check(QUICK)
    assert text == call(["check", str(QUICK)]) and repr(text) == str(text) and "replicas" in text


def test_errors_have_the_programs_message(tmp_path):
    with pytest.raises(SceneError, match=r"material\.work_of_adhesion") as refused:
        stiction.run(QUICK, tmp_path / "no.h5", **{"material.work_of_adhesion": "0.1 Pa"})
    assert refused.value.exit_code == 2 and not list(tmp_path.iterdir())
    with pytest.raises(SceneError, match="work_of_adhesion"):
        stiction.run({**TABLES, "material": {}}, tmp_path / "no.h5")
    with pytest.raises(SceneError, match=r"none\.toml: no such file"):
        stiction.run(tmp_path / "none.toml")
    with pytest.raises(SceneError, match="not list"):
        stiction.run([])
    with pytest.raises(SceneError, match=r"hardness: not a key of scenes, .* material\.hardness\?"):
        stiction.run(QUICK, hardness="1 GPa")
    with pytest.raises(SceneError, match=r"material\.hardness is a object"):
        stiction.run({**TABLES, "material": {**TABLES["material"], "hardness": object()}})
    with pytest.raises(SceneError, match="resume=True: name the output"):
        stiction.run(QUICK, resume=True)
    ureg = pint.UnitRegistry()
    with pytest.raises(SceneError, match="no quantity of this dimension"):
        stiction.run(QUICK, **{"material.hardness": ureg("3 s")})
    (tmp_path / "there.h5").write_text("mine")
    with pytest.raises(StictionError, match=r"there\.h5"):
        stiction.run(QUICK, tmp_path / "there.h5")
    assert (tmp_path / "there.h5").read_text() == "mine"


def test_where_the_program_is_looked_for_is_reported(monkeypatch, tmp_path):
    monkeypatch.setenv("STICTION", str(tmp_path / "none"))
    with pytest.raises(StictionError, match=r"STICTION = .*no such program"):
        find()
    monkeypatch.delenv("STICTION")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("sysconfig.get_path", lambda *_: str(tmp_path))
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    with pytest.raises(StictionError, match="pip install stiction"):
        find()
    (tmp_path / "stiction").write_text("#!/bin/sh\necho '{}' >&2\nexit 1\n")
    (tmp_path / "stiction").chmod(0o755)
    assert find() == str(tmp_path / "stiction")


INTERRUPTED = """
import sys, stiction
try:
    stiction.run(sys.argv[1], sys.argv[2], replicas=700, progress=True, **{"ensemble.seed": 7})
except KeyboardInterrupt:
    print("interrupted")
"""


def test_what_an_interrupted_run_has_done_is_gone_on_with(tmp_path):
    scene, output = CONFIGS / "case_ii.toml", tmp_path / "long.h5"
    with begun(INTERRUPTED, scene, output, folder=tmp_path) as process:
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
    assert out.strip() == "interrupted" and not output.exists()
    assert (tmp_path / "long.h5.partial").exists()
    run = stiction.run(scene, output, replicas=700, resume=True, **{"ensemble.seed": 7})
    assert int(run["diagnostics/resumptions"]) == 1
    whole = stiction.run(scene, tmp_path / "whole.h5", replicas=700, **{"ensemble.seed": 7})
    assert same(run.path, whole.path)
