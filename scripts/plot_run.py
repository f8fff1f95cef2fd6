"""One page of pictures of a result of `stiction run`.

(a) external force F and adhesion force F_s over the separation h*, around the adhesive well: mean over the replicas
    with the standard deviation of one replica, the statistical integral, and the pull-off of the mean curve;
(b) how far both mean forces deviate from the integral, in standard errors, with the verdict of the joint test;
(c) adhesion force of each regime, the inset where contact sets in;
(d) pull-off forces of the single replicas, with their mean and the pull-off of the mean curve and of the integral.

Usage:
    python scripts/plot_run.py FILE.h5 [-o OUT.png] [--dpi N]

The picture goes beside FILE.h5, with the suffix .png, unless -o says otherwise.
Exit codes: 0 done; 2 the file cannot be read or is not a result, or the picture cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "matplotlib>=3.7"]
# ///

import argparse
import math
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402

FORMAT, MAJOR_VERSION = "stiction-run", 1
BLUE, VERMILION, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#E69F00", "#009E73", "#CC79A7"
# Colour, line style and width of what panel (c) draws; they differ in grey as well.
STYLES = {
    "total": ("black", "-", 1.8),
    "noncontact": (BLUE, (0, (5, 1.5)), 1.5),
    "lubricant": (ORANGE, "-", 1.5),
    "elastic": (VERMILION, (0, (5, 1.2, 1, 1.2)), 1.5),
    "elastoplastic 1+2": (GREEN, (0, (1.2, 1.2)), 1.7),
    "plastic": (PURPLE, (0, (8, 2)), 1.2),
}
STYLE = {
    "font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.labelsize": 9, "legend.fontsize": 8,
    "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.linewidth": 0.7, "legend.frameon": False,
    "legend.handlelength": 2.6, "axes.spines.top": False, "axes.spines.right": False,
}


class RunError(Exception):
    """Why a file cannot be plotted."""


@dataclass
class Run:
    """What the page shows: root attributes, attributes of groups, and datasets by path."""

    attributes: dict[str, object]
    groups: dict[str, dict[str, object]]
    data: dict[str, np.ndarray]

    def __getitem__(self, path: str) -> np.ndarray:
        return self.data[path]


DATASETS = [
    "h_star", "separation", "regime", "ensemble/external_force_mean", "ensemble/external_force_std",
    "ensemble/adhesion_force_mean", "ensemble/contact_area_mean", "ensemble/regime_adhesion_force_mean",
    "replicas/asperity_count", "replicas/pull_off_force", "statistical/external_force",
    "statistical/adhesion_force", "statistical/regime_adhesion_force", "validation/z_adhesion_force",
    "validation/z_external_force", "validation/tested_adhesion_force", "validation/tested_external_force",
]
ATTRIBUTES = {
    "/": ["title", "law", "path", "adhesion_parameter", "plasticity_index", "nominal_area", "replicas",
          "surface_height_std", "seed", "program_version"],
    "ensemble": ["pull_off_force", "pull_off_separation"],
    "statistical": ["pull_off_force"],
    "validation": ["verdict", "p_value"],
}


def text(value: object) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)


def read(path: Path) -> Run:
    """Reads a result, or says in a RunError what is wrong with it."""
    if not path.is_file():
        raise RunError("no such file")
    if not h5py.is_hdf5(path):
        raise RunError("not an HDF5 file")
    try:
        with h5py.File(path, "r") as file:
            check_format(file)
            groups = {group: {name: attribute(file, group, name) for name in names}
                      for group, names in ATTRIBUTES.items()}
            return Run(groups["/"], groups, {name: dataset(file, name) for name in DATASETS})
    except OSError as error:
        raise RunError(f"cannot be read: {error}") from error


def check_format(file: h5py.File) -> None:
    if text(file.attrs.get("format", "")) != FORMAT:
        raise RunError(f"not a result of `stiction run`: its attribute format is not {FORMAT}")
    version = np.atleast_1d(file.attrs.get("format_version", 0))
    if int(version[0]) != MAJOR_VERSION:
        raise RunError(f"its format version is {'.'.join(map(str, version))}, this script reads {MAJOR_VERSION}.x")


def attribute(file: h5py.File, group: str, name: str) -> object:
    try:
        return file[group].attrs[name]
    except KeyError:
        raise RunError(f"lacks the attribute {name} of {group}") from None


def dataset(file: h5py.File, name: str) -> np.ndarray:
    try:
        return file[name][()]
    except KeyError:
        raise RunError(f"lacks the dataset {name}") from None


def prefix(largest: float) -> tuple[float, str]:
    """SI prefix, as factor and sign, for numbers up to `largest`."""
    exponent = 3 * math.floor(math.log10(largest) / 3) if largest > 0 and math.isfinite(largest) else 0
    exponent = min(max(exponent, -15), 9)
    signs = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
    return 10.0**exponent, signs[exponent]


def newton(value: float, digits: int = 4) -> str:
    factor, sign = prefix(abs(value))
    return f"{value / factor:#.{digits}g}".rstrip(".") + f" {sign}N"


def window(mean: np.ndarray, std: np.ndarray) -> tuple[float, float]:
    """Range of forces around the adhesive well; all of them where there is none."""
    spread = np.nan_to_num(std)
    low, high = float((mean - spread).min()), float((mean + spread).max())
    if mean.min() >= 0.0:
        return low - 0.05 * (high - low), high + 0.05 * (high - low)
    depth = -min(1.5 * mean.min(), max(1.1 * low, 2.6 * mean.min()))
    return -depth, max(0.12 * depth, min(1.05 * high, 0.7 * depth))


def draw_forces(axes: Axes, run: Run) -> None:
    x, mean, std = run["h_star"], run["ensemble/external_force_mean"], run["ensemble/external_force_std"]
    low, high = window(mean, std)
    unit, sign = prefix(max(-low, high))
    if np.isfinite(std).any():
        axes.fill_between(x, (mean - std) / unit, (mean + std) / unit, color="#A9CFE8", alpha=0.75, linewidth=0.5,
                          label="± one standard deviation of one replica")
    axes.plot(x, -run["ensemble/adhesion_force_mean"] / unit, color=VERMILION, linestyle=(0, (5, 1.2, 1, 1.2)),
              linewidth=1.2, label="$-F_s$, mean over replicas")
    axes.plot(x, mean / unit, color=BLUE, linewidth=2.2, label="$F$, mean over replicas")
    axes.plot(x, run["statistical/external_force"] / unit, color="black", linestyle="--", linewidth=0.9,
              label="$F$, integral")
    pull_off = run.groups["ensemble"]
    place, force = pull_off["pull_off_separation"] / run.attributes["surface_height_std"], pull_off["pull_off_force"]
    name = "pull-off of the mean" if force > 0 else "smallest force, no pull-off"
    axes.plot(place, -force / unit, "o", color="black", markerfacecolor="white", markersize=6, zorder=5, clip_on=False,
              linestyle="none", label=f"{name}: {newton(abs(force))} at $h^*$ = {place:.2f}{edge(run)}")
    axes.axhline(0.0, color="0.5", linewidth=0.6, zorder=0)
    axes.set(ylim=(low / unit, high / unit), ylabel=f"force, compressive positive ({sign}N)")
    axes.set_title("(a) External force $F$ and adhesion force $F_s$")
    handles, labels = axes.get_legend_handles_labels()
    order = sorted(range(len(labels)), key=lambda i: ["$F$, m", "± one", "$F$, i", "$-F_s"].index(key)
                   if (key := next((k for k in ("$F$, m", "± one", "$F$, i", "$-F_s") if labels[i].startswith(k)), ""))
                   else 9)
    axes.legend([handles[i] for i in order], [labels[i] for i in order], loc="best")


def edge(run: Run) -> str:
    """A remark where the mean curve is lowest at the first or last separation."""
    mean = run["ensemble/external_force_mean"]
    return " (edge)" if mean.argmin() in (0, mean.size - 1) else ""
