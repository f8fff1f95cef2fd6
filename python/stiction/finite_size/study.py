"""The approach of the pull-off of a finite patch to the integral's as the number N of its asperities grows.

The pull-off of a patch is the minimum of its own curve, and the mean of minima is below the minimum of the
mean: patches pull harder than the integral, and the less so the more asperities they have.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from ..errors import SceneError
from ..results import Sweep

__all__ = ["ACCURACIES", "KEY", "QUANTILES", "Approach", "NoApproach", "is_study", "reached", "study"]

Array = NDArray[np.float64]

#: Probabilities of the quantiles of patches.
QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
#: Accuracies for which the number of asperities is sought from which on the integral has them.
ACCURACIES = (0.10, 0.05, 0.01)
#: The key that sweeps over sizes have.
KEY = "surface.nominal_area"
# The power law is fitted to biases of at most so much, of this many sizes at least; with two it would go
# through both.
_FITTED, _FEWEST = 0.5, 3
# A power law is rejected where a chi squared as large has a smaller probability.
_REJECTED = 0.01
# Largest standard error of the logarithm of a number of asperities beyond the largest size.
_KNOWN = 0.5


def is_study(sweep: Sweep) -> bool:
    """Whether a sweep is of patches of several sizes that pull: over the nominal area alone, complete, with
    replicas."""
    of_area = sweep.keys == [KEY] and "ensemble" in sweep and not sweep.is_partial
    return (
        of_area
        and sweep[KEY.replace(".", "_")].size > 1
        and bool((sweep["integral/pull_off_force"] > 0.0).all())
    )


def study(sweep: Sweep | str | Path) -> xarray.Dataset:
    """Bias, standard deviation and power law of finite patches, from a sweep over the nominal area.

    Parameters
    ----------
    sweep : Sweep or path
        What `run` has computed, or its file.

    Returns
    -------
    xarray.Dataset
        Over `asperity_count`: `bias`, mean pull-off force with control variates over the integral's, less 1,
        and `bias_standard_error`; `bias_fitted` by the power law, and whether it `is_fitted` to the size;
        `relative_std` and `skewness` of
        the pull-off force of a patch, its `pull_off_quantiles` over the integral's over `quantile`,
        `nominal_area` (m²),
        `p_value` of the cross-check, `summation`, `independence` (the verdict), and where all replicas
        agree `most_differing`, the fraction
        of patches that differ at most. Over `accuracy`: `count_at_accuracy`, asperities from which on the
        bias is within it, and
        `count_at_accuracy_source`. Attributes: `integral_pull_off_per_asperity` (N); `fit_coefficient`,
        `fit_exponent` and their kin,
        or `fit_refusal`.

    Raises
    ------
    SceneError
        The sweep is none of patches of several sizes.
    """
    if not isinstance(sweep, Sweep):
        opened = Sweep(sweep)
        try:
            return study(opened)
        finally:
            opened.close()
    if not is_study(sweep):
        raise SceneError(
            f"{sweep.path}: no sweep over {KEY} alone of patches that pull, complete and with replicas"
        )
    order = np.argsort(sweep["nominal_area"].values)
    counts = np.rint(sweep["asperity_density"].values * sweep["nominal_area"].values)[order]
    force = sweep.group("ensemble").sel(scalar="pull_off_force")
    of = {
        name: force[f"scalar_{name}"].values[order]
        for name in ("controlled_mean", "controlled_standard_error", "most_differing")
    }
    integral = sweep["integral/pull_off_force"].values[order]
    bias, error = of["controlled_mean"] / integral - 1.0, of["controlled_standard_error"] / integral
    patches = [
        _scatter(values[~np.isnan(values)])
        for values in sweep["replicas/pull_off_force"].values[order] / integral[:, None]
    ]
    try:
        fit: Approach | NoApproach = Approach.of(counts, bias, error)
    except NoApproach as refusal:
        fit = refusal
    known = fit if isinstance(fit, Approach) else None
    found = [reached(accuracy, counts, bias, error, known) for accuracy in ACCURACIES]
    size, fitted = "asperity_count", np.full(counts.size, np.nan) if known is None else known.bias(counts)
    taken = np.zeros(counts.size, bool) if known is None else known.fitted
    variables = {
        "nominal_area": (size, sweep["nominal_area"].values[order], {"units": "m2"}),
        "bias": (size, bias),
        "bias_standard_error": (size, error),
        "bias_fitted": (size, fitted),
        "is_fitted": (size, taken.astype(np.uint8)),
        "relative_std": (size, [one[0] for one in patches]),
        "skewness": (size, [one[1] for one in patches]),
        "pull_off_quantiles": ((size, "quantile"), np.stack([one[2] for one in patches])),
        "most_differing": (size, of["most_differing"]),
        "replica_count": (size, sweep["replica_count"].values[order]),
        "p_value": (size, sweep["validation/p_value"].values[order]),
        "summation": (size, sweep["ensemble/summation"].values[order].astype(str)),
        "independence": (size, sweep["independence/verdict"].values[order].astype(str)),
        "count_at_accuracy": ("accuracy", [count for count, _ in found]),
        "count_at_accuracy_source": ("accuracy", [source for _, source in found]),
    }
    coordinates = {size: counts.astype(int), "quantile": list(QUANTILES), "accuracy": list(ACCURACIES)}
    attributes: dict[str, Any] = {
        "replicas": int(sweep.attrs["replicas"]),
        "integral_pull_off_per_asperity": float((integral / counts)[-1]),
    }
    attributes |= {"fit_refusal": str(fit)} if isinstance(fit, NoApproach) else fit.attributes()
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes)


def _scatter(values: Array) -> tuple[float, float, Array]:
    """Relative standard deviation, adjusted Fisher-Pearson skewness and the `QUANTILES` of the values of
    patches."""
    n, off = values.size, values - values.mean()
    with np.errstate(invalid="ignore", divide="ignore"):
        std = float(values.std(ddof=1) / abs(values.mean())) if n > 1 else math.nan
        skewness = float(math.sqrt(n * (n - 1)) / (n - 2) * (off**3).mean() / (off**2).mean() ** 1.5) if n > 2 else math.nan
    return std, skewness, np.quantile(values, QUANTILES)


class NoApproach(ValueError):
    """The reason why the biases of the sizes make no power law."""


@dataclass(frozen=True)
class Approach:
    """The power law c N^−a by which the bias of the mean pull-off vanishes.

    Attributes
    ----------
    coefficient, exponent : float
        c and a.
    covariance : array (2, 2)
        Of ln c and a; larger by χ²/degrees of freedom where that is more than 1.
    chi_squared, degrees_of_freedom : float and int
        Of the fit.
    fitted : array of bool
        The sizes that it is fitted to.
    """

    coefficient: float
    exponent: float
    covariance: Array
    chi_squared: float
    degrees_of_freedom: int
    fitted: NDArray[np.bool_]

    @classmethod
    def of(cls, counts: Array, bias: Array, error: Array) -> Approach:
        """Fits biases of sizes in rising order by weighted least squares.

        It is fitted to biases of at most one half, less the smallest sizes as long as χ² rejects a power
        law at the 1 % level: it is
        what the bias goes to.

        Raises
        ------
        NoApproach
            The biases carry no power law.

        Examples
        --------
        >>> law = Approach.of(np.array([100.0, 400.0, 1600.0]), np.array([0.2, 0.1, 0.05]), np.full(3, 1e-3))
        >>> round(law.exponent, 6), round(law.count(0.025)[0])
        (0.5, 6400)
        """
        # Imported only where they are needed: results that are no study are drawn and read in half of the time.
        from scipy.special import chdtrc

        with np.errstate(invalid="ignore"):
            small = np.flatnonzero(np.isfinite(bias) & (error > 0.0) & (bias <= _FITTED))
        for first in range(small.size - _FEWEST + 1):
            taken = small[first:]
            fit = cls._fitted(counts, bias, error, taken)
            if chdtrc(fit.degrees_of_freedom, fit.chi_squared) >= _REJECTED:
                return fit
            if taken.size == _FEWEST:
                one, two = -np.diff(np.log(bias[taken])) / np.diff(np.log(counts[taken]))
                raise NoApproach(
                    f"the exponent is still changing, from {one:.2f} to {two:.2f} "
                    f"among the largest {_FEWEST} sizes (chi squared {fit.chi_squared:.1f} "
                    "for 1 degree of freedom)"
                )
        raise NoApproach(f"fewer than {_FEWEST} sizes have a bias of at most {100 * _FITTED:.0f} %")

    @classmethod
    def _fitted(cls, counts: Array, bias: Array, error: Array, taken: NDArray[np.intp]) -> Approach:
        """The fit to these sizes, of which there are three at least."""
        from scipy.optimize import least_squares

        falls_not = NoApproach("the bias does not fall with N within its errors")
        # About the middle of the counts the two parameters are all but independent.
        centre = float(np.log(counts[taken]).mean())
        off, of, scale = np.log(counts[taken]) - centre, bias[taken], error[taken]
        if not of.max() > 0.0:
            raise falls_not

        def law(p: Array) -> Array:
            value: Array = np.exp(p[0] - p[1] * off) / scale
            return value

        def slopes(p: Array) -> Array:
            return np.column_stack([law(p), -off * law(p)])

        level, exact = math.log(of.max()), 1e-15
        fits = [
            least_squares(
                lambda p: law(p) - of / scale,
                start,
                jac=slopes,
                method="lm",
                xtol=exact,
                ftol=exact,
                gtol=exact,
                max_nfev=2000,
            )
            for start in ([level - 1.0, 0.5], [level - 3.0, 1.0])
        ]
        best = min(fits, key=lambda fit: float(fit.cost))
        level, exponent = best.x
        normal = best.jac.T @ best.jac
        if not (exponent > 0.0 and np.linalg.det(normal) > 0.0):
            raise falls_not
        freedom, chi_squared = taken.size - 2, 2.0 * float(best.cost)
        # ln c = level + exponent x centre.
        turn = np.array([[1.0, centre], [0.0, 1.0]])
        covariance = turn @ np.linalg.inv(normal) @ turn.T * max(chi_squared / freedom, 1.0)
        coefficient, is_taken = math.exp(level + exponent * centre), np.isin(np.arange(counts.size), taken)
        return cls(coefficient, float(exponent), covariance, chi_squared, int(freedom), is_taken)

    @property
    def standard_errors(self) -> Array:
        """Standard errors of ln c and a."""
        return np.sqrt(np.diag(self.covariance))

    def bias(self, count: Any) -> Any:
        """The bias at a number of asperities."""
        return self.coefficient * np.asarray(count, float) ** -self.exponent

    def count(self, bias: float) -> tuple[float, float]:
        """The number of asperities with this bias, and the standard error of its
        logarithm."""
        logarithm = math.log(self.coefficient / bias) / self.exponent
        slopes = np.array([1.0, -logarithm]) / self.exponent
        return math.exp(logarithm), math.sqrt(max(float(slopes @ self.covariance @ slopes), 0.0))

    def attributes(self) -> dict[str, float]:
        """Attributes of a study."""
        of_coefficient, of_exponent = (float(error) for error in self.standard_errors)
        return {
            "fit_coefficient": self.coefficient,
            "fit_exponent": self.exponent,
            "fit_log_coefficient_standard_error": of_coefficient,
            "fit_exponent_standard_error": of_exponent,
            "fit_chi_squared": self.chi_squared,
            "fit_degrees_of_freedom": self.degrees_of_freedom,
        }


def reached(
    accuracy: float, counts: Array, bias: Array, error: Array, approach: Approach | None
) -> tuple[float, str]:
    """The number of asperities from which on the bias is within an accuracy, and how it was found.

    Parameters
    ----------
    accuracy : float
        The largest bias.
    counts, bias, error : arrays
        Sizes in rising order, biases and their standard errors.
    approach : Approach or None
        The power law, beyond the largest size.

    Returns
    -------
    tuple of float and str
        The number, or NaN; ``interpolated``, ``extrapolated``, ``below the smallest``, ``beyond the
        largest`` or ``unknown``.

    Examples
    --------
    >>> reached(0.05, np.array([100.0, 1e4]), np.array([0.5, 0.005]), np.full(2, 1e-4), None)[1]
    'interpolated'
    """
    with np.errstate(invalid="ignore"):
        within, known = np.abs(bias) <= accuracy, error <= 0.5 * accuracy
    outside = np.flatnonzero(~within)
    last = int(outside[-1]) if outside.size else -1
    # The sizes from there on decide where it is.
    if not known[last + 1 :].all():
        return math.nan, "unknown"
    if last < 0:
        return math.nan, "below the smallest"
    if last + 1 == counts.size:
        count, spread = approach.count(accuracy) if approach is not None else (math.nan, math.nan)
        is_known = count > counts[last] and spread <= _KNOWN
        return (count, "extrapolated") if is_known else (math.nan, "beyond the largest")
    (y0, y1), x = bias[last : last + 2], np.log(counts[last : last + 2])
    limit = math.copysign(accuracy, y0)
    share = math.log(y0 / limit) / math.log(y0 / y1) if y0 * y1 > 0.0 else (y0 - limit) / (y0 - y1)
    if not math.isfinite(share):
        return math.nan, "unknown"
    return math.exp(x[0] + share * (x[1] - x[0])), "interpolated"
