"""Results as they are opened: what their files contain, with figures and force curves."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray

from . import files, results, stored
from .force_curves.lever import of_run

if TYPE_CHECKING:
    from .plot.accessors import Plot

__all__ = ["Asperities", "Finding", "Place", "Result", "Run", "Sweep", "open_run"]

# Results without a name are read into memory up to this size, bytes.
_IN_MEMORY = 100_000_000


class Result(results.Result):
    """A result file that is open for reading, with its figures.

    Attributes
    ----------
    path : pathlib.Path
        The file.
    tree : xarray.DataTree
        All groups, datasets and attributes of the file; values are read when they are needed.
    """

    @property
    def plot(self) -> Plot:
        """Figures: ``result.plot()`` draws the page of its kind, ``result.plot.force(ax=ax)`` a part of it."""
        from .plot.accessors import Plot

        return Plot(self)


class Run(results.Run, Result):
    """A result of `stiction run` of one scene."""

    def force_curve(self, stiffness: Any = None, *, replica: int = 0, preload: Any = None) -> xarray.Dataset:
        """The force curve of one patch on a cantilever, as an AFM records it: force over piezo position, both branches, with jumps.

        It is followed along the curves that the file keeps of each replica of a loop with ``curves = true`` in ``[output]``.

        Parameters
        ----------
        stiffness : str or float, optional
            Of the cantilever: a text such as ``"40 N/m"``, or N/m; by default the one spring of ``[instability]``.
        replica : int
            The patch.
        preload : str or float, optional
            The force at which it turns, one of ``[instability]``; by default the largest that the patch reaches. Without
            preloads in the scene it turns at the smallest separation.

        Returns
        -------
        xarray.Dataset
            As of `stiction.force_curves.force_curve`, with the coordinates `replica` and `preload`.

        Raises
        ------
        FileError
            The file is of no loop, or has no curves of its replicas, or the patch reaches no preload.
        SceneError
            There is no such replica or preload, no stiffness greater than 0; or the tip jumps in outside of the separations.
        """
        return of_run(self, stiffness, replica, preload)


class Sweep(results.Sweep, Result):
    """A result of `stiction run` of a scene with `[sweep]`, or of `stiction compare`: points along its keys.

    Points are selected by values of the keys, and by names where a key is a choice: ``sweep.integral.sel(model_law="emd")``.
    """


class Asperities(results.Asperities, Result):
    """A result of `stiction asperities`: the asperities of a measured surface."""


class Finding(results.Finding, Result):
    """What `stiction infer`, `sensitivity`, `design` or `map` found, in words and a figure."""


def open_run(path: str | os.PathLike[str]) -> Any:
    """Opens a result of the program, of any kind.

    Parameters
    ----------
    path : str or pathlib.Path
        A file of `stiction run`, `compare`, `asperities`, `infer`, `sensitivity`, `design` or `map`.

    Returns
    -------
    Run, Sweep, Asperities or Finding
        By the root attribute `format` of the file.

    Raises
    ------
    FileError
        There is no such file, it is no result of stiction, or one of a version that this package does not read.
    """
    path = Path(path)
    name = results.format_of(path)
    return next(kind for kind in (Run, Sweep, Asperities, Finding) if name in kind.formats)(path)


class Place:
    """The place of a result that is about to be computed: a path, or without one a folder that is deleted."""

    def __init__(self, output: str | Path | None) -> None:
        self._folder = files.Folder() if output is None else None
        self.path = self._folder.path / "result.h5" if self._folder is not None else Path(output or "")

    def __enter__(self) -> Place:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None and self._folder is not None:
            self._folder.delete()

    def result(self) -> Any:
        """The result that is there now. What is in a folder that is deleted is so when the result is garbage."""
        result = open_run(self.path)
        if self._folder is not None:
            if self.path.stat().st_size <= _IN_MEMORY:
                # Parts of it may be wanted for longer than the result.
                result.tree.load()
            result.folder = self._folder
        return result

    def patches(self) -> xarray.Dataset:
        """The group `replicas` of the result that is there now, in memory. A folder that is deleted is so at once."""
        with stored.reading(self.path), xarray.open_dataset(
            self.path, group="replicas", engine="h5netcdf", decode_times=False
        ) as group:  # fmt: skip
            found = group.load()
        if self._folder is not None:
            self._folder.delete()
        return found
