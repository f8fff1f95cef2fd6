"""Scenes that have priors in the place of numbers: reading and drawing.

A number of a scene may be a table with ``prior``:

==================  =====================================  ==========================================================
``prior``           keys                                   law
==================  =====================================  ==========================================================
``"uniform"``       `from`, `to`                           uniform between the two
``"log_uniform"``   `from`, `to`                           uniform in the logarithm
``"normal"``        `mean`, `std`, also `from` and `to`    normal, cut at the limits that are there
``"log_normal"``    `median`, `log_std`                    normal in the logarithm, with standard deviation `log_std`
``"fixed"``         `value`                                it is that number
==================  =====================================  ==========================================================

Where specimens or batches of patches differ in a number, its prior has ``batch_log_std``, too: the number of a batch is the
number times exp(τ v) with a standard normal v, and τ has a half-normal prior of this scale. `stiction.inference` alone takes it.

A table ``[priors]`` may have ``keys = ["material.work_of_adhesion", ...]`` and either ``correlation``, the
matrix of these keys for their normal scores (a Gaussian copula), or ``covariance`` of normal and log-normal
priors: in SI units, of log-normal ones of the logarithms, with the squares of their own standard deviations
on the diagonal. Other keys are independent.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special, stats

from . import quantities
from .errors import SceneError
from .scenes import Scene

__all__ = ["MOST", "BatchScatter", "Prior", "Priors", "opened", "read"]

Array = NDArray[np.float64]

#: Most keys with priors: a sweep may have this number.
MOST = 6

_NEEDED = {
    "uniform": ("from", "to"),
    "log_uniform": ("from", "to"),
    "normal": ("mean", "std"),
    "log_normal": ("median", "log_std"),
    "fixed": ("value",),
}
_POSSIBLE = {"normal": ("from", "to")}
_BATCH = "batch_log_std"
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
    std : float or None
        Standard deviation of a normal law without limits, and of the logarithm of a log-normal one.
    distribution : frozen distribution of `scipy.stats`
        The law of the number in SI units: ``ppf``, ``logpdf``, ``cdf`` and their kin.
    batch_log_std : float or None
        Scale of the half-normal prior of the standard deviation of its logarithm between batches.
    """

    key: str
    law: str
    unit: str
    std: float | None
    distribution: Any = field(compare=False, repr=False)
    batch_log_std: float | None = None

    def text(self, value: float) -> str | float:
        """A value as scenes write it."""
        return float(value) if self.unit == "1" else f"{float(value)!r} {self.unit}"

    @property
    def name(self) -> str:
        """The key's name as a variable of files: the key with underlines, as sweeps have it."""
        return self.key.replace(".", "_")

    @property
    def median(self) -> float:
        """The median, in SI units."""
        return float(self.distribution.median())

    @property
    def logarithmic(self) -> bool:
        """Whether the law is one of the logarithm."""
        return self.law.startswith("log_")


@dataclass(frozen=True)
class BatchScatter:
    """The number of a scene that differs between batches.

    Attributes
    ----------
    place : int
        Its place among the priors.
    log_std : float
        Scale of the half-normal prior of the standard deviation τ of its logarithm.
    """

    place: int
    log_std: float

    def spread(self, scores: ArrayLike) -> Array:
        """τ at normal scores, (n,): quantiles of its prior."""
        shares = np.minimum(special.ndtr(np.asarray(scores, dtype=float)), 1.0 - 1e-15)
        return np.asarray(self.log_std * special.ndtri(0.5 + 0.5 * shares))


