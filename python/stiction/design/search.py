"""The value of one number of a scene at which a rare pull-off has a wanted probability."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import optimize

from .. import experiments, priors, quantities
from ..errors import SceneError, written_at_end
from ..progress import work
from ..scenes import Scene
from .estimate import LEAST, Probability
from .heights import Array
from .rare import Patches

__all__ = ["Best", "Design", "Event", "best", "design", "event", "probability"]

# A search ends when the number is known so well, relative to its range (or to the logarithm of that).
_WIDTH = 0.005
# The error of a parabola through the logarithms of probabilities, times their square.
_BENT = 0.1
_STEPS = 12


@dataclass(frozen=True)
class Event:
    """A pull-off force of a patch above or below a threshold.

    Attributes
    ----------
    threshold : float
        N.
    below : bool
        Whether it is the patches below it.
    """

    threshold: float
    below: bool = False

    def __str__(self) -> str:
        return f"pull-off {'below' if self.below else 'above'} {quantities.si(self.threshold, 'N')}"


@dataclass(frozen=True)
class Best:
    """The value of a number with the least or the largest pull-off.

    Attributes
    ----------
    key, unit : str
        The number, and its SI unit.
    value : float
        Where the force is least, or largest.
    force, interval : float, tuple of float
        The force (N) that patches exceed, or stay below, with the probability, and its 95 % interval.
    tried : tuple of (float, float)
        Values and the forces there (N), in the order of the values.
    """

    key: str
    unit: str
    value: float
    force: float
    interval: tuple[float, float]
    tried: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Design:
    """The result of a search.

    Attributes
    ----------
    key, unit : str
        The number searched for, and its SI unit.
    value, interval : float, tuple of float
        The value with the wanted probability, and its 95 % interval, from the errors of the probabilities.
    at_end : bool
        Whether it is the end of the range, at which the wanted probability is not reached yet.
    tried : tuple of (float, Probability)
        Values and the probabilities there, in the order of the search.
    """

    key: str
    unit: str
    value: float
    interval: tuple[float, float]
    at_end: bool
    tried: tuple[tuple[float, Probability], ...]


def event(above: Any = None, below: Any = None) -> Event:
    """An event from one of two forces: numbers in N, texts with a unit, or pint quantities.

    Raises
    ------
    SceneError
        Not one of them is given, or it is no force.

    Examples
    --------
    >>> str(event(above="5 uN"))
    'pull-off above 5.000 µN'
    """
    if (above is None) == (below is None):
        raise SceneError('above, below: one of them is needed, such as above="5 uN"')
    name, given = ("above", above) if below is None else ("below", below)
    try:
        value, unit = quantities.parsed(name, given if isinstance(given, str) else quantities.as_text(given, "N"))
    except ValueError as error:
        raise SceneError(str(error)) from None
    if unit != "N" or not value > 0.0:
        raise SceneError(f"{name} = {given!r}: a force greater than 0 with a unit is needed")
    return Event(value, below is not None)


def probability(
    scene: Scene, *, above: Any = None, below: Any = None, error: float = 0.1, seed: int | None = None, threads: int | None = None,
    most: int | None = None, progress: bool | None = None,
) -> Probability:  # fmt: skip
    """The probability that a patch pulls harder (or less) than a threshold, however small.

    Parameters
    ----------
    scene : path or dict
        A scene of asperities of one radius, without priors; of independent ones for `below`.
    above, below : str, float or pint.Quantity
        One of them: the threshold, N.
    error : float
        Relative standard error that is wanted, from 0.01 to 0.5.
    seed, threads : int, optional
        As in `stiction.run`.
    most : int, optional
        Patches at most; by default 200 000 above a threshold, and 20 million below, with those that are moved.
    progress : bool, optional
        Whether to show it, as in `stiction.run`.

    Raises
    ------
    SceneError
        The scene or an argument is wrong; the message names it.
    StictionError
        The error is not reached with this number of patches.

    Examples
    --------
    >>> from stiction.design import probability
    >>> found = probability("configs/quick.toml", above="0.14 mN", error=0.2)
    >>> found.value < 0.1 and found.relative_error <= 0.2
    True
    """
    happens = event(above, below)
    _checked(error, seed, threads)
    tables = _fixed(scene)
    with written_at_end(), work(progress=progress):
        return Patches(tables, seed=seed, threads=threads).probability(
            happens.threshold, below=happens.below, error=error, most=most
        )


def design(
    scene: Scene, wanted: float, *, above: Any = None, below: Any = None, largest: bool = True, error: float = 0.1,
    seed: int | None = None, threads: int | None = None, progress: bool | None = None,
) -> Design:  # fmt: skip
    """The largest (or smallest) value of a number with which an event is at most as probable as wanted.

    The logarithm of the probability is taken as monotonic in the number between the ends of its range.

    Parameters
    ----------
    scene : path or dict
        A scene as `probability` takes it, with one number that has a range: a prior ``uniform`` or ``log_uniform``.
    wanted : float
        Probability of the event, at most.
    above, below : str, float or pint.Quantity
        One of them: the threshold of the event, N.
    largest : bool
        Whether to find the largest such value, else the smallest.
    error : float
        Relative standard error of each probability.
    seed, threads : int, optional
        As in `stiction.run`; each value has random numbers of its own that follow from the seed.
    progress : bool, optional
        Whether to show it, as in `stiction.run`.

    Raises
    ------
    SceneError
        The scene or an argument is wrong, or the event is too probable everywhere in the range.
    StictionError
        An error is not reached.
    """
    happens = event(above, below)
    _checked(error, seed, threads)
    if not 1e-12 <= wanted < 1.0:
        raise SceneError(f"probability = {wanted}: a number from 1e-12 to below 1 is needed")
    found, prior = _ranged(scene)
    tried: list[tuple[float, Probability]] = []
    # Errors of all values are independent.
    first = experiments.seed_of(found.tables, seed)

    def excess(share: float) -> tuple[float, float]:
        """ln of the probability over the wanted one, and its standard error, at a fraction of the range."""
        value = float(prior.distribution.ppf(share))
        tables = _with(found.tables, prior.key, prior.text(value))
        own = int(np.random.default_rng([first, len(tried)]).integers(2**62))
        with written_at_end(), work(f"value {len(tried) + 1} of at most {_STEPS + 2}", progress):
            of = Patches(tables, seed=own, threads=threads).probability(happens.threshold, below=happens.below, error=error)
        tried.append((value, of))
        if of.value == 0.0:
            return math.log(LEAST / wanted), 0.0
        # The mean of the logarithm is less than the logarithm of the mean.
        return math.log(of.value / wanted) + 0.5 * of.relative_error**2, of.relative_error

    good, bad = (1.0, 0.0) if largest else (0.0, 1.0)
    at_good = excess(good)
    if at_good[0] <= 0.0:
        value = float(prior.distribution.ppf(good))
        return Design(prior.key, prior.unit, value, (value, value), True, tuple(tried))
    at_bad = excess(bad)
    if at_bad[0] > 0.0:
        least = min(tried, key=lambda one: one[1].value)
        raise SceneError(
            f"{prior.key}: {happens} has a probability of at least {quantities.number(least[1].value, 2)} at both ends of its range, "
            f"and at most {quantities.number(wanted, 2)} is wanted: another range is needed"
        )
    spreads = {good: at_good[1], bad: at_bad[1]}
    values = {good: at_good[0], bad: at_bad[0]}

    def at(share: float) -> float:
        if share not in values:
            values[share], spreads[share] = excess(share)
        # Within its error it is the wanted one.
        return 0.0 if abs(values[share]) <= spreads[share] else values[share]

    share = float(optimize.brentq(at, 0.0, 1.0, xtol=_WIDTH, maxiter=_STEPS, disp=False))
    if share not in values:
        at(share)
    centre, half = _crossing(np.array(list(values)), np.array(list(values.values())), np.array([spreads[one] for one in values]))
    low, high, best = (float(prior.distribution.ppf(min(max(one, 0.0), 1.0))) for one in (centre - half, centre + half, centre))
    return Design(prior.key, prior.unit, best, (low, high), False, tuple(tried))


def _crossing(shares: Array, values: Array, spreads: Array) -> tuple[float, float]:
    """The fraction of the range at which values with standard errors are 0, and half of what holds it in 95 of 100 cases.

    It is where a parabola through all of them is 0, of which the far ones weigh little. One value and the
    slope to the next would not do: the search ends where a value happens to be near 0, and the next may be so
    near that the slope is chance.
    """
    nearest = int(np.abs(values).argmin())
    powers = np.vander(shares - shares[nearest], 3)
    weights = 1.0 / (spreads**2 + (_BENT * values**2) ** 2 + 1e-12)
    covariance = np.linalg.inv((powers.T * weights) @ powers)
    parabola = np.poly1d(covariance @ (powers.T @ (weights * values)))
    slope = np.polyder(parabola)
    place = 0.0
    for _ in range(_STEPS):
        place -= float(parabola(place)) / float(slope(place))
    at = np.vander([place], 3)[0]
    return float(shares[nearest]) + place, 1.96 * float(np.sqrt(at @ covariance @ at)) / abs(float(slope(place)))


def best(
    scene: Scene, probability: float, *, largest: bool = False, points: int = 9, error: float = 0.1, seed: int | None = None,
    threads: int | None = None, progress: bool | None = None,
) -> Best:  # fmt: skip
    """The value of a number with the least pull-off that patches exceed, or the largest that they stay below, with a probability.

    Parameters
    ----------
    scene : path or dict
        As in `design`.
    probability : float
        Of the patches that pull harder than the least force, or less than the largest; from 1e-12 to 0.5.
    largest : bool
        Whether to find the largest force.
    points : int
        Values of the number at first, from end to end of the range; then as many between the neighbours of the best one.
    error, seed, threads, progress
        As in `design`.

    Raises
    ------
    SceneError
        The scene or an argument is wrong.
    StictionError
        An error is not reached.
    """
    _checked(error, seed, threads)
    if not 1e-12 <= probability <= 0.5:
        raise SceneError(f"probability = {probability}: a number from 1e-12 to 0.5 is needed")
    if points < 3:
        raise SceneError(f"points = {points}: at least 3 are needed")
    found, prior = _ranged(scene)
    forces: dict[float, tuple[float, tuple[float, float]]] = {}
    low, high = 0.0, 1.0
    for _ in range(2):
        for share in np.linspace(low, high, points).tolist():
            if share not in forces:
                tables = _with(found.tables, prior.key, prior.text(float(prior.distribution.ppf(share))))
                with written_at_end(), work(f"value {len(forces) + 1} of at most {2 * points - 2}", progress):
                    forces[share] = Patches(tables, seed=seed, threads=threads).quantile(probability, below=largest, error=error)
        chosen = (max if largest else min)(forces, key=lambda share: forces[share][0])
        if chosen in (0.0, 1.0):
            # Nothing is between the end and the end.
            break
        step = (high - low) / (points - 1)
        low, high = max(chosen - step, 0.0), min(chosen + step, 1.0)
    force, interval = forces[chosen]
    tried = tuple((float(prior.distribution.ppf(share)), forces[share][0]) for share in sorted(forces))
    return Best(prior.key, prior.unit, float(prior.distribution.ppf(chosen)), force, interval, tried)


def _ranged(scene: Scene) -> tuple[priors.Priors, priors.Prior]:
    """A scene with a range in the place of one number."""
    found = priors.read(scene)
    if len(found.priors) != 1 or found.priors[0].law not in ("uniform", "log_uniform"):
        raise SceneError(
            f"{', '.join(found.keys)}: one number with a range is needed, a prior that is uniform or log_uniform"
        )
    return found, found.priors[0]


def _checked(error: float, seed: int | None, threads: int | None) -> None:
    experiments.check_settings(seed=seed, threads=threads)
    if not 0.01 <= error <= 0.5:
        raise SceneError(f"error = {error}: a relative error from 0.01 to 0.5 is needed")


def _fixed(scene: Scene) -> dict[str, Any]:
    """The tables of a scene without priors."""
    tables = priors.opened(scene)
    for name in _priors(tables):
        raise SceneError(f"{name} has a prior: the probability of an event is that of fixed numbers; give one, or look for it (maximise)")
    return tables


def _priors(table: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    for key, value in table.items():
        if isinstance(value, Mapping):
            if "prior" in value:
                yield f"{prefix}{key}"
            else:
                yield from _priors(value, f"{prefix}{key}.")


def _with(tables: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """Tables with another number."""
    changed: dict[str, Any] = copy.deepcopy(dict(tables))
    *path, last = key.split(".")
    table = changed
    for name in path:
        table = table[name]
    table[last] = value
    return changed
