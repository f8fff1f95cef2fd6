"""Tables of other programs: texts with a name above each column, of spreadsheets, pandas and instruments."""

from __future__ import annotations

import csv
import difflib
import itertools
import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
import xarray

from . import quantities
from .errors import FileError
from .texts import GAPS, SHEET_ERROR, head, is_number, opened

__all__ = ["Column", "Table", "meant", "read", "read_table"]

Name = str | os.PathLike[str]

# Lines that a quoted cell may have, as names above columns in spreadsheets do.
_MOST_LINES = 20


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    name : str
        What stands above it without its unit: small letters, with underlines for spaces and hyphens.
    unit : str
        Its unit as the file writes it, or nothing.
    place : int
        From 1.
    cells : tuple of str
        Its texts, without spaces around them.
    table : Table
        The table that it is of.
    """

    name: str
    unit: str
    place: int
    cells: tuple[str, ...]
    table: Table = field(repr=False)

    @property
    def title(self) -> str:
        """Its name and unit in messages, behind the file and the line of the names."""
        return f"{self.table.path}, line {self.table.header}, column {self.place} ({self.name})"

    def where(self, row: int) -> str:
        """File, line and column of a cell."""
        return f"{self.table.path}, line {self.table.lines[row]}, column {self.place} ({self.name})"

    def is_gap(self, row: int) -> bool:
        """Whether nothing, or the error of a spreadsheet, is in a cell."""
        cell = self.cells[row]
        return cell.casefold() in GAPS or re.fullmatch(SHEET_ERROR, cell) is not None

    def is_text(self) -> bool:
        """Whether something is in it, and no number anywhere."""
        given = [cell for row, cell in enumerate(self.cells) if not self.is_gap(row)]
        return bool(given) and not any(is_number(cell.lstrip("<> ")) for cell in given)

    def number(self, row: int, *, behind: int = 0) -> str:
        """The number in a cell, behind some characters, as Python writes it.

        Raises
        ------
        FileError
            It is a gap or no number; the message has its line and column.
        """
        cell = self.cells[row]
        text = cell[behind:].strip()
        where = self.where(row)
        if self.is_gap(row):
            raise FileError(f"{where}: {cell or 'nothing'}: a gap; fill it, or take the line out")
        comma = self.table.comma
        if is_number(text, "," if comma else "."):
            return text.replace(",", ".").replace("−", "-")
        if is_number(text):
            other = f"{comma} has a decimal comma" if comma else "commas are between the columns"
            raise FileError(
                f"{where}: {cell}, but {other}; write all numbers with points, or semicolons between columns"
            )
        raise FileError(f"{where}: {cell} is not a number")

    def value(self, row: int, unit: quantities.Unit, *, behind: int = 0) -> float:
        """The number in a cell, behind some characters, in SI units.

        Raises
        ------
        FileError
            As `number`, and where it is too large.
        """
        try:
            return unit.value(self.number(row, behind=behind))
        except ValueError as error:
            raise FileError(f"{self.where(row)}: {error}") from None

    def measured_in(self) -> quantities.Unit:
        """Its unit.

        Raises
        ------
        FileError
            It is no unit of a scene.
        """
        try:
            return quantities.unit(self.unit)
        except ValueError as error:
            raise FileError(f"{self.title}: {error}") from None


@dataclass
class Table:
    """A table.

    Attributes
    ----------
    path : str
        The file.
    header : int
        The line with the names, from 1.
    lines : tuple of int
        The line of each row.
    comma : str
        The place of a decimal comma, or nothing if numbers have points.
    columns : tuple of Column
    """

    path: str
    header: int
    lines: tuple[int, ...]
    comma: str = ""
    columns: tuple[Column, ...] = ()


def read(path: Name) -> Table:
    """Reads a table in the dialect that is found.

    Commas, semicolons or tabs are between columns; numbers have points, or commas where no commas are between
    columns. The text is in UTF-8, UTF-16 or Windows-1252. Cells may be quoted, and lines that begin with # are
    comments, but for errors of spreadsheets; below the names such a line with the cells of a row is refused. A
    column's unit is in brackets or behind its name: ``force (uN)``, ``force [uN]``, ``force uN``, ``force_uN``.
    Empty lines are left out, but among the rows of one column alone.

    Raises
    ------
    FileError
        The file cannot be read, a row begins with # or has another number of cells than the header, or two
        columns have one name.
    """
    text = opened(path)
    records = itertools.dropwhile(lambda record: record[1] == [""], _records(str(path), text))
    header, names = next(records, (1, []))
    rows = [(line, row) for line, row in records if row != [""] or len(names) == 1]
    if not rows:
        raise FileError(f"{path}: a header and a line for each row are needed")
    if all(map(is_number, names)):
        raise FileError(f"{path}, line {header}: numbers, where the names of the columns belong")
    width = len(names)
    for line, row in rows:
        if len(row) < width or any(row[width:]):
            comma = "; a number has a point where commas are between columns" if len(row) > width else ""
            raise FileError(f"{path}, line {line}: {len(row)} cells, where the header has {width}{comma}")
    table = Table(str(path), header, tuple(line for line, _ in rows))
    columns = []
    for place, (name, cells) in enumerate(
        zip(names, zip(*(row[:width] for _, row in rows), strict=True), strict=True), 1
    ):
        if name or any(cells):
            columns.append(Column(*head(name), place, cells, table))
    _check_names(f"{path}, line {header}", names, columns)
    table.columns = tuple(columns)
    if _separator(text) != ",":
        table.comma = next(_commas(columns), "")
    return table


def read_table(path: Name) -> xarray.Dataset:
    """Reads a table of another program, such as a spreadsheet: its numbers in SI units.

    Commas, semicolons or tabs between columns, points or commas in numbers, quoted cells and the usual encodings
    are found; lines that begin with # are comments, unless they have the cells of a row. A column's unit is in
    brackets or behind its name,
    ``radius (nm)`` or ``radius_nm``; without one its numbers are taken as they are.

    Parameters
    ----------
    path : path
        A text with a name above each column.

    Returns
    -------
    xarray.Dataset
        A variable over ``row`` for each column, named by it in small letters, with the SI unit as attribute; of
        labels a variable of texts.

    Raises
    ------
    FileError
        A cell is a gap or no number, a unit is none of scenes, two columns have one name; the message has line
        and column.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "tips.csv"
    >>> _ = file.write_text("Tip;Radius (nm)\\nA;20,5\\nB;18\\n")
    >>> read_table(file).radius.values.tolist()
    [2.05e-08, 1.8e-08]
    """
    variables = {}
    for column in read(path).columns:
        if column.is_text() and not column.unit:
            variables[column.name or "row_name"] = xarray.Variable("row", list(column.cells))
            continue
        of = column.measured_in()
        numbers = [column.value(row, of) for row in range(len(column.cells))]
        variables[column.name or "row_name"] = xarray.Variable("row", np.array(numbers), {"units": of.si})
    return xarray.Dataset(variables)


def meant(name: str, known: Iterable[str]) -> str:
    """A question for the name that was probably meant, or nothing."""
    names = list(known)
    near = difflib.get_close_matches(name, names, n=1) or [one for one in names if name and name in one]
    return f"; did you mean {near[0]}?" if near else ""


def _is_blank(line: str) -> bool:
    return not line.strip(" ")


def _is_comment(line: str) -> bool:
    start = line.lstrip()
    return start.startswith("#") and re.match(rf"{SHEET_ERROR}\s*(?:[,;\t]|$)", start) is None


def _separator(text: str) -> str:
    """What is between columns, by the line of the names; Excel may say it in a line of its own."""
    first = next((line for line in text.split("\n") if not _is_blank(line) and not _is_comment(line)), "")
    if (found := re.fullmatch(r"sep=(.)", first.strip("\ufeff "))) is not None:
        return found[1]
    bare = re.sub(r'"[^"]*"', "", first)
    return next((one for one in "\t;" if one in bare), ",")


def _records(path: str, text: str) -> Iterator[tuple[int, list[str]]]:
    """Lines, from 1, and cells of what is no comment; an empty line is a cell without anything in it."""
    lines, separator = text.rstrip(" \n").split("\n"), _separator(text)
    place, width = 0, 0
    while place < len(lines):
        line, taken = lines[place], 1
        if _is_blank(line):
            yield place + 1, [""]
        elif _is_comment(line):
            _check_comment(f"{path}, line {place + 1}", line, separator, width)
        elif not re.fullmatch(r"sep=.", line.strip()):
            cells, taken = _cells(path, lines[place : place + _MOST_LINES], place + 1, separator)
            width = width or len(cells)
            yield place + 1, cells
        place += taken


def _check_comment(where: str, line: str, separator: str, width: int) -> None:
    """Refuses a comment that is a row, as its label or what a spreadsheet wrote for a number begins with #."""
    if width == 1 and re.fullmatch(r"##+", line.strip()):
        advice = "write the number, or take the line out"
        raise FileError(f"{where}: # alone, where a column was too narrow; {advice}")
    fewest, most = (text.count(separator) + 1 for text in (line.rstrip(f"{separator} "), line))
    others = [cell.strip('" ') for cell in line.split(separator)[1:]]
    is_row = any(map(is_number, others)) or not any(others)
    if width > 1 and fewest <= width <= most and (is_row or line.lstrip().startswith("##")):
        raise FileError(
            f"{where}: begins with #, as a comment, and has the cells of a row; put quotes around the label, "
            "or take the line out"
        )


