"""Figures 1, 2 and 4 to 9 of the paper, the direct solution with the paper's fits."""

import numpy as np
from drawing import (
    BLUE, CASE_COLORS, COLORS, DASH_DOT, DASHED, GREEN, H_STAR, VERMILION, Figure, column, context, legend, save,
)

from paper.data import CASES, ENERGIES, NM, UN, contact_zone, fit_points, noncontact

MN, DOTTED = 1e-3, (0, (1.2, 1.2))
# Label, colour and line of a law; in grey the lines tell them apart.
LAWS = {
    "hybrid": ("hybrid", BLUE, "-"), "emd": ("EMD", VERMILION, DASHED), "isbl": ("ISBL", GREEN, DASH_DOT),
    "sbl": ("SBL", COLORS[4], (0, (7, 1.5, 1, 1.5, 1, 1.5))),
    "jkr": ("JKR", COLORS[4], (0, (7, 1.5, 1, 1.5, 1, 1.5))),
    "idmt": ("IDMT", GREEN, DASH_DOT), "fit:paper": ("hybrid with the paper's fits", "black", DOTTED),
}  # fmt: skip
REGIMES = {
    "noncontact": (("noncontact",), BLUE, DASHED), "lubricant": (("lubricant",), COLORS[4], "-"),
    "elastic": (("elastic",), VERMILION, DASH_DOT),
    "elastic-plastic, plastic": (("elastoplastic1", "elastoplastic2", "plastic"), GREEN, (0, (2.5, 1.2))),
}  # fmt: skip
ENERGY_STYLES = {"0.04": (GREEN, DASH_DOT), "0.09": (VERMILION, DASHED), "0.14": (BLUE, "-")}
BAND = "shaded, where wider than the line: ± standard deviation of one replica"


def panels(width, height, columns=1, rows=1):
    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False)


def legend_below(figure, axes, columns, note=""):
    """One legend for all panels, where it can hide no curve."""
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=columns, title=note)


def named(case, name):
    return rf"Case {name}, $\lambda$ = {case.lam:.2f}, $\psi$ = {case.psi:.2f}"


def curve(axes, case, law, unit, name="adhesion_force", style=None):
    """The integral over h*, and the ensemble's scatter around it, where there is an ensemble."""
    label, color, line = style or LAWS[law]
    force = case.by_law(law, f"integral/{name}") / unit
    axes.plot(case.x, force, color=color, linestyle=line, label=label)
    if "fit" not in law:
        std = case.by_law(law, f"ensemble/{name}_std") / unit
        axes.fill_between(case.x, force - std, force + std, facecolor=color, alpha=0.22, linewidth=0,
                          zorder=1)


def figure_1(program, runs):
    case = runs["II"]
    to_nm = case.radius / NM
    figure, ((left, right),) = panels(10, 4.2, 2)
    near = -case.delta_a * (1 - np.geomspace(1e-9, 0.1, 60))
    delta = np.concatenate([near, np.linspace(-0.9 * case.delta_a, 2e-9, 300)])
    contact = program.sphere(case, "emd", delta)
    c, _ = contact_zone(case.lam, contact["contact_radius"], contact["delta"])
    left.plot(delta / NM, contact["contact_radius"] * to_nm, color=BLUE, label="contact radius $a$")
    left.plot(delta / NM, c * to_nm, color=VERMILION, linestyle=DASHED, label="adhesive radius $c$")
    left.set(xlabel=r"approach $\delta$ (nm)", ylabel="radius (nm)", ylim=(0, None),
             title="(a) Contact (Maugis-Dugdale)")
    z = np.geomspace(1.005, 6.0, 1500)
    c, delta, _ = noncontact(case.lam, z)
    outermost = delta > np.maximum.accumulate(np.append(delta, -np.inf)[::-1])[::-1][1:]
    reached, lowest = outermost & (delta < -case.delta_a / case.length), c.argmin()
    h0, label = z * case.spacing / NM, f"smallest $c$ at $h_0$ = {z[lowest]:.2f} $Z_0$"
    right.plot(h0, c * to_nm, color="0.45", linestyle=DOTTED, label="not reached on approach")
    right.plot(h0, np.where(reached, c * to_nm, np.nan), color=VERMILION,
               label="adhesive radius $c$, reached on approach")
    right.plot(h0[lowest], c[lowest] * to_nm, "o", color="black", markerfacecolor="white", label=label)
    right.set(xlabel="separation $h_0$ at the centre (nm)", ylabel="adhesive radius $c$ (nm)")
    right.set(ylim=(0, None), xlim=(0.16, 1.22), title="(b) Before contact")
    for axes in (left, right):
        axes.legend()
    return figure


