"""Experiments: runs, sweeps, comparisons of laws, the integral alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from . import program
from .errors import SceneError
from .opened import Place, Run, Sweep
from .scenes import Scene, Source

__all__ = ["check", "check_settings", "compare", "integral", "patches", "run", "seed_of", "sweep"]

#: Keys of ensembles that are parts of another answer, which the range over plastic contacts would only slow down.
ONE_MODEL: dict[str, Any] = {"ensemble.model_range": False}


def run(
    scene: Scene,
    output: str | Path | None = None,
    *,
    replicas: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    resume: bool = False,
    force: bool = False,
    progress: bool | None = None,
    **overrides: Any,
) -> Any:
    """Computes a scene.

    Parameters
    ----------
    scene : path or dict
        The TOML file of the scene, or its tables: ``{"material": {"reduced_modulus": "85 GPa", ...}, ...}``. Values are texts with
        a unit, numbers without one, or pint quantities. Heights and radii of asperities may be arrays (m), ``surface.asperities``
        what `find_asperities` returned.
    output : path, optional
        The result file. Without it the file is temporary and goes with the result; ``result.save(path)`` keeps it.
    replicas, seed : int, optional
        Instead of the scene's; 0 replicas give the integral alone.
    threads : int, optional
        One per core by default. They do not change the result.
    resume : bool
        Whether to go on with a run of this `output` that was interrupted.
    force : bool
        Whether an existing `output` is overwritten.
    progress : bool, optional
        Whether to show it, as bars on terminals and in notebooks, else as lines; by default on terminals and in notebooks only.
    **overrides
        Keys of the scene by their dotted names: ``**{"material.work_of_adhesion": "0.1 J/m^2"}``.

    Returns
    -------
    Run or Sweep
        A `Sweep` where the scene has a table ``[sweep]``.

    Raises
    ------
    SceneError
        The scene or an argument is wrong; the message names the key.
    StictionError
        The run failed.
    KeyboardInterrupt
        It was interrupted. With `output` finished replicas are kept; this call with ``resume=True`` goes on.

    Examples
    --------
    >>> import stiction
    >>> result = stiction.run("configs/quick.toml", replicas=20, **{"ensemble.seed": 2})
    >>> result.pull_off.replicas
    20
    """
    _named(output, resume=resume)
    options = program.options(replicas=replicas, seed=seed, threads=threads, resume=resume)
    return _computed("run", scene, output, overrides, [*options], force, progress)


def sweep(
    scene: Scene,
    axes: Mapping[str, Any],
    output: str | Path | None = None,
    *,
    mode: str = "grid",
    replicas: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    resume: bool = False,
    force: bool = False,
    progress: bool | None = None,
    **overrides: Any,
) -> Sweep:
    """Computes a scene at several values of some of its keys. The other arguments are as in `run`.

    Parameters
    ----------
    axes : dict
        Values by dotted names: a list, or a dict with ``from``, ``to``, ``count`` and ``spacing``.
    mode : {"grid", "zip"}
        Every value with every other, or the first with the first.

    Examples
    --------
    >>> import stiction
    >>> films = {"surface.lubricant_thickness": ["0 nm", "0.5 nm"]}
    >>> points = stiction.sweep("configs/quick.toml", films, replicas=20)
    >>> points.pull_off["mean_over_patches"].sizes["surface_lubricant_thickness"]
    2
    """
    scene, added = _swept(scene, axes, mode)
    _named(output, resume=resume)
    options = program.options(replicas=replicas, seed=seed, threads=threads, resume=resume)
    result: Sweep = _computed("run", scene, output, {**overrides, **added}, [*options], force, progress)
    return result


def patches(
    scene: Scene,
    axes: Mapping[str, Any],
    *,
    replicas: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    progress: bool | None = None,
    **overrides: Any,
) -> xarray.Dataset:
    """Numbers and curves of each patch of a zipped `sweep`, for studies of hundreds of sweeps: the other groups of the file are not opened.

    It takes the arguments of `sweep`, and has its errors.

    Returns
    -------
    xarray.Dataset
        The group `replicas` of the result, over `point` and `replica`, in memory and in SI units.

    Examples
    --------
    >>> import stiction
    >>> films = {"surface.lubricant_thickness": ["0 nm", "0.5 nm"]}
    >>> dict(stiction.experiments.patches("configs/quick.toml", films, replicas=20)["pull_off_force"].sizes)
    {'point': 2, 'replica': 20}
    """
    scene, added = _swept(scene, axes, "zip")
    options = program.options(replicas=replicas, seed=seed, threads=threads)
    found: xarray.Dataset = _computed(
        "run", scene, None, {**overrides, **added}, [*options], False, progress, opened=Place.patches
    )  # fmt: skip
    return found


def compare(
    scene: Scene,
    laws: Sequence[str] = (),
    output: str | Path | None = None,
    *,
    ensemble: bool = False,
    replicas: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    force: bool = False,
    progress: bool | None = None,
    **overrides: Any,
) -> Sweep:
    """Computes a scene by several laws on the same asperities, by the integral and, if asked for, by ensembles: a sweep over `model.law`.

    The other arguments are as in `run`; `replicas` and `seed` need `ensemble`.

    Parameters
    ----------
    laws : sequence of str
        Names of laws, such as ``["hybrid", "emd"]``. The scene's own by default.
    ensemble : bool
        Whether explicit ensembles are summed too, with equal asperities for every law.

    Examples
    --------
    >>> import stiction
    >>> laws = stiction.compare("configs/case_ii.toml", ["hybrid", "emd"])
    >>> force = laws.integral["pull_off_force"]
    >>> f"{float(force.sel(model_law='emd') / force.sel(model_law='hybrid') - 1):+.1%}"
    '+15.8%'
    """
    if isinstance(laws, str):
        laws = laws.split(",")
    options = program.options(
        laws=",".join(laws) or None, ensemble=ensemble, replicas=replicas, seed=seed, threads=threads
    )
    result: Sweep = _computed("compare", scene, output, overrides, [*options], force, progress)
    return result


def integral(scene: Scene, **overrides: Any) -> xarray.Dataset:
    """The statistical integral of a scene alone, by its own law. The arguments are as in `run`.

    Returns
    -------
    xarray.Dataset
        `external_force`, `adhesion_force`, `contact_force` (N) and `contact_area` (m²) over `separation` (m), with `h_star` to
        select by; `pull_off_force` (N) and its place `pull_off_separation` (m). Of a loop they are on approach, with
        `retraction_` before their names on retraction, where the surfaces are pulled off.

    Examples
    --------
    >>> import stiction
    >>> curve = stiction.integral("configs/case_ii.toml")
    >>> f"{float(curve.pull_off_force):.3e} N"
    '5.622e-04 N'
    """
    alone = run(scene, replicas=0, progress=False, **overrides)
    if not isinstance(alone, Run):
        raise SceneError("the scene has a table [sweep], which `run` computes: leave it out")
    attrs = alone.tree["integral"].attrs
    return alone.integral.assign({name: attrs[name] for name in ("pull_off_force", "pull_off_separation")})


class Text(str):
    """A text of the program that a notebook shows as it is."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


