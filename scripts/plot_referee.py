"""Boundary elements (referee.py) against coupled asperities, independent ones and the program, in one
picture.

Usage: python scripts/plot_referee.py [-o OUT.png] [--substrate TOML]

The program runs on these surfaces; --substrate is more of its table, such as 'kernel = "contact"'.
"""

import json

import numpy as np
from drawing import BLUE, DOCS, GREEN, PROGRAM, VERMILION, Figure, context, options
from matplotlib.ticker import NullFormatter, ScalarFormatter
from referee import FILE, adhesive_state, program_states, states_of

KINDS = {"point": ("point forces", BLUE, "-"), "contact": ("and the next orders", GREEN, "--"),
         "independent": ("independent", VERMILION, ":")}  # fmt: skip
BEM = {"color": "black", "marker": "o", "linestyle": "none", "markerfacecolor": "none"}
OWN = {"color": "#CC79A7", "marker": "x", "linestyle": "none"}


def column(states, name):
    return np.array([state[name] for state in states])


def curves(surface, separations):
    """Total forces of the asperities, and their states, by kind."""
    for kind in KINDS:
        states = states_of(surface, list(separations), kind)
        yield kind, np.array([float(state.force.sum()) for state in states]), states


def force_over_separation(axes, surface, rows, program, separations):
    scale = 1e-6 / surface["cell"] ** 2
    axes.plot(column(rows, "separation") * 1e9, column(rows, "pressure") * 1e-6, label="boundary elements",
              **BEM)
    for kind, forces, _ in curves(surface, separations):
        label, color, line = KINDS[kind]
        axes.plot(np.array(separations) * 1e9, forces * scale, line, color=color, label=label)
    axes.plot(column(rows, "separation") * 1e9, column(program, "external_force") * scale, label="program",
              **OWN)
    axes.set(yscale="log", xlabel="separation (nm)", ylabel="mean pressure (MPa)")
    axes.yaxis.set_major_formatter(ScalarFormatter())
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.legend()


def errors(axes, parts, programs):
    """Relative error of the total force at the separation of the referee, over the share in contact."""
    for (name, surface), marker in zip(parts.items(), "osD^"):
        rows = surface["states"]
        share, true = column(rows, "area") / surface["cell"] ** 2, column(rows, "force")
        for kind, forces, _ in curves(surface, column(rows, "separation")):
            style = {"color": KINDS[kind][1], "marker": marker, "label": name if kind == "point" else None}
            axes.plot(share, np.abs(forces / true - 1), KINDS[kind][2], **style)
        if name in programs:
            axes.plot(share, np.abs(column(programs[name], "external_force") / true - 1), **OWN)
    axes.set(xscale="log", yscale="log", xlabel="share of the area in contact",
             ylabel="relative error of the total force")
    axes.set_title("(b) error at equal separations")
    axes.legend(title="asperities")


def loads(axes, surface, row, program):
    """Load of each asperity against the referee's."""
    true = np.array(row["loads"])
    found = {kind: (states[0].force.astype(float),
                    {"color": KINDS[kind][1], "marker": "o", "linestyle": "none"})
             for kind, _, states in curves(surface, [row["separation"]])}  # fmt: skip
    for kind, (force, style) in {**found, "program": (program["loads"], OWN)}.items():
        own = force > 0
        axes.plot(true[own] * 1e6, (force - true)[own] / true.max(), label=KINDS.get(kind, [kind])[0],
                  **style)
    axes.set(xlabel="load of an asperity (µN)", ylabel="difference over the largest load")
    axes.set_title(f"(c) loads of 200 asperities at {row['pressure'] * 1e-6:g} MPa")
    axes.set_yscale("symlog", linthresh=1e-4)
    axes.axhline(0, color="grey", linewidth=0.6)
    axes.legend(loc="center right")


