"""The numbers behind each figure of a page: tables of datasets of the file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
import xarray

from ..finite_size.study import is_study, study
from ..plot.run import BRANCHES
from ..plot.sweep import QUANTITIES, model_range, of_points
from ..results import Result, Run, Sweep

__all__ = ["tables"]

_PREFIXES = tuple(branch.prefix for branch in BRANCHES)
_OVER_H = ("external_force_mean", "external_force_standard_error", "external_force_quantile")
# Datasets of each figure; those that a file does not have are left out.
_DATASETS: dict[str, list[str]] = {
    "force": [f"ensemble/{prefix}{name}" for prefix in _PREFIXES for name in _OVER_H]
    + [f"integral/{prefix}external_force" for prefix in _PREFIXES]
    + ["replicas/snap_in_separation"],
    "integral": [f"integral/{prefix}external_force" for prefix in _PREFIXES],
    "pull_off": ["replicas/pull_off_force", "replicas/pull_off_separation", "replicas/approach_pull_off_force",
                 "model_range/pull_off_force"],
    "attraction": [f"ensemble/{prefix}adhesion_force_mean" for prefix in _PREFIXES]
    + ["background/force", "background/*_force"],
    "coupling": [f"coupling/{prefix}independent_external_force_mean" for prefix in _PREFIXES]
    + [f"ensemble/{prefix}external_force_mean" for prefix in _PREFIXES],
    "coupling_difference": [
        f"coupling/{prefix}difference_external_force_{of}" for prefix in _PREFIXES for of in ("mean", "standard_error")
    ],
    "avalanches": ["coupling/avalanche_size_count"],
    "contacts": [f"{group}/jump_{way}_count{of}" for group, of in (("ensemble", "_mean"), ("integral", "")) for way in ("in", "off")],
    "energy": ["replicas/dissipated_energy", "model_range/dissipated_energy"],
    "snaps": [f"instability/snap_{way}_probability{end}" for way in ("in", "off") for end in ("", "_low", "_high")],
    "preloads": [f"instability/pull_off_after_preload_{of}" for of in ("mean", "std", "quantile")]
    + ["model_range/pull_off_after_preload"],
    "stuck": [f"device/stuck_probability{end}_after_preload" for end in ("", "_low", "_high")]
    + ["model_range/stuck_probability_after_preload"],
    "regimes": ["ensemble/adhesion_force_mean", "integral/adhesion_force", "ensemble/regime_adhesion_force_mean",
                "integral/regime_adhesion_force"],
    "deviation": [f"validation/{of}_{name}_force" for of in ("z", "tested") for name in ("external", "adhesion")],
    "comparison": ["integral/h_star", "integral/external_force", "ensemble/external_force_mean"],
    "law_deviation": ["integral/pull_off_force"],
    "sizes": ["bias", "pull_off_quantiles"],
    "bias": ["bias", "bias_standard_error", "bias_fitted", "is_fitted", "count_at_accuracy"],
    "scatter": ["relative_std"],
    "asperities": ["asperities/x", "asperities/y", "asperities/height", "asperities/radius"],
    "heights": ["asperities/height"],
    "relation": ["asperities/height", "asperities/radius"],
    "curvatures": ["asperities/radius"],
    "density_over_cutoff": ["cutoffs/asperity_density", "cutoffs/summit_count"],
    "radius_over_cutoff": ["cutoffs/asperity_radius", "cutoffs/asperity_curvature_std", "cutoffs/summit_count"],
    "scatter_over_cutoff": ["cutoffs/asperity_height_std", "cutoffs/summit_count"],
    "convergence": ["replicas/pull_off_force", "replicas/pull_off_separation", "replicas/peak_secant_stiffness"],
}  # fmt: skip
_DATASETS["standard_errors"] = _DATASETS["convergence"]
# Beginning of what is by plastic contact, next to the datasets of a figure.
_RANGE = "model_range/"
# The first of these that a dataset has is the dimension of its rows.
_ROWS = ("separation", "separation_index", "step", "replica", "stiffness", "asperity_count", "preload")


def tables(result: Result, figure: str) -> list[pd.DataFrame]:
    """The numbers of a figure in SI units: a table for each dimension, with names and units of the file as names of columns.

    Parameters
    ----------
    result : Run, Sweep or Asperities
    figure : str
        A name that `stiction.plot.panels` has.
    """
    source: Any = result
    if isinstance(result, Sweep):
        if figure in QUANTITIES or figure == "heat_map":
            return [_of_sweep(result, figure if figure in QUANTITIES else "pull_off_force")]
        source = study(result) if is_study(result) else result
    by_dimension: dict[str, dict[str, Any]] = {}
    for path in _present(result, figure, source):
        array = source[path]
        main = _main(array)
        columns = by_dimension.setdefault(main, _coordinates(array, main))
        has_group = path.startswith(_RANGE) or ("/" in path and _is_of_several_groups(figure))
        columns.update(_columns(array, path, main, has_group))
    return [pd.DataFrame(columns) for columns in by_dimension.values()]


def _present(result: Result, figure: str, source: Any) -> Iterator[str]:
    for path in _DATASETS[figure]:
        if path == "background/*_force" and isinstance(result, Run):
            yield from result.mean_plane_forces.values()
        elif path in source:
            yield path


def _is_of_several_groups(figure: str) -> bool:
    return len({path.partition("/")[0] for path in _DATASETS[figure] if not path.startswith(_RANGE)}) > 1


def _main(array: xarray.DataArray) -> str:
    """The dimension of the rows."""
    return next((name for name in _ROWS if name in array.dims), str(array.dims[0]))


def _header(name: str, array: xarray.DataArray) -> str:
    unit = str(array.attrs.get("units", "1"))
    return f"{name} ({unit})" if unit not in ("1", "") else name


def _coordinates(array: xarray.DataArray, main: str) -> dict[str, Any]:
    of = [name for name in ("h_star", main, *array.coords) if name in array.coords and array.coords[name].dims == (main,)]
    return {_header(str(name), array.coords[name]): array.coords[name].values for name in dict.fromkeys(of)}


def _columns(array: xarray.DataArray, path: str, main: str, with_group: bool) -> Iterator[tuple[str, Any]]:
    """The columns of a dataset: one, or one for each place along its other dimensions."""
    group, _, name = path.rpartition("/")
    name = f"{group} {name}" if with_group else name
    others = [dim for dim in array.dims if dim != main]
    turned = array.transpose(main, *others)
    for place in np.ndindex(*(array.sizes[dim] for dim in others)):
        suffixes = [
            f"{dim} {array.coords[dim].values[i] if dim in array.coords else i}" for dim, i in zip(others, place, strict=True)
        ]
        yield _header(" ".join([name, *suffixes]), array), turned.values[(slice(None), *place)]


def _of_sweep(result: Sweep, figure: str) -> pd.DataFrame:
    mean, error, integral = of_points(result, figure)
    name = QUANTITIES[figure].dataset or figure
    columns = {f"{name}_mean_over_patches": mean, f"{name}_standard_error": error}
    if "range_end" in error.dims:
        below, above = error
        columns = {name: mean, f"{name}_low": mean - below, f"{name}_high": mean + above}
    if integral is not None:
        columns[f"{name}_of_integral"] = integral
    by_contact = model_range(result, figure)
    if by_contact is not None:
        columns |= {f"{name}_{end}_by_contact": of for end, of in zip(("smallest", "largest"), by_contact, strict=True)}
    keys = [key.replace(".", "_") for key in result.keys]
    whole = xarray.Dataset({name: of.drop_vars([c for c in of.coords if c not in keys]) for name, of in columns.items()})
    for key in keys:
        if key not in whole.variables:
            whole[key] = result[key]
    table = whole.to_dataframe().reset_index()[[*keys, *columns]]
    unit = QUANTITIES[figure].unit
    headers = {key: _header(key, result[key]) for key in keys}
    return table.rename(columns=headers | ({name: f"{name} ({unit})" for name in columns} if unit else {}))
