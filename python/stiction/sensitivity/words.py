"""A study in words."""

from __future__ import annotations

import numpy as np
import xarray

from .. import quantities

__all__ = ["QUANTITIES", "needed", "words"]

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
    correlated = bool(found.attrs["correlated"])
    named = "Sobol indices of correlated numbers" if correlated else "Sobol indices"
    lines = [f"{named} of the mean over patches, with {level:g} % intervals", f"  {_precision(found)}"]
    if found.attrs["left_out"]:
        lines.append(f"  {found.attrs['left_out']} of {found.attrs['samples']} samples left out; the first: {found.attrs['left_out_first']}")
    width = max(len(str(key)) for key in found["key"].values) + 2
    for name in found["quantity"].values:
        one = found.sel(quantity=name)
        unit = str(one["unit"].item())
        mean, std = (quantities.si(one[what], unit) for what in ("mean", "standard_deviation"))
        lines.append(f"\n  {QUANTITIES[str(name)][0]}: {mean}; standard deviation of one patch, by numbers and by chance, {std}")
        lines.append(f"    {'':{width}}{'first order':26}total")
        least = (one["total"] < one["first_order"] - _ROUNDED) & (not correlated)
        for key in found["key"].values:
            of = one.sel(key=key)
            columns = [_within(of[kind], of[f"{kind}_interval"]) for kind in ("first_order", "total")]
            lines.append(f"    {key:{width}}{columns[0]:26}{columns[1]}")
        lines.append(f"    {'scatter between patches, of all variance':{width + 26}}{_within(one['scatter'], one['scatter_interval'])}")
        if least.any():
            few = ", ".join(str(key) for key in found["key"].values[least.values])
            lines.append(f"    too few samples: the total of {few} is below its first order, which it contains; give a smaller --interval")
    return "\n".join(lines)


def _precision(found: xarray.Dataset) -> str:
    """The widest interval of an index, and the number of samples that the asked one needs."""
    samples, asked, wide = found.attrs["samples"], found.attrs["interval"], _widest(found)
    points = f"{samples} samples, of {found.attrs['replicas']} patches at each point"
    said = f"intervals up to {wide:.2g} wide" if np.isfinite(wide) else "intervals that are not known"
    if wide <= asked:
        return f"{points}: {said}"
    return f"too few samples: {points}: {said}; {asked:g} needs about {needed(found)}"


def _widest(found: xarray.Dataset) -> float:
    """The largest width of an interval of an index that there is."""
    width = 0.0
    for kind in ("first_order", "total"):
        of = np.diff(found[f"{kind}_interval"].values, axis=-1)[..., 0][np.isfinite(found[kind].values)]
        width = max(width, float(np.nan_to_num(of, nan=np.inf).max(initial=0.0)))
    return width


def needed(found: xarray.Dataset) -> int:
    """Samples, a power of 2, with which intervals of indices are likely as narrow as asked: widths fall with their square root."""
    samples, ratio = int(found.attrs["samples"]), _widest(found) / float(found.attrs["interval"])
    doublings = 2.0 * np.log2(max(ratio, 1.0)) if np.isfinite(ratio) else 1.0
    more: int = 2 ** int(np.ceil(doublings))
    return samples * more


def _within(value: xarray.DataArray, interval: xarray.DataArray) -> str:
    if np.isnan(float(value)):
        return "none"
    if np.isnan(interval.values).any():
        return f"{float(value):.3f} [not known]"
    low, high = (f"{float(end):.3f}" for end in interval.values)
    return f"{float(value):.3f} [{low}, {high}]".replace("-", "−")