@dataclass(frozen=True)
class Priors:
    """A scene with priors for some of its numbers.

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
    def names(self) -> list[str]:
        """The names of parameters as variables of files: of the keys, and of the scatter between batches, where there is one."""
        names = [prior.name for prior in self.priors]
        return names if self.of_batch is None else [*names, f"{names[self.of_batch.place]}_{_BATCH}"]

    @property
    def are_independent(self) -> bool:
        """Whether no two of the numbers are correlated."""
        return bool((self.correlation == np.eye(len(self.priors))).all())

    @property
    def of_batch(self) -> BatchScatter | None:
        """The number that differs between batches, if one does."""
        found = [BatchScatter(place, prior.batch_log_std) for place, prior in enumerate(self.priors) if prior.batch_log_std]
        return found[0] if found else None

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
            return self.of_scores(special.ndtri(shares))
        return self._quantiles(shares)

    def of_scores(self, scores: ArrayLike) -> Array:
        """Parameters from independent standard normal numbers.

        Parameters
        ----------
        scores : array (n, k)

        Returns
        -------
        array (n, k)
            In SI units.
        """
        return self._quantiles(np.clip(special.ndtr(np.asarray(scores, dtype=float) @ self._factor.T), _EDGE, 1.0 - _EDGE))

    @cached_property
    def _factor(self) -> Array:
        return np.asarray(np.linalg.cholesky(self.correlation), dtype=np.float64)

    def _quantiles(self, shares: Array) -> Array:
        columns = [prior.distribution.ppf(shares[:, column]) for column, prior in enumerate(self.priors)]
        return np.stack(columns, axis=1)

    def natural(self, values: ArrayLike) -> Array:
        """Parameters; for laws of the logarithm their logarithms.

        Parameters
        ----------
        values : array (n, k)
            In SI units.
        """
        of = np.asarray(values, dtype=float)
        result: Array = np.log(of, out=of.copy(), where=np.broadcast_to([prior.logarithmic for prior in self.priors], of.shape))
        return result

    def values(self, natural: ArrayLike) -> Array:
        """The inverse of `natural`: parameters in SI units, (n, k)."""
        of = np.asarray(natural, dtype=float)
        result: Array = np.exp(of, out=of.copy(), where=np.broadcast_to([prior.logarithmic for prior in self.priors], of.shape))
        return result

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


def read(scene: Scene, *, batches: bool = False) -> Priors:
    """Reads a scene that may have priors for its numbers.

    Parameters
    ----------
    scene : path or dict
        The TOML file of the scene, or its tables. Paths in a file are relative to it.
    batches : bool
        Whether a number may differ between batches.

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
    try:
        replaced = _replaced(tables, "", priors)
    except RecursionError:
        raise SceneError("the scene: a table in it holds itself") from None
    if not priors:
        raise SceneError(
            "no number of the scene has a prior: a table in its place has one, such as "
            'work_of_adhesion = { prior = "log_uniform", from = "5 mJ/m^2", to = "0.3 J/m^2" }'
        )
    if len(priors) > MOST:
        raise SceneError(f"{len(priors)} numbers have priors, {', '.join(p.key for p in priors)}: {MOST} at most may")
    scattered = [prior.key for prior in priors if prior.batch_log_std is not None]
    if scattered and not batches:
        raise SceneError(f"{scattered[0]}.{_BATCH}: batches are of measured data, which `stiction infer` alone has; leave it out")
    if len(scattered) > 1:
        raise SceneError(f"{scattered[1]}.{_BATCH}: {scattered[0]} has one, and one number may differ between batches; leave one out")
    return Priors(replaced, tuple(priors), _correlation(given, priors))


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
            if isinstance(prior, Prior):
                priors.append(prior)
                value = prior.text(prior.median)
            else:
                value = prior
        elif isinstance(value, Mapping):
            value = _replaced(value, f"{name}.", priors)
        replaced[key] = value
    return replaced


