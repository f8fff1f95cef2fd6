"""Boundary elements (referee.py) against coupled asperities, independent ones and the program: two pictures.

Usage: python scripts/plot_referee.py [-o FOLDER] [--substrate TOML]

referee.svg            Hertz contacts: pressure, error of the total force, single loads
referee_surfaces.svg   area in contact, the shipped map, spheres with adhesion

The program runs on these surfaces; --substrate is more of its table, such as 'kernel = "contact"'.
"""

import json

import numpy as np
from drawing import (
    BLUE, DASH_DOT, DASHED, DOCS, GREEN, PINK, PROGRAM, VERMILION, column, dressed, legend, options, save,
)
from matplotlib.ticker import NullFormatter, ScalarFormatter
from referee import FILE, adhesive_state, program_states, states_of

KINDS = {"point": ("coupled, point forces", BLUE, "-"), "contact": ("coupled, next orders", GREEN, DASHED),
         "independent": ("independent", VERMILION, DASH_DOT)}  # fmt: skip
BEM = {"color": "black", "marker": "o", "linestyle": "none", "markerfacecolor": "none"}
OWN = {"color": PINK, "marker": "x", "linestyle": "none"}


def values(states, name):
    return np.array([state[name] for state in states])


def curves(surface, separations):
    """Total forces of the asperities, and their states, by kind."""
    for kind in KINDS:
        states = states_of(surface, list(separations), kind)
        yield kind, np.array([float(state.force.sum()) for state in states]), states


def force_over_separation(axes, surface, rows, program, separations):
    scale = 1e-6 / surface["cell"] ** 2
    axes.plot(values(rows, "separation") * 1e9, values(rows, "pressure") * 1e-6, label="boundary elements",
              **BEM)
    for kind, forces, _ in curves(surface, separations):
        label, color, line = KINDS[kind]
        axes.plot(np.array(separations) * 1e9, forces * scale, linestyle=line, color=color, label=label)
    axes.plot(values(rows, "separation") * 1e9, values(program, "external_force") * scale, label="program",
              **OWN)
    axes.set(yscale="log", xlabel="separation (nm)", ylabel="mean pressure (MPa)")
    axes.yaxis.set_major_formatter(ScalarFormatter())
    axes.yaxis.set_minor_formatter(NullFormatter())


def errors(axes, parts, programs):
    """Relative error of the total force at the separation of the referee, over the share in contact."""
    for (name, surface), marker in zip(parts.items(), "osD^"):
        rows = surface["states"]
        share, true = values(rows, "area") / surface["cell"] ** 2, values(rows, "force")
        for kind, forces, _ in curves(surface, values(rows, "separation")):
            style = {"color": KINDS[kind][1], "linestyle": KINDS[kind][2], "marker": marker}
            axes.plot(share, np.abs(forces / true - 1), **style, label=NAMES[name] if kind == "point" else None)
        if name in programs:
            axes.plot(share, np.abs(values(programs[name], "external_force") / true - 1), **OWN)
    axes.set(xscale="log", yscale="log", xlabel="fraction of the area in contact",
             ylabel="relative error of the total force")
    legend(axes)


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
    axes.set_yscale("symlog", linthresh=1e-4)
    axes.axhline(0, color="grey", linewidth=0.6)


def areas(axes, surfaces):
    """Share in contact over the mean pressure, of surfaces by name: asperities, states of the referee and the
    program."""
    for (name, (surface, rows, program)), marker in zip(surfaces.items(), "os"):
        cell, first = surface["cell"] ** 2, marker == "o"
        style = {**BEM, "marker": marker, "label": name}
        axes.plot(values(rows, "pressure") * 1e-6, values(rows, "area") / cell, **style)
        for kind, forces, states in curves(surface, values(rows, "separation")):
            share = [float(np.sum(np.pi * np.array(surface["radii"]) * np.maximum(state.approach, 0)))
                     for state in states]
            label, color, line = KINDS[kind]
            axes.plot(forces / cell * 1e-6, np.array(share) / cell, linestyle=line, color=color,
                      label=label if first else None)
        own = values(program, "external_force") / cell * 1e-6, values(program, "contact_area") / cell
        axes.plot(*own, label="program" if first else None, **OWN)
    axes.set(xscale="log", yscale="log", xlabel="mean pressure (MPa)", ylabel="fraction in contact")
    legend(axes)


