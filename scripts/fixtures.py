"""Tables of tests/data, as the reference scripts write them: `git diff` says what has changed."""

import csv
from pathlib import Path

from mpmath import mp

DATA = Path(__file__).resolve().parents[1] / "tests" / "data"


def write(name, columns, rows, end="\n"):
    """Writes a table, of rows in the order of the columns."""
    with open(DATA / name, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator=end)
        table.writerow(columns)
        table.writerows(rows)
    print(DATA / name)


def bisect(is_above, below, above):
    """The place where is_above turns from false, at below, to true, at above, to the digits of mp."""
    if is_above(below) or not is_above(above):
        raise ValueError("no change of sign between the ends")
    for _ in range(mp.prec + 16):
        middle = (below + above) / 2
        below, above = (below, middle) if is_above(middle) else (middle, above)
    return (below + above) / 2
