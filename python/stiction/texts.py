"""Texts with numbers in columns: how they are encoded, how cells are separated, and which of them are numbers or gaps."""

from __future__ import annotations

import codecs
import csv
import os
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from . import quantities
from .errors import FileError

__all__ = [
    "GAPS", "HEIGHT", "MISSING", "SHEET_ERROR", "Dialect", "any_number", "decoded", "dialect_of", "head", "hint", "is_number", "is_value",
    "no_numbers", "opened",
]  # fmt: skip

# The beginnings of files that are no texts, and what they are.
_NO_TEXTS = {
    b"PK\x03\x04": "is a workbook or an archive; save the sheet as CSV",
    b"\xd0\xcf\x11\xe0": "is a workbook; save the sheet as CSV",
    b"\x89HDF": "is an HDF5 file, not a table",
    b"\x1f\x8b": "is compressed; unpack it",
}
_PICTURE = re.compile(rb"\x89PNG|\xff\xd8\xff|GIF8[79]a|BM.{4}\0{4}", re.DOTALL)
# Characters that no text has.
_CONTROLS = bytes(sorted({*range(32)} - {*b"\t\n\v\f\r\x1a\x1b"}))
# What people, spreadsheets and programs write where nothing was measured, in small letters.
GAPS = frozenset({
    "", "na", "n/a", "nan", "-nan", "<na>", "null", "none", "-", "--", "---", "–", "—", "1.#qnan", "-1.#ind", "1.#ind",
    "#n/a", "#na", "#nv",
})  # fmt: skip
# What is written where a height is missing.
MISSING = GAPS | {"*", "bad", "missing"}
# What spreadsheets write there, in any language: #N/A, #NV, #REF!, #NOM?
SHEET_ERROR = r"#(?:N/?[ADV]|[^\W\d_a-z][^\Wa-z]*(?:/[^\Wa-z]+)?[!?])"
_NUMBER = r"[-+−]?(?:[0-9]+{0}?[0-9]*|{0}[0-9]+)(?:[eE][-+]?[0-9]+)?"
# A number in a map.
HEIGHT = re.compile(rf"{_NUMBER.format('[.,]')}|[-+]?inf(?:inity)?", re.IGNORECASE)
# What stands before and behind a decimal comma, and numbers with one between commas and blanks.
_WHOLE, _BEHIND, _PADDED = re.compile(r"[-+]?\d+"), re.compile(r"\d+([eE][-+]?\d+)?"), re.compile(r"[-+]?0\d")
_PAIR = f"{_WHOLE.pattern},{_BEHIND.pattern}"
_PAIRS = re.compile(rf"\s*{_PAIR}(?:,\s+{_PAIR})+[\s,]*")
# Numbers that are written so that they are none here, and what would do.
_FOREIGN = (
    (
        r"[-+]?\d{1,3}(?:\.\d{3})+,\d+",
        "has points between thousands and a decimal comma: leave the points out",
    ),
    (r"[-+]?\d{1,3}(?:,\d{3})+\.\d+", "has commas between thousands: leave them out"),
    (r"[-+]?(?:\d+\.?\d*|\.\d+)[dD][-+]?\d+", "has an exponent of Fortran: write E in the place of D"),
    (
        r"[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?\s*(?:[fpnu\u00b5\u03bcmk]?m|\u00c5|[mu\u00b5]?V)",
        "has a unit: leave the units of the cells out, and give that of heights as height_unit (--height-unit)",
    ),
)
# How many cells in columns of one kind, as every second one, are no chance.
_OTHERS = 12
# Lines and cells of a line that a dialect is found by.
_SAMPLE, _CELLS = 200, 40


def opened(path: str | os.PathLike[str]) -> str:
    """The text of a file of numbers.

    Raises
    ------
    FileError
        It cannot be read, or is no text of numbers.
    """
    try:
        content = Path(path).read_bytes()
    except FileNotFoundError:
        raise FileError(f"{path}: no such file") from None
    except (OSError, ValueError) as error:
        raise FileError(f"{path}: cannot be read: {error}") from None
    what = no_numbers(content) or next((of for mark, of in _NO_TEXTS.items() if content.startswith(mark)), "")
    if what:
        raise FileError(f"{path}: {what}")
    text = decoded(content)
    if text is None:
        raise FileError(f"{path}: cannot be read as text in UTF-8, UTF-16 or Windows-1252")
    return text


def no_numbers(beginning: bytes) -> str:
    """What a file with these first bytes is, where neither a table nor a map may be in it; or nothing."""
    if _PICTURE.match(beginning):
        return "is a picture: colours are no heights and no measured numbers; export these as a text"
    if beginning.startswith(b"version https://git-lfs"):
        return "is a pointer of Git LFS, not the file; run `git lfs pull`"
    return ""


def decoded(data: bytes, *, any_bytes: bool = False) -> str | None:
    """The text of a file by its byte order mark, as UTF-16, UTF-8 or Windows-1252; None if it is no text.

    Lines end with a line feed. With `any_bytes` a text may have bytes that Windows-1252 leaves out, read as Latin-1.

    Examples
    --------
    >>> decoded("1\\t2".encode("utf-16")), decoded("5 µm".encode("cp1252")), decoded(b"\\x00\\x01\\x02")
    ('1\\t2', '5 µm', None)
    """
    coding: str | None = None
    for mark, name in (
        (codecs.BOM_UTF8, "utf-8-sig"),
        (codecs.BOM_UTF16_LE, "utf-16"),
        (codecs.BOM_UTF16_BE, "utf-16"),
    ):
        if data.startswith(mark):
            coding = name
    beginning = data[:4096]
    if coding is None and b"\0" in beginning:
        # Texts of UTF-16 without a mark have a NUL in every other byte.
        odd, even = beginning[1::2].count(0), beginning[0::2].count(0)
        if max(odd, even) < 4 * min(odd, even) + len(beginning) // 4:
            return None
        coding = "utf-16-le" if odd > even else "utf-16-be"
    if coding is None and len(data.translate(None, _CONTROLS)) < len(data):
        return None
    for name in (coding,) if coding else ("utf-8", "cp1252", *(["latin-1"] if any_bytes else [])):
        try:
            text = data.decode(name)
        except UnicodeDecodeError:
            continue
        return text.rstrip("\x1a").replace("\r\n", "\n").replace("\r", "\n")
    return None


