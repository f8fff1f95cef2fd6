"""The one style of all figures: the style sheet, colours, labels, legends, axes for the data at hand."""

from __future__ import annotations

import functools
import io
import math
import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.resources import files
from typing import Any, ParamSpec, TypeVar

import matplotlib.style
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter
from numpy.typing import ArrayLike

from .. import quantities

P = ParamSpec("P")
R = TypeVar("R")

__all__ = [
    "BLUE", "COLORS", "DASHED", "DASH_DOT", "GREEN", "GREY", "H_STAR", "INVALID", "MARKERS", "MODEL_RANGE", "PINK", "VERMILION",
    "context", "dressed", "empty", "inches", "label", "legend", "lettered", "logarithmic", "marked_invalid", "new_axes", "picture",
    "places_logarithmic", "plain", "scaled",
]  # fmt: skip

BLUE, VERMILION, GREEN, PINK = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
COLORS = [BLUE, VERMILION, GREEN, PINK, "#E69F00", "#56B4E9", "black"]
MARKERS = "osD^vP*"
GREY = "0.45"
DASHED, DASH_DOT = (0, (4, 1.6)), (0, (5, 1.2, 1, 1.2))
# In all figures the integral is dashed and black, or an open symbol; means over patches are solid lines, or full symbols.
H_STAR = "separation $h^*=h/\\sigma$"
MODEL_RANGE = "range over plastic contacts"
INVALID = "invalid: not independent"

_SHEET = str(files(__package__).joinpath("stiction.mplstyle"))
# Lengths that widths may be given in, inches.
_LENGTHS = {"mm": 1.0 / 25.4, "cm": 1.0 / 2.54, "in": 1.0, "pt": 1.0 / 72.0}
# Positive data over more than this factor get a logarithmic axis.
_DECADES = 100.0
# Characters of a text of a file that are shown.
_LONGEST = 80


@contextmanager
def context() -> Iterator[None]:
    """The style sheet, for the figures that are made within."""
    with matplotlib.style.context(_SHEET):
        yield
        interactive = matplotlib.rcParams["interactive"]
    # A backend that the first figure has loaded, such as that of notebooks, says so there.
    matplotlib.rcParams["interactive"] = interactive


def dressed(function: Callable[P, R]) -> Callable[P, R]:
    """A function that draws in the style."""

    @functools.wraps(function)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> R:
        with context():
            return function(*args, **kwargs)

    return drawn


def inches(width: str | float) -> float:
    """A width in inches from a text such as ``85mm``; numbers are mm.

    Raises
    ------
    ValueError
        It is no length, or none between 40 mm and 1 m.

    Examples
    --------
    >>> inches("2in"), round(inches(85), 3)
    (2.0, 3.346)
    """
    found = re.fullmatch(r"\s*([\d.]+)\s*(mm|cm|in|pt)?\s*", str(width))
    try:
        value = float(found[1]) * _LENGTHS[found[2] or "mm"] if found else math.nan
    except ValueError:
        value = math.nan
    if not 40.0 / 25.4 <= value <= 1000.0 / 25.4:
        raise ValueError(f"width = {width}: a length from 40mm to 1000mm is needed, such as 85mm or 3.3in")
    return value


def new_axes(ax: Axes | None) -> Axes:
    """The axes that are given, or axes of a new figure as wide as a column."""
    if ax is not None:
        return ax
    from matplotlib import pyplot

    return pyplot.figure(figsize=(inches(90), inches(68))).add_subplot()


def scaled(unit: str, *values: ArrayLike) -> tuple[float, str]:
    """The factor to divide all of the values by, and their unit then."""
    finite = np.concatenate([np.ravel(np.asarray(value, dtype=float)) for value in values])
    return quantities.factor_and_unit(finite, unit)


def plain(text: Any) -> str:
    """A text of a file as figures show it: no formula, in one line, and not too long."""
    line = "".join(one if one.isprintable() else " " for one in str(text))
    return textwrap.shorten(line, _LONGEST, placeholder=" …").replace("$", r"\$")


