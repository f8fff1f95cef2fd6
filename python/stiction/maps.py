"""Asperities of measured height maps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray

from . import files, program, quantities
from .errors import SceneError, StictionError
from .results import Asperities, Place

__all__ = ["find_asperities"]

# Files that the program reads itself; all others are for SurfaceTopography.
_OWN = {".npy", ".txt", ".csv", ".tsv", ".asc", ".dat", ".h5", ".hdf5"}
# The share of their size by which pixels may differ, as coordinates are rounded.
_UNEVEN = 1e-3


def find_asperities(
    map: Any,
    output: str | Path | None = None,
    *,
    pixel: Any = None,
    height_unit: str | None = None,
    dataset: str | None = None,
    level: str = "plane",
    smooth: Any = None,
    prominence: Any = None,
    cutoffs: int | None = None,
    force: bool = False,
) -> Asperities:
    """Finds the asperities of a measured surface.

    Parameters
    ----------
    map : path, array_like, xarray.DataArray or SurfaceTopography topography
        Heights. A path is read by the program (``.npy``, text, ``.h5``) or, with the extra ``stiction[topography]``, by
        SurfaceTopography, which knows some forty formats of instruments (``.gwy``, ``.spm``, ``.ibw``, ``.nid``, ...). In an array the
        first index is y and the second x, as in images; masked heights and NaN are missing. The coordinates `x` and `y` of a
        `DataArray`, evenly spaced, give the pixel, and their attribute `units` its unit; SurfaceTopography's first index is x,
        which is seen to.
    output : path, optional
        Where the result goes; as of `run`.
    pixel : float, str, or pair of them, optional
        Width, or width and height, of a pixel: numbers in m, or texts with a unit. Needed for arrays.
    height_unit : str, optional
        Unit of the heights; of arrays m by default, of files what they say.
    dataset : str, optional
        Which dataset of an HDF5 file is the map.
    level : {"plane", "quadratic", "none"}
        What is subtracted from the heights.
    smooth : float, str, optional
        Cut-off wavelength of the areal Gaussian filter (ISO 16610-61) that the levelled map is smoothed with, a number in m or a text
        with a unit: from two pixels to half the shorter side of the map. By default it is not smoothed.
    prominence : float, str, optional
        Least height above the saddle on the way to higher ground with which a summit counts, a number in m or a text with a unit. By
        default all count.
    cutoffs : int, optional
        Over how many cut-offs, 2 to 100, from two pixels to a quarter of the shorter side, density, radius and scatter of the summits
        are computed too, with the same `prominence`: `Asperities.cutoffs`.
    force : bool
        Whether an existing `output` is overwritten.

    Returns
    -------
    Asperities
        Heights, radii and places of the asperities, the levelled map, and the surface that represents it.

    Raises
    ------
    SceneError
        An argument or the map is wrong.
    StictionError
        The map cannot be read; the message says what is missing for it.

    Examples
    --------
    >>> import stiction
    >>> found = stiction.find_asperities("configs/maps/polished.txt")
    >>> found.height.shape
    (213,)
    """
    lengths = {
        name: None if length is None else quantities.as_text(length, "m")
        for name, length in (("smooth", smooth), ("prominence", prominence))
    }
    options = {"level": level, "cutoffs": cutoffs, "force": force, **lengths}
    if isinstance(map, str | Path):
        path = Path(map)
        if not path.is_file():
            raise SceneError(f"{path}: no such file")
        if path.suffix.lower() in _OWN:
            return _found(path, output, pixel, height_unit, dataset, options)
        map = _topography(path)
        name, called = path.stem, str(path)
    else:
        name, called = "array", "map"
    if dataset is not None:
        raise SceneError(f"dataset = {dataset!r}: only HDF5 files have datasets")
    heights, own_pixel, own_unit = _heights(map)
    pixel, height_unit = pixel or own_pixel, height_unit or own_unit
    if pixel is None:
        raise SceneError('pixel: an array does not say how large its pixels are; give pixel="10 nm"')
    with files.Folder() as folder:
        file = folder / f"{name}.npy"
        np.save(file, heights)
        try:
            return _found(file, output, pixel, height_unit, None, options)
        except StictionError as error:
            raise type(error)(str(error).replace(str(file), called), error.exit_code) from None


def _found(
    path: Path,
    output: str | Path | None,
    pixel: Any,
    height_unit: str | None,
    dataset: str | None,
    others: dict[str, Any],
) -> Asperities:
    sizes = None if pixel is None else ",".join(quantities.as_text(one, "m") for one in _pair(pixel))
    with Place(output) as place:
        options = program.options(pixel=sizes, height_unit=height_unit, dataset=dataset, **others)
        program.call(["asperities", str(path), "--output", str(place.path), *options])
        result: Asperities = place.result()
        return result


def _pair(pixel: Any) -> list[Any]:
    """The width, or width and height, of a pixel."""
    if isinstance(pixel, list | tuple | np.ndarray):
        if len(pixel) not in (1, 2):
            raise SceneError(f"pixel = {pixel!r}: a width, or a width and a height, is needed")
        return list(pixel)
    return [pixel]


def _heights(map: Any) -> tuple[Any, Any, str | None]:
    """Heights over y and x, the pixel and the unit of the heights, as far as they are given."""
    if hasattr(map, "physical_sizes") and callable(getattr(map, "heights", None)):
        return _of_topography(map)
    if isinstance(map, xarray.DataArray):
        return _of_data_array(map)
    if quantities.is_pint(map):
        map = quantities.in_si("map", map, "m")
    return _checked(map), None, "m"


def _checked(map: Any) -> Any:
    """Heights as an array of two dimensions, NaN where they are missing."""
    try:
        values = quantities.reals("map", map)
    except ValueError as error:
        raise SceneError(str(error)) from None
    if values.ndim != 2:
        raise SceneError(f"map: an array of 2 dimensions (y, x) is needed, and this has {values.ndim}")
    return np.ascontiguousarray(values)


def _of_topography(topography: Any) -> tuple[Any, Any, str]:
    if topography.dim != 2:
        raise SceneError("map: a line scan has no asperities; a topography of 2 dimensions is needed")
    unit = topography.unit
    if unit is None:
        raise SceneError(
            'map: the topography has no unit; give it one, such as topography.scale_height_by_factor(1, "nm")'
        )
    pixel = [f"{float(size)!r} {unit}" for size in topography.pixel_size]
    return _checked(topography.heights().T), pixel, str(unit)


def _of_data_array(map: xarray.DataArray) -> tuple[Any, Any, str | None]:
    if map.ndim == 2 and set(map.dims) == {"x", "y"}:
        map = map.transpose("y", "x")
    values = _checked(map.values)
    pixel = []
    for name in reversed(map.dims):
        if name not in map.coords or map.sizes[name] < 2:
            return values, None, map.attrs.get("units", "m")
        steps = np.diff(map[name].values.astype(float))
        if not np.allclose(steps, steps.mean(), rtol=_UNEVEN, atol=0.0):
            raise SceneError(f"map: its coordinate {name} is not evenly spaced")
        pixel.append(f"{abs(float(steps.mean()))!r} {map[name].attrs.get('units', 'm')}")
    return values, pixel, map.attrs.get("units", "m")


def _topography(path: Path) -> Any:
    """A file of an instrument, as SurfaceTopography reads it."""
    try:
        import SurfaceTopography
    except ImportError:
        own = ", ".join(sorted(_OWN))
        raise SceneError(
            f"{path}: for files other than {own} SurfaceTopography is needed: `pip install stiction[topography]`"
        ) from None
    try:
        return SurfaceTopography.read_topography(str(path))
    except Exception as error:
        raise SceneError(
            f"{path}: SurfaceTopography cannot read it: {' '.join(str(error).split()) or error!r}"
        ) from error
