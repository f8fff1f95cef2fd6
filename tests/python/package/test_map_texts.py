"""Texts of height maps that spreadsheets and instruments have damaged: no number vanishes or is made up."""

import re

import numpy as np
import pytest
import xarray
from scipy import ndimage
from test_reading import GIVEN, HEADERS, PIXEL, ROUGH, Z, assert_read, points, rows, written

from stiction import SceneError
from stiction.maps.command import main
from stiction.maps.reading import read_map

HEADER = HEADERS["Gwyddion"]
# The lines of the map, with semicolons.
LINES = rows(separator=";").splitlines()


def refused(tmp_path, content, said, **options):
    with pytest.raises(SceneError, match=said) as caught:
        read_map(written(tmp_path, content), **(options or GIVEN))
    return str(caught.value)


# Rows behind #.


@pytest.mark.parametrize("separator", [";", "\t", ",", " "])
@pytest.mark.parametrize("mark", ["#####", "##", "#", "#1.5", "# 1.5", "#1.2.3", "%1.5", "//1.5", "#12.Mrz"])
@pytest.mark.parametrize("line", [1, 4, 8])
def test_a_row_behind_a_mark_of_comments_is_refused(tmp_path, separator, mark, line):
    if separator == " " and mark in ("#", "##", "#####"):
        mark += "1.5"
    lines = rows(separator=separator).splitlines()
    lines[line] = mark + separator + lines[line].split(separator, 1)[1]
    said = refused(tmp_path, HEADER + "\n".join(lines), rf"scan\.txt: line {line + 5}, column 1: `")
    assert "cells of a row" in said


@pytest.mark.parametrize("first", [1, 9])
def test_cells_that_were_too_narrow_are_refused_from_the_first_row_on(tmp_path, first):
    lines = [f"#####;{line.split(';', 1)[1]}" for line in LINES[:first]] + LINES[first:]
    refused(tmp_path, "\n".join(lines), r"line 1, column 1: `#####;")
    lines = [f"2;#####;{line.split(';', 2)[2]}" for line in LINES]
    refused(tmp_path, "\n".join(lines), r"line 1, column 2: `#####` is not a number")


def test_a_column_of_numbers_has_no_row_behind_a_mark(tmp_path):
    column = "1\n2\n4\n{}\n3\n"
    for mark in ("#####", "#7", "# 7"):
        refused(tmp_path, column.format(mark), rf"line 4, column 1: `{mark}`", **GIVEN, lines=True)
    banner = "#####\n# of heights\n#####\n" + column.format("# the second half") + "# the end"
    read = read_map(written(tmp_path, banner), **GIVEN, lines=True)
    np.testing.assert_allclose(read.heights, [[1e-9, 2e-9, 4e-9, 3e-9]])


def test_sentences_and_headers_stay_comments(tmp_path):
    before = "########\n# 1 2 3 4 5 6 7 8 9\n#a b c d e f g h i\n"
    between = ("# the second half of the scan\n## one two three four five six seven eight\n% half\n#\n//\n####\n")
    lines = rows(separator=" ").splitlines()
    assert_read(written(tmp_path, before + "\n".join([*lines[:4], between, *lines[4:], "# the end"])), **GIVEN)
    padded = HEADER.replace("\n", ";;;;;;;;\n")
    assert_read(written(tmp_path, padded + "\n".join(LINES)))


# Empty rows and columns.

EMPTY = {";": ";" * 8, "\t": "\t" * 8, ",": "," * 8}


@pytest.mark.parametrize("separator", EMPTY)
def test_empty_rows_are_borders_or_missing_heights(tmp_path, separator):
    lines, empty = rows(separator=separator).splitlines(), EMPTY[separator]
    assert_read(written(tmp_path, "\n".join([empty, empty, HEADER + empty, *lines, empty, "", empty])))
    read = read_map(written(tmp_path, "\n".join([*lines[:4], empty, *lines[5:]])), **GIVEN)
    assert np.isnan(read.heights[4]).all() and np.isnan(read.heights).sum() == 9
    np.testing.assert_allclose(np.delete(read.heights, 4, axis=0), 1e-9 * np.delete(Z, 4, axis=0))


@pytest.mark.parametrize("separator", EMPTY)
@pytest.mark.parametrize(("left", "right"), [(0, 1), (0, 3), (1, 0), (2, 2)])
def test_empty_columns_at_the_border_are_none(tmp_path, separator, left, right):
    lines = [separator * left + line + separator * right for line in rows(separator=separator).splitlines()]
    assert_read(written(tmp_path, HEADER + "\n".join(lines)))
    # An empty row is as long.
    lines.append(separator * (8 + left + right))
    assert_read(written(tmp_path, HEADER + "\n".join(lines)))


