"""One answer from a map, and the spectrum of several scans: against closed forms, a surface of known spectrum and
SurfaceTopography."""

import math

import numpy as np
import pytest
import xarray
from conftest import ROOT
from scipy import ndimage

import stiction
from stiction import SceneError
from stiction.assessment import criteria
from stiction.assessment.command import main
from stiction.assessment.cutoffs import chosen, contact_width
from stiction.maps.combine import of_scan
from stiction.maps.level import Grid
from stiction.maps.moments import in_numbers
from stiction.maps.spectrum import Moments

MAP = ROOT / "configs" / "maps" / "polished.txt"
NM = 1e-9

# The spectrum of several scans: a surface with C(q) ∝ (1 + (q/q_0)²)^−1.8 exp(−(q/q_1)²) and σ = 3 nm.

ROLL, END, STD = 2.0 * math.pi / 4e-6, 2.0 * math.pi / 20e-9, 3e-9


def shape(q):
    return (1.0 + (q / ROLL) ** 2) ** -1.8 * np.exp(-((q / END) ** 2))


def known(cutoff):
    """m0, m2 and m4 of the surface behind the Gaussian filter, by quadrature over C(q) itself."""
    q = np.geomspace(1e3, 1e10, 20001)
    scale = STD**2 / np.trapezoid(q**2 * shape(q) / (2.0 * math.pi), np.log(q))
    power = scale * shape(q) * 4.0 ** -((q * cutoff / (2.0 * math.pi)) ** 2)
    shares = (0.5 / math.pi, 0.25 / math.pi, 3.0 / (16.0 * math.pi))
    return scale, [s * np.trapezoid(q ** (2 + n) * power, np.log(q)) for s, n in zip(shares, (0, 2, 4), strict=True)]


