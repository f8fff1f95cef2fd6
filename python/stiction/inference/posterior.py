"""The posterior of a scene's parameters from measured outcomes."""

from __future__ import annotations

import copy
import math
import warnings
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import arviz
import numpy as np
import xarray
from numpy.typing import NDArray
from scipy import linalg
from threadpoolctl import threadpool_limits

from .. import experiments, files, quantities
from .. import priors as scenes
from ..errors import SceneError, StictionError, written_at_end
from ..priors import Priors
from ..progress import Bar, work
from ..scenes import Scene, named_files, toml
from . import data as measurements
from .check import check_p_values, farthest
from .data import EXACT, Group, Measurements
from .density import log_sum_exp
from .emulator import FORCE_SCALE, Emulator, Patches, design, outcomes_of, simulate, try_out
from .found import FORMAT, Inference
from .sampling import Chains, sample

__all__ = ["checked", "infer"]

Array = NDArray[np.float64]
# Points of the first batch for each parameter that is swept, rounded up to a power of 2; a batch that follows has half of them.
_POINTS = 32
_MOST_BATCHES = 8
# Patches of the Fisher information.
_SCORED = 4000
# Draws of the prior.
_PRIOR = 20_000
_VERSION = (1, 0)


def infer(
    data: str | Path | Measurements,
    scene: Scene,
    output: str | Path | None = None,
    *,
    seed: int = 1,
    threads: int | None = None,
    end_error: float = 0.02,
    emulator_error: float = 0.2,
    replicas: int = 300,
    missing: str = "refuse",
    force: bool = False,
    progress: bool | None = None,
) -> Inference:
    """Infers parameters of a scene from measured outcomes of patches.

    Patches are simulated over the priors, in batches of parameter sets; a density of their outcomes over the parameters is fitted (`Density`) and the
    posterior sampled. Further batches lie where the posterior is, until the density's own error is small against it. That error is carried in the
    likelihood: it is the mean over fits to resampled patches.

    Parameters
    ----------
    data : path or Measurements
        The table of `stiction.inference.data.read`.
    scene : path or dict
        The scene with priors, as `stiction.priors.read` has them.
    output : path, optional
        File for the result, too.
    seed : int
        Seed of simulations, fits and chains.
    threads : int, optional
        Of the simulations, one per core by default.
    end_error : float
        Monte Carlo error of the ends of 95 % intervals over their width.
    emulator_error : float
        Scatter of the posterior means of the fits over the standard deviation of the posterior: 0.2 widens it by 2 %.
    replicas : int
        Patches that are simulated at each parameter set: several times as many as were measured.
    missing : {"refuse", "drop"}
        Whether a gap of the table is an error or an outcome that was not measured.
    force : bool
        Whether an existing `output` is overwritten.
    progress : bool, optional
        Whether to show it, as in `stiction.run`.

    Raises
    ------
    SceneError, FileError
        Scene, argument or data are wrong; the message says where. Nothing is written.
    StictionError
        A simulation failed, all simulated patches are alike, or the chains do not agree.
    """
    for name, value, low, high in (("end_error", end_error, 1e-3, 0.5), ("emulator_error", emulator_error, 0.01, 1.0)):
        if not low <= value <= high:
            raise SceneError(f"{name} = {value}: a number from {low} to {high} is needed")
    if not 20 <= replicas <= 100_000:
        raise SceneError(f"replicas = {replicas}: a number from 20 to 100000 is needed")
    experiments.check_settings(seed=seed, threads=threads)
    if output is not None:
        inputs = named_files(scene) if isinstance(data, Measurements) else [data, *named_files(scene)]
        files.check(output, force=force, inputs=inputs)
    # Matrices are so small that threads would only wait for each other.
    with written_at_end(), work(progress=progress), threadpool_limits(1):
        measured, priors = checked(data, scene, missing)
        result = _inferred(measured, priors, seed, threads, end_error, emulator_error, replicas)
    if output is not None:
        result.save(output, force=force)
    return result


def checked(data: str | Path | Measurements, scene: Scene, missing: str = "refuse") -> tuple[Measurements, Priors]:
    """The data and the scene with its priors, with all that can be wrong with either found by a few patches.

    Raises
    ------
    SceneError, FileError
        As `infer`.
    """
    if isinstance(data, Measurements):
        measured, priors = data, scenes.read(scene)
    else:
        # What is no table is found before anything runs.
        conditions = measurements.first_conditions(data)
        priors = scenes.read(scene)
        with Bar("trial patches"):
            known = outcomes_of(priors, conditions)
        measured = measurements.read(data, outcomes=known, missing=missing)
    with Bar("trial patches"):
        try_out(priors, measured)
    return measured, priors


