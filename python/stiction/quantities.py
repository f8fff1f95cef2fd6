"""Numbers with units, as people read them: SI prefixes, errors, signs."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

__all__ = [
    "as_text",
    "factor_and_unit",
    "in_si",
    "is_pint",
    "number",
    "parsed",
    "pint_text",
    "plain_unit",
    "reals",
    "si",
    "with_error",
]

_PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
# Units that take a prefix; "m2" and its kin would have it squared.
_PREFIXED = {"N", "m", "Pa", "J", "N/m", "J/m2", "s", "N m-1"}
_WRITTEN = {"1": "", "m2": "m²", "m-2": "m⁻²", "m-1": "m⁻¹", "J/m2": "J/m²", "N m-1": "N/m"}
# Units as scenes have them, and as files have them.
_OF_SCENES = {"m^2": "m2", "/m^2": "m-2", "J/m^2": "J/m2"}


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
        A unit of a file or a scene: ``N``, ``m``, ``1``, ``m2`` and their kin.

    Returns
    -------
    tuple of float and str
        Such as ``(1e-6, "µN")``.

    Examples
    --------
    >>> factor_and_unit([0.0, -5.7e-4], "N"), factor_and_unit([7.4e12], "/m^2")
    ((1e-06, 'µN'), (1000000000000.0, 'µm⁻²'))
    """
    unit = _OF_SCENES.get(unit, unit)
    sizes = np.abs(np.asarray(values, dtype=float))
    sizes = sizes[np.isfinite(sizes)]
    largest = float(sizes.max(initial=0.0))
    if unit == "m2" and largest > 0.0:
        # Squares of prefixed metres.
        exponent = min(max(3 * math.floor(math.log10(largest) / 6.0), -9), 0)
        return 10.0 ** (2 * exponent), f"{_PREFIXES[exponent]}m²"
    if unit == "m-2" and largest >= 1e9:
        return 1e12, "µm⁻²"
    if unit not in _PREFIXED or not largest > 0.0:
        return 1.0, plain_unit(unit)
    exponent = min(max(3 * math.floor(math.log10(largest) / 3.0 + 1e-12), -15), 9)
    return float(f"1e{exponent}"), f"{_PREFIXES[exponent]}{plain_unit(unit)}"


def number(value: float, digits: int = 4) -> str:
    """A number with `digits` significant digits, with a true minus sign.

    Examples
    --------
    >>> number(-0.00123456), number(2.82), number(1730, 2), number(float("nan")), number(1.5e-9)
    ('−0.001235', '2.820', '1700', '–', '1.500·10⁻⁹')
    """
    value = float(value)
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0.0:
        return "0"
    if not 1e-3 <= abs(value) < 1e6:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        power = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        return f"{mantissa}·10{power}".replace("-", "−")
    rounded = float(f"{value:.{digits - 1}e}")
    places = digits - 1 - math.floor(math.log10(abs(rounded)))
    return f"{rounded:.{max(places, 0)}f}".replace("-", "−")


def si(value: Any, unit: str, digits: int = 4) -> str:
    """A value with its unit and SI prefix.

    Examples
    --------
    >>> si(5.764e-4, "N"), si(4.56e-9, "m"), si(0.848, "1")
    ('576.4 µN', '4.560 nm', '0.8480')
    """
    value = float(value)
    if math.isnan(value):
        return number(value)
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


_POWERS = {"": 0, "T": 12, "G": 9, "M": 6, "k": 3, "m": -3, "u": -6, "µ": -6, "μ": -6, "n": -9, "p": -12}


def as_text(value: Any, unit: str) -> str:
    """A quantity as the program reads it: a text as it is, a number in `unit`, a pint quantity in its SI unit.

    Examples
    --------
    >>> as_text(2e-8, "m"), as_text("20 nm", "m")
    ('2e-08 m', '20 nm')
    """
    if isinstance(value, str):
        return value
    if is_pint(value):
        return pint_text(value)
    return f"{float(value)!r} {unit}"


# Units that scenes give numbers in, with the SI unit, and the power to which a prefix is in it.
_UNITS = {
    "m": ("m", 1), "m^2": ("m^2", 2), "/m^2": ("/m^2", -2), "Pa": ("Pa", 1), "N": ("N", 1), "J": ("J", 1), "J/m^2": ("J/m^2", 1),
    "N/m": ("J/m^2", 1), "V": ("V", 1), "K": ("K", 1), "m^3/mol": ("m^3/mol", 3),
}  # fmt: skip
_SMALL = {"c": -2, "f": -15, "a": -18, "z": -21}


