"""Numbers with units, as people read them: SI prefixes, errors, signs."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

__all__ = [
    "Unit",
    "as_text",
    "counted",
    "factor_and_unit",
    "in_si",
    "is_pint",
    "number",
    "of_one_dimension",
    "parsed",
    "pint_text",
    "plain_unit",
    "reals",
    "si",
    "split",
    "unit",
    "with_error",
]

_PREFIXES = {-18: "a", -15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
# Units that take a prefix; "m2" and its kin would have it squared.
_PREFIXED = {"N", "m", "Pa", "J", "N/m", "J/m2", "s", "N m-1", "V"}
_WRITTEN = {
    "1": "",
    "m2": "m²",
    "m-2": "m⁻²",
    "m-1": "m⁻¹",
    "J/m2": "J/m²",
    "J m-2": "J/m²",
    "N m-1": "N/m",
    "m3 mol-1": "m³/mol",
}
# Units as scenes have them, and as files have them.
_OF_SCENES = {"m^2": "m2", "/m^2": "m-2", "J/m^2": "J/m2", "J m-2": "J/m2", "m^3/mol": "m3 mol-1"}


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
    exponent = min(max(3 * math.floor(math.log10(largest) / 3.0 + 1e-12), -18), 9)
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


def counted(count: int, noun: str) -> str:
    """A number of things.

    Examples
    --------
    >>> counted(1, "patch"), counted(2, "patch"), counted(3, "thread")
    ('1 patch', '2 patches', '3 threads')
    """
    return f"{count} {noun}{'' if count == 1 else 'es' if noun.endswith('ch') else 's'}"


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


@dataclass(frozen=True)
class _Dimension:
    """A dimension: its SI unit as scenes and as pint write it, and the powers of ten of its units."""

    si: str
    of_pint: str
    units: dict[str, int]


# The units of scenes: those of src/scene/units.rs, as tests/data/units.csv says. N/m is also an energy per
# area.
_DIMENSIONS = (
    _Dimension("m", "meter", {"m": 0, "cm": -2, "mm": -3, "um": -6, "nm": -9, "angstrom": -10, "pm": -12}),
    _Dimension("m^2", "meter**2", {"m^2": 0, "cm^2": -4, "mm^2": -6, "um^2": -12, "nm^2": -18}),
    _Dimension("/m^2", "1/meter**2", {"/m^2": 0, "/cm^2": 4, "/mm^2": 6, "/um^2": 12, "/nm^2": 18}),
    _Dimension("Pa", "pascal", {"Pa": 0, "kPa": 3, "MPa": 6, "GPa": 9, "TPa": 12}),
    _Dimension("N/m", "newton/meter", {
        "N/m": 0, "mN/m": -3, "uN/m": -6, "kN/m": 3, "MN/m": 6, "N/mm": 3, "N/um": 6, "nN/nm": 0,
    }),
    _Dimension("J/m^2", "joule/meter**2", {"J/m^2": 0, "mJ/m^2": -3, "uJ/m^2": -6}),
    _Dimension("N", "newton", {"N": 0, "mN": -3, "uN": -6, "nN": -9, "pN": -12, "fN": -15, "kN": 3}),
    _Dimension("J", "joule", {
        "J": 0, "mJ": -3, "uJ": -6, "nJ": -9, "pJ": -12, "fJ": -15, "aJ": -18, "zJ": -21,
    }),
    _Dimension("V", "volt", {"V": 0, "kV": 3, "mV": -3, "uV": -6}),
    _Dimension("K", "kelvin", {"K": 0}),
    _Dimension("rad", "radian", {"rad": 0}),
    _Dimension("m^3/mol", "meter**3/mole", {"m^3/mol": 0, "cm^3/mol": -6, "mm^3/mol": -9}),
)  # fmt: skip
# Characters of other writers, behind Unicode's own forms of compatibility, and what they are here.
_SPELLINGS = {
    "\u03bc": "u",
    "\u00c5": "angstrom",
    "\u2212": "-",
    "\u00b0C": "degC",
    "\u00b0": "deg",
    "\u22c5": " ",
    "\u00b7": " ",
    "**": "^",
    "*": " ",
}
_NUMBER = r"([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eE]([-+]?[0-9]+))?"


@dataclass(frozen=True)
class Unit:
    """A unit of scenes.

    Attributes
    ----------
    si : str
        The SI unit of its dimension, as scenes write it; ``1`` of numbers.
    power : int
        The power of ten of that which it is.
    """

    si: str
    power: int = 0

    def value(self, text: str) -> float:
        """A decimal number in this unit, in SI; rounded once.

        Raises
        ------
        ValueError
            The text is no finite decimal number.
        """
        found = re.fullmatch(_NUMBER, text.strip().replace("\u2212", "-"))
        if found is None:
            raise ValueError(f"{text} is not a number")
        value = float(f"{found[1]}e{int(found[2] or 0) + self.power}")
        if not math.isfinite(value):
            raise ValueError(f"{text} is not finite")
        return value


@dataclass(frozen=True)
class _Celsius(Unit):
    def value(self, text: str) -> float:
        return super().value(text) + 273.15


@dataclass(frozen=True)
class _Degree(Unit):
    def value(self, text: str) -> float:
        return math.radians(super().value(text))


# Units that others write, and what they are in units of scenes.
_OTHERS = {
    "HV": "1 HV is 9.807 MPa", "micron": 'did you mean "um"?', "N/mm^2": 'did you mean "MPa"?',
    "kgf/mm^2": "1 kgf/mm^2 is 9.807 MPa", "erg/cm^2": 'did you mean "mJ/m^2"?', "dyn/cm": 'did you mean "mN/m"?',
}  # fmt: skip
_UNITS = {"": Unit("1"), "%": Unit("1", -2), "degC": _Celsius("K"), "deg": _Degree("rad")}
_UNITS |= {name: Unit(of.si, power) for of in _DIMENSIONS for name, power in of.units.items()}


def unit(written: str) -> Unit:
    """A unit as people write it.

    ``um^-2``, ``µm⁻²``, ``1/um2`` and ``um**-2`` are one, and so are ``mJ/m2`` and ``mJ m^-2``.

    Raises
    ------
    ValueError
        It is no unit of a scene.

    Examples
    --------
    >>> unit("mJ m^-2"), unit("%")
    (Unit(si='J/m^2', power=-3), Unit(si='1', power=-2))
    """
    plain = unicodedata.normalize("NFKC", written.strip())
    for other, own in _SPELLINGS.items():
        plain = plain.replace(other, own)
    sides: tuple[list[str], list[str]] = ([], [])
    for place, part in enumerate(plain.split("/")):
        for factor in part.split():
            found = re.fullmatch(r"([^0-9^-]+)(?:\^?(-?)([0-9]+))?", factor)
            if found is not None:
                power = "" if found[3] in (None, "1") else f"^{found[3]}"
                sides[(place > 0) != bool(found[2])].append(found[1] + power)
            elif place or factor != "1":
                sides[0].append(factor)
    name = " ".join(sides[0]) + "".join(f"/{below}" for below in sides[1])
    if name not in _UNITS or not (name or not plain):
        raise ValueError(f'unknown unit "{written}"; {_meant(name)}')
    return _UNITS[name]


def _meant(name: str) -> str:
    """What was probably meant by a unit that is none: one with other capitals, or what another one is."""
    alike = [f'"{known}"' for known in _UNITS if known and known.lower() == name.lower()]
    if alike:
        return f"did you mean {' or '.join(alike)}?"
    known = ", ".join(of.si for of in _DIMENSIONS)
    return _OTHERS.get(name) or f"scenes have {known}, degC and deg, with the usual prefixes, and %"


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


def split(text: str) -> tuple[str, str]:
    """The decimal number that a text begins with, and the unit behind it; two empty texts where it is none.

    Examples
    --------
    >>> split("9.8 nm"), split("1e3"), split("nm")
    (('9.8', 'nm'), ('1e3', ''), ('', ''))
    """
    found = re.fullmatch(rf"({_NUMBER})\s*(\D.*)?", text.strip().replace("\u2212", "-"))
    return ("", "") if found is None else (found[1], found[4] or "")


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
    >>> parsed("radius", "20 nm"), parsed("density", "8.5 /um^2")
    ((2e-08, 'm'), (8500000000000.0, '/m^2'))
    >>> parsed("humidity", "45 %"), parsed("temperature", "20 degC")
    ((0.45, '1'), (293.15, 'K'))
    """
    number, written = split(pint_text(value) if is_pint(value) else str(value))
    if not number or isinstance(value, bool):
        raise ValueError(
            f'{name} = {value!r}: a number is needed, with its unit if it has one, such as "20 nm"'
        )
    if re.match(r"\s*,\s*[0-9]", written):
        raise ValueError(
            f"{name} = {value!r}: has a decimal comma; a point is needed, and nothing between thousands"
        )
    try:
        of = unit(written)
        return of.value(number), of.si
    except ValueError as error:
        in_scenes = f": {si(9.80665e6 * float(number), 'Pa')}" if "9.807 MPa" in str(error) else ""
        raise ValueError(f"{name} = {value!r}: {error}{in_scenes}") from None


