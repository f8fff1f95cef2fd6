"""The spread of plastic models: the pull-off of one rough surface by loading law and unloading.

Usage: python scripts/plot_plastic.py sweep_plastic.h5 [-o OUT.svg]      after `stiction run
configs/sweep_plastic.toml`

(a) external force of the integral on retraction by each unloading of Kogut and Etsion's load, with the
    approach;
(b) pull-off by the load: mean over the replicas with two standard errors, and the integral. The table is
    printed.
"""

import re

import h5py
import numpy as np
from drawing import BLUE, DASH_DOT, DOCS, GREEN, H_STAR, PINK, VERMILION, column, dressed, legend, options, save

# Colour and marker of an unloading, and its distance from its load.
UNLOADINGS = {"ekk": ("0.25", "D", -0.24), "secant": (PINK, "o", -0.08),
              "mesarovic_johnson": (VERMILION, "s", 0.08), "thornton_ning": (GREEN, "^", 0.24)}  # fmt: skip


def names(dataset):
    """The names of a swept choice at the points."""
    known = dict(re.findall(r"(\d+) ([\w:]+)", dataset.attrs["long_name"].split(": ", 1)[1]))
    return [known[str(int(number))] for number in dataset[:]]


def table(points, laws, pull_offs):
    lines = [["load", *(f"`{name}`" for name in UNLOADINGS)], ["---"] * (1 + len(UNLOADINGS))]
    for law in laws:
        found = [points.index((law, name)) if (law, name) in points else None for name in UNLOADINGS]
        cells = ["" if i is None else "{:.2f} ± {:.2f} ({:.2f})".format(*(of[i] for of in pull_offs))
                 for i in found]
        lines.append([f"`{law}`", *cells])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


@dressed
def draw(file, points, laws, pull_offs):
    figure, (curves, pulls) = column(3.0, 3.0)
    h_star, (mean, error, integral) = file["integral/h_star"][:], pull_offs
    for i in [points.index(("ke", name)) for name in UNLOADINGS]:
        name = points[i][1]
        # Two of them nearly agree.
        curves.plot(h_star[i], 1e6 * file["integral/retraction_external_force"][i], color=UNLOADINGS[name][0],
                    linestyle=DASH_DOT if name == "thornton_ning" else "-", label=name)
    curves.plot(h_star[i], 1e6 * file["integral/external_force"][i], color=BLUE, linestyle="dotted",
                label="approach")
    curves.axhline(0.0, color="0.8", lw=0.6, zorder=0)
    curves.set(xlim=(3.0, 6.0), ylim=(-2.0, 2.0), xlabel=H_STAR, ylabel="external force (µN)")
    for name, (color, marker, offset) in UNLOADINGS.items():
        own = [i for i, point in enumerate(points) if point[1] == name]
        x = [laws.index(points[i][0]) + offset for i in own]
        style = {"color": color, "marker": marker, "ls": "none"}
        pulls.errorbar(x, mean[own], 2.0 * error[own], **style, label=name)
        pulls.plot(x, integral[own], **style, mfc="none")
    pulls.plot([], [], "o", color="0.4", mfc="none", label="integral")
    pulls.set(yscale="log", xlabel="law of the load", ylabel="pull-off force (µN)", xlim=(-0.5, len(laws) - 0.5))
    pulls.set_xticks(range(len(laws)), laws)
    legend(curves)
    legend(pulls)
    return figure


def main():
    parser = options(__doc__, DOCS / "plastic.svg")
    parser.add_argument("file")
    arguments = parser.parse_args()
    with h5py.File(arguments.file) as file:
        points = list(zip(names(file["model_law"]), names(file["model_unloading"])))
        laws = list(dict.fromkeys(law for law, _ in points))
        replicas = 1e6 * file["replicas/pull_off_force"][:]
        error = replicas.std(axis=1, ddof=1) / np.sqrt(replicas.shape[1])
        pull_offs = replicas.mean(axis=1), error, 1e6 * file["integral/pull_off_force"][:]
        save(draw(file, points, laws, pull_offs), arguments.output, arguments.dpi)
    print(table(points, laws, pull_offs))


if __name__ == "__main__":
    main()
