"""Faces in moist air: pull-off and energy of their adhesion, and what of them is wet, over the relative
humidity.

Usage: python scripts/plot_humidity.py humidity.h5 [-o OUT.png]      after `stiction run
configs/humidity.toml`

(a) pull-off of the expected curve per nominal area, and the energy to part the faces, with every bridge by
    itself and with the liquid that fills gaps, and the upper limit of DelRio et al., Appl. Phys. Lett. 90
    (2007) 163104;
(b) shares of wet asperities and of the covered area at pull-off. The numbers are printed.
"""

import h5py
import numpy as np
from drawing import BLUE, DASHED, DOCS, GREEN, VERMILION, Figure, context, options, panel

LIMIT = 144.0  # mJ/m^2, of the abstract


def draw(humidity, pull_offs, energies, shares):
    figure = Figure(figsize=(6.7, 2.8), layout="none")
    first, second = panel(figure, 0.6, 0.5, 2.35, 2.0), panel(figure, 4.1, 0.5, 2.35, 2.0)
    twin = first.twinx()
    for axes, values, marker, color in [(first, pull_offs, "o", BLUE), (twin, energies, "s", VERMILION)]:
        axes.semilogy(humidity, values[0], color=color, linestyle=DASHED)
        axes.semilogy(humidity, values[1], f"{marker}-", color=color, markersize=3)
    twin.axhline(LIMIT, color=VERMILION, linewidth=0.8, linestyle="dotted")
    first.set(xlabel="relative humidity", title="(a) dashed: every bridge by itself")
    first.set_ylabel("pull-off per area (MPa)", color=BLUE)
    twin.set_ylabel("energy (mJ/m²)", color=VERMILION)
    second.plot(humidity, shares[0], "o-", color=BLUE, markersize=3, label="wet asperities")
    second.plot(humidity, shares[1], "s-", color=GREEN, markersize=3, label="covered area")
    second.set(xlabel="relative humidity", ylabel="share", ylim=(0, 1), title="(b) at pull-off")
    second.legend()
    return figure


def main():
    parser = options(__doc__, DOCS / "humidity.png")
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
