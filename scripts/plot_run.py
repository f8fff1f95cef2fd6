"""One page of pictures of a result of `stiction run`.

(a) external force F and adhesion force F_s over the separation h* around the adhesive well: mean over
    replicas, standard deviation of one replica, statistical integral, and pull-off of the mean curve;
(b) deviation of both means from the integral, in standard errors, with the verdict of the joint test;
(c) adhesion force of each regime, with an inset of the separations where contact sets in;
(d) pull-off forces of single replicas, their mean, and the pull-off of the mean curve and of the integral.

Usage:
    python scripts/plot_run.py FILE.h5 [-o OUT.png] [--dpi N]

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
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator, NullFormatter, StrMethodFormatter

from plot_page import BLUE, DASHED, DASH_DOT, PAGE, VERMILION, FileError, Result, main, panel, si

SEPARATION = r"separation $h$* = $h/\sigma$"
BAND, GREYS = "#BFDBEE", ("white", "0.92", "0.82")
# Colour, line style and width of the curves of (c); in grey, the line styles tell them apart.
CURVES = {
    "total": ("black", "-", 1.8),
    "noncontact": (BLUE, DASHED, 1.6),
    "lubricant": ("#E69F00", "-", 1.6),
    "elastic": (VERMILION, DASH_DOT, 1.6),
    "elastoplastic 1+2": ("#009E73", (0, (1.2, 1.2)), 1.8),
    "plastic": ("#CC79A7", (0, (9, 2)), 1.2),
}


class Run(Result):
    """A result of `stiction run`."""

    format, major_version, made_by = "stiction-run", 3, "a result of `stiction run`"
    style = {"axes.xmargin": 0.01}

    def pull_off_place(self) -> float:
        """h* of the pull-off of the mean curve."""
        place = self.attribute("ensemble", "pull_off_separation")
        return float(place / self.attribute("/", "surface_height_std"))


def newton(value: float, error: float = math.nan) -> str:
    factor, sign = si(abs(value))
    plus_minus = f" ± {error / factor:.2g}" if math.isfinite(error) else ""
    return f"{value / factor:#.4g}".rstrip(".").replace("-", "−") + f"{plus_minus} {sign}N"


def head(axes: Axes, title: str, handles: list[Artist], columns: int, rows: int) -> None:
    """Title and legend above the panel, where no curve can be beneath them."""
    axes.set_title(title, pad=8.0 + 12.2 * rows)
    axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=columns)


def empty(axes: Axes, title: str, reason: str) -> None:
    """A panel that has nothing to show, and why."""
    axes.set_title(title)
    axes.text(0.5, 0.5, reason, ha="center", va="center", transform=axes.transAxes)
    axes.set(xticks=[], yticks=[])


def force_range(mean: np.ndarray, std: np.ndarray, pull_off: float) -> tuple[float, float]:
    """Range of forces around the adhesive well; all of them where there is none."""
    std = np.nan_to_num(std)
    low, high = float((mean - std).min()), float((mean + std).max())
    if mean.min() >= 0.0:
        return low - 0.1 * (high - low), high + 0.1 * (high - low)
    depth = max(-1.6 * mean.min(), min(-1.1 * low, -2.6 * mean.min()), 1.1 * pull_off)
    return -depth, max(0.1 * depth, min(1.05 * high, 0.8 * depth))


def draw_forces(axes: Axes, run: Run) -> None:
    x, mean, std = run["ensemble/h_star"], run["ensemble/external_force_mean"], run["ensemble/external_force_std"]
    pull_off = run.attribute("ensemble", "pull_off_force")
    low, high = force_range(mean, std, pull_off)
    unit, sign = si(max(-low, high))
    handles = axes.plot(x, mean / unit, color=BLUE, linewidth=2.2, label="$F$, mean over replicas")
    handles += axes.plot(x, run["integral/external_force"] / unit, color="black", linestyle=(0, (4, 2)),
                         linewidth=0.9, label="$F$, integral")
    if np.isfinite(std).any():
        edges = (mean - std) / unit, (mean + std) / unit
        handles.append(axes.fill_between(x, *edges, facecolor=BAND, edgecolor=BLUE, linewidth=0.4, zorder=1,
                                         label="± standard deviation of one replica"))
    handles += axes.plot(x, -run["ensemble/adhesion_force_mean"] / unit, color=VERMILION, linestyle=DASH_DOT,
                         linewidth=1.2, zorder=1.8, label="$-F_s$, mean over replicas")
    label = f"pull-off: {newton(pull_off)} at $h$* = {run.pull_off_place():.2f}"
    label += " (edge)" if mean.argmin() in (0, mean.size - 1) else ""
    label = label if pull_off > 0.0 else "no pull-off: $F$ > 0 throughout"
    handles += axes.plot(run.pull_off_place(), -pull_off / unit, "o", color="black", markerfacecolor="white",
                         markersize=5.5, zorder=5, clip_on=False, label=label)
    axes.axhline(0.0, color="0.5", linewidth=0.6, zorder=0.5)
    axes.set(ylim=(low / unit, high / unit), ylabel=f"force, compressive positive ({sign}N)")
    axes.tick_params(labelbottom=False)
    head(axes, "(a) External force $F$ and adhesion force $F_s$", handles, 2, 3)


def draw_z(axes: Axes, run: Run) -> None:
    x, handles, left_out, limit = run["ensemble/h_star"], [], 0, 3.0
    for name, label, color, line in [("external_force", "$F$", BLUE, "-"),
                                     ("adhesion_force", "$F_s$", VERMILION, DASH_DOT)]:
        z, tested = run[f"validation/z_{name}"], run[f"validation/tested_{name}"] != 0
        handles += axes.plot(x, z, color=color, linestyle=line, linewidth=1.3, label=label,
                             marker="." if x.size <= 20 else None)
        left_out = left_out + ~tested
        # All that the test looks at is shown, the rest as far as 8 standard errors.
        size = np.abs(np.where(np.isfinite(z), z, 0.0))
        limit = max(limit, 1.1 * size[tested].max(initial=0.0), min(1.1 * size.max(), 8.0))
    for level in (-2.0, 0.0, 2.0):
        axes.axhline(level, color="0.35", linewidth=0.7, linestyle="--" if level else "-", zorder=1)
    middles = np.concatenate([x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]])
    greys = ListedColormap(GREYS)
    axes.pcolormesh(middles, [-limit, limit], [left_out], cmap=greys, vmin=0, vmax=2, zorder=0)
    labels = {1: "one of them left out of the joint test", 2: "both left out of the joint test"}
    handles += [Patch(color=GREYS[count], label=labels[count]) for count in labels if count in left_out]
    p_value = float(run.attribute("validation", "p_value"))
    verdict = run.attribute("validation", "verdict")
    level = 100.0 * float(run.attribute("validation", "significance"))
    verdict += f" at the {level:g} % level, p = {p_value:#.2g}" if math.isfinite(p_value) else ""
    axes.set(ylim=(-limit, limit), xlabel=SEPARATION, ylabel="$z$ (standard errors)")
    axes.set_title(f"(b) Deviation from the integral; joint test: {verdict}")
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(-0.02, -0.27), ncols=2)


def by_regime(run: Run, table: str, total: str) -> dict[str, np.ndarray]:
    """Total adhesion force, and that of each regime that has any, the elastoplastic ones together."""
    curves = {"total": run[total]}
    for name, curve in zip(run["ensemble/regime"], run[table]):
        name = "elastoplastic 1+2" if name.startswith(b"elastoplastic") else name.decode()
        curves[name] = curves.get(name, 0.0) + curve
    return {name: curve for name, curve in curves.items() if name == "total" or np.any(curve != 0.0)}


def draw_curves(axes: Axes, x: np.ndarray, means: dict, integrals: dict, unit: float, step: int) -> list:
    """Means as lines and integrals as dots, one every `step` separations."""
    handles, dots = [], []
    for name, curve in means.items():
        color, line, width = CURVES.get(name, ("0.4", "-", 1.0))
        handles += axes.plot(x, curve / unit, color=color, linestyle=line, linewidth=width, label=name)
        integral = integrals.get(name, 0.0 * curve)
        dots = axes.plot(x[::step], integral[::step] / unit, "o", color="black", markersize=2.2,
                         markerfacecolor="white", markeredgewidth=0.6, zorder=3, label="integral")
    return handles + dots


def draw_regimes(axes: Axes, run: Run) -> None:
    x = run["ensemble/h_star"]
    means = by_regime(run, "ensemble/regime_adhesion_force_mean", "ensemble/adhesion_force_mean")
    integrals = by_regime(run, "integral/regime_adhesion_force", "integral/adhesion_force")
    top = float(means["total"].max())
    if not top > 0.0:
        empty(axes, "(c) Adhesion force $F_s$ of each regime", "the law has no adhesion")
        return
    unit, sign = si(top)
    handles = draw_curves(axes, x, means, integrals, unit, max(1, x.size // 30))
    axes.set(xlabel=SEPARATION, ylabel=f"adhesion force ({sign}N)", ylim=(0.0, 1.08 * top / unit))
    head(axes, "(c) Adhesion force $F_s$ of each regime, mean over replicas", handles, 4, 2)
    draw_onset(axes, x, means, integrals, unit)


def draw_onset(axes: Axes, x: np.ndarray, means: dict, integrals: dict, unit: float) -> None:
    """An inset of the separations where noncontact asperities take over, if any do and there is room."""
    total = integrals["total"]
    over = np.flatnonzero(integrals.get("noncontact", 0.0 * total) > 0.5 * total)
    if over.size < 5 or over[0] == 0 or not total[-1] > 0.0:
        return
    first, left, bottom, height = max(over[0] - x.size // 10, 0), 0.46, 0.36, 0.56
    beneath = x > x[0] + (left - 0.1) * (x[-1] - x[0])
    headroom = float(means["total"][beneath].max()) / unit / (bottom - 0.14)
    if headroom > 1.7 * axes.get_ylim()[1]:
        return
    axes.set_ylim(0.0, max(headroom, axes.get_ylim()[1]))
    inset = axes.inset_axes((left, bottom, 0.985 - left, height))
    unit, sign = si(float(total[first]))
    draw_curves(inset, x, means, integrals, unit, max(1, (x.size - first) // 14))
    top = 1.6 * total[first] / unit
    inset.set(yscale="log", xlim=(x[first], x[-1]), ylim=(min(0.4 * total[-1] / unit, top / 30.0), top))
    inset.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    inset.yaxis.set_minor_formatter(NullFormatter())
    inset.set_title(f"onset of contact ({sign}N)", fontsize=8, loc="right", pad=3)


def draw_pull_off(axes: Axes, run: Run) -> None:
    values = run["replicas/pull_off_force"]
    if not values.max() > 0.0:
        empty(axes, "(d) Pull-off force of single replicas", "no replica pulls: $F$ > 0 throughout")
        return
    n, mean, (unit, sign) = values.size, float(values.mean()), si(float(np.abs(values).max()))
    error = float(values.std(ddof=1)) / math.sqrt(n) if n > 1 else math.nan
    # What varies by rounding only has one bin.
    if np.ptp(values) > 1e-9 * np.abs(values).max():
        count = min(max(round(2.0 * n ** (1 / 3)), 8), 40)
    else:
        count, values = 1, np.full(n, mean)
    counts, _, bars = axes.hist(values / unit, count, color="0.86", edgecolor="0.5", linewidth=0.6)
    bars[0].set_label(f"{n} replica{'s' if n > 1 else ''}")
    handles = [bars[0]]
    of_mean, of_integral = (run.attribute(of, "pull_off_force") for of in ("ensemble", "integral"))
    lines = [(mean, f"their mean: {newton(mean, error)}", "black", "-"),
             (of_mean, f"of the mean curve: {newton(of_mean)}", BLUE, DASHED),
             (of_integral, f"of the integral: {newton(of_integral)}", VERMILION, DASH_DOT)]
    for value, label, color, line in lines:
        handles += [axes.axvline(value / unit, color=color, linestyle=line, linewidth=1.6, label=label)]
    axes.set(xlabel=f"pull-off force, minus the smallest $F$ ({sign}N)", ylabel="replicas", xmargin=0.04)
    axes.set_ylim(0.0, 1.1 * counts.max())
    axes.yaxis.set_major_locator(MaxNLocator(nbins=6, integer=True, steps=[1, 2, 5, 10]))
    head(axes, "(d) Pull-off force of single replicas", handles, 2, 2)


def draw_texts(figure: Figure, run: Run) -> None:
    """Title and numbers of the scene above, what the model leaves out beneath."""
    title = run.attribute("/", "title").strip() or Path(run.file.filename).name
    title = textwrap.wrap(title, 80 if len(title) <= 80 else min(len(title) // 2 + 12, 90), max_lines=2)
    figure.text(0.5, 0.985, "\n".join(title), ha="center", va="top", size=12, weight="bold", parse_math=False)
    replicas, count = run.attribute("/", "replicas"), round(float(run["replicas/asperity_count"].mean()))
    numbers = (f"law {run.attribute('/', 'law')}, history {run.attribute('/', 'history')}, "
               f"λ = {run.attribute('/', 'adhesion_parameter'):.4g}, "
               f"ψ = {run.attribute('/', 'plasticity_index'):.4g}, N = {count} asperities, "
               f"{replicas} replica{'s' if replicas > 1 else ''}, seed {run.attribute('/', 'seed')}")
    figure.text(0.5, 0.981 - 0.027 * len(title), numbers, ha="center", va="top", fontsize=9.5)
    share = 100.0 * float(run["integral/pull_off_contact_area"]) / run.attribute("/", "nominal_area")
    place = "pull-off" if run.attribute("integral", "pull_off_force") > 0.0 else "the smallest separation"
    figure.text(0.5, 0.015, "independent asperities: no coupling through the substrate, no coalescence; "
                f"contact area at {place} {share:.2g} % of the nominal area", ha="center", fontsize=8.5)


def draw(run: Run) -> Figure:
    if run.attribute("/", "history") == "loop":
        raise FileError("a loop: scripts/plot_loop.py draws it")
    figure = Figure(figsize=PAGE)

    forces = panel(figure, 0.85, 3.15, 4.5, 3.3)
    draw_forces(forces, run)
    draw_z(panel(figure, 0.85, 1.2, 4.5, 1.55, sharex=forces), run)
    draw_regimes(panel(figure, 6.3, 4.0, 4.45, 2.62), run)
    draw_pull_off(panel(figure, 6.3, 1.2, 4.45, 1.65), run)
    draw_texts(figure, run)
    return figure


if __name__ == "__main__":
    sys.exit(main("Pictures of a result of `stiction run`, on one page.", Run, draw))
