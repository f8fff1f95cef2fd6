"""Scripts that draw for the documentation share this: the style of this checkout's package, panels, runs."""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

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
    "PINK", "PROGRAM", "ROOT", "SHADES", "VERMILION", "VERDICTS", "column", "context", "digits", "dressed",
    "factor_and_unit",
    "inches", "legend", "lettered", "open_run", "options", "rounded", "run", "save",
    "si",
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


def digits(value, count = 3):
    """Significant digits, without a power of ten."""
    if value == 0.0 or not np.isfinite(value):
        return f"{value:g}"
    return f"{value:.{max(count - 1 - int(np.floor(np.log10(abs(value)))), 0)}f}"


def rounded(value, error):
    """A value and its standard error with one digit of the error, with two where it begins with 1."""
    decimals = max(-int(np.floor(np.log10(error / 2))), 0)
    return f"{value:.{decimals}f}".replace("-", "−"), f"{error:.{decimals}f}"


def save(figure, path, dpi = 200, numbers = None):
    """Leaves a picture. Numbers that it shows and its page states are kept in an SVG by their names, as texts,
    where doc_figures.py reads them."""
    drawn = picture(figure, path.suffix, dpi)
    if path.suffix == ".svg" and numbers:
        note = f"<!-- numbers: {json.dumps(numbers, ensure_ascii=False)} -->\n</svg>"
        drawn = drawn.replace(b"</svg>", note.encode("utf-8"))
    path.write_bytes(drawn)