def test_heights_that_are_written_as_missing_are_pixels(tmp_path):
    z = Z.copy()
    z[0] = z[:, 8] = np.nan
    read = read_map(written(tmp_path, HEADER + rows(z, ";")))
    np.testing.assert_array_equal(np.isnan(read.heights), np.isnan(z))
    assert read.pixel == pytest.approx((PIXEL, PIXEL)) and read.warnings == []
    # Neither is an empty column between others a border.
    lines = [f"{line[: line.index(';')]};{line[line.index(';') :]}" for line in LINES]
    assert np.isnan(read_map(written(tmp_path, "\n".join(lines)), **GIVEN).heights[:, 1]).all()


def test_empty_rows_among_points_are_left_out(tmp_path):
    lines = [line.replace(" ", "\t") for line in points()]
    for empty in ("\t\t", ""):
        content = "\n".join(line + ("\n" + empty) * (k % 9 == 8) for k, line in enumerate(lines))
        assert_read(written(tmp_path, content), **GIVEN)


# Pixels of a header.


def test_pixels_that_are_not_square_are_warned_of(tmp_path, capsys):
    """An aborted scan of 8 of 9 rows, and rows that are wrapped."""
    aborted = HEADER + "\n".join(LINES[:8])
    read = read_map(written(tmp_path, aborted))
    assert read.pixel == pytest.approx((10e-9, 11.25e-9))
    (said,) = read.warnings
    parts = "10.00 nm x 11.25 nm", "not square", "lines 2 and 3", "8 rows", "aborted", "wrapped", "--pixel"
    assert [part for part in parts if part not in said] == []
    cells = rows().split()
    wrapped = HEADER + "\n".join(" ".join(cells[k : k + 3]) for k in range(0, 81, 3))
    (said,) = read_map(written(tmp_path, wrapped)).warnings
    assert "30.00 nm x 3.333 nm" in said and "27 rows" in said
    # Who gives the pixel has answered it.
    given = read_map(written(tmp_path, aborted), pixel="10 nm,11.25 nm")
    assert given.warnings == []
    (said,) = read_map(written(tmp_path, aborted), pixel="10 nm").warnings
    assert said.startswith("pixel is 10.00 nm x 10.00 nm, and the map says 10.00 nm x 11.25 nm")
    assert main([str(written(tmp_path, aborted)), "--level", "none"]) == 0
    assert "not square" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(("height", "warned"), [("90.8 nm", 0), ("89.2 nm", 0), ("91.5 nm", 1), ("88.5 nm", 1)])
def test_pixels_are_square_to_a_percent(tmp_path, height, warned):
    header = HEADER.replace("# Height: 90 nm", f"# Height: {height}")
    assert len(read_map(written(tmp_path, header + "\n".join(LINES))).warnings) == warned


# Decimal commas between commas.


def decimal_commas(z, digits, separator=",", form="f"):
    return "\n".join(separator.join(f"{height:.{digits}{form}}".replace(".", ",") for height in row) for row in z)


@pytest.mark.parametrize("z", [Z, Z + 10.0, ROUGH, 3.0 * ROUGH + 40.0])
@pytest.mark.parametrize("header", [HEADER, ""])
def test_decimal_commas_between_commas_are_refused(tmp_path, z, header):
    for content in (
        *(decimal_commas(z, digits, ", ") for digits in (1, 2, 4)),
        *(decimal_commas(z, digits) for digits in (1, 2, 4)),
        decimal_commas(1e-9 * z, 4, ",", "e"),
    ):
        said = refused(tmp_path, header + content, r"line \d+: its commas look like decimal ones")
        assert "semicolons" in said and "points" in said


INTEGERS = {
    "counts": lambda random: random.integers(0, 10, (40, 30)),
    "two digits": lambda random: random.integers(10, 100, (40, 30)),
    "four digits": lambda random: random.integers(1000, 10000, (40, 30)),
    "bytes": lambda random: random.integers(0, 256, (40, 30)),
    "16 bits": lambda random: random.integers(0, 65536, (40, 30)),
    "signs": lambda random: random.integers(-9, 10, (40, 30)),
    "a few signs": lambda random: random.integers(-1, 50, (40, 30)),
    "one negative column": lambda random: random.integers(0, 10, (40, 30)) - 20 * (np.arange(30) == 4),
    "a negative edge": lambda random: random.integers(0, 10, (40, 30)) - 20 * (np.arange(30) < 1),
    "a mask": lambda random: random.integers(0, 2, (40, 30)),
    "small": lambda random: random.integers(0, 10, (4, 4)),
    "six digits now and then": lambda random: random.normal(99995.0, 2.0, (40, 30)).astype(int),
    "four columns": lambda random: random.integers(0, 10, (40, 4)) - np.array([20, 0, 20, 0]),
}


