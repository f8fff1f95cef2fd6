"""Files that the package writes, as a whole or not at all, and its temporary folders."""

from __future__ import annotations

import os
import re
import secrets
import shutil
import tempfile
import weakref
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType

from .errors import FileError

__all__ = ["Folder", "check", "writing", "writing_hdf5"]

Name = str | os.PathLike[str]


def check(path: Name, *, force: bool = False, inputs: Iterable[Name] = ()) -> Path:
    """The path of a file that may be written; commands ask before they compute.

    Parameters
    ----------
    path : path
        The file.
    force : bool
        Whether it may be there already.
    inputs : iterable of paths
        Files that it is made from, in whose place nothing is ever written.

    Raises
    ------
    FileError
        The message says what is in the way.
    """
    path = Path(path)
    if "\0" in str(path):
        raise FileError(f"{str(path)!r}: a name cannot have the character NUL")
    if path.is_symlink():
        raise FileError(f"{path}: is a symbolic link, which is not followed; name the file itself")
    if not path.parent.is_dir():
        raise FileError(f"{path}: there is no folder {path.parent}")
    if not path.exists():
        return path
    if not path.is_file():
        raise FileError(f"{path}: is not a regular file; name another output")
    for one in inputs:
        if os.path.exists(one) and os.path.samefile(path, one):
            raise FileError(f"{path}: is an input, {one}; name another output")
    if not force:
        raise FileError(f"{path}: exists; force=True overwrites it")
    return path


@contextmanager
def writing(path: Name, *, force: bool = False, inputs: Iterable[Name] = ()) -> Iterator[Path]:
    """A new, empty file to fill, which gets the name `path` when the block ends without an error.

    The new file is in the folder of `path`, with the same ending and a random name. It reaches the disk before it
    is renamed. An earlier file of the name `path` stays as it is until then, and for good if anything fails.

    Raises
    ------
    FileError
        As `check`, at the beginning and when the file gets its name.
    OSError
        The file cannot be written.
    """
    path, inputs = Path(path), list(inputs)
    check(path, force=force, inputs=inputs)
    part = path.with_name(f".stiction-{secrets.token_hex(8)}{path.suffix}")
    try:
        os.close(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        yield part
        # Windows flushes only what is open for writing.
        with open(part, "r+b") as file:
            os.fsync(file.fileno())
            if not os.fstat(file.fileno()).st_size:
                raise OSError(f"{path}: nothing has been written")
        check(path, force=force, inputs=inputs)
        _name(part, path, force)
    except OSError as error:
        named = (str(error.filename), str(error.filename2))
        if error.errno is not None and (error.filename is None or str(part) in named):
            error.filename = str(path)
            # None would be printed as a second name.
            del error.filename2
        raise
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def writing_hdf5(path: Name, *, force: bool = False, inputs: Iterable[Name] = ()) -> Iterator[Path]:
    """A new file as by `writing`, for libhdf5, which may crash on a full disk: it fills a file in a temporary folder."""
    with Folder() as folder:
        try:
            yield folder / "whole.h5"
        except RuntimeError as error:
            # h5py says so of a file that it cannot write when that is closed.
            if (number := re.search(r"write failed.* errno = (\d+)", str(error), re.DOTALL)) is None:
                raise
            raise OSError(int(number[1]), os.strerror(int(number[1])), str(folder / "whole.h5")) from None
        with writing(path, force=force, inputs=inputs) as part:
            shutil.copyfile(folder / "whole.h5", part)


def _name(part: Path, path: Path, force: bool) -> None:
    """Gives a file its name; without `force` it replaces none, not even one that has just been made."""
    if not force:
        try:
            os.link(part, path)
            return
        except FileExistsError:
            raise FileError(f"{path}: exists; force=True overwrites it") from None
        except OSError:
            # Some file systems have no second names.
            pass
    os.replace(part, path)


class Folder:
    """A temporary folder that is deleted with this object, by the process that made it and by no child of it.

    Attributes
    ----------
    path : pathlib.Path
        The folder.
    """

    def __init__(self) -> None:
        self.path = Path(tempfile.mkdtemp(prefix="stiction-"))
        self.delete = weakref.finalize(self, _deleted, str(self.path), os.getpid())

    def __enter__(self) -> Path:
        return self.path

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.delete()


def _deleted(folder: str, process: int) -> None:
    if os.getpid() != process:
        return
    try:
        shutil.rmtree(folder, ignore_errors=True)
    except KeyboardInterrupt:
        shutil.rmtree(folder, ignore_errors=True)
        raise
