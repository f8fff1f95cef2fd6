"""Reading height maps: files of NumPy, HDF5 and texts, files of instruments, arrays."""

from __future__ import annotations

import io
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray

from .. import quantities
from ..errors import SceneError

__all__ = ["HeightMap", "read_map"]

# Files that are read here; all others are for SurfaceTopography.
_OWN = {".npy", ".txt", ".csv", ".tsv", ".asc", ".dat", ".h5", ".hdf5"}
# The share of their size by which pixels may differ, as coordinates are rounded.
_UNEVEN = 1e-3


@dataclass
class HeightMap:
    """Heights of a surface over a grid.

    Attributes
    ----------
    heights : array (ny, nx)
        Heights, m; NaN where one is missing.
    pixel : pair of float
        Width and height of a pixel, m.
    name : str
        What messages and files call the map.
    source : str
        The kind of the file, and the channel of it.
    warnings : list of str
        What the reader is not sure of.
    """

    heights: Any
    pixel: tuple[float, float]
    name: str
    source: str
    warnings: list[str] = field(default_factory=list)


@dataclass
class _Raw:
    heights: Any
    source: str
    pixel: Any = None
    unit: str | None = None


def read_map(
    source: Any, *, pixel: Any = None, height_unit: str | None = None, channel: str | None = None,
    factor: Any = None, mask: Any = None,
) -> HeightMap:  # fmt: skip
    """Reads a map from a file or an array.

    Raises
    ------
    SceneError
        It is no map, or its pixel or unit is not known.
    """
    if isinstance(source, str | Path):
        path = Path(source)
        raw, name = _of_file(path, channel), path.name
    else:
        raw, name = _of_object(source), "array"
        if channel is not None:
            raise SceneError(f"dataset = {channel!r}: only HDF5 files have datasets")
    called = str(source) if isinstance(source, str | Path) else "map"
    warnings: list[str] = []
    size = _pixel(called, pixel, raw, warnings)
    unit = _unit(called, height_unit, raw, warnings)
    heights = raw.heights * (unit * (1.0 if factor is None else float(factor)))
    if mask is not None:
        heights[np.asarray(mask, dtype=bool)] = np.nan
    return HeightMap(heights, size, name, raw.source, warnings)


def _length(name: str, value: Any) -> float:
    try:
        length, unit = quantities.parsed(
            name, value if isinstance(value, str) else quantities.as_text(value, "m")
        )
    except (TypeError, ValueError):
        unit = ""
    if unit != "m":
        raise SceneError(f'{name} = {value!r}: a length with its unit is needed, such as "9.8 nm"')
    return float(length)


def _pixel(called: str, given: Any, raw: _Raw, warnings: list[str]) -> tuple[float, float]:
    if isinstance(given, str) and "," in given:
        given = given.split(",")
    if given is None and raw.pixel is None and called == "map":
        raise SceneError('pixel: an array does not say how large its pixels are; give pixel="10 nm"')
    if given is None and raw.pixel is None:
        raise SceneError(
            f'{called}: does not say how large it is; give pixel with the size of a pixel, such as "9.8 nm"'
        )
    stated = None if raw.pixel is None else [_length("pixel", one) for one in raw.pixel]
    if given is None:
        assert stated is not None
        return stated[0], stated[1]
    pair = list(given) if isinstance(given, list | tuple | np.ndarray) else [given]
    if len(pair) not in (1, 2):
        raise SceneError(f"pixel = {given!r}: a width, or a width and a height, is needed")
    sizes = [_length("pixel", one) for one in pair]
    if not all(1e-13 <= size <= 1e3 for size in sizes):
        raise SceneError("pixel: a pixel is between 1e-13 and 1e3 m")
    size = (sizes[0], sizes[-1])
    if stated is not None and not np.allclose(size, stated, rtol=1e-6, atol=0.0):
        shown = [" x ".join(quantities.si(one, "m") for one in pair) for pair in (size, stated)]
        warnings.append(f"pixel says {shown[0]}, and the file {shown[1]}: taken as pixel says")
    return size


