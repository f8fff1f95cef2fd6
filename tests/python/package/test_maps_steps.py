"""Each step from a map to its asperities against closed forms, definitions summed one by one, and flooding
level by level."""

import itertools
import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from conftest import ROOT
from scipy import ndimage, stats

from stiction import SceneError
from stiction.maps.ellipsoids import forces_of_spheres, hertz_radius
from stiction.maps.level import Grid, flaws, levelled, offset_lines, rows_levelled
from stiction.maps.prominence import prominences
from stiction.maps.reading import HeightMap
from stiction.maps.smooth import cutoff_series, smoothed
from stiction.maps.spectrum import Moments, equivalent, moments
from stiction.maps.summits import apart, summits
from stiction.maps.surface import Steps, found_on


def grid(heights, pixel=(1e-9, 1e-9), resolution=None):
    heights = np.asarray(heights, dtype=float)
    largest = np.nanmax(np.abs(heights), initial=0.0)
    return Grid(heights, pixel, 64.0 * np.finfo(float).eps * largest if resolution is None else resolution)


def places(shape, pixel):
    """x and y of the pixels, m."""
    y, x = np.mgrid[0 : shape[0], 0 : shape[1]].astype(float)
    return x * pixel[0], y * pixel[1]


# Levelling.


def tilted(bow=0.0):
    """A wave on an offset that is a million times larger, a tilt and a bow, m."""
    y, x = np.mgrid[0:40, 0:50].astype(float)
    return 1e-3 + 2e-9 * x - 3e-9 * y + bow * (x - 7.0) * (y + 3.0) + 1e-9 * np.sin(2.1 * x) * np.cos(1.7 * y)


@pytest.mark.parametrize(("level", "bow", "terms"), [("plane", 0.0, 3), ("quadratic", 1e-10, 6)])
def test_what_is_left_is_orthogonal_to_what_was_subtracted(level, bow, terms):
    z = tilted(bow)
    z[15, 27] = np.nan
    left = levelled(grid(z, (1e-9, 2e-9)), level).heights
    assert np.nanmax(np.abs(left)) < 1.3e-9 and np.isnan(left[15, 27])
    v, u = np.meshgrid(np.linspace(-1.0, 1.0, 40), np.linspace(-1.0, 1.0, 50), indexing="ij")
    for term in [u**0, u, v, u * u, u * v, v * v][:terms]:
        assert abs(np.nansum(term * left)) < 2000 * 1e-22


def test_a_plane_leaves_the_bow_and_none_the_plane():
    assert np.abs(levelled(grid(tilted(1e-10)), "plane").heights).max() > 2e-8
    z = tilted()
    np.testing.assert_allclose(levelled(grid(z), "none").heights, z - z.mean(), rtol=0.0, atol=1e-17)


def test_what_determines_no_plane_is_refused():
    line = np.full((40, 50), np.nan)
    line[:, 4] = tilted()[:, 4]
    with pytest.raises(
        SceneError, match="40 of 2000 heights are known, and they do not determine the plane of least squares"
    ):
        levelled(grid(line), "plane")
    with pytest.raises(SceneError, match="0 of 64 heights are known"):
        levelled(grid(np.full((8, 8), np.nan)), "none")
    x, y = places((10, 10), (1.0, 1.0))
    with pytest.raises(SceneError, match="the levelled map is flat"):
        levelled(grid(1e-3 + 1e-7 * x - 3e-8 * y), "plane")


def smooth_surface(seed=0, shape=(128, 96), sigma=4.0):
    """Smooth roughness, periodic, of standard deviation 1."""
    frequency = [np.fft.fftfreq(count) for count in shape]
    damping = np.exp(-2.0 * (math.pi * sigma) ** 2 * (frequency[0][:, None] ** 2 + frequency[1] ** 2))
    z = np.fft.ifft2(np.fft.fft2(np.random.default_rng(seed).normal(size=shape)) * damping).real
    return z / z.std()


@pytest.mark.parametrize("how", ["median", "differences"])
def test_offsets_of_rows_are_taken_away(how):
    """What was added to whole rows changes nothing, and of rows without a height nothing is left out or
    made."""
    z, rng = smooth_surface(), np.random.default_rng(1)
    z[3, 40:50], z[60] = np.nan, np.nan
    added = z + rng.normal(size=(128, 1))
    one, other = rows_levelled(z, how), rows_levelled(added, how)
    if how == "median":
        np.testing.assert_allclose(one, other, atol=1e-12)
        np.testing.assert_allclose(np.nanmedian(np.delete(one, 60, axis=0), axis=1), 0.0, atol=1e-12)
    else:
        # No step is known across a row without heights: what is beyond may be higher or lower as a whole.
        for part in (slice(0, 60), slice(61, None)):
            of = one[part] - other[part]
            np.testing.assert_allclose(of, np.broadcast_to(np.nanmedian(of), of.shape) + 0.0 * of, atol=1e-12)
        steps = np.diff(other, axis=0)
        np.testing.assert_allclose(np.nanmedian(np.delete(steps, [59, 60], axis=0), axis=1), 0.0, atol=1e-12)
    assert np.array_equal(np.isnan(one), np.isnan(z))


def test_differences_keep_what_is_high_along_a_row():
    """A round island moves the median of the rows of which it has more than half, and not the median of
    differences."""
    z = 1e-3 * smooth_surface(sigma=1.0)
    x, y = places(z.shape, (1.0, 1.0))
    z[(x - 48.0) ** 2 + (y - 64.0) ** 2 < 40.0**2] += 5.0
    kept, moved = (rows_levelled(z, how)[50:78, :8] for how in ("differences", "median"))
    assert np.abs(kept).max() < 0.1 < 4.0 < np.abs(moved).min()


