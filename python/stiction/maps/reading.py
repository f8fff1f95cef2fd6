"""Height maps of files and arrays, in metres."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray
from numpy.typing import NDArray

from .. import quantities
from ..errors import SceneError
from . import declared, formats, frames, lengths, places, text
from .channels import named
from .declared import Raw

__all__ = ["HeightMap", "read_map"]

# Relative difference below which sizes are one.
_ALIKE = 1e-3
# Radius of curvature, m, from pixel to pixel, above which a pixel is taken for the whole scan. Surfaces have a few
# millimetres at most, polished glass under an optical profiler included.
_FLATTEST = 1e-2
# Shorter ones, m, are pixels and no scans.
_SHORTEST_SCAN = 1e-7
# Heights that files write where there is none.
_SENTINELS = (-9999.0, -99999.0, -32768.0, -32767.0, 1e20, 1e30, 9.969209968386869e36, -3.4028234663852886e38,
              3.4028234663852886e38, 1.70141e38)  # fmt: skip


@dataclass
class HeightMap:
    """A map of heights, and where it comes from.

    Attributes
    ----------
    heights : numpy.ndarray
        Heights over y and x, m; NaN where they are missing.
    pixel : tuple of float
        Width and height of a pixel, m.
    name : str
        What it is called: the name of the file, without its folder.
    source : str
        The path, and the channel, dataset or variable of a file that has names for them.
    warnings : list of str
        What should be looked at, a sentence each.
    channel : str
        The channel, dataset or variable; empty where there are no names for them.
    """

    heights: NDArray[np.float64]
    pixel: tuple[float, float]
    name: str
    source: str
    warnings: list[str] = field(default_factory=list)
    channel: str = ""

    @property
    def is_line(self) -> bool:
        """Whether it is a line scan, of a single row."""
        return len(self.heights) == 1


def read_map(
    source: Any,
    *,
    pixel: Any = None,
    height_unit: Any = None,
    channel: str | int | None = None,
    factor: Any = None,
    mask: Any = None,
    lines: bool = False,
) -> HeightMap:
    """Reads a height map.

    Parameters
    ----------
    source : path, array_like, pandas.DataFrame, pint.Quantity, xarray.DataArray, xarray.Dataset or topography
        Heights, the first index y and the second x, as in images. Files are ``.npy``, ``.npz``, HDF5, netCDF,
        MATLAB, TIFF, texts, and all formats of instruments that SurfaceTopography knows; they may be packed by
        gzip, bz2 or xz, or alone in a zip file. NaN and masked heights are missing.
    pixel : float, str, pint.Quantity, or one or two of them, optional
        Width, or width and height, of a pixel: numbers in m, texts with a unit. Needed where `source` does not
        say it.
    height_unit : str, optional
        Unit of the heights, such as ``"nm"``; of arrays m by default, of files what they say.
    channel : str or int, optional
        Name, or number from 0, of the channel, dataset, variable or page, where there are several.
    factor : float, str or pint.Quantity, optional
        Factor for the numbers: a number, and then their unit or `height_unit` holds; or a length per
        count or other unit, such as ``"0.5 nm"`` or ``"12 nm/V"``.
    mask : array_like or path, optional
        Where it is not 0 (True) heights are left out as missing, in the shape of the map.
    lines : bool
        Whether a line scan is read too, as a map of a single row; otherwise it is refused.

    Returns
    -------
    HeightMap
        Heights and pixel in m.

    Raises
    ------
    SceneError
        The map cannot be read, an argument is wrong, or pixel and unit are not known; the message begins with
        the path, or with the argument.

    Examples
    --------
    >>> from stiction.maps.reading import read_map
    >>> map = read_map("configs/maps/polished.txt")
    >>> map.heights.shape, map.pixel, map.name
    ((192, 192), (3e-08, 3e-08), 'polished.txt')
    """
    called, raw = _read(source, None if channel is None else str(channel))
    _from_points(called, raw)
    if lines and sum(length > 1 for length in np.shape(raw.heights)) == 1:
        raw.heights = np.reshape(raw.heights, (1, -1))
    elif np.ndim(raw.heights) != 2 or min(raw.heights.shape) < 2:
        raise SceneError(f"{called}: {_not_two(raw.heights.shape)}")
    if mask is not None:
        raw.heights = np.where(_mask(mask, raw.heights.shape), np.nan, raw.heights)
    size, scale = _in_metres(called, raw, pixel, (height_unit, factor))
    heights = np.multiply(raw.heights, scale, order="C")
    _check_heights(called, heights)
    warnings = [*raw.warnings, *_marked(raw.heights), *_whole_scan(heights, size, raw)]
    path = Path(source) if isinstance(source, str | Path) else None
    of_channel = f", channel {raw.channel}" if raw.channel else ""
    name = path.name if path else raw.channel or "array"
    return HeightMap(
        heights, size, name, f"{path}{of_channel}" if path else name, warnings, raw.channel or ""
    )


def _read(source: Any, channel: str | None) -> tuple[str, Raw]:
    """What messages call a source, and what it says."""
    if isinstance(source, str | Path):
        return str(source), formats.from_path(Path(source), channel)
    if isinstance(source, xarray.Dataset):
        maps = [str(name) for name, one in source.data_vars.items() if one.squeeze().ndim == 2]
        name = named(channel, maps, "variable", "map: ")
        nearby = {str(other): one for other, one in source.variables.items() if other != name}
        raw = declared.from_data_array("map", declared.placed(source[name].squeeze(), nearby))
        raw.channel = name
    elif channel is not None:
        raise SceneError(f"channel = {channel!r}: only files and datasets have channels")
    elif hasattr(source, "physical_sizes") and callable(getattr(source, "heights", None)):
        return "map", formats.from_topography("map", source)
    elif isinstance(source, pd.DataFrame):
        with _blamed("map"):
            raw = frames.from_frame(source)
    elif isinstance(source, xarray.DataArray):
        raw = declared.from_data_array("map", source)
        raw.channel = "" if source.name is None else str(source.name)
    elif quantities.is_pint(source):
        raw = declared.from_pint("map", source)
    else:
        raw = declared.from_array("map", source)
    raw.assumed = "m"
    return "map", raw


@contextmanager
def _blamed(called: str) -> Iterator[None]:
    """Blames what goes wrong in a block on a source."""
    try:
        yield
    except SceneError as error:
        raise SceneError(f"{called}: {error}") from None


def _from_points(called: str, raw: Raw) -> None:
    """Makes a map of N x 3 numbers, which are points x, y, z, and refuses points with more columns."""
    if np.ndim(raw.heights) != 2 or raw.pixel is not None or raw.steps is not None:
        return
    count, columns = raw.heights.shape
    if columns == 3 and count > 3:
        unit = raw.unit if raw.fixed and raw.unit else ""
        with _blamed(called):
            found = places.points(raw.heights, (unit, unit))
        raw.heights, raw.pixel, raw.steps, raw.unsaid = found.heights, found.pixel, found.steps, found.unsaid
        raw.warnings += found.warnings
    elif places.begin_with_grid(raw.heights):
        raise SceneError(
            f"{called}: looks like a list of points x, y, z with more columns: it has {columns}, and the places of a "
            "grid are in it; keep the columns x, y, z, or name all in the first line of a text, as `x y z phase`"
        )


def _not_two(shape: tuple[int, ...]) -> str:
    if sum(length > 1 for length in shape) < 2:
        return text.LINE_SCAN if shape else "a single number is no map"
    sizes = " x ".join(str(length) for length in shape)
    return f"an array of 2 dimensions (y, x) is needed, and this has {len(shape)}: {sizes}"


def _mask(mask: Any, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Where heights are left out."""
    if isinstance(mask, str | Path):
        values = formats.from_path(Path(mask), None).heights
    else:
        values = declared.from_array("mask", mask).heights
    if shape == (1, values.size):
        values = values.reshape(shape)
    if values.shape != shape:
        given, needed = (" x ".join(str(length) for length in one) for one in (values.shape, shape))
        raise SceneError(f"mask: has the shape {given}, and the map {needed}")
    return np.asarray(np.isnan(values) | (values != 0.0))


