"""Limits within which asperities may be taken as independent: the verdict over roughness and surface energy,
and over the size of a patch.

Usage: python scripts/plot_independence.py [-o OUT.svg] [--steps N]      a minute on two cores; prints the
three cases

The integral alone, `stiction compare --laws hybrid`, of a grid of surfaces of the publication: at the
roughness of one of its cases they have that case's radius and density, between and beyond these follow
straight lines in the logarithms.
(a) verdict, with lines where each figure is at its limit; (b) attraction over the stiffness of the
    half-space, over the side.
"""

import concurrent.futures
import os
import re
import tempfile
from pathlib import Path

import h5py
import numpy as np
from drawing import (
    BLUE, CASE_COLORS, DASH_DOT, DASHED, DOCS, GREEN, ROOT, SHADES, VERDICTS, VERMILION, column, dressed,
    factor_and_unit, legend, options, run, save,
)
from matplotlib.colors import ListedColormap
from matplotlib.ticker import StrMethodFormatter

# Roughness, nm, radius, um, density, 1/um^2, and work of adhesion, J/m^2.
CASES = {"I": (3.40, 1.66, 8.51, 0.01), "II": (1.619, 3.33, 7.39, 0.09), "III": (0.6541, 6.38, 9.87, 0.30)}
ROUGHNESS, ENERGY, SIDES = (0.5, 5.0), (0.003, 0.6), np.array([1.0, 1e5])
RATIO = "relative_attractive_stiffness"
FIGURES = {RATIO: (VERMILION, "solid", "attraction over $k_s$"),
           "relative_shift": (BLUE, DASHED, "shift over $\\sigma$"),
           "relative_fluctuation": (GREEN, DASH_DOT, "fluctuation over $\\sigma$"),
           "contact_share": ("0.35", "dotted", "fraction in contact")}  # fmt: skip


def judged(scene):
    """The figures of a scene, its verdict and the limits, by the integral."""
    with tempfile.TemporaryDirectory() as folder:
        source, output = Path(folder) / "scene.toml", Path(folder) / "out.h5"
        source.write_text(scene)
        run("compare", source, "--laws", "hybrid", "-o", output, "--threads", "1", "--quiet")
        with h5py.File(output) as file:
            group = file["independence"]
            figures = {name: float(group[name][0]) for name in group if name not in ("model_law", "verdict")}
            return {**figures, **group.attrs, "verdict": group["verdict"].asstr()[0]}


def of_case(name):
    return (ROOT / "configs" / f"case_{name.lower()}.toml").read_text()


def scene(sigma, energy):
    """The scene of case II with another roughness, nm, and surface energy, J/m^2, over separations that hold
    its pull-off."""
    known = np.log(sorted(case[:3] for case in CASES.values()))
    low = 0 if np.log(sigma) < known[1, 0] else 1
    share = (np.log(sigma) - known[low, 0]) / (known[low + 1, 0] - known[low, 0])
    _, radius, density = np.exp(known[low] + share * (known[low + 1] - known[low])).tolist()
    values = {"work_of_adhesion": f'"{energy!r} J/m^2"', "surface_height_std": f'"{sigma!r} nm"',
              "asperity_radius": f'"{radius!r} um"', "asperity_density": f'"{density!r} /um^2"',
              "h_star": "{ from = -3.0, to = 10.0, count = 131 }"}  # fmt: skip
    text = of_case("II")
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
        assert count == 1, key
    return text