@pytest.mark.parametrize("how", ["median", "differences"])
@pytest.mark.parametrize(("level", "bow"), [("plane", 0.0), ("quadratic", 1e-11)])
def test_offsets_of_rows_do_not_depend_on_the_slopes_of_a_map(how, level, bow):
    """A tilt of the sample, and a bow of the scanner: what is left has the heights that the level map has."""
    z, rng = 2e-9 * smooth_surface(), np.random.default_rng(1)
    y, x = np.mgrid[0:128, 0:96].astype(float)
    offsets = 1e-9 * rng.normal(size=(128, 1))

    def left(heights):
        of = HeightMap(heights, (1e-8, 1e-8), "map", "array")
        return found_on(of, Steps(level=level, level_rows=how)).grid.heights

    flat = left(z)
    assert np.std(flat) < np.std(z)
    for other in (z + offsets, z + 2e-9 * x - 1e-9 * y + bow * (x - 20.0) ** 2, z + offsets - 5e-10 * x + bow * x * x):
        np.testing.assert_allclose(left(other), flat, atol=1e-20)


def test_levelling_of_rows_that_raises_heights_is_warned_of():
    """The medians of noise add up from row to row of a narrow map; offsets that are there go without a word."""
    noise, rng = 1e-9 * np.random.default_rng(7).normal(size=(200, 16)), np.random.default_rng(1)
    for heights, how, warned in ((noise, "differences", 1), (noise, "median", 0), (1e-9 * smooth_surface(), "median", 0),
                                 (noise + 1e-7 * rng.normal(size=(200, 1)), "differences", 0)):  # fmt: skip
        surface = found_on(HeightMap(heights, (1e-8, 1e-8), "map", "array"), Steps(level_rows=how))
        said = [line for line in surface.warnings if line.startswith("levelling of rows raises the standard deviation")]
        assert len(said) == warned
        before = found_on(HeightMap(heights, (1e-8, 1e-8), "map", "array"), Steps()).moments.m0
        assert (surface.moments.m0 > before) == bool(warned)
        for line in said:
            assert f"from {1e12 * math.sqrt(before):.1f} pm to {1e9 * math.sqrt(surface.moments.m0):.3f} nm" in line


def test_offset_and_frozen_lines_are_said():
    z = smooth_surface()
    assert flaws(z) == [] and offset_lines(z) == []
    jump = z.copy()
    jump[50:] += 1.0
    for name, of in (("row", jump), ("column", jump.T)):
        said = offset_lines(of)
        assert len(said) == 1 and said[0].startswith(f"1 {name} is offset against the one before"), said
    every = z + np.random.default_rng(2).normal(scale=0.5, size=(128, 1))
    for name, of in (("rows", every), ("columns", every.T)):
        assert [said.startswith(f"{name} are offset against each other") for said in offset_lines(of)] == [True]
        assert offset_lines(rows_levelled(every, "differences")) == []
    frozen = z.copy()
    frozen[31:34] = frozen[30]
    for name, of in (("rows", frozen), ("columns", frozen.T)):
        said = flaws(of)
        assert any(line.startswith(f"3 {name} repeat the one before") for line in said), said


def test_equal_neighbours_are_counted_along_both_directions():
    """Every other row repeats: half of the pairs along y are equal, none along x; the other way round
    likewise."""
    z = smooth_surface(shape=(64, 64))
    z += 1e-3 * np.random.default_rng(3).random(z.shape)
    twice = np.repeat(z[::2], 2, axis=0)
    for of in (twice, twice.T):
        assert any(line.startswith("50.8 % of neighbouring pixels are equally high") for line in flaws(of))
    holed = z.copy()
    holed[:2] = np.nan
    assert flaws(holed) == ["3.1 % of the heights are missing"]


# The filter.


@pytest.mark.parametrize(
    ("length", "direction"), [(20, 0.0), (20, 0.5 * math.pi), (20, 0.6), (40, 0.3), (15, 2.0), (10, 1.1)]
)
def test_waves_keep_their_part(length, direction):
    """exp(−πα²λ²/ℓ²) = 2^−(λ/ℓ)² in the interior, with pixels that are not square: half at the cut-off."""
    x, y = places((80, 101), (1.0, 1.5))
    wave = np.sin(2.0 * math.pi / length * (math.cos(direction) * x + math.sin(direction) * y) + 0.4)
    smooth = smoothed(grid(wave, (1.0, 1.5)), 20.0).heights
    np.testing.assert_allclose(smooth[30:50, 30:70], 2.0 ** -((20 / length) ** 2) * wave[30:50, 30:70], atol=2e-10)


def test_constants_and_planes_are_kept():
    """A constant everywhere, with holes too; a plane where the weights are symmetric."""
    flat = np.full((60, 50), 3e-9)
    flat[0, :7], flat[24, 34] = np.nan, np.nan
    smooth = smoothed(grid(flat, (2e-9, 1e-9)), 16e-9)
    np.testing.assert_allclose(smooth.heights, flat, rtol=1e-14)
    assert smooth.border == (8, 4)
    x, y = places((60, 50), (2e-9, 1e-9))
    plane = 0.1 * x - 0.3 * y + 1e-9
    off = np.abs(smoothed(grid(plane, (2e-9, 1e-9)), 16e-9).heights - plane)
    assert off[20:40, 10:40].max() < 1e-22
    # Half a cut-off from the border a tilt is off by little of what it rises over a cut-off.
    assert off[8, 25] < 2.2e-3 * 0.3 * 16e-9 and off[0, 25] > 0.1 * 0.3 * 16e-9


def test_the_filter_is_its_formula():
    """Every pixel against the formula, summed one by one, with missing heights, at the border too."""
    x, y = places((23, 40), (1.3, 1.0))
    rough = np.sin(1.7 * x) + np.cos(2.9 * y + x)
    rough.ravel()[3::17] = np.nan
    found = smoothed(grid(rough, (1.3, 1.0)), 7.7).heights
    known = ~np.isnan(rough)
    distance = (x[known][:, None, None] - x) ** 2 + (y[known][:, None, None] - y) ** 2
    weight = np.exp(-math.pi * distance / (math.log(2.0) / math.pi * 7.7**2))
    expected = np.einsum("k,kij->ij", rough[known], weight) / weight.sum(axis=0)
    np.testing.assert_allclose(found, np.where(known, expected, np.nan), atol=1e-10)