def check(scene: Scene, **overrides: Any) -> Text:
    """Reports what a scene would compute and skip, the memory and disk it takes, and what looks wrong; computes nothing.

    Raises
    ------
    SceneError
        The scene is wrong; the message names every problem with its line. Or a run of it would be too large for this machine.
    """
    with Source(scene, overrides, None) as source:
        return Text(program.call(["check", *source.arguments], text=source.text))


def check_settings(*, seed: int | None, threads: int | None) -> None:
    """Refuses a seed or a number of threads that no run has, before work of several runs begins.

    Raises
    ------
    SceneError
        One of them is no whole number, or is out of range.
    """
    for name, value, low, high in (("seed", seed, 0, 2**63 - 1), ("threads", threads, 1, 4096)):
        if value is not None and not (isinstance(value, int | np.integer) and low <= value <= high):
            raise SceneError(f"{name} = {value}: a whole number from {low} to {high} is needed")


def seed_of(tables: Mapping[str, Any], seed: int | None) -> int:
    """The seed that is given, or that of a scene."""
    return int(tables.get("ensemble", {}).get("seed", 1)) if seed is None else seed


def _swept(scene: Scene, axes: Mapping[str, Any], mode: str) -> tuple[Scene, dict[str, Any]]:
    """A scene and its overrides with the axes of a sweep: a part of the tables, or of the overrides of a file."""
    if not isinstance(axes, Mapping) or not axes:
        raise SceneError(
            "axes: a dict of values by dotted keys is needed, such as {'material.hardness': ['1 GPa', '2 GPa']}"
        )
    if not isinstance(scene, Mapping):
        return scene, {f'sweep."{key}"': values for key, values in axes.items()} | {"sweep.mode": mode}
    swept = scene.get("sweep", {})
    if not isinstance(swept, Mapping):
        raise SceneError(f"sweep is a {type(swept).__name__}: a table is needed, a dict")
    return {**scene, "sweep": {**swept, **axes, "mode": mode}}, {}


def _named(output: str | Path | None, *, resume: bool) -> None:
    if resume and output is None:
        raise SceneError("resume=True: name the output of the run that was interrupted")


def _computed(
    command: str,
    scene: Scene,
    output: str | Path | None,
    overrides: Mapping[str, Any],
    options: list[str],
    force: bool,
    progress: bool | None,
    *,
    opened: Callable[[Place], Any] = Place.result,
) -> Any:
    """Calls a command that leaves a result, and opens that."""
    with Place(output) as place, Source(scene, overrides, place.path) as source:
        # A name may begin like an option.
        named = f"./{place.path}" if str(place.path).startswith("-") else str(place.path)
        arguments = [command, *source.arguments, "--output", named, *options, "--json-progress"]
        try:
            program.call([*arguments, *(["--force"] if force else [])], text=source.text, progress=progress)
        except KeyboardInterrupt as interruption:
            if output is None:
                raise KeyboardInterrupt("nothing was kept, as no output was named") from None
            kept = str(interruption).splitlines()
            goes_on = ["resume=True goes on"] if any("kept" in line for line in kept) else []
            raise KeyboardInterrupt("; ".join([*kept, *goes_on])) from None
        return opened(place)