def _prior(key: str, table: Mapping[str, Any]) -> Any:
    """The prior of a key, or its value where that is fixed."""
    law = table["prior"]
    if not isinstance(law, str) or law not in _NEEDED:
        raise SceneError(f"{key}.prior = {law!r}: one of {', '.join(_NEEDED)} is needed")
    known = (*_NEEDED[law], *_POSSIBLE.get(law, ()))
    for name in table:
        if name not in ("prior", *known, *([_BATCH] if law != "fixed" else [])):
            raise SceneError(f"{key}.{name}: a prior that is {law} has {', '.join(known)}")
    for name in _NEEDED[law]:
        if name not in table:
            raise SceneError(f"{key}.{name} is missing: a prior that is {law} has {', '.join(_NEEDED[law])}")
    if law == "fixed":
        return table["value"]
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
    if not quantities.of_one_dimension(units.values()):
        listed = ", ".join(f"{name} = {table[name]!r}" for name in units)
        raise SceneError(f"{key}: {listed}: all of them have to be of one dimension")
    # For a normal law that is cut the covariance is not the covariance of its normal scores.
    std = numbers.get("log_std", None if numbers.keys() & {"from", "to"} else numbers.get("std"))
    distribution = _distribution(key, law, table, numbers)
    return Prior(key, law, next(iter(units.values())), std, distribution, _between_batches(key, table, distribution))


def _between_batches(key: str, table: Mapping[str, Any], distribution: Any) -> float | None:
    """The scale of the prior of the scatter between batches, if there are any."""
    if _BATCH not in table:
        return None
    scale = table[_BATCH]
    if isinstance(scale, bool) or not isinstance(scale, int | float) or not 0.0 < scale <= 3.0:
        raise SceneError(f"{key}.{_BATCH} = {scale!r}: a number above 0, 3 at most, is needed, such as 0.2 where batches differ by 20 %")
    if not distribution.support()[0] >= 0.0:
        raise SceneError(f"{key}.{_BATCH}: it is of a logarithm, and the number may be negative; give it `from`, or a prior of the logarithm")
    return float(scale)


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


def _correlation(given: Any, priors: Sequence[Prior]) -> Array:
    """The matrix of correlations of all keys from a table [priors]."""
    whole = np.eye(len(priors))
    if not given:
        return whole
    names = set(given) - {"keys"} if isinstance(given, Mapping) else set()
    if names not in ({"correlation"}, {"covariance"}) or not isinstance(given.get("keys"), list):
        raise SceneError("priors: a table [priors] has `keys`, and either `correlation` or `covariance`, the matrix of these keys")
    keys = [prior.key for prior in priors]
    for key in given["keys"]:
        if key not in keys:
            raise SceneError(f"priors.keys: {key} has no prior; {', '.join(keys)} have one")
    places = [keys.index(key) for key in given["keys"]]
    (name,) = names
    try:
        matrix = np.asarray(given[name], dtype=float)
    except (TypeError, ValueError):
        matrix = np.empty(0)
    if matrix.shape != (len(places), len(places)) or len(set(places)) != len(places) or not np.array_equal(matrix, matrix.T):
        raise SceneError(f"priors.{name}: a symmetric matrix with a row for each of the {len(places)} different keys is needed")
    if name == "covariance":
        for place, variance in zip(places, np.diag(matrix), strict=True):
            if (std := priors[place].std) is None:
                raise SceneError(
                    f"priors.covariance: the prior of {keys[place]} is {priors[place].law}; give `correlation`, or a normal or log_normal prior"
                )
            if not np.isclose(variance, std**2, rtol=1e-6):
                raise SceneError(f"priors.covariance: {keys[place]} has the variance {variance:g}, but its prior {std**2:g}")
        scale = np.sqrt(np.diag(matrix))
        matrix = matrix / np.outer(scale, scale)
    if not np.allclose(np.diag(matrix), 1.0):
        raise SceneError("priors.correlation: the correlation of a key with itself is 1")
    whole[np.ix_(places, places)] = matrix
    if np.linalg.eigvalsh(whole)[0] <= 1e-12:
        raise SceneError(f"priors.{name}: no numbers have it, the matrix is not positive definite")
    return whole
