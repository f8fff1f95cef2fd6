"""The posterior of a scene's parameters from measured outcomes."""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import arviz
import numpy as np
import xarray
from numpy.typing import NDArray
from scipy import linalg
from threadpoolctl import threadpool_limits

from .. import experiments, files, quantities
from .. import priors as scenes
from ..errors import SceneError, StictionError
from ..priors import Priors
from ..progress import Bar, work
from ..scenes import Scene, named_files, toml
from . import data as measurements
from .check import check_p_values
from .data import Measurements
from .emulator import (
    FORCE_SCALE,
    PARTS,
    ROW,
    Emulator,
    Patches,
    as_measured,
    design,
    outcomes_of,
    outliers_of,
    try_out,
)
from .found import FORMAT, Inference
from .fresh import Misfit, gain, misfit, scatter, scores
from .grid import on_grid
from .kept import GROUP, Kept, partial, source, stating_what_is_kept
from .likelihood import Likelihood, outlier_range
from .sampling import Chains, independent, rough, sample

__all__ = ["Goals", "Posterior", "checked", "infer", "over_priors", "posterior"]

Array = NDArray[np.float64]
# Points of each batch for each parameter that is swept, of the first a power of 2; at most, and patches of a point before there are more points.
_POINTS, _MOST_POINTS, _OF_A_POINT = 16, 128, 100
_MOST_BATCHES = 8
# Patches of a point of the first batch, and fresh patches at the posterior over the measured ones: of the second batch, and of each that follows.
_FIRST, _ROUGH, _FRESH = 100, 25, 100
# Power of the likelihood on whose draws densities are fitted: three standard deviations of what data alone show, and all that a prior leaves open.
_FLANKS = 1.0 / 9.0
# Draws of a rough posterior, and of one on a grid.
_ROUGH_DRAWS, _GRID_DRAWS = 4000, 8000
# Patches of the Fisher information.
_SCORED = 4000
# Gain of ln of the likelihood of data like the given ones for which a density has more parts.
_BETTER = 0.1
# Draws by which fits to halves of the patches are compared.
_SCATTER = 1000
# Draws of the prior, and draws of the posterior that checks look at.
_PRIOR, _CHECKED = 20_000, 1000
_VERSION = (1, 0)


@dataclass(frozen=True)
class Goals:
    """Seed of an inference, and the errors at which it ends."""

    seed: int
    end_error: float
    emulator_error: float


