"""`stiction.find_asperities`: a map in, the file of its asperities out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..opened import Asperities, Place

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
    level_rows: str | None = None,
    level: str = "plane",
    smooth: Any = None,
    prominence: Any = None,
    min_distance: Any = None,
    cutoffs: int | None = None,
    figure: str | Path | None = None,
    force: bool = False,
) -> Asperities:
    """Finds the asperities of a measured surface.

    Parameters
    ----------
    map : path, array_like, pandas.DataFrame, pint.Quantity, xarray.DataArray, xarray.Dataset or topography
        Heights: files of texts, NumPy, HDF5, netCDF and, with the extra ``stiction[maps]``, TIFF and some forty
        formats of instruments (``.gwy``, ``.spm``, ``.ibw``, ``.nid``, ...). In an array the first index is y and
        the second x, as in images; masked heights and NaN are missing. The coordinates `x` and `y` of a
        `DataArray`, evenly spaced, give the pixel, and their attribute `units` its unit. SurfaceTopography's first
        index is x; the program swaps them.
    output : path, optional
        The result file, as in `run`.
    pixel : float, str, or pair of them, optional
        Width, or width and height, of a pixel: numbers in m, or texts with a unit. Needed for arrays.
    height_unit : str, optional
        Unit of the heights; for arrays m by default, for files the unit that they give.
    channel : str or int, optional
        Name, or number from 0, of the channel, dataset, variable or page, where a file has several.
    factor : float, str, optional
        Factor for the numbers: a number, or a text with a length per count or other unit of the
        instrument, such as ``"12 nm/V"``.
    mask : array_like (ny, nx) or path, optional
        Where it is not 0 heights count as missing.
    level_rows : {"median", "differences"}, optional
        What is subtracted from each row before: its median, or the sum of the median differences from row to row,
        both of heights above the surface of `level`. By default nothing is.
    level : {"plane", "quadratic", "none"}
        What is subtracted from the heights.
    smooth : float, str, optional
        Cut-off wavelength of the areal Gaussian filter (ISO 16610-61) that the levelled map is smoothed with,
        a number in m or a text with a unit: from two pixels to half the shorter side of the map. By default
        it is not smoothed.
    prominence : float, str, optional
        Least height above the saddle on the way to higher ground with which a summit counts, a number in m or
        a text with a unit. By default all count.
    min_distance : float, str, optional
        Least distance to a higher summit that counts, a number in m or a text with a unit. By default all
        count.
    cutoffs : int, optional
        Over how many cut-offs, 2 to 100, from two pixels to a quarter of the shorter side, density, radius
        and standard deviation of the heights of the summits are computed too, with the other options as they are: `Asperities.cutoffs`.
    figure : path, optional
        A picture, ``.png``, ``.pdf`` or ``.svg``, of the map with its summits as measured and after each
        step.
    force : bool
        Whether an existing `output` or `figure` is overwritten.

    Returns
    -------
    Asperities
        Heights, radii and places of the asperities, the levelled map, and the surface that represents it.

    Raises
    ------
    SceneError
        An argument or the map is wrong.
    FileError
        A file is there already, or cannot be written.

    Examples
    --------
    >>> import stiction
    >>> found = stiction.find_asperities("configs/maps/polished.txt")
    >>> found.height.shape
    (213,)
    """
    # SciPy takes as long to import as the rest of the package.
    from . import figure as picture
    from . import surface as steps_to
    from .file import write
    from .reading import read_map

    steps = steps_to.steps_of(
        level, level_rows, smooth=smooth, prominence=prominence, min_distance=min_distance, cutoffs=cutoffs
    )
    inputs = [map] if isinstance(map, str | Path) else []
    steps_to.check_outputs(output, figure, force=force, inputs=inputs)
    height_map = read_map(
        map, pixel=pixel, height_unit=height_unit, channel=channel, factor=factor, mask=mask
    )
    called = str(map) if isinstance(map, str | Path) else "map"
    surface = steps_to.found_on(height_map, steps, called, keep=figure is not None)
    with Place(output) as place:
        write(place.path, surface, height_unit or "", force=force, inputs=inputs)
        if figure is not None:
            picture.draw(figure, surface, force=force, inputs=inputs)
        result: Asperities = place.result()
        return result
