"""Scenes that have priors in the place of numbers: reading, drawing, densities.

A number of a scene may be a table with ``prior``:

==================  =====================================  ==========================================================
``prior``           keys                                   law
==================  =====================================  ==========================================================
``"uniform"``       `from`, `to`                           uniform between the two
``"log_uniform"``   `from`, `to`                           uniform in the logarithm
``"normal"``        `mean`, `std`, also `from` and `to`    normal, cut at the limits that are there
``"log_normal"``    `median`, `log_std`                    normal in the logarithm, whose standard deviation is `log_std`
==================  =====================================  ==========================================================

A table ``[priors]`` may have ``correlation = [["material.work_of_adhesion", "surface.asperity_radius", 0.5], ...]``: the correlations of
the normal scores of pairs of keys (a Gaussian copula; of normal and log-normal priors those of the numbers and of their logarithms).
Pairs that are not there are independent.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from . import quantities
from .errors import SceneError
from .scenes import Scene

__all__ = ["MOST", "Prior", "Priors", "opened", "read"]

Array = NDArray[np.float64]

#: How many keys may have priors: so many a sweep may have.
MOST = 6

_NEEDED = {
    "uniform": ("from", "to"),
    "log_uniform": ("from", "to"),
    "normal": ("mean", "std"),
    "log_normal": ("median", "log_std"),
}
_POSSIBLE = {"normal": ("from", "to")}
# The nearest to 0 and 1 that a point of the unit cube may be: its quantiles are finite.
_EDGE = 2.0**-53


@dataclass(frozen=True)
class Prior:
    """The law of one number of a scene.

    Attributes
    ----------
    key : str
        Its dotted name.
    law : str
        Name of the law, as the scene has it.
    unit : str
        SI unit of the number; ``1`` where it has none.
    distribution : frozen distribution of `scipy.stats`
        The law of the number in SI units: ``ppf``, ``logpdf``, ``cdf`` and their kin.
    """

    key: str
    law: str
    unit: str
    distribution: Any = field(compare=False, repr=False)

    def text(self, value: float) -> str | float:
        """A value as scenes write it."""
        return float(value) if self.unit == "1" else f"{float(value)!r} {self.unit}"

    @property
    def median(self) -> float:
        """The median, in SI units."""
        return float(self.distribution.median())


@dataclass(frozen=True)
class Priors:
    """A scene whose numbers have priors.

    Attributes
    ----------
    tables : dict
        The tables of the scene with the median of each prior in its place: a scene that the program takes.
    priors : tuple of Prior
        One for each such key, in the order of the scene.
    correlation : array (k, k)
        Of the normal scores of the k keys.
    """

    tables: dict[str, Any]
    priors: tuple[Prior, ...]
    correlation: Array

    @property
    def keys(self) -> list[str]:
        """The dotted names."""
        return [prior.key for prior in self.priors]

    @property
    def are_independent(self) -> bool:
        """Whether no two of the numbers are correlated."""
        return bool((self.correlation == np.eye(len(self.priors))).all())

    def draw(self, points: ArrayLike) -> Array:
        """Parameters from points of the unit cube.

        Parameters
        ----------
        points : array (n, k)
            Uniform and independent: random numbers, or points of a quasi-random sequence.

        Returns
        -------
        array (n, k)
            In SI units.
        """
        shares: Array = np.clip(np.asarray(points, dtype=float), _EDGE, 1.0 - _EDGE)
        if not self.are_independent:
            shares = stats.norm.cdf(stats.norm.ppf(shares) @ np.linalg.cholesky(self.correlation).T)
            shares = np.clip(shares, _EDGE, 1.0 - _EDGE)
        columns = [prior.distribution.ppf(shares[:, column]) for column, prior in enumerate(self.priors)]
        return np.stack(columns, axis=1)

    def log_density(self, values: ArrayLike) -> Array:
        """The logarithm of the joint density of parameters, −∞ where it is 0.

        Parameters
        ----------
        values : array (n, k)
            In SI units.

        Returns
        -------
        array (n,)
            Of the density by the numbers in SI units.
        """
        of = np.asarray(values, dtype=float)
        total: Array = np.zeros(len(of))
        for column, prior in enumerate(self.priors):
            total = total + prior.distribution.logpdf(of[:, column])
        if not self.are_independent:
            # The density of a Gaussian copula.
            within = np.isfinite(total)
            below = np.stack(
                [prior.distribution.cdf(of[within, column]) for column, prior in enumerate(self.priors)], axis=1
            )
            scores = stats.norm.ppf(np.clip(below, _EDGE, 1.0 - _EDGE))
            joint = stats.multivariate_normal(cov=self.correlation).logpdf(scores)
            total[within] += joint - stats.norm.logpdf(scores).sum(axis=1)
        return total

    def axes(self, values: ArrayLike) -> dict[str, list[str | float]]:
        """The axes of a zipped `stiction.sweep` over parameters.

        Parameters
        ----------
        values : array (n, k)
            In SI units.
        """
        columns = np.asarray(values, dtype=float).T
        return {
            prior.key: [prior.text(value) for value in column]
            for prior, column in zip(self.priors, columns, strict=True)
        }


def read(scene: Scene) -> Priors:
    """Reads a scene whose numbers may have priors.

    Parameters
    ----------
    scene : path or dict
        The TOML file of the scene, or its tables. Paths in a file are relative to it.

    Raises
    ------
    SceneError
        The file is no TOML, no number has a prior, or more than 6 have; a prior is wrong: the message names its key.

    Examples
    --------
    >>> scene = {"material": {"work_of_adhesion": {"prior": "log_uniform", "from": "10 mJ/m^2", "to": "0.1 J/m^2"}}}
    >>> found = read(scene)
    >>> found.keys, found.draw([[0.0], [0.5]]).round(4).tolist()
    (['material.work_of_adhesion'], [[0.01], [0.0316]])
    """
    tables = opened(scene)
    given = tables.pop("priors", {})
    priors: list[Prior] = []
    replaced = _replaced(tables, "", priors)
    if not priors:
        raise SceneError(
            "no number of the scene has a prior: a table in its place has one, such as "
            'work_of_adhesion = { prior = "log_uniform", from = "5 mJ/m^2", to = "0.3 J/m^2" }'
        )
    if len(priors) > MOST:
        raise SceneError(f"{len(priors)} numbers have priors, {', '.join(p.key for p in priors)}: {MOST} at most may")
    return Priors(replaced, tuple(priors), _correlation(given, [prior.key for prior in priors]))


def opened(scene: Scene) -> dict[str, Any]:
    """The tables of a scene; of a file with paths that do not depend on the folder.

    Raises
    ------
    SceneError
        There is no such file, or it is no TOML.
    """
    if isinstance(scene, Mapping):
        return dict(scene)
    path = Path(scene)
    if not path.is_file():
        raise SceneError(f"{path}: no such file; a scene is the path of a TOML file, or a dict of its tables")
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SceneError(f"{path}: {error}") from None
    placed: dict[str, Any] = _placed(tables, path.resolve().parent)
    return placed


def _placed(value: Any, folder: Path) -> Any:
    """Tables with the paths of files joined to the folder that they are relative to."""
    if not isinstance(value, Mapping):
        return value
    return {
        key: str(folder / one) if key == "path" and isinstance(one, str) else _placed(one, folder)
        for key, one in value.items()
    }


def _replaced(table: Mapping[str, Any], prefix: str, priors: list[Prior]) -> dict[str, Any]:
    """A table with medians in the place of priors, which are appended."""
    replaced: dict[str, Any] = {}
    for key, value in table.items():
        name = f"{prefix}{key}"
        if isinstance(value, Mapping) and "prior" in value:
            prior = _prior(name, value)
            priors.append(prior)
            value = prior.text(prior.median)
        elif isinstance(value, Mapping):
            value = _replaced(value, f"{name}.", priors)
        replaced[key] = value
    return replaced


def _prior(key: str, table: Mapping[str, Any]) -> Prior:
    law = table["prior"]
    if not isinstance(law, str) or law not in _NEEDED:
        raise SceneError(f"{key}.prior = {law!r}: one of {', '.join(_NEEDED)} is needed")
    known = (*_NEEDED[law], *_POSSIBLE.get(law, ()))
    for name in table:
        if name not in ("prior", *known):
            raise SceneError(f"{key}.{name}: a prior that is {law} has {', '.join(known)}")
    for name in _NEEDED[law]:
        if name not in table:
            raise SceneError(f"{key}.{name} is missing: a prior that is {law} has {', '.join(_NEEDED[law])}")
    numbers, units = {}, {}
    for name in known:
        if name in table:
            try:
                numbers[name], units[name] = quantities.parsed(f"{key}.{name}", table[name])
            except ValueError as error:
                raise SceneError(str(error)) from None
    log_std = units.pop("log_std", "1")
    if log_std != "1":
        raise SceneError(f"{key}.log_std = {table['log_std']!r}: a number without a unit is needed")
    if len(set(units.values())) > 1:
        told = ", ".join(f"{name} = {table[name]!r}" for name in units)
        raise SceneError(f"{key}: {told}: all of them have to be of one dimension")
    return Prior(key, law, next(iter(units.values())), _distribution(key, law, table, numbers))


def _distribution(key: str, law: str, table: Mapping[str, Any], numbers: Mapping[str, float]) -> Any:
    def need(name: str, holds: bool, what: str) -> None:
        if not holds:
            raise SceneError(f"{key}.{name} = {table[name]!r}: {what} is needed")

    low, high = numbers.get("from", -np.inf), numbers.get("to", np.inf)
    if "to" in numbers:
        need("to", high > low, "more than `from`")
    match law:
        case "uniform":
            return stats.uniform(low, high - low)
        case "log_uniform":
            need("from", low > 0.0, "a number greater than 0")
            return stats.loguniform(low, high)
        case "normal":
            mean, std = numbers["mean"], numbers["std"]
            need("std", std > 0.0, "a number greater than 0")
            if np.isinf(low) and np.isinf(high):
                return stats.norm(mean, std)
            return stats.truncnorm((low - mean) / std, (high - mean) / std, mean, std)
        case _:
            need("median", numbers["median"] > 0.0, "a number greater than 0")
            need("log_std", numbers["log_std"] > 0.0, "a number greater than 0")
            return stats.lognorm(numbers["log_std"], scale=numbers["median"])


def _correlation(given: Any, keys: Sequence[str]) -> Array:
    """The matrix of correlations that a table [priors] gives by pairs."""
    matrix = np.eye(len(keys))
    if not isinstance(given, Mapping) or set(given) - {"correlation"}:
        raise SceneError("priors: a table [priors] has one key, correlation")
    for first, second, value in _pairs(given.get("correlation", []), keys):
        matrix[keys.index(first), keys.index(second)] = matrix[keys.index(second), keys.index(first)] = value
    if np.linalg.eigvalsh(matrix)[0] <= 1e-12:
        raise SceneError("priors.correlation: no numbers have these correlations together, they are too strong")
    return matrix


def _pairs(given: Any, keys: Sequence[str]) -> Iterator[tuple[str, str, float]]:
    if not isinstance(given, list | tuple):
        raise SceneError(f"priors.correlation = {given!r}: a list of [key, key, correlation] is needed")
    for one in given:
        match one:
            case [str(first), str(second), int() | float() as value] if (
                first in keys and second in keys and first != second and -1.0 < value < 1.0
            ):
                yield first, second, float(value)
            case _:
                raise SceneError(
                    f"priors.correlation: {one!r}: two different keys that have priors ({', '.join(keys)}) "
                    "and a correlation between -1 and 1 are needed"
                )
