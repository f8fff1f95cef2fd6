"""What a file of asperities holds, read with h5py and xarray and found anew from the map with numpy and scipy.

Needs the packages of scripts/requirements.txt.
"""

import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.integrate
import scipy.ndimage
import xarray
from program import ROOT
from stiction.maps.reading import read_map

MAP, PIXEL = ROOT / "configs" / "maps" / "polished.txt", 3e-8

sys.path.insert(0, str(ROOT / "scripts"))


def stiction(*arguments) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "stiction.maps", *arguments]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8")


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("asperities") / "polished.h5"
    run = stiction(MAP, "-o", path)
    assert run.returncode == 0, run.stderr
    return path


@pytest.fixture(scope="module")
def file(path):
    with h5py.File(path, "r") as file:
        yield file


@pytest.fixture(scope="module")
def surface() -> np.ndarray:
    """The shipped map less its plane, m."""
    z = 1e-9 * np.loadtxt(MAP)
    y, x = np.indices(z.shape)
    basis = np.stack([np.ones(z.size), x.ravel(), y.ravel()], axis=1)
    coefficients = np.linalg.lstsq(basis, z.ravel(), rcond=None)[0]
    return z - (basis @ coefficients).reshape(z.shape)


def summits(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    around = np.ones((3, 3), dtype=bool)
    around[1, 1] = False
    higher = z > scipy.ndimage.maximum_filter(z, footprint=around)
    higher[[0, -1], :] = higher[:, [0, -1]] = False
    return np.nonzero(higher)


def test_asperities_are_the_summits_of_the_map(file, surface):
    row, column = summits(surface)
    assert row.size > 150
    z = surface
    xx = (z[row, column + 1] - 2.0 * z[row, column] + z[row, column - 1]) / PIXEL**2
    yy = (z[row + 1, column] - 2.0 * z[row, column] + z[row - 1, column]) / PIXEL**2
    group = file["asperities"]
    np.testing.assert_allclose(group["height"], z[row, column], rtol=1e-9, atol=1e-20)
    np.testing.assert_allclose(group["radius"], -2.0 / (xx + yy), rtol=1e-9)
    np.testing.assert_allclose(group["curvature_x"], -xx, rtol=1e-8)
    np.testing.assert_allclose(group["curvature_y"], -yy, rtol=1e-8)
    np.testing.assert_allclose(group["x"], (column + 0.5) * PIXEL, rtol=1e-14)
    np.testing.assert_allclose(group["y"], (row + 0.5) * PIXEL, rtol=1e-14)
    measured = file["measured"]
    area = (z.shape[0] - 2) * (z.shape[1] - 2) * PIXEL**2
    assert file.attrs["nominal_area"] == pytest.approx(area, rel=1e-14)
    assert measured["asperity_density"][()] == pytest.approx(row.size / area, rel=1e-14)
    assert measured["asperity_radius"][()] == pytest.approx(1.0 / np.mean(-0.5 * (xx + yy)), rel=1e-9)
    assert measured["asperity_height_mean"][()] == file.attrs["mean_plane_offset"]
    assert measured["asperity_height_std"][()] == pytest.approx(np.std(z[row, column], ddof=1), rel=1e-9)


def test_moments_and_the_equivalent_surface(file, surface):
    z, moments, equivalent = surface, file["surface"], file["equivalent"]
    slope = [np.mean(np.diff(z, axis=axis) ** 2) / PIXEL**2 for axis in (1, 0)]
    m0, m2 = np.mean(z**2), np.mean(slope)
    m4 = np.mean([np.mean(np.diff(z, 2, axis=axis) ** 2) for axis in (0, 1)]) / PIXEL**4
    for name, value in {"m0": m0, "m2": m2, "m4": m4, "slope_x": slope[0], "slope_y": slope[1],
                        "alpha": m0 * m4 / m2**2}.items():
        assert moments[name][()] == pytest.approx(value, rel=1e-9), name
    assert moments["skewness"][()] == pytest.approx(np.mean(z**3) / m0**1.5, abs=1e-9)
    assert moments["excess_kurtosis"][()] == pytest.approx(np.mean(z**4) / m0**2 - 3.0, abs=1e-9)
    alpha = m0 * m4 / m2**2
    assert equivalent["asperity_density"][()] == pytest.approx(m4 / (6.0 * np.pi * np.sqrt(3.0) * m2), rel=1e-9)
    assert equivalent["asperity_radius"][()] == pytest.approx(0.375 * np.sqrt(np.pi / m4), rel=1e-9)
    assert equivalent["asperity_height_mean"][()] == pytest.approx(4.0 * np.sqrt(m0 / (np.pi * alpha)), rel=1e-9)
    assert equivalent["asperity_height_std"][()] == pytest.approx(np.sqrt((1.0 - 0.8968 / alpha) * m0), rel=1e-9)


def test_xarray_sees_every_dataset_with_its_units(path):
    with xarray.open_datatree(path, engine="h5netcdf") as tree:
        assert tree.attrs["format"] == "stiction-asperities"
        seen = 0
        for group in ("asperities", "surface", "measured", "equivalent"):
            for name, variable in tree[group].data_vars.items():
                assert variable.attrs["units"] and variable.attrs["long_name"], name
                assert variable.dims == (("asperity",) if group == "asperities" else ()), name
                seen += 1
        assert seen == 29


@pytest.mark.parametrize("dtype, order", [("<f8", "C"), (">f4", "F"), ("<i2", "C"), (">u4", "F"), ("|i1", "C")])
def test_arrays_of_numpy(tmp_path, dtype, order):
    """What NumPy writes is read as NumPy reads it, whatever type and order."""
    z = np.random.Generator(np.random.PCG64(3)).normal(60.0, 12.0, (40, 30)).round().astype(dtype)
    np.save(tmp_path / "map.npy", np.asarray(z, order=order))
    read = read_map(tmp_path / "map.npy", pixel="2 nm,1 nm", height_unit="pm")
    np.testing.assert_allclose(read.heights, 1e-12 * z.astype(float), rtol=1e-14)
    assert read.pixel == (2e-9, 1e-9)


@pytest.mark.parametrize("options", [{}, {"chunks": (16, 16), "compression": "gzip"}, {"dtype": ">f4"}])
def test_datasets_of_hdf5(tmp_path, options):
    """Layout and type of a dataset do not matter, and its units are taken."""
    z = np.random.Generator(np.random.PCG64(4)).normal(0.0, 1.0, (48, 64)).astype("f4")
    with h5py.File(tmp_path / "in.h5", "w") as file:
        file.create_dataset("height", data=z, **options).attrs["units"] = "nm"
    read = read_map(tmp_path / "in.h5", pixel="1 nm")
    np.testing.assert_allclose(read.heights, 1e-9 * z.astype(float), rtol=1e-14)
    assert read.source.endswith("in.h5, channel height")


def test_nayaks_density_in_the_plot():
    """The density that the plot draws is one, and has the moments of the theory."""
    from stiction.plot.others import nayak

    for alpha in (1.6, 2.0, 9.0):
        density = lambda s, power: s**power * nayak(s, alpha)  # noqa: E731
        one, mean, square = [scipy.integrate.quad(density, -9.0, 9.0, (power,), limit=200)[0] for power in range(3)]
        assert one == pytest.approx(1.0, abs=1e-9)
        assert mean == pytest.approx(4.0 / np.sqrt(np.pi * alpha), abs=1e-9)
        assert square - mean**2 == pytest.approx(1.0 - 0.8968 / alpha, abs=1e-5)


def test_the_shipped_map_is_that_of_its_script():
    """Rounded to picometres, but for the last bits of a Fourier transform, which may round a height the other way."""
    from synthesise_map import heights

    assert np.abs(np.loadtxt(MAP) - heights()).max() < 5.1e-4
