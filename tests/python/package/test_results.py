"""Results are what their files have, reported with h5py."""

import gc
import math
import tomllib

import h5py
import numpy as np
import pytest
import xarray
from conftest import CONFIGS

import stiction
import stiction.report
from stiction import FileError, plot, quantities
from stiction.backend import StictionBackend

KINDS = {"run": stiction.Run, "sweep": stiction.Sweep, "comparison": stiction.Sweep}
KINDS |= {"alone": stiction.Run, "alone_sweep": stiction.Sweep, "asperities": stiction.Asperities}


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_opens_as_its_class_and_says_what_it_is(result, name):
    opened = result(name)
    assert type(opened) is KINDS[name] and opened.format in KINDS[name].formats.values()
    text, html = repr(opened), opened._repr_html_()
    assert text.startswith(f"<stiction.{KINDS[name].__name__} ") and len(text.splitlines()) > 2
    assert html.startswith("<table>") and html.count("<tr>") == len(opened._summary()) + len(opened.warnings)
    with h5py.File(opened.path) as file:
        assert opened.attrs["format"] == file.attrs["format"]
        assert opened.scene_text == file.attrs.get("scene", "")
        assert set(opened.tree.children) == {group for group in file if isinstance(file[group], h5py.Group)}


def test_what_is_wrong_with_a_file_is_reported(result, tmp_path):
    with pytest.raises(FileError, match=r"none\.h5: no such file"):
        stiction.open_run(tmp_path / "none.h5")
    (tmp_path / "text.h5").write_text("no")
    with pytest.raises(FileError, match="not an HDF5 file"):
        stiction.open_run(tmp_path / "text.h5")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = [1.0]
    with pytest.raises(FileError, match="not a result of stiction"):
        stiction.open_run(tmp_path / "other.h5")
    old = result("run").save(tmp_path / "old.h5")
    with h5py.File(old, "r+") as file:
        file.attrs["format_version"] = np.array([2, 0])
    with pytest.raises(FileError, match=r"format version is 2\.x, this package reads 3\.x"):
        stiction.open_run(old)
    with pytest.raises(FileError, match="exists; force=True"):
        result("run").save(old)
    with pytest.raises(FileError, match=r"of `stiction run`, not of `stiction run of a scene with \[sweep\]`"):
        stiction.Sweep(result("run").path)
    with pytest.raises(FileError, match=r"no group /coupling; it has .*ensemble"):
        result("run").group("coupling")


def test_separations_are_selected_by_either_coordinate(result):
    run = result("run")
    force = run.ensemble.external_force_mean
    with h5py.File(run.path) as file:
        h_star, plain = file["ensemble/h_star"][:], file["ensemble/external_force_mean"][:]
    at = int(np.abs(h_star - 2.8).argmin())
    assert float(force.sel(h_star=2.8, method="nearest")) == plain[at]
    assert float(force.sel(separation=force.separation[at])) == plain[at]
    between = (h_star >= 1.0) & (h_star <= 3.0)
    assert np.array_equal(force.sel(h_star=slice(1.0, 3.0)), plain[between])
    assert float(run.integral.external_force.sel(h_star=2.8, method="nearest")) != 0.0


def test_the_number_to_quote_is_that_of_the_file(result):
    run = result("run")
    with h5py.File(run.path) as file:
        ensemble, values = file["ensemble"], file["replicas/pull_off_force"][:]
        scalar = list(ensemble["scalar"].asstr()[:]).index("pull_off_force")
        quoted = run.pull_off
        assert quoted.mean_over_patches == float(quoted) == ensemble["scalar_controlled_mean"][scalar]
        assert quoted.standard_error == ensemble["scalar_controlled_standard_error"][scalar]
        assert list(quoted.interval) == list(ensemble["scalar_controlled_interval"][scalar])
        assert math.isclose(quoted.std, values.std(ddof=1)) and quoted.replicas == len(values)
        assert math.isclose(quoted.scatter, values.std(ddof=1) / values.mean())
        assert quoted.of_mean_curve == ensemble.attrs["pull_off_force"]
        assert quoted.of_integral == file["integral"].attrs["pull_off_force"]
        assert run.cross_check.p_value == file["validation"].attrs["p_value"]
        assert run.cross_check.verdict == file["validation"].attrs["verdict"]
    assert quoted.interval[0] < quoted.mean_over_patches < quoted.interval[1]


@pytest.mark.parametrize("name", ["run", "curves", "coupled", "loop"])
def test_a_table_of_replicas_has_a_row_for_each(result, name):
    run = result(name)
    table = run.replicas.to_dataframe()
    assert len(table) == run.attrs["replicas"]
    with h5py.File(run.path) as file:
        rows = {key for key, data in file["replicas"].items() if data.shape == (len(table),)} - {"replica"}
        assert rows == set(table.columns)
        assert np.array_equal(table["pull_off_force"], file["replicas/pull_off_force"][:])


