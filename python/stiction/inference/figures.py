"""Figures of an inference: the posterior, and the measured distribution against the predicted one."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..plot.style import BLUE, DASHED, GREY, VERMILION, dressed, inches, label, lettered, new_axes, scaled
from .calibrated import Calibration
from .data import ABOVE, BELOW, MISSING
from .found import Inference

__all__ = ["page", "predicted", "ranks"]

_SHARES = (0.5, 0.9)


@dressed
def page(result: Inference, width: str | float | None = None, truth: Mapping[str, float] | None = None) -> Figure:
    """The corner plot, and in its upper right, or below it where the page is narrower than 122 mm, the outcomes against their predictions.

    Parameters
    ----------
    result : Inference
    width : str or float, optional
        Such as ``95mm``, or mm; 180 mm by default.
    truth : mapping, optional
        Of parameters that are known, such as of made-up data, the values in SI units by the names of the posterior: a black line each.
    """
    from matplotlib import pyplot

    size, count = inches(width or 180), len(result.names)
    outcomes = str(result.attrs["outcomes"]).split(", ")
    if size < 4.8:
        figure = pyplot.figure(figsize=(size, size * (1.0 + 0.65 * len(outcomes))))
        whole = figure.add_gridspec(1 + len(outcomes), 1, height_ratios=[1.0, *[0.65] * len(outcomes)])
        grid: Any = whole[0].subgridspec(count, count)
        free = [whole[1 + row] for row in range(len(outcomes))]
    else:
        figure = pyplot.figure(figsize=(size, (0.95 if count > 1 else 0.45) * size))
        grid = figure.add_gridspec(count, max(count, 2))
        # Free are the cells above the diagonal, of a single parameter the one next to it.
        half = max(count // 2, 1)
        upper = grid[: max(count - half, 1), -half:].subgridspec(len(outcomes), 1)
        free = [upper[row] for row in range(len(outcomes))]
    _corner(result, figure, grid, truth or {})
    lettered(figure.axes[0], 0)
    for place, (outcome, cell) in enumerate(zip(outcomes, free, strict=True), 1):
        lettered(predicted(result, outcome, ax=figure.add_subplot(cell)), place)
    return figure


def _corner(result: Inference, figure: Figure, grid: Any, truth: Mapping[str, float]) -> None:
    """Posterior of each parameter, with its prior within the range in grey, and 50 and 90 % of the draws of each pair."""
    names = result.names
    values, labels, priors, logs, truths = [], [], [], [], []
    for name in names:
        draws = np.asarray(result.data.posterior[name]).ravel()
        attrs = result.data.posterior[name].attrs
        factor, written = scaled(str(attrs["units"]), [np.median(draws)])
        values.append(draws / factor)
        truths.append(truth.get(name, np.nan) / factor)
        priors.append(np.asarray(result.data.prior[name]).ravel() / factor)
        labels.append(textwrap.fill(label(name.partition("_")[2].replace("_", " "), written), 16))
        logs.append(bool(attrs["logarithmic"]))
    ranges: list[Any] = [np.quantile(of, [0.002, 0.998]) for of in values]
    for row in range(len(names)):
        for column in range(row + 1):
            ax = figure.add_subplot(grid[row, column])
            if row == column:
                first, last = ranges[row]
                bins: Any = np.geomspace(first, last, 41) if logs[row] else np.linspace(first, last, 41)
                ax.hist(values[row], bins, density=True, histtype="stepfilled", color=BLUE, alpha=0.35)
                # Wider bins, as few draws of a wide prior are within the range; its fraction outside is not drawn.
                counts, edges = np.histogram(priors[row], bins[::4])
                ax.stairs(counts / (priors[row].size * np.diff(edges)), edges, color=GREY)
                low, middle, high = np.quantile(values[row], [0.025, 0.5, 0.975])
                for at in (low, high):
                    ax.axvline(at, color=VERMILION, lw=0.8, ls=":")
                ax.axvline(middle, color=VERMILION, lw=0.8)
                if np.isfinite(truths[row]):
                    ax.axvline(truths[row], color="black", lw=1.0, ls=DASHED)
                ax.set_yticks([])
            else:
                _pair(ax, values[column], values[row], ranges[column], ranges[row])
                ax.plot(truths[column], truths[row], "x", color="black")
                ax.set_ylim(*ranges[row])
            ax.set_xlim(*ranges[column])
            ax.locator_params(axis="x", nbins=3)
            ax.set_xlabel(labels[column] if row == len(names) - 1 else "")
            ax.set_ylabel(labels[row] if column == 0 and row > 0 else "")
            if row < len(names) - 1:
                ax.set_xticklabels([])
            if column > 0:
                ax.set_yticklabels([])


def _pair(ax: Axes, x: Any, y: Any, x_range: Any, y_range: Any) -> None:
    """The draws of a pair and the lines within which fractions of them lie."""
    from scipy.ndimage import gaussian_filter

    counts, x_edges, y_edges = np.histogram2d(x, y, 60, [x_range, y_range])
    smooth = gaussian_filter(counts, 2.0)
    ordered = np.sort(smooth.ravel())[::-1]
    levels = sorted(ordered[np.searchsorted(np.cumsum(ordered), share * ordered.sum())] for share in _SHARES)
    ax.plot(x[::4], y[::4], ".", ms=0.8, color=BLUE, alpha=0.25, rasterized=True)
    middles = [0.5 * (edges[1:] + edges[:-1]) for edges in (x_edges, y_edges)]
    ax.contour(*middles, smooth.T, levels=np.unique(levels), colors=[VERMILION], linewidths=0.9)


@dressed
def predicted(result: Inference, outcome: str | None = None, *, ax: Axes | None = None) -> Axes:
    """The measured distribution of an outcome, and the band of 95 % of as many patches of the posterior.

    Parameters
    ----------
    result : Inference
    outcome : str, optional
        The first by default.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new ones by default.
    """
    ax = new_axes(ax)
    name = outcome or str(result.attrs["outcomes"]).split(", ")[0]
    observed = result.data.observed_data
    values, kinds = observed[name].values, observed[f"{name}_kind"].values
    known = kinds != MISSING
    replicated = result.data.posterior_predictive[name].values.reshape(-1, values.size)[:, known]
    factor, unit = scaled(str(observed[name].attrs["units"]), [np.median(values[known])])
    # Limits are below all others, or above them.
    places = np.select([kinds[known] == BELOW, kinds[known] == ABOVE], [0.0, np.inf], values[known])
    ordered = np.sort(places) / factor
    shares = np.arange(1, ordered.size + 1) / ordered.size
    low, middle, high = np.quantile(np.sort(replicated, axis=1), [0.025, 0.5, 0.975], axis=0) / factor
    ax.fill_betweenx(shares, low, high, color=BLUE, alpha=0.25, lw=0, label="95 % of predictions")
    ax.plot(middle, shares, color=BLUE, label="median prediction")
    resolved = (ordered > 0.0) & np.isfinite(ordered)
    ax.plot(ordered[resolved], shares[resolved], "o", ms=2.5, color=VERMILION, clip_on=False, label="measured")
    for kind, marker, share in ((BELOW, "<", 0.0), (ABOVE, ">", 1.0)):
        if (limits := values[kinds == kind] / factor).size:
            ax.plot(limits, np.full(limits.size, share), marker, ms=4, color=GREY, clip_on=False, label="below" if kind == BELOW else "above")
    ax.set(xlabel=label(name.replace("_", " ").replace("pull off", "pull-off"), unit), ylabel="fraction of patches", ylim=(0.0, 1.0))
    ax.set_xlim(left=0.0)
    ax.legend(loc="lower right")
    p = np.atleast_1d(result.attrs["check_p_value"])[str(result.attrs["outcomes"]).split(", ").index(name)]
    ax.set_title(f"check: p = {p:.2g}", loc="left")
    return ax


@dressed
def ranks(result: Calibration, width: str | float | None = None) -> Figure:
    """Histograms of the ranks of the true parameters, with the band in which 95 % of the bars of uniform ranks lie.

    Parameters
    ----------
    result : Calibration
    width : str or float, optional
        Such as ``95mm``, or mm; 180 mm by default.
    """
    from matplotlib import pyplot
    from scipy import stats

    size, count = inches(width or 180), len(result.names)
    columns = min(count, 3 if size > 4.8 else 1)
    rows = -(-count // columns)
    figure, grid = pyplot.subplots(rows, columns, figsize=(size, 2.2 * rows), squeeze=False, sharex=True)
    bins = min(max(len(result.ranks) // 10, 4), 20)
    low, high = stats.binom(len(result.ranks), 1.0 / bins).interval(0.95)
    for place, (name, ax) in enumerate(zip(result.names, grid.flat, strict=False)):
        ax.axhspan(low, high, color=GREY, alpha=0.3, lw=0, label="95 % of uniform ranks")
        ax.hist(result.ranks[:, place], np.linspace(0.0, 1.0, bins + 1), color=BLUE, alpha=0.6)
        ax.set(title=name.partition("_")[2].replace("_", " "), xlim=(0.0, 1.0))
        ax.locator_params(axis="y", integer=True)
        lettered(ax, place)
    for ax in grid.flat[count:]:
        ax.remove()
    figure.supxlabel("fraction of the posterior below the true parameter")
    figure.supylabel("experiments")
    grid.flat[0].legend()
    return figure
