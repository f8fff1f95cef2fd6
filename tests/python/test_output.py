"""What a result file holds, read with h5py and xarray and checked with numpy, independently of the program.

Needs the packages of scripts/requirements.txt. The program is $STICTION, by default target/release/stiction:

    cargo build --release
    python -m pytest tests/python
"""

import datetime
import re
import subprocess
import warnings
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.stats
import stiction.plot
import xarray
from program import PATCH, PROGRAM, ROOT, close, documented_version, run_scene


REPLICAS, SEPARATIONS, ASPERITIES, SEED = 20, 15, 2217, 7
REGIMES = ["noncontact", "lubricant", "elastic", "elastoplastic1", "elastoplastic2", "plastic"]
SCENE = f"""# A small patch of 300 \u00b5m\u00b2
format = 1
title = "Test patch"

{PATCH}
[model]
law = "hybrid"
history = "approach"

[separation]
h_star = {{ from = 1.0, to = 4.5, count = {SEPARATIONS} }}

[ensemble]
replicas = {REPLICAS}
seed = {SEED}

[output]
curves = true
"""

QUANTITIES = ["adhesion_force", "contact_force", "external_force", "contact_area"]
PLACES = ["separation", "h_star", "asperity_separation"]
REGIONS = ["regime_count", "regime_adhesion_force", "regime_external_force"]
# What this run has outside /diagnostics.
NAMES = {
    "ensemble": [
        *PLACES, "regime", "scalar", "range_end", "control", "quantile", "external_force_quantile",
        *(f"{name}_{of}" for name in QUANTITIES for of in ("mean", "standard_error", "std")), *(f"{name}_mean" for name in REGIONS),
        *(f"scalar_{of}" for of in ("units", "mean", "standard_error", "interval", "controlled_mean", "controlled_interval",
                                    "controlled_standard_error", "variance_reduction", "most_differing")),
    ],
    "pull_off": ["pull_off_quantile", "range_end", "force_quantile", "force_quantile_interval"],
    "replicas": [
        *PLACES, "replica", "asperity_count", "highest_asperity", "external_force", "adhesion_force", "pull_off_force",
        "pull_off_separation", "peak_secant_stiffness", "peak_secant_stiffness_separation",
    ],
    "integral": [
        *PLACES, "regime", *QUANTITIES, *(f"{name}_std" for name in QUANTITIES), *REGIONS, "pull_off_contact_area",
        "pull_off_regime_count", "pull_off_regime_adhesion_force",
    ],
    "validation": [*PLACES, "component", *(f"{of}_{name}_force" for of in ("z", "tested", "probe") for name in ("adhesion", "external"))],
    "independence": [
        "patch_side", "substrate_stiffness", "shift", "relative_shift", "attractive_stiffness", "relative_attractive_stiffness",
        "fluctuation", "relative_fluctuation", "longest_stable_wavelength", "contact_share", "closest_shift", "relative_closest_shift",
        "independent_from", "greenwood_tripp_mu", "fuller_tabor_theta",
    ],
}  # fmt: skip


def documented() -> dict[str, tuple]:
    """Dimensions and units of the datasets of this run by docs/format/*.md; no units where rows have their own."""
    pages, found = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs" / "format").glob("*.md")), {}
    for group, table in re.findall(r"<!-- schema: run (\w+) -->(.*?)<!-- end -->", pages, re.DOTALL):
        for name, dimensions, units in re.findall(r"^\| `(\w+)` \| (.*?) \| (.*?) \|", table, re.MULTILINE):
            if name in NAMES.get(group, []):
                found[f"{group}/{name}"] = tuple(re.findall(r"`(\w+)`", dimensions)), None if "`" in units else units
    return found


DATASETS = documented()
GROUPS = ["ensemble", "replicas", "integral", "independence", "validation"]


def run_program(folder: Path, text: str) -> Path:
    """Runs a scene; nothing but its result may be left."""
    path, _ = run_scene(folder, text)
    assert sorted(file.name for file in folder.iterdir()) == ["result.h5", "scene.toml"]
    return path


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Path:
    """The result of the scene."""
    return run_program(tmp_path_factory.mktemp("run"), SCENE)


@pytest.fixture(scope="module")
def file(path):
    with h5py.File(path, "r") as file:
        yield file


