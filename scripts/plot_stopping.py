"""One page of pictures of a result of `stiction run` that ended at targets.

For each target with the plain mean, over the number of replicas: (left) the mean with its 95 % interval, and (right) its standard error
with the largest that the target allows and the numbers of replicas after which the rule looked. What is drawn is computed
from the single replicas of the file.

Usage:
    python scripts/plot_stopping.py FILE.h5 [-o OUT.png] [--dpi N]

The picture goes beside FILE.h5, with the suffix .png, unless -o says otherwise.
Exit codes: 0 done; 2 the file cannot be read or is not such a result, or the picture cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "scipy>=1.10", "h5py>=3.8", "matplotlib>=3.7"]
# ///

import argparse
import math
import sys
import textwrap
from pathlib import Path

import h5py
import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import t as student

FORMAT, MAJOR_VERSION, BATCH = "stiction-run", 1, 8
GROUPS = {"independent": 1, "antithetic": 2, "stratified": 8}
BLUE, VERMILION, BAND, GREEN = "#0072B2", "#D55E00", "#BFDBEE", "#009E73"
STYLE = {
    "font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.labelsize": 9,
    "legend.fontsize": 8, "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.linewidth": 0.7,
    "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False, "axes.formatter.useoffset": False,
}


class RunError(Exception):
    """Why a file cannot be plotted."""


class Run:
    """A result that is open for reading."""

    def __init__(self, file: h5py.File) -> None:
        self.file = file
        if file.attrs.get("format") != FORMAT:
            raise RunError(f"not a result of `stiction run`: its attribute `format` is not {FORMAT}")
        version = np.atleast_1d(self.attribute("/", "format_version"))
        if version[0] != MAJOR_VERSION:
            raise RunError(f"its format version is {version[0]}.x, this script reads {MAJOR_VERSION}.x")
        if "target" not in file:
            raise RunError("it has no targets: its number of replicas was given")

    def __getitem__(self, path: str) -> np.ndarray:
        if not isinstance(self.file.get(path), h5py.Dataset):
            raise RunError(f"the dataset /{path} is missing")
        return self.file[path][()]

    def texts(self, path: str) -> list[str]:
        self[path]
        return [str(text) for text in self.file[path].asstr()[()]]

    def attribute(self, group: str, name: str) -> object:
        if group not in self.file or name not in self.file[group].attrs:
            raise RunError(f"the attribute {name} of {group} is missing")
        return self.file[group].attrs[name]


def si(largest: float) -> tuple[float, str]:
    """Factor and sign of the SI prefix for numbers up to `largest`."""
    exponent = math.floor(math.log10(largest) / 3) if largest > 0 and math.isfinite(largest) else 0
    exponent = min(max(exponent, -5), 3)
    return 1000.0**exponent, "fpnµm kMG"[exponent + 5].strip()


def running(values: np.ndarray, group: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Replicas, mean and standard error after each group from the third on."""
    means = values[: values.size // group * group].reshape(-1, group).mean(axis=1)
    count = np.arange(1, means.size + 1)
    shifted = means - means[0]
    mean = np.cumsum(shifted) / count
    squares = np.cumsum(shifted**2) - count * mean**2
    error = np.sqrt(np.maximum(squares, 0.0)[2:] / (count[2:] - 1) / count[2:])
    return group * count[2:], mean[2:] + means[0], error


def looks(replicas: int, first: int) -> list[int]:
    """Numbers of replicas after which the rule looked, up to that at which the run ended."""
    found = [first]
    while found[-1] < replicas:
        found.append(min(math.ceil((found[-1] + math.ceil(found[-1] / 10)) / BATCH) * BATCH, replicas))
    return found


def draw_target(left: Axes, right: Axes, run: Run, place: int) -> None:
    name, units = run.texts("target")[place], run.texts("ensemble/target_units")[place].replace(" m-1", "/m")
    group = GROUPS[str(run.attribute("/", "sampling"))]
    replicas, mean, error = running(run[f"replicas/{name}"], group)
    unit, sign = si(abs(float(mean[-1])))
    half = student.ppf(0.975, replicas / group - 1) * error
    left.fill_between(replicas, (mean - half) / unit, (mean + half) / unit, color=BAND, linewidth=0.0, label="95 % interval")
    left.plot(replicas, mean / unit, color=BLUE, linewidth=1.4, label="mean")
    spread = 6.0 * half[-1]
    left.set(xscale="log", ylim=((mean[-1] - spread) / unit, (mean[-1] + spread) / unit), xlabel="replicas", ylabel=f"{sign}{units}")
    left.set_title(f"({'acegikmo'[place % 8]}) Mean of {name}")
    left.legend(loc="upper right", ncols=2, frameon=True, framealpha=1.0, edgecolor="none")
    unit, sign = si(float(error[-1]))
    right.plot(replicas, error / unit, color=BLUE, linewidth=1.4, label="standard error")
    limit = float(run["ensemble/target_largest_standard_error"][place]) / unit
    right.axhline(limit, color=VERMILION, linestyle=(0, (5, 1.5)), linewidth=1.2, label="largest allowed")
    seen = np.array(looks(int(run.attribute("/", "replicas")), int(run.attribute("/", "min_replicas"))))
    at = np.interp(seen, replicas, error / unit)
    right.plot(seen, at, "o", color="white", markeredgecolor=BLUE, markersize=3.5, label="looks")
    right.plot(seen[-1], at[-1], "o", color=GREEN if run["ensemble/target_met"][place] else VERMILION, markersize=5.5, zorder=5,
               label="end, met" if run["ensemble/target_met"][place] else "end, missed")
    right.set(xscale="log", yscale="log", xlabel="replicas", ylabel=f"{sign}{units}")
    right.set_title(f"({'bdfhjlnp'[place % 8]}) Its standard error")
    right.legend(loc="upper right")


def draw(run: Run) -> Figure:
    plain = [i for i, estimate in enumerate(run.texts("ensemble/target_estimate")) if estimate == "plain"]
    if not plain:
        raise RunError("all its targets are for means with control variates, whose course the file does not hold")
    if run["replica"].size < 3 * GROUPS[str(run.attribute("/", "sampling"))]:
        raise RunError("it has too few replicas for a course")
    plain = plain[:8]
    figure = Figure(figsize=(11.0, 0.9 + 2.9 * len(plain)))
    axes = figure.subplots(len(plain), 2, squeeze=False)
    for (left, right), place in zip(axes, plain):
        draw_target(left, right, run, place)
    title = str(run.attribute("/", "title")).strip() or Path(run.file.filename).name
    replicas, most = run.attribute("/", "replicas"), run.attribute("/", "max_replicas")
    reason = run.attribute("ensemble", "stopping_reason")
    figure.suptitle(textwrap.shorten(title, 100), fontsize=12, weight="bold", parse_math=False)
    figure.text(0.5, 1.0 - 0.5 / figure.get_figheight(), f"ended after {replicas} of at most {most} replicas: {reason}",
                ha="center", fontsize=9.5)
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 1.0 - 0.5 / figure.get_figheight()), h_pad=1.5, w_pad=2.5)
    return figure


def main() -> int:
    parser = argparse.ArgumentParser(description="Pictures of a run that ended at targets, on one page.")
    parser.add_argument("file", type=Path, metavar="FILE.h5", help="the result")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.png", help="default: beside FILE.h5")
    parser.add_argument("--dpi", type=int, default=200, metavar="N", help="dots per inch, default 200")
    arguments = parser.parse_args()
    output = arguments.output or arguments.file.with_suffix(".png")
    try:
        if not arguments.file.is_file() or not h5py.is_hdf5(arguments.file):
            raise RunError("not an HDF5 file" if arguments.file.is_file() else "no such file")
        with h5py.File(arguments.file, "r") as file, rc_context(STYLE):
            draw(Run(file)).savefig(output, dpi=arguments.dpi)
    except (RunError, OSError, ValueError) as error:
        print(f"plot_stopping: {arguments.file}:", *str(error).split(), file=sys.stderr)
        return 2
    print(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
