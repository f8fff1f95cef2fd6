"""Measured outcomes of patches from a table."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import quantities, tables
from ..errors import FileError, SceneError
from ..results import OF_WHOLE_LOOP
from ..tables import Column, Table

__all__ = ["ABOVE", "BELOW", "EXACT", "MISSING", "Group", "Measurements", "first_conditions", "read"]

Array = NDArray[np.float64]
#: What a number says: the outcome itself, an upper or a lower limit of it, nothing.
EXACT, BELOW, ABOVE, MISSING = range(4)
_ERROR = "_error"
# Units that outcomes usually have.
_USUAL = {"N": "nN", "m": "nm", "J": "fJ"}
# A limit of a force that is negative in the file is one of its size.
_OF_SIZE = {EXACT: EXACT, BELOW: ABOVE, ABOVE: BELOW, MISSING: MISSING}
# Columns of labels, also where these are numbers; the first of pandas has no name.
_LABELS = {"", "sample", "label", "name", "id", "index", "no", "nr", "patch", "test"}
# The outcome after a preload of the scene.
AFTER_PRELOAD = "pull_off_after_preload"
# Columns of labels of specimens or batches of patches.
_BATCHES = ("batch", "specimen")
# Columns of tables of force curves that say where and with what was measured, and why not.
_ASIDE = {"curve", "spring_constant", "position_x", "position_y", "remark"}


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
    samples : tuple of str
        Labels of the patches, if the file has them.
    batches : array (patches,) of int
        Places of their batches among `Measurements.batches`; 0 where there is one.
    """

    conditions: dict[str, Any]
    values: Array
    errors: Array
    kinds: NDArray[np.int64]
    lines: tuple[int, ...] = ()
    samples: tuple[str, ...] = ()
    batches: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))


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
    gaps : int
        The number of outcomes that are not measured.
    batches : tuple of str
        Labels of the batches, if the file has them.
    """

    outcomes: tuple[str, ...]
    units: tuple[str, ...]
    groups: tuple[Group, ...]
    gaps: int = 0
    batches: tuple[str, ...] = ()

    @property
    def floors(self) -> Array:
        """A tenth of the smallest number of each outcome, SI, (outcomes,): the data resolve nothing below."""
        smallest: Array = np.nanmin(np.concatenate([group.values for group in self.groups]), axis=0)
        return 0.1 * smallest

    @property
    def size(self) -> int:
        """Number of patches."""
        return sum(len(group.values) for group in self.groups)


@dataclass(frozen=True)
class _Roles:
    """What the columns of a table hold; outcomes and errors by the name of the outcome."""

    outcomes: dict[str, Column] = field(default_factory=dict)
    errors: dict[str, Column] = field(default_factory=dict)
    conditions: list[Column] = field(default_factory=list)
    labels: list[Column] = field(default_factory=list)
    batches: list[Column] = field(default_factory=list)


@dataclass(frozen=True)
class _Outcome:
    """A column of outcomes: numbers and errors in SI units, and what they say, a number for each row."""

    values: list[float]
    errors: list[float]
    kinds: list[int]


def read(
    path: str | Path, *, outcomes: Mapping[str, str] | None = None, missing: str = "refuse"
) -> Measurements:
    """Reads measured outcomes.

    Parameters
    ----------
    path : path
        A table, as `stiction.read_table` reads it. A column is headed by an outcome of patches with its unit,
        ``pull_off_force (uN)``; by an outcome with ``_error``, the standard deviation of its measurement; or by a
        key of the scene, ``surface.nominal_area (um^2)``, for patches under different conditions. A column of
        texts labels the patches, a column ``batch`` or ``specimen`` what they were made with. ``<0.5`` is a pull-off below 0.5, ``>5`` one above. Forces that are all negative
        are taken by their size.
    outcomes : dict, optional
        The outcomes that patches of the scene have, with their units as files have them; without it any.
    missing : {"refuse", "drop"}
        Whether an empty cell, or what spreadsheets and people write for one, is an error or an outcome that was
        not measured.

    Raises
    ------
    FileError
        There is no such file, or the message names line and column of what is wrong.
    """
    if missing not in ("refuse", "drop"):
        raise SceneError(f"missing = {missing!r}: refuse or drop is needed")
    table = tables.read(path)
    roles = _roles(table, outcomes)
    units = {name: _unit(column, outcomes) for name, column in roles.outcomes.items()}
    for name, column in roles.errors.items():
        if name not in units or not quantities.of_one_dimension([_unit(column, None).si, units[name].si]):
            raise FileError(f"{column.title}: needs a column {name}, and both a unit of one kind")
    found = [_outcome(column, roles.errors.get(name), missing) for name, column in roles.outcomes.items()]
    for column, one in zip(roles.outcomes.values(), found, strict=True):
        if set(one.kinds) == {MISSING}:
            raise FileError(f"{column.title}: nothing is in it; leave it out")
    places: dict[tuple[tuple[str, Any], ...], list[int]] = {}
    for row in range(len(table.lines)):
        if any(one.kinds[row] != MISSING for one in found):
            conditions = tuple(sorted((column.name, _condition(column, row)) for column in roles.conditions))
            places.setdefault(conditions, []).append(row)
    labels = [roles.batches[0].cells[row] for row in range(len(table.lines))] if roles.batches else []
    batches = tuple(dict.fromkeys(labels))
    if "" in batches:
        column = roles.batches[0]
        raise FileError(f"{column.where(labels.index(''))}: nothing: a label is needed in each line")
    of_rows = np.array([batches.index(label) for label in labels] if labels else np.zeros(len(table.lines)), dtype=np.int64)
    groups = tuple(
        dataclasses.replace(_group(dict(conditions), rows, found, roles, table), batches=of_rows[rows])
        for conditions, rows in places.items()
    )
    gaps = sum(one.kinds.count(MISSING) for one in found)
    return Measurements(tuple(units), tuple(unit.si for unit in units.values()), groups, gaps, batches)


def first_conditions(path: str | Path) -> dict[str, Any]:
    """The values that the first row of a table has for keys of the scene, as scenes write them.

    Raises
    ------
    FileError
        As `read`, for what is no table.
    """
    columns = tables.read(path).columns
    return {column.name: _condition(column, 0) for column in columns if _is_key(column.name)}


def _is_key(name: str) -> bool:
    """Whether a column is named by a key of scenes; ``x.1`` is what pandas calls a second column ``x``."""
    return "." in name and not name.rpartition(".")[2].isdecimal()


def _roles(table: Table, known: Mapping[str, str] | None) -> _Roles:
    roles = _Roles()
    for column in table.columns:
        name = column.name
        if _is_key(name):
            roles.conditions.append(column)
        elif name in _ASIDE:
            continue
        elif name in _BATCHES and not column.unit:
            roles.batches.append(column)
        elif known is not None and name in known:
            roles.outcomes[name] = column
        elif name.endswith(_ERROR):
            roles.errors[name.removesuffix(_ERROR)] = column
        elif name in _LABELS or (column.is_text() and not column.unit):
            roles.labels.append(column)
        elif known is None:
            roles.outcomes[name] = column
        else:
            raise FileError(f"{column.title}: no outcome of this scene{_instead(name, known)}")
    if len(roles.labels) > 1:
        raise FileError(
            f"{roles.labels[1].title}: a second column of labels; one may be there, and notes behind #"
        )
    if len(roles.batches) > 1:
        raise FileError(f"{roles.batches[1].title}: a second column of batches; one may be there")
    if not roles.outcomes:
        such = "pull_off_force" if not known or "pull_off_force" in known else next(iter(known))
        raise FileError(f"{table.path}: no column has an outcome, such as `{such} (uN)`")
    return roles


def _instead(name: str, known: Mapping[str, str]) -> str:
    """What a column may hold that is named by no outcome of the scene."""
    column = "a column instability.preload (uN) has the preload of each patch"
    if name == AFTER_PRELOAD:
        return f": it needs one instability.preload in the scene, or {column}"
    # Every scene without preloads has it.
    if name in OF_WHOLE_LOOP:
        several = "" if AFTER_PRELOAD in known else f"; {column}"
        return f", as its preload decides where the surfaces turn: name the column {AFTER_PRELOAD}, or leave out instability.preload{several}"
    guess = tables.meant(name, known) or f", which has {', '.join(known)}."
    return f"{guess} A key of the scene has its table before it, such as surface.nominal_area (um^2)"


def _unit(column: Column, known: Mapping[str, str] | None) -> quantities.Unit:
    """The unit of a column of outcomes."""
    unit = column.measured_in()
    if known is not None and not quantities.of_one_dimension([unit.si, known[column.name]]):
        own = quantities.plain_unit(known[column.name])
        if not column.unit:
            such = f"{column.name} ({_USUAL.get(own, own)})"
            raise FileError(f"{column.title}: the unit is missing; put it behind the name, such as {such}")
        such = f"{column.name} ({own})" if own else f"{column.name} without one"
        raise FileError(f"{column.title}: {column.unit} is another unit; {such} is needed")
    return unit


def _outcome(column: Column, errors: Column | None, missing: str) -> _Outcome:
    """The outcomes of a column; forces that are all negative by their size."""
    unit = column.measured_in()
    numbers, kinds = [], []
    for row, cell in enumerate(column.cells):
        if column.is_gap(row):
            if missing == "refuse":
                advice = "fill it, or --missing drop takes it for not measured"
                raise FileError(f"{column.where(row)}: {cell or 'nothing'}: a gap; {advice}")
            numbers.append(math.nan)
            kinds.append(MISSING)
            continue
        kind = {"<": BELOW, ">": ABOVE}.get(cell[:1], EXACT)
        numbers.append(column.value(row, unit, behind=int(kind != EXACT)))
        kinds.append(kind)
    given = [number for number in numbers if not math.isnan(number)]
    if unit.si == "N" and given and max(given) < 0.0:
        numbers, kinds = [-number for number in numbers], [_OF_SIZE[kind] for kind in kinds]
    deviations = [0.0] * len(numbers)
    for row, (number, kind) in enumerate(zip(numbers, kinds, strict=True)):
        if kind == MISSING:
            continue
        if not number > 0.0:
            advice = (
                "write `<` before the resolution where none was seen; forces are all positive or all negative"
            )
            problem = f"{column.cells[row]}: a measured outcome has to be greater than 0"
            raise FileError(f"{column.where(row)}: {problem}; {advice}")
        if errors is not None:
            deviations[row] = errors.value(row, errors.measured_in())
            if deviations[row] < 0.0:
                raise FileError(
                    f"{errors.where(row)}: a standard deviation of 0 or more is needed, also of a limit"
                )
    return _Outcome(numbers, deviations, kinds)


def _condition(column: Column, row: int) -> Any:
    """The value of a key, as scenes write it."""
    if column.is_text() and not column.unit and not column.is_gap(row):
        return column.cells[row]
    number = column.number(row)
    if column.unit and column.measured_in().si != "1":
        return f"{number} {column.unit}"
    return column.value(row, column.measured_in())


def _group(
    conditions: dict[str, Any], rows: list[int], found: list[_Outcome], roles: _Roles, table: Table
) -> Group:
    def each(name: str) -> Any:
        return np.array([[getattr(one, name)[row] for one in found] for row in rows])

    samples = tuple(roles.labels[0].cells[row] for row in rows) if roles.labels else ()
    return Group(
        conditions,
        each("values"),
        each("errors"),
        each("kinds"),
        tuple(table.lines[row] for row in rows),
        samples,
    )