@pytest.mark.parametrize("cutoff, missing", [(70.0, True), (85.0, False), (119.0, True), (170.0, False), (170.0, True)])
def test_long_cut_offs_are_those_of_scipy(cutoff, missing):
    """Kernels on either side of the length from which on they are transformed; more rows than are taken at one time."""
    rough = np.random.default_rng(8).normal(size=(700, 340))
    if missing:
        rough[5:90, 200:260] = np.nan
    known = ~np.isnan(rough)
    sigma, reach = cutoff * math.sqrt(0.5 * math.log(2.0)) / math.pi, math.ceil(1.25 * cutoff)
    above, below = (
        ndimage.gaussian_filter(of, sigma, mode="constant", radius=reach)
        for of in (np.where(known, rough, 0.0), known.astype(float))
    )
    found = smoothed(grid(rough), cutoff * 1e-9).heights
    assert found.flags.c_contiguous
    np.testing.assert_allclose(found, np.where(known, above / below, np.nan), rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("pixels", "passed", "within"), [(2, 0.8923, 1e-3), (3, 0.5625, 4e-3), (5, 0.5, 2e-5), (8, 0.5, 1e-9)]
)
def test_few_pixels_pass_more(pixels, passed, within):
    """A cut-off of few pixels passes more than half of its own wave, as the sum over its weights has it."""
    x, _ = places((90, 90), (1.0, 1.0))
    wave = np.cos(2.0 * math.pi * x / pixels)
    found = smoothed(grid(wave), float(pixels) * 1e-9).heights[45, 40]
    assert found / wave[45, 40] == pytest.approx(passed, abs=within)


@pytest.mark.parametrize("cutoff", [3.99e-9, 20.1e-9, math.nan, 0.0, -1e-8, math.inf])
def test_cutoffs_that_no_map_has_are_refused(cutoff):
    rough = grid(smooth_surface(shape=(40, 60)), (2e-9, 1e-9))
    with pytest.raises(SceneError, match=r"smooth = .*(give 4\.000 nm or more|give 20\.00 nm or less)"):
        smoothed(rough, cutoff)
    assert smoothed(rough, 4e-9).border == (2, 1) and smoothed(rough, 20e-9).border == (10, 5)


def test_cutoffs_rise_by_a_factor():
    series = cutoff_series(grid(np.zeros((40, 40)), (1e-9, 2e-9)), 5)
    assert (len(series), series[0], series[-1]) == (5, 4e-9, 10e-9)
    np.testing.assert_allclose(np.diff(np.log(series)), math.log(2.5) / 4.0, rtol=1e-12)
    with pytest.raises(SceneError, match="cutoffs = 5: there is no room"):
        cutoff_series(grid(np.zeros((8, 40)), (1e-9, 2e-9)), 5)


# Summits.


def raised(*pixels, shape=(9, 10)):
    """A flat map with raised pixels."""
    heights = np.zeros(shape)
    for row, column, height in pixels:
        heights[row, column] = height
    return grid(heights, (1e-9, 2e-9))


def pixels_of(found):
    return list(zip(found.row.tolist(), found.column.tolist(), strict=True))


def test_a_summit_is_higher_than_all_eight():
    found, area = summits(raised((3, 4, 1e-9), (6, 7, 2e-9)))
    assert area == pytest.approx(56 * 2e-18, rel=1e-14) and pixels_of(found) == [(3, 4), (6, 7)]
    assert found.curvature_y[0] == pytest.approx(5e8, rel=1e-15) and found.curvature_x[0] == pytest.approx(
        2e9, rel=1e-15
    )
    assert found.radius[0] == pytest.approx(1.0 / 1.25e9, rel=1e-15)
    # Each of the neighbours can take it away, by being higher.
    for i in range(2, 5):
        for j in range(3, 6):
            if (i, j) != (3, 4):
                assert pixels_of(summits(raised((3, 4, 1e-9), (i, j, 1.1e-9)))[0]) == [(i, j)]
    # What is higher by rounding only is not higher.
    for below in (1e-15, 1e-13):
        found, _ = summits(raised((3, 4, 1.0), (3, 5, 1.0 - below)))
        assert pixels_of(found) == [(3, 4)]
        # On the right one falls by 1 over two pixels, 2 (1/1 + 1/2)/(1 + 2), the other by nothing over one.
        assert found.curvature_x[0] == pytest.approx(1e18, rel=1e-12)
        assert found.peak[0] == 3 * 10 + 4


def plateaus_one_by_one(z, pixel):
    """Summits by their definition: every pixel spreads over its equals, and all others around are lower.
    The pixel of each and its curvatures along y and x and across, by the parabola through three points and
    the saddle through four."""
    dx, dy = pixel
    known = np.pad(np.ones([count - 2 for count in z.shape], dtype=bool), 1) & ~np.isnan(z)
    seen, found = set(), []
    for place in np.ndindex(*z.shape):
        if place in seen or np.isnan(z[place]):
            continue
        plateau, ahead = set(), [place]
        while ahead:
            one = ahead.pop()
            if one not in plateau:
                plateau.add(one)
                ahead += [other for other in around(one, z.shape) if z[other] == z[place]]
        seen |= plateau
        outer = {other for one in plateau for other in around(one, z.shape)} - plateau
        if not all(known[one] for one in plateau) or not all(z[one] < z[place] for one in outer):
            continue
        middle = [Fraction(sum(one[axis] for one in plateau), len(plateau)) for axis in (0, 1)]
        i, j = min(sorted(plateau), key=lambda one: ((one[0] - middle[0]) * dy) ** 2 + ((one[1] - middle[1]) * dx) ** 2)
        up, down = (next(n for n in range(1, 99) if (i + way * n, j) not in plateau) for way in (-1, 1))
        left, right = (next(n for n in range(1, 99) if (i, j + way * n) not in plateau) for way in (-1, 1))
        y, x = np.array([-up, 0, down]) * dy, np.array([-left, 0, right]) * dx
        bends = [
            -2.0 * np.linalg.solve(np.vander(at), [z[before], z[i, j], z[after]])[0]
            for at, before, after in ((y, (i - up, j), (i + down, j)), (x, (i, j - left), (i, j + right)))
        ]
        ends = np.array([(v, u) for v in (y[0], y[2]) for u in (x[0], x[2])])
        corners = [z[i + n, j + m] for n in (-up, down) for m in (-left, right)]
        terms = np.column_stack([np.ones(4), ends, ends[:, 0] * ends[:, 1]])
        found.append((i, j, *bends, -np.linalg.solve(terms, corners)[3]))
    return np.array(found).reshape(-1, 5)


