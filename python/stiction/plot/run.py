"""Figures of a run: forces, regimes, deviations from the integral, pull-off forces of single replicas."""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from .. import quantities
from ..results import Run
from .style import (
    BLUE,
    COLORS,
    DASH_DOT,
    DASHED,
    GREEN,
    GREY,
    H_STAR,
    MODEL_RANGE,
    PINK,
    VERMILION,
    dressed,
    empty,
    is_noise,
    label,
    legend,
    logarithmic,
    marked_invalid,
    new_axes,
    plain,
    scaled,
)

__all__ = ["attraction", "deviation", "force", "histogram", "integral", "pull_off", "regimes"]


class Branch(NamedTuple):
    """A branch of curves: its name, the prefix of its datasets, and how it is drawn."""

    name: str
    prefix: str
    color: str
    line: Any


BRANCHES = (
    Branch("approach", "", BLUE, "-"),
    Branch("retraction", "retraction_", VERMILION, DASH_DOT),
    Branch("second approach", "reapproach_", COLORS[2], (0, (1.2, 1.2))),
)
_REGIMES = {
    "total": ("black", "-"),
    "noncontact": (BLUE, DASHED),
    "lubricant": (COLORS[4], "-"),
    "bridge": (COLORS[5], "-"),
    "elastic": (VERMILION, DASH_DOT),
    "elastoplastic": (COLORS[2], (0, (1.2, 1.2))),
    "plastic": (COLORS[3], (0, (9, 2))),
}


def values(run: Any, path: str) -> Any:
    """The numbers of a dataset."""
    return run[path].values


def branches(run: Run) -> list[Branch]:
    """The branches of the curves of a run."""
    if run.attrs["history"] == "loop":
        return [branch for branch in BRANCHES if f"integral/{branch.prefix}external_force" in run]
    return [Branch(plain(run.attrs["history"]), "", BLUE, "-")]


def left_out(run: Run) -> list[Line2D]:
    """The line of a legend on asperities that the law leaves out, where it leaves out any."""
    words = f"left out by the law:\n{run.left_out.split(' and ')[0]}"
    return [Line2D([], [], linestyle="none", label=words)] if run.left_out else []


def is_invalid(run: Run) -> Any:
    """Whether asperities are taken as independent and may not be, at each separation: closer than `independent_from` of a run that is invalid."""
    from_where = float(run["independence/independent_from"])
    whole = str(run["independence"].attrs["verdict"]) == "invalid" and "coupling" not in run
    return whole & ~(values(run, "integral/separation") >= from_where)


