"""When asperities may be taken as independent: the verdict over roughness and surface energy, and over the size of a patch.

Runs `stiction compare --laws hybrid`, which computes the integral alone, for a grid of surfaces, and for the three cases
(configs/case_i.toml and so on), and reads /independence of each file. The surfaces of the grid are those of the publication: at
the roughness of one of its cases they have that case's radius and density of asperities, between and beyond them these follow
straight lines in the logarithms. Everything else is as in the cases.

(a) verdict over roughness and surface energy, with lines where each figure is at its limit, and the three cases;
(b) attraction over the stiffness of the half-space against the side of the patch, to which it is proportional, for the three cases.

Usage:
    python scripts/plot_independence.py [--stiction PROGRAM] [-o OUT.png] [--steps N] [--dpi N]

The program is target/release/stiction unless --stiction names another; the picture goes to docs/independence.png unless -o says
otherwise. The figures of the three cases are printed. A minute on two cores.
Exit codes: 0 done; 1 the program failed; 2 there is no such program, or the picture cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "h5netcdf>=1.3", "matplotlib>=3.8", "pandas>=2.1", "xarray>=2024.10"]
# ///

import argparse
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import StrMethodFormatter

from drawing import BLUE, DASHED, DASH_DOT, GREEN, VERMILION, context, panel

ROOT = Path(__file__).resolve().parents[1]
VERDICTS = ("good", "a shift", "invalid")
SHADES = ("#D5EBE2", "#FCEBC8", "#F3D3C4")
# Roughness, nm, radius, um, and density, 1/um^2, of the cases, and where their names stand beside their places.
CASES = {"I": (3.40, 1.66, 8.51, 0.01), "II": (1.619, 3.33, 7.39, 0.09), "III": (0.6541, 6.38, 9.87, 0.30)}
ROUGHNESS = (0.5, 5.0)  # nm
ENERGY = (0.003, 0.6)  # J/m^2
# Figures whose limits are drawn: colour, dashes, what they are.
FIGURES = {"relative_attractive_stiffness": (VERMILION, "solid", "attraction over $k_s$"),
           "relative_shift": (BLUE, DASHED, "shift over $\\sigma$"),
           "relative_fluctuation": (GREEN, DASH_DOT, "fluctuation over $\\sigma$"),
           "contact_share": ("0.35", "dotted", "share in contact")}
SIDES = (1.0, 1e5)  # um


class ProgramError(Exception):
    """The program failed."""


def judged(program: Path, folder: Path, name: str, scene: str) -> dict[str, object]:
    """The figures of a scene, its verdict and the limits, by the integral."""
    source, output = folder / f"{name}.toml", folder / f"{name}.h5"
    source.write_text(scene)
    done = subprocess.run([program, "compare", source, "--laws", "hybrid", "-o", output, "--threads", "1", "--quiet"],
                          capture_output=True, text=True)
    if done.returncode != 0:
        raise ProgramError(done.stderr.strip())
    with h5py.File(output) as file:
        group = file["independence"]
        figures = {name: float(group[name][0]) for name in group if name not in ("law", "verdict")}
        return {**figures, **group.attrs, "verdict": group["verdict"].asstr()[0]}


def along(sigma: float) -> tuple[float, float]:
    """Radius, um, and density of asperities, 1/um^2, of a surface of a roughness, nm."""
    known = np.log(sorted((sigma, radius, density) for sigma, radius, density, _ in CASES.values()))
    x = np.log(sigma)
    part = 0 if x < known[1, 0] else 1
    low, high = known[part], known[part + 1]
    share = (x - low[0]) / (high[0] - low[0])
    radius, density = np.exp(low[1:] + share * (high[1:] - low[1:]))
    return float(radius), float(density)


def scene(base: str, sigma: float, energy: float) -> str:
    """The scene of a case with another roughness, nm, and surface energy, J/m^2, over separations that hold its pull-off."""
    radius, density = along(sigma)
    values = {"work_of_adhesion": f'"{energy!r} J/m^2"', "surface_height_std": f'"{sigma!r} nm"', "asperity_radius": f'"{radius!r} um"',
              "asperity_density": f'"{density!r} /um^2"', "h_star": "{ from = -3.0, to = 10.0, count = 131 }"}
    for key, value in values.items():
        base, count = re.subn(rf"^{key} = .*$", lambda _: f"{key} = {value}", base, flags=re.MULTILINE)
        if count != 1:
            raise ProgramError(f"the scene has {key} {count} times")
    return base


def over_grid(program: Path, folder: Path, sigmas: np.ndarray, energies: np.ndarray) -> np.ndarray:
    """The figures at each energy and roughness."""
    base = (ROOT / "configs" / "case_ii.toml").read_text()
    places = [(i, j) for i in range(len(energies)) for j in range(len(sigmas))]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        made = [pool.submit(judged, program, folder, f"{i}_{j}", scene(base, float(sigmas[j]), float(energies[i]))) for i, j in places]
        found = np.array([one.result() for one in made], dtype=object)
    return found.reshape(len(energies), len(sigmas))


def draw_map(axes: Axes, sigmas: np.ndarray, energies: np.ndarray, grid: np.ndarray, cases: dict[str, dict]) -> None:
    words = np.vectorize(lambda one: VERDICTS.index(one["verdict"]))(grid)
    axes.pcolormesh(sigmas, energies, words, cmap=ListedColormap(SHADES), vmin=-0.5, vmax=2.5, shading="nearest", rasterized=True)
    for name, (colour, dashes, label) in FIGURES.items():
        values = np.vectorize(lambda one: np.log(max(abs(one[name]), 1e-30)))(grid)
        limits = grid[0, 0]
        told = f"{label}: {limits[f'good_{name}']:g}"
        levels = [limits[f"good_{name}"]]
        if f"invalid_{name}" in limits:
            levels.append(limits[f"invalid_{name}"])
            told += f" and {levels[1]:g}"
        lines = axes.contour(sigmas, energies, values, levels=np.log(levels), colors=colour, linewidths=[0.9, 1.7][:len(levels)])
        lines.set_linestyle(dashes)
        axes.plot([], [], color=colour, linestyle=dashes, label=told)
    for name, (sigma, _, _, energy) in CASES.items():
        axes.plot(sigma, energy, "o", color="black", markersize=5)
        axes.annotate(f"case {name}", (sigma, energy), xytext=(6, 5), textcoords="offset points", fontweight="bold", fontsize=8.5)
    for word, place in zip(VERDICTS, [(4.3, 0.0045), (2.33, 0.34), (0.56, 0.42)]):
        axes.text(*place, word, fontsize=13, color="0.25", ha="left" if word == "invalid" else "center", style="italic")
    axes.set(xscale="log", yscale="log", xlim=ROUGHNESS, ylim=ENERGY, xlabel="roughness $\\sigma$, nm", ylabel="work of adhesion, J/m$^2$")
    axes.set_xticks([0.5, 1, 2, 3, 5])
    axes.set_xticks([], minor=True)
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set_title("(a) Independence of asperities, surfaces of the publication, 1000 µm$^2$")
    axes.legend(loc="lower left", title="limits of good (thin) and invalid (thick)", title_fontsize=8, frameon=True, framealpha=0.85, edgecolor="none")


def draw_sizes(axes: Axes, cases: dict[str, dict]) -> None:
    sides = np.array(SIDES)
    any_case = cases["II"]
    good, invalid = (any_case[f"{word}_relative_attractive_stiffness"] for word in ("good", "invalid"))
    low, high = 1e-6, 1e5
    for (bottom, top), shade in zip([(low, good), (good, invalid), (invalid, high)], SHADES):
        axes.axhspan(bottom, top, color=shade, linewidth=0)
    for (name, case), colour in zip(cases.items(), (GREEN, BLUE, VERMILION)):
        side = 1e6 * case["patch_side"]
        ratio = case["relative_attractive_stiffness"]
        axes.plot(sides, ratio * sides / side, color=colour, linewidth=1.3, label=f"case {name}, $\\Lambda_c$ = {length(case)}")
        axes.plot(side, ratio, "o", color="black", markersize=5)
    axes.set(xscale="log", yscale="log", xlim=SIDES, ylim=(low, high), xlabel="side of the patch, µm",
             ylabel="largest attractive stiffness over $k_s$")
    axes.set_title("(b) The larger a patch, the softer it stands")
    axes.legend(loc="upper left", frameon=True, framealpha=0.85, edgecolor="none")


def length(case: dict) -> str:
    metres = case["longest_stable_wavelength"]
    factor, unit = next((factor, unit) for factor, unit in [(1.0, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")] if metres * factor >= 1.0)
    return f"{metres * factor:.3g} {unit}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stiction", type=Path, default=ROOT / "target" / "release" / "stiction", metavar="PROGRAM")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs" / "independence.png", metavar="OUT.png")
    parser.add_argument("--steps", type=int, default=41, metavar="N", help="surfaces along each axis, default 41")
    parser.add_argument("--dpi", type=int, default=200, metavar="N", help="dots per inch, default 200")
    arguments = parser.parse_args()
    if not arguments.stiction.is_file():
        print(f"plot_independence: {arguments.stiction}: no such program", file=sys.stderr)
        return 2
    try:
        with tempfile.TemporaryDirectory() as temporary, context():
            folder = Path(temporary)
            cases = {name: judged(arguments.stiction, folder, name, (ROOT / "configs" / f"case_{name.lower()}.toml").read_text())
                     for name in CASES}
            sigmas, energies = np.geomspace(*ROUGHNESS, arguments.steps), np.geomspace(*ENERGY, arguments.steps)
            grid = over_grid(arguments.stiction, folder, sigmas, energies)
            figure = Figure(figsize=(11.0, 4.9))
            draw_map(panel(figure, 0.65, 0.6, 5.4, 3.9), sigmas, energies, grid, cases)
            draw_sizes(panel(figure, 6.95, 0.6, 3.8, 3.9), cases)
            figure.savefig(arguments.output, dpi=arguments.dpi)
    except ProgramError as error:
        print("plot_independence:", *str(error).split(), file=sys.stderr)
        return 1
    except OSError as error:
        print(f"plot_independence: {error}", file=sys.stderr)
        return 2
    for name, case in cases.items():
        print(f"case {name}: {case['verdict']}; shift {1e9 * case['shift']:.2e} nm = {case['relative_shift']:.2e} sigma, attraction "
              f"{case['relative_attractive_stiffness']:.2e} k_s, fluctuation {case['relative_fluctuation']:.2e} sigma, stable to {length(case)}, "
              f"{100 * case['contact_share']:.1e} % in contact")
    print(arguments.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
