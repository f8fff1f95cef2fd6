"""Pull-offs of the map itself, and of patches drawn from its spectrum."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import experiments, files, priors, program
from ..errors import SceneError
from ..maps.file import write
from ..maps.moments import SpectralMoments
from ..maps.surface import Surface
from ..opened import Run
from ..scenes import Scene

__all__ = ["Way", "approaching", "constants", "of_map", "of_sigma", "of_spectrum", "tables_of"]

# What stays of the scene's surface.
_KEPT = ("lubricant_thickness",)
# Tables of scenes that have no area of a map.
_REFUSED = {
    "shape": "a probe has no area that can be asked for: run it on the map, as configs/maps/probe.toml does",
    "sweep": "one scene is needed; leave it out",
}


@dataclass(frozen=True)
class Way:
    """Pull-offs by one way with one cut-off.

    Attributes
    ----------
    name : str
        ``map`` for the map itself, ``patches`` for patches drawn from the spectrum.
    cutoff, area, count, radius, height_std : float
        Cut-off, m, area, m², summits on it, their R and σ_s, m.
    forces : numpy.ndarray
        Pull-off of each replica, N; NaN where a preload is not reached.
    run : Run
        The result.
    """

    name: str
    cutoff: float
    area: float
    count: float
    radius: float
    height_std: float
    forces: NDArray[np.float64]
    run: Run


def tables_of(scene: Scene | None, overrides: Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a scene with overrides and without its surface; without a scene of the template `measured-map`.

    Raises
    ------
    SceneError
        The scene has what a map has no answer for, or an override is of the surface.
    """
    tables: dict[str, Any]
    if scene is None:
        with files.Folder() as folder:
            program.call(["new", str(folder / "map.toml"), "--template", "measured-map"])
            tables = tomllib.loads((folder / "map.toml").read_text(encoding="utf-8"))
    else:
        tables = dict(priors.opened(scene))
    named = {key.split(".")[0] for key in overrides} | set(tables)
    for refused, why in _REFUSED.items():
        if refused in named:
            raise SceneError(f"[{refused}]: {why}")
    for key in overrides:
        if key.startswith("surface.") and key.removeprefix("surface.") not in _KEPT:
            raise SceneError(
                f"{key}: the map gives the surface; of [surface] {', '.join(_KEPT)} alone can be set"
            )
    own = tables.get("surface", {})
    surface = {key: own[key] for key in _KEPT if isinstance(own, Mapping) and key in own}
    tables = {**tables, "surface": surface, "title": str(tables.get("title", ""))}
    for key, value in overrides.items():
        *path, last = key.split(".")
        table: dict[str, Any] = tables
        for name in path:
            table[name] = dict(table.get(name, {}))
            table = table[name]
        table[last] = value
    return tables


def approaching(tables: Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a scene on approach, without what is pressed, pulled or coupled."""
    left_out = ("instability", "device", "substrate", "output")
    found = {name: of for name, of in tables.items() if name not in left_out}
    found["model"] = {**found.get("model", {}), "history": "approach"}
    if "separation" in found:
        found["separation"] = {key: value for key, value in found["separation"].items() if key != "cycles"}
    return found


def constants(tables: Mapping[str, Any]) -> dict[str, float]:
    """E*, Pa, Δγ, J/m², and with a hardness that, Pa, of a scene as the program reads it."""
    surface = {
        "asperity_radius": "1 um",
        "asperity_density": "1 /um^2",
        "asperity_height_std": "1 nm",
        "nominal_area": "1 um^2",
    }
    scene = {"material": tables.get("material", {}), "surface": surface}
    alone = experiments.run(scene, replicas=0, progress=False)
    names = ("reduced_modulus", "hardness", "work_of_adhesion")
    return {name: float(alone.attrs[name]) for name in names if name in alone.attrs and math.isfinite(float(alone.attrs[name]))}


def of_map(tables: Mapping[str, Any], surface: Surface, options: Mapping[str, Any]) -> Way:
    """The run of the map itself: one replica that has the summits of the map. The options go to `stiction.run`."""
    with files.Folder() as folder:
        path = folder / "map.h5"
        write(path, surface, "", force=False, inputs=[])
        source = {"path": str(path), "sample": "whole", "radius": "equivalent"}
        run = experiments.run(_on(tables, {"asperities": source}), **{**options, "replicas": 1})
    found, cutoff = surface.measured, surface.steps.smooth or 0.0
    return Way(
        "map", cutoff, surface.area, len(surface.summits), found.radius, found.height_std, _forces(run), run
    )


def of_spectrum(
    tables: Mapping[str, Any],
    moments: SpectralMoments,
    cutoff: float,
    area: float,
    options: Mapping[str, Any],
) -> Way:
    """Patches of an area, m², of the Gaussian surface with the moments of a map behind a cut-off, m."""
    surface = {"spectrum": _spectrum(moments), "nominal_area": f"{area!r} m^2"}
    run = experiments.run(_on(tables, surface), **experiments.ONE_MODEL, **options)
    return Way(
        "patches", cutoff, area, moments.density * area, moments.radius, moments.height_std, _forces(run), run
    )


def of_sigma(
    tables: Mapping[str, Any], moments: SpectralMoments, area: float, error: float, options: Mapping[str, Any]
) -> float:
    """The ratio of mean pull-offs on approach where σ is lower and higher by a relative error, with equal random numbers."""
    means = []
    for factor in (1.0 - error, 1.0 + error):
        moved = {**_spectrum(moments), "m0": f"{moments.m0 * factor**2!r} m^2"}
        scene = _on(approaching(tables), {"spectrum": moved, "nominal_area": f"{area!r} m^2"})
        run = experiments.run(scene, **experiments.ONE_MODEL, **options)
        means.append(run.pull_off.mean_over_patches)
    return max(means) / min(means) if min(means) > 0.0 else math.inf


def _spectrum(of: SpectralMoments) -> dict[str, Any]:
    return {"m0": f"{of.m0!r} m^2", "m2": of.m2, "m4": f"{of.m4!r} /m^2"}


def _on(tables: Mapping[str, Any], surface: dict[str, Any]) -> dict[str, Any]:
    return {**tables, "surface": {**tables["surface"], **surface}}


def _forces(run: Run) -> NDArray[np.float64]:
    """Pull-off of each replica, N: after the largest preload that is reached, if there are preloads."""
    after = run.after_largest_preload
    if after is None:
        return np.asarray(run.replicas["pull_off_force"].values, dtype=float)
    preload = float(after["preload"])
    if math.isnan(preload):
        raise SceneError("instability.preload: no patch reaches it; give a smaller one, or a larger area")
    return np.asarray(run["replicas/pull_off_after_preload"].sel(preload=preload).values, dtype=float)
