"""The engine `stiction` of xarray: results with `h_star` to select by, as well as `separation`.

``xarray.open_datatree("run.h5", engine="stiction")`` is the tree of a result with an index for `h_star` and `asperity_separation`,
and names in the place of the numbers of choices; any other engine for HDF5 opens the same file without.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray
from xarray.backends import BackendEntrypoint

from . import stored
from .errors import FileError
from .results import indexed, is_result

__all__ = ["StictionBackend"]


class StictionBackend(BackendEntrypoint):
    """Opens results of stiction by the engine ``h5netcdf``."""

    description = "Results of stiction, with h_star to select by"
    open_dataset_parameters = ("filename_or_obj", "drop_variables", "group")
    supports_groups = True

    def open_dataset(
        self, filename_or_obj: Any, *, drop_variables: Any = None, group: str | None = None
    ) -> xarray.Dataset:
        """A group of the file, or its root."""
        opened = xarray.open_dataset(
            _checked(filename_or_obj), engine="h5netcdf", group=group, drop_variables=drop_variables
        )
        return indexed(opened)

    def open_groups_as_dict(
        self, filename_or_obj: Any, *, drop_variables: Any = None, group: str | None = None
    ) -> dict[str, xarray.Dataset]:
        """The groups of the file, all or those in `group`, by their paths."""
        opened = xarray.open_groups(
            _checked(filename_or_obj), engine="h5netcdf", drop_variables=drop_variables, group=group
        )
        return {path: indexed(one) for path, one in opened.items()}

    def open_datatree(
        self, filename_or_obj: Any, *, drop_variables: Any = None, group: str | None = None
    ) -> xarray.DataTree:
        """The tree of all groups, or of those in `group`."""
        return xarray.DataTree.from_dict(
            self.open_groups_as_dict(filename_or_obj, drop_variables=drop_variables, group=group)
        )

    def guess_can_open(self, filename_or_obj: Any) -> bool:
        """Whether an object is the path of a result of stiction, by the attribute `format` of its root."""
        if not isinstance(filename_or_obj, str | Path) or not Path(filename_or_obj).is_file():
            return False
        try:
            return is_result(Path(filename_or_obj))
        except FileError:
            return False


def _checked(filename_or_obj: Any) -> Any:
    """The object to be opened; a file only if all that it has is in the file itself."""
    if isinstance(filename_or_obj, str | Path) and Path(filename_or_obj).is_file():
        stored.check(Path(filename_or_obj))
    return filename_or_obj
