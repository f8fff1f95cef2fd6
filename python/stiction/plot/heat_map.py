"""A figure of sweeps over two keys: a number of each point as a colour."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from .. import quantities
from ..errors import FileError
from ..results import Sweep
from .style import INVALID, dressed, folded, is_noise, label, legend, new_axes, plain, scaled
from .sweep import QUANTITIES, axes_of, invalid_points, of_points, require, words_of

__all__ = ["heat_map", "is_map"]

# Positive numbers over more than this factor, one and a half decades, have logarithmic colours.
_DECADES = 10.0**1.5
# Most points whose numbers are written into their cells.
_WRITTEN = 64


def is_map(result: Sweep) -> bool:
    """Whether two keys of a grid have three values at least, and others one."""
    sizes = sorted(int(size) for size in result.points.sizes.values())
    return result.attrs["sweep_mode"] == "grid" and len(sizes) >= 2 and sizes[-2] >= 3 and all(size == 1 for size in sizes[:-2])


@dressed
def heat_map(
    result: Sweep,
    ax: Axes | None = None,
    *,
    quantity: str = "pull_off_force",
    x: str | None = None,
    by: str | None = None,
    preload: Any = None,
) -> Axes:
    """A number of each point of a grid over two keys: the mean over replicas, or the integral's without them.

    Parameters
    ----------
    result : Sweep
        A grid in which two keys vary.
    ax : matplotlib.axes.Axes, optional
    quantity : str
        As of `sweep`.
    x, by : str, optional
        The keys along and across; by default the first that varies, and the other one.
    preload : str or float, optional
        As of `sweep`.

    Raises
    ------
    FileError
        There is no such quantity or key, or other than two keys vary.
    SceneError
        The scene has no such preload.
    """
    require(quantity)
    across, along = axes_of(result, x, by)
    varying = [str(name) for name, size in result.points.sizes.items() if size > 1]
    if along is None or result.attrs["sweep_mode"] != "grid" or {across, along} != set(varying):
        raise FileError(f"a heat map is of a grid in which two keys vary; here vary {', '.join(varying) or 'none'}")
    mean, _, _ = of_points(result, quantity, preload)
    values = mean.squeeze(drop=True).transpose(along, across)
    unit = QUANTITIES[quantity].unit
    factor, sign = scaled(unit, values) if unit not in ("", "%") else (1.0, unit)
    ax = new_axes(ax)
    cells = values.values / factor
    mesh = ax.pcolormesh(cells, cmap="viridis", edgecolors="face", linewidth=0.0, norm=_colours(cells, quantity))
    figure = ax.get_figure()
    assert figure is not None
    figure.colorbar(mesh, ax=ax, label=folded(label(words_of(result, quantity, preload), sign)))
    if cells.size <= _WRITTEN:
        written: list[Text] = []
        colours, dark = mesh.to_rgba(cells), ~(np.ma.filled(mesh.norm(cells), 0.0) >= 0.5)
        for (row, column), value in np.ndenumerate(cells):
            text = "–" if np.isnan(value) else quantities.number(float(value), 3)
            # Its own background keeps a number readable in a hatched cell.
            behind = {"facecolor": colours[row, column], "linewidth": 0.0, "pad": 1.0}
            color = "white" if dark[row, column] and not np.isnan(value) else "black"
            written.append(ax.text(column + 0.5, row + 0.5, text, ha="center", va="center", color=color, fontsize="x-small", bbox=behind))
        if not _are_narrow(ax, written, cells.shape[1]):
            for one in written:
                one.remove()
    invalid = invalid_points(result).squeeze(drop=True).transpose(along, across).values
    hatched = [Rectangle((column, row), 1.0, 1.0, fill=False, hatch="///", linewidth=0.0, label=INVALID) for row, column in np.argwhere(invalid)]
    for cell in hatched:
        ax.add_patch(cell)
    if hatched:
        legend(ax, hatched[:1])
    for name, axis in ((across, ax.xaxis), (along, ax.yaxis)):
        key = result[name]
        is_choice = key.dtype.kind == "U"
        key_factor, key_sign = (1.0, "") if is_choice else scaled(str(key.attrs.get("units", "1")), key)
        texts = [plain(value) if is_choice else f"{float(f'{value / key_factor:.4g}'):g}" for value in key.values]
        axis.set_ticks(np.arange(key.size) + 0.5, texts)
        axis.set_label_text(folded(label(plain(str(key.attrs.get("long_name", name))), plain(key_sign))))
    if not _are_narrow(ax, ax.get_xticklabels(), cells.shape[1]):
        ax.tick_params(axis="x", labelrotation=40.0)
    return ax


def _are_narrow(ax: Axes, written: list[Text], columns: int) -> bool:
    """Whether each text is narrower than its cell, as wide as the panel is now."""
    # Some of a panel's width is taken by its labels and its bar of colours.
    room = 0.72 * ax.get_window_extent().width / columns
    return all(text.get_window_extent().width <= room for text in written)


def _colours(cells: Any, quantity: str) -> Normalize:
    """From 0 to 1 for a probability; logarithmic where positive numbers span more than one and a half decades; even where all are one number."""
    low, high = float(np.nanmin(cells)), float(np.nanmax(cells))
    if quantity == "stuck":
        return Normalize(0.0, 1.0)
    if is_noise(cells):
        return Normalize(low - abs(low), high + abs(high))
    return LogNorm(low, high) if low > 0.0 and high > _DECADES * low else Normalize(low, high)
