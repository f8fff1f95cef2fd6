"""Faces in moist air: pull-off and energy of their adhesion, and what of them is wet, over the relative
humidity.

Usage: python scripts/plot_humidity.py humidity.h5 [-o OUT.svg]      after `stiction run
configs/humidity.toml`

(a) pull-off of the expected curve per nominal area, with every bridge by itself and with the liquid that
    fills gaps;
(b) the energy to part the faces, and its upper limit of DelRio et al., Appl. Phys. Lett. 90 (2007) 163104;
(c) shares of wet asperities and of the covered area at pull-off. The numbers are printed.
"""

import h5py
import numpy as np
from drawing import BLUE, DASH_DOT, DOCS, GREEN, VERMILION, column, dressed, legend, options, save

LIMIT = 144.0  # mJ/m^2, of the abstract


@dressed
def draw(humidity, pull_offs, energies, shares):
    figure, (force, energy, share) = column(2.3, 2.3, 2.3)
    for axes, (alone, merged) in [(force, pull_offs), (energy, energies)]:
        axes.semilogy(humidity, merged, "o-", color=BLUE, markersize=3, label="with liquid that fills gaps")
        axes.semilogy(humidity, alone, color=VERMILION, linestyle=DASH_DOT, label="every bridge by itself")
    energy.axhline(LIMIT, color="black", linewidth=0.8, linestyle="dotted",
                   label="measured upper limit, 144 mJ/m²")
    force.set(ylabel="pull-off per area (MPa)")
    energy.set(ylabel="energy per area (mJ/m²)")
    share.plot(humidity, shares[0], "o-", color=BLUE, markersize=3, label="wet asperities")
    share.plot(humidity, shares[1], "s-", color=GREEN, markersize=3, label="area covered by bridges")
    share.set(ylabel="share at pull-off", ylim=(0, 1))
    for axes in (force, energy, share):
        axes.set(xlabel="relative humidity")
        legend(axes)
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
    save(draw(humidity, pull_offs, energies, shares), arguments.output, arguments.dpi)


if __name__ == "__main__":
    main()
