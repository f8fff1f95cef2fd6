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
from ..progress import Bar
from . import heights, splitting, tilting
from .estimate import NEVER, Probability, checked
from .heights import Array

__all__ = ["Patches"]

# Replicas of the scene's own law at first, and below a threshold.
_PILOT, _PILOT_BELOW = 64, 256
# Share of the patches that turn nearer than the laws have it: patches in the event mostly turn near.
_TURN = 0.25
# Patches of a mixture that have to be in the event at first, at least and at most, and how many are drawn for each.
_HITS, _DRAWN = (32, 128), 8
# The smallest effective number of patches in the event, and the one that is aimed at, however large the error may be.
_EFFECTIVE, _ALIKE = 25.0, 100.0
# Patches at most, by default.
_MOST_ABOVE, _MOST_BELOW = 200_000, 20_000_000
# Pilots for a force above which patches pull with a probability; how near the last one's is, as a logarithm.
_FORCES, _NEAR = 20, 1.5
# Share of patches that may miss the preload.
_MISSED = 0.05
# Standard deviations below the lowest height at which nothing acts, and above the largest separation from which on heights are alike.
_FAR, _BEYOND = 50.0, 8.0
# Standard deviation by low heights that splitting leaves out at most, as a fraction of the least pull-off of the pilot, and of the standard
# deviation of pull-offs.
_IN_BINS, _OF_SCATTER = 2e-3, 0.03


