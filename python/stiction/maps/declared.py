"""What sources declare of their numbers and of the places of pixels: the one module that makes maps of it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray

from .. import quantities
from ..errors import SceneError
from .lengths import Steps, metres

__all__ = [
    "Raw",
    "axis_of",
    "from_array",
    "from_data_array",
    "from_pint",
    "grid",
    "placed",
    "uneven",
    "unpacked",
]

# Attributes of CF that scale numbers, that mark missing ones, and all that are read.
_SCALES, _MARKS = ("scale_factor", "add_offset"), ("_FillValue", "missing_value")
_READ = {*_SCALES, *_MARKS, "_Unsigned", "valid_range", "valid_min", "valid_max"}
# Words that names of places have next to x and y.
_OF_PLACES = {
    "pos",
    "position",
    "positions",
    "coord",
    "coords",
    "coordinate",
    "coordinates",
    "axis",
    "grid",
    "mesh",
}


@dataclass
class Raw:
    """What a source says of a map.

    `heights` are over y and x, NaN where they are missing, in `unit`; `pixel` is (width, height) in m. `assumed`
    is the unit of heights that come without one, `unsaid` why a pixel has to be given, `doubt` why the one here may
    be wrong, and `fixed` that the unit belongs to the numbers. `steps` are of places without a unit. `uneven` has names
    and places, m, of coordinates that are not even: under 0 of those along the width of a pixel, under 1 along its
    height.
    """

    heights: Any
    pixel: tuple[float, float] | None = None
    unit: str | None = None
    channel: str = ""
    assumed: str | None = None
    unsaid: str = ""
    doubt: str = ""
    fixed: bool = False
    steps: Steps | None = None
    uneven: dict[int, tuple[str, Any]] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def from_array(name: str, values: Any) -> Raw:
    """Numbers without a unit as a map.

    Raises
    ------
    SceneError
        They are no real numbers.
    """
    try:
        return Raw(quantities.reals(name, values))
    except ValueError as error:
        raise SceneError(str(error)) from None


def from_pint(name: str, values: Any) -> Raw:
    """A pint quantity as a map: a length in m, or what it is in its own unit."""
    if values.is_compatible_with("meter"):
        raw = from_array(name, values.to("meter").magnitude)
        raw.unit, raw.fixed = "m", True
    else:
        raw = from_array(name, values.magnitude)
        raw.unit = f"{values.units:~}" or None
    return raw


def unpacked(name: str, variable: xarray.Variable) -> xarray.Variable:
    """Numbers with the scale, the offset and the marks of missing ones that their attributes declare.

    Parameters
    ----------
    name : str
        What messages call the numbers.
    variable : xarray.Variable
        The numbers as they are stored, with attributes by the conventions of CF, in any writer's type.

    Returns
    -------
    xarray.Variable
        Of any shape; NaN where one is missing, and without the attributes that were applied.

    Raises
    ------
    SceneError
        An attribute that is needed is no single number.
    """
    attrs = attributes(variable.attrs)
    for key in (key for key in (*_SCALES, *_MARKS) if key in attrs):
        found = _stored(name, key, attrs.pop(key), variable.dtype)
        if len(found) == 1 or (found and key in _MARKS):
            attrs[key] = found[0] if len(found) == 1 else np.array(found)
    if not {*_SCALES, *_MARKS, "_Unsigned"} & set(attrs):
        return xarray.Variable(variable.dims, variable.values, attrs, variable.encoding)
    packed = xarray.Dataset({"z": xarray.Variable(variable.dims, variable.values, attrs)})
    decoded = xarray.decode_cf(packed, decode_times=False, decode_coords=False)["z"].variable
    decoded.encoding = {**variable.encoding, **decoded.encoding}
    return decoded


def attributes(attrs: Mapping[Any, Any]) -> dict[str, Any]:
    """The attributes that are read: others may be references, or what only their writer knows."""
    return {
        str(name): given.decode("utf-8", "replace") if isinstance(given, bytes) else given
        for name in attrs
        if (name in _READ or str(name).lower() in ("units", "unit")) and (given := attrs[name]) is not None
    }


def _stored(name: str, key: str, given: Any, dtype: np.dtype[Any]) -> list[Any]:
    """The numbers of an attribute, which some write as texts, in the type of what they scale or mark."""
    try:
        numbers = [float(one) if isinstance(one, str | bytes) else one for one in np.ravel(np.asarray(given))]
        if key in _SCALES:
            (number,) = (np.float64(one) for one in numbers)
            return [number]
        # A mark that the type of the numbers does not have marks none of them.
        return [
            np.asarray(one).astype(dtype)[()] for one in numbers if dtype.kind == "f" or _fits(one, dtype)
        ]
    except (TypeError, ValueError):
        raise SceneError(f"{name}: its attribute {key} is {given!r}, and a number is needed") from None


def _fits(number: Any, dtype: np.dtype[Any]) -> bool:
    if dtype.kind not in "iu":
        return False
    of = np.iinfo(dtype)
    return bool(of.min <= number <= of.max and number == int(number))


def grid(
    heights: Any, attrs: Mapping[str, Any], steps: Iterable[float] | None, unit: str | None
) -> xarray.DataArray:
    """Numbers over y and x with their attributes. `steps` has the step of columns and the step of rows, in `unit`, where they are known."""
    places = {
        axis: (axis, step * np.arange(count), {"units": unit} if unit else {})
        for axis, step, count in zip("xy", steps or (), heights.shape[::-1], strict=False)
    }
    return xarray.DataArray(heights, dims=("y", "x"), coords=places, attrs=dict(attrs))


def placed(array: xarray.DataArray, nearby: Mapping[str, xarray.Variable]) -> xarray.DataArray:
    """Numbers of two dimensions, with x and y that a file has next to them as their coordinates.

    Parameters
    ----------
    array : xarray.DataArray (any, any)
        The numbers. Coordinates that they have are kept.
    nearby : mapping of str to xarray.Variable
        Other arrays of the file. Those that are named after x and y count if they are as long as a side, or of the
        shape of the numbers and constant along one of its sides.
    """
    if array.ndim != 2 or any(dim in array.coords for dim in array.dims):
        return array
    along_of = {axis: _places(axis, nearby, array) for axis in "xy"}
    for dims in (("y", "x"), ("x", "y")):
        if all(along in along_of[axis] for along, axis in enumerate(dims)):
            places = [along_of[axis][along] for along, axis in enumerate(dims)]
            coordinates = {
                axis: (axis, one.values, one.attrs) for axis, one in zip(dims, places, strict=True)
            }
            found = xarray.DataArray(array.values, dims=dims, coords=coordinates, attrs=array.attrs)
            found.encoding = array.encoding
            return found
    return array


def _places(
    axis: str, nearby: Mapping[str, xarray.Variable], array: xarray.DataArray
) -> dict[int, xarray.Variable]:
    """The places of an axis, by the dimension of an array that they may go along."""
    for one in (
        xarray.DataArray(one).squeeze().variable for name, one in nearby.items() if axis_of(name) == axis
    ):
        if one.shape == array.shape:
            along = [side for side in (0, 1) if not np.ptp(one.values, axis=1 - side).any()]
            return {side: one.isel({one.dims[1 - side]: 0}) for side in along[:1]}
        if one.ndim == 1 and one.dims[0] in array.dims:
            return {array.dims.index(one.dims[0]): one}
        if one.ndim == 1 and one.size in array.shape:
            return {side: one for side in (0, 1) if array.shape[side] == one.size}
    return {}


def axis_of(name: str) -> str | None:
    """The axis that an array is named after, such as ``x``, ``X_um`` or ``pos_x``; None if it is no such name."""
    words = [word for word in re.split(r"[^a-z]+", name.lower()) if word]
    axes = [word for word in words if word in ("x", "y")]
    others = [word for word in words if word not in axes and word not in _OF_PLACES and metres(word) is None]
    return axes[0] if len(axes) == 1 and not others else None


def _unit(attrs: Any) -> str | None:
    """The unit among attributes, whatever wrote it: bytes, an array of one element, a NumPy string."""
    for name, given in attrs.items():
        if str(name).lower() in ("units", "unit"):
            value = np.ravel(np.asarray(given))
            one = value[0] if value.size else ""
            said = one.decode("utf-8", "replace") if isinstance(one, bytes) else str(one)
            if said.strip("\0 "):
                return said.strip("\0 ")
    return None


def from_data_array(name: str, array: xarray.DataArray) -> Raw:
    """A map whose coordinates with units say where its pixels are.

    Raises
    ------
    SceneError
        It has no two dimensions, or coordinates without units that are off even places by half a step.
    """
    array = array.squeeze()
    if array.ndim == 2 and set(array.dims) == {"x", "y"}:
        array = array.transpose("y", "x")
    if quantities.is_pint(array.data):
        raw, attrs, encoding = from_pint(name, array.data), attributes(array.attrs), array.encoding
    else:
        numbers = unpacked(name, array.variable)
        raw, attrs, encoding = from_array(name, numbers.values), numbers.attrs, numbers.encoding
    raw.unit = raw.unit or _unit(attrs)
    for limit, sign in zip(_limits(attrs), (1.0, -1.0), strict=True):
        if limit is not None and "dtype" in encoding:
            raw.heights = np.where(_is_below(sign, raw.heights, limit, encoding), np.nan, raw.heights)
    if array.ndim != 2:
        return raw
    sizes: list[float] = []
    coordinates = [(dim, _coordinate(name, array, dim)) for dim in reversed(array.dims)]
    for _, coordinate in reversed(coordinates):
        _check_spacing(name, coordinate)
    raw.steps = _steps([coordinate for _, coordinate in coordinates])
    for dim, coordinate in coordinates:
        if coordinate is None:
            return raw
        unit, places = _unit(coordinate.attrs), coordinate.values.astype(float)
        scale, is_even = metres(unit or ""), _is_even(places)
        step = abs(places[-1] - places[0]) / (places.size - 1)
        if scale is None:
            if unit is not None:
                raw.unsaid = f"its coordinate {dim} is in {unit}"
            elif step != 1.0:
                raw.unsaid = f'its coordinate {dim} has steps of {step:g}, but no attribute units such as "m"'
            return raw
        if not is_even:
            raw.uneven[len(sizes)] = (str(dim), scale * places)
        sizes.append(step * scale)
    raw.pixel = (sizes[0], sizes[1])
    return raw


def _coordinate(name: str, array: xarray.DataArray, dim: Any) -> xarray.Variable | None:
    """The numbers that a dimension has as its coordinate; None without them."""
    if dim not in array.coords or array.coords[dim].size < 2 or array.coords[dim].dtype.kind not in "iuf":
        return None
    return unpacked(f"{name}: its coordinate {dim}", array.coords[dim].variable.to_base_variable())


def _unitless(coordinate: xarray.Variable | None) -> Any:
    """The places of a coordinate without a unit of length; None if it has one, or there are none."""
    if coordinate is None:
        return None
    return coordinate.values.astype(float) if metres(_unit(coordinate.attrs) or "") is None else None


def _check_spacing(name: str, coordinate: xarray.Variable | None) -> None:
    """Refuses a coordinate without a unit of length that is off even places by half a step or more."""
    places = _unitless(coordinate)
    if places is None or _is_even(places):
        return
    step = float(np.median(np.diff(places)))
    if not np.all(np.abs(places - places[0] - step * np.arange(places.size)) < 0.5 * abs(step)):
        assert coordinate is not None
        raise SceneError(f"{name}: {uneven(coordinate.dims[0], places)}")


def _steps(coordinates: list[xarray.Variable | None]) -> Steps | None:
    """The steps of two coordinates that are even, of which one or both have no unit of length; None if they are others.

    One without a unit is taken to have that of the other.
    """
    if any(one is None or not _is_even(one.values.astype(float)) for one in coordinates):
        return None
    known = [one for one in coordinates if one is not None]
    width, height = (float(abs(one.values[-1] - one.values[0]) / (one.size - 1)) for one in known)
    units = [_unit(one.attrs) for one in known]
    named = {unit for unit in units if unit}
    if len(named) > 1 or all(metres(unit or "") for unit in units):
        return None
    unit = named.pop() if named else None
    return Steps(width, height, None if metres(unit or "") else unit)


def _limits(attrs: Any) -> tuple[Any, Any]:
    """The least and the largest valid number by the attributes of CF, NumPy's; None where none is said."""
    of_range = np.ravel(attrs.get("valid_range", ()))
    given = of_range if of_range.size == 2 else [attrs.get(f"valid_{which}") for which in ("min", "max")]
    low, high = (np.ravel(one)[0] if np.asarray(one).dtype.kind in "iuf" else None for one in given)
    return low, high


