"""A scene with priors at Saltelli's points: sweeps of the program, a block each, and their results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from .. import experiments, files, priors
from ..errors import SceneError, StictionError, written_at_end
from ..progress import steps
from ..results import Result
from ..scenes import Scene, named_files, toml
from . import indices
from .words import QUANTITIES, words

__all__ = ["BLOCKS", "sensitivity"]

Array = NDArray[np.float64]

#: Independent blocks of points.
BLOCKS = 32
# Samples at least: with one row a block, intervals of 95 % hold the truth in 80 to 90 % of designs only.
_LEAST = 64
#: Points of a sweep at most.
_MOST_POINTS = 10_000
_VERSION = (1, 0)


def sensitivity(
    scene: Scene,
    output: str | Path | None = None,
    *,
    samples: int = 512,
    replicas: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    level: float = 0.95,
    force: bool = False,
    progress: bool | None = None,
) -> xarray.Dataset:
    """Sobol indices of pull-off, stiffness and energy of a patch over the priors of a scene.

    Parameters
    ----------
    scene : path or dict
        A scene with up to 6 numbers that have priors (`stiction.priors`), which are independent.
    output : path, optional
        HDF5 file for the result.
    samples : int
        Rows n of Saltelli's design, a power of 2 of at least 64: n (k + 2) points of k keys are computed, in 32 independent blocks.
    replicas : int, optional
        Patches at each point, instead of the scene's; all points of a block share them.
    seed, threads : int, optional
        As in `stiction.run`.
    level : float
        Probability that the intervals are to have, between 0.5 and 1.
    force : bool
        Whether an existing `output` is overwritten.
    progress : bool, optional
        Whether to show it, as in `stiction.run`.

    Returns
    -------
    xarray.Dataset
        Over `quantity` (pull_off_force, N; peak_secant_stiffness, N/m; energy, J) and `key`: `first_order` and `total` indices of the mean
        over patches, `scatter`, the fraction of the variance of one patch that is between patches, their `…_interval` over `range_end`,
        `mean` and `standard_deviation` of one patch in SI units. Energy is what a cycle dissipates with
        ``history = "loop"``, else the work to detach the surfaces from where they adhere without a force to the
        largest separation.

    Raises
    ------
    SceneError
        The scene, a prior or an argument is wrong; priors are correlated; sampling is not independent. A point that the program refuses is
        named with its numbers.
    """
    if samples < _LEAST or samples & (samples - 1):
        raise SceneError(f"samples = {samples}: a power of 2 of at least {_LEAST} is needed")
    if not 0.5 <= level < 1.0:
        raise SceneError(f"level = {level}: a number from 0.5 to below 1 is needed")
    experiments.check_settings(seed=seed, threads=threads)
    found = priors.read(scene)
    inputs = named_files(scene)
    if output is not None:
        files.check(output, force=force, inputs=inputs)
    tables, patches = _checked(found, replicas)
    k, rows = len(found.priors), samples // BLOCKS
    if rows * (k + 2) > _MOST_POINTS:
        raise SceneError(f"samples = {samples}: at most {_MOST_POINTS // (k + 2) * BLOCKS} can be had of {k} keys")
    first = int(tables.get("ensemble", {}).get("seed", 1)) if seed is None else seed
    cube = indices.points(k, rows, BLOCKS, first)
    seeds = np.random.SeedSequence([first, 1]).generate_state(BLOCKS)
    outcomes = {name: np.empty((BLOCKS, rows, k + 2, patches)) for name in QUANTITIES}
    with written_at_end():
        for block in steps(range(BLOCKS), "", "blocks of points", progress):
            axes = found.axes(found.draw(cube[block]))
            with experiments.sweep(
                tables, axes, mode="zip", replicas=patches, seed=int(seeds[block]), threads=threads, progress=False,
                **experiments.ONE_MODEL,
            ) as sweep:  # fmt: skip
                for name, values in _outcomes(sweep).items():
                    outcomes[name][block] = values.reshape(rows, k + 2, patches)
    estimated = {}
    for name, values in outcomes.items():
        if not np.isfinite(values).all():
            at = np.argwhere(~np.isfinite(values))[0]
            number = found.draw(cube[at[0]])[at[1] * (k + 2) + at[2]]
            numbers = ", ".join(f"{prior.key} = {prior.text(value)}" for prior, value in zip(found.priors, number, strict=True))
            raise StictionError(f"no {QUANTITIES[name][0]} of a patch at {numbers}: other ranges or separations are needed")
        try:
            estimated[name] = indices.estimated(values, level=level)
        except ValueError as error:
            raise StictionError(f"{QUANTITIES[name][0]}: {error}") from None
    result = _dataset(found, estimated, level)
    # As the run had it: with what the arguments say.
    result.attrs |= {"title": str(tables.get("title", "")), "samples": samples, "blocks": BLOCKS, "replicas": patches,
                     "seed": first, "scene": _text(scene), "summary": words(result)}  # fmt: skip
    if output is not None:
        with files.writing_hdf5(output, force=force, inputs=inputs) as part:
            result.to_netcdf(part, engine="h5netcdf")
    return result


def _text(scene: Scene) -> str:
    return toml(scene) if not isinstance(scene, str | Path) else Path(scene).read_text(encoding="utf-8")


def _checked(found: priors.Priors, replicas: int | None) -> tuple[dict[str, Any], int]:
    """The tables of the sweeps, and the number of patches of a point."""
    if not found.are_independent:
        raise SceneError("priors: Sobol indices are of independent numbers; leave the table out")
    tables = dict(found.tables)
    ensemble = dict(tables.get("ensemble", {}))
    if "sweep" in tables:
        raise SceneError("sweep: the scene may have priors or [sweep], not both")
    if ensemble.get("sampling", "independent") != "independent":
        raise SceneError(
            f"ensemble.sampling = {ensemble['sampling']!r}: independent patches are needed, to tell their scatter from parameters"
        )
    if "target" in ensemble:
        raise SceneError("ensemble.target: a fixed number of patches is needed; give replicas")
    patches = int(ensemble.get("replicas", 0)) if replicas is None else replicas
    if patches < 2:
        raise SceneError(f"replicas = {patches}: at least 2 patches are needed, to tell their scatter from parameters")
    tables["ensemble"] = {**ensemble, "replicas": patches}
    if tables.get("model", {}).get("history") != "loop":
        # The energy is calculated from the curves.
        tables["output"] = {**tables.get("output", {}), "curves": True}
    return tables, patches


def _outcomes(sweep: Result) -> dict[str, Array]:
    """Outcomes of each patch, arrays (points, patches), SI."""
    group = sweep["replicas"].to_dataset()
    found = {name: group[name].transpose("point", "replica").values for name in QUANTITIES if name in group}
    if "dissipated_energy" in group:
        found["energy"] = group["dissipated_energy"].transpose("point", "replica").values
    else:
        force = group["external_force"].transpose("point", "replica", "separation_index").values
        h = group["separation"].transpose("point", "separation_index").values
        found["energy"] = _work(force, h[:, None, :])
    return found


def _work(force: Array, h: Array) -> Array:
    """The largest work to part surfaces from a separation to the last one, by the trapezoidal rule (N m).

    Parameters
    ----------
    force, h : array (…, separations)
        External force, compressive positive (N), at rising separations (m).

    Examples
    --------
    >>> _work(np.array([2.0, 0.0, -1.0, -1.0]), np.array([0.0, 1.0, 2.0, 3.0])).item()
    1.5
    """
    steps = -0.5 * (force[..., 1:] + force[..., :-1]) * np.diff(h, axis=-1)
    from_here = np.cumsum(steps[..., ::-1], axis=-1)
    best: Array = np.maximum(from_here.max(axis=-1), 0.0)
    return best


def _dataset(found: priors.Priors, of: dict[str, indices.Estimated], level: float) -> xarray.Dataset:
    ends = ("quantity", "key", "range_end")
    all_of = list(of.values())
    words = {
        "first_order": "first-order Sobol index of the mean over patches",
        "total": "total Sobol index of the mean over patches",
    }
    variables: dict[str, Any] = {}
    for name, said in words.items():
        variables[name] = (ends[:2], np.stack([getattr(one, name) for one in all_of]), {"units": "1", "long_name": said})
        between = np.stack([getattr(one, f"{name}_interval") for one in all_of])
        variables[f"{name}_interval"] = (ends, between, {"units": "1", "long_name": f"{said}, bootstrap interval"})
    said = "share of the scatter between patches in the variance of one patch"
    variables["scatter"] = ("quantity", [one.scatter for one in all_of], {"units": "1", "long_name": said})
    variables["scatter_interval"] = (
        ("quantity", "range_end"), np.stack([one.scatter_interval for one in all_of]),
        {"units": "1", "long_name": f"{said}, bootstrap interval"},
    )  # fmt: skip
    variables["mean"] = ("quantity", [one.mean for one in all_of], {"long_name": "mean over parameters and patches, in `unit`"})
    variables["standard_deviation"] = (
        "quantity", [max(one.variance, 0.0) ** 0.5 for one in all_of],
        {"long_name": "standard deviation of one patch with unknown parameters, in `unit`"},
    )  # fmt: skip
    coordinates = {
        "quantity": list(of), "key": found.keys, "range_end": ["low", "high"],
        "unit": ("quantity", [QUANTITIES[name][1] for name in of]),
    }  # fmt: skip
    attributes = {"format": "stiction-sensitivity", "format_version": np.array(_VERSION), "interval_level": level}
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes)
