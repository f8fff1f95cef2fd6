"""Figures 1, 2 and 4 to 9 of the paper, the direct solution beside its fits."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from drawing import BLUE, DASH_DOT, DASHED, VERMILION, context

from paper.data import CASES, ENERGIES, NM, UN, Comparison, Program, contact_zone, fit_points, noncontact

GREEN, ORANGE, PURPLE, DOTTED = "#009E73", "#E69F00", "#CC79A7", (0, (1.2, 1.2))
SEPARATION, MN, MNM = r"separation $h$* = $h/\sigma$", 1e-3, 1e6
# Colour, line and width of a law; in grey, the lines tell them apart.
LAWS = {
    "hybrid": ("hybrid", BLUE, "-", 1.9),
    "emd": ("EMD", VERMILION, DASHED, 1.5),
    "isbl": ("ISBL", GREEN, DASH_DOT, 1.5),
    "sbl": ("SBL", ORANGE, (0, (7, 1.5, 1, 1.5, 1, 1.5)), 1.5),
    "jkr": ("JKR", ORANGE, (0, (7, 1.5, 1, 1.5, 1, 1.5)), 1.5),
    "idmt": ("IDMT", GREEN, DASH_DOT, 1.5),
    "fit:paper": ("hybrid with the paper's fits", "black", DOTTED, 1.4),
}
REGIMES = {
    "noncontact": (("noncontact",), BLUE, DASHED, 1.6),
    "lubricant": (("lubricant",), ORANGE, "-", 1.6),
    "elastic": (("elastic",), VERMILION, DASH_DOT, 1.6),
    "elastic-plastic, plastic": (("elastoplastic1", "elastoplastic2", "plastic"), GREEN, (0, (2.5, 1.2)), 1.6),
}
# Of what a case or a work of adhesion is drawn in, where several are in one panel.
SCENES = {"I": (GREEN, DASH_DOT), "II": (VERMILION, DASHED), "III": (BLUE, "-"),
          "0.04": (GREEN, DASH_DOT), "0.09": (VERMILION, DASHED), "0.14": (BLUE, "-")}
BAND = "shaded, where wider than the line: ± standard deviation of one replica"


def curve(axes: Axes, case: Comparison, law: str, unit: float, name: str = "adhesion_force",
          style: tuple | None = None) -> None:
    """The integral over h*, and the ensemble's scatter around it, where there is an ensemble."""
    label, color, line, width = style or LAWS[law]
    force = case.by_law(law, f"integral/{name}") / unit
    axes.plot(case.x, force, color=color, linestyle=line, linewidth=width, label=label)
    if "fit" not in law:
        std = case.by_law(law, f"ensemble/{name}_std") / unit
        axes.fill_between(case.x, force - std, force + std, facecolor=color, alpha=0.22, linewidth=0, zorder=1)


def named(case: Comparison, name: str) -> str:
    return rf"Case {name}, $\lambda$ = {case.lam:.2f}, $\psi$ = {case.psi:.2f}"


def panels(width: float, height: float, columns: int = 1, rows: int = 1, **grid: object) -> tuple[Figure, np.ndarray]:
    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **grid)


