"""Pull-offs of recorded force curves: the files by afmformats, baselines and contact points by nanite."""

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

from .. import progress, quantities
from ..errors import FileError, SceneError, StictionError

__all__ = ["SLOPES", "pull_offs", "written"]

#: What a baseline's slope is taken to follow, and is subtracted by: the height over the surface, the time, or nothing.
SLOPES = ("shift", "drift", "none")
# The part of the approach that nanite takes for baseline to find the contact, and the factor of the largest deviation there that is a force.
_BASELINE, _SEEN = 0.1, 2.0
_COLUMNS = ["file", "curve", "pull_off_force", "resolution", "spring_constant", "position_x", "position_y"]


def pull_offs(path: str | Path, *, slope: str = "shift", spring_constant: Any = None) -> pd.DataFrame:
    """The pull-off force of each force curve in a file or folder.

    afmformats reads the files (JPK, Asylum, NT-MDT, AFM workshop and others). nanite corrects each curve: tip position by the deflection, contact
    point, slope and offset of the baseline. The pull-off is minus the lowest force on retraction.

    Parameters
    ----------
    path : path
        A file, or a folder, which is searched with its subfolders.
    slope : {"shift", "drift", "none"}
        What the slope of the baseline follows: the height over the surface, the time, or nothing, and then none is subtracted.
    spring_constant : str or float, optional
        Of the cantilever, such as ``"40 N/m"``, or N/m, for files that do not say it.

    Returns
    -------
    pandas.DataFrame
        A row for each curve: `file`; `curve`, its number in the file from 0; `pull_off_force` (N), NaN without a retraction;
        `resolution` (N), twice the largest deviation of the first tenth of the approach from the baseline, below which nothing is seen;
        `spring_constant` (N/m), `position_x` and `position_y` (m), NaN where the file does not say them. ``attrs["left_out"]`` has the
        files of a folder that are no force curves.

    Raises
    ------
    FileError
        There is no such file, no force curve in it, or it cannot be read or corrected; the message names it and what would do.
    SceneError
        An argument is wrong.
    StictionError
        The libraries are not installed.

    References
    ----------
    P. Müller et al., BMC Bioinformatics 20 (2019) 465, doi:10.1186/s12859-019-3010-3 (nanite).
    """
    if slope not in SLOPES:
        raise SceneError(f"slope = {slope}: one of {', '.join(SLOPES)} is needed")
    override = {} if spring_constant is None else {"spring constant": _stiffness(spring_constant)}
    path, libraries = Path(path), _libraries()
    found, left_out = _files(path, libraries)
    curves = [(name, curve) for name in found for curve in _curves(name, override, libraries)]
    rows = [_row(curve, name, slope, path, libraries) for name, curve in progress.steps(curves, "", "curves")]
    table = pd.DataFrame(rows, columns=_COLUMNS)
    table.attrs["left_out"] = left_out
    return table


def written(table: pd.DataFrame) -> str:
    """A table of pull-offs as CSV for `stiction infer`: nN, N/m and µm. A pull-off that cannot be seen is an upper limit, an unknown number an empty cell."""

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
    })  # fmt: skip
    # Of what no curve knows there is no column.
    known = cells.dropna(axis="columns", how="all")
    return str(known.to_csv(index=False, float_format="%.6g"))


def _libraries() -> tuple[Any, Any]:
    """afmformats and nanite."""
    try:
        import afmformats
        import nanite.read
    except ModuleNotFoundError as error:
        raise StictionError(f"{error.name} is not installed: pip install 'stiction[afm]' brings it", 2) from None
    return afmformats, nanite


def _stiffness(given: Any) -> float:
    try:
        value = float(quantities.in_si("spring_constant", given, "N/m"))
    except ValueError as error:
        raise SceneError(str(error)) from None
    if not (math.isfinite(value) and value > 0.0):
        raise SceneError(f"spring_constant = {given}: one greater than 0 is needed, such as 40 N/m")
    return value


def _files(path: Path, libraries: tuple[Any, Any]) -> tuple[list[Path], list[Path]]:
    """The files with force curves, and the others of a folder."""
    afmformats, _ = libraries
    if not path.exists():
        raise FileError(f"{path}: no such file or folder")
    every = sorted(one for one in path.rglob("*") if one.is_file()) if path.is_dir() else [path]
    with _quiet():
        found = [one for one in every if afmformats.find_data(one, modality="force-distance")]
    if not found:
        known = ", ".join(afmformats.formats.supported_extensions)
        where = "no file in it has force curves" if path.is_dir() else "has no force curves"
        raise FileError(f"{path}: {where} in a format that afmformats reads ({known}); export it in one of these")
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
def _named(path: Path, what: str, advice: str, libraries: tuple[Any, Any]) -> Iterator[None]:
    """Errors of the libraries, some of which are no `Exception`, as a `FileError` that names the file."""
    afmformats, _ = libraries
    own = (afmformats.errors.AFMFileFormatError, afmformats.errors.MissingMetaDataError, afmformats.meta.MetaDataMissingError)
    try:
        with _quiet():
            yield
    except (Exception, *own) as error:
        missing = [*getattr(error, "meta_keys", []), *str(error).split("'")]
        if "sensitivity" in missing:
            advice = "calibrate it with the program of the instrument"
        elif "spring constant" in missing and not isinstance(error, NotImplementedError):
            advice = 'give the spring constant, such as "40 N/m"'
        said = " ".join(str(error).split()) or type(error).__name__
        raise FileError(f"{path}: {what} ({said}); {advice}") from None


def _curves(path: Path, override: dict[str, float], libraries: tuple[Any, Any]) -> list[Any]:
    """The curves of a file, in its order."""
    _, nanite = libraries
    with _named(path, "cannot be read", "take it out, or export it again" if not override else "leave the spring constant out, or export it again", libraries):
        curves = sorted(nanite.read.load_data(path, meta_override=override or None), key=lambda curve: curve.enum)
    if not curves:
        raise FileError(f"{path}: has no force curve; take it out")
    return curves


def _row(curve: Any, path: Path, slope: str, of: Path, libraries: tuple[Any, Any]) -> list[Any]:
    """The numbers of a curve in the order of the columns."""
    steps, options = ["correct_force_offset"], {}
    if slope != "none":
        steps = ["compute_tip_position", "correct_tip_offset", "correct_force_slope", *steps]
        # This method does not take a slope for a contact.
        options = {"correct_tip_offset": {"method": "fit_line_polynomial"}, "correct_force_slope": {"region": "all", "strategy": slope}}
    with _named(path, f"curve {curve.enum}: cannot be corrected", 'with slope none it needs the force alone', libraries):
        back = int(np.count_nonzero(curve["segment"] == 1))
        place = {name: float(curve.metadata.get(name, math.nan)) for name in ("spring constant", "position x", "position y")}
        pull_off = resolution = math.nan
        if back:
            curve.apply_preprocessing(steps, options=options)
            baseline = np.asarray(curve.appr["force"])[: max(1, int(_BASELINE * len(curve.appr["force"])))]
            resolution = _SEEN * float(np.abs(baseline).max())
            pull_off = -float(np.min(curve.retr["force"]))
    name = str(path.relative_to(of)) if of.is_dir() else path.name
    return [name, curve.enum, pull_off, resolution, *place.values()]
