"""Sobol indices against closed forms: Ishigami's function, sums and products, a scene whose pull-off is known, SALib's own estimator."""

import contextlib
import io
import signal

import numpy as np
import pytest
import xarray
from conftest import assert_opens, begun
from scipy import special, stats

import stiction.sensitivity as study
from stiction import FileError, SceneError, priors
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
    points = indices.points(3, rows, blocks, seed)
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


def test_a_polynomial_near_the_model_narrows_intervals_that_still_hold_the_indices():
    """Ishigami's function with scatter, of 40 designs of 8 rows: mean widths are half as large or less, and as above means are within 0.02 and their error, and each interval of 95 %
    holds the truth in at least 31 of 40."""
    first, total, _ = of_ishigami()
    truth = np.concatenate([first, total])
    values, held, widths = [], [], []
    for seed in range(40):
        y = outcomes(seed, 1.0, rows=8)
        for at in (None, indices.points(3, 8, 32, seed)):
            found = indices.estimated(y, at=at, resamples=500)
            between = np.concatenate([found.first_order_interval, found.total_interval])
            widths.append(np.diff(between)[:, 0])
        values.append(np.concatenate([found.first_order, found.total]))
        held.append((between[:, 0] <= truth) & (truth <= between[:, 1]))
    error = np.std(values, axis=0, ddof=1) / np.sqrt(40.0)
    assert (np.mean(widths[1::2], axis=0) < 0.5 * np.mean(widths[::2], axis=0)).all()
    assert (np.abs(np.mean(values, axis=0) - truth) < 0.02 + Z * error).all()
    assert (np.sum(held, axis=0) >= 31).all()


def test_of_a_polynomial_indices_are_exact():
    """u1 + u1 u2 of independent uniform numbers, by hand: variances 3/16 of u1, 1/48 of u2 and 1/144 of both."""
    points = indices.points(2, 4, 8, seed=1)
    y = points[..., 0] * (1.0 + points[..., 1])
    found = indices.estimated(np.stack([y, y], axis=-1), at=points, resamples=50)
    parts = np.array([27.0, 3.0, 1.0])
    np.testing.assert_allclose(found.first_order, parts[:2] / parts.sum(), atol=1e-9)
    np.testing.assert_allclose(found.total, (parts[:2] + parts[2]) / parts.sum(), atol=1e-9)
    assert found.variance == pytest.approx(parts.sum() / 144.0, rel=1e-9)


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
    found = indices.estimated(np.repeat(y[..., None], 2, axis=-1), resamples=50)
    problem = {"num_vars": 3, "names": list("abc"), "bounds": [[0, 1]] * 3}
    others = [sobol.analyze(problem, one, calc_second_order=False, num_resamples=10, seed=1) for one in y.reshape(2, -1)]
    np.testing.assert_allclose(found.first_order, np.mean([one["S1"] for one in others], axis=0), atol=2e-3)
    np.testing.assert_allclose(found.total, np.mean([one["ST"] for one in others], axis=0), atol=2e-3)


# Standard deviations and correlations of three normal numbers: S. Kucherenko et al., Comput. Phys. Commun. 183 (2012) 937, test case 1.
STDS = np.array([1.0, 1.0, 2.0])


def correlated(rho):
    return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, rho], [0.0, rho, 1.0]])


def of_linear(rho):
    """Indices of x1 + x2 + x3 in closed form, their equations 5.1 to 5.3."""
    sigma = STDS[2]
    whole = 2.0 + sigma**2 + 2.0 * rho * sigma
    first = np.array([1.0, (1.0 + rho * sigma) ** 2, (sigma + rho) ** 2]) / whole
    return first, np.array([1.0, 1.0 - rho**2, sigma**2 * (1.0 - rho**2)]) / whole