@pytest.mark.parametrize("kind", INTEGERS)
@pytest.mark.parametrize("separator", [",", ", "])
def test_whole_numbers_between_commas_are_no_decimals(tmp_path, kind, separator):
    for seed in range(5):
        z = INTEGERS[kind](np.random.default_rng(seed))
        np.savetxt(tmp_path / "scan.csv", z, fmt="%d", delimiter=separator)
        read = read_map(tmp_path / "scan.csv", **GIVEN)
        np.testing.assert_allclose(read.heights, 1e-9 * z, rtol=1e-14)


def test_other_whole_numbers_are_no_decimals(tmp_path):
    z = np.random.default_rng(3).normal(scale=0.6, size=(40, 30))
    for form in ("%.0f", "%03.0f", "%+.0f", "%05.0f"):
        np.savetxt(tmp_path / "scan.csv", 10.0 * z, fmt=form, delimiter=",")
        np.testing.assert_allclose(read_map(tmp_path / "scan.csv", **GIVEN).heights, 1e-9 * np.round(10.0 * z))
    places = "\n".join(f"{x},{x % 7}" for x in range(-40, 41))
    assert read_map(written(tmp_path, places), **GIVEN, lines=True).heights.shape == (1, 81)
    listed = "\n".join(f"{x},{y},{(x * y) % 9}" for x in range(-5, 5) for y in range(10))
    assert read_map(written(tmp_path, listed), **GIVEN).heights.shape == (10, 10)


# One mark of decimals.


@pytest.mark.parametrize(
    ("decimal", "cell", "said"),
    [
        (",", "12.Mrz", "nan is a missing height"),
        (",", "1.7", "there are decimal commas, too"),
        (".", "1,7", "there are decimal points, too"),
        (".", "12,Mrz", "nan is a missing height"),
    ],
)
def test_one_cell_with_the_other_mark_is_where_it_is(tmp_path, decimal, cell, said):
    lines = [line.split(";") for line in rows(Z + 0.25, ";", decimal).splitlines()]
    lines[5][5] = cell
    content = "\n".join(";".join(line) for line in lines)
    refused(tmp_path, content, rf"line 6, column 6: `{re.escape(cell)}` is not a number; {said}")


def test_marks_of_missing_heights_have_points(tmp_path):
    read = read_map(written(tmp_path, rows(Z + 0.25, ";", ",").replace("5,25", "1.#QNAN")), **GIVEN)
    assert np.argwhere(np.isnan(read.heights)).tolist() == [[4, 4]]


# Places that are rounded.


def rounded(separator=" ", header="", pixel=0.00977, digits=3, columns=12, count=9):
    z = np.resize(Z, (count, columns))
    lines = [
        separator.join([f"{i * pixel:.{digits}f}", f"{j * pixel:.{digits}f}", f"{z[j, i]:g}"])
        for i in range(columns)
        for j in range(count)
    ]
    return header + "\n".join(lines), z


def test_rounded_places_need_their_pixel(tmp_path):
    for header, separator in (("", " "), ("x (um),y (um),z (nm)\n", ",")):
        content, z = rounded(separator, header)
        said = refused(tmp_path, content, 'pixel="10 nm"', height_unit="nm")
        assert "0.009 to 0.01" in said and "rounded" in said
        read = read_map(written(tmp_path, content), pixel="9.77 nm", height_unit="nm")
        np.testing.assert_allclose(read.heights, 1e-9 * z)
        assert read.pixel == (9.77e-9, 9.77e-9)
    # The unit of x and y says that it is another pixel.
    said = read_map(written(tmp_path, content), pixel="30 nm").warnings
    assert re.match("its x is rounded, .*: taken as even", said[0])
    assert re.match("pixel is 30.00 nm x 30.00 nm, and the map says 9.7", said[1])


def test_rounded_places_of_a_line_need_their_pixel(tmp_path):
    content = "\n".join(f"{0.00977 * i:.3f} {(7 * i) % 5}" for i in range(40))
    refused(tmp_path, content, "how large its pixels are .*rounded", height_unit="nm", lines=True)
    read = read_map(written(tmp_path, content), pixel="9.77 nm", height_unit="nm", lines=True)
    np.testing.assert_allclose(read.heights, 1e-9 * np.array([[(7 * i) % 5 for i in range(40)]]))


