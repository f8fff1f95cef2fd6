"""What an inference found: the posterior, as its file has it."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import arviz
import numpy as np
import pandas as pd
import xarray

from .. import files, quantities, stored
from ..errors import FileError, SceneError
from ..rows import row

__all__ = ["FORMAT", "Inference", "models", "open_inference"]

#: The attribute `format` of its files.
FORMAT = "stiction-inference"


@dataclass(frozen=True)
class Inference:
    """The posterior of a scene's parameters from the data.

    Attributes
    ----------
    data : arviz.InferenceData
        The groups `posterior` (parameters in SI units), `sample_stats`, `log_likelihood`, `posterior_predictive`, `observed_data`, `prior`, and
        `identifiability`: combinations of parameters, from the best known to the least, and the Fisher information.
    """

    data: Any

    @property
    def attrs(self) -> dict[str, Any]:
        """Title, scene and figures of the whole inference."""
        return dict(self.data.posterior.attrs)

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return [str(name) for name in self.data.posterior.data_vars]

    def summary(self, level: float = 0.95) -> pd.DataFrame:
        """A row for each parameter, in SI units.

        Parameters
        ----------
        level : float
            The probability of the central intervals.

        Returns
        -------
        pandas.DataFrame
            `median`, `low` and `high` ends, `prior_low` and `prior_high`; `r_hat`, `effective` sample size and `end_error`, the Monte Carlo error of
            the ends of the 95 % interval over its width; `contraction`, 1 − posterior variance / prior variance (of the logarithm where
            the prior is one of the logarithm).
        """
        tail = 0.5 * (1.0 - level)
        rows = []
        for name in self.names:
            low, median, high = np.quantile(self.data.posterior[name], [tail, 0.5, 1.0 - tail])
            before = np.quantile(self.data.prior[name], [tail, 1.0 - tail])
            attrs = self.data.posterior[name].attrs
            figures = {key: float(attrs[key]) for key in ("r_hat", "effective", "end_error", "contraction")}
            rows.append({"median": median, "low": low, "high": high, "prior_low": before[0], "prior_high": before[1], **figures})
        return pd.DataFrame(rows, index=self.names)

    def loo(self) -> Any:
        """Expected log density of a patch not measured, by Pareto-smoothed importance sampling: `arviz.loo`."""
        return arviz.loo(self.data, pointwise=True)  # type: ignore[no-untyped-call]

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Writes the HDF5 file that `open_inference` and `arviz.from_netcdf` read.

        Raises
        ------
        FileError
            There is one already, and `force` is not given.
        """
        with files.writing_hdf5(path, force=force) as part:
            self.data.to_netcdf(str(part), engine="h5netcdf")
        return Path(path)

    def _batches(self) -> list[tuple[str, str]]:
        """Rows on the batches of the data."""
        names = str(self.attrs["batches"])
        if "batches" not in self.data.groups():
            return [("batches", f"{names}: taken as alike; batch_log_std in a prior lets its number differ between them")] if names else []
        (of,) = self.data.batches.data_vars.values()
        rows = []
        for batch in of.batch.values:
            low, median, high = (quantities.si(end, str(of.attrs["units"])) for end in np.quantile(of.sel(batch=batch), [0.025, 0.5, 0.975]))
            rows.append((f"batch {batch}", f"{_words(str(of.name))} {median}, 95 % interval {low} to {high}"))
        return rows

    def _density(self) -> str:
        """What the fitted density leaves."""
        share, noise, wanted = (100.0 * float(self.attrs[f"emulator_{name}"]) for name in ("share", "noise", "wanted"))
        text = (
            f"{self.attrs['simulated_patches']} simulated patches; by fresh ones its error moves or widens the posterior by "
            f"{quantities.with_error(share, noise, '%')} of its standard deviation, and their distribution is off by "
            f"{quantities.number(100.0 * self.attrs['emulator_distance'], 2)} % at most"
        )
        return text if share <= wanted else f"{text}: more than the {wanted:g} % wanted, the interval is that much off"

    def _combinations(self) -> list[tuple[str, str]]:
        """Rows on combinations of the parameters, from the best known to the least."""
        rows = []
        for k in range(self.data.identifiability.sizes["combination"]):
            of = self.data.identifiability.isel(combination=k)
            share, spread = 100.0 * float(of.posterior_std / of.prior_std), float(of.posterior_std)
            known = "known" if share < 30.0 else "hardly known" if share > 70.0 else "partly known"
            rows.append((known, f"{_combination(of)} to {quantities.number(spread, 2)} ({quantities.number(share, 2)} % of the prior's standard deviation)"))
        return rows

    def _errors(self) -> tuple[str, str]:
        """The row on the error of the draws."""
        if self.attrs["is_grid"]:
            return "grid", "of one or two priors; no chains that would have to agree"
        worst = self.summary()
        error = quantities.number(100.0 * worst.end_error.max(), 2)
        return "chains", f"R̂ {worst.r_hat.max():.4f}, {worst.effective.min():.0f} effective draws, their error of the ends of intervals {error} % of the width"

    def __str__(self) -> str:
        gaps = f"; not measured: {self.attrs['gaps']}" if self.attrs.get("gaps") else ""
        rows = [("data", f"{quantities.counted(int(self.attrs['patches']), 'patch')}: {self.attrs['outcomes']}{gaps}")]
        for name, figures in self.summary().iterrows():
            unit = str(self.data.posterior[name].attrs["units"])
            low, median, high = (quantities.si(figures[of], unit) for of in ("low", "median", "high"))
            rows.append((_words(str(name)), f"{median}, 95 % interval {low} to {high}"))
        rows += self._batches() + self._combinations()
        for outcome, p in zip(str(self.attrs["outcomes"]).split(", "), np.atleast_1d(self.attrs["check_p_value"]), strict=True):
            verdict = "the model does not describe the data" if p < 0.01 else "the model may have made the data"
            rows.append(("check", f"{outcome}: p = {p:.3g}, {verdict}"))
        if self.attrs["outliers_expected"]:
            rows.append(("outliers", f"{100 * self.attrs['outliers']:.2g} % of the data, {100 * self.attrs['outliers_expected']:.2g} % by the prior"))
        rows += [("doubted", said) for said in str(self.attrs["doubted"]).splitlines()]
        rows += [self._errors(), ("density", self._density())]
        start = max(len(name) for name, _ in rows) + 4
        return "\n".join(line for name, text in rows for line in row(name, text, start))