def _cells(path: str, lines: list[str], number: int, separator: str) -> tuple[list[str], int]:
    """The cells of the first of some lines, and the number of lines that they take."""
    problem = ""
    for taken in range(1, len(lines) + 1):
        try:
            cells = next(
                csv.reader(
                    ["\n".join(lines[:taken])], delimiter=separator, skipinitialspace=True, strict=True
                )
            )
            return [" ".join(cell.split()) for cell in cells], taken
        except csv.Error as error:
            problem = problem or str(error)
            if "unexpected end of data" not in problem:
                break
    raise FileError(f"{path}, line {number}: {problem}; the quotation marks of a cell begin and end it")


def _check_names(where: str, written: list[str], columns: list[Column]) -> None:
    for place, text in enumerate(written, 1):
        # As pandas has them.
        numbered = re.fullmatch(r"(.*[^\d.].*)\.\d+", text)
        if numbered is not None and numbered[1] in written:
            raise FileError(f"{where}: column {place} is a second one of `{numbered[1]}`; leave one out")
    names: dict[str, int] = {}
    for column in columns:
        if column.name in names:
            raise FileError(
                f"{where}: the columns {names[column.name]} and {column.place} are both "
                f"`{column.name}`; leave one out"
            )
        if not column.name and column.place > 1:
            raise FileError(f"{where}: column {column.place} has no name")
        names[column.name] = column.place


def _commas(columns: list[Column]) -> Iterator[str]:
    """Places of numbers with a comma."""
    for column in columns:
        for row, cell in enumerate(column.cells):
            if "," in cell and is_number(cell.lstrip("<> "), ","):
                yield f"line {column.table.lines[row]}, column {column.place}"
