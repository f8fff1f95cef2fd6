"""Files that hold height maps, each read by the library of its format."""

from __future__ import annotations

import importlib
import re
import shutil
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO
from xml.etree import ElementTree

import h5py
import numpy as np
import xarray
from scipy import io

from .. import files, stored, texts
from ..errors import SceneError, StictionError
from . import text
from .channels import named, numbered
from .declared import Raw, attributes, axis_of, from_array, from_data_array, grid, placed
from .lengths import metres

__all__ = ["MOST_PIXELS", "from_path", "from_topography"]

# Most pixels of a map that is read.
MOST_PIXELS = 1 << 26
# Bytes that a compressed file may unpack to.
_MOST_BYTES = 1 << 32
_TEXT_OF_INSTRUMENTS = re.compile(
    r"\A\s*aISO-|Wyko ASCII Data File|File Format\s*=\s*ASCII|^\s*Unit Data\s*=", re.MULTILINE
)
# Formats of SurfaceTopography that fit any bytes.
_WITHOUT_MARK = {"hgt", "nms"}
# Formats that nothing here reads, by their first bytes, and what would do.
_OTHERS = {
    b"Gwyddion Simple Field": "is a Gwyddion Simple Field, which is not read: open it in Gwyddion and save it as .gwy",
    b"DSCOMPRESSED": "is a compressed surface of Digital Surf, which is not read: save it without compression, or as "
    ".gwy by Gwyddion",
    b":NANONIS_VERSION:": "is a scan of Nanonis, which is not read: open it in Gwyddion and save it as .gwy",
}
# Files that are texts, and nothing else.
_TEXTS = {"", ".txt", ".csv", ".tsv", ".asc", ".dat", ".xyz"}
_WORKBOOKS = {".xlsx", ".xlsm", ".xlsb", ".xls", ".ods"}
# What unpacks files with these first bytes.
_PACKED = {b"\x1f\x8b": "gzip", b"BZh": "bz2", b"\xfd7zXZ": "lzma"}
# Characters in which the beginnings of files stand.
_BEGINNING = 1 << 12
# Pixels of images, m: a resolution for printing makes larger ones.
_LARGEST_OF_IMAGES = 1e-5
_PARK, _NODATA, _GDAL, _SCALE = 50432, 42113, 42112, 33550
# What the numbers of pictures are, by their PhotometricInterpretation, and what would do.
_PICTURES = {
    0: "its numbers fall where it is brighter (MinIsWhite)",
    3: "its numbers are places in a palette of colours",
}
_GREY = "save heights as grey values that rise where it is brighter (MinIsBlack), or as a text"
# Attributes of CF by the roles that GDAL has for them.
_ROLES = {"scale": "scale_factor", "offset": "add_offset", "unittype": "units"}


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
    if what := texts.no_numbers(beginning):
        raise SceneError(what)
    for mark, what in _OTHERS.items():
        if beginning.startswith(mark):
            raise SceneError(what)
    if suffix == ".nms":
        raise SceneError(
            "is a map of NanoFocus, whose pixels SurfaceTopography reads in a wrong unit: export it as .sdf or as text"
        )
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
    """The file itself, or what a packed file has inside, in a separate folder."""
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
    maps = _no_places([name for name, shape in shapes.items() if _has_two(shape)]) or list(shapes)
    name = channel if channel in shapes else named(channel, maps, "array")
    _within(shapes[name])
    nearby = {
        other: xarray.Variable([f"{other} {axis}" for axis in range(len(shape))], load(other))
        for other, shape in shapes.items()
        if other != name and axis_of(other) and 0 < np.prod(shape) <= np.prod(shapes[name])
    }
    raw = from_data_array(f"its array {name}", placed(xarray.DataArray(load(name)).squeeze(), nearby))
    raw.channel = name
    others = ", ".join(other for other in shapes if other != name)
    if channel is None and others:
        raw.warnings.append(f"of its arrays {name} is read; there are {others}, too")
        raw.unsaid = raw.unsaid or f"its arrays {others} have no units"
    return raw


def _has_two(shape: tuple[int, ...]) -> bool:
    """Whether a shape has two dimensions, but for ones of length 1."""
    return sum(length > 1 for length in shape) == 2


def _no_places(names: list[str]) -> list[str]:
    """Names of arrays that are not named after places x and y; all, if nothing else is there."""
    return [name for name in names if axis_of(name.rpartition("/")[2]) is None] or names


def _no_channel(channel: str | None) -> None:
    if channel is not None:
        raise SceneError(f"channel = {channel!r}: this file has a single map, without a name")


def _hdf5(path: Path, channel: str | None) -> Raw:
    """A dataset of HDF5 or netCDF4, which are read by h5py: attributes may be references, which xarray refuses."""
    with h5py.File(path, "r") as file:
        name = _dataset(file, channel)
        group, _, leaf = name.rpartition("/")
        nearby = {
            other: _variable(path, file[group or "/"][other])
            for other in file[group or "/"]
            if other != leaf and axis_of(other) and _is_numbers(file[group or "/"], other)
        }
        raw = from_data_array(name, placed(_with_axes(path, file[name]), nearby))
        raw.pixel = raw.pixel or _topostats(file, raw)
    raw.channel = name
    return raw


