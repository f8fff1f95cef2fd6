"""The picture of referee.py: boundary elements against coupled asperities, independent ones, and the program where it is given."""

import sys
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, ScalarFormatter
from measurement import STYLE
from referee import adhesive_state, program_states, states_of

KINDS = {"point": ("point forces", "#0072B2", "-"), "contact": ("and the next orders", "#009E73", "--"),
         "independent": ("independent", "#D55E00", ":")}
BEM = {"color": "black", "marker": "o", "linestyle": "none", "markersize": 5, "markerfacecolor": "none"}
PROGRAM = {"color": "#CC79A7", "marker": "x", "linestyle": "none", "markersize": 6}


def column(states: list, name: str) -> np.ndarray:
    return np.array([state[name] for state in states])


def curves(surface: dict, separations) -> dict:
    return {kind: states_of(surface, list(separations), kind) for kind in KINDS}


def of_program(program: Path | None, surface: dict, separations, law: str, substrate: str) -> list | None:
    """What the program says, or None where it is not given or refuses the surface, which is told."""
    if program is None:
        return None
    try:
        return program_states(program.resolve(), surface, list(separations), law, substrate)
    except ValueError as error:
        print(f"plot_referee: the program refuses: {error}", file=sys.stderr)
        return None


def force_over_separation(axes: Axes, surface: dict, rows: list, program: list | None, separations, title: str) -> None:
    """Mean pressure, or force, over the separation of the mean planes."""
    scale = 1e-6 / surface["cell"] ** 2
    axes.plot(column(rows, "separation") * 1e9, column(rows, "pressure") * 1e-6, label="boundary elements", **BEM)
    for kind, states in curves(surface, separations).items():
        label, colour, line = KINDS[kind]
        forces = [float(state.force.sum()) * scale for state in states]
        axes.plot(np.array(separations) * 1e9, forces, line, color=colour, label=label)
    if program is not None:
        axes.plot(column(rows, "separation") * 1e9, column(program, "external_force") * scale, label="program", **PROGRAM)
    axes.set(yscale="log", xlabel="separation (nm)", ylabel="mean pressure (MPa)", title=title)
    axes.yaxis.set_major_formatter(ScalarFormatter())
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.legend()


def errors(axes: Axes, parts: dict, programs: dict) -> None:
    """Relative error of the total force at the separation of the referee, over the share in contact."""
    markers = dict(zip(parts, "osD^"))
    for name, surface in parts.items():
        rows = surface["states"]
        share = column(rows, "area") / surface["cell"] ** 2
        for kind, states in curves(surface, column(rows, "separation")).items():
            off = [abs(float(state.force.sum()) / row["force"] - 1) for state, row in zip(states, rows)]
            axes.plot(share, off, KINDS[kind][2], color=KINDS[kind][1], marker=markers[name], markersize=4, linewidth=0.8,
                      label=name if kind == "point" else None)
        if programs.get(name) is not None:
            axes.plot(share, np.abs(column(programs[name], "external_force") / column(rows, "force") - 1), **PROGRAM)
    axes.set(xscale="log", yscale="log", xlabel="share of the area in contact", ylabel="relative error of the total force",
             title="(b) error at the same separation")
    axes.legend(title="asperities")


def loads(axes: Axes, surface: dict, row: dict, program: dict | None) -> None:
    """Load of each asperity against that of the referee."""
    true = np.array(row["loads"])
    for kind, states in curves(surface, [row["separation"]]).items():
        found = states[0].force.astype(float)
        touched = found > 0
        axes.plot(true[touched] * 1e6, (found - true)[touched] / true.max(), "o", color=KINDS[kind][1], markersize=3, label=KINDS[kind][0])
    if program is not None:
        touched = program["loads"] > 0
        axes.plot(true[touched] * 1e6, (program["loads"] - true)[touched] / true.max(), label="program", **{**PROGRAM, "markersize": 4})
    axes.set(xlabel="load of an asperity (µN)", ylabel="difference over the largest load",
             title=f"(c) loads of 200 asperities at {row['pressure'] * 1e-6:g} MPa")
    axes.set_yscale("symlog", linthresh=1e-4)
    axes.axhline(0, color="grey", linewidth=0.6)
    axes.set_xlim(right=1.5e6 * true.max())
    axes.legend(loc="center right")


