"""The cost of accuracy: error over time, from tables that `cargo bench --bench work_precision` and
benches/peers/peers.py write.

Usage: python scripts/work_precision.py FILE.csv... [-o OUT]

A table has the header panel,method,setting,seconds,error,what; each method is a line through its points in
the order of their settings, and its branches share a colour.
"""

import csv
import itertools
import sys
from pathlib import Path

from drawing import COLORS, DASHED, MARKERS, column, dressed, legend, options, save

PANELS = {
    "sums": ("time per replica (s)", "error over the sum of magnitudes"),
    "monte_carlo": ("time (s)", "relative standard error"),
    "integral": ("time (s)", "relative error"),
    "peers": ("time per solve (s)", "relative error"),
}
BRANCHES = {", contact": "-", ", before contact": DASHED, ", moments": "-", ", direct": DASHED}


def draw_panel(axes, rows):
    floor = min([sys.float_info.epsilon,
                 *(float(row["error"]) or 1.0 for row in rows)])  # where an error of 0 is drawn
    styles = {}
    for method, points in itertools.groupby(rows, lambda row: row["method"]):
        points = list(points)
        branch = next((branch for branch in BRANCHES if method.endswith(branch)), "")
        name = method.removesuffix(branch)
        color, marker = styles.setdefault(name, (COLORS[len(styles) % len(COLORS)],
                                                 MARKERS[len(styles) % len(MARKERS)]))
        x, y = ([max(float(row[key]), floor) for row in points] for key in ("seconds", "error"))
        axes.loglog(x, y, color=color, marker=marker, linestyle=BRANCHES.get(branch, "-"), label=method)
        for place in sorted({0, len(points) - 1}):
            axes.annotate(points[place]["setting"], (x[place], y[place]), xytext=(4, 4),
                          textcoords="offset points", fontsize=7)
    if rows and rows[0]["panel"] == "monte_carlo":
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        for step in range(-12, 13):
            axes.plot([left, right], [10 ** (step / 2) * at**-0.5 for at in (left, right)], color="0.85",
                      zorder=0)
        axes.set(xlim=(left, right), ylim=(low, high))
    else:
        axes.axhline(sys.float_info.epsilon, color="0.6", linestyle=":", zorder=0)
    legend(axes)


@dressed
def draw(rows):
    figure, panels = column(*[3.2] * len(PANELS))
    for axes, (panel, (x, y)) in zip(panels, PANELS.items()):
        draw_panel(axes, [row for row in rows if row["panel"] == panel])
        axes.set(xlabel=x, ylabel=y)
    return figure


if __name__ == "__main__":
    parser = options(__doc__, Path("work_precision.svg"))
    parser.add_argument("files", nargs="+", metavar="FILE.csv")
    arguments = parser.parse_args()
    rows = []
    for name in arguments.files:
        with open(name, newline="", encoding="utf-8") as file:
            rows += csv.DictReader(file)
    save(draw(rows), arguments.output, arguments.dpi)
