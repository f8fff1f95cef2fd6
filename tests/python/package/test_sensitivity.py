"""Sobol indices against closed forms: Ishigami's function, sums and products, a scene whose pull-off is known, SALib's own estimator."""

import contextlib
import io

import numpy as np
import pytest
import xarray
from conftest import assert_opens
from scipy import stats

import stiction.sensitivity as study
from stiction import FileError, SceneError
from stiction.sensitivity import command, indices
from stiction.sensitivity.study import words

# Of independent test statistics |z| > 4.5 happens once in 150 000.
Z = 4.5


def ishigami(points, a=7.0, b=0.1):
    """T. Ishigami, T. Homma, ISUMA (1990) 398."""
    x = np.pi * (2.0 * points - 1.0)
    return np.sin(x[..., 0]) + a * np.sin(x[..., 1]) ** 2 + b * x[..., 2] ** 4 * np.sin(x[..., 0])


def of_ishigami(a=7.0, b=0.1):
    """First-order and total indices and the variance, in closed form."""
    first = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2
    second = a**2 / 8.0
    both = b**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    whole = first + second + both
    return np.array([first, second, 0.0]) / whole, np.array([first + both, second, both]) / whole, whole


def outcomes(seed, scatter=0.0, common=True, rows=16, blocks=32, patches=8):
    """Ishigami's function and a scatter of normal patches that grows with the first parameter: its variance is 7/3 `scatter`²."""
    points = indices.points(3, rows, blocks, seed).reshape(blocks, rows, 5, 3)
    shape = (blocks, 1, 1, patches) if common else (blocks, rows, 5, patches)
    noise = np.random.default_rng(seed).normal(size=shape)
    return ishigami(points)[..., None] + scatter * noise * (1.0 + points[..., :1])


@pytest.mark.parametrize("scatter, common, rows", [(0.0, True, 16), (2.0, True, 16), (2.0, False, 16), (2.0, True, 2)])
def test_indices_are_those_of_ishigami_and_intervals_hold_them(scatter, common, rows):
    """Of 40 designs. A mean is within 0.02 of the closed form (0.06 of 2 rows) and its error (ratios of means are off by O(1/blocks)); each
    interval of 95 % holds the truth in at least 31 of 40: a right one fails that 3 times in 100 000, one of 60 % passes twice in 100.
    """
    first, total, whole = of_ishigami()
    noise = 7.0 / 3.0 * scatter**2
    truth = np.concatenate([first, total, [noise / (whole + noise)]])
    values, held = [], []
    for seed in range(40):
        found = indices.estimated(outcomes(seed, scatter, common, rows), resamples=500)
        values.append(np.concatenate([found.first_order, found.total, [found.scatter]]))
        between = np.concatenate([found.first_order_interval, found.total_interval, [found.scatter_interval]])
        held.append((between[:, 0] <= truth + 1e-12) & (truth - 1e-12 <= between[:, 1]))
    error = np.std(values, axis=0, ddof=1) / np.sqrt(40.0)
    assert (np.abs(np.mean(values, axis=0) - truth) < (0.02 if rows > 2 else 0.06) + Z * error).all()
    assert (np.sum(held, axis=0) >= 31).all()


def test_scatter_between_patches_is_no_variance_of_parameters():
    """Two patches a point, and a scatter of twice the variance of the parameters: means over patches would have 2 instead of 1 of it."""
    found = [indices.estimated(outcomes(seed, 3.5, common=False, rows=64, patches=2), resamples=100) for seed in range(20)]
    whole, noise = of_ishigami()[2], 7.0 / 3.0 * 3.5**2
    of_parameters = np.array([one.variance * (1.0 - one.scatter) for one in found])
    assert abs(of_parameters.mean() - whole) < Z * of_parameters.std(ddof=1) / np.sqrt(20.0)
    assert of_parameters.mean() < whole + 0.5 * noise / 2.0
    assert np.mean([one.variance for one in found]) == pytest.approx(whole + noise, rel=0.05)


def test_common_patches_make_indices_more_precise():
    """The same patches at all points: the variance of a total index is less than that of patches of their own."""
    spread = [
        np.std([indices.estimated(outcomes(seed, 4.0, common, patches=2), resamples=50).total[2] for seed in range(30)])
        for common in (True, False)
    ]
    # An F ratio above 1/0.7² = 2 with 29 and 29 degrees of freedom: their true ratio is above 4.
    assert spread[0] < 0.7 * spread[1]


