"""Effect of coupling through the substrate on a surface: three pictures from the scenes in configs/coupled.

Usage: python scripts/plot_coupling.py RESULTS [-o FOLDER]

RESULTS is a folder with case_i.h5, case_ii.h5, case_iii.h5 and patches.h5; those that are not there are
computed into it, in some minutes on two cores. The pictures go to docs; the table of the three cases is
printed.

coupled_cases.png   force over separation of the three cases, with the integral and the mean field, and what
                    coupling changes
coupled_patch.png   the patch of case III, which snaps: force, avalanches, asperities before and after the
                    largest
coupled_chart.png   change of pull-off over the attraction of the integral, and of the force over separation,
                    roughness, size
"""

from pathlib import Path

import h5py
import numpy as np
from drawing import (
    BLUE, DASHED, DOCS, GREEN, ROOT, VERMILION, Figure, context, factor_and_unit, options, panel, run, si,
)
from matplotlib.colors import LogNorm, SymLogNorm

CASES = {"I": "case_i", "II": "case_ii", "III": "case_iii"}
COUPLINGS = {"periodic": (1, BLUE, "repeated square"), "patch": (2, VERMILION, "patch")}
# Wide enough that the one shows below the other where they agree.
WIDTHS = {"periodic": 2.6, "patch": 1.1}
# Where the picture of a case begins, h*, and how far changes reach in it, % of the pull-off.
LIMITS = {"I": (3.6, 40), "II": (2.0, 30), "III": (0.7, 110)}
# Share of the pull-off below which a force is none.
NONE = 1e-3


class Point:
    """A point of a sweep."""

    def __init__(self, file, index):
        self.file, self.index = file, index

    def __getitem__(self, path):
        return self.file[path][self.index]

    @property
    def independent(self):
        return self["coupling/independent_external_force_mean"]

    @property
    def difference(self):
        return self["coupling/difference_external_force_mean"]

    def scalar(self, name):
        """A scalar without coupling, the difference that it makes, and its standard error."""
        place = list(self.file["coupling/scalar"].asstr()[()]).index(name)
        return [self[f"coupling/scalar_{kind}"][place]
                for kind in ("independent_mean", "difference_mean", "difference_standard_error")]  # fmt: skip


def points(file):
    return [Point(file, index) for index in np.ndindex(file["replica_count"].shape)]


def coupling_of(file, name):
    """The point of a sweep over the coupling that has one; none where it was not computed."""
    return next((point for point in points(file) if point["substrate_coupling"] == COUPLINGS[name][0]), None)


def draw_case(force, change, letters, name, file):
    pair = {kind: point for kind in COUPLINGS if (point := coupling_of(file, kind))}
    patch = pair["patch"]
    h_star, integral, mean_field = (
        patch[path] for path in ("coupling/h_star", "integral/external_force",
                                 "validation/mean_field_external_force")
    )
    scale = -np.min(patch.independent)
    factor, sign = factor_and_unit([scale], "N")
    force.plot(h_star, patch.independent / factor, color="0.75", linewidth=5.0,
               label="independent")
    force.plot(h_star, integral / factor, color="black", linewidth=0.8, linestyle="dotted", label="integral")
    force.plot(h_star, mean_field / factor, color=GREEN, linewidth=1.0, linestyle=DASHED,
               label="mean field of the patch")
    for kind, point in pair.items():
        _, color, label = COUPLINGS[kind]
        force.plot(h_star, (point.independent + point.difference) / factor, color=color,
                   linewidth=WIDTHS[kind], label=label)
        difference = 100 * point.difference / scale
        error = 200 * point["coupling/difference_external_force_standard_error"] / scale
        change.fill_between(h_star, difference - error, difference + error, color=color, alpha=0.25,
                            linewidth=0)
        change.plot(h_star, difference, color=color, linewidth=WIDTHS[kind])
        unsettled = point["coupling/unsettled_count"] > 0
        change.plot(h_star[unsettled], difference[unsettled], "x", color=color)
    change.plot(h_star, 100 * (mean_field - integral) / scale, color=GREEN, linewidth=1.0, linestyle=DASHED)
    begin, reach = LIMITS[name]
    deepest = scale / factor
    for axes in (force, change):
        axes.axhline(0.0, color="0.8", linewidth=0.7, zorder=0)
        axes.set(xlim=(begin, 6.3))
    force.set(ylim=(-1.15 * deepest, 0.7 * deepest), ylabel=f"external force ({sign})")
    force.set_title(f"({letters[0]}) Case {name}: force", loc="left")
    change.set(ylim=(-reach, reach), ylabel="change (% of the pull-off)")
    change.set_title(f"({letters[1]}) Case {name}: change by coupling", loc="left")


