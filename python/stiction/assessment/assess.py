"""`stiction.assess_map`: one answer from one map, or from scans of several sizes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import files, quantities
from ..errors import SceneError
from ..opened import Finding, Place
from ..scenes import Scene, named_files

if TYPE_CHECKING:
    from ..maps.moments import SpectralMoments
    from ..maps.surface import Surface
    from .answer import Answer
    from .ways import Way

__all__ = ["assess_map"]

# Change of the pull-off of the map itself up to which patches are computed on approach, in a tenth of the time.
_CHANGED = 0.02


def assess_map(
    maps: Any,
    scene: Scene | None = None,
    *,
    area: Any = None,
    above: Any = None,
    tip: Any = None,
    smooth: Any = None,
    pixel: Any = None,
    height_unit: str | None = None,
    channel: str | int | None = None,
    factor: Any = None,
    mask: Any = None,
    level_rows: str | None = None,
    level: str = "plane",
    output: str | Path | None = None,
    replicas: int = 200,
    seed: int | None = None,
    threads: int | None = None,
    force: bool = False,
    progress: bool | None = None,
    **overrides: Any,
) -> Finding:
    """Finds the pull-off of patches of a measured surface, and assesses how far it can be trusted.

    The map itself and patches drawn from its spectrum are computed with two cut-offs, a factor of two apart. The smaller one is the
    shortest that pixels and tip resolve and that is no shorter than contacts are wide.

    Parameters
    ----------
    maps : map, or list of maps
        As `find_asperities` takes it. Several scans of one surface are combined as by `combine_spectra`.
    scene : path or dict, optional
        Material, model, history and preload; its surface is replaced, but for `lubricant_thickness`. By default the template
        ``measured-map``.
    area : float or str, optional
        Nominal area, m², or a text such as ``"100 um^2"``; by default that of the largest map.
    above : float or str, optional
        A force, N, or a text, for the probability that the pull-off exceeds it.
    tip : float or str, optional
        Radius of the tip, m, or a text: waves that it does not resolve are left out.
    smooth : float or str, optional
        The smaller cut-off, m, or a text, in place of the one that is chosen.
    pixel, height_unit, channel, factor, mask, level_rows, level : optional
        As of `find_asperities`; of several scans a list `pixel` has one for each.
    output : path, optional
        The result file, for `stiction plot`, `info` and `report`; without it the file is temporary.
    replicas, seed, threads, force, progress, **overrides
        As of `run`.

    Returns
    -------
    Finding
        `words` is the answer. Without runs, and so without pull-offs, where boundary elements are needed in any case. Its tree has `pull_off_force` (way, replica), N, with `cutoff` (way), m; `power` (wavevector), m⁴; and
        the attributes `assessment` (``yes`` or ``no``), `factor` and `nominal_area`, m².

    Raises
    ------
    SceneError
        An argument, a map or the scene is wrong.
    FileError
        `output` is there already, or cannot be written.

    Examples
    --------
    >>> import stiction
    >>> found = stiction.assess_map("configs/maps/polished.txt", replicas=20, **{"model.history": "approach"})
    >>> found.attrs["assessment"]
    'yes'
    """
    from . import record, summary

    scans = list(maps) if isinstance(maps, list | tuple) else [maps]
    inputs = [one for one in (*scans, mask) if isinstance(one, str | Path)]
    inputs += [] if scene is None else named_files(scene)
    if output is not None:
        files.check(output, force=force, inputs=inputs)
    reading = {"pixel": pixel, "height_unit": height_unit, "channel": channel, "factor": factor, "mask": mask}
    asked = _Asked(
        _positive("area", area, "m^2", "100 um^2"), _positive("above", above, "N", "100 nN"), tip,
        _positive("smooth", smooth, "m", "100 nm"),
        {"level": level, "level_rows": level_rows}, reading,
        {"replicas": _count(replicas), "seed": seed, "threads": threads, "progress": progress},
    )  # fmt: skip
    answer = _answer(scans, scene, asked, overrides)
    words = summary.words(answer)
    with Place(output) as place:
        with files.writing_hdf5(place.path, force=force, inputs=inputs) as part:
            record.dataset(answer, words).to_netcdf(part, engine="h5netcdf")
        found: Finding = place.result()
        return found


@dataclass(frozen=True)
class _Asked:
    """What was asked for, SI, and options: of levelling, of reading, of runs."""

    area: float | None
    above: float | None
    tip: Any
    smooth: float | None
    levelling: dict[str, Any]
    reading: dict[str, Any]
    runs: dict[str, Any]


def _positive(name: str, value: Any, unit: str, example: str) -> float | None:
    """A quantity above 0 in SI units, from a number or a text with a unit; None stays."""
    if value is None:
        return None
    try:
        number = float(quantities.in_si(name, value, unit))
    except (TypeError, ValueError) as error:
        said = str(error)
        raise SceneError(
            said if said.startswith(name) else f'{name} = {value!r}: such as "{example}" is needed'
        ) from None
    if not 0.0 < number < math.inf:
        raise SceneError(f'{name} = {value!r}: above 0 is needed, such as "{example}"')
    return number


def _count(replicas: Any) -> int:
    if isinstance(replicas, bool) or not isinstance(replicas, int) or replicas < 2:
        raise SceneError(f"replicas = {replicas!r}: 2 or more are needed for a distribution")
    return replicas


def _answer(scans: Sequence[Any], scene: Scene | None, asked: _Asked, overrides: Mapping[str, Any]) -> Answer:
    from ..maps.combine import read_scans
    from ..maps.moments import in_numbers
    from ..maps.surface import found_on
    from . import criteria, ways
    from .answer import Answer
    from .cutoffs import chosen, contact_width

    if not scans:
        raise SceneError("maps: one map or more are needed")
    surfaces, spectrum = read_scans(scans, asked.reading, asked.levelling, asked.tip)
    surfaces.sort(key=lambda one: -one.area)
    largest = surfaces[0]
    tables = ways.tables_of(scene, overrides)
    of = ways.constants(tables)
    sides = [count * step for count, step in zip(largest.grid.heights.shape, largest.grid.steps, strict=True)]

    @cache
    def smoothed(cutoff: float) -> Surface:
        """The summits of the largest map behind a cut-off, m."""
        return found_on(largest.map, replace(largest.steps, smooth=cutoff), largest.map.name)

    def moments(cutoff: float) -> SpectralMoments:
        """Moments behind a cut-off, m: of the map itself, or of the combined spectrum of several scans."""
        return in_numbers(smoothed(cutoff).moments) if len(surfaces) == 1 else spectrum.moments(cutoff)

    try:
        cutoffs = chosen(
            spectrum.shortest,
            min(sides),
            lambda cutoff: contact_width(moments(cutoff).radius, of["work_of_adhesion"], of["reduced_modulus"]),
            asked.smooth,
        )
    except SceneError as error:
        raise SceneError(f"{largest.map.name}: {error}") from None
    area = asked.area or math.prod(sides)
    smooth = [smoothed(cutoff) for cutoff in cutoffs.both] if len(surfaces) == 1 else []
    errors, first = criteria.sampling(largest.grid), moments(cutoffs.smaller)
    met = [
        *criteria.of_surface(largest.moments, errors),
        *criteria.of_shape(2.0 * math.pi * math.sqrt(first.m2 / first.m4), first.alpha, cutoffs),
    ]
    names = [scan.name for scan in spectrum.scans]
    of_scan = [f"{surface.map.name}: {one}" if len(names) > 1 else one for surface in surfaces for one in surface.warnings]
    warnings = [*dict.fromkeys(of_scan + spectrum.warnings)]
    answer = Answer(
        names, scene is None, smooth or [largest], spectrum, cutoffs, area, asked.above, of, [], met,
        math.inf, None, warnings,
    )  # fmt: skip
    if any(one.advice == criteria.ELEMENTS for one in met):
        return answer
    found = [ways.of_map(tables, one, asked.runs) for one in smooth]
    changed = _by_history(tables, smooth, found, asked.runs)
    of_patches = tables if changed is None else ways.approaching(tables)
    for cutoff in cutoffs.both:
        found.append(ways.of_spectrum(of_patches, moments(cutoff), cutoff, area, asked.runs))
    met += [
        *criteria.of_contacts(found, moments(cutoffs.both[1]).density * math.prod(sides)),
        *criteria.of_spread(
            found, abs(math.log(area / math.prod(sides))) < 0.2,
            ways.of_sigma(tables, first, area, min(errors.std, 0.5), asked.runs), errors.std,
        ),
    ]  # fmt: skip
    return replace(answer, ways=found, factor=criteria.factor_of(met), changed=changed)


def _by_history(
    tables: Mapping[str, Any], smooth: Sequence[Surface], own: Sequence[Way], runs: Mapping[str, Any]
) -> float | None:
    """By which fraction the history changes the pull-off of the map itself, if it may be left out for patches."""
    from . import ways

    if not smooth or str(own[0].run.attrs["history"]) == "approach":
        return None
    force = ways.of_map(ways.approaching(tables), smooth[0], runs).forces[0]
    changed = float(own[0].forces[0] / force - 1.0) if force > 0.0 else math.inf
    return changed if abs(changed) <= _CHANGED else None
