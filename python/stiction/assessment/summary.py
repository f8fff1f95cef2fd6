"""The answer of a map in words, in lines of at most 80 columns."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from .. import quantities
from ..rows import row
from .answer import Answer
from .criteria import LARGEST_FACTOR
from .ways import Way

__all__ = ["probability", "words"]

# Column in which texts begin.
_START = 20
# Logarithm of the ratio of areas from which on the area of the map is printed.
_OWN = 0.1
# Level of intervals of probabilities.
_LEVEL = 0.95
# Where to go, by the advice of a criterion.
_ADVICE = {
    "boundary elements": "boundary elements solve the map itself, with contacts that merge: export it by `stiction asperities MAP --smooth CUT-OFF -o levelled.h5`, "
    "then docs/my-afm-map.md#boundary-elements",
    "couple": "couple the summits of the map through the substrate: --set substrate.coupling=patch",
    "scan": "scan again with smaller pixels, less noise or a larger area",
    "more maps": "patches of the spectrum do not represent this surface: quote this map for its own area, and measure maps as large as a larger part",
}


def words(answer: Answer) -> str:
    """All that is printed."""
    parts = [[", ".join(answer.names), *_inputs(answer)], [*_assessment(answer)]]
    if answer.ways:
        parts[1:] = [list(_table(answer)), [*_distribution(answer), *_assessment(answer)]]
    return "\n\n".join("\n".join(lines) for lines in parts)


def _row(label: str, text: str) -> list[str]:
    return row(label, text, _START)


def _inputs(answer: Answer) -> Iterator[str]:
    of = answer.material
    material = [
        f"{name} {quantities.si(of[key], unit)}"
        for name, key, unit in (
            ("E*", "reduced_modulus", "Pa"),
            ("hardness", "hardness", "Pa"),
            ("work of adhesion", "work_of_adhesion", "J m-2"),
        )
        if key in of
    ]
    source = (
        "of the template measured-map, not of your surface: give --scene, or --set material.work_of_adhesion=..."
        if answer.template
        else ""
    )
    yield from _row("material", "; ".join([", ".join(material), source]).strip("; "))
    if answer.ways:
        yield from _row("model", _model(answer))
    for scan in answer.spectrum.scans:
        limits = " to ".join(quantities.si(wave, "m", 3) for wave in (scan.shortest, scan.longest))
        yield from _row("reliable waves", f"{limits}{f' of {scan.name}' if len(answer.names) > 1 else ''}")
    both = " and ".join(quantities.si(cutoff, "m", 3) for cutoff in answer.cutoffs.both)
    yield from _row(
        "cut-offs",
        f"{both}, the smaller {answer.cutoffs.why}; contacts are {quantities.si(answer.cutoffs.width, 'm', 2)} wide",
    )
    for warning in answer.warnings:
        yield from _row("warning", warning)


def _model(answer: Answer) -> str:
    own = answer.ways[0].run.attrs
    model = f"{own['law']}, {own['history']}"
    if answer.changed is None:
        return model
    share = quantities.number(abs(100.0 * answer.changed), 2) if abs(answer.changed) > 5e-5 else "0.00"
    return f"{model}; patches on approach, since pressing changes this map by {share} % only"


def _table(answer: Answer) -> Iterator[str]:
    above = "" if answer.above is None else "P(above)"
    yield f"  {'':<17}{'summits':>8}{'R':>9}{'sigma_s':>9}{'pull-off':>9}{'5 to 95 %':>17}{above:>9}".rstrip()
    for way in answer.ways:
        force = quantities.si(np.nanmedian(way.forces), "N", 3)
        ends = "" if way.forces.size == 1 else _ends(way.forces)
        over = "" if answer.above is None else _over(way, answer.above)
        name = "this map" if way.name == "map" else "patches"
        cells = (quantities.si(way.radius, "m", 3), quantities.si(way.height_std, "m", 3), force)
        label = f"{name}, {quantities.si(way.cutoff, 'm', 3)}"
        yield f"  {label:<17}{way.count:>8.0f}{cells[0]:>9}{cells[1]:>9}{cells[2]:>9}{ends:>17}{over:>9}".rstrip()


def _ends(forces: Any) -> str:
    low, high = np.nanquantile(forces, [0.05, 0.95])
    unit, sign = quantities.factor_and_unit([high], "N")
    return f"{quantities.number(low / unit, 3)} to {quantities.number(high / unit, 3)} {sign}"


def _over(way: Way, above: float) -> str:
    if way.forces.size == 1:
        return "yes" if way.forces[0] > above else "no"
    return f"{100.0 * np.mean(way.forces > above):.1f} %"


def probability(answer: Answer) -> tuple[float, float, float]:
    """The probability that a patch exceeds the force asked for; the lowest and highest 95 % limit with either cut-off."""
    from scipy import stats

    assert answer.above is not None
    shares, ends = [], []
    for way in answer.patches:
        count, known = int(np.sum(way.forces > answer.above)), int(np.sum(~np.isnan(way.forces)))
        interval = stats.binomtest(count, known).proportion_ci(_LEVEL, "wilson")
        shares.append(count / known)
        ends += [float(interval.low), float(interval.high)]
    return float(np.mean(shares)), min(ends), max(ends)


def _distribution(answer: Answer) -> Iterator[str]:
    median = float(np.nanmedian(answer.forces))
    area, of_map = quantities.si(answer.area, "m2", 3), answer.ways[0].area
    is_own = abs(math.log(answer.area / of_map)) < _OWN
    own = "" if is_own or answer.ways[0].name != "map" else f" (this map has {quantities.si(of_map, 'm2', 3)})"
    yield from _row(
        "pull-off",
        f"of {area}{own}: half of the patches below {quantities.si(median, 'N', 3)}, 90 % from {_ends(answer.forces)}",
    )
    if answer.above is not None:
        share, low, high = (100.0 * of for of in probability(answer))
        yield from _row(
            f"above {quantities.si(answer.above, 'N', 3)}",
            f"P = {share:.1f} % ({low:.1f} to {high:.1f} % by chance and cut-off)",
        )


def _assessment(answer: Answer) -> Iterator[str]:
    failed = answer.failed
    factor = quantities.number(answer.factor, 2)
    if failed:
        yield from _row("assessment", f"no: {', '.join(one.name for one in failed)}")
        advice = dict.fromkeys(one.advice for one in failed)
        # Of what is noise the other criteria say nothing.
        for one in ["scan"] if "scan" in advice else advice:
            yield from _row("instead", _ADVICE[one])
    elif answer.factor > LARGEST_FACTOR:
        largest = max(answer.criteria, key=lambda one: one.factor)
        yield from _row("assessment", f"no: within a factor of {factor} only, mostly by {largest.name}")
        yield from _row("instead", _ADVICE["boundary elements" if largest.name == "cut-off" else "more maps"])
    else:
        yield from _row("assessment", f"yes, within a factor of {factor}, for this material and law")
    for criterion in answer.criteria:
        yield from _row(f"{' !' if criterion.advice else '  '} {criterion.name}", criterion.text)
