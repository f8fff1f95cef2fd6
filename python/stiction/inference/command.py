"""`stiction infer DATA.csv SCENE.toml`: parameters of a scene from measured outcomes of patches."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..errors import FileError, SceneError, StictionError

__all__ = ["main"]

_ENDINGS = (".png", ".pdf", ".svg")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction infer",
        description="Infer parameters of a scene, such as the work of adhesion, from measured outcomes of patches: "
        "their posterior, what the data do not tell, and whether the model may have made the data.",
        epilog="Examples: stiction infer first.csv first.toml; stiction infer first.csv first.toml --model model.law=emd "
        "--figure first.pdf. Exit codes: 0 done; 1 it failed while running; 2 the command, the scene or the data are wrong.",
    )
    parser.add_argument("data", type=Path, metavar="DATA.csv", help="measured outcomes, a column each, headed as `pull_off_force (uN)`")
    parser.add_argument("scene", type=Path, metavar="SCENE.toml", help="the scene, with priors in the place of numbers")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.h5", help="the result; by default the name of the scene with _infer.h5, here")
    parser.add_argument("--figure", type=Path, metavar="OUT", help="the figures, .png, .pdf or .svg; by default none")
    parser.add_argument("--model", action="append", default=[], metavar="KEY=VALUE[,KEY=VALUE]",
                        help="another model to compare with the scene's, such as model.law=emd or substrate.coupling=periodic; may be given several times")  # fmt: skip
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="seed of simulations and chains, by default 1")
    parser.add_argument("--threads", type=int, metavar="N", help="threads of the simulations, by default one per core")
    parser.add_argument("--end-error", type=float, default=0.02, metavar="X",
                        help="Monte Carlo error of the ends of 95 %% intervals over their width, by default 0.02")  # fmt: skip
    parser.add_argument("--emulator-error", type=float, default=0.2, metavar="X",
                        help="error of the fitted density over the posterior's scatter, by default 0.2")  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite what is there")
    return parser


def _changes(texts: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Keys and values of the models to compare, by their texts."""
    result: dict[str, dict[str, Any]] = {}
    for text in texts:
        pairs = [pair.partition("=") for pair in text.split(",")]
        if not all(key.count(".") == 1 and value for key, _, value in pairs):
            raise SceneError(f"--model {text}: keys of the scene with their values are needed, such as model.law=emd")
        result[text] = {key.strip(): value.strip() for key, _, value in pairs}
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, infers, and tells the result; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(arguments)
    if given.figure is not None and given.figure.suffix.lower() not in _ENDINGS:
        parser.error(f"--figure {given.figure}: a name that ends with {', '.join(_ENDINGS)} is needed")
    try:
        _infer(given)
    except (StictionError, OSError) as error:
        told = " ".join(str(error).split()).replace("force=True", "--force")
        print(f"stiction infer: {told}", file=sys.stderr)
        return error.exit_code if isinstance(error, StictionError) else 1
    return 0


def _infer(given: argparse.Namespace) -> None:
    try:
        from . import figures, posterior
    except ImportError as error:
        raise StictionError(f"{error.name} is not installed: pip install 'stiction[inference]' brings it", 2) from None
    output = given.output or Path(f"{given.scene.stem}_infer.h5")
    for path in (output, given.figure):
        if path is not None and path.exists() and not given.force:
            raise FileError(f"{path} exists; give force=True to overwrite it, or another output")
    options = {"seed": given.seed, "threads": given.threads, "end_error": given.end_error, "emulator_error": given.emulator_error}
    changed = _changes(given.model)
    own = posterior.infer(given.data, given.scene, output, force=given.force, **options)
    print(own)
    if given.figure is not None:
        from ..plot.style import context

        figure = figures.page(own)
        with context():
            figure.savefig(given.figure)
    if changed:
        results = {"the scene": own}
        for name, keys in changed.items():
            results[name] = posterior.infer(given.data, posterior.with_keys(given.scene, keys), **options)
            print(f"\n{name}\n{results[name]}")
        print(f"\n{posterior.models(results)[['elpd_loo', 'elpd_diff', 'dse', 'weight', 'warning']].to_string()}")
    print(output if given.figure is None else f"{output}\n{given.figure}")
