"""What accuracy costs: one page of work-precision diagrams, error over time, down and to the left is better.

(a) sums: one replica of case II, error relative to the sum of magnitudes, over seconds per replica;
(b) monte_carlo: relative standard error of the mean pull-off over seconds, with lines of slope -1/2, along which more
    replicas of the same estimator move;
(c) integral: relative error of the statistical integral over seconds;
(d) peers: error over seconds per solve of one asperity, by this program and by others.

Usage:
    python scripts/work_precision.py FILE.csv... [-o OUT.png] [--dpi N]

Each FILE.csv has the header panel,method,setting,seconds,error,what: panel is one of those above, every method is a line
through its points in the order of their settings. benches/peers/peers.py writes one. The picture goes beside the first file, with
the suffix .png, unless -o says otherwise.
Exit codes: 0 done; 2 a file cannot be read or is not such a table, or the picture cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["matplotlib>=3.7"]
# ///

import argparse
import csv
import math
import re
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, StrMethodFormatter

HEADER = ["panel", "method", "setting", "seconds", "error", "what"]
PAGE = (11.0, 9.9)  # inches
EPSILON = sys.float_info.epsilon
PANELS = {
    "sums": ("Sums over one replica of case II", "seconds per replica", "error over the sum of magnitudes"),
    "monte_carlo": ("Mean pull-off of case II", "seconds", "relative standard error"),
    "integral": ("Statistical integral", "seconds", "relative error"),
    "peers": ("One solve of an asperity, worst of all reference rows", "seconds per solve", "relative error"),
}
# Colours of Okabe and Ito; with the markers, the lines are also told apart in grey.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "0.4")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
# Branches of one method share its colour and marker.
DASHES = (0, (4, 1.5))
BRANCHES = {", contact": "-", ", before contact": DASHES, ", moments": "-", ", direct": DASHES}
OWN = ("stiction", "moments")  # stars and lines in greys, the last black: what the program does; names begin so
MOST_LABELS = {"monte_carlo": 2, "peers": 3}  # settings written at one line, elsewhere 4
STYLE = {
    "font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.labelsize": 9,
    "legend.fontsize": 8, "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.linewidth": 0.7,
    "legend.frameon": False, "legend.handlelength": 2.6, "legend.borderaxespad": 0.3,
    "axes.spines.top": False, "axes.spines.right": False,
}


class TableError(Exception):
    """Why a file cannot be drawn."""


@dataclass
class Point:
    """One row of a table."""

    method: str
    setting: str
    seconds: float
    error: float


def read(path: Path) -> list[tuple[str, Point]]:
    """The rows of a file with their panels."""
    with open(path, newline="", encoding="utf-8") as file:
        lines = list(csv.reader(file))
    if not lines or lines[0] != HEADER:
        raise TableError(f"its first line is not {','.join(HEADER)}")
    points = []
    for number, line in enumerate(lines[1:], 2):
        if not line:
            continue
        if len(line) != len(HEADER):
            raise TableError(f"line {number} has {len(line)} fields, not {len(HEADER)}")
        panel, method, setting, seconds, error, _ = line
        if panel not in PANELS:
            raise TableError(f"line {number}: unknown panel {panel!r}; known: {', '.join(PANELS)}")
        try:
            point = Point(method, setting, float(seconds), float(error))
        except ValueError as reason:
            raise TableError(f"line {number}: {reason}") from None
        if not (0.0 < point.seconds < math.inf and 0.0 <= point.error < math.inf):
            raise TableError(f"line {number}: seconds must be positive and the error not negative, both finite")
        points.append((panel, point))
    if not points:
        raise TableError("no rows")
    return points


def split(method: str) -> tuple[str, str | tuple]:
    """Name that is coloured, and line style of its branch."""
    for ending, line in BRANCHES.items():
        if method.endswith(ending):
            return method.removesuffix(ending), line
    return method, "-"


def is_own(name: str) -> bool:
    return name.split(" ")[0] in OWN


def short(setting: str) -> str:
    """A setting as it fits beside a point: only its number where it has one, 1e-09 as a power of ten."""
    found = re.search(r"(\d+(?:\.\d+)?)e([+-]?\d+)", setting)
    if found:
        factor = "" if float(found[1]) == 1.0 else rf"{found[1]}\cdot"
        return f"${factor}10^{{{int(found[2])}}}$"
    found = re.search(r"^\d+(?=\b)", setting)
    return found[0] if found else setting


def name_of_settings(points: list[Point]) -> str:
    """What the numbers beside the points of most settings of a line are."""
    names = [re.subn(r"\d+(\.\d+)?e[+-]?\d+|^\d+", "", point.setting) for point in points]
    names = [name.split(",")[0].strip(" =") for name, count in names if count]
    return Counter(names).most_common(1)[0][0] if len(names) > 1 else ""


def annotate(axes: Axes, points: list[Point], color: str, shown: list[float], most: int, left: bool, bottom: bool) -> None:
    """Settings beside the first, the last and some points between, where the line leaves room.

    To the left of a line if `left`, and beneath its last point if `bottom`, where lines end side by side.
    """
    count = min(len(points), most)
    last, right = None, axes.get_xlim()[1]
    for index in sorted({round(i * (len(points) - 1) / max(1, count - 1)) for i in range(count)}):
        place = axes.transData.transform((points[index].seconds, shown[index]))
        if last is not None and abs(place - last).max() < 0.09 * axes.figure.dpi:
            continue
        last, text = place, short(points[index].setting)
        word = len(text) > 6 and not text.startswith("$")
        # Words near the right edge go to the left, where they stay on the page, and other words below, clear of those.
        to_left = left or (word and points[index].seconds > right / 12.0)
        x, y = (-5 if to_left else 5), (-7 if word and index < len(points) - 1 else 5)
        if bottom and index == len(points) - 1 and not word:
            x, y = (-3 if to_left else 3), -8
        axes.annotate(text, (points[index].seconds, shown[index]), xytext=(x, y), textcoords="offset points", fontsize=6.5, color=color,
                      ha="right" if to_left else "left", va="center", parse_math=text.startswith("$"), zorder=6,
                      path_effects=[withStroke(linewidth=1.6, foreground="white")])


def slopes(axes: Axes, points: list[Point]) -> None:
    """Lines of slope -1/2 through the panel, a factor of ten in time apart."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    products = [point.error * math.sqrt(point.seconds) for point in points if point.error > 0.0]
    middle = round(2.0 * math.log10(sorted(products)[len(products) // 2])) / 2.0
    for step in range(-12, 13):
        level = 10.0 ** (middle + 0.5 * step)
        axes.plot([left, right], [level / math.sqrt(left), level / math.sqrt(right)], color="0.82", linewidth=0.6, zorder=0)
    axes.set(xlim=(left, right), ylim=(low, high))


def draw_panel(axes: Axes, letter: str, panel: str, points: list[Point]) -> None:
    title, x_label, y_label = PANELS[panel]
    axes.set_title(f"({letter}) {title}")
    if not points:
        axes.text(0.5, 0.5, "no measurement given", ha="center", va="center", transform=axes.transAxes, color="0.4")
        axes.set(xticks=[], yticks=[])
        return
    methods: dict[str, list[Point]] = {}
    for point in points:
        methods.setdefault(point.method, []).append(point)
    names = list(dict.fromkeys(split(method)[0] for method in methods))
    others, own_names = [name for name in names if not is_own(name)], [name for name in names if is_own(name)]
    styles = {name: (COLORS[i % len(COLORS)], MARKERS[i % len(MARKERS)]) for i, name in enumerate(others)}
    styles |= {name: (f"{0.3 * (len(own_names) - 1 - i):g}", "*") for i, name in enumerate(own_names)}
    positive = [point.error for point in points if point.error > 0.0]
    floor = min([*positive, EPSILON])  # where an error of 0 is drawn
    settings: dict[str, str] = {}
    drawn = []
    for method, own in methods.items():
        name, line = split(method)
        color, marker = styles[name]
        shown = [max(point.error, floor) for point in own]
        axes.plot([point.seconds for point in own], shown, color=color, marker=marker, linestyle=line, linewidth=1.3,
                  markersize=8.5 if marker == "*" else 4.2, markerfacecolor="white" if line != "-" else color, markeredgewidth=1.0,
                  zorder=4 if is_own(name) else 3)
        # Of lines that share their settings and end side by side, one says them.
        alike = is_own(name) and (name != own_names[-1] or len(own) == 1 < len(points))
        if not alike and not (panel == "monte_carlo" and name != names[0]):
            drawn.append((own, color, shown, line != "-"))
        settings.setdefault(name, name_of_settings(own))
    axes.set(xscale="log", yscale="log", xlabel=x_label, ylabel=y_label)
    axes.margins(0.09, 0.1 if panel == "peers" else 0.07)
    axes.autoscale_view()
    if panel == "monte_carlo":
        slopes(axes, points)
    elif min(positive, default=1.0) < 100.0 * EPSILON:
        axes.axhline(EPSILON, color="0.6", linewidth=0.7, linestyle=":", zorder=0)
        axes.annotate(r"$\varepsilon$", (1.0, EPSILON), xycoords=("axes fraction", "data"), xytext=(2, 0),
                      textcoords="offset points", fontsize=8, color="0.4", va="center")
    for own, color, shown, left in drawn:
        annotate(axes, own, color, shown, MOST_LABELS.get(panel, 4), left, panel == "peers")
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        decades = math.log10(high / low)
        subs = (1.0, 2.0, 5.0) if decades < 1.7 else (1.0,)
        axis.set_major_locator(LogLocator(numticks=9, subs=subs) if decades > 0.7 else MaxNLocator(5))
        if decades < 1.7:
            axis.set_major_formatter(StrMethodFormatter("{x:g}"))
        if decades < 1.7 or decades > 6.0:
            axis.set_minor_formatter(NullFormatter())
    axes.grid(which="major", color="0.92", linewidth=0.5)
    axes.set_axisbelow(True)
    common = settings[names[0]] if len(set(settings.values())) == 1 and len(names) > 1 else ""
    handles = []
    for name, (color, marker) in ((name, styles[name]) for name in names):
        label = f"{name} ({settings[name]})" if settings[name] and not common else name
        handles.append(Line2D([], [], color=color, marker=marker, label=label, linewidth=1.3, markersize=8.5 if marker == "*" else 4.2))
    if common:
        axes.set_title(f"numbers: {common}", loc="right", fontsize=8, color="0.3")
    handles += [Line2D([], [], color="0.3", linestyle=line, marker="o", markersize=4.2, label=branch.strip(", "),
                       markerfacecolor="white" if line != "-" else "0.3")
                for branch, line in BRANCHES.items() if any(method.endswith(branch) for method in methods)]
    if panel == "monte_carlo":
        handles.append(Line2D([], [], color="0.75", linewidth=0.8, label="slope −1/2"))
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(-0.02, -0.12), ncols=2, columnspacing=1.2)


def draw(points: list[tuple[str, Point]]) -> Figure:
    figure = Figure(figsize=PAGE)
    (w, h) = PAGE
    for index, panel in enumerate(PANELS):
        left, bottom = 0.8 + 5.55 * (index % 2), 6.45 - 5.0 * (index // 2)
        axes = figure.add_axes((left / w, bottom / h, 4.45 / w, 3.05 / h))
        draw_panel(axes, "abcd"[index], panel, [point for name, point in points if name == panel])
    return figure


def main() -> int:
    parser = argparse.ArgumentParser(description="Work-precision diagrams of CSV files, on one page.")
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE.csv", help="tables with the header " + ",".join(HEADER))
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.png", help="default: beside the first FILE.csv")
    parser.add_argument("--dpi", type=int, default=200, metavar="N", help="dots per inch, default 200")
    arguments = parser.parse_args()
    output = arguments.output or arguments.files[0].with_suffix(".png")
    points, at = [], arguments.files[0]
    try:
        for at in arguments.files:
            points += read(at)
        at = output
        with rc_context(STYLE):
            draw(points).savefig(output, dpi=arguments.dpi)
    except (TableError, OSError, ValueError, csv.Error) as error:
        print(f"work_precision: {at}:", *str(error).split(), file=sys.stderr)
        return 2
    print(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
