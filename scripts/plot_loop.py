"""One page of pictures of a loop: a result of `stiction run` of a scene with history = "loop".

(a) external force F over the separation h*, on approach and on retraction: mean over replicas, standard
    deviation of one replica, statistical integral;
(b) asperities that come into contact and lose it, per step of the separations, with the integral;
(c) energy that a cycle of a replica dissipates;
(d) of a scene with [instability], the probability to snap in and off over the stiffness of what holds the surfaces,
    or, for three preloads and more, the pull-off force over the preload; else pull-off forces of single replicas.

Usage:
    python scripts/plot_loop.py FILE.h5 [-o OUT.png] [--dpi N]

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

from plot_page import BLUE, DASHED, DASH_DOT, PAGE, VERMILION, FileError, main, panel, si
from plot_run import BAND, SEPARATION, Run, head, newton

INTEGRAL = (0, (4, 2))
PINK = "#F6D5C3"
# Way, what its datasets begin with, colour, band and line.
WAYS = [("approach", "", BLUE, BAND, "-"), ("retraction", "retraction_", VERMILION, PINK, DASH_DOT)]
GREENS = ["#009E73", "#CC79A7", "#E69F00", "#56B4E9"]
# Beyond the deepest force, as shares of it.
MARGIN = (0.12, 0.55)


def draw_forces(axes: Axes, run: Run) -> None:
    x, lowest, handles, curves = run["ensemble/h_star"], 0.0, [], []
    for way, prefix, color, band, line in WAYS:
        mean, std = run[f"ensemble/{prefix}external_force_mean"], run[f"ensemble/{prefix}external_force_std"]
        integral = run[f"integral/{prefix}external_force"]
        curves.append((way, color, band, line, mean, np.nan_to_num(std), integral))
        lowest = min(lowest, float((mean - np.nan_to_num(std)).min()))
    depth = -lowest if lowest < 0.0 else float(curves[0][4].max())
    unit, sign = si(depth)
    for way, color, band, line, mean, std, integral in curves:
        handles += axes.plot(x, mean / unit, color=color, linestyle=line, linewidth=1.8, label=f"{way}, mean")
        handles.append(axes.fill_between(x, (mean - std) / unit, (mean + std) / unit, facecolor=band, alpha=0.6,
                                         linewidth=0.0, zorder=1, label="± one replica"))
        dots = axes.plot(x, integral / unit, color="black", linestyle=INTEGRAL, linewidth=0.8, label="integral")
    handles += dots
    axes.axhline(0.0, color="0.5", linewidth=0.6, zorder=0.5)
    if lowest < 0.0:
        axes.set_ylim(-(1.0 + MARGIN[0]) * depth / unit, MARGIN[1] * depth / unit)
    axes.set(ylabel=f"external force, compressive positive ({sign}N)")
    axes.tick_params(labelbottom=False)
    head(axes, "(a) External force $F$", handles, 3, 2)


def draw_jumps(axes: Axes, run: Run) -> None:
    x = run["ensemble/step"] / run.attribute("/", "surface_height_std")
    handles, top = [], 0.0
    for (_, _, color, _, line), name, label in zip(WAYS, ["jump_in", "jump_off"], ["come into contact", "lose contact"]):
        mean, integral = run[f"ensemble/{name}_count_mean"], run[f"integral/{name}_count"]
        handles += axes.plot(x, mean, color=color, linestyle=line, linewidth=1.6, label=label)
        dots = axes.plot(x, integral, color="black", linestyle=INTEGRAL, linewidth=0.8, label="integral")
        top = max(top, float(mean.max()))
    axes.set(xlabel=SEPARATION, ylabel="asperities per step", ylim=(0.0, 1.1 * top if top > 0.0 else 1.0))
    head(axes, "(b) Contacts made and lost", handles + dots, 3, 1)


def histogram(axes: Axes, values: np.ndarray, unit: float, color: str, label: str) -> object:
    spread = np.ptp(values) > 1e-9 * np.abs(values).max(initial=0.0)
    count = min(max(round(2.0 * values.size ** (1 / 3)), 8), 40) if spread else 1
    _, _, bars = axes.hist(values / unit, count, color=color, edgecolor="0.5", linewidth=0.5, alpha=0.75, label=label)
    return bars[0]


def draw_energy(axes: Axes, run: Run) -> None:
    energy = run["replicas/dissipated_energy"]
    unit, sign = si(float(np.abs(energy).max()))
    if unit < 1e-12 and np.abs(energy).max() >= 1e-15:
        unit, sign = 1e-15, "f"
    n, mean = energy.size, float(energy.mean())
    handles = [histogram(axes, energy, unit, "0.86", f"{n} replica{'s' if n > 1 else ''}")]
    difference = run["integral/external_force"] - run["integral/retraction_external_force"]
    area = float(np.sum(0.5 * (difference[1:] + difference[:-1]) * np.diff(run["ensemble/separation"])))
    error = f" ± {energy.std(ddof=1) / math.sqrt(n) / unit:.2g}" if n > 1 else ""
    for value, label, color, line in [(mean, f"their mean: {mean / unit:.4g}{error} {sign}J", "black", "-"),
                                      (area, f"of the integral: {area / unit:.4g} {sign}J", VERMILION, DASHED)]:
        handles.append(axes.axvline(value / unit, color=color, linestyle=line, linewidth=1.6, label=label))
    axes.set(xlabel=f"energy dissipated per cycle ({sign}J)", ylabel="replicas", xmargin=0.04)
    head(axes, "(c) Energy of a cycle", handles, 2, 2)


def draw_probability(axes: Axes, run: Run) -> None:
    """Probabilities over the stiffness; a constant load, of stiffness 0, at the left edge."""
    stiffness, handles = run["replicas/stiffness"], []
    unit, sign = si(float(stiffness.max()))
    order = np.argsort(stiffness)

    def curve(name: str, row: tuple, label: str, color: str, line: object) -> None:
        value, low, high = (run[f"instability/{name}_probability{end}"][row][order] for end in ("", "_low", "_high"))
        if not np.isfinite(value).any():
            return
        x = stiffness[order] / unit
        axes.fill_between(x, low, high, color=color, alpha=0.2, linewidth=0.0)
        handles.extend(axes.plot(x, value, color=color, linestyle=line, marker="o", markersize=3, linewidth=1.4,
                                 label=label))

    curve("snap_in", (slice(None),), "snap-in", BLUE, "-")
    for i, preload in enumerate(run["replicas/preload"]):
        after = "the closest separation" if math.isnan(preload) else newton(preload)
        curve("snap_off", (i,), f"snap-off after {after}", [VERMILION, *GREENS][i % 5], DASH_DOT)
    axes.axvline(run.attribute("integral", "peak_stiffness") / unit, color="black", linestyle=INTEGRAL, linewidth=0.9)
    axes.set(xlabel=f"stiffness of what holds the surface ({sign}N/m)", ylabel="probability", ylim=(-0.04, 1.08))
    axes.annotate("stiffest point\nof the integral", (run.attribute("integral", "peak_stiffness") / unit, 0.35),
                  xytext=(-6, 0), textcoords="offset points", ha="right", va="center", fontsize=8)
    head(axes, "(d) Probability to snap, with 95 % intervals", handles, 2, 1 + len(handles) // 3)


def draw_preloads(axes: Axes, run: Run) -> None:
    preload, reached = run["replicas/preload"], run["instability/preload_reached_count"] > 0
    mean, std = (run[f"instability/pull_off_after_preload_{of}"][reached] for of in ("mean", "std"))
    unit, sign = si(float(mean.max()))
    load, load_sign = si(float(preload[reached].max()))
    handles = [axes.errorbar(preload[reached] / load, mean / unit, np.nan_to_num(std) / unit, color=VERMILION, fmt="o-",
                             markersize=4, linewidth=1.4, capsize=2.5, label="mean over replicas ± one replica")]
    there = float(run["replicas/approach_pull_off_force"].mean())
    handles.append(axes.axhline(there / unit, color=BLUE, linestyle=DASHED, linewidth=1.4,
                                label=f"on approach: {newton(there)}"))
    axes.set(xscale="log", xlabel=f"preload ({load_sign}N)", ylabel=f"pull-off force ({sign}N)")
    axes.set_ylim(0.0, 1.1 * float((mean + np.nan_to_num(std)).max()) / unit)
    head(axes, "(d) Pull-off after a preload", handles, 2, 1)


def draw_pull_off(axes: Axes, run: Run) -> None:
    there, back = run["replicas/approach_pull_off_force"], run["replicas/pull_off_force"]
    unit, sign = si(float(max(np.abs(there).max(), np.abs(back).max())))
    handles = [histogram(axes, there, unit, BAND, f"approach: {newton(float(there.mean()))}"),
               histogram(axes, back, unit, PINK, f"retraction: {newton(float(back.mean()))}")]
    for radius, line in (("kept", DASHED), ("elastic", DASH_DOT)):
        name = f"pull_off_force_{radius}_radius"
        if name in run.file["integral"].attrs:
            force = float(run.attribute("integral", name))
            handles.append(axes.axvline(force / unit, color="black", linestyle=line, linewidth=1.1,
                                        label=f"integral, {radius} radius: {newton(force)}"))
    axes.set(xlabel=f"pull-off force, minus the smallest $F$ ({sign}N)", ylabel="replicas", xmargin=0.04)
    head(axes, "(d) Pull-off force of single replicas, with means", handles, 2, len(handles) // 2)


def draw_last(axes: Axes, run: Run) -> None:
    if "instability" not in run.file:
        draw_pull_off(axes, run)
    elif run["replicas/preload"].size >= 3:
        draw_preloads(axes, run)
    else:
        draw_probability(axes, run)


def draw_texts(figure: Figure, run: Run) -> None:
    """Title and numbers of the scene above, what the model leaves out beneath."""
    title = run.attribute("/", "title").strip() or Path(run.file.filename).name
    title = textwrap.wrap(title, 84 if len(title) <= 84 else min(len(title) // 2 + 12, 90), max_lines=2)
    figure.text(0.5, 0.985, "\n".join(title), ha="center", va="top", size=12, weight="bold", parse_math=False)
    replicas, count = run.attribute("/", "replicas"), round(float(run["replicas/asperity_count"].mean()))
    verdict, p_value = run.attribute("validation", "verdict"), float(run.attribute("validation", "p_value"))
    level = 100.0 * float(run.attribute("validation", "significance"))
    verdict += f" at the {level:g} % level (p = {p_value:#.2g})" if math.isfinite(p_value) else ""
    numbers = (f"law {run.attribute('/', 'law')}, λ = {run.attribute('/', 'adhesion_parameter'):.4g}, "
               f"ψ = {run.attribute('/', 'plasticity_index'):.4g}, N = {count} asperities, "
               f"{replicas} replica{'s' if replicas > 1 else ''}, approach, retraction and their integral: {verdict}")
    figure.text(0.5, 0.981 - 0.027 * len(title), numbers, ha="center", va="top", fontsize=9.5)
    std = run.attribute("/", "surface_height_std")
    touch, off = (float(run[f"replicas/{name}_separation"].mean()) / std for name in ("touchdown", "detachment"))
    places = f"first contact at $h$* = {touch:.2f} on average, last at {off:.2f}; " if math.isfinite(off) else ""
    figure.text(0.5, 0.015, places + "independent asperities: no coupling through the substrate, no coalescence",
                ha="center", fontsize=8.5)


def draw(run: Run) -> Figure:
    if run.attribute("/", "history") != "loop":
        raise FileError('not a loop: its scene has no history = "loop"; scripts/plot_run.py draws it')
    figure = Figure(figsize=PAGE)

    forces = panel(figure, 0.85, 3.35, 4.5, 3.2)
    draw_forces(forces, run)
    draw_jumps(panel(figure, 0.85, 0.95, 4.5, 1.65, sharex=forces), run)
    draw_energy(panel(figure, 6.3, 4.45, 4.45, 2.1), run)
    draw_last(panel(figure, 6.3, 0.95, 4.45, 2.2), run)
    draw_texts(figure, run)
    return figure


if __name__ == "__main__":
    sys.exit(main("Pictures of a loop, on one page.", Run, draw))
