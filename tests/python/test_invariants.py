"""What holds of the datasets that the shipped scenes write: finite, ordered, of their sign, and sums that add
up. Rules go by names, so that a new dataset has one; only one of either sign or with gaps needs a word here."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy
import pytest
import xarray
from program import PROGRAM, ROOT

CONFIGS = ROOT / "configs"
# Scenes with priors are no runs, and in folders of their own.
SCENES = sorted(CONFIGS.glob("*.toml")) + sorted(CONFIGS.glob("[ps]*/*.toml")) + [CONFIGS / "coupled/patches.toml"]
# Few separations and asperities, with which a scene of any of these takes a second.
FEW = {"separation.h_star": "{ from = 1.0, to = 8.0, count = 15 }", "surface.nominal_area": '"10 um^2"'}
COSTLY = "humidity instability loop preload slider voltage coupled sweep_plastic"
SHORT = {name: FEW for name in COSTLY.split()} | {
    "patches": {"sweep": '{ "substrate.coupling" = ["none", "patch"] }'} | FEW
}
SLOW = "sweep_plastic sweep_roughness sweep_lubricant sweep_hardness probe probe_wet humidity".split()
ROUNDING = 1e-9

# NaN stands where something did not happen, or has no scatter.
GAPS = re.compile(
    r"_std$|standard_error|interval|quantile|most_differing|variance_r|/scalar_|/snap_|preload|probability|"
    r"/z_|_z$|/probe_|sum_error|sum_tolerance|statistic|p_value|highest_asperity|touchdown|detachment|secant|"
    r"energy_lost|energy_unit|independent_from|/differences/|/asperities/|/control$|critical_approach|"
    r"/instability/|/wavelength|greenwood_tripp"
)
INFINITE = re.compile(r"variance_r|longest_stable_wavelength")
SIGNED = re.compile(
    r"external|difference|separation|interval|quantile|/scalar_|target_mean|/z_|_z$|/probe_|/mean_field_|"
    r"pull_off|secant|peak|height|offset|energy|shift|kurtosis|bias|approach|highest|h_star|/background/|"
    r"preload|independent_from|control$|spread_force|contour_force|interference|step_count|/step$|jump_|/fit/[cr]"
)
COUPLED = re.compile(r"^/coupling/|/independent_|/mean_field_|largest_crowding")
RISING = "separation h_star asperity_separation step quantile replica avalanche_size energy_class".split()
SHARES = re.compile(r"_share$|probability|p_value$|most_differing")
FLAGS = re.compile(r"/tested_|/in_contact|/has_touched|/at_rest|_at_edge$|target_met|/snap_(in|off)$")
WAYS = ("", "retraction_", "reapproach_")


def written(scene, folder):
    """What a scene writes of three replicas."""
    name, output = scene.stem, folder / "out.h5"
    if "polished.h5" in scene.read_text():
        search = [PROGRAM, "asperities", CONFIGS / "maps/polished.txt", "-o", folder / "polished.h5"]
        subprocess.run(search, check=True, capture_output=True)
        scene = Path(shutil.copy(scene, folder))
    overrides = SHORT.get(name, {})
    sets = [word for key, value in overrides.items() for word in ("--set", f"{key}={value}")]
    command = [PROGRAM, "run", scene, "--quiet", "-o", output, "--replicas", "3", *sets]
    subprocess.run(command, check=True, capture_output=True, cwd=CONFIGS)
    with xarray.open_datatree(output, engine="h5netcdf") as opened:
        return opened.load()


def numbers(tree):
    """The datasets of numbers, by their paths without the way."""
    for group in tree.subtree:
        for name, values in group.dataset.variables.items():
            if values.dtype.kind in "iuf":
                way = next(way for way in reversed(WAYS) if name.startswith(way))
                yield f"{group.path.rstrip('/')}/{name.removeprefix(way)}", values


def numbers_are_finite_and_of_their_sign(tree):
    wrong = []
    for path, values in numbers(tree):
        # Points of a sweep without coupling have none of it.
        is_gap = GAPS.search(path) or (COUPLED.search(path) and "sweep_keys" in tree.attrs)
        there = values.values if not is_gap else values.values[~numpy.isnan(values.values)]
        largest = numpy.abs(there[numpy.isfinite(there)]).max(initial=0.0)
        does = numpy.isfinite(there) if not INFINITE.search(path) else ~numpy.isnan(there)
        if not SIGNED.search(path) or re.search("_std$|standard_error|regime_count|regime_adhesion", path):
            does &= there >= -ROUNDING * largest
        if SHARES.search(path):
            does &= there <= 1
        if FLAGS.search(path):
            does &= (there == 0) | (there == 1)
        if not does.all():
            wrong.append(f"{path} has {there[~does][:3]}")
    assert not wrong


def coordinates_rise(tree):
    for path, values in numbers(tree):
        if path.rsplit("/", 1)[1] in RISING and values.ndim == 1:
            assert (numpy.diff(values.values) > 0).all(), path


def intervals_and_quantiles_are_ordered(tree):
    for path, values in numbers(tree):
        for dimension in {"range_end", "quantile"} & set(values.dims) - {path.rsplit("/", 1)[1]}:
            steps = numpy.diff(values.values, axis=values.dims.index(dimension))
            slack = ROUNDING * numpy.abs(numpy.nan_to_num(values.values)).max(initial=0.0)
            assert not (steps < -slack).any(), path


def curves(tree):
    """Groups with curves of all parts of the force, by way, and the end of their names."""
    for group, end in (("ensemble", "_mean"), ("integral", "")):
        for way in WAYS:
            if f"{way}external_force{end}" in tree[group]:
                yield tree[group], way, end


def close(found, expected, size):
    return bool((abs(found - expected) <= ROUNDING * abs(size)).all())


def forces_and_regimes_add_up(tree):
    for group, way, end in curves(tree):
        names = ("adhesion", "contact", "external")
        adhesion, contact, external = (group[f"{way}{name}_force{end}"] for name in names)
        beside = xarray.zeros_like(external)
        for name, own in (("background", "force"), ("capillary", f"{way}spread_force")):
            if name in tree.children and own in tree[name]:
                beside = beside + tree[name][own]
        assert close(external, contact - adhesion - beside, adhesion + contact + abs(beside)), way
        regimes = f"{way}regime_adhesion_force{end}"
        if regimes in group:
            assert close(group[regimes].sum("regime"), adhesion, adhesion), way
            of_regimes = group[f"{way}regime_external_force{end}"]
            assert close(of_regimes.sum("regime"), external + beside, adhesion + contact + abs(beside)), way


def asperities_are_counted_once(tree):
    count = tree["replicas"]["asperity_count"].mean("replica")
    for way in WAYS:
        counts = tree["ensemble"].get(f"{way}regime_count_mean")
        if counts is not None:
            assert close(counts.sum("regime"), count, count), way


def means_are_those_of_the_replicas(tree):
    ensemble, replicas = tree["ensemble"], tree["replicas"]
    for scalar in ensemble["scalar"].values:
        own = ensemble["scalar_mean"].sel(scalar=scalar)
        values = replicas[str(scalar)]
        mean = values.mean("replica", skipna=False)
        assert close(own, mean, abs(values).max("replica")) or own.isnull().any(), scalar


def differences_are_with_coupling_less_without(tree):
    coupling = tree["coupling"] if "coupling" in tree.children else {}
    differences = [name for name in coupling if re.fullmatch(r"(re[a-z]+_)?difference_.*_mean", str(name))]
    for name in differences:
        coupled = tree["ensemble"][name.replace("difference_", "")]
        independent = coupling[name.replace("difference_", "independent_")]
        # Points of a sweep without coupling have none.
        size = (abs(coupled) + abs(independent)).fillna(numpy.inf)
        assert close(coupling[name].fillna(0), (coupled - independent).fillna(0), size), name


def pull_offs_are_no_less_than_those_of_the_curves(tree):
    """They are searched between the separations too, and a mean of minima is below the minimum of the mean."""
    way = "retraction_" if "retraction_external_force" in tree["integral"] else ""
    along = "separation" if "separation" in tree["integral"].dims else "separation_index"
    mean = tree["ensemble"][f"{way}external_force_mean"]
    deepest, size = -mean.min(along), abs(mean).max(along)
    assert bool((tree["replicas"]["pull_off_force"].mean("replica") >= deepest - ROUNDING * size).all())


def loops_lose_energy(tree):
    for name in ("dissipated_energy", "repeated_dissipated_energy"):
        energy = tree["replicas"].get(name)
        if energy is not None:
            assert bool((energy >= -ROUNDING * abs(energy).max()).all()), name


RULES = (
    numbers_are_finite_and_of_their_sign,
    coordinates_rise,
    intervals_and_quantiles_are_ordered,
    forces_and_regimes_add_up,
    asperities_are_counted_once,
    means_are_those_of_the_replicas,
    differences_are_with_coupling_less_without,
    pull_offs_are_no_less_than_those_of_the_curves,
    loops_lose_energy,
)


@pytest.mark.parametrize("scene", [pytest.param(scene, marks=[pytest.mark.slow] * (scene.stem in SLOW)) for scene in SCENES],
                         ids=lambda scene: f"{scene.parent.name}/{scene.stem}")
def test_a_file_keeps_all_rules(scene, tmp_path):
    tree = written(scene, tmp_path)
    for rule in RULES:
        rule(tree)
