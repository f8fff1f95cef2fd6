"""Numbers of forces to measure against closed forms: patches whose forces are log-normal with known slopes in the parameters."""

import math
import os
import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import CONFIGS, assert_opens

pytest.importorskip("arviz")

import stiction
from stiction import SceneError
from stiction.design import command, information, measurements
from stiction.inference.emulator import Patches

ENERGY = {"prior": "log_uniform", "from": "1 mJ/m^2", "to": "1 J/m^2"}
# Standard deviation of the logarithm, whose law is uniform.
WIDE = math.log(1000.0) / math.sqrt(12.0)
AREA = 100e-12
KEY = "material.work_of_adhesion"


def scene(**surface):
    """Work of adhesion with a wide prior, and other numbers of a surface."""
    return {"title": "closed form", "material": {"work_of_adhesion": ENERGY}, "surface": {"nominal_area": "100 um^2", **surface}, "ensemble": {"seed": 7}}


def radius(log_std):
    return {"asperity_radius": {"prior": "log_normal", "median": "3 um", "log_std": log_std}}


@pytest.fixture
def forces(monkeypatch):
    """Puts log-normal forces in the place of patches: slopes and standard deviation of the logarithm by the area over the scene's."""

    def simulated(slopes, scatter):
        def simulate(priors, outcomes, values, *, replicas, seed, threads, floors, conditions):
            area = float(conditions.get("surface.nominal_area", f"{AREA} m^2").split()[0]) / AREA
            assert outcomes == ("pull_off_force",) and floors == 0.0
            means = priors.natural(values) @ np.asarray(slopes(area))
            noise = np.random.default_rng(seed).standard_normal((len(values), replicas))
            return Patches(values, (means[:, None] + scatter(area) * noise)[:, :, None])

        monkeypatch.setattr(information, "simulate", simulate)

    return simulated


def wanted(accuracy):
    """Standard deviation of a logarithm, half of whose 95 % interval is that share of the value."""
    return math.asinh(accuracy) / 1.96


def contained(number, of):
    """Whether the interval of a number contains it; a number is the next larger whole one."""
    return of.interval[0] - 1.0 <= number <= of.interval[1]


@pytest.mark.slow
def test_one_parameter_takes_the_number_of_the_closed_form(forces):
    """ln F = ln Δγ + 0.5 ε: 1/s² = n/0.25 + 1/1.99², here with a scatter that falls with the root of the area, so that n falls with the area.

    Intervals of 2 seeds and 3 sizes: at least 4 of 6 contain the number (false alarm 2e-3 at 95 %). The information scatters by 5.2 % over seeds
    (measured with 8), so numbers are within 25 % (1e-5 of the six if normal). The mean of the halves of intervals is 10 % for that number, so within
    the half of that, 13 %; 20 intervals contain the value with 95 % each, at least 15 (3e-4).
    """
    forces(lambda area: [1.0], lambda area: 0.5 / math.sqrt(area))
    held = 0
    for seed in (1, 2):
        found = measurements(scene(), KEY, "10 %", seed=seed, progress=False)
        own, small, large = found.choices[:3]
        for of, area in ((own, 1.0), (small, 0.25), (large, 4.0)):
            exact = 0.25 / area * (1.0 / wanted(0.1) ** 2 - 1.0 / WIDE**2)
            held += contained(exact, of)
            assert of.forces == pytest.approx(exact, rel=0.25, abs=1.0)
        assert found.best is large and found.limit is None and len(found.choices) == 6
        assert np.mean(found.checked) == pytest.approx(0.1, rel=0.13) and found.held >= 15
    assert held >= 4


