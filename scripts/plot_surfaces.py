"""One page of pictures that compares results of `stiction run`, such as those of surfaces with other asperities.

(a) external force F over the separation h*, per area: mean over replicas, its standard error as a band, and the
    statistical integral;
(b) the same where it pulls;
(c) pull-off force of a replica, per area: mean with standard error, the middle 90 % of replicas, and the pull-off of
    the integral.

Usage:
    python scripts/plot_surfaces.py FILE.h5 FILE.h5 ... [-o OUT.png] [--dpi N]

The picture goes beside the first file as surfaces.png, unless -o says otherwise. Forces are over the nominal area, so
that patches of different sizes can be compared.
Exit codes: 0 done; 2 a file cannot be read or is not such a result, or the picture cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "h5netcdf>=1.3", "matplotlib>=3.8", "pandas>=2.1", "xarray>=2024.10"]
# ///

import argparse
import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drawing import FileError, context, factor_and_unit, open_run

PAGE = (11.0, 7.0)  # inches
COLORS = ["black", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"]
LINES = ["-", (0, (5, 1.5)), (0, (5, 1.2, 1, 1.2)), (0, (1.2, 1.2))]
INTEGRAL = dict(linestyle="none", marker="x", markersize=6, markeredgewidth=1.1, zorder=5)


class Surface:
    """What is shown of one result; forces in Pa."""

    def __init__(self, path: Path) -> None:
        with open_run(path) as run:
            if run.kind != "run":
                raise FileError("not a result of `stiction run` of one scene")
            area = float(run.attrs["nominal_area"])
            self.name = run.title or path.stem
            self.h_star = run["ensemble/h_star"].values
            self.mean = run["ensemble/external_force_mean"].values / area
            self.error = np.nan_to_num(run["ensemble/external_force_standard_error"].values) / area
            self.integral = run["integral/external_force"].values / area
            self.pull_off = run["replicas/pull_off_force"].values / area
            self.integral_pull_off = run.pull_off.of_integral / area


def style(index: int) -> dict:
    return dict(color=COLORS[index % len(COLORS)], linestyle=LINES[index // len(COLORS) % len(LINES)])


def draw_forces(axes: Axes, surfaces: list[Surface], pulls: bool) -> None:
    deepest = max(-surface.mean.min() for surface in surfaces)
    unit, sign = factor_and_unit([deepest if pulls and deepest > 0.0 else max(np.abs(s.mean).max() for s in surfaces)], "Pa")
    for i, surface in enumerate(surfaces):
        x, look = surface.h_star, style(i)
        axes.plot(x, surface.mean / unit, linewidth=1.5, label=surface.name, **look)
        axes.fill_between(x, (surface.mean - surface.error) / unit, (surface.mean + surface.error) / unit,
                          facecolor=look["color"], alpha=0.25, linewidth=0.0)
        step = max(len(x) // 12, 1)
        axes.plot(x[i % step::step], surface.integral[i % step::step] / unit, color=look["color"],
                  **{**INTEGRAL, "markersize": 4})
    axes.axhline(0.0, color="0.5", linewidth=0.6, zorder=0.5)
    axes.set(xlabel="separation $h/\\sigma$", ylabel=f"external force over the nominal area ({sign})")
    if pulls:
        axes.set_title("(b) The same where it pulls")
        if deepest > 0.0:
            axes.set_ylim(-1.15 * deepest / unit, 0.35 * deepest / unit)
    else:
        axes.set_title("(a) External force: lines mean over replicas, crosses integral")
        axes.legend(loc="upper right")


def draw_pull_off(axes: Axes, surfaces: list[Surface]) -> None:
    largest = max(max(np.quantile(s.pull_off, 0.95), s.integral_pull_off) for s in surfaces)
    unit, sign = factor_and_unit([largest], "Pa")
    places = np.arange(len(surfaces))[::-1]
    for place, (i, surface) in zip(places, enumerate(surfaces)):
        color, pull_off = style(i)["color"], surface.pull_off / unit
        low, high = np.quantile(pull_off, [0.05, 0.95])
        axes.plot([low, high], [place, place], color=color, linewidth=5.0, alpha=0.3, solid_capstyle="butt")
        error = pull_off.std(ddof=1) / np.sqrt(pull_off.size) if pull_off.size > 1 else 0.0
        axes.errorbar(pull_off.mean(), place, xerr=error, fmt="o", color=color, markersize=4, capsize=2.5)
        axes.plot(surface.integral_pull_off / unit, place, color=color, **INTEGRAL)
    axes.axvline(0.0, color="0.5", linewidth=0.6, zorder=0.5)
    axes.set_yticks(places, [surface.name for surface in surfaces])
    axes.set(ylim=(-0.7, len(surfaces) - 0.3), xlabel=f"pull-off force over the nominal area ({sign})")
    axes.set_title("(c) Pull-off: mean, 90 % of replicas, × integral")


def draw(surfaces: list[Surface]) -> Figure:
    figure = Figure(figsize=PAGE, layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.15, 1.0))
    draw_forces(figure.add_subplot(grid[0, 0]), surfaces, pulls=False)
    draw_forces(figure.add_subplot(grid[1, 0]), surfaces, pulls=True)
    draw_pull_off(figure.add_subplot(grid[:, 1]), surfaces)
    return figure


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE.h5")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.png")
    parser.add_argument("--dpi", type=int, default=150)
    arguments = parser.parse_args()
    output = arguments.output or arguments.files[0].with_name("surfaces.png")
    surfaces = []
    for path in arguments.files:
        try:
            surfaces.append(Surface(path))
        except (OSError, FileError) as error:
            print(f"plot_surfaces: {path}: {error}", file=sys.stderr)
            return 2
    try:
        with context():
            draw(surfaces).savefig(output, dpi=arguments.dpi)
    except (OSError, ValueError) as error:
        print(f"plot_surfaces: {output}: {error}", file=sys.stderr)
        return 2
    print(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