def spheres(axes, parts, programs):
    """Total force with the adhesion of Maugis."""
    for (name, surface), color in zip(parts.items(), (BLUE, GREEN)):
        rows, unit = surface["states"], np.pi * surface["work_of_adhesion"] * surface["radii"][0]
        at = values(rows, "separation") * 1e9
        style = {**BEM, "color": color, "label": f"boundary elements, {name} spheres"}
        axes.errorbar(at, values(rows, "force") / unit, values(rows, "force_error") / unit, **style)
        for kind, line in (("coupled", "-"), ("independent", DASH_DOT)):
            states = [adhesive_state(surface, row["separation"], kind == "coupled") for row in rows]
            forces = [float(state.force.sum()) / unit for state in states]
            axes.plot(at, forces, linestyle=line, color=color, label=f"{kind}, {name} spheres")
        axes.plot(at, values(programs[name], "external_force") / unit, **OWN)
    axes.set(xlabel="separation (nm)", ylabel="total force / π w R")
    legend(axes, columns=1)


# The parts of the fixture by their names in legends.
NAMES = {"one": "1 paraboloid", "twelve": "12 paraboloids", "thirty": "30 paraboloids",
         "two hundred": "200 paraboloids"}  # fmt: skip


def own(surface, rows, law, substrate):
    return program_states(PROGRAM, surface, values(rows, "separation").tolist(), law, substrate)


@dressed
def draw_contacts(parts, programs):
    figure, axes = column(2.8, 2.6, 2.4)
    thirty, hundreds = parts["thirty"], parts["two hundred"]
    ends = [row["separation"] for row in thirty["states"]]
    force_over_separation(axes[0], thirty, thirty["states"], programs["thirty"],
                          np.linspace(ends[0], ends[-1], 12))
    legend(axes[0])
    errors(axes[1], parts, programs)
    loads(axes[2], hundreds, hundreds["states"][1], programs["two hundred"][1])
    return figure


@dressed
def draw_surfaces(fixture, programs, substrate):
    figure, axes = column(2.6, 2.2, 3.0)
    thirty, adhesive = fixture["paraboloids"]["thirty"], fixture["adhesive"]
    summits, rows = fixture["map"]["summits"], fixture["map"]["states"][:3]
    on_map = own(summits, rows, "gw", substrate)
    areas(axes[0], {"30 paraboloids": (thirty, thirty["states"], programs["thirty"]),
                    "the shipped map": (summits, rows, on_map)})  # fmt: skip
    force_over_separation(axes[1], summits, rows, on_map, values(rows, "separation"))
    sticking = {name: own(part, part["states"], "md_kim", substrate) for name, part in adhesive.items()}
    spheres(axes[2], adhesive, sticking)
    return figure


def main():
    parser = options(__doc__, DOCS)
    parser.add_argument("--substrate", default="", metavar="TOML", help="more of the table [substrate]")
    arguments = parser.parse_args()
    fixture = json.loads(FILE.read_text())
    parts = fixture["paraboloids"]
    # The program takes two asperities and more.
    programs = {name: own(part, part["states"], "gw", arguments.substrate) for name, part in parts.items()
                if len(part["heights"]) > 1}
    pictures = {"referee": draw_contacts(parts, programs),
                "referee_surfaces": draw_surfaces(fixture, programs, arguments.substrate)}  # fmt: skip
    for name, figure in pictures.items():
        save(figure, arguments.output / f"{name}.svg", arguments.dpi)


if __name__ == "__main__":
    main()
