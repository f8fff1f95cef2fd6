"""One asperity, in SI units."""

from __future__ import annotations

import io
import itertools
from collections.abc import Iterable
from typing import Any

import pandas as pd
import xarray

from . import program, quantities
from .errors import SceneError
from .tables import meant

__all__ = ["asperity"]

# The arguments that are numbers, the unit of each, and how it is called in words.
_NUMBERS = {
    "radius": ("m", "radius of the asperity"),
    "reduced_modulus": ("Pa", "reduced modulus"),
    "work_of_adhesion": ("J/m^2", "work of adhesion"),
    "equilibrium_spacing": ("m", "equilibrium spacing"),
    "interference": ("m", "interference, positive where the undeformed bodies overlap"),
    "hardness": ("Pa", "hardness of the softer body"),
    "poisson_ratio": ("1", "Poisson ratio of the softer body"),
    "lubricant_thickness": ("m", "thickness of the lubricant"),
    "deepest_interference": ("m", "interference at which the asperity turned"),
}
_USUAL = {"m": "nm", "Pa": "GPa", "J/m^2": "mJ/m^2"}
_OPTIONAL = ("hardness", "poisson_ratio", "lubricant_thickness", "deepest_interference")
_RESULTS = {
    "adhesion_force": ("N", "adhesion force, attractive positive"),
    "contact_force": ("N", "contact force, compressive positive"),
    "external_force": ("N", "external force, compressive positive"),
    "contact_radius": ("m", "radius of the contact"),
    "adhesion_parameter": ("1", "adhesion parameter"),
    "regime": ("1", "regime of the asperity"),
}


def asperity(
    *,
    radius: Any = None,
    reduced_modulus: Any = None,
    work_of_adhesion: Any = None,
    equilibrium_spacing: Any = None,
    interference: Any = None,
    law: str = "hybrid",
    hardness: Any = None,
    poisson_ratio: Any = None,
    lubricant_thickness: Any = None,
    deepest_interference: Any = None,
    path: str = "approach",
    **others: Any,
) -> xarray.Dataset:
    """Solves one asperity against a flat.

    All numbers may be floats or arrays in SI units, texts with a unit (``"20 nm"``), or pint quantities. `xarray.DataArray`
    broadcast by the names of their dimensions; an array without names has the name of its argument for its dimension. A table of
    asperities, one a row, is ``asperity(**read_table("tips.csv"))``.

    Parameters
    ----------
    radius, equilibrium_spacing : m
    reduced_modulus : Pa
    work_of_adhesion : J/m²
    interference : m
        How far the undeformed bodies overlap; negative before contact.
    law : str
        Any law that scenes know but ``fit:paper``.
    hardness : Pa, optional
        Of the softer body; without it the asperity stays elastic.
    poisson_ratio : float, optional
        Of the softer body; needed with `hardness`.
    lubricant_thickness : m, optional
    deepest_interference : m, optional
        To which the asperity was pressed before: then it is on its unloading branch. By laws of loading alone it may not have yielded.
    path : {"approach", "retraction"}
        Which solution where there are two.
    **others
        Columns of a table that are no arguments: refused, with their names.

    Returns
    -------
    xarray.Dataset
        `adhesion_force`, `contact_force` and `external_force` (N), `contact_radius` (m), `adhesion_parameter` λ and `regime`, over
        the arguments that are arrays.

    Raises
    ------
    SceneError
        An argument is wrong, missing or unknown, or a column has a unit of another dimension; the message names it.

    Examples
    --------
    The pull-off force of a soft sphere is 3/2 πRΔγ, as by JKR:

    >>> import numpy as np
    >>> import stiction
    >>> curve = stiction.asperity(
    ...     law="jkr", path="retraction", radius="1 um", reduced_modulus="1 MPa", work_of_adhesion="50 mJ/m^2",
    ...     equilibrium_spacing="0.2 nm", interference=np.linspace(-100e-9, 100e-9, 2001))
    >>> f"{float(-curve.external_force.min() / (np.pi * 1e-6 * 0.05)):.2f}"
    '1.50'
    """
    given = locals()
    _check_names(given, others)
    arrays: dict[str, xarray.DataArray] = {}
    for name, (unit, words) in _NUMBERS.items():
        value = given[name]
        if value is None and name in _OPTIONAL:
            continue
        _check_unit(name, given, unit)
        try:
            value = value if unit == "1" else quantities.in_si(name, value, unit)
            array = _array(name, value)
        except (TypeError, ValueError) as error:
            raise SceneError(
                str(error) if str(error).startswith(name) else f"{name} = {value!r}: {error}"
            ) from None
        array.attrs = {"units": unit, "long_name": words}
        arrays[name] = array
        if array.size == 0:
            raise SceneError(f"{name}: the array is empty")
    broadcast = xarray.broadcast(*arrays.values())
    shape, dims = broadcast[0].shape, broadcast[0].dims
    printed = program.call(["asperity", "--law", law, "--path", path, "--table", "-"], text=_table(arrays, broadcast))
    solved = pd.read_csv(io.StringIO(printed))
    coordinates = {name: coordinate for array in broadcast for name, coordinate in array.coords.items()}
    results = {
        name: (dims, solved[name].to_numpy().reshape(shape), {"units": unit, "long_name": words})
        for name, (unit, words) in _RESULTS.items()
    }
    attributes = {"law": law, "path": path}
    scalars = {name: array for name, array in arrays.items() if array.ndim == 0}
    return xarray.Dataset(results, coords={**coordinates, **scalars}, attrs=attributes)


