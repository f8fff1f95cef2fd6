"""How the cells of texts are separated, and which of them are heights."""

from __future__ import annotations

import csv
import re
from collections import Counter
from dataclasses import dataclass

__all__ = ["MISSING", "NUMBER", "Dialect", "any_number", "dialect_of", "hint", "is_value"]

# What instruments, spreadsheets and programs write where there is no height. All else that is no number is
# refused.
MISSING = frozenset({
    "", "-", "--", "---", "*", "nan", "-nan", "na", "n/a", "null", "none", "bad", "missing", "#n/a", "#na",
    "#nv", "1.#qnan", "-1.#ind", "1.#ind", "<na>",
})  # fmt: skip
NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?|[-+]?inf(?:inity)?", re.IGNORECASE)
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
    return cell.lower() in MISSING or NUMBER.fullmatch(cell) is not None


def any_number(cells: list[str]) -> bool:
    """Whether one of the cells has a number."""
    return any(NUMBER.fullmatch(cell) for cell in cells)


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