def test_without_scatter_they_are_those_of_salib():
    """SALib's estimator of the same design, which has the same numerators and the variance of all points."""
    from SALib.analyze import sobol

    points = indices.points(3, 4096, 2, seed=3)
    y = ishigami(points)
    found = indices.estimated(np.repeat(y.reshape(2, 4096, 5, 1), 2, axis=-1), resamples=50)
    problem = {"num_vars": 3, "names": list("abc"), "bounds": [[0, 1]] * 3}
    others = [sobol.analyze(problem, one, calc_second_order=False, num_resamples=10, seed=1) for one in y]
    np.testing.assert_allclose(found.first_order, np.mean([one["S1"] for one in others], axis=0), atol=2e-3)
    np.testing.assert_allclose(found.total, np.mean([one["ST"] for one in others], axis=0), atol=2e-3)


def test_what_cannot_be_estimated_is_refused():
    with pytest.raises(ValueError, match="at least 2 blocks and patches"):
        indices.estimated(np.ones((4, 8, 4, 1)))


@pytest.mark.filterwarnings("error")
def test_what_has_no_variance_has_no_indices():
    """An outcome that is the same everywhere, and one that scatters alike at all parameters: no index, no warning."""
    alike = indices.estimated(np.ones((4, 8, 4, 2)), resamples=50)
    assert np.isnan(alike.first_order).all() and np.isnan(alike.total_interval).all()
    assert alike.variance == 0.0 and np.isnan(alike.scatter)
    patches = np.random.default_rng(1).standard_normal((4, 1, 1, 50))
    scattered = indices.estimated(np.broadcast_to(patches, (4, 8, 4, 50)), resamples=50)
    assert np.isnan(scattered.first_order).all() and scattered.scatter == 1.0
    # The variance over all patches that the generator drew, of each block by itself.
    assert scattered.variance == pytest.approx(patches.var(axis=-1, ddof=1).mean(), rel=1e-9)


def test_a_total_below_its_first_order_asks_for_more_samples():
    """Of the first number the total, 0.2, is less than the first order, 0.5, which it contains; of the second it is not."""
    ends = {"range_end": ["low", "high"]}
    of = {
        "first_order": (("quantity", "key"), [[0.5, 0.1]]), "total": (("quantity", "key"), [[0.2, 0.2]]),
        "first_order_interval": (("quantity", "key", "range_end"), np.full((1, 2, 2), 0.1)),
        "total_interval": (("quantity", "key", "range_end"), np.full((1, 2, 2), 0.1)),
        "scatter": ("quantity", [np.nan]), "scatter_interval": (("quantity", "range_end"), [[np.nan, np.nan]]),
        "mean": ("quantity", [1e-6]), "standard_deviation": ("quantity", [1e-7]),
    }  # fmt: skip
    study = xarray.Dataset(
        of, coords={"quantity": ["pull_off_force"], "key": ["a.one", "a.two"], "unit": ("quantity", ["N"]), **ends},
        attrs={"interval_level": 0.95},
    )  # fmt: skip
    said = words(study)
    assert "too few samples: the total of a.one is below its first order" in said
    assert "scatter between patches" in said and "none" in said and "nan" not in said


