"""Results of `stiction run` of several surfaces in one picture, over the nominal area.

Usage: python scripts/plot_surfaces.py FILE.h5... [-o OUT.svg]

(a) external force over the separation where the surfaces attract: mean over replicas, its standard error as
    a band, the integral as open circles;
(b) pull-off: mean with standard error, the middle 90 % of replicas, the integral. Surfaces are called by
    their files.
"""

from pathlib import Path

import numpy as np
from drawing import (
    COLORS, DOCS, H_STAR, column, digits, dressed, factor_and_unit, legend, open_run, options, save,
)

INTEGRAL = {"linestyle": "none", "marker": "o", "markerfacecolor": "white", "markersize": 3.5}


def surface(path):
    """The data shown of one result; forces in Pa."""
    with open_run(path) as run:
        area = float(run.attrs["nominal_area"])
        forces = {name: np.nan_to_num(run[dataset].values) / area for name, dataset in {
            "mean": "ensemble/external_force_mean", "error": "ensemble/external_force_standard_error",
            "integral": "integral/external_force",
            "pull_off": "replicas/pull_off_force"}.items()}  # fmt: skip
        named = {"name": Path(path).stem, "h_star": run["ensemble/h_star"].values, "area": area}
        own = {"integral": run.pull_off.of_integral, "mean": run.pull_off.mean_over_patches,
               "error": run.pull_off.standard_error}  # fmt: skip
        return named | forces | {f"{name}_pull_off": value / area for name, value in own.items()}


def draw_forces(axes, surfaces):
    deepest = max(-np.min(own["mean"]) for own in surfaces)
    unit, sign = factor_and_unit([deepest], "Pa")
    for i, own in enumerate(surfaces):
        x, color, step = own["h_star"], COLORS[i % len(COLORS)], max(len(own["h_star"]) // 12, 1)
        axes.plot(x, own["mean"] / unit, color=color, label=own["name"])
        low, high = ((own["mean"] + k * own["error"]) / unit for k in (-1.0, 1.0))
        axes.fill_between(x, low, high, color=color, alpha=0.25, linewidth=0.0)
        axes.plot(x[i % step :: step], own["integral"][i % step :: step] / unit, color=color, **INTEGRAL)
    axes.axhline(0.0, color="0.5", linewidth=0.6, zorder=0.5)
    axes.set(xlabel=H_STAR, ylabel=f"external force over area ({sign})")
    axes.set(ylim=(-1.15 * deepest / unit, 0.35 * deepest / unit))


def draw_pull_off(axes, surfaces):
    unit, sign = factor_and_unit([max(np.quantile(own["pull_off"], 0.95) for own in surfaces)], "Pa")
    for i, own in enumerate(surfaces):
        color, pull_off = COLORS[i % len(COLORS)], own["pull_off"] / unit
        axes.plot(np.quantile(pull_off, [0.05, 0.95]), [-i, -i], color=color, linewidth=5.0, alpha=0.3)
        error = np.nan_to_num(own["error_pull_off"]) / unit
        axes.errorbar(own["mean_pull_off"] / unit, -i, xerr=error, fmt="o", color=color)
        axes.plot(own["integral_pull_off"] / unit, -i, color=color, **INTEGRAL)
    axes.set_yticks(-np.arange(len(surfaces)), [own["name"] for own in surfaces])
    axes.set(xlabel=f"pull-off force over area ({sign})")


@dressed
def draw(surfaces):
    figure, (forces, pull_off) = column(2.8, 2.2)
    draw_forces(forces, surfaces)
    legend(forces, columns=3)
    draw_pull_off(pull_off, surfaces)
    return figure


def numbers(surfaces):
    """By name: mean pull-off of 100 um^2 and of a patch, uN, its standard deviation, %, its excess over the
    integral's, %, and the integral's, MPa."""
    kept = {}
    for own in surfaces:
        mean, deviation = own["mean_pull_off"], own["pull_off"].std(ddof=1)
        kept[own["name"]] = [digits(1e-4 * mean, 2)]
        kept[f"{own['name']} patch"] = [digits(1e6 * own["area"] * mean, 2)]
        kept[f"{own['name']} excess"] = [digits(100.0 * (mean / own["integral_pull_off"] - 1.0), 2)]
        kept[f"{own['name']} deviation"] = [digits(100.0 * deviation / mean, 2)]
        kept[f"{own['name']} integral"] = [digits(1e-6 * own["integral_pull_off"], 2)]
    return kept


if __name__ == "__main__":
    parser = options(__doc__, DOCS / "surfaces.svg")
    parser.add_argument("files", nargs="+")
    arguments = parser.parse_args()
    surfaces = [surface(path) for path in arguments.files]
    save(draw(surfaces), arguments.output, arguments.dpi, numbers(surfaces))
