"""From a map to its asperities: rows, plane, filter, summits, and what they do not meet."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from .. import files, quantities
from ..errors import SceneError
from .ellipsoids import Shape, shape
from .lengths import PIXELS, length
from .level import (
    LEVELS,
    ROWS,
    SMALLEST,
    Grid,
    fitted,
    flaws,
    levelled,
    offset_lines,
    raised_by_rows,
    rows_levelled,
)
from .reading import HeightMap
from .smooth import cutoff_series, smoothed
from .spectrum import Equivalent, Moments, equivalent, moments
from .summits import Measured, Summits, apart, measured, prominent, summits

__all__ = [
    "ANISOTROPIC",
    "FEWEST_PIXELS",
    "KURTOSIS",
    "SKEWNESS",
    "AtCutoff",
    "Steps",
    "Surface",
    "check_outputs",
    "far_from_theory",
    "found_on",
    "grid_of",
    "steps_of",
    "wrong_unit",
]

# Endings of pictures.
PICTURES = (".png", ".pdf", ".svg")
# Largest height of either sign, m.
_HIGHEST = 1e6
# Roundings of the largest height within which heights are equal: levelling does not keep them apart.
_ROUNDINGS = 64.0
# Most cut-offs of a series: a page has no room for more.
_MOST_CUTOFFS = 100
# Fewer pixels from one maximum of a profile to the next leave summits unresolved; fewer summits their
# density.
FEWEST_PIXELS, _FEWEST_SUMMITS = 10.0, 100
# Skewness and excess kurtosis of heights that are far from Gaussian, ratio of slopes of a lay, least α.
SKEWNESS, KURTOSIS, ANISOTROPIC, _LEAST_ALPHA = 0.3, 0.6, 1.5, 1.5
# Root mean square slopes of surfaces, torn ones and polished optics included, and of most surfaces.
_SLOPES, _USUAL_SLOPES = (1e-7, 10.0), (1e-4, 1.0)


@dataclass(frozen=True)
class Steps:
    """What is done to a map on the way to its asperities; lengths in m, None where a step is left out."""

    level: str = "plane"
    level_rows: str | None = None
    smooth: float | None = None
    prominence: float | None = None
    min_distance: float | None = None
    cutoffs: int | None = None


@dataclass(frozen=True)
class AtCutoff:
    """Summits of a map that is smoothed with a cut-off, m: their number, the area searched, m², and what they
    are."""

    cutoff: float
    count: int
    area: float
    measured: Measured | None


@dataclass
class Surface:
    """A measured surface and what was found on it."""

    map: HeightMap
    steps: Steps
    #: As it was searched.
    grid: Grid
    missing: int
    summits: Summits
    #: Area that was searched, m².
    area: float
    moments: Moments
    shape: Shape
    series: list[AtCutoff] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    #: The map after each step that was done, by its name, if it is kept.
    stages: dict[str, Grid] = field(default_factory=dict)

    @property
    def measured(self) -> Measured:
        """Density and moments of the summits."""
        return measured(self.summits, self.area)

    @property
    def equivalent(self) -> Equivalent:
        """The asperities that follow from the moments."""
        return equivalent(self.moments)


def check_outputs(
    output: str | Path | None, figure: str | Path | None, *, force: bool, inputs: Sequence[str | Path]
) -> None:
    """Refuses names of a result and a picture that cannot be written, before anything is computed.

    Raises
    ------
    FileError
        The message says what is in the way.
    SceneError
        The picture is of no kind that is known.
    """
    if figure is not None and Path(figure).suffix.lower() not in PICTURES:
        raise SceneError(f"figure = {figure}: a name that ends with {', '.join(PICTURES)} is needed")
    for path in (output, figure):
        if path is not None:
            files.check(path, force=force, inputs=inputs)


def steps_of(
    level: str,
    level_rows: str | None,
    *,
    smooth: Any,
    prominence: Any,
    min_distance: Any,
    cutoffs: int | None,
) -> Steps:
    """The steps that arguments ask for.

    Raises
    ------
    SceneError
        One of them is wrong.
    """
    if level not in LEVELS:
        raise SceneError(f"level = {level!r}: known: {', '.join(LEVELS)}")
    if level_rows not in {None, *ROWS}:
        raise SceneError(f"level_rows = {level_rows!r}: known: {', '.join(ROWS)}")
    if cutoffs is not None and (isinstance(cutoffs, bool) or cutoffs not in range(2, _MOST_CUTOFFS + 1)):
        raise SceneError(f"cutoffs = {cutoffs}: a number from 2 to {_MOST_CUTOFFS} is needed")
    return Steps(
        level=level,
        level_rows=level_rows,
        smooth=_length("smooth", smooth, "a cut-off wavelength is above 0", lambda one: one > 0.0),
        prominence=_length(
            "prominence",
            prominence,
            "a prominence is between 0 and 1e6 m",
            lambda one: 0.0 <= one <= _HIGHEST,
        ),
        min_distance=_length("min_distance", min_distance, "a distance is above 0", lambda one: one > 0.0),
        cutoffs=None if cutoffs is None else int(cutoffs),
    )


def _length(name: str, value: Any, bound: str, fits: Callable[[float], bool]) -> float | None:
    """A length in m that fits its bound, from a number or a text with its unit."""
    if value is None:
        return None
    found = length(name, value)
    if not (math.isfinite(found) and fits(found)):
        raise SceneError(f"{name} = {value!r}: {bound}")
    return found


def found_on(height_map: HeightMap, steps: Steps, called: str = "map", *, keep: bool = False) -> Surface:
    """Levels and smooths a map, and finds its asperities.

    Parameters
    ----------
    height_map : HeightMap
        The map.
    steps : Steps
        What is done to it.
    called : str
        What messages call it.
    keep : bool
        Whether the map after each step is kept.

    Raises
    ------
    SceneError
        The map is none, or steps are not possible on it.
    """
    try:
        return _found(height_map, steps, keep)
    except SceneError as error:
        # What is wrong with the map may be what was warned of.
        raise SceneError("; ".join([f"{called}: {error}", *height_map.warnings])) from None


def _found(height_map: HeightMap, steps: Steps, keep: bool) -> Surface:
    grid = grid_of(height_map)
    warnings = flaws(grid.heights)
    stages = {"as measured": grid} if keep else {}
    if steps.level_rows is not None:
        slopes = fitted(grid.heights, steps.level)
        before = grid.heights - slopes
        grid = _with(grid, rows_levelled(grid.heights, steps.level_rows, slopes))
        if keep:
            stages["rows levelled"] = grid
    warnings += offset_lines(grid.heights, ("rows", "columns") if steps.level_rows is None else ("columns",))
    grid = levelled(grid, steps.level)
    if steps.level_rows is not None:
        warnings += raised_by_rows(before, grid.heights)
    if keep:
        stages["levelled"] = grid
    series = _series(grid, steps)
    if steps.smooth is not None:
        grid = smoothed(grid, steps.smooth)
        if keep:
            stages["smoothed"] = grid
    of_profiles = moments(grid)
    found, area = summits(grid)
    if not len(found):
        raise SceneError("no pixel and no plateau is higher than all around: the map has no summit")
    all_prominent = prominent(grid, found, steps.prominence)
    if not len(all_prominent):
        least = quantities.si(steps.prominence, "m")
        most = float(prominent(grid, found, 0.0).prominence.max())
        raise SceneError(
            f"prominence = {least}: no summit has that; the most prominent one has {quantities.si(most, 'm')}"
        )
    kept = apart(grid, all_prominent, steps.min_distance)
    surface = Surface(
        height_map, steps, grid, missing=int(np.count_nonzero(np.isnan(grid.heights))), summits=kept,
        area=area, moments=of_profiles, shape=shape(kept), series=series, stages=stages,
    )  # fmt: skip
    surface.warnings = [*height_map.warnings, *_caveats(surface), *warnings]
    return surface


def grid_of(height_map: HeightMap) -> Grid:
    """The map, or the line scan of a single row, with what decides which heights are equal, if it is one.

    Raises
    ------
    SceneError
        It has too few heights, or ones or pixels that are too large or too small.
    """
    heights = height_map.heights
    rows, columns = heights.shape
    if rows == 1 and columns < SMALLEST:
        raise SceneError(f"the line scan has {quantities.counted(columns, 'height')}; at least {SMALLEST} are needed")
    if 1 < rows < SMALLEST or columns < SMALLEST:
        raise SceneError(
            f"the map has {rows} rows and {columns} columns; at least {SMALLEST} of each are needed"
        )
    for size in height_map.pixel:
        if not PIXELS[0] <= size <= PIXELS[1]:
            raise SceneError(f"a pixel of {size:e} m is outside 1e-13..1e3 m; check its unit")
    beyond = np.abs(heights) > _HIGHEST
    if beyond.any():
        row, column = (int(place[0]) for place in np.nonzero(beyond))
        raise SceneError(
            f"row {row + 1}, column {column + 1}: the height is {heights[row, column]:g} m; finite ones up "
            "to 1e6 m, and NaN where it is missing, are needed"
        )
    return _with(Grid(heights, height_map.pixel, 0.0), heights)


def _with(grid: Grid, heights: Any) -> Grid:
    largest = float(np.nanmax(np.abs(heights), initial=0.0))
    return Grid(heights, grid.pixel, _ROUNDINGS * float(np.finfo(float).eps) * largest)


def _series(grid: Grid, steps: Steps) -> list[AtCutoff]:
    """The summits of the levelled map over the cut-off, the cut-off of the map included."""
    if steps.cutoffs is None:
        return []
    series = []
    for cutoff in sorted(
        {*cutoff_series(grid, steps.cutoffs), *([] if steps.smooth is None else [steps.smooth])}
    ):
        smooth = smoothed(grid, cutoff)
        found, area = summits(smooth)
        if len(found):
            found = apart(smooth, prominent(smooth, found, steps.prominence), steps.min_distance)
        series.append(AtCutoff(cutoff, len(found), area, measured(found, area) if len(found) else None))
    return series


def _caveats(surface: Surface) -> Iterator[str]:
    """Assumptions of the parameters that the surface does not meet: number and consequence."""
    of, count = surface.moments, len(surface.summits)
    yield from (wrong := [*wrong_unit(math.sqrt(of.m2))])
    largest = max(surface.grid.pixel)
    # In a wrong unit radii are of no surface either.
    if (pixels := of.wavelength / largest) < FEWEST_PIXELS and not wrong:
        radius = quantities.number(surface.measured.radius / largest, 3)
        yield (
            f"{pixels:.1f} pixels from one maximum of a profile to the next, fewer than {FEWEST_PIXELS:g}: "
            f"pixels are too coarse for the summits, which have a radius of {radius} pixels"
        )
    if count < _FEWEST_SUMMITS:
        yield f"few summits ({count}): their density is uncertain by about {100.0 / math.sqrt(count):.0f} %"
    yield from _not_gaussian(of)
    ratio = of.slope_x / of.slope_y if of.slope_y else math.inf
    if not 1.0 / ANISOTROPIC <= ratio <= ANISOTROPIC:
        yield (
            f"mean square slopes along x and y differ {ratio:.2f} times: the parameters from moments are of "
            "isotropic surfaces"
        )
    yield from _narrow(of)


def far_from_theory(of: Moments) -> Iterator[str]:
    """Assumptions of the parameters from moments that a line scan does not meet."""
    yield from _not_gaussian(of)
    yield from _narrow(of)


def _not_gaussian(of: Moments) -> Iterator[str]:
    if abs(of.skewness) > SKEWNESS or abs(of.excess_kurtosis) > KURTOSIS:
        yield (
            f"heights are far from Gaussian (skewness {of.skewness:.2f}, excess kurtosis "
            f"{of.excess_kurtosis:.2f}), which the parameters from moments take for granted"
        )


def _narrow(of: Moments) -> Iterator[str]:
    if of.alpha < _LEAST_ALPHA:
        yield f"alpha = {of.alpha:.3f}, but that of a random isotropic surface is at least 1.5"


def wrong_unit(slope: float) -> Iterator[str]:
    """Slopes that no surface has, where heights or pixels are in a wrong unit, and the factor that would make
    them usual."""
    if _SLOPES[0] <= slope <= _SLOPES[1]:
        return
    powers = (12, 9, 6, 3, -3, -6, -9, -12)
    usual = [power for power in powers if _USUAL_SLOPES[0] <= slope * 10.0**power <= _USUAL_SLOPES[1]]
    advice = (
        f"; with heights 1e{usual[0]} times as high they would be {slope * 10.0 ** usual[0]:.1e}"
        if usual
        else ""
    )
    yield (
        f"slopes are {slope:.1e} on average, as on no surface: the unit of the heights or of the pixels is "
        f"wrong{advice}"
    )
