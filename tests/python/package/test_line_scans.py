"""Line scans: their spectral moments against closed forms, the map that one is cut from, and scenes."""

import itertools
import os
import re

import numpy as np
import pytest
from conftest import CONFIGS

import stiction
from stiction.program import call

MAP = CONFIGS / "maps" / "polished.txt"


def sine(pixels, periods=200):
    """z = a sin kx over whole periods, symmetric about their middle, on an offset and a tilt: heights and
    pixel, m, and the moments of the wave."""
    a, pixel = 3e-9, 1e-9
    k = 2.0 * np.pi / (pixels * pixel)
    x = (np.arange(pixels * periods) + 0.5 - 0.5 * pixels * periods) * pixel
    return a * np.cos(k * x) + 1e-6 + 1e-3 * x, pixel, np.array([a**2, a**2 * k**2, a**2 * k**4]) / 2.0


def test_a_sine_has_its_moments():
    """m0 = a²/2, m2 = a²k²/2 and m4 = a²k⁴/2, where differences have 2 sin(k dx/2)/dx for k: second order."""
    errors = []
    for pixels in (8, 16, 32, 64):
        z, pixel, exact = sine(pixels)
        of = stiction.spectral_moments(z, pixel=pixel)
        found = np.array([of.m0, of.m2, of.m4])
        part = np.sinc(1.0 / pixels) ** 2
        # A difference less at the end than there are heights.
        np.testing.assert_allclose(found, exact * [1.0, part, part**2], rtol=1.0 / (100.0 * pixels))
        assert of.alpha == pytest.approx(of.m0 * of.m4 / of.m2**2, rel=1e-14)
        errors.append(1.0 - found[1:] / exact[1:])
    for coarse, fine in itertools.pairwise(errors):
        np.testing.assert_allclose(np.log2(coarse / fine), 2.0, atol=0.1)


def test_cuts_through_a_map_have_its_moments():
    """The mean over all cuts along both directions: m2 and m4 are those of the map, but for the line in the
    place of the plane; of a single cut they scatter. The waves longer than a cut are missing in m0."""
    z = np.loadtxt(MAP)
    whole = stiction.spectral_moments(MAP)
    cuts = [stiction.spectral_moments(line, pixel="30 nm", height_unit="nm") for line in (*z, *z.T)]
    assert np.mean([of.m2 for of in cuts]) == pytest.approx(whole.m2, rel=0.03)
    assert np.mean([of.m4 for of in cuts]) == pytest.approx(whole.m4, rel=1e-9)
    assert np.mean([of.m0 for of in cuts]) < whole.m0
    maxima = z.shape[0] * 3e-8 / (2.0 * np.pi * np.sqrt(whole.m2 / whole.m4))
    assert np.std([of.m2 / whole.m2 for of in cuts]) < 2.0 / np.sqrt(maxima)
    with stiction.find_asperities(MAP) as found:
        for name in ("m0", "m2", "m4", "alpha"):
            assert getattr(whole, name) == float(found[f"surface/{name}"]), name
        for name in ("density", "radius", "height_mean", "height_std"):
            assert getattr(whole, name) == float(found[f"equivalent/asperity_{name}"]), name


