"""Effect of coupling through the substrate on a surface: pictures from the scenes in configs/coupled.

Usage: python scripts/plot_coupling.py RESULTS [-o FOLDER]

RESULTS is a folder with case_i.h5, case_ii.h5, case_iii.h5, case_iii_loop.h5 and patches.h5; those that are not
there are computed into it, in half an hour on two cores. The pictures go to docs.

coupled_cases.svg   force over separation of the three cases, with the integral and the mean field, and what
                    coupling changes
coupled_patch.svg   the patch of case III, which jumps: force, avalanches and the unloading branch
coupled_loads.svg   asperities of a part of this patch before and after the largest avalanche
coupled_chart.svg   change of pull-off and stiffness over the attraction of the integral, displacement of the
                    pull-off
coupled_force.svg   change of the force over separation and side, for three roughnesses
"""

from pathlib import Path

import h5py
import numpy as np
from drawing import (
    BLUE, DASH_DOT, DASHED, DOCS, GREEN, H_STAR, PINK, ROOT, SHADES, VERDICTS, VERMILION, column, digits,
    dressed, factor_and_unit, legend, options, rounded, run, save,
)
from matplotlib.colors import LogNorm, SymLogNorm

CASES = {"I": "case_i", "II": "case_ii", "III": "case_iii"}
COUPLINGS = {"periodic": (1, GREEN, "coupled, repeated square"), "patch": (2, BLUE, "coupled, patch")}
# Wide enough that the one shows below the other where they agree.
WIDTHS = {"periodic": 3.2, "patch": 1.3}
INDEPENDENT = {"color": VERMILION, "alpha": 0.35, "linewidth": 5.0, "label": "independent"}
# Where the picture of a case begins, h*, and how far changes reach in it, % of the pull-off.
LIMITS = {"I": (3.6, 40), "II": (2.0, 30), "III": (0.7, 110)}
# Half a side of the part of a patch that is drawn, um.
REACH = 3.0
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


def draw_case(force, change, name, file):
    pair = {kind: point for kind in COUPLINGS if (point := coupling_of(file, kind))}
    patch = pair["patch"]
    h_star, integral, mean_field = (
        patch[path] for path in ("coupling/h_star", "integral/external_force",
                                 "validation/mean_field_external_force")
    )
    scale = -np.min(patch.independent)
    factor, sign = factor_and_unit([scale], "N")
    force.plot(h_star, patch.independent / factor, **INDEPENDENT)
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
    force.plot(h_star, mean_field / factor, color=PINK, linewidth=1.0, linestyle=DASH_DOT,
               label="mean field of the patch")
    force.plot(h_star, integral / factor, color="black", linewidth=0.8, linestyle=DASHED, label="integral")
    change.plot(h_star, 100 * (mean_field - integral) / scale, color=PINK, linewidth=1.0, linestyle=DASH_DOT)
    begin, reach = LIMITS[name]
    deepest = scale / factor
    for axes in (force, change):
        axes.axhline(0.0, color="0.8", linewidth=0.7, zorder=0)
        axes.set(xlim=(begin, 6.3))
    force.set(ylim=(-1.15 * deepest, 0.7 * deepest), ylabel=f"external force ({sign})", xlabel=H_STAR)
    force.set_title(f"Case {name}", loc="right")
    change.set(ylim=(-reach, reach), ylabel="change (% of the pull-off)", xlabel=H_STAR)
    change.set_title(f"Case {name}, coupled less independent", loc="right")


@dressed
def draw_cases(files):
    figure, panels = column(2.6, *[2.0] * 5)
    for row, (name, scene) in enumerate(CASES.items()):
        draw_case(*panels[2 * row : 2 * row + 2], name, files[scene])
    panels[0].set_title("")
    # Case II has all of the curves.
    legend(panels[0], panels[2].get_legend_handles_labels()[0])
    return figure


def draw_map(axes, patch, state, largest, window):
    x, y = (1e6 * patch[f"asperities/{name}"] for name in "xy")
    load = 1e6 * patch["asperities/external_force"][state]
    touches = patch["asperities/in_contact"][state] > 0
    near = np.all([np.abs(at - np.mean(ends)) < 1.1 * REACH for at, ends in zip((x, y), window)], axis=0)
    colors = {"cmap": "RdBu_r", "norm": SymLogNorm(0.03 * largest, vmin=-largest, vmax=largest)}
    for own, size in ((near & ~touches, 10.0), (near & touches, 40.0)):
        drawn = axes.scatter(x[own], y[own], c=load[own], s=size, linewidths=0, **colors)
    h_star = patch["asperities/state_separation"][state] / patch["surface_height_std"]
    axes.set(aspect="equal", xlabel="x (µm)", ylabel="y (µm)", xlim=window[0], ylim=window[1])
    return drawn, f"$h^*$ = {h_star:.2f}: {int(np.sum(touches))} of {int(np.sum(np.isfinite(x)))} touch"