@pytest.mark.slow
def test_a_product_is_never_taken_apart_and_its_other_factor_is_named(forces):
    """ln F = ln Δγ + ln R + 0.3 ε, with R known to 0.1: the variance of ln Δγ does not fall below 1/(1/1.99² + 1/0.1²), and with R known n is that of one
    parameter (within 25 %, as there). The limit's width is known as the slope of R is: 0.3/(0.2/√3 · √16000) = 2 %, here 10 %. Of 2 seeds and 6 choices at most 3 are not never: false alarm 2e-3 at the 5 % of each that are so by chance.
    """
    forces(lambda area: [1.0, 1.0], lambda area: 0.3)
    numbers = []
    for seed in (1, 2):
        found = measurements(scene(**radius(0.1)), KEY, "5 %", seed=seed, progress=False)
        numbers += [of.forces for of in found.choices]
        assert found.limit.key == "surface.asperity_radius" and found.limit.known == pytest.approx(math.sinh(0.196), rel=0.01)
        exact = 0.09 * (1.0 / wanted(0.05) ** 2 - 1.0 / WIDE**2)
        assert found.limit.forces == pytest.approx(exact, rel=0.25)
        if found.choices[0].forces == math.inf:
            least = math.sinh(1.96 / math.sqrt(1.0 / WIDE**2 + 1.0 / 0.1**2))
            assert found.choices[0].least == pytest.approx(least, rel=0.1)
            assert not found.checked and "never" in str(found) and "limited by surface.asperity_radius, known to 20 %" in " ".join(str(found).split())
    assert sum(number < math.inf for number in numbers) <= 3


def test_of_two_other_factors_the_less_known_one_is_named_with_what_it_leaves(forces):
    """ln F = ln Δγ + ln R + ln σ_s + 0.3 ε with R known to 0.1 and σ_s to 0.3: with σ_s known exactly the standard deviation of ln Δγ is still 1/√(1/1.99² + 1/0.1²), within 10 %
    as above. False alarm: each of the two curves misses never by chance in 5 %, so 1 in 10 at another seed.
    """
    forces(lambda area: [1.0, 1.0, 1.0], lambda area: 0.3)
    given = scene(**radius(0.1), asperity_height_std={"prior": "log_normal", "median": "2 nm", "log_std": 0.3})
    del given["surface"]["nominal_area"]
    found = measurements(given, KEY, "5 %", progress=False)
    least = math.sinh(1.96 / math.sqrt(1.0 / WIDE**2 + 1.0 / 0.1**2))
    assert found.choices[0].forces == found.limit.forces == math.inf and found.limit.key == "surface.asperity_height_std"
    assert found.limit.least == pytest.approx(least, rel=0.1)
    assert re.search(r"known to 62 %: if it was known exactly, never, (19|20) % at best", " ".join(str(found).split()))
    assert max(map(len, str(found).splitlines())) <= 80


@pytest.mark.slow
def test_two_sizes_take_a_product_apart(forces):
    """With ln F = ln Δγ + (1, 0, −1) ln R of areas 1/4, 1, 4: the scene's own patches show Δγ alone, small and large ones half each do, too, and
    small ones alone do not. Exact numbers are of the 2 × 2 matrix; within 25 %, as above.
    """
    forces(lambda area: [1.0, -math.log(area) / math.log(4.0)], lambda area: 0.3)
    found = {of.words: of for of in measurements(scene(**radius(0.3)), KEY, "5 %", progress=False).choices}
    prior = np.diag([1.0 / WIDE**2, 1.0 / 0.3**2])

    def exact(*slopes):
        information = np.mean([np.outer(of, of) for of in slopes], axis=0) / 0.09
        numbers = np.arange(1, 5000)
        variances = np.array([np.linalg.inv(n * information + prior)[0, 0] for n in numbers])
        return numbers[variances <= wanted(0.05) ** 2][0]

    assert found["nominal area 100.0 µm²"].forces == pytest.approx(exact([1.0, 0.0]), rel=0.25)
    assert found["nominal area 25.00 µm²"].forces == math.inf
    both = found["nominal area 25.00 µm² and 400.0 µm², half each"]
    assert both.forces == pytest.approx(exact([1.0, 1.0], [1.0, -1.0]), rel=0.25)


def test_errors_of_measurement_add_to_the_scatter(forces):
    """A relative error of 0.3 next to a scatter of 0.4 makes 0.5: within 25 %, as above; without the error it would be 36 % less."""
    forces(lambda area: [1.0], lambda area: 0.4)
    found = measurements(scene(), KEY, "10 %", force_error="30 %", progress=False)
    assert found.choices[0].forces == pytest.approx(0.25 * (1.0 / wanted(0.1) ** 2 - 1.0 / WIDE**2), rel=0.25)