def label(words: str, unit: str) -> str:
    """An axis label in words with its unit."""
    words = words.replace("psi of sigma_s", "ψ of σₛ").replace("psi of sigma", "ψ of σ")
    return f"{words} ({unit})" if unit else words


def lettered(ax: Axes, place: int) -> None:
    """(a), (b) and so on at the upper left of axes, next to their legend."""
    ax.annotate(f"({'abcdefghijklmnop'[place]})", (0, 1), xycoords="axes fraction", xytext=(-6, 3), textcoords="offset points",
                ha="right", va="bottom", annotation_clip=False)  # fmt: skip


def picture(figure: Figure, ending: str, dpi: float | None = None) -> bytes:
    """A figure as a file with an ending such as ``.svg`` has it; the same figure gives the same bytes."""
    stream, undated = io.BytesIO(), {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    with context():
        figure.savefig(stream, format=ending[1:].lower(), dpi=dpi, metadata=undated.get(ending.lower()))
    return stream.getvalue()


def legend(ax: Axes, handles: Sequence[Any] | None = None, columns: int = 2) -> None:
    """A legend above the axes, where no data are."""
    handles = ax.get_legend_handles_labels()[0] if handles is None else handles
    figure: Any = ax.figure
    width = ax.get_position().width * figure.get_figwidth()
    longest = max((len(row) for handle in handles for row in str(handle.get_label()).splitlines()), default=0)
    # A letter is about half as wide as its font is high.
    columns = max(1, min(columns, int(width * 72.0 / (7.0 * 0.52 * longest + 26.0)))) if longest else 1
    kept: list[Artist] = list(handles)
    drawn = ax.legend(handles=kept, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns)
    drawn.set_in_layout(True)


def marked_invalid(ax: Axes, x: ArrayLike, y: ArrayLike, invalid: ArrayLike) -> list[Artist]:
    """Marks the part of a curve that the file says is invalid by a broad line under it, and returns what the legend has of it."""
    there = np.asarray(invalid, dtype=bool)
    if not there.any():
        return []
    line = ax.plot(np.asarray(x, float), np.where(there, np.asarray(y, float), np.nan), color=GREY, alpha=0.3, linewidth=7.0,
                   solid_capstyle="round", zorder=0.8, label=INVALID)  # fmt: skip
    return list(line)


def empty(ax: Axes, reason: str) -> Axes:
    """Axes that have nothing to show, and why."""
    ax.text(0.5, 0.5, reason, ha="center", va="center", transform=ax.transAxes, wrap=True)
    ax.set(xticks=[], yticks=[])
    return ax


def logarithmic(ax: Axes, axis: str, values: ArrayLike) -> bool:
    """Makes an axis logarithmic if all values are positive and span more than two decades, and says whether."""
    numbers = np.asarray(values, dtype=float).ravel()
    numbers = numbers[np.isfinite(numbers)]
    if not numbers.size or not numbers.min() > 0.0 or numbers.max() < _DECADES * numbers.min():
        return False
    (ax.set_xscale if axis == "x" else ax.set_yscale)("log")
    return True


def places_logarithmic(ax: Axes, values: ArrayLike) -> None:
    """Makes the x axis logarithmic if places are spaced by factors rather than by steps."""
    x = np.unique(np.asarray(values, dtype=float))
    if x.size < 3 or not x[0] > 0.0 or not x[-1] > 2.5 * x[0]:
        return
    steps, factors = (np.ptp(of) / of.mean() for of in (np.diff(x), np.diff(np.log(x))))
    if factors < steps:
        ax.set_xscale("log")
        if x[-1] < 1000.0 * x[0]:
            ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 3, 5, 7) if x[-1] < 12 * x[0] else (1, 2, 5)))
            ax.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            ax.xaxis.set_minor_formatter(NullFormatter())