def _in_metres(
    called: str, raw: Raw, pixel: Any, heights: tuple[Any, Any]
) -> tuple[tuple[float, float], float]:
    """The pixel in m, and what the heights are to be multiplied by; what is missing is said at once."""
    missing: list[str] = []
    advice: list[str] = []
    size = raw.pixel if pixel is None else lengths.pixel_size(pixel)
    if pixel is None and raw.doubt:
        raw.warnings.append(raw.doubt)
    for axis, (dim, along) in raw.uneven.items():
        if size is None or pixel is None or not _agree(along, size[axis]):
            near = (
                ""
                if pixel is not None
                else "; places within half a pixel are taken if pixel (--pixel) is given"
            )
            raise SceneError(f"{called}: {declared.uneven(dim, along)}{near}")
    if pixel is not None and size is not None:
        raw.warnings += _against_steps(called, raw, pixel, size)
    if size is None or (pixel is None and raw.unsaid):
        missing.append("how large its pixels are" + (f" ({raw.unsaid})" if raw.unsaid else ""))
        advice.append('pixel="10 nm"')
    scale = _scale(called, raw, *heights)
    if scale is None:
        missing.append("in which unit its heights are")
        advice.append('height_unit="nm"')
    if missing or size is None or scale is None:
        raise SceneError(
            f"{called}: does not say {', nor '.join(missing)}; give {' and '.join(advice)}"
            if raw.assumed is None
            else f"pixel: an array does not say {missing[0]}; give {advice[0]}"
        )
    return size, scale