def minimum(places, values) -> tuple[float, float]:
    """Place and value of a sampled minimum: the vertex of the parabola through it and its neighbours."""
    k = int(np.argmin(values))
    if k in (0, len(values) - 1):
        return places[k], values[k]
    x = places[k - 1 : k + 2] - places[k]
    a, b, c = np.linalg.solve(np.vander(x / x[2]), values[k - 1 : k + 2])
    return places[k] - x[2] * b / (2 * a), c - b * b / (4 * a)


# Layout


def test_root_attributes(file):
    attributes = file.attrs
    for name in ["format", "program_version", "source_revision", "source_hash", "created", "title", "scene", "law", "history"]:
        assert isinstance(attributes[name], str), name
    assert attributes["format"] == "stiction-run"
    assert list(attributes["format_version"]) == documented_version("format.md")
    assert np.issubdtype(attributes["format_version"].dtype, np.integer)
    assert re.fullmatch(r"\d+\.\d+\.\d+.*", attributes["program_version"])
    assert re.fullmatch(r"[0-9a-f]{7,}(-modified)?|unknown", attributes["source_revision"])
    assert re.fullmatch(r"[0-9a-f]{16}", attributes["source_hash"])
    assert attributes["title"] == "Test patch"
    assert attributes["scene"] == SCENE
    assert (attributes["law"], attributes["history"]) == ("hybrid", "approach")
    assert attributes["sampling"] == "independent"
    for name, value in [("seed", SEED), ("replicas", REPLICAS)]:
        assert isinstance(attributes[name], np.integer) and attributes[name] == value
    for name in ["adhesion_parameter", "asperity_plasticity_index", "plasticity_index", "critical_interference",
                 "surface_height_std", "asperity_height_std", "mean_plane_offset", "nominal_area"]:
        assert isinstance(attributes[name], np.float64) and attributes[name] > 0.0, name
    for index, std in [("asperity_plasticity_index", "asperity_height_std"), ("plasticity_index", "surface_height_std")]:
        expected = np.sqrt(attributes[std] / attributes["critical_interference"])
        assert attributes[index] == pytest.approx(expected, rel=1e-14)
    assert attributes["nominal_area"] == pytest.approx(300e-12, rel=1e-14)
    assert attributes["surface_height_std"] == pytest.approx(1.619e-9, rel=1e-14)


def test_created_is_the_time_of_the_run_in_utc(file):
    created = re.fullmatch(r"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d)(\.\d+)?(Z|\+00:00)", file.attrs["created"])
    assert created, file.attrs["created"]
    time = datetime.datetime.fromisoformat(created[1] + "+00:00")
    assert abs(datetime.datetime.now(datetime.timezone.utc) - time) < datetime.timedelta(hours=1)


def test_datasets_are_those_of_the_layout(file):
    found = []
    file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
    named = {f"{group}/{name}" for group, names in NAMES.items() for name in names}
    assert {name for name in found if not name.startswith("diagnostics/")} == named == set(DATASETS)


def test_every_dataset_says_its_units_and_meaning(file):
    def check(name, item):
        if isinstance(item, h5py.Dataset):
            listed = name in DATASETS and DATASETS[name][1] is None
            for attribute in ["coordinates" if listed else "units", "long_name"]:
                text = item.attrs[attribute]
                assert isinstance(text, str) and text.strip(), (name, attribute)
            if name in DATASETS:
                assert item.attrs.get("units") == DATASETS[name][1], name
            if listed:
                assert item.attrs["coordinates"] == "scalar_units", name

    file.visititems(check)


def test_every_dimension_has_its_scale(file):
    sizes = {"separation": SEPARATIONS, "regime": len(REGIMES), "replica": REPLICAS}
    for name, (dimensions, _) in DATASETS.items():
        dataset = file[name]
        assert dataset.ndim == len(dimensions), name
        for size, scales, dimension in zip(dataset.shape, dataset.dims, dimensions):
            assert size == sizes.get(dimension, size), name
            group, _, last = name.rpartition("/")
            if last == dimension:
                assert dataset.is_scale
            else:
                assert list(scales.keys()) == [dimension], name
                assert scales[0].name == f"/{group}/{dimension}"
                assert size == scales[0].shape[0]


