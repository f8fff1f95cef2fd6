"""How well the unknowns of the published simulations are determined by the numbers that they gave.

Shi and Polycarpou (J. Colloid Interface Sci. 290 (2005) 514) state neither the nominal area A_n, the lubricant thickness t and
Poisson's ratio, nor whether the spread and the mean plane of the asperities were converted from those of the surface (sigma_s, y_s), nor
how their critical approach delta_A follows. This script computes their pull-off forces and the places of largest stiffness with their
own curve fits (case III at other work of adhesion: the same forms refitted) for

* t from 0 to 1.5 nm,
* sigma_s and y_s converted, only one of them, or neither,
* delta_A as the approach at first touch, at the end of the stable contact branch, or, with the published fits, 0.30 nm or 0,
* Poisson's ratio by itself, which enters through the plasticity index,

and takes for each the nominal area that suits the forces best, to which they are proportional. It writes

    FOLDER/unknowns.csv     every combination: its area, its misfits, all forces and places
    FOLDER/unknowns.png     places and areas over t

and prints the best combinations and what Poisson's ratio the published plasticity indices ask for.

Usage:
    python scripts/scan_unknowns.py [-o FOLDER] [--step NM] [--program PATH]

It takes two minutes on two cores with the default step of 0.1 nm in t.

The program is $STICTION or target/release/stiction, built by `cargo build --release`.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "matplotlib>=3.7"]
# ///

import argparse
import csv
import itertools
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter, StrMethodFormatter

ROOT = Path(__file__).resolve().parents[1]
SCENES = ROOT / "configs" / "paper"
AREA = 1000.0  # um^2, of the scenes
LARGEST_THICKNESS = 1.5  # nm
CONVERSIONS = ["both", "spread only", "plane only", "neither"]
RULES = ["first touch", "end of contact", "0.30 nm", "0"]
INFERRED = (0.5, "both", "first touch")


class Published(NamedTuple):
    """A scene, the law that comes nearest to what was computed, the pull-off force (N) and the place of largest stiffness (h*)."""

    scene: str
    law: str
    force: float
    place: float


# Section 5, in the order of the text; forces have one to three digits, places three.
PUBLISHED = [
    Published("case_i", "fit:paper", 2.13e-6, 5.72),
    Published("case_ii", "fit:paper", 0.6e-3, 3.19),
    Published("case_iii", "fit:paper", 93.5e-3, 3.06),
    Published("case_iii_0.04", "fit:refit", 6.3e-3, 2.82),
    Published("case_iii_0.09", "fit:refit", 19.9e-3, 2.75),
    Published("case_iii_0.14", "fit:refit", 35.8e-3, 2.80),
]
FORCES = ["2.13 µN", "0.6 mN", "93.5 mN"]
NAMES = ["I", "II", "III", "III, 0.04", "III, 0.09", "III, 0.14"]
# Table 2: R (um), sigma (nm), eta (1/um^2), psi; E_r 85.29 GPa, H 2.5 GPa.
TABLE_2 = [(1.66, 3.40, 8.51, 1.76), (3.33, 1.619, 7.39, 0.84), (6.38, 0.6541, 9.87, 0.39)]

COLOURS = {"both": "#0072B2", "spread only": "#D55E00", "plane only": "#009E73", "neither": "black"}
LINES = {"first touch": "-", "end of contact": (0, (5, 1.5)), "0.30 nm": (0, (5, 1.2, 1, 1.2)), "0": (0, (1.2, 1.2))}
STYLE = {"font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "legend.frameon": False,
         "axes.spines.top": False, "axes.spines.right": False, "xtick.labelsize": 8, "ytick.labelsize": 8}


class ScanError(Exception):
    """Why nothing can be scanned."""


def with_key(text: str, section: str, key: str, value: str) -> str:
    """The scene with a key of a section set."""
    text = re.sub(rf"^{key} *=.*\n", "", text, flags=re.MULTILINE)
    return re.sub(rf"^(\[{section}\].*\n)", rf"\g<1>{key} = {value}\n", text, flags=re.MULTILINE)


def scene_text(published: Published, thickness: float, conversion: str, rule: str) -> str:
    """A scene for one combination."""
    text = (SCENES / f"{published.scene}.toml").read_text(encoding="utf-8")
    std = re.search(r'^surface_height_std *= *("[^"]*")', text, flags=re.MULTILINE)
    text = with_key(text, "surface", "lubricant_thickness", f'"{thickness:.6g} nm"')
    if conversion in ("plane only", "neither"):
        text = with_key(text, "surface", "asperity_height_std", std[1])
    if conversion in ("spread only", "neither"):
        text = with_key(text, "surface", "mean_plane_offset", "0")
    text = with_key(text, "model", "law", f'"{published.law}"')
    text = with_key(text, "model", "history", '"retraction"' if rule == "end of contact" else '"approach"')
    if rule in ("0.30 nm", "0") and published.law == "fit:paper":  # a refit ends where its direct law does
        text = with_key(text, "model", "critical_approach", f'"{rule.removesuffix(" nm")} nm"')
    return with_key(text, "separation", "h_star", "{ from = 0.0, to = 8.0, count = 65 }")


def solve(program: Path, folder: Path, published: Published, combination: tuple) -> tuple[float, float]:
    """Pull-off force (N) and place of largest stiffness (h*) by the integral."""
    name = "_".join([published.scene, *(re.sub(r"\W", "", str(part)) for part in combination)])
    scene, result = folder / f"{name}.toml", folder / f"{name}.h5"
    scene.write_text(scene_text(published, *combination), encoding="utf-8")
    command = [program, "compare", scene, "--laws", published.law, "-o", result, "--threads", "1", "--quiet"]
    run = subprocess.run(command, capture_output=True, text=True, encoding="utf-8")
    if run.returncode != 0:
        raise ScanError(f"{' '.join(map(str, command))}: {run.stderr.strip()}")
    with h5py.File(result, "r") as file:
        force = float(file["integral/pull_off_force"][0])
        place = float(file["integral/peak_stiffness_separation"][0]) / file.attrs["surface_height_std"]
    result.unlink()
    return force, place


class Row(NamedTuple):
    """A combination: area (um^2) that suits the forces best, their root mean square misfit as a factor, and that of the places in
    h*; forces at the area of the scenes (N) and places (h*) in the order of PUBLISHED."""

    thickness: float
    conversion: str
    rule: str
    area: float
    force_misfit: float
    place_misfit: float
    forces: list[float]
    places: list[float]


def judge(combination: tuple, answers: list[tuple[float, float]]) -> Row:
    forces, places = (list(column) for column in zip(*answers))
    ratios = np.log([p.force / force for p, force in zip(PUBLISHED, forces)])
    area = AREA * float(np.exp(ratios.mean()))
    misfit = float(np.exp(ratios.std()))
    off = np.array(places) - [p.place for p in PUBLISHED]
    return Row(*combination, area, misfit, float(np.sqrt(np.mean(off**2))), forces, places)


def scan(program: Path, step: float, threads: int) -> list[Row]:
    thicknesses = step * np.arange(round(LARGEST_THICKNESS / step) + 1)
    combinations = list(itertools.product(thicknesses, CONVERSIONS, RULES))
    tasks = [(published, combination) for combination in combinations for published in PUBLISHED]
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(threads) as pool:
        answers = list(pool.map(lambda task: solve(program, Path(folder), *task), tasks))
    count = len(PUBLISHED)
    return [judge(c, answers[i * count : (i + 1) * count]) for i, c in enumerate(combinations)]


def poisson_ratios(of_asperities: bool) -> list[tuple[float, float]]:
    """Range of Poisson's ratio that each rounded plasticity index of Table 2 allows, by k = 0.454 + 0.41 nu, with sigma_s or sigma."""
    ranges = []
    for radius, std, density, psi in TABLE_2:
        if of_asperities:
            std = np.sqrt(std**2 - 3.717e-4 * 1e6 / (density * radius) ** 2)
        product = 2 * 85.29 / (np.pi * 2.5) * np.sqrt(std * 1e-3 / radius)  # psi k
        ranges.append(tuple((product / (psi + half) - 0.454) / 0.41 for half in (0.005, -0.005)))
    return ranges


