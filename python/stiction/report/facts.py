"""Facts of a result: the numbers to quote, what was computed, assessments, how to make it again."""

from __future__ import annotations

import math
import shlex
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .. import quantities
from ..finite_size.study import is_study, study
from ..results import Asperities, Finding, Result, Run, Sweep, agreement
from ..scenes import paths_in

__all__ = ["Facts", "Number", "Table", "Verdict", "facts"]


@dataclass(frozen=True)
class Number:
    """A number in words; `value` and `error` are its SI value and standard error where files can be compared by it."""

    label: str
    text: str
    note: str = ""
    value: float = math.nan
    error: float = math.nan


@dataclass(frozen=True)
class Verdict:
    """A judgement; `grade` is ``good``, ``caution``, ``bad`` or ``none``."""

    subject: str
    grade: str
    word: str
    text: str


@dataclass(frozen=True)
class Table:
    """Numbers of several things: points of a sweep, sizes, springs."""

    caption: str
    header: list[str]
    rows: list[list[str]]


@dataclass(frozen=True)
class Facts:
    """The content of a report on one result but its figures."""

    kind: str
    numbers: list[Number]
    verdicts: list[Verdict]
    computed: list[tuple[str, str]]
    commands: str
    needs: list[str]
    tables: list[Table] = field(default_factory=list)


_HISTORIES = {
    "approach": "on approach",
    "retraction": "on retraction from the closest separation",
    "loop": "a loop: to the smallest separation and back",
}
_INDEPENDENCE = {"good": "good", "a shift": "caution", "invalid": "bad"}
_AGREEMENT = {"agree": "good", "disagree": "bad"}


def facts(result: Result) -> Facts:
    """The facts of a result of any kind.

    Parameters
    ----------
    result : Run, Sweep, Asperities or Finding
    """
    for kind, of in _OF.items():
        if isinstance(result, kind):
            found: Facts = of(result)
            return found
    raise TypeError(f"{type(result).__name__}: no result of stiction")


def _percent(value: float, digits: int = 3) -> str:
    return f"{quantities.number(100.0 * value, digits)} %"


def _value(result: Result, path: str) -> float:
    return float(result[path].values)


def _span(low: float, high: float, unit: str) -> str:
    return f"{quantities.si(low, unit)} to {quantities.si(high, unit)}"


def _of_contacts(values: Any, unit: str) -> tuple[list[str], str]:
    """Numbers by plastic contact from the smallest on, three digits each, and the unit of all; those that are known."""
    known = np.sort(values[np.isfinite(values)])
    factor, written = (0.01, "%") if unit == "%" else quantities.factor_and_unit(known, unit)
    return [quantities.number(float(value) / factor, 3) for value in known], written


def _range(values: Any, unit: str) -> str:
    """The range of numbers over plastic contacts, in words; a dash where there are none."""
    numbers, written = _of_contacts(values, unit)
    if not numbers:
        return "–"
    return f"{numbers[0]} {written}" if numbers[0] == numbers[-1] else f"{numbers[0]} to {numbers[-1]} {written}"


def _model_range(run: Run, name: str, label: str, unit: str) -> list[Number]:
    """The range of a number of the run over plastic contacts, where contacts yield."""
    if run.model_range is None or name not in run.model_range:
        return []
    of = run.model_range[name].dropna("plastic_contact")
    numbers, written = _of_contacts(of.values, unit)
    if not numbers:
        return []
    names = of["plastic_contact"].values[np.argsort(of.values)]
    each = ", ".join(f"{contact} {number}" for contact, number in zip(names, numbers, strict=True))
    return [Number(f"model range{label}", _range(of.values, unit), f"by plastic contact, which no interval has: {each} {written}")]


# Rows on what was computed.


def _surface(result: Result) -> Iterator[tuple[str, str]]:
    attrs = result.attrs
    rows = (
        ("λ, adhesion parameter", "adhesion_parameter", "1"),
        ("ψ of σ_s, plasticity index of Greenwood and Williamson", "asperity_plasticity_index", "1"),
        ("ψ of σ, as Shi and Polycarpou print it", "plasticity_index", "1"),
        ("R, radius of asperities", "asperity_radius", "m"),
        ("σ, standard deviation of the surface heights", "surface_height_std", "m"),
        ("σ_s, standard deviation of the asperity heights", "asperity_height_std", "m"),
        ("nominal area of a patch", "nominal_area", "m2"),
    )
    for words, name, unit in rows:
        if name in attrs and math.isfinite(float(attrs[name])):
            yield words, quantities.si(attrs[name], unit)


def _draws(result: Result) -> Iterator[tuple[str, str]]:
    attrs = result.attrs
    if "replicas" in attrs:
        seed = f", seed {attrs['seed']}" if "seed" in attrs else ""
        yield "replicas", f"{quantities.counted(int(attrs['replicas']), 'patch')}, {attrs.get('sampling', 'independent')}{seed}"


