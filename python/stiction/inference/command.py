"""`stiction infer DATA.csv SCENE.toml`: parameters of a scene from measured outcomes of patches."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from .. import files
from ..errors import FileError
from ..plot.style import picture
from ..progress import work
from ..scenes import named_files
from ..terminal import ended, given_words, real, whole
from . import calibration, figures, found, posterior

__all__ = ["main"]

_ENDINGS = (".png", ".pdf", ".svg")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction infer",
        description="Infer parameters of a scene, such as the work of adhesion, from measured outcomes of patches: "
        "their posterior, what the data do not tell, and whether the model may have made the data.",
        epilog="Examples: stiction infer first.csv first.toml; stiction infer first.csv first.toml --figure first.pdf; "
        "stiction infer coupled.csv coupled.toml --model independent.toml. Exit codes: 0 done; 1 it failed while running; 2 the command, the scene or the data are wrong.",
    )
    parser.add_argument("data", type=Path, metavar="DATA.csv", help="measured outcomes, a column each, headed as `pull_off_force (uN)`")
    parser.add_argument("scene", type=Path, metavar="SCENE.toml", help="the scene, with priors for some numbers")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.h5", help="the result; by default the name of the scene with _infer.h5, here")
    parser.add_argument("--figure", type=Path, metavar="OUT", help="the figures, .png, .pdf or .svg; by default none")
    parser.add_argument("--model", action="append", default=[], type=Path, metavar="OTHER.toml",
                        help="another scene with priors to compare with, such as of another law, of other heights, or of coupled asperities; "
                        "may be given several times. Its result is the name of that scene with _infer.h5, next to OUT.h5")  # fmt: skip
    parser.add_argument("--seed", type=whole, default=1, metavar="N", help="seed of simulations and chains, by default 1")
    parser.add_argument("--threads", type=whole, metavar="N", help="threads of the simulations, or experiments of --calibrate at once, by default one per core")
    parser.add_argument("--end-error", type=real, default=0.02, metavar="X",
                        help="error of the ends of 95 %% intervals over their width that the chains leave, by default 0.02")  # fmt: skip
    parser.add_argument("--emulator-error", type=real, default=0.2, metavar="X",
                        help="shift of the posterior by the error of the fitted density, over its standard deviation, by default 0.2: patches are "
                        "simulated, in proportion to the data, until fresh ones show less")  # fmt: skip
    parser.add_argument("--calibrate", type=whole, metavar="N",
                        help="infer from N synthetic data like these instead, of parameters drawn from the priors: how often intervals contain them; "
                        "the result is the name of the scene with _calibration.h5")  # fmt: skip
    parser.add_argument("--resume", action="store_true",
                        help="go on with the patches that OUT.h5.partial or OUT.h5 has, such as of an interrupted inference or of other data of this "
                        "scene; errors to reach are of all patches together")  # fmt: skip
    parser.add_argument("--reuse", type=Path, metavar="OTHER.h5", help="another result of this scene, whose simulated patches are taken, too")
    parser.add_argument("--missing", choices=("refuse", "drop"), default="refuse",
                        help="whether a gap of the table, such as an empty cell or #N/A, is an error, or was not measured")  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite what is there")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, infers, and prints the result; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(given_words(arguments))
    if given.figure is not None and given.figure.suffix.lower() not in _ENDINGS:
        parser.error(f"--figure {given.figure}: a name that ends with {', '.join(_ENDINGS)} is needed")
    if given.calibrate is not None and (given.model or given.reuse):
        parser.error("--calibrate: it is of one scene, with patches of its own; leave --model and --reuse out")
    return ended("stiction infer", lambda: _infer(given) if given.calibrate is None else _calibrate(given), is_long=True)


def _calibrate(given: argparse.Namespace) -> None:
    output = given.output or Path(f"{given.scene.stem}_calibration.h5")
    written = [path for path in (output, given.figure) if path is not None]
    for path in written:
        files.check(path, force=given.force or given.resume, inputs=[given.data, *named_files(given.scene)])
    ranked = calibration.calibrate(
        given.data, given.scene, output, count=given.calibrate, seed=given.seed, threads=given.threads, end_error=given.end_error,
        emulator_error=given.emulator_error, missing=given.missing, resume=given.resume, force=given.force,
    )  # fmt: skip
    print(f"{given.scene}\n{ranked}")
    if given.figure is not None:
        with files.writing(given.figure, force=given.force or given.resume) as part:
            part.write_bytes(picture(figures.ranks(ranked), given.figure.suffix))
    print("\n".join(str(path) for path in written))


def _infer(given: argparse.Namespace) -> None:
    output = given.output or Path(f"{given.scene.stem}_infer.h5")
    outputs = [output, *(output.with_name(f"{scene.stem}_infer.h5") for scene in given.model)]
    written = outputs if given.figure is None else [*outputs, given.figure]
    inputs = [given.data, *(path for scene in (given.scene, *given.model) for path in named_files(scene))]
    for path in written:
        if written.count(path) > 1:
            raise FileError(f"{path} would be written twice; give other names to the scenes, or another output")
        files.check(path, force=given.force or given.resume, inputs=inputs)
    if len({scene.resolve() for scene in (given.scene, *given.model)}) <= len(given.model):
        raise FileError("--model: a scene is there twice; others than SCENE.toml are needed, each once")
    # Errors are reported before minutes are spent on others.
    for scene in given.model:
        posterior.checked(given.data, scene, given.missing)
    options = {"missing": given.missing, "seed": given.seed, "threads": given.threads, "end_error": given.end_error, "emulator_error": given.emulator_error, "resume": given.resume}
    results = {}
    for scene, path in zip((given.scene, *given.model), outputs, strict=True):
        with work(scene.name if given.model else ""):
            results[str(scene)] = result = posterior.infer(given.data, scene, path, force=given.force, reuse=given.reuse if scene == given.scene else None, **options)
        print(f"{scene}\n{result}", flush=True)
        if given.figure is not None and scene == given.scene:
            with files.writing(given.figure, force=given.force, inputs=inputs) as part:
                part.write_bytes(picture(figures.page(result), given.figure.suffix))
    if given.model:
        print(f"\n{found.models(results)[['elpd_loo', 'elpd_diff', 'dse', 'weight', 'warning']].to_string()}")
    print("\n".join(str(path) for path in written))
