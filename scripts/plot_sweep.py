"""One page of pictures of a sweep: pull-off and stiffest point over one or two swept keys.

(a) pull-off force: mean over replicas with its standard error, scatter of one replica as a band, and the
    pull-off of the integral;
(b) the same less the integral's, relative to it: what the size of the patch does;
(c) largest stiffness dF/dh: of the mean curve and of the integral;
(d) where both are, as h*: the pull-off averaged over replicas and of the integral, the stiffest point of the mean
    curve and of the integral.

The first key that has several values is the axis; a second one makes a curve of each of its values.

Usage:
    python scripts/plot_sweep.py FILE.h5 [-o OUT.png] [--x DATASET] [--dpi N]

--x takes another dataset over the points for the axis, such as plasticity_index or adhesion_parameter.
The picture goes beside FILE.h5, with the suffix .png, unless -o says otherwise.
Exit codes: 0 done; 2 the file cannot be read or is not such a result, or the picture cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "matplotlib>=3.7"]
# ///

import math
import sys
import textwrap
from pathlib import Path

import h5py
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from plot_page import DASHED, PAGE, FileError, Result, main, si

COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "black"]
MARKERS = "osD^vP*"
X_OPTION = {"metavar": "DATASET", "help": "key, or dataset over the points, for the axis; default: the first key"}
# Units that may have a prefix.
SIMPLE = {"m", "Pa", "N"}


class Sweep(Result):
    """A sweep of `stiction run`."""

    format, major_version, made_by = "stiction-sweep", 4, "a sweep of `stiction run`"

    def __init__(self, file: h5py.File) -> None:
        super().__init__(file)
        self.keys = [key.replace(".", "_") for key in str(self.attribute("/", "sweep_keys")).split(", ")]
        self.shape = self["nominal_area"].shape

    def over_points(self, name: str) -> np.ndarray:
        """The values of a key, or of a dataset, at every point."""
        values = self[name]
        if name in self.keys and self.attribute("/", "sweep_mode") == "grid":
            axis = self.keys.index(name)
            values = np.broadcast_to(np.expand_dims(values, tuple(i for i in range(len(self.shape)) if i != axis)),
                                     self.shape)
        if values.shape != self.shape:
            raise FileError(f"/{name} has no value at each point")
        return values

    def label(self, name: str, values: np.ndarray) -> tuple[float, str, str]:
        """Factor, unit and words for the values of a dataset."""
        units, words = self.file[name].attrs["units"], self.file[name].attrs["long_name"]
        factor, sign = si(float(np.abs(values).max())) if units in SIMPLE else (1.0, "")
        units = units.replace("J m-2", "J/m$^2$").replace("m-2", "1/m$^2$").replace("m2", "m$^2$")
        return factor, "" if units == "1" else f"{sign}{units}", words

    def curves(self) -> list[tuple[str, np.ndarray]]:
        """A name and the indices of the points of each curve: all of them, or those of each value of a second key."""
        varying = [key for key in self.keys if np.unique(self.over_points(key)).size > 1] or self.keys[:1]
        points = np.arange(math.prod(self.shape))
        if self.attribute("/", "sweep_mode") == "zip" or len(varying) == 1:
            return [("", points)]
        if len(varying) > 2:
            raise FileError(f"{len(varying)} keys have several values; one or two can be drawn")
        second = self.over_points(varying[1]).ravel()
        factor, units, words = self.label(varying[1], second)
        values = np.unique(second)
        if values.size > len(COLORS):
            raise FileError(f"{varying[1]} has {values.size} values; up to {len(COLORS)} curves can be told apart")
        return [(f"{words} {value / factor:.4g} {units}".strip(), points[second == value]) for value in values]

    def scalar(self, name: str, of: str) -> np.ndarray:
        """A mean over replicas, or its standard error, of a number of single replicas."""
        scalars = [scalar.decode() for scalar in self["ensemble/scalar"]]
        return self[f"ensemble/scalar_{of}"][..., scalars.index(name)].ravel()


def is_logarithmic(x: np.ndarray) -> bool:
    """Whether places are spaced by factors rather than by steps."""
    x = np.unique(x)
    if x.size < 3 or not x[0] > 0.0:
        return False
    spread = [np.ptp(steps) / steps.mean() for steps in (np.diff(x), np.diff(np.log(x)))]
    return spread[1] < spread[0] and x[-1] > 2.5 * x[0]


def draw_force(axes: Axes, sweep: Sweep, x: np.ndarray, curves: list) -> None:
    mean, error = (sweep.scalar("pull_off_force", of) for of in ("mean", "standard_error"))
    std = np.nanstd(sweep["replicas/pull_off_force"], axis=-1, ddof=1).ravel()
    integral = sweep["integral/pull_off_force"].ravel()
    unit, sign = si(float(np.abs(mean).max()))
    for (_, points), color, marker in zip(curves, COLORS, MARKERS):
        order = points[np.argsort(x[points])]
        axes.fill_between(x[order], (mean - std)[order] / unit, (mean + std)[order] / unit, color=color, alpha=0.15,
                          linewidth=0)
        axes.errorbar(x[order], mean[order] / unit, error[order] / unit, color=color, marker=marker, markersize=4,
                      linewidth=0, elinewidth=1.2, capsize=2.5)
        axes.plot(x[order], integral[order] / unit, color=color, linestyle=DASHED, linewidth=1.3)
    low = min(integral.min(), mean.min())
    if low > 0.0 and mean.max() > 12.0 * low:
        axes.set_yscale("log")
        axes.set_ylim(0.5 * low / unit, 2.0 * (mean + std).max() / unit)
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set(ylabel=f"pull-off force ({sign}N)")
    axes.set_title("(a) Pull-off force")
    axes.legend(handles=[
        Line2D([], [], color="0.3", marker="o", markersize=4, linewidth=0, label="mean over replicas ± standard error"),
        Patch(color="0.3", alpha=0.2, linewidth=0, label="standard deviation of one replica"),
        Line2D([], [], color="0.3", linestyle=DASHED, linewidth=1.3, label="of the integral"),
    ], loc="best")


def draw_excess(axes: Axes, sweep: Sweep, x: np.ndarray, curves: list) -> None:
    means = [sweep.scalar("pull_off_force", of) for of in ("controlled_mean", "controlled_standard_error")]
    integral = sweep["integral/pull_off_force"].ravel()
    with np.errstate(all="ignore"):
        excess, error = 100.0 * (means[0] / integral - 1.0), 100.0 * means[1] / integral
    for (_, points), color, marker in zip(curves, COLORS, MARKERS):
        order = points[np.argsort(x[points])]
        axes.errorbar(x[order], excess[order], error[order], color=color, marker=marker, markersize=4, linewidth=0.9,
                      elinewidth=1.2, capsize=2.5)
    finite = excess[np.isfinite(excess)]
    if finite.size and finite.min() > 0.0 and finite.max() > 20.0 * finite.min():
        axes.set_yscale("log")
        axes.set_ylim(0.5 * finite.min(), 2.0 * finite.max())
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    else:
        axes.axhline(0.0, color="0.3", linestyle=DASHED, linewidth=1.0)
    axes.set(ylabel="mean over replicas less integral (% of it)")
    axes.set_title("(b) What finite patches pull more than the integral")


def draw_stiffness(axes: Axes, sweep: Sweep, x: np.ndarray, curves: list) -> None:
    mean, integral = (sweep[f"{of}/peak_stiffness"].ravel() for of in ("ensemble", "integral"))
    single, error = (sweep.scalar("peak_secant_stiffness", of) for of in ("mean", "standard_error"))
    unit, sign = si(float(np.abs(integral).max()))
    for (_, points), color, marker in zip(curves, COLORS, MARKERS):
        order = points[np.argsort(x[points])]
        axes.plot(x[order], mean[order] / unit, marker, color=color, markersize=4)
        axes.plot(x[order], integral[order] / unit, color=color, linestyle=DASHED, linewidth=1.3)
        axes.errorbar(x[order], single[order] / unit, error[order] / unit, color=color, marker=marker, markersize=4,
                      markerfacecolor="white", linewidth=0, elinewidth=1.2, capsize=2.5)
    low = min(float(values.min()) for values in (mean, integral, single))
    if low > 0.0 and single.max() > 12.0 * low:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set(ylabel=f"largest $dF/dh$ ({sign}N/m)")
    axes.set_title("(c) Largest stiffness")
    axes.legend(handles=[
        Line2D([], [], color="0.3", marker="o", markersize=4, linewidth=0, label="of the mean curve"),
        Line2D([], [], color="0.3", marker="o", markersize=4, markerfacecolor="white", linewidth=0,
               label="secant of single replicas, mean ± standard error"),
        Line2D([], [], color="0.3", linestyle=DASHED, linewidth=1.3, label="of the integral"),
    ], loc="best")


def draw_places(axes: Axes, sweep: Sweep, x: np.ndarray, curves: list) -> None:
    sigma = sweep["surface_height_std"].ravel()
    pull_off, error = (sweep.scalar("pull_off_separation", of) / sigma for of in ("mean", "standard_error"))
    of_integral = [sweep[f"integral/{name}_separation"].ravel() / sigma for name in ("pull_off", "peak_stiffness")]
    stiffest = sweep["ensemble/peak_stiffness_separation"].ravel() / sigma
    for (_, points), color, marker in zip(curves, COLORS, MARKERS):
        order = points[np.argsort(x[points])]
        axes.errorbar(x[order], pull_off[order], error[order], color=color, marker=marker, markersize=4, linewidth=0,
                      elinewidth=1.2, capsize=2.5)
        axes.plot(x[order], of_integral[0][order], color=color, linestyle=DASHED, linewidth=1.3)
        axes.plot(x[order], stiffest[order], marker, color=color, markersize=4, markerfacecolor="white")
        axes.plot(x[order], of_integral[1][order], color=color, linestyle=":", linewidth=1.5)
    axes.set(ylabel=r"separation $h$* = $h/\sigma$")
    axes.set_title("(d) Where they are")
    axes.legend(handles=[
        Line2D([], [], color="0.3", marker="o", markersize=4, linestyle=DASHED, linewidth=1.3,
               label="pull-off: mean over replicas, integral"),
        Line2D([], [], color="0.3", marker="o", markersize=4, markerfacecolor="white", linestyle=":", linewidth=1.5,
               label="stiffest point: of the mean curve, integral"),
    ], loc="best")


def draw_texts(figure: Figure, sweep: Sweep, curves: list) -> None:
    title = str(sweep.attribute("/", "title")).strip() or Path(sweep.file.filename).name
    figure.text(0.5, 0.985, "\n".join(textwrap.wrap(title, 90, max_lines=2)), ha="center", va="top", size=12,
                weight="bold", parse_math=False)
    numbers = "the same random numbers" if sweep.attribute("/", "common_random_numbers") else "random numbers of its own"
    figure.text(0.5, 0.95, f"law {sweep.attribute('/', 'law')}, history {sweep.attribute('/', 'history')}, {sweep.attribute('/', 'points')} "
                f"points with {sweep.attribute('/', 'replicas')} replicas each, {numbers}, seed {sweep.attribute('/', 'seed')}",
                ha="center", va="top", fontsize=9.5)
    if len(curves) > 1:
        handles = [Line2D([], [], color=color, marker=marker, markersize=4, linewidth=1.3, label=name)
                   for (name, _), color, marker in zip(curves, COLORS, MARKERS)]
        figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.935), ncols=min(len(curves), 4))


def draw(sweep: Sweep, name: str | None) -> Figure:
    figure = Figure(figsize=PAGE)
    curves = sweep.curves()
    varying = [key for key in sweep.keys if np.unique(sweep.over_points(key)).size > 1] or sweep.keys
    name = name or varying[0]
    x = sweep.over_points(name).astype(float).ravel()
    factor, units, words = sweep.label(name, x)
    x = x / factor
    rows = math.ceil(len(curves) / 4) if len(curves) > 1 else 0
    grid = figure.add_gridspec(2, 2, left=0.08, right=0.98, bottom=0.07, top=0.89 - 0.03 * rows, hspace=0.28, wspace=0.2)
    drawn = [draw_force, draw_excess, draw_stiffness, draw_places]
    for i, draw_panel in enumerate(drawn):
        axes = figure.add_subplot(grid[i // 2, i % 2])
        draw_panel(axes, sweep, x, curves)
        if is_logarithmic(x):
            axes.set_xscale("log")
            axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 3, 5, 7) if x.max() < 12 * x.min() else (1, 2, 5)))
            axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel(f"{words} ({units})" if units else words)
    draw_texts(figure, sweep, curves)
    return figure


if __name__ == "__main__":
    sys.exit(main("Pictures of a sweep of `stiction run`, on one page.", Sweep, draw, {"x": X_OPTION}))
