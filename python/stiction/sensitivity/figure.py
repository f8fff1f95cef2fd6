"""The figure of a study: a panel for each outcome."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..plot.style import BLUE, GREY, VERMILION, dressed, inches, lettered
from .words import QUANTITIES

__all__ = ["draw"]


@dressed
def draw(result: xarray.Dataset, width: str | float = "180mm") -> Figure:
    """First-order and total indices of each key, and the fraction of the variance between patches, of each outcome.

    Parameters
    ----------
    result : xarray.Dataset
        What `sensitivity` returned, or its file.
    width : str or float
        Such as ``85mm``, or mm.

    Returns
    -------
    matplotlib.figure.Figure
    """
    keys = [str(key) for key in result["key"].values]
    wide = inches(width)
    names = [str(name) for name in result["quantity"].values]
    columns = len(names) if wide > 4.8 else 1
    rows = -(-len(names) // columns)
    figure = Figure(figsize=(wide, rows * (1.0 + 0.36 * (len(keys) + 1))))
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    places = np.arange(len(keys))
    for ax, name in zip(axes, names, strict=True):
        one = result.sel(quantity=name)
        for kind, words, shift, color, marker in [
            ("first_order", "first order, of the mean over patches", -0.14, BLUE, "o"), ("total", "total, of the mean over patches", 0.14, VERMILION, "s"),
        ]:  # fmt: skip
            value, between = one[kind].values, one[f"{kind}_interval"].values.T
            ax.plot(value, places + shift, marker, color=color, markersize=3.5, label=words)
            ax.hlines(places + shift, *between, color=color, linewidth=1.0)
        ax.plot([float(one["scatter"])], [len(keys)], "D", color="black", markersize=3.5, label="patch-to-patch, of one patch")
        ax.hlines([len(keys)], *one["scatter_interval"].values, color="black", linewidth=1.0)
        ax.axhline(len(keys) - 0.5, color=GREY, linewidth=0.5)
        ax.axvline(0.0, color=GREY, linewidth=0.5, zorder=0.5)
        ax.set_title(QUANTITIES[name][0])
        lettered(ax, names.index(name))
        ax.set_xlabel("fraction of the variance")
        ax.tick_params(labelbottom=True)
    called = [key.rsplit(".", 1)[-1].replace("_", " ") for key in keys]
    axes[0].set(yticks=[*places, len(keys)], yticklabels=[*called, "patch-to-patch variance"], xlim=(-0.05, 1.05))
    axes[0].set_ylim(len(keys) + 0.5, -0.5)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3 if columns > 1 else 1)
    return figure