def draw_loop(axes, file):
    """The forces of a loop on approach and on the unloading branch, with the mean field of the latter."""
    x = file["validation/separation"][()] / file.attrs["surface_height_std"]
    ways = {"approach": "ensemble/external_force_mean", "unloading branch": "ensemble/retraction_external_force_mean",
            "mean field of the unloading branch": "validation/retraction_mean_field_external_force"}  # fmt: skip
    curves = {label: file[path][()] for label, path in ways.items()}
    factor, sign = factor_and_unit([-min(curve.min() for curve in curves.values())], "N")
    styles = {"color": BLUE, "linestyle": DASHED}, {"color": BLUE}, {"color": PINK, "linestyle": DASH_DOT}
    for (label, curve), style in zip(curves.items(), styles):
        axes.plot(x, curve / factor, linewidth=1.0, label=label, **style)
    unsettled = file["coupling/retraction_unsettled_count"][()] > 0
    if unsettled.any():
        axes.plot(x[unsettled], curves["unloading branch"][unsettled] / factor, "x", color=BLUE, label="not settled")
    axes.axhline(0.0, color="0.8", linewidth=0.7, zorder=0)
    axes.set(xlim=(x[0], x[-1]), xlabel=H_STAR, ylabel=f"external force ({sign})")
    legend(axes)


@dressed
def draw_patch(file, loop):
    figure, (force, sizes, back) = column(2.5, 1.9, 2.2)
    patch = coupling_of(file, "patch")
    h_star, coupled = patch["coupling/h_star"], patch.independent + patch.difference
    factor, sign = factor_and_unit([patch["integral/pull_off_force"]], "N")
    force.plot(h_star, patch.independent / factor, **INDEPENDENT)
    force.plot(h_star, coupled / factor, ".-", color=BLUE, linewidth=1.0, markersize=2.5,
               label="coupled, patch, on approach")
    deepest = np.max(-patch.independent) / factor
    force.set(ylim=(-1.1 * deepest, 0.4 * deepest), ylabel=f"external force ({sign})")
    legend(force)
    sizes.stem(h_star, patch["coupling/largest_avalanche_mean"], basefmt=" ", linefmt=BLUE, markerfmt=".")
    sizes.set(yscale="log", ylim=(0.7, 2e4), ylabel="largest avalanche\n(asperities)")
    for axes in (force, sizes):
        axes.set(xlim=(h_star[0], 6.5), xlabel=H_STAR)
    draw_loop(back, loop)
    return figure


@dressed
def draw_loads(file):
    figure, maps = column(3.0, 3.0)
    patch = coupling_of(file, "patch")
    largest = 1e6 * np.nanmax(np.abs(patch["asperities/external_force"]))
    states = np.argsort(-patch["asperities/state_separation"])
    # A part of the patch, around the asperity that touches before the avalanche.
    first = np.argmax(patch["asperities/in_contact"][states[0]])
    window = [1e6 * patch[f"asperities/{name}"][first] + np.array([-REACH, REACH]) for name in "xy"]
    for axes, state in zip(maps, states):
        drawn, title = draw_map(axes, patch, state, largest, window)
        axes.set_title(title)
        figure.colorbar(drawn, ax=axes, label="load (µN)")
    return figure


def draw_changes(axes, chart, limits, cases):
    low, high = 3e-4, 30.0
    good, invalid = (limits[f"{word}_relative_attractive_stiffness"] for word in ("good", "invalid"))
    ends = 3e-6, good, invalid, 100.0
    for begin, end, shade, word in zip(ends, ends[1:], SHADES, VERDICTS):
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
    axes.set(xlabel="largest attraction of the integral over $k_s$", ylabel="relative change by coupling")
    legend(axes)


