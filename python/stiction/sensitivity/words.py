"""A study in words."""

from __future__ import annotations

import numpy as np
import xarray

from .. import quantities

__all__ = ["QUANTITIES", "words"]

#: Outcomes of a patch: words and unit.
QUANTITIES = {
    "pull_off_force": ("pull-off force", "N"),
    "peak_secant_stiffness": ("largest stiffness", "N m-1"),
    "energy": ("energy", "J"),
}
# Indices that differ by less are alike, as chance has them of numbers that act separately.
_ROUNDED = 0.01


def words(found: xarray.Dataset) -> str:
    """A study in words."""
    level = 100.0 * float(found.attrs["interval_level"])
    lines = [f"Sobol indices of the mean over patches, with {level:g} % intervals"]
    width = max(len(str(key)) for key in found["key"].values) + 2
    for name in found["quantity"].values:
        one = found.sel(quantity=name)
        unit = str(one["unit"].item())
        mean, std = (quantities.si(one[what], unit) for what in ("mean", "standard_deviation"))
        lines.append(f"\n  {QUANTITIES[str(name)][0]}: {mean}; standard deviation of one patch, by numbers and by chance, {std}")
        lines.append(f"    {'':{width}}{'first order':26}total")
        least = one["total"] < one["first_order"] - _ROUNDED
        for key in found["key"].values:
            of = one.sel(key=key)
            columns = [_within(of[kind], of[f"{kind}_interval"]) for kind in ("first_order", "total")]
            lines.append(f"    {key:{width}}{columns[0]:26}{columns[1]}")
        lines.append(f"    {'scatter between patches, of all variance':{width + 26}}{_within(one['scatter'], one['scatter_interval'])}")
        if least.any():
            few = ", ".join(str(key) for key in found["key"].values[least.values])
            lines.append(f"    too few samples: the total of {few} is below its first order, which it contains; more --samples")
    return "\n".join(lines)


def _within(value: xarray.DataArray, interval: xarray.DataArray) -> str:
    if np.isnan(float(value)):
        return "none"
    if np.isnan(interval.values).any():
        return f"{float(value):.3f} [not known]"
    low, high = (f"{float(end):.3f}" for end in interval.values)
    return f"{float(value):.3f} [{low}, {high}]".replace("-", "−")
