"""Numbers with units, as people read them: SI prefixes, errors, signs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["factor_and_unit", "number", "plain_unit", "si", "with_error"]

_PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
# Units that take a prefix; "m2" and its kin would have it squared.
_PREFIXED = {"N", "m", "Pa", "J", "N/m", "J/m2", "s", "N m-1"}
_WRITTEN = {"1": "", "m2": "m²", "m-2": "m⁻²", "m-1": "m⁻¹", "J/m2": "J/m²", "N m-1": "N/m"}


def plain_unit(unit: str) -> str:
    """A unit as a file writes it, as people write it: ``m2`` is m², ``1`` is nothing."""
    return _WRITTEN.get(unit, unit)


def factor_and_unit(values: ArrayLike, unit: str) -> tuple[float, str]:
    """The factor to divide values by, and the unit that they then have.

    Parameters
    ----------
    values : array_like
        Numbers in `unit`; the largest finite one decides.
    unit : str
        A unit of a file: ``N``, ``m``, ``1``, ``m2`` and their kin.

    Returns
    -------
    tuple of float and str
        Such as ``(1e-6, "µN")``.

    Examples
    --------
    >>> factor_and_unit([0.0, -5.7e-4], "N")
    (1e-06, 'µN')
    """
    sizes = np.abs(np.asarray(values, dtype=float))
    sizes = sizes[np.isfinite(sizes)]
    largest = float(sizes.max(initial=0.0))
    if unit == "m2" and largest > 0.0:
        # Squares of prefixed metres.
        exponent = min(max(3 * math.floor(math.log10(largest) / 6.0), -9), 0)
        return 10.0 ** (2 * exponent), f"{_PREFIXES[exponent]}m²"
    if unit not in _PREFIXED or not largest > 0.0:
        return 1.0, plain_unit(unit)
    exponent = min(max(3 * math.floor(math.log10(largest) / 3.0 + 1e-12), -15), 9)
    return float(f"1e{exponent}"), f"{_PREFIXES[exponent]}{plain_unit(unit)}"


def number(value: float, digits: int = 4) -> str:
    """A number with so many significant digits, with a true minus sign.

    Examples
    --------
    >>> number(-0.00123456), number(2.82), number(float("nan")), number(1.5e-9)
    ('−0.001235', '2.820', '–', '1.500·10⁻⁹')
    """
    value = float(value)
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value != 0.0 and not 1e-3 <= abs(value) < 1e6:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        power = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        return f"{mantissa}·10{power}".replace("-", "−")
    return f"{value:#.{digits}g}".rstrip(".").replace("-", "−")


def si(value: Any, unit: str, digits: int = 4) -> str:
    """A value with its unit and SI prefix.

    Examples
    --------
    >>> si(5.764e-4, "N"), si(4.56e-9, "m"), si(0.848, "1")
    ('576.4 µN', '4.560 nm', '0.8480')
    """
    value = float(value)
    factor, written = factor_and_unit([value], unit)
    return f"{number(value / factor, digits)} {written}".strip()


def with_error(value: Any, error: Any, unit: str) -> str:
    """A value and its standard error in one unit, the error to two digits, the value to the same place.

    Examples
    --------
    >>> with_error(5.764e-4, 3.733e-7, "N")
    '576.40 ± 0.37 µN'
    >>> with_error(5.764e-4, float("nan"), "N")
    '576.4 µN'
    """
    value, error = float(value), float(error)
    if not (math.isfinite(value) and math.isfinite(error) and error > 0.0):
        return si(value, unit)
    factor, written = factor_and_unit([value], unit)
    places = max(1 - math.floor(math.log10(error / factor)), 0)
    text = f"{value / factor:.{places}f} ± {error / factor:.{places}f} {written}"
    return text.replace("-", "−").strip()