def _inferred(
    measured: Measurements, priors: Priors, seed: int, threads: int | None, end_error: float,
    emulator_error: float, replicas: int,
) -> Inference:  # fmt: skip
    first = 2 ** math.ceil(math.log2(_POINTS * len({*priors.keys} - {FORCE_SCALE})))
    seeds = iter(np.random.SeedSequence(seed).generate_state(1000) >> 1)

    def simulated(values: Array, batch: int) -> list[Patches]:
        # One seed under all conditions: they differ in nothing else.
        of, found = int(next(seeds)), []
        for number, group in enumerate(measured.groups, 1):
            with _of_batch(batch), work(f"condition {number} of {len(measured.groups)}" if len(measured.groups) > 1 else "simulation"):
                found.append(simulate(
                    priors, measured.outcomes, values, units=measured.units, replicas=replicas, seed=of, threads=threads, floors=measured.floors,
                    conditions=group.conditions,
                ))  # fmt: skip
        return found

    patches = simulated(design(priors, first, int(next(seeds))), 1)
    _check_scatter(measured, patches)
    random = np.random.default_rng(int(next(seeds)))
    centre: Array | None = None
    covariance: Array | None = None
    start: Array | None = None
    for batch in range(1, _MOST_BATCHES + 1):
        with _of_batch(batch):
            with Bar("density"):
                emulator = Emulator(priors, patches, centre=centre, covariance=covariance, seed=int(next(seeds)))
            rough = sample(_likelihood(emulator, measured.groups), priors, seed=int(next(seeds)), end_error=0.1, effective=400.0, start=start)
        start = rough.z.reshape(-1, len(priors.priors))
        natural = priors.natural(priors.of_scores(start))
        share = _share(emulator, measured.groups, priors, start)
        if batch > 1 and share <= emulator_error:
            break
        centre, covariance = natural.mean(axis=0), np.cov(natural.T).reshape(len(priors.priors), -1)
        if batch < _MOST_BATCHES:
            # Wider than the posterior, so that its flanks are known as well as its middle.
            middle = start.mean(axis=0)
            wide = middle + 2.0 * (start[random.choice(len(start), first // 2, replace=False)] - middle)
            more = simulated(priors.of_scores(np.clip(wide, -3.0, 3.0)), batch + 1)
            patches = [one + two for one, two in zip(patches, more, strict=True)]
    with work("result"):
        chains = sample(_likelihood(emulator, measured.groups), priors, seed=int(next(seeds)), end_error=end_error, start=start)
        with Bar("checks"):
            return _result(chains, priors, measured, emulator, random, share, sum(of.logs[:, :, 0].size for of in patches), batch)


def _of_batch(batch: int) -> AbstractContextManager[None]:
    return work(f"batch {batch} of at most {_MOST_BATCHES}")


def _check_scatter(measured: Measurements, patches: list[Patches]) -> None:
    """Refuses outcomes of which all simulated patches have one value: no density can be fitted."""
    for of in patches:
        for name, unit, logs, floor in zip(measured.outcomes, measured.units, np.moveaxis(of.logs, 2, 0), measured.floors, strict=True):
            if np.ptp(logs) == 0.0:
                raise StictionError(
                    f"{name}: all simulated patches are alike, {quantities.si(np.exp(logs.flat[0]), unit)}, and those below a tenth of the smallest "
                    f"datum, {quantities.si(floor, unit)}, are set to it: check the unit of the column, and the priors"
                )


def _likelihood(emulator: Emulator, groups: tuple[Group, ...]) -> Callable[[Array], Array]:
    return lambda values: emulator.log_likelihood(groups, values)


def _share(emulator: Emulator, groups: tuple[Group, ...], priors: Priors, z: Array) -> float:
    """Scatter of the members' posterior means over the posterior's standard deviation: the largest of all parameters."""
    values = priors.of_scores(z[:: max(len(z) // 2000, 1)])
    natural = priors.natural(values)
    each = np.concatenate([emulator.log_densities(groups, piece).sum(axis=2) for piece in np.array_split(values, 10)], axis=1)
    weights = np.exp(each - log_sum_exp(each, axis=0))
    weights /= weights.sum(axis=1, keepdims=True)
    means = weights @ natural
    return float((means.std(axis=0, ddof=1) / natural.std(axis=0)).max())


def _result(
    chains: Chains, priors: Priors, measured: Measurements, emulator: Emulator, random: np.random.Generator, share: float,
    simulated: int, batches: int,
) -> Inference:  # fmt: skip
    count, draws, dimensions = chains.z.shape
    values = priors.of_scores(chains.z.reshape(-1, dimensions))
    flat = priors.natural(values)
    drawn = priors.of_scores(random.standard_normal((_PRIOR, dimensions)))
    before = priors.natural(drawn)
    groups = measured.groups
    pieces = np.array_split(values, max(len(values) // 200, 1))
    each = np.concatenate([emulator.log_densities(groups, piece) for piece in pieces], axis=1)
    pointwise = (log_sum_exp(each, axis=0) - np.log(len(each))).reshape(count, draws, -1)
    replicated = np.concatenate([emulator.measured(groups, piece, random) for piece in pieces]).reshape(count, draws, measured.size, -1)
    observed = {name: np.concatenate([group.values[:, j] for group in groups]) for j, name in enumerate(measured.outcomes)}
    for j, name in enumerate(measured.outcomes):
        observed[f"{name}_error"] = np.concatenate([group.errors[:, j] for group in groups])
        observed[f"{name}_kind"] = np.concatenate([group.kinds[:, j] for group in groups])
    names = [prior.name for prior in priors.priors]
    sampled = [*observed]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data = arviz.from_dict(
            posterior={name: values[:, k].reshape(count, draws) for k, name in enumerate(names)},
            sample_stats={"lp": chains.log_probability},
            log_likelihood={"patch": pointwise},
            posterior_predictive={name: replicated[..., j] for j, name in enumerate(measured.outcomes)},
            observed_data=observed,
            prior={name: drawn[None, :, k] for k, name in enumerate(names)},
            dims={"patch": ["patch_number"], **{name: ["patch_number"] for name in sampled}},
            coords={"patch_number": np.arange(measured.size)},
        )
        data.add_groups(identifiability=_identifiability(values, drawn, priors, measured, emulator, random))
    for k, prior in enumerate(priors.priors):
        for group in (data.posterior, data.prior):
            group[prior.name].attrs.update(units=prior.unit, long_name=prior.key)
        contraction = 1.0 - float(flat[:, k].var() / before[:, k].var())
        data.posterior[prior.name].attrs.update(
            r_hat=chains.r_hat[k], effective=chains.effective[k], end_error=chains.end_errors[k], contraction=contraction,
            logarithmic=int(prior.logarithmic),
        )  # fmt: skip
    for name, unit in zip(measured.outcomes, measured.units, strict=True):
        for of in (data.observed_data, data.posterior_predictive):
            of[name].attrs["units"] = unit
        data.observed_data[f"{name}_error"].attrs["units"] = unit
        data.observed_data[f"{name}_kind"].attrs["flag_meanings"] = "0 number, 1 below it, 2 above it, 3 not measured"
    data.posterior.attrs.update(
        format=FORMAT, format_version="1.0", title=str(priors.tables.get("title", "")), scene=toml(priors.tables), outcomes=", ".join(measured.outcomes),
        patches=measured.size, gaps=measured.gaps, check_p_value=check_p_values(emulator, groups, values, random), acceptance=chains.acceptance,
        emulator_share=share, simulated_patches=simulated, batches=batches,
        farthest="\n".join(_farthest(measured, farthest(emulator, groups, values, random))),
    )  # fmt: skip
    found = Inference(data)
    data.attrs = {"format": FORMAT, "format_version": np.array(_VERSION), "title": data.posterior.attrs["title"],
                  "scene": data.posterior.attrs["scene"], "summary": str(found)}  # fmt: skip
    return found


def _farthest(measured: Measurements, found: list[tuple[int, float]]) -> Iterator[str]:
    """Sentences on the datum of each outcome that is farthest off the others."""
    table = np.concatenate([group.values for group in measured.groups])
    lines = [line for group in measured.groups for line in group.lines]
    samples = [sample for group in measured.groups for sample in group.samples]
    for name, unit, j, (patch, p) in zip(measured.outcomes, measured.units, range(len(found)), found, strict=True):
        where = f"line {lines[patch]}" if lines else f"patch {patch}"
        where = f"{samples[patch]}, {where}" if samples else where
        verdict = "far off what the others say: look at it" if p < 0.01 else "as far off as the farthest may be"
        yield f"{name} of {where}, {quantities.si(table[patch, j], unit)}: p = {p:.2g}, {verdict}"


def _identifiability(
    values: Array, drawn: Array, priors: Priors, measured: Measurements, emulator: Emulator, random: np.random.Generator
) -> xarray.Dataset:
    """Combinations of the parameters by how far the data narrow them, and the Fisher information at the posterior's mean.

    A combination is Σ a_k q_k of the logarithms of the parameters; of one that may be negative q is the number over the standard deviation of its prior. Those that are
    independent under prior and posterior are the solutions of C_posterior a = r C_prior a, with r the fraction of the variance that is left.
    """
    positive = (values > 0.0).all(axis=0) & (drawn > 0.0).all(axis=0)
    scale = np.where(positive, 1.0, drawn.std(axis=0))

    def coordinates(of: Array) -> Array:
        result: Array = np.log(of, out=of / scale, where=np.broadcast_to(positive, of.shape))
        return result

    flat, before = coordinates(values), coordinates(drawn)
    after = np.cov(flat.T).reshape(flat.shape[1], -1)
    prior = np.cov(before.T).reshape(after.shape)
    ratios, vectors = linalg.eigh(after, prior)
    # The largest fraction is 1; fractions are of parameters over the standard deviations of their priors.
    scaled = vectors * np.sqrt(np.diag(prior))[:, None]
    vectors = vectors / vectors[np.abs(scaled).argmax(axis=0), np.arange(len(ratios))]
    spreads = np.sqrt(np.einsum("ik,ij,jk->k", vectors, after, vectors))
    natural = priors.natural(values)
    middle = natural.mean(axis=0)
    information = _fisher(middle, natural.std(axis=0), priors, measured, emulator, random)
    # From natural parameters to these coordinates.
    slopes = np.where([one.logarithmic for one in priors.priors], 1.0, np.where(positive, middle, scale))
    names = [prior.name for prior in priors.priors]
    return xarray.Dataset(
        {
            "exponent": (("combination", "parameter"), vectors.T),
            "posterior_std": (("combination",), spreads),
            "prior_std": (("combination",), spreads / np.sqrt(ratios)),
            "fisher_information": (("parameter", "of"), information * np.outer(slopes, slopes)),
            "posterior_covariance": (("parameter", "of"), after),
            "logarithmic": (("parameter",), positive.astype(int)),
        },
        coords={"parameter": names, "of": names},
        attrs={"long_name": "of logarithms of parameters; of those that are not logarithmic over the standard deviation of their prior"},
    )


def _fisher(at: Array, steps: Array, priors: Priors, measured: Measurements, emulator: Emulator, random: np.random.Generator) -> Array:
    """Expected information of the data's patches, measured with their errors and without limits: the mean of the outer products of scores."""
    dimensions = len(at)
    result = np.zeros((dimensions, dimensions))
    for place, group in enumerate(measured.groups):
        sets = max(_SCORED // len(group.values), 1)
        single = _only(emulator, place)
        drawn = single.measured((group,), np.repeat(priors.values(at[None]), sets, axis=0), random).reshape(-1, group.values.shape[1])
        errors = np.tile(group.errors, (sets, 1))
        kinds = np.where((drawn > 0.0) & (np.tile(group.kinds, (sets, 1)) != measurements.MISSING), EXACT, measurements.MISSING)
        like = Group(group.conditions, np.where(drawn > 0.0, drawn, 1.0), errors, kinds)
        points = priors.values(np.concatenate([at + 0.25 * sign * np.diag(steps) for sign in (1.0, -1.0)]))
        each = np.concatenate([single.log_densities((like,), point[None]) for point in points], axis=1)
        logs = log_sum_exp(each, axis=0) - np.log(len(each))
        scores = (logs[:dimensions] - logs[dimensions:]) / (0.5 * steps[:, None])
        result += scores @ scores.T / sets
    return result


def _only(emulator: Emulator, place: int) -> Emulator:
    single = copy.copy(emulator)
    single.densities = [emulator.densities[place]]
    return single
