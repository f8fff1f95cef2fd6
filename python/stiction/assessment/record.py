"""The answer of a map as a dataset: numbers for the figure, words for reports."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray

from .answer import Answer
from .criteria import LARGEST_FACTOR

__all__ = ["VERSION", "dataset"]

VERSION = (1, 0)


def dataset(answer: Answer, words: str) -> xarray.Dataset:
    """The dataset of an answer and its words."""
    surface, spectrum = answer.surfaces[0], answer.spectrum
    most = max((way.forces.size for way in answer.ways), default=0)
    run = answer.ways[-1].run if answer.ways else None
    forces = np.full((len(answer.ways), most), np.nan)
    for place, way in enumerate(answer.ways):
        forces[place, : way.forces.size] = way.forces
    (dy, dx), (rows, columns) = surface.grid.steps, surface.grid.heights.shape
    values: dict[str, Any] = {
        "pull_off_force": (
            ("way", "replica"),
            forces,
            _about("N", "pull-off force of each patch, or of the map itself"),
        ),
        "power": ("wavevector", spectrum.density, _about("m4", "two-dimensional power spectral density")),
        "longest_wave": (
            "scan",
            [one.longest for one in spectrum.scans],
            _about("m", "longest reliable wave of each scan"),
        ),
        "shortest_wave": (
            "scan",
            [one.shortest for one in spectrum.scans],
            _about("m", "shortest reliable wave of each scan"),
        ),
        "height": (
            ("y", "x"),
            surface.grid.heights,
            _about("m", "levelled heights, of one map behind the smaller cut-off"),
        ),
        "summit_x": (
            "summit",
            (surface.summits.column + 0.5) * dx,
            _about("m", "place of each summit along x"),
        ),
        "summit_y": ("summit", (surface.summits.row + 0.5) * dy, _about("m", "place of each summit along y")),
        "criterion_met": (
            "criterion",
            [not one.advice for one in answer.criteria],
            _about("1", "whether each criterion is met"),
        ),
        "criterion_factor": (
            "criterion",
            [one.factor for one in answer.criteria],
            _about("1", "factor by which pull-off may be off"),
        ),
    }
    for name, units, meaning in (
        ("cutoff", "m", "cut-off wavelength"), ("area", "m2", "nominal area"), ("count", "1", "summits"),
        ("radius", "m", "radius R of summits"), ("height_std", "m", "standard deviation of their heights"),
    ):  # fmt: skip
        values[name] = (
            "way",
            [getattr(way, name) for way in answer.ways],
            _about(units, f"{meaning} of each way"),
        )
    coords = {
        "way": [way.name for way in answer.ways],
        "wavevector": ("wavevector", spectrum.wavevector, _about("m-1", "wavevector")),
        "scan": answer.names,
        "criterion": [one.name for one in answer.criteria],
        "y": ("y", (np.arange(rows) + 0.5) * dy, _about("m", "place along y")),
        "x": ("x", (np.arange(columns) + 0.5) * dx, _about("m", "place along x")),
    }
    attrs = {
        "format": "stiction-map", "format_version": np.array(VERSION), "title": run.title if run else "",
        "scene": run.scene_text if run else "", "summary": words, "nominal_area": answer.area,
        "above": math.nan if answer.above is None else answer.above, "factor": answer.factor,
        "assessment": "no" if answer.failed or answer.factor > LARGEST_FACTOR else "yes",
    }  # fmt: skip
    return xarray.Dataset(values, coords, attrs)


def _about(units: str, meaning: str) -> dict[str, str]:
    return {"units": units, "long_name": meaning}
