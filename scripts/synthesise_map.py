"""Makes the shipped height map configs/maps/polished.txt, a synthetic surface as the program of a microscope
would export it.

An isotropic Gaussian surface, periodic, from white noise filtered in Fourier space to the power spectrum

    C(q) ~ (1 + (q / q0)^2)^-1.8 exp(-(q / q1)^2),    q0 = 2 pi / 1.5 um,  q1 = 2 pi / 0.24 um,

self-affine between the roll-off at q0 and the cut-off at q1, scaled to a standard deviation of 1.62 nm,
tilted by 2 nm per um as samples are, and rounded to picometres. 192 x 192 pixels on 5.76 x 5.76 um^2. No
measurement is in it.

Usage:
    python scripts/synthesise_map.py [-o OUT.txt]
"""

import argparse
from pathlib import Path

import numpy as np

MAP = Path(__file__).resolve().parents[1] / "configs" / "maps" / "polished.txt"
PIXELS, PIXEL = 192, 0.03  # um
ROLL_OFF, CUT_OFF = 2.0 * np.pi / 1.5, 2.0 * np.pi / 0.24  # 1/um
EXPONENT, STD, TILT, SEED = 1.8, 1.62, 2.0, 20260  # nm, nm/um


def heights():
    """Heights in nm, rows along y."""
    noise = np.random.Generator(np.random.PCG64(SEED)).standard_normal((PIXELS, PIXELS))
    q = 2.0 * np.pi * np.fft.fftfreq(PIXELS, PIXEL)
    q = np.hypot(q[:, None], q[None, :])
    amplitude = np.sqrt((1.0 + (q / ROLL_OFF) ** 2) ** -EXPONENT * np.exp(-((q / CUT_OFF) ** 2)))
    amplitude[0, 0] = 0.0
    surface = np.fft.ifft2(amplitude * np.fft.fft2(noise)).real
    return STD * surface / surface.std() + TILT * PIXEL * np.arange(PIXELS)[None, :]


def main():
    parser = argparse.ArgumentParser(description="Makes the shipped height map.")
    parser.add_argument("-o", "--output", type=Path, default=MAP, metavar="OUT.txt")
    output = parser.parse_args().output
    size = f"{PIXELS * PIXEL:.3f} µm"
    header = ["# Channel: Topography, synthetic (scripts/synthesise_map.py)", f"# Width: {size}",
              f"# Height: {size}",
              "# Value units: nm"]
    rows = ["\t".join(f"{height:.3f}" for height in row) for row in heights()]
    output.write_text("\n".join(header + rows) + "\n", encoding="utf-8")
    print(output)


if __name__ == "__main__":
    main()