def _separations(result: Result, path: str = "integral") -> Iterator[tuple[str, str]]:
    h_star, h = result[f"{path}/h_star"].values, result[f"{path}/separation"].values
    if h_star.ndim == 1:
        text = f"{h_star.size}, from h/σ = {quantities.number(h_star.min(), 3)} to {quantities.number(h_star.max(), 3)}"
        yield "separations", f"{text} ({_span(h.min(), h.max(), 'm')})"


def _law(result: Result) -> Iterator[tuple[str, str]]:
    attrs = result.attrs
    if "law" in attrs and "model_law" not in result:
        yield "law of an asperity", str(attrs["law"])
    if result.left_out:
        yield "left out by the law", result.left_out
    if "history" in attrs:
        turned = ", turned back at each preload" if isinstance(result, Run | Sweep) and result.preloads else ""
        yield "history", _HISTORIES.get(str(attrs["history"]), str(attrs["history"])) + turned


# Verdicts.


def _is_of_resolution(warning: str) -> bool:
    return "separations are too coarse" in warning


def _validity(result: Result) -> Verdict:
    there = [warning for warning in result.warnings if not _is_of_resolution(warning)]
    if not there:
        psi = float(result.attrs.get("asperity_plasticity_index", 0.0))
        yielding = f"; contacts yield (ψ of σ_s = {quantities.number(psi, 2)}), which the law computes" if psi > 1.0 else ""
        return Verdict("validity", "good", "no warning", f"the scene is within the limits of its law and of known materials and surfaces{yielding}")
    return Verdict("validity", "caution", quantities.counted(len(there), "warning"), f"{there[0]}{'; more below' if len(there) > 1 else ''}")


def _worst(words: Iterable[str], grades: dict[str, str]) -> tuple[str, str]:
    """The worst of several words with its grade, and how often each is there, in words."""
    counts = Counter(words)
    order = ["bad", "caution", "none", "good"]
    worst = min(counts, key=lambda word: order.index(grades.get(word, "none")))
    text = worst if len(counts) == 1 else ", ".join(f"{count} {word}" for word, count in counts.items())
    return grades.get(worst, "none"), text


def _independence(result: Result) -> Verdict:
    group = result["independence"]
    if "verdict" in group.attrs:
        word = str(group.attrs["verdict"])
        shift = abs(_value(result, "independence/relative_shift"))
        attraction = _value(result, "independence/relative_attractive_stiffness")
        text = (
            f"at pull-off the substrate is displaced by {quantities.number(shift, 2)} σ and attraction is "
            f"{quantities.number(attraction, 2)} of its stiffness; "
            f"{_percent(_value(result, 'independence/contact_share'), 2)} of the area is in contact"
        )
        if "coupling" in result:
            text = f"asperities are coupled through the substrate ({result['coupling'].attrs['coupling']}); without: {word}, as {text}"
            return Verdict("independence", "good", "coupled", text)
        return Verdict("independence", _INDEPENDENCE.get(word, "none"), word, text)
    grade, words = _worst((str(word) for word in group["verdict"].values.ravel()), _INDEPENDENCE)
    coupled = "; where asperities are coupled it says how it would be without" if "coupling" in result else ""
    return Verdict(
        "independence", grade, words, f"whether asperities may be taken as independent at pull-off{coupled}"
    )


def _resolution(run: Run) -> Verdict:
    prefix = "retraction_" if run.attrs["history"] == "loop" else ""
    h, force = (
        run[f"ensemble/{name}"].values for name in ("separation", f"{prefix}external_force_mean")
    )
    places = run["replicas/pull_off_separation"].values
    pulls = run["replicas/pull_off_force"].values > 0.0
    at_edge = float(np.mean(np.isin(places[pulls], (h.min(), h.max())))) if pulls.any() else 0.0
    lowest = int(np.nanargmin(force))
    inside = 0 < lowest < h.size - 1
    notes = [warning for warning in run.warnings if _is_of_resolution(warning)]
    error = float(run["integral"].attrs["quadrature_error"])
    explained = f"the integral is good to {quantities.number(error, 1)} of itself"
    if "coupling" in run and int(run["coupling/unsettled_count"].values.sum()) > 0:
        notes.append(f"{int(run['coupling/unsettled_count'].values.sum())} equilibria did not settle")
    if not pulls.any():
        return Verdict("resolution", "none", "no pull-off", explained)
    if not inside or at_edge > 0.5:
        text = "the pull-off is at the edge of the separations: it may lie beyond"
        return Verdict("resolution", "bad", "at the edge", "; ".join([text, *notes]))
    step = float(np.nanmax(np.abs(force[[lowest - 1, lowest + 1]] - force[lowest])) / abs(force[lowest]))
    explained = f"one separation from pull-off the force differs by {_percent(step, 2)}; {explained}"
    if at_edge > 0.0:
        notes.append(f"at least {_percent(at_edge, 2)} of the patches have their pull-off at the edge of the separations")
    if notes:
        return Verdict("resolution", "caution", "look", "; ".join([*notes, explained]))
    return Verdict("resolution", "good", "fine", explained)


# Commands.


