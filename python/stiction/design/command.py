"""`stiction design SCENE.toml`: the probability of failure, the number that makes it as rare as wanted, the number of forces to measure."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from .. import files, priors, quantities
from ..errors import SceneError
from ..scenes import named_files
from ..terminal import ended, given_words, real, whole
from .estimate import Probability
from .needed import Needed, measurements
from .search import Best, Design, best, design, event, probability

__all__ = ["main"]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction design",
        description="Find how probable it is that a patch pulls harder than a threshold, by tilted heights, or less, by importance splitting: "
        "probabilities of 1e-6 in seconds to minutes. With --maximise or --minimise: the largest or smallest value of a number of the scene with which "
        "that probability is at most the wanted one; or, of pull_off_force, the value with which the force that patches exceed with it is "
        "least, or that they stay below largest. With --parameter and --accuracy: the number of pull-off forces to measure for "
        "that interval of a number of the scene, or never, what limits it, and the size of patches or the preload with the fewest forces.",
        epilog="Examples: stiction design configs/case_i.toml --above '3 uN'; stiction design configs/case_i.toml --below "
        "'0.24 uN'; stiction design configs/inference/design.toml --maximise "
        "surface.lubricant_thickness --above '0.15 mN' --probability 1e-3; stiction design configs/inference/extremes.toml --parameter "
        "material.work_of_adhesion --accuracy '10 %%' --force-error '5 nN'. "
        "Exit codes: 0 done; 1 failed while running; 2 the command or the scene is wrong.",
    )
    parser.add_argument("scene", type=Path, metavar="SCENE",
                        help="a scene; with --maximise or --minimise the number has a prior uniform or log_uniform, its range; "
                        "with --parameter up to six numbers have priors")  # fmt: skip
    side = parser.add_mutually_exclusive_group()
    side.add_argument("--above", metavar="FORCE", help="patches that pull harder count, such as '5 uN'")
    side.add_argument("--below", metavar="FORCE", help="patches that pull less count")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--maximise", metavar="KEY", help="the number to make as large as possible, or pull_off_force")
    which.add_argument("--minimise", metavar="KEY", help="the number to make as small as possible, or pull_off_force")
    parser.add_argument("--probability", type=real, metavar="P", help="largest probability of the patches")
    parser.add_argument("--parameter", metavar="KEY", help="the number with a prior that forces are measured for")
    parser.add_argument("--accuracy", metavar="WIDTH",
                        help="half of its 95 %% interval, over the value or with a unit, such as '5 %%' or '2 mJ/m^2'")  # fmt: skip
    parser.add_argument("--force-error", metavar="ERROR",
                        help="with --parameter: standard deviation of the measurement of one force, such as '5 nN' or '2 %%'; by default none")  # fmt: skip
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.h5",
                        help="the result as a file, for `stiction info`, `report` and, of a search, `plot`; by default none")  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite a file that is there")
    parser.add_argument("--error", type=real, metavar="E",
                        help="relative standard error of each probability; by default 0.1")  # fmt: skip
    parser.add_argument("--seed", type=whole, metavar="N", help="seed, instead of the scene's")
    parser.add_argument("--threads", type=whole, metavar="N", help="threads; by default one per core")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, computes, and says what was found; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(given_words(arguments))
    key = given.maximise or given.minimise
    if given.parameter or given.accuracy or given.force_error:
        _check_measurements(parser, given)
        return ended("stiction design", lambda: _design(given, key), is_long=True)
    given.error = 0.1 if given.error is None else given.error
    if (key is None) != (given.probability is None):
        parser.error("--probability: it is needed with --maximise or --minimise, and with them alone")
    if (given.above is None and given.below is None) != (key == _FORCE):
        parser.error(f"--above or --below: one of them is needed, but with --maximise or --minimise {_FORCE} none")
    return ended("stiction design", lambda: _design(given, key), is_long=True)


def _check_measurements(parser: argparse.ArgumentParser, given: argparse.Namespace) -> None:
    """Ends the command where the number of forces is asked for with an option that has no part in it."""
    if given.parameter is None or given.accuracy is None:
        parser.error("--parameter and --accuracy: each needs the other, and --force-error both")
    for name in ("above", "below", "maximise", "minimise", "probability", "error"):
        if getattr(given, name) is not None:
            parser.error(f"--{name}: not with --parameter, which asks for the number of forces")


def _design(given: argparse.Namespace, key: str | None) -> None:
    if given.output is not None:
        files.check(given.output, force=given.force, inputs=named_files(given.scene))
    words, found = _found(given, key)
    print(words)
    if given.output is None:
        return
    tables = priors.opened(given.scene)
    text = given.scene.read_text(encoding="utf-8")
    found.attrs |= {"format": "stiction-design", "format_version": np.array(_VERSION), "title": str(tables.get("title", "")),
                    "scene": text, "summary": words}  # fmt: skip
    with files.writing_hdf5(given.output, force=given.force, inputs=named_files(given.scene)) as part:
        found.to_netcdf(part, engine="h5netcdf")
    print(given.output)


def _found(given: argparse.Namespace, key: str | None) -> tuple[str, xarray.Dataset]:
    """What was found, in words and as a dataset."""
    if given.parameter is not None:
        needed = measurements(
            given.scene, given.parameter, given.accuracy, force_error=given.force_error, seed=given.seed, threads=given.threads
        )
        return str(needed), _needed(needed)
    if key == _FORCE:
        most = given.maximise is not None
        force = best(given.scene, given.probability, largest=most, error=given.error, seed=given.seed, threads=given.threads)
        values = {"force": ("value", [of for _, of in force.tried], {"units": "N", "long_name": "pull-off force of the wanted probability"})}
        return _best(force, given), _searched(force, values, given, "pull-off force")
    happens = event(given.above, given.below)
    common = {"above": given.above, "below": given.below, "error": given.error, "seed": given.seed, "threads": given.threads}
    if key is None:
        one = probability(given.scene, **common)
        after = " after the largest preload" if "preload" in priors.opened(given.scene).get("instability", {}) else ""
        alone = {"probability": one.value, "probability_standard_error": one.standard_error, "probability_interval": ("range_end", list(one.interval))}
        words = f"probability of {happens}{after}\n{_told(one, given.below is not None)}"
        return words, xarray.Dataset(alone, attrs={"event": f"{happens}{after}"})
    found = priors.read(given.scene)
    if found.keys != [key]:
        raise SceneError(f"{key}: this number of the scene, and no other, needs a range (a prior); there is one of {', '.join(found.keys)}")
    searched = design(given.scene, given.probability, largest=given.maximise is not None, **common)
    values = {
        "probability": ("value", [of.value for _, of in searched.tried], {"units": "1", "long_name": "probability of the event"}),
        "probability_standard_error": ("value", [of.standard_error for _, of in searched.tried], {"units": "1", "long_name": "its standard error"}),
    }
    return _designed(searched, given, str(happens)), _searched(searched, values, given, str(happens))


def _needed(found: Needed) -> xarray.Dataset:
    """The number of forces of each choice."""
    columns = {
        "forces": ("choice", [of.forces for of in found.choices], {"units": "1", "long_name": "forces to measure, infinite for never"}),
        "forces_interval": (("choice", "range_end"), [of.interval for of in found.choices], {"units": "1", "long_name": "95 % interval of the number"}),
        "least": ("choice", [of.least for of in found.choices], {"units": "1", "long_name": "half of the interval after 100 000 forces"}),
        "checked": ("experiment", np.array(found.checked), {"units": "1", "long_name": "half of the interval of a synthetic experiment"}),
    }
    attrs = {"key": found.key, "units": found.unit, "at": found.value, "accuracy": found.accuracy, "held": found.held}
    if found.limit is not None:
        attrs |= {"limit": found.limit.key, "limit_known": found.limit.known, "limit_forces": found.limit.forces,
                  "limit_least": found.limit.least}  # fmt: skip
    return xarray.Dataset(columns, coords={"choice": [of.words for of in found.choices]}, attrs=attrs)


def _searched(found: Design | Best, values: dict[str, Any], given: argparse.Namespace, event: str) -> xarray.Dataset:
    """What was found at each value that was tried, in the order of the values."""
    tried = [value for value, _ in found.tried]
    units = {"units": found.unit, "long_name": found.key}
    attrs = {"key": found.key, "event": event, "wanted": given.probability, "found": found.value, "interval": np.array(found.interval)}
    if isinstance(found, Best):
        # The interval of the force, at the value that was found.
        attrs |= {"interval": np.array([found.value, found.value]), "force": found.force, "force_interval": np.array(found.interval)}
    return xarray.Dataset(values, coords={"value": ("value", tried, units)}, attrs=attrs).sortby("value")


def _told(found: Probability, below: bool) -> str:
    if found.value == 0.0:
        return f"  {_RARER}"
    if found.hits == found.replicas:
        return f"  at least {quantities.number(found.interval[0], 3)}, as all of {found.replicas} patches are such (95 %)"
    low, high = (quantities.number(end, 2) for end in found.interval)
    plain = quantities.number((1.0 - found.value) / found.value / found.relative_error**2, 2)
    return (
        f"  {quantities.number(found.value, 3)} ± {100.0 * found.relative_error:.0f} %, 95 % interval {low} to {high}\n"
        f"  one in {quantities.number(1.0 / found.value, 2)} patches\n"
        f"  from {found.replicas} patches, {found.hits} of them in the event; effective sample size\n"
        f"  {found.effective:.0f}{' runs' if below else ''}, largest weight {100.0 * found.largest:.1f} %; plain sampling needs {plain}"
    )


def _designed(found: Design, given: argparse.Namespace, happens: str) -> str:
    word = "largest" if given.maximise is not None else "smallest"
    lines = [f"{happens} at most with probability {quantities.number(given.probability, 2)}"]
    for value, of in found.tried:
        rare = f"{quantities.number(of.value, 3)} ± {100.0 * of.relative_error:.0f} %" if of.value > 0.0 else _RARER
        lines.append(f"  {quantities.si(value, found.unit):>12}   {rare}")
    if found.at_end:
        lines.append(f"{word} {found.key}: {quantities.si(found.value, found.unit)}, the end of its range, where it is rarer still")
    else:
        low, high = (quantities.si(end, found.unit) for end in found.interval)
        lines.append(f"{word} {found.key}: {quantities.si(found.value, found.unit)}, 95 % interval {low} to {high}")
    return "\n".join(lines)


def _best(found: Best, given: argparse.Namespace) -> str:
    most = given.maximise is not None
    side = "less" if most else "harder"
    lines = [f"force than which patches pull {side} with probability {quantities.number(given.probability, 2)}"]
    lines += [f"  {quantities.si(value, found.unit):>12}   {quantities.si(force, 'N')}" for value, force in found.tried]
    low, high = (quantities.si(end, "N") for end in found.interval)
    lines.append(
        f"{'largest' if most else 'least'} at {found.key} = {quantities.si(found.value, found.unit)}: {quantities.si(found.force, 'N')}, "
        f"95 % interval {low} to {high}"
    )
    return "\n".join(lines)


_VERSION = (1, 0)
_RARER = "none, or rarer than 10⁻¹⁸"
# Not a number of the scene but what its patches do.
_FORCE = "pull_off_force"
