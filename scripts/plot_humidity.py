"""Surfaces in humid air: pull-off, energy of adhesion, wet asperities and covered area over the relative
humidity.

Usage: python scripts/plot_humidity.py humidity.h5 [-o OUT.svg]      after `stiction run
configs/humidity.toml`

(a) pull-off of the expected curve per nominal area, with independent bridges and with the liquid that
    fills gaps;
(b) the energy to separate the surfaces, and its upper limit of DelRio et al., Appl. Phys. Lett. 90 (2007) 163104;
(c) fraction of wet asperities at pull-off; (d) fraction of the area that bridges cover.
"""

import h5py
import numpy as np
from drawing import BLUE, DASH_DOT, DOCS, VERMILION, column, digits, dressed, legend, options, save

LIMIT = 144.0  # mJ/m^2, of the abstract


@dressed
def draw(humidity, pull_offs, energies, shares):
    figure, (force, energy, *panels) = column(2.3, 2.3, 1.7, 1.7)
    for axes, (alone, merged) in [(force, pull_offs), (energy, energies)]:
        axes.semilogy(humidity, merged, "o-", color=BLUE, markersize=3, label="with liquid that fills gaps")
        axes.semilogy(humidity, alone, color=VERMILION, linestyle=DASH_DOT, label="independent bridges")
    energy.axhline(LIMIT, color="black", linewidth=0.8, linestyle="dotted",
                   label="measured upper limit, 144 mJ/m²")
    force.set(ylabel="pull-off per area (MPa)")
    energy.set(ylabel="energy per area (mJ/m²)")
    legend(force)
    legend(energy)
    for axes, share, word in zip(panels, shares, ("wet asperities", "area covered by bridges")):
        axes.plot(humidity, share, "o-", color=BLUE, markersize=3)
        axes.set(ylabel=word, ylim=(0, 1))
    for axes in (force, energy, *panels):
        axes.set(xlabel="relative humidity")
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
    # By humidity: pull-off of all liquid and of bridges, in kPa below 1 MPa, energy, wet and covered, %.
    numbers = {}
    for rh, bridges, whole, _, energy, *own in zip(humidity, *pull_offs, *energies, *shares):
        unit = 1.0 if whole >= 1.0 else 1e-3
        row = whole / unit, bridges / unit, energy, *(100.0 * share for share in own)
        numbers[f"{rh:g}"] = [digits(value, 2) for value in row]
    save(draw(humidity, pull_offs, energies, shares), arguments.output, arguments.dpi, numbers)


if __name__ == "__main__":
    main()