def figure_2(program, runs):
    figure, (row,) = panels(11, 3.7, 3)
    for axes, name, letter, (low, high) in zip(row, CASES, "abc", [(-0.6, 1.0), (-1.0, 1.5), (-1.5, 2.5)]):
        case = runs[name]
        near = np.geomspace(1e-9, 0.05, 40)  # the approaches around first touch, relative
        touch = [-case.delta_a * (1 + sign * near) for sign in (-1, 1)]
        delta = np.sort(np.concatenate([np.linspace(low * NM, high * NM, 1200), *touch]))
        for law in ("emd", "idmt", "jkr"):
            sphere = program.sphere(case, law, delta, "retraction" if law == "jkr" else "approach")
            force = np.where((law == "jkr") & (sphere["branch"] != "contact"), np.nan,
                             sphere["adhesion_force"])
            label, color, line = LAWS[law]
            axes.plot(delta / NM, force / UN, color=color, linestyle=line, label=label)
        axes.set(xlabel=r"approach $\delta$ (nm)", ylim=(0, None))
        axes.set_title(rf"({letter}) Case {name}, $\lambda$ = {case.lam:.2f}")
    row[0].set_ylabel("adhesion force of one sphere (µN)")
    legend_below(figure, row[0], 3)
    return figure


def figure_4(_, runs):
    figure, ((axes,),) = panels(6.2, 4.6)
    for law in ("emd", "sbl", "isbl"):
        curve(axes, runs["III"], law, MN)
    curve(axes, runs["III"], "fit:paper", MN, style=("EMD with the paper's fits", *LAWS["fit:paper"][1:]))
    axes.set(xlabel=H_STAR, ylabel="adhesion force (mN)", xlim=(0, 7), ylim=(0, 330),
             title=named(runs["III"], "III"))
    legend_below(figure, axes, 4, BAND)
    return figure


def figure_5(_, runs):
    """Below on a logarithmic axis, which shows what is before contact."""
    figure, grid = panels(11.5, 7.0, 3, 2)
    for pair, letter, name, start in zip(grid.T, "abc", CASES, (3.0, 3.0, 5.0)):
        case = runs[name]
        for axes, unit in zip(pair, (MN, UN)):
            for law in ("hybrid", "emd", "isbl", "fit:paper"):
                curve(axes, case, law, unit)
        force = case.by_law("hybrid", "integral/adhesion_force")
        pair[0].set(xlim=(0, 7), ylim=(0, 1.05 * force[case.x >= 0].max() / MN),
                      title=f"({letter}) {named(case, name)}")
        shown = force[(case.x >= start - 1) & (case.x <= 8)] / UN
        pair[1].set(yscale="log", xlim=(start - 1, 8), ylim=(0.6 * shown.min(), 2 * shown.max()),
                      xlabel=H_STAR)
        pair[1].axvline(start, color="0.6", linewidth=0.7, zorder=0)
        pair[1].set_title(f"before contact, line at $h^*$ = {start:g}")
    for axes, unit in zip(grid[:, 0], ("mN", "µN")):
        axes.set_ylabel(f"adhesion force ({unit})")
    legend_below(figure, grid[0, 0], 4, BAND)
    return figure


def figure_6(_, runs):
    case = runs["II"]
    figure, (row,) = panels(10, 4.6, 2)
    for axes, unit, sign in zip(row, (MN, UN), ("mN", "µN")):
        curve(axes, case, "hybrid", unit, style=("all", "black", "-"))
        for label, (names, color, line) in REGIMES.items():
            axes.plot(case.x, case.regime("hybrid", *names) / unit, color=color, linestyle=line, label=label)
        fits = case.regime("fit:paper", "noncontact") / unit
        axes.plot(case.x, fits, color="black", linestyle=DOTTED, label="noncontact with the paper's fits")
        axes.set(xlabel=H_STAR, ylabel=f"adhesion force ({sign})")
    row[0].set(xlim=(0, 7), ylim=(0, 39), title=named(case, "II"))
    row[1].set(xlim=(3, 6), ylim=(2, 2000), yscale="log", title="before contact")
    legend_below(figure, row[0], 3, BAND)
    return figure


