"""Faces in moist air: pull-off and energy of their adhesion, and what of them is wet, over the relative
humidity.

Usage: python scripts/plot_humidity.py humidity.h5 [-o OUT.png]      after `stiction run
configs/humidity.toml`

(a) pull-off of the expected curve per nominal area, with every bridge by itself and with the liquid that
    fills gaps;
(b) the energy to part the faces, and its upper limit of DelRio et al., Appl. Phys. Lett. 90 (2007) 163104;
(c) shares of wet asperities and of the covered area at pull-off. The numbers are printed.
"""

import h5py
import numpy as np
from drawing import BLUE, DASHED, DOCS, GREEN, VERMILION, Figure, context, options, panel

LIMIT = 144.0  # mJ/m^2, of the abstract


def draw(humidity, pull_offs, energies, shares):
    figure = Figure(figsize=(4.2, 6.6), layout="none")
    force, energy, share = [panel(figure, 0.75, bottom, 3.3, 1.6) for bottom in (4.75, 2.6, 0.45)]
    for axes, (alone, merged) in [(force, pull_offs), (energy, energies)]:
        axes.semilogy(humidity, merged, "o-", color=BLUE, markersize=3, label="liquid fills gaps")
        axes.semilogy(humidity, alone, color=BLUE, linestyle=DASHED, label="every bridge by itself")
    energy.axhline(LIMIT, color=VERMILION, linewidth=0.8, linestyle="dotted")
    energy.annotate("144 mJ/m², measured upper limit", (0.4, LIMIT), xytext=(0, -3), color=VERMILION,
                    textcoords="offset points", va="top", fontsize="small")
    force.set(ylabel="pull-off per area (MPa)", title="(a)")
    force.legend()
    energy.set(ylabel="energy (mJ/m²)", title="(b)")
    share.plot(humidity, shares[0], "o-", color=BLUE, markersize=3, label="wet asperities")
    share.plot(humidity, shares[1], "s-", color=GREEN, markersize=3, label="covered area")
    share.set(xlabel="relative humidity", ylabel="share at pull-off", ylim=(0, 1), title="(c)")
    share.legend()
    return figure


def main():
    parser = options(__doc__, DOCS / "humidity.svg")
    parser.add_argument("file")
    arguments = parser.parse_args()
    with h5py.File(arguments.file) as file:
        humidity, area = file["capillary_relative_humidity"][:], file["nominal_area"][0]
        pull = -file["integral/external_force"][:]
        alone = pull - file["capillary/spread_force"][:]
        separation = np.broadcast_to(file["integral/separation"][:], alone.shape)
        places = np.arange(len(humidity)), pull.argmax(axis=1)
        shares = [file[f"capillary/{name}_share"][:][places] for name in ("wet", "covered")]
    pull_offs = [1e-6 * forces.max(axis=1) / area for forces in (alone, pull)]
    energies = [1e3 * np.trapezoid(np.maximum(forces, 0.0), separation, axis=1) / area
                for forces in (alone, pull)]
    print("humidity, pull-off/A_n of bridges and of all liquid (MPa), energy of both (mJ/m^2), wet, covered")
    print("\n".join(" ".join(f"{value:9.4g}" for value in row)
                    for row in zip(humidity, *pull_offs, *energies, *shares)))
    with context():
        draw(humidity, pull_offs, energies, shares).savefig(arguments.output, dpi=arguments.dpi)


if __name__ == "__main__":
    main()