@dressed
def force(run: Run, ax: Axes | None = None, *, band: bool = True) -> Axes:
    """External force over the separation: mean over replicas, statistical integral, and where single replicas are.

    Parameters
    ----------
    run : Run
        The result; of a loop all its branches are drawn.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in; new ones by default.
    band : bool
        Whether to draw the ranges with 90 % and 50 % of the replicas, by their quantiles at each separation.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = new_axes(ax)
    x, lowest, highest = values(run, "ensemble/h_star"), 0.0, 0.0
    handles: list[Any] = []
    means = {of.name: values(run, f"ensemble/{of.prefix}external_force_mean") for of in branches(run)}
    integrals = {of.name: values(run, f"integral/{of.prefix}external_force") for of in branches(run)}
    bands = {}
    for way, prefix, *_ in branches(run):
        lowest = min(lowest, float(np.nanmin(means[way])))
        highest = max(highest, float(np.nanmax(means[way])))
        name = f"ensemble/{prefix}external_force_quantile"
        # The second approach lies on the retraction for the most part.
        if band and way != "second approach" and name in run and np.isfinite(values(run, name)).all():
            bands[way] = run[name].transpose("quantile", "separation").values
            lowest = min(lowest, float(bands[way].min()))
    # An integral that is far off must not press all else to a line.
    lowest = min(lowest, max(float(np.nanmin([*integrals.values()])), 3.0 * lowest))
    depth = -lowest if lowest < 0.0 else highest
    unit, sign = scaled("N", depth)
    several = len(means) > 1
    for way, _, color, line in branches(run):
        mean = means[way]
        if way in bands:
            quantile = bands[way] / unit
            ax.fill_between(x, quantile[0], quantile[4], color=color, alpha=0.15, linewidth=0, zorder=1)
            shade = ax.fill_between(
                x, quantile[1], quantile[3], color=color, alpha=0.25, linewidth=0, zorder=1
            )
            shade.set_label("50 % and 90 % of patches")
        drawn = ax.plot(
            x,
            mean / unit,
            color=color,
            linestyle=line,
            label=f"{way}, mean" if several else "mean over patches",
        )
        handles += drawn
        integral = ax.plot(
            x,
            integrals[way] / unit,
            color="black",
            linestyle=DASHED,
            linewidth=0.8,
            label="integral",
        )
    handles += integral
    if bands:
        # One entry is for both branches, and grey then.
        handles.append(Patch(color=GREY, alpha=0.4, linewidth=0, label=shade.get_label()) if several else shade)
    attrs = run["ensemble"].attrs
    pull, place = (
        float(attrs["pull_off_force"]),
        float(attrs["pull_off_separation"]) / float(run.attrs["surface_height_std"]),
    )
    if pull > 0.0:
        # The marker of a loop is on retraction.
        way, _, color, _ = branches(run)[:2][-1]
        at = np.interp(place, x, means[way]) / unit
        marker = ax.plot(place, at, "o", color=color, markerfacecolor="white", zorder=5, clip_on=False)
        of = "mean curve of the whole loop" if isinstance(run, Run) and run.after_largest_preload is not None else "mean"
        marker[0].set_label(f"pull-off of the {of}, {quantities.si(pull, 'N')}")
        handles += marker
    handles += _snaps(run, ax, x, means, unit)
    marks = [marked_invalid(ax, x, mean / unit, is_invalid(run)) for mean in means.values()]
    handles += [*marks[0], *left_out(run)]
    ax.axhline(0.0, color=GREY, linewidth=0.5, zorder=0.5)
    if lowest < 0.0:
        ax.set_ylim(-1.08 * depth / unit, min(1.05 * highest, 0.45 * depth) / unit)
    ax.set(xlabel=H_STAR, ylabel=label("external force", sign))
    legend(ax, handles)
    return ax


@dressed
def integral(run: Run, ax: Axes | None = None) -> Axes:
    """External force of the integral over the separation, on all branches."""
    ax = new_axes(ax)
    curves = [(way, values(run, f"integral/{prefix}external_force"), color, line) for way, prefix, color, line in branches(run)]
    lowest, highest = (float(of([of(force) for _, force, _, _ in curves])) for of in (np.nanmin, np.nanmax))
    depth = -lowest if lowest < 0.0 else highest
    unit, sign = scaled("N", depth)
    handles: list[Any] = []
    for way, force, color, line in curves:
        handles += ax.plot(values(run, "integral/h_star"), force / unit, color=color, linestyle=line, label=f"integral, {way}")
    marks = [marked_invalid(ax, values(run, "integral/h_star"), force / unit, is_invalid(run)) for _, force, _, _ in curves]
    handles += [*marks[0], *left_out(run)]
    ax.axhline(0.0, color=GREY, linewidth=0.5, zorder=0.5)
    if lowest < 0.0:
        ax.set_ylim(-1.08 * depth / unit, min(1.05 * highest, 0.45 * depth) / unit)
    ax.set(xlabel=H_STAR, ylabel=label("external force", sign))
    legend(ax, handles)
    return ax


def _snaps(run: Run, ax: Axes, x: Any, means: dict[str, Any], unit: float) -> list[Any]:
    """Markers on the curve where surfaces on a spring jump in on approach, on average."""
    if "replicas/snap_in_separation" not in run:
        return []
    snaps = run["replicas/snap_in_separation"]
    handles: list[Any] = []
    for index, stiffness in enumerate(np.atleast_1d(run["replicas/stiffness"].values)):
        places = snaps.isel(stiffness=index).values
        share = float(np.isfinite(places).mean())
        if share == 0.0 or handles:
            continue
        place = float(np.nanmean(places)) / float(run.attrs["surface_height_std"])
        at = np.interp(place, x, next(iter(means.values()))) / unit
        drawn = ax.plot(place, at, "v", color=COLORS[2], zorder=6)
        drawn[0].set_label(f"snap-in, mean of {100 * share:.0f} % at {quantities.si(stiffness, 'N m-1', 3)}")
        handles += drawn
    return handles


@dressed
def regimes(run: Run, ax: Axes | None = None) -> Axes:
    """Adhesion force by regime over the separation: means as lines, the integral as dots."""
    ax = new_axes(ax)
    x = values(run, "ensemble/h_star")
    curves = {"total": (values(run, "ensemble/adhesion_force_mean"), values(run, "integral/adhesion_force"))}
    names = [plain(name) for name in run["ensemble/regime"].values]
    pair = (run["ensemble/regime_adhesion_force_mean"], run["integral/regime_adhesion_force"])
    means, integrals = (of.transpose("regime", "separation").values for of in pair)
    for name, mean, integral in zip(names, means, integrals, strict=True):
        key = "elastoplastic" if name.startswith("elastoplastic") else name
        before = curves.get(key, (0.0, 0.0))
        curves[key] = (before[0] + mean, before[1] + integral)
    total = curves["total"][0]
    if not total.max() > 0.0:
        return empty(ax, "the law has no adhesion")
    unit, sign = scaled("N", total)
    handles: list[Any] = []
    dots: list[Any] = []
    step = max(1, x.size // 30)
    for name, (mean, integral) in curves.items():
        if name != "total" and not np.any(mean != 0.0):
            continue
        color, line = _REGIMES.get(name, (GREY, "-"))
        drawn = [np.where(of > 0.0, of, np.nan) / unit for of in (mean, integral)]
        handles += ax.plot(x, drawn[0], color=color, linestyle=line, label=name)
        dots = ax.plot(x[::step], drawn[1][::step], "o", color="black", markerfacecolor="white", markersize=2,
                       markeredgewidth=0.5, label="integral")  # fmt: skip
    if logarithmic(ax, "y", total):
        ax.set_ylim(0.3 * total.min() / unit, 2.0 * total.max() / unit)
    else:
        ax.set_ylim(0.0, 1.08 * total.max() / unit)
    ax.set(xlabel=H_STAR, ylabel=label("adhesion force", sign))
    legend(ax, handles + dots, columns=3)
    return ax


@dressed
def attraction(run: Run, ax: Axes | None = None) -> Axes:
    """Attraction over the separation: by asperities, mean over replicas, and by terms of the mean planes.

    For runs with forces between the mean planes. Of a loop the asperities are on retraction.
    """
    ax = new_axes(ax)
    x = values(run, "background/h_star")
    prefix = branches(run)[-1].prefix
    asperities = values(run, f"ensemble/{prefix}adhesion_force_mean")
    looks = itertools.cycle(zip((VERMILION, *COLORS[2:]), itertools.cycle((DASH_DOT, DASHED))))
    planes = [(name, values(run, path), *next(looks)) for name, path in run.mean_plane_forces.items()]
    together = ("together", asperities + values(run, "background/force"), "0.7", "-")
    curves: list[tuple[str, Any, Any, Any]] = [("asperities", asperities, BLUE, "-"), *planes]
    # The sum lies under its parts, broad, since one of them is most of it.
    curves = [curve for curve in (together, *curves) if np.any(curve[1] != 0.0)]
    if not curves:
        return empty(ax, "nothing attracts")
    everything = np.abs(np.concatenate([force for _, force, _, _ in curves]))
    unit, sign = scaled("N", everything)
    handles: list[Any] = []
    # Where caps take off more than the mean planes have the force is below 0, and its size is drawn thin.
    for name, force, color, line in curves:
        width = 4.0 if name == "together" else 1.3
        handles += ax.plot(x, np.where(force > 0.0, force, np.nan) / unit, color=color, linestyle=line, linewidth=width, label=name)
        if np.any(force < 0.0):
            taken = ax.plot(x, np.where(force < 0.0, -force, np.nan) / unit, color=color, linestyle=line, linewidth=0.6)
            taken[0].set_label(f"{name}, taken off")
            handles += taken
    if logarithmic(ax, "y", everything[everything > 0.0]):
        ax.set_ylim(max(0.3 * everything[everything > 0.0].min(), 1e-6 * everything.max()) / unit, 3.0 * everything.max() / unit)
    else:
        ax.set_ylim(0.0, 1.08 * everything.max() / unit)
    ax.set(xlabel=H_STAR, ylabel=label("attraction", sign))
    legend(ax, handles, columns=2)
    return ax


@dressed
def deviation(run: Run, ax: Axes | None = None) -> Axes:
    """Deviation of the means from the integral, in standard errors, and what the joint test leaves out."""
    ax = new_axes(ax)
    x, limit = values(run, "validation/h_star"), 3.0
    handles: list[Any] = []
    left_out = np.zeros(x.size, bool)
    for name, words, color, line in (
        ("external_force", "external force", BLUE, "-"),
        ("adhesion_force", "adhesion force", VERMILION, DASH_DOT),
    ):
        z, tested = values(run, f"validation/z_{name}"), values(run, f"validation/tested_{name}") != 0
        handles += ax.plot(x, z, color=color, linestyle=line, linewidth=1.0, label=words)
        left_out |= ~tested
        size = np.abs(np.where(np.isfinite(z), z, 0.0))
        limit = max(limit, 1.1 * size[tested].max(initial=0.0), min(1.1 * size.max(), 8.0))
    for level in (-2.0, 0.0, 2.0):
        ax.axhline(level, color=GREY, linewidth=0.5, linestyle="--" if level else "-", zorder=1)
    if left_out.any():
        shade = ax.fill_between(
            x,
            0,
            1,
            where=left_out,
            transform=ax.get_xaxis_transform(),
            color="0.5",
            alpha=0.15,
            linewidth=0,
            zorder=0,
        )
        shade.set_label("left out of the joint test")
        handles.append(shade)
    ax.set(xlabel=H_STAR, ylabel="deviation (standard errors)", ylim=(-limit, limit))
    legend(ax, handles, columns=3)
    return ax


def histogram(ax: Axes, numbers: Any, unit: float, words: str, color: str = GREY) -> Any:
    """Bars of how many replicas have which value, outlined so that none hides others, those over others by dashes; what varies by rounding
    only has one bar."""
    noise = is_noise(numbers)
    count = 1 if noise else min(max(round(2.0 * numbers.size ** (1 / 3)), 8), 40)
    middle = float(np.mean(numbers)) / unit
    bars: Any
    _, _, bars = ax.hist(numbers / unit, count, range=(min(0.98 * middle, 1.02 * middle), max(0.98 * middle, 1.02 * middle)) if noise and middle else None,
                         facecolor=to_rgba(color, 0.3), edgecolor=color, linewidth=0.9, linestyle="--" if ax.patches else "-")  # fmt: skip
    bars[0].set_label(words)
    ax.xaxis.set_major_locator(MaxNLocator(nbins=6))
    ax.yaxis.set_major_locator(MaxNLocator(nbins=5, integer=True))
    return bars[0]


def model_span(ax: Axes, of: xarray.DataArray | None, sign: str, unit: float) -> list[Any]:
    """A bar above histograms from the smallest to the largest mean by any plastic contact, where contacts yield; cut off where the axis would
    be more than twice as long for it."""
    if of is None or of.isnull().all():
        return []
    low, high = float(of.min()), float(of.max())
    words = f"{MODEL_RANGE}, {quantities.number(low / unit, 3)} to {quantities.number(high / unit, 3)} {sign}"
    left, right = ax.get_xlim()
    width = right - left
    ax.set_ylim(top=1.12 * ax.get_ylim()[1])
    bar = ax.plot([low / unit, high / unit], [0.95, 0.95], transform=ax.get_xaxis_transform(), color=GREEN, linewidth=4.0, alpha=0.7,
                  solid_capstyle="butt", zorder=0.5, label=words)  # fmt: skip
    ax.set_xlim(min(left, max(low / unit, left - width)), max(right, min(high / unit, right + width)))
    return list(bar)


@dressed
def pull_off(run: Run, ax: Axes | None = None, *, preload: Any = None) -> Axes:
    """Distribution of the pull-off force over replicas, its mean, pull-offs of mean curve and integral, and the force of a device.

    Parameters
    ----------
    run : Run
        Of a loop both branches are drawn.
    ax : matplotlib.axes.Axes, optional
    preload : str or float, optional
        The preload of the scene before the pull-off; by default the largest that is reached.

    Raises
    ------
    SceneError
        The scene has no such preload.
    """
    ax = new_axes(ax)
    of_replicas, way = values(run, "replicas/pull_off_force"), "retraction"
    pressed, quoted = run.after_preload(preload), run.pull_off
    mean, error = quoted.mean_over_patches, quoted.standard_error
    if pressed is not None:
        if not float(pressed["count"]) > 0.0:
            return empty(ax, "no patch reaches a preload" if preload is None else f"no patch reaches {preload}")
        load, mean, error = (float(pressed[name]) for name in ("preload", "mean_over_patches", "standard_error"))
        after = run["replicas/pull_off_after_preload"].sel(preload=load).values
        of_replicas, way = after[np.isfinite(after)], f"after {quantities.si(load, 'N', 3)}"
    if not of_replicas.max() > 0.0:
        return empty(ax, "no replica pulls")
    there = (
        values(run, "replicas/approach_pull_off_force") if "replicas/approach_pull_off_force" in run else None
    )
    unit, sign = scaled("N", of_replicas if there is None else np.concatenate([of_replicas, there]))
    handles: list[Any] = []
    if there is not None:
        handles.append(histogram(ax, there, unit, f"approach, {there.size} patches", BLUE))
    handles.append(histogram(ax, of_replicas, unit, f"{f'{way}, ' if there is not None else ''}{of_replicas.size} patches",
                             GREY if there is None else VERMILION))  # fmt: skip
    lines: list[tuple[float, str, Any]] = [(mean, f"mean over patches, {quantities.with_error(mean, error, 'N')}", "-")]
    # The mean curve and the integral turn at the closest separation.
    if pressed is None:
        lines += [
            (quoted.of_mean_curve, f"of the mean curve, {quantities.si(quoted.of_mean_curve, 'N')}", DASH_DOT),
            (quoted.of_integral, f"of the integral, {quantities.si(quoted.of_integral, 'N')}", DASHED),
        ]
    for value, words, line in lines:
        handles.append(ax.axvline(value / unit, color="black", linestyle=line, label=words))
    force = run.restoring_force
    if force is not None and 0.3 * of_replicas.min() < force < 3.0 * of_replicas.max():
        share = float(run.stuck_after(preload)["stuck_probability"])
        words = f"restoring force, {quantities.si(force, 'N', 3)}: {quantities.number(100.0 * share, 3)} % above"
        handles.append(ax.axvline(force / unit, color=PINK, linestyle=":", label=words))
    ax.set(xlabel=label("pull-off force", sign), ylabel="patches")
    ax.margins(x=0.04)
    by_contact = run.model_range_after(preload)
    handles += model_span(ax, by_contact.get("pull_off_force") if by_contact is not None else None, sign, unit)
    legend(ax, handles)
    return ax
