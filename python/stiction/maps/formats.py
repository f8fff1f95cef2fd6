"""Files that hold height maps, each read by the library of its format."""

from __future__ import annotations

import importlib
import re
import shutil
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import h5py
import numpy as np
import xarray
from scipy import io

from .. import files, quantities, stored, tables
from ..errors import SceneError, StictionError
from . import text
from .channels import named, numbered
from .lengths import Steps, metres

__all__ = [
    "MOST_PIXELS",
    "Raw",
    "from_array",
    "from_data_array",
    "from_path",
    "from_pint",
    "from_topography",
    "uneven",
]

# Most pixels of a map that is read.
MOST_PIXELS = 1 << 26
# Bytes that a compressed file may unpack to.
_MOST_BYTES = 1 << 32
_TEXT_OF_INSTRUMENTS = re.compile(
    r"\A\s*aISO-|Wyko ASCII Data File|File Format\s*=\s*ASCII|^\s*Unit Data\s*=", re.MULTILINE
)
# Formats of SurfaceTopography that fit any bytes.
_WITHOUT_MARK = {"hgt", "nms"}
# Files that are texts, and nothing else.
_TEXTS = {"", ".txt", ".csv", ".tsv", ".asc", ".dat", ".xyz"}
_WORKBOOKS = {".xlsx", ".xlsm", ".xlsb", ".xls", ".ods"}
# What unpacks files with these first bytes.
_PACKED = {b"\x1f\x8b": "gzip", b"BZh": "bz2", b"\xfd7zXZ": "lzma"}
# Characters in which the beginnings of files stand.
_BEGINNING = 1 << 12
# Pixels of images, m: a resolution for printing makes larger ones.
_LARGEST_OF_IMAGES = 1e-5
_PARK, _NODATA = 50432, 42113