def draw_cases(files):
    figure = Figure(figsize=(7.4, 8.9), layout="none")
    for row, (name, scene) in enumerate(CASES.items()):
        bottom = 6.45 - 2.95 * row
        force, change = panel(figure, 0.7, bottom, 2.85, 2.1), panel(figure, 4.35, bottom, 2.85, 2.1)
        draw_case(force, change, "abcdef"[2 * row : 2 * row + 2], name, files[scene])
        if name == "II":
            force.legend(loc="lower right")
        if name == "III":
            force.set(xlabel="separation $h^*$")
            change.set(xlabel="separation $h^*$")
    return figure


def draw_map(axes, patch, state, largest):
    x, y = (1e6 * patch[f"asperities/{name}"] for name in "xy")
    load = 1e6 * patch["asperities/external_force"][state]
    touches = patch["asperities/in_contact"][state] > 0
    order = np.argsort(np.abs(load))
    colors = {"cmap": "RdBu_r", "norm": SymLogNorm(0.03 * largest, vmin=-largest, vmax=largest)}
    # Before the avalanche few asperities touch: their points are large enough to be seen.
    size = 3.0 if np.sum(touches) > 100 else 30.0
    drawn = axes.scatter(x[order], y[order], c=load[order], s=np.where(touches[order], size, 1.5),
                         linewidths=0, **colors)
    h_star = patch["asperities/state_separation"][state] / patch["surface_height_std"]
    axes.set(aspect="equal", xlabel="x (µm)", xlim=(0, np.nanmax(x)), ylim=(0, np.nanmax(y)))
    return drawn, f"$h^*$ = {h_star:.2f}: {int(np.sum(touches))} of {int(np.sum(np.isfinite(x)))} touch"


def draw_patch(file):
    figure = Figure(figsize=(7.4, 7.15), layout="none")
    patch = coupling_of(file, "patch")
    h_star, coupled = patch["coupling/h_star"], patch.independent + patch.difference
    force, sizes = panel(figure, 0.75, 5.1, 6.4, 1.75), panel(figure, 0.75, 4.05, 6.4, 0.8)
    factor, sign = factor_and_unit([patch["integral/pull_off_force"]], "N")
    force.plot(h_star, patch.independent / factor, color="0.75", linewidth=4.0, label="independent")
    style = {"color": VERMILION, "linewidth": 1.0, "markersize": 2.5, "label": "patch, on approach"}
    force.plot(h_star, coupled / factor, ".-", **style)
    deepest = np.max(-patch.independent) / factor
    force.set(xlim=(h_star[0], 6.5), ylim=(-1.1 * deepest, 0.4 * deepest), ylabel=f"external force ({sign})")
    force.set(xticklabels=[])
    force.set_title("(a) Case III, a patch of 1000 µm$^2$: force, and largest avalanche", loc="left")
    force.legend(loc="lower right")
    sizes.stem(h_star, patch["coupling/largest_avalanche_mean"], basefmt=" ", linefmt=BLUE, markerfmt=".")
    sizes.set(xlim=(h_star[0], 6.5), yscale="log", ylim=(0.7, 2e4), xlabel="separation $h^*$",
              ylabel="asperities")
    largest = 1e6 * np.nanmax(np.abs(patch["asperities/external_force"]))
    states = np.argsort(-patch["asperities/state_separation"])
    for column, (state, letter) in enumerate(zip(states, "bc")):
        axes = panel(figure, 0.75 + 3.05 * column, 0.5, 2.75, 2.75)
        drawn, title = draw_map(axes, patch, state, largest)
        axes.set_title(f"({letter}) {title}", loc="left")
        axes.set(yticklabels=[]) if column else axes.set(ylabel="y (µm)")
    bar = figure.colorbar(drawn, cax=panel(figure, 6.65, 0.5, 0.1, 2.75))
    bar.set_label("load (µN)", labelpad=0)
    return figure


