"""Tables of pandas get the care of texts: names, places and points are no heights, and no row of heights is lost."""

import io

import numpy as np
import pandas as pd
import pytest
from test_reading import GIVEN, PIXEL, ROUGH, Z, assert_read, assert_summit, points, rows

from stiction import SceneError
from stiction.maps.reading import read_map


def test_a_plain_table_is_its_array():
    for z in (Z, ROUGH):
        for frame in (pd.DataFrame(z), pd.DataFrame(z, columns=[f"P{k}" for k in range(z.shape[1])])):
            read = read_map(frame, **GIVEN)
            np.testing.assert_array_equal(read.heights, 1e-9 * z)
            assert read.warnings == []
    assert_summit(pd.DataFrame(1e-9 * Z), pixel=PIXEL)


@pytest.mark.parametrize("first", [0, 1])
def test_a_column_of_line_numbers_is_left_out_and_said(first):
    frame = pd.DataFrame(Z)
    frame.insert(0, "Line", np.arange(first, first + 9))
    read = read_map(frame, **GIVEN)
    assert read.warnings == [f"column 1 counts from {first} to {first + 8}, as names do: left out"]
    assert_summit(frame, **GIVEN)


def test_a_column_of_places_or_times_is_refused():
    for column, said in ((20.0 * np.arange(12), "column 1 goes evenly from 0 to 220"),
                         (np.cumsum(1.0 + 0.1 * np.arange(12) % 0.3), "column 1 only rises or falls")):  # fmt: skip
        frame = pd.DataFrame(ROUGH)
        frame.insert(0, "t", column)
        with pytest.raises(SceneError, match=f"^map: {said}"):
            read_map(frame, **GIVEN)


@pytest.mark.parametrize("z", [Z, ROUGH, np.round(ROUGH)])
def test_a_first_row_that_became_names_is_refused(z):
    """Of equal heights pandas makes ``1``, ``1.1``, ``1.2``."""
    frame = pd.read_csv(io.StringIO(rows(z, ",")))
    assert frame.shape == (len(z) - 1, z.shape[1])
    with pytest.raises(SceneError, match=r"^map: its names of columns are numbers without even steps, .*header=None"):
        read_map(frame, **GIVEN)
    np.testing.assert_allclose(read_map(pd.read_csv(io.StringIO(rows(z, ",")), header=None), **GIVEN).heights, 1e-9 * z)


def test_places_in_index_and_columns_are_steps():
    """Numbers or texts, falling too; a pixel that no unit makes of them is warned of, and uneven ones are refused."""
    at = 20.0 * np.arange(9)
    for index, columns in ((at, at), (at[::-1], [f"{place:g}" for place in at])):
        frame = pd.DataFrame(Z, index=index, columns=columns)
        assert read_map(frame, pixel="20 nm", height_unit="nm").warnings == []
        (said,) = read_map(frame, **GIVEN).warnings
        assert "places have steps of 20 along x and 20 along y" in said
    with pytest.raises(SceneError, match="its coordinate index is not evenly spaced"):
        read_map(pd.DataFrame(Z, index=at**2, columns=at), **GIVEN)
    # Names of lines, and times of a clock, are no places.
    for index in (list("abcdefghi"), pd.date_range("2026-01-01", periods=9, freq="7s")):
        assert_read(pd.DataFrame(Z, index=index, columns=at), **GIVEN)


def test_points_in_a_table_are_a_map():
    frame = pd.DataFrame([line.split() for line in points()], columns=["x", "y", "height"], dtype=float)
    assert_read(frame, **GIVEN)
    frame.insert(0, "id", np.arange(100, 181))
    assert_read(frame.rename(columns={"x": "X (nm)", "y": "Y [nm]", "height": "Z (nm)"}))
    assert_read(frame[["x", "y", "height"]].set_axis(["a", "b", "c"], axis=1), **GIVEN)
