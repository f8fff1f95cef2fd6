"""Figures of coupled runs: forces with and without coupling, their difference, avalanches."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ..results import Run
from .run import branches, values
from .style import (
    BLUE,
    COLORS,
    DASH_DOT,
    DASHED,
    GREY,
    H_STAR,
    VERMILION,
    dressed,
    empty,
    label,
    legend,
    logarithmic,
    new_axes,
    scaled,
)

__all__ = ["avalanches", "coupling", "coupling_difference"]


@dressed
def coupling(run: Run, ax: Axes | None = None) -> Axes:
    """External force with coupling, and of the same asperities without.

    For scenes with ``[substrate]``.
    """
    ax = new_axes(ax)
    x = values(run, "ensemble/h_star")
    curves: list[Any] = []
    for way, prefix, color, _ in branches(run):
        of = f", {way}" if len(branches(run)) > 1 else ""
        curves.append((values(run, f"ensemble/{prefix}external_force_mean"), f"coupled{of}", color, "-"))
        independent = values(run, f"coupling/{prefix}independent_external_force_mean")
        curves.append((independent, f"independent{of}", {BLUE: COLORS[5]}.get(color, COLORS[4]) if of else VERMILION, DASH_DOT))
    depth = -min(float(np.nanmin(curve)) for curve, *_ in curves)
    highest = max(float(np.nanmax(curve)) for curve, *_ in curves)
    unit, sign = scaled("N", depth if depth > 0.0 else highest)
    handles = []
    for curve, words, color, line in curves:
        handles += ax.plot(x, curve / unit, color=color, linestyle=line, label=words)
    ax.axhline(0.0, color=GREY, linewidth=0.5, zorder=0.5)
    if depth > 0.0:
        ax.set_ylim(-1.1 * depth / unit, min(1.05 * highest, 0.6 * depth) / unit)
    ax.set(xlabel=H_STAR, ylabel=label("external force", sign))
    legend(ax, handles)
    return ax


@dressed
def coupling_difference(run: Run, ax: Axes | None = None) -> Axes:
    """The change of the external force by coupling, of the same asperities, with two standard errors.

    For scenes with ``[substrate]``.
    """
    ax = new_axes(ax)
    x, pull = values(run, "ensemble/h_star"), -float(np.nanmin(values(run, "ensemble/external_force_mean")))
    differences = [
        (
            way,
            color,
            line,
            *(
                values(run, f"coupling/{prefix}difference_external_force_{of}")
                for of in ("mean", "standard_error")
            ),
        )
        for way, prefix, color, line in branches(run)
    ]
    unit, sign = scaled("N", pull)
    handles, near = [], np.zeros(x.size, bool)
    for way, color, line, mean, error in differences:
        error = np.nan_to_num(error)
        ax.fill_between(
            x, (mean - 2.0 * error) / unit, (mean + 2.0 * error) / unit, color=color, alpha=0.2, linewidth=0
        )
        handles += ax.plot(
            x, mean / unit, color=color, linestyle=line, label=f"coupled less independent, {way}"
        )
        near |= values(run, "ensemble/external_force_mean") < 0.5 * pull
    ax.axhline(0.0, color=GREY, linewidth=0.5, zorder=0.5)
    # Where the surfaces are pressed together the difference is far larger than all of the adhesion.
    seen = np.concatenate([mean[near] for *_, mean, _ in differences]) if near.any() else np.array([pull])
    span = 1.3 * float(np.abs(seen).max()) / unit
    ax.set(
        xlabel=H_STAR,
        ylabel=label("difference of forces", sign),
        ylim=(-span, span) if span > 0 else None,
    )
    legend(ax, handles, columns=1)
    return ax


@dressed
def avalanches(run: Run, ax: Axes | None = None) -> Axes:
    """Numbers of avalanches by their size, over all replicas and separations.

    For scenes with ``[substrate]``.
    """
    ax = new_axes(ax)
    size, count = values(run, "coupling/avalanche_size"), values(run, "coupling/avalanche_size_count")
    there = count > 0
    ax.plot(size[there], count[there], "o", color=BLUE, markersize=3, linestyle=DASHED, label="avalanches")
    ax.set(xlabel="asperities in an avalanche, at least", ylabel="avalanches")
    if not there.any():
        return empty(ax, "no avalanches")
    logarithmic(ax, "x", size[there])
    if not logarithmic(ax, "y", count[there]):
        ax.set_ylim(bottom=0.0)
    return ax
