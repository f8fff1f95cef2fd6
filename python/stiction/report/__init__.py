"""Pages to mail: one HTML file that holds all of a result, or of several side by side, and the command `stiction report`.

The page needs no network: style, figures and the numbers behind them are in it.
"""

from .page import page, write

__all__ = ["page", "write"]
