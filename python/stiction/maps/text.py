"""Height maps in texts: their dialect and header are found here, and pandas reads the numbers."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from decimal import Decimal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from .. import quantities
from ..errors import SceneError
from .channels import numbered
from .dialect import MISSING, NUMBER, any_number, dialect_of, hint, is_value
from .lengths import Steps, length, metres
from .places import BLOCK, MOST_AXES, REGULAR, Places, begin_with_grid, on_grid

__all__ = ["LINE_SCAN", "NoNumbers", "TextMap", "read"]

_Array = NDArray[np.float64]

_SPELLINGS = sorted(
    {spelt(mark) for mark in MISSING for spelt in (str, str.upper, str.title)} | {"NaN", "-NaN"}
)
# A comment, and what it says.
_COMMENT = re.compile(r"\s*(?:#|%|//)[#%/ ]*(.*)")
# An error of a spreadsheet as a whole cell, which a row may begin with: #N/A, #REF!, #DIV/0!; #####.
_SHEET_ERROR = re.compile(r"#[^\W\d][^\s:]*|#+")
# A line of empty cells.
_EMPTY = re.compile(r'[\s;,"]*')
_WEB_PAGE = re.compile(
    r"\s*(?:<\?xml[^>]*>\s*|<!--.*?-->\s*)*<(?:!doctype\s+html|html|head|body)\b", re.I | re.S
)
# What decimal commas show somewhere, and commas of thousands nowhere.
_DECIMALS = re.compile(rb"(?<![0-9])0*,|,[0-9]{0,2}(?![0-9])|,[0-9]{4}")
LINE_SCAN = "a line scan has a spectrum, but no asperities; a map has two dimensions"

# Labels of headers. Gwyddion translates its own.
_LABELS = {
    "channel": "Channel|Kanál|Kanal|Canal|Canale|チャネル|채널|Канал",
    "width": "Width|Šířka|Breite|Anchura|Largeur|Larghezza|幅|폭|Largura|Ширина|X Amplitude|x-length",
    "height": "Height|Výška|Höhe|Altura|Hauteur|Altezza|高さ|높이|Высота|Y Amplitude|y-length",
    "unit": "Value units|Jednotky hodnot|Einheiten|Unités|unità valore|値の単位|값 단위|Unidades de valor"
    "|Единицы измерения|z-unit|data unit",
    "lateral": "Lateral units",
}
# Keys that blanks may separate from their values, as in grids of ESRI.
_KEYS = {
    "columns": "ncols|Number of columns|x-pixels",
    "rows": "nrows|Number of rows|y-pixels",
    "missing": "no_?data(?:[_ ]?value)?|missing_value|_FillValue",
    "cell": "cellsize|pixel size",
    "scale": r"height conversion factor \(-> *m\)",
}
_HEADER = {
    name: re.compile(rf"(?:{labels})\s*{colon}\s*(.+)", re.IGNORECASE)
    for known, colon in ((_LABELS, "[:=：]"), (_KEYS, "[:=：\\s]"))
    for name, labels in known.items()
}
_AXES = {"x": "x", "y": "y", "z": "z", "height": "z"}
_AXIS = re.compile(r'"?([A-Za-z]+)"?\s*(?:[\[(]\s*([^\])]*?)\s*[\])]"?)?')
# What ESRI takes for NODATA_value where a grid does not say it.
_ESRI_MISSING = -9999.0
# Numbers to their last bit, which pandas gives from 3 on by itself.
_EXACT = {} if int(pd.__version__.split(".")[0]) >= 3 else {"float_precision": "round_trip"}
# Pixels of other sides than that are not square.
_SQUARE = 0.01
# Values from which on they may rise evenly but for their rounding, and how far single precision rounds.
_ROUNDED, _SINGLE = 8, 1e-7


class NoNumbers(SceneError):
    """A text has no row of numbers."""


@dataclass
class TextMap:
    """What a text says: heights in `unit` and the pixel in m, as far as it says them.

    `unsaid` is why a pixel has to be given, `doubt` why the one here may be wrong; `steps` have no unit.
    """

    heights: _Array
    pixel: tuple[float, float] | None = None
    unit: str | None = None
    channel: str | None = None
    warnings: list[str] = field(default_factory=list)
    unsaid: str = ""
    doubt: str = ""
    steps: Steps | None = None


@dataclass
class _Block:
    """The rows of one map, by the numbers of their lines, below what its header says, and on which lines."""

    header: dict[str, str] = field(default_factory=dict)
    said_on: dict[str, int] = field(default_factory=dict)
    axes: list[str | None] | None = None
    lines: list[int] = field(default_factory=list)

    def says(self, said: dict[str, str], line: int) -> None:
        self.header |= said
        self.said_on |= dict.fromkeys(said, line)


def read(text: str, channel: str | None = None) -> TextMap:
    """The map, or the one of the channel, that a text has.

    Parameters
    ----------
    text : str
        The text.
    channel : str, optional
        Name or number (from 0) of the map, of a text that has several.

    Raises
    ------
    SceneError
        It is no map; the message has line and column.
    """
    if _WEB_PAGE.match(text):
        raise SceneError("is a web page, not a map: of a login or a download; save the file that it leads to")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").replace("−", "-").split("\n")
    reader = _Reader(lines)
    blocks = reader.blocks()
    names = [block.header.get("channel", f"map {number}") for number, block in enumerate(blocks)]
    return reader.map(blocks[numbered(channel, names, "channel")])


class _Reader:
    """Lines of a text, and how their cells are separated."""

    def __init__(self, lines: list[str]) -> None:
        self.lines = lines
        self.warnings: list[str] = []
        written = [line for line in lines if line.strip()]
        self.dialect = dialect_of([line for line in written if not _COMMENT.match(line)] or written)

    def blocks(self) -> list[_Block]:
        """The maps of the text. Every line between numbers is a row, and every line as long as rows are."""
        blocks = [_Block()]
        # Lines without a number, which are rows if one follows: borders of a sheet are none.
        empty: list[int] = []
        for number, line in enumerate(self.lines):
            block = blocks[-1]
            comment = _COMMENT.fullmatch(line)
            if _EMPTY.fullmatch(line):
                if line.strip() or self.dialect.count(line) == self.dialect.columns:
                    empty.append(number)
            elif comment and self._is_comment(number, comment[1], bool(block.lines)):
                said = _said(comment[1])
                if "channel" in said and block.lines:
                    blocks.append(_Block())
                self._is_axes(comment[1], blocks[-1])
                blocks[-1].says(said, number + 1)
            elif not block.lines and self._is_header(line, block):
                block.says(_said(line), number + 1)
            else:
                block.lines += [*(empty if block.lines else []), number]
                empty = []
        blocks = [block for block in blocks if block.lines]
        if not blocks:
            first = next((line.strip() for line in self.lines if line.strip()), "")
            begins = f"; it begins with `{_shown(first)}`" if first else ", but blanks"
            written = hint(next((line for line in self.lines if hint(line)), "")) or (
                "a text has a row of the map on each line"
            )
            raise NoNumbers(f"holds no row of numbers{begins}: {written}")
        return blocks

    def _is_comment(self, number: int, comment: str, below: bool) -> bool:
        """Whether a line is a comment; `below` the first row one with the cells of a row is none, and refused."""
        cells, behind = (self.dialect.cells(line) for line in (self.lines[number], comment))
        others = len(cells) == self.dialect.columns and all(is_value(cell) for cell in cells[1:])
        error = others and _SHEET_ERROR.fullmatch(cells[0]) is not None
        if error and cells[0].strip("#"):
            return False
        values = [cell for cell in behind if is_value(cell)]
        is_row = len(behind) == self.dialect.columns and 2 * len(values) > len(behind) and any_number(values)
        if (below and (error or is_row)) or (self.dialect.separator and error and any_number(cells)):
            raise SceneError(
                f"line {number + 1}, column 1: `{_shown(self.lines[number])}` begins as comments do, and has the "
                "cells of a row; write the number, or nan for a missing height, or take the line out"
            )
        return True

    def _is_header(self, line: str, block: _Block) -> bool:
        """Whether a line before the rows belongs to the header; numbers are never taken for one."""
        if self._is_axes(line, block):
            return True
        cells = self.dialect.cells(line)
        if len(cells) == self.dialect.columns:
            return False
        # Names of columns that count, above rows that begin with the name of a row, are looked at later.
        return not (all(is_value(cell) for cell in cells) and any_number(cells))

    def _is_axes(self, line: str, block: _Block) -> bool:
        """Whether a line names the columns of a list of points, such as ``X[nm] Y[nm] Z[nm]``."""
        found = _AXIS.findall(line)
        axes = [_AXES.get(name.lower()) for name, _ in found]
        units = [unit for _, unit in found]
        if not ({"x", "y", "z"} <= set(axes) or axes == ["x", "z"]) or block.lines:
            return False
        # The column of names of rows of pandas has none itself.
        unnamed = self.dialect.columns - len(axes)
        if unnamed not in (0, 1) or len(axes) > MOST_AXES:
            return False
        block.header |= {"lateral": units[axes.index("x")], "unit": units[axes.index("z")]}
        block.axes = [*([None] * unnamed), *axes]
        return True

    def map(self, block: _Block) -> TextMap:
        """The map of a block: a grid, or points on one."""
        numbers, header = list(block.lines), block.header
        names_of_columns = self._short_names(numbers)
        self._check_lengths(numbers)
        values = self._numbers(numbers)
        if block.axes is None:
            values = self._within_borders(values, numbers)
        columns = values.shape[1]
        is_line = len(numbers) == 1 or columns == 1 or (columns == 2 and "width" not in header)
        are_points = not is_line and (block.axes is not None or (columns == 3 and "width" not in header))
        if not is_line and not are_points and "width" not in header and begin_with_grid(values):
            raise SceneError(
                f"looks like a list of points x, y, z with more columns: it has {columns}, and the first two are the "
                "places of a grid; keep the columns x, y, z, or name all in a first line, as `x y z phase`"
            )
        if "scale" in header:
            values *= _number_of(header["scale"])
            header["unit"] = "m"
        if is_line or are_points:
            values = values[[not _EMPTY.fullmatch(self.lines[number]) for number in numbers]]
        else:
            values, said = _without_labels(values, numbers[0] + 1, names_of_columns)
            self.warnings += [*said, *self._parted(numbers)]
        if header.get("missing") or "cell" in header:
            missing = _number_of(header.get("missing", "")) if "missing" in header else _ESRI_MISSING
            values[np.isclose(values, missing, rtol=1e-6, atol=0.0)] = np.nan
        if block.axes is not None and are_points:
            if block.axes[0] is None and not _counting(values[:, 0]):
                raise SceneError(f"its header names {columns - 1} columns, and there are {columns}")
            values = values[:, [block.axes.index(axis) for axis in ("x", "y", "z")]]
        found = (_line if is_line else _points if are_points else _grid)(values, block)
        found.unit, found.channel = header.get("unit") or None, header.get("channel")
        found.warnings = self.warnings + found.warnings
        return found

    def _parted(self, numbers: list[int]) -> list[str]:
        """That blank lines part the rows into blocks of one size, as stacked maps; single rows may be parted."""
        blank = np.array([not line.strip() for line in self.lines]).cumsum()[numbers]
        sizes = np.unique(blank, return_counts=True)[1]
        if sizes.size == 1 or sizes.min() < BLOCK or np.ptp(sizes) > 0:
            return []
        return [
            f"blank lines part its rows into {sizes.size} blocks of {sizes[0]} rows, which are read as one map: if "
            "each block is a map, or a wrapped row, save it in a file of its own, or on one line"
        ]

    def _within_borders(self, values: _Array, numbers: list[int]) -> _Array:
        """The values without columns of empty cells at the borders; a height that is written nan is no empty cell."""

        def is_empty(column: int) -> bool:
            rows = (self.dialect.cells(self.lines[number]) for number in numbers)
            return bool(np.isnan(values[:, column]).all()) and not any(cells[column] for cells in rows)

        left, right = 0, values.shape[1]
        while right > 1 and is_empty(right - 1):
            right -= 1
        while left < right - 1 and is_empty(left):
            left += 1
        return values[:, left:right]

    def _short_names(self, numbers: list[int]) -> bool:
        """Takes away a first line that has a cell fewer than the rows and counts: the names of columns."""
        cells = self.dialect.cells(self.lines[numbers[0]])
        counts = [_number_of(cell) for cell in cells]
        if len(numbers) > 1 and len(cells) == self.dialect.columns - 1 and _counting(np.array(counts)):
            first = [
                _number_of(next(iter(self.dialect.cells(self.lines[number])), "")) for number in numbers[1:]
            ]
            if _counting(np.array(first)):
                del numbers[0]
                return True
        return False

    def _check_lengths(self, numbers: list[int]) -> None:
        for number in numbers:
            count = self.dialect.count(self.lines[number])
            if count == self.dialect.columns:
                continue
            cells = self.dialect.cells(self.lines[number])
            words = [cell for cell in cells if not is_value(cell)]
            what = f"`{_shown(words[0])}` is not a number" if words else f"has {count} numbers"
            raise SceneError(
                f"line {number + 1}: {what}, and most lines have {self.dialect.columns} numbers; "
                "lines that are no rows begin with `# `"
            )

    def _numbers(self, numbers: list[int]) -> _Array:
        """The numbers of rows, by pandas; of what is none line and column are found."""
        separator = self.dialect.separator or " "
        rows: Iterator[str] = (self.lines[number] for number in numbers)
        if any('"' in self.lines[number] for number in numbers):
            separator = "\t"
            rows = ("\t".join(self.dialect.cells(self.lines[number])) for number in numbers)
        body = "\n".join(rows).encode()
        decimal = "," if separator != "," and body.count(b",") > body.count(b".") else "."
        if b"." not in body and self.dialect.has_decimal_commas([self.lines[number] for number in numbers]):
            raise SceneError(
                f"line {numbers[0] + 1}: its commas look like decimal ones, and separate the numbers, too: "
                f"`{_shown(self.lines[numbers[0]])}`; write decimal points, or separate the numbers by semicolons "
                "or tabs"
            )
        if decimal == "," and b"." in body:
            self._refuse(numbers, decimal)
        if decimal == "," and not _DECIMALS.search(body):
            self.warnings.append(
                "its commas are read as decimal ones: if they part thousands, leave them out"
            )
        blanks = self.dialect.separator is None and separator == " "
        try:
            table = pd.read_csv(
                io.BytesIO(body), sep=r"\s+" if blanks else separator, header=None, dtype=np.float64,
                decimal=decimal, na_values=_SPELLINGS,
                keep_default_na=False, skip_blank_lines=False, skipinitialspace=True, quoting=csv.QUOTE_NONE,
                usecols=range(self.dialect.columns), **_EXACT,
            )  # fmt: skip
            values: _Array = table.to_numpy()
        except (ValueError, OverflowError):
            self._refuse(numbers, decimal)
            raise SceneError("holds what is not a number") from None
        self._check_finite(values, numbers)
        return values

    def _check_finite(self, values: _Array, numbers: list[int]) -> None:
        rows, columns = np.nonzero(np.isinf(values))
        if rows.size:
            raise SceneError(
                f"line {numbers[rows[0]] + 1}, column {columns[0] + 1}: the height is infinite; "
                "nan is a missing one"
            )

    def _refuse(self, numbers: list[int], decimal: str) -> None:
        """Names the first cell that is not a number, if there is one."""
        points, other = ("commas", ".") if decimal == "," else ("points", ",")
        for number in numbers:
            for column, cell in enumerate(self.dialect.cells(self.lines[number])):
                is_number = NUMBER.fullmatch(cell) is not None
                if cell.lower() in MISSING or (is_number and other not in cell):
                    continue
                advice = hint(cell) or (
                    "names of columns and other lines that are no rows begin with `# `, with a blank behind #"
                )
                if is_number:
                    advice = f"there are decimal {points}, too; decimal commas have to be in all numbers or in none"
                elif number > numbers[0] or column > 0:
                    advice = "nan is a missing height; " + advice
                raise SceneError(
                    f"line {number + 1}, column {column + 1}: `{_shown(cell)}` is not a number; {advice}"
                )


def _shown(text: str) -> str:
    """The beginning of a text, as it can be printed."""
    begins = "".join(one if one.isprintable() else "\ufffd" for one in text[:60].replace("\t", " "))
    return begins if len(text) <= 60 else begins + "..."


def _number_of(text: str) -> float:
    """The number that a text begins with, be it with a decimal comma; NaN without one."""
    found = re.match(r"\s*([-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)", text)
    return float(found[1].replace(",", ".")) if found else np.nan


def _said(line: str) -> dict[str, str]:
    """What counts of a line of a header, without the separators that spreadsheets fill it up with."""
    found = {name: pattern.fullmatch(line.strip(" \t;,")) for name, pattern in _HEADER.items()}
    return {name: value[1].strip() for name, value in found.items() if value is not None}


def _counting(values: _Array) -> bool:
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


def _without_labels(values: _Array, line: int, named: bool) -> tuple[_Array, list[str]]:
    """The heights without names of columns and rows that count, as pandas writes them, and what was left out.

    Others that rise or fall evenly are refused: they may be places, and may be heights.
    """
    if min(values.shape) < 4:
        return values, []
    said = []
    if not named and _counting(values[0, 1:]) and _counting(values[1:, 0]):
        values, named = values[1:], True
        said = [f"line {line} has the names of columns: left out"]
    if named:
        return values[:, 1:], [*said, f"column 1 has the names of rows, from {values[0, 0]:g} on: left out"]
    for part, where in ((values, f"line {line}"), (values.T, "column 1")):
        if _counting(part[0]) and _names(part):
            said = [f"{where} counts from {part[0, 0]:g} to {part[0, -1]:g}, as names do: left out"]
            rest, more = _without_labels(values[1:] if part is values else values[:, 1:], line + 1, False)
            return rest, said + more
        if _names(part) or _names(part[:, 1:]):
            first = part[0, 0 if _names(part) else 1]
            raise SceneError(
                f"{where} goes evenly from {first:g} to {part[0, -1]:g}, "
                "as names or places do and heights do not; "
                "take it out, "
                + ("or begin it with `# `" if part is values else "or write the map with numpy.save")
            )
    return values, []


def _grid(values: _Array, block: _Block) -> TextMap:
    rows, columns = values.shape
    header, on = block.header, block.said_on
    for name, count in (("rows", rows), ("columns", columns)):
        stated = _number_of(header.get(name, ""))
        if not np.isnan(stated) and stated != count:
            raise SceneError(f"its header says {stated:g} {name}, and there are {count}")
    found = TextMap(values)
    cell, width, height = (_length_of(header.get(name, "")) for name in ("cell", "width", "height"))
    if width is not None and height is not None:
        sides = (width / columns, height / rows)
        found.pixel = sides
        if abs(sides[0] / sides[1] - 1.0) > _SQUARE:
            shown = " x ".join(quantities.si(side, "m") for side in sides)
            found.doubt = (
                f"the header's width and height (lines {on['width']} and {on['height']}) make pixels of {shown}, "
                f"not square, of {columns} columns and {rows} rows: if the scan was aborted, pixel (--pixel) has to "
                "say the true ones; rows that are wrapped have to be joined; an instrument may have such pixels"
            )
    elif cell is not None:
        found.pixel = (cell, cell)
    elif "cell" in header:
        found.unsaid = f"its cellsize {header['cell']} has no unit"
    return found


def _line(values: _Array, block: _Block) -> TextMap:
    """A line scan: heights in one column or on one line, or two columns, places with even steps and heights."""
    if len(values) == 1 or values.shape[1] == 1:
        header = block.header
        if (
            len(values) > 1
            and {"width", "height"} <= set(header)
            and _number_of(header.get("rows", "")) != 1.0
        ):
            raise SceneError(
                "its header has a width and a height, as of a map, and its numbers are one column: save it as a "
                "matrix, a row of the map on each line"
            )
        width = _length_of(block.header.get("width", ""))
        step = None if width is None else width / values.size
        return TextMap(values.ravel(), None if step is None else (step, step))
    x = on_grid(values[:, 0], "x")
    heights = np.full(x.count, np.nan)
    if np.unique(x.index).size < x.index.size or x.index.size < heights.size / 2:
        raise SceneError("its points x, z have no even steps: only regular line scans are read")
    heights[x.index] = values[:, 1]
    return _placed(heights, block, x, x)


def _length_of(text: str) -> float | None:
    """A length of a header in m, be it with a decimal comma; None without a unit, or if it is not above 0."""
    try:
        value = length("the header", text.replace(",", "."))
    except SceneError:
        return None
    return value if value > 0.0 else None


def _points(values: _Array, block: _Block) -> TextMap:
    """Points x, y, z on a grid as a map: y from row to row, x along the rows, both rising."""
    x, y = (on_grid(values[:, axis], name) for axis, name in enumerate("xy"))
    shape = (y.count, x.count)
    points, places = len(values), x.count * y.count
    if points < places / 2 or min(shape) < 2:
        raise SceneError(
            f"its {points} points x, y, z are no grid: there would be {shape[0]} x {shape[1]} places; {REGULAR}"
        )
    for axis in (x, y):
        if axis.rounded and points != places:
            raise SceneError(f"its points x, y, z are no grid: {axis.name} has no even steps; {REGULAR}")
    heights = np.full(shape, np.nan)
    taken = np.zeros(shape, dtype=bool)
    taken[y.index, x.index] = True
    if taken.sum() != points:
        raise SceneError(f"{points - int(taken.sum())} of its points x, y, z have the place of another one")
    heights[y.index, x.index] = values[:, 2]
    found = _placed(heights, block, x, y)
    if points < places:
        found.warnings.append(f"{places - points} of {places} places of the grid have no point: missing")
    return found


def _placed(heights: _Array, block: _Block, x: Places, y: Places) -> TextMap:
    """Heights with the steps of their places as pixel, if these have a unit."""
    unit = metres(block.header.get("lateral", ""))
    found = TextMap(heights, None if unit is None else (x.step * unit, y.step * unit))
    if unit is None:
        found.steps = Steps(x.step, y.step, block.header.get("lateral") or None, x.off + y.off)
    found.unsaid = x.rounded or y.rounded
    if found.unsaid:
        found.warnings.append(f"{found.unsaid}: taken as even")
    return found