def test_rounded_places_are_a_whole_grid(tmp_path):
    content, _ = rounded()
    lines = content.splitlines()
    refused(tmp_path, "\n".join(lines[1:]), "are no grid: [xy] has no even steps")
    refused(tmp_path, "\n".join([*lines, lines[3]]), "no grid|the place of another one")
    # Steps that double are no rounded ones.
    uneven = "\n".join(f"{2**i} {j} {i + j}" for i in range(8) for j in range(8))
    refused(tmp_path, uneven, "no grid: x has no even steps")


# What is no map.


@pytest.mark.parametrize("content", ["<!DOCTYPE html>\n<html>1 2 3</html>", "<html><body>404</body></html>",
                                     '\n<?xml version="1.0"?>\n<!-- a login -->\n<HTML lang="en">\n'])  # fmt: skip
@pytest.mark.parametrize("name", ["scan.txt", "scan.spm", "scan.html"])
def test_a_web_page_is_no_map(tmp_path, content, name):
    with pytest.raises(SceneError, match="is a web page, not a map"):
        read_map(written(tmp_path, content, name), **GIVEN)


@pytest.mark.parametrize(
    ("content", "shown"),
    [
        ("Scan of a pad\nby J. Doe\n", "`Scan of a pad`"),
        ("\n \n" + 300 * "words ", "`words words .*\\.\\.\\.`"),
        ("1.5 nm;2.5 nm;3.5 nm;4.5 nm\n" * 4, "`1\\.5 nm;2\\.5 nm"),
        ("a\x0cb\u200b\n", "`a\ufffdb\ufffd`"),
        ("\n  \n\t\n", "holds no row of numbers, but blanks"),
    ],
)  # fmt: skip
def test_the_first_line_of_what_has_no_numbers_is_shown(tmp_path, content, shown):
    said = refused(tmp_path, content, shown)
    assert "holds no row of numbers" in said and len(said) < 300 + len(str(tmp_path))


def test_channels_of_one_name_have_numbers(tmp_path):
    path = written(tmp_path, HEADER + rows() + HEADER + rows(ROUGH[:9, :9]))
    np.testing.assert_allclose(read_map(path, channel=1).heights, 1e-9 * ROUGH[:9, :9])
    np.testing.assert_allclose(read_map(path, channel=0).heights, 1e-9 * Z)


# A pixel against the steps of places without a unit.


def places(width, height, form="{:g}"):
    """Points with steps without a unit."""
    places = [(form.format(width * i), form.format(height * j), ROUGH[j, i]) for j in range(12) for i in range(10)]
    return "\n".join(" ".join(str(one) for one in place) for place in places)


@pytest.mark.parametrize("suffix", ["txt", "nc"])
def test_a_square_pixel_of_steps_that_are_not_square_is_refused(tmp_path, suffix, capsys):
    path = tmp_path / f"scan.{suffix}"
    path.write_text(places(20, 40))
    if suffix == "nc":
        coordinates = {"x": 20.0 * np.arange(10), "y": 40.0 * np.arange(12)}
        xarray.DataArray(ROUGH, dims=("y", "x"), coords=coordinates, name="z").to_netcdf(path)
    for pixel, shown in (("20 nm", "20 nm,40 nm"), (4e-8, "20 nm,40 nm"), ("10 nm", "10 nm,20 nm")):
        with pytest.raises(SceneError, match=f'steps of 20 along x and 40 along y.*give pixel="{shown}"'):
            read_map(path, pixel=pixel, height_unit="nm")
    assert main([str(path), "--pixel", "20 nm", "--height-unit", "nm"]) == 2
    assert '--pixel "20 nm,40 nm"' in capsys.readouterr().err
    read = read_map(path, pixel="20 nm,40 nm", height_unit="nm")
    assert read.pixel == pytest.approx((2e-8, 4e-8)) and not read.warnings
    (said,) = read_map(path, pixel="20 nm,30 nm", height_unit="nm").warnings
    assert "20.00 nm x 30.00 nm" in said and "20 along x and 40 along y" in said


@pytest.mark.parametrize(
    ("steps", "pixel", "warned"),
    [
        (20, "20 nm", False), (20, "20 um", False), (0.02, "20 nm", False), (200, "20 nm", False),
        (2e-8, "20 nm", False), (20, "10 nm", True), (19.53, "20 nm", True), (20, "200 nm", True), (1, "20 nm", False),
    ],
)  # fmt: skip
def test_a_pixel_that_no_unit_makes_of_the_steps_is_warned_of(tmp_path, steps, pixel, warned):
    read = read_map(written(tmp_path, places(steps, steps)), pixel=pixel, height_unit="nm")
    said = [warning for warning in read.warnings if "places have" in warning]
    assert len(said) == warned
    if warned:
        assert f"steps of {steps} along x and {steps} along y" in said[0]


