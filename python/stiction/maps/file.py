"""The asperities of a measured surface in their file: docs/asperity-file.md."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .. import files
from ..version import __version__
from .layout import FORMAT, VARIABLES, VERSION
from .spectrum import Equivalent
from .summits import Measured
from .surface import Surface

__all__ = ["write"]

# Most numbers of a chunk, and most rows and columns of a chunk of a map.
_CHUNK, _MAP_CHUNK = 1 << 17, 256


def write(
    path: Path, surface: Surface, height_unit: str, *, force: bool, inputs: Iterable[str | Path]
) -> None:
    """Writes the file, as a whole or not at all.

    Parameters
    ----------
    path : path
        The file.
    surface : Surface
        What was found.
    height_unit : str
        What was said of the unit of the heights; empty where the map says its unit.
    force : bool
        Whether an existing file is overwritten.
    inputs : iterable of paths
        Files that are never overwritten.
    """
    with files.writing_hdf5(path, force=force, inputs=inputs) as part, h5py.File(part, "w") as file:
        for name, value in _attributes(surface, height_unit).items():
            file.attrs[name] = value
        _scales(file, surface)
        for group, values in _values(surface).items():
            for name, one in values.items():
                _dataset(file, f"{group}/{name}", one)


def _attributes(surface: Surface, height_unit: str) -> dict[str, Any]:
    steps, map = surface.steps, surface.map
    width, height = surface.grid.pixel
    return {
        "format": FORMAT,
        "format_version": np.array(VERSION, dtype=np.uint32),
        "program_version": __version__,
        "created": datetime.now(UTC).isoformat().replace("+00:00", "Z"),
        "map": map.name,
        "map_source": map.source,
        "height_unit": height_unit,
        "level": steps.level,
        "level_rows": steps.level_rows or "none",
        "smooth": steps.smooth or 0.0,
        "prominence": steps.prominence or 0.0,
        "min_distance": steps.min_distance or 0.0,
        "cutoffs": np.uint64(steps.cutoffs or 0),
        "border": np.array(surface.grid.border, dtype=np.uint64),
        "map_shape": np.array(surface.grid.heights.shape, dtype=np.uint64),
        "pixel_size": np.array([height, width]),
        "missing_pixels": np.uint64(surface.missing),
        "nominal_area": surface.area,
        "mean_plane_offset": surface.measured.height_mean,
        "warnings": "\n".join(surface.warnings),
    }


def _middles(count: int, pixel: float) -> Any:
    """The middles of pixels; the first one begins at 0."""
    return (np.arange(count) + 0.5) * pixel


def _scales(file: h5py.File, surface: Surface) -> None:
    """The scale of each dimension, in its group."""
    (rows, columns), (width, height) = surface.grid.heights.shape, surface.grid.pixel
    values = {
        "asperities/asperity": np.arange(len(surface.summits), dtype=np.uint64),
        "map/y": _middles(rows, height),
        "map/x": _middles(columns, width),
        "cutoffs/cutoff": np.array([at.cutoff for at in surface.series]),
    }
    for path, of in values.items():
        if of.size:
            _dataset(file, path, of)
            file[path].make_scale(path.split("/")[1])


def _dataset(file: h5py.File, path: str, values: Any) -> None:
    """A dataset with its attributes and scales; chunks have checksums, and a map is compressed."""
    values = np.asarray(values)
    options: dict[str, Any] = {}
    if values.ndim == 1:
        options = {"chunks": (min(values.size, _CHUNK),), "fletcher32": True}
    elif values.ndim == 2:
        chunks = tuple(min(count, _MAP_CHUNK) for count in values.shape)
        options = {"chunks": chunks, "fletcher32": True, "shuffle": True, "compression": 1}
    dataset = file.create_dataset(path, data=values, **options)
    variable = VARIABLES[path]
    dataset.attrs["units"] = variable.units
    dataset.attrs["long_name"] = variable.long_name
    group = path.split("/")[0]
    for axis, name in enumerate(variable.dimensions):
        dataset.dims[axis].attach_scale(file[f"{group}/{name}"])


def _values(surface: Surface) -> dict[str, dict[str, Any]]:
    """The values of every dataset that is no scale, by group and name."""
    values = {
        "asperities": _of_asperities(surface),
        "map": {"height": surface.grid.heights},
        "surface": _of_surface(surface),
        "measured": _of_measured(surface),
        "equivalent": _parameters(surface.equivalent),
    }
    if surface.series:
        values["cutoffs"] = _of_series(surface)
    return values


def _of_asperities(surface: Surface) -> dict[str, Any]:
    found, (width, height) = surface.summits, surface.grid.pixel
    sharp, blunt = found.principal_curvatures
    values = {
        "height": found.height,
        "radius": found.radius,
        "x": (found.column + 0.5) * width,
        "y": (found.row + 0.5) * height,
        "curvature_x": found.curvature_x,
        "curvature_y": found.curvature_y,
        "curvature_xy": found.curvature_xy,
        "principal_radius_1": 1.0 / sharp,
        "principal_radius_2": np.where(blunt > 0.0, 1.0 / np.where(blunt > 0.0, blunt, np.nan), np.nan),
        "equivalent_radius": found.equivalent_radius,
    }
    return values if found.prominence is None else values | {"prominence": found.prominence}


def _of_series(surface: Surface) -> dict[str, Any]:
    series, nan = surface.series, float("nan")

    def of(name: str, otherwise: float) -> list[float]:
        return [otherwise if at.measured is None else getattr(at.measured, name) for at in series]

    return {
        "summit_count": np.array([at.count for at in series], dtype=np.uint64),
        "nominal_area": [at.area for at in series],
        "asperity_density": of("density", 0.0),
        "asperity_radius": of("radius", nan),
        "asperity_height_std": of("height_std", nan),
        "asperity_curvature_std": of("curvature_std", nan),
    }


def _of_surface(surface: Surface) -> dict[str, Any]:
    names = ("m0", "m2", "m4", "slope_x", "slope_y", "alpha", "skewness", "excess_kurtosis")
    return {name: getattr(surface.moments, name) for name in names}


def _parameters(of: Measured | Equivalent) -> dict[str, Any]:
    """The numbers of an equivalent surface, counted or by theory."""
    names = ("density", "radius", "height_mean", "height_std")
    return {f"asperity_{name}": getattr(of, name) for name in names}


def _of_measured(surface: Surface) -> dict[str, Any]:
    return _parameters(surface.measured) | {
        "asperity_curvature_std": surface.measured.curvature_std,
        "curvature_ratio_median": surface.shape.ratio,
        "saddle_count": np.uint64(surface.shape.saddles),
    }
