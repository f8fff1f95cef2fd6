"""Calibration of intervals: inferences from synthetic data whose parameters are known."""

from __future__ import annotations

import dataclasses
import os
import warnings
from pathlib import Path

import numpy as np
import xarray
from joblib import Parallel, delayed
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from .. import experiments, files
from ..errors import FileError, SceneError, StictionError
from ..priors import Priors
from ..progress import Bar, work
from ..scenes import Scene, named_files, toml
from .calibrated import FORMAT, RANKS, Calibration, open_calibration
from .data import EXACT, MISSING, Group, Measurements
from .emulator import Patches, as_measured, simulate
from .kept import GROUP, Kept, partial, source, stating_what_is_kept
from .posterior import Goals, checked, over_priors, posterior

__all__ = ["calibrate"]

Array = NDArray[np.float64]
_VERSION = (1, 0)
# Streams of random numbers of an experiment: its parameters, its data, its inference.
_TRUTH, _DATA, _INFERENCE = range(3)


def calibrate(
    data: str | Path | Measurements,
    scene: Scene,
    output: str | Path | None = None,
    *,
    count: int,
    seed: int = 1,
    threads: int | None = None,
    emulator_error: float = 0.2,
    end_error: float = 0.02,
    missing: str = "refuse",
    resume: bool = False,
    force: bool = False,
    progress: bool | None = None,
) -> Calibration:
    """Simulation-based calibration of `infer` with these data: their number, conditions, errors, limits and batches, of parameters drawn from the priors.

    Each experiment is inferred as `infer` does, with patches of its own at its posterior; all of them share the patches over the priors.

    Parameters
    ----------
    data, scene, emulator_error, end_error, missing, force, progress
        As in `infer`.
    output : path, optional
        File for the result; ``OUTPUT.partial`` has the experiments that are done.
    count : int
        Number of experiments in all.
    seed : int
        Of everything. Experiments do not depend on their number.
    threads : int, optional
        Experiments at once, one per core by default.
    resume : bool
        Whether to go on with the experiments that ``OUTPUT.partial`` or `output` has, to `count` in all.

    Raises
    ------
    SceneError, FileError
        As `infer`.
    StictionError
        All experiments failed, a process of them was ended, or the disk is full; the message says what is kept.
    """
    if count < 2:
        raise SceneError(f"count = {count}: at least 2 experiments are needed; 100 show coverage of 90 % to ± 6 %")
    experiments.check_settings(seed=seed, threads=threads)
    output = None if output is None else Path(output)
    begun = None if output is None else source(output, resume, force)
    if output is not None:
        files.check(output, force=force or resume, inputs=named_files(scene))
    with work(progress=progress), threadpool_limits(1):
        with stating_what_is_kept(output, "the experiments before"):
            measured, priors = checked(data, scene, missing)
            kept = Kept(priors, measured, seed, threads)
            goals = Goals(seed, end_error, emulator_error)
            done = _Done(priors, measured, goals, output, begun)
            if done.source is not None:
                kept.take(done.source)
            patches = over_priors(priors, kept, goals)
            done.save(kept)
            _all(done, _Job(priors, measured, patches, goals), count, threads or os.cpu_count() or 1, kept)
        if not done.ranks:
            raise StictionError(f"all {count} experiments failed: {done.failed[min(done.failed)]}")
        found = Calibration(done.dataset())
        found.data.attrs["summary"] = str(found)
        if output is not None:
            done.finish(found.data, kept, force or resume)
    return found


@dataclasses.dataclass(frozen=True)
class _Job:
    """What experiments have in common."""

    priors: Priors
    measured: Measurements
    patches: list[Patches]
    goals: Goals


@dataclasses.dataclass(frozen=True)
class _Ranked:
    """Ranks (parameters,), p-values of the check (outcomes,), and the density's error of an experiment."""

    ranks: Array
    checks: Array
    share: float