def of_portfolio(covariance, means):
    """Indices of x1 x3 + x2 x4 where (x1, x2) is independent of (x3, x4), all normal: their test case 2, by moments of normal numbers.

    E[Y | x1] = x1 μ3 + E[x2 | x1] μ4 is linear in x1, and Var[Y | others] = x3² Var[x1 | x2].
    """
    c, mu = covariance, means
    pair = {0: 1, 1: 0, 2: 3, 3: 2}
    partner = {0: 2, 1: 3, 2: 0, 3: 1}
    first, total = [], []
    for k in range(4):
        slope = mu[partner[k]] + c[k, pair[k]] / c[k, k] * mu[partner[pair[k]]]
        first.append(slope**2 * c[k, k])
        alone = c[k, k] - c[k, pair[k]] ** 2 / c[pair[k], pair[k]]
        total.append(alone * (c[partner[k], partner[k]] + mu[partner[k]] ** 2))
    x, y, a, b = mu[:2], mu[2:], c[:2, :2], c[2:, 2:]
    whole = x @ b @ x + y @ a @ y + np.trace(a @ b)
    return np.array(first) / whole, np.array(total) / whole


def of_normal(correlation, model, seed, rows=64):
    """Estimated indices of a model of standard normal numbers of a correlation, from 32 blocks of rows."""
    points = special.ndtri(indices.points(len(correlation), rows, 32, seed, correlation)) @ np.linalg.cholesky(correlation).T
    y = model(points)
    return indices.estimated(np.stack([y, y], axis=-1), keys=len(correlation), resamples=500)


@pytest.mark.parametrize("rho", [-0.8, 0.0, 0.5])
def test_correlated_numbers_have_the_indices_of_kucherenko(rho):
    """A sum of three normal numbers, the last two correlated. False alarm: 6 means of 10 designs within 4.5 standard errors (t with 9 degrees of freedom: 1.5 in 1000
    each) or 0.003, so 9 in 1000 at another seed for each correlation."""
    found = [of_normal(correlated(rho), lambda z: z @ STDS, seed) for seed in range(10)]
    for kind, truth in zip(("first_order", "total"), of_linear(rho), strict=True):
        values = np.array([getattr(one, kind) for one in found])
        error = values.std(axis=0, ddof=1) / np.sqrt(10.0)
        assert (np.abs(values.mean(axis=0) - truth) < np.maximum(Z * error, 0.003)).all()


def test_a_portfolio_of_correlated_numbers_has_its_indices_and_intervals_hold_them():
    """Kucherenko et al., test case 2: means 0, 0, 250, 400, variances 16, 4, 4e4, 9e4, covariances 2.4 and -1.8e4. The closed form is by moments; of the paper first orders are
    0.507, 0.399, 0, 0 and totals 0.492, 0.300, 0.192, 0.108. Of 20 designs each interval of 95 % holds the truth in 14 at least: a right one fails that in 3 of 100 000, so 8 in 3 of 10 000."""
    covariance = np.array([[16.0, 2.4, 0, 0], [2.4, 4.0, 0, 0], [0, 0, 4e4, -1.8e4], [0, 0, -1.8e4, 9e4]])
    means, stds = np.array([0.0, 0.0, 250.0, 400.0]), np.sqrt(np.diag(covariance))
    truth = of_portfolio(covariance, means)
    np.testing.assert_allclose(truth, [[0.507, 0.399, 0.0, 0.0], [0.492, 0.300, 0.192, 0.108]], atol=5e-4)

    def model(z):
        x = means + stds * z
        return x[..., 0] * x[..., 2] + x[..., 1] * x[..., 3]

    held = np.zeros((2, 4))
    for seed in range(20):
        found = of_normal(covariance / np.outer(stds, stds), model, seed)
        ends = np.stack([found.first_order_interval, found.total_interval])
        held += (ends[..., 0] <= truth) & (np.array(truth) <= ends[..., 1])
    assert (held >= 14).all()


def test_points_of_correlated_numbers_are_of_their_law():
    """Scores of each of the points have the correlation; with none the points are Saltelli's, those for S and for T alike. 5 standard errors of 4096 numbers are 0.08."""
    correlation = np.array([[1.0, 0.7, 0.2], [0.7, 1.0, -0.4], [0.2, -0.4, 1.0]])
    factor = np.linalg.cholesky(correlation)
    scores = special.ndtri(indices.points(3, 1024, 4, 1, correlation)) @ factor.T
    for point in range(8):
        np.testing.assert_allclose(np.corrcoef(scores[:, :, point].reshape(-1, 3).T), correlation, atol=0.08)
    a, b = scores[:, :, 0], scores[:, :, -1]
    for k in range(3):
        others = [j for j in range(3) if j != k]
        np.testing.assert_allclose(scores[:, :, 1 + k, k], b[..., k], atol=1e-9)
        np.testing.assert_allclose(scores[:, :, 4 + k][..., others], a[..., others], atol=1e-9)
    plain, both = indices.points(3, 8, 2, 1), indices.points(3, 8, 2, 1, np.eye(3))
    np.testing.assert_allclose(both[:, :, 1:4], plain[:, :, 1:4], atol=1e-12)
    np.testing.assert_allclose(both[:, :, 4:7], plain[:, :, 1:4], atol=1e-12)