def test_a_table_of_replicas_has_a_column_for_each_preload(result):
    """Its means are the numbers of the summary; the pull-off of the whole loop is named as that."""
    run = result("device")
    table = run.replicas.to_dataframe()
    with h5py.File(run.path) as file:
        preloads, means = file["instability/preload"][:], file["instability/pull_off_after_preload_mean"][:]
        whole = file["replicas/pull_off_force"][:]
    reached = ~np.isnan(means)
    assert reached.sum() > 2
    for preload, mean in zip(preloads[reached], means[reached], strict=True):
        assert table[f"pull_off_after_preload[{float(preload)!r} N]"].mean() == pytest.approx(mean, rel=1e-12)
    assert np.array_equal(table["pull_off_force_of_whole_loop"], whole)
    assert "pull_off_force" not in table
    assert run.pull_off.mean_over_patches in [pytest.approx(mean) for mean in means[reached]]


def test_curves_of_replicas_have_both_coordinates(result):
    run = result("curves")
    assert run.curves.external_force.sel(h_star=2.8, method="nearest").shape == (40,)
    mean = run.curves.external_force.mean("replica")
    assert np.allclose(mean, run.ensemble.external_force_mean, rtol=1e-9, atol=1e-12 * abs(mean).max())


def test_points_of_a_sweep_are_selected_by_their_keys(result):
    sweep = result("grid")
    assert sweep.keys == ["surface.lubricant_thickness", "material.hardness"]
    mean = sweep.pull_off["mean_over_patches"]
    assert dict(mean.sizes) == {"surface_lubricant_thickness": 2, "material_hardness": 3}
    chosen = float(mean.sel(surface_lubricant_thickness=5e-10, material_hardness=2e9, method="nearest"))
    with h5py.File(sweep.path) as file:
        assert chosen == file["ensemble/scalar_controlled_mean"][1, 1, 0]
    assert len(sweep.replicas.to_dataframe()) == 2 * 3 * 20


def test_points_of_choices_are_selected_by_name(result):
    for name, key, names in (("comparison", "model_law", ["hybrid", "emd", "fit:paper", "gw"]), ("choice", "substrate_coupling", ["none", "patch"])):
        sweep = result(name)
        with h5py.File(sweep.path) as file:
            forces, mean = file["integral/external_force"][:], file["ensemble/scalar_controlled_mean"][:, 0]
        for point, chosen in enumerate(names):
            assert np.array_equal(sweep.integral.external_force.sel({key: chosen}), forces[point])
            assert float(sweep.pull_off["mean_over_patches"].sel({key: chosen})) == mean[point]
            assert sweep.key_text(key, sweep.points[key][point].item()) == chosen
        tree = xarray.open_datatree(sweep.path, engine=StictionBackend)
        assert list(sweep[key].values) == list(tree[f"integral/{key}"].values) == names
        assert ", ".join(names) in repr(sweep) or name == "choice"


def test_results_without_a_name_are_there_as_long_as_they_are_used(result):
    run = stiction.run(result("run").scene, replicas=10)
    path, ensemble = run.path, run.ensemble
    kept = run.save(path.parent.parent / f"{path.parent.name}-kept.h5")
    assert path.exists()
    del run
    gc.collect()
    assert not path.parent.exists()
    assert float(ensemble.external_force_mean.min()) < 0.0
    with stiction.open_run(kept) as again:
        assert again.pull_off.replicas == 10
    kept.unlink()


def test_a_sweep_with_preloads_quotes_the_largest_that_is_reached(result):
    """30 mN of 1 mN, 30 mN and 10 N, by hand from the replicas."""
    sweep = result("pressed_sweep")
    forces = sweep["replicas/pull_off_after_preload"].transpose("material_work_of_adhesion", "replica", "preload").values
    assert np.isnan(forces[..., 2]).all() and np.isfinite(forces[..., 1]).all()
    of = forces[..., 1]
    quoted = sweep.pull_off
    np.testing.assert_allclose(quoted["mean_over_patches"], of.mean(axis=1), rtol=1e-13)
    error = of.std(axis=1, ddof=1) / np.sqrt(12)
    np.testing.assert_allclose(quoted["standard_error"], error, rtol=1e-11)
    assert list(quoted["preload"].values) == [0.03, 0.03]
    # Student's t of 11 degrees of freedom, 97.5 %: 2.200985.
    np.testing.assert_allclose(quoted["interval"].isel(range_end=1) - quoted["mean_over_patches"], 2.200985 * error, rtol=1e-6)
    stuck = sweep.after_largest_preload["stuck_probability"]
    np.testing.assert_allclose(stuck, (of > 1e-4).mean(axis=1), rtol=1e-15)
    assert "pull_off_excess" not in plot.panels(sweep) and "stuck" in plot.panels(sweep)