@dataclass
class Raw:
    """What a source says of a map.

    `heights` are over y and x, NaN where they are missing, in `unit`; `pixel` is (width, height) in m. `assumed`
    is the unit of heights that come without one, `unsaid` why a pixel has to be given, `doubt` why the one here may
    be wrong, and `fixed` that the unit belongs to the numbers. `steps` are of places without a unit. `uneven` has names and places, m, of coordinates that
    are not even: under 0 of those along the width of a pixel, under 1 along its height.
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


def from_path(path: Path, channel: str | None) -> Raw:
    """The map of a file, by its first bytes.

    Raises
    ------
    SceneError
        It cannot be read, or has several maps of which none is named; the message begins with the path.
    """
    if not path.is_file():
        raise SceneError(f"{path}: {'is a folder; name a file in it' if path.is_dir() else 'no such file'}")
    with _blamed(path), _unpacked(path) as plain:
        with plain.open("rb") as file:
            beginning = file.read(_BEGINNING)
        return _reader(plain, beginning)(plain, channel)


def _reader(path: Path, beginning: bytes) -> Callable[[Path, str | None], Raw]:
    """What reads a file, by its first bytes."""
    suffix = path.suffix.lower()
    if not beginning:
        raise SceneError("is empty")
    if what := tables.no_numbers(beginning):
        raise SceneError(what)
    if suffix in _WORKBOOKS and beginning.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0")):
        raise SceneError("is a workbook; save the sheet as CSV")
    if beginning.startswith(b"\x93NUMPY"):
        return _numpy_array
    if suffix == ".npz":
        return _numpy_archive
    if h5py.is_hdf5(path) and suffix != ".datx":
        return _hdf5
    # Version 4 has no mark: it begins with a small number of four bytes.
    if beginning.startswith(b"MATLAB 5.0") or (suffix == ".mat" and 0 in beginning[:4]):
        return _matlab
    if beginning.startswith(b"CDF"):
        return _netcdf3
    if beginning[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+") and suffix in (".tif", ".tiff"):
        return _tiff
    return _text_or_instrument


@contextmanager
def _blamed(path: Path) -> Iterator[None]:
    """Blames what goes wrong in a block on a file, in one line."""
    try:
        yield
    except StictionError as error:
        said = str(error)
        raise SceneError(said if said.startswith(str(path)) else f"{path}: {said}") from None
    except MemoryError:
        raise SceneError(f"{path}: is too large for the memory of this computer") from None
    except Exception as error:
        said = " ".join(str(error).split())[:200] or type(error).__name__
        raise SceneError(f"{path}: is damaged, or no map: {said}") from error


@contextmanager
def _unpacked(path: Path) -> Iterator[Path]:
    """The file itself, or what a packed file has inside, in a folder of its own."""
    with path.open("rb") as file:
        beginning = file.read(6)
    packer = next((name for mark, name in _PACKED.items() if beginning.startswith(mark)), None)
    if packer is not None:
        inside = path.stem if path.suffix.lower() in (".gz", ".bz2", ".xz") else path.name
        with files.Folder() as folder, importlib.import_module(packer).open(path, "rb") as packed:
            yield _copied(packed, folder / inside)
    elif beginning[:4] == b"PK\x03\x04" and path.suffix.lower() == ".zip":
        with files.Folder() as folder, zipfile.ZipFile(path) as archive:
            names = [
                info for info in archive.infolist() if not info.is_dir() and "__MACOSX" not in info.filename
            ]
            if len(names) != 1:
                listed = ", ".join(info.filename for info in names[:12])
                raise SceneError(f"holds {len(names)} files, of which one has to be unpacked: {listed}")
            with archive.open(names[0]) as packed:
                yield _copied(packed, folder / Path(names[0].filename).name)
    else:
        yield path


def _copied(packed: Any, target: Path) -> Path:
    with target.open("wb") as file:
        shutil.copyfileobj(_Limited(packed), file)
    return target


class _Limited:
    """A file that ends with an error where it is longer than what is unpacked."""

    def __init__(self, file: BinaryIO) -> None:
        self.file, self.left = file, _MOST_BYTES

    def read(self, size: int = -1, /) -> bytes:
        block = self.file.read(size)
        self.left -= len(block)
        if self.left < 0:
            raise SceneError(f"unpacks to more than {_MOST_BYTES >> 30} GB")
        return block


def _within(shape: tuple[int, ...]) -> None:
    if np.prod([float(length) for length in shape]) > MOST_PIXELS:
        sizes = " x ".join(str(length) for length in shape)
        raise SceneError(f"has {sizes} pixels, and {MOST_PIXELS} can be read here; cut or coarsen it")


def _numpy_array(path: Path, channel: str | None) -> Raw:
    _no_channel(channel)
    mapped = np.load(path, mmap_mode="r", allow_pickle=False)
    _within(mapped.shape)
    return from_array("its array", np.array(mapped))


def _numpy_archive(path: Path, channel: str | None) -> Raw:
    with np.load(path, allow_pickle=False) as archive:
        return _one_of(channel, _shapes(archive), archive.__getitem__)


def _shapes(archive: Any) -> dict[str, tuple[int, ...]]:
    """The shapes of the arrays of an archive of NumPy, by their names."""
    shapes = {}
    for name in (name for name in archive.files if f"{name}.npy" in archive.zip.namelist()):
        with archive.zip.open(f"{name}.npy") as file:
            version = np.lib.format.read_magic(file)
            of = np.lib.format
            header = of.read_array_header_1_0 if version == (1, 0) else of.read_array_header_2_0
            shapes[name] = header(file)[0]
    return shapes


def _matlab(path: Path, channel: str | None) -> Raw:
    """A variable of MATLAB, up to version 7.2; later ones are in HDF5."""
    number = re.compile(r"double|single|logical|u?int\d+")
    shapes = {name: shape for name, shape, kind in io.whosmat(path) if number.fullmatch(kind)}
    return _one_of(channel, shapes, lambda name: io.loadmat(path, variable_names=[name])[name])


def _one_of(channel: str | None, shapes: dict[str, tuple[int, ...]], load: Callable[[str], Any]) -> Raw:
    """The array of a name or number, or the only one of two dimensions, of arrays of some shapes."""
    maps = [name for name, shape in shapes.items() if _has_two(shape)] or list(shapes)
    name = channel if channel in shapes else named(channel, maps, "array")
    _within(shapes[name])
    raw = from_array(f"its array {name}", load(name))
    raw.channel = name
    others = ", ".join(other for other in shapes if other != name)
    if channel is None and others:
        raw.warnings.append(f"of its arrays {name} is read; there are {others}, too")
        raw.unsaid = f"its arrays {others} have no units"
    return raw


def _has_two(shape: tuple[int, ...]) -> bool:
    """Whether a shape has two dimensions, but for ones of length 1."""
    return sum(length > 1 for length in shape) == 2


def _no_channel(channel: str | None) -> None:
    if channel is not None:
        raise SceneError(f"channel = {channel!r}: this file has a single map, without a name")


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


def _hdf5(path: Path, channel: str | None) -> Raw:
    """A dataset of HDF5 or netCDF4, which xarray reads by the conventions of CF."""
    with h5py.File(path, "r") as file:
        name = _dataset(file, channel)
        stored.check_dataset(path, name, file[name])
        _within(file[name].shape)
        group, _, leaf = name.rpartition("/")
        others = [
            other
            for other in file[group or "/"]
            if other != leaf and not _is_coordinate(path, file[group or "/"], other)
        ]
    with xarray.open_dataset(
        path,
        group=group or "/",
        engine="h5netcdf",
        phony_dims="access",
        decode_times=False,
        drop_variables=others,
    ) as opened:
        raw = from_data_array(name, _placed(opened, leaf))
    raw.channel = name
    return raw


def _dataset(file: h5py.File, channel: str | None) -> str:
    """The path of a dataset in a file: one of two dimensions in the root, or in any group."""
    found: list[str] = []
    file.visititems(lambda name, item: found.append(name) if _is_map(item) else None)
    if channel is None or channel.isdecimal():
        return named(channel, [name for name in found if "/" not in name] or found, "dataset")
    name = channel.strip("/")
    link = file.get(name, getlink=True) if name in file else None
    if isinstance(link, h5py.HardLink) and isinstance(file[name], h5py.Dataset):
        return name
    return named(channel, found, "dataset")


def _is_map(item: Any) -> bool:
    if not isinstance(item, h5py.Dataset) or item.shape is None:
        return False
    return _has_two(item.shape) and item.dtype.kind in "iuf"


def _is_coordinate(path: Path, group: h5py.Group, name: str) -> bool:
    """Whether a dataset may say where pixels are."""
    if not isinstance(group.get(name, getlink=True), h5py.HardLink) or not isinstance(
        group[name], h5py.Dataset
    ):
        return False
    item = group[name]
    if item.shape is None or len(item.shape) != 1 or item.dtype.kind not in "iuf":
        return False
    stored.check_dataset(path, name, item)
    return True


def _netcdf3(path: Path, channel: str | None) -> Raw:
    with xarray.open_dataset(path, engine="scipy", decode_times=False) as opened:
        if "heights" in opened and "length" in opened.variables.get("x", xarray.Variable((), 0)).attrs:
            return _instrument(path, channel)
        name = named(
            channel,
            [str(name) for name, one in opened.data_vars.items() if one.squeeze().ndim == 2],
            "variable",
        )
        _within(opened[name].shape)
        raw = from_data_array(name, _placed(opened, name))
    raw.channel = name
    return raw


def _placed(opened: xarray.Dataset, name: str) -> xarray.DataArray:
    """A variable, and x and y of its file where they are no coordinates of it but as long as its sides.

    MATLAB has its columns first in HDF5.
    """
    array = opened[name].load().squeeze()
    if "MATLAB_class" in array.attrs:
        array = array.transpose()
    x, y = (opened.variables.get(axis) for axis in "xy")
    if x is None or y is None or array.ndim != 2 or any(dim in array.coords for dim in array.dims):
        return array
    if x.dims != y.dims and (*x.dims, *y.dims) == array.dims:
        array = array.transpose()
    if (*y.shape, *x.shape) != array.shape:
        return array
    places = {axis: (axis, one.values, one.attrs) for axis, one in (("y", y), ("x", x))}
    return xarray.DataArray(array.values, dims=("y", "x"), coords=places, attrs=array.attrs)


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
    magnitudes = array.data if quantities.is_pint(array.data) else None
    raw = from_pint(name, magnitudes) if magnitudes is not None else from_array(name, array.values)
    raw.unit = raw.unit or _unit(array.attrs)
    for limit, sign in zip(_limits(array.attrs), (1.0, -1.0), strict=True):
        if limit is not None and "dtype" in array.encoding:
            raw.heights = np.where(_is_below(sign, raw.heights, limit, array.encoding), np.nan, raw.heights)
    if array.ndim != 2:
        return raw
    sizes: list[float] = []
    for dim in array.dims:
        _check_spacing(name, array.coords.get(dim))
    coordinates = [(dim, array.coords.get(dim)) for dim in reversed(array.dims)]
    raw.steps = _steps([coordinate for _, coordinate in coordinates])
    for dim, coordinate in coordinates:
        if coordinate is None or coordinate.size < 2 or coordinate.dtype.kind not in "iuf":
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


def _unitless(coordinate: xarray.DataArray | None) -> Any:
    """The places of a coordinate without a unit of length; None if it has one, or there are none."""
    if coordinate is None or coordinate.size < 2 or coordinate.dtype.kind not in "iuf":
        return None
    return coordinate.values.astype(float) if metres(_unit(coordinate.attrs) or "") is None else None


def _check_spacing(name: str, coordinate: xarray.DataArray | None) -> None:
    """Refuses a coordinate without a unit of length that is off even places by half a step or more."""
    places = _unitless(coordinate)
    if places is None or _is_even(places):
        return
    step = float(np.median(np.diff(places)))
    if not np.all(np.abs(places - places[0] - step * np.arange(places.size)) < 0.5 * abs(step)):
        assert coordinate is not None
        raise SceneError(f"{name}: {uneven(coordinate.name, places)}")


def _steps(coordinates: list[xarray.DataArray | None]) -> Steps | None:
    """The steps of two coordinates that are even and have no unit of length; None if they are others."""
    places = [_unitless(one) for one in coordinates]
    if any(one is None or not _is_even(one) for one in places):
        return None
    width, height = (float(abs(one[-1] - one[0]) / (one.size - 1)) for one in places)
    units = {_unit(one.attrs) for one in coordinates if one is not None}
    return Steps(width, height, units.pop()) if len(units) == 1 else None


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


def from_pint(name: str, values: Any) -> Raw:
    """A pint quantity as a map: a length in m, or what it is in its own unit."""
    if values.is_compatible_with("meter"):
        raw = from_array(name, values.to("meter").magnitude)
        raw.unit, raw.fixed = "m", True
    else:
        raw = from_array(name, values.magnitude)
        raw.unit = f"{values.units:~}" or None
    return raw


def _tiff(path: Path, channel: str | None) -> Raw:
    tifffile = extra("tifffile")
    with tifffile.TiffFile(path) as file:
        if _PARK in file.pages[0].tags:
            return _instrument(path, channel)
        names = [f"page {number}" for number in range(len(file.pages))]
        page = file.pages[numbered(channel, names, "page")]
        if len(page.shape) != 2:
            sizes = " x ".join(str(length) for length in page.shape)
            raise SceneError(
                f"is a picture of {sizes} values, as colours are; heights are one number per pixel"
            )
        _within(page.shape)
        raw = from_array("its page", page.asarray())
        missing = page.tags.get(_NODATA)
        if missing is not None:
            raw.heights[raw.heights == float(str(missing.value).strip("\0 "))] = np.nan
        raw.pixel = _pixel_of_page(page, (file.imagej_metadata or {}).get("unit"))
    raw.channel = f"page {page.index}"
    return raw


def _pixel_of_page(page: Any, unit: str | None) -> tuple[float, float] | None:
    """The pixel by the tags of resolution, in the unit of ImageJ, or in inches or centimetres."""
    tags = page.tags
    if "XResolution" not in tags or "YResolution" not in tags:
        return None
    scale = metres(str(unit).encode().decode("unicode_escape")) if unit else None
    if scale is None:
        scale = {2: 0.0254, 3: 0.01}.get(int(tags["ResolutionUnit"].value) if "ResolutionUnit" in tags else 1)
    sizes = []
    for name in ("XResolution", "YResolution"):
        numerator, denominator = tags[name].value
        if scale is None or numerator == 0 or scale * denominator / numerator > _LARGEST_OF_IMAGES:
            return None
        sizes.append(scale * denominator / numerator)
    return sizes[0], sizes[1]


def extra(module: str) -> Any:
    """A library of the extra for maps.

    Raises
    ------
    SceneError
        It is not installed.
    """
    try:
        return __import__(module)
    except ImportError:
        raise SceneError(f"{module} is needed to read it: `pip install stiction[maps]`") from None


def _text_or_instrument(path: Path, channel: str | None) -> Raw:
    data = path.read_bytes() if path.stat().st_size <= _MOST_BYTES else b"\0"
    content = tables.decoded(data, any_bytes=True)
    if content is None:
        return _instrument(path, channel)
    if _TEXT_OF_INSTRUMENTS.search(content[:_BEGINNING]):
        if content.lstrip().startswith("aISO-") and "," in content:
            content = content.replace(",", ".")
        with files.Folder() as folder:
            copy = folder / path.name
            copy.write_text(content, encoding="utf-8")
            return _instrument(copy, channel)
    try:
        found = text.read(content, channel)
    except text.NoNumbers:
        if path.suffix.lower() in _TEXTS:
            raise
        return _instrument(path, channel)
    return Raw(
        found.heights, found.pixel, found.unit, found.channel or "", unsaid=found.unsaid, doubt=found.doubt,
        steps=found.steps, warnings=found.warnings,
    )  # fmt: skip


def _instrument(path: Path, channel: str | None) -> Raw:
    """A file of an instrument, as SurfaceTopography reads it."""
    library = extra("SurfaceTopography")
    try:
        reader = library.open_topography(str(path))
    except Exception as error:
        unknown = type(error).__name__ == "CannotDetectFileFormat"
        said = "none of its formats" if unknown else " ".join(str(error).split())[:200] or repr(error)
        raise SceneError(f"SurfaceTopography cannot read it: {said}") from error
    if reader.format() in _WITHOUT_MARK and path.suffix.lower() != f".{reader.format()}":
        raise SceneError("SurfaceTopography cannot read it: none of its formats")
    with reader:
        channels = list(reader.channels)
        # Channels whose data have no unit that is known have two of them, the other one of lengths.
        heights = [one for one in channels if one.is_height_channel and not isinstance(one.unit, tuple)]
        names = [one.channel_id for one in channels]
        if channel is not None:
            return _of_channel(channels[numbered(channel, names, "channel")])
        default = reader.default_channel.index
        one = next((one for one in heights if one.index == default), (heights or channels)[0])
        raw = _of_channel(one)
        others = ", ".join(other.channel_id for other in heights if other.index != one.index)
        if others:
            raw.warnings.append(
                f"of its heights the channel {one.channel_id} is read; there are {others}, too"
            )
        return raw


def _of_channel(channel: Any) -> Raw:
    """The map of a channel of SurfaceTopography."""
    # A size is needed to ask for the heights of a file that does not say it.
    unknown = channel.physical_sizes is None
    raw = from_topography(
        "its map", channel.topography(physical_sizes=channel.nb_grid_pts if unknown else None)
    )
    raw.channel, raw.pixel, raw.unsaid = channel.channel_id, None, ""
    if isinstance(channel.unit, tuple):
        lateral, raw.unit = channel.unit
    else:
        lateral = channel.unit
        raw.unit = lateral if channel.is_height_channel else channel.data_unit
    scale = metres(str(lateral))
    if scale is not None and not unknown:
        raw.pixel = _pixel(channel, scale)
    return raw


def from_topography(name: str, topography: Any) -> Raw:
    """A topography of SurfaceTopography, whose first index is x.

    Raises
    ------
    SceneError
        It is a line scan with uneven steps.
    """
    if not topography.is_uniform:
        raise SceneError(f"{name}: is a line scan with uneven steps; only even ones are read")
    raw = from_array(name, topography.heights().T)
    raw.unit = topography.unit
    scale = metres(str(raw.unit))
    if scale is not None:
        raw.pixel = _pixel(topography, scale)
    elif raw.unit is None:
        raw.unsaid = "the topography has no unit"
    return raw


def _pixel(of: Any, scale: float) -> tuple[float, float]:
    """Width and height of a pixel, m; a line scan has the steps for both."""
    sizes = np.atleast_1d(np.asarray(of.pixel_size, dtype=float)) * scale
    return float(sizes[0]), float(sizes[-1])