def test_more_rows_begin_with_the_fewer():
    np.testing.assert_array_equal(indices.points(4, 16, 3, 1)[:, :2], indices.points(4, 2, 3, 1))


def test_rows_that_lack_a_value_are_left_out_as_a_whole():
    """NaN in one point of a row has the estimate without that row, and a block without any row is none."""
    y = outcomes(1, scatter=1.0, rows=8)
    lacking = y.copy()
    lacking[:, 3, 2, 1] = np.nan
    without = indices.estimated(np.delete(y, 3, axis=1), resamples=50)
    found = indices.estimated(lacking, resamples=50)
    np.testing.assert_array_equal(found.first_order, without.first_order)
    np.testing.assert_array_equal(found.total_interval, without.total_interval)
    lacking[5:] = np.nan
    np.testing.assert_array_equal(
        indices.estimated(lacking, resamples=50).total, indices.estimated(np.delete(y, 3, axis=1)[:5], resamples=50).total
    )


@pytest.mark.slow
@pytest.mark.parametrize("has_polynomial, width", [(False, 0.15), (True, 0.1)])
def test_intervals_of_designs_that_stop_at_a_width_hold_the_indices(has_polynomial, width):
    """Ishigami's function with scatter, rows doubled until no interval is wider than asked, without and with a polynomial as control variate: of 60 designs each interval of 95 %
    holds the truth in 47 at least. A right one fails that in 1 of 800 000, so the seven in 1 of 100 000 at other seeds; one of 60 % passes in 2 of 1000."""
    first, total, whole = of_ishigami()
    noise = 7.0 / 3.0
    truth = np.concatenate([first, total, [noise / (whole + noise)]])
    held, stopped = np.zeros(7), []
    for seed in range(60):
        rows = 2
        while True:
            at = indices.points(3, rows, 32, seed) if has_polynomial else None
            found = indices.estimated(outcomes(seed, 1.0, rows=rows), at=at, resamples=500)
            between = np.concatenate([found.first_order_interval, found.total_interval, [found.scatter_interval]])
            if np.diff(between[:6], axis=1).max() <= width or rows == 256:
                break
            rows *= 2
        stopped.append(rows)
        held += (between[:, 0] <= truth + 1e-12) & (truth - 1e-12 <= between[:, 1])
    assert max(stopped) < 256 and (held >= 47).all()


def test_what_cannot_be_estimated_is_refused():
    with pytest.raises(ValueError, match="at least 2 blocks and patches"):
        indices.estimated(np.ones((4, 8, 4, 1)))
    with pytest.raises(ValueError, match="0 blocks have a row of finite values"):
        indices.estimated(np.full((4, 8, 4, 2), np.nan))


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
        "first_order_interval": (("quantity", "key", "range_end"), [[[0.4, 0.6], [0.0, 0.1]]]),
        "total_interval": (("quantity", "key", "range_end"), np.full((1, 2, 2), 0.1)),
        "scatter": ("quantity", [np.nan]), "scatter_interval": (("quantity", "range_end"), [[np.nan, np.nan]]),
        "mean": ("quantity", [1e-6]), "standard_deviation": ("quantity", [1e-7]),
    }  # fmt: skip
    study = xarray.Dataset(
        of, coords={"quantity": ["pull_off_force"], "key": ["a.one", "a.two"], "unit": ("quantity", ["N"]), **ends},
        attrs={"interval_level": 0.95, "correlated": 0, "left_out": 1, "left_out_first": "no energy at a point", "samples": 64,
               "replicas": 20, "interval": 0.05},
    )  # fmt: skip
    said = words(study)
    assert "too few samples: the total of a.one is below its first order" in said
    assert "scatter between patches" in said and "none" in said and "nan" not in said
    # The widest, 0.2, is 4 times as wide as asked.
    assert "too few samples: 64 samples, of 20 patches at each point: intervals up to 0.2 wide; 0.05 needs about 1024" in said
    assert "1 of 64 samples left out; the first: no energy at a point" in said
    enough = words(study.assign_attrs(interval=0.25, left_out=0, correlated=1))
    assert "  64 samples, of 20 patches at each point: intervals up to 0.2 wide\n" in enough
    assert "too few" not in enough and "left out" not in enough and enough.startswith("Sobol indices of correlated numbers")


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


