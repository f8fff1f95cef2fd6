"""Probabilities of rare patches of a scene: by tilted heights above a threshold, by importance splitting below one."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import experiments, quantities
from ..errors import SceneError, StictionError
from . import heights, splitting, tilting
from .estimate import NEVER, Probability, checked
from .heights import Array

__all__ = ["Patches"]

# Replicas of the scene's own law at first, then of a mixture, and the fewest of these that have to be in the event.
_PILOT, _FIRST, _HITS = 256, 1024, 128
# The smallest effective number of patches in the event.
_EFFECTIVE = 25.0
# Patches at most, by default.
_MOST_ABOVE, _MOST_BELOW = 200_000, 20_000_000
# Pilots for a force above which patches pull with a probability; how near the last one's is, as a logarithm.
_FORCES, _NEAR = 20, 1.5
# Scatter of low heights that splitting leaves out at most, as a share of the least pull-off of the pilot, and of the scatter of pull-offs.
_IN_BINS, _OF_SCATTER = 2e-3, 0.03


class Patches:
    """Patches of a scene, for probabilities of their pull-off force.

    Parameters
    ----------
    tables : mapping
        A scene of independent asperities of one radius, with heights by a law that is a formula, on approach or retraction.
    seed, threads : int, optional
        As in `stiction.run`.

    Raises
    ------
    SceneError
        The scene is wrong, or has something that neither method knows; the message names the key.
    """

    def __init__(self, tables: Mapping[str, Any], *, seed: int | None = None, threads: int | None = None) -> None:
        _checked(tables)
        ensemble = {key: value for key, value in tables.get("ensemble", {}).items() if key in ("seed",)}
        self.tables = {**tables, "ensemble": {**ensemble, "replicas": _PILOT}, "output": {**tables.get("output", {}), "curves": True}}
        self.threads = threads
        self.reseed(int(ensemble.get("seed", 1)) if seed is None else seed)
        with experiments.run(self.tables, seed=int(self._seeds.integers(2**62)), threads=threads, progress=False) as run:
            self.separations = run["replicas/separation"].values
            self.offset = float(run.attrs["mean_plane_offset"])
            self.pull_off = run["replicas/pull_off_force"].values
            attraction = -run["replicas/external_force"].transpose("replica", "separation").values
            count = float(run["replicas/asperity_count"].values[0])
            sigma = float(run.attrs["asperity_height_std"])
            mean_count = float(run.attrs["asperity_density"]) * float(run.attrs["nominal_area"])
            of_asperity = dict(run.attrs)
        surface = tables["surface"]
        self.poisson = surface.get("count", "fixed") == "poisson"
        self.count = mean_count if self.poisson else count
        self.heights = heights.law(surface.get("heights", "gaussian"), sigma)
        self._ends = float(self.heights.ppf(1e-18)), float(self.heights.isf(1e-18))
        self.tops = self.separations - self.offset
        # Where each patch pulls most, nearly.
        self._most = self.tops[attraction.argmax(axis=1)]
        self._asperity = heights.attraction(of_asperity, self._ends[0] - float(self.tops.max()), self._ends[1] - float(self.tops.min()))

    def reseed(self, seed: int) -> None:
        """Begins another stream of random numbers; what the program has computed of the scene remains."""
        self._seeds = np.random.default_rng([seed, 2])

    @functools.cached_property
    def _tilts(self) -> tilting.Tilts:
        return tilting.Tilts(self.heights, self._ends, self.count, self._asperity, self.tops)

    @functools.cached_property
    def _below(self) -> splitting.Curves:
        low, middle, high = (float(of(self._most)) for of in (np.min, np.median, np.max))
        # Half as far again as patches of the pilot reach.
        where = max(1.5 * low - 0.5 * middle, float(self.tops.min())), min(1.5 * high - 0.5 * middle, float(self.tops.max()))
        return self._curves(where)

    def _curves(self, where: tuple[float, float]) -> splitting.Curves:
        forces = self.pull_off
        error = min(_IN_BINS * max(float(forces.min()), 0.1 * float(np.median(forces))), _OF_SCATTER * float(forces.std()))
        return splitting.Curves(self.heights, self.count, self.poisson, self._asperity, np.sort(self.tops), where, error)

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
            Patches at most: by default 200 000 above, and 20 million below, with those that are moved.

        Raises
        ------
        StictionError
            The error takes more patches, or the answer rests on a few of them.
        """
        if below:
            return splitting.Splitting(self._below, self._seeds).probability(threshold, error, most or _MOST_BELOW)
        pilot = self._pilot(threshold, most)
        return NEVER if pilot is None else self._main(pilot, threshold, error, most)[0]

    def quantile(
        self, probability: float, *, below: bool = False, error: float = 0.1, most: int | None = None
    ) -> tuple[float, tuple[float, float]]:
        """The force that a patch exceeds (or stays below) with a probability, and its interval of 95 %, N.

        Parameters
        ----------
        probability : float
            From 1e-12 to 0.5.
        below, error, most
            As for `probability`; its error becomes the error of the force.

        Raises
        ------
        StictionError
            The error takes more patches, or the answer rests on a few of them.
        """
        if below:
            return splitting.Splitting(self._below, self._seeds).quantile(probability, error, most or _MOST_BELOW)
        force = float(np.quantile(self.pull_off, 1.0 - max(probability, 0.02)))
        spread = float(self.pull_off.std())
        for _ in range(_FORCES):
            first = self._pilot(force, most)
            if first is None:
                force, spread = force - 0.5 * spread, 0.5 * spread
                continue
            mixture, pilot = first
            near = mixture.estimate(pilot, force)
            if abs(np.log(near.value / probability)) < _NEAR:
                found, drawn = self._main(first, force, error, most)
                wanted = probability * np.array([1.0, *(np.array(found.interval) / found.value)])
                at = _exceeded(drawn[1], drawn[0].weights(drawn[1]), wanted)
                return float(at[0]), (float(at[1:].min()), float(at[1:].max()))
            # At most one standard deviation beyond where patches were drawn for.
            at = _exceeded(pilot, mixture.weights(pilot), np.array([probability]))
            force = float(np.clip(at[0], force - spread, force + spread))
        raise StictionError(f"no force above which a patch pulls with probability {probability:g} was found")

    def _pilot(self, threshold: float, most: int | None) -> tuple[tilting.Mixture, tilting.Drawn] | None:
        """A mixture for patches above a threshold and the first patches of it; none where the event never happens."""
        mixture = self._tilts.mixture(threshold, self._curves)
        if mixture is None:
            return None
        size, most = _FIRST, most or _MOST_ABOVE
        while True:
            pilot = mixture.drawn(size, self._seeds)
            if (pilot.pull_off > threshold).sum() >= _HITS:
                return mixture, pilot
            if size >= most:
                raise StictionError(
                    f"of {size} patches {(pilot.pull_off > threshold).sum()} pull more than {quantities.si(threshold, 'N')}, "
                    f"and {_HITS} are needed for its probability: `most` of more patches, or a lower threshold"
                )
            size = min(4 * size, most)

    def _main(
        self, first: tuple[tilting.Mixture, tilting.Drawn], threshold: float, error: float, most: int | None
    ) -> tuple[Probability, tuple[tilting.Mixture, tilting.Drawn]]:
        """The probability from new patches, whose number and laws are by the pilot alone, and these."""
        mixture, pilot = first
        fitted, most = mixture.fitted(pilot, threshold), most or _MOST_ABOVE
        size = fitted.patches(pilot, mixture, threshold, error)
        if size > most:
            raise StictionError(
                f"the probability of a pull-off above {quantities.si(threshold, 'N')} takes {size} patches for an error of "
                f"{100 * error:.0f} %, and {most} are allowed: a larger `error`, or `most` of more patches"
            )
        drawn = fitted.drawn(size, self._seeds)
        found = fitted.estimate(drawn, threshold)
        what = f"the probability of a pull-off above {quantities.si(threshold, 'N')}"
        return checked(found, what, _EFFECTIVE, "patches"), (fitted, drawn)

def _exceeded(drawn: tilting.Drawn, weights: Array, probabilities: Array) -> Array:
    """Forces that patches of a mixture exceed with probabilities, N."""
    order = np.argsort(-drawn.pull_off)
    shares = np.cumsum(weights[order]) / len(order)
    at = np.searchsorted(shares, np.minimum(probabilities, shares[-1])).clip(0, len(order) - 1)
    return np.asarray(drawn.pull_off[order][at])


# Tables of scenes that this knows.
_TABLES = ("material", "surface", "model", "separation", "ensemble", "solver", "output")


def _checked(tables: Mapping[str, Any]) -> None:
    """Refuses scenes that neither tilts nor splitting know."""
    for table, content in tables.items():
        if isinstance(content, Mapping) and table not in _TABLES:
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
