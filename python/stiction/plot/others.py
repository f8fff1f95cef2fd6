"""Figures of sweeps over laws, patches of several sizes, asperities of maps, and runs that end at targets."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from .. import quantities
from ..errors import FileError
from ..results import Asperities, Run, Sweep
from .run import histogram, values
from .style import (
    BLUE,
    COLORS,
    DASH_DOT,
    DASHED,
    GREEN,
    GREY,
    H_STAR,
    LINES,
    VERMILION,
    dressed,
    empty,
    folded,
    label,
    legend,
    marked_invalid,
    new_axes,
    plain,
    readable,
    scaled,
)

__all__ = [
    "asperities", "bias", "comparison", "convergence", "curvatures", "density_over_cutoff", "draw_map", "heights", "law_deviation",
    "radius_over_cutoff", "relation", "scatter", "scatter_over_cutoff", "sizes", "standard_errors",
]  # fmt: skip


@dressed
def comparison(result: Sweep, ax: Axes | None = None) -> Axes:
    """External force of the integral by each law; means over replicas as dots where there are ensembles.

    For sweeps over `model.law` alone.
    """
    ax = new_axes(ax)
    x, forces, laws = (values(result, path) for path in ("integral/h_star", "integral/external_force", "model_law"))
    handles: list[Any] = []
    depth, highest = -float(np.nanmin(forces)), float(np.nanmax(forces))
    unit, sign = scaled("N", depth if depth > 0.0 else highest)
    for place, law in enumerate(laws):
        color = COLORS[place % len(COLORS)]
        handles += ax.plot(
            x[place], forces[place] / unit, color=color, linestyle=LINES[place % len(LINES)], label=plain(law)
        )
        if "ensemble/external_force_mean" in result:
            step = max(1, x.shape[1] // 40)
            ax.plot(
                x[place, ::step],
                values(result, "ensemble/external_force_mean")[place, ::step] / unit,
                "o",
                color=color,
                markerfacecolor="white",
                markersize=2.5,
                markeredgewidth=0.6,
            )
    ax.axhline(0.0, color=GREY, linewidth=0.5, zorder=0.5)
    if depth > 0.0:
        ax.set_ylim(-1.1 * depth / unit, min(1.05 * highest, 0.6 * depth) / unit)
    ax.set(xlabel=H_STAR, ylabel=label("external force", sign))
    legend(ax, handles, columns=4)
    return ax


@dressed
def law_deviation(result: Sweep, ax: Axes | None = None) -> Axes:
    """The deviation of the pull-off force of each law from the first law's, in per cent.

    For sweeps over `model.law` alone.
    """
    ax = new_axes(ax)
    forces = values(result, "integral/pull_off_force")
    pulls = np.where(forces > 0.0, forces, np.nan)
    off = 100.0 * (pulls / pulls[0] - 1.0)
    places = np.arange(off.size)
    ax.barh(places, np.nan_to_num(off), color=[COLORS[place % len(COLORS)] for place in places], height=0.6)
    for place, value, force in zip(places, off, forces, strict=True):
        text = quantities.si(force, "N") if force > 0.0 else "no pull-off"
        text += f", {value:+.1f} %".replace("-", "−") if place and math.isfinite(value) else ""
        ax.annotate(
            text,
            (max(float(np.nan_to_num(value)), 0.0), place),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=7,
        )
    ax.axvline(0.0, color=GREY, linewidth=0.5)
    ax.set(yticks=places, yticklabels=[plain(law) for law in values(result, "model_law")], ylabel="law")
    ax.set(xlabel="pull-off force against that of the first law (%)")
    ax.invert_yaxis()
    if not np.nan_to_num(off).any():
        ax.set_xlim(-1.0, 1.0)
    ax.margins(x=0.35)
    return ax


def _plain(ax: Axes, axis: str) -> None:
    (ax.xaxis if axis == "x" else ax.yaxis).set_major_formatter(StrMethodFormatter("{x:g}"))


_COUNT = "asperities of a patch"


@dressed
def sizes(study: xarray.Dataset, ax: Axes | None = None) -> Axes:
    """Pull-off force of single patches over the integral's, by the number of asperities of a patch.

    It takes what `stiction.finite_size.study` finds in a sweep.
    """
    ax = new_axes(ax)
    n, quantile = values(study, "asperity_count"), values(study, "pull_off_quantiles")
    handles: list[Any] = []
    for (low, high), alpha in zip([(0, 6), (1, 5), (2, 4)], [0.12, 0.18, 0.25], strict=True):
        shade = ax.fill_between(n, quantile[:, low], quantile[:, high], color=BLUE, alpha=alpha, linewidth=0)
        shade.set_label(f"{(98, 90, 50)[low]} % of patches")
        handles.append(shade)
    handles += ax.plot(n, quantile[:, 3], color=BLUE, label="median")
    handles += ax.plot(n, 1.0 + values(study, "bias"), "o", color="black", label="mean")
    handles.append(ax.axhline(1.0, color="black", linestyle=DASHED, linewidth=0.8, label="integral"))
    handles += marked_invalid(ax, n, 1.0 + values(study, "bias"), values(study, "independence") == "invalid")
    ax.set(xscale="log", xlabel=_COUNT, ylabel="pull-off force over the integral's")
    if quantile.max() > 4.0 * max(float(quantile.min()), 0.01):
        ax.set_yscale("log")
        ax.set_ylim(max(0.6 * quantile[:, 0].min(), 0.01), 1.6 * quantile.max())
        _plain(ax, "y")
    legend(ax, handles, columns=3)
    return ax


@dressed
def bias(study: xarray.Dataset, ax: Axes | None = None) -> Axes:
    """The excess of the mean pull-off of patches over the integral's, with the law that is fitted to it.

    It takes what `stiction.finite_size.study` finds in a sweep.
    """
    ax = new_axes(ax)
    n, of, error = (values(study, name) for name in ("asperity_count", "bias", "bias_standard_error"))
    fitted = values(study, "is_fitted") == 1
    handles: list[Any] = []
    for use, face, words in ((fitted, BLUE, "fitted"), (~fitted, "white", "not fitted")):
        use = use & (of > 0.0)
        if use.any():
            # Downwards as far as a logarithm goes.
            below = np.minimum(error[use], 0.999 * of[use])
            handles.append(
                ax.errorbar(n[use], 100.0 * of[use], 100.0 * np.vstack([below, error[use]]), color=BLUE, marker="o",
                            markerfacecolor=face, linewidth=0, elinewidth=1.0, label=f"mean ± standard error, {words}")
            )  # fmt: skip
    if "fit_exponent" in study.attrs:
        c, a = float(study.attrs["fit_coefficient"]), float(study.attrs["fit_exponent"])
        furthest = np.nanmax([n[-1], *values(study, "count_at_accuracy")])
        x = np.geomspace(n[fitted][0] / 2.0, furthest * 1.5, 50)
        error_a = float(study.attrs["fit_exponent_standard_error"])
        words = f"{float(f'{c:.3g}'):g} $N^{{-{a:.3f}}}$, exponent ± {error_a:.1g}"
        handles += ax.plot(x, 100.0 * c * x**-a, color=VERMILION, linestyle=DASHED, label=words)
    sources = values(study, "count_at_accuracy_source")
    counts, accuracies = values(study, "count_at_accuracy"), values(study, "accuracy")
    for accuracy, count, source in zip(accuracies, counts, sources, strict=True):
        ax.axhline(100.0 * accuracy, color="0.8", linewidth=0.5, zorder=0)
        if math.isfinite(count):
            ax.plot([count], [100.0 * accuracy], "s", color=GREEN, markerfacecolor="none")
            text = f"{100 * accuracy:g} % from {quantities.number(count, 2)}" + (
                " (extrapolated)" if str(source) == "extrapolated" else ""
            )
            left = count > 30.0 * n[0]
            ax.annotate(text, (count, 100.0 * accuracy), xytext=(-5, -2) if left else (5, 2), textcoords="offset points",
                        fontsize=7, color=GREEN, ha="right" if left else "left", va="top" if left else "bottom")  # fmt: skip
    if not (of > 0.0).any():
        return empty(ax, "no size has a positive bias")
    ax.set(xscale="log", yscale="log", xlabel=_COUNT, ylabel="mean less integral (% of it)")
    ax.set_ylim(bottom=40.0 * min(float(of[of > 0.0].min(initial=0.01)), 0.01))
    _plain(ax, "y")
    legend(ax, handles, columns=1)
    return ax


@dressed
def scatter(study: xarray.Dataset, ax: Axes | None = None) -> Axes:
    """Scatter of the pull-off force from patch to patch, by the number of asperities of a patch.

    It takes what `stiction.finite_size.study` finds in a sweep.
    """
    ax = new_axes(ax)
    n, of = values(study, "asperity_count"), 100.0 * values(study, "relative_std")
    error = of / math.sqrt(2.0 * max(int(study.attrs["replicas"]) - 1, 1))
    handles: list[Any] = [
        ax.errorbar(
            n,
            of,
            error,
            color=BLUE,
            marker="o",
            linewidth=0.9,
            elinewidth=1.0,
            label="standard deviation over mean",
        )
    ]
    x = n[of[-1] * np.sqrt(n[-1] / n) < 2.0 * np.nanmax(of)]
    handles += ax.plot(
        x,
        of[-1] * np.sqrt(n[-1] / x),
        color=GREY,
        linestyle=DASHED,
        linewidth=1.0,
        label="$N^{-1/2}$ through the last",
    )
    ax.set(xscale="log", yscale="log", xlabel=_COUNT, ylabel=folded("patch-to-patch standard deviation (%)"))
    ax.set_ylim(0.5 * np.nanmin(of), 2.0 * np.nanmax(of))
    _plain(ax, "y")
    legend(ax, handles)
    return ax


@dressed
def asperities(result: Asperities, ax: Axes | None = None) -> Axes:
    """The map with the asperities that were found on it.

    Files before version 2.1 have no map; their asperities are drawn by their heights.
    """
    ax = new_axes(ax)
    dy, dx = (float(size) for size in result.attrs["pixel_size"])
    x, y, z = (values(result, f"asperities/{name}") for name in ("x", "y", "height"))
    if "map/height" in result:
        return draw_map(ax, result.map.values, (dx, dy), (x, y))
    rows, columns = (int(count) for count in result.attrs["map_shape"])
    unit, sign = scaled("m", max(rows * dy, columns * dx))
    z_unit, z_sign = scaled("m", z)
    drawn = ax.scatter(x / unit, y / unit, min(max(2000.0 / z.size, 1.0), 20.0), z / z_unit, cmap="cividis")
    ax.set(xlim=(0.0, columns * dx / unit), ylim=(rows * dy / unit, 0.0), aspect="equal")
    return _of_map(ax, drawn, sign, z_sign)


def draw_map(ax: Axes, heights: Any, pixel: tuple[float, float], places: tuple[Any, Any]) -> Axes:
    """Draws a map and the places of its summits.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
    heights : array (ny, nx)
        Heights, m.
    pixel : pair of float
        Width and height of a pixel, m.
    places : pair of arrays (summits,)
        x and y of the summits, m.
    """
    (rows, columns), (dx, dy) = heights.shape, pixel
    unit, sign = scaled("m", max(rows * dy, columns * dx))
    z_unit, z_sign = scaled("m", heights)
    extent = (0.0, columns * dx / unit, rows * dy / unit, 0.0)
    drawn = ax.imshow(heights / z_unit, extent=extent, cmap="cividis", interpolation="nearest", rasterized=True)
    x, y = places
    # Thin rings, so that the map is seen within and between them.
    size = min(max(60.0 / max(x.size, 1) ** 0.5, 1.2), 3.5)
    ax.plot(x / unit, y / unit, "o", markerfacecolor="none", markeredgecolor=VERMILION, markeredgewidth=0.4, markersize=size, linestyle="none")
    return _of_map(ax, drawn, sign, z_sign)


def _of_map(ax: Axes, drawn: Any, sign: str, z_sign: str) -> Axes:
    """Labels of a map, with a bar of its heights."""
    ax.spines[["top", "right"]].set_visible(True)
    ax.set(xlabel=label("x", sign), ylabel=label("y, as the rows\nof the map", sign))
    bar = ax.figure.colorbar(drawn, ax=ax, label=label("height", z_sign), shrink=0.9)
    bar.outline.set_linewidth(0.5)
    return ax


def nayak(s: Any, alpha: float) -> Any:
    """Probability density of the heights s of summits of a Gaussian surface, over its standard deviation (Nayak 1971).

    `alpha`, m0 m4/m2², is above 3/2.
    """
    erf = np.vectorize(math.erf)
    c = 2.0 * alpha - 3.0
    rise = np.exp(-alpha * s**2 / c) * math.sqrt(3.0 * c) / alpha * s
    middle = 3.0 * math.sqrt(2.0 * math.pi) / (2.0 * alpha) * np.exp(-0.5 * s**2)
    middle = middle * (1.0 + erf(math.sqrt(1.5 / c) * s)) * (s**2 - 1.0)
    rest = math.sqrt(2.0 * math.pi * alpha / (3.0 * (alpha - 1.0))) * np.exp(
        -alpha * s**2 / (2.0 * (alpha - 1.0))
    )
    rest = rest * (1.0 + erf(math.sqrt(alpha / (2.0 * (alpha - 1.0) * c)) * s))
    return math.sqrt(3.0) / (2.0 * math.pi) * (rise + middle + rest)


@dressed
def heights(result: Asperities, ax: Axes | None = None) -> Axes:
    """Distribution of the heights of the asperities, with Nayak's density and the equivalent Gaussian."""
    ax = new_axes(ax)
    of, alpha, m0 = (
        values(result, "asperities/height"),
        float(result["surface/alpha"]),
        float(result["surface/m0"]),
    )
    unit, sign = scaled("m", of)
    mean, std = (float(result[f"equivalent/asperity_height_{name}"]) for name in ("mean", "std"))
    count = min(max(round(2.0 * of.size ** (1 / 3)), 8), 40)
    bars: Any
    _, _, bars = ax.hist(of / unit, count, density=True, color="0.8", edgecolor="0.4", linewidth=0.4)
    bars[0].set_label("asperities")
    handles: list[Any] = [bars[0]]
    spread = max(std, float(of.std()))
    z = np.linspace(min(mean - 4.0 * std, of.min() - spread), max(mean + 4.0 * std, of.max() + spread), 400)
    if alpha > 1.5:
        density = nayak(z / math.sqrt(m0), alpha) / math.sqrt(m0)
        handles += ax.plot(z / unit, density * unit, color=BLUE, label=f"Nayak, α = {alpha:.3g}")
    if std > 0.0:
        density = np.exp(-0.5 * ((z - mean) / std) ** 2) / (std * math.sqrt(2.0 * math.pi))
        handles += ax.plot(
            z / unit, density * unit, color=VERMILION, linestyle=DASHED, label="equivalent Gaussian"
        )
    ax.set(xlabel=label("height above the mean plane", sign), ylabel=label("density", f"1/{sign}"))
    legend(ax, handles, columns=3)
    return ax