def _variable(path: Path, item: h5py.Dataset) -> xarray.Variable:
    """A dataset with its dimensions, by the names of their scales, and the attributes that can be read.

    MATLAB has its columns first in HDF5.
    """
    stored.check_dataset(path, item.name, item)
    _within(item.shape)
    dims = [
        axis[0].name.rpartition("/")[2] if len(axis) else f"{item.name} {place}"
        for place, axis in enumerate(item.dims)
    ]
    variable = xarray.Variable(dims, item[()], attributes(item.attrs), {"dtype": item.dtype})
    return variable.transpose() if "MATLAB_class" in item.attrs else variable


def _with_axes(path: Path, item: h5py.Dataset) -> xarray.DataArray:
    """A dataset with the coordinates that its scales of dimensions are, or that the axes of NeXus name."""
    variable = _variable(path, item)
    array = xarray.DataArray(variable)
    array.encoding = variable.encoding
    names = _texts(item.attrs.get("axes", item.parent.attrs.get("axes")))
    names = names if len(names) == array.ndim else [""] * array.ndim
    for dim, axis, name in zip(array.dims, item.dims, names, strict=True):
        group, leaf = (axis[0].parent, axis[0].name.rpartition("/")[2]) if len(axis) else (item.parent, name)
        if leaf and _is_numbers(group, leaf) and group[leaf].shape == (array.sizes[dim],):
            one = _variable(path, group[leaf])
            array = array.assign_coords({dim: (dim, one.values, one.attrs)})
    return array.squeeze()


def _texts(given: Any) -> list[str]:
    """The names of an attribute, which are an array, or one text with colons between them."""
    names = [one.decode() if isinstance(one, bytes) else str(one) for one in np.ravel(np.asarray(given))]
    return re.split(r"[:,]", names[0].strip("[]")) if len(names) == 1 else names


def _topostats(file: h5py.File, raw: Raw) -> tuple[float, float] | None:
    """The pixel that TopoStats writes as a number of nm next to its image, whose heights are in nm."""
    if "topostats_file_version" not in file or "pixel_to_nm_scaling" not in file:
        return None
    size = 1e-9 * float(file["pixel_to_nm_scaling"][()])
    raw.unit = raw.unit or "nm"
    return size, size


def _dataset(file: h5py.File, channel: str | None) -> str:
    """The path of a dataset in a file: one of two dimensions in the root, or in any group."""
    found: list[str] = []
    file.visititems(lambda name, item: found.append(name) if _is_map(item) else None)
    found = _no_places(found)
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


def _is_numbers(group: h5py.Group, name: str) -> bool:
    """Whether a name is that of a dataset of numbers in this file; netCDF has dimensions without any, too."""
    if not isinstance(group.get(name, getlink=True), h5py.HardLink):
        return False
    item = group[name]
    if not isinstance(item, h5py.Dataset) or item.shape is None or item.dtype.kind not in "iuf":
        return False
    return "This is a netCDF dimension but not" not in str(item.attrs.get("NAME"))


def _netcdf3(path: Path, channel: str | None) -> Raw:
    with xarray.open_dataset(path, engine="scipy", decode_cf=False) as opened:
        if "heights" in opened and "length" in opened.variables.get("x", xarray.Variable((), 0)).attrs:
            return _instrument(path, channel)
        name = named(
            channel,
            [str(name) for name, one in opened.data_vars.items() if one.squeeze().ndim == 2],
            "variable",
        )
        _within(opened[name].shape)
        raw = from_data_array(
            name,
            placed(opened[name].load().squeeze(), {str(one): of for one, of in opened.variables.items()}),
        )
    raw.channel = name
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
        if (kind := int(page.tags["PhotometricInterpretation"].value)) != 1:
            raise SceneError(f"is a picture: {_PICTURES.get(kind, 'its numbers are colours')}; {_GREY}")
        raw = from_data_array("its page", _page(file, page))
    raw.channel = f"page {page.index}"
    return raw


def _page(file: Any, page: Any) -> xarray.DataArray:
    """The numbers of a page with what GDAL, ImageJ and OME declare of them."""
    ours = file.imagej_metadata or {}
    attrs = _gdal(page) | _imagej(ours)
    steps, unit = _ome(file) or _pixel_of_page(page, ours.get("unit"))
    return grid(page.asarray(), attrs, steps, unit)


def _gdal(page: Any) -> dict[str, Any]:
    """Scale, offset, unit and missing number of a page, as attributes of CF."""
    attrs: dict[str, Any] = {}
    if _NODATA in page.tags:
        attrs["missing_value"] = str(page.tags[_NODATA].value).strip("\0 ")
    if _GDAL in page.tags:
        for item in ElementTree.fromstring(str(page.tags[_GDAL].value).strip("\0 ")).iter("Item"):
            role = item.get("role", item.get("name", "")).lower()
            if role in _ROLES and item.get("sample", "0") == "0":
                attrs[_ROLES[role]] = (item.text or "").strip()
    return attrs