def _heredoc(command: list[str], scene: str) -> str:
    end = "SCENE"
    while end in scene:
        end += "_"
    return f"{shlex.join(command)} <<'{end}'\n{scene.rstrip()}\n{end}\n"


def _again(result: Result, command: list[str], *options: str) -> str:
    """The command that makes a result again, with its scene on standard input."""
    ensemble, attrs = result.scene.get("ensemble", {}), result.attrs
    words = ["stiction", *command, "-", *options]
    # Numbers that the command line had, and not the scene. A run that ended at targets has as many replicas as it took.
    ended = "ensemble/target" in result or "until" in ensemble
    for name in ("replicas", "seed"):
        default = {"seed": 1}.get(name)
        if name in attrs and int(ensemble.get(name, default or -1)) != int(attrs[name]) and not (name == "replicas" and ended):
            words += [f"--{name}", str(int(attrs[name]))]
    return _heredoc([*words, "-o", result.path.name], result.scene_text)


# Kinds.


def _scalar(run: Run, name: str) -> tuple[float, float]:
    """Mean over replicas of a scalar, and its standard error."""
    of = run["ensemble"].to_dataset().sel(scalar=name)
    return float(of["scalar_controlled_mean"]), float(of["scalar_controlled_standard_error"])


def _integral(run: Run) -> Facts:
    """The facts of a run of the integral alone."""
    attrs = run["integral"].attrs
    force, place, sigma = float(attrs["pull_off_force"]), float(attrs["pull_off_separation"]), float(run.attrs["surface_height_std"])
    numbers = [Number("pull-off of the integral", "none", "nothing pulls", 0.0)]
    if force > 0.0:
        h = run["integral/separation"].values
        edge = "at the edge of the separations: it may lie beyond" if place in (h[0], h[-1]) else f"h/σ = {quantities.number(place / sigma)}"
        numbers = [
            Number("pull-off of the integral", quantities.si(force, "N"), "of the mean over infinitely many patches", force),
            Number("separation of pull-off", quantities.si(place, "m"), edge, place),
        ]
    stiffness = float(attrs["peak_stiffness"])
    numbers.append(Number("largest stiffness", quantities.si(stiffness, "N m-1"), "of the integral", stiffness))
    if "background" in run:
        numbers.append(_mean_planes(run))
    computed = [*_law(run), *_surface(run), *_separations(run), *_draws(run)]
    return Facts("integral alone", numbers, [_validity(run), _independence(run)], computed, _again(run, ["run"]), paths_in(run.scene))


