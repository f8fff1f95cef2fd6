"""The figure of a search: what was found at each value that was tried."""

from __future__ import annotations

import xarray
from matplotlib.figure import Figure

from ..errors import FileError
from ..plot.style import BLUE, GREY, VERMILION, dressed, inches, label, scaled

__all__ = ["draw"]


@dressed
def draw(result: xarray.Dataset, width: str | float = "90mm") -> Figure:
    """The probability, or the force, at each value of the number that was searched, and the value that was found.

    Parameters
    ----------
    result : xarray.Dataset
        The file of `stiction design`.
    width : str or float
        Such as ``85mm``, or mm.

    Raises
    ------
    FileError
        It is of one probability or one number of forces, which have no figure.
    """
    if "value" not in result.dims:
        raise FileError("this is one answer, not a search: it has no figure; `stiction info` says it")
    key, unit = str(result.attrs["key"]), str(result["value"].attrs["units"])
    factor, written = scaled(unit, result["value"].values)
    wide = inches(width)
    figure = Figure(figsize=(wide, 0.75 * wide))
    ax = figure.subplots()
    at = result["value"].values / factor
    if "probability" in result:
        error = result["probability_standard_error"].values
        seen = result["probability"].values > 0.0
        ax.errorbar(at[seen], result["probability"].values[seen], error[seen], fmt="o", color=BLUE, capsize=2)
        ax.set_yscale("log")
        ax.axhline(float(result.attrs["wanted"]), color=GREY, linewidth=0.8)
        ax.set_ylabel(f"probability of {result.attrs['event']}")
    else:
        scale, newtons = scaled("N", result["force"].values)
        ax.plot(at, result["force"].values / scale, "o-", color=BLUE)
        ax.set_ylabel(label("pull-off force", newtons))
    ax.axvline(float(result.attrs["found"]) / factor, color=VERMILION, linewidth=0.8)
    low, high = (float(end) / factor for end in result.attrs["interval"])
    ax.axvspan(low, high, color=VERMILION, alpha=0.2, linewidth=0)
    ax.set_xlabel(label(key.rsplit(".", 1)[-1].replace("_", " "), written))
    return figure