def draw_changes(axes, chart, limits, cases):
    low, high = 3e-4, 30.0
    good, invalid = (limits[f"{word}_relative_attractive_stiffness"] for word in ("good", "invalid"))
    shades = [(3e-6, good, "#D5EBE2", "good"), (good, invalid, "#FCEBC8", "a shift"),
              (invalid, 100.0, "#F3D3C4", "invalid")]
    for begin, end, shade, word in shades:
        axes.axvspan(begin, end, color=shade, linewidth=0)
        axes.text(np.sqrt(max(begin, 1e-5) * end), 12.0, word, ha="center", style="italic", color="0.25")
    ratio = np.array([point["independence/relative_attractive_stiffness"] for point in chart])
    is_case = np.arange(len(chart)) >= len(chart) - len(cases)
    for scalar, color, marker, label in [
        ("pull_off_force", BLUE, "o", "pull-off"), ("peak_secant_stiffness", VERMILION, "s", "stiffness"),
    ]:  # fmt: skip
        values = np.array([point.scalar(scalar) for point in chart])
        change, error = np.maximum(np.abs(values[:, 1]) / values[:, 0], low), values[:, 2] / values[:, 0]
        axes.errorbar(ratio, change, yerr=error, fmt="none", ecolor=color, elinewidth=0.6, alpha=0.6)
        axes.scatter(ratio[~is_case], change[~is_case], color=color, marker=marker, s=14, label=label,
                     zorder=3)
        axes.scatter(ratio[is_case], change[is_case], color=color, marker=marker, s=30, edgecolors="black",
                     zorder=4)
        for name, x, y in zip(cases, ratio[is_case], change[is_case]) if marker == "o" else ():
            axes.annotate(name, (x, y), xytext=(5, 5), textcoords="offset points", fontweight="bold")
    share = np.geomspace(1e-5, 0.97, 200)
    axes.plot(share, share / (1.0 - share), color="black", linewidth=0.9, linestyle=DASHED,
              label="stiffness by mean field")
    axes.set(xscale="log", yscale="log", xlim=(3e-6, 100.0), ylim=(low, high))
    axes.set_title("(a) Pull-off and stiffness of patches", loc="left")
    axes.set(xlabel="largest attraction of the integral over $k_s$", ylabel="relative change by coupling")
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, 0.86), frameon=True, framealpha=0.85)


def draw_places(axes, chart):
    expected = np.array([-point["independence/relative_shift"] for point in chart])
    ratio = np.array([point["independence/relative_attractive_stiffness"] for point in chart])
    found = np.array([point.scalar("pull_off_separation")[1:] / point["surface_height_std"]
                      for point in chart])
    far, line = (expected > 0.05) & ~(ratio > 1.0), np.array([0.05, 2.0])
    axes.plot(line, line, color="black", linewidth=0.9, linestyle=DASHED, label="mean field")
    axes.errorbar(expected[far], found[far, 0], yerr=found[far, 1], fmt="o", color=BLUE, elinewidth=0.7)
    axes.set(xlim=(0.0, 1.6), ylim=(-0.2, 1.6))
    axes.set_title("(b) Place of the pull-off", loc="left")
    axes.set(xlabel="shift $F/k_s$ at pull-off ($\\sigma$)", ylabel="pull-off moves by ($\\sigma$)")
    axes.legend(loc="upper left")


