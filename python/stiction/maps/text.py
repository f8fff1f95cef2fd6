"""Height maps in texts: their dialect and header are found here, and pandas reads the numbers."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd
import xarray
from numpy.typing import NDArray

from .. import quantities
from ..errors import SceneError
from ..texts import HEIGHT, MISSING, any_number, dialect_of, hint, is_value
from .channels import numbered
from .declared import Raw, unpacked
from .labels import counting, without_labels, wrapped
from .lengths import Steps, length
from .places import BLOCK, MOST_AXES, NAMED, axes_of, on_grid, placed, points

__all__ = ["LINE_SCAN", "NoNumbers", "read"]

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
    "channel": "name|Channel|Kanál|Kanal|Canal|Canale|チャネル|채널|Канал",
    "width": "Width|Šířka|Breite|Anchura|Largeur|Larghezza|幅|폭|Largura|Ширина|X Amplitude|x-length",
    "height": "Height|Výška|Höhe|Altura|Hauteur|Altezza|高さ|높이|Высота|Y Amplitude|y-length",
    "unit": "Units?|Value units|Jednotky hodnot|Einheiten|Unités|unità valore|値の単位|값 단위|Unidades de valor"
    "|Единицы измерения|z-unit|data unit",
    "lateral": "Lateral units",
}
# Keys that blanks may separate from their values, as in grids of ESRI.
_KEYS = {
    "columns": r"ncols|Number of columns|x-pixels|Horizontal|columns(?=\s*[:=])|Samps/line",
    "rows": r"nrows|Number of rows|y-pixels|Vertical|rows(?=\s*[:=])|Number of lines",
    "missing": "no_?data(?:[_ ]?value)?|missing_value|_FillValue",
    "cell": "cellsize|pixel size|XY calibration",
    "step x": "dx|x[ -](?:step|spacing|pixel size)",
    "step y": "dy|y[ -](?:step|spacing|pixel size)",
    "scale": r"height conversion factor \(-> *m\)",
}
_HEADER = {
    name: re.compile(rf"(?:{labels})\s*{colon}\s*(.+)", re.IGNORECASE)
    for known, colon in ((_LABELS, "[:=：]"), (_KEYS, "[:=：\\s]"))
    for name, labels in known.items()
}
# What ESRI takes for NODATA_value where a grid does not say it.
_ESRI_MISSING = -9999.0
# Numbers to their last bit, which pandas gives from 3 on by default.
_EXACT = {} if int(pd.__version__.split(".")[0]) >= 3 else {"float_precision": "round_trip"}
# Pixels of other sides than that are not square.
_SQUARE = 0.01


class NoNumbers(SceneError):
    """A text has no row of numbers."""


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


def read(text: str, channel: str | None = None) -> Raw:
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
    lines = text.replace("−", "-").split("\n")
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
        comments: list[int] = []
        for number, line in enumerate(self.lines):
            block = blocks[-1]
            comment = _COMMENT.fullmatch(line)
            if _EMPTY.fullmatch(line):
                if line.strip() or self.dialect.count(line) == self.dialect.columns:
                    empty.append(number)
            elif comment and self._is_comment(number, comment[1], bool(block.lines)):
                said = self._said(comment[1])
                if "channel" in said and block.lines:
                    blocks.append(_Block())
                self._is_axes(comment[1], blocks[-1])
                blocks[-1].says(said, number + 1)
                comments.append(number)
            elif not block.lines and self._is_header(line, block):
                block.says(self._said(line), number + 1)
            else:
                block.lines += [*(empty if block.lines else []), number]
                empty = []
        blocks = [part for block in blocks if block.lines for part in self._slices(block, comments)]
        if not blocks:
            first = next((line.strip() for line in self.lines if line.strip()), "")
            begins = f"; it begins with `{_shown(first)}`" if first else ", but blanks"
            written = hint(next((line for line in self.lines if hint(line)), "")) or (
                "a text has a row of the map on each line"
            )
            raise NoNumbers(f"holds no row of numbers{begins}: {written}")
        return blocks

    def _slices(self, block: _Block, comments: list[int]) -> list[_Block]:
        """The maps of one size into which comments part rows, as numpy.savetxt is used; others are named."""
        part = np.searchsorted(comments, block.lines)
        sizes = np.unique(part, return_counts=True)[1]
        if sizes.size == 1 or sizes.min() < BLOCK or block.axes is not None or self.dialect.columns <= BLOCK:
            return [block]
        if np.ptp(sizes) > 0:
            listed = ", ".join(str(size) for size in sizes[:12])
            self.warnings.append(
                f"comments part its rows into {sizes.size} blocks of {listed} rows, which are read as one map: if each "
                "block is a map, save it in a file of its own"
            )
            return [block]
        ends = np.cumsum(sizes).tolist()
        return [replace(block, lines=block.lines[end - sizes[0] : end]) for end in ends]

    def _said(self, line: str) -> dict[str, str]:
        """What counts of a line of a header, without the separators that spreadsheets fill it up with.

        A key and its value may be cells, as `"Unit","um"`, or have a colon between them."""
        line = line.strip(" \t;,")
        cells = [cell for cell in self.dialect.cells(line) if cell] if self.dialect.separator else []
        if len(cells) > 1 and not re.search("[:=：]", cells[0]):
            line = f"{cells[0]}: {' '.join(cells[1:])}"
        found = {name: pattern.fullmatch(line) for name, pattern in _HEADER.items()}
        return {name: value[1].strip() for name, value in found.items() if value is not None}

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
        found = axes_of([name[0] for name in NAMED.finditer(line)], line_scans=True)
        if found is None or block.lines:
            return False
        # The column of names of rows of pandas has none itself.
        unnamed = self.dialect.columns - len(found.names)
        if unnamed not in (0, 1) or len(found.names) > MOST_AXES:
            return False
        block.header |= {("unit" if axis == "z" else axis): unit for axis, unit in found.units.items()}
        block.axes = [*(["name of the row"] * unnamed), *found.names]
        return True

    def map(self, block: _Block) -> Raw:
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
        if "scale" in header:
            scale = {"scale_factor": header["scale"].split()[0]}
            values = unpacked("its header", xarray.Variable(("y", "x"), values, scale)).values
            header["unit"] = "m"
        if is_line or are_points:
            values = values[[not _EMPTY.fullmatch(self.lines[number]) for number in numbers]]
        else:
            said = wrapped(values)
            if not said:
                values, said = without_labels(values, f"line {numbers[0] + 1}", names_of_columns)
            self.warnings += [*said, *self._parted(numbers)]
        if header.get("missing") or "cell" in header:
            missing = _number_of(header.get("missing", "")) if "missing" in header else _ESRI_MISSING
            values[np.isclose(values, missing, rtol=1e-6, atol=0.0)] = np.nan
        if block.axes is not None and are_points:
            if block.axes[0] == "name of the row" and not counting(values[:, 0]):
                raise SceneError(f"its header names {columns - 1} columns, and there are {columns}")
            values = values[:, [block.axes.index(axis) for axis in ("x", "y", "z")]]
        if are_points:
            found = points(values, _units(block))
        else:
            found = (_line if is_line else _grid)(values, block)
        found.unit, found.channel = header.get("unit") or None, header.get("channel", "")
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
        if len(numbers) > 1 and len(cells) == self.dialect.columns - 1 and counting(np.array(counts)):
            first = [
                _number_of(next(iter(self.dialect.cells(self.lines[number])), "")) for number in numbers[1:]
            ]
            if counting(np.array(first)):
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
                is_number = HEIGHT.fullmatch(cell) is not None
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


def _grid(values: _Array, block: _Block) -> Raw:
    rows, columns = values.shape
    header, on = block.header, block.said_on
    for name, count in (("rows", rows), ("columns", columns)):
        stated = _number_of(header.get(name, ""))
        if not np.isnan(stated) and stated != count:
            raise SceneError(f"its header says {stated:g} {name}, and there are {count}")
    found = Raw(values)
    width, height = (_length_of(header.get(name, "")) for name in ("width", "height"))
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
    else:
        _of_cells(found, header)
    return found


def _of_cells(found: Raw, header: dict[str, str]) -> None:
    """The pixel or the steps that a header gives for cells: one for both sides, or one for each."""
    said = [header.get(f"step {axis}") or header.get("cell", "") for axis in "xy"]
    if not all(said):
        return
    width, height = (_length_of(re.sub(r"/ *(?:pixels?|px)$", "", one)) for one in said)
    if width is not None and height is not None:
        found.pixel = (width, height)
        return
    what = f"cellsize {said[0]} has" if said[0] == said[1] else f"steps {said[0]} and {said[1]} have"
    found.unsaid = f"its {what} no unit"
    x, y = (_number_of(one) for one in said)
    if x > 0.0 and y > 0.0:
        found.steps = Steps(x, y)


def _line(values: _Array, block: _Block) -> Raw:
    """A line scan: heights in one column or on one line, or two columns, places with even steps and heights."""
    if len(values) == 1 or values.shape[1] == 1:
        header, rows = block.header, _number_of(block.header.get("rows", ""))
        sizes = [{"width", "height"}, {"rows", "columns"}]
        stated = next((sorted(pair) for pair in sizes if pair <= set(header)), None)
        if stated and rows != 1.0 and (len(values) > 1 or rows > 1.0):
            raise SceneError(
                f"its header has {stated[1]} and {stated[0]} of a map, and its numbers are one column: save it as a "
                "matrix, a row of the map on each line"
            )
        width = _length_of(block.header.get("width", ""))
        step = None if width is None else width / values.size
        return Raw(values.ravel(), None if step is None else (step, step))
    x = on_grid(values[:, 0], "x")
    heights = np.full(x.count, np.nan)
    if np.unique(x.index).size < x.index.size or x.index.size < heights.size / 2:
        raise SceneError("its points x, z have no even steps: only regular line scans are read")
    heights[x.index] = values[:, 1]
    return placed(heights, x, x, _units(block))


def _length_of(text: str) -> float | None:
    """A length of a header in m, be it with a decimal comma; None without a unit, or if it is not above 0."""
    try:
        value = length("the header", text.replace(",", "."))
    except SceneError:
        return None
    return value if value > 0.0 else None


def _units(block: _Block) -> tuple[str, str]:
    """The units of x and y of points; a column without one has that of the other."""
    x, y = (block.header.get(axis) or block.header.get("lateral", "") for axis in "xy")
    return x or y, y or x
