"""What the words of the pages mean, in a picture: summits, separations and interference; approach and unloading
of a finite patch; the pull-off of many patches.

Usage: python scripts/plot_concepts.py [-o OUT.svg]      runs the pad of the README, some seconds

(a) a section through two surfaces, drawn freely;
(b) force over the separation of one patch of the pad, which turns at a preload, and where it jumps off;
(c) pull-offs of 200 patches with their mean, its standard error and their standard deviation.
"""

import re
import tempfile
from pathlib import Path

import h5py
import numpy as np
from drawing import BLUE, DASHED, DOCS, ROOT, VERMILION, column, context, legend, options, run, save

# Places, heights and radii of the summits of the section; the flat surface.
SUMMITS = [(0.3, 0.5, 0.6), (1.45, 1.15, 0.55), (2.6, 0.6, 0.7), (3.7, 2.0, 0.5), (4.85, 0.75, 0.6)]
MEAN_OF_SUMMITS, FLAT = sum(height for _, height, _ in SUMMITS) / len(SUMMITS), 1.6


def arrow(axes, place, ends, name, side = 0.08):
    """A double arrow with a name next to its middle."""
    style = {"arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0, "linewidth": 0.8}
    axes.annotate("", (place, ends[1]), (place, ends[0]), arrowprops=style)
    axes.text(place + side, sum(ends) / 2, name, va="center", ha="left" if side > 0 else "right")


def section(axes):
    """Draws panel (a)."""
    x = np.linspace(-0.2, 5.4, 1200)
    profile = np.max([height - (x - at) ** 2 / (2 * radius) for at, height, radius in SUMMITS], axis=0)
    axes.fill_between(x, -0.7, profile, color="0.85", linewidth=0)
    axes.plot(x, profile, color="0.3", linewidth=0.9)
    axes.fill_between(x, FLAT, 2.3, color=BLUE, alpha=0.15, linewidth=0)
    axes.plot(x[[0, -1]], [FLAT, FLAT], color=BLUE, linewidth=0.9)
    names = ((0.0, "solid", "mean plane"), (MEAN_OF_SUMMITS, DASHED, "mean plane\nof summits"))
    for height, style, name in names:
        axes.plot(x[[0, -1]], [height, height], color=VERMILION, linestyle=style, linewidth=0.8)
        axes.text(5.5, height, name, va="center", color=VERMILION)
    axes.text(5.5, 1.95, "other surface", va="center", color=BLUE)
    highest, height = SUMMITS[3][:2]
    arrow(axes, 0.3, (0.0, FLAT), "$h$")
    arrow(axes, 2.6, (MEAN_OF_SUMMITS, FLAT), "$d$")
    arrow(axes, 5.2, (0.0, MEAN_OF_SUMMITS), "$y_s$", side=-0.08)
    arrow(axes, highest, (MEAN_OF_SUMMITS, height), "$z$")
    arrow(axes, highest + 0.55, (FLAT, height), "$\\delta$")
    axes.plot([highest, highest + 0.65], [height, height], color="0.3", linewidth=0.5)
    at, height, radius = SUMMITS[1]
    angle = np.linspace(0, 2 * np.pi, 200)
    circle = at + radius * np.cos(angle), height - radius + radius * np.sin(angle)
    axes.plot(*circle, color="0.3", linewidth=0.7, linestyle="dotted")
    away = {"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0, "linewidth": 0.8}
    axes.annotate("", (at + 0.7 * radius, height - 1.7 * radius), (at, height - radius), arrowprops=away)
    axes.text(at - 0.05, height - radius - 0.05, "$R$", ha="right", va="center")
    axes.set(xlim=(-0.2, 7.3), ylim=(-0.7, 2.35), aspect="equal")
    axes.axis("off")


def patch(axes, file):
    """Draws panel (b) from a result."""
    replicas = file["replicas"]
    h, back = replicas["separation"][:] * 1e9, replicas["external_force_after_preload"][0, 0] * 1e6
    forth, kept = replicas["external_force"][0] * 1e6, np.isfinite(back)
    turn = replicas["preload_separation"][0, 0] * 1e9
    shown = h >= turn
    axes.axhline(0.0, color="0.6", linewidth=0.7)
    axes.plot(h[shown], forth[shown], color=BLUE, label="approach")
    axes.plot(h[kept], back[kept], color=VERMILION, linestyle=DASHED, label="unloading after 100 µN")
    force = replicas["pull_off_after_preload"][0, 0] * 1e6
    place = replicas["pull_off_after_preload_separation"][0, 0] * 1e9
    axes.plot(place, -force, "o", color=VERMILION, markerfacecolor="white", label="pull-off")
    axes.set(xlim=(place - 2.5, place + 7), ylim=(-1.8 * force, 2.2 * force))
    axes.set(xlabel="separation $h$ (nm)", ylabel="force $F$ (µN)")
    legend(axes)


def patches(axes, file):
    """Draws panel (c) from a result."""
    forces = file["replicas/pull_off_after_preload"][:, 0] * 1e9
    mean, std = forces.mean(), forces.std(ddof=1)
    error = std / np.sqrt(forces.size)
    axes.hist(forces, bins=24, color=BLUE, alpha=0.6, label=f"{forces.size} patches")
    axes.axvspan(mean - std, mean + std, color="0.9", zorder=0, label=f"standard deviation, {std:.0f} nN")
    name = f"mean ± its standard error, {mean:.1f} ± {error:.1f} nN"
    axes.axvspan(mean - error, mean + error, color=VERMILION, zorder=2, label=name)
    axes.set(xlabel="pull-off force (nN)", ylabel="patches")
    legend(axes)


if __name__ == "__main__":
    arguments = options(__doc__, DOCS / "concepts.svg").parse_args()
    scene = re.search(r"```toml\n(.*?)```", (ROOT / "README.md").read_text(), re.S)[1]
    with tempfile.TemporaryDirectory() as folder:
        source, output = Path(folder, "pad.toml"), Path(folder, "pad.h5")
        source.write_text(scene, encoding="utf-8")
        run("run", source, "--set", "output.curves=true", "--no-model-range", "--quiet", "-o", output)
        with context(), h5py.File(output) as file:
            figure, (first, second, third) = column(1.7, 1.9, 1.7)
            section(first)
            patch(second, file)
            patches(third, file)
            save(figure, arguments.output, arguments.dpi)
