"""Pull-offs of recorded force curves, of the files that afmformats reads."""

from __future__ import annotations

import logging
import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from .. import progress, quantities
from ..errors import FileError, SceneError, StictionError
from .baseline import PullOff, pull_off

__all__ = ["SLOPES", "listed", "pull_offs", "remarks", "written"]

Array = NDArray[np.float64]
#: What a baseline's slope is taken to follow, and is subtracted by: the height over the surface, the time, or nothing.
SLOPES = ("shift", "drift", "none")
_FOLLOWS = {"shift": "height", "drift": "time"}
_APPROACH, _RETRACTION = 0, 1
# Asylum's directions of the piezo, with the numbers that afmformats has for them; in others it rests.
_DIRECTIONS = {1.0: _APPROACH, -1.0: _RETRACTION}
# Names of files and curves that a message has.
_MOST = 5
_PLACE = ("spring constant", "position x", "position y")
_COLUMNS = [
    "file",
    "curve",
    "pull_off_force",
    "resolution",
    "spring_constant",
    "position_x",
    "position_y",
    "remark",
]


def pull_offs(path: str | Path, *, slope: str = "shift", spring_constant: Any = None) -> pd.DataFrame:
    """The pull-off force of each force curve in a file or folder.

    afmformats reads the files (JPK, Asylum, NT-MDT, AFM workshop and others). The pull-off is the lowest force on
    retraction under the baseline of the retraction, a line through its outer half or less: in a liquid the
    baseline of the approach is higher by twice the drag.

    Parameters
    ----------
    path : path
        A file, or a folder, which is searched with its subfolders.
    slope : {"shift", "drift", "none"}
        What the slope of the baseline follows: the height over the surface, the time, or nothing, and then none is
        subtracted. The baseline of the approach has to have the same slope.
    spring_constant : str or float, optional
        Of the cantilever, such as ``"40 N/m"``, or N/m, for files that do not say it.

    Returns
    -------
    pandas.DataFrame
        A row for each curve: `file`; `curve`, its number in the file from 0; `pull_off_force` (N); `resolution` (N),
        below which nothing is seen: twice the largest deviation of the baseline, as much again for each length that
        it is continued by, and twice what the slope of the approach would change; `spring_constant` (N/m),
        `position_x` and `position_y` (m), NaN where the file does not say them; `remark`. A curve or file that gives
        no number has NaN, and the reason in `remark`, which also names different slopes of approach and retraction.
        ``attrs["left_out"]`` has the files of a folder that are no force curves.

    Raises
    ------
    FileError
        There is no such file, no force curve in it, or none gives a number; the message names one, the reason and
        what would do.
    SceneError
        An argument is wrong.
    StictionError
        The libraries are not installed.
    """
    if slope not in SLOPES:
        raise SceneError(f"slope = {slope}: one of {', '.join(SLOPES)} is needed")
    override = {} if spring_constant is None else {"spring constant": _stiffness(spring_constant)}
    path, library = Path(path), _library()
    found, left_out = _files(path, library)
    curves = [(one, curve) for one in progress.steps(found, "reading", "files") for curve in _curves(one, override, library)]
    rows = []
    for one, curve in progress.steps(curves, "pull-offs", "curves"):
        name = str(one.relative_to(path)) if path.is_dir() else path.name
        rows.append([name, *_row(curve, slope, library)])
    table = pd.DataFrame(rows, columns=_COLUMNS).astype({"curve": "Int64"})
    if table["pull_off_force"].isna().all():
        others = f"; {len(table)} curves and files give no number" if len(table) > 1 else ""
        raise FileError(remarks(table.assign(file=[str(one) for one, _ in curves])[:1])[0] + others)
    table.attrs["left_out"] = left_out
    return table