def test_scales_hold_what_they_name(file):
    assert list(file["ensemble/regime"].asstr()[()]) == REGIMES
    assert list(file["replicas/replica"][()]) == list(range(REPLICAS))
    h_star, sigma = file["ensemble/h_star"][()], file.attrs["surface_height_std"]
    assert close(h_star, np.linspace(1.0, 4.5, SEPARATIONS), 4.5)
    assert close(file["ensemble/separation"][()], h_star * sigma, sigma * 4.5)
    offset = file["ensemble/separation"][()] - file["ensemble/asperity_separation"][()]
    assert close(offset, file.attrs["mean_plane_offset"], sigma)


def test_quantiles_are_those_of_the_curves(file):
    probabilities, curves = file["ensemble/quantile"][()], file["replicas/external_force"][()]
    assert list(probabilities) == [0.05, 0.25, 0.5, 0.75, 0.95]
    size = np.abs(curves).max(axis=0)
    assert close(file["ensemble/external_force_quantile"][()], np.quantile(curves, probabilities, axis=0), size, 1e-14)


def test_warnings_are_those_of_check(file):
    reported = subprocess.run([PROGRAM, "check", "-"], input=SCENE, capture_output=True, text=True, check=True).stdout
    findings = [" ".join(text.split()) for text in reported.split("  warning  ")[1:]]
    warnings = file.attrs["warnings"].splitlines()
    assert len(findings) == len(warnings) > 0
    assert all(finding.startswith(warning) for finding, warning in zip(findings, warnings, strict=True))


def test_replica_curves_are_chunked_and_compressed(file):
    for name in ["replicas/external_force", "replicas/adhesion_force"]:
        assert file[name].chunks is not None and file[name].compression == "gzip"
        assert np.all(np.isfinite(file[name][()]))


# xarray


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
@pytest.mark.parametrize("group", [None, *GROUPS, "diagnostics"])
def test_xarray_opens_every_group(path, engine, group):
    with xarray.open_dataset(path, engine=engine, group=group) as run:
        assert not [name for name in run.sizes if name.startswith("phony")]
        prefix = f"{group}/" if group else ""
        expected = {name for name in DATASETS if name.rpartition("/")[0] == (group or "")}
        if group != "diagnostics":
            assert {prefix + str(name) for name in run.variables} == expected
        for name, variable in run.variables.items():
            listed = name in run.data_vars and "scalar_units" in run[name].coords
            assert variable.attrs["long_name"] and (listed or variable.attrs["units"]), name
            if group != "diagnostics":
                assert variable.dims == DATASETS[prefix + name][0], name
        if group == "ensemble":
            names = list(run.regime.values)
            assert names == REGIMES and all(isinstance(name, str) for name in names)
            assert {"h_star", "asperity_separation", "scalar_units"} <= set(run.coords)
            assert {"separation", "h_star"} <= set(run.external_force_mean.coords)
        if group is None:
            assert not run.variables and run.attrs["title"] == "Test patch"


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_groups_have_the_coordinates_of_their_datasets_and_no_others(path, file, engine):
    with xarray.open_datatree(path, engine=engine) as run:
        mean = run["ensemble"].external_force_mean
        assert np.array_equal(mean.separation, file["ensemble/separation"][()])
        assert np.array_equal(run["replicas"].external_force.h_star, file["ensemble/h_star"][()])
        assert set(run["replicas"].dims) == {"replica", "separation"}
        tables = [run[group].to_dataset() for group in run.groups[1:] if run[group].dims]
        assert all(len(table.to_dataframe()) < 20000 for table in tables)
        elastic = run["ensemble"].regime_count_mean.sel(regime="elastic")
        assert np.array_equal(elastic, file["ensemble/regime_count_mean"][2])


# Numbers


def test_ensemble_is_the_moments_of_the_replicas(file):
    assert np.all(file["replicas/asperity_count"][()] == ASPERITIES)
    for name in ["external_force", "adhesion_force"]:
        curves = file[f"replicas/{name}"][()]
        mean, std = curves.mean(axis=0), curves.std(axis=0, ddof=1)
        assert close(file[f"ensemble/{name}_mean"][()], mean, np.abs(mean).max())
        assert close(file[f"ensemble/{name}_std"][()], std, std.max())
    for name in QUANTITIES:
        std = file[f"ensemble/{name}_std"][()]
        assert np.all(std > 0.0)
        assert close(file[f"ensemble/{name}_standard_error"][()], std / np.sqrt(REPLICAS), std)