def infer(
    data: str | Path | Measurements,
    scene: Scene,
    output: str | Path | None = None,
    *,
    seed: int = 1,
    threads: int | None = None,
    end_error: float = 0.02,
    emulator_error: float = 0.2,
    missing: str = "refuse",
    resume: bool = False,
    reuse: str | Path | None = None,
    force: bool = False,
    progress: bool | None = None,
) -> Inference:
    """Infers parameters of a scene from measured outcomes of patches.

    Patches are simulated over the priors, and then in batches where the posterior is; a density of their outcomes over the parameters is fitted
    (`Density`). The patches of each batch first show how far the density is off there (`misfit`), and then improve it, until its error is small
    against the posterior. Their number is in proportion to the measured ones. The posterior is that on a grid of one or two parameters, and
    sampled by emcee of more.

    Parameters
    ----------
    data : path or Measurements
        The table of `stiction.inference.data.read`.
    scene : path or dict
        The scene with priors, as `stiction.priors.read` has them.
    output : path, optional
        File for the result, too. Until that is complete the simulated patches are in ``OUTPUT.partial``.
    seed : int
        Seed of simulations, fits and chains.
    threads : int, optional
        Of the simulations, one per core by default.
    end_error : float
        Monte Carlo error of the ends of 95 % intervals over their width.
    emulator_error : float
        Shift of the posterior's mean by the density's error, over its standard deviation.
    missing : {"refuse", "drop"}
        Whether a gap of the table is an error or an outcome that was not measured.
    resume : bool
        Whether to go on with the patches that ``OUTPUT.partial`` or `output` has, as of an interrupted inference or of other data of this scene.
        Errors to reach are of all patches together.
    reuse : path, optional
        Another result of this scene whose patches are taken, too.
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
    experiments.check_settings(seed=seed, threads=threads)
    if resume and reuse is not None:
        raise SceneError("reuse: resume=True goes on with the patches of the output, which has reused ones, too; leave one of them out")
    output = None if output is None else Path(output)
    begun = None if output is None else source(output, resume, force)
    if output is not None:
        inputs = named_files(scene) if isinstance(data, Measurements) else [data, *named_files(scene)]
        files.check(output, force=force or resume, inputs=inputs)
    # Matrices are so small that threads would only wait for each other.
    with work(progress=progress), threadpool_limits(1):
        with stating_what_is_kept(output, "the patches simulated before"):
            measured, priors = checked(data, scene, missing)
            kept = Kept(priors, measured, seed, threads, None if output is None else partial(output))
            if (taken := begun or reuse) is not None:
                kept.take(taken)
            found = _inferred(measured, priors, kept, Goals(seed, end_error, emulator_error))
    if output is not None:
        found.save(output, force=force or resume)
        partial(output).unlink(missing_ok=True)
    return found


def checked(data: str | Path | Measurements, scene: Scene, missing: str = "refuse") -> tuple[Measurements, Priors]:
    """The data and the scene with its priors, with all that can be wrong with either found by a few patches.

    Raises
    ------
    SceneError, FileError
        As `infer`.
    """
    if isinstance(data, Measurements):
        measured, priors = data, scenes.read(scene, batches=True)
    else:
        # What is no table is found before anything runs.
        conditions = measurements.first_conditions(data)
        priors = scenes.read(scene, batches=True)
        with Bar("trial patches"):
            known = outcomes_of(priors, conditions)
        measured = measurements.read(data, outcomes=known, missing=missing)
    outliers_of(priors)
    if priors.of_batch is not None and len(measured.batches) < 2:
        key = priors.keys[priors.of_batch.place]
        raise SceneError(f"{key}.batch_log_std: the data need a column `batch` or `specimen` with at least two labels; there {'is' if measured.batches else 'are'} {len(measured.batches) or 'none'}")
    with Bar("trial patches"):
        try_out(priors, measured)
    return measured, priors


def _inferred(measured: Measurements, priors: Priors, kept: Kept, goals: Goals) -> Inference:
    found = posterior(measured, kept, over_priors(priors, kept, goals), goals)
    with work("result"), Bar("checks"):
        return _result(found, goals.emulator_error, kept)


def over_priors(priors: Priors, kept: Kept, goals: Goals) -> list[Patches]:
    """Patches over the priors for each set of conditions: former ones, if there are any."""
    if (former := kept.former()) is not None:
        return former
    first = 2 ** math.ceil(math.log2(_POINTS * len({*priors.keys} - {FORCE_SCALE})))
    with work("over the priors"):
        return kept.simulated(design(priors, first, goals.seed), _FIRST)


@dataclass(frozen=True)
class Posterior:
    """A posterior, the likelihood, the error of its density as the last batch has it, p-values of the check, (outcomes,), and whether a grid has it."""

    chains: Chains
    likelihood: Likelihood
    error: Misfit
    checks: Array
    is_grid: bool


def posterior(measured: Measurements, kept: Kept, patches: list[Patches], goals: Goals) -> Posterior:
    """The posterior from patches over the priors and from batches where it is."""
    _check_scatter(measured, patches)
    priors, floors = kept.priors, np.log(measured.floors)
    patches = _floored(patches, floors)
    around: Array | None = None
    wide: Array | None = None
    level, batch = 0, 0
    if kept.former() is not None:
        # Most of them are where a posterior was.
        random, likelihood = np.random.default_rng([goals.seed, batch]), _likelihood(measured, priors, patches, None, level)
        wide = _rough(likelihood, None, random, _FLANKS)
        around = priors.natural(likelihood.of_any_batch(wide, random))
    while True:
        batch, is_local = batch + 1, around is not None
        random = np.random.default_rng([goals.seed, batch])
        with work(f"batch {batch} of at most {_MOST_BATCHES}"):
            likelihood = _likelihood(measured, priors, patches, around, level)
            with Bar("rough posterior"):
                z, wide = _rough(likelihood, wide, random), _rough(likelihood, wide, random, _FLANKS)
            flanks = likelihood.of_any_batch(wide, random)
            around = priors.natural(flanks)
            of_batches = likelihood.of_batches(z, random)
            covariance = _of_each_batch(priors, of_batches)
            near = of_batches[np.arange(len(z)), random.integers(of_batches.shape[1], size=len(z))]
            made = _batch(kept, (near, flanks), random, _FRESH if is_local else _ROUGH)
            fresh, more = (_floored(of, floors) for of in made)
            with Bar("error of the density"):
                found = misfit(likelihood, fresh, covariance, random)
                # The density of the result has the patches of this batch, too.
                rest = math.sqrt(len(patches[0].values) / (len(patches[0].values) + len(fresh[0].values) + len(more[0].values)))
                found = dataclasses.replace(found, share=max(found.share, rest * scatter(likelihood, patches, z[:_SCATTER]) if is_local else 1.0))
                if level + 1 < len(PARTS):
                    level += gain(likelihood, likelihood.refitted(patches, PARTS[level + 1]), fresh, batch) > _BETTER
            patches = [one + two + three for one, two, three in zip(patches, fresh, more, strict=True)]
            if (is_local and max(found.share, found.noise) <= goals.emulator_error) or batch == _MOST_BATCHES:
                break
    random = np.random.default_rng([goals.seed, 0])
    with work("result"):
        likelihood = _likelihood(measured, priors, patches, around, level)
        gridded = None
        if likelihood.is_gridded:
            with Bar("posterior"):
                gridded = on_grid(likelihood, likelihood.dimensions, _GRID_DRAWS, random, about=wide)
        chains = independent(*gridded) if gridded else sample(likelihood, _rough(likelihood, wide, random), seed=goals.seed, end_error=goals.end_error)
        with Bar("checks"):
            flat = chains.z.reshape(-1, likelihood.dimensions)
            of_batches = likelihood.of_batches(flat[random.choice(len(flat), min(_CHECKED, len(flat)), replace=False)], random)
            checks = check_p_values(likelihood, of_batches, random)
    return Posterior(chains, likelihood, found, checks, is_grid=gridded is not None)


def _likelihood(measured: Measurements, priors: Priors, patches: list[Patches], around: Array | None, level: int) -> Likelihood:
    with Bar("density"):
        emulator = Emulator(priors, patches, around=around, parts=PARTS[level])
    return Likelihood(emulator, measured, priors, outliers_of(priors), outlier_range(measured, [of.logs for of in patches]))


def _rough(likelihood: Likelihood, about: Array | None, random: np.random.Generator, power: float = 1.0) -> Array:
    """Normal scores of draws of the posterior, of a power of the likelihood, (draws, parameters); `about` as in `on_grid`."""

    def tempered(z: Array) -> Array:
        return power * likelihood(z)

    if likelihood.is_gridded and (found := on_grid(tempered, likelihood.dimensions, _ROUGH_DRAWS, random, about=about, is_rough=True)):
        return found[0]
    return rough(tempered, likelihood.dimensions, _ROUGH_DRAWS, random, about=about)


def _batch(
    kept: Kept, where: tuple[Array, Array], random: np.random.Generator, over_measured: int
) -> tuple[list[Patches], list[Patches]]:
    """Fresh patches at draws of the posterior, and half of their number on its flanks: parameters of both, (draws, parameters), SI."""
    wanted = over_measured * max(len(group.values) for group in kept.measured.groups)
    points = max(_POINTS * len({*kept.priors.keys} - {FORCE_SCALE}), min(wanted // _OF_A_POINT, _MOST_POINTS))
    rows = math.ceil(wanted / points / ROW)
    near, flanks = (of[random.choice(len(of), count, replace=False)] for of, count in zip(where, (points, points // 2), strict=True))
    made = kept.simulated(np.concatenate([near, flanks]), rows * ROW)
    own = points * rows
    return [Patches(of.values[:own], of.logs[:own]) for of in made], [Patches(of.values[own:], of.logs[own:]) for of in made]


def _of_each_batch(priors: Priors, values: Array) -> Array:
    """Covariance of the natural parameters of a batch, the mean over batches, from draws (points, batches, parameters), SI."""
    each = [np.cov(priors.natural(values[:, batch]).T).reshape(values.shape[2], -1) for batch in range(values.shape[1])]
    result: Array = np.mean(each, axis=0)
    return result


def _floored(patches: list[Patches], floors: Array) -> list[Patches]:
    """Patches without what the data do not resolve."""
    return [Patches(of.values, np.maximum(of.logs, floors)) for of in patches]


def _check_scatter(measured: Measurements, patches: list[Patches]) -> None:
    """Refuses outcomes of which all simulated patches have one value: no density can be fitted."""
    for of in patches:
        for name, unit, logs, floor in zip(measured.outcomes, measured.units, np.moveaxis(of.logs, 2, 0), measured.floors, strict=True):
            logs = np.maximum(logs, np.log(floor))
            if np.ptp(logs) == 0.0:
                raise StictionError(
                    f"{name}: all simulated patches are alike, {quantities.si(np.exp(logs.flat[0]), unit)}, and those below a tenth of the smallest "
                    f"datum, {quantities.si(floor, unit)}, are set to it: check the unit of the column, and the priors"
                )


def _result(found: Posterior, wanted: float, kept: Kept) -> Inference:
    chains, likelihood, error = found.chains, found.likelihood, found.error
    measured, priors = likelihood.measured, likelihood.priors
    random = np.random.default_rng(kept.count)
    count, draws, dimensions = chains.z.shape
    flat = chains.z.reshape(-1, dimensions)
    values = likelihood.values(flat)
    drawn = random.standard_normal((_PRIOR, dimensions))
    of_batches = likelihood.of_batches(flat, random)
    pieces = np.array_split(of_batches, max(len(flat) // 200, 1))
    pointwise = np.concatenate([likelihood.log_densities(piece) for piece in pieces]).reshape(count, draws, -1)
    replicated = np.concatenate([likelihood.predicted(piece, random) for piece in pieces]).reshape(count, draws, measured.size, -1)
    doubts, outliers = likelihood.doubts(of_batches[random.choice(len(flat), min(_CHECKED, len(flat)), replace=False)])
    observed = _observed(measured, doubts)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data = arviz.from_dict(
            posterior=_parameters(likelihood, flat, (count, draws)),
            sample_stats={"lp": chains.log_probability},
            log_likelihood={"patch": pointwise},
            posterior_predictive={name: replicated[..., j] for j, name in enumerate(measured.outcomes)},
            observed_data=observed,
            prior=_parameters(likelihood, drawn, (1, _PRIOR)),
            dims={"patch": ["patch_number"], **{name: ["patch_number"] for name in observed}},
            coords={"patch_number": np.arange(measured.size)},
        )
        data.add_groups(identifiability=_identifiability(values, likelihood.values(drawn), likelihood, random), **{GROUP: kept.dataset()})
        if priors.of_batch is not None:
            data.add_groups(batches=_batches(of_batches.reshape(count, draws, *of_batches.shape[1:]), likelihood))
    _attributes(data, chains, likelihood, flat, drawn)
    for name, unit in zip(measured.outcomes, measured.units, strict=True):
        for of in (data.observed_data, data.posterior_predictive):
            of[name].attrs["units"] = unit
        data.observed_data[f"{name}_error"].attrs["units"] = unit
        data.observed_data[f"{name}_kind"].attrs["flag_meanings"] = "0 number, 1 below it, 2 above it, 3 not measured"
    data.posterior.attrs.update(
        format=FORMAT, format_version="1.0", title=str(priors.tables.get("title", "")), scene=toml(priors.tables), outcomes=", ".join(measured.outcomes),
        patches=measured.size, gaps=measured.gaps, check_p_value=found.checks, acceptance=chains.acceptance,
        emulator_share=error.share, emulator_noise=error.noise, emulator_distance=error.distance, emulator_wanted=wanted,
        simulated_patches=kept.count, is_grid=int(found.is_grid), outliers=outliers, outliers_expected=outliers_of(priors), doubted="\n".join(_doubted(measured, doubts)), batches=", ".join(measured.batches),
    )  # fmt: skip
    inference = Inference(data)
    data.attrs = {"format": FORMAT, "format_version": np.array(_VERSION), "title": data.posterior.attrs["title"],
                  "scene": data.posterior.attrs["scene"], "summary": str(inference)}  # fmt: skip
    return inference


def _parameters(likelihood: Likelihood, z: Array, shape: tuple[int, int]) -> dict[str, Array]:
    """Draws of the parameters by name, from normal scores (draws, parameters)."""
    columns = [*likelihood.values(z).T]
    if likelihood.priors.of_batch is not None:
        columns.append(likelihood.spread_of_batches(z))
    return {name: column.reshape(shape) for name, column in zip(likelihood.priors.names, columns, strict=True)}


def _observed(measured: Measurements, doubts: Array) -> dict[str, Array]:
    """The data, and how far each is doubted."""
    groups, observed = measured.groups, {}
    for j, name in enumerate(measured.outcomes):
        observed[name] = np.concatenate([group.values[:, j] for group in groups])
        observed[f"{name}_error"] = np.concatenate([group.errors[:, j] for group in groups])
        observed[f"{name}_kind"] = np.concatenate([group.kinds[:, j] for group in groups])
    return {**observed, "outlier_probability": doubts}


def _batches(values: Array, likelihood: Likelihood) -> xarray.Dataset:
    """The number that differs between batches, of each of them: (chains, draws, batches)."""
    of_batch = likelihood.priors.of_batch
    assert of_batch is not None
    prior = likelihood.priors.priors[of_batch.place]
    own = (("chain", "draw", "batch"), values[..., of_batch.place], {"units": prior.unit, "long_name": f"{prior.key} of each batch"})
    return xarray.Dataset({prior.name: own}, coords={"batch": list(likelihood.measured.batches)})


def _attributes(data: Any, chains: Chains, likelihood: Likelihood, flat: Array, drawn: Array) -> None:
    """Gives each parameter its unit and the figures of its draws."""
    priors = likelihood.priors
    after, before = priors.natural(likelihood.values(flat)), priors.natural(likelihood.values(drawn))
    for k, name in enumerate(data.posterior.data_vars):
        prior = priors.priors[k] if k < len(priors.priors) else None
        for group in (data.posterior, data.prior):
            group[name].attrs.update(units=prior.unit if prior else "1", long_name=prior.key if prior else "standard deviation of the logarithm between batches")
        contraction = 1.0 - float(after[:, k].var() / before[:, k].var()) if prior else 1.0 - float(data.posterior[name].var() / data.prior[name].var())
        data.posterior[name].attrs.update(
            r_hat=chains.r_hat[k], effective=chains.effective[k], end_error=chains.end_errors[k], contraction=contraction,
            logarithmic=int(prior.logarithmic if prior else False),
        )  # fmt: skip


def _doubted(measured: Measurements, doubts: Array) -> Iterator[str]:
    """Sentences on the data that are rather outliers than patches of the model."""
    table = np.concatenate([group.values for group in measured.groups])
    lines = [line for group in measured.groups for line in group.lines]
    samples = [sample for group in measured.groups for sample in group.samples]
    for patch in np.flatnonzero(doubts > 0.5):
        where = f"line {lines[patch]}" if lines else f"patch {patch}"
        where = f"{samples[patch]}, {where}" if samples else where
        numbers = ", ".join(
            f"{name} {quantities.si(value, unit)}"
            for name, unit, value in zip(measured.outcomes, measured.units, table[patch], strict=True)
            if not math.isnan(value)
        )
        yield f"{where}, {numbers}: {100.0 * doubts[patch]:.0f} % for an outlier"


def _identifiability(values: Array, drawn: Array, likelihood: Likelihood, random: np.random.Generator) -> xarray.Dataset:
    """Combinations of the parameters by how far the data narrow them, and the Fisher information at the posterior's mean.

    A combination is Σ a_k q_k of the logarithms of the parameters; of one that may be negative q is the number over the standard deviation of its prior. Those that are
    independent under prior and posterior are the solutions of C_posterior a = r C_prior a, with r the fraction of the variance that is left.
    """
    priors = likelihood.priors
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
    axes = np.asarray(np.linalg.cholesky(np.cov(natural.T).reshape(after.shape)))
    information = _fisher(middle, axes, likelihood, random)
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


def _fisher(at: Array, axes: Array, likelihood: Likelihood, random: np.random.Generator) -> Array:
    """Expected information of the data's patches, with their errors, gaps and limits, on natural parameters: the mean of the outer products of scores along `axes`."""
    result = np.zeros((len(at), len(at)))
    point = likelihood.priors.values(at[None])
    for place, group in enumerate(likelihood.measured.groups):
        emulator = likelihood.emulator.of_group(place)
        logs = emulator.densities[0].draw(np.repeat(emulator.scaled(point), _SCORED, axis=0), random)
        each = scores(likelihood, place, as_measured(group, logs, random), point[0], axes) @ np.linalg.inv(axes)
        result += len(group.values) / len(each) * each.T @ each
    return result
