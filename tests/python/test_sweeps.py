"""What a sweep file holds, read with h5py and xarray and checked with numpy, and the pictures of one.

Needs the packages of scripts/requirements.txt. The program is $STICTION, by default target/release/stiction.
"""

from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from program import ROOT, changed, run_scene

REPLICAS = 24
KEYS = ["material.work_of_adhesion", "surface.lubricant_thickness"]
ENERGY, LUBRICANT = (key.replace(".", "_") for key in KEYS)
GRID = f"""
[sweep]
"{KEYS[0]}" = {{ from = "0.06 J/m^2", to = "0.24 J/m^2", count = 3, spacing = "log" }}
"{KEYS[1]}" = ["0 nm", "0.5 nm"]
"""
ZIP = """
[sweep]
mode = "zip"
surface.surface_height_std = ["1.5 nm", "2 nm", "2.5 nm"]
material.hardness = ["2.5 GPa", "2 GPa", "1.5 GPa"]
"""


def run(folder: Path, sweep: str) -> Path:
    quick = changed(ROOT / "tests" / "data" / "quick.toml", ("count = 91", "count = 31"))
    return run_scene(folder, quick + sweep, "--replicas", REPLICAS)[0]


@pytest.fixture(scope="module")
def grid(tmp_path_factory) -> Path:
    return run(tmp_path_factory.mktemp("grid"), GRID)


@pytest.fixture(scope="module")
def zipped(tmp_path_factory) -> Path:
    return run(tmp_path_factory.mktemp("zip"), ZIP)


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_sees_keys_by_name(grid, engine):
    with xarray.open_datatree(grid, engine=engine) as tree:
        assert tree[ENERGY].values == pytest.approx([0.06, 0.12, 0.24], rel=1e-15)
        assert tree[ENERGY].attrs["units"] == "J m-2" and tree[LUBRICANT].attrs["units"] == "m"
        for group in tree.groups[1:]:
            for name, variable in tree[group].data_vars.items():
                assert "units" in variable.attrs or "scalar_units" in variable.coords, name
                assert variable.attrs["long_name"] and variable.dims[:2] == (ENERGY, LUBRICANT), name
        force = tree["ensemble"].external_force_mean
        assert force.dims == (ENERGY, LUBRICANT, "separation_index")
        assert force.separation.dims == force.h_star.dims == force.dims
        assert [tree[key].attrs["key"] for key in (ENERGY, LUBRICANT)] == KEYS
        # A node is a table: no dimension of another group comes with it.
        assert all(len(tree[group].to_dataset().to_dataframe()) < 100_000 for group in tree.groups)
        assert set(tree["replicas"].dims) == {ENERGY, LUBRICANT, "replica"}
        pull_off = tree["integral"].pull_off_force
        assert float(pull_off.sel({ENERGY: 0.24, LUBRICANT: 0.0})) > float(pull_off.sel({ENERGY: 0.06, LUBRICANT: 0.0}))


def test_differences_are_paired(grid):
    with h5py.File(grid) as file:
        for name in ["pull_off_force", "pull_off_separation", "peak_secant_stiffness",
                     "peak_secant_stiffness_separation"]:
            values = file[f"replicas/{name}"][()]
            assert values.shape == (3, 2, REPLICAS)
            differences = values - values[0, 0]
            error = differences.std(axis=-1, ddof=1) / np.sqrt(REPLICAS)
            # Against itself all replicas agree: no error is known.
            error[0, 0] = np.nan
            assert np.allclose(file[f"differences/{name}_mean"], differences.mean(axis=-1), rtol=1e-9)
            assert np.allclose(file[f"differences/{name}_standard_error"], error, rtol=1e-9, equal_nan=True)
            apart = (values.var(axis=-1, ddof=1) + values[0, 0].var(ddof=1)) / REPLICAS
            ratio = file[f"differences/{name}_variance_ratio"][()]
            assert np.isnan(ratio[0, 0])
            assert np.allclose(ratio.ravel()[1:], apart.ravel()[1:] / error.ravel()[1:] ** 2, rtol=1e-9)


def test_numbers_of_a_point_follow_from_its_keys(grid):
    """lambda goes with the 2/3 power of the work of adhesion; the rest of the scene stays."""
    with h5py.File(grid) as file:
        assert file.attrs["format"] == "stiction-sweep"
        assert file.attrs["points"] == 6 and file.attrs["sweep_keys"] == ", ".join(KEYS)
        parameter = file["adhesion_parameter"][()]
        assert np.allclose(parameter / parameter[0], np.array([[1.0], [2.0], [4.0]]) ** (2 / 3), rtol=1e-14)
        assert np.ptp(file["nominal_area"][()]) == 0.0 and np.all(file["seed"][()] == 1)
        # A regime that a point does not have is empty there.
        lubricant = [name.decode() for name in file["ensemble/regime"]].index("lubricant")
        count = file["ensemble/regime_count_mean"][()]
        assert np.all(count[:, 0, lubricant] == 0.0) and np.all(count[:, 1, lubricant].max(axis=-1) > 0.0)
        assert np.allclose(count.sum(axis=2), file["replicas/asperity_count"][()].mean(axis=-1)[..., None], rtol=1e-12)


def test_keys_that_go_together_are_coordinates_of_points(zipped):
    with xarray.open_datatree(zipped, engine="h5netcdf") as tree:
        assert tree["ensemble"].external_force_mean.dims == ("point", "separation_index")
        assert tree["material_hardness"].dims == ("point",)
        assert "material_hardness" in tree["integral"].pull_off_force.coords
        sigma = tree["surface_surface_height_std"].values
        assert list(sigma) == [1.5e-9, 2e-9, 2.5e-9] and list(tree["surface_height_std"].values) == list(sigma)
        # The same h*, so other separations.
        assert np.allclose(tree["ensemble/h_star"].values, tree["ensemble/h_star"].values[0])
        assert np.allclose(tree["ensemble/separation"].values, sigma[:, None] * tree["ensemble/h_star"].values, rtol=1e-14)