@pytest.mark.parametrize("levels", [3, 6, 12])
def test_a_plateau_is_one_summit(levels):
    """Small maps of few levels, with missing heights: every summit by its definition."""
    rng, pixel, seen = np.random.default_rng(levels), (1.0, 2.0), 0
    for trial in range(150):
        z = ndimage.gaussian_filter(rng.normal(size=(13, 15)), 0.5 * (trial % 3))
        z = np.round((z - z.min()) / np.ptp(z) * (levels - 0.5))
        z[rng.random(z.shape) < 0.01] = np.nan
        found, _ = summits(grid(z, pixel))
        expected = plateaus_one_by_one(z, pixel)
        order = np.lexsort((expected[:, 1], expected[:, 0]))
        expected = expected[order]
        assert pixels_of(found) == [(int(i), int(j)) for i, j in expected[:, :2]]
        np.testing.assert_allclose(found.curvature_y, expected[:, 2], rtol=1e-12)
        np.testing.assert_allclose(found.curvature_x, expected[:, 3], rtol=1e-12)
        across = np.nan_to_num(expected[:, 4])
        np.testing.assert_allclose(found.curvature_xy, across, atol=1e-12)
        seen += len(found)
    assert seen > 200


@pytest.mark.parametrize(("blunt", "angle"), [(1.0, 0.0), (1.7, 0.3), (3.0, 1.0), (20.0, 2.4), (3.0, 1.58), (5.0, 3.0)])
def test_ellipsoids_have_their_curvatures_at_any_angle(blunt, angle):
    """z = −(x'²/R₁ + y'²/R₂)/2 about a pixel: second differences of a parabola are exact."""
    x, y = places((9, 11), (1e-9, 1.5e-9))
    x, y = x - x[4, 5], y - y[4, 5]
    sin, cos = math.sin(angle), math.cos(angle)
    k1, k2 = 1.0 / 50e-9, 1.0 / (blunt * 50e-9)
    found, _ = summits(grid(-0.5 * (k1 * (cos * x + sin * y) ** 2 + k2 * (cos * y - sin * x) ** 2), (1e-9, 1.5e-9)))
    assert pixels_of(found) == [(4, 5)]
    principal = found.principal_curvatures
    assert [float(one[0]) for one in principal] == pytest.approx([k1, k2], rel=1e-12)
    assert found.radius[0] == pytest.approx(2.0 / (k1 + k2), rel=1e-12)
    assert found.equivalent_radius[0] == pytest.approx(1.0 / math.sqrt(k1 * k2), rel=1e-12)
    assert found.curvature_xy[0] == pytest.approx((k1 - k2) * sin * cos, abs=1e-13 * k1)


def test_a_saddle_may_be_higher_than_all_eight():
    """Two of the corners are nearly as high."""
    sides = [(4, 3, 0.9e-9), (4, 5, 0.9e-9), (3, 4, 0.9e-9), (5, 4, 0.9e-9), (3, 5, -3e-9), (5, 3, -3e-9)]
    found, _ = summits(raised((4, 4, 1e-9), (3, 3, 0.99e-9), (5, 5, 0.99e-9), *sides))
    sharp, blunt = found.principal_curvatures
    assert sharp[0] > 0.0 > blunt[0] and found.equivalent_radius[0] == found.radius[0]


def test_the_border_and_what_is_next_to_a_missing_height_are_not_compared():
    assert len(summits(raised((0, 4, 1e-9), (8, 2, 1e-9), (5, 0, 1e-9), (5, 9, 1e-9)))[0]) == 0
    found, area = summits(raised((3, 4, 1e-9), (2, 5, np.nan), (6, 7, 1e-9)))
    assert len(found) == 1 and area == pytest.approx((56 - 9) * 2e-18, rel=1e-14)
    found, area = summits(replace(raised((3, 4, 1e-9), (6, 7, 1e-9)), border=(3, 2)))
    assert pixels_of(found) == [(3, 4)] and area == pytest.approx(3 * 6 * 2e-18, rel=1e-14)


def test_summits_that_are_apart():
    """From the highest down each takes away the lower ones around it; one that is gone takes away none."""
    of = raised((2, 2, 3.0), (2, 4, 2.0), (2, 6, 1.0), (6, 6, 1.0))
    found, _ = summits(of)
    assert len(found) == 4
    # 2 nm from one to the next in the row; 8 nm down.
    for distance, expected in [(2e-9, 4), (2.1e-9, 3), (4e-9, 3), (4.1e-9, 2), (8.1e-9, 2), (1.0, 1)]:
        assert len(apart(of, found, distance)) == expected, distance
    assert pixels_of(apart(of, found, 2.1e-9)) == [(2, 2), (2, 6), (6, 6)]
    assert apart(of, found, None) is found
    # Of two that are equally high the first stays.
    two = raised((2, 2, 1.0), (2, 5, 1.0))
    assert pixels_of(apart(two, summits(two)[0], 5e-9)) == [(2, 2)]


# Prominence.


def around(place, shape):
    row, column = place
    for i in range(max(row - 1, 0), min(row + 2, shape[0])):
        for j in range(max(column - 1, 0), min(column + 2, shape[1])):
            if (i, j) != place:
                yield i, j