def _run(run: Run) -> Facts:
    if not run.has_replicas:
        return _integral(run)
    quoted, sigma = run.pull_off, float(run.attrs["surface_height_std"])
    loop = run.attrs["history"] == "loop"
    if quoted.mean_over_patches > 0.0:
        level, single = f"{100 * quoted.interval_level:g} %", quoted.replicas == 1
        note = "of one patch: it has no standard error" if single else f"mean over {quoted.replicas} patches and its standard error"
        note = quoted.agreement or note
        if "coupling" not in run and str(run["independence"].attrs["verdict"]) == "invalid":
            note = f"not to be quoted, since asperities are not independent; {note}"
        after = "" if quoted.preload is None else f" after {quantities.si(quoted.preload, 'N', 3)}"
        numbers = [Number(f"pull-off force{after}", str(quoted), note, quoted.mean_over_patches, quoted.standard_error)]
        if not single and not quoted.agreement:
            numbers += [
                Number(f"{level} interval", _span(*quoted.interval, "N"), "of the mean"),
                Number("standard deviation of patches", _percent(quoted.scatter, 4),
                       f"{quantities.si(quoted.std, 'N')}: the next patch differs by about that", quoted.scatter),
            ]
        numbers += [
            *_model_range(run, "pull_off_force", "", "N"),
            Number("separation of pull-off", quantities.si(quoted.separation, "m"),
                   f"h/σ = {quantities.number(quoted.separation / sigma)}, mean over patches", quoted.separation),
            *_after_preloads(run)[1:],
        ]  # fmt: skip
        if quoted.preload is not None:
            whole, error = _scalar(run, "pull_off_force")
            place = "the closest separation, beyond the preloads"
            numbers.append(Number("pull-off of the whole loop", quantities.with_error(whole, error, "N"), f"from {place}", whole, error))
        else:
            numbers += [
                Number("pull-off of the mean curve", quantities.si(quoted.of_mean_curve, "N"),
                       "smaller: each patch has its deepest point at its own separation", quoted.of_mean_curve),
                Number("pull-off of the integral", quantities.si(quoted.of_integral, "N"),
                       "the statistical integral over asperity heights", quoted.of_integral),
            ]  # fmt: skip
    else:
        why = "no patch pulls" if quoted.mean_over_patches <= 0.0 else "no patch reaches a preload"
        numbers = [Number("pull-off force", "none", why, 0.0)]
    if "device" in run:
        numbers += [_chances(run, preload) for preload in _preloads(run)]
    if loop:
        numbers.append(_mean("pull-off on approach", run["replicas/approach_pull_off_force"].values, "N"))
        for label, name in (("energy dissipated in a cycle", "replicas/dissipated_energy"),
                            ("energy dissipated in each further cycle", "replicas/repeated_dissipated_energy")):  # fmt: skip
            if name not in run:
                continue
            of_all = "" if quoted.preload is None else ", over all separations"
            lost = _mean(label + of_all, run[name].values, "J")
            gains = lost.value < (-3.0 * lost.error if lost.error > 0.0 else 0.0)
            numbers.append(replace(lost, note="no result: a loop cannot give out energy; the adhesive stress is above the pressure at which contacts yield") if gains else lost)
            if name.endswith("/dissipated_energy"):
                numbers += _model_range(run, "dissipated_energy", " of the energy", "J")
    stiffness, error = _scalar(run, "peak_secant_stiffness")
    numbers.append(Number("largest stiffness", quantities.with_error(stiffness, error, "N m-1"),
                          "mean over patches of the largest secant", stiffness, error))  # fmt: skip
    if "background" in run:
        numbers.append(_mean_planes(run))
    if "coupling" in run:
        of = run["coupling"].to_dataset().sel(scalar="pull_off_force")
        change, error = float(of["scalar_difference_mean"]), float(of["scalar_difference_standard_error"])
        numbers.append(Number("coupled less independent", quantities.with_error(change, error, "N"),
                              "pull-off force of the same asperities", change, error))  # fmt: skip
    check = run.cross_check
    z = [np.abs(run[f"validation/z_{name}"].values) for name in ("adhesion_force", "external_force")]
    largest = max(float(np.nanmax(of, initial=0.0)) for of in z)
    verdicts = [
        Verdict("cross-check", _AGREEMENT.get(check.verdict, "none"), check.verdict,
                f"ensemble against integral: {check}; largest deviation {quantities.number(largest, 3)} standard errors"),
        _validity(run), _independence(run), _resolution(run),
    ]  # fmt: skip
    counts = run["replicas/asperity_count"].values
    count = f"{counts.min()}" if counts.min() == counts.max() else f"{counts.min()} to {counts.max()}"
    computed = [*_law(run), *_surface(run), ("asperities of a patch", count), *_separations(run), *_draws(run)]
    if "coupling" in run:
        attrs = run["coupling"].attrs
        computed.append(("coupling", f"{attrs['coupling']}, {attrs['kernel']} kernel, {attrs['positions']} positions"))
    tables = [*_targets(run), *_springs(run), *_stuck(run)]
    commands = _again(run, ["run"])
    return Facts("run", numbers, verdicts, computed, commands, paths_in(run.scene), tables)


def _after_preloads(result: Run | Sweep) -> list[Number]:
    """The pull-off after each preload that is reached, the largest first; of a sweep the smallest and the largest mean of the points."""
    if "instability/preload" not in result:
        return []
    group = result.group("instability")
    numbers = []
    for i in np.argsort(-np.asarray(group["preload"].values)):
        load, mean, std, count = (
            group[name].isel(preload=i).values.ravel()
            for name in ("preload", "pull_off_after_preload_mean", "pull_off_after_preload_std", "preload_reached_count")
        )
        if not (np.isfinite(load).all() and (count > 0).any()):
            continue
        if isinstance(result, Sweep):
            text, note = _span(np.nanmin(mean), np.nanmax(mean), "N"), f"smallest and largest mean of {quantities.counted(mean.size, 'point')}"
        else:
            text, note = quantities.with_error(mean[0], std[0] / math.sqrt(count[0]), "N"), f"mean over {quantities.counted(int(count[0]), 'patch')}"
        numbers.append(Number(f"pull-off force after {quantities.si(load[0], 'N', 3)}", text, note))
    return numbers


def _mean_planes(run: Run) -> Number:
    """The attraction of the mean planes at the pull-off of the integral, or at the smallest separation where nothing pulls."""
    attrs, prefix = run["integral"].attrs, "retraction_" if run.attrs["history"] == "loop" else ""
    h = run["background/separation"].values
    place = float(attrs["pull_off_separation"]) if float(attrs["pull_off_force"]) > 0.0 else float(h[0])
    force, *others = (
        float(np.interp(place, h, run[path].values)) for path in ("background/force", *run.mean_plane_forces.values())
    )
    asperities = float(np.interp(place, h, run[f"integral/{prefix}adhesion_force"].values))
    parts = [f"{name} {quantities.si(own, 'N')}" for name, own in zip(run.mean_plane_forces, others, strict=True) if own != 0.0]
    share = force / (force + asperities) if force + asperities > 0.0 else math.nan
    note = f"{_percent(share)} of the attraction at pull-off of the integral; {', '.join(parts) or 'none'}"
    return Number("attraction of the mean planes", quantities.si(force, "N"), note, force)


