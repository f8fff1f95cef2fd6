"""How far plastic models are apart: the pull-off of one rough surface by loading law and unloading.

Reads what `stiction run configs/sweep_plastic.toml` leaves, and draws

(a) the external force of the integral on retraction, over the separation, of Kogut and Etsion's load by each unloading, with the
    approach;
(b) the pull-off by the load: mean over the replicas with two standard errors, and the integral, by unloading.

The table of docs/plastic.md is printed: pull-off of the replicas and of the integral, by model.

Usage:
    python scripts/plot_plastic.py sweep_plastic.h5 [-o OUT.png] [--dpi N]

The picture goes to docs/plastic.png unless -o says otherwise.
Exit codes: 0 done; 2 the file is not that of the sweep, or the picture cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "h5netcdf>=1.3", "matplotlib>=3.8", "pandas>=2.1", "xarray>=2024.10"]
# ///

import argparse
import re
import sys
from pathlib import Path

import h5py
import numpy as np
from matplotlib.figure import Figure

from drawing import BLUE, GREEN, VERMILION, context, panel

ROOT = Path(__file__).resolve().parents[1]
COLOURS = {"ekk": "0.25", "secant": BLUE, "mesarovic_johnson": VERMILION, "thornton_ning": GREEN}
MARKERS = {"ekk": "D", "secant": "o", "mesarovic_johnson": "s", "thornton_ning": "^"}


def names(dataset: h5py.Dataset) -> list[str]:
    """The names of a swept choice at the points."""
    known = dict(re.findall(r"(\d+) ([\w:]+)", dataset.attrs["long_name"].split(": ", 1)[1]))
    return [known[str(int(number))] for number in dataset[:]]


def pull_off(file: h5py.File) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pull-off at the points, N: mean over the replicas, its standard error, and the integral's."""
    replicas = file["replicas/pull_off_force"][:]
    error = replicas.std(axis=1, ddof=1) / np.sqrt(replicas.shape[1])
    return replicas.mean(axis=1), error, file["integral/pull_off_force"][:]


def table(points: list[tuple[str, str]], mean: np.ndarray, error: np.ndarray, integral: np.ndarray) -> str:
    unloadings = list(COLOURS)
    lines = ["| load | " + " | ".join(f"`{name}`" for name in unloadings) + " |", "|---|" + "---|" * len(unloadings)]
    for law in dict.fromkeys(law for law, _ in points):
        cells = []
        for unloading in unloadings:
            if (law, unloading) not in points:
                cells.append("")
                continue
            i = points.index((law, unloading))
            cells.append(f"{1e6 * mean[i]:.2f} ± {1e6 * error[i]:.2f} ({1e6 * integral[i]:.2f})")
        lines.append(f"| `{law}` | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def draw(file: h5py.File, points: list[tuple[str, str]], output: Path, dpi: int) -> None:
    with context():
        figure = Figure(figsize=(7.2, 3.1), layout="none")
        curves = panel(figure, 0.62, 0.5, 2.75, 2.35)
        h_star = file["integral/h_star"][:]
        force = file["integral/retraction_external_force"][:]
        for i, (law, unloading) in enumerate(points):
            if law == "ke":
                curves.plot(h_star[i], 1e6 * force[i], color=COLOURS[unloading], label=unloading)
                if unloading == "ekk":
                    curves.plot(h_star[i], 1e6 * file["integral/external_force"][i], color="0.6", ls="dotted", label="approach")
        curves.set(xlim=(3.0, 6.0), ylim=(-2.0, 2.0), xlabel="separation $h^*$", ylabel="external force (µN)")
        curves.axhline(0.0, color="0.8", lw=0.6, zorder=0)
        curves.legend(fontsize=7, title="`ke`, unloaded by".replace("`", ""), title_fontsize=7)
        curves.set_title("(a)", loc="left")
        pulls = panel(figure, 4.15, 0.5, 2.9, 2.35)
        laws = list(dict.fromkeys(law for law, _ in points))
        mean, error, integral = pull_off(file)
        for unloading, offset in zip(COLOURS, (-0.24, -0.08, 0.08, 0.24)):
            own = [i for i, point in enumerate(points) if point[1] == unloading]
            x = np.array([laws.index(points[i][0]) + offset for i in own])
            style = {"color": COLOURS[unloading], "marker": MARKERS[unloading], "ls": "none", "ms": 4}
            pulls.errorbar(x, 1e6 * mean[own], 2e6 * error[own], **style, capsize=2, label=unloading)
            pulls.plot(x, 1e6 * integral[own], **style, mfc="none")
        pulls.set(yscale="log", ylabel="pull-off (µN)", xlim=(-0.5, len(laws) - 0.5))
        pulls.set_xticks(range(len(laws)), laws)
        pulls.set_title("(b)  full: mean of patches; open: integral", loc="left")
        figure.savefig(output, dpi=dpi)


def main() -> None:
    parser = argparse.ArgumentParser(description="How far plastic models are apart.")
    parser.add_argument("file", type=Path, help="what stiction run configs/sweep_plastic.toml leaves")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs" / "plastic.png", metavar="OUT.png")
    parser.add_argument("--dpi", type=int, default=160)
    arguments = parser.parse_args()
    try:
        with h5py.File(arguments.file, locking=False) as file:
            points = list(zip(names(file["model_law"]), names(file["model_unloading"])))
            draw(file, points, arguments.output, arguments.dpi)
            values = pull_off(file)
    except (OSError, KeyError) as error:
        print(f"{arguments.file}: {error}", file=sys.stderr)
        sys.exit(2)
    print(table(points, *values))


if __name__ == "__main__":
    main()