class Patches:
    """Patches of a scene, for probabilities of their pull-off force.

    Parameters
    ----------
    tables : mapping
        A scene of asperities of one radius, coupled or not, with heights by a law that is a formula, on any history;
        after the largest preload where there are preloads.
    seed, threads : int, optional
        As in `stiction.run`.

    Raises
    ------
    SceneError
        The scene is wrong, or has something that neither method knows; the message names the key.
    """

    def __init__(self, tables: Mapping[str, Any], *, seed: int | None = None, threads: int | None = None) -> None:
        _checked(tables)
        seeded = {key: value for key, value in tables.get("ensemble", {}).items() if key == "seed"}
        instability = {"preload": tables["instability"]["preload"]} if "preload" in tables.get("instability", {}) else {}
        self.tables = {key: value for key, value in tables.items() if key not in ("device", "instability", "output")}
        self.tables |= {"ensemble": seeded, **({"instability": instability} if instability else {})}
        self.threads = threads
        self.reseed(experiments.seed_of(tables, seed))
        self._first = int(self._seeds.integers(2**62))
        with self._sampled(_PILOT) as run:
            self._scene = dict(run.attrs)
            self.history = self._scene["history"]
            self.separations = run["replicas/separation"].values
            self.pull_off, self.preload = self._of(run), None
            turn = float(self.separations.min())
            if instability:
                largest = int(run["replicas/preload"].values.argmax())
                self.preload = float(run["replicas/preload"].values[largest])
                turns = run["replicas/preload_separation"].values[:, largest]
                if (missed := int(np.isnan(turns).sum())) > _MISSED * turns.size:
                    raise SceneError(
                        f"instability.preload: {missed} of {turns.size} patches do not reach {quantities.si(self.preload, 'N')}; "
                        "begin nearer by [separation], or press less"
                    )
                turn = float(np.nanquantile(turns, _TURN))
                self.tables["instability"] = {"preload": [f"{self.preload!r} N"]}
            self._turn = turn
            count = float(run["replicas/asperity_count"].values[0])
        surface = tables["surface"]
        self.poisson = surface.get("count", "fixed") == "poisson"
        self.count = float(self._scene["asperity_density"]) * float(self._scene["nominal_area"]) if self.poisson else count
        self.heights = heights.law(surface.get("heights", "gaussian"), float(self._scene["asperity_height_std"]))
        self._ends = float(self.heights.ppf(1e-18)), float(self.heights.isf(1e-18))
        # Separations from the mean plane of the summits.
        self.from_summits = self.separations - float(self._scene["mean_plane_offset"])

    def _sampled(self, replicas: int) -> Any:
        """A run of patches of the scene's own law."""
        tables = {**self.tables, "ensemble": {"replicas": replicas}, "output": {"curves": True}}
        with Bar("patches of the scene itself"):
            return experiments.run(tables, seed=self._first, threads=self.threads, progress=False, **experiments.ONE_MODEL)

    def _of(self, run: Any) -> Array:
        """Pull-off force of the patches of a run, N; after the largest preload, if there is one, and 0 where it is not reached."""
        if "preload" not in self.tables.get("instability", {}):
            return np.asarray(run["replicas/pull_off_force"].values)
        force: Array = run["replicas/pull_off_after_preload"].values[:, run["replicas/preload"].values.argmax()]
        return np.where(np.isnan(force), 0.0, force)

    def reseed(self, seed: int) -> None:
        """Begins another stream of random numbers; what the program has computed of the scene remains."""
        self._seeds = np.random.default_rng([seed, 2])

    def _computed(self, z: Array, **changes: Any) -> Any:
        """The run of patches of given heights above the mean plane of the asperities, m."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "heights.h5")
            with h5py.File(path, "w") as file:
                file["height"] = z.ravel()
            area = f"{z.shape[1] / float(self._scene['asperity_density'])!r} m^2"
            surface = {**self.tables["surface"], "nominal_area": area, "count": "fixed"}
            ensemble = {"replicas": z.shape[0], "heights": {"path": str(path), "dataset": "height", "unit": "m"}}
            tables = {key: value for key, value in {**self.tables, "surface": surface, "ensemble": ensemble, **changes}.items() if value is not None}
            # Of given heights places alone are drawn: other ones each time.
            seed = int(self._seeds.integers(2**62)) if _is_coupled(tables) else None
            return experiments.run(tables, seed=seed, threads=self.threads, progress=False, **experiments.ONE_MODEL)

    def _pull_off(self, z: Array) -> Array:
        """Pull-off force of patches, N, by their heights, m, of NaN where there is no asperity."""
        # Nothing acts so far below.
        low = self._ends[0] - _FAR * float(self.heights.std())
        with self._computed(np.where(np.isnan(z), low, z)) as run:
            return self._of(run)

    def _one(self, h: Array) -> Array:
        """Attraction, N, of single asperities, (separations, cells), on the unloading branch from where patches turn."""
        # What an asperity remembers is from where the patches turn.
        given = h if self.history == "approach" else np.unique([self._turn, *h])
        separation = {"h": [f"{float(one)!r} m" for one in given]}
        changes = {"separation": separation, "output": {"curves": True}, "instability": None, "substrate": None}
        with self._computed(self._cells.z[:, None], **changes) as run:
            force = self._force(run).transpose("separation", "replica").values
        return np.asarray(-force[np.searchsorted(given, h)])

    def _force(self, run: Any) -> Any:
        """External force of the patches of a run, N; of a loop on retraction."""
        return run["replicas/retraction_external_force" if self.history == "loop" else "replicas/external_force"]

    @functools.cached_property
    def _cells(self) -> tilting.Cells:
        sigma = float(self.heights.std())
        high = min(self._ends[1], max(float(self.from_summits.max()) + _BEYOND * sigma, self._ends[0] + sigma))
        return tilting.Cells(self.heights, self._ends[0], high)

    @functools.cached_property
    def _tilts(self) -> tilting.Tilts:
        patch = tilting.Patch(self._cells, self.count, self.poisson, self._one, self._pull_off)
        outward = self.separations[self.separations >= self._turn]
        return tilting.Tilts(patch, outward)

    @functools.cached_property
    def _asperity(self) -> tuple[Array, Array]:
        """Interferences (m) and attraction (N) of one asperity."""
        return heights.attraction(self._scene, self._ends[0] - float(self.from_summits.max()), self._ends[1] - float(self.from_summits.min()))

    @functools.cached_property
    def _below(self) -> splitting.Curves:
        if self.history != "approach":
            raise SceneError(f'model.history = "{self.history}": probabilities below a force are of approach; count the patches of a long run')
        if _is_coupled(self.tables):
            raise SceneError("substrate: probabilities below a force are of independent asperities; count the patches of a long run")
        with self._sampled(_PILOT_BELOW) as run:
            forces = self._of(run)
            # Where each patch pulls most, nearly.
            most = self.from_summits[self._force(run).transpose("replica", "separation").values.argmin(axis=1)]
        low, middle, high = (float(of(most)) for of in (np.min, np.median, np.max))
        # Half as far again as patches of the pilot reach.
        where = max(1.5 * low - 0.5 * middle, float(self.from_summits.min())), min(1.5 * high - 0.5 * middle, float(self.from_summits.max()))
        error = min(_IN_BINS * max(float(forces.min()), 0.1 * float(np.median(forces))), _OF_SCATTER * float(forces.std()))
        return splitting.Curves(self.heights, self.count, self.poisson, self._asperity, np.sort(self.from_summits), where, error)

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
        pilot = self._pilot(threshold, error, most)
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
            first = self._pilot(force, error, most)
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

    def _pilot(self, threshold: float, error: float, most: int | None) -> tuple[tilting.Mixture, tilting.Drawn] | None:
        """A mixture for patches above a threshold and the first patches of it; none where the event never happens."""
        with Bar("heights to sample"):
            mixture = self._tilts.mixture(threshold)
        if mixture is None:
            return None
        wanted, most = int(np.clip(1.0 / error**2, *_HITS)), most or _MOST_ABOVE
        pilot = mixture.drawn(_DRAWN * wanted, self._seeds, "trial")
        while (hits := int((pilot.pull_off > threshold).sum())) < wanted:
            if (size := pilot.pull_off.size) >= most:
                raise StictionError(
                    f"of {size} patches {hits} pull more than {quantities.si(threshold, 'N')}, and {wanted} are needed for its probability: "
                    "`most` of more patches, or a lower threshold"
                )
            pilot = pilot.and_more(mixture.drawn(min(size, most - size), self._seeds, "trial"))
        return mixture, pilot

    def _main(
        self, first: tuple[tilting.Mixture, tilting.Drawn], threshold: float, error: float, most: int | None
    ) -> tuple[Probability, tuple[tilting.Mixture, tilting.Drawn]]:
        """The probability from new patches, whose number and laws are by the pilot alone, and these."""
        mixture, pilot = first
        fitted, most = mixture.fitted(pilot, threshold), most or _MOST_ABOVE
        size = fitted.patches(pilot, mixture, threshold, max(2.0 / error**2, _ALIKE))
        if size > most:
            raise StictionError(
                f"the probability of a pull-off above {quantities.si(threshold, 'N')} takes {size} patches for an error of "
                f"{100 * error:.0f} %, and {most} are allowed: a larger `error`, or `most` of more patches"
            )
        drawn = fitted.drawn(size, self._seeds, "sampling")
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
_TABLES = ("material", "surface", "model", "separation", "substrate", "instability", "device", "ensemble", "solver", "output")


def _is_coupled(tables: Mapping[str, Any]) -> bool:
    return bool(tables.get("substrate", {}).get("coupling", "none") != "none")


def _checked(tables: Mapping[str, Any]) -> None:
    """Refuses scenes that neither tilts nor splitting know."""
    for table, content in tables.items():
        if isinstance(content, Mapping) and table not in _TABLES:
            raise SceneError(f"{table}: rare patches are not computed with this table; `stiction run --above` with more replicas counts them")
    surface, ensemble = tables.get("surface", {}), tables.get("ensemble", {})
    for key in ("asperities", "spectrum", "summits", "radii"):
        if key in surface and surface[key] != "common":
            raise SceneError(f"surface.{key}: probabilities of rare patches are of asperities of one radius; give asperity_radius")
    given = surface.get("heights", "gaussian")
    name = given.get("law") if isinstance(given, Mapping) else given
    if name not in heights.LAWS:
        raise SceneError(f"surface.heights.law = {name!r}: a law of a formula is needed: {', '.join(heights.LAWS)}")
    if ensemble.get("sampling", "independent") != "independent":
        raise SceneError(f"ensemble.sampling = {ensemble['sampling']!r}: independent patches are needed")
    if _is_coupled(tables) and surface.get("count", "fixed") == "poisson":
        raise SceneError('surface.count = "poisson": coupled asperities of rare patches have a fixed number; count = "fixed"')
    if "heights" in ensemble:
        raise SceneError("ensemble.heights: patches are drawn by the law of `[surface]`; leave it out")
