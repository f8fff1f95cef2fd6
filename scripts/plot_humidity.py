"""Faces in moist air: force and energy of their adhesion, and what of them is wet, over the relative humidity.

Draws a result of `stiction run configs/humidity.toml`:
(a) pull-off per nominal area of the expected curve (the integral), with every bridge by itself and with liquid that fills gaps where bridges merge, and the energy to part the faces
    (the integral of the external force over the separation where it pulls), with the upper limit that DelRio et al. state, Appl. Phys. Lett. 90
    (2007) 163104;
(b) shares of wet asperities and of the covered area at pull-off.

Usage:
    python scripts/plot_humidity.py humidity.h5 [-o OUT.png] [--dpi N]

The picture goes to docs/humidity.png unless -o says otherwise; the numbers that are drawn are printed.
Exit codes: 0 done; 2 the file cannot be read, or the picture not written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "h5netcdf>=1.3", "matplotlib>=3.8", "pandas>=2.1", "xarray>=2024.10"]
# ///

import argparse
import sys
from pathlib import Path

import h5py
import numpy as np
from matplotlib.figure import Figure

from drawing import BLUE, DASHED, GREEN, VERMILION, context, panel

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 144e-3  # J/m^2, of the abstract


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs" / "humidity.png")
    parser.add_argument("--dpi", type=int, default=150)
    arguments = parser.parse_args()
    try:
        with h5py.File(arguments.file) as file:
            humidity = file["capillary_relative_humidity"][:]
            area = file["nominal_area"][0]
            separation = file["integral/separation"][:]
            pull = -file["integral/external_force"][:]
            alone = pull - file["capillary/spread_force"][:]
            wet, covered = file["capillary/wet_share"][:], file["capillary/covered_share"][:]
    except (OSError, KeyError) as error:
        print(f"{arguments.file}: {error}", file=sys.stderr)
        return 2
    separation = np.broadcast_to(separation, alone.shape)
    energies = [[np.trapezoid(np.maximum(row, 0), h) / area for row, h in zip(forces, separation)] for forces in (alone, pull)]
    places = pull.argmax(axis=1)
    at = np.arange(len(humidity))
    print("humidity, pull-off/A_n of bridges and of all liquid (MPa), energy of both (mJ/m^2), wet, covered")
    for i in at:
        print(f"{humidity[i]:.2f}  {alone[i].max() / area / 1e6:8.3f} {pull[i].max() / area / 1e6:8.3f}  {1e3 * energies[0][i]:8.2f} "
              f"{1e3 * energies[1][i]:8.2f}  {wet[i, places[i]]:.4f}  {covered[i, places[i]]:.4f}")
    with context():
        figure = Figure(figsize=(6.7, 2.8))
        figure.set_layout_engine("none")
        first, second = panel(figure, 0.6, 0.5, 2.35, 2.0), panel(figure, 4.1, 0.5, 2.35, 2.0)
        twin = first.twinx()
        first.semilogy(humidity, alone.max(axis=1) / area / 1e6, color=BLUE, linestyle=DASHED)
        first.semilogy(humidity, pull.max(axis=1) / area / 1e6, "o-", color=BLUE, markersize=3)
        twin.semilogy(humidity, 1e3 * np.array(energies[0]), color=VERMILION, linestyle=DASHED)
        twin.semilogy(humidity, 1e3 * np.array(energies[1]), "s-", color=VERMILION, markersize=3)
        twin.axhline(1e3 * LIMIT, color=VERMILION, linewidth=0.8, linestyle="dotted")
        first.set(xlabel="relative humidity", title="(a) dashed: every bridge by itself")
        first.set_ylabel("pull-off per area (MPa)", color=BLUE)
        twin.set_ylabel("energy (mJ/m²)", color=VERMILION)
        second.plot(humidity, wet[at, places], "o-", color=BLUE, markersize=3, label="wet asperities")
        second.plot(humidity, covered[at, places], "s-", color=GREEN, markersize=3, label="covered area")
        second.set(xlabel="relative humidity", ylabel="share", ylim=(0, 1), title="(b) at pull-off")
        second.legend(frameon=False)
        try:
            figure.savefig(arguments.output, dpi=arguments.dpi)
        except OSError as error:
            print(f"{arguments.output}: {error}", file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