@dressed
def relation(result: Asperities, ax: Axes | None = None) -> Axes:
    """Curvature of the asperities over their height; the legend has the correlation."""
    ax = new_axes(ax)
    of, curvature = values(result, "asperities/height"), 1.0 / values(result, "asperities/radius")
    unit, sign = scaled("m", of)
    per, per_sign = scaled("m", float(result["measured/asperity_radius"]))
    correlation = np.corrcoef(of, curvature)[0, 1] if of.size > 2 else math.nan
    handles = ax.plot(of / unit, curvature * per, "o", color=BLUE, markersize=2, alpha=0.6, markeredgewidth=0)
    handles[0].set_label(f"asperities, correlation {quantities.number(correlation, 2)}")
    ax.set(
        xlabel=label("height above the mean plane", sign),
        ylabel=label("mean curvature", f"1/{per_sign}"),
        ylim=(0.0, None),
    )
    legend(ax, handles)
    return ax


@dressed
def curvatures(result: Asperities, ax: Axes | None = None) -> Axes:
    """Distribution of the curvatures of the asperities, their mean, and the equivalent surface's."""
    ax = new_axes(ax)
    curvature = 1.0 / values(result, "asperities/radius")
    measured, theory = float(result["measured/asperity_radius"]), float(result["equivalent/asperity_radius"])
    unit, sign = scaled("m", measured)
    handles = [histogram(ax, curvature * unit, 1.0, "asperities")]
    for radius, words, color, line in (
        (measured, "mean", "black", "-"),
        (theory, "by the moments", VERMILION, DASH_DOT),
    ):
        text = f"{words}, R = {quantities.si(radius, 'm')}"
        handles.append(ax.axvline(unit / radius, color=color, linestyle=line, label=text))
    ax.set(xlabel=label("mean curvature", f"1/{sign}"), ylabel="asperities", xlim=(0.0, None))
    legend(ax, handles)
    return ax