def hall(sample: np.ndarray, freedom: int) -> list[float]:
    """The 95 % interval of a mean after P. Hall, J. R. Statist. Soc. B 54 (1992) 221: where his polynomial is the quantile of Student's t."""
    a = scipy.stats.skew(sample, bias=False) / np.sqrt(sample.size)
    error = sample.std(ddof=1) / np.sqrt(sample.size)

    def end(quantile: float) -> float:
        roots = np.roots([a**2 / 27.0, a / 3.0, 1.0, a / 6.0 - quantile])
        return sample.mean() - error * roots[np.argmin(abs(roots.imag))].real

    return [end(scipy.stats.t.ppf(probability, freedom)) for probability in [0.975, 0.025]]


def check_controlled_means(file, group: int, controls: int):
    """The means of the scalars with control variates: each part of the sample at the integral's forces by the regression of the others."""
    units = {"pull_off_force": "N", "pull_off_separation": "m", "peak_secant_stiffness": "N m-1",
             "peak_secant_stiffness_separation": "m"}
    names = list(file["ensemble/scalar"].asstr()[()])
    assert names == list(units) and list(file["ensemble/scalar_units"].asstr()[()]) == list(units.values())
    places = np.searchsorted(file["ensemble/separation"][()], file["ensemble/control"][()])
    assert np.array_equal(file["ensemble/separation"][()][places], file["ensemble/control"][()])
    means = lambda values: values.reshape(-1, group, *values.shape[1:]).mean(axis=1)
    forces, expected = means(file["replicas/external_force"][:, places]), file["integral/external_force"][()][places]
    n, k = forces.shape
    assert k == controls
    scale = forces.std(axis=0)
    parts = np.arange(n) * group // 8 % 16  # batches of 8 replicas in turn
    design = np.column_stack([np.ones(n), (forces - expected) / scale])
    for i, name in enumerate(names):
        values, scalar = means(file[f"replicas/{name}"][()]), {
            part: file[f"ensemble/scalar_{part}"][i]
            for part in ["mean", "standard_error", "controlled_mean", "controlled_standard_error", "variance_reduction"]
        }
        error = values.std(ddof=1) / np.sqrt(n)
        assert scalar["mean"] == pytest.approx(values.mean(), rel=1e-12)
        assert scalar["standard_error"] == pytest.approx(error, rel=1e-9)
        adjusted = np.empty(n)
        for part in set(parts):
            own, others = parts == part, parts != part
            slopes = np.linalg.lstsq(design[others], values[others], rcond=None)[0][1:]
            adjusted[own] = values[own] - design[own, 1:] @ slopes
        variance = adjusted.var(ddof=1) / n
        assert scalar["controlled_mean"] == pytest.approx(adjusted.mean(), abs=1e-6 * error)
        assert scalar["controlled_standard_error"] == pytest.approx(np.sqrt(variance), rel=1e-6)
        intervals = {"interval": (values, n - 1), "controlled_interval": (adjusted, n - 1 - k)}
        for part, (sample, freedom) in intervals.items():
            found = file[f"ensemble/scalar_{part}"][i]
            assert found == pytest.approx(hall(sample, freedom), abs=1e-5 * error), (name, part)
        assert scalar["variance_reduction"] == pytest.approx(error**2 / variance, rel=1e-6)


def test_controlled_means(file):
    check_controlled_means(file, 1, 2)


