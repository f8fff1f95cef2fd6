"""Smoothed maps and series over cut-offs against numpy and SurfaceTopography; Hertz contacts of ellipsoids against `scipy.special`."""

import math
import re
import subprocess

import numpy as np
import pytest
import scipy.ndimage
import scipy.optimize
import scipy.special
import SurfaceTopography

import stiction
from stiction import FileError, SceneError
from stiction.plot import page, panels
from stiction.program import find


def rough(seed=3, shape=(90, 110)):
    """Roughness of several wavelengths, and noise, m."""
    rng = np.random.default_rng(seed)
    smooth = scipy.ndimage.gaussian_filter(rng.normal(size=shape), 3.0)
    return 1e-9 * (smooth / smooth.std() + 0.2 * rng.normal(size=shape))


def test_moments_of_a_smoothed_map_are_those_of_numpy_and_of_surface_topography():
    """m0, m2 and m4 within the border that is left out; the slope of a periodic map by SurfaceTopography's own derivatives."""
    z, cutoff, pixel = rough(7), 120e-9, 10e-9
    found = stiction.find_asperities(z, pixel=pixel, smooth=cutoff)
    down, along = (int(n) for n in found.attrs["border"])
    inner = found.map.values[down:-down, along:-along]
    surface = found.tree["surface"]
    slope = [np.mean(np.diff(inner, axis=axis) ** 2) / pixel**2 for axis in (0, 1)]
    bend = [np.mean(np.diff(inner, 2, axis=axis) ** 2) / pixel**4 for axis in (0, 1)]
    assert float(surface.m0) == pytest.approx(np.mean(inner**2), rel=1e-9)
    assert float(surface.m2) == pytest.approx(np.mean(slope), rel=1e-9)
    assert float(surface.m4) == pytest.approx(np.mean(bend), rel=1e-9)
    rows, columns = inner.shape
    theirs = SurfaceTopography.Topography(inner.T, (columns * pixel, rows * pixel), unit="m")
    by_x, by_y = theirs.derivative(1)
    own = [float(surface.slope_x), float(surface.slope_y)]
    assert own == pytest.approx([float(np.mean(np.square(by_x))), float(np.mean(np.square(by_y)))], rel=2e-2)
    assert own == pytest.approx([slope[1], slope[0]], rel=1e-9)


def test_lengths_may_be_numbers_texts_and_a_series():
    z = rough(5)
    one = stiction.find_asperities(z, pixel=1e-8, smooth=1.5e-7, prominence=2e-10, cutoffs=5)
    other = stiction.find_asperities(z, pixel="10 nm", smooth="150 nm", prominence="0.2 nm", cutoffs=5)
    np.testing.assert_array_equal(one.height, other.height)
    cutoffs = one.cutoffs
    assert cutoffs.sizes["cutoff"] == 6 and 1.5e-7 in cutoffs.cutoff.values
    np.testing.assert_allclose(cutoffs.cutoff.values[[0, -1]], [2e-8, 2.25e-7])
    np.testing.assert_allclose(cutoffs.asperity_density, cutoffs.summit_count / cutoffs.nominal_area)
    # Every row is what a search of the map with that cut-off finds.
    for at in (0, 2, 5):
        row = cutoffs.isel(cutoff=at)
        again = stiction.find_asperities(z, pixel=1e-8, smooth=float(row.cutoff), prominence=2e-10)
        measured = again.tree["measured"]
        for name in ("asperity_density", "asperity_radius", "asperity_height_std", "asperity_curvature_std"):
            assert float(row[name]) == pytest.approx(float(measured[name]), rel=1e-9), name
    assert float(one.asperities.prominence.min()) >= 2e-10
    with pytest.raises(FileError, match="no series over cut-offs"):
        _ = stiction.find_asperities(z, pixel=1e-8).cutoffs
    with pytest.raises(SceneError, match="below two pixels"):
        stiction.find_asperities(z, pixel=1e-8, smooth=1e-8)