def scan(side, seed, tip=None, pixels=128, finer=4):
    """A scan as a microscope takes it: another place, a dilated tip, the mean over each pixel, a tilt."""
    count, step = 2 * pixels * finer, side / pixels / finer
    q = 2.0 * math.pi * np.fft.fftfreq(count, step)
    amplitude = np.sqrt(known(0.0)[0] * shape(np.hypot(q[:, None], q[: count // 2 + 1]))) / step
    amplitude[0, 0] = 0.0
    noise = np.random.Generator(np.random.PCG64(seed)).standard_normal((count, count))
    z = np.fft.irfft2(amplitude * np.fft.rfft2(noise), (count, count))[: count // 2, : count // 2]
    if tip is not None and (reach := int(math.sqrt(2.0 * tip * 2e-9) / step)):
        y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1] * step
        z = ndimage.grey_dilation(z, structure=-(x**2 + y**2) / (2.0 * tip))
    z = z.reshape(pixels, finer, pixels, finer).mean((1, 3)) + 1e-3 * np.arange(pixels) * side / pixels
    at = (np.arange(pixels) + 0.5) * side / pixels
    places = {axis: (axis, at, {"units": "m"}) for axis in ("y", "x")}
    return xarray.DataArray(z, places, ("y", "x"), attrs={"units": "m"})


@pytest.mark.parametrize("tip", [None, 2e-7])
def test_scans_of_three_sizes_have_the_moments_of_the_surface(tip):
    """m0 is uncertain by 10 % by the waves of the largest scan, m2 by 5 %: 30 and 15 % are three errors, of 12 chances about 3 % are beyond."""
    scans = [scan(side, seed, tip) for seed, side in enumerate((1e-6, 5e-6, 25e-6))]
    found = stiction.combine_spectra(scans, tip=tip)
    assert found.warnings == [] and [one.side for one in found.scans] == pytest.approx([25e-6, 5e-6, 1e-6])
    for cutoff in (2.0 * found.shortest, 4.0 * found.shortest):
        of, (_, true) = found.moments(cutoff), known(cutoff)
        np.testing.assert_allclose([of.m0, of.m2, of.m4], true, rtol=0.3)
        np.testing.assert_allclose([of.m2, of.m4], true[1:], rtol=0.15)
    # No scan alone has all of them.
    for one in scans:
        alone, true = stiction.combine_spectra([one]).moments(2.0 * found.shortest), known(2.0 * found.shortest)[1]
        assert np.abs(np.array([alone.m0, alone.m2, alone.m4]) / true - 1.0).max() > 0.3
    middle = (found.wavevector > 2 * math.pi / 5e-6) & (found.wavevector < 2 * math.pi / found.shortest)
    deviations = np.log(found.density / (known(0.0)[0] * shape(found.wavevector)))[middle]
    assert abs(deviations.mean()) < 0.15 and deviations.std() < 0.35


def test_a_wave_has_its_variance_at_its_wavevector():
    """The integral over the spectrum of a wave of amplitude 1 nm has its variance 0.5 nm², and m2 = q²m0/2."""
    x = np.arange(256) * 10 * NM
    q = 2.0 * math.pi / (256 * 10 * NM / 16)
    found = of_scan(Grid(NM * np.cos(q * x)[None, :] * np.ones((256, 1)), (10 * NM, 10 * NM), 0.0), "wave", None)
    at = found.density.argmax()
    assert found.wavevector[at] == pytest.approx(q, rel=0.05)
    cells = found.modes * found.density * (2.0 * math.pi / (2560 * NM)) ** 2 / (2.0 * math.pi) ** 2
    assert cells.sum() == pytest.approx(0.5 * NM**2, rel=0.02)


def test_the_spectrum_and_the_tip_are_those_of_surface_topography():
    topography = pytest.importorskip("SurfaceTopography")
    z = scan(1e-6, 3).values
    z = z - z.mean()
    grid = Grid(z, (1e-6 / 128, 1e-6 / 128), 0.0)
    theirs = topography.Topography(z.T, (1e-6, 1e-6), unit="m")
    for tip in (1e-7, 4e-7):
        limit = theirs.scanning_probe_reliability_cutoff(tip)
        ours = of_scan(grid, "scan", tip).shortest
        # Steps of the stencil are pixels here, and any length there.
        assert abs(ours - max(limit or 0.0, 4e-6 / 128)) <= 2.0 * 1e-6 / 128 + 0.05 * ours
    q, power = theirs.power_spectrum_from_area(window="hann", reliable=False, nb_points_per_decade=24)
    found = of_scan(grid, "scan", None)
    inside = (q > 2 * math.pi / 0.3e-6) & (q < 2 * math.pi / 30e-9) & ~np.ma.getmaskarray(power)
    ratio = np.log(np.interp(np.log(q[inside]), np.log(found.wavevector), np.log(found.density)) / np.log(power[inside]))
    assert np.abs(ratio).max() < 0.02


def test_scans_that_leave_a_gap_and_none_are_named():
    scans = [scan(0.25e-6, 0), scan(100e-6, 1)]
    (warning,) = stiction.combine_spectra(scans).warnings
    assert "no scan is reliable from 83.3 nm to 3.13 µm" in warning
    with pytest.raises(SceneError, match="no wave is reliable: pixels and tip need"):
        stiction.combine_spectra([scan(1e-6, 0)], tip="1 m")
    for scans in ([], str(MAP)):
        with pytest.raises(SceneError, match="scans: a list of maps is needed"):
            stiction.combine_spectra(scans)


# Cut-offs and criteria.


def test_contacts_are_as_wide_as_the_unit_of_contact_radius():
    """a³ = πΔγR²/K = 1e-24 m³ for R = 1 µm, Δγ = 4/(3π) J/m² and E* = 1 TPa: a = 10 nm."""
    assert contact_width(1e-6, 4.0 / (3.0 * math.pi), 1e12) == pytest.approx(20.0 * NM)


def test_the_smaller_cutoff_is_resolved_and_as_wide_as_contacts():
    assert chosen(40 * NM, 4e-6, lambda cutoff: 30 * NM, None).smaller == pytest.approx(40 * NM)
    wide = chosen(40 * NM, 4e-6, lambda cutoff: 100 * NM, None)
    assert 100 * NM <= wide.smaller <= 112 * NM and wide.why == "as wide as contacts"
    # Contacts that are wider than any cut-off: the criterion says so.
    never = chosen(40 * NM, 4e-6, lambda cutoff: 2.0 * cutoff, None)
    assert never.smaller == pytest.approx(40 * NM)
    assert [one.advice for one in criteria.of_shape(1e-7, 5.0, never)] == ["", "", "boundary elements"]
    with pytest.raises(SceneError, match="no room for two cut-offs"):
        chosen(40 * NM, 300 * NM, lambda cutoff: 0.0, None)
    with pytest.raises(SceneError, match=r"smooth = 10\.00 nm: the smaller of two cut-offs is between 40.0 nm"):
        chosen(40 * NM, 4e-6, lambda cutoff: 0.0, 10 * NM)


def test_smoothed_noise_is_no_surface():
    """White noise behind a filter of the cut-off λ has m4/m2 by ∫q⁵ and ∫q³ of 4^(−(qλ/2π)²): maxima 0.96 λ apart."""
    noise = np.random.Generator(np.random.PCG64(1)).standard_normal((256, 256))
    grid = Grid(NM * noise, (NM, NM), 0.0)
    found = stiction.combine_spectra([xarray.DataArray(noise * NM, dims=("y", "x"), attrs={"units": "m"})], pixel=NM)
    of = found.moments(8 * NM)
    ratio = 2.0 * math.pi * math.sqrt(of.m2 / of.m4) / (8 * NM)
    assert ratio == pytest.approx(0.96, abs=0.03)
    cutoffs = chosen(8 * NM, 256 * NM, lambda cutoff: 0.0, None)
    assert next(criteria.of_shape(ratio * 8 * NM, of.alpha, cutoffs)).advice == "scan"
    # Independent heights: 1/√(2N), which noise of the autocorrelation makes 1/√N, √(6/N) and √(24/N).
    errors = criteria.sampling(grid)
    expected = np.sqrt(np.array([1.0, 6.0, 24.0]) / noise.size)
    np.testing.assert_allclose([errors.std, errors.skewness, errors.kurtosis], expected, rtol=0.02)


def test_surfaces_with_a_lay_or_worn_flat_are_not_gaussian():
    errors = criteria.Sampling(0.05, 0.1, 0.2)
    for of, met in (
        (Moments(1.0, 1.0, 1.2, 1.0, 0.2, 0.5), [True, True]),
        (Moments(1.0, 1.0, 1.6, 1.0, 0.2, 0.5), [True, False]),
        (Moments(1.0, 1.0, 1.0, 1.0, -0.4, 0.0), [False, True]),
        (Moments(1.0, 1.0, 1.0, 1.0, 0.0, 0.7), [False, True]),
    ):
        assert [not one.advice for one in criteria.of_surface(of, errors)] == met
    wide = criteria.Sampling(0.05, 0.3, 0.5)
    assert not next(criteria.of_surface(Moments(1.0, 1.0, 1.0, 1.0, -0.4, 0.7), wide)).advice


def test_factors_add_as_squares_of_logarithms():
    of = [criteria.Criterion("a", "", factor) for factor in (1.0, math.exp(0.3), math.exp(0.4))]
    assert criteria.factor_of(of) == pytest.approx(math.exp(0.5))


# The command.


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A quarter of the shipped map as an array file, and its answer."""
    folder = tmp_path_factory.mktemp("map")
    np.save(folder / "scan.npy", np.loadtxt(MAP)[:96, :96])
    command = [str(folder / "scan.npy"), "--pixel", "30 nm", "--height-unit", "nm", "--replicas", "20", "--quiet"]
    output = ["-o", str(folder / "answer.h5"), "--figure", str(folder / "answer.png"), "--above", "3 uN"]
    assert main([*command, *output, "--set", "model.history=approach"]) == 0
    return folder


def test_the_answer_is_one_distribution_of_both_cutoffs(small):
    with stiction.open_run(small / "answer.h5") as found:
        of, words = found.tree, found.words
        assert all(len(line) <= 80 for line in words.splitlines())
        assert list(of["way"].values) == ["map", "map", "patches", "patches"]
        np.testing.assert_allclose(of["cutoff"], [120 * NM, 240 * NM] * 2)
        forces = of["pull_off_force"].values
        assert np.isnan(forces[:2, 1:]).all() and np.isfinite(forces[2:]).all()
        share = np.mean(forces[2:] > 3e-6)
        assert f"P = {100 * share:.1f} %" in words and "template measured-map, not of your surface" in words
        assert found.attrs["nominal_area"] == pytest.approx((96 * 30 * NM) ** 2)
        assert found.attrs["factor"] == pytest.approx(criteria.factor_of([criteria.Criterion("", "", f) for f in of["criterion_factor"].values]))
        assert ("yes, within a factor" in words) == (found.attrs["assessment"] == "yes")
        assert found.plot() is not None
    assert (small / "answer.png").stat().st_size > 10_000


def test_the_map_itself_is_a_run_of_its_summits(small):
    """The row `this map` is what a run of the asperity file has, by the steps of the page."""
    asperities = stiction.find_asperities(small / "scan.npy", pixel="30 nm", height_unit="nm", smooth="120 nm")
    material = {"youngs_modulus": "169 GPa", "poisson_ratio": 0.22, "hardness": "12 GPa", "work_of_adhesion": "20 mJ/m^2"}
    surface = {"asperities": {"path": asperities, "sample": "whole", "radius": "equivalent"}}
    run = stiction.run({"material": material, "surface": surface, "model": {"history": "approach"}}, replicas=1)
    with stiction.open_run(small / "answer.h5") as found:
        assert float(found.tree["pull_off_force"][0, 0]) == pytest.approx(run.pull_off.mean_over_patches, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--area", "-1 um^2"], "--area '-1 um^2': above 0 is needed"),
        (["--area", "3 um"], "--area"),
        (["--tip", "10"], "--tip '10': a length with its unit is needed"),
        (["--smooth", "1 nm"], "--smooth 1.000 nm: the smaller of two cut-offs is between 120 nm"),
        (["--replicas", "1"], "--replicas 1: 2 or more are needed"),
        (["--set", "surface.nominal_area=1 um^2"], "surface.nominal_area: the map gives the surface"),
        (["--set", "shape.body=sphere"], "[shape]: a probe has no area"),
        (["--figure", "map.jpg"], "--figure map.jpg: a name that ends with"),
        (["-o", str(MAP)], "is an input"),
    ],
)
def test_a_wrong_option_is_named(options, message, capsys):
    assert main([str(MAP), "--quiet", *options]) == 2
    said = capsys.readouterr()
    assert message in said.err and not said.out


def test_a_line_scan_has_no_patches(tmp_path, capsys):
    np.savetxt(tmp_path / "line.txt", np.random.default_rng(0).standard_normal(200))
    assert main([str(tmp_path / "line.txt"), "--pixel", "5 nm", "--height-unit", "nm", "--quiet"]) == 2
    assert "line scan" in capsys.readouterr().err


def test_moments_of_two_surfaces_are_in_the_order_of_toml():
    of = in_numbers(Moments(1e-18, 1e-4, 1e-4, 1e10, 0.0, 0.0))
    assert of.toml == 'spectrum = { m0 = "1 nm^2", m2 = 0.0001, m4 = "0.01 /um^2" }'


def test_what_boundary_elements_need_is_found_without_runs(tmp_path, capsys):
    """White noise in 8 nm pixels under long waves: the bandwidth is beyond any comparison, which is printed with the spectrum."""
    noise = np.random.Generator(np.random.PCG64(2)).standard_normal((2, 128, 128))
    for name, pixel, heights in (("small.npy", 8.0, noise[0]), ("large.npy", 64.0, noise[1])):
        waves = np.cumsum(np.cumsum(heights, axis=0), axis=1)
        np.save(tmp_path / name, heights + pixel * (waves - waves.mean()) / waves.std())
    scans = [str(tmp_path / name) for name in ("small.npy", "large.npy")]
    options = ["--height-unit", "nm", "--quiet", "-o", str(tmp_path / "answer.h5")]
    assert main([*scans, *options, "--pixel", "8 nm; 64 nm; 1 nm"]) == 2
    assert "one for each of the 2 scans is needed" in capsys.readouterr().err
    assert main([*scans, *options, "--pixel", "8 nm; 64 nm"]) == 0
    said = capsys.readouterr().out
    assert "assessment        no: " in said and "! bandwidth      alpha = " in said and "pull-off" not in said
    assert "reliable waves    256 nm" in said and "boundary elements solve the map itself" in said
    with stiction.open_run(tmp_path / "answer.h5") as found:
        assert found.tree.sizes["way"] == 0 and found.attrs["assessment"] == "no"
        assert len(found.plot().axes) == 3