@pytest.mark.parametrize("form", ["column", "line", "points", "header"])
def test_the_line_of_a_scene_is_what_was_found(form, command, tmp_path):
    """Texts of every form; the program takes what the command prints, and has its numbers."""
    z, pixel = np.loadtxt(MAP)[40], 30e-9
    x = np.arange(z.size) * 30.0
    units = ("--pixel", "30 nm", "--height-unit", "nm")
    if form == "points":
        table = "\n".join(f"{u:.1f}\t{v!r}" for u, v in zip(x.tolist(), z.tolist(), strict=True))
        (tmp_path / "profile.txt").write_text(f"x [nm]\tz [nm]\n{table}\n", encoding="utf-8")
        units = ()
    else:
        head = f"# Width: {30 * z.size} nm\n# Value units: nm\n" if form == "header" else ""
        rows = (" " if form == "line" else "\n").join(map(repr, z.tolist()))
        (tmp_path / "profile.txt").write_text(f"{head}{rows}\n", encoding="utf-8")
        units = () if form == "header" else units
    said = command("profile.txt", *units)
    of = stiction.spectral_moments(1e-9 * z, pixel=pixel)
    assert f"\n  {of.toml}\n" in said and "192 heights over 5.730 µm" in said
    assert "few maxima" in said.replace("\n                    ", " ")
    scene = (CONFIGS / "surfaces" / "spectrum.toml").read_text(encoding="utf-8")
    lines = [of.toml if line.startswith("spectrum") else line for line in scene.splitlines()]
    (tmp_path / "scene.toml").write_text("\n".join(lines), encoding="utf-8")
    checked = call(["check", str(tmp_path / "scene.toml")])
    radius = re.search(r"1/mean curvature ([\d.]+) µm", checked)
    assert float(radius[1]) == pytest.approx(1e6 * of.radius, rel=2e-4)
    assert f"alpha = {of.alpha:.3f}" in checked
    std = re.search(r"sigma_s\s+([\d.]+) pm", checked)
    assert float(std[1]) == pytest.approx(1e12 * of.height_std, rel=2e-4)


def test_lines_of_surface_topography(tmp_path):
    library = pytest.importorskip("SurfaceTopography")
    z, pixel, _ = sine(16)
    line = library.UniformLineScan(1e9 * z, 1e9 * z.size * pixel, unit="nm")
    of, own = stiction.spectral_moments(line), stiction.spectral_moments(z, pixel=pixel)
    assert [of.m0, of.m2, of.m4] == pytest.approx([own.m0, own.m2, own.m4], rel=1e-9)
    uneven = library.NonuniformLineScan(np.arange(20.0) ** 2, z[:20], unit="m")
    with pytest.raises(stiction.SceneError, match="uneven steps"):
        stiction.spectral_moments(uneven)


def test_missing_heights_are_left_out():
    z, pixel, _ = sine(16)
    whole = stiction.spectral_moments(z, pixel=pixel)
    z[100:140] = np.nan
    assert stiction.spectral_moments(z, pixel=pixel).m4 == pytest.approx(whole.m4, rel=0.02)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (("-o", "out.h5"), "--output"),
        (("--figure", "out.png"), "--figure"),
        (("--level", "quadratic"), "--level"),
        (("--smooth", "9 nm", "--cutoffs", "4"), "--smooth, --cutoffs"),
        (("--prominence", "1 nm", "--min-distance", "9 nm"), "--prominence, --min-distance"),
        (("--level-rows", "median"), "--level-rows"),
        (("--mask", "mask.npy"), "--mask"),
    ],
)
def test_options_of_maps_are_refused(options, named, command):
    np.save("line.npy", sine(8)[0])
    np.save("mask.npy", np.zeros(sine(8)[0].size))
    before = os.listdir()
    said = command("line.npy", "--pixel", "1 nm", "--height-unit", "m", *options, code=2)
    assert f"{named}: line.npy is a line scan, which has a spectrum, but no asperities" in said
    assert os.listdir() == before


@pytest.mark.parametrize(
    ("source", "said"),
    [
        (np.arange(7.0), "the line scan has 7 heights; at least 8"),
        (np.arange(20.0), "the levelled profile is flat"),
        (np.where(np.arange(20) == 3, 1.0, np.nan), "fewer than two heights are known"),
        (np.where(np.arange(20) % 2, 1.0, np.nan), "the levelled profile is flat"),
        (np.where(np.arange(20) % 2, np.arange(20.0) ** 2, np.nan), "leave no neighbouring pixels"),
    ],
)
def test_lines_that_are_none_are_refused(source, said):
    with pytest.raises(stiction.SceneError, match=f"^source: .*{said}"):
        stiction.spectral_moments(source, pixel=1.0)


def test_points_of_uneven_steps_are_refused(tmp_path):
    path = tmp_path / "points.txt"
    path.write_text("\n".join(f"{i * i} {i % 3}" for i in range(20)), encoding="utf-8")
    with pytest.raises(stiction.SceneError, match=r"points.txt: .*even steps"):
        stiction.spectral_moments(path, pixel="1 nm", height_unit="nm")