def hertz(ratio):
    """Hertz forces of spheres over that of an ellipsoid of curvatures `ratio` and 1: of 2/(κ₁ + κ₂) and of 1/√(κ₁κ₂)."""

    def integrals(k):
        return scipy.special.ellipk(1.0 - k * k), scipy.special.ellipe(1.0 - k * k)

    def off(k):
        first, second = integrals(k)
        return (second / k**2 - first) / (first - second) - ratio

    k = scipy.optimize.brentq(off, 1e-3, 1.0 - 1e-7, xtol=1e-14)
    first, second = integrals(k)
    force = 2.0 * math.pi / 3.0 / first * math.sqrt((first - second) / (first * (1.0 - k * k) * 0.5))
    return [4.0 / 3.0 * math.sqrt(radius) / force for radius in (2.0 / (1.0 + ratio), ratio**-0.5)]


def test_the_summary_tells_the_shape_and_its_force(tmp_path):
    """The median ratio of principal curvatures by numpy's eigenvalues, and what that makes of the Hertz force by scipy's integrals."""
    np.save(tmp_path / "map.npy", rough(9))
    found = stiction.find_asperities(
        tmp_path / "map.npy", tmp_path / "map.h5", pixel=1e-8, height_unit="m", smooth=1e-7
    )
    of = found.asperities
    xx, yy, xy = of.curvature_x.values, of.curvature_y.values, of.curvature_xy.values
    eigen = np.linalg.eigvalsh(np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2))
    there = eigen[:, 0] > 0.0
    np.testing.assert_allclose(of.principal_radius_1, 1.0 / eigen[:, 1], rtol=1e-9)
    np.testing.assert_allclose(of.principal_radius_2[there], 1.0 / eigen[there, 0], rtol=1e-7)
    assert np.isnan(of.principal_radius_2[~there]).all()
    np.testing.assert_allclose(of.equivalent_radius[there], 1.0 / np.sqrt(eigen[there].prod(axis=1)), rtol=1e-8)
    np.testing.assert_allclose(of.radius, 2.0 / eigen.sum(axis=1), rtol=1e-9)
    ratio = float(np.median(eigen[there, 1] / eigen[there, 0]))
    assert float(found.tree["measured"].curvature_ratio_median) == pytest.approx(ratio, rel=1e-9)
    command = [
        find(),
        "asperities",
        tmp_path / "map.npy",
        "--pixel",
        "10 nm",
        "--height-unit",
        "m",
        "--smooth",
        "100 nm",
    ]
    reported = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=True).stdout
    shown = re.search(r"k1/k2 = ([\d.]+),.*\n.*\n\s+(-[\d.]+) % with R = 1/mean curvature, (-[\d.]+) %", reported)
    assert float(shown[1]) == pytest.approx(ratio, abs=5e-3)
    expected = [100.0 * (share - 1.0) for share in hertz(ratio)]
    assert [float(shown[2]), float(shown[3])] == pytest.approx(expected, abs=6e-3)


def test_panels_over_the_cutoff_have_the_numbers_of_the_file():
    plain = stiction.find_asperities(rough(4), pixel=1e-8)
    assert "density_over_cutoff" not in panels(plain)
    for smooth in (None, 9e-8):
        found = stiction.find_asperities(rough(4), pixel=1e-8, smooth=smooth, cutoffs=6)
        names = ["density_over_cutoff", "radius_over_cutoff", "scatter_over_cutoff"]
        assert list(panels(found))[-3:] == names
        figure = page(found, what=names)
        of = found.cutoffs
        factors = {"asperity_density": 1e12, "asperity_radius": 1e-9, "asperity_height_std": 1e-12}
        for ax, (name, factor) in zip(figure.axes, factors.items(), strict=True):
            line = next(line for line in ax.lines if line.get_label() == "of summits")
            there = (of.summit_count > 1).values
            shown = line.get_ydata() / of[name].values[there]
            assert np.ptp(shown) < 1e-9 * shown[0] and (
                name != "asperity_density" or shown[0] == pytest.approx(1.0 / factor)
            )
            words = [str(line.get_label()) for line in ax.lines]
            assert any(word.startswith("smoothed with 90" if smooth else "not smoothed") for word in words), (words)


def test_pixels_that_are_not_square_are_drawn_as_they_are():
    found = stiction.find_asperities(rough(shape=(48, 70)), pixel=(20e-9, 30e-9), level="none")
    ax = page(found, what="asperities").axes[0]
    assert ax.get_xlabel() == "x (µm)"
    assert ax.images[0].get_extent() == pytest.approx([0.0, 70 * 0.02, 48 * 0.03, 0.0])