def of_one_dimension(units: Iterable[str]) -> bool:
    """Whether SI units as scenes or files write them are of one dimension; J/m² is N/m."""
    plain = {plain_unit(_OF_SCENES.get(unit, unit)) for unit in units}
    return len({"N/m" if unit == "J/m²" else unit for unit in plain}) <= 1


def is_pint(value: Any) -> bool:
    """Whether a value is a quantity of pint, which need not be installed."""
    return hasattr(value, "magnitude") and hasattr(value, "is_compatible_with")


def pint_text(value: Any) -> str:
    """A scalar pint quantity as scenes write it, in its SI unit.

    Raises
    ------
    ValueError
        Scenes have no quantity of that dimension.
    """
    number, unit = _of_pint(value)
    return repr(float(number)) if unit == "1" else f"{float(number)!r} {unit}"


def _of_pint(value: Any) -> tuple[Any, str]:
    """Numbers of a pint quantity in SI units, and that unit as scenes write it."""
    if value.is_compatible_with("dimensionless"):
        # An angle is a number for pint, with a unit all the same.
        unit = "rad" if str(value.to_base_units().units) == "radian" else "1"
        return value.to("radian" if unit == "rad" else "dimensionless").magnitude, unit
    for of in _DIMENSIONS:
        if value.is_compatible_with(of.of_pint):
            return value.to(of.of_pint).magnitude, of.si
    known = ", ".join(of.si for of in _DIMENSIONS)
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
    unit : str
        An SI unit as scenes write it, such as ``m``, ``Pa``, ``J/m^2``.

    Raises
    ------
    ValueError
        A text is not a number with such a unit, or a quantity has another dimension.

    Examples
    --------
    >>> in_si("radius", "20 nm", "m"), in_si("work_of_adhesion", "50 mJ/m^2", "J/m^2")
    (2e-08, 0.05)
    """
    if isinstance(value, list | tuple) and any(isinstance(one, str) or is_pint(one) for one in value):
        return np.array([in_si(name, one, unit) for one in value])
    if is_pint(value):
        number, own = _of_pint(value)
    elif isinstance(value, str):
        number, own = parsed(name, value)
    else:
        return value
    if not of_one_dimension([own, unit]):
        such = {"m": "nm"}.get(unit, unit)
        given = repr(value) if isinstance(value, str) else value
        raise ValueError(f"{name} = {given}: a number with a unit such as {such} is needed")
    return number
