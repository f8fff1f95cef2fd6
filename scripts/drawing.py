"""Scripts that draw for the documentation share this: the style of this checkout's package, panels, runs."""

import argparse
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))

from matplotlib.figure import Figure

from stiction import open_run
from stiction.plot.style import (
    BLUE, COLORS, DASH_DOT, DASHED, GREEN, GREY, H_STAR, MARKERS, PINK, VERMILION, context, dressed, inches,
    legend, lettered, picture,
)
from stiction.quantities import factor_and_unit, si

__all__ = [
    "BLUE", "CASE_COLORS", "COLORS", "DASHED", "DASH_DOT", "DOCS", "Figure", "GREEN", "GREY", "H_STAR", "MARKERS",
    "PINK", "PROGRAM", "ROOT", "SHADES", "VERMILION", "VERDICTS", "column", "context", "dressed", "factor_and_unit",
    "inches", "legend", "lettered", "open_run", "options", "run", "save", "si",
]  # fmt: skip
DOCS = ROOT / "docs"
PROGRAM = Path(os.environ.get("STICTION") or ROOT / "target" / "release" / "stiction")
CASE_COLORS = {"I": GREEN, "II": VERMILION, "III": BLUE}
VERDICTS, SHADES = ("good", "a shift", "invalid"), ("#D5EBE2", "#FCEBC8", "#F3D3C4")


def options(about, output):
    """The command line of a script that leaves a picture: -o and --dpi."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=output, metavar="OUT", help=f"default: {output}")
    parser.add_argument("--dpi", type=int, default=200, metavar="N", help="dots per inch, default 200")
    return parser


def run(*arguments):
    """Runs the program, $STICTION or target/release/stiction."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr.strip())
    return done.stdout


def column(*heights):
    """A figure as wide as a phone, and its panels one below the other, with heights in inches and letters."""
    figure = Figure(figsize=(inches("95mm"), sum(heights)))
    panels = figure.subplots(len(heights), height_ratios=heights, squeeze=False)[:, 0]
    for place, axes in enumerate(panels):
        lettered(axes, place)
    return figure, panels


def save(figure, path, dpi = 200):
    path.write_bytes(picture(figure, path.suffix, dpi))
