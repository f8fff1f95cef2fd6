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
# dependencies = ["numpy>=1.24", "h5py>=3.8", "matplotlib>=3.7"]
# ///

import argparse
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, SymLogNorm
from matplotlib.figure import Figure

from plot_page import BLUE, DASHED, GREEN, STYLE, VERMILION, panel, si

ROOT = Path(__file__).resolve().parents[1]
CASES = {"I": "case_i", "II": "case_ii", "III": "case_iii"}
CHART = "patches"
COUPLINGS = {"periodic": (1, BLUE, "repeated square"), "patch": (2, VERMILION, "patch")}
# Roughnesses of the chart that are drawn over separation and size, by their index.
DRAWN = (0, 3, 6)
# Share of the pull-off below which a force is none.
NONE = 1e-3


class ProgramError(Exception):
    """The program failed."""


class Point:
    """A point of a sweep."""

    def __init__(self, file: h5py.File, index: int) -> None:
        self.file, self.index = file, index

    def __getitem__(self, path: str) -> np.ndarray:
        return self.file[path][self.index]

    def of(self, kind: str, quantity: str = "external_force") -> np.ndarray:
        """A curve without coupling, or the difference that it makes."""
        return self[f"coupling/{kind}_{quantity}_mean"]

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
    return [Point(file, index) for index in range(file.attrs["points"])]


def coupling_of(file: h5py.File, name: str) -> Point | None:
    """The point of a sweep over the coupling that has one; none where it was not computed."""
    return next((point for point in points(file) if point["substrate_coupling"] == COUPLINGS[name][0]), None)


def draw_case(force: Axes, change: Axes, name: str, file: h5py.File) -> None:
    pair = {kind: point for kind in COUPLINGS if (point := coupling_of(file, kind))}
    patch = pair["patch"]
    h_star, independent = patch["coupling/h_star"], patch.of("independent")
    scale = patch["integral/pull_off_force"]
    factor, prefix = si(scale)
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
    limit = 1.15 if name != "III" else 1.05
    force.set(xlim=(h_star[0], 6.0), ylim=(-limit * scale / factor, 0.6 * scale / factor), ylabel=f"external force, {prefix}N")
    reach = {"I": 60, "II": 60, "III": 110}[name]
    change.set(xlim=(h_star[0], 6.0), ylim=(-reach, reach), xlabel="separation $h^*$", ylabel="change, % of the pull-off")
    force.set_title(f"case {name}")


def draw_cases(files: dict[str, h5py.File]) -> Figure:
    figure = Figure(figsize=(11.0, 6.2))
    for column, (name, scene) in enumerate(CASES.items()):
        left = 0.7 + 3.55 * column
        force, change = panel(figure, left, 3.35, 2.9, 2.45), panel(figure, left, 0.55, 2.9, 2.35)
        draw_case(force, change, name, files[scene])
        if column == 0:
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
    factor, prefix = si(patch["integral/pull_off_force"])
    force.plot(h_star, patch.of("independent") / factor, color="0.35", linewidth=2.4, alpha=0.5, label="independent")
    force.plot(h_star, patch.coupled / factor, ".-", color=VERMILION, linewidth=1.0, markersize=2.5, label="patch, on approach")
    force.set(xlim=(h_star[0], 6.5), ylim=(-1.1 * np.max(-patch.of("independent")) / factor, 0.4 * np.max(-patch.of("independent")) / factor),
              ylabel=f"external force, {prefix}N")
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