def test_rounded_places_name_their_mean_step(tmp_path):
    content, _ = rounded(pixel=0.01953, columns=60, count=40)
    assert len(read_map(written(tmp_path, content), pixel="19.53 nm", height_unit="nm").warnings) == 1
    said = read_map(written(tmp_path, content), pixel="25 nm", height_unit="nm").warnings
    assert "mean steps of 0.01953 along x and 0.01954 along y" in said[1]
    content, _ = rounded(header="x (um),y (um),z (nm)\n", separator=",", pixel=0.01953, columns=60, count=40)
    said = read_map(written(tmp_path, content), pixel="25 nm").warnings
    assert "pixel is 25.00 nm x 25.00 nm, and the map says 19.5" in said[1]


# Maps that were wrapped or stacked.


def test_a_column_below_width_and_height_is_no_line_scan(tmp_path):
    column = "\n".join(f"{height:g}" for height in ROUGH.ravel())
    said = "its header has width and height of a map, .*one column: save it as a matrix"
    refused(tmp_path, HEADER + column, said, lines=True)
    refused(tmp_path, HEADER + column, said)
    read = read_map(written(tmp_path, "# Number of rows: 1\n" + HEADER + column), lines=True)
    np.testing.assert_allclose(read.heights, 1e-9 * ROUGH.reshape(1, -1))
    only_width = "\n".join(line for line in HEADER.splitlines() if "Height" not in line) + "\n"
    assert read_map(written(tmp_path, only_width + column), lines=True).heights.size == ROUGH.size


@pytest.mark.parametrize(
    ("size", "blank", "blocks"),
    [(6, "\n", 2), (4, "\n\n \n", 3), (3, "\n", 4), (1, "\n", 0), (2, "\n", 0), (5, "\n", 0)],
)
def test_blocks_of_rows_between_blank_lines_are_warned_of(tmp_path, size, blank, blocks):
    lines = rows(ROUGH).splitlines()
    parts = ["\n".join(lines[first : first + size]) + "\n" for first in range(0, 12, size)]
    read = read_map(written(tmp_path, "\n" + blank.join(parts) + "\n\n"), **GIVEN)
    np.testing.assert_allclose(read.heights, 1e-9 * ROUGH)
    said = [f"blank lines part its rows into {blocks} blocks of {size} rows, "] if blocks else []
    assert [warning[: len(said[0])] for warning in read.warnings] == said


def test_blank_lines_behind_scan_lines_of_points_are_none_of_maps(tmp_path):
    lines = places(10, 10).splitlines()
    parted = "\n\n".join("\n".join(lines[first : first + 10]) for first in range(0, 120, 10))
    read = read_map(written(tmp_path, parted), **GIVEN)
    np.testing.assert_allclose(read.heights, 1e-9 * ROUGH)
    assert not read.warnings


# Messages that say what would do.


def test_names_of_columns_begin_with_a_blank_behind_the_mark(tmp_path):
    body = rows(ROUGH, separator=",")
    for first in ("row", "#row"):
        header = f"{first},{','.join(str(20 * i) for i in range(9))}\n"
        refused(tmp_path, header + body, rf"column 1: `{first}` is not a number.*begin with `# `, with a blank")
    for named in (header.replace("#", "# "), "#a,b,c,d,e,f,g,h,i,j\n"):
        np.testing.assert_allclose(read_map(written(tmp_path, named + body), **GIVEN).heights, 1e-9 * ROUGH)


def test_places_are_named_from_the_first_on(tmp_path):
    down = "\n".join(f"{11 + 20 * i},{line}" for i, line in enumerate(rows(ROUGH, separator=",").splitlines()))
    refused(tmp_path, down, "column 1 goes evenly from 11 to 231")
    across = f"11,{','.join(str(31 + 20 * i) for i in range(9))}\n" + rows(ROUGH, separator=",")
    refused(tmp_path, across, "line 1 goes evenly from 11 to 191.*begin it with `# `")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("2.225,03;2.226,10;2.224,00", "`2.225,03` has points between thousands and a decimal comma: leave"),
        ("2,225.03;2,226.10;2,224.00", "`2,225.03` has commas between thousands: leave"),
        ("11.1 nm;12.2 nm;13 nm", r"`11.1 nm` has a unit: leave .* height_unit"),
        ("1.11D-08 1.22D-08 1.3D-08", "`1.11D-08` has an exponent of Fortran: write E"),
    ],
)
def test_numbers_that_are_written_otherwise_are_known(tmp_path, line, said):
    refused(tmp_path, "\n".join([line] * 3), f"holds no row of numbers; .*: {said}")
    if ";" in line:
        mixed = "\n".join([*LINES, f"{line.split(';')[0]};{LINES[0].split(';', 1)[1]}"])
        refused(tmp_path, mixed, f"line 10, column 1: .*{said}")