def remarks(table: pd.DataFrame) -> list[str]:
    """The remarks of a table of pull-offs, each with the curves and files that have it."""
    where = table["file"] + ["" if pd.isna(curve) else f" curve {curve}" for curve in table["curve"]]
    kinds = table["remark"].where(table["remark"] != "")
    return [f"{listed(list(those))}: {remark}" for remark, those in where.groupby(kinds, sort=False)]


def listed(names: list[str]) -> str:
    """Names, of many the first."""
    more = len(names) - _MOST
    return "; ".join(names[:_MOST]) + (f" and {more} more" if more > 0 else "")


def written(table: pd.DataFrame) -> str:
    """A table of pull-offs as CSV for `stiction infer`: nN, N/m and µm. A pull-off that cannot be seen is an upper
    limit, an unknown number an empty cell."""

    def force(row: Any) -> str:
        if math.isnan(row.pull_off_force):
            return ""
        seen = row.pull_off_force > row.resolution
        return f"{1e9 * row.pull_off_force:.6g}" if seen else f"<{1e9 * row.resolution:.6g}"

    cells = pd.DataFrame({
        "file": table["file"],
        "curve": table["curve"],
        "pull_off_force (nN)": [force(row) for row in table.itertuples()],
        "spring_constant (N/m)": table["spring_constant"],
        "position_x (um)": 1e6 * table["position_x"],
        "position_y (um)": 1e6 * table["position_y"],
        "remark": table["remark"].where(table["remark"] != ""),
    })  # fmt: skip
    # Of what no curve knows there is no column.
    known = cells.dropna(axis="columns", how="all")
    return str(known.to_csv(index=False, float_format="%.6g"))


def _library() -> Any:
    try:
        import afmformats
    except ModuleNotFoundError as error:
        raise StictionError(
            f"{error.name} is not installed: pip install 'stiction[afm]' brings it", 2
        ) from None
    return afmformats


def _stiffness(given: Any) -> float:
    try:
        value = float(quantities.in_si("spring_constant", given, "N/m"))
    except ValueError as error:
        raise SceneError(str(error)) from None
    if not (math.isfinite(value) and value > 0.0):
        raise SceneError(f"spring_constant = {given}: one greater than 0 is needed, such as 40 N/m")
    return value


def _files(path: Path, library: Any) -> tuple[list[Path], list[Path]]:
    """The files with force curves, and the others of a folder."""
    if not path.exists():
        raise FileError(f"{path}: no such file or folder")
    every = sorted(one for one in path.rglob("*") if one.is_file()) if path.is_dir() else [path]
    with _quiet():
        found = [one for one in every if library.find_data(one)]
    if not found:
        known = ", ".join(library.formats.supported_extensions)
        where = "no file in it has force curves" if path.is_dir() else "has no force curves"
        raise FileError(
            f"{path}: {where} in a format that afmformats reads ({known}); export it in one of these"
        )
    return found, sorted({*every} - {*found})