def _check_names(given: dict[str, Any], others: dict[str, Any]) -> None:
    """Refuses what is no argument, or no text where one is needed, and what is missing."""
    for name in others:
        guess = meant(name, _NUMBERS) or f'; leave it out, of a table by .drop_vars("{name}")'
        raise SceneError(f"{name}: no argument of asperity{guess}")
    for name in ("law", "path"):
        if not isinstance(given[name], str):
            raise SceneError(f"{name}: one text for all asperities is needed")
    missing = [name for name in _NUMBERS if given[name] is None and name not in _OPTIONAL]
    if missing:
        units = ", ".join(f"{name} ({_NUMBERS[name][0]})" for name in missing)
        raise SceneError(f"{missing[0]} is missing; needed besides what is given: {units}")


def _check_unit(name: str, given: dict[str, Any], unit: str) -> None:
    """Refuses an array of xarray with another unit, or with none where others have one."""
    units = {key: str(given[key].attrs["units"]) for key in _NUMBERS if "units" in getattr(given[key], "attrs", {})}
    own = units.get(name, unit)
    if own in ("", "1") and not any(other not in ("", "1") for other in units.values()):
        # Numbers in SI units, of which none is written.
        return
    if not quantities.of_one_dimension([own or "1", unit]):
        problem = "has no unit, and other columns have theirs" if own in ("", "1") else f"has the unit {own}"
        such = f"{unit} or a multiple is needed, such as {name} ({_USUAL.get(unit, unit)})"
        raise SceneError(f"{name}: the column {problem}; {'a number without unit is needed' if unit == '1' else such}")


def _table(arrays: dict[str, xarray.DataArray], broadcast: tuple[xarray.DataArray, ...]) -> str:
    """Arguments as the program reads them; one number for all is written once, as writing takes longer than solving."""
    columns: list[Iterable[str]] = []
    for array, whole in zip(arrays.values(), broadcast, strict=True):
        if array.size == 1:
            columns.append(itertools.repeat(f"{float(array.values.ravel()[0]):.17g}", whole.size))
        else:
            columns.append(map("{:.17g}".format, whole.values.ravel().tolist()))
    return "\n".join([",".join(arrays), *map(",".join, zip(*columns, strict=True)), ""])


def _array(name: str, value: Any) -> xarray.DataArray:
    """A number or an array over dimensions, of which a list of numbers is its own coordinate."""
    if isinstance(value, xarray.DataArray):
        return value.copy(data=quantities.reals(name, value.values))
    numbers = quantities.reals(name, value)
    if numbers.ndim > 1:
        raise ValueError(
            f"{name}: an array of {numbers.ndim} dimensions needs their names: give an xarray.DataArray"
        )
    return xarray.DataArray(
        numbers, dims=[name] * numbers.ndim, coords={name: numbers} if numbers.ndim else None
    )
