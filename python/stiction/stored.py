"""Files of unknown origin: that they hold what they claim, and nothing that is elsewhere."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import xarray

from . import program
from .errors import FileError, StictionError

__all__ = ["check", "check_dataset", "group", "reading", "require_end", "try_first"]

# Groups and datasets together; results have up to two hundred.
_MOST_OBJECTS = 1000
# Bytes that a byte of a file can hold at most: deflate makes no more of one.
_LARGEST_EXPANSION = 1032
# Words of the program on a file of which libhdf5 does not come to an end.
_WITHOUT_END = "reads it without an end"
# Characters of a message of a library that are shown.
_SHOWN = 200


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Blames failures in the block on the file, which is all that the block depends on.

    Raises
    ------
    FileError
        The message begins with the path.
    """
    try:
        yield
    except StictionError as error:
        if str(path) in str(error):
            raise
        raise type(error)(f"{path}: {error}", error.exit_code) from error
    except MemoryError:
        raise FileError(f"{path}: is damaged, or too large for the memory of this computer") from None
    except Exception as error:
        said = " ".join(str(error).split())[:_SHOWN]
        said = (
            f"something is missing: {said}" if isinstance(error, KeyError) else said or type(error).__name__
        )
        raise FileError(f"{path}: is damaged or not whole: {said}") from error


def group(path: Path, name: str, lacks: str) -> xarray.Dataset:
    """A group of a file, in memory.

    Parameters
    ----------
    path : path
    name : str
        Of the group.
    lacks : str
        What the message says of a file without it, such as ``not a result of `stiction infer```.

    Raises
    ------
    FileError
        There is no such file, it is none that can be trusted, or it has no such group.
    """
    check(path)
    try:
        with xarray.open_dataset(path, engine="h5netcdf", group=name) as opened:
            return opened.load()
    except Exception:
        raise FileError(f"{path}: {lacks}") from None


def require_end(path: Path) -> None:
    """Refuses a damaged file that libhdf5 reads without an end, as the program finds within a minute of processor time.

    Raises
    ------
    FileError
        With the message of `stiction info`. Without the program nothing is found.
    """
    error = _refusal(path)
    if error is not None and _WITHOUT_END in str(error):
        raise FileError(str(error))


def try_first(path: Path) -> None:
    """Lets the program read a file first, in a process with limits: libhdf5 may never return from damage.

    Raises
    ------
    StictionError
        With the message of `stiction info`.
    """
    if path.is_file() and h5py.is_hdf5(path):
        error = _refusal(path)
        if error is not None:
            raise type(error)(str(error), error.exit_code)


def _refusal(path: Path) -> StictionError | None:
    """The error of `stiction info` on a file that is there, found once for each state of the file."""
    stat = path.stat()
    return _refusal_of(str(path), stat.st_mtime_ns, stat.st_size)


@functools.lru_cache(maxsize=64)
def _refusal_of(path: str, _changed: int, _length: int) -> StictionError | None:
    try:
        program.call(["info", path])
    except StictionError as error:
        return error
    return None


def check(path: Path) -> None:
    """Refuses an HDF5 file that leads to other files, in a circle, or claims more values than it holds.

    Raises
    ------
    FileError
        The message says what is wrong.
    """
    if not h5py.is_hdf5(path):
        raise FileError(f"{path}: not an HDF5 file")
    with reading(path), h5py.File(path, "r") as file:
        groups: list[h5py.Group] = [file]
        known = {_address(file)}
        count = 0
        while groups:
            group = groups.pop()
            for name in group:
                count += 1
                if count > _MOST_OBJECTS:
                    raise FileError(
                        f"{path}: has more than {_MOST_OBJECTS} groups and datasets, which no result has"
                    )
                where = f"{group.name.rstrip('/')}/{name}"
                if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                    raise FileError(f"{path}: has a link {where} to elsewhere, which is not followed")
                item = group[name]
                if isinstance(item, h5py.Dataset):
                    check_dataset(path, where, item)
                elif isinstance(item, h5py.Group):
                    if _address(item) in known:
                        raise FileError(f"{path}: has the group {where} twice")
                    known.add(_address(item))
                    groups.append(item)
                else:
                    raise FileError(f"{path}: has {where}, which is neither a group nor a dataset")


def _address(group: h5py.Group) -> int:
    return int(h5py.h5o.get_info(group.id).addr)


def check_dataset(path: Path, where: str, dataset: h5py.Dataset) -> None:
    """Refuses a dataset whose values are elsewhere, or more than the file holds.

    Raises
    ------
    FileError
        The message says what is wrong.
    """
    if dataset.shape is None:
        raise FileError(f"{path}: has a dataset {where} without values")
    if dataset.dtype.kind not in "iuf" and h5py.check_string_dtype(dataset.dtype) is None:
        raise FileError(f"{path}: has a dataset {where} that holds neither numbers nor texts")
    creation = dataset.id.get_create_plist()
    layout = creation.get_layout()
    if layout == h5py.h5d.VIRTUAL or (layout == h5py.h5d.CONTIGUOUS and creation.get_external_count()):
        raise FileError(f"{path}: has a dataset {where} whose values are in other files, which are not read")
    # Dimensions of netCDF are datasets without any value that is stored, so the file as a whole is the limit.
    held = path.stat().st_size * _LARGEST_EXPANSION
    most = max(math.prod(dataset.shape), math.prod(dataset.chunks or ())) * dataset.dtype.itemsize
    if dataset.size and most > held:
        raise FileError(f"{path}: has a dataset {where} that has more values than the file holds")
