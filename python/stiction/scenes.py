"""Scenes as Python has them: a path, or the tables as a dict, with single keys set."""

from __future__ import annotations

import hashlib
import json
import math
import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

import h5py
import numpy as np

from . import files, quantities
from .errors import SceneError
from .results import Asperities

__all__ = ["Scene", "Source", "named_files", "setting", "toml"]

#: A scene: the path of its TOML file, or its tables.
Scene = str | Path | Mapping[str, Any]


class Source:
    """A scene as the program takes it: its arguments on the command line, and standard input.

    Arrays of heights or radii go into an HDF5 file that the scene names: next to the output of that name, or in a folder that is
    deleted with the source where the result has no name either.
    """

    def __init__(self, scene: Scene, overrides: Mapping[str, Any], output: Path | None) -> None:
        self._folder: files.Folder | None = None
        self._output = output
        self.text = ""
        if isinstance(scene, Mapping):
            name = "-"
            self.text = toml(self._named(scene))
        elif isinstance(scene, str | Path):
            if not Path(scene).is_file():
                raise SceneError(
                    f"{scene}: no such file; a scene is the path of a TOML file, or a dict of its tables"
                )
            name = str(scene)
        else:
            raise SceneError(
                f"a scene is the path of a TOML file, or a dict of its tables, not {type(scene).__name__}"
            )
        self.arguments = [name]
        for key, value in overrides.items():
            if "." not in key:
                raise SceneError(
                    f"{key}: not a key of scenes, which are named with their table: material.{key}?"
                )
            table, last = key.rsplit(".", 1)
            self.arguments += [
                "--set",
                f"{key}={_value(self._file(table.split('.')[-1] if last == 'path' else last, value))}",
            ]

    def __enter__(self) -> Source:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._folder is not None:
            self._folder.delete()

    def _named(self, scene: Mapping[str, Any]) -> dict[str, Any]:
        """The tables with files in the place of arrays."""
        tables: dict[str, Any] = {"format": 1, **scene}
        surface = tables.get("surface")
        if isinstance(surface, Mapping):
            tables["surface"] = {key: self._file(key, value) for key, value in surface.items()}
        return tables

    def _file(self, key: str, value: Any) -> Any:
        """The value of a key, with files in the place of arrays and results."""
        if key == "asperities":
            if isinstance(value, Asperities):
                return {"path": str(value.path.resolve())}
            if isinstance(value, Mapping) and isinstance(value.get("path"), Asperities):
                return {**value, "path": str(value["path"].path.resolve())}
        if key in ("heights", "radii") and not isinstance(value, str | Mapping):
            try:
                lengths = quantities.reals(key, quantities.in_si(key, value, "m"))
            except ValueError as error:
                raise SceneError(f"surface.{error}") from None
            if lengths.ndim != 1 or lengths.size == 0 or not np.isfinite(lengths).all():
                raise SceneError(f"surface.{key}: an array of one dimension of finite lengths in m is needed")
            return {"law": "file", "path": self._written(key, lengths), "dataset": key, "unit": "m"}
        return value

    def _written(self, key: str, values: np.ndarray[Any, np.dtype[np.float64]]) -> str:
        """The path of an HDF5 file that has the values as a dataset; equal values have equal names."""
        if self._output is None:
            self._folder = self._folder or files.Folder()
            folder, stem = self._folder.path, "scene"
        else:
            folder, stem = self._output.resolve().parent, self._output.stem
        path = folder / f"{stem}.{key}-{hashlib.sha256(values.tobytes()).hexdigest()[:12]}.h5"
        with files.writing_hdf5(path, force=True) as part, h5py.File(part, "w") as file:
            file[key] = values
        return str(path)


def named_files(scene: Scene) -> list[Path]:
    """The files that a scene is made from: its own and those that it names, as far as it can be read."""
    if isinstance(scene, Mapping):
        return [Path(name) for name in paths_in(scene)]
    path = Path(scene)
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return [path]
    return [path, *(path.parent / name for name in paths_in(tables))]