def draw_map(axes, sigmas, energies, grid):
    words = np.vectorize(lambda one: VERDICTS.index(one["verdict"]))(grid)
    axes.pcolormesh(sigmas, energies, words, cmap=ListedColormap(SHADES), vmin=-0.5, vmax=2.5,
                    shading="nearest", rasterized=True)
    for name, (color, dashes, label) in FIGURES.items():
        limits = [grid[0, 0][f"{word}_{name}"] for word in ("good", "invalid")
                  if f"{word}_{name}" in grid[0, 0]]
        values = np.vectorize(lambda one, name=name: np.log(max(abs(one[name]), 1e-30)))(grid)
        lines = axes.contour(sigmas, energies, values, levels=np.log(limits), colors=color,
                             linewidths=[0.9, 1.7][: len(limits)])
        lines.set_linestyle(dashes)
        axes.plot([], [], color=color, linestyle=dashes,
                  label=f"{label}: {' and '.join(f'{limit:g}' for limit in limits)}")
    for name, (sigma, _, _, energy) in CASES.items():
        axes.plot(sigma, energy, "o", color="black", markersize=5)
        axes.annotate(f"case {name}", (sigma, energy), xytext=(6, 5), textcoords="offset points",
                      fontweight="bold")
    for word, place in zip(VERDICTS, [(4.3, 0.0045), (2.33, 0.34), (0.56, 0.42)]):
        axes.text(*place, word, fontsize=11, color="0.25", ha="left" if word == "invalid" else "center",
                  style="italic")
    axes.set(xscale="log", yscale="log", xlim=ROUGHNESS, ylim=ENERGY)
    axes.set(xlabel="roughness $\\sigma$ (nm)", ylabel="work of adhesion (J/m$^2$)")
    axes.set_xticks([0.5, 1, 2, 3, 5])
    axes.set_xticks([], minor=True)
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    legend(axes, columns=1)


def draw_sizes(axes, cases):
    low, high = 1e-6, 1e5
    limits = [low, *(cases["II"][f"{word}_{RATIO}"] for word in ("good", "invalid")), high]
    for bottom, top, shade in zip(limits, limits[1:], SHADES):
        axes.axhspan(bottom, top, color=shade, linewidth=0)
    for name, case in cases.items():
        side, label = 1e6 * case["patch_side"], f"case {name}, $\\Lambda_c$ = {length(case)}"
        axes.plot(SIDES, case[RATIO] * SIDES / side, color=CASE_COLORS[name], label=label)
        axes.plot(side, case[RATIO], "o", color="black", markersize=5)
    axes.set(xscale="log", yscale="log", xlim=SIDES, ylim=(low, high))
    axes.set(xlabel="side of the patch (µm)", ylabel="largest attractive stiffness over $k_s$")
    legend(axes, columns=1)


@dressed
def draw(sigmas, energies, grid, cases):
    figure, (verdicts, sizes) = column(4.3, 3.2)
    draw_map(verdicts, sigmas, energies, grid)
    draw_sizes(sizes, cases)
    return figure


def length(case):
    factor, unit = factor_and_unit([case["longest_stable_wavelength"]], "m")
    return f"{case['longest_stable_wavelength'] / factor:.3g} {unit}"


def main():
    parser = options(__doc__, DOCS / "independence.svg")
    parser.add_argument("--steps", type=int, default=41, metavar="N",
                        help="surfaces along each axis, default 41")
    arguments = parser.parse_args()
    sigmas, energies = (np.geomspace(*ends, arguments.steps) for ends in (ROUGHNESS, ENERGY))
    cases = {name: judged(of_case(name)) for name in CASES}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        scenes = [scene(sigma, energy) for energy in energies.tolist() for sigma in sigmas.tolist()]
        grid = np.array(list(pool.map(judged, scenes)), dtype=object).reshape(arguments.steps, -1)
    save(draw(sigmas, energies, grid, cases), arguments.output, arguments.dpi)
    for name, case in cases.items():
        print(f"case {name}: {case['verdict']}; shift {1e9 * case['shift']:.2e} nm = "
              f"{case['relative_shift']:.2e} sigma, attraction {case[RATIO]:.2e} k_s, "
              f"fluctuation {case['relative_fluctuation']:.2e} sigma, stable to {length(case)}, "
              f"{100 * case['contact_share']:.1e} % in contact")  # fmt: skip
    print(arguments.output)


if __name__ == "__main__":
    main()
