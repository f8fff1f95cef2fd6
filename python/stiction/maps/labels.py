"""Rows and columns of numbers that are no heights, but names, places or times."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from .places import BLOCK

__all__ = ["counting", "without_labels", "wrapped"]

_Array = NDArray[np.float64]

# Most lines that a row is looked for on, and how much nearer to each other rows are than lines, squared.
_MOST, _ALIKE = 64, 0.25
_NTH = {2: "second", 3: "third"}
# Values from which on they may rise evenly but for their rounding, and how far single precision rounds.
_ROUNDED, _SINGLE = 8, 1e-7
# The part of steps that rise in a row of heights next to one that only rises, and in most rows of a tilted map; how
# much farther apart rows may be, squared.
_RISING, _MOSTLY, _APART = 0.75, 0.6, 9.0


def counting(values: _Array) -> bool:
    """Whether values count by one from 0 or 1."""
    return values.size > 1 and values[0] in (0.0, 1.0) and bool(np.all(np.diff(values) == 1.0))


def _half_digits(values: _Array) -> _Array:
    """Half a unit of the last digit of each value, by the value with the most digits."""
    numbers = [Decimal(int(one)) if one.is_integer() else Decimal(repr(one)) for one in values.tolist()]
    decimals = max(-int(number.as_tuple().exponent) for number in numbers)
    digits = max(len(number.as_tuple().digits) for number in numbers)
    units = [
        max(10.0**-decimals, 10.0 ** (number.adjusted() - digits + 1)) if number else 10.0**-decimals
        for number in numbers
    ]
    return 0.5 * np.array(units)


def _even(values: _Array) -> float | None:
    """The step of values that rise or fall evenly, exactly or but for the rounding to their last digits."""
    steps = np.diff(values)
    if values.size < 4 or not np.all(np.isfinite(steps)) or steps[0] == 0.0:
        return None
    if np.all(np.abs(steps - steps[0]) <= 1e-6 * abs(steps[0])):
        return float(steps[0])
    # A few heights of a few digits may rise so by chance.
    if values.size < _ROUNDED or not np.all(steps * np.sign(steps[0]) > 0.0):
        return None
    order = np.arange(values.size, dtype=float)
    step, start = np.polyfit(order, values, 1)
    off = np.abs(start + step * order - values)
    return (
        float(step)
        if np.all(off <= np.maximum(1.2 * _half_digits(values), _SINGLE * np.abs(values)))
        else None
    )


def _names(values: _Array) -> bool:
    """Whether the first row rises or falls evenly, as names and places do, and no other row does."""
    step = _even(values[0])
    if step is None:
        return False
    likely = np.all(np.diff(values[1:], axis=1) * np.sign(step) > 0.0, axis=1)
    for row in values[1:][likely]:
        other = _even(row)
        rounding = 2.0 * (_half_digits(values[0]).max() + _half_digits(row).max()) / values.shape[1]
        if other is not None and abs(other - step) <= max(1e-6 * abs(step), rounding):
            return False
    return True


def without_labels(values: _Array, first: str, named: bool = False) -> tuple[_Array, list[str]]:
    """The heights without names of columns and rows that count, as pandas writes them, and what was left out.

    Others that rise or fall evenly, or that only rise or fall, are refused: they may be places or times.

    Parameters
    ----------
    values : array (rows, columns)
        The numbers; NaN where one is missing.
    first : str
        What messages call the first row, such as ``line 4``.
    named : bool
        Whether names of columns were left out before, so that the first column has names of rows.

    Raises
    ------
    SceneError
        The first row or column has no heights; the message has what would do.
    """
    if min(values.shape) < 4:
        return values, []
    said = []
    if not named and counting(values[0, 1:]) and counting(values[1:, 0]):
        values, named = values[1:], True
        said = [f"{first} has the names of columns: left out"]
    if named:
        return values[:, 1:], [*said, f"column 1 has the names of rows, from {values[0, 0]:g} on: left out"]
    for part, where in ((values, first), (values.T, "column 1")):
        if counting(part[0]) and _names(part):
            said = [f"{where} counts from {part[0, 0]:g} to {part[0, -1]:g}, as names do: left out"]
            rest, more = without_labels(values[1:] if part is values else values[:, 1:], first)
            return rest, said + more
        evenly = _names(part) or _names(part[:, 1:])
        if evenly or _only_rises(part):
            begin = part[0, 1 if evenly and not _names(part) else 0]
            kind = "goes evenly" if evenly else "only rises or falls,"
            raise SceneError(
                f"{where} {kind} from {begin:g} to {part[0, -1]:g}, as names, places or times do and heights do not; "
                "take it out, "
                + ("or begin it with `# `" if part is values else "or write the map with numpy.save")
            )
    return values, []


def _only_rises(values: _Array) -> bool:
    """Whether the first row rises or falls from one value to the next, and is no neighbour of the second row.

    Of heights the second row rises as well, or most do, and differs from the first by about as much as others do.
    """
    if len(values) < _ROUNDED or values.shape[1] < _ROUNDED or not np.isfinite(values[0]).all():
        return False
    steps = np.diff(values, axis=1)
    if not np.all(steps[0] * np.sign(steps[0, 0]) > 0.0):
        return False
    rising = np.mean(steps[1:] * np.sign(steps[0, 0]) > 0.0, axis=1)
    if rising[0] < _RISING and np.median(rising) < _MOSTLY:
        return True
    apart = np.array(
        [np.var(one[np.isfinite(one)]) for one in np.diff(values, axis=0) if np.isfinite(one).any()]
    )
    return bool(apart.size > 1 and apart[0] > _APART * apart[1:].max())


def wrapped(values: _Array) -> list[str]:
    """That each row of a map may be on several lines: they end where the next ones begin, and others are alike.

    Parameters
    ----------
    values : array (lines, columns)
        The numbers of each line.
    """
    lines, columns = values.shape
    gaps = range(1, min(lines // BLOCK, _MOST) + 1)
    apart = [_square(values[gap:] - values[:-gap]) for gap in gaps]
    for count in (count for count in gaps[1:] if lines % count == 0 and apart[count - 1] < _ALIKE * apart[0]):
        rows = values.reshape(lines // count, count * columns)
        along = np.diff(rows, axis=1)
        joins = _square(along[:, columns - 1 :: columns])
        if joins < min(4.0 * _square(along), _ALIKE * _square(rows[1:, 0] - rows[:-1, -1])):
            return [
                f"each row of the map may be on {count} lines: a line goes on where the one before ends, and every "
                f"{_NTH.get(count, f'{count}th')} one is alike; if so, join them to {lines // count} lines of "
                f"{count * columns} numbers"
            ]
    return []


def _square(values: _Array) -> float:
    """The mean square of those that are known; not a number without any."""
    known = values[np.isfinite(values)]
    return float(np.mean(np.square(known))) if known.size else np.nan
