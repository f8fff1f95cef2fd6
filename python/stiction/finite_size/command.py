"""`stiction finite-size SCENE.toml`: from how many asperities on the integral is good enough."""

from __future__ import annotations

import argparse
import math
import sys
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import xarray

from .. import quantities
from ..errors import SceneError
from ..results import Sweep, agreement
from ..scenes import Scene, setting
from ..terminal import ended, given_words, whole
from .patches import run
from .study import study

__all__ = ["main"]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction finite-size",
        description="Find how the pull-off of a finite patch approaches the integral's as its asperities become "
        "more: a sweep over surface.nominal_area, and a table of what it says.",
        epilog="Example: stiction finite-size configs/case_ii.toml --counts 10:1e5:9 --replicas 200. "
        "Exit codes: 0 done; 1 failed while running; 2 the command or the scene is wrong; 130 interrupted, "
        "--resume goes on.",
    )
    add = parser.add_argument
    of_counts = "numbers of asperities, with commas between; FROM:TO:COUNT are that many by equal factors"
    of_output = "where the sweep goes; by default the name of the scene with _finite_size.h5, in this folder"
    add("scene", metavar="SCENE", help="the scene, TOML; - for standard input")
    add(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="set a key; may be given several times",
    )
    add("--counts", default="10:1e6:11", metavar="N,N...", help=f"{of_counts}; by default 10:1e6:11")
    add("-o", "--output", type=Path, metavar="FILE.h5", help=of_output)
    add("--replicas", type=whole, metavar="N", help="patches of each size, instead of the scene's")
    add("--seed", type=whole, metavar="N", help="seed, instead of the scene's")
    add("--threads", type=whole, metavar="N", help="threads; by default one per core")
    add("--resume", action="store_true", help="go on with an interrupted study of this output")
    add("--force", action="store_true", help="overwrite a file that is there")
    add("--quiet", action="store_true", help="no progress")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, computes the sweep and prints its table; returns the exit code."""
    given = _parser().parse_args(given_words(arguments))
    return ended("stiction finite-size", lambda: _study(given))


def _study(given: argparse.Namespace) -> None:
    output = given.output or Path(f"{Path(given.scene).stem}_finite_size.h5")
    scene: Scene = given.scene
    if given.scene == "-":
        if given.output is None:
            raise SceneError("a scene from standard input has no name for its result; name one with -o")
        try:
            scene = tomllib.loads(sys.stdin.read())
        except ValueError as error:
            raise SceneError(f"standard input: not TOML: {error}") from None
    options = {name: getattr(given, name) for name in ("replicas", "seed", "threads", "resume", "force")}
    settings = dict(setting(text) for text in given.set)
    progress = False if given.quiet else None
    with run(scene, given.counts, output, progress=progress, **options, **settings) as sweep:
        print("\n".join(table(sweep)))
    print(_row("written", str(output)))


def _row(label: str, text: str) -> str:
    return f"  {label:<18}{text}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.1e} %" if 0.0 < abs(share) < 1e-4 else f"{100.0 * share:.2f} %"


def table(sweep: Sweep) -> Iterator[str]:
    """Lines of the table of a study."""
    found = study(sweep)
    per_asperity = quantities.si(found.attrs["integral_pull_off_per_asperity"], "N")
    if sweep.title:
        yield sweep.title
    yield _row("integral", f"pull-off {per_asperity} for each asperity")
    coupling = sweep.scene.get("substrate", {}).get("coupling", "none")
    if coupling != "none":
        yield _row("coupling", f"{coupling}, which the integral leaves out")
    yield _row("columns", "N; mean pull-off less the integral's; patch-to-patch")
    yield _row("", "standard deviation; skewness; 5 % to 95 % of patches")
    head = "N,bias,std,skewness,5 to 95 %,independence"
    yield "\n" + _columns(*head.split(","))
    sizes = [found.isel(asperity_count=place) for place in range(found.sizes["asperity_count"])]
    for one in sizes:
        low, high = one["pull_off_quantiles"].sel(quantile=[0.05, 0.95]).values
        yield _columns(
            one["asperity_count"].item(), _bias(one["bias"].item(), one["bias_standard_error"].item()),
            _percent(one["relative_std"].item()), f"{one['skewness'].item():.2f}", f"{low:.3f} to {high:.3f}",
            one["independence"].item(),
        )  # fmt: skip
    yield ""
    for one in sizes:
        if one["most_differing"].item() > 0.0:
            agree = agreement(one["replica_count"].item(), one["most_differing"].item())
            yield _row("", f"N = {one['asperity_count'].item()}: {agree}")
    yield from _approach(found)
    for place in range(found.sizes["accuracy"]):
        one = found.isel(accuracy=place)
        reached = _reached(found, one["count_at_accuracy"].item(), one["count_at_accuracy_source"].item())
        yield _row("" if place else "good to", f"{100 * one['accuracy'].item():>3.0f} % from {reached}")
    attrs = sweep["validation"].attrs
    yield _row("cross-check", f"ensemble and integral {attrs['overall_verdict']} for all sizes together,")
    yield _row("", f"at the {100 * float(attrs['significance']):g} % level")


def _columns(*cells: Any) -> str:
    count, bias, std, skewness, patches, independence = cells
    return f"{count:>9} {bias:>21} {std:>9} {skewness:>8} {patches:>16} {independence:>12}"


def _bias(bias: float, error: float) -> str:
    if math.isnan(error):
        return f"{100.0 * bias:+.2f} %" if bias < 1.0 else f"x {1.0 + bias:.3f}"
    if bias < 1.0:
        return f"{100.0 * bias:+.2f} % ± {_percent(error)}"
    return f"x {1.0 + bias:.4f} ± {error:.4f}"


def _approach(found: xarray.Dataset) -> Iterator[str]:
    """The power law, or why there is none."""
    attrs = found.attrs
    if "fit_refusal" in attrs:
        yield _row("approach", "no power law, and nothing beyond the largest size:")
        yield _row("", str(attrs["fit_refusal"]))
        return
    law = f"bias = {attrs['fit_coefficient']:.3f} N^-{attrs['fit_exponent']:.3f}"
    yield _row("approach", f"{law}, exponent ± {attrs['fit_exponent_standard_error']:.2g}")
    freedom, chi = attrs["fit_degrees_of_freedom"], attrs["fit_chi_squared"]
    degrees = "1 degree" if freedom == 1 else f"{freedom} degrees"
    yield _row("", f"fitted to {freedom + 2} sizes, chi squared {chi:.1f} for {degrees} of freedom")


def _reached(found: xarray.Dataset, count: float, source: str) -> str:
    counts = found["asperity_count"].values
    words = {
        "below the smallest": f"N = {counts[0]} already",
        "beyond the largest": f"beyond N = {counts[-1]}",
        "unknown": "unknown: the bias is not known as well as that",
    }
    number = f"{count:.2e}".replace("e+0", "e").replace("e+", "e")
    return words.get(source) or f"N = {number} ({source})"