def _over_cutoff(ax: Axes, result: Asperities, name: str, words: str, unit: str, power: int = 1) -> Axes:
    """A number of the summits over the cut-off, and the one that the map was smoothed with; with its error by their number."""
    cutoff, count, of = (values(result, f"cutoffs/{which}") for which in ("cutoff", "summit_count", name))
    there = (count > 1) & np.isfinite(of)
    if not there.any():
        return empty(ax, "no cut-off leaves two summits")
    cutoff, count, of = cutoff[there], count[there], of[there]
    measured, chosen = float(result[f"measured/{name}"]), float(result.attrs["smooth"])
    x_unit, x_sign = scaled("m", cutoff)
    factor, sign = scaled(unit, of, measured) if power == 1 else (1e12, "1/µm²")
    # Errors of a number that is counted, of the reciprocal of a mean, and of a standard deviation.
    error = of / np.sqrt(count if name != "asperity_height_std" else 2.0 * (count - 1.0))
    if name == "asperity_radius":
        error *= of * values(result, "cutoffs/asperity_curvature_std")[there]
    shade = ax.fill_between(
        cutoff / x_unit, (of - error) / factor, (of + error) / factor, color=BLUE, alpha=0.2, linewidth=0
    )
    shade.set_label("± standard error")
    line = ax.plot(cutoff / x_unit, of / factor, "o-", color=BLUE, markersize=3, label="of summits")
    handles: list[Any] = [*line, shade]
    if chosen > 0.0:
        text = f"smoothed with {quantities.si(chosen, 'm')}"
        handles += ax.plot(
            chosen / x_unit, measured / factor, "D", color=VERMILION, markersize=5, label=text
        )
        ax.axvline(chosen / x_unit, color=VERMILION, linestyle=DASH_DOT, linewidth=0.8, zorder=0.5)
    else:
        handles.append(
            ax.axhline(measured / factor, color=VERMILION, linestyle=DASH_DOT, label="not smoothed")
        )
    ax.set(xscale="log", xlabel=label("cut-off wavelength of the filter", x_sign), ylabel=label(words, sign))
    if name == "asperity_height_std":
        ax.set_ylim(0.0, 1.1 * max(float(np.max(of + error)), measured) / factor)
    else:
        ax.set_yscale("log")
        low, high = min(float(of.min()), measured), max(float(of.max()), measured)
        ax.set_ylim(0.6 * low / factor, 1.6 * high / factor)
        _plain(ax, "y")
        if high < 10.0 * low:
            ax.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        ax.yaxis.set_minor_formatter(NullFormatter())
    _plain(ax, "x")
    legend(ax, handles, columns=3)
    return ax


