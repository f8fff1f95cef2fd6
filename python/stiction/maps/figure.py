"""The picture of a map with its summits after each step on the way to its asperities."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import files
from .level import Grid
from .summits import Summits, summits
from .surface import Surface

__all__ = ["draw"]


def draw(path: str | Path, surface: Surface, *, force: bool, inputs: Iterable[str | Path]) -> None:
    """Draws the map as measured and after each step, each with its summits, and last the asperities that
    count.

    Parameters
    ----------
    path : path
        The picture, by its ending PNG, PDF or SVG.
    surface : Surface
        What was found, with the map after each step.
    force : bool
        Whether an existing picture is overwritten.
    inputs : iterable of paths
        Files that are never overwritten.
    """
    from matplotlib import pyplot

    from ..plot.others import draw_map
    from ..plot.style import context, inches, picture

    stages = _stages(surface)
    with context():
        columns = min(len(stages), 2)
        rows = -(-len(stages) // columns)
        figure, axes = pyplot.subplots(
            rows,
            columns,
            squeeze=False,
            layout="constrained",
            figsize=(inches(90 * columns), inches(75 * rows)),
        )
        for ax, (name, (grid, found)) in zip(axes.flat, stages.items(), strict=False):
            width, height = grid.pixel
            draw_map(ax, grid.heights, grid.pixel, ((found.column + 0.5) * width, (found.row + 0.5) * height))
            ax.set_title(f"{name}: {len(found)} {'summit' if len(found) == 1 else 'summits'}")
        for ax in axes.flat[len(stages) :]:
            ax.set_visible(False)
        drawn = picture(figure, Path(path).suffix)
        pyplot.close(figure)
    with files.writing(path, force=force, inputs=inputs) as part:
        part.write_bytes(drawn)


def _stages(surface: Surface) -> dict[str, tuple[Grid, Summits]]:
    """The map after each step with its summits; as measured it is less its mean, so that the steps are
    alike."""
    stages: dict[str, Any] = {name: (grid, summits(grid)[0]) for name, grid in surface.stages.items()}
    for name in ("as measured", "rows levelled"):
        if name in stages:
            grid, found = stages[name]
            stages[name] = (replace(grid, heights=grid.heights - np.nanmean(grid.heights)), found)
    words = {"prominence": "prominent", "min_distance": "apart"}
    chosen = [word for name, word in words.items() if getattr(surface.steps, name) is not None]
    if chosen:
        stages[" and ".join(chosen)] = (surface.grid, surface.summits)
    return stages