def of_counts(tmp_path):
    """A scene whose pull-off is 2πRΔγ times the asperities that touch at the smallest separation, of almost no stiffness."""
    text = """
format = 1
[material]
reduced_modulus = "100 Pa"
hardness = "1 TPa"
poisson_ratio = 0.3
work_of_adhesion = { prior = "log_normal", median = "50 mJ/m^2", log_std = 0.2 }
equilibrium_spacing = "0.2 nm"
[surface]
asperity_radius = { prior = "log_normal", median = "2 um", log_std = 0.1 }
asperity_density = "8 /um^2"
asperity_height_std = "1.5 nm"
mean_plane_offset = "0 nm"
nominal_area = "10 um^2"
[model]
law = "dmt"
[separation]
h = { from = "1.5 nm", to = "9 nm", count = 4 }
[ensemble]
replicas = 20
"""
    path = tmp_path / "counts.toml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    """The folder of a study by the command, and what it printed."""
    folder = tmp_path_factory.mktemp("sensitivity")
    of_counts(folder)
    with contextlib.chdir(folder), contextlib.redirect_stdout(io.StringIO()) as printed:
        assert command.main(["counts.toml", "--samples", "128"]) == 0
    return folder, printed.getvalue()


@pytest.mark.slow
def test_the_file_is_opened_by_info_plot_and_report(studied, tmp_path):
    folder, printed = studied
    assert_opens(folder / "counts_sensitivity.h5", printed.splitlines()[0], tmp_path)


@pytest.mark.slow
def test_a_scene_with_a_closed_form(studied):
    """Pull-off is 2πRΔγ n with n binomial of N = 80 and p = 1 − Φ(1), independent of R and Δγ; R and Δγ are log-normal.

    With c² = exp(s²) − 1 of each, E = 2π E[R] E[Δγ] N p, Var m = E² ((1 + c₁²)(1 + c₂²) − 1), S = c²/that, T = c²(1 + c'²)/that, and the scatter
    is E² (1 + c₁²)(1 + c₂²)(1 − p)/(N p). False alarm: each of 5 intervals of 95 %, stretched to 99.9 % by 3.29/1.96, leaves out the truth by chance,
    so 5 in 1000 at another seed.
    """
    with xarray.open_dataset(studied[0] / "counts_sensitivity.h5", engine="h5netcdf") as file:
        found = file.load().sel(quantity="pull_off_force")
    p, count = stats.norm.sf(1.0), 80
    c = np.exp(np.array([0.04, 0.01])) - 1.0
    of_mean = np.prod(1.0 + c) - 1.0
    noise = np.prod(1.0 + c) * (1.0 - p) / (count * p)
    mean = 2.0 * np.pi * 2e-6 * 0.05 * np.exp(0.025) * count * p
    assert found["key"].values.tolist() == ["material.work_of_adhesion", "surface.asperity_radius"]
    assert float(found["mean"]) == pytest.approx(mean, rel=0.05)
    assert float(found["standard_deviation"]) == pytest.approx(mean * np.sqrt(of_mean + noise), rel=0.1)

    def between(kind):
        value = found[kind].values[..., None]
        return value + 3.29 / 1.96 * (found[f"{kind}_interval"].values - value)

    for kind, truth in [("first_order", c / of_mean), ("total", c * (1.0 + c[::-1]) / of_mean)]:
        ends = between(kind)
        assert ((ends[:, 0] < truth) & (truth < ends[:, 1])).all()
        assert (np.diff(ends, axis=1) < 0.7).all()
    low, high = between("scatter")
    assert low < noise / (of_mean + noise) < high and high - low < 0.4


@pytest.mark.slow
def test_the_command_leaves_file_and_figure_and_overwrites_nothing(studied, monkeypatch, capsys):
    folder, printed = studied
    monkeypatch.chdir(folder)
    assert "pull-off force" in printed and "scatter between patches" in printed and "counts_sensitivity.h5" in printed
    with xarray.open_dataset("counts_sensitivity.h5", engine="h5netcdf") as file:
        assert file.attrs["format"] == "stiction-sensitivity" and file.attrs["samples"] == 128
        assert set(file["quantity"].values) == set(study.QUANTITIES)
        assert file.attrs["scene"] == (folder / "counts.toml").read_text(encoding="utf-8")
    assert (folder / "counts_sensitivity.png").stat().st_size > 10_000
    assert command.main(["counts.toml", "--samples", "128"]) == 2
    assert "counts_sensitivity.h5: exists; --force overwrites it" in capsys.readouterr().err


@pytest.mark.parametrize(
    "change, arguments, reported",
    [
        (("replicas = 20", 'replicas = 16\nsampling = "stratified"'), {}, "ensemble.sampling = 'stratified': independent patches"),
        (("replicas = 20", 'target = { quantity = "pull_off_force", relative_standard_error = 0.1 }'), {}, "ensemble.target: a fixed number"),
        (("replicas = 20", "replicas = 1"), {}, "replicas = 1: at least 2 patches"),
        (("", ""), {"samples": 100}, "samples = 100: a power of 2 of at least 64"),
        (("", ""), {"samples": 32}, "samples = 32: a power of 2 of at least 64"),
        (("", ""), {"samples": 131072}, "samples = 131072: at most 80000"),
        (("", ""), {"level": 95}, "level = 95"),
        (("[ensemble]", '[priors]\nkeys = ["material.work_of_adhesion", "surface.asperity_radius"]\ncorrelation = [[1, 0.5], [0.5, 1]]\n[ensemble]'), {},
         "priors: Sobol indices are of independent numbers"),
        (('law = "dmt"', 'law = "nothing"'), {}, "nothing"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_and_nothing_is_left(tmp_path, change, arguments, reported):
    path = of_counts(tmp_path)
    text = path.read_text(encoding="utf-8").replace(*change)
    path.write_text(text)
    with pytest.raises(SceneError, match=reported):
        study.sensitivity(path, tmp_path / "out.h5", progress=False, **arguments)
    assert not (tmp_path / "out.h5").exists()
    (tmp_path / "out.h5").touch()
    with pytest.raises(FileError, match="force=True"):
        study.sensitivity(of_counts(tmp_path), tmp_path / "out.h5")