@pytest.mark.parametrize("sampling, group, replicas, controls", [("antithetic", 2, 60, 3), ("stratified", 8, 160, 2)])
def test_sampling_schemes(tmp_path, sampling, group, replicas, controls):
    text = SCENE.replace(f"replicas = {REPLICAS}", f'replicas = {replicas}\nsampling = "{sampling}"')
    with h5py.File(run_program(tmp_path, text), "r") as file:
        assert file.attrs["sampling"] == sampling
        check_controlled_means(file, group, controls)
        curves = file["replicas/external_force"][()]
        means = curves.reshape(-1, group, curves.shape[1]).mean(axis=1)
        groups = len(means)
        error = means.std(axis=0, ddof=1) / np.sqrt(groups)
        assert close(file["ensemble/external_force_standard_error"][()], error, error, 1e-9)
        assert close(file["ensemble/external_force_std"][()], curves.std(axis=0, ddof=1), curves.std(axis=0), 1e-9)
        z = (curves.mean(axis=0) - file["integral/external_force"][()]) / error
        assert close(file["validation/z_external_force"][()], z, 1.0, 1e-6)
        probes = {name: file[f"validation/probe_{name}"][()] for name in ["external_force", "adhesion_force"]}
        scores = sum(file[f"replicas/{name}"][()] @ probe.T for name, probe in probes.items())
        scores = scores.reshape(groups, group, -1).mean(axis=1)
        covariance = np.atleast_2d(np.cov(scores, rowvar=False))
        k = scores.shape[1]
        # What chance leaves of the mean of a group is 1/n of the variance of a replica's worth of it, on average over the scores to
        # 5 standard errors (the seed is fixed).
        assert k >= 1 and file["validation"].attrs["degrees_of_freedom"] == k
        assert abs(np.trace(covariance) * group / k - 1.0) < 5.0 * np.sqrt(2.0 / groups)


def test_sums_by_moments(file, tmp_path):
    """Sums say how they were made and how far off they are; replicas are those of direct sums to the tolerance."""
    assert file["ensemble"].attrs["summation"] == "direct" and "sum_error" not in file["ensemble"].attrs
    text = SCENE.replace("[output]", '[solver]\nsummation = "moments"\ntolerance = 1e-8\n\n[output]')
    path = run_program(tmp_path, text)
    with h5py.File(path, "r") as by_moments:
        attributes = by_moments["ensemble"].attrs
        assert attributes["summation"] == "moments" and "sum_refusal" not in attributes
        for name in ["sum_tolerance", "sum_error"]:
            assert isinstance(attributes[name], np.float64), name
        assert attributes["sum_tolerance"] == 1e-8 and 0.0 < attributes["sum_error"] <= 1e-8
        assert by_moments["diagnostics/moment_sums"][()] == REPLICAS * SEPARATIONS
        assert file["diagnostics/moment_sums"][()] == 0
        sets = ["baseline", "avx2", "avx512"]
        assert all(run["diagnostics"].attrs["instruction_set"] in sets for run in [file, by_moments])
        adhesion = file["replicas/adhesion_force"][()]
        scale = 2 * adhesion + file["replicas/external_force"][()]
        # The scale may also be that of the separations beside.
        scale = np.max([scale, np.roll(scale, 1, axis=1), np.roll(scale, -1, axis=1)], axis=0)
        assert close(by_moments["replicas/adhesion_force"][()], adhesion, scale, 1e-8)
        assert close(by_moments["replicas/external_force"][()], file["replicas/external_force"][()], scale, 1e-8)
        assert np.any(by_moments["replicas/adhesion_force"][()] != adhesion)
        for name in ["ensemble/regime_count_mean", "replicas/highest_asperity"]:
            assert np.array_equal(by_moments[name][()], file[name][()]), name
    with xarray.open_dataset(path, group="ensemble", engine="h5netcdf") as ensemble:
        assert ensemble.attrs["summation"] == "moments" and ensemble.attrs["sum_tolerance"] == 1e-8


def test_sums_that_were_refused(tmp_path):
    """Separations without a common step are summed directly, and the file says why."""
    places = ", ".join(str(1.0 + 0.25 * k + 0.01 * k * k) for k in range(SEPARATIONS))
    text = SCENE.replace(f"{{ from = 1.0, to = 4.5, count = {SEPARATIONS} }}", f"[{places}]")
    text = text.replace("[output]", '[solver]\nsummation = "moments"\n\n[output]')
    with h5py.File(run_program(tmp_path, text), "r") as file:
        attributes = file["ensemble"].attrs
        assert attributes["summation"] == "direct" and attributes["sum_tolerance"] == 1e-9
        assert np.isnan(attributes["sum_error"]) and "not evenly spaced" in attributes["sum_refusal"]


