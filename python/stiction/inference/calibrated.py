"""What a calibration found: ranks of true parameters, as its file has them."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray
from numpy.typing import NDArray
from scipy import stats

from .. import quantities, stored
from ..errors import FileError
from ..rows import row

__all__ = ["FORMAT", "RANKS", "Calibration", "open_calibration"]

Array = NDArray[np.float64]
#: The attribute `format` of its files.
FORMAT = "stiction-calibration"
#: The group of files that has the ranks.
RANKS = "calibration"
_LEVELS = (0.5, 0.9, 0.95)
# Column of the table in which its cells begin.
_START = 24


@dataclass(frozen=True)
class Calibration:
    """Ranks of the true parameters of synthetic experiments in their posteriors.

    Attributes
    ----------
    data : xarray.Dataset
        Over `experiment` and `parameter`: `rank`, fractions of the posterior's draws below the true parameter, uniform on 0 to 1 if the posteriors are right
        (S. Talts and others, arXiv:1804.06788); over `experiment` `check`, p-values of the posterior-predictive check, and
        `emulator_share`. Attributes: title, scene, number of patches, experiments that failed.
    """

    data: xarray.Dataset

    @property
    def names(self) -> list[str]:
        """Parameters."""
        return [str(name) for name in self.data.parameter.values]

    @property
    def ranks(self) -> Array:
        """Ranks, (experiments, parameters)."""
        return np.asarray(self.data["rank"].values)

    def coverage(self, level: float) -> Array:
        """Fraction of the experiments in which the central interval of that probability contains the true parameter, (parameters,)."""
        result: Array = (np.abs(self.ranks - 0.5) <= 0.5 * level).mean(axis=0)
        return result

    def p_values(self) -> Array:
        """p-values of uniform ranks by the test of Kolmogorov and Smirnov, (parameters,)."""
        return np.array([stats.kstest(column, "uniform").pvalue for column in self.ranks.T])

    def __str__(self) -> str:
        failed = int(self.data.attrs["failed"])
        count = f"{len(self.ranks)} of {quantities.counted(int(self.data.attrs['patches']), 'patch')}, parameters drawn from the priors"
        heads = "".join(f"{f'{100 * level:.0f} %':<16}" for level in _LEVELS)
        lines = row("experiments", f"{count}{f'; {failed} failed, left out' if failed else ''}", _START)
        lines.append(f"  {'intervals of':<{_START - 2}}{heads}ranks: p")
        for place, (name, p) in enumerate(zip(self.names, self.p_values(), strict=True)):
            cells = []
            for level in _LEVELS:
                hits = round(float(self.coverage(level)[place]) * len(self.ranks))
                low, high = stats.binomtest(hits, len(self.ranks)).proportion_ci(0.95, "wilson")
                cells.append(f"{100 * hits / len(self.ranks):.0f} ({100 * low:.0f} to {100 * high:.0f})")
            label = name.partition("_")[2].replace("_", " ")
            if len(label) > _START - 4:
                lines.append(f"  {label}")
                label = ""
            lines.append(f"  {label:<{_START - 2}}{''.join(f'{cell:<16}' for cell in cells)}{quantities.number(p, 2) if p >= 1e-3 else '< 0.001'}")
        return "\n".join(lines)


def open_calibration(path: str | os.PathLike[str]) -> Calibration:
    """Opens the file of a calibration.

    Raises
    ------
    FileError
        There is no such file, or it holds no calibration.
    """
    path = Path(path)
    if not path.is_file():
        raise FileError(f"{path}: no such file")
    return Calibration(stored.group(path, RANKS, "not a result of `stiction infer --calibrate`"))