def _against_steps(called: str, raw: Raw, pixel: Any, size: tuple[float, float]) -> list[str]:
    """What a pixel of a size, m, that is given has against the steps of the source."""
    stated = raw.steps
    if stated is None and raw.pixel is not None and not raw.doubt:
        stated = lengths.Steps(*raw.pixel, unit="m")
    if stated is not None:
        with _blamed(called):
            stated.refuse_single(pixel, size)
    if raw.pixel is not None:
        return [] if np.allclose(size, raw.pixel, rtol=_ALIKE, atol=0.0) else [_other_pixel(size, raw)]
    said = None if raw.steps is None else raw.steps.disagreement(size)
    return [said] if said else []


def _agree(places: Any, size: float) -> bool:
    """Whether each place, m, is within half a pixel of where pixels of a size have it."""
    off = np.abs(places - places[0]) - size * np.arange(places.size)
    return bool(np.all(np.abs(off) < 0.5 * size))


def _other_pixel(given: tuple[float, float], raw: Raw) -> str:
    """That a pixel is given other than the source says, above all where it is the whole scan."""
    assert raw.pixel is not None
    rows, columns = raw.heights.shape
    shown = [" x ".join(quantities.si(one, "m") for one in size) for size in (given, raw.pixel)]
    scan = (raw.pixel[0] * columns, raw.pixel[1] * rows)
    if any(abs(one / whole - 1.0) < 1e-2 for one, whole in zip(given, scan, strict=True)):
        return f"pixel is {shown[0]}, which is the whole scan: one of its {columns} x {rows} pixels is {shown[1]}"
    return f"pixel is {shown[0]}, and the map says {shown[1]}: taken as pixel says"