def _mean(label: str, values: Any, unit: str) -> Number:
    mean = float(values.mean())
    if values.size > 1 and np.ptp(values) <= 1e-9 * abs(mean):
        # The rule of three: equal patches are no certainty.
        note = f"mean over patches; {agreement(values.size, 1.0 - 0.05 ** (1.0 / values.size))}"
        return Number(label, quantities.si(mean, unit), note, mean, math.nan)
    error = float(values.std(ddof=1)) / math.sqrt(values.size) if values.size > 1 else math.nan
    return Number(label, quantities.with_error(mean, error, unit), "mean over patches", mean, error)


def _targets(run: Run) -> Iterator[Table]:
    if "ensemble/target" not in run:
        return
    of = run["ensemble"].to_dataset()
    rows = []
    for name, unit, error, most, met in zip(
        *(of[name].values for name in ("target", "target_units", "target_standard_error",
                                       "target_largest_standard_error", "target_met")),
        strict=True,
    ):  # fmt: skip
        differing = float(of["scalar_most_differing"].sel(scalar=str(name)))
        known = agreement(run["replicas"].sizes["replica"], differing) if differing > 0.0 else quantities.si(error, str(unit))
        numbers = [known, quantities.si(most, str(unit))]
        rows.append([str(name).replace("pull_off", "pull-off").replace("_", " "), *numbers, "met" if met else "missed"])
    yield Table("Targets", ["mean of", "standard error", "largest allowed", ""], rows)


def _springs(run: Run) -> Iterator[Table]:
    if "instability" not in run:
        return
    group = run["instability"].to_dataset()
    none = np.zeros(0)
    stiffness, preloads = (
        np.atleast_1d(group[name].values) if name in group else none for name in ("stiffness", "preload")
    )

    def probability(name: str, **place: int) -> str:
        if f"{name}_probability" not in group:
            return "–"
        value, low, high = (float(group[f"{name}_probability{end}"].isel(place)) for end in ("", "_low", "_high"))
        if math.isnan(value):
            return "–"
        return f"{quantities.number(value, 3)} ({quantities.number(low, 2)} to {quantities.number(high, 2)})"

    if stiffness.size:
        after = ["the closest" if math.isnan(load) else quantities.si(load, "N", 3) for load in preloads]
        rows = [
            [quantities.si(k, "N m-1", 3), probability("snap_in", stiffness=i),
             *(probability("snap_off", stiffness=i, preload=j) for j in range(preloads.size))]
            for i, k in enumerate(stiffness)
        ]  # fmt: skip
        header = ["stiffness", "snap-in", *(f"snap-off after {load}" for load in after)]
        yield Table("Probability to snap, with 95 % intervals", header, rows)
    if "pull_off_after_preload_mean" in group and np.isfinite(preloads).any():
        header = ["preload", "mean pull-off", "standard deviation of patches"]
        ranges = _ranges(run, "pull_off_after_preload", "N")
        rows = [
            [quantities.si(load, "N", 3), quantities.si(mean, "N"), quantities.si(std, "N"), *ranges[i : i + 1]]
            for i, (load, mean, std) in enumerate(
                zip(preloads, *(group[f"pull_off_after_preload_{of}"].values for of in ("mean", "std")), strict=True)
            )
            if math.isfinite(load)
        ]
        yield Table("Pull-off after a preload", [*header, *["model range"] * bool(ranges)], rows)


def _ranges(run: Run, name: str, unit: str) -> list[str]:
    """The range over plastic contacts of a number after each preload, or of the one number; none where no contacts yield."""
    if f"model_range/{name}" not in run:
        return []
    of = run[f"model_range/{name}"].transpose("plastic_contact", ...).values
    return [_range(values, unit) for values in of.reshape(of.shape[0], -1).T]


def _stuck(run: Run) -> Iterator[Table]:
    if "device" not in run:
        return
    group = run["device"].to_dataset()
    rows = [("the closest separation", "")]
    if "preload" in group:
        rows = [(quantities.si(load, "N", 3), "_after_preload") for load in group["preload"].values]

    def cell(name: str, of: str, place: int) -> str:
        return _percent(float(np.atleast_1d(group[f"stuck_{name}{of}"].values)[place]))

    names = ("probability", "probability_low", "probability_high")
    ranges = _ranges(run, f"stuck_probability{rows[0][1]}", "%")
    header = ["preload", "probability", "95 % interval from", "to", *["model range"] * bool(ranges)]
    cells = [[load, *(cell(name, of, i) for name in names), *ranges[i : i + 1]] for i, (load, of) in enumerate(rows)]
    yield Table(f"Probability that the pull-off is above {_restoring(run)}", header, cells)


