"""What a file of `stiction finite-size` holds, checked with numpy and scipy independently of the program, and its picture.

Needs the packages of scripts/requirements.txt. The program is $STICTION, by default target/release/stiction.
"""

import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.optimize
import scipy.stats
import xarray
from program import PROGRAM, ROOT

REPLICAS, COUNTS = 48, [100, 316, 1000, 3162, 10000]


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Path:
    assert PROGRAM.is_file(), f"no program {PROGRAM}: run `cargo build --release` or set STICTION"
    folder = tmp_path_factory.mktemp("finite")
    command = [PROGRAM, "finite-size", ROOT / "tests" / "data" / "quick.toml", "--counts", "100:1e4:5",
               "--replicas", str(REPLICAS), "-o", folder / "sizes.h5", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8")
    assert done.returncode == 0, done.stderr
    assert [file.name for file in folder.iterdir()] == ["sizes.h5"]
    return folder / "sizes.h5"


@pytest.fixture(scope="module")
def file(path):
    with h5py.File(path) as file:
        yield file


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_sees_sizes_by_name(path, engine):
    with xarray.open_dataset(path, engine=engine) as sizes:
        assert list(sizes.asperity_count.values) == COUNTS
        assert sizes.pull_off_per_asperity.dims == ("asperity_count", "replica")
        assert sizes.pull_off_quantiles.dims == ("asperity_count", "quantile")
        for name, variable in sizes.variables.items():
            assert variable.attrs["units"] and variable.attrs["long_name"], name


def test_moments_and_quantiles_are_those_of_the_replicas(file):
    values = file["pull_off_per_asperity"][()]
    assert np.allclose(file["pull_off_per_asperity_mean"], values.mean(axis=1), rtol=1e-12)
    error = values.std(axis=1, ddof=1) / np.sqrt(REPLICAS)
    assert np.allclose(file["pull_off_per_asperity_standard_error"], error, rtol=1e-9)
    assert np.allclose(file["relative_std"], values.std(axis=1, ddof=1) / values.mean(axis=1), rtol=1e-9)
    assert np.allclose(file["skewness"], scipy.stats.skew(values, axis=1, bias=False), rtol=1e-8)
    quantiles = np.quantile(values, file["quantile"][()], axis=1).T / file["integral_pull_off_per_asperity"][()]
    assert np.allclose(file["pull_off_quantiles"], quantiles, rtol=1e-12)


def test_the_fit_is_that_of_scipy(file):
    counts, bias, error = (file[name][()] for name in ["asperity_count", "bias", "bias_standard_error"])
    mean = file["pull_off_per_asperity_controlled_mean"][()] / file["integral_pull_off_per_asperity"][()]
    assert np.allclose(bias, mean - 1.0, rtol=1e-12)
    taken = file["is_fitted"][()] == 1
    assert not taken[bias > 0.5].any() and list(taken) == sorted(taken) and taken.sum() >= 3
    law = lambda n, log_c, a: np.exp(log_c - a * np.log(n))  # noqa: E731
    parameters, covariance = scipy.optimize.curve_fit(law, counts[taken].astype(float), bias[taken], p0=[3.0, 0.7],
                                                      sigma=error[taken], absolute_sigma=True)
    attributes = file.attrs
    assert np.log(attributes["fit_coefficient"]) == pytest.approx(parameters[0], rel=1e-5)
    assert attributes["fit_exponent"] == pytest.approx(parameters[1], rel=1e-5)
    residuals = (law(counts[taken], *parameters) - bias[taken]) / error[taken]
    assert attributes["fit_chi_squared"] == pytest.approx((residuals**2).sum(), rel=1e-4)
    misfit = max(1.0, (residuals**2).sum() / (taken.sum() - 2)) ** 0.5
    errors = [attributes["fit_log_coefficient_standard_error"], attributes["fit_exponent_standard_error"]]
    assert errors == pytest.approx(misfit * np.sqrt(np.diag(covariance)), rel=1e-3)
    assert np.allclose(file["bias_fitted"], law(counts.astype(float), *parameters), rtol=1e-4)


def test_the_sizes_that_are_good_enough_are_on_the_curve(file):
    counts, bias = file["asperity_count"][()], file["bias"][()]
    found = zip(file["accuracy"][()], file["count_at_accuracy"][()], file["count_at_accuracy_source"][()])
    for accuracy, count, source in found:
        if source == b"interpolated":
            assert np.interp(np.log(count), np.log(counts), np.log(bias)) == pytest.approx(np.log(accuracy), rel=1e-9)
        elif source in [b"beyond the largest", b"unknown"]:
            assert np.isnan(count)
        else:
            assert source == b"extrapolated" and count > counts[-1]
            c, a = file.attrs["fit_coefficient"], file.attrs["fit_exponent"]
            assert c * count**-a == pytest.approx(accuracy, rel=1e-9)