def of_sizes(tables, axes, replicas, seed, refused=(), lacking=()):
    """Patches of numbers in SI units by a closed form, in the place of the program: Δγ R times a scatter; some points are refused, or lack a stiffness."""
    gamma, radius = (np.array([float(text.split()[0]) for text in axes[key]]) for key in KEYS)
    bad = np.flatnonzero(np.isin(radius.round(12), refused))
    if bad.size:
        raise SceneError(f"-: at point {bad[0] + 1} of {len(radius)} (`surface.asperity_radius = {radius[bad[0]]:g} m`): too blunt")
    patches = np.random.default_rng(seed).lognormal(0.0, 0.1, replicas)
    force = (gamma * radius)[:, None] * patches
    stiffness = np.where(np.isin(radius.round(12), lacking)[:, None] & (np.arange(replicas) == 1), np.nan, force)
    of = {"pull_off_force": force, "peak_secant_stiffness": stiffness, "dissipated_energy": force}
    return xarray.Dataset({name: (("point", "replica"), values) for name, values in of.items()})


KEYS = ("material.work_of_adhesion", "surface.asperity_radius")


@pytest.fixture
def closed(monkeypatch):
    """Lets `of_sizes` with its options compute in the place of the program."""
    def put(**options):
        def patches(tables, axes, *, replicas, seed, threads, progress, **_):
            return of_sizes(tables, axes, replicas, seed, **options)

        monkeypatch.setattr("stiction.experiments.patches", patches)

    return put


def radii(path, seed, rows):
    """The radii at B of all rows of the first block."""
    found = priors.read(path)
    cube = indices.points(2, rows, 32, seed)[0]
    return found.draw(cube.reshape(-1, 2))[:, 1].reshape(rows, 4)[:, -1].round(12)