def test_a_pixel_with_a_decimal_comma_is_known(tmp_path):
    path = written(tmp_path, rows())
    with pytest.raises(SceneError, match=r"pixel = '19,53 nm': a comma is between.*a point: \"19\.53 nm\""):
        read_map(path, pixel="19,53 nm", height_unit="nm")


def test_points_with_more_columns_are_no_map(tmp_path):
    lines = places(10, 10).splitlines()
    more = "\n".join(f"{line} {i % 7}" for i, line in enumerate(lines))
    refused(tmp_path, more, "looks like a list of points x, y, z with more columns.*keep the columns x, y, z")
    read = read_map(written(tmp_path, "x y z phase\n" + more), **GIVEN)
    np.testing.assert_allclose(read.heights, 1e-9 * ROUGH)
    narrow = np.random.default_rng(3).integers(0, 4, size=(16, 4))
    np.testing.assert_allclose(read_map(written(tmp_path, rows(narrow)), **GIVEN).heights, 1e-9 * narrow)


@pytest.mark.parametrize("axis", ["x", "y"])
@pytest.mark.parametrize("attrs", [{}, {"units": "nm"}])
def test_the_step_of_a_missing_line_is_named(axis, attrs):
    even = {"x": 20.0 * np.arange(10), "y": 20.0 * np.arange(12)}
    even[axis] = np.delete(20.0 * np.arange(len(even[axis]) + 1), 5)
    z = xarray.DataArray(ROUGH, dims=("y", "x"), coords={one: (one, at, attrs) for one, at in even.items()})
    for pixel in (None, "20 nm"):
        with pytest.raises(SceneError, match=f"{axis} is not evenly spaced: from 8.* it has a step of 4.*as NaN"):
            read_map(z, pixel=pixel, height_unit="nm")


# Headers of instruments.

KEYENCE = (
    '"Measured date","2025/03/02"\n"XY calibration","10.0","nm/pixel"\n"Horizontal","9"\n"Vertical","9"\n'
    '"Unit","um"\n\n"Height"\n'
)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_header_in_cells_has_pixel_and_unit(tmp_path, separator):
    body = "\n".join(separator.join(f'"{height / 1e3:.5f}"' for height in row) for row in Z)
    path = written(tmp_path, KEYENCE.replace(",", separator) + body, "scan.csv")
    assert_read(path)
    (said,) = read_map(path, height_unit="nm").warnings
    assert said == "height_unit is nm, and the map says um: taken as height_unit says"
    (said,) = read_map(path, pixel="20 nm").warnings
    assert "pixel is 20.00 nm x 20.00 nm, and the map says 10.00 nm x 10.00 nm" in said
    wrong = KEYENCE.replace('"Vertical","9"', '"Vertical","8"').replace(",", separator)
    refused(tmp_path, wrong + body, "its header says 8 rows, and there are 9")


def test_steps_of_a_header_are_the_pixel_or_need_both(tmp_path):
    """With a unit for each they are the pixel, as numbers they have to agree with it."""
    headers = "# dx: 10 nm\n# dy: 0.02 um\n", "x-step = 10 nm\ny-step = 20 nm\n", "X spacing: 10 nm\nY spacing: 20 nm\n"
    for header in headers:
        assert read_map(written(tmp_path, header + rows()), height_unit="nm").pixel == pytest.approx((1e-8, 2e-8))
        refused(tmp_path, header + rows(), 'leave pixel.*give pixel="10 nm,20 nm"')
    refused(tmp_path, "dx 10\ndy 20\n" + rows(), r"its steps 10 and 20 have no unit\)", height_unit="nm")
    refused(tmp_path, "dx 10\ndy 20\n" + rows(), 'single pixel is square; give pixel="10 nm,20 nm"')
    (said,) = read_map(written(tmp_path, "cellsize 20\n" + rows()), **GIVEN).warnings
    assert "places have steps of 20 along x and 20 along y, which no unit makes so large" in said


def test_a_factor_of_a_header_is_used(tmp_path):
    header = "height conversion factor (->m): 1e-9\npixel size: 10 nm\n"
    assert_read(written(tmp_path, header + rows()))


