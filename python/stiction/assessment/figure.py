"""The picture of an answer: map, spectrum, pull-offs, probability over force."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from .. import quantities
from ..plot.others import draw_map
from ..plot.style import BLUE, DASHED, GREY, VERMILION, dressed, inches, label, legend, lettered, scaled

__all__ = ["draw"]

_COLORS = (BLUE, VERMILION)
# Width, inches, from which on panels are next to each other.
_WIDE = 5.0


@dressed
def draw(result: xarray.Dataset, width: str | float = "180mm") -> Figure:
    """The map with its summits, the power spectrum with limits and cut-offs, pull-offs, and P over force.

    Parameters
    ----------
    result : xarray.Dataset
        The file of `stiction map`.
    width : str or float
        Such as ``95mm``, or mm; narrow figures have their panels one below the other.
    """
    wide = inches(width)
    columns = 2 if wide >= _WIDE else 1
    # Without runs there are no pull-offs.
    panels = (_map, _spectrum, _pull_offs, _over_force)[: 4 if result.sizes["way"] else 2]
    rows = len(panels) // columns
    figure = Figure(figsize=(wide, rows * (0.8 if columns == 1 else 0.38) * wide), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for place, (ax, panel) in enumerate(zip(axes, panels, strict=True)):
        panel(ax, result)
        lettered(ax, place)
    return figure


def _map(ax: Axes, result: xarray.Dataset) -> None:
    pixel = tuple(float(result[axis].values[1] - result[axis].values[0]) for axis in ("x", "y"))
    draw_map(
        ax,
        result["height"].values,
        (pixel[0], pixel[1]),
        (result["summit_x"].values, result["summit_y"].values),
    )


def _spectrum(ax: Axes, result: xarray.Dataset) -> None:
    q, power = result["wavevector"].values, result["power"].values
    unit, sign = scaled("m", 2.0 * math.pi / q)
    ax.loglog(2.0 * math.pi / q / unit, power * 1e36, color="black")
    for place, (long, short) in enumerate(
        zip(result["longest_wave"].values, result["shortest_wave"].values, strict=True)
    ):
        # Reliable waves of each scan, below the spectrum.
        at = np.nanmin(power) * 1e36 * 0.5**place
        ax.plot(
            [short / unit, long / unit],
            [at, at],
            color=GREY,
            linewidth=2.5,
            label="reliable waves of a scan" if place == 0 else None,
        )
    for color, cutoff in zip(_COLORS, _cutoffs(result), strict=False):
        ax.axvline(
            cutoff / unit, color=color, linestyle=DASHED, label=f"cut-off {quantities.si(cutoff, 'm', 3)}"
        )
    ax.invert_xaxis()
    ax.set(xlabel=label("wavelength", sign), ylabel=label("power spectral density", "nm⁴"))
    legend(ax)


def _patches(result: xarray.Dataset) -> list[tuple[str, float, Any]]:
    """Name, cut-off, m, and pull-offs, N, of each way."""
    found = zip(result["way"].values, result["cutoff"].values, result["pull_off_force"].values, strict=True)
    return [(str(name), float(cutoff), forces[~np.isnan(forces)]) for name, cutoff, forces in found]


def _cutoffs(result: xarray.Dataset) -> list[float]:
    return sorted({float(cutoff) for cutoff in result["cutoff"].values})


def _pull_offs(ax: Axes, result: xarray.Dataset) -> None:
    patches = [one for one in _patches(result) if one[0] == "patches"]
    own = [one for one in _patches(result) if one[0] == "map"]
    whole = np.concatenate([forces for _, _, forces in patches])
    unit, sign = scaled("N", whole)
    edges = np.linspace(0.0, np.quantile(whole, 0.995) / unit, 30).tolist()
    for color, line, (_, cutoff, forces) in zip(_COLORS, ("-", "--"), patches, strict=False):
        # Outlines, so that neither hides the other.
        ax.hist(
            forces / unit, edges, histtype="stepfilled", facecolor=to_rgba(color, 0.25), edgecolor=color, linewidth=1.1,
            linestyle=line, label=f"patches, {quantities.si(cutoff, 'm', 3)}",
        )  # fmt: skip
    for color, (_, cutoff, forces) in zip(_COLORS, own, strict=False):
        ax.plot(
            forces / unit,
            [0.0],
            "v",
            color=color,
            markeredgecolor="black",
            clip_on=False,
            zorder=4,
            label=f"this map, {quantities.si(cutoff, 'm', 3)}",
        )
    ax.set(xlabel=label("pull-off force", sign), ylabel="number of patches")
    legend(ax)


def _over_force(ax: Axes, result: xarray.Dataset) -> None:
    patches = [forces for name, _, forces in _patches(result) if name == "patches"]
    whole = np.sort(np.concatenate(patches))
    unit, sign = scaled("N", whole)
    shares = [np.array([np.mean(forces > at) for at in whole]) for forces in patches]
    ax.fill_between(
        whole / unit,
        np.min(shares, axis=0),
        np.max(shares, axis=0),
        color=GREY,
        alpha=0.35,
        linewidth=0,
        label="between cut-offs",
    )
    ax.plot(whole / unit, np.mean(shares, axis=0), color="black", label="all patches")
    above = float(result.attrs["above"])
    if math.isfinite(above):
        ax.axvline(above / unit, color=GREY, linestyle=DASHED, label=f"{quantities.si(above, 'N', 3)}")
    ax.set(xlabel=label("force", sign), ylabel="P(pull-off > force)", ylim=(0.0, 1.0))
    ax.yaxis.set_major_formatter(PercentFormatter(1.0))
    legend(ax)
