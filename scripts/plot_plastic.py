"""How far plastic contacts are apart: pull-off of two rough surfaces that were pressed until some summits yielded.

Usage: python scripts/plot_plastic.py sweep_plastic.h5 [-o OUT.svg]      after `stiction run
configs/sweep_plastic.toml`

(a) external force of case I on approach and, by each plastic contact, on unloading: the integral;
(b) pull-off of cases I and II on both branches: mean over patches with two standard errors, and the integral.
"""

import h5py
import numpy as np
from drawing import BLUE, COLORS, DOCS, H_STAR, VERMILION, column, digits, dressed, legend, options, rounded, save

# The points of the scene: case I by each contact, then case II.
CASES, CONTACTS = {"I": "o", "II": "s"}, ["jg", "ke", "zmc", "tn"]
# Of a branch: how the names of its pull-off and of its force begin, its colour, its distance from its contact.
WAYS = {"approach": ("approach_", "", BLUE, -0.12), "unloading": ("", "retraction_", VERMILION, 0.12)}


def pull_offs(file):
    """Case, way, and by contact: mean over patches, its standard error, the integral's pull-off, µN."""
    scalars = list(file["ensemble/scalar"].asstr()[:])
    for row, case in enumerate(CASES):
        for way, (prefix, of_curve, *_) in WAYS.items():
            own = slice(row * len(CONTACTS), (row + 1) * len(CONTACTS)), scalars.index(f"{prefix}pull_off_force")
            mean, error = (1e6 * file[f"ensemble/scalar_controlled_{name}"][own] for name in ("mean", "standard_error"))
            yield case, way, mean, error, -1e6 * file[f"integral/{of_curve}external_force"][own[0]].min(axis=1)


def numbers(file):
    """By case and branch: of each contact the mean pull-off, its standard error and the integral's, µN."""
    return {f"{case} {way}": [text for mean, error, integral in zip(*values, strict=True)
                              for text in (*rounded(mean, error), digits(integral))]
            for case, way, *values in pull_offs(file)}  # fmt: skip


@dressed
def draw(file):
    figure, (curves, pulls) = column(3.0, 3.0)
    forces = {name: 1e6 * file[f"integral/{name}external_force"][:] for name in ("", "retraction_")}
    h_star = file["integral/h_star"][0]
    curves.plot(h_star, forces[""][0], color=BLUE, linestyle="dotted", label="approach")
    for i, contact in enumerate(CONTACTS):
        curves.plot(h_star, forces["retraction_"][i], color=COLORS[i + 1], label=f"unloading, {contact}")
    curves.axhline(0.0, color="0.8", lw=0.6, zorder=0)
    curves.set(xlim=(2.4, 6.0), ylim=(-4.0, 4.0), xlabel=H_STAR, ylabel="external force (µN)")
    for case, way, mean, error, integral in pull_offs(file):
        *_, color, offset = WAYS[way]
        x, style = np.arange(len(CONTACTS)) + offset, {"color": color, "marker": CASES[case], "ls": "none"}
        pulls.errorbar(x, mean, 2.0 * error, **style, label=f"case {case}, {way}")
        pulls.plot(x, integral, **style, mfc="none")
    pulls.plot([], [], "o", color="0.4", mfc="none", label="integral")
    pulls.set(yscale="log", xlabel="plastic contact", ylabel="pull-off force (µN)", xlim=(-0.5, len(CONTACTS) - 0.5))
    pulls.set_xticks(range(len(CONTACTS)), CONTACTS)
    legend(curves)
    legend(pulls)
    return figure


def main():
    parser = options(__doc__, DOCS / "plastic.svg")
    parser.add_argument("file")
    arguments = parser.parse_args()
    with h5py.File(arguments.file) as file:
        save(draw(file), arguments.output, arguments.dpi, numbers(file))


if __name__ == "__main__":
    main()
