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

import math
import sys
import textwrap
from pathlib import Path

import h5py
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import t as student

from plot_page import BLUE, GREEN, VERMILION, FileError, main, si
from plot_run import BAND, Run

BATCH = 8
GROUPS = {"independent": 1, "antithetic": 2, "stratified": 8}


class Targets(Run):
    """A result of `stiction run` that ended at targets."""

    def __init__(self, file: h5py.File) -> None:
        super().__init__(file)
        if "ensemble/target" not in file:
            raise FileError("it has no targets: its number of replicas was given")

    def texts(self, path: str) -> list[str]:
        self[path]
        return [str(text) for text in self.file[path].asstr()[()]]


def hall(quantile: np.ndarray, skewness: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Where Hall's transformation of the t statistic is the quantile of Student's (docs/sampling.md)."""
    a = skewness / np.sqrt(count)
    root = np.cbrt(1.0 + a * (quantile - a / 6.0))
    return 3.0 * (quantile - a / 6.0) / (root**2 + root + 1.0)


def skewnesses(values: np.ndarray, group: int) -> np.ndarray:
    """Adjusted skewness of the means of groups after each group from the third on."""
    means = values[: values.size // group * group].reshape(-1, group).mean(axis=1)
    count = np.arange(1.0, means.size + 1.0)
    shifted = (means - means.mean()) / max(means.std(), 1e-300)
    first, second, third = (np.cumsum(shifted**power) / count for power in (1, 2, 3))
    squares = np.maximum(second - first**2, 1e-12)
    cubes = third - 3.0 * first * second + 2.0 * first**3
    return (np.sqrt(count * (count - 1.0))[2:] / (count - 2.0)[2:]) * (cubes / squares**1.5)[2:]


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


def draw_target(left: Axes, right: Axes, run: Targets, place: int) -> None:
    name, units = run.texts("ensemble/target")[place], run.texts("ensemble/target_units")[place].replace(" m-1", "/m")
    group = GROUPS[str(run.attribute("/", "sampling"))]
    replicas, mean, error = running(run[f"replicas/{name}"], group)
    unit, prefix = si(abs(float(mean[-1])))
    quantile, skewness = student.ppf(0.975, replicas / group - 1), skewnesses(run[f"replicas/{name}"], group)
    low, high = (mean - hall(sign * quantile, skewness, replicas / group) * error for sign in (1.0, -1.0))
    half = 0.5 * (high - low)
    left.fill_between(replicas, low / unit, high / unit, color=BAND, linewidth=0.0, label="95 % interval")
    left.plot(replicas, mean / unit, color=BLUE, linewidth=1.4, label="mean")
    spread = 6.0 * half[-1]
    left.set(xscale="log", ylim=((mean[-1] - spread) / unit, (mean[-1] + spread) / unit), xlabel="replicas", ylabel=f"{prefix}{units}")
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


def draw(run: Targets) -> Figure:
    plain = [i for i, estimate in enumerate(run.texts("ensemble/target_estimate")) if estimate == "plain"]
    if not plain:
        raise FileError("all its targets are for means with control variates, whose course the file does not hold")
    if run["replicas/replica"].size < 3 * GROUPS[str(run.attribute("/", "sampling"))]:
        raise FileError("it has too few replicas for a course")
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


if __name__ == "__main__":
    sys.exit(main("Pictures of a run that ended at targets, on one page.", Targets, draw))