def write(rows: list[Row], path: Path) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["lubricant_thickness_nm", "conversions", "critical_approach", "best_area_um2", "force_misfit",
                         "place_misfit", *(f"force_uN {name}" for name in NAMES), *(f"place {name}" for name in NAMES)])
        for row in rows:
            numbers = [row.area, row.force_misfit, row.place_misfit, *(1e6 * f for f in row.forces), *row.places]
            writer.writerow([f"{row.thickness:.2f}", row.conversion, row.rule, *(f"{x:.5g}" for x in numbers)])


def draw(rows: list[Row]) -> Figure:
    thicknesses = sorted({row.thickness for row in rows})
    figure = Figure(figsize=(11.0, 7.2))
    axes = figure.subplots(2, 3, sharex=True)
    shown = [(row.conversion, row.rule) for row in rows]
    curves = {key: [row for row in rows if (row.conversion, row.rule) == key] for key in dict.fromkeys(shown)}
    for column in range(3):
        top, bottom = axes[0, column], axes[1, column]
        for (conversion, rule), points in curves.items():
            style = {"color": COLOURS[conversion], "linestyle": LINES[rule], "linewidth": 1.2}
            top.plot(thicknesses, [row.places[column] for row in points], **style)
            if conversion in ("both", "neither"):  # the mean plane shifts the separation and no force
                area = [AREA * PUBLISHED[column].force / row.forces[column] for row in points]
                bottom.plot(thicknesses, area, **style)
        published = PUBLISHED[column].place
        top.axhline(published, color="0.6", linewidth=4, zorder=0)
        top.set_title(f"({'abc'[column]}) Case {NAMES[column]}: published at $h$* = {published}")
        bottom.set_title(f"({'def'[column]}) Case {NAMES[column]}: area for the published {FORCES[column]}")
        bottom.set(yscale="log" if column == 1 else "linear", xlabel="lubricant thickness $t$ (nm)")
        if column == 1:
            bottom.set_yticks([200, 500, 1000, 2000, 5000])
            bottom.yaxis.set_minor_formatter(NullFormatter())
        bottom.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        bottom.axhline(AREA, color="0.6", linewidth=4, zorder=0)
        for panel in (top, bottom):
            panel.axvline(INFERRED[0], color="0.85", linewidth=4, zorder=0)
    axes[0, 0].set_ylabel("place of largest stiffness $h$*")
    axes[1, 0].set_ylabel("nominal area $A_n$ (µm²)")
    handles = [Line2D([], [], color=colour, label=label) for label, colour in
               zip(["$\\sigma_s$ and $y_s$ converted", "only $\\sigma_s$", "only $y_s$", "neither"], COLOURS.values())]
    handles += [Line2D([], [], color="0.3", linestyle=line, label=f"$\\delta_A$: {rule}") for rule, line in LINES.items()]
    handles += [Line2D([], [], color="0.6", linewidth=4, label="published; 1000 µm²; $t$ = 0.5 nm")]
    figure.legend(handles=handles, loc="upper center", ncols=5, fontsize=8.5)
    figure.subplots_adjust(left=0.075, right=0.985, top=0.87, bottom=0.075, hspace=0.16, wspace=0.22)
    return figure