def is_number(cell: str, decimal: str = ".,") -> bool:
    """Whether a cell is a number, with one of these characters before its decimals."""
    return re.fullmatch(_NUMBER.format(f"[{decimal}]"), cell) is not None


def head(text: str) -> tuple[str, str]:
    """Name and unit of what stands above a column."""
    bracket = re.fullmatch(r"(.*?)\s*[(\[{]\s*([^)\]}]*?)\s*[)\]}]", text)
    if bracket is not None:
        return _plain(bracket[1]), bracket[2]
    for place in (found.start() for found in re.finditer(r"[\s_]", text)):
        name, written = text[:place].rstrip(" ,:/_"), text[place + 1 :]
        try:
            quantities.unit(written)
        except ValueError:
            continue
        if name and written:
            return _plain(re.sub(r"[\s_]in$", "", name)), written
    return _plain(text), ""


def _plain(name: str) -> str:
    return re.sub(r"[\s-]+", "_", name.strip().lower())


@dataclass
class Dialect:
    """How cells are separated: `separator` is None for blanks; `columns` is how many cells most lines have.

    `trailing` says that there is a separator behind the last cell, too.
    """

    separator: str | None
    columns: int = 0
    trailing: bool = False

    def cells(self, line: str) -> list[str]:
        """The cells of a line, without quotes and blanks around them."""
        if self.separator is None:
            return [cell.strip('"') for cell in line.split()]
        cells = [cell.strip() for cell in next(csv.reader([line], delimiter=self.separator), [])]
        return cells[:-1] if self.trailing and cells and cells[-1] == "" else cells

    def count(self, line: str) -> int:
        """How many cells a line has."""
        if '"' in line:
            return len(self.cells(line))
        if self.separator is None:
            return len(line.split())
        return line.count(self.separator) + 1 - (self.trailing and line.rstrip(" ")[-1:] == self.separator)

    def has_decimal_commas(self, lines: list[str]) -> bool:
        """Whether rows have decimal commas in numbers that commas separate: every second cell is no whole number."""
        some = lines[:: len(lines) // _SAMPLE + 1]
        if self.separator != "," or any('"' in line for line in some):
            return False
        if all(_PAIRS.fullmatch(line) for line in some):
            return True
        rows = [self.cells(line)[:_SAMPLE] for line in some]
        whole, behind = ([cell for row in rows for cell in row[first::2]] for first in (0, 1))
        found = [_BEHIND.fullmatch(cell) for cell in behind]
        if len(whole) != len(behind) or not all(found) or not all(_WHOLE.fullmatch(cell) for cell in whole):
            return False
        if all(one[1] for one in found if one):
            return True
        lengths = {len(cell) for cell in behind}
        # 0225 and 05 stand behind a comma only.
        padded = any(map(_PADDED.match, behind)) and not any(map(_PADDED.match, whole))
        # Columns of a map have signs, and numbers of other lengths, where their neighbours have.
        other = [
            column
            for row in rows
            for column, cell in enumerate(row)
            if cell[0] == "-" or len(cell) not in lengths
        ]
        return len(lengths) == 1 and (padded or (len(other) >= _OTHERS and len(set(other)) > 2))


def is_value(cell: str) -> bool:
    """Whether a cell has a number, or says that a height is missing."""
    return cell.lower() in MISSING or HEIGHT.fullmatch(cell) is not None


def any_number(cells: list[str]) -> bool:
    """Whether one of the cells has a number."""
    return any(HEIGHT.fullmatch(cell) for cell in cells)


def hint(text: str) -> str:
    """What a number at the beginning of a text looks like, and what would do; empty if nothing is known."""
    for pattern, said in _FOREIGN:
        if found := re.match(rf"\s*({pattern})(?![\w.])", text):
            return f"`{found[1]}` {said}"
    return ""


def dialect_of(lines: list[str]) -> Dialect:
    """How the cells of lines are separated, and how many most have, by the last lines: headers come first."""
    best, most, rows = Dialect(None), 0, []
    for dialect in (Dialect("\t"), Dialect(";"), Dialect(","), Dialect(None)):
        of_numbers = [line for line in lines[-_SAMPLE:] if _has_numbers(dialect, line)]
        if len(of_numbers) > most:
            best, most, rows = dialect, len(of_numbers), of_numbers
    if best.separator is not None:
        best.trailing = all(line.rstrip(" ").endswith(best.separator) for line in rows)
    counts = Counter(best.count(line) for line in rows)
    # Of two that are as frequent the longer one.
    best.columns = max(counts, key=lambda count: (counts[count], count), default=0)
    return best


def _has_numbers(dialect: Dialect, line: str) -> bool:
    """Whether the separator is in a line, and more numbers than words are between it."""
    separator = dialect.separator
    if separator is not None and separator not in line:
        return False
    if separator == "," and len(line.split()) > 1 and not re.search(r",\s|\s,", line.strip()):
        # Blanks separate 1,5 2,5, and never follow a comma.
        return False
    cells = [cell for cell in dialect.cells(line)[:_CELLS] if cell]
    numbers = sum(is_value(cell) for cell in cells)
    return 2 * numbers > len(cells)
