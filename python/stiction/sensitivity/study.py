"""Studies of a scene with priors: as many samples as the indices need, and the result."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from .. import experiments, files, priors
from ..errors import SceneError, StictionError, written_at_end
from ..scenes import Scene, named_files, toml
from . import indices
from .sampled import BLOCKS, LEAST, Design, points_of_row
from .words import QUANTITIES, needed, words

__all__ = ["BLOCKS", "sensitivity"]

Array = NDArray[np.float64]

#: Points of a sweep at most.
_MOST_POINTS = 10_000
_VERSION = (1, 0)


def sensitivity(
    scene: Scene,
    output: str | Path | None = None,
    *,
    interval: float = 0.1,
    samples: int | None = None,
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
        A scene with up to 6 numbers that have priors (`stiction.priors`).
    output : path, optional
        HDF5 file for the result.
    interval : float
        Largest width of the intervals of all indices of all outcomes: samples are doubled, from 64 on, until it is reached.
    samples : int, optional
        Samples n at most, a power of 2 of at least 64; by default the largest number that a sweep can have. Each is a row of Saltelli's design: n (k + 2)
        points of k independent keys are computed, n (2k + 2) of correlated ones, in 32 independent blocks.
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
        over patches (of correlated keys as in `indices`), `scatter`, the fraction of the variance of one patch that is between patches, their `…_interval` over `range_end`,
        `mean` and `standard_deviation` of one patch in SI units. Energy is what a cycle dissipates with
        ``history = "loop"``, else the work to detach the surfaces from where they adhere without a force to the
        largest separation.

    Raises
    ------
    SceneError
        The scene, a prior or an argument is wrong; sampling is not independent. Or more than 5 % of the samples have a point that the program refuses, or
        where a patch lacks an outcome: the first is named with its numbers. Up to that they are left out, and counted by the attribute `left_out`.
    """
    if isinstance(interval, bool) or not isinstance(interval, int | float) or not 0.0 < interval <= 1.0:
        raise SceneError(f"interval = {interval}: a number above 0, and at most 1, is needed")
    if samples is not None and (samples < LEAST or samples & (samples - 1)):
        raise SceneError(f"samples = {samples}: a power of 2 of at least {LEAST} is needed")
    if not 0.5 <= level < 1.0:
        raise SceneError(f"level = {level}: a number from 0.5 to below 1 is needed")
    experiments.check_settings(seed=seed, threads=threads)
    found = priors.read(scene)
    inputs = named_files(scene)
    if output is not None:
        files.check(output, force=force, inputs=inputs)
    tables, patches = _checked(found, replicas)
    most = _most(found, samples)
    first = experiments.seed_of(tables, seed)
    design = Design(found, tables, patches, first, threads)
    with written_at_end():
        forecast = 0
        while True:
            design.double(forecast, progress)
            result = _result(design, level, interval)
            forecast = min(needed(result), most)
            if forecast <= design.samples:
                break
    result.attrs |= {"title": str(tables.get("title", "")), "seed": first, "scene": _text(scene)}
    result.attrs["summary"] = words(result)
    if output is not None:
        with files.writing_hdf5(output, force=force, inputs=inputs) as part:
            result.to_netcdf(part, engine="h5netcdf")
    return result


def _result(design: Design, level: float, interval: float) -> xarray.Dataset:
    """The indices of all outcomes."""
    estimated = {}
    at = design.cube if design.found.are_independent else None
    for name, values in zip(QUANTITIES, design.outcomes, strict=True):
        try:
            estimated[name] = indices.estimated(values, keys=len(design.found.priors), at=at, level=level)
        except ValueError as error:
            raise StictionError(f"{QUANTITIES[name][0]}: {error}") from None
    result = _dataset(design.found, estimated, level)
    result.attrs |= {"samples": design.samples, "blocks": BLOCKS, "replicas": design.patches, "interval": interval,
                     "correlated": int(not design.found.are_independent), "left_out": len(design.left_out),
                     "left_out_first": next(iter(design.left_out), "")}  # fmt: skip
    return result


def _most(found: priors.Priors, samples: int | None) -> int:
    """The largest number of samples: the given one, or the power of 2 that sweeps can have."""
    largest: int = BLOCKS * 2 ** int(np.log2(_MOST_POINTS // points_of_row(found)))
    if samples is not None and samples > largest:
        raise SceneError(f"samples = {samples}: at most {largest} can be had of {len(found.priors)} keys")
    return samples or largest


def _text(scene: Scene) -> str:
    return toml(scene) if not isinstance(scene, str | Path) else Path(scene).read_text(encoding="utf-8")


def _checked(found: priors.Priors, replicas: int | None) -> tuple[dict[str, Any], int]:
    """The tables of the sweeps, and the number of patches of a point."""
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