def figure_7(_, runs):
    """The force of each case, and the slope of that; as narrow as the page that shows it."""
    figure, panels = column(*[2.1] * 6)
    limits = {"I": (UN, "µN", (4.5, 8), (-4, 2)), "II": (UN, "µN", (2, 5), (-900, 300)),
              "III": (MN, "mN", (0, 8), (-135, 135))}
    slopes = {"I": (1.0, "N/m", (-5, 35)), "II": (1e3, "kN/m", (-100, 420)), "III": (1e6, "MN/m", (-45, 190))}
    for (top, bottom), (name, (unit, sign, x, y)) in zip(panels.reshape(3, 2), limits.items()):
        case, (slope, of_slope, z) = runs[name], slopes[name]
        styles = {"hybrid": (f"case {name}", CASE_COLORS[name], "-"),
                  "fit:paper": ("with the paper's fits", "black", DOTTED)}
        for law, style in styles.items():
            curve(top, case, law, unit, "external_force", style)
            force = case.by_law(law, "integral/external_force")
            bottom.plot(case.x, np.gradient(force, case.h, edge_order=2) / slope, color=style[1], linestyle=style[2])
        for axes in (top, bottom):
            axes.axhline(0, color="0.6", linewidth=0.6, zorder=0)
        top.set(xlim=x, ylim=y, xlabel=H_STAR, ylabel=f"external force ({sign})")
        bottom.set(xlim=x, ylim=z, xlabel=H_STAR, ylabel=f"stiffness $dF/dh$ ({of_slope})")
        legend(top)
    bottom.axvline(2e-9 / runs["III"].sigma, color="0.55", linewidth=0.8, zorder=0, label="$h$ = 2 nm")
    legend(bottom)
    return figure


def figure_8(_, runs):
    figure, ((axes,),) = panels(6.5, 4.8)
    for name in ENERGIES:
        case = runs[name]
        curve(axes, case, "hybrid", MN, "external_force",
              (rf"$\Delta\gamma$ = {name} J/m$^2$", *ENERGY_STYLES[name]))
        place, label = case.place("hybrid", "pull_off"), "pull-off" if name == "0.04" else "_"
        force = -case.number("hybrid", "pull_off_force") / MN
        axes.plot(place, force, "o", color="black", markerfacecolor="white", zorder=4, label=label)
    axes.axhline(0, color="0.6", linewidth=0.6, zorder=0)
    axes.set(xlabel=H_STAR, ylabel="external force, compressive positive (mN)", xlim=(0.5, 6),
             ylim=(-42, 30))
    axes.set_title(r"Surface of case III, $\sigma$ = 0.6541 nm")
    legend_below(figure, axes, 4, BAND)
    return figure


def figure_9(program, runs):
    figure, grid = panels(11, 5.6, 3, 2)
    titles = {"f_snc": "(a) Adhesion before contact $f_{snc}$", "f_sel": "(b) Adhesion in contact $f_{sel}$",
              "f_f": "(c) External force $f_f$"}  # fmt: skip
    for (top, bottom), (force, title) in zip(grid.T, titles.items()):
        delta, direct, paper = fit_points(program, runs["II"], "fit:paper", force)
        top.plot(delta / NM, direct / UN, color=BLUE, label="direct solution")
        top.plot(delta / NM, paper / UN, color="black", linestyle=DOTTED, label="the paper's fit (Table 3)")
        bottom.plot(delta / NM, 100 * (paper - direct) / np.abs(direct).max(), color="black",
                    linestyle=DOTTED)
        bottom.axhspan(-1, 1, facecolor="0.9", zorder=0)
        bottom.set_xlabel(r"approach $\delta$ (nm)")
        top.set_title(title)
    grid[0, 0].set_ylabel("force of one sphere (µN)")
    grid[1, 0].set_ylabel("fit − direct\n(% of the largest force)")
    legend_below(figure, grid[0, 0], 2, "grey: the paper's ±1 %")
    return figure


FIGURES = {1: figure_1, 2: figure_2, 4: figure_4, 5: figure_5, 6: figure_6, 7: figure_7, 8: figure_8,
           9: figure_9}


def draw_all(program, runs):
    for number, draw in FIGURES.items():
        with context():
            save(draw(program, runs), program.folder / f"figure_{number}.svg")
