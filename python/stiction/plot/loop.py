"""Figures of loops and of surfaces on springs: contacts made and lost, energy, jumps, pull-off after preloads."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D

from .. import quantities
from ..force_curves.lever import of_run
from ..results import Run
from .run import BRANCHES, histogram, left_out, model_span, values
from .style import (
    BLUE,
    COLORS,
    DASH_DOT,
    DASHED,
    GREY,
    H_STAR,
    MODEL_RANGE,
    VERMILION,
    dressed,
    empty,
    is_noise,
    label,
    legend,
    logarithmic,
    new_axes,
    places,
    probability,
    scaled,
)

# Dashes of jumps, and the ratio of the largest force to the pull-off from which on a force curve has a part that is drawn larger.
_JUMP = (0, (2.0, 1.0))
_FAR = 8.0

__all__ = ["contacts", "energy", "force_curve", "preloads", "snaps", "stuck"]


@dressed
def contacts(run: Run, ax: Axes | None = None) -> Axes:
    """Asperities that come into contact on approach and lose it on retraction, on each step of the separation.

    For loops.
    """
    ax = new_axes(ax)
    x, handles = values(run, "ensemble/step") / float(run.attrs["surface_height_std"]), []
    words = ("come into contact", "lose contact")
    for (_, _, color, line), name, word in zip(BRANCHES[:2], ("jump_in", "jump_off"), words, strict=True):
        handles += ax.plot(
            x, values(run, f"ensemble/{name}_count_mean"), color=color, linestyle=line, label=word
        )
        integral = ax.plot(
            x,
            values(run, f"integral/{name}_count"),
            color="black",
            linestyle=DASHED,
            linewidth=0.8,
            label="integral",
        )
    ax.set(xlabel=H_STAR, ylabel="asperities per step", ylim=(0.0, None))
    legend(ax, handles + integral, columns=3)
    return ax


@dressed
def energy(run: Run, ax: Axes | None = None) -> Axes:
    """Distribution of the energy that is dissipated in a cycle, its mean, and the area of the integral's loop.

    For loops.
    """
    ax = new_axes(ax)
    lost = values(run, "replicas/dissipated_energy")
    unit, sign = scaled("J", lost)
    mean, count = float(lost.mean()), lost.size
    error = float(lost.std(ddof=1)) / math.sqrt(count) if count > 1 else math.nan
    difference = values(run, "integral/external_force") - values(run, "integral/retraction_external_force")
    area = float(np.trapezoid(difference, values(run, "integral/separation")))
    handles = [histogram(ax, lost, unit, f"{count} patches")]
    for value, words, color, line in (
        (mean, f"mean, {quantities.with_error(mean, error, 'J')}", "black", "-"),
        (area, f"of the integral, {quantities.si(area, 'J')}", "black", DASHED),
    ):
        handles.append(ax.axvline(value / unit, color=color, linestyle=line, label=words))
    ax.set(xlabel=label("energy dissipated in a cycle", sign), ylabel="patches")
    ax.margins(x=0.04)
    of_contacts = run.model_range
    handles += model_span(ax, of_contacts.get("dissipated_energy") if of_contacts is not None else None, sign, unit)
    legend(ax, handles)
    return ax


def loses_energy(run: Run) -> bool:
    """Whether a loop dissipates more than the rounding of the work along its branches."""
    work = np.trapezoid(np.abs(values(run, "ensemble/external_force_mean")), values(run, "ensemble/separation"))
    return not is_noise(values(run, "replicas/dissipated_energy"), abs(float(work)))


@dressed
def snaps(run: Run, ax: Axes | None = None) -> Axes:
    """Probability that a surface on a spring jumps in or off, over the stiffness of the spring, with 95 % intervals.

    For scenes with ``[instability]``.
    """
    ax = new_axes(ax)
    stiffness = np.atleast_1d(values(run, "replicas/stiffness"))
    if not stiffness.size:
        return empty(ax, "no springs")
    unit, sign = scaled("N m-1", stiffness)
    order, handles = np.argsort(stiffness), []
    # Curves that coincide are all seen: each is thinner than those under it.
    widths = iter((2.8, 1.7, *[0.8] * 20))

    def curve(name: str, chosen: dict[str, int], words: str, color: str, line: Any) -> None:
        probability, low, high = (
            run[f"instability/{name}_probability{end}"].isel(chosen).values[order]
            for end in ("", "_low", "_high")
        )
        if np.isfinite(probability).any():
            ax.fill_between(stiffness[order] / unit, low, high, color=color, alpha=0.2, linewidth=0)
            handles.extend(
                ax.plot(
                    stiffness[order] / unit,
                    probability,
                    "o",
                    color=color,
                    linestyle=line,
                    linewidth=(width := next(widths)),
                    markersize=1.5 + 1.2 * width,
                    clip_on=False,
                    label=words,
                )
            )

    if "instability/snap_in_probability" in run:
        curve("snap_in", {}, "snap-in", BLUE, "-")
    if "instability/snap_off_probability" in run:
        for index, preload in enumerate(np.atleast_1d(values(run, "replicas/preload"))):
            after = "the closest separation" if math.isnan(preload) else quantities.si(preload, "N")
            curve(
                "snap_off",
                {"preload": index},
                f"snap-off after {after}",
                [VERMILION, *COLORS[2:]][index % 6],
                "-",
            )
    stiffest = float(run["integral"].attrs["peak_stiffness"])
    handles.append(
        ax.axvline(
            stiffest / unit,
            color="black",
            linestyle=DASHED,
            linewidth=0.8,
            label="stiffest point of the integral",
        )
    )
    logarithmic(ax, "x", stiffness[stiffness > 0.0])
    ax.set_xlabel(label("stiffness of the spring", sign))
    probability(ax, "probability of a jump")
    legend(ax, handles)
    return ax


@dressed
def preloads(run: Run, ax: Axes | None = None) -> Axes:
    """Pull-off force after preloads: means over replicas, and where 90 % of them are (in older files their standard deviation).

    For scenes with ``preload`` in ``[instability]``.
    """
    ax = new_axes(ax)
    preload, reached = values(run, "replicas/preload"), values(run, "instability/preload_reached_count") > 0
    reached &= np.isfinite(preload)
    if not reached.any():
        return empty(ax, "no preload is reached")
    mean, std = (values(run, f"instability/pull_off_after_preload_{of}")[reached] for of in ("mean", "std"))
    low, high, words = mean - std, mean + std, "± standard deviation of patches"
    if "instability/pull_off_after_preload_quantile" in run:
        quantile = run["instability/pull_off_after_preload_quantile"].sel(pull_off_quantile=[0.05, 0.95], method="nearest")
        (low, high), words = quantile.transpose("pull_off_quantile", "preload").values[:, reached], "90 % of patches"
    unit, sign = scaled("N", mean)
    load, load_sign = scaled("N", preload[reached])
    handles: list[Any] = [
        *ax.plot(preload[reached] / load, mean / unit, "o-", color=VERMILION, markersize=3, label="mean over patches"),
        ax.fill_between(preload[reached] / load, low / unit, high / unit, color=VERMILION, alpha=0.2, linewidth=0, label=words),
    ]  # fmt: skip
    handles += _model_range(ax, run, "pull_off_after_preload", preload / load, unit)
    there = float(values(run, "replicas/approach_pull_off_force").mean())
    handles.append(
        ax.axhline(
            there / unit, color=BLUE, linestyle=DASHED, label=f"on approach, {quantities.si(there, 'N')}"
        )
    )
    restoring = run.restoring_force
    if restoring is not None:
        words = f"restoring force, {quantities.si(restoring, 'N')}"
        handles.append(ax.axhline(restoring / unit, color="black", linestyle=DASH_DOT, label=words))
    places(ax, preload[reached] / load)
    ax.set(xlabel=label("preload", load_sign), ylabel=label("pull-off force", sign), ylim=(0.0, None))
    legend(ax, handles)
    return ax


@dressed
def stuck(run: Run, ax: Axes | None = None) -> Axes:
    """Probability that the restoring force does not part the surfaces, over the preload, with 95 % intervals.

    For scenes with ``preload`` in ``[instability]`` and with ``[device]``.
    """
    ax = new_axes(ax)
    preload = values(run, "replicas/preload")
    share, low, high = (
        values(run, f"device/stuck_probability{end}_after_preload") for end in ("", "_low", "_high")
    )
    known = np.isfinite(share) & np.isfinite(preload)
    if not known.any():
        return empty(ax, "no preload is reached")
    load, sign = scaled("N", preload[known])
    restoring = float(run["device/restoring_force"])
    handles: list[Any] = [
        ax.fill_between(preload[known] / load, low[known], high[known], color=VERMILION, alpha=0.2, linewidth=0,
                        label="95 % interval"),
        *ax.plot(preload[known] / load, share[known], "o-", color=VERMILION, markersize=3, clip_on=False,
                 label=f"pull-off force above {quantities.si(restoring, 'N')}"),
        *_model_range(ax, run, "stuck_probability_after_preload", preload / load),
    ]  # fmt: skip
    places(ax, preload[known] / load)
    ax.set_xlabel(label("preload", sign))
    probability(ax, f"probability to stay adhered\nunder {quantities.si(restoring, 'N', 3)}")
    legend(ax, handles)
    return ax


def _model_range(ax: Axes, run: Run, name: str, x: Any, unit: float = 1.0) -> list[Any]:
    """Lines over the preload around what plastic contacts give, where contacts yield."""
    if f"model_range/{name}" not in run:
        return []
    of = run[f"model_range/{name}"]
    low, high = (end.values / unit for end in (of.min("plastic_contact"), of.max("plastic_contact")))
    known = np.isfinite(low) & np.isfinite(x)
    # Dashes over the mean, which is at one end of the range.
    lines = [ax.plot(x[known], end[known], color="0.25", linewidth=0.9, linestyle=DASHED, label=MODEL_RANGE) for end in (low, high)]
    return list(lines[0])


@dressed
def force_curve(
    run: Run, ax: Axes | None = None, *, stiffness: Any = None, replica: int = 0, preload: Any = None
) -> Axes:
    """Force of one patch on a cantilever over the position of its piezo, as an AFM draws it: both branches, with jumps.

    Parameters
    ----------
    run : Run
        A loop with ``curves = true`` in ``[output]``.
    ax : matplotlib.axes.Axes, optional
    stiffness, replica, preload
        As of `Run.force_curve`.
    """
    ax = new_axes(ax)
    curve = of_run(run, stiffness, replica, preload)
    pull, force, piezo = float(curve["pull_off_force"]), curve["force"].values, curve["piezo_position"].values
    highest = float(force.max())
    unit, sign = scaled("N", max(pull, highest))
    length, length_sign = scaled("m", np.ptp(piezo))
    handles = _branches(ax, curve, unit, length)
    if pull > 0.0:
        deepest = int(np.where(curve["way"] == "retraction", force, np.inf).argmin())
        marker = ax.plot(piezo[deepest] / length, force[deepest] / unit, "o", color=VERMILION, markersize=2.5, zorder=6)
        marker[0].set_label(f"pull-off, {quantities.si(pull, 'N')}")
        handles += marker
    ax.margins(x=0.03)
    ax.set_ylim(-max(1.12 * pull, 0.06 * highest) / unit, 1.05 * highest / unit)
    ax.set(xlabel=label("piezo position", length_sign), ylabel=label("external force", sign))
    if highest > _FAR * pull > 0.0:
        # Where the surfaces are pressed far harder than they are pulled, the pull is drawn larger, too.
        part = ax.inset_axes((0.52, 0.45, 0.4, 0.5))
        pulls, pull_sign = scaled("N", pull)
        _branches(part, curve, pulls, length)
        near = piezo[force <= pull]
        part.set(xlim=(near.min() / length, (near.min() + 1.5 * (piezo[deepest] - near.min())) / length), ylim=(-1.15 * pull / pulls, pull / pulls))
        part.yaxis.tick_right()
        part.spines[["right", "left"]].set_visible(True)
        part.tick_params(labelsize=6)
        part.locator_params(nbins=4)
        part.text(0.97, 0.95, pull_sign, transform=part.transAxes, fontsize=6, ha="right", va="top")
    handles += left_out(run)
    words = f"cantilever {quantities.si(curve['stiffness'], 'N m-1', 3)}"
    handles.append(Line2D([], [], linestyle="none", label=words))
    legend(ax, handles)
    return ax


def _branches(ax: Axes, curve: xarray.Dataset, unit: float, length: float) -> list[Any]:
    """Both branches of a force curve over the position of the piezo, with their jumps, and the lines of the legend."""
    handles: list[Any] = []
    # Where both branches lie on one line, that of contact, the approach is the thin one.
    for (way, _, color, _), width, paler in zip(BRANCHES[:2], (0.9, 3.0), (1.0, 0.6), strict=True):
        own = curve.isel(sample=np.flatnonzero(curve["way"] == way))
        x, y = own["piezo_position"].values / length, own["force"].values / unit
        jumps = curve.isel(jump=np.flatnonzero(curve["jump_way"] == way))
        # The line is broken at each jump.
        breaks = np.flatnonzero(np.isin(own["separation"].values, jumps["jump_separation"].values)) + 1
        order = 4.0 - width
        handles += ax.plot(np.insert(x, breaks, np.nan), np.insert(y, breaks, np.nan), color=to_rgba(color, paler), linewidth=width, zorder=order, label=way)
        for at in breaks:
            ax.plot(x[at - 1 : at + 1], y[at - 1 : at + 1], color=color, linestyle=_JUMP, linewidth=1.0, zorder=4.0)
        ax.plot(x[breaks - 1], y[breaks - 1], "o", color=color, markerfacecolor="white", markersize=4.5, zorder=5)
    ax.axhline(0.0, color=GREY, linewidth=0.5, zorder=0.5)
    return [*handles, Line2D([], [], color=GREY, linestyle=_JUMP, linewidth=1.0, marker="o", markerfacecolor="white", markersize=4.5, label="jumps")]
