"""Lengths as people write them: units with any code point, pixels, factors of heights."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import quantities
from ..errors import SceneError

__all__ = ["PIXELS", "Factor", "Steps", "factor", "length", "metres", "pixel_size", "power_of_ten"]

_SYMBOLS = {"f": -15, "p": -12, "n": -9, "u": -6, "\u03bc": -6, "~": -6, "m": -3, "c": -2, "": 0, "k": 3}
_WORDS = {"femto": -15, "pico": -12, "nano": -9, "micro": -6, "milli": -3, "centi": -2, "": 0, "kilo": 3}
_ANGSTROM = {"\u00e5", "angstrom", "\u00e5ngstr\u00f6m"}
#: Smallest and largest size of a pixel, m, that a map may have.
PIXELS = (1e-13, 1e3)
# Relative difference from which on a pixel is another one than the steps of a file.
_OTHER = 0.01


@dataclass
class Factor:
    """What the numbers of a map are multiplied by: `per` is the unit that they then no longer have."""

    scale: float
    is_length: bool = False
    per: str | None = None


@dataclass
class Steps:
    """Steps of the places of a file along the width and the height of a pixel.

    `unit` is m, or one that is none of length, and `off` by which relative part the ratio of the steps may be wrong.
    """

    width: float
    height: float
    unit: str | None = None
    off: float = 0.0

    def refuse_single(self, given: Any, size: tuple[float, float]) -> None:
        """Refuses a pixel of a size, m, that is given as a single number, where the steps are not square.

        Raises
        ------
        SceneError
            It has the pixel that would do.
        """
        ratio = self.height / self.width
        single = (
            "," not in given if isinstance(given, str) else np.size(getattr(given, "magnitude", given)) == 1
        )
        if not single or abs(ratio - 1.0) <= _OTHER + self.off:
            return
        along = size[0] / ratio if self._is(size[0], self.height) else size[0]
        sizes, steps = (along, along * ratio), [f"{step:g}" for step in (self.width, self.height)]
        advice = "give"
        if self.unit == "m":
            sizes, steps = (
                (self.width, self.height),
                [quantities.si(one, "m") for one in (self.width, self.height)],
            )
            advice = "leave pixel (--pixel) out, or give"
        shown = ",".join(f"{1e9 * one:.6g} nm" for one in sizes)
        raise SceneError(
            f"its places have steps of {steps[0]} along x and {steps[1]} along y, and a single pixel is square; "
            f'{advice} pixel="{shown}", which is of such pixels, width and height'
        )

    def disagreement(self, size: tuple[float, float]) -> str | None:
        """What is wrong with a pixel of a size, m; None if nothing is, or steps only count."""
        ratio, tolerance = self.height / self.width, _OTHER + self.off
        is_known = self._is(size[0], self.width) and self._is(size[1], self.height)
        if self.unit or self.width == self.height == 1.0:
            return None
        if is_known and abs(size[1] / size[0] / ratio - 1.0) <= tolerance:
            return None
        steps = " and ".join(
            f"{step:.4g} along {axis}" for axis, step in zip("xy", (self.width, self.height), strict=True)
        )
        shown = " x ".join(quantities.si(one, "m") for one in size)
        return (
            f"pixel is {shown}, and places have {'mean ' if self.off else ''}steps of {steps}, which no unit makes "
            "so large: taken as pixel says"
        )

    def _is(self, size: float, step: float) -> bool:
        """Whether a size, m, is a step in a unit of length."""
        powers = {*_SYMBOLS.values(), -10}
        return any(abs(size / (step * float(f"1e{power}")) - 1.0) <= _OTHER + self.off for power in powers)


def power_of_ten(unit: str) -> int | None:
    """The power of ten of m that a unit of length is; None if it is none.

    Examples
    --------
    >>> [power_of_ten(unit) for unit in ("nm", "\u00b5m", "\u03bcm", "[um]", "Micrometers", "\u212b", "V")]
    [-9, -6, -6, -6, -6, -10, None]
    """
    # One code point for the micro sign and the Greek letter, and one for the angstrom sign and the letter.
    plain = unicodedata.normalize("NFKC", unit).strip().strip("[]()").strip()
    if plain[-1:] == "m" and plain[:-1] in _SYMBOLS:
        return _SYMBOLS[plain[:-1]]
    word = re.sub(r"[\s_]", "", plain).lower()
    singular = word.removesuffix("s")
    if singular in _ANGSTROM:
        return -10
    if singular == "micron":
        return -6
    for ending in ("meter", "metre"):
        if singular.endswith(ending):
            return _WORDS.get(singular.removesuffix(ending))
    return None


def metres(unit: str) -> float | None:
    """A unit of length in m; None if it is none.

    Examples
    --------
    >>> metres("nanometer"), metres("deg")
    (1e-09, None)
    """
    power = power_of_ten(unit)
    return None if power is None else float(f"1e{power}")


def length(name: str, value: Any) -> float:
    """A length in m from a number in m, a text with its unit, or a pint quantity.

    Raises
    ------
    SceneError
        It is no length; the message begins with `name`.

    Examples
    --------
    >>> length("pixel", "9.8 nm"), length("pixel", 1e-8)
    (9.8e-09, 1e-08)
    """
    try:
        if isinstance(value, str):
            number, unit = quantities.split(value)
            power = power_of_ten(unit)
            if power is None:
                raise SceneError(f'{name} = {value!r}: a length with its unit is needed, such as "10 nm"')
            return quantities.Unit("m", power).value(number)
        return float(np.asarray(quantities.in_si(name, value, "m"), dtype=float).item())
    except (TypeError, ValueError) as error:
        said = str(error) if str(error).startswith(name) else f"{name} = {value!r}: a length in m is needed"
        raise SceneError(said) from None


def pixel_size(value: Any) -> tuple[float, float]:
    """Width and height of a pixel, m.

    Parameters
    ----------
    value : float, str, pint.Quantity, or one or two of them as a list, tuple or array
        A width, or a width and a height: numbers in m, or texts with a unit, as ``"10 nm"`` and
        ``"10 nm, 12 nm"``.

    Raises
    ------
    SceneError
        It is neither one length nor two, or no size that pixels have.

    Examples
    --------
    >>> pixel_size("10 nm"), pixel_size("10 nm,12 nm"), pixel_size([1e-8, 2e-8])
    ((1e-08, 1e-08), (1e-08, 1.2e-08), (1e-08, 2e-08))
    """
    if isinstance(value, np.ndarray) and value.dtype.kind in "OSU":
        value = value.ravel().tolist()
    if isinstance(value, str):
        if found := re.fullmatch(r"\s*(\d+),(\d+(?:[eE][-+]?\d+)?\s*[^\W\d]+)\s*", value):
            raise SceneError(
                f"pixel = {value!r}: a comma is between width and height, each with its unit; of a decimal comma make "
                f'a point: "{found[1]}.{found[2]}"'
            )
        sizes = [length("pixel", one) for one in value.split(",")]
    elif isinstance(value, list | tuple):
        sizes = [length("pixel", one) for one in value]
    else:
        try:
            inside = np.ravel(np.asarray(quantities.in_si("pixel", value, "m"), dtype=float))
        except (TypeError, ValueError) as error:
            said = str(error)
            raise SceneError(said if said.startswith("pixel") else f"pixel = {value!r}: no length") from None
        sizes = [float(one) for one in inside]
    if len(sizes) not in (1, 2):
        raise SceneError(f"pixel = {value!r}: a width, or a width and a height, is needed")
    for size in sizes:
        if not PIXELS[0] <= size <= PIXELS[1]:
            raise SceneError(
                f"pixel = {value!r}: a pixel is between {PIXELS[0]:g} and {PIXELS[1]:g} m; numbers are in m, "
                'a text has its unit, such as "10 nm"'
            )
    return sizes[0], sizes[-1]


def factor(value: Any) -> Factor:
    """What `factor` says: a number, a length such as ``"0.5 nm"``, or one per unit such as ``"0.5 nm/V"``.

    Raises
    ------
    SceneError
        It is none of these, or not finite, or 0.

    Examples
    --------
    >>> factor("0.5 nm/V")
    Factor(scale=5e-10, is_length=True, per='V')
    """
    if quantities.is_pint(value):
        found = _of_pint(value)
    elif isinstance(value, str):
        written, slash, per = value.partition("/")
        number, unit = quantities.split(written)
        is_plain = bool(number) and not unit and not slash
        found = Factor(float(number)) if is_plain else Factor(length("factor", written), True)
        found.per = per.strip() or None
    else:
        try:
            found = Factor(float(value))
        except (TypeError, ValueError):
            raise SceneError(
                f'factor = {value!r}: a number is needed, or a text such as "0.5 nm/V"'
            ) from None
    if not np.isfinite(found.scale) or found.scale == 0.0:
        raise SceneError(f"factor = {value!r}: a finite number other than 0 is needed")
    return found


def _of_pint(value: Any) -> Factor:
    for unit, is_length, per in (("", False, None), ("meter", True, None), ("meter/volt", True, "V")):
        if value.is_compatible_with(unit or "dimensionless"):
            return Factor(float(value.to(unit or "dimensionless").magnitude), is_length, per)
    raise SceneError(f"factor = {value}: a length is needed, or a length per volt")
