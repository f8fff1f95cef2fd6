"""Scripts that draw for the documentation share this: the style of this checkout's package, axes, runs."""

import argparse
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))

from matplotlib.figure import Figure

from stiction import open_run
from stiction.plot.style import BLUE, COLORS, DASH_DOT, DASHED, GREEN, MARKERS, VERMILION, context
from stiction.quantities import factor_and_unit, si

__all__ = [
    "BLUE", "COLORS", "DASHED", "DASH_DOT", "DOCS", "Figure", "GREEN", "MARKERS", "PROGRAM", "ROOT",
    "VERMILION", "context",
    "factor_and_unit", "open_run", "options", "panel", "run", "si",
]  # fmt: skip
DOCS = ROOT / "docs"
PROGRAM = Path(os.environ.get("STICTION") or ROOT / "target" / "release" / "stiction")


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


def panel(figure, left, bottom, width, height):
    """Axes at a place of a figure, inches."""
    w, h = figure.get_size_inches()
    return figure.add_axes((left / w, bottom / h, width / w, height / h))
