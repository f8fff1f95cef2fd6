"""A run that ended at its targets, read with h5py and checked with numpy, independently of the program.

Needs the packages of scripts/requirements.txt. The program is $STICTION, by default target/release/stiction.
"""

import math
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from program import ROOT, changed, run_scene

TARGETS = """target = [
    { quantity = "pull_off_force", relative_standard_error = 0.03 },
    { quantity = "pull_off_separation", standard_error = "0.04 nm" },
    { quantity = "pull_off_force", relative_standard_error = 0.02, estimate = "controlled" },
]
min_replicas = 50
max_replicas = 5000
sampling = "antithetic"
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Path:
    scene = changed(ROOT / "tests" / "data" / "quick.toml", ("count = 91", "count = 31"), ("replicas = 200\n", TARGETS))
    return run_scene(tmp_path_factory.mktemp("stopping"), scene)[0]


@pytest.fixture(scope="module")
def file(path):
    with h5py.File(path, "r") as file:
        yield file


def looks(first: int, most: int) -> list[int]:
    found = [first]
    while found[-1] < most:
        found.append(min(8 * math.ceil((found[-1] + math.ceil(found[-1] / 10)) / 8), most))
    return found


def error(values: np.ndarray) -> tuple[float, float]:
    """Mean and standard error by antithetic pairs."""
    pairs = values.reshape(-1, 2).mean(axis=1)
    return pairs.mean(), pairs.std(ddof=1) / math.sqrt(pairs.size)


def test_the_end_is_the_first_look_that_meets_all_targets(file):
    force, separation = file["replicas/pull_off_force"][()], file["replicas/pull_off_separation"][()]
    replicas = file.attrs["replicas"]
    assert force.size == replicas and file.attrs["min_replicas"] == 56 and file.attrs["max_replicas"] == 5000
    seen = [look for look in looks(56, 5000) if look <= replicas]
    assert len(seen) > 3 and seen[-1] == replicas

    def plain_are_met(look: int) -> bool:
        mean, of_force = error(force[:look])
        return of_force <= 0.03 * mean and error(separation[:look])[1] <= 0.04e-9

    # The third target, with control variates, is met before these two.
    assert [plain_are_met(look) for look in seen] == [False] * (len(seen) - 1) + [True]
    ensemble = file["ensemble"]
    assert list(file["ensemble/target"].asstr()) == ["pull_off_force", "pull_off_separation", "pull_off_force"]
    assert list(ensemble["target_estimate"].asstr()) == ["plain", "plain", "controlled"]
    assert list(ensemble["target_units"].asstr()) == ["N", "m", "N"]
    expected = [error(force), error(separation)]
    np.testing.assert_allclose(ensemble["target_mean"][:2], [mean for mean, _ in expected], rtol=1e-10)
    np.testing.assert_allclose(ensemble["target_standard_error"][:2], [error for _, error in expected], rtol=1e-10)
    assert ensemble["target_mean"][2] == ensemble["scalar_controlled_mean"][0]
    assert ensemble["target_standard_error"][2] == ensemble["scalar_controlled_standard_error"][0]
    assert (ensemble["target_interval"][2] == ensemble["scalar_controlled_interval"][0]).all()
    assert (ensemble["target_interval"][0] == ensemble["scalar_interval"][0]).all()
    allowed = [0.03 * expected[0][0], 0.04e-9, 0.02 * ensemble["target_mean"][2]]
    np.testing.assert_allclose(ensemble["target_largest_standard_error"], allowed, rtol=1e-10)
    assert list(ensemble["target_met"]) == [1, 1, 1] and ensemble.attrs["stopping_reason"] == "all targets are met"


def test_xarray_sees_targets(path):
    with xarray.open_datatree(path, engine="h5netcdf") as tree:
        names = [name for name in tree["ensemble"].data_vars if name.startswith("target_")]
        assert len(names) == 6
        for name in names:
            variable = tree["ensemble"][name]
            dims = ("target", "range_end") if name == "target_interval" else ("target",)
            assert variable.dims == dims and variable.attrs["long_name"], name
            assert ("units" in variable.attrs) == (name in ("target_estimate", "target_met")), name
            assert "units" in variable.attrs or list(variable.target_units.values) == ["N", "m", "N"], name
