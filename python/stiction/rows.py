"""Rows of a label and a text, in lines of at most 80 columns."""

from __future__ import annotations

import textwrap

__all__ = ["row"]

# Columns of a line.
_COLUMNS = 80


def row(label: str, text: str, start: int) -> list[str]:
    """A label and its text, which begins in a column and is continued below that.

    Examples
    --------
    >>> row("heights", "standard deviation 1.480 nm", 20)
    ['  heights           standard deviation 1.480 nm']
    """
    first = f"  {label:<{start - 2}}"
    return textwrap.wrap(text, _COLUMNS, initial_indent=first, subsequent_indent=" " * start, break_on_hyphens=False) or [first]