def models(results: Mapping[str, Inference]) -> pd.DataFrame:
    """Compares inferences from the same data by their expected log density of a patch not measured: `arviz.compare`.

    Parameters
    ----------
    results : dict
        Inferences by the names of their models.

    Returns
    -------
    pandas.DataFrame
        A row for each model, the best first: `elpd_loo`, its difference to the best `elpd_diff` with the standard error `dse`, the stacking `weight`, and
        `warning` where importance sampling is not to be trusted (Pareto k̂ above 0.7).
    """
    if len({result.data.observed_data.sizes["patch_number"] for result in results.values()}) > 1:
        raise SceneError("models are compared with the same data only")
    with warnings.catch_warnings():
        # The table says it, in its column.
        warnings.simplefilter("ignore")
        return arviz.compare({name: result.data for name, result in results.items()}, ic="loo")


def open_inference(path: str | os.PathLike[str]) -> Inference:
    """Opens the file of an inference.

    Raises
    ------
    FileError
        There is no such file, or it holds no inference.
    """
    path = Path(path)
    if not path.is_file():
        raise FileError(f"{path}: no such file")
    try:
        stored.check(path)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            data = arviz.from_netcdf(str(path))  # type: ignore[no-untyped-call]
        known = data.posterior.attrs.get("format") == FORMAT
    except FileError:
        raise
    except Exception:
        known = False
    if not known:
        raise FileError(f"{path}: not a result of `stiction infer`")
    return Inference(data)


def _words(name: str) -> str:
    return name.partition("_")[2].replace("_", " ")


def _combination(of: xarray.Dataset) -> str:
    """A combination in words, without what hardly takes part in it: a product of powers, or a sum where a parameter may be negative."""
    rows = zip(of.parameter.values, of.exponent.values, of.logarithmic.values, strict=True)
    kept = [(_words(str(name)), share, bool(log)) for name, share, log in rows if abs(share) > 0.05 * np.abs(of.exponent.values).max()]
    if all(log for _, _, log in kept):
        text = " · ".join(name + f"^{share:.2g}".removesuffix("^1") for name, share, _ in kept)
    else:
        text = " + ".join(f"{share:.2g} {f'ln {name}' if log else f'{name}/prior scatter'}" for name, share, log in kept)
    return text.replace("-", "−")