@pytest.mark.parametrize("library", ["emcee", "joblib"])
def test_a_library_that_is_not_installed_is_named_with_what_brings_it(library, tmp_path):
    (tmp_path / f"{library}.py").write_text(f"raise ModuleNotFoundError('none', name='{library}')")
    given = [CONFIGS / "inference" / "first.toml", "--parameter", KEY, "--accuracy", "5 %"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    run = subprocess.run([sys.executable, "-m", "stiction.design", *given], env=environment, capture_output=True, encoding="utf-8", check=False)
    assert run.returncode == 2 and run.stderr.endswith(f"stiction design: {library} is not installed: pip install 'stiction[inference]' brings it\n")


def test_an_absolute_width_is_one_of_the_value_and_a_narrow_prior_takes_no_forces(forces):
    forces(lambda area: [1.0], lambda area: 0.5)
    found = measurements(scene(), KEY, "3 mJ/m^2", progress=False)
    assert found.accuracy == pytest.approx(0.003 / math.sqrt(1e-3), rel=1e-6)
    assert found.best.forces == measurements(scene(), KEY, f"{100 * found.accuracy!r} %", progress=False).best.forces
    tables = scene()
    tables["material"]["work_of_adhesion"] = {"prior": "log_normal", "median": "30 mJ/m^2", "log_std": 0.02}
    narrow = measurements(tables, KEY, "5 %", progress=False)
    assert narrow.choices[0].forces == 0.0 and "no forces are needed" in str(narrow)


def test_the_command_says_the_number_and_its_file_opens(forces, tmp_path, capsys):
    forces(lambda area: [1.0], lambda area: 0.5)
    path, output = tmp_path / "scene.toml", tmp_path / "needed.h5"
    path.write_text(stiction.scenes.toml({"format": 1, **scene()}), encoding="utf-8")
    assert command.main([str(path), "--parameter", KEY, "--accuracy", "10 %", "-o", str(output)]) == 0
    printed = capsys.readouterr().out
    assert f"{KEY} to 10 % (half of its 95 % interval) at 31.62 mJ/m²:\n  " in printed
    assert "checked: 20 experiments of " in printed and "   best\n" in printed
    assert_opens(output, printed.splitlines()[0], tmp_path, has_figure=False)


@pytest.mark.parametrize(
    "words, reported",
    [
        (["--parameter", KEY], "--parameter and --accuracy: each needs the other"),
        (["--accuracy", "5 %"], "--parameter and --accuracy: each needs the other"),
        (["--parameter", KEY, "--accuracy", "5 %", "--above", "1 uN"], "--above: not with --parameter"),
        (["--parameter", KEY, "--accuracy", "5 %", "--error", "0.2"], "--error: not with --parameter"),
    ],
)
def test_options_of_two_questions_are_refused(words, reported, capsys):
    with pytest.raises(SystemExit):
        command.main([str(CONFIGS / "inference" / "first.toml"), *words])
    assert reported in capsys.readouterr().err


@pytest.mark.parametrize(
    "options, reported",
    [
        ({"parameter": "material.hardness"}, "parameter = 'material.hardness': no number with a prior; material.work_of_adhesion, surface.asp"),
        ({"accuracy": "5"}, 'accuracy = \'5\': half of the 95 % interval is needed, such as "5 %"'),
        ({"accuracy": "0 %"}, "accuracy = '0 %': half of"),
        ({"accuracy": "150 %"}, "accuracy = '150 %': at most 100 %"),
        ({"accuracy": "5 nm"}, "accuracy = '5 nm': half of"),
        ({"accuracy": 0.05}, "accuracy = 0.05: half of"),
        ({"force_error": "5"}, "force_error = '5': the standard deviation"),
        ({"force_error": "60 %"}, "force_error = '60 %'"),
        ({"seed": -1}, "seed = -1"),
    ],
)
def test_what_is_wrong_is_named(options, reported):
    given = {"parameter": KEY, "accuracy": "5 %", **options}
    with pytest.raises(SceneError, match=reported.replace("(", r"\(")):
        measurements(CONFIGS / "inference" / "first.toml", **given)