@pytest.mark.parametrize(
    "header",
    ["ncols 12\nnrows 10\ncellsize 10\n", "x-pixels = 12\ny-pixels = 10\n",
     "Number of rows: 12\nNumber of columns: 10\n",
     '"Horizontal";"12"\n"Vertical";"10"\n', "Samps/line: 12\nNumber of lines: 10\n"],
)  # fmt: skip
def test_a_column_below_rows_and_columns_is_no_line_scan(tmp_path, header):
    column = "\n".join(f"{height:g};" if ";" in header else f"{height:g}" for height in ROUGH.ravel())
    for lines in (True, False):
        said = "rows and columns of a map, .*one column: save it as a matrix"
        refused(tmp_path, header + column, said, **GIVEN, lines=lines)
    one = " ".join(f"{height:g}" for height in ROUGH.ravel())
    refused(tmp_path, "ncols 12\nnrows 10\n" + one, "rows and columns of a map", **GIVEN, lines=True)


# Points.


def test_each_column_of_points_has_its_unit(tmp_path):
    """x in mm, y in um, z in nm; a place without a unit has that of the other."""
    lines = [f"{1e-5 * i:g},{0.02 * j:g},{Z[j, i]:g}" for j in range(9) for i in range(9)]
    path = written(tmp_path, "X (mm),Y (um),Z (nm)\n" + "\n".join(lines))
    read = read_map(path)
    assert read.pixel == pytest.approx((1e-8, 2e-8))
    np.testing.assert_allclose(read.heights, 1e-9 * Z)
    for header in ("X (nm),Y,Z (nm)\n", "X,Y (nm),Z (nm)\n"):
        assert_read(written(tmp_path, header + "\n".join(points()).replace(" ", ",")))


def test_a_first_column_of_points_may_be_named_otherwise(tmp_path):
    lines = [f"{100 + 3 * n},{line.replace(' ', ',')}" for n, line in enumerate(points())]
    for name in ("id", "Point", '"No"'):
        assert_read(written(tmp_path, f"{name},x (nm),y (nm),z (nm)\n" + "\n".join(lines)))
    refused(tmp_path, "x,y,z\n" + "\n".join(lines), "its header names 3 columns, and there are 4")


def test_points_with_gaps_and_more_columns_are_known(tmp_path):
    """Behind a number of the point, too; one or a line of them may be missing."""
    whole = [f"{line} {n % 7}" for n, line in enumerate(places(10, 10).splitlines())]
    said = "looks like a list of points x, y, z with more columns.*keep the columns x, y, z"
    for lines in (whole, whole[1:], whole[:50] + whole[53:], whole[:20] + whole[30:]):
        refused(tmp_path, "\n".join(lines), said)
        np.save(tmp_path / "points.npy", np.genfromtxt(lines))
        with pytest.raises(SceneError, match=said):
            read_map(tmp_path / "points.npy", **GIVEN)
    counted = [f"{{}} {line}" for line in places(10, 10).splitlines()]
    np.save(tmp_path / "points.npy", np.genfromtxt([line.format(7 + n) for n, line in enumerate(counted)]))
    with pytest.raises(SceneError, match=said):
        read_map(tmp_path / "points.npy", **GIVEN)
    read = read_map(written(tmp_path, "\n".join(line.format(n) for n, line in enumerate(counted))), **GIVEN)
    np.testing.assert_allclose(read.heights, 1e-9 * ROUGH)


def test_arrays_of_points_are_maps(tmp_path):
    """In any order, with a gap, in a file or as a list."""
    listed = np.array([[float(cell) for cell in line.split()] for line in points()])
    np.save(tmp_path / "points.npy", listed)
    for source in (tmp_path / "points.npy", listed, listed.tolist(), np.random.default_rng(3).permutation(listed)):
        assert_read(source, **GIVEN)
    assert read_map(listed[1:], **GIVEN).warnings == ["1 of 81 places of the grid have no point: missing"]
    with pytest.raises(SceneError, match=r"^map: 1 of its points x, y, z have the place of another one"):
        read_map(np.concatenate([listed, listed[:1]]), **GIVEN)


# Several maps, wrapped rows, times of lines.


@pytest.mark.parametrize("mark", ["# New slice\n", "% 2\n", "\n# frame 2\n\n", "// b\n"])
def test_maps_of_one_size_between_comments_are_channels(tmp_path, mark):
    path = written(tmp_path, f"# Array shape: (2, 12, 10)\n{rows(ROUGH)}{mark}{rows(ROUGH + 1.0)}# the end\n")
    with pytest.raises(SceneError, match=r"has 2 channels that may be maps; .*, one of 0: map 0, 1: map 1"):
        read_map(path, **GIVEN)
    for channel, z in enumerate((ROUGH, ROUGH + 1.0)):
        np.testing.assert_allclose(read_map(path, **GIVEN, channel=channel).heights, 1e-9 * z)