def _scale(called: str, raw: Raw, height_unit: Any, factor: Any) -> float | None:
    """What the heights are to be multiplied by for m; None if nothing says it."""
    given = None if height_unit is None else _unit(height_unit)
    by = lengths.Factor(1.0) if factor is None else lengths.factor(factor)
    stated = None if raw.unit is None else lengths.metres(raw.unit)
    if by.is_length:
        if given is not None:
            raise SceneError(
                f"factor = {factor!r} is a length, and height_unit = {height_unit!r}, too; give one"
            )
        if stated is not None or (by.per and raw.unit and by.per.lower() != raw.unit.lower()):
            raise SceneError(f"factor = {factor!r}: {called} has its heights in {raw.unit}")
        return by.scale
    if raw.fixed and given is not None and not np.isclose(given, stated or np.nan, rtol=1e-12, atol=0.0):
        # The numbers of a pint quantity were converted to m by their own unit.
        return by.scale * (stated or 1.0)
    if raw.unit is not None and stated is None and factor is None:
        raise SceneError(
            f"{called}: its heights are in {raw.unit}, which is no unit of length; give factor, such as "
            f'factor="0.5 nm/{raw.unit}", or factor=1 and height_unit="nm"'
        )
    if given is None:
        known = stated if raw.unit is not None else lengths.metres(raw.assumed or "")
        return None if known is None else by.scale * known
    if stated is not None and not np.isclose(given, stated, rtol=1e-9, atol=0.0):
        raw.warnings.append(
            f"height_unit is {height_unit}, and the map says {raw.unit}: taken as height_unit says"
        )
    return by.scale * given


def _unit(height_unit: Any) -> float:
    """A unit of heights in m: its name, a length such as ``"0.5 nm"``, or a unit of pint."""
    if isinstance(height_unit, np.ndarray | list | tuple) and np.size(height_unit) == 1:
        height_unit = np.ravel(np.asarray(height_unit))[0]
    unit = height_unit.decode() if isinstance(height_unit, bytes) else str(height_unit).strip()
    known = lengths.metres(unit)
    if known is not None:
        return known
    if unit[:1].isdigit() or quantities.is_pint(height_unit):
        return lengths.length("height_unit", height_unit)
    raise SceneError(f"height_unit = {height_unit!r}: a unit of length is needed, such as nm, um or angstrom")


def _check_heights(called: str, heights: NDArray[np.float64]) -> None:
    infinite = int(np.count_nonzero(np.isinf(heights)))
    if infinite:
        row, column = (int(one) for one in np.argwhere(np.isinf(heights))[0])
        raise SceneError(
            f"{called}: {infinite} of its heights are infinite, the first in row {row}, column {column}; "
            "NaN is missing"
        )
    if np.isnan(heights).all():
        raise SceneError(f"{called}: 0 of {heights.size} heights are known")


def _marked(heights: Any) -> list[str]:
    """That a number that files have where there is no height is among the heights, far from the others."""
    for sentinel in (float(np.nanmin(heights)), float(np.nanmax(heights))):
        if not np.any(np.isclose(sentinel, _SENTINELS, rtol=1e-6, atol=0.0)):
            continue
        others = heights[np.isfinite(heights) & (heights != sentinel)]
        if others.size and np.ptp(others) < 0.1 * np.abs(others - sentinel).min():
            count = int(np.count_nonzero(heights == sentinel))
            return [
                f"{count} of the heights are {sentinel:g}, as files mark missing ones: leave them out by mask"
            ]
    return []


def _whole_scan(heights: NDArray[np.float64], pixel: tuple[float, float], raw: Raw) -> list[str]:
    """That the surface is flatter than any, as with a pixel that is the whole scan."""
    if raw.pixel is not None or max(pixel) < _SHORTEST_SCAN:
        return []
    squares = [
        np.square(np.diff(heights, 2, axis=axis) / size**2) for axis, size in ((1, pixel[0]), (0, pixel[1]))
    ]
    known = [float(np.nanmean(square)) for square in squares if np.isfinite(square).any()]
    bend = float(np.sqrt(np.mean(known))) if known else 0.0
    rounding = 1e-12 * float(np.nanmax(np.abs(heights))) / min(pixel) ** 2
    if not rounding < bend < 1.0 / _FLATTEST:
        return []
    columns = heights.shape[1]
    shown = quantities.si(pixel[0], "m")
    return [
        f"with a pixel of {shown} summits have radii of {quantities.si(1.0 / bend, 'm', 2)}, as on no rough "
        f"surface: if {shown} is the whole scan, the pixel is {quantities.si(pixel[0] / columns, 'm')}"
    ]