def flooded(z, peak):
    """The prominence of a pixel by its definition: the ground is flooded to each level in turn, and the least
    loss of height at which higher ground is reached counts; the whole of what is connected, if none is."""
    levels = sorted({float(level) for level in z[z <= z[peak]].ravel()}, reverse=True)
    lowest = z[peak]
    for level in levels:
        reached, ahead = set(), [peak]
        while ahead:
            place = ahead.pop()
            if place not in reached:
                reached.add(place)
                ahead += [other for other in around(place, z.shape) if z[other] >= level]
        if any((z[place], *(-one for one in place)) > (z[peak], *(-one for one in peak)) for place in reached):
            return z[peak] - level
        lowest = min(lowest, *(z[place] for place in reached))
    return z[peak] - lowest


@pytest.mark.parametrize("levels", [4, 12, 1 << 19])
def test_prominence_is_by_its_definition(levels):
    """Small maps of few levels and of many, with missing heights: every summit."""
    rng, seen = np.random.default_rng(levels), 0
    for _ in range(60):
        z = rng.integers(0, levels, (9, 11)).astype(float)
        z[rng.random(z.shape) < 1 / 23] = np.nan
        found, _ = summits(grid(z))
        # Of a plateau the first pixel is the highest one.
        peaks = np.unravel_index(found.peak, z.shape)
        own = prominences(z, *peaks)
        assert own.tolist() == [flooded(z, place) for place in zip(*peaks, strict=True)]
        assert (own > 0.0).all()
        seen += own.size
    assert seen > 50


def test_rows_that_are_sorted_apart_have_the_prominences_of_the_whole():
    """A map that is higher than the part of it whose passes are sorted at one time, turned by a quarter."""
    z = smooth_surface(5, shape=(700, 40), sigma=1.0)
    z[200:320, 20] = np.nan
    found, _ = summits(grid(z))
    upright = prominences(z, found.row, found.column)
    turned = prominences(np.ascontiguousarray(z.T), found.column, found.row)
    assert found.row.size > 800
    np.testing.assert_array_equal(upright, turned)


def test_equal_heights_and_the_border():
    """Of two hills of one height the first, row by row, is the higher one; a third on the border is higher
    for both."""
    z = np.zeros((10, 10))
    z[2, 3:8] = [5.0, 4.0, 1.0, 2.0, 5.0]

    def own():
        found, _ = summits(grid(z))
        return prominences(z, found.row, found.column).tolist()

    assert own() == [5.0, 4.0]
    z[0, 3], z[1, 3] = 6.0, 3.0
    assert own() == [2.0, 4.0]
    # Missing heights are no way.
    z[1] = np.nan
    z[2, 3], z[3, 3:6] = 0.0, [5.0, 4.0, 1.0]
    assert own() == [4.0]


# Ellipsoids.


@pytest.mark.parametrize("k", [0.02, 0.1, 0.3, 0.55, 0.8, 0.95, 0.999])
def test_the_force_is_by_johnsons_equations(k):
    """As they are printed (4.28, 4.24, 4.26), from half-widths to curvatures and force, with integrals by the
    trapezium rule over a period, which converges geometrically: A = κ₂/2, B = κ₁/2, pressure p₀ at the
    middle, P = 2πabp₀/3."""
    a, modulus, interference = 3e-9, 4e10, 2e-10
    b, e2 = k * a, 1.0 - k * k
    root = np.sqrt(1.0 - e2 * np.sin(math.pi * (np.arange(4000) + 0.5) / 4000) ** 2)
    first, second = 0.5 * math.pi * np.mean(1.0 / root), 0.5 * math.pi * np.mean(root)
    pressure = interference * modulus / (b * first)
    scale = pressure / modulus * b / (e2 * a * a)
    blunt, sharp = 2.0 * scale * (first - second), 2.0 * scale * (a * a / (b * b) * second - first)
    force = 2.0 / 3.0 * math.pi * a * b * pressure
    of_sphere = 4.0 / 3.0 * modulus * math.sqrt(hertz_radius(sharp, blunt)) * interference**1.5
    # The equations lose digits where k is close to 1.
    assert of_sphere == pytest.approx(force, rel=1e-12 + 1e-15 / (e2 * e2))


def test_spheres_and_what_is_close_to_them():
    """Of curvatures 1 ± ε the radius is 1 + 2ε²/3, by the series of K and E."""
    assert hertz_radius(5.0, 5.0) * 5.0 == pytest.approx(1.0, rel=1e-14)
    for difference in (1e-3, 3e-3):
        assert (hertz_radius(1.0 + difference, 1.0 - difference) - 1.0) / difference**2 == pytest.approx(
            2.0 / 3.0, abs=1e-4
        )
    assert math.isfinite(hertz_radius(1e100, 1.0))


def test_errors_of_spheres_are_those_of_the_page():
    """The table of errors of force, per cent, and that the geometric mean is the nearer one; of curvatures 1
    ± ε the errors are ε²/3 and ε²/12."""
    page = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    for ratio in (1.5, 2, 3, 5, 10, 30):
        mean, geometric = (100.0 * (1.0 - share) for share in forces_of_spheres(ratio))
        assert f"| {ratio} | −{mean:.1f} % | −{geometric:.1f} % |" in page
        assert mean > geometric > 0.0
    for epsilon in (0.01, 0.02):
        mean, geometric = (1.0 - share for share in forces_of_spheres((1.0 + epsilon) / (1.0 - epsilon)))
        assert mean / epsilon**2 == pytest.approx(
            1 / 3, abs=1e-3
        ) and geometric / epsilon**2 == pytest.approx(1 / 12, abs=1e-3)


# The spectrum.