def test_features_of_the_mean_curve_and_the_integral(file, tmp_path):
    """They do not depend on the separations: 0.25 apart, against parabolas through samples 25 times closer."""
    coarse = f"from = 1.0, to = 4.5, count = {SEPARATIONS}"
    fine = run_program(tmp_path, SCENE.replace(coarse, "from = 1.0, to = 4.5, count = 351"))
    with h5py.File(fine, "r") as fine:
        h, sigma = fine["ensemble/separation"][()], fine.attrs["surface_height_std"]
        # The mean curve is jagged, and between coarse separations known through its deviation from the integral only.
        for group, name, tolerance in [("ensemble", "external_force_mean", 0.03), ("integral", "external_force", 1e-5)]:
            curve, features = fine[f"{group}/{name}"][()], file[group].attrs
            place, value = minimum(h, curve)
            assert features["pull_off_force"] == pytest.approx(-value, rel=tolerance)
            assert abs(features["pull_off_separation"] - place) < 2.0 * tolerance**0.5 * sigma
        place, value = minimum(0.5 * (h[1:] + h[:-1]), -np.diff(curve) / np.diff(h))
        assert features["peak_stiffness"] == pytest.approx(-value, rel=1e-4)
        assert abs(features["peak_stiffness_separation"] - place) < 0.01 * sigma


def test_features_of_each_replica(file):
    h, replicas = file["ensemble/separation"][()], file["replicas"]
    for i, curve in enumerate(replicas["external_force"][()]):
        pull_off, place = replicas["pull_off_force"][i], replicas["pull_off_separation"][i]
        assert -curve.min() * (1 - 1e-12) <= pull_off <= -1.25 * curve.min()
        assert abs(place - h[curve.argmin()]) <= 2.0 * (h[1] - h[0])


def test_the_stiffness_of_a_replica_is_that_of_its_finely_sampled_curve(file, tmp_path):
    """The same surfaces on separations 25 times closer, over a span of ten of their steps: samples may miss the largest secant by a little, but
    do not exceed it, and the separations do not decide what it is."""
    span = f'{0.1e9 * file.attrs["surface_height_std"]:.12g} nm'
    coarse = f"h_star = {{ from = 1.0, to = 4.5, count = {SEPARATIONS} }}"
    assert coarse in SCENE
    with_span = f'stiffness_span = "{span}"\n' + coarse
    texts = [SCENE.replace(coarse, with_span.replace(f"count = {SEPARATIONS}", f"count = {n}")) for n in (SEPARATIONS, 351)]
    folders = [tmp_path / "coarse", tmp_path / "fine"]
    for folder in folders:
        folder.mkdir()
    results = [run_program(folder, text) for folder, text in zip(folders, texts)]
    with h5py.File(results[0], "r") as coarse, h5py.File(results[1], "r") as fine:
        stiffness = coarse["replicas/peak_secant_stiffness"][()]
        assert coarse.attrs["stiffness_span"] == pytest.approx(0.1 * file.attrs["surface_height_std"])
        assert fine["replicas/peak_secant_stiffness"][()] == pytest.approx(stiffness, rel=1e-6)
        force, h = fine["replicas/external_force"][()], fine["ensemble/separation"][()]
    sampled = ((force[:, 10:] - force[:, :-10]) / (h[10:] - h[:-10])).max(axis=1)
    assert np.all((sampled <= stiffness * (1 + 1e-9)) & (sampled > 0.9 * stiffness)), sampled / stiffness


def test_pull_off_of_a_replica_is_that_of_its_finely_sampled_curve(file, tmp_path):
    """The same surfaces, which the seed decides, with 25 times as many separations around the pull-off."""
    coarse = f"from = 1.0, to = 4.5, count = {SEPARATIONS}"
    fine = run_program(tmp_path, SCENE.replace(coarse, "from = 2.0, to = 4.2, count = 221"))
    with h5py.File(fine, "r") as fine:
        assert np.array_equal(fine["replicas/highest_asperity"][()], file["replicas/highest_asperity"][()])
        sampled = -fine["replicas/external_force"][()].min(axis=1)
    # Samples miss the deepest point by up to one asperity's jump, so the pull-off may be larger than theirs.
    excess = file["replicas/pull_off_force"][()] / sampled - 1.0
    assert np.all((excess > -0.01) & (excess < 0.025)), excess


def test_highest_asperities_are_extremes_of_a_gaussian(file):
    highest = file["replicas/highest_asperity"][()] / file.attrs["asperity_height_std"]
    probability = scipy.stats.norm.cdf(highest) ** ASPERITIES  # uniform over replicas
    assert scipy.stats.kstest(probability, "uniform").pvalue > 1e-4
    assert len(set(highest)) == REPLICAS