def test_the_model_range_follows_the_largest_preload_that_is_reached(result):
    """The scene's own contact has what is quoted, and the others are further apart than its interval is wide."""
    run = result("device")
    of, group = run.model_range, run["model_range"]
    assert list(of["plastic_contact"].values) == ["jg", "ke", "zmc", "tn"] and int(of["replica_count"]) == 1
    largest = int(np.flatnonzero(run["instability/preload_reached_count"].values)[-1])
    assert run.pull_off.preload == run["instability/preload"].values[largest]
    for name, own in (("pull_off_force", "pull_off_after_preload"), ("stuck_probability", "stuck_probability_after_preload")):
        np.testing.assert_array_equal(of[name], group[own].transpose("plastic_contact", "preload").values[:, largest])
    force = of["pull_off_force"]
    assert float(force.sel(plastic_contact="jg")) == pytest.approx(run.pull_off.mean_over_patches, rel=1e-14)
    assert float(of["stuck_probability"].sel(plastic_contact="jg")) == float(run.after_largest_preload["stuck_probability"])
    low, high = run.pull_off.interval
    assert float(force.max() - force.min()) > high - low
    words = f"{quantities.si(force.min(), 'N')} to {quantities.si(force.max(), 'N')}"
    assert f"model range       {words} after 100.0 mN, by plastic contact" in repr(run)
    page = stiction.report.page([run])
    assert "by plastic contact, which no interval has: jg 1.7" in page and ">model range<" in page
    sweep = result("yielding_sweep")
    assert sweep.model_range["pull_off_force"].sizes == {"material_work_of_adhesion": 2, "plastic_contact": 4}
    assert result("run").model_range is None and result("sweep").model_range is None


def test_figures_show_the_model_range(result):
    run, sweep = result("device"), result("yielding_sweep")
    known = run["model_range/pull_off_after_preload"]
    (lower, *_) = [line for line in plot.preloads(run).lines if line.get_label() == "range over plastic contacts"]
    reached = np.isfinite(known.min("plastic_contact").values)
    ratio = lower.get_ydata() / known.min("plastic_contact").values[reached]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    for ax in (plot.stuck(run), plot.pull_off(run), plot.energy(run), plot.sweep(sweep), plot.sweep(sweep, quantity="stuck")):
        words = [text.get_text() for text in ax.get_legend().get_texts()]
        assert any("range over plastic contacts" in text for text in words), words
    words = [text.get_text() for text in plot.sweep(sweep, quantity="peak_secant_stiffness").get_legend().get_texts()]
    assert "range over plastic contacts" not in words


def test_answers_that_take_many_runs_compute_one_contact(monkeypatch):
    """`infer`, `sensitivity`, `design` and `finite-size` ask for the scene's own contact alone."""
    from stiction import experiments, finite_size, priors, sensitivity
    from stiction.design import rare
    from stiction.inference import emulator

    class Asked(Exception):
        pass

    original = experiments.run

    def asked(*_, replicas=None, **overrides):
        if replicas == 0:
            return original(*_, replicas=0, **overrides)
        raise Asked(overrides.get("ensemble.model_range"))

    monkeypatch.setattr(experiments, "run", asked)
    monkeypatch.setattr(experiments, "sweep", asked)
    monkeypatch.setattr(experiments, "patches", asked)
    scene = tomllib.loads((CONFIGS / "first.toml").read_text(encoding="utf-8"))
    hardness = {"prior": "uniform", "from": "5 GPa", "to": "6 GPa"}
    with_prior = scene | {"material": scene["material"] | {"hardness": hardness}}
    for ask in (
        lambda: finite_size.run(scene, [10, 100]),
        lambda: sensitivity.sensitivity(with_prior, samples=64),
        lambda: rare.Patches(scene, seed=1, threads=1),
        lambda: emulator.simulate(priors.read(with_prior), ("pull_off_force",), np.array([[5.5e9]]), replicas=2, seed=1),
    ):
        with pytest.raises(Asked) as found:
            ask()
        assert found.value.args[0] is False


def test_a_preload_that_no_patch_reaches_has_no_pull_off(result):
    run = result("missed_preload")
    quoted = run.pull_off
    assert np.isnan([quoted.mean_over_patches, *quoted.interval, quoted.preload]).all() and quoted.replicas == 0
    assert np.isnan(run.after_largest_preload["stuck_probability"])
    assert "no patch reaches a preload" in stiction.report.page([run])
    assert "device/stuck_probability" not in run and quoted.of_integral > 0.0


def test_a_loop_prints_the_energy_that_it_dissipates(result):
    """Mean and standard error of the replicas; a run on approach has no such line."""
    loop = result("loop")
    energy = loop["replicas/dissipated_energy"].values
    shown = next(line for line in str(loop).splitlines() if line.startswith("  dissipated"))
    expected = quantities.with_error(energy.mean(), energy.std(ddof=1) / energy.size**0.5, "J")
    assert shown.split(None, 1)[1].startswith(f"{expected} in a cycle") and shown.endswith(f"mean over {energy.size} replicas")
    assert "dissipated" not in str(result("run"))
