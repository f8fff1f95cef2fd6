"""Asperities of measured height maps."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .. import files, program, quantities
from ..errors import StictionError
from ..results import Asperities, Place
from .reading import read_map

__all__ = ["find_asperities"]


def find_asperities(
    map: Any,
    output: str | Path | None = None,
    *,
    pixel: Any = None,
    height_unit: str | None = None,
    channel: str | int | None = None,
    factor: Any = None,
    mask: Any = None,
    level: str = "plane",
    smooth: Any = None,
    prominence: Any = None,
    cutoffs: int | None = None,
    force: bool = False,
) -> Asperities:
    """Finds the asperities of a measured surface.

    Parameters
    ----------
    map : path, array_like, pint.Quantity, xarray.DataArray, xarray.Dataset or SurfaceTopography topography
        Heights, as `maps.reading.read_map` takes them: files of texts, NumPy, HDF5, netCDF and, with the extra
        ``stiction[maps]``, TIFF and some forty formats of instruments (``.gwy``, ``.spm``, ``.ibw``, ``.nid``, ...).
        In an array the first index is y and the second x, as in images; masked heights and NaN are missing. The
        coordinates of a `DataArray`, evenly spaced, give the pixel, and their attribute `units` its unit.
        SurfaceTopography's first index is x, which is seen to.
    output : path, optional
        Where the result goes; as of `run`.
    pixel : float, str, or pair of them, optional
        Width, or width and height, of a pixel: numbers in m, or texts with a unit. Needed for arrays.
    height_unit : str, optional
        Unit of the heights; of arrays m by default, of files what they say.
    channel : str or int, optional
        Name, or number from 0, of the channel, dataset, variable or page, where a file has several.
    factor : float, str or pint.Quantity, optional
        What the numbers are multiplied by: a number, or a length per count or other unit (``"12 nm/V"``).
    mask : array_like or path, optional
        Where it is not 0 (True) heights are left out, in the shape of the map.
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
    read = read_map(
        map, pixel=pixel, height_unit=height_unit, channel=channel, factor=factor, mask=mask
    )
    for said in read.warnings:
        warnings.warn(f"{read.name}: {said}", stacklevel=2)
    sizes = ",".join(f"{size!r} m" for size in read.pixel)
    with files.Folder() as folder, Place(output) as place:
        # The program knows an array of NumPy by its first bytes, and writes down the name.
        file = folder / Path(read.name).name
        with file.open("wb") as opened:
            np.save(opened, read.heights)
        try:
            given = program.options(pixel=sizes, height_unit="m", **options)
            program.call(["asperities", str(file), "--output", str(place.path), *given])
        except StictionError as error:
            called = str(map) if isinstance(map, str | Path) else "map"
            raise type(error)(str(error).replace(str(file), called), error.exit_code) from None
        with h5py.File(place.path, "r+") as written:
            written.attrs["map_source"] = read.source
            written.attrs["height_unit"] = "" if height_unit is None else str(height_unit)
        result: Asperities = place.result()
        return result