def legend_below(figure: Figure, axes: Axes, columns: int, note: str = "") -> None:
    """One legend for all panels, where it can hide no curve."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, title=note, title_fontsize=8)


def stress_inset(axes: Axes, place: tuple, radius: np.ndarray, stress: np.ndarray, title: str, unit: str) -> None:
    """Adhesive stress over the radius, both signs of it, as the sketches of the paper have it."""
    inset = axes.inset_axes(place)
    both = np.concatenate([-radius[::-1], radius])
    inset.fill_between(both, np.concatenate([stress[::-1], stress]), facecolor="0.85", edgecolor="black", linewidth=0.8)
    inset.set(xlabel="$r$ (nm)", ylabel=unit, ylim=(0, 1.25))
    inset.set_title(title, fontsize=8, loc="center")


def figure_1(program: Program, runs: dict) -> Figure:
    case = runs["II"]
    to_nm = float(case.attrs["radius_unit"]) / NM
    figure, ((left, right),) = panels(10, 4.2, 2)
    delta = np.concatenate([-case.delta_a * (1 - np.geomspace(1e-9, 0.1, 60)), np.linspace(-0.9 * case.delta_a, 2e-9,
                                                                                           300)])
    contact = program.sphere(case, "emd", delta)
    a = contact["contact_radius"]
    c, _ = contact_zone(case.lam, a, contact["delta"])
    left.plot(delta / NM, a * to_nm, color=BLUE, label="contact radius $a$")
    left.plot(delta / NM, c * to_nm, color=VERMILION, linestyle=DASHED, label="adhesive radius $c$")
    left.set(xlabel=r"approach $\delta$ (nm)", ylabel="radius (nm)", ylim=(0, None))
    left.set_title("(a) Contact (Maugis-Dugdale)")
    left.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    nearest = np.abs(delta).argmin()
    a0, c0 = a[nearest] * to_nm, c[nearest] * to_nm
    r = np.concatenate([np.linspace(0, a0 * (1 - 1e-9), 200), [a0, c0, c0]])
    inside = 2 / np.pi * np.arctan(np.sqrt((c0**2 - a0**2) / np.maximum(a0**2 - r[:200] ** 2, 1e-12)))
    stress_inset(left, (0.56, 0.17, 0.42, 0.32), r, np.concatenate([inside, [1, 1, 0]]),
                 r"adhesive stress at $\delta$ = 0", r"$\sigma(r)/\sigma_0$")
    z = np.geomspace(1.005, 6.0, 1500)
    c, delta, _ = noncontact(case.lam, z)
    outermost = delta > np.maximum.accumulate(np.append(delta, -np.inf)[::-1])[::-1][1:]
    h0 = z * case.spacing / NM
    right.plot(h0, c * to_nm, color="0.45", linestyle=DOTTED, label="not reached on approach")
    right.plot(h0, np.where(outermost & (delta < -case.delta_a / case.length), c * to_nm, np.nan), color=VERMILION,
               label="adhesive radius $c$, reached on approach")
    lowest = c.argmin()
    right.plot(h0[lowest], c[lowest] * to_nm, "o", color="black", markerfacecolor="white", markersize=5,
               label=f"smallest $c$ at $h_0$ = {z[lowest]:.2f} $Z_0$")
    right.set(xlabel="separation $h_0$ at the centre (nm)", ylabel="adhesive radius $c$ (nm)", ylim=(0, None),
              xlim=(0.16, 1.22))
    right.set_title("(b) Before contact")
    right.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    zone = np.array([0, c[lowest], c[lowest]]) * to_nm
    stress_inset(right, (0.54, 0.62, 0.42, 0.30), zone, np.array([1, 1, 0]), "adhesive stress at the smallest $c$",
                 r"$\sigma(r)/\sigma(h_0)$")
    return figure


def figure_2(program: Program, runs: dict) -> Figure:
    figure, (row,) = panels(11, 3.7, 3)
    for axes, name, letter, (low, high) in zip(row, CASES, "abc", [(-0.6, 1.0), (-1.0, 1.5), (-1.5, 2.5)]):
        case = runs[name]
        near = np.geomspace(1e-9, 0.05, 40)  # the approaches around first touch, relative
        delta = np.concatenate([np.linspace(low * NM, high * NM, 1200), -case.delta_a * (1 - near),
                                -case.delta_a * (1 + near)])
        delta.sort()
        for law in ("emd", "idmt", "jkr"):
            sphere = program.sphere(case, law, delta, "retraction" if law == "jkr" else "approach")
            force = np.where((law == "jkr") & (sphere["branch"] != "contact"), np.nan, sphere["adhesion_force"])
            label, color, line, width = LAWS[law]
            color, line, width = (BLUE, "-", 1.9) if law == "emd" else (color, line, width)
            axes.plot(delta / NM, force / UN, color=color, linestyle=line, linewidth=width, label=label,
                      zorder=3 if law == "emd" else 2)
        axes.axvline(0, color="0.75", linewidth=0.7, zorder=0)
        axes.set(xlabel=r"approach $\delta$ (nm)", ylim=(0, None))
        axes.set_title(rf"({letter}) Case {name}, $\lambda$ = {case.lam:.2f}")
    row[0].set_ylabel("adhesion force of one sphere (µN)")
    legend_below(figure, row[0], 3)
    return figure


def figure_4(_: Program, runs: dict) -> Figure:
    figure, ((axes,),) = panels(6.2, 4.6)
    for law in ("emd", "sbl", "isbl"):
        curve(axes, runs["III"], law, MN, style=("EMD", BLUE, "-", 1.9) if law == "emd" else None)
    label, *style = LAWS["fit:paper"]
    curve(axes, runs["III"], "fit:paper", MN, style=("EMD with the paper's fits", *style))
    axes.set(xlabel=SEPARATION, ylabel="adhesion force (mN)", xlim=(0, 7), ylim=(0, 330))
    axes.set_title(named(runs["III"], "III"))
    legend_below(figure, axes, 4, BAND)
    return figure


def figure_5(_: Program, runs: dict) -> Figure:
    figure, (row,) = panels(11.5, 4.2, 3)
    for axes, name, letter in zip(row, CASES, "abc"):
        case = runs[name]
        for law in ("hybrid", "emd", "isbl", "fit:paper"):
            curve(axes, case, law, MN)
        axes.set(xlabel=SEPARATION, ylabel="adhesion force (mN)", xlim=(0, 7))
        axes.set_ylim(0, 1.05 * case.by_law("hybrid", "integral/adhesion_force")[case.x >= 0].max() / MN)
        axes.set_title(f"({letter}) {named(case, name)}")
        onset_inset(axes, case, 5.0 if name == "III" else 3.0)
    legend_below(figure, row[0], 4, BAND)
    return figure


def onset_inset(axes: Axes, case: Comparison, start: float) -> None:
    """The same curves before contact, where a linear axis shows none."""
    inset = axes.inset_axes((0.45, 0.42, 0.54, 0.53))
    for law in ("hybrid", "emd", "isbl", "fit:paper"):
        _, color, line, width = LAWS[law]
        inset.plot(case.x, case.by_law(law, "integral/adhesion_force") / UN, color=color, linestyle=line,
                   linewidth=0.8 * width)
    shown = (case.x >= start - 1) & (case.x <= 8)
    forces = case.by_law("hybrid", "integral/adhesion_force")[shown] / UN
    inset.set(yscale="log", xlim=(start - 1, 8), ylim=(0.6 * forces.min(), 2 * forces.max()))
    inset.axvline(start, color="0.6", linewidth=0.7, zorder=0)
    inset.set_title(f"onset, line at $h$* = {start:g} (µN)", fontsize=8, loc="right", pad=3)


def figure_6(_: Program, runs: dict) -> Figure:
    case = runs["II"]
    figure, ((axes,),) = panels(7, 4.8)
    inset = axes.inset_axes((0.47, 0.38, 0.52, 0.52))
    for where, unit, width in ((axes, MN, 1.0), (inset, UN, 0.8)):
        total = case.by_law("hybrid", "integral/adhesion_force") / unit
        where.plot(case.x, total, color="black", linewidth=1.9 * width, label="all")
        std = case.by_law("hybrid", "ensemble/adhesion_force_std") / unit
        where.fill_between(case.x, total - std, total + std, facecolor="0.5", alpha=0.25, linewidth=0, zorder=1)
        for label, (names, color, line, thick) in REGIMES.items():
            where.plot(case.x, case.regime("hybrid", *names) / unit, color=color, linestyle=line,
                       linewidth=thick * width, label=label)
        fits = case.regime("fit:paper", "noncontact") / unit
        where.plot(case.x, fits, color="black", linestyle=DOTTED, linewidth=1.2 * width,
                   label="noncontact with the paper's fits")
    axes.set(xlabel=SEPARATION, ylabel="adhesion force (mN)", xlim=(0, 7), ylim=(0, 39))
    axes.set_title(named(case, "II"))
    inset.set(yscale="log", xlim=(3, 6), ylim=(2, 2000))
    inset.set_title("before contact (µN)", fontsize=8, loc="right", pad=3)
    legend_below(figure, axes, 3, BAND)
    return figure


def external(axes: Axes, case: Comparison, name: str, unit: float, law: str = "hybrid") -> None:
    color, line = SCENES[name]
    label = f"case {name}" if name in CASES else rf"$\Delta\gamma$ = {name} J/m$^2$"
    curve(axes, case, law, unit, "external_force", style=(label, color, line, 1.8))


def fit_curve(axes: Axes, case: Comparison, law: str, unit: float, label: str = "",
              name: str = "external_force") -> None:
    axes.plot(case.x, case.by_law(law, f"integral/{name}") / unit, color="black", linestyle=DOTTED, linewidth=1.3,
              label=label)


def stiffness(case: Comparison, law: str) -> np.ndarray:
    return np.gradient(case.by_law(law, "integral/external_force"), case.h, edge_order=2)


def figure_7(_: Program, runs: dict) -> Figure:
    figure, (row,) = panels(11, 4.8, 2)
    insets = {"II": (0.52, 0.07, 0.47, 0.27), "I": (0.44, 0.60, 0.55, 0.32)}
    for axes, letter in zip(row, "ab"):
        draw = draw_external if letter == "a" else draw_stiffness
        for name in reversed(CASES):
            draw(axes, runs[name], name, 1e-3 if letter == "a" else 1e6)
        axes.plot([], [], color="black", linestyle=DOTTED, linewidth=1.3, label="with the paper's fits")
        axes.axvline(2e-9 / runs["III"].sigma, color="0.55", linewidth=0.8, zorder=0, label="$h$ = 2 nm of case III")
        axes.axhline(0, color="0.6", linewidth=0.6, zorder=0)
        axes.set_xlabel(SEPARATION)
        small_cases(axes, runs, letter, insets if letter == "a" else None)
    row[0].set(xlim=(0, 8), ylim=(-135, 135), ylabel="external force, compressive positive (mN)")
    row[1].set(xlim=(0, 8), ylim=(-45, 190), ylabel=r"stiffness $dF/dh$ (MN/m)")
    row[0].set_title("(a) External force")
    row[1].set_title("(b) Stiffness of the external force")
    legend_below(figure, row[0], 5, BAND.replace("shaded", "shaded in (a)"))
    return figure


def draw_external(axes: Axes, case: Comparison, name: str, unit: float) -> None:
    external(axes, case, name, unit)
    fit_curve(axes, case, "fit:paper", unit, "_")


def draw_stiffness(axes: Axes, case: Comparison, name: str, unit: float) -> None:
    color, line = SCENES[name]
    axes.plot(case.x, stiffness(case, "hybrid") / unit, color=color, linestyle=line, linewidth=1.8,
              label=f"case {name}")
    axes.plot(case.x, stiffness(case, "fit:paper") / unit, color="black", linestyle=DOTTED, linewidth=1.3)


def small_cases(axes: Axes, runs: dict, letter: str, places: dict | None) -> None:
    """Cases I and II in insets: beside case III they are lines along zero."""
    places = places or {"II": (0.58, 0.69, 0.41, 0.24), "I": (0.58, 0.36, 0.41, 0.22)}
    shown = {("a", "II"): (UN, "µN", (2, 5), (-900, 300)), ("a", "I"): (UN, "µN", (4.5, 8), (-4, 2)),
             ("b", "II"): (1e3, "kN/m", (2, 5), (-100, 420)), ("b", "I"): (1.0, "N/m", (4.5, 8), (-5, 35))}
    for name, place in places.items():
        unit, sign, x, y = shown[letter, name]
        inset = axes.inset_axes(place)
        (draw_external if letter == "a" else draw_stiffness)(inset, runs[name], name, unit)
        inset.axhline(0, color="0.6", linewidth=0.6, zorder=0)
        inset.set(xlim=x, ylim=y)
        inset.set_title(f"case {name} ({sign})", fontsize=8, loc="right", pad=3)


def figure_8(_: Program, runs: dict) -> Figure:
    figure, ((axes,),) = panels(6.5, 4.8)
    for name in ENERGIES:
        external(axes, runs[name], name, MN)
    for name in ENERGIES:
        case = runs[name]
        axes.plot(case.place("hybrid", "pull_off"), -case.number("hybrid", "pull_off_force") / MN, "o", color="black",
                  markerfacecolor="white", markersize=5, zorder=4, label="pull-off" if name == "0.04" else "_")
    axes.axhline(0, color="0.6", linewidth=0.6, zorder=0)
    axes.set(xlabel=SEPARATION, ylabel="external force, compressive positive (mN)", xlim=(0.5, 6), ylim=(-42, 30))
    axes.set_title(r"Surface of case III, $\sigma$ = 0.6541 nm")
    legend_below(figure, axes, 3, BAND)
    return figure


def figure_9(program: Program, runs: dict) -> Figure:
    figure, grid = panels(11, 5.6, 3, 2, height_ratios=[2.2, 1], sharex="col")
    case = runs["II"]
    titles = {"f_snc": "(a) Adhesion before contact $f_{snc}$", "f_sel": "(b) Adhesion in contact $f_{sel}$",
              "f_f": "(c) External force $f_f$"}
    for column, (force, title) in enumerate(titles.items()):
        top, bottom = grid[:, column]
        delta, direct, paper = fit_points(program, case, "fit:paper", force)
        top.plot(delta / NM, direct / UN, color=BLUE, linewidth=1.9, label="direct solution")
        top.plot(delta / NM, paper / UN, color="black", linestyle=DOTTED, linewidth=1.5,
                 label="the paper's fit (Table 3)")
        bottom.plot(delta / NM, 100 * (paper - direct) / np.abs(direct).max(), color="black", linestyle=DOTTED,
                    linewidth=1.3)
        bottom.axhspan(-1, 1, facecolor="0.9", zorder=0)
        bottom.axhline(0, color="0.6", linewidth=0.6, zorder=0)
        bottom.set_xlabel(r"approach $\delta$ (nm)")
        bottom.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
        top.set_title(title)
    grid[0, 0].set_ylabel("force of one sphere (µN)")
    grid[1, 0].set_ylabel("fit − direct\n(% of the largest force)")
    legend_below(figure, grid[0, 0], 3, "grey: the paper's ±1 %")
    return figure


def draw_all(program: Program, runs: dict, dpi: int) -> None:
    for number, draw in {1: figure_1, 2: figure_2, 4: figure_4, 5: figure_5, 6: figure_6, 7: figure_7, 8: figure_8,
                         9: figure_9}.items():
        with context():
            draw(program, runs).savefig(program.folder / f"figure_{number}.png", dpi=dpi)