def _is_below(sign: float, values: Any, limit: Any, encoding: Any) -> Any:
    """Where values of a file are below a limit of CF, or above it for a sign of −1.

    A limit is of numbers as they are stored, but one with a point for whole numbers is of scaled ones.
    """
    stored = np.dtype(encoding["dtype"])
    scale, offset = (
        float(np.ravel(encoding.get(name, default))[0])
        for name, default in (("scale_factor", 1.0), ("add_offset", 0.0))
    )
    if str(encoding.get("_Unsigned")).lower() == "true" and limit.dtype.kind == "i":
        limit = limit.astype(f"i{stored.itemsize}").view(f"u{stored.itemsize}")
    is_scaled = stored.kind in "iu" and limit.dtype.kind == "f"
    bound = float(limit) if is_scaled else offset + scale * float(limit)
    if scale < 0.0 and not is_scaled:
        sign = -sign
    # Less than a step, and more than the rounding of scaling.
    margin = 0.01 * abs(scale) if stored.kind in "iu" else 1e-6 * abs(bound - offset)
    return sign * (values - bound) < -margin


def uneven(dim: Any, places: Any) -> str:
    """Where the steps of a coordinate are others first, and what would do."""
    steps = np.diff(places)
    usual = float(np.median(steps))
    at = int(np.argmax(np.abs(steps - usual) > 1e-3 * abs(usual)))
    return (
        f"its coordinate {dim} is not evenly spaced: from {places[at]:g} to {places[at + 1]:g} it has a step of "
        f"{steps[at]:g}, and the usual one is {usual:g}; write rows and columns that are missing as NaN"
    )


def _is_even(places: Any) -> bool:
    """Whether places rise or fall evenly, but for the rounding of single precision."""
    steps = np.diff(places)
    mean = float(np.mean(steps))
    rounding = min(float(np.finfo("f4").eps * np.abs(places).max()), 0.5 * abs(mean))
    return mean != 0.0 and bool(np.all(np.abs(steps - mean) <= max(1e-3 * abs(mean), rounding)))