def _imagej(ours: dict[str, Any]) -> dict[str, Any]:
    """The straight line and the unit of ImageJ's calibration, as attributes of CF."""
    if "c0" not in ours:
        return {}
    if int(ours.get("cf", 0)) != 0:
        raise SceneError(
            f"its calibration by ImageJ (cf={ours['cf']}) is no straight line; apply it there and save 32-bit numbers"
        )
    unit = str(ours.get("vunit", "")).strip()
    named = {} if unit.lower() in ("", "gray value", "pixel", "pixels") else {"units": _unescaped(unit)}
    return {"scale_factor": ours.get("c1", 1.0), "add_offset": ours["c0"]} | named


def _ome(file: Any) -> tuple[tuple[float, float], str] | None:
    """The steps of pixels by OME, and their unit; of images with other pixels none."""
    if not file.ome_metadata:
        return None
    found = set()
    for one in (
        one for one in ElementTree.fromstring(file.ome_metadata).iter() if one.tag.endswith("}Pixels")
    ):
        units = [metres(one.get(f"PhysicalSize{axis}Unit", "\u00b5m")) for axis in "XY"]
        x, y = (
            float(one.get(f"PhysicalSize{axis}", "nan")) * (unit or np.nan)
            for axis, unit in zip("XY", units, strict=True)
        )
        found.add((x, y))
    (x, y), *others = found or {(np.nan, np.nan)}
    return ((x, y), "m") if x > 0.0 and y > 0.0 and not others else None


def _unescaped(unit: str) -> str:
    """A unit of ImageJ, which writes other characters than ASCII as escapes."""
    return unit.encode("ascii", "backslashreplace").decode("unicode_escape")


def _pixel_of_page(page: Any, unit: str | None) -> tuple[tuple[float, float] | None, str | None]:
    """The steps of pixels and their unit, by the tags of GeoTIFF, which have none, or of resolution.

    A resolution is in the unit of ImageJ, or in inches or centimetres; one without a unit counts where pixels are not
    square.
    """
    tags = page.tags
    if _SCALE in tags:
        return tuple(tags[_SCALE].value[:2]), None
    if "XResolution" not in tags or "YResolution" not in tags:
        return None, None
    scale = metres(_unescaped(str(unit))) if unit else None
    if scale is None:
        scale = {2: 0.0254, 3: 0.01}.get(int(tags["ResolutionUnit"].value) if "ResolutionUnit" in tags else 1)
    (x, of_x), (y, of_y) = (tags[name].value for name in ("XResolution", "YResolution"))
    if x == 0 or y == 0:
        return None, None
    steps = (of_x / x, of_y / y)
    if scale is not None and scale * max(steps) <= _LARGEST_OF_IMAGES:
        return (scale * steps[0], scale * steps[1]), "m"
    return (steps, None) if steps[0] != steps[1] else (None, None)


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
    content = texts.decoded(data, any_bytes=True)
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
        return text.read(content, channel)
    except text.NoNumbers:
        if path.suffix.lower() in _TEXTS:
            raise
        return _instrument(path, channel)


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
        default = reader.default_channel.index
        one = (
            channels[numbered(channel, names, "channel")]
            if channel is not None
            else next((one for one in heights if one.index == default), (heights or channels)[0])
        )
        raw = _of_channel(one, has_masks=reader.format() == "gwy")
        others = ", ".join(other.channel_id for other in heights if other.index != one.index)
        if others and channel is None:
            raw.warnings.append(
                f"of its heights the channel {one.channel_id} is read; there are {others}, too"
            )
        return raw


def _of_channel(channel: Any, *, has_masks: bool) -> Raw:
    """The map of a channel of SurfaceTopography, which leaves out what a mask marks, be it missing or not."""
    # A size is needed to ask for the heights of a file that does not say it.
    unknown = channel.physical_sizes is None
    topography = channel.topography(physical_sizes=channel.nb_grid_pts if unknown else None)
    raw = from_topography("its map", topography)
    raw.channel, raw.pixel, raw.unsaid = channel.channel_id, None, ""
    if isinstance(channel.unit, tuple):
        lateral, raw.unit = channel.unit
    else:
        lateral = channel.unit
        raw.unit = lateral if channel.is_height_channel else channel.data_unit
    scale = metres(str(lateral))
    if scale is not None and not unknown:
        raw.pixel = _pixel(channel, scale)
    if has_masks and (count := int(np.count_nonzero(np.ma.getmaskarray(topography.heights())))):
        raw.warnings.append(
            f"the mask in the file leaves {count} of {raw.heights.size} heights out: if it marks grains, and no "
            "missing heights, remove it in Gwyddion (Data Process, Mask, Remove Mask) and save the file again"
        )
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