def test_differences_of_a_wave_are_those_of_its_frequency():
    """z = a cos(kx) cos(qy) over whole periods: the differences are multiples of the derivatives, 2 sin(k
    dx/2)/dx for k, and the mean squares of cosines over rows and columns are 1/2. Two lines more are within
    1.1 %."""
    dx, dy, a = 1e-9, 2e-9, 3e-9
    k, q = 2.0 * math.pi / (20.0 * dx), 2.0 * math.pi / (25.0 * dy)
    x, y = places((502, 402), (dx, dy))
    of = moments(grid(a * np.cos(k * x) * np.cos(q * y), (dx, dy)))
    kd, qd = 2.0 * math.sin(0.5 * k * dx) / dx, 2.0 * math.sin(0.5 * q * dy) / dy
    square = a * a / 4.0
    expected = [square, square * kd**2, square * qd**2, 0.5 * square * (kd**4 + qd**4), 9.0 / 4.0 - 3.0]
    assert [of.m0, of.slope_x, of.slope_y, of.m4, of.excess_kurtosis] == pytest.approx(expected, rel=0.011)
    assert abs(of.skewness) < 0.02


def test_missing_heights_take_away_the_differences_that_need_them():
    z = 1e-9 * ((np.arange(100) ** 2) % 13).astype(float).reshape(10, 10)
    z[3, 4] = np.nan
    of = moments(grid(z))
    for axis, slope in ((0, of.slope_y), (1, of.slope_x)):
        rises = np.diff(z, axis=axis)
        assert (
            np.count_nonzero(~np.isnan(rises)) == 88
            and np.count_nonzero(~np.isnan(np.diff(z, 2, axis=axis))) == 77
        )
        assert slope == pytest.approx(np.nanmean(rises**2) / 1e-18, rel=1e-13)
    z.ravel()[1::2] = np.nan
    with pytest.raises(SceneError, match="leave no neighbouring pixels"):
        moments(grid(z))


def test_the_relations_agree_with_each_other():
    """Table 2 of the hybrid model's paper lists σ, R and η of three surfaces; the relations give them back
    from moments that follow from R and η: m₄ = (3√π/(8R))², m₂ = m₄/(6π√3 η)."""
    radius, density, sigma = 3.33e-6, 7.39e12, 1.619e-9
    m4 = (3.0 * math.sqrt(math.pi) / (8.0 * radius)) ** 2
    m2 = m4 / (6.0 * math.pi * math.sqrt(3.0) * density)
    of = equivalent(Moments(sigma**2, m2, m2, m4, 0.0, 0.0))
    assert [of.density, of.radius] == pytest.approx([density, radius], rel=1e-14)
    # σ_s² = σ² − 3.717·10⁻⁴/(ηR)² and y_s = 0.045944/(ηR) have four digits.
    assert of.height_std == pytest.approx(math.sqrt(sigma**2 - 3.717e-4 / (density * radius) ** 2), rel=1e-4)
    assert of.height_mean == pytest.approx(0.045944 / (density * radius), rel=1e-4)


# Surfaces as a whole.


def found_in(heights, pixel, **steps):
    return found_on(HeightMap(heights, pixel, "map", "array"), Steps(**{"level": "none"} | steps))


def test_spheres_on_a_plane_are_found_one_by_one():
    """Spheres of radius R anywhere between the pixels. The pixel next to a top is at most (dx, dy)/2 off it:
    its height is less by at most (a² + b²)/2R, and its mean curvature off by (a² + b²)/R² + dx²/4R² to
    leading order."""
    radius, pixel, spacing, protrusion = 40e-9, 1e-9, 40, 10e-9
    rng = np.random.default_rng(5)
    rows, columns = np.mgrid[0:8, 0:9]
    tops = np.column_stack([rows.ravel(), columns.ravel()]) + 0.5
    tops = (tops * spacing + rng.uniform(-3.0, 3.0, tops.shape)) * pixel
    x, y = places((8 * spacing, 9 * spacing), (pixel, pixel))
    nearest = np.min([(y - v) ** 2 + (x - u) ** 2 for v, u in tops], axis=0)
    z = np.maximum(protrusion - radius + np.sqrt(np.maximum(radius**2 - nearest, 0.0)), 0.0)
    found = found_in(z, (pixel, pixel))
    assert len(found.summits) == 72
    at = np.column_stack([found.summits.row, found.summits.column]) * pixel
    off = np.abs(at[:, None] - tops[None]).max(axis=2)
    assert ((off <= 0.5001 * pixel).sum(axis=1) == 1).all()
    below = protrusion - (found.summits.height + z.mean())
    assert below.min() > -1e-6 * protrusion and below.max() <= 1.01 * pixel**2 / (4.0 * radius)
    deviation = radius * found.summits.mean_curvature - 1.0
    assert deviation.min() > 0.0 and deviation.max() <= 1.01 * 0.75 * (pixel / radius) ** 2
    area = (8 * spacing - 2) * (9 * spacing - 2) * pixel**2
    assert found.area == pytest.approx(area, rel=1e-14) and found.measured.density == pytest.approx(
        72 / area, rel=1e-14
    )


def test_an_egg_box_is_approached_with_second_order():
    """z = a (cos kx + cos ky), its summits at a fixed part of a pixel off the next one: one in a period
    squared; height 2a and radius 1/(ak²) are approached with the second order of the pixel."""
    a, period = 2e-9, 480e-9
    k = 2.0 * math.pi / period

    def errors(pixels):
        pixel, side = period / pixels, 5 * pixels + 2
        x, y = places((side, side), (pixel, pixel))
        z = a * (np.cos(k * (x + 0.3 * pixel - period / 2.0)) + np.cos(k * (y + 0.2 * pixel - period / 2.0)))
        found = found_in(z, (pixel, pixel))
        assert len(found.summits) == 25 and found.measured.density * period**2 == pytest.approx(1.0, rel=1e-12)
        return (
            np.array([(found.measured.height_mean + z.mean()) / (2.0 * a), found.measured.radius * a * k * k])
            - 1.0
        )

    of = [errors(pixels) for pixels in (12, 24, 48, 96)]
    for coarse, fine in itertools.pairwise(of):
        np.testing.assert_allclose(np.log2(coarse / fine), 2.0, atol=0.02)
    # cos(0.3 kdx) + cos(0.2 kdx) = 2 − (0.09 + 0.04)(kdx)²/2.
    assert of[-1][0] == pytest.approx(-0.0325 * (2.0 * math.pi / 96.0) ** 2, rel=1e-3)


