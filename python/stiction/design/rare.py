"""Probabilities of rare patches of a scene: by tilted heights above a threshold, by importance splitting below one."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .. import experiments, quantities
from ..errors import SceneError, StictionError
from . import heights, splitting, tilting
from .estimate import NEVER, Probability
from .heights import Array

__all__ = ["Patches"]

# Replicas of a scene's own law, and of all tilted laws at first.
_PILOT, _FIRST = 256, 512
# In the event at least, before an error is believed.
_HITS = 100
# Patches at most, by default.
_MOST_ABOVE, _MOST_BELOW = 200_000, 20_000_000
# Forces at which patches above a quantile are looked for.
_FORCES = 20
# Scatter of low heights that splitting leaves out at most, as a share of the least pull-off of the pilot, and of the scatter of pull-offs.
_IN_BINS, _OF_SCATTER = 2e-3, 0.03


class Patches:
    """Patches of a scene, for probabilities of their pull-off force.

    Parameters
    ----------
    tables : mapping
        A scene of independent asperities of one radius, whose heights have a law of a formula, on approach or retraction.
    seed, threads : int, optional
        As in `stiction.run`.

    Raises
    ------
    SceneError
        The scene is wrong, or has what neither tilts nor splitting know; the message names the key.
    """

    def __init__(self, tables: Mapping[str, Any], *, seed: int | None = None, threads: int | None = None) -> None:
        _checked(tables)
        ensemble = {key: value for key, value in tables["ensemble"].items() if key in ("seed",)}
        self.tables = {**tables, "ensemble": {**ensemble, "replicas": _PILOT}, "output": {**tables.get("output", {}), "curves": True}}
        self.threads = threads
        self._seeds = np.random.default_rng([int(ensemble.get("seed", 1)) if seed is None else seed, 2])
        run = self._run(self.tables, _PILOT)
        with run:
            self.separations = run["replicas/separation"].values
            self.offset = float(run.attrs["mean_plane_offset"])
            self.pilot = _drawn(run)
            sigma = float(run.attrs["asperity_height_std"])
            area = float(run.attrs["nominal_area"])
        surface = tables["surface"]
        self.poisson = surface.get("count", "fixed") == "poisson"
        self.count = float(self.pilot.count[0])
        if self.poisson:
            self.count = quantities.parsed("asperity_density", surface["asperity_density"])[0] * area
        self.heights = heights.law(surface.get("heights", "gaussian"), sigma)
        self._ends = float(self.heights.ppf(1e-18)), float(self.heights.isf(1e-18))
        self.tops = self.separations - self.offset
        self._asperity = heights.attraction(tables, self._ends[0] - float(self.tops.max()), self._ends[1] - float(self.tops.min()))

    @functools.cached_property
    def _tilts(self) -> tilting.Tilts:
        return tilting.Tilts(self.heights, self._ends, self.count, self._asperity, self.tops)

    @functools.cached_property
    def _splitting(self) -> splitting.Splitting:
        most = self.tops[self.pilot.attraction.argmax(axis=1)]
        low, middle, high = (float(of(most)) for of in (np.min, np.median, np.max))
        # Half as far again as patches of the pilot reach.
        where = max(1.5 * low - 0.5 * middle, float(self.tops.min())), min(1.5 * high - 0.5 * middle, float(self.tops.max()))
        forces = self.pilot.pull_off
        error = min(_IN_BINS * max(float(forces.min()), 0.1 * float(np.median(forces))), _OF_SCATTER * float(forces.std()))
        curves = splitting.Curves(self.heights, self.count, self.poisson, self._asperity, np.sort(self.tops), where, error)
        return splitting.Splitting(curves, self._seeds)

    def probability(self, threshold: float, *, below: bool = False, error: float = 0.1, most: int | None = None) -> Probability:
        """The probability that the pull-off force of a patch is above (or below) a threshold.

        Parameters
        ----------
        threshold : float
            N.
        below : bool
            Whether patches below it count, else those above.
        error : float
            Relative standard error that is wanted.
        most : int, optional
            Patches at most: by default 200 000 above, which the program solves, and 20 million below, with those that are moved.

        Raises
        ------
        StictionError
            With so many patches the error is not reached.
        """
        if not below:
            return self._above(threshold, error, most)[0]
        found = tilting.estimate([tilting.OWN], [self.pilot], threshold, below)
        if found.hits >= _HITS and found.relative_error <= error:
            return found
        return self._splitting.probability(threshold, error, most or _MOST_BELOW)

    def quantile(
        self, probability: float, *, below: bool = False, error: float = 0.1, most: int | None = None
    ) -> tuple[float, tuple[float, float]]:
        """The force that a patch pulls harder than (or less than) with a probability, and what holds it in 95 of 100 cases, N.

        Parameters
        ----------
        probability : float
            From 1e-12 to 0.5.
        below, error, most
            As of `probability`, whose error makes that of the force.

        Raises
        ------
        StictionError
            With so many patches the error is not reached.
        """
        if below:
            return self._splitting.quantile(probability, error, most or _MOST_BELOW)
        force, spread = float(np.quantile(self.pilot.pull_off, 1.0 - max(probability, 0.02))), float(self.pilot.pull_off.std())
        for _ in range(_FORCES):
            found, pull_off, weights = self._above(force, error, most)
            if found.value == 0.0:
                force, spread = force - 0.5 * spread, 0.5 * spread
                continue
            order = np.argsort(-pull_off)
            shares = np.cumsum(weights[order]) / len(order)
            wanted = probability * np.exp(np.array([0.0, -1.96, 1.96]) * found.relative_error)
            at = pull_off[order][np.searchsorted(shares, np.minimum(wanted, shares[-1])).clip(0, len(order) - 1)]
            # Patches were drawn for one force, and are good for forces about it.
            if abs(np.log(found.value / probability)) < 1.5:
                return float(at[0]), (float(at[1:].min()), float(at[1:].max()))
            # At most one standard deviation beyond where patches were drawn for.
            force = float(np.clip(at[0], force - spread, force + spread))
        raise StictionError(f"no force above which a patch pulls with probability {probability:g} was found")

    def _above(self, threshold: float, error: float, most: int | None) -> tuple[Probability, Array, Array]:
        """The probability, and pull-off (N) and weight of the patches that it is of."""

        def told(laws: list[tilting.Law], drawn: list[tilting.Drawn]) -> tuple[Probability, Array, Array]:
            forces = np.concatenate([of.pull_off for of in drawn])
            return found, forces, np.concatenate(tilting.weights(laws, drawn))

        found = tilting.estimate([tilting.OWN], [self.pilot], threshold, False)
        if found.hits >= _HITS and found.relative_error <= error:
            return told([tilting.OWN], [self.pilot])
        chosen = self._tilts.laws(threshold)
        if chosen is None:
            return NEVER, np.empty(0), np.empty(0)
        tilted, shares = chosen
        # A tenth are of the scene's own heights; all are, where none are tilted.
        laws, shares = [tilting.OWN, *tilted], np.array([0.1, *(0.9 * shares)] if tilted else [1.0])
        drawn = [tilting.Drawn(np.empty(0), np.empty((0, self.separations.size)), np.empty(0)) for _ in laws]
        size, most = _FIRST, most or _MOST_ABOVE
        while True:
            for place, share in enumerate(shares):
                drawn[place] = tilting.joined(drawn[place], self._draw(laws[place], max(int(np.ceil(share * size)), 8)))
            found = tilting.estimate(laws, drawn, threshold, False)
            n = found.replicas
            if found.hits >= _HITS and found.relative_error <= error:
                return told(laws, drawn)
            if n >= most:
                break
            ratio = (found.relative_error / error) ** 2 if found.hits >= 20 else 4.0
            size = int(min(max(1.1 * (ratio - 1.0) * n, 0.5 * n), 4.0 * n, most - n + 64))
        raise StictionError(
            f"the probability of a pull-off above {quantities.si(threshold, 'N')} is known to {100 * found.relative_error:.0f} % only "
            f"after {n} patches, {found.hits} of them above it: a larger error, or more replicas are needed"
        )

    def _draw(self, law: tilting.Law, replicas: int) -> tilting.Drawn:
        """Patches of a tilted law, or of the scene's own where it has no tilt."""
        if not law.theta:
            with self._run(self.tables, replicas) as run:
                return _drawn(run)
        drawn = self._tilts.heights(law, self._seeds)
        with tempfile.TemporaryDirectory(prefix="stiction-") as folder:
            path = Path(folder) / "heights.h5"
            with h5py.File(path, "w") as file:
                file["heights"] = drawn
            surface = {
                key: value for key, value in self.tables["surface"].items() if key not in ("surface_height_std", "asperity_height_std")
            }
            surface |= {
                "heights": {"law": "file", "path": str(path), "dataset": "heights", "unit": "m"},
                "mean_plane_offset": f"{self.offset!r} m",
            }
            # Heights of a list are taken about their mean.
            h = [f"{value!r} m" for value in (self.separations - drawn.mean()).tolist()]
            with self._run({**self.tables, "surface": surface, "separation": {"h": h}}, replicas) as run:
                return _drawn(run)

    def _run(self, tables: Mapping[str, Any], replicas: int) -> Any:
        seed = int(self._seeds.integers(2**62))
        return experiments.run(tables, replicas=replicas, seed=seed, threads=self.threads, progress=False)


