"""The one style of all figures: the style sheet, colours, labels, legends, axes for the data at hand."""

from __future__ import annotations

import functools
import io
import itertools
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
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator, StrMethodFormatter
from numpy.typing import ArrayLike, NDArray

from .. import quantities

P = ParamSpec("P")
R = TypeVar("R")

__all__ = [
    "BLUE", "COLORS", "DASHED", "DASH_DOT", "GREEN", "GREY", "H_STAR", "INVALID", "LINES", "MARKERS", "MODEL_RANGE", "PINK", "VERMILION",
    "context", "dressed", "empty", "folded", "inches", "is_noise", "label", "legend", "legend_rows", "lettered", "logarithmic", "marked_invalid", "new_axes",
    "picture", "places", "plain", "probability", "readable", "scaled", "steady",
]  # fmt: skip

BLUE, VERMILION, GREEN, PINK = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
COLORS = [BLUE, VERMILION, GREEN, PINK, "#E69F00", "#56B4E9", "black"]
MARKERS = "osD^vP*"
GREY = "0.45"
DASHED, DASH_DOT = (0, (4, 1.6)), (0, (5, 1.2, 1, 1.2))
# Of curves that may coincide.
LINES = ["-", DASH_DOT, DASHED, (0, (1.2, 1.2)), (0, (9, 2)), "-", DASHED]
# In all figures the integral is dashed and black, or an open symbol; means over patches are solid lines, or full symbols.
H_STAR = "separation $h^*=h/\\sigma$"
MODEL_RANGE = "range over plastic contacts"
INVALID = "invalid: not independent"

_SHEET = str(files(__package__).joinpath("stiction.mplstyle"))
# Lengths that widths may be given in, inches.
_LENGTHS = {"mm": 1.0 / 25.4, "cm": 1.0 / 2.54, "in": 1.0, "pt": 1.0 / 72.0}
# Positive data over more than this factor get a logarithmic axis.
_DECADES = 100.0
# Width of the symbol of a legend with its gaps, points.
_SYMBOL = 31.0
# Values of a key up to this many have ticks of their own.
_FEW = 8
# Differences up to this fraction are rounding.
_ROUNDING = 1e-9
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
    return textwrap.shorten(line, _LONGEST, placeholder=" …").replace("$", r"\$").replace("`", "")


def label(words: str, unit: str) -> str:
    """An axis label in words with its unit."""
    words = words.replace("psi of sigma_s", "ψ of σₛ").replace("psi of sigma", "ψ of σ")
    return f"{words} ({unit})" if unit else words


def folded(text: str) -> str:
    """A label of an axis in lines that are not longer than a panel is high."""
    return "\n".join(textwrap.fill(line, 30) for line in text.splitlines())


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


def legend(ax: Axes, handles: Sequence[Any] | None = None, columns: int = 3, title: str | None = None) -> None:
    """A legend above the axes, where no data are, in as many columns as there is room for."""
    kept: list[Artist] = list(ax.get_legend_handles_labels()[0] if handles is None else handles)
    figure: Any = ax.figure
    room = ax.get_position().width * figure.get_figwidth() * 72.0
    font = FontProperties(size=float(matplotlib.rcParams["legend.fontsize"]))

    def width(text: str) -> float:
        """Of the widest line, points."""
        return max((text_to_path.get_text_width_height_descent(line, font, "$" in line)[0] for line in text.splitlines()), default=0.0)

    def wrapped(text: str) -> str:
        letters = int(len(text) * min((room - _SYMBOL) / max(width(text), 1.0), 1.0))
        return "\n".join(part for line in text.splitlines() for part in textwrap.wrap(line, max(letters, 12)))

    texts = [wrapped(str(of.get_label())) for of in kept]
    lengths = [width(text) + _SYMBOL for text in texts]

    def widths(count: int) -> list[float]:
        """The widest of each column, which are filled one after the other."""
        rows, longer = divmod(len(lengths), count)
        ends = [0, *itertools.accumulate(rows + (column < longer) for column in range(count))]
        return [max(lengths[begin:end], default=0.0) for begin, end in itertools.pairwise(ends)]

    fitting = (count for count in range(min(columns, len(kept)), 1, -1) if sum(widths(count)) <= room)
    words = wrapped(title) if title else None
    drawn = ax.legend(kept, texts, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=next(fitting, 1), title=words,
                      title_fontsize=7, alignment="left")  # fmt: skip
    drawn.set_in_layout(True)


