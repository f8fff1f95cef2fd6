"""Figures show what the files have, in words with units, and `stiction plot` draws every kind of result."""

import os
import re
import subprocess
import sys
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pytest
from conftest import CONFIGS
from matplotlib import pyplot
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm, Normalize, to_rgba

import stiction
from stiction import FileError, finite_size, plot, quantities
from stiction.plot.command import main
from stiction.plot.style import BLUE, VERMILION, inches, is_noise, steady

KINDS = [
    "run", "retraction", "loop", "cycles", "instability", "preload", "device", "pressed_sweep", "missed_preload", "stopping", "coupled", "background", "sweep", "grid", "grid_of_three", "heat_map",
    "choice", "comparison", "finite_size", "alone", "alone_sweep", "asperities", "partial",
]  # fmt: skip


@pytest.fixture(autouse=True)
def closed():
    """No figure is left to the next test."""
    yield
    pyplot.close("all")


def lines(ax):
    return {str(line.get_label()): line for line in ax.lines}


def reported(ax):
    """The words of the legend."""
    return [words.get_text() for words in ax.get_legend().get_texts()]


def unit_of(ax):
    """The factor of the unit in the label of the y axis."""
    sign = re.search(r"\((.)?N\)$", ax.get_ylabel())[1] or ""
    return {"p": 1e-12, "n": 1e-9, "µ": 1e-6, "m": 1e-3, "": 1.0}[sign]


