"""Patches of a scene at many parameters, and the likelihood of measured ones."""

from __future__ import annotations

import copy
import dataclasses
import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray
from scipy.special import log_ndtr
from scipy.stats import qmc

from .. import experiments, quantities
from ..errors import SceneError
from ..priors import Priors
from ..progress import work
from ..results import OF_WHOLE_LOOP
from .data import ABOVE, BELOW, EXACT, MISSING, Group, Measurements
from .density import Density, fit, log_sum_exp

__all__ = ["FORCE_SCALE", "PARTS", "ROW", "Emulator", "Patches", "as_measured", "design", "log_density", "outcomes_of", "outliers_of", "simulate", "try_out"]

Array = NDArray[np.float64]
_HALF_LOG_2PI = 0.5 * np.log(2.0 * np.pi)
# Gauss's rule over a measured outcome, and over a limit; weights of the normal law.
_NODES, _NODE_WEIGHTS = np.polynomial.hermite_e.hermegauss(5)
_NODE_WEIGHTS = _NODE_WEIGHTS / _NODE_WEIGHTS.sum()
_LIMIT_NODES, _LIMIT_WEIGHTS = np.polynomial.hermite_e.hermegauss(9)
_LIMIT_WEIGHTS = _LIMIT_WEIGHTS / _LIMIT_WEIGHTS.sum()
# Relative errors below which the logarithm has a Gaussian error.
_SMALL_ERROR = 0.01
# ln p of what cannot be, so that differences are numbers.
_LEAST_LOG = -700.0
#: Parts of a density, from the simplest to the most flexible.
PARTS = (4, 6, 10)
# Simulated parameters lie between these quantiles of each prior.
_TAIL = 1e-3
# How much further than the root of the number of parameters a fit holds, in standard deviations of what it is about.
_EDGE = 1.5
# ln of the likelihood beyond.
_BEYOND = -1e9
# Numbers of a table over points, patches and parts at most.
_MOST_NUMBERS = 2_000_000
#: Patches of a point that stand together.
ROW = 50
# Points of the priors at which patches are tried where data are off those in the middle, and how far they are off.
_TRIED, _FAR_OFF = 16, 100.0
#: The key of the factor that all measured forces share; the scene of the program has none.
FORCE_SCALE = "calibration.force_scale"
# The largest fraction of patches at a point that may lack an outcome, as a patch without tall tips that no preload reaches.
_MOST_LACKING = 0.02
# Fraction of outliers that is expected.
_OUTLIERS = 0.02
# Beginnings of units with a newton.
_OF_FORCES = ("N", "J")


@dataclass(frozen=True)
class Patches:
    """Simulated patches.

    Attributes
    ----------
    values : array (points, parameters)
        Parameters in SI units.
    logs : array (points, replicas, outcomes)
        Logarithms of the outcomes in SI units.
    """

    values: Array
    logs: Array

    def __add__(self, other: Patches) -> Patches:
        return Patches(np.concatenate([self.values, other.values]), np.concatenate([self.logs, other.logs]))


def design(priors: Priors, count: int, seed: int) -> Array:
    """Parameters that fill the priors, (count, parameters) in SI units: scrambled Sobol points between the quantiles 0.001 and 0.999."""
    points = qmc.Sobol(len(priors.priors), seed=seed).random(count)
    return priors.draw(_TAIL + (1.0 - 2.0 * _TAIL) * points)