def areas(axes: Axes, surfaces: dict) -> None:
    """Share in contact over the mean pressure of surfaces by name: asperities, states of the referee, states of the program."""
    for (name, (surface, rows, program)), marker in zip(surfaces.items(), "os"):
        cell = surface["cell"] ** 2
        axes.plot(column(rows, "pressure") * 1e-6, column(rows, "area") / cell, label=f"boundary elements, {name}", **{**BEM, "marker": marker})
        for kind, states in curves(surface, column(rows, "separation")).items():
            pressure = [float(state.force.sum()) / cell * 1e-6 for state in states]
            share = [float(np.sum(np.pi * np.array(surface["radii"]) * np.maximum(state.approach, 0))) / cell for state in states]
            axes.plot(pressure, share, KINDS[kind][2], color=KINDS[kind][1], label=KINDS[kind][0] if marker == "o" else None)
        if program is not None:
            axes.plot(column(program, "external_force") / cell * 1e-6, column(program, "contact_area") / cell,
                      label="program" if marker == "o" else None, **PROGRAM)
    axes.set(xscale="log", yscale="log", xlabel="mean pressure (MPa)", ylabel="share in contact", title="(d) contact area over load")
    axes.legend()


def spheres(axes: Axes, parts: dict, programs: dict) -> None:
    """Total force with the adhesion of Maugis."""
    for (name, surface), colour in zip(parts.items(), ("#0072B2", "#009E73")):
        rows = surface["states"]
        unit = np.pi * surface["work_of_adhesion"] * surface["radii"][0]
        at = column(rows, "separation") * 1e9
        axes.errorbar(at, column(rows, "force") / unit, column(rows, "force_error") / unit, label=f"boundary elements, {name}",
                      **{**BEM, "color": colour})
        for coupled, line in ((True, "-"), (False, ":")):
            found = [float(adhesive_state(surface, row["separation"], coupled).force.sum()) / unit for row in rows]
            axes.plot(at, found, line, color=colour, label=f"{'coupled' if coupled else 'independent'}, {name}")
        if programs.get(name) is not None:
            axes.plot(at, column(programs[name], "external_force") / unit, **PROGRAM)
    axes.set(xlabel="separation (nm)", ylabel="total force / π w R", title="(f) spheres with Maugis's adhesion")
    axes.legend()


def draw(fixture: dict, program: Path | None, substrate: str, output: Path) -> None:
    parts, whole, adhesive = fixture["paraboloids"], fixture["map"], fixture["adhesive"]
    programs = {name: of_program(program, part, column(part["states"], "separation").tolist(), "gw", substrate) for name, part in parts.items()}
    sticking = {name: of_program(program, part, column(part["states"], "separation").tolist(), "md_kim", substrate)
                for name, part in adhesive.items()}
    summits = of_program(program, whole["summits"], column(whole["states"], "separation").tolist(), "gw", substrate)
    with rc_context(STYLE):
        figure = Figure(figsize=(13.5, 8.0), layout="constrained")
        axes = figure.subplots(2, 3)
        thirty, hundreds = parts["thirty"], parts["two hundred"]
        low, high = thirty["states"][-1]["separation"], thirty["states"][0]["separation"]
        force_over_separation(axes[0, 0], thirty, thirty["states"], programs["thirty"], np.linspace(high, low, 12).tolist(),
                              "(a) 30 asperities")
        errors(axes[0, 1], parts, programs)
        told = programs["two hundred"]
        loads(axes[0, 2], hundreds, hundreds["states"][1], told and told[1])
        rows = whole["states"][:3]
        areas(axes[1, 0], {"30 asperities": (thirty, thirty["states"], programs["thirty"]),
                           "the shipped map": (whole["summits"], rows, summits and summits[:3])})
        force_over_separation(axes[1, 1], whole["summits"], rows, summits and summits[:3], column(rows, "separation").tolist(),
                              "(e) the shipped map, and its summits")
        spheres(axes[1, 2], adhesive, sticking)
        figure.savefig(output, dpi=150)
    print(output)