def _unit(called: str, given: str | None, raw: _Raw, warnings: list[str]) -> float:
    def length(unit: str) -> float:
        try:
            value, si = quantities.parsed("height_unit", f"1 {unit}")
        except ValueError:
            value, si = 0.0, ""
        if si != "m":
            raise SceneError(f"height_unit = {unit!r}: known: m, mm, um, nm, pm, fm, angstrom")
        return value

    if given is not None:
        own = length(given)
        if raw.unit is not None:
            try:
                is_alike = abs(own / length(raw.unit) - 1.0) < 1e-6
            except SceneError:
                is_alike = False
            if not is_alike:
                shown = quantities.si(own, "m")
                warnings.append(
                    f"height_unit says {shown}, and the file {raw.unit}: taken as height_unit says"
                )
        return own
    if raw.unit is None:
        raise SceneError(
            f"{called}: does not say in which unit its heights are; give height_unit, such as nm"
        )
    try:
        return length(raw.unit)
    except SceneError:
        raise SceneError(
            f"{called}: has heights in `{raw.unit}`, which is no unit of length; give height_unit, such as nm"
        ) from None


def _of_object(map: Any) -> _Raw:
    """Heights over y and x, with the pixel and the unit as far as they are given."""
    if hasattr(map, "physical_sizes") and callable(getattr(map, "heights", None)):
        return _of_topography(map)
    if isinstance(map, xarray.DataArray):
        return _of_data_array(map)
    if quantities.is_pint(map):
        map = quantities.in_si("map", map, "m")
    return _Raw(_checked(map), "array", unit="m")


def _checked(map: Any) -> Any:
    """Heights as an array of two dimensions, NaN where they are missing."""
    try:
        values = quantities.reals("map", map)
    except ValueError as error:
        raise SceneError(str(error)) from None
    if values.ndim != 2:
        raise SceneError(f"map: an array of 2 dimensions (y, x) is needed, and this has {values.ndim}")
    return np.ascontiguousarray(values)


def _of_topography(topography: Any) -> _Raw:
    if topography.dim != 2:
        raise SceneError("map: a line scan has no asperities; a topography of 2 dimensions is needed")
    unit = topography.unit
    if unit is None:
        raise SceneError(
            'map: the topography has no unit; give it one, such as topography.scale_height_by_factor(1, "nm")'
        )
    pixel = [f"{float(size)!r} {unit}" for size in topography.pixel_size]
    return _Raw(_checked(topography.heights().T), "SurfaceTopography", pixel, str(unit))


def _of_data_array(map: xarray.DataArray) -> _Raw:
    if map.ndim == 2 and set(map.dims) == {"x", "y"}:
        map = map.transpose("y", "x")
    raw = _Raw(_checked(map.values), "DataArray", unit=map.attrs.get("units", "m"))
    pixel = []
    for name in reversed(map.dims):
        if name not in map.coords or map.sizes[name] < 2:
            return raw
        steps = np.diff(map[name].values.astype(float))
        if not np.allclose(steps, steps.mean(), rtol=_UNEVEN, atol=0.0):
            raise SceneError(f"map: its coordinate {name} is not evenly spaced")
        pixel.append(f"{abs(float(steps.mean()))!r} {map[name].attrs.get('units', 'm')}")
    raw.pixel = pixel
    return raw


def _of_file(path: Path, channel: str | None) -> _Raw:
    if not path.exists():
        raise SceneError(f"{path}: no such file; it cannot be read")
    if path.is_dir():
        raise SceneError(f"{path}: is a folder")
    if path.suffix.lower() not in _OWN:
        if channel is not None:
            raise SceneError(f"dataset = {channel!r}: only HDF5 files have datasets")
        return _of_topography(_topography(path))
    if h5py.is_hdf5(path):
        return _of_hdf5(path, channel)
    start = path.read_bytes()[:8]
    if start.startswith(b"\x89HDF"):
        raise SceneError(f"{path}: is an HDF5 file that is damaged or incomplete")
    if channel is not None:
        raise SceneError(f"{path}: is no HDF5 file, and has no dataset to choose")
    if start.startswith(b"\x93NUMPY"):
        try:
            return _Raw(_checked(np.load(path)), "NPY")
        except (ValueError, EOFError, OSError) as error:
            raise SceneError(f"{path}: is an NPY file that is damaged: {error}") from None
    return _of_text(path)