@pytest.mark.parametrize(("fall", "mean"), [(40.0, 3.6), (4.0, 1.55), (0.4, 1.02), (0.04, 1.0)])
def test_paraboloids_in_steps_of_height(fall, mean):
    """z = h − r²/2R of R = 1 pixel, its top anywhere, in steps of q = `fall` times dx²/2R, at any height
    within a step. Rounding moves every height by at most q/2, so that a second difference over a and b
    pixels is off by at most 2q/(ab dx²), which falls to 0 with q. The mean curvatures are on the page."""
    rng, curvatures = np.random.default_rng(0), []
    x, y = places((61, 61), (1.0, 1.0))
    q = 0.5 * fall
    for _ in range(200):
        square = (x - 30.0 - rng.uniform(-0.5, 0.5)) ** 2 + (y - 30.0 - rng.uniform(-0.5, 0.5)) ** 2
        z = q * np.round((np.maximum(200.0 - 0.5 * square, 0.0) + q * rng.random()) / q)
        found, _ = summits(grid(z, (1.0, 1.0)))
        assert len(found) == 1
        i, j = int(found.row[0]), int(found.column[0])
        for bend, profile, at in ((found.curvature_x[0], z[i], j), (found.curvature_y[0], z[:, j], i)):
            top = np.flatnonzero(profile == profile.max())
            a, b = at - top[0] + 1, top[-1] - at + 1
            assert abs(bend - 1.0) <= 2.0 * q / (a * b) * (1.0 + 1e-12)
        curvatures.append(found.mean_curvature[0])
    scatter = np.std(curvatures) / math.sqrt(200)
    assert abs(np.mean(curvatures) - mean) < max(3.0 * scatter, 0.005)


@pytest.mark.parametrize("share", [0.1, 0.05, 0.02, 0.01, 0.001])
@pytest.mark.parametrize(("tilt", "level"), [(0.0, "none"), (1e-4, "plane")])
def test_an_egg_box_in_steps_keeps_its_summits(share, tilt, level):
    """One summit in a period squared, whatever the step of the heights, with a tilt of them, too; with a
    filter over the steps they have their radius again."""
    a, period, pixels = 2e-9, 480e-9, 48
    pixel, k = period / pixels, 2.0 * math.pi / period
    x, y = places((5 * pixels + 2, 5 * pixels + 2), (pixel, pixel))
    z = a * (np.cos(k * (x + 0.3 * pixel - period / 2)) + np.cos(k * (y + 0.2 * pixel - period / 2)))
    z += tilt * (x + 2.0 * y)
    step = share * 4.0 * a
    in_steps = step * np.round(z / step)
    found = found_in(in_steps, (pixel, pixel), level=level)
    assert len(found.summits) == 25
    exact = found_in(z, (pixel, pixel), level=level)
    at, of = (np.array(pixels_of(one.summits)) for one in (found, exact))
    off = np.abs(at[:, None] - of[None]).max(axis=2).min(axis=1)
    # A plateau is as wide as the crest within a step, and its middle as far off as a tilt moves it.
    wide = math.sqrt(2.0 * step / a) / (k * pixel)
    assert off.max() <= 1.0 + wide
    if share <= 0.02:
        smooth, clean = (found_in(of, (pixel, pixel), level=level, smooth=10 * pixel) for of in (in_steps, z))
        assert smooth.measured.radius / clean.measured.radius == pytest.approx(1.0, abs=0.06)


def test_a_tilt_does_not_part_a_plateau():
    """A plateau in steps of 1 that levelling tilts by 0.01 a pixel is one summit, with the curvatures of the
    map before; a tilt above the step leaves no pixels that are equally high."""
    x, y = places((30, 30), (1.0, 1.0))
    hill = np.round(np.maximum(6.0 - 0.1 * ((x - 14.0) ** 2 + (y - 14.0) ** 2), 0.0))
    flat, _ = summits(grid(hill, (1.0, 1.0)))
    slight, steep = (levelled(grid(hill + of, (1.0, 1.0)), "plane") for of in (0.0, 1.3 * x + 0.7 * y))
    assert slight.measured is not None and steep.measured is None
    # An uneven hill has a tilt of its own.
    uneven = hill + np.where(x > 25.0, 1.0, 0.0)
    level = levelled(grid(uneven, (1.0, 1.0)), "plane")
    assert len(set(level.heights[hill == 6.0])) > 1
    found, _ = summits(level)
    here = (found.row == flat.row[0]) & (found.column == flat.column[0])
    assert here.sum() == 1 and len(flat) == 1
    np.testing.assert_allclose(found.curvature_x[here], flat.curvature_x, rtol=1e-12)
    np.testing.assert_allclose(found.curvature_y[here], flat.curvature_y, rtol=1e-12)
    own = prominences(level.heights, *np.unravel_index(found.peak, hill.shape))[here]
    assert own[0] == pytest.approx(6.0, abs=1.0)


def test_directions_are_not_mixed_up():
    """Turning a map by a quarter exchanges x and y and changes nothing else; coarser steps along y are no
    other heights."""
    x, y = places((120, 90), (1e-9, 2e-9))
    z = 1e-9 * (np.cos(0.3e9 * x) + 2.0 * np.cos(0.2e9 * y + 0.1) + 0.1 * np.sin(0.11e9 * (x + y)))
    upright = found_in(z, (1e-9, 2e-9), level="plane")
    turned = found_in(np.ascontiguousarray(z.T), (2e-9, 1e-9), level="plane")
    order = np.lexsort((turned.summits.row, turned.summits.column))
    one, other = upright.summits, turned.summits[order]
    assert one.row.tolist() == other.column.tolist() and one.column.tolist() == other.row.tolist()
    np.testing.assert_allclose(one.curvature_y, other.curvature_x, rtol=1e-9)
    np.testing.assert_allclose(one.curvature_x, other.curvature_y, rtol=1e-9)
    assert upright.moments.slope_y == pytest.approx(turned.moments.slope_x, rel=1e-12)
    # −∂²z/∂y² of the second wave at its crests is 2·(0.2)² = 0.08, against 0.09 along x.
    assert [one.curvature_y.mean(), one.curvature_x.mean()] == pytest.approx([0.08e9, 0.09e9], rel=0.05)