def simulate(
    priors: Priors,
    outcomes: tuple[str, ...],
    values: Array,
    *,
    units: tuple[str, ...] | None = None,
    replicas: int,
    seed: int,
    threads: int | None = None,
    floors: Array | float = 0.0,
    conditions: Mapping[str, Any] | None = None,
) -> Patches:
    """Patches at some parameters, by one run: a sweep with random numbers of its own for each point.

    Forces, stiffnesses and energies are multiplied by ``calibration.force_scale`` of the scene, 1 without it: the factor by which an
    error of the calibration, such as of a cantilever's stiffness, makes all measured ones larger than the true ones.

    The density is fitted to all points together. Errors of points that are independent average out in the fit; with common random numbers all
    points would err alike, and the fit with them. Over ten seeds of 64 points of 100 patches posterior means of Δγ and σ_s scattered by 0.88 and
    0.76 of the posterior's width with common numbers, by 0.40 and 0.32 with independent ones.

    Parameters
    ----------
    priors : Priors
        The scene and the keys that have priors.
    outcomes : tuple of str
        Datasets of /replicas.
    values : array (points, parameters)
        In SI units.
    units : tuple of str, optional
        SI units of the data, which have to be the units of the datasets.
    replicas, seed, threads
        As in `stiction.sweep`.
    floors : array (outcomes,) or float
        Outcomes below are taken as these (SI): what no measurement distinguishes.
    conditions : dict, optional
        Other values of keys of the scene.

    Raises
    ------
    SceneError
        The scene cannot be, at a point of the prior or at all; a patch has no such outcome.
    """
    tables = _tables(priors, conditions or {}, replicas)
    scale = _force_scale(tables, priors, values)
    known = _known(tables, priors, values, seed=seed, threads=threads)
    if "force_scale" in _calibration(tables) and not any(_has_newton(known[name]) for name in outcomes if name in known):
        raise SceneError(f"{FORCE_SCALE}: none of {', '.join(outcomes)} is a force, a stiffness or an energy; leave it out")
    columns = []
    for name, floor in zip(outcomes, np.broadcast_to(floors, len(outcomes)), strict=True):
        if name not in known:
            raise SceneError(f"{name}: not one number of each patch of this scene; it has {', '.join(known)}")
        own = quantities.plain_unit(str(known[name].attrs["units"]))
        if units is not None and not quantities.of_one_dimension([units[outcomes.index(name)], own]):
            given = units[outcomes.index(name)] or "no unit"
            raise SceneError(f"{name}: the data have it in {given}, and it is one in {own or 'no unit'}: {name}{f' ({own})' if own else ''} is needed")
        numbers = known[name].transpose("point", "replica").values
        columns.append(np.maximum(scale[:, None] * numbers if _has_newton(known[name]) else numbers, floor))
    return Patches(values, np.log(_complete(np.stack(columns, axis=2), outcomes, priors.axes(values))))


def _complete(numbers: Array, outcomes: tuple[str, ...], axes: Mapping[str, list[str | float]]) -> Array:
    """Outcomes (points, replicas, outcomes) without the patches that lack one: others of the point are in their places.

    Raises
    ------
    SceneError
        At a point more than 2 % of the patches lack an outcome, and more than one does.
    """
    lacks = ~(numbers > 0.0)
    of_patch: NDArray[np.bool_] = np.any(lacks, axis=2)
    counts = of_patch.sum(axis=1)
    most = min(max(_MOST_LACKING * numbers.shape[1], 1.0), numbers.shape[1] - 1.0)
    if counts.max() > most:
        worst = int(counts.argmax())
        name, share = outcomes[int(lacks[worst].sum(axis=0).argmax())], 100.0 * counts[worst] / numbers.shape[1]
        where = ", ".join(f"{key} = {texts[worst]}" for key, texts in axes.items())
        raise SceneError(
            f"{name}: {share:.2g} % of the patches have none at {where}; narrow the priors to where every patch has one, or reach it with [separation]"
        )
    for point in np.flatnonzero(counts):
        numbers[point] = np.resize(numbers[point, ~of_patch[point]], numbers[point].shape)
    return numbers


def outcomes_of(priors: Priors, conditions: Mapping[str, Any]) -> dict[str, str]:
    """The numbers that each patch of a scene has under some conditions, and their units as files have them, by a run of two patches.

    Raises
    ------
    SceneError
        The scene cannot be.
    """
    tables, values = _tables(priors, conditions, 2), _middle(priors)
    _force_scale(tables, priors, values)
    with work(progress=False):
        known = _known(tables, priors, values, seed=1)
    return {name: str(of.attrs["units"]) for name, of in known.items()}


def try_out(priors: Priors, measured: Measurements) -> None:
    """Two patches under each set of conditions, so that what is wrong is seen before minutes are spent.

    Raises
    ------
    SceneError
        As `simulate`, or the data are more than a factor of 100 off what patches have, also over the priors.
    """
    for group in measured.groups:
        for values in (_middle(priors), design(priors, _TRIED, 1)):
            with work(progress=False):
                patches = simulate(
                    priors, measured.outcomes, values, units=measured.units, replicas=2, seed=1,
                    floors=float(np.finfo(float).tiny), conditions=group.conditions,
                )  # fmt: skip
            problem = _far_off(group, measured, patches)
            if not problem:
                break
        else:
            raise SceneError(problem)


