"""A figure of sweeps over two keys: a number of each point as a colour."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from .. import quantities
from ..errors import FileError
from ..results import Sweep
from .style import INVALID, dressed, label, legend, new_axes, plain, scaled
from .sweep import QUANTITIES, axes_of, invalid_points, of_points

__all__ = ["heat_map", "is_map"]

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

    Raises
    ------
    FileError
        There is no such quantity or key, or other than two keys vary.
    """
    if quantity not in QUANTITIES:
        raise FileError(f"quantity = {quantity}: known are {', '.join(QUANTITIES)}")
    across, along = axes_of(result, x, by)
    varying = [str(name) for name, size in result.points.sizes.items() if size > 1]
    if along is None or result.attrs["sweep_mode"] != "grid" or {across, along} != set(varying):
        raise FileError(f"a heat map is of a grid in which two keys vary; here vary {', '.join(varying) or 'none'}")
    mean, _, _ = of_points(result, quantity)
    values = mean.squeeze(drop=True).transpose(along, across)
    words, unit, _ = QUANTITIES[quantity]
    factor, sign = scaled(unit, values) if unit not in ("", "%") else (1.0, unit)
    ax = new_axes(ax)
    cells = values.values / factor
    mesh = ax.pcolormesh(cells, cmap="viridis", edgecolors="face", linewidth=0.0)
    figure = ax.get_figure()
    assert figure is not None
    figure.colorbar(mesh, ax=ax, label=label(words, sign))
    if cells.size <= _WRITTEN:
        middle = 0.5 * (np.nanmin(cells) + np.nanmax(cells))
        for (row, column), value in np.ndenumerate(cells):
            color = "white" if value < middle else "black"
            text = "–" if np.isnan(value) else quantities.number(float(value), 3)
            ax.text(column + 0.5, row + 0.5, text, ha="center", va="center", color=color, fontsize="x-small")
    invalid = invalid_points(result).squeeze(drop=True).transpose(along, across).values
    hatched = [Rectangle((column, row), 1.0, 1.0, fill=False, hatch="///", linewidth=0.0, label=INVALID) for row, column in np.argwhere(invalid)]
    for cell in hatched:
        ax.add_patch(cell)
    if hatched:
        legend(ax, hatched[:1])
    for name, axis in ((across, ax.xaxis), (along, ax.yaxis)):
        key = result[name]
        axis.set_ticks(np.arange(key.size) + 0.5, [plain(result.key_text(name, value, 3)) for value in key.values])
        axis.set_label_text(plain(str(key.attrs.get("long_name", name))))
    ax.tick_params(axis="x", labelrotation=30.0)
    return ax