def gaussian_surface(side, q, rng, waves=500):
    """An isotropic Gaussian surface of unit variance as a sum of waves whose wave vectors are drawn from a
    disc of radius q, a stratified sample: profiles have m₂ = q²/4 and m₄ = q⁴/8, so α = 2."""
    place = np.arange(waves)
    radius = q * np.sqrt((place + rng.random(waves)) / waves)
    direction = math.pi * ((place * 263 % waves) + rng.random(waves)) / waves
    phase = 2.0 * math.pi * rng.random(waves)
    along = np.exp(1j * (np.outer(radius * np.cos(direction), np.arange(side)) + phase[:, None]))
    down = np.exp(1j * np.outer(radius * np.sin(direction), np.arange(side)))
    return math.sqrt(2.0 / waves) * (down.T @ along).real


def statistics(z, pixel):
    found = found_in(z, (pixel, pixel))
    of = found.measured
    return np.array([of.density, of.height_mean, of.height_std, 1.0 / of.radius, found.moments.m2, found.moments.m4])


@pytest.mark.parametrize(("maps", "most"), [(8, 0.016), pytest.param(40, 0.007, marks=pytest.mark.slow)])
def test_summits_of_gaussian_surfaces_are_those_of_nayaks_theory(maps, most):
    """Nayak (1971): η = m₄/(6π√3 m₂), mean height 4√(m₀/(πα)); Bush, Gibson and Thomas (1975): mean curvature
    8/3 √(m₄/π); the variance of heights is (1 − 0.896805756…/α) m₀, by quadrature of Nayak's density in 30
    digits. The means of two maps, of pixels of 1/28 and 1/14 of the wavelength 2π√(m₂/m₄), are extrapolated
    to pixels of no size, with the second order that differences have. Student's t of six means over
    independent maps; false alarms: 6 × 2·10⁻⁵."""
    q = 2.0 * math.pi / 28.0 * math.sqrt(2.0)
    m2, m4 = q * q / 4.0, q**4 / 8.0
    exact = np.array([
        m4 / m2 / (6.0 * math.pi * math.sqrt(3.0)), 4.0 / math.sqrt(2.0 * math.pi),
        math.sqrt(1.0 - 0.896805756 / 2.0), 8.0 / 3.0 * math.sqrt(m4 / math.pi), m2, m4,
    ])  # fmt: skip
    fine, coarse = [], []
    for seed in range(maps):
        z = gaussian_surface(600, q, np.random.default_rng(seed))
        fine.append(statistics(z, 1.0) / exact)
        coarse.append(statistics(np.ascontiguousarray(z[::2, ::2]), 2.0) / exact)
    of = (4.0 * np.array(fine) - np.array(coarse)) / 3.0
    errors = of.std(axis=0, ddof=1) / math.sqrt(maps)
    assert (errors < most).all(), errors
    assert (np.abs(of.mean(axis=0) - 1.0) < stats.t.isf(1e-5, maps - 1) * errors).all(), of.mean(axis=0)
    # What docs/my-afm-map.md says of pixels of 1/14 of the wavelength.
    mean = np.mean(coarse, axis=0)
    assert maps < 40 or ((np.abs(mean[:3] - 1.0) < 0.03).all() and 0.94 < mean[3] < 1.0), mean


def test_noise_is_taken_away():
    """40 pixels from maximum to maximum of a profile, and noise of a tenth of the standard deviation from
    pixel to pixel: the noise makes most of the summits, and either the filter or prominence takes these away,
    so that the summits of the surface are left, within 15 %."""
    rng = np.random.default_rng(11)
    clean = gaussian_surface(400, 2.0 * math.pi / 40.0 * math.sqrt(2.0), rng)
    noisy = clean + 0.1 * rng.uniform(-1.0, 1.0, clean.shape)

    def density(z, **steps):
        return found_in(z, (1.0, 1.0), **steps).measured.density

    exact = density(clean)
    assert density(noisy) > 10.0 * exact
    assert density(noisy, smooth=14.0) == pytest.approx(exact, rel=0.15)
    assert density(noisy, prominence=0.15) == pytest.approx(exact, rel=0.15)


@pytest.mark.parametrize(("down", "across", "is_reported"), [(16, 16, False), (6, 6, True), (6, 16, True), (16, 6, True)])
def test_coarse_pixels_are_reported(down, across, is_reported):
    """Summits of 6 pixels from one to the next are too coarse, along whichever side; of 16 they are not."""
    period, pixel = 480e-9, (480e-9 / across, 480e-9 / down)
    x, y = places((5 * down + 2, 5 * across + 2), pixel)
    k = 2.0 * math.pi / period
    found = found_in(2e-9 * (np.cos(k * (x + 0.1 * period)) + np.cos(k * (y + 0.2 * period))), pixel)
    assert any("pixels are too coarse" in one for one in found.warnings) == is_reported, found.warnings


@pytest.mark.parametrize(("down", "across", "is_reported"), [(1, 1, False), (1, 1.05, False), (1, 3, True), (3, 1, True)])
def test_unequal_slopes_are_reported(down, across, is_reported):
    """Mean square slopes along two directions are as the squares of the wave numbers."""
    x, y = places((218, 218), (20e-9, 20e-9))
    k = 2.0 * math.pi / 480e-9
    found = found_in(2e-9 * (np.cos(k / across * x + 0.6) + np.cos(k / down * y + 1.3)), (20e-9, 20e-9))
    assert any("slopes along x and y differ" in one for one in found.warnings) == is_reported, found.warnings


def test_saddles_are_counted():
    z = np.random.default_rng(3).uniform(-1.0, 1.0, (200, 200))
    found = found_in(z, (10.0, 10.0))
    of = found.summits
    saddles = np.count_nonzero(of.curvature_x * of.curvature_y <= of.curvature_xy**2)
    assert found.shape.saddles == saddles > 0