class _Done:
    """The experiments that are done, and the file that keeps them."""

    def __init__(self, priors: Priors, measured: Measurements, goals: Goals, output: Path | None, begun: Path | None) -> None:
        self._priors, self._measured, self._goals, self._output = priors, measured, goals, output
        self.ranks: dict[int, _Ranked] = {}
        self.failed: dict[int, str] = {}
        self.source = begun
        if begun is not None:
            self._read(begun)

    @property
    def count(self) -> int:
        """Number of experiments."""
        return len(self.ranks) + len(self.failed)

    def _read(self, path: Path) -> None:
        found = open_calibration(path).data
        if found.attrs["goals"] != repr(self._goals):
            raise FileError(f"{path}: its experiments have another seed or other errors to reach, {found.attrs['goals']}; leave resume=True out")
        for place, number in enumerate(found.experiment.values):
            row = found.isel(experiment=place)
            self.ranks[int(number)] = _Ranked(row["rank"].values, row["check"].values, float(row.emulator_share))
        self.failed = {int(number): "" for number in np.atleast_1d(found.attrs["which_failed"])}

    def dataset(self) -> xarray.Dataset:
        """The experiments in their order."""
        order = sorted(self.ranks)
        rows = [self.ranks[number] for number in order]
        names = self._priors.names
        variables = {
            "rank": (("experiment", "parameter"), np.array([row.ranks for row in rows]).reshape(-1, len(names)), {"units": "1", "long_name": "fraction of the posterior below the true parameter"}),
            "check": (("experiment", "outcome"), np.array([row.checks for row in rows]).reshape(-1, len(self._measured.outcomes)), {"units": "1", "long_name": "p-value of the posterior-predictive check"}),
            "emulator_share": ("experiment", [row.share for row in rows], {"units": "1", "long_name": "shift of the posterior by the density's error over its standard deviation"}),
        }  # fmt: skip
        attrs = {"format": FORMAT, "format_version": np.array(_VERSION), "title": str(self._priors.tables.get("title", "")), "scene": toml(self._priors.tables),
                 "patches": self._measured.size, "failed": len(self.failed), "which_failed": np.array(sorted(self.failed), dtype=np.int64),
                 "goals": repr(self._goals)}  # fmt: skip
        return xarray.Dataset(variables, coords={"experiment": order, "parameter": names}, attrs=attrs)

    def save(self, kept: Kept) -> None:
        """Keeps what is done."""
        if self._output is not None:
            self._write(partial(self._output), self.dataset(), kept, True)

    def finish(self, found: xarray.Dataset, kept: Kept, force: bool) -> None:
        """Writes the result."""
        assert self._output is not None
        self._write(self._output, found, kept, force)
        partial(self._output).unlink(missing_ok=True)

    @staticmethod
    def _write(path: Path, found: xarray.Dataset, kept: Kept, force: bool) -> None:
        about = xarray.Dataset(attrs={name: of for name, of in found.attrs.items() if name != "which_failed"})
        with files.writing_hdf5(path, force=force) as part:
            about.to_netcdf(part, engine="h5netcdf")
            found.to_netcdf(part, engine="h5netcdf", group=RANKS, mode="a")
            kept.dataset().to_netcdf(part, engine="h5netcdf", group=GROUP, mode="a")


def _all(done: _Done, job: _Job, count: int, processes: int, kept: Kept) -> None:
    """Does the experiments that are missing, several at once."""
    missing = [number for number in range(count) if number not in done.ranks and number not in done.failed]
    jobs = (delayed(_experiment)(job, number) for number in missing)
    with Bar("experiments", count, "experiments", done=done.count) as bar:
        for number, found in Parallel(min(processes, max(len(missing), 1)), return_as="generator_unordered")(jobs):
            if isinstance(found, str):
                done.failed[number] = found
            else:
                done.ranks[number] = found
            bar.to(done.count)
            done.save(kept)


def _experiment(job: _Job, number: int) -> tuple[int, _Ranked | str]:
    """An experiment, or why it failed."""
    priors, goals = job.priors, dataclasses.replace(job.goals, seed=_seed(job.goals.seed, number, _INFERENCE))
    random = np.random.default_rng([job.goals.seed, number, _TRUTH])
    z = random.standard_normal(len(priors.priors) + (priors.of_batch is not None))
    try:
        with work(progress=False), threadpool_limits(1), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            measured = _synthetic(job, z, random, _seed(job.goals.seed, number, _DATA))
            kept = Kept(priors, measured, goals.seed, 1)
            found = posterior(measured, kept, job.patches, goals)
    except StictionError as error:
        return number, str(error)
    flat = found.chains.z.reshape(-1, len(z))
    return number, _Ranked((flat < z).mean(axis=0), found.checks, found.error.share)


def _seed(*of: int) -> int:
    return int(np.random.SeedSequence(list(of)).generate_state(1)[0] >> 1)


def _synthetic(job: _Job, z: Array, random: np.random.Generator, seed: int) -> Measurements:
    """Data like the given ones, of parameters with the normal scores z."""
    priors, measured, groups = job.priors, job.measured, []
    values = np.repeat(priors.of_scores(z[None, : len(priors.priors)]), max(len(measured.batches), 1), axis=0)
    if (of_batch := priors.of_batch) is not None:
        values[:, of_batch.place] *= np.exp(of_batch.spread(z[-1:]) * random.standard_normal(len(values)))
    for place, group in enumerate(measured.groups):
        made = simulate(
            priors, measured.outcomes, values, units=measured.units, replicas=max(len(group.values), 2), seed=seed + place, threads=1,
            floors=float(np.finfo(float).tiny), conditions=group.conditions,
        )  # fmt: skip
        batches = group.batches if len(values) > 1 else np.zeros(len(group.values), dtype=np.int64)
        logs = made.logs[batches, np.arange(len(group.values))]
        groups.append(_like(group, logs, random))
    return dataclasses.replace(measured, groups=tuple(groups))


def _like(group: Group, logs: Array, random: np.random.Generator) -> Group:
    """Data in the place of each of a group's, with its error and gaps; what resolution the limits have is that of all."""
    found = as_measured(group, logs, random, np.arange(len(logs)))
    values = np.where(found.kinds == MISSING, np.nan, found.values)
    if not (found.kinds == EXACT).any():
        raise StictionError("all synthetic data are limits or gaps")
    return dataclasses.replace(group, values=values, kinds=found.kinds)