def draw_size(axes, own):
    """The change of the force over separation and side, of surfaces of one roughness."""
    sides = np.array([np.sqrt(point["nominal_area"]) for point in own]) * 1e6
    h_star = own[0]["coupling/h_star"]
    # Where the force passes through nothing a share of it says nothing.
    size = [np.maximum(np.abs(point.independent), NONE * -np.min(point.independent)) for point in own]
    change = np.maximum(np.array([np.abs(point.difference) for point in own]) / np.array(size), 1e-4)
    drawn = axes.pcolormesh(h_star, sides, change, norm=LogNorm(1e-3, 1.0), cmap="magma_r", shading="nearest")
    limit = [point["independence/independent_from"] / point["surface_height_std"] for point in own]
    axes.plot(limit, sides, color=GREEN, linewidth=1.6, marker="o", markersize=3)
    axes.set(yscale="log", xlim=(h_star[0], 6.0), xlabel="separation $h^*$", ylim=(sides[0] / 1.35, sides[-1] * 1.35))
    axes.set_yticks([], minor=True)
    axes.set_yticks(sides, [f"{side:.0f}" for side in sides])
    return drawn


def draw_chart(file, cases):
    figure = Figure(figsize=(7.4, 6.9), layout="none")
    chart = points(file)
    drawn = [*chart, *(coupling_of(case, "patch") for case in cases.values())]
    draw_changes(panel(figure, 0.75, 3.9, 3.6, 2.7), drawn, file["independence"].attrs, cases)
    draw_places(panel(figure, 5.15, 3.9, 2.0, 2.7), drawn)
    sigmas = np.unique([point["surface_height_std"] for point in chart])
    for column, index in enumerate((0, len(sigmas) // 2, len(sigmas) - 1)):
        axes = panel(figure, 0.75 + 1.95 * column, 0.55, 1.75, 2.4)
        mesh = draw_size(axes, [point for point in chart if point["surface_height_std"] == sigmas[index]])
        axes.set_title(f"({'cde'[column]}) $\\sigma$ = {1e9 * sigmas[index]:.2f} nm", loc="left")
        axes.set(yticks=[]) if column else axes.set_ylabel("side of the patch (µm)", labelpad=-2)
    bar = figure.colorbar(mesh, cax=panel(figure, 6.6, 0.55, 0.1, 2.4))
    bar.set_label("relative change of the force", labelpad=1)
    return figure


def change_of(point, scalar, unit):
    independent, difference, error = point.scalar(scalar)
    within = f" ± {100 * error / independent:.2g}" if np.isfinite(error) else ""
    share = f"({100 * difference / independent:+.3g}{within} %)"
    return f"{si(independent, unit, 3)} → {si(independent + difference, unit, 3)} {share}"


def table(files):
    """The three cases: pull-off, its place and stiffness without coupling, and what coupling makes of
    them."""
    rows = ["| case | | pull-off | h* of it | stiffest secant | states not settled |",
            "|---|---|---|---|---|---|"]
    for name, scene in CASES.items():
        for kind, (_, _, label) in COUPLINGS.items():
            if (point := coupling_of(files[scene], kind)) is None:
                continue
            place, moved = (value / point["surface_height_std"]
                            for value in point.scalar("pull_off_separation")[:2])
            cells = [name, label, change_of(point, "pull_off_force", "N"),
                     f"{place:.3f} → {place + moved:.3f}",
                     change_of(point, "peak_secant_stiffness", "N/m"),
                     f"{int(np.sum(point['coupling/unsettled_count']))} of "
                     f"{int(point['replica_count']) * len(point['coupling/h_star'])}"]  # fmt: skip
            rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def main():
    parser = options(__doc__, DOCS)
    parser.add_argument("results", type=Path, metavar="RESULTS", help="folder of the results")
    arguments = parser.parse_args()
    files = {}
    for name in (*CASES.values(), "patches"):
        path = arguments.results / f"{name}.h5"
        if not path.is_file():
            run("run", ROOT / "configs" / "coupled" / f"{name}.toml", "-o", path, "--quiet")
        files[name] = h5py.File(path)
    cases = {name: files[scene] for name, scene in CASES.items()}
    with context():
        pictures = {"cases": draw_cases(files), "patch": draw_patch(files["case_iii"]),
                    "chart": draw_chart(files["patches"], cases)}  # fmt: skip
        for name, figure in pictures.items():
            path = arguments.output / f"coupled_{name}.png"
            figure.savefig(path, dpi=arguments.dpi)
            print(path)
    print(table(files))


if __name__ == "__main__":
    main()