@dressed
def density_over_cutoff(result: Asperities, ax: Axes | None = None) -> Axes:
    """Density of the summits over the cut-off of the filter; where it settles there is more than noise.

    For asperities that were found with `cutoffs`.
    """
    return _over_cutoff(new_axes(ax), result, "asperity_density", "density of summits", "m-2", -2)


@dressed
def radius_over_cutoff(result: Asperities, ax: Axes | None = None) -> Axes:
    """Radius of the summits, the reciprocal of their mean curvature, over the cut-off of the filter.

    For asperities that were found with `cutoffs`.
    """
    return _over_cutoff(new_axes(ax), result, "asperity_radius", "radius, 1/mean curvature", "m")


@dressed
def scatter_over_cutoff(result: Asperities, ax: Axes | None = None) -> Axes:
    """Standard deviation of the heights of the summits over the cut-off of the filter.

    For asperities that were found with `cutoffs`.
    """
    return _over_cutoff(new_axes(ax), result, "asperity_height_std", "σₛ of summit heights", "m")


# Replicas of a group by the way they are drawn: groups are independent.
_GROUPS = {"independent": 1, "antithetic": 2, "stratified": 8}


def _course(run: Run, target: int) -> tuple[str, str, Any, Any, Any]:
    """Name and unit of a target, and its mean and standard error after groups of replicas from the third on."""
    names = [str(name) for name in run["ensemble/target"].values]
    if str(run["ensemble/target_estimate"].values[target]) != "plain":
        raise FileError(f"{names[target]}: the course of a mean with control variates is not in the file")
    name, unit = plain(names[target]), plain(run["ensemble/target_units"].values[target])
    group, of = _GROUPS[str(run.attrs["sampling"])], values(run, f"replicas/{names[target]}")
    means = of[: of.size // group * group].reshape(-1, group).mean(axis=1)
    if means.size < 3:
        raise FileError("it has too few replicas for a course")
    count = np.arange(1, means.size + 1)
    shifted = means - means[0]
    mean = np.cumsum(shifted) / count
    squares = np.maximum(np.cumsum(shifted**2) - count * mean**2, 0.0)
    # As many as a logarithmic axis can show.
    shown = np.unique(np.geomspace(2, count.size - 1, 300).astype(int))
    error = np.sqrt(squares[shown] / (count[shown] - 1) / count[shown])
    return name, unit, group * count[shown], mean[shown] + means[0], error


def _words(name: str) -> str:
    return name.replace("pull_off", "pull-off").replace("_", " ")


@dressed
def convergence(run: Run, ax: Axes | None = None, *, target: int = 0) -> Axes:
    """The mean of a target over the number of replicas, with two standard errors.

    Parameters
    ----------
    run : Run
        That ended at targets.
    ax : matplotlib.axes.Axes, optional
    target : int
        Which of its targets.
    """
    ax = new_axes(ax)
    name, units, *course = _course(run, target)
    # Before the square root of all replicas the error is so large that nothing else would be seen.
    begin = np.searchsorted(course[0], math.sqrt(course[0][-1]))
    replicas, mean, error = (of[begin:] for of in course)
    unit, sign = scaled(units, mean[-1])
    shade = ax.fill_between(
        replicas, (mean - 2 * error) / unit, (mean + 2 * error) / unit, color=BLUE, alpha=0.2, linewidth=0
    )
    shade.set_label("± 2 standard errors")
    handles = ax.plot(replicas, mean / unit, color=BLUE, label="mean")
    ax.set(xlabel="replicas", ylabel=folded(label(f"mean {_words(name)}", sign)))
    readable(ax, "x", replicas)
    legend(ax, [*handles, shade])
    return ax


@dressed
def standard_errors(run: Run, ax: Axes | None = None, *, target: int = 0) -> Axes:
    """The standard error of a target over the number of replicas, and the largest that is allowed.

    Parameters
    ----------
    run : Run
        That ended at targets.
    ax : matplotlib.axes.Axes, optional
    target : int
        Which of its targets.
    """
    ax = new_axes(ax)
    name, units, replicas, _, error = _course(run, target)
    unit, sign = scaled(units, error[-1])
    handles = ax.plot(replicas, error / unit, color=BLUE, label="standard error")
    limit = float(run["ensemble/target_largest_standard_error"].values[target]) / unit
    handles.append(ax.axhline(limit, color=VERMILION, linestyle=DASHED, label="largest allowed"))
    met = bool(run["ensemble/target_met"].values[target])
    handles += ax.plot(
        replicas[-1],
        error[-1] / unit,
        "o",
        color=GREEN if met else VERMILION,
        label="end, met" if met else "end, missed",
    )
    ax.set(xlabel="replicas", ylabel=folded(label(f"standard error of {_words(name)}", sign)))
    readable(ax, "x", replicas)
    readable(ax, "y", error / unit)
    legend(ax, handles, columns=3)
    return ax