def _sweep(sweep: Sweep) -> Facts:
    points, pull_off = sweep.points, sweep.pull_off
    integrals = pull_off["of_integral"].values
    numbers = [Number("of the integral", _span(np.nanmin(integrals), np.nanmax(integrals), "N"), "smallest and largest")]
    checked = []
    if sweep.has_replicas:
        means = pull_off["mean_over_patches"].values
        span = _span(np.nanmin(means), np.nanmax(means), "N")
        note = f"smallest and largest mean of {quantities.counted(means.size, 'point')}"
        numbers = _after_preloads(sweep) or [Number("pull-off force", span, note), *numbers]
        numbers += [_chances(sweep, preload) for preload in _preloads(sweep)] if "device" in sweep else []
        overall = str(sweep["validation"].attrs["overall_verdict"])
        smallest = float(np.nanmin(sweep["validation/p_value"].values, initial=1.0))
        level = 100 * float(sweep["validation"].attrs["significance"])
        check = f"ensemble against integral at all points together: smallest p = {quantities.number(smallest, 3)}, {level:g} % level, Holm's method"
        checked = [Verdict("cross-check", _AGREEMENT.get(overall, "none"), overall, check)]
    edge = np.isin(sweep["integral/pull_off_separation"].values, _edges(sweep)) & (integrals > 0.0)
    coarse = [warning for warning in sweep.warnings if _is_of_resolution(warning)]
    resolution = Verdict("resolution", "good", "fine", "no point has the pull-off of its integral at the edge of the separations")
    if edge.any() or coarse:
        seen = coarse[:1] + [f"{quantities.counted(int(edge.sum()), 'point')} with the pull-off at the edge of the separations"] * bool(edge.any())
        resolution = Verdict("resolution", "bad" if edge.any() else "caution", "look", "; ".join(seen))
    verdicts = [*checked, _validity(sweep), _independence(sweep), resolution]
    keys = [key.replace(".", "_") for key in sweep.keys]
    computed = [("sweep", f"{quantities.counted(integrals.size, 'point')} ({sweep.attrs['sweep_mode']})")]
    for key, name in zip(sweep.keys, keys, strict=True):
        of = points[name] if name in points.variables else sweep[name]
        values = list(dict.fromkeys(of.values.ravel())) if of.dtype.kind == "U" else np.unique(of.values)
        texts = [sweep.key_text(key, value) for value in values]
        computed.append((key, ", ".join(texts) if of.dtype.kind == "U" or len(texts) == 1 else f"{len(texts)} values, {texts[0]} to {texts[-1]}"))
    computed += [*_law(sweep), *_draws(sweep)]
    tables = list(_points(sweep, keys))
    found = Facts("sweep", numbers, verdicts, computed, _again(sweep, ["run"]), paths_in(sweep.scene), tables)
    return _finite_size(sweep, found) if is_study(sweep) else found


def _chances(result: Run | Sweep, preload: float | None) -> Number:
    """The probability of a device after a preload: of a run with its interval, of a sweep the smallest and the largest of its points."""
    after = "" if preload is None else f" after {quantities.si(preload, 'N', 3)}"
    label = f"P(pull-off > {_restoring(result)}){after}"
    of = result.stuck_after(preload)
    low, value, high = (np.ravel(of[f"stuck_probability{end}"].values) for end in ("_low", "", "_high"))
    if np.isnan(value).all():
        return Number(label, "none", "no patch reaches the preload")
    if isinstance(result, Sweep):
        first, last = int(np.nanargmin(value)), int(np.nanargmax(value))
        text = f"{_percent(value[first])} to {_percent(value[last])}"
        ends = [_interval(low[i], high[i]) for i in (first, last)]
        return Number(label, text, f"smallest and largest of {quantities.counted(value.size, 'point')}, 95 % intervals {' and '.join(ends)}")
    ranges = result.model_range_after(preload)
    note = f"95 % interval {_interval(low[0], high[0])}"
    if ranges is not None and "stuck_probability" in ranges:
        note += f"; model range {_range(ranges['stuck_probability'].values, '%')}"
    return Number(label, _percent(value[0]), note, float(value[0]))


def _edges(sweep: Sweep) -> Any:
    h = sweep["integral/separation"].values
    return np.concatenate([np.ravel(h[..., 0]), np.ravel(h[..., -1])])


def _points(sweep: Sweep, keys: list[str]) -> Iterator[Table]:
    """The points: their pull-offs after every preload, and of a device their probabilities."""
    preloads = _preloads(sweep)
    pull_offs = [_cells(sweep, keys, preload, _pull_off_words(sweep)) for preload in preloads]
    yield Table("Points", [*sweep.keys, *pull_offs[0][0]], _rows([rows for _, rows in pull_offs]))
    if sweep.has_replicas and "device" in sweep:
        chances = [_cells(sweep, keys, preload, _PROBABILITY_WORDS) for preload in preloads]
        yield Table(f"Probability that the pull-off is above {_restoring(sweep)}", [*sweep.keys, *chances[0][0]], _rows([rows for _, rows in chances]))


def _preloads(result: Run | Sweep) -> list[float | None]:
    """The preloads of the scene, N, in its order; None where pull-offs are of the whole history."""
    return [*result.preloads] or [None]


def _rows(tables: list[list[list[str]]]) -> list[list[str]]:
    """The rows of tables of one length, of each point one after the other."""
    return [row for rows in zip(*tables, strict=True) for row in rows]