def test_z_scores(file):
    for name in ["external_force", "adhesion_force"]:
        mean, integral = file[f"ensemble/{name}_mean"][()], file[f"integral/{name}"][()]
        z = np.sqrt(REPLICAS) * (mean - integral) / file[f"integral/{name}_std"][()]
        assert close(file[f"validation/z_{name}"][()], z, 1.0)
        assert np.all(np.abs(z) < 6.0)


def test_joint_test(file):
    group = file["validation"]
    probes = {name: group[f"probe_{name}"][()] for name in ["external_force", "adhesion_force"]}
    scores = sum(file[f"replicas/{name}"][()] @ probe.T for name, probe in probes.items())
    expected = sum(probe @ file[f"integral/{name}"][()] for name, probe in probes.items())
    n, k = scores.shape
    assert k >= 1 and group.attrs["degrees_of_freedom"] == k
    difference = scores.mean(axis=0) - expected
    statistic = n * difference @ difference
    # Edgeworth's expansion of the sum of squares of almost Gaussian scores.
    s = [scipy.stats.chi2.sf(statistic, k + 2 * j) for j in range(4)]
    correction = group.attrs["kurtosis"] / n / 8 * (s[2] - 2 * s[1] + s[0])
    correction += group.attrs["skewness"] / n / 24 * (s[3] - 3 * s[2] + 3 * s[1] - s[0])
    p_value = s[0] * np.exp(correction / s[0])
    assert group.attrs["statistic"] == pytest.approx(statistic, rel=1e-6)
    assert group.attrs["p_value"] == pytest.approx(p_value, abs=1e-6)
    assert group.attrs["verdict"] == ("agree" if p_value >= group.attrs["significance"] else "disagree")
    for name, probe in probes.items():
        tested = group[f"tested_{name}"][()]
        assert set(tested) <= {0, 1} and np.all(probe[:, tested == 0] == 0.0)


# Pictures


@pytest.fixture
def drawn(tmp_path):
    """Draws the page of a result; a warning is an error."""

    def draw(path: Path) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            stiction.plot.page(stiction.open_run(path)).savefig(tmp_path / "page.png", dpi=40)

    return draw


def test_one_dry_elastic_replica_can_be_tested_and_plotted(tmp_path, drawn):
    text = SCENE.replace('lubricant_thickness = "0.5 nm"', "").replace('law = "hybrid"', 'law = "emd"')
    path = run_program(tmp_path, text.replace(f"replicas = {REPLICAS}", "replicas = 1"))
    with h5py.File(path, "r") as file:
        assert list(file["ensemble/regime"].asstr()[()]) == REGIMES[:3]
        assert np.all(file["ensemble/regime_adhesion_force_mean"][1] == 0.0)
        assert np.all(np.isnan(file["ensemble/external_force_std"][()]))
        assert np.all(np.isfinite(file["validation/z_external_force"][()]))
        # A single replica of many asperities has a distribution by the law; a false alarm once in 1000, the seed is fixed.
        assert file["validation"].attrs["verdict"] == "agree"
        assert 0.001 <= file["validation"].attrs["p_value"] <= 1.0
    drawn(path)


SPANS = dict(zip(REGIMES, [(1.5, 2.5), (0.4, 0.65), (-2, 0.1), (-12, -3), (-200, -20), (-400, -260)]))
slow = pytest.mark.slow


@pytest.mark.parametrize("sums", ["direct", pytest.param("moments", marks=slow)])
@pytest.mark.parametrize("low, high", [pytest.param(*span, marks=[slow] * (span[0] < -100), id=name) for name, span in SPANS.items()])
def test_one_regime_alone_can_be_plotted(tmp_path, drawn, low, high, sums):
    """Heights within some picometres: every asperity is in one regime at all separations, and in the lubricant nothing varies."""
    heights = 'asperity_height_std = "5 pm"\nmean_plane_offset = "0 nm"\nnominal_area'
    scene = SCENE.replace("nominal_area", heights)
    scene = re.sub(r"(?m)^h_star = .*", f'h = {{ from = "{low} nm", to = "{high} nm", count = 21 }}', scene)
    drawn(run_program(tmp_path, scene + f'\n[solver]\nsummation = "{sums}"\n'))