@pytest.mark.parametrize("ending", ["png", pytest.param("pdf", marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", KINDS)
def test_every_kind_is_drawn_whole_without_a_warning(result, name, ending, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        opened = result(name)
        figure = plot.page(opened, "95mm" if ending == "png" else None)
        figure.savefig(tmp_path / f"page.{ending}", dpi=50)
    for ax in figure.axes:
        if ax.get_legend() is not None:
            # No legend is in the data, larger than its axes or beyond the page.
            legend, axes = ax.get_legend().get_window_extent(), ax.get_window_extent()
            assert legend.y0 >= axes.y1 - 1.0 and legend.height < axes.height, (ax.get_ylabel(), legend, axes)
            assert legend.x1 <= figure.bbox.x1 + 1.0 and legend.y1 <= figure.bbox.y1 + 1.0, (ax.get_ylabel(), legend)
    drawn = [ax for ax in figure.axes if ax.get_label() != "<colorbar>"]
    # A sweep over laws or the nominal area has the figures of any sweep only if they are asked for.
    assert len(drawn) == {"comparison": 2, "finite_size": 3}.get(name, len(plot.panels(opened))) >= (1 if name == "alone" else 2)
    for ax in drawn:
        if not (ax.lines or ax.collections or ax.patches or ax.images):
            # A panel without data says why.
            assert name in ("missed_preload", "partial") and ax.texts, ax.get_title()
            continue
        # Words, not names of datasets.
        for label in (ax.get_xlabel(), ax.get_ylabel()):
            assert "_" not in label.replace("$", "") and label, ax.get_title()
    assert figure.get_suptitle() == ""


def test_the_attraction_is_that_of_asperities_and_mean_planes(result):
    run = result("background")
    ax = plot.attraction(run)
    drawn, unit = lines(ax), unit_of(ax)
    asperities, force, voltage = (
        run[path].values for path in ("ensemble/adhesion_force_mean", "background/force", "background/electrostatic_force")
    )
    np.testing.assert_allclose(drawn["electrostatic"].get_ydata() * unit, voltage)
    np.testing.assert_allclose(drawn["together"].get_ydata() * unit, asperities + force)
    dispersion = run["background/van_der_waals_force"].values
    parts = [drawn[name].get_ydata() * unit for name in ("van der Waals", "van der Waals, taken off")]
    np.testing.assert_allclose(np.nan_to_num(parts[0]) - np.nan_to_num(parts[1]), dispersion)
    external = run["ensemble/contact_force_mean"].values - asperities - force
    np.testing.assert_allclose(run["ensemble/external_force_mean"].values, external, rtol=1e-9, atol=1e-9 * abs(external).max())


def test_every_key_of_a_sweep_can_be_the_axis(result):
    grid = result("grid_of_three")
    for x, curves in (("surface.lubricant_thickness", 6), ("material.work_of_adhesion", 4), ("material_hardness", 6)):
        ax = plot.sweep(grid, x=x)
        assert len(ax.containers) == curves
        assert len(ax.containers[0][0].get_xdata()) == grid.points.sizes[x.replace(".", "_")]
    by = plot.sweep(grid, x="material.work_of_adhesion", by="material.hardness")
    assert by.get_legend().get_title().get_text().startswith(grid["material_hardness"].attrs["long_name"])
    follows = plot.sweep(result("grid"), x="asperity_plasticity_index")
    places = result("grid").points["asperity_plasticity_index"]
    for container, lubricant in zip(follows.containers, range(places.sizes["surface_lubricant_thickness"]), strict=True):
        expected = np.sort(places.isel(surface_lubricant_thickness=lubricant).values)
        np.testing.assert_allclose(container[0].get_xdata(), expected, rtol=1e-12)
    # A figure by itself has the whole legend, on a page the first has it.
    alone, *_ = plot.page(grid, what="pull_off_scatter").axes
    first, second, *_ = plot.page(grid).axes
    names = [len(ax.get_legend().get_texts()) if ax.get_legend() else 0 for ax in (alone, first, second)]
    assert names == [6, 8, 0]
    with pytest.raises(FileError, match=r"x = replicas: not a key of this sweep; it has surface\.lubricant_thickness"):
        plot.sweep(grid, x="replicas")


def grid_spread(grid):
    """Standard deviation of the pull-off over the mean at each point, per cent."""
    forces = grid["replicas/pull_off_force"]
    return 100.0 * (forces.std("replica", ddof=1) / forces.mean("replica")).values


def test_a_heat_map_has_the_points_of_its_grid(result):
    grid = result("heat_map")
    assert "heat_map" in plot.panels(grid) and "heat_map" not in plot.panels(result("grid"))
    ax = plot.heat_map(grid, x="material.hardness")
    (mesh,) = ax.collections
    mean = grid.pull_off["mean_over_patches"].transpose("material_work_of_adhesion", "material_hardness").values
    cells = np.asarray(mesh.get_array()).reshape(mean.shape)
    np.testing.assert_allclose(cells / cells[0, 0], mean / mean[0, 0], rtol=1e-12)
    assert [tick.get_text() for tick in ax.get_xticklabels()] == ["1", "2", "4"] and "(GPa)" in ax.get_xlabel()
    # The pull-off spans more than one and a half decades, the plastic numbers of one column do not; a probability is from 0 to 1.
    assert mean.max() > 10**1.5 * mean.min() and isinstance(mesh.norm, LogNorm)
    spread = plot.heat_map(grid, quantity="pull_off_scatter").collections[0].norm
    assert not isinstance(spread, LogNorm) and (spread.vmin, spread.vmax) == (spread.vmin, pytest.approx(grid_spread(grid).max()))
    stuck = plot.heat_map(grid, quantity="stuck").collections[0].norm
    assert (type(stuck), stuck.vmin, stuck.vmax) == (Normalize, 0.0, 1.0)
    with pytest.raises(FileError, match="of a grid in which two keys vary; here vary material_work_of_adhesion"):
        plot.heat_map(result("sweep_of_one"))


def test_ticks_are_at_the_values_of_a_key(result):
    ax = plot.sweep(result("heat_map"), x="material.hardness")
    assert list(ax.get_xticks()) == [1.0, 2.0, 4.0] and [tick.get_text() for tick in ax.get_xticklabels()] == ["1", "2", "4"]
    assert not list(ax.get_xticks(minor=True))
    # Values spaced by factors are so on the axis, with the same ticks.
    ax = plot.sweep(result("judged"), x="material.work_of_adhesion")
    assert ax.get_xscale() == "log" and list(ax.get_xticks()) == pytest.approx([1.0, 10.0, 90.0])
    assert list(plot.preloads(result("preload")).get_xticks()) == pytest.approx([0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0])


def test_a_probability_is_drawn_from_0_to_1(result):
    drawn = [plot.stuck(result("device")), plot.snaps(result("instability")), plot.sweep(result("heat_map"), quantity="stuck")]
    assert [(ax.get_ylim(), ax.get_yscale()) for ax in drawn] == [((0.0, 1.0), "linear")] * 3


def test_no_curve_or_histogram_hides_another(result):
    """Curves of a sweep are moved aside by two points each, histograms are outlines that are filled thinly, and of jumps the first curve is widest."""
    ax = plot.sweep(result("heat_map"), x="material.work_of_adhesion", quantity="stuck")
    places = [curve[0].get_transform().transform((30.0, 0.5))[0] for curve in ax.containers]
    np.testing.assert_allclose(np.diff(places), 2.0 / 72.0 * ax.figure.dpi, rtol=1e-9)
    pairs = plot.pull_off(result("loop")).patches
    assert all(bar.get_facecolor()[3] < 0.5 and bar.get_edgecolor()[3] == 1.0 for bar in pairs)
    assert {(bar.get_edgecolor(), bar.get_linestyle() in ("-", (0, None))) for bar in pairs} == {(to_rgba(BLUE), True), (to_rgba(VERMILION), False)}
    widths = [line.get_linewidth() for label, line in lines(plot.snaps(result("instability"))).items() if label.startswith("snap-")]
    assert len(widths) == 3 and widths == sorted(set(widths), reverse=True)


def test_points_of_a_zip_that_share_places_are_curves_of_their_own(tmp_path):
    scene = {"sweep": {"mode": "zip", "material.work_of_adhesion": ["10 mJ/m^2", "30 mJ/m^2"] * 2, "surface.lubricant_thickness": ["0 nm"] * 2 + ["1 nm"] * 2}}
    tables = tomllib.loads((CONFIGS / "quick.toml").read_text(encoding="utf-8"))
    with stiction.run(tables | scene, tmp_path / "zip.h5", replicas=4) as zipped:
        ax = plot.sweep(zipped)
        assert [list(curve[0].get_xdata()) for curve in ax.containers] == [pytest.approx([10.0, 30.0])] * 2
        assert [words.get_text() for words in ax.get_legend().get_texts()][:2] == ["0 m", "1.00 nm"]


def test_figures_of_a_preload_name_it_and_the_restoring_force(result):
    sweep = result("pressed_sweep")
    group = sweep.group("instability")
    for preload, words in (("1 mN", "1.00 mN"), (None, "30.0 mN")):
        place = int(np.flatnonzero(np.isclose(group["preload"], 1e-3 if preload else 30e-3))[0])
        ax = plot.sweep(sweep, preload=preload)
        mean = group["pull_off_after_preload_mean"].isel(preload=place).values
        np.testing.assert_allclose(np.asarray(ax.containers[0][0].get_ydata()) * unit_of(ax), mean, rtol=1e-12)
        assert f"after {words}" in ax.get_ylabel()
        stuck = plot.sweep(sweep, quantity="stuck", preload=preload)
        np.testing.assert_allclose(stuck.containers[0][0].get_ydata(), sweep["device/stuck_probability_after_preload"].isel(preload=place), rtol=1e-15)
        assert " ".join(stuck.get_ylabel().split()) == f"probability to stay adhered under 100 µN after {words}"
    run = result("preload")
    after = run["replicas/pull_off_after_preload"].sel(preload=1e-3).values
    label = next(words for words in reported(plot.pull_off(run, preload="1 mN")) if words.startswith("mean over patches"))
    assert label == f"mean over patches, {quantities.with_error(after.mean(), after.std(ddof=1) / 2.0, 'N')}"


def test_no_panel_shows_rounding(result, tmp_path):
    with stiction.run(CONFIGS / "quick.toml", tmp_path / "a.h5", replicas=4, **{"model.law": "dmt", "model.history": "loop"}) as elastic:
        assert "contacts" in plot.panels(elastic) and "energy" not in plot.panels(elastic)
    assert "energy" in plot.panels(result("loop"))
    assert is_noise([1.0, 1.0 + 1e-15]) and is_noise([1e-12, -1e-13], 100.0) and not is_noise([1.0, 1.001])
    # Numbers that agree but for rounding lie on a line, in axes from 0 on.
    ax = pyplot.figure().add_subplot()
    steady(ax, [3.0, 3.0 + 1e-15])
    assert ax.get_ylim() == pytest.approx((0.0, 6.0))


def test_a_figure_of_a_run_needs_no_scipy(result):
    """What takes a third of the time to import is imported where it is needed."""
    code = f"import sys; from stiction.plot import page; import stiction; page(stiction.open_run({str(result('run').path)!r})); print('scipy.optimize' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}, check=True)
    assert done.stdout == "False\n"


def test_what_the_file_says_is_invalid_is_marked(result):
    """Case III: its whole curve; of a sweep the points of that verdict alone, and as cells of a map; nothing of a surface that is good."""
    mark = "invalid: not independent"
    run = result("instability")
    (line,) = [line for name, line in lines(plot.force(run)).items() if name == mark]
    closer = ~(run["ensemble/separation"].values >= float(run["independence/independent_from"]))
    assert run.independence.attrs["verdict"] == "invalid" and (np.isfinite(line.get_ydata()) == closer).all() and closer.any()
    assert mark not in lines(plot.force(result("run")))
    grid = result("judged")
    verdicts = grid["independence/verdict"].values.astype(str)
    assert 0 < (verdicts == "invalid").sum() < verdicts.size
    ax = plot.sweep(grid, x="material.work_of_adhesion")
    marked = [line for line in ax.lines if line.get_label() == mark]
    assert sum(np.isfinite(line.get_ydata()).sum() for line in marked) == (verdicts == "invalid").sum()
    assert [text.get_text() for text in ax.get_legend().get_texts()].count(mark) == 1
    cells = [patch for patch in plot.heat_map(grid).patches if patch.get_hatch()]
    assert len(cells) == (verdicts == "invalid").sum()


def test_points_of_a_sweep_are_its_means_and_its_integral(result):
    of = result("sweep")
    ax = plot.sweep(of)
    container = ax.containers[0]
    drawn = np.asarray(container[0].get_ydata(), float) * unit_of(ax)
    np.testing.assert_allclose(drawn, of.pull_off["mean_over_patches"].values, rtol=1e-12)
    np.testing.assert_allclose(container[0].get_xdata(), of.points["surface_lubricant_thickness"].values * 1e9, rtol=1e-12)
    integral = next(line for line in ax.lines if len(line.get_ydata()) == drawn.size and line is not container[0]
                    and line.get_linestyle() == "--")  # fmt: skip
    np.testing.assert_allclose(np.asarray(integral.get_ydata()) * unit_of(ax), of["integral/pull_off_force"].values, rtol=1e-12)


def test_a_choice_has_its_names_on_the_axis(result):
    for name, names in (("choice", ["none", "patch"]), ("comparison", ["hybrid", "emd", "fit:paper", "gw"])):
        ax = plot.sweep(result(name))
        assert [tick.get_text() for tick in ax.get_xticklabels()] == names
        assert ": 0" not in ax.get_xlabel()


def test_laws_are_compared_by_their_curves_and_pull_off_forces(result):
    of = result("comparison")
    ax, h_star = plot.comparison(of), of["integral/h_star"].values
    drawn = lines(ax)
    for law, x, force in zip(of["model_law"].values, h_star, of["integral/external_force"].values, strict=True):
        np.testing.assert_array_equal(drawn[law].get_xdata(), x)
        np.testing.assert_allclose(np.asarray(drawn[law].get_ydata()) * unit_of(ax), force, rtol=1e-12)
    dots = [line for line in ax.lines if line.get_marker() == "o"]
    for line, mean in zip(dots, of["ensemble/external_force_mean"].values, strict=True):
        np.testing.assert_allclose(np.asarray(line.get_ydata()) * unit_of(ax), mean[:: max(1, mean.size // 40)], rtol=1e-12)
    force = of["integral/pull_off_force"].values
    bars = plot.law_deviation(of).patches
    np.testing.assert_allclose([bar.get_width() for bar in bars[:3]], 100 * (force[:3] / force[0] - 1), rtol=1e-12)
    assert force[3] < 0.0 == bars[3].get_width()


@pytest.mark.parametrize("name", ["run", "loop", "retraction", "instability"])
def test_curves_bands_and_markers_of_forces_are_those_of_the_file(result, name):
    run = result(name)
    ax = run.plot.force()
    unit = unit_of(ax)
    loop = name in ("loop", "instability")
    prefix = "retraction_" if loop else ""
    mean = run[f"ensemble/{prefix}external_force_mean"].values
    curve = lines(ax)["retraction, mean" if loop else "mean over patches"]
    np.testing.assert_allclose(np.asarray(curve.get_ydata()) * unit, mean, rtol=1e-12)
    np.testing.assert_array_equal(curve.get_xdata(), run["ensemble/h_star"].values)
    # The widest band on this way is from the 5 % to the 95 % quantile: no mean less sigma.
    quantile = run[f"ensemble/{prefix}external_force_quantile"].transpose("quantile", "separation").values
    assert list(run["ensemble/quantile"].values) == [0.05, 0.25, 0.5, 0.75, 0.95]
    bands = [of.get_paths()[0].vertices[:, 1] * unit for of in ax.collections if isinstance(of, PolyCollection)]
    assert len(bands) == (4 if loop else 2)
    wide = bands[2 if loop else 0]
    assert wide.min() == pytest.approx(quantile[0].min()) and wide.max() == pytest.approx(quantile[4].max())
    # The marker of the pull-off sits on the curve.
    of = "mean" if run.after_largest_preload is None else "mean curve of the whole loop"
    marker = next(line for label, line in lines(ax).items() if label.startswith(f"pull-off of the {of}"))
    place, force = (float(of[0]) for of in marker.get_data())
    assert force * unit == pytest.approx(np.interp(place, run["ensemble/h_star"].values, mean), rel=1e-12)
    assert force * unit == pytest.approx(-run.pull_off.of_mean_curve, rel=0.03)


def test_the_second_approach_is_drawn_where_there_is_one(result):
    run = result("cycles")
    ax = run.plot.force()
    curve = lines(ax)["second approach, mean"]
    mean = run["ensemble/reapproach_external_force_mean"].values
    np.testing.assert_allclose(np.asarray(curve.get_ydata()) * unit_of(ax), mean, rtol=1e-12)
    assert not any(label.startswith("second") for label in lines(result("loop").plot.force()))
    assert abs(run["replicas/repeated_dissipated_energy"].values).max() < 1e-9 * run["replicas/dissipated_energy"].values.min()


def test_snap_in_is_a_marker_on_the_curve_of_approach(result):
    run = result("instability")
    ax = run.plot.force()
    (marker,) = (line for label, line in lines(ax).items() if label.startswith("snap-in"))
    place, force = (float(of[0]) for of in marker.get_data())
    snaps = run["replicas/snap_in_separation"].values / run.attrs["surface_height_std"]
    snapping = [np.nanmean(of) for of in snaps.reshape(snaps.shape) if np.isfinite(of).any()]
    if snaps.shape[0] == run.replicas.sizes["replica"]:
        snapping = [np.nanmean(of) for of in snaps.T if np.isfinite(of).any()]
    assert place == pytest.approx(snapping[0])
    mean = run["ensemble/external_force_mean"].values
    assert force * unit_of(ax) == pytest.approx(np.interp(place, run["ensemble/h_star"].values, mean))


def test_the_probability_to_stay_stuck_is_that_of_the_patches(result):
    run = result("device")
    ax = plot.stuck(run)
    (curve,) = (line for label, line in lines(ax).items() if label == "pull-off force above 600.0 µN")
    forces = run["replicas/pull_off_after_preload"].transpose("replica", "preload").values
    reached = np.isfinite(forces)
    expected = (forces > 0.6e-3).sum(axis=0)[reached.any(axis=0)] / reached.sum(axis=0)[reached.any(axis=0)]
    np.testing.assert_allclose(curve.get_ydata(), expected, rtol=1e-14)
    assert 0.0 < expected[0] < expected[-1] <= 1.0
    assert "restoring force, 600.0 µN" in lines(plot.preloads(run))


def test_a_band_is_left_out_when_asked_for(result):
    ax = plot.force(result("run"), band=False)
    assert not [of for of in ax.collections if isinstance(of, PolyCollection)]


def test_the_integral_alone_is_drawn_as_it_is(result):
    run = result("alone")
    ax = plot.integral(run)
    drawn = np.asarray(lines(ax)["integral, retraction"].get_ydata()) * unit_of(ax)
    np.testing.assert_allclose(drawn, run["integral/retraction_external_force"].values, rtol=1e-12)
    sweep = result("alone_sweep")
    ax = plot.sweep(sweep)
    drawn = np.asarray(ax.containers[0][0].get_ydata(), float) * unit_of(ax)
    np.testing.assert_allclose(drawn, sweep["integral/pull_off_force"].values, rtol=1e-12)
    assert list(plot.panels(sweep)) == ["pull_off_force", "pull_off_separation", "peak_secant_stiffness"]


def test_figures_name_what_a_law_leaves_out(result):
    run = result("ending_law")
    (warning,) = (text for text in run.warnings if text.endswith(run.left_out))
    count = int(run["replicas/asperity_count"].values[0])
    # The integral has the same asperities beyond the end of the law.
    left = count - float(run["integral/pull_off_regime_count"].values.sum())
    assert warning.startswith("the law ends") and run.left_out.startswith(f"{left:.0f} of {count} asperities ({100 * left / count:.2f} %) at pull-off")
    for draw in (plot.force, plot.integral):
        assert f"left out by the law:\n{run.left_out.split(' and ')[0]}" in reported(draw(run))
    assert not result("run").left_out and not [words for words in reported(plot.force(result("run"))) if "left out" in words]


def test_histograms_hold_every_patch_and_their_lines_are_the_numbers_to_quote(result):
    run = result("run")
    ax = run.plot.pull_off()
    assert sum(bar.get_height() for bar in ax.patches) == run.pull_off.replicas
    label = next(label for label in lines(ax) if label.startswith("mean over patches,"))
    assert label == f"mean over patches, {run.pull_off}"


def test_logarithmic_axes_where_the_data_ask(result):
    assert plot.regimes(result("run")).get_yscale() == "log"
    assert plot.force(result("run")).get_yscale() == "linear"
    sizes = finite_size.study(result("finite_size"))
    assert (plot.scatter(sizes).get_xscale(), plot.scatter(sizes).get_yscale()) == ("log", "log")
    assert plot.sweep(result("sweep")).get_xscale() == "linear"
    assert plot.sweep(result("grid_of_three"), x="material.work_of_adhesion").get_xscale() == "log"


def test_the_course_of_a_run_to_a_target_ends_at_its_mean_and_error(result):
    run = result("stopping")
    mean, error = (line.get_ydata()[-1] for line in (plot.convergence(run).lines[0], plot.standard_errors(run).lines[0]))
    scale = {"µ": 1e-6, "n": 1e-9}
    units = [scale[re.search(r"\((.)N\)", draw(run).get_ylabel())[1]] for draw in (plot.convergence, plot.standard_errors)]
    assert mean * units[0] == pytest.approx(float(run["ensemble/target_mean"][0]), rel=1e-9)
    assert error * units[1] == pytest.approx(float(run["ensemble/target_standard_error"][0]), rel=1e-9)


def test_a_coupled_run_is_drawn_beside_the_same_asperities_without_coupling(result):
    run = result("coupled")
    ax = run.plot.coupling()
    for label, path in (("coupled", "ensemble/external_force_mean"), ("independent", "coupling/independent_external_force_mean")):
        np.testing.assert_allclose(np.asarray(lines(ax)[label].get_ydata()) * unit_of(ax), run[path].values, rtol=1e-12)


def test_the_map_itself_is_drawn_with_its_asperities(result):
    of = result("asperities")
    ax = of.plot.asperities()
    (image,) = ax.images
    np.testing.assert_allclose(image.get_array() * 1e-9, of.map.values, rtol=1e-12)
    marks = ax.lines[0]
    assert marks.get_markerfacecolor() == "none" and marks.get_markeredgewidth() <= 0.5 and marks.get_markersize() <= 3.5
    x, y = marks.get_data()
    np.testing.assert_allclose(np.asarray(x) * 1e-6, of.asperities["x"].values, rtol=1e-12)
    np.testing.assert_allclose(np.asarray(y) * 1e-6, of.asperities["y"].values, rtol=1e-12)


def test_figures_are_drawn_into_given_axes(result):
    figure, (left, right) = pyplot.subplots(1, 2)
    run = result("run")
    assert run.plot.force(ax=left) is left and left.lines and not right.lines
    assert plot.pull_off(run, right) is right and right.patches
    assert pyplot.get_fignums() == [figure.number]
    with pytest.raises(AttributeError, match="no figure `bias` of this result; it has force, pull_off, regimes, deviation"):
        run.plot.bias()
    assert {"force", "pull_off"} <= set(dir(run.plot))


def test_widths_are_kept(result):
    assert plot.page(result("run"), "85mm").get_figwidth() == pytest.approx(85 / 25.4)
    assert plot.page(result("run")).get_figwidth() == pytest.approx(180 / 25.4)
    assert inches("8.5cm") == pytest.approx(85 / 25.4)
    for width in ("85 lines", "1mm", "-85mm", "5m"):
        with pytest.raises(ValueError, match="a length from 40mm to 1000mm is needed"):
            inches(width)


def test_text_of_svg_is_text_and_two_drawings_have_the_same_bytes(result, tmp_path):
    path = result("run").path
    for name in ("a.svg", "b.svg", "a.pdf", "b.pdf"):
        assert main([str(path), "--what", "force", "--width", "85mm", "-o", str(tmp_path / name)]) == 0
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert (tmp_path / "a.pdf").read_bytes() == (tmp_path / "b.pdf").read_bytes()
    svg = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert ">external force (" in svg and 'width="240.94' in svg


def test_a_partial_result_is_marked(result):
    marked = [text.get_text() for text in plot.page(result("partial")).texts]
    assert marked == [f"PARTIAL: {result('partial').attrs['replicas']} of 64 replicas"]
    assert plot.page(result("run")).texts == []


def test_a_title_is_there_when_asked_for(result):
    assert plot.page(result("run"), title=True).get_suptitle() == result("run").title


def test_the_command_draws_beside_the_file(result, tmp_path, capsys):
    copy = result("run").save(tmp_path / "a.h5")
    assert main([str(copy)]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'a.png'}\n"
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    # A picture that is there stays.
    (tmp_path / "a.png").write_text("mine")
    assert main([str(copy)]) == 2
    assert capsys.readouterr().err == f"stiction plot: {tmp_path / 'a.png'}: exists; --force overwrites it\n"
    assert (tmp_path / "a.png").read_text() == "mine"
    assert main([str(copy), "--force"]) == 0
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG") and capsys.readouterr().out
    assert main([str(copy), str(copy), "--force"]) == 2
    assert "would be written twice" in capsys.readouterr().err
    assert main([str(copy), "--what", "list"]) == 0
    assert capsys.readouterr().out.split() == ["force", "pull_off", "regimes", "deviation"]


@pytest.mark.parametrize(
    "name, arguments, code, message",
    [
        ("run", ["--what", "forces"], 2, "forces: no figure of this result, is force meant? it has force, pull_off, regimes, deviation"),
        ("heat_map", ["--what", "stuck_probability"], 2, "stuck_probability: no figure of this result, is stuck meant?"),
        ("run", ["--x", "material.hardness"], 2, "x: this is no sweep, whose keys it names"),
        ("run", ["--preload", "1 mN"], 2, "preload = 1 mN: the file has none"),
        ("preload", ["--what", "preloads", "--preload", "1 mN"], 2, "preload: it is of force_curve and pull_off alone, and none of these is drawn"),
        ("pressed_sweep", ["--preload", "3 mN"], 2, "preload = 3 mN: the file has 1.000 mN, 30.00 mN, 10.00 N; name one of them"),
        ("sweep", ["--x", "material.hardness"], 2, "not a key of this sweep; it has surface.lubricant_thickness"),
        ("run", ["-o", "none/a.png"], 2, "none/a.png: there is no folder none"),
    ],
)
def test_what_is_wrong_is_reported_in_one_line(result, name, arguments, code, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([str(result(name).path), *arguments]) == code
    reported = capsys.readouterr().err
    assert reported.startswith("stiction plot: ") and message in reported and reported.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["a.h5", "b.h5", "-o", "a.png"], "--output is for one file"),
        (["a.h5", "-o", "a.gif"], "--output a.gif: a name that ends with .png, .pdf, .svg is needed"),
        (["a.h5", "--width", "5 miles"], "--width = 5 miles: a length from 40mm to 1000mm is needed"),
        (["a.h5", "--dpi", "0"], "--dpi 0: a number from 10 to 2400 is needed"),
        ([], "the following arguments are required: FILE"),
    ],
)
def test_wrong_commands_end_with_two(arguments, message, capsys):
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2 and message in capsys.readouterr().err


def test_files_of_others_are_refused(tmp_path, capsys):
    assert main([str(tmp_path / "none.h5")]) == 2
    (tmp_path / "text.h5").write_text("no")
    assert main([str(tmp_path / "text.h5")]) == 2
    assert capsys.readouterr().err.splitlines() == [
        f"stiction plot: {tmp_path / 'none.h5'}: no such file",
        f"stiction plot: {tmp_path / 'text.h5'}: not an HDF5 file",
    ]


def test_the_style_sheet_is_part_of_the_package():
    sheet = Path(stiction.__file__).parent / "plot" / "stiction.mplstyle"
    with pyplot.style.context(str(sheet)):
        assert pyplot.rcParams["svg.fonttype"] == "none" and pyplot.rcParams["font.size"] == 8.0


def test_numbers_have_no_computer_notation():
    assert quantities.number(1730.0, 2) == "1700" and quantities.number(0.0) == "0"
    assert "e" not in "".join(quantities.number(10.0**k) for k in range(-20, 20))


def test_the_restoring_force_stands_in_the_histogram_of_pull_offs(result):
    run = result("device")
    ax = plot.pull_off(run)
    share = float(run.after_preload()["stuck_probability"])
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert f"restoring force, 600 µN: {quantities.number(100.0 * share, 3)} % above" in words
    forces = run["replicas/pull_off_after_preload"].sel(preload=run.after_preload()["preload"]).values
    assert share == np.mean(forces > 6e-4)


def test_a_heat_map_writes_no_number_that_its_cells_cut(result):
    """Many narrow cells have colours alone and turned ticks; where there is room numbers stand in them."""
    sweep = result("heat_map")
    for width, count in ((7.0, 9), (0.8, 0)):
        figure = pyplot.figure(figsize=(width, 2.0))
        ax = plot.heat_map(sweep, ax=figure.add_subplot())
        assert len(ax.texts) == count, width
        assert {text.get_rotation() for text in ax.get_xticklabels()} == ({0.0} if count else {40.0})
        pyplot.close(figure)
