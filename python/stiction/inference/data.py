"""Measured outcomes of patches from a CSV file."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import quantities
from ..errors import FileError

__all__ = ["ABOVE", "BELOW", "EXACT", "MISSING", "Group", "Measurements", "read"]

Array = NDArray[np.float64]
#: What a number says: the outcome itself, an upper or a lower limit of it, nothing.
EXACT, BELOW, ABOVE, MISSING = range(4)
_ERROR = "_error"


@dataclass(frozen=True)
class Group:
    """The patches that were measured under the same conditions.

    Attributes
    ----------
    conditions : dict
        Values of keys of the scene, as scenes write them.
    values : array (patches, outcomes)
        Outcomes in SI units, or their limits; NaN where missing.
    errors : array (patches, outcomes)
        Standard deviations of the measurement, in SI units; 0 where none is given.
    kinds : array (patches, outcomes) of int
        `EXACT`, `BELOW`, `ABOVE` or `MISSING`.
    lines : tuple of int
        Lines of the file, if they are from one.
    """

    conditions: dict[str, Any]
    values: Array
    errors: Array
    kinds: NDArray[np.int64]
    lines: tuple[int, ...] = ()


@dataclass(frozen=True)
class Measurements:
    """The data of a file.

    Attributes
    ----------
    outcomes : tuple of str
        Names of the outcomes, as the files of the program have them, such as ``pull_off_force``.
    units : tuple of str
        Their SI units.
    groups : tuple of Group
        One for each set of conditions.
    """

    outcomes: tuple[str, ...]
    units: tuple[str, ...]
    groups: tuple[Group, ...]

    @property
    def floors(self) -> Array:
        """A tenth of the smallest number of each outcome, SI, (outcomes,): the data resolve nothing below."""
        smallest: Array = np.nanmin(np.concatenate([group.values for group in self.groups]), axis=0)
        return 0.1 * smallest

    @property
    def size(self) -> int:
        """Number of patches."""
        return sum(len(group.values) for group in self.groups)


def read(path: str | Path) -> Measurements:
    """Reads measured outcomes.

    Parameters
    ----------
    path : path
        A CSV file with a header. A column is headed by an outcome of patches with its unit, ``pull_off_force (uN)``; by an outcome with
        ``_error``, the standard deviation of its measurement; or by a key of the scene, ``surface.nominal_area (um^2)``, for patches under
        different conditions. ``<0.5`` is a pull-off below 0.5, ``>5`` one above; an empty cell was not measured. Lines that begin
        with # are comments.

    Raises
    ------
    FileError
        There is no such file, or the message names line and column of what is wrong.
    """
    path = Path(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except FileNotFoundError:
        raise FileError(f"{path}: no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{path}: cannot be read as text: {error}") from None
    numbered = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    rows = [_row(f"{path}, line {number}", line) for number, line in numbered]
    if len(rows) < 2:
        raise FileError(f"{path}: a header and a line for each patch are needed")
    heads = [_head(path, cell) for cell in rows[0]]
    names = [name for name, _, _ in heads]
    if twice := {name for name in names if names.count(name) > 1}:
        raise FileError(f"{path}: the column {sorted(twice)[0]} is there twice")
    outcomes = [name for name in names if "." not in name and not name.endswith(_ERROR)]
    if not outcomes:
        raise FileError(f"{path}: no column has an outcome, such as `pull_off_force (uN)`")
    units = {name: unit for name, _, unit in heads}
    for name in names:
        if name.endswith(_ERROR) and units.get(name.removesuffix(_ERROR)) != units[name]:
            raise FileError(f"{path}: the column {name} needs one {name.removesuffix(_ERROR)}, and both a unit of the same kind")
    gathered: dict[tuple[tuple[str, Any], ...], list[list[tuple[float, float, int]]]] = {}
    places: dict[tuple[tuple[str, Any], ...], list[int]] = {}
    for (line, _), row in zip(numbered[1:], rows[1:], strict=True):
        where = f"{path}, line {line}"
        if len(row) != len(heads):
            raise FileError(f"{where}: {len(row)} cells, where the header has {len(heads)}")
        conditions: dict[str, Any] = {}
        cells: dict[str, tuple[float, int]] = {}
        for (name, factor, _), (_, unit_text), cell in zip(heads, _texts(rows[0]), row, strict=True):
            if "." in name:
                conditions[name] = f"{cell.strip()} {unit_text}" if unit_text else _plain(cell.strip())
            else:
                number, kind = _cell(f"{where}, {name}", cell)
                cells[name] = number * factor, kind
        patch = []
        for name in outcomes:
            value, kind = cells[name]
            deviation, deviation_kind = cells.get(name + _ERROR, (0.0, EXACT))
            if kind != MISSING and (deviation_kind != EXACT or deviation < 0.0):
                raise FileError(f"{where}, {name}{_ERROR}: a standard deviation of 0 or more is needed, also of a limit")
            if kind != MISSING and not value > 0.0:
                told = "a measured outcome has to be greater than 0; write `<` before the resolution where none was seen"
                raise FileError(f"{where}, {name}: {told}")
            patch.append((value, 0.0 if kind == MISSING else deviation, kind))
        if all(kind == MISSING for _, _, kind in patch):
            raise FileError(f"{where}: no outcome")
        gathered.setdefault(tuple(sorted(conditions.items())), []).append(patch)
        places.setdefault(tuple(sorted(conditions.items())), []).append(line)
    for place, name in enumerate(outcomes):
        if all(patch[place][2] == MISSING for patches in gathered.values() for patch in patches):
            raise FileError(f"{path}: the column {name} is empty; leave it out")
    groups = []
    for conditions_of, patches in gathered.items():
        table = np.array(patches)
        groups.append(Group(dict(conditions_of), table[:, :, 0], table[:, :, 1], table[:, :, 2].astype(np.int64), tuple(places[conditions_of])))
    return Measurements(tuple(outcomes), tuple(units[name] for name in outcomes), tuple(groups))


def _row(where: str, line: str) -> list[str]:
    """The cells of a line."""
    try:
        return next(csv.reader([line], skipinitialspace=True, strict=True))
    except csv.Error as error:
        raise FileError(f"{where}: {error}; the quotation marks of a cell begin and end in one line") from None


def _texts(header: list[str]) -> list[tuple[str, str]]:
    result = []
    for cell in header:
        found = re.fullmatch(r"\s*([\w.]+)\s*(?:[(\[]\s*(.*?)\s*[)\]])?\s*", cell)
        result.append((found[1], found[2] or "") if found else ("", ""))
    return result


def _head(path: Path, cell: str) -> tuple[str, float, str]:
    """Name, factor to SI and SI unit of a column."""
    ((name, unit),) = _texts([cell])
    if not name:
        raise FileError(f"{path}: the column `{cell}` is not headed by a name with a unit, such as `pull_off_force (uN)`")
    if not unit or "." in name:
        return name, 1.0, ""
    try:
        factor, si = quantities.parsed(f"{path}: the column {name}", f"1 {unit}")
    except ValueError as error:
        raise FileError(str(error)) from None
    # N/m and J/m² have one dimension, but stiffnesses are not given as energies.
    return name, factor, "N/m" if unit.endswith("N/m") else si


def _plain(cell: str) -> Any:
    try:
        return float(cell)
    except ValueError:
        return cell


def _cell(where: str, cell: str) -> tuple[float, int]:
    text = cell.strip()
    if text == "":
        return math.nan, MISSING
    kind = {"<": BELOW, ">": ABOVE}.get(text[0], EXACT)
    try:
        value = float(text if kind == EXACT else text[1:])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise FileError(f"{where}: {cell.strip()} is not a number, nor one behind < or >")
    return value, kind
