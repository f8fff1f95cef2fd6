"""External force of one elastic asperity over its approach, for several λ, with the limits DMT and JKR.

Usage: python scripts/plot_elastic.py [-o OUT.svg]      a second

(a) on approach, with the attraction before contact; (b) on retraction, where contacts end later.
"""

import io

import numpy as np
from drawing import COLORS, DASH_DOT, DASHED, DOCS, column, dressed, legend, options, run, save

LAMBDAS = (0.1, 0.5, 1.0, 3.0)
APPROACH = np.linspace(-4.0, 2.0, 601)


def force(law, path, lambda_):
    """External force over πRΔγ at the approaches."""
    numbers = [f"{delta:.3f}" for delta in APPROACH]
    csv = run("asperity", "--law", law, "--lambda", lambda_, "--path", path, "--delta", *numbers)
    return np.genfromtxt(io.StringIO(csv), delimiter=",", names=True, usecols="external_force")["external_force"]


@dressed
def draw():
    figure, panels = column(2.6, 2.6)
    for axes, path in zip(panels, ("approach", "retraction")):
        for color, lambda_ in zip(COLORS, LAMBDAS):
            axes.plot(APPROACH, force("emd", path, lambda_), color=color, label=f"λ = {lambda_:g}")
        axes.plot(APPROACH, force("dmt", path, 0.1), color="black", linestyle=DASHED, linewidth=0.9, label="DMT")
        axes.plot(APPROACH, force("jkr", path, 3.0), color="black", linestyle=DASH_DOT, linewidth=0.9, label="JKR")
        axes.axhline(0.0, color="0.8", linewidth=0.7, zorder=0)
        axes.set(xlim=(-4.0, 2.0), ylim=(-2.2, 1.0), xlabel="approach $\\Delta$", ylabel="external force $\\hat{F}$")
        axes.set_title(f"On {path}", loc="right")
    legend(panels[0], columns=3)
    return figure


if __name__ == "__main__":
    arguments = options(__doc__, DOCS / "elastic.svg").parse_args()
    save(draw(), arguments.output, arguments.dpi)