def areas(axes, surfaces):
    """Share in contact over the mean pressure, of surfaces by name: asperities, states of the referee and the
    program."""
    for (name, (surface, rows, program)), marker in zip(surfaces.items(), "os"):
        cell, first = surface["cell"] ** 2, marker == "o"
        style = {**BEM, "marker": marker, "label": f"boundary elements, {name}"}
        axes.plot(column(rows, "pressure") * 1e-6, column(rows, "area") / cell, **style)
        for kind, forces, states in curves(surface, column(rows, "separation")):
            share = [float(np.sum(np.pi * np.array(surface["radii"]) * np.maximum(state.approach, 0)))
                     for state in states]
            label, color, line = KINDS[kind]
            axes.plot(forces / cell * 1e-6, np.array(share) / cell, line, color=color,
                      label=label if first else None)
        own = column(program, "external_force") / cell * 1e-6, column(program, "contact_area") / cell
        axes.plot(*own, label="program" if first else None, **OWN)
    axes.set(xscale="log", yscale="log", xlabel="mean pressure (MPa)", ylabel="share in contact")
    axes.set_title("(d) contact area over load")
    axes.legend()


def spheres(axes, parts, programs):
    """Total force with the adhesion of Maugis."""
    for (name, surface), color in zip(parts.items(), (BLUE, GREEN)):
        rows, unit = surface["states"], np.pi * surface["work_of_adhesion"] * surface["radii"][0]
        at = column(rows, "separation") * 1e9
        style = {**BEM, "color": color, "label": f"boundary elements, {name}"}
        axes.errorbar(at, column(rows, "force") / unit, column(rows, "force_error") / unit, **style)
        for kind, line in (("coupled", "-"), ("independent", ":")):
            states = [adhesive_state(surface, row["separation"], kind == "coupled") for row in rows]
            forces = [float(state.force.sum()) / unit for state in states]
            axes.plot(at, forces, line, color=color, label=f"{kind}, {name}")
        axes.plot(at, column(programs[name], "external_force") / unit, **OWN)
    axes.set(xlabel="separation (nm)", ylabel="total force / π w R",
             title="(f) spheres with Maugis's adhesion")
    axes.legend()


def draw(fixture, substrate):
    def own(surface, rows, law):
        return program_states(PROGRAM, surface, column(rows, "separation").tolist(), law, substrate)

    parts, adhesive = fixture["paraboloids"], fixture["adhesive"]
    # The program takes two asperities and more.
    programs = {name: own(part, part["states"], "gw") for name,
                part in parts.items() if len(part["heights"]) > 1}
    sticking = {name: own(part, part["states"], "md_kim") for name, part in adhesive.items()}
    summits, rows = fixture["map"]["summits"], fixture["map"]["states"][:3]
    on_map, (thirty, hundreds) = own(summits, rows, "gw"), (parts["thirty"], parts["two hundred"])
    figure = Figure(figsize=(11.0, 6.6))
    axes = figure.subplots(2, 3)
    ends = [row["separation"] for row in thirty["states"]]
    force_over_separation(axes[0, 0], thirty, thirty["states"], programs["thirty"],
                          np.linspace(ends[0], ends[-1], 12))
    errors(axes[0, 1], parts, programs)
    loads(axes[0, 2], hundreds, hundreds["states"][1], programs["two hundred"][1])
    areas(axes[1, 0], {"30 asperities": (thirty, thirty["states"], programs["thirty"]),
                       "the shipped map": (summits, rows, on_map)})  # fmt: skip
    force_over_separation(axes[1, 1], summits, rows, on_map, column(rows, "separation"))
    spheres(axes[1, 2], adhesive, sticking)
    axes[0, 0].set_title("(a) 30 asperities")
    axes[1, 1].set_title("(e) the shipped map, and its summits")
    return figure


if __name__ == "__main__":
    parser = options(__doc__, DOCS / "referee.png")
    parser.add_argument("--substrate", default="", metavar="TOML", help="more of the table [substrate]")
    arguments = parser.parse_args()
    with context():
        draw(json.loads(FILE.read_text()), arguments.substrate).savefig(arguments.output, dpi=arguments.dpi)
