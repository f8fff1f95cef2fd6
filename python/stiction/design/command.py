"""`stiction design SCENE.toml`: the probability of failure, and the number that makes it as rare as wanted."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from .. import priors, quantities
from ..errors import SceneError
from ..terminal import ended
from .estimate import Probability
from .search import Best, Design, best, design, event, probability

__all__ = ["main"]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction design",
        description="Find how probable it is that a patch pulls harder than a threshold, by tilted heights, or less, by importance splitting: "
        "probabilities of 1e-6 in seconds to minutes. With --maximise or --minimise: the largest or smallest value of a number of the scene with which "
        "that probability is at most the wanted one; or, of pull_off_force, the value with which the force that patches exceed with it is "
        "least, or that they stay below largest.",
        epilog="Examples: stiction design configs/case_i.toml --above '3 uN'; stiction design configs/case_i.toml --below "
        "'0.24 uN'; stiction design configs/inference/design.toml --maximise "
        "surface.lubricant_thickness --above '0.15 mN' --probability 1e-3. "
        "Exit codes: 0 done; 1 failed while running; 2 the command or the scene is wrong.",
    )
    parser.add_argument("scene", type=Path, metavar="SCENE",
                        help="a scene; with --maximise or --minimise the number has a prior uniform or log_uniform, its range")  # fmt: skip
    side = parser.add_mutually_exclusive_group()
    side.add_argument("--above", metavar="FORCE", help="patches that pull harder count, such as '5 uN'")
    side.add_argument("--below", metavar="FORCE", help="patches that pull less count")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--maximise", metavar="KEY", help="the number to make as large as possible, or pull_off_force")
    which.add_argument("--minimise", metavar="KEY", help="the number to make as small as possible, or pull_off_force")
    parser.add_argument("--probability", type=float, metavar="P", help="largest probability of the patches")
    parser.add_argument("--error", type=float, default=0.1, metavar="E",
                        help="relative standard error of each probability; by default 0.1")  # fmt: skip
    parser.add_argument("--seed", type=int, metavar="N", help="seed, instead of the scene's")
    parser.add_argument("--threads", type=int, metavar="N", help="threads; by default one per core")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, computes, and says what was found; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(arguments)
    key = given.maximise or given.minimise
    if (key is None) != (given.probability is None):
        parser.error("--probability: it is needed with --maximise or --minimise, and with them alone")
    if (given.above is None and given.below is None) != (key == _FORCE):
        parser.error(f"--above or --below: one of them is needed, but with --maximise or --minimise {_FORCE} none")
    return ended("stiction design", lambda: _design(given, key))


def _design(given: argparse.Namespace, key: str | None) -> None:
    if key == _FORCE:
        most = given.maximise is not None
        print(_best(best(given.scene, given.probability, largest=most, error=given.error, seed=given.seed, threads=given.threads), given))
        return
    happens = event(given.above, given.below)
    common = {"above": given.above, "below": given.below, "error": given.error, "seed": given.seed, "threads": given.threads}
    if key is None:
        print(f"probability of {happens}\n{_told(probability(given.scene, **common), given.below is not None)}")
        return
    found = priors.read(given.scene)
    if found.keys != [key]:
        raise SceneError(f"{key}: this number of the scene, and no other, needs a range (a prior); there is one of {', '.join(found.keys)}")
    print(_designed(design(given.scene, given.probability, largest=given.maximise is not None, **common), given, str(happens)))


def _told(found: Probability, below: bool) -> str:
    if found.value == 0.0:
        return f"  {_RARER}"
    if found.hits == found.replicas:
        return f"  at least {quantities.number(found.interval[0], 3)}, as all of {found.replicas} patches are such (95 %)"
    low, high = (quantities.number(end, 2) for end in found.interval)
    return (
        f"  {quantities.number(found.value, 3)} ± {100.0 * found.relative_error:.0f} %, 95 % interval {low} to {high}\n"
        f"  from {found.replicas} patches, {found.hits} of them such; plain sampling needs "
        f"{quantities.number((1.0 - found.value) / found.value / found.relative_error**2, 2)} for this error\n"
        f"  they weigh as {found.effective:.0f} alike {'runs' if below else 'patches'} would, the largest weight is "
        f"{100.0 * found.largest:.1f} % of all; mean weight {found.total:.3f} ± {found.total_error:.3f}, which has to be 1"
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


_RARER = "none, or rarer than 10⁻¹⁸"
# Not a number of the scene but what its patches do.
_FORCE = "pull_off_force"