def paths_in(tables: Any) -> list[str]:
    """The files that tables of a scene name, as they name them."""
    if isinstance(tables, Mapping):
        here = [str(value) for key, value in tables.items() if key == "path" and isinstance(value, str | Path)]
        return here + [name for value in tables.values() for name in paths_in(value)]
    return [name for value in tables for name in paths_in(value)] if isinstance(tables, list) else []


def setting(text: str) -> tuple[str, Any]:
    """A key and its value from ``KEY=VALUE`` of a command line: TOML, or a text without quotation marks.

    Raises
    ------
    SceneError
        There is no value.
    """
    key, sign, value = text.partition("=")
    if not sign:
        raise SceneError(f"--set {text}: KEY=VALUE is needed, such as material.work_of_adhesion='0.1 J/m^2'")
    try:
        return key.strip(), tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return key.strip(), value


def toml(tables: Mapping[str, Any]) -> str:
    """The TOML text of a scene.

    Parameters
    ----------
    tables : mapping
        Tables by their names, with texts, numbers, truth values, lists, dicts, NumPy scalars and arrays, pint quantities.

    Raises
    ------
    SceneError
        A value is of another type.

    Examples
    --------
    >>> print(toml({"format": 1, "model": {"law": "hybrid"}, "sweep": {"material.hardness": ["1 GPa", "2 GPa"]}}), end="")
    format = 1
    <BLANKLINE>
    [model]
    law = "hybrid"
    <BLANKLINE>
    [sweep]
    "material.hardness" = ["1 GPa", "2 GPa"]
    """
    return "\n".join(_tables(tables)) + "\n"


def _tables(tables: Mapping[str, Any]) -> Iterator[str]:
    for key, value in tables.items():
        if not isinstance(value, Mapping):
            yield f"{_key(key)} = {_value(value, key)}"
    for name, table in tables.items():
        if isinstance(table, Mapping):
            yield f"\n[{_key(name)}]"
            yield from (f"{_key(key)} = {_value(value, f'{name}.{key}')}" for key, value in table.items())


def _key(key: Any) -> str:
    if not isinstance(key, str):
        raise SceneError(f"{key!r}: the name of a key or table is a text, not a {type(key).__name__}")
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _text(key, "the name of a key")


def _value(value: Any, name: str = "value") -> str:
    """A value as TOML writes it in a line."""
    try:
        return _written(value, name)
    except RecursionError:
        raise SceneError(f"{name.split('.')[0]}: a table or list in it holds itself") from None


def _written(value: Any, name: str) -> str:
    if hasattr(value, "tolist") and not quantities.is_pint(value):
        value = value.tolist()
    match value:
        case bool():
            return "true" if value else "false"
        case str() | Path():
            return _text(str(value), name)
        case int():
            return str(value)
        case float():
            return {"inf": "inf", "-inf": "-inf", "nan": "nan"}.get(str(value), repr(value))
        case Mapping():
            return (
                "{ "
                + ", ".join(f"{_key(key)} = {_written(one, f'{name}.{key}')}" for key, one in value.items())
                + " }"
            )
        case list() | tuple():
            return "[" + ", ".join(_written(one, name) for one in value) + "]"
    if quantities.is_pint(value):
        if np.ndim(value.magnitude):
            return _written(list(value), name)
        try:
            text = quantities.pint_text(value)
        except ValueError as error:
            raise SceneError(f"{name} = {error}") from None
        return text if _is_number(text) else json.dumps(text)
    raise SceneError(
        f"{name} is a {type(value).__name__}: a text, number, list, dict, array or pint quantity is needed"
    )


def _text(text: str, name: str) -> str:
    try:
        text.encode()
    except UnicodeEncodeError:
        raise SceneError(f"{name} = {text!r}: half of a surrogate pair is no character") from None
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