def test_samples_are_doubled_until_intervals_are_narrow(tmp_path, closed):
    """As many as the design of that size has by itself; without an end to the doubling, the number at most and what it lacks are named."""
    closed()
    path = of_counts(tmp_path)
    found = study.sensitivity(path, interval=0.02, seed=1)
    samples = found.attrs["samples"]
    width = max(np.diff(found[f"{kind}_interval"], axis=-1).max() for kind in ("first_order", "total"))
    assert 64 < samples < 4096 and width <= 0.02
    half = study.sensitivity(path, interval=0.02, samples=samples // 2, seed=1)
    assert max(np.diff(half[f"{kind}_interval"], axis=-1).max() for kind in ("first_order", "total")) > 0.02
    assert half.attrs["samples"] == samples // 2 and "too few samples" in half.attrs["summary"]
    at_once = study.sensitivity(path, interval=1e-6, samples=samples, seed=1)
    xarray.testing.assert_equal(found, at_once)


def test_samples_with_a_point_that_fails_are_left_out_and_named(tmp_path, closed):
    """A point that is refused, and one where a patch lacks an outcome: their two samples are left out of 64, and the indices hold the closed form."""
    path = of_counts(tmp_path)
    refused, lacking = radii(path, 1, 2)
    closed(refused=[refused], lacking=[lacking])
    found = study.sensitivity(path, samples=64, seed=1)
    assert found.attrs["left_out"] == 2
    assert f"2 of 64 samples left out; the first: -: at (`surface.asperity_radius = {refused:g} m`): too blunt" in found.attrs["summary"]
    closed()
    whole = study.sensitivity(path, samples=64, seed=1)
    assert whole.attrs["left_out"] == 0
    np.testing.assert_allclose(found["first_order"], whole["first_order"], atol=0.1)
    closed(lacking=[lacking])
    assert "no largest stiffness of a patch at material.work_of_adhesion = " in study.sensitivity(path, samples=64, seed=1).attrs["left_out_first"]


def test_too_many_points_that_fail_are_an_error_with_what_would_do(tmp_path, closed, monkeypatch):
    path = of_counts(tmp_path)
    closed(refused=np.concatenate([radii(path, 1, 2), [one for row in indices.points(2, 2, 32, 1)[1:3] for one in priors.read(path).draw(row[:, -1])[:, 1].round(12)]]))
    with pytest.raises(SceneError, match=r"more than 5 % of the samples have a point without an outcome, the first: .*too blunt; narrow the priors"):
        study.sensitivity(path, samples=64, seed=1)

    def broken(*_, **__):
        raise SceneError("model.law = nothing")

    monkeypatch.setattr("stiction.experiments.patches", broken)
    with pytest.raises(SceneError, match=r"^model\.law = nothing$"):
        study.sensitivity(path, samples=64, seed=1)


def test_correlated_priors_have_their_own_points(tmp_path, closed):
    """ln Y = ln Δγ + ln R + scatter: of normal logarithms of 0.2 and 0.1 with ρ = 0.6, indices of Y, nearly those of the sum of the logarithms:
    S = (s + ρ s')²/V and T = s²(1 − ρ²)/V with V = s² + s'² + 2ρ s s', within 0.05."""
    closed()
    path = of_counts(tmp_path)
    table = '[priors]\nkeys = ["material.work_of_adhesion", "surface.asperity_radius"]\ncorrelation = [[1, 0.6], [0.6, 1]]\n[ensemble]'
    path.write_text(path.read_text().replace("[ensemble]", table))
    found = study.sensitivity(path, interval=0.06, seed=1).sel(quantity="pull_off_force")
    s, other, rho = np.array([0.2, 0.1]), np.array([0.1, 0.2]), 0.6
    whole = 0.05 + 2.0 * rho * 0.02
    np.testing.assert_allclose(found["first_order"], (s + rho * other) ** 2 / whole, atol=0.05)
    np.testing.assert_allclose(found["total"], s**2 * (1.0 - rho**2) / whole, atol=0.05)
    assert found.attrs["correlated"] == 1 and "too few samples" not in found.attrs["summary"]


@pytest.mark.slow
def test_points_that_the_program_refuses_are_left_out(tmp_path):
    """Of standard deviations of heights that may be below 0, by the program itself."""
    path = of_counts(tmp_path)
    prior = 'asperity_height_std = { prior = "normal", mean = "1.5 nm", std = "0.6 nm" }'
    path.write_text(path.read_text().replace('asperity_height_std = "1.5 nm"', prior))
    found = study.sensitivity(path, samples=64, replicas=5)
    assert 1 <= found.attrs["left_out"] <= 3
    assert "surface.asperity_height_std = -" in found.attrs["left_out_first"] and "has to be greater than 0" in found.attrs["left_out_first"]


INTERRUPTED = """
import sys
from stiction.sensitivity import command
sys.exit(command.main(sys.argv[1:]))
"""


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_command_that_is_interrupted_leaves_no_folder(how, tmp_path):
    scene = of_counts(tmp_path)
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    with begun(INTERRUPTED, scene, "-o", tmp_path / "out.h5", folder=temporary) as process:
        process.send_signal(how)
        _, said = process.communicate(timeout=60)
    assert process.returncode == 130 and "nothing was kept" in said
    assert not list(temporary.iterdir()) and [path.name for path in tmp_path.iterdir() if path != temporary] == [scene.name]


@pytest.mark.parametrize(
    "change, arguments, reported",
    [
        (("replicas = 20", 'replicas = 16\nsampling = "stratified"'), {}, "ensemble.sampling = 'stratified': independent patches"),
        (("replicas = 20", 'target = { quantity = "pull_off_force", relative_standard_error = 0.1 }'), {}, "ensemble.target: a fixed number"),
        (("replicas = 20", "replicas = 1"), {}, "replicas = 1: at least 2 patches"),
        (("", ""), {"samples": 100}, "samples = 100: a power of 2 of at least 64"),
        (("", ""), {"samples": 32}, "samples = 32: a power of 2 of at least 64"),
        (("", ""), {"samples": 131072}, "samples = 131072: at most 65536"),
        (("", ""), {"interval": 0.0}, "interval = 0.0: a number above 0"),
        (("", ""), {"level": 95}, "level = 95"),
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