def _restoring(result: Run | Sweep) -> str:
    force = result.restoring_force
    return "the restoring force" if force is None else quantities.si(force, "N")


def _pull_off_words(sweep: Sweep) -> dict[str, tuple[str, Callable[[Any], str]]]:
    """The columns of the pull-offs of points: names of data, heads, and the words of a row."""

    def mean(row: Any) -> str:
        if math.isnan(row["mean_over_patches"]):
            return "–"
        return "none" if row["mean_over_patches"] <= 0.0 else quantities.with_error(row["mean_over_patches"], row["standard_error"], "N")

    words: dict[str, tuple[str, Callable[[Any], str]]] = {
        "preload": ("preload", lambda row: quantities.si(row["preload"], "N", 3)),
        "mean_over_patches": ("pull-off force", mean),
        "of_integral": ("of the integral", lambda row: "none" if row["of_integral"] <= 0.0 else quantities.si(row["of_integral"], "N")),
        "model_range": ("model range", lambda row: str(row["model_range"])),
        "verdict": ("cross-check", lambda row: str(row["verdict"])),
        "independence": ("independence", lambda row: str(row["independence"])),
    }
    if sweep.has_preload and sweep.has_replicas:
        del words["of_integral"]
    return words


_PROBABILITY_WORDS: dict[str, tuple[str, Callable[[Any], str]]] = {
    "preload": ("preload", lambda row: quantities.si(row["preload"], "N", 3)),
    "stuck_probability": ("probability", lambda row: "–" if math.isnan(row["stuck_probability"]) else _percent(row["stuck_probability"])),
    "stuck_probability_low": ("95 % interval", lambda row: _interval(row["stuck_probability_low"], row["stuck_probability_high"])),
    "stuck_model_range": ("model range", lambda row: str(row["stuck_model_range"])),
}


def _interval(low: float, high: float) -> str:
    """The interval of a probability, per cent; a dash where it is not known."""
    return "–" if math.isnan(low) else f"{quantities.number(100.0 * low, 3)} to {_percent(high)}"


def _cells(
    sweep: Sweep, keys: list[str], preload: float | None, words: dict[str, tuple[str, Callable[[Any], str]]]
) -> tuple[list[str], list[list[str]]]:
    """Heads of the columns behind the keys, and a row for each point after a preload."""
    import xarray

    whole = _numbers_of_points(sweep, preload)
    for name in keys:
        if name not in whole.variables:
            whole[name] = sweep[name]
    if preload is not None:
        whole["preload"] = xarray.full_like(sweep["integral/pull_off_force"], preload)
    columns = [name for name in words if name in whole]
    rows = [
        [*(sweep.key_text(name, row[name]) for name in keys), *(words[name][1](row) for name in columns)]
        for row in whole.to_dataframe().reset_index().to_dict("records")
    ]
    return [words[name][0] for name in columns], rows


def _numbers_of_points(sweep: Sweep, preload: float | None) -> Any:
    """The numbers of the points after a preload, or of the whole history: a dataset over the points."""
    import xarray

    after = None if preload is None else sweep.after_preload(preload)
    of: dict[str, Any] = {str(name): own for name, own in (sweep.pull_off if after is None else after).data_vars.items()}
    if "device" in sweep and sweep.has_replicas:
        of |= {str(name): own for name, own in sweep.stuck_after(preload).data_vars.items()}
    of = {name: own for name, own in of.items() if name not in ("interval", "preload")}
    for name, path in (("verdict", "validation/verdict"), ("independence", "independence/verdict")):
        if path in sweep:
            of[name] = sweep[path]
    ranges = sweep.model_range_after(preload)
    for name, own, unit in (("model_range", "pull_off_force", "N"), ("stuck_model_range", "stuck_probability", "%")):
        if ranges is not None and own in ranges:
            of[name] = xarray.apply_ufunc(
                lambda values, unit=unit: _range(values, unit), ranges[own],
                input_core_dims=[["plastic_contact"]], vectorize=True, output_dtypes=[object],
            )  # fmt: skip
    keys = {key.replace(".", "_") for key in sweep.keys}
    return xarray.Dataset({name: own.drop_vars([c for c in own.coords if c not in keys]) for name, own in of.items()})