def draw_places(axes, chart):
    expected = np.array([-point["independence/relative_shift"] for point in chart])
    ratio = np.array([point["independence/relative_attractive_stiffness"] for point in chart])
    found = np.array([point.scalar("pull_off_separation")[1:] / point["surface_height_std"]
                      for point in chart])
    far, line = (expected > 0.05) & ~(ratio > 1.0), np.array([0.05, 2.0])
    axes.plot(line, line, color="black", linewidth=0.9, linestyle=DASHED, label="mean field")
    axes.errorbar(expected[far], found[far, 0], yerr=found[far, 1], fmt="o", color=BLUE, elinewidth=0.7)
    axes.set(xlim=(0.0, 1.6), ylim=(-0.2, 1.6))
    axes.set(xlabel="shift $F/k_s$ at pull-off ($\\sigma$)", ylabel="pull-off moves by ($\\sigma$)")
    legend(axes)


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
    axes.set(yscale="log", xlim=(h_star[0], 6.0), xlabel=H_STAR, ylim=(sides[0] / 1.35, sides[-1] * 1.35))
    axes.set_yticks([], minor=True)
    axes.set_yticks(sides, [f"{side:.0f}" for side in sides])
    return drawn


@dressed
def draw_chart(file, cases):
    figure, (changes, places) = column(3.2, 2.5)
    chart = points(file)
    drawn = [*chart, *(coupling_of(case, "patch") for case in cases.values())]
    draw_changes(changes, drawn, file["independence"].attrs, cases)
    draw_places(places, drawn)
    return figure


@dressed
def draw_force(file):
    figure, sizes = column(2.0, 2.0, 2.0)
    chart = points(file)
    sigmas = np.unique([point["surface_height_std"] for point in chart])
    for axes, index in zip(sizes, (0, len(sigmas) // 2, len(sigmas) - 1)):
        mesh = draw_size(axes, [point for point in chart if point["surface_height_std"] == sigmas[index]])
        axes.set_title(f"$\\sigma$ = {1e9 * sigmas[index]:.2f} nm")
        axes.set(ylabel="side of the patch (µm)")
    figure.colorbar(mesh, ax=sizes, label="relative change of the force")
    return figure



def numbers_of_cases(files):
    """By case and coupling: pull-off without and with it, change and its standard error, %, place of both."""
    kept = {}
    for name, scene in CASES.items():
        for kind in COUPLINGS:
            if (point := coupling_of(files[scene], kind)) is None:
                continue
            independent, difference, error = point.scalar("pull_off_force")
            factor, _ = factor_and_unit([independent], "N")
            place, moved = (value / point["surface_height_std"] for value in point.scalar("pull_off_separation")[:2])
            change = rounded(100 * difference / independent, 100 * error / independent) if np.isfinite(error) else ()
            kept[f"{name} {kind}"] = [digits(independent / factor), digits((independent + difference) / factor),
                                      *change, f"{place:.3f}", f"{place + moved:.3f}"]  # fmt: skip
    return kept


def numbers_of_patch(file):
    """Asperities of the patch of case III that touch after its largest avalanche, and the size of that."""
    patch = coupling_of(file, "patch")
    states = np.argsort(-patch["asperities/state_separation"])
    after = np.sum(patch["asperities/in_contact"][states[-1]] > 0)
    return {"after": [f"{after}"], "asperities": [f"{np.sum(np.isfinite(patch['asperities/x']))}"],
            "largest avalanche": [f"{np.max(patch['coupling/largest_avalanche_mean']):.0f}"]}  # fmt: skip


def main():
    parser = options(__doc__, DOCS)
    parser.add_argument("results", type=Path, metavar="RESULTS", help="folder of the results")
    arguments = parser.parse_args()
    files = {}
    for name in (*CASES.values(), "case_iii_loop", "patches"):
        path = arguments.results / f"{name}.h5"
        if not path.is_file():
            run("run", ROOT / "configs" / "coupled" / f"{name}.toml", "-o", path, "--quiet")
        files[name] = h5py.File(path)
    cases = {name: files[scene] for name, scene in CASES.items()}
    loop = files["case_iii_loop"]["replicas/pull_off_force"][0]
    numbers = {"cases": numbers_of_cases(files), "loads": numbers_of_patch(files["case_iii"]),
               "patch": {"pull-off of the loop": [digits(1e3 * loop)]}}  # fmt: skip
    pictures = {"cases": draw_cases(files), "patch": draw_patch(files["case_iii"], files["case_iii_loop"]),
                "loads": draw_loads(files["case_iii"]), "chart": draw_chart(files["patches"], cases),
                "force": draw_force(files["patches"])}  # fmt: skip
    for name, figure in pictures.items():
        path = arguments.output / f"coupled_{name}.svg"
        save(figure, path, arguments.dpi, numbers.get(name))
        print(path)


if __name__ == "__main__":
    main()