def _of_hdf5(path: Path, channel: str | None) -> _Raw:
    try:
        with h5py.File(path, "r") as file:
            maps = [name for name, one in file.items() if isinstance(one, h5py.Dataset) and one.ndim == 2]
            if channel is None and len(maps) != 1:
                there = (
                    f"several datasets; name one of {', '.join(maps)}"
                    if maps
                    else "no dataset of two dimensions in its root"
                )
                raise SceneError(f"{path}: has {there}; give dataset")
            name = maps[0] if channel is None else channel
            dataset = file.get(name)
            if not isinstance(dataset, h5py.Dataset):
                raise SceneError(f"{path}: lacks the dataset {name}")
            unit = dataset.attrs.get("units")
            return _Raw(_checked(dataset[()]), f"HDF5, dataset {name}", unit=unit)
    except OSError as error:
        raise SceneError(f"{path}: is an HDF5 file that is damaged or incomplete: {error}") from None


def _of_text(path: Path) -> _Raw:
    text = path.read_bytes().decode("utf-8-sig", errors="replace")
    rows: list[Any] = []
    header: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        line = line.strip()
        first = re.split(r"[\t;, ]", line.lstrip())[0] if line else ""
        if (
            not line
            or line.startswith(("#", "%", "//"))
            or (not rows and not re.fullmatch(r"[-+]?(\d.*|\.\d.*|nan|inf)", first))
        ):
            header.append(line.lstrip("#%/ "))
            continue
        mark = next((mark for mark in "\t;," if mark in line), None)
        fields = [one.strip() for one in line.split(mark)]
        if len(fields) > 1 and not fields[-1]:
            fields.pop()
        rows.append(_numbers(path, number, fields))
        if len(fields) != len(rows[0]):
            raise SceneError(
                f"{path}: line {number}: has {len(fields)} numbers, and the rows before it have {len(rows[0])}"
            )
    if not rows:
        raise SceneError(f"{path}: {'holds no row of numbers' if text else 'is empty'}")
    heights = np.array(rows)
    keys = dict(re.findall(r"^(Width|Height|Value units):\s*(.*\S)", "\n".join(header), flags=re.MULTILINE))
    pixel = None
    if {"Width", "Height"} <= keys.keys():
        pixel = [
            _length("pixel", keys[key]) / count
            for key, count in (("Width", heights.shape[1]), ("Height", heights.shape[0]))
        ]
    return _Raw(heights, "text", pixel, keys.get("Value units"))


def _numbers(path: Path, number: int, fields: list[str]) -> Any:
    for column, one in enumerate(fields, 1):
        try:
            float(one)
        except ValueError:
            advice = (
                "decimal points are needed, not commas"
                if "," in one
                else "lines that are no rows begin with #"
            )
            raise SceneError(
                f"{path}: line {number}: column {column}: `{one}` is not a number; {advice}"
            ) from None
    return np.loadtxt(io.StringIO(" ".join(fields)), ndmin=1)


def _topography(path: Path) -> Any:
    """A file of an instrument, as SurfaceTopography reads it."""
    try:
        import SurfaceTopography
    except ImportError:
        own = ", ".join(sorted(_OWN))
        raise SceneError(
            f"{path}: for files other than {own} SurfaceTopography is needed: `pip install stiction[maps]`"
        ) from None
    try:
        return SurfaceTopography.read_topography(str(path))
    except Exception as error:
        raise SceneError(
            f"{path}: SurfaceTopography cannot read it: {' '.join(str(error).split()) or error!r}"
        ) from error