def _finite_size(sweep: Sweep, of_sweep: Facts) -> Facts:
    """The facts of a sweep over the nominal area on how patches go to the integral, before any sweep's."""
    sizes = study(sweep)
    attrs, counts = sizes.attrs, sizes["asperity_count"].values
    numbers = []
    for accuracy, count, source in zip(
        *(sizes[name].values for name in ("accuracy", "count_at_accuracy", "count_at_accuracy_source")), strict=True
    ):
        text = f"{quantities.number(count, 3)} asperities" if math.isfinite(count) else "more than the sizes tell"
        numbers.append(Number(f"bias within {_percent(accuracy, 2)} from", text, str(source), float(count)))
    if "fit_exponent" in attrs:
        text = quantities.with_error(attrs["fit_exponent"], attrs["fit_exponent_standard_error"], "1")
        numbers.append(Number("exponent of the bias", text, "bias falls as the number of asperities to this power"))
    fit = Verdict("power law", "good", "fine", "a power law fits the bias")
    if "fit_refusal" in attrs:
        fit = Verdict("power law", "caution", "no fit", str(attrs["fit_refusal"]))
    columns = (counts, *(sizes[name].values for name in ("bias", "bias_standard_error", "relative_std", "p_value", "independence")))
    rows = [
        [str(n), f"{quantities.number(100 * b, 3)} ± {quantities.number(100 * e, 2)} %", _percent(s), quantities.number(q, 3), str(word)]
        for n, b, e, s, q, word in zip(*columns, strict=True)
    ]
    table = Table("Sizes", ["asperities", "mean less integral", "scatter", "p of the cross-check", "independence"], rows)
    computed = [("sizes", f"{counts.size}, from {counts.min()} to {counts.max()} asperities"), *of_sweep.computed]
    return replace(of_sweep, kind="patches of several sizes", numbers=numbers, verdicts=[*of_sweep.verdicts, fit], computed=computed,
                   tables=[table, *of_sweep.tables])  # fmt: skip


def _filter(attrs: dict[str, Any]) -> list[tuple[str, str]]:
    """The smoothing of a map, prominence and distance of its summits; nothing of files that do not say."""
    said = (
        ("smoothed, cut-off", "smooth"),
        ("prominence, at least", "prominence"),
        ("distance to a higher one, at least", "min_distance"),
    )
    return [(words, quantities.si(float(attrs[name]), "m")) for words, name in said if float(attrs.get(name, 0.0)) > 0.0]


def _asperities(result: Asperities) -> Facts:
    def of(name: str) -> float:
        return _value(result, f"equivalent/{name}")

    count = int(result.asperities.sizes["asperity"])
    numbers = [
        Number("density of asperities", f"{quantities.number(1e-12 * of('asperity_density'))} /µm²", "by the moments of the spectrum", of("asperity_density")),
        Number("radius of asperities", quantities.si(of("asperity_radius"), "m"), "by the moments of the spectrum", of("asperity_radius")),
        Number("standard deviation of their heights", quantities.si(of("asperity_height_std"), "m"), "by the moments of the spectrum", of("asperity_height_std")),
        Number("asperities found", str(count), "on the map", float(count)),
    ]  # fmt: skip
    rows = [
        [words, quantities.si(_value(result, f"measured/{name}") * scale, unit), quantities.si(of(name) * scale, unit)]
        for words, name, unit, scale in (
            ("density (1/µm²)", "asperity_density", "1", 1e-12),
            ("radius", "asperity_radius", "m", 1.0),
            ("mean height", "asperity_height_mean", "m", 1.0),
            ("standard deviation of heights", "asperity_height_std", "m", 1.0),
        )
    ]
    attrs = result.attrs
    dy, dx = (float(size) for size in attrs["pixel_size"])
    missing = int(attrs["missing_pixels"])
    computed = [
        ("map", f"{attrs['map']}, {' by '.join(str(int(n)) for n in attrs['map_shape'])} pixels"),
        ("pixel", f"{quantities.si(dx, 'm')} by {quantities.si(dy, 'm')}"),
        *([("rows levelled by", rows_by)] if (rows_by := str(attrs.get("level_rows", "none"))) != "none" else []),
        ("levelled by", str(attrs["level"])),
        *_filter(attrs),
        ("missing pixels", str(missing)),
        ("roughness Sq", quantities.si(math.sqrt(_value(result, "surface/m0")), "m")),
        ("α, bandwidth parameter", quantities.number(_value(result, "surface/alpha"))),
    ]
    verdicts = [
        _validity(result),
        Verdict("resolution", "caution" if missing else "good", f"{missing} missing" if missing else "whole", "pixels without a height"),
    ]
    command = ["stiction", "asperities", str(attrs["map"]), "--pixel", f"{dx * 1e9:.15g} nm,{dy * 1e9:.15g} nm", "--level", str(attrs["level"])]
    if rows_by != "none":
        command += ["--level-rows", rows_by]
    for name in ("smooth", "prominence", "min_distance"):
        if float(attrs.get(name, 0.0)) > 0.0:
            command += [f"--{name.replace('_', '-')}", f"{float(attrs[name])!r} m"]
    if int(attrs.get("cutoffs", 0)) > 0:
        command += ["--cutoffs", str(int(attrs["cutoffs"]))]
    if attrs.get("height_unit"):
        command += ["--height-unit", str(attrs["height_unit"])]
    commands = f"{shlex.join([*command, '-o', result.path.name])}\n"
    table = Table("Asperities", ["", "measured", "by the moments"], rows)
    return Facts("asperities of a map", numbers, verdicts, computed, commands, [str(attrs["map"])], [table])


def _finding(result: Finding) -> Facts:
    return Facts(f"result of `{result.format.made_by}`", [], [], [], "", [])


_OF: dict[Any, Any] = {Run: _run, Sweep: _sweep, Asperities: _asperities, Finding: _finding}