def _far_off(group: Group, measured: Measurements, patches: Patches) -> str:
    """What is wrong where the median of an outcome is far off that of all patches, or nothing."""
    for j, (name, unit) in enumerate(zip(measured.outcomes, measured.units, strict=True)):
        given = group.values[group.kinds[:, j] == EXACT, j]
        if len(given) == 0:
            continue
        median = float(np.median(given))
        low, high = (float(np.exp(end(patches.logs[:, :, j]))) for end in (np.min, np.max))
        if not low / _FAR_OFF <= median <= high * _FAR_OFF:
            own = f"at most {quantities.si(high, unit)}" if median > high else f"at least {quantities.si(low, unit)}"
            return (
                f"{name}: the median of the data is {quantities.si(median, unit)}, and trial patches over the priors have "
                f"{own}; check the unit of the column"
            )
    return ""


def _middle(priors: Priors) -> Array:
    return np.array([[prior.median for prior in priors.priors]])


def _tables(priors: Priors, conditions: Mapping[str, Any], replicas: int) -> dict[str, Any]:
    """The tables of the scene under some conditions."""
    scene = priors.tables
    if "sweep" in scene:
        raise SceneError("sweep: a scene with priors has none, the keys with priors are varied; leave it out")
    tables = {**scene, "sweep": {"common_random_numbers": False}}
    ensemble = {key: value for key, value in scene.get("ensemble", {}).items() if key == "sampling"}
    tables["ensemble"] = {**ensemble, "replicas": replicas}
    if ensemble.get("sampling", "independent") != "independent":
        raise SceneError("ensemble.sampling: the distribution of patches needs independent ones")
    for key, value in conditions.items():
        if key in priors.keys:
            raise SceneError(f"{key}: a column of the data has its values, and the scene a prior; one of them is needed")
        table, name = key.rsplit(".", 1)
        if table not in tables:
            raise SceneError(f"{key}: a column of the data has its values, but the scene has no table [{table}]")
        tables[table] = {**tables[table], name: value}
    return tables


def _force_scale(tables: Mapping[str, Any], priors: Priors, values: Array) -> Array:
    """``calibration.force_scale`` at each point, (points,): 1 without it."""
    try:
        number, unit = quantities.parsed(FORCE_SCALE, _calibration(tables).get("force_scale", 1.0))
    except ValueError as error:
        raise SceneError(str(error)) from None
    place = priors.keys.index(FORCE_SCALE) if FORCE_SCALE in priors.keys else None
    least = number if place is None else float(priors.priors[place].distribution.ppf(_TAIL))
    if unit != "1" or not least > 0.0:
        given = f"= {_calibration(tables)['force_scale']!r}" if unit != "1" or place is None else f"may be {least:.3g}"
        raise SceneError(f"{FORCE_SCALE} {given}: a number greater than 0 without a unit is needed, measured forces over true ones")
    return np.full(len(values), number) if place is None else values[:, place]


def outliers_of(priors: Priors) -> float:
    """``calibration.outliers``: the fraction of the data that is expected to be of something else than the model."""
    given = _calibration(priors.tables).get("outliers", _OUTLIERS)
    if isinstance(given, bool) or not isinstance(given, int | float) or not 0.0 <= given <= 0.3:
        raise SceneError(f"calibration.outliers = {given!r}: a number from 0 to 0.3 is needed, the fraction of the data that is expected to be of something else; 0 without")
    return float(given)


def _calibration(tables: Mapping[str, Any]) -> Mapping[str, Any]:
    table = tables.get("calibration", {})
    if not isinstance(table, Mapping) or not set(table) <= {"force_scale", "outliers"}:
        raise SceneError(f"calibration: a table with force_scale, outliers or both is needed, not {table!r}")
    return table


def _has_newton(of: xarray.DataArray) -> bool:
    return str(of.attrs["units"]).startswith(_OF_FORCES)