def describe(row: Row) -> str:
    places = ", ".join(f"{place:.2f}" for place in row.places)
    forces = ", ".join(f"{force * row.area / AREA / p.force:.2f}" for force, p in zip(row.forces, PUBLISHED))
    unknowns = f"t {row.thickness:.1f} nm, {row.conversion:<11} delta_A {row.rule:<14}"
    return (f"{unknowns} A_n {row.area:5.0f} um^2, forces x/ {row.force_misfit:.2f} ({forces}), "
            f"places +- {row.place_misfit:.2f} ({places})")


def report(rows: list[Row]) -> None:
    print("published places:", ", ".join(f"{p.place}" for p in PUBLISHED), "of cases", "; ".join(NAMES))
    print("forces are over the published ones at the area that suits them best\ninferred:")
    for row in rows:
        if (round(row.thickness, 6), *row[1:3]) == INFERRED:
            print(" ", describe(row))
    for title, key in [("best places:", lambda row: row.place_misfit), ("best forces:", lambda row: row.force_misfit)]:
        print(title)
        for row in sorted(rows, key=key)[:6]:
            print(" ", describe(row))
    for name, of_asperities in [("sigma_s", True), ("sigma", False)]:
        ranges = "; ".join(f"{case} {low:.3f} to {high:.3f}" for case, (low, high) in zip(NAMES, poisson_ratios(of_asperities)))
        print(f"Poisson's ratio by the published plasticity indices, of {name}:", ranges)


def main() -> int:
    parser = argparse.ArgumentParser(description="How well the unknowns of the published simulations are determined.")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "reproduction", metavar="FOLDER")
    parser.add_argument("--step", type=float, default=0.1, metavar="NM", help="step of t, 0.01 to 0.5 nm, default 0.1")
    default = os.environ.get("STICTION", ROOT / "target" / "release" / "stiction")
    parser.add_argument("--program", type=Path, default=Path(default), metavar="PATH")
    arguments = parser.parse_args()
    try:
        if not arguments.program.is_file():
            raise ScanError(f"no program {arguments.program}: run `cargo build --release`, set STICTION or give --program")
        if not 0.01 <= arguments.step <= 0.5:
            raise ScanError(f"--step {arguments.step}: 0.01 to 0.5 nm are possible")
        arguments.output.mkdir(parents=True, exist_ok=True)
        rows = scan(arguments.program.resolve(), arguments.step, os.cpu_count() or 1)
        write(rows, arguments.output / "unknowns.csv")
        with rc_context(STYLE):
            draw(rows).savefig(arguments.output / "unknowns.png", dpi=110)
    except (ScanError, OSError) as error:
        print(f"scan_unknowns: {error}", file=sys.stderr)
        return 2
    report(rows)
    print(arguments.output / "unknowns.csv", arguments.output / "unknowns.png", sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
