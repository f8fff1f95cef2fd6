"""What the scripts that draw for the documentation have in common: the style of the Python package of this checkout, and axes at places."""

import sys
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from stiction import FileError, open_run
from stiction.plot.style import BLUE, DASH_DOT, DASHED, GREEN, VERMILION, context
from stiction.quantities import factor_and_unit, si

__all__ = ["BLUE", "DASHED", "DASH_DOT", "FileError", "GREEN", "VERMILION", "context", "factor_and_unit", "open_run", "panel", "si"]


def panel(figure: Figure, left: float, bottom: float, width: float, height: float, **shared: Axes) -> Axes:
    """Axes at a place of a figure, inches."""
    w, h = figure.get_size_inches()
    return figure.add_axes((left / w, bottom / h, width / w, height / h), **shared)
