"""A measured surface as the terminal shows it, in lines of at most 80 columns."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .. import quantities
from ..rows import row
from .ellipsoids import forces_of_spheres
from .level import LEVELS, ROWS
from .moments import LineScan, in_numbers
from .surface import AtCutoff, Surface

__all__ = ["of_line", "summary"]

# Column in which texts begin.
_START = 20


def summary(surface: Surface, path: str | Path, output: Path | None = None) -> str:
    """What was found on a map.

    Parameters
    ----------
    surface : Surface
        It.
    path : path
        The file of the map.
    output : path, optional
        Where the result is.
    """
    parts = [[str(path), *_map(surface), *_found(surface)], _parameters(surface), _series(surface)]
    if output is not None:
        parts.append(iter([f"  {'written':<18}{output}"]))
    return "\n\n".join("\n".join(lines) for part in parts if (lines := list(part)))


def of_line(line: LineScan, path: str | Path) -> str:
    """The moments of a line scan, and the surface that has them."""
    of, theirs = line.moments, in_numbers(line.moments)
    m0, m2, m4 = (_power(value, 4) for value in (of.m0, of.m2, of.m4))
    shape = f"skewness {of.skewness:.3f}, excess kurtosis {of.excess_kurtosis:.3f}"
    rows = [
        ("line scan", f"{line.count} heights over {_m(line.length)}"),
        *([("missing", quantities.counted(line.missing, "height"))] if line.missing else []),
        ("levelled", "less the straight line of least squares"),
        ("heights", f"standard deviation {_m(math.sqrt(of.m0))}, {shape}"),
        ("moments", f"m0 = {m0} m^2, m2 = {m2}, m4 = {m4} /m^2, alpha = {_pure(of.alpha)}"),
        *(("warning", warning) for warning in line.warnings),
    ]
    parameters = [
        ("density", f"{_pure(1e-12 * theirs.density)} /um^2"),
        ("1/mean curvature", _m(theirs.radius)),
        ("mean height", _m(theirs.height_mean)),
        ("height std", _m(theirs.height_std)),
    ]
    parts = [
        [str(path), *(shown for row in rows for shown in _row(*row))],
        ["  the isotropic surface of these moments:", *(s for row in parameters for s in _row(*row))],
        ["  in a scene, below [surface]:", f"  {theirs.toml}"],
    ]
    return "\n\n".join("\n".join(lines) for lines in parts)


def _row(label: str, text: str) -> list[str]:
    return row(label, text, _START)


def _m(length: float) -> str:
    return quantities.si(length, "m")


def _power(value: float, digits: int) -> str:
    """A number in powers of ten; – for one that is not known."""
    if not math.isfinite(value):
        return "–"
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def _pure(value: float) -> str:
    return f"{value:.4f}" if 1e-2 <= abs(value) < 1e5 else _power(value, 3)


def _map(surface: Surface) -> Iterator[str]:
    grid, steps, of = surface.grid, surface.steps, surface.moments
    (rows, columns), (width, height) = grid.heights.shape, grid.pixel
    channel = f" ({surface.map.channel})" if surface.map.channel else ""
    yield from _row("map", f"{columns} x {rows} pixels of {_m(width)} x {_m(height)}{channel}")
    if surface.missing:
        yield from _row(
            "missing", f"{quantities.counted(surface.missing, 'height')}, {100.0 * surface.missing / grid.heights.size:.2f} %"
        )
    if steps.level_rows is not None:
        yield from _row("rows levelled", f"less the {ROWS[steps.level_rows]}")
    yield from _row("levelled", f"less the {LEVELS[steps.level]}")
    if steps.smooth is not None:
        down, along = grid.border
        left = f"{along} x {down} pixels along the border left out"
        yield from _row("smoothed", f"Gaussian, cut-off {_m(steps.smooth)}; {left}")
    shape = f"skewness {of.skewness:.3f}, excess kurtosis {of.excess_kurtosis:.3f}"
    yield from _row("heights", f"standard deviation {_m(math.sqrt(of.m0))}, {shape}")
    m0, m2, m4 = (_power(value, 4) for value in (of.m0, of.m2, of.m4))
    yield from _row("moments", f"m0 = {m0} m^2, m2 = {m2}, m4 = {m4} /m^2, alpha = {_pure(of.alpha)}")


def _found(surface: Surface) -> Iterator[str]:
    steps, count = surface.steps, len(surface.summits)
    text = f"{count} on {_power(surface.area, 4)} m^2"
    if steps.prominence is not None:
        text += f", prominent by {_m(steps.prominence)} or more"
    if steps.min_distance is not None:
        text += f", {_m(steps.min_distance)} or more from a higher one"
    yield from _row("asperities", text)
    yield from _shape(surface, count)
    for warning in surface.warnings:
        yield from _row("warning", warning)


def _shape(surface: Surface, count: int) -> Iterator[str]:
    """The deviation of the summits from the spheres of the laws, and its effect on their force."""
    of = surface.shape
    if not math.isfinite(of.ratio):
        return
    mean, geometric = (f"{100.0 * (share - 1.0):+.2f} %" for share in forces_of_spheres(of.ratio))
    yield from _row("shape", f"k1/k2 = {of.ratio:.2f}, median ratio of the principal curvatures")
    yield from _row("", "Hertz force of a sphere against such an ellipsoid's:")
    yield from _row("", f"{mean} with R = 1/mean curvature, {geometric} with sqrt(R1 R2)")
    if of.saddles:
        share = f"{of.saddles} of {count} ({100.0 * of.saddles / count:.1f} %)"
        yield from _row(
            "", f"{share} are saddles by second differences, k2 <= 0: spheres of their mean curvature"
        )


def _parameters(surface: Surface) -> Iterator[str]:
    """The parameters of an equivalent surface, counted and by theory, side by side."""
    ours, theirs = surface.measured, surface.equivalent

    def line(label: str, one: float, other: float, shown: Any) -> str:
        ratio = one / other if other else math.inf
        return f"  {label:<18}{shown(one):>18}{shown(other):>18}{ratio:>9.3f}"

    def density(value: float) -> str:
        return f"{_pure(1e-12 * value)} /um^2"

    yield f"  {'':<18}{'of summits':>18}{'of moments':>18}{'ratio':>9}"
    yield line("density", ours.density, theirs.density, density)
    yield line("1/mean curvature", ours.radius, theirs.radius, _m)
    found = surface.summits
    of_scenes = (("mean radius", "mean_curvature", found.radius), ("", "equivalent", found.equivalent_radius))
    for label, name, radii in of_scenes:
        yield f'  {label:<18}{_m(float(np.mean(radii))):>18}  R of a run: radius = "{name}"'
    yield line("mean height", ours.height_mean, theirs.height_mean, _m)
    yield line("height std", ours.height_std, theirs.height_std, _m)
    beta = [one.density * one.radius * one.height_std for one in (ours, theirs)]
    yield line("eta R sigma_s", beta[0], beta[1], _pure)


def _series(surface: Surface) -> Iterator[str]:
    """The parameters over the cut-off; the cut-off of the map has a mark."""
    if not surface.series:
        return
    yield f"  {'cut-off':<18}{'summits':>9}{'density':>18}{'1/mean curv.':>18}{'height std':>14}"
    for at in surface.series:
        mark = " *" if at.cutoff == surface.steps.smooth else ""
        density = f"{_pure(1e-12 * at.count / at.area) if at.area else '-'} /um^2"
        radius, std = (_of(at, name) for name in ("radius", "height_std"))
        yield f"  {_m(at.cutoff) + mark:<18}{at.count:>9}{density:>18}{radius:>18}{std:>14}"


def _of(at: AtCutoff, name: str) -> str:
    value = math.nan if at.measured is None else getattr(at.measured, name)
    return _m(value) if math.isfinite(value) else "-"
