"""The number of measured forces with which a parameter's interval is as narrow as wanted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from threadpoolctl import threadpool_limits

from .. import experiments, priors, quantities
from ..errors import SceneError, StictionError, written_at_end
from ..priors import Prior, Priors
from ..progress import Bar, work
from ..rows import row
from ..scenes import Scene

if TYPE_CHECKING:
    from .information import Experiments, Local, Measured, Shown

__all__ = ["Choice", "Limit", "Needed", "measurements"]

# Other sizes of patches and preloads, over the scene's.
_VARIED = {"surface.nominal_area": (0.25, 4.0), "instability.preload": (1.0 / 3.0, 3.0)}
# Synthetic experiments, and patches of all of them at most.
_EXPERIMENTS, _SIMULATED = 20, 100_000
# A limit matters where without it the number of forces, or the interval at best, is smaller by this factor.
_MATTERS = 0.8
# Standard deviations of half of a 95 % interval.
_HALF = 1.96
_MANY = "100 000"


@dataclass(frozen=True)
class Choice:
    """What is measured, and the number of forces that it takes.

    Attributes
    ----------
    words : str
        Such as ``nominal area 25.00 µm²``, or two of them, measured in equal numbers.
    forces, interval : float, tuple of float
        The number and its 95 % interval, by the errors of the information; infinite where 100 000 do not do, NaN where the scene has no such patches.
    least : float
        Half of the parameter's 95 % interval over its value that 100 000 forces leave.
    problem : str
        Why there are no such patches.
    """

    words: str
    forces: float
    interval: tuple[float, float]
    least: float
    problem: str = ""


@dataclass(frozen=True)
class Limit:
    """The parameter that limits the answer most.

    Attributes
    ----------
    key : str
        Its name.
    known : float
        Half of its prior's 95 % interval over its median.
    forces : float
        The number of forces if it was known exactly; infinite where 100 000 do not do.
    least : float
        Half of the interval of the wanted parameter over its value that 100 000 forces then leave.
    """

    key: str
    known: float
    forces: float
    least: float


@dataclass(frozen=True)
class Needed:
    """The number of forces for a wanted interval.

    Attributes
    ----------
    key, unit, value : str, str, float
        The parameter, its SI unit, and the median of its prior, at which the patches are.
    accuracy : float
        Half of the wanted 95 % interval over the value.
    choices : tuple of Choice
        The scene's own patches first, then others.
    limit : Limit or None
        What limits the scene's own patches most; None where nothing else has a prior, or nothing limits them.
    checked : tuple of float
        Half of the interval over the value in each of 20 synthetic experiments of as many of the scene's patches; empty where they are too many.
    held : int
        How many of these intervals contain the value.
    """

    key: str
    unit: str
    value: float
    accuracy: float
    choices: tuple[Choice, ...]
    limit: Limit | None
    checked: tuple[float, ...]
    held: int

    @property
    def best(self) -> Choice:
        """The choice with the fewest forces, or the narrowest interval."""
        return min((of for of in self.choices if not of.problem), key=lambda of: (of.forces, of.least))

    def __str__(self) -> str:
        own, percent = self.choices[0], f"{_percent(self.accuracy)} %"
        lines = [f"{self.key} to {percent} (half of its 95 % interval) at {quantities.si(self.value, self.unit)}:", f"  {_answer(own)}"]
        if own.forces == math.inf:
            lines.append(f"  {_MANY} forces leave {_percent(own.least)} %")
        if self.limit is not None:
            known = f"never, {_percent(self.limit.least)} % at best" if self.limit.forces == math.inf else f"{_counted(self.limit.forces)} forces"
            lines += row("", f"limited by {self.limit.key}, known to {_percent(self.limit.known)} %: if it was known exactly, {known}", 2)
        width = max(len(of.words) for of in self.choices) + 2
        lines += [f"  {of.words:{width}}{_row(of)}{'   best' if of is self.best and len(self.choices) > 1 else ''}" for of in self.choices]
        return "\n".join([*lines, *row("", self._check(), 2)])

    def _check(self) -> str:
        own = self.choices[0].forces
        if not self.checked:
            return f"not checked by simulation: {'no number of forces' if own in (0.0, math.inf) else f'{_EXPERIMENTS} experiments are too many patches'}"
        low, mean, high = (_percent(of) for of in (min(self.checked), float(np.mean(self.checked)), max(self.checked)))
        return (
            f"checked: {len(self.checked)} experiments of {quantities.counted(int(own), 'force')} gave {mean} % "
            f"({low} to {high} %), and {self.held} of their intervals contain the value"
        )


def measurements(
    scene: Scene, parameter: str, accuracy: Any, *, force_error: Any = None, seed: int | None = None, threads: int | None = None,
    progress: bool | None = None,
) -> Needed:  # fmt: skip
    """The number of pull-off forces that have to be measured to know a parameter as well as wanted.

    Each force is of another patch of the surface. The covariance of the parameters after n patches is (n I + C⁻¹)⁻¹, with the Fisher information I
    of one patch at the medians of the priors, and the covariance C of the priors, both of the logarithms where priors are of these.

    Parameters
    ----------
    scene : path or dict
        A scene with priors, as `stiction.inference.infer` takes it.
    parameter : str
        One of its keys with priors.
    accuracy : str or pint.Quantity
        Half of the 95 % interval: as a fraction of the value, ``5 %``, or with the unit of the parameter, ``2 mJ/m^2``.
    force_error : str or pint.Quantity, optional
        Standard deviation of the measurement of one force, such as ``5 nN`` or ``2 %``; without it none.
    seed, threads : int, optional
        As in `stiction.run`.
    progress : bool, optional
        Whether to show it, as in `stiction.run`.

    Raises
    ------
    SceneError
        The scene or an argument is wrong; the message names it.
    StictionError
        A library of ``stiction[inference]`` is not installed, or a simulation failed.

    References
    ----------
    K. Chaloner, I. Verdinelli, *Stat. Sci.* **10** (1995) 273 (Bayesian experimental design).
    """
    experiments.check_settings(seed=seed, threads=threads)
    found = priors.read(scene)
    if parameter not in found.keys:
        raise SceneError(f"parameter = {parameter!r}: no number with a prior; {', '.join(found.keys)} {'has' if len(found.keys) == 1 else 'have'} one")
    prior = found.priors[found.keys.index(parameter)]
    wanted, error = _accuracy(accuracy, prior), _force_error(force_error)
    first = experiments.seed_of(found.tables, seed)
    # Matrices are so small that threads would only wait for each other.
    with written_at_end(), work(progress=progress), threadpool_limits(1):
        try:
            with Bar("loading"):
                # ArviZ and emcee take a second, and no other design needs them.
                from . import information
        except ModuleNotFoundError as missing:
            raise StictionError(f"{missing.name} is not installed: pip install 'stiction[inference]' brings it", 2) from None
        local = information.Local(found, None if error is None else information.Error(*error))
        return _Study(local, parameter, wanted, first, threads).needed()


class _Study:
    """The answer for one parameter."""

    def __init__(self, local: Local, key: str, wanted: float, seed: int, threads: int | None) -> None:
        self._local, self._place, self._wanted = local, local.priors.keys.index(key), wanted
        self._prior = local.priors.priors[self._place]
        self._deviation = _deviation(wanted, self._prior)
        self._seeds, self._threads = iter(np.random.SeedSequence(seed).generate_state(1000) >> 1), threads

    def needed(self) -> Needed:
        varied = _varied(self._local.priors)
        with work("the scene's patches"):
            own = self._measured({})
        choices = [self._choice(_own_words(varied), own.shown)]
        for key, settings in varied.items():
            of: dict[str, Shown] = {settings[1]: own.shown}
            for text in (settings[0], settings[2]):
                words = _setting_words(key, text)
                try:
                    with work(words):
                        of[text] = self._measured({key: text}).shown
                    choices.append(self._choice(words, of[text]))
                except StictionError as error:
                    choices.append(Choice(words, math.nan, (math.nan, math.nan), math.nan, str(error)))
            kept = [text for text in settings if text in of]
            pairs = [(one, two) for place, one in enumerate(kept) for two in kept[place + 1 :]]
            choices += [self._choice(_pair_words(key, one, two), of[one] + of[two]) for one, two in pairs]
        limit = self._limit(own.shown, choices[0])
        checked = self._checked(own, choices[0].forces)
        halves = () if checked is None else tuple((checked.halves / abs(self._prior.median)).tolist())
        return Needed(
            self._prior.key, self._prior.unit, self._prior.median, self._wanted, tuple(choices), limit, halves, 0 if checked is None else checked.held
        )

    def _measured(self, settings: Mapping[str, Any]) -> Measured:
        from .information import Measured

        return Measured(self._local, settings, seed=int(next(self._seeds)), threads=self._threads)

    def _choice(self, words: str, shown: Shown) -> Choice:
        from .information import Curve

        curve = Curve(shown, self._local, self._place)
        least = _half_width(curve.least, self._prior)
        if self._local.covariance[self._place, self._place] ** 0.5 <= self._deviation:
            return Choice(words, 0.0, (0.0, 0.0), least)
        number, *interval = curve.forces(self._deviation)
        return Choice(words, number, (interval[0], interval[1]), least)

    def _limit(self, shown: Shown, own: Choice) -> Limit | None:
        """The other parameter without whose uncertainty the fewest forces do, or the interval at best is narrowest."""
        from .information import Curve

        found = []
        for place, prior in enumerate(self._local.priors.priors):
            if place != self._place:
                curve = Curve(shown, self._local, self._place, place)
                found.append((curve.forces(self._deviation)[0], curve.least, place, prior))
        if not found or own.forces == 0.0:
            return None
        number, deviation, place, prior = min(found, key=lambda of: of[:2])
        least = _half_width(deviation, self._prior)
        if number > _MATTERS * own.forces or (number == math.inf and least > _MATTERS * own.least):
            return None
        return Limit(prior.key, _half_width(float(self._local.covariance[place, place] ** 0.5), prior), number, least)

    def _checked(self, own: Measured, forces: float) -> Experiments | None:
        from .information import simulated_experiments

        if forces == 0.0 or forces * _EXPERIMENTS > _SIMULATED:
            return None
        with work("synthetic experiments"):
            logs = self._local.logs(self._local.medians, {}, int(forces) * _EXPERIMENTS, int(next(self._seeds)), self._threads)
            with Bar("posteriors"):
                return simulated_experiments(self._local, self._place, logs.reshape(_EXPERIMENTS, -1, 1), own.density(), own.shown.information())


def _number(name: str, given: Any) -> tuple[float, str]:
    """A number that is given, and its SI unit; % of a percentage, whose number is a fraction."""
    try:
        value, unit = quantities.parsed(name, given)
    except ValueError as error:
        raise SceneError(str(error)) from None
    return value, "%" if unit == "1" and "%" in str(given) else unit


def _accuracy(given: Any, prior: Prior) -> float:
    """Half of the wanted interval over the median."""
    such = f'half of the 95 % interval is needed, such as "5 %"{"" if prior.unit == "1" else f", or with the unit of {prior.key}"}'
    value, unit = _number("accuracy", given)
    relative = unit == "%"
    if not value > 0.0 or not (relative or (unit != "1" and quantities.of_one_dimension([unit, prior.unit]))):
        raise SceneError(f"accuracy = {given!r}: {such}")
    if relative and value > 1.0:
        raise SceneError(f"accuracy = {given!r}: at most 100 % is needed")
    if prior.median == 0.0:
        raise SceneError(f"{prior.key}: the median of its prior is 0, and a fraction of that is nothing; another prior is needed")
    return value if relative else value / abs(prior.median)


def _force_error(given: Any) -> tuple[float, bool] | None:
    if given is None:
        return None
    value, unit = _number("force_error", given)
    relative = unit == "%"
    if not value > 0.0 or not (relative or unit == "N") or (relative and value > 0.5):
        raise SceneError(f'force_error = {given!r}: the standard deviation of a force is needed, such as "5 nN", or up to "50 %" of it')
    return value, relative


def _deviation(accuracy: float, prior: Prior) -> float:
    """The standard deviation of the natural parameter with half an interval of that width, over the median."""
    return math.asinh(accuracy) / _HALF if prior.logarithmic else accuracy * abs(prior.median) / _HALF


def _half_width(deviation: float, prior: Prior) -> float:
    """The inverse of `_deviation`."""
    if prior.logarithmic:
        return math.sinh(min(_HALF * deviation, 100.0))
    return _HALF * deviation / abs(prior.median) if prior.median else math.inf


def _varied(found: Priors) -> dict[str, tuple[str, str, str]]:
    """Keys of the scene that patches may be measured with other values of: a smaller one, its own, a larger one."""
    varied = {}
    for key, (less, more) in _VARIED.items():
        table, name = key.split(".")
        given = found.tables.get(table, {}).get(name)
        if given is not None and not isinstance(given, list) and key not in found.keys:
            value, unit = quantities.parsed(key, given)
            varied[key] = (f"{less * value!r} {unit}", f"{value!r} {unit}", f"{more * value!r} {unit}")
    return varied


def _value(key: str, text: str) -> str:
    return quantities.si(*quantities.parsed(key, text))


def _setting_words(key: str, text: str) -> str:
    return f"{key.split('.')[1].replace('_', ' ')} {_value(key, text)}"


def _own_words(varied: Mapping[str, tuple[str, str, str]]) -> str:
    return ", ".join(_setting_words(key, settings[1]) for key, settings in varied.items()) or "patches of the scene"


def _pair_words(key: str, one: str, two: str) -> str:
    return f"{_setting_words(key, one)} and {_value(key, two)}, half each"


def _percent(share: float) -> str:
    return quantities.number(100.0 * share, 2)


def _counted(forces: float) -> str:
    if forces == math.inf:
        return "never"
    return f"{forces:.0f}" if forces < 100.0 else quantities.number(forces, 2)


def _answer(of: Choice) -> str:
    if of.forces == 0.0:
        return "its prior is as narrow, no forces are needed"
    if of.forces == math.inf:
        return "never" if of.interval[0] == math.inf else f"never, or with {_counted(of.interval[0])} forces at least"
    return f"{_counted(of.forces)} forces (95 % interval {_counted(of.interval[0])} to {_counted(of.interval[1])})"


def _row(of: Choice) -> str:
    if of.problem:
        return f"not possible: {of.problem}"
    if of.forces == 0.0:
        return "     0"
    if of.forces == math.inf:
        return f" never   ({_counted(of.interval[0])} to never), {_percent(of.least)} % at best"
    return f"{_counted(of.forces):>6}   ({_counted(of.interval[0])} to {_counted(of.interval[1])})"