def test_arrays_of_numpy_and_octave_are_channels(tmp_path):
    with (tmp_path / "slices.txt").open("w") as file:
        for n in range(3):
            np.savetxt(file, ROUGH + n)
            file.write("# New slice\n")
    np.testing.assert_allclose(read_map(tmp_path / "slices.txt", **GIVEN, channel=2).heights, 1e-9 * (ROUGH + 2.0))
    of = "# name: {}\n# type: matrix\n# rows: {}\n# columns: {}\n{}\n\n"
    octave = "# Created by Octave\n" + of.format("a", 12, 10, rows(ROUGH, " ")) + of.format("b", 9, 9, rows(Z, " "))
    lines = octave.splitlines()
    wide = written(tmp_path, "\n".join(lines[: lines.index("# name: b")]))
    np.testing.assert_allclose(read_map(wide, **GIVEN).heights, 1e-9 * ROUGH)
    fits = of.format("b", 8, 10, rows(ROUGH[:8], " "))
    two = written(tmp_path, octave.replace(of.format("b", 9, 9, rows(Z, " ")), fits))
    np.testing.assert_allclose(read_map(two, channel="b", **GIVEN).heights, 1e-9 * ROUGH[:8])
    refused(tmp_path, two.read_text(), "one of 0: a, 1: b")


def test_comments_that_part_rows_unevenly_are_warned_of(tmp_path):
    lines = rows(ROUGH).splitlines()
    for first, warned in ((5, 1), (2, 0), (11, 0)):
        read = read_map(written(tmp_path, "\n".join([*lines[:first], "# B", *lines[first:]])), **GIVEN)
        np.testing.assert_allclose(read.heights, 1e-9 * ROUGH)
        assert [said[:47] for said in read.warnings] == ["comments part its rows into 2 blocks of 5, 7 ro"] * warned


def correlated(shape=(48, 64), seed=3):
    return ndimage.gaussian_filter(np.random.default_rng(seed).normal(size=shape), 3.0) * 10.0


@pytest.mark.parametrize("count", [2, 4])
@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_wrapped_rows_are_warned_of(tmp_path, count, offset):
    """Rows on two and four lines, as grids of Surfer have them, and with offsets of rows."""
    z = correlated() + offset * np.random.default_rng(4).normal(size=(48, 1))
    for content, warned in ((z, []), (z.reshape(48 * count, -1), [f"each row of the map may be on {count} lines"])):
        read = read_map(written(tmp_path, rows(content, " ")), **GIVEN)
        assert read.heights.shape == content.shape and [said[:37] for said in read.warnings] == warned
    assert "join them to 48 lines of 64 numbers" in read.warnings[0]


def test_surfaces_that_repeat_are_not_wrapped(tmp_path):
    """Gratings along both sides and across, with noise: every n-th line is alike, and none goes on with the next."""
    y, x = np.mgrid[0:48, 0:64].astype(float)
    for u in (x, y, x + y, 0.5 * x - y):
        z = np.sin(2.0 * np.pi * u / 8.0) + 0.1 * np.random.default_rng(5).normal(size=u.shape)
        assert read_map(written(tmp_path, rows(z, " ")), **GIVEN).warnings == []


def test_an_error_of_a_wrapped_map_names_the_warning(tmp_path, capsys):
    """The one summit is on the border of the lines, so the map has none."""
    y, x = np.mgrid[0:14, 0:16]
    path = written(tmp_path, rows((5.0 - ((x - 7) ** 2 + (y - 6) ** 2) / 4.0).reshape(28, 8), " "))
    assert main([str(path), "--pixel", "10 nm", "--height-unit", "nm"]) == 2
    said = capsys.readouterr().err
    assert "the map has no summit; each row of the map may be on 2 lines" in said


@pytest.mark.parametrize("tilt", [0.0, 3.0])
def test_lines_that_only_rise_are_refused(tmp_path, tilt):
    """Times of lines, and places with uneven steps, on level and tilted maps; rising heights are read."""
    z = correlated() + tilt * np.arange(48)[:, np.newaxis]
    assert read_map(written(tmp_path, rows(z)), **GIVEN).heights.shape == (48, 64)
    times = np.cumsum(1.0 + 0.2 * np.random.default_rng(6).random(48))
    for column in (times, -times, 1e3 + 5.0 * times):
        refused(tmp_path, rows(np.column_stack([column, z])), "column 1 only rises or falls, from .* times do")
    refused(tmp_path, rows(np.vstack([np.cumsum(times[:40]), z.T[:, :40]])), "line 1 only rises or falls")
