"""One page of pictures of a result of `stiction finite-size`.

(a) pull-off force of a patch over that of the integral with the same number N of asperities: mean over replicas, and
    the ranges that hold 50, 90 and 98 % of the patches;
(b) bias of that mean with its standard error, the fitted power law, and the N from which on it is 10, 5 and 1 %;
(c) scatter from patch to patch, and what it would be if pull-offs were sums (1/sqrt(N));
(d) skewness, with the standard error sqrt(6/n) of n replicas.

Usage:
    python scripts/plot_finite_size.py FILE.h5 [-o OUT.png] [--dpi N]

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

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import StrMethodFormatter

from plot_page import BLUE, DASHED, DASH_DOT, GREEN, PAGE, VERMILION, Result, main

COUNT = "asperities of a patch, $N$"


class Study(Result):
    """A result of `stiction finite-size`."""

    format, major_version, made_by = "stiction-finite-size", 2, "a result of `stiction finite-size`"


def draw_ranges(axes: Axes, study: Study) -> None:
    n, quantiles = study["asperity_count"], study["pull_off_quantiles"]
    for (low, high), shade in zip([(0, 6), (1, 5), (2, 4)], ["#E3EEF6", "#BFDBEE", "#8FBFDF"]):
        axes.fill_between(n, quantiles[:, low], quantiles[:, high], color=shade, linewidth=0,
                          label=f"{(98, 90, 50)[low]} % of the patches")
    axes.plot(n, quantiles[:, 3], color=BLUE, linewidth=1.3, label="median")
    axes.plot(n, 1.0 + study["bias"], "o", color="black", markersize=4, label="mean over replicas")
    axes.axhline(1.0, color=VERMILION, linestyle=DASH_DOT, linewidth=1.4, label="integral")
    axes.set(xscale="log", xlabel=COUNT, ylabel="pull-off force over that of the integral")
    if quantiles.max() > 4.0 * max(float(quantiles.min()), 0.01):
        axes.set_yscale("log")
        axes.set_ylim(max(0.6 * quantiles[:, 0].min(), 0.01), 1.6 * quantiles.max())
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set_title("(a) Pull-off force of single patches")
    axes.legend(loc="upper right")


def draw_bias(axes: Axes, study: Study) -> None:
    n, bias, error = study["asperity_count"], study["bias"], study["bias_standard_error"]
    fitted = study["is_fitted"] == 1
    for use, face, label in [(fitted, BLUE, "fitted"), (~fitted, "white", "not fitted")]:
        use = use & (bias > 0.0)
        if use.any():
            # Downwards as far as a logarithm goes.
            below = np.minimum(error[use], 0.999 * bias[use])
            axes.errorbar(n[use], 100.0 * bias[use], 100.0 * np.vstack([below, error[use]]), color=BLUE, marker="o",
                          markersize=4.5, markerfacecolor=face, linewidth=0, elinewidth=1.2, capsize=2.5,
                          label=f"mean over replicas ± standard error, {label}")
    if "fit_exponent" in study.file.attrs:
        c, a = study.attribute("/", "fit_coefficient"), study.attribute("/", "fit_exponent")
        da = study.attribute("/", "fit_exponent_standard_error")
        furthest = np.nanmax([n[-1], *study["count_at_accuracy"]])
        x = np.geomspace(n[fitted][0] / 2.0, furthest * 1.5, 50)
        axes.plot(x, 100.0 * c * x**-a, color=VERMILION, linestyle=DASHED, linewidth=1.4,
                  label=f"{float(f'{c:.3g}'):g} $N^{{-{a:.3f}}}$, exponent ± {da:.1g}")
    sources = [source.decode() for source in study["count_at_accuracy_source"]]
    for accuracy, count, source in zip(study["accuracy"], study["count_at_accuracy"], sources):
        axes.axhline(100.0 * accuracy, color="0.75", linewidth=0.7, zorder=0)
        if math.isfinite(count):
            axes.plot([count], [100.0 * accuracy], "s", color=GREEN, markersize=6, markerfacecolor="none")
            exponent = math.floor(math.log10(count))
            number = f"{count / 10**exponent:.1f} × $10^{{{exponent}}}$" if count >= 1000.0 else f"{float(f'{count:.2g}'):g}"
            # Beneath the curve where there is room for it, else above.
            left = count > 30.0 * n[0]
            axes.annotate(f"{100 * accuracy:g} % from {number}" + (" (extrapolated)" if source == "extrapolated" else ""),
                          (count, 100.0 * accuracy), xytext=(-6, -3) if left else (6, 3), textcoords="offset points",
                          fontsize=8, color=GREEN, ha="right" if left else "left", va="top" if left else "bottom")
    axes.set(xscale="log", yscale="log", xlabel=COUNT, ylabel="mean pull-off less the integral's (% of it)")
    axes.set_ylim(bottom=40.0 * min(float(bias[bias > 0.0].min(initial=0.01)), 0.01))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set_title("(b) Bias of the mean")
    axes.legend(loc="upper right")


def draw_scatter(axes: Axes, study: Study) -> None:
    n, scatter = study["asperity_count"], 100.0 * study["relative_std"]
    error = scatter / math.sqrt(2.0 * max(study["replica"].size - 1, 1))
    axes.errorbar(n, scatter, error, color=BLUE, marker="o", markersize=4.5, linewidth=0.9, elinewidth=1.2, capsize=2.5,
                  label="standard deviation over mean")
    x = n[scatter[-1] * np.sqrt(n[-1] / n) < 2.0 * np.nanmax(scatter)]
    axes.plot(x, scatter[-1] * np.sqrt(n[-1] / x), color="0.4", linestyle=DASHED, linewidth=1.2,
              label=r"$\propto 1/\sqrt{N}$ through the last")
    axes.set(xscale="log", yscale="log", xlabel=COUNT, ylabel="scatter from patch to patch (%)")
    axes.set_ylim(0.5 * np.nanmin(scatter), 2.5 * np.nanmax(scatter))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set_title("(c) Scatter")
    axes.legend(loc="lower left")


def draw_skewness(axes: Axes, study: Study) -> None:
    n, skewness = study["asperity_count"], study["skewness"]
    error = np.full(n.size, math.sqrt(6.0 / study["replica"].size))
    axes.errorbar(n, skewness, error, color=BLUE, marker="o", markersize=4.5, linewidth=0.9, elinewidth=1.2, capsize=2.5)
    axes.axhline(0.0, color="0.4", linestyle=DASHED, linewidth=1.0)
    axes.set(xscale="log", xlabel=COUNT, ylabel="skewness of the pull-off force")
    axes.set_title("(d) Skewness")


def draw(study: Study) -> Figure:
    figure = Figure(figsize=PAGE)
    grid = figure.add_gridspec(2, 2, left=0.08, right=0.98, bottom=0.07, top=0.88, hspace=0.28, wspace=0.2)
    for i, draw_panel in enumerate([draw_ranges, draw_bias, draw_scatter, draw_skewness]):
        draw_panel(figure.add_subplot(grid[i // 2, i % 2]), study)
    title = str(study.attribute("/", "title")).strip() or Path(study.file.filename).name
    figure.text(0.5, 0.985, "\n".join(textwrap.wrap(title, 90, max_lines=2)), ha="center", va="top", size=12,
                weight="bold", parse_math=False)
    per_asperity = float(study["integral_pull_off_per_asperity"])
    unit = next((unit for unit in [(1e-6, "µN"), (1e-9, "nN")] if per_asperity >= unit[0]), (1e-12, "pN"))
    figure.text(0.5, 0.945, f"law {study.attribute('/', 'law')}, history {study.attribute('/', 'history')}, "
                f"λ = {study.attribute('/', 'adhesion_parameter'):.4g}, ψ = {study.attribute('/', 'plasticity_index'):.4g}, "
                f"{study.attribute('/', 'replicas')} replicas of each size, seed {study.attribute('/', 'seed')}; "
                f"pull-off of the integral {per_asperity / unit[0]:.4g} {unit[1]} for each asperity", ha="center", va="top", fontsize=9.5)
    return figure


if __name__ == "__main__":
    sys.exit(main("Pictures of a result of `stiction finite-size`, on one page.", Study, draw))
