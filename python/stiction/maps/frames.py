"""Tables of pandas as maps, with the care that texts get."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pandas as pd
import xarray
from numpy.typing import NDArray

from ..errors import SceneError
from ..texts import HEIGHT
from .declared import Raw, from_array, from_data_array
from .labels import counting, without_labels
from .places import axes_of, points

__all__ = ["from_frame"]


def from_frame(frame: pd.DataFrame) -> Raw:
    """A table as a map: places in its index and its names of columns, or points with columns x, y, z.

    Parameters
    ----------
    frame : pandas.DataFrame (ny, nx) or (count, 3 or more)
        Heights, or points.

    Raises
    ------
    SceneError
        A first row of heights has become names of columns, or a row or column has no heights.
    """
    axes = axes_of([str(name) for name in frame.columns])
    if axes is not None:
        chosen = [axes.names.index(axis) for axis in "xyz"]
        found = points(_numbers(frame.iloc[:, chosen]), (axes.units["x"], axes.units["y"]))
        found.unit = axes.units["z"] or None
        return found
    columns, rows = _places(frame.columns), _places(frame.index)
    if columns is not None and np.isfinite(columns).sum() * 2 > columns.size:
        _check_names(columns)
    heights, said = without_labels(_numbers(frame), "row 1")
    array = xarray.DataArray(heights, dims=("index", "columns"))
    for dim, at in (("columns", columns), ("index", rows)):
        at = None if at is None else at[-array.sizes[dim] :]
        if at is not None and np.isfinite(at).all() and not counting(at):
            array = array.assign_coords({dim: at})
    raw = from_data_array("its table", array)
    raw.warnings += said
    return raw


def _numbers(frame: pd.DataFrame) -> NDArray[np.float64]:
    numbers: NDArray[np.float64] = np.asarray(from_array("its table", frame.to_numpy()).heights, dtype=float)
    return numbers


def _places(names: pd.Index[Any]) -> NDArray[np.float64] | None:
    """The numbers that names are, be it as texts, NaN for others; None if none is one."""
    if names.nlevels > 1 or names.dtype.kind in "mM":
        return None
    written = [str(name).strip() for name in names]
    # A number that is there twice has another one behind it in pandas.
    found = [re.fullmatch(r"(.+?)(?:\.\d+)?", name) for name in written]
    plain = [one[1] if one and one[1] in written else name for one, name in zip(found, written, strict=True)]
    numbers = np.array(
        [float(name) if HEIGHT.fullmatch(name) and "," not in name else np.nan for name in plain]
    )
    return numbers if np.isfinite(numbers).any() else None


def _check_names(places: NDArray[np.float64]) -> None:
    """Refuses names of columns that are numbers without even steps: the heights of a first row."""
    steps = np.diff(places[np.isfinite(places)])
    if steps.size and np.abs(steps - np.median(steps)).max() > 0.5 * abs(np.median(steps)):
        raise SceneError(
            f"its names of columns are numbers without even steps, from {places[np.isfinite(places)][0]:g} on, as "
            "the heights of a first row: read it with pandas.read_csv(..., header=None)"
        )