def parsed(name: str, value: Any) -> tuple[float, str]:
    """A quantity of a scene as a number in SI units, and that unit; ``1`` where it has none.

    Parameters
    ----------
    name : str
        What it is, for the message.
    value : str, float or pint.Quantity
        A text of a number and a unit of scenes, or a number without one.

    Raises
    ------
    ValueError
        It is no finite number, or its unit is none of scenes.

    Examples
    --------
    >>> parsed("radius", "20 nm"), parsed("density", "8.5 /um^2"), parsed("humidity", 0.45), parsed("temperature", "20 degC")
    ((2e-08, 'm'), (8500000000000.0, '/m^2'), (0.45, '1'), (293.15, 'K'))
    """
    text = pint_text(value) if is_pint(value) else str(value)
    text = text.strip().replace("**", "^").replace("²", "^2").replace("µ", "u").replace("μ", "u")
    found = re.fullmatch(r"([-+]?(?:\d+\.?\d*|\.\d+))(?:[eE]([-+]?\d+))?\s*(\S*)", text)
    if found is None or isinstance(value, bool):
        raise ValueError(f"{name} = {value!r}: a number is needed, with its unit if it has one, such as \"20 nm\"")
    mantissa, exponent, written = found.groups()
    written = {"angstrom": "100 pm"}.get(written, written)
    if not written:
        return float(f"{mantissa}e{int(exponent or 0)}"), "1"
    if written == "degC":
        return float(f"{mantissa}e{int(exponent or 0)}") + 273.15, "K"
    if written == "100 pm":
        return float(f"{mantissa}e{int(exponent or 0) - 10}"), "m"
    for unit, (si_unit, power) in _UNITS.items():
        over = "/" if unit.startswith("/") else ""
        for prefix, ten in (_POWERS | _SMALL).items():
            if written == f"{over}{prefix}{unit.removeprefix('/')}":
                return float(f"{mantissa}e{int(exponent or 0) + power * ten}"), si_unit
    raise ValueError(
        f"{name} = {value!r}: {written} is no unit of a scene; {', '.join(_UNITS)} are, with prefixes, and degC"
    )


def is_pint(value: Any) -> bool:
    """Whether a value is a quantity of pint, which need not be installed."""
    return hasattr(value, "magnitude") and hasattr(value, "is_compatible_with")


# Units of scenes, as pint and as scenes write them; J/m^2 and N/m are one.
_OF_PINT = {
    "meter": "m",
    "meter**2": "m^2",
    "1/meter**2": "/m^2",
    "pascal": "Pa",
    "newton/meter": "N/m",
    "newton": "N",
}


def pint_text(value: Any) -> str:
    """A scalar pint quantity as scenes write it, in its SI unit.

    Raises
    ------
    ValueError
        Scenes have no quantity of that dimension.
    """
    for of_pint, unit in _OF_PINT.items():
        if value.is_compatible_with(of_pint):
            return f"{float(value.to(of_pint).magnitude)!r} {unit}"
    if value.is_compatible_with("dimensionless"):
        return repr(float(value.to("dimensionless").magnitude))
    known = ", ".join(_OF_PINT.values())
    raise ValueError(f"{value}: scenes have no quantity of this dimension; they have {known}")


def reals(name: str, value: Any) -> Any:
    """Real numbers as an array of floats, NaN where they are masked.

    Parameters
    ----------
    name : str
        What they are, for the message.
    value : array_like
        The numbers.

    Raises
    ------
    ValueError
        They are complex, of different lengths, or no numbers.

    Examples
    --------
    >>> reals("radius", [1, 2]).tolist()
    [1.0, 2.0]
    """
    try:
        if np.iscomplexobj(value):
            raise ValueError(f"{name}: real numbers are needed, not complex ones")
        return np.ma.filled(np.asanyarray(value, dtype=float), np.nan)
    except (TypeError, ValueError) as error:
        if str(error).startswith(name):
            raise
        raise ValueError(f"{name}: an array of real numbers is needed ({error})") from None


def in_si(name: str, value: Any, unit: str) -> Any:
    """Numbers in an SI unit from numbers, texts with a unit, or pint quantities, scalars or arrays.

    Parameters
    ----------
    name : str
        What it is, for the message.
    value : float, str, array_like or pint.Quantity
        Numbers are in `unit` already.
    unit : {"m", "Pa", "J/m^2"}
        The unit.

    Raises
    ------
    ValueError
        A text is not a number with such a unit, or a quantity has another dimension.

    Examples
    --------
    >>> in_si("radius", "20 nm", "m"), in_si("work_of_adhesion", "50 mJ/m^2", "J/m^2")
    (2e-08, 0.05)
    """
    if is_pint(value):
        of_pint = {"m": "meter", "Pa": "pascal", "J/m^2": "newton/meter"}[unit]
        if not value.is_compatible_with(of_pint):
            raise ValueError(f"{name} = {value}: a quantity in {unit} is needed")
        return value.to(of_pint).magnitude
    if not isinstance(value, str):
        if isinstance(value, list | tuple) and any(isinstance(one, str) for one in value):
            return np.array([in_si(name, one, unit) for one in value])
        return value
    text = value.strip().replace("**", "^").replace("²", "^2")
    found = re.fullmatch(r"([-+]?[\d.]+)(?:[eE]([-+]?\d+))?\s*(\S.*)", text)
    if found is not None:
        mantissa, exponent, written = found.groups()
        written = {"angstrom": "Å", "A": "Å"}.get(written, written)
        powers = {f"{sign}{unit}": power for sign, power in _POWERS.items()}
        if unit == "J/m^2":
            for spelling in ("N/m", "J/m2"):
                powers |= {f"{sign}{spelling}": power for sign, power in _POWERS.items()}
        if unit == "m":
            powers["Å"] = -10
        if written in powers:
            try:
                return float(f"{mantissa}e{int(exponent or 0) + powers[written]}")
            except ValueError:
                pass
    raise ValueError(
        f"{name} = {value!r}: a number with a unit such as {'n' if unit == 'm' else ''}{unit} is needed"
    )