def legend_rows(ax: Axes) -> int:
    """How many lines the legend of axes has one above the other."""
    drawn: Any = ax.get_legend()
    if drawn is None:
        return 0
    heights = [1 + words.get_text().count("\n") for words in drawn.get_texts()]
    rows = -(-len(heights) // drawn._ncols)
    most = max((sum(heights[begin : begin + rows]) for begin in range(0, len(heights), rows)), default=0)
    title = drawn.get_title().get_text()
    return most + (1 + title.count("\n") if title else 0)


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
    readable(ax, axis, numbers)
    return True


def readable(ax: Axes, axis: str, values: ArrayLike) -> None:
    """Makes an axis logarithmic, with plain numbers at its ticks where the values span less than three decades."""
    (ax.set_xscale if axis == "x" else ax.set_yscale)("log")
    span = float(np.nanmax(values) / np.nanmin(values))
    if span < 1000.0:
        scale = ax.xaxis if axis == "x" else ax.yaxis
        scale.set_major_locator(LogLocator(subs=(1, 2, 3, 5, 7) if span < 12.0 else (1, 2, 5) if span < 100.0 else (1,)))
        scale.set_major_formatter(StrMethodFormatter("{x:g}"))
        scale.set_minor_formatter(NullFormatter())


def probability(ax: Axes, words: str, lines: Sequence[Any] = ()) -> None:
    """Makes the y axis one of a probability, from 0 to 1; symbols of the lines at its ends are whole."""
    for line in lines:
        line.set_clip_on(False)
    ax.set(ylabel=words, ylim=(0.0, 1.0))


def is_noise(values: ArrayLike, scale: float | None = None) -> bool:
    """Whether values are one number but for rounding, or, with a scale, nothing next to it."""
    numbers = np.asarray(values, dtype=float).ravel()
    numbers = numbers[np.isfinite(numbers)]
    size = np.abs(numbers).max(initial=0.0)
    return bool(size <= _ROUNDING * scale if scale is not None else np.ptp(numbers) <= _ROUNDING * size) if numbers.size else True


def steady(ax: Axes, values: ArrayLike) -> None:
    """Keeps a y axis from showing the rounding of what is one number."""
    numbers = np.asarray(values, dtype=float).ravel()
    numbers = numbers[np.isfinite(numbers)]
    if numbers.size and is_noise(numbers):
        middle = float(numbers.mean())
        ax.set_ylim(min(0.0, 2.0 * middle) if middle else -1.0, max(0.0, 2.0 * middle) if middle else 1.0)


def places(ax: Axes, values: ArrayLike) -> None:
    """Ticks at the places, if they are few; a logarithmic axis if they are spaced by factors rather than by steps."""
    x = np.unique(np.asarray(values, dtype=float))
    x = x[np.isfinite(x)]
    if x.size >= 3 and x[0] > 0.0 and x[-1] > 2.5 * x[0]:
        steps, factors = (np.ptp(of) / of.mean() for of in (np.diff(x), np.diff(np.log(x))))
        if factors < steps:
            readable(ax, "x", x)
    if x.size <= _FEW:
        ax.set_xticks(x, _labels(ax, x))
        ax.xaxis.set_minor_locator(NullLocator())


def _labels(ax: Axes, x: NDArray[np.float64]) -> list[str]:
    """Labels of ticks, left out where they would be in the next one's."""
    figure: Any = ax.figure
    at = np.log(x) if ax.get_xscale() == "log" else x
    width = ax.get_position().width * figure.get_figwidth() * 72.0
    points = (at - at[0]) / (np.ptp(at) or 1.0) * 0.9 * width
    texts = [f"{float(f'{value:.4g}'):g}".replace("-", "−") for value in x]
    half = [0.5 * 7.0 * 0.65 * len(text) + 1.0 for text in texts]
    kept: list[int] = []
    for place in range(x.size):
        if not kept or points[place] - half[place] >= points[kept[-1]] + half[kept[-1]]:
            kept.append(place)
    return [text if place in kept else "" for place, text in enumerate(texts)]
