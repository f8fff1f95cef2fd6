"""What coupling through the substrate makes of a surface: three pictures from the scenes in configs/coupled.

coupled_cases.png   the cases of Shi and Polycarpou: force over separation, independent, as a repeated square and as a patch, with
                    the integral and the mean field, and what coupling changes
coupled_patch.png   the patch of case III, which snaps: its force, its avalanches, and its asperities before and after the largest
coupled_chart.png   when independence holds: change of pull-off over the attraction of the integral, and of the force over separation,
                    roughness and size, with the limits of the verdict

Usage:
    python scripts/plot_coupling.py RESULTS [-o FOLDER] [--stiction PROGRAM] [--dpi N]

RESULTS is a folder with case_i.h5, case_ii.h5, case_iii.h5 and patches.h5; those that are not there are computed into it, which takes
some minutes on two cores. The pictures go to docs unless -o says otherwise; the program is target/release/stiction unless --stiction
names another. The table of the three cases is printed.
Exit codes: 0 done; 1 the program failed; 2 there is no such program, or a file cannot be read or written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "h5netcdf>=1.3", "matplotlib>=3.8", "pandas>=2.1", "xarray>=2024.10"]
# ///

import argparse
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, SymLogNorm
from matplotlib.figure import Figure

from drawing import BLUE, DASHED, GREEN, VERMILION, context, factor_and_unit, panel, si

ROOT = Path(__file__).resolve().parents[1]
CASES = {"I": "case_i", "II": "case_ii", "III": "case_iii"}
CHART = "patches"
COUPLINGS = {"periodic": (1, BLUE, "repeated square"), "patch": (2, VERMILION, "patch")}
# Where pictures of the cases begin, h*, and how far changes reach in them, % of the pull-off.
BEGINS = {"I": 3.6, "II": 2.0, "III": 0.7}
REACH = {"I": 40, "II": 30, "III": 110}
# Share of the pull-off below which a force is none.
NONE = 1e-3


class ProgramError(Exception):
    """The program failed."""


class Point:
    """A point of a sweep."""

    def __init__(self, file: h5py.File, index: tuple[int, ...]) -> None:
        self.file, self.index = file, index

    def __getitem__(self, path: str) -> np.ndarray:
        return self.file[path][self.index]

    def of(self, kind: str) -> np.ndarray:
        """The external force without coupling, or the difference that it makes."""
        return self[f"coupling/{kind}_external_force_mean"]

    @property
    def coupled(self) -> np.ndarray:
        return self.of("independent") + self.of("difference")

    def scalar(self, name: str) -> tuple[float, float, float]:
        """A scalar without coupling, the difference that it makes, and its standard error."""
        place = list(self.file["coupling/scalar"].asstr()[()]).index(name)
        kinds = ("independent_mean", "difference_mean", "difference_standard_error")
        independent, difference, error = (self[f"coupling/scalar_{kind}"][place] for kind in kinds)
        return independent, difference, error


def results(folder: Path, program: Path) -> dict[str, h5py.File]:
    """The results of the scenes, computed where they are not there."""
    files = {}
    for name in [*CASES.values(), CHART]:
        path = folder / f"{name}.h5"
        if not path.is_file():
            if not program.is_file():
                raise OSError(f"{program}: no such program")
            scene = ROOT / "configs" / "coupled" / f"{name}.toml"
            done = subprocess.run([program, "run", scene, "-o", path, "--quiet"], capture_output=True, text=True)
            if done.returncode != 0:
                raise ProgramError(done.stderr.strip())
        files[name] = h5py.File(path)
    return files


def points(file: h5py.File) -> list[Point]:
    return [Point(file, index) for index in np.ndindex(file["replica_count"].shape)]


def coupling_of(file: h5py.File, name: str) -> Point | None:
    """The point of a sweep over the coupling that has one; none where it was not computed."""
    return next((point for point in points(file) if point["substrate_coupling"] == COUPLINGS[name][0]), None)


def draw_case(force: Axes, change: Axes, name: str, file: h5py.File) -> None:
    pair = {kind: point for kind in COUPLINGS if (point := coupling_of(file, kind))}
    patch = pair["patch"]
    h_star, independent = patch["coupling/h_star"], patch.of("independent")
    scale = -np.min(independent)
    factor, sign = factor_and_unit([scale], "N")
    force.axhline(0.0, color="0.8", linewidth=0.7)
    force.plot(h_star, independent / factor, color="0.35", linewidth=2.4, alpha=0.5, label="independent")
    force.plot(h_star, patch["integral/external_force"] / factor, color="black", linewidth=0.8, linestyle="dotted", label="integral")
    force.plot(h_star, patch["validation/mean_field_external_force"] / factor, color=GREEN, linewidth=1.0, linestyle=DASHED,
               label="mean field of the patch")
    change.axhline(0.0, color="0.8", linewidth=0.7)
    for kind, point in pair.items():
        _, colour, label = COUPLINGS[kind]
        force.plot(h_star, point.coupled / factor, color=colour, linewidth=1.2, label=label)
        difference, error = (point[f"coupling/difference_external_force_{what}"] / scale for what in ("mean", "standard_error"))
        change.fill_between(h_star, 100 * (difference - 2 * error), 100 * (difference + 2 * error), color=colour, alpha=0.25, linewidth=0)
        change.plot(h_star, 100 * difference, color=colour, linewidth=1.2)
        unsettled = point["coupling/unsettled_count"] > 0
        change.plot(h_star[unsettled], 100 * difference[unsettled], "x", color=colour, markersize=4)
    shift = (patch["validation/mean_field_external_force"] - patch["integral/external_force"]) / scale
    change.plot(h_star, 100 * shift, color=GREEN, linewidth=1.0, linestyle=DASHED)
    deepest = -np.min(independent) / factor
    force.set(xlim=(BEGINS[name], 6.3), ylim=(-1.15 * deepest, 0.7 * deepest), ylabel=f"external force, {sign}")
    reach = REACH[name]
    change.set(xlim=(BEGINS[name], 6.3), ylim=(-reach, reach), xlabel="separation $h^*$", ylabel="change, % of the pull-off")
    force.set_title(f"case {name}")


def draw_cases(files: dict[str, h5py.File]) -> Figure:
    figure = Figure(figsize=(11.0, 6.2))
    for column, (name, scene) in enumerate(CASES.items()):
        left = 0.7 + 3.55 * column
        force, change = panel(figure, left, 3.35, 2.9, 2.45), panel(figure, left, 0.55, 2.9, 2.35)
        draw_case(force, change, name, files[scene])
        if name == "II":
            force.legend(loc="lower right")
    return figure


def draw_map(figure: Figure, axes: Axes, patch: Point, state: int, largest: float) -> None:
    x, y = (1e6 * patch[f"asperities/{name}"] for name in "xy")
    load = 1e6 * patch["asperities/external_force"][state]
    touches = patch["asperities/in_contact"][state] > 0
    order = np.argsort(np.abs(load))
    colours = {"cmap": "RdBu_r", "norm": SymLogNorm(0.03 * largest, vmin=-largest, vmax=largest)}
    drawn = axes.scatter(x[order], y[order], c=load[order], s=np.where(touches[order], 3.0, 1.0), linewidths=0, **colours)
    h_star = patch["asperities/state_separation"][state] / patch["surface_height_std"]
    axes.set(aspect="equal", xlabel="x, µm", xlim=(0, np.nanmax(x)), ylim=(0, np.nanmax(y)))
    axes.set_title(f"$h^*$ = {h_star:.2f}: {int(np.sum(touches))} of {int(np.sum(np.isfinite(x)))} touch")
    return drawn


def draw_patch(file: h5py.File) -> Figure:
    figure = Figure(figsize=(11.0, 4.1))
    patch = coupling_of(file, "patch")
    h_star = patch["coupling/h_star"]
    force, sizes = panel(figure, 0.65, 1.65, 3.1, 2.1), panel(figure, 0.65, 0.55, 3.1, 0.85)
    factor, sign = factor_and_unit([patch["integral/pull_off_force"]], "N")
    force.plot(h_star, patch.of("independent") / factor, color="0.35", linewidth=2.4, alpha=0.5, label="independent")
    force.plot(h_star, patch.coupled / factor, ".-", color=VERMILION, linewidth=1.0, markersize=2.5, label="patch, on approach")
    force.set(xlim=(h_star[0], 6.5), ylim=(-1.1 * np.max(-patch.of("independent")) / factor, 0.4 * np.max(-patch.of("independent")) / factor),
              ylabel=f"external force, {sign}")
    force.set_xticklabels([])
    force.legend(loc="lower right")
    force.set_title("(a) case III, a patch of 1000 µm$^2$")
    sizes.stem(h_star, patch["coupling/largest_avalanche_mean"], basefmt=" ", linefmt=BLUE, markerfmt=".")
    sizes.set(xlim=(h_star[0], 6.5), yscale="log", ylim=(0.7, 2e4), xlabel="separation $h^*$", ylabel="largest\navalanche")
    largest = 1e6 * np.nanmax(np.abs(patch["asperities/external_force"]))
    states = np.argsort(-patch["asperities/state_separation"])
    for column, (state, letter) in enumerate(zip(states, "bc")):
        axes = panel(figure, 4.35 + 3.15 * column, 0.55, 2.85, 3.1)
        drawn = draw_map(figure, axes, patch, state, largest)
        axes.set_title(f"({letter}) {axes.get_title(loc='left')}")
        if column:
            axes.set_yticklabels([])
        else:
            axes.set_ylabel("y, µm")
    bar = figure.colorbar(drawn, cax=panel(figure, 10.4, 0.9, 0.1, 2.4))
    bar.set_label("load, µN", labelpad=1)
    return figure


def draw_changes(axes: Axes, moved: Axes, file: h5py.File, cases: dict[str, h5py.File]) -> None:
    chart = [*points(file), *(coupling_of(case, "patch") for case in cases.values())]
    limits = file["independence"].attrs
    good, invalid = (limits[f"{word}_relative_attractive_stiffness"] for word in ("good", "invalid"))
    low, high = 3e-4, 30.0
    for begin, end, shade, word in [(1e-6, good, "#D5EBE2", "good"), (good, invalid, "#FCEBC8", "a shift"), (invalid, 100.0, "#F3D3C4", "invalid")]:
        axes.axvspan(begin, end, color=shade, linewidth=0)
        axes.text(np.sqrt(max(begin, 1e-5) * end), 12.0, word, ha="center", style="italic", color="0.25")
    ratio = np.array([point["independence/relative_attractive_stiffness"] for point in chart])
    is_case = np.arange(len(chart)) >= len(chart) - len(cases)
    for scalar, colour, marker, label in [("pull_off_force", BLUE, "o", "pull-off"), ("peak_secant_stiffness", VERMILION, "s", "stiffness")]:
        values = np.array([point.scalar(scalar) for point in chart])
        change, error = np.abs(values[:, 1]) / values[:, 0], values[:, 2] / values[:, 0]
        axes.errorbar(ratio, np.maximum(change, low), yerr=error, fmt="none", ecolor=colour, elinewidth=0.6, alpha=0.6)
        axes.scatter(ratio[~is_case], np.maximum(change, low)[~is_case], color=colour, marker=marker, s=14, label=label, zorder=3)
        axes.scatter(ratio[is_case], np.maximum(change, low)[is_case], color=colour, marker=marker, s=30, edgecolors="black", zorder=4)
        if marker == "o":
            for name, x, y in zip(cases, ratio[is_case], np.maximum(change, low)[is_case]):
                axes.annotate(name, (x, y), xytext=(5, 5), textcoords="offset points", fontweight="bold")
    share = np.geomspace(1e-5, 0.97, 200)
    axes.plot(share, share / (1.0 - share), color="black", linewidth=0.9, linestyle=DASHED, label="stiffness by mean field")
    axes.set(xscale="log", yscale="log", xlim=(3e-6, 100.0), ylim=(low, high), xlabel="largest attraction of the integral over $k_s$",
             ylabel="change by coupling, over what it is without")
    axes.legend(loc="lower right", frameon=True, framealpha=0.85, edgecolor="none")
    axes.set_title("(a) Pull-off and stiffness of patches")
    expected = np.array([-point["independence/relative_shift"] for point in chart])
    found = np.array([point.scalar("pull_off_separation")[1:] / point["surface_height_std"] for point in chart])
    far = (expected > 0.05) & ~(ratio > 1.0)
    line = np.array([0.05, 2.0])
    moved.plot(line, line, color="black", linewidth=0.9, linestyle=DASHED, label="mean field")
    moved.errorbar(expected[far], found[far, 0], yerr=found[far, 1], fmt="o", color=BLUE, markersize=4, elinewidth=0.7)
    moved.set(xlim=(0.0, 1.6), ylim=(-0.2, 1.6), xlabel="shift F/$k_s$ at pull-off, $\\sigma$", ylabel="pull-off moves by, $\\sigma$")
    moved.legend(loc="upper left")
    moved.set_title("(b) Place of the pull-off")


def draw_chart(file: h5py.File, cases: dict[str, h5py.File]) -> Figure:
    figure = Figure(figsize=(11.0, 4.0))
    draw_changes(panel(figure, 0.65, 0.55, 3.1, 3.1), panel(figure, 4.35, 0.55, 1.75, 3.1), file, cases)
    chart = points(file)
    sigmas = np.unique([point["surface_height_std"] for point in chart])
    for column, index in enumerate((0, len(sigmas) // 2, len(sigmas) - 1)):
        own = [point for point in chart if point["surface_height_std"] == sigmas[index]]
        sides = np.array([np.sqrt(point["nominal_area"]) for point in own]) * 1e6
        axes = panel(figure, 6.65 + 1.25 * column, 0.55, 1.1, 3.1)
        h_star = own[0]["coupling/h_star"]
        # Where the force passes through nothing a share of it says nothing.
        size = [np.maximum(np.abs(point.of("independent")), NONE * -np.min(point.of("independent"))) for point in own]
        change = np.array([np.abs(point.of("difference")) for point in own]) / np.array(size)
        drawn = axes.pcolormesh(h_star, sides, np.maximum(change, 1e-4), norm=LogNorm(1e-3, 1.0), cmap="magma_r", shading="nearest")
        limit = [point["independence/independent_from"] for point in own]
        axes.plot(np.array(limit) / sigmas[index], sides, color=GREEN, linewidth=1.6, marker="o", markersize=3)
        axes.set(yscale="log", xlim=(h_star[0], 6.0), xlabel="$h^*$", ylim=(sides[0] / 1.35, sides[-1] * 1.35))
        axes.set_yticks(sides, [f"{side:.0f}" for side in sides] if column == 0 else [])
        axes.set_yticks([], minor=True)
        axes.set_title(f"({'cde'[column]}) $\\sigma$ = {1e9 * sigmas[index]:.2f} nm")
        if column == 0:
            axes.set_ylabel("side of the patch, µm", labelpad=-2)
    figure.colorbar(drawn, cax=panel(figure, 10.32, 0.55, 0.1, 3.1)).set_label("change of the force, over the force", labelpad=1)
    return figure


def table(files: dict[str, h5py.File]) -> str:
    """The three cases: pull-off, its place and stiffness without coupling, and what coupling makes of them."""
    rows = ["| case | | pull-off | h* of it | stiffest secant | states not settled |", "|---|---|---|---|---|---|"]
    for name, scene in CASES.items():
        for kind, (_, _, label) in COUPLINGS.items():
            if (point := coupling_of(files[scene], kind)) is None:
                continue
            sigma = point["surface_height_std"]
            cells = []
            for scalar, unit, over in [("pull_off_force", "N", 1.0), ("pull_off_separation", "", sigma), ("peak_secant_stiffness", "N/m", 1.0)]:
                independent, difference, error = (value / over for value in point.scalar(scalar))
                if unit:
                    within = f" ± {100 * error / independent:.2g}" if np.isfinite(error) else ""
                    change = f"{100 * difference / independent:+.3g}{within} %"
                    cells.append(f"{si(independent, unit, 3)} → {si(independent + difference, unit, 3)} ({change})")
                else:
                    cells.append(f"{independent:.3f} → {independent + difference:.3f}")
            count = int(np.sum(point["coupling/unsettled_count"]))
            states = int(point["replica_count"]) * len(point["coupling/h_star"])
            rows.append(f"| {name} | {label} | {' | '.join(cells)} | {count} of {states} |")
    return "\n".join(rows)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path, metavar="RESULTS", help="folder of the results")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs", metavar="FOLDER", help="folder of the pictures, default docs")
    parser.add_argument("--stiction", type=Path, default=ROOT / "target" / "release" / "stiction", metavar="PROGRAM")
    parser.add_argument("--dpi", type=int, default=200, metavar="N", help="dots per inch, default 200")
    arguments = parser.parse_args()
    try:
        files = results(arguments.results, arguments.stiction)
        cases = {name: files[scene] for name, scene in CASES.items()}
        with context():
            pictures = {"cases": draw_cases(files), "patch": draw_patch(files["case_iii"]), "chart": draw_chart(files[CHART], cases)}
            for name, figure in pictures.items():
                path = arguments.output / f"coupled_{name}.png"
                figure.savefig(path, dpi=arguments.dpi)
                print(path)
        print(table(files))
    except ProgramError as error:
        print("plot_coupling:", *str(error).split(), file=sys.stderr)
        return 1
    except (OSError, KeyError) as error:
        print(f"plot_coupling: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