def _known(tables: Mapping[str, Any], priors: Priors, values: Array, **options: Any) -> dict[str, xarray.DataArray]:
    """The datasets with one number for each patch, over points and replicas; after a preload none of the whole loop's pull-off.

    It takes the options of `stiction.sweep`.
    """
    axes = {key: of for key, of in priors.axes(values).items() if key != FORCE_SCALE}
    if not axes:
        raise SceneError(f"{FORCE_SCALE}: it alone has a prior; another number of the scene needs one, too")
    own = {name: table for name, table in tables.items() if name != "calibration"}
    try:
        patches = experiments.patches(own, axes, **options, **experiments.ONE_MODEL)
    except SceneError as error:
        raise SceneError(f"at a point of the priors: {error}") from None
    known = {}
    for name, of in patches.data_vars.items():
        squeezed = of.squeeze([d for d in of.dims if d not in ("point", "replica") and of.sizes[d] == 1])
        if set(squeezed.dims) == {"point", "replica"}:
            known[str(name)] = squeezed
    if "preload" in tables.get("instability", {}):
        known = {name: of for name, of in known.items() if name not in OF_WHOLE_LOOP}
    return known


class Emulator:
    """Densities of the outcomes over the parameters under all conditions of the data, fitted to simulated patches.

    Parameters
    ----------
    priors : Priors
        For the scale of the parameters.
    patches : list of Patches
        For each set of conditions.
    around : array (draws, parameters), optional
        Draws of `Priors.natural` about which the densities are fitted and hold, wider than a posterior; without it over all of the priors.
    parts : int
        Of the densities, as in `PARTS`.
    """

    def __init__(
        self, priors: Priors, patches: list[Patches], *, around: Array | None = None, parts: int = PARTS[0]
    ) -> None:
        self.priors = priors
        self._is_local = around is not None
        if around is None:
            quantiles = [prior.distribution.ppf([_TAIL, 1.0 - _TAIL]) for prior in priors.priors]
            low, high = priors.natural(np.stack(quantiles, axis=1))
            self._middle, self._axes = 0.5 * (low + high), np.diag(0.5 * (high - low))
        else:
            covariance = np.cov(around.T).reshape(around.shape[1], -1)
            self._middle, self._axes = around.mean(axis=0), np.linalg.cholesky(covariance)
        self._edge = len(self._middle) ** 0.5 + _EDGE
        self._parts = parts
        self.densities = [self._fitted(of) for of in patches]

    def refitted(self, patches: list[Patches], parts: int | None = None) -> Emulator:
        """The same densities, fitted to other patches or of another number of parts."""
        other = copy.copy(self)
        other._parts = parts or self._parts
        other.densities = [other._fitted(of) for of in patches]
        return other

    def _fitted(self, patches: Patches) -> Density:
        x = self._placed(patches.values)
        if not self._is_local:
            return fit(x, patches.logs, np.ones(len(x)), parts=self._parts)
        away, parameters = np.linalg.norm(x, axis=1), x.shape[1]
        # As many as the coefficients need, where few are near.
        least = np.sort(away)[min(2 * (parameters + 1) * (parameters + 2), len(x) - 1)]
        near = away <= max(self._edge, float(least))
        # Most of many parameters are far off in some direction.
        weights = np.maximum(np.exp(-(away[near] ** 2) / (2 * parameters)), 1e-3)
        return fit(x[near], patches.logs[near], weights, parts=self._parts)

    def _placed(self, values: Array) -> Array:
        away = self.priors.natural(values) - self._middle
        placed: Array = np.linalg.solve(self._axes, away.T).T
        return placed

    def reach(self, place: int) -> tuple[float, float]:
        """The least and the largest value of a parameter, SI, where the densities hold."""
        half = float(np.linalg.norm(self._axes[place])) * (self._edge if self._is_local else 1.0)
        ends = np.repeat(self._middle[None], 2, axis=0)
        ends[:, place] += [-half, half]
        low, high = self.priors.values(ends)[:, place]
        return float(low), float(high)

    def holds(self, values: Array) -> NDArray[np.bool_]:
        """Whether parameters are where the densities were fitted, (points,)."""
        x = self._placed(values)
        inside: NDArray[np.bool_] = np.linalg.norm(x, axis=1) <= self._edge if self._is_local else np.ones(len(x), dtype=bool)
        return inside

    def scaled(self, values: Array) -> Array:
        """Parameters as the densities take them, the nearest where they hold."""
        x = self._placed(values)
        if not self._is_local:
            return np.clip(x, -1.0, 1.0)
        away = np.linalg.norm(x, axis=1, keepdims=True)
        result: Array = x * np.minimum(1.0, self._edge / np.maximum(away, 1e-300))
        return result

    def of_group(self, place: int) -> Emulator:
        """That of one set of conditions."""
        single = copy.copy(self)
        single.densities = [self.densities[place]]
        return single

    def log_densities(self, groups: tuple[Group, ...], values: Array) -> Array:
        """ln p of each patch of the data at each point, (points, patches); as good as none where the densities do not hold."""
        size = sum(len(group.values) for group in groups) * self.densities[0].slopes.shape[1]
        pieces = np.array_split(values, max(len(values) * size // _MOST_NUMBERS, 1))
        result = np.concatenate([self._log_densities(groups, self.scaled(piece)) for piece in pieces])
        result[~self.holds(values)] = _BEYOND
        return result

    def _log_densities(self, groups: tuple[Group, ...], x: Array) -> Array:
        return np.concatenate([log_density(of, group, x) for of, group in zip(self.densities, groups, strict=True)], axis=1)

    def cumulative(self, groups: tuple[Group, ...], values: Array) -> Array:
        """P(measured outcome ≤ the data's): (points, patches, outcomes); of limits at the limit, NaN where missing."""
        x = self.scaled(values)
        result = []
        for density, group in zip(self.densities, groups, strict=True):
            columns = []
            for j in range(group.values.shape[1]):
                kinds = np.full(group.kinds.shape, MISSING)
                kinds[:, j] = np.where(group.kinds[:, j] == MISSING, MISSING, BELOW)
                one = dataclasses.replace(group, kinds=kinds)
                columns.append(np.where(group.kinds[:, j] == MISSING, np.nan, np.exp(log_density(density, one, x))))
            result.append(np.stack(columns, axis=2))
        return np.concatenate(result, axis=1)

    def measured(self, groups: tuple[Group, ...], values: Array, random: np.random.Generator) -> Array:
        """Data like the given ones, one set for each point: (points, patches, outcomes), SI, without limits."""
        x, result = self.scaled(values), []
        for density, group in zip(self.densities, groups, strict=True):
            drawn = np.stack([np.exp(density.draw(x, random)) for _ in group.values], axis=1)
            result.append(drawn + group.errors * random.standard_normal(drawn.shape))
        return np.concatenate(result, axis=1)


def as_measured(group: Group, logs: Array, random: np.random.Generator, like: NDArray[np.int64] | None = None) -> Group:
    """Patches as the data of a group would have them: with the errors, gaps and limits of data.

    Parameters
    ----------
    group : Group
        The data.
    logs : array (patches, outcomes)
        Logarithms of the outcomes, SI.
    random : numpy.random.Generator
        It draws errors.
    like : array (patches,), optional
        Of which datum each has the error and the gap; without it of data at random.
    """
    if like is None:
        like = random.integers(len(group.values), size=len(logs))
    errors = group.errors[like]
    values = np.exp(logs) + errors * random.standard_normal(logs.shape)
    kinds = np.where(group.kinds[like] == MISSING, MISSING, EXACT)
    for j in range(logs.shape[1]):
        for kind, nearest, is_beyond in ((BELOW, np.max, np.less), (ABOVE, np.min, np.greater)):
            if (limits := group.values[group.kinds[:, j] == kind, j]).size:
                beyond = (kinds[:, j] == EXACT) & is_beyond(values[:, j], limit := nearest(limits))
                values[beyond, j], kinds[beyond, j] = limit, kind
    kinds = np.where((values > 0.0) | (kinds != EXACT), kinds, MISSING)
    return Group(group.conditions, np.where(kinds == MISSING, 1.0, values), errors, kinds)


def log_density(density: Density, group: Group, x: Array) -> Array:
    """ln p of each patch at each point, (points, patches), from the logarithms of the outcomes and their errors."""
    log_weights, means, widths = density.parts(x)
    whole = log_weights[:, None, :]  # (points, patches, parts)
    for j in range(group.values.shape[1]):
        mean, width = means[:, None, :, j], widths[:, None, :, j]
        terms = np.zeros((len(x), len(group.values), whole.shape[2]))
        for kind in (EXACT, BELOW, ABOVE):
            for measured in (False, True):
                of = np.flatnonzero((group.kinds[:, j] == kind) & ((group.errors[:, j] > 0.0) == measured))
                if of.size:
                    # Limits are often equal.
                    pairs, back = np.unique(np.stack([group.values[of, j], group.errors[of, j]], axis=1), axis=0, return_inverse=True)
                    value, error = pairs[:, :1], pairs[:, 1:]
                    each = _convolved(kind, value, error, mean, width) if measured else _plain(kind, value, mean, width)
                    terms[:, of] = each[:, back.ravel()]
        whole = whole + terms
    result: Array = log_sum_exp(whole, axis=2)
    return result


def _plain(kind: int, value: Array, mean: Array, width: Array) -> Array:
    """ln p of an outcome without error under parts that are Gaussian in the logarithm."""
    logs = np.log(value)
    deviation = (logs - mean) / width
    result: Array
    if kind == EXACT:
        result = -0.5 * deviation**2 - np.log(width) - _HALF_LOG_2PI - logs
    else:
        result = log_ndtr(deviation if kind == BELOW else -deviation)
    return result


def _convolved(kind: int, value: Array, error: Array, mean: Array, width: Array) -> Array:
    """ln p of an outcome with a Gaussian error.

    Of an outcome whose error is less than 1 % of it the logarithm has a Gaussian error: its mean is off by half of the square, 5e-5.
    """
    result = np.empty(np.broadcast_shapes(value.shape, mean.shape))
    small = (error / value)[:, 0] < _SMALL_ERROR
    if small.any():
        result[:, small] = _plain(kind, value[small], mean, np.hypot(width, (error / value)[small]))
    if not small.all():
        integral = _exact_integral if kind == EXACT else functools.partial(_limit_integral, kind)
        result[:, ~small] = np.maximum(integral(value[~small], error[~small], mean, width), _LEAST_LOG)
    return result


def _exact_integral(value: Array, error: Array, mean: Array, width: Array) -> Array:
    """ln of the density of a measured outcome: Gauss's rule about the largest of the integrand, as wide as that is there."""
    relative, logs = error / value, np.log(value)

    def over(at: Array) -> Array:
        """The outcome over the measured one; values far above are taken nearer, and as good as impossible."""
        result: Array = np.exp(np.minimum(at - logs, 100.0))
        return result

    middle = (mean / width**2 + logs / relative**2) / (1.0 / width**2 + 1.0 / relative**2)
    # One step of Gauss and Newton from its place if the error were one of the logarithm.
    ratio = over(middle)
    step = ((1.0 - ratio) * ratio / relative**2 - (middle - mean) / width**2) / ((ratio / relative) ** 2 + 1.0 / width**2)
    middle = middle + np.clip(step, -1.0, 1.0)
    spread = ((over(middle) / relative) ** 2 + 1.0 / width**2) ** -0.5
    each = []
    for node, weight in zip(_NODES, _NODE_WEIGHTS, strict=True):
        at = middle + spread * node
        each.append(np.log(weight) + 0.5 * node**2 - 0.5 * ((at - mean) / width) ** 2 - 0.5 * ((1.0 - over(at)) / relative) ** 2)
    result: Array = log_sum_exp(np.stack(each), axis=0) + np.log(spread / (width * error)) - _HALF_LOG_2PI
    return result


def _limit_integral(kind: int, value: Array, error: Array, mean: Array, width: Array) -> Array:
    """ln of the probability that an outcome is measured beyond a limit: Gauss's rule over whichever is narrower, the part or the error."""
    # Over the error: outcomes value − error z. No outcome is below 0, and every one is above.
    outcomes = value[..., None] - error[..., None] * _LIMIT_NODES
    each = _plain(kind, np.maximum(outcomes, 1e-9 * value[..., None]), mean[..., None], width[..., None])
    each = np.where(outcomes > 0.0, each, 0.0 if kind == ABOVE else -np.inf)
    with np.errstate(divide="ignore"):
        large = np.log(np.exp(each) @ _LIMIT_WEIGHTS)
    narrow = width * value < error  # (points, patches, parts)
    if narrow.any():
        # Over the part: outcomes exp(mean + width z), measured with the error.
        where = np.nonzero(narrow)
        of_part = np.broadcast_to(mean, narrow.shape)[where], np.broadcast_to(width, narrow.shape)[where]
        of_patch = value[where[1], 0, None], error[where[1], 0, None]
        outcomes = np.exp(np.minimum(of_part[0][:, None] + of_part[1][:, None] * _LIMIT_NODES, 300.0))
        deviation = (of_patch[0] - outcomes) / of_patch[1]
        large[where] = log_sum_exp(log_ndtr(deviation if kind == BELOW else -deviation) + np.log(_LIMIT_WEIGHTS), axis=-1)
    return large