def draw_scatter(axes: Axes, file: h5py.File, cases: dict[str, h5py.File]) -> None:
    chart = points(file)
    limits = file["independence"].attrs
    good, invalid = (limits[f"{word}_relative_attractive_stiffness"] for word in ("good", "invalid"))
    low, high = 1e-7, 30.0
    for begin, end, shade, word in [(low, good, "#D5EBE2", "good"), (good, invalid, "#FCEBC8", "a shift"), (invalid, 1e3, "#F3D3C4", "invalid")]:
        axes.axvspan(begin, end, color=shade, linewidth=0)
        axes.text(np.sqrt(max(begin, 1e-5) * min(end, 100.0)), 12.0, word, ha="center", style="italic", color="0.25")
    sigmas = np.array([point["surface_height_std"] for point in chart]) * 1e9
    sides = np.array([np.sqrt(point["nominal_area"]) for point in chart]) * 1e6
    ratio = np.array([point["independence/relative_attractive_stiffness"] for point in chart])
    scalars = np.array([point.scalar("pull_off_force") for point in chart])
    change, error = np.abs(scalars[:, 1]) / scalars[:, 0], scalars[:, 2] / scalars[:, 0]
    for side, marker in zip(np.unique(sides), "osD^"):
        which = sides == side
        drawn = axes.scatter(ratio[which], np.maximum(change[which], low), c=sigmas[which], marker=marker, s=28, cmap="viridis",
                             norm=LogNorm(sigmas.min(), sigmas.max()), zorder=3, label=f"side {side:.1f} µm", edgecolors="white", linewidths=0.4)
    axes.errorbar(ratio, np.maximum(change, low), yerr=2 * error, fmt="none", ecolor="0.5", elinewidth=0.7)
    for name, case in cases.items():
        patch = coupling_of(case, "patch")
        independent, difference, _ = patch.scalar("pull_off_force")
        place = (patch["independence/relative_attractive_stiffness"], max(abs(difference) / independent, low))
        axes.plot(*place, "*", color="black", markersize=9, zorder=4)
        axes.annotate(f"case {name}", place, xytext=(6, 4), textcoords="offset points", fontweight="bold")
    axes.set(xscale="log", yscale="log", xlim=(1e-5, 100.0), ylim=(low, high), xlabel="largest attractive stiffness of the integral over $k_s$",
             ylabel="change of the pull-off by coupling")
    axes.legend(loc="lower right")
    axes.set_title("(a) Pull-off of patches")
    axes.figure.colorbar(drawn, ax=axes, pad=0.02, label="roughness $\\sigma$, nm", ticks=[1, 2, 3]).ax.set_yticklabels(["1", "2", "3"])


def draw_chart(file: h5py.File, cases: dict[str, h5py.File]) -> Figure:
    figure = Figure(figsize=(11.0, 4.0))
    draw_scatter(panel(figure, 0.75, 0.55, 4.3, 3.1), file, cases)
    chart = points(file)
    sigmas = np.unique([point["surface_height_std"] for point in chart])
    for column, index in enumerate(DRAWN):
        own = [point for point in chart if np.isclose(point["surface_height_std"], sigmas[index])]
        sides = np.array([np.sqrt(point["nominal_area"]) for point in own]) * 1e6
        axes = panel(figure, 5.85 + 1.55 * column, 0.55, 1.35, 3.1)
        h_star = own[0]["coupling/h_star"]
        change = np.array([np.abs(point.of("difference")) / (np.abs(point.of("independent")) + NONE * point["integral/pull_off_force"])
                           for point in own])
        drawn = axes.pcolormesh(h_star, sides, np.maximum(change, 1e-4), norm=LogNorm(1e-3, 1.0), cmap="magma_r", shading="nearest")
        limit = [point["independence/independent_from"] for point in own]
        axes.plot(np.array(limit) / sigmas[index], sides, color=GREEN, linewidth=1.6, marker="o", markersize=3)
        axes.set(yscale="log", xlim=(1.0, 6.0), xlabel="$h^*$", yticks=[], ylim=(sides[0] / 1.35, sides[-1] * 1.35))
        axes.set_yticks([], minor=True)
        axes.set_title(f"({'bcd'[column]}) $\\sigma$ = {1e9 * sigmas[index]:.2f} nm")
        if column == 0:
            axes.set_yticks(sides, [f"{side:.0f}" for side in sides])
            axes.set_ylabel("side of the patch, µm", labelpad=-2)
    figure.colorbar(drawn, cax=panel(figure, 10.4, 0.55, 0.1, 3.1), label="change of the force")
    return figure


def told(value: float, unit: str) -> str:
    factor, prefix = si(abs(value))
    return f"{value / factor:.3g} {prefix}{unit}"


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
                    change = f"{100 * difference / independent:+.3g} ± {100 * error / independent:.2g} %"
                    cells.append(f"{told(independent, unit)} → {told(independent + difference, unit)} ({change})")
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
        with rc_context(STYLE):
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