@contextmanager
def _quiet() -> Iterator[None]:
    """No warnings and records of the libraries; errors say what is wrong."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(before)


@contextmanager
def _explained(advice: str, library: Any) -> Iterator[None]:
    """Errors of the library, some of which are no `Exception`, as a `FileError` without the name of the file."""
    own = (
        library.errors.AFMFileFormatError,
        library.errors.MissingMetaDataError,
        library.meta.MetaDataMissingError,
    )
    try:
        with _quiet():
            yield
    except FileError:
        raise
    except (Exception, *own) as error:
        missing = [*getattr(error, "meta_keys", []), *str(error).split("'")]
        if "sensitivity" in missing:
            advice = "calibrate it with the program of the instrument"
        elif "spring constant" in missing and not isinstance(error, NotImplementedError):
            advice = 'give the spring constant, such as "40 N/m"'
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FileError(f"cannot be read ({reason}); {advice}") from None


def _curves(path: Path, override: dict[str, float], library: Any) -> list[Any]:
    """The curves of a file, in its order, or an error in their place."""
    advice = "leave the spring constant out, or export it again" if override else "export it again"
    try:
        with _explained(advice, library):
            curves = sorted(
                library.load_data(path, meta_override=override or None), key=lambda curve: curve.enum
            )
            if path.suffix == ".ibw":
                for curve in curves:
                    curve["segment"] = _directions(path, len(curve))
    except FileError as error:
        return [error]
    return curves or [FileError("has no force curve")]


def _directions(path: Path, count: int) -> NDArray[np.uint8]:
    """The segments of an Asylum file by its note: afmformats calls all samples approach."""
    from igor2 import binarywave

    lines = binarywave.load(path)["wave"]["note"].decode("latin-1").split("\r")
    note = {name: text.rstrip(", ").split(",") for name, _, text in (line.partition(":") for line in lines)}
    segments = np.full(count, _APPROACH, dtype=np.uint8)
    # A direction is that of the samples from the index before on.
    for begin, direction in zip(note.get("Indexes", []), note.get("Direction", [])[1:], strict=False):
        segments[int(float(begin)) :] = _DIRECTIONS.get(float(direction), _RETRACTION + 1)
    return segments


def _row(curve: Any, slope: str, library: Any) -> list[Any]:
    """What the table has of a curve, or of an error in its place, behind the name of the file."""
    if isinstance(curve, FileError):
        return [pd.NA, math.nan, math.nan, *(math.nan for _ in _PLACE), str(curve)]
    place = [float(curve.metadata.get(name, math.nan)) for name in _PLACE]
    try:
        with _explained("export it again", library):
            found = _pull_off(curve, slope)
            remark = _mismatch(curve, slope, found)
    except FileError as error:
        return [curve.enum, math.nan, math.nan, *place, str(error)]
    return [curve.enum, found.force, found.resolution, *place, remark]


def _pull_off(curve: Any, slope: str) -> PullOff:
    force, segment = np.asarray(curve["force"], float), np.asarray(curve["segment"])
    if segment.max() > _RETRACTION:
        raise FileError("has a pause between approach and retraction; pull-offs of such are not measured")
    if segment.max() < _RETRACTION:
        raise FileError("has no retraction")
    both = np.array([_abscissa(curve, force, slope), force])
    if not np.isfinite(both).all():
        raise FileError("has samples that are no numbers; export it again")
    ways = (both[:, segment == way] for way in (_APPROACH, _RETRACTION))
    return pull_off(*ways, is_sloped=slope != "none")


def _abscissa(curve: Any, force: Array, slope: str) -> Array:
    """What the slope of the baseline follows: the height of the tip, the time, or just the samples."""
    if slope == "none":
        return np.arange(force.size, dtype=float)
    known = ["time"] if slope == "drift" else ["tip position", "height (measured)", "height (piezo)"]
    name = next((one for one in known if one in curve), None)
    if name is None:
        raise FileError(f"has no {_FOLLOWS[slope]}, which slope {slope} needs; take slope none")
    values = np.asarray(curve[name], float)
    if not name.startswith("height"):
        return values
    if "spring constant" not in curve.metadata:
        raise FileError('has no spring constant; give it, such as "40 N/m", or take slope none')
    return values + force / float(curve.metadata["spring constant"])


def _mismatch(curve: Any, slope: str, found: PullOff) -> str:
    """The remark on slopes that differ by more than noise; an error where they hide the pull-off."""
    if found.mismatch <= found.noise:
        return ""
    others = [other for other in SLOPES[:2] if other != slope and _fits(curve, other)]
    advice = f"; slope {' or '.join(others)} fits" if others else ""
    if slope == "none":
        remark = f"has a baseline with a slope{advice}"
    else:
        remark = (
            f"baselines of approach and retraction differ in their slope over the {_FOLLOWS[slope]}{advice}"
        )
    if found.force <= found.resolution:
        raise FileError(remark)
    return remark


def _fits(curve: Any, slope: str) -> bool:
    try:
        found = _pull_off(curve, slope)
    except FileError:
        return False
    return found.mismatch <= found.noise