def _drawn(run: Any) -> tilting.Drawn:
    force = run["replicas/external_force"].transpose("replica", "separation").values
    return tilting.Drawn(run["replicas/pull_off_force"].values, -force, run["replicas/asperity_count"].values.astype(float))


def _checked(tables: Mapping[str, Any]) -> None:
    """Refuses what neither tilts nor splitting know."""
    for table in ("substrate", "capillary", "van_der_waals", "electrostatic", "instability", "sweep"):
        if table in tables:
            raise SceneError(f"{table}: probabilities of rare patches are of independent asperities alone; leave the table out")
    surface, ensemble = tables.get("surface", {}), tables.get("ensemble", {})
    for key in ("asperities", "spectrum", "summits", "radii"):
        if key in surface and surface[key] != "common":
            raise SceneError(f"surface.{key}: probabilities of rare patches are of asperities of one radius; give asperity_radius")
    given = surface.get("heights", "gaussian")
    name = given.get("law") if isinstance(given, Mapping) else given
    if name not in heights.LAWS:
        raise SceneError(f"surface.heights.law = {name!r}: a law of a formula is needed: {', '.join(heights.LAWS)}")
    if tables.get("model", {}).get("history", "approach") == "loop":
        raise SceneError('model.history = "loop": "approach" or "retraction" is needed')
    if ensemble.get("sampling", "independent") != "independent":
        raise SceneError(f"ensemble.sampling = {ensemble['sampling']!r}: independent patches are needed")
