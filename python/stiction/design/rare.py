r"""Probabilities of rare patches by tilted heights.

The asperities of a patch are independent, so its force is a sum, and its pull-off F the largest attraction over all separations: F = max_h
S(h), S(h) = Σ_i a(z_i − d), with the attraction a(δ) of one asperity (minus its external force) at the interference δ = z − d. Heights are drawn
from tilted laws

.. math:: q_j(z) = p(z) \exp\Big(\sum_k \theta_{jk}\, a(z - d_k) - \psi_j\Big), \qquad
          \psi_j = \log \operatorname{E} \exp\Big(\sum_k \theta_{jk}\, a(z - d_k)\Big),

under which a patch of N asperities has the likelihood ratio exp(Nψ_j − Σ_k θ_jk S(d_k)): a number that *the curve of the patch itself*
tells. So the program draws and solves patches as ever, from lists of heights of these laws, and its own exact pull-off decides which are in the
event. Replicas of all laws are weighed together (balance heuristic),

.. math:: \hat p = \frac1n \sum_i \frac{1[F_i \in A]}{\sum_j (n_j/n) \exp(\sum_k \theta_{jk} S_i(d_k) - N \psi_j)},

which is unbiased for any choice of the tilts. They are chosen so:

* F above x is a union over separations. For each of them θ > 0 is that of Chernoff's bound, the supremum of θx − Nψ(θ), which makes x the
  mean of S(d); separations are in the mixture as their bounds exp(−rate) are large.
  Where S is above x at one of these, the weight is at most the bound over the share of its law.
* F below x is an intersection. One tilt of several separations together is found level by level, by the cross-entropy method: θ is such that
  mean attractions Nψ′(θ) are those of the patches below the level. Tilts of all levels are used together: weak ones cover what strong ones miss.

Patches that tilts were found with are not in the estimate.

References: D. Siegmund, *Ann. Stat.* **4** (1976) 673; D. Q. Naiman, C. E. Priebe, *J. Comput. Graph. Stat.* **10** (2001)
296 (maxima); R. Y. Rubinstein, D. P. Kroese, *The Cross-Entropy Method*, Springer (2004); E. Veach, L. J. Guibas, *Proc. SIGGRAPH* (1995) 419; A. Owen, Y. Zhou,
*J. Am. Stat. Assoc.* **95** (2000) 135 (mixtures).
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray
from scipy import optimize, special, stats

from .. import experiments, quantities, single
from ..errors import SceneError, StictionError

__all__ = ["Patches", "Probability"]

Array = NDArray[np.float64]

# Heights of a list: more than a patch has by far, so that those of a patch hardly come from the same one.
_LIST = 2**19
# Points of the quadrature over heights, and those at which tilts are looked for.
_GRID, _COARSE = 2**18, 2**12
# Tilted laws of one mixture, and separations of the tilt of an intersection.
_LAWS, _SEPARATIONS = 8, 12
# Levels of an intersection, and what holds its tilts back where few patches tell them.
_LEVELS, _RIDGE, _KEPT = 20, 2.0, 20
# Laws of heights whose densities are known.
_HEIGHTS = ("gaussian", "truncated", "exponential", "weibull", "lognormal")
# Replicas of a scene's own law, and of all tilted laws at first.
_PILOT, _FIRST = 256, 512
# In the event at least, before an error is believed.
_HITS = 100


@dataclass(frozen=True)
class Probability:
    """The probability of an event, and how well it is known.

    Attributes
    ----------
    value, standard_error : float
        Estimate and its standard error.
    replicas : int
        Patches that were computed for it.
    hits : int
        Those of them in the event.
    total : float
        Mean of all weights, which is 1 but for chance.
    total_error : float
        Its standard error.
    """

    value: float
    standard_error: float
    replicas: int
    hits: int
    total: float
    total_error: float

    @property
    def relative_error(self) -> float:
        """Standard error over the value."""
        return self.standard_error / self.value if self.value > 0.0 else float("inf")

    @property
    def interval(self) -> tuple[float, float]:
        """What holds the probability in 95 of 100 cases: normal in the logarithm, never below 0."""
        spread = float(np.exp(1.96 * self.relative_error))
        return self.value / spread, min(self.value * spread, 1.0)


@dataclass(frozen=True)
class _Law:
    """Heights tilted by θ (1/N) at separations of the scene, by their indices; log-moment ψ."""

    at: NDArray[np.intp]
    theta: Array
    psi: float


# The scene's own heights.
_OWN = _Law(np.array([], dtype=np.intp), np.array([]), 0.0)


@dataclass(frozen=True)
class _Drawn:
    """Patches of one law: pull-off (n,), attraction (n, separations), number of asperities (n,)."""

    pull_off: Array
    attraction: Array
    count: Array


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
        The scene is wrong, or has what cannot be tilted; the message names the key.
    """

    def __init__(self, tables: Mapping[str, Any], *, seed: int | None = None, threads: int | None = None) -> None:
        _tiltable(tables)
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
        self.heights = _law_of_heights(self.tables["surface"].get("heights", "gaussian"), sigma)
        self.count = float(self.pilot.count.mean())
        low, high = (float(self.heights.ppf(1e-18)), float(self.heights.isf(1e-18)))
        d = self.separations - self.offset
        self._asperity = _attraction(self.tables, low - float(d.max()), high - float(d.min()))
        self._grid, self._coarse = (_Quadrature(self.heights, low, high, size) for size in (_GRID, _COARSE))
        coarse = self._coarse.z[None, :] - d[:, None]
        self._of_separations = np.interp(coarse, *self._asperity)

    def probability(
        self, threshold: float, *, below: bool = False, error: float = 0.1, most: int = 200_000
    ) -> Probability:
        """The probability that the pull-off force of a patch is above (or below) a threshold.

        Parameters
        ----------
        threshold : float
            N.
        below : bool
            Whether patches below it count, else those above.
        error : float
            Relative standard error that is wanted.
        most : int
            Replicas at most.

        Raises
        ------
        StictionError
            With so many replicas the error is not reached.
        """
        return self._sampled(threshold, below, error, most)[0]

    def quantile(
        self, probability: float, *, below: bool = False, error: float = 0.1, most: int = 200_000
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
            With so many replicas the error is not reached.
        """
        force = float(np.quantile(self.pilot.pull_off, max(probability, 0.02) if below else 1.0 - max(probability, 0.02)))
        spread = float(self.pilot.pull_off.std())
        for _ in range(_LEVELS):
            found, pull_off, weights = self._sampled(force, below, error, most)
            order = np.argsort(pull_off if below else -pull_off)
            shares = np.cumsum(weights[order]) / len(order)
            wanted = probability * np.exp(np.array([0.0, -1.96, 1.96]) * found.relative_error)
            at = pull_off[order][np.searchsorted(shares, np.minimum(wanted, shares[-1])).clip(0, len(order) - 1)]
            # Patches were drawn for one force, and are good for forces about it.
            if abs(np.log(found.value / probability)) < 1.5:
                return float(at[0]), (float(at[1:].min()), float(at[1:].max()))
            # At most one standard deviation beyond where patches were drawn for.
            force = float(np.clip(at[0], force - spread, force + spread))
        side = "below" if below else "above"
        raise StictionError(f"no force {side} which a patch pulls with probability {probability:g} was found")

    def _sampled(self, threshold: float, below: bool, error: float, most: int) -> tuple[Probability, Array, Array]:
        """The probability, and pull-off (N) and weight of the patches that it is of."""

        def told(laws: list[_Law], drawn: list[_Drawn]) -> tuple[Probability, Array, Array]:
            forces = np.concatenate([of.pull_off for of in drawn])
            return found, forces, np.concatenate(_weights(laws, drawn))

        found = _estimate([_OWN], [self.pilot], threshold, below)
        if found.hits >= _HITS and found.relative_error <= error:
            return told([_OWN], [self.pilot])
        tilted, shares = self._descend(threshold) if below else self._tilts(threshold)
        # A tenth are of the scene's own heights; all are, where none are tilted. Patches that tilts were found with do not count.
        laws, shares = [_OWN, *tilted], np.array([0.1, *(0.9 * shares)] if tilted else [1.0])
        drawn = [_Drawn(np.empty(0), np.empty((0, self.separations.size)), np.empty(0)) for _ in laws]
        size = _FIRST
        while True:
            for place, share in enumerate(shares):
                drawn[place] = _joined(drawn[place], self._draw(laws[place], max(int(np.ceil(share * size)), 8)))
            found = _estimate(laws, drawn, threshold, below)
            n = found.replicas
            if found.hits >= _HITS and found.relative_error <= error:
                return told(laws, drawn)
            if n >= most:
                break
            ratio = (found.relative_error / error) ** 2 if found.hits >= 20 else 4.0
            size = int(min(max(1.1 * (ratio - 1.0) * n, 0.5 * n), 4.0 * n, most - n + 64))
        side = "below" if below else "above"
        raise StictionError(
            f"the probability of a pull-off {side} {quantities.si(threshold, 'N')} is known to {100 * found.relative_error:.0f} % only "
            f"after {n} patches, {found.hits} of them {side} it: a larger error, or more replicas are needed"
        )

    def _tilts(self, x: float) -> tuple[list[_Law], Array]:
        """The tilted laws for patches above x, and how many of the replicas each has."""
        best = [self._chernoff(x, place) for place in range(self.separations.size)]
        rates = np.array([rate for _, rate in best])
        if not np.isfinite(rates).any():
            most = self.count * float(self._asperity[1].max())
            raise SceneError(f"no patch pulls harder than {quantities.si(most, 'N')}, all asperities at once: {quantities.si(x, 'N')} is above")
        if not (rates > 1.0).all():
            return [], np.array([])
        bound = np.exp(rates.min() - rates)
        # As many places as laws, each in the middle of an equal part of the sum of bounds.
        parts = np.cumsum(bound) / bound.sum()
        places, number = np.unique(np.searchsorted(parts, (np.arange(_LAWS) + 0.5) / _LAWS), return_counts=True)
        laws = [self._tilted(np.array([place]), np.array([best[place][0]])) for place in places]
        return laws, number / number.sum()

    def _chernoff(self, x: float, place: int) -> tuple[float, float]:
        """θ ≥ 0 (1/N) and the supremum of θx − Nψ(θ) at a separation."""
        a, scale = self._of_separations[place], float(self._asperity[1].max())
        mean = self.count * self._coarse.mean(a)
        if mean >= x:
            return 0.0, 0.0
        if a.max() * self.count <= x:
            return 0.0, np.inf

        def cost(t: float) -> float:
            return self.count * self._coarse.log_moment(t / scale * a) - t * x / scale

        found = optimize.minimize_scalar(cost, bounds=(0.0, 200.0), method="bounded", options={"xatol": 1e-4})
        return float(found.x) / scale, -float(found.fun)

    def _descend(self, x: float) -> tuple[list[_Law], Array]:
        """The laws of all levels until patches below x are common under, found level by level, and how many of the replicas each has."""
        laws, drawn = [_OWN], [self.pilot]
        # Where single patches pull most; the deepest of a curve is within.
        low, high = np.quantile(self.pilot.attraction.argmax(axis=1), [0.02, 0.98])
        at = np.unique(np.linspace(low, high, _SEPARATIONS).round().astype(int))
        a, scale = self._of_separations[at], float(self._asperity[1].max())
        theta = np.zeros(at.size)
        for _ in range(_LEVELS):
            level = max(x, float(np.quantile(drawn[-1].pull_off, 0.15)))
            inside = np.concatenate([of.pull_off for of in drawn]) < level
            weights = np.concatenate(_weights(laws, drawn))[inside]
            of_event = np.concatenate([of.attraction[:, at] for of in drawn])[inside]
            wanted = (weights @ of_event) / weights.sum() / scale

            def cost(t: Array, wanted: Array = wanted) -> tuple[float, Array]:
                exponent = t @ a / scale
                psi = self._coarse.log_moment(exponent)
                tilted = np.exp(self._coarse.log_weights + exponent - psi)
                gradient = self.count * (a @ tilted) / scale - wanted + 2.0 * _RIDGE * t
                return self.count * psi - float(t @ wanted) + _RIDGE * float(t @ t), gradient

            theta = optimize.minimize(cost, theta, jac=True, method="BFGS", options={"gtol": 1e-3}).x
            law = self._tilted(at, theta / scale)
            laws.append(law)
            drawn.append(self._draw(law, _FIRST))
            if level == x and (drawn[-1].pull_off < x).sum() >= _HITS:
                break
        kept = laws[1:][-_KEPT:]
        return kept, np.full(len(kept), 1.0 / len(kept))

    def _tilted(self, at: NDArray[np.intp], theta: Array) -> _Law:
        return _Law(at, theta, self._grid.log_moment(self._exponent(at, theta)))

    def _exponent(self, at: NDArray[np.intp], theta: Array) -> Array:
        total = np.zeros_like(self._grid.z)
        for place, one in zip(at, theta, strict=True):
            total += one * np.interp(self._grid.z - (self.separations[place] - self.offset), *self._asperity)
        return total

    def _draw(self, law: _Law, replicas: int) -> _Drawn:
        """Patches of a tilted law, or of the scene's own where it has no tilt."""
        if not law.at.size:
            with self._run(self.tables, replicas) as run:
                return _drawn(run)
        heights = self._grid.drawn(self._exponent(law.at, law.theta), self._seeds.random(_LIST))
        with tempfile.TemporaryDirectory(prefix="stiction-") as folder:
            path = Path(folder) / "heights.h5"
            with h5py.File(path, "w") as file:
                file["heights"] = heights
            surface = {
                key: value for key, value in self.tables["surface"].items() if key not in ("surface_height_std", "asperity_height_std")
            }
            surface |= {
                "heights": {"law": "file", "path": str(path), "dataset": "heights", "unit": "m"},
                "mean_plane_offset": f"{self.offset!r} m",
            }
            # Heights of a list are taken about their mean.
            h = [f"{value!r} m" for value in (self.separations - heights.mean()).tolist()]
            with self._run({**self.tables, "surface": surface, "separation": {"h": h}}, replicas) as run:
                return _drawn(run)

    def _run(self, tables: Mapping[str, Any], replicas: int) -> Any:
        seed = int(self._seeds.integers(2**62))
        return experiments.run(tables, replicas=replicas, seed=seed, threads=self.threads, progress=False)


class _Quadrature:
    """Expectations over heights on a grid of equal steps, the trapezoidal rule on the density."""

    def __init__(self, heights: Any, low: float, high: float, size: int) -> None:
        self.z = np.linspace(low, high, size)
        # Of each point the probability of its cell, so that kinks and ends of the law lose nothing.
        edges = np.concatenate([[low], 0.5 * (self.z[1:] + self.z[:-1]), [high]])
        middle = float(heights.median())
        self.weights = np.where(
            edges[1:] > middle, heights.sf(edges[:-1]) - heights.sf(edges[1:]), heights.cdf(edges[1:]) - heights.cdf(edges[:-1])
        )
        self.weights /= self.weights.sum()
        with np.errstate(divide="ignore"):
            self.log_weights = np.log(self.weights)

    def mean(self, values: Array) -> float:
        return float(self.weights @ values)

    def log_moment(self, exponent: Array) -> float:
        """log E exp(exponent)."""
        return float(special.logsumexp(exponent + self.log_weights))

    def drawn(self, exponent: Array, uniform: Array) -> Array:
        """Heights of the tilted law, one in each of equally probable parts."""
        log = exponent + self.log_weights
        cumulated = np.cumsum(np.exp(log - log.max()))
        edges = np.concatenate([[self.z[0]], 0.5 * (self.z[1:] + self.z[:-1]), [self.z[-1]]])
        shares = (np.arange(uniform.size) + uniform) / uniform.size
        heights: Array = np.interp(shares, np.concatenate([[0.0], cumulated / cumulated[-1]]), edges)
        return heights


def _drawn(run: Any) -> _Drawn:
    force = run["replicas/external_force"].transpose("replica", "separation").values
    return _Drawn(run["replicas/pull_off_force"].values, -force, run["replicas/asperity_count"].values.astype(float))


def _joined(first: _Drawn, second: _Drawn) -> _Drawn:
    return _Drawn(
        np.concatenate([first.pull_off, second.pull_off]),
        np.concatenate([first.attraction, second.attraction]),
        np.concatenate([first.count, second.count]),
    )


def _weights(laws: list[_Law], drawn: list[_Drawn]) -> list[Array]:
    """Likelihood of each patch under the scene's own law over that under the mixture of all."""
    sizes = np.array([len(of.pull_off) for of in drawn], dtype=float)
    weights = []
    for of in drawn:
        logs = [of.attraction[:, law.at] @ law.theta - of.count * law.psi for law in laws]
        weights.append(np.exp(-special.logsumexp(logs, axis=0, b=(sizes / sizes.sum())[:, None])))
    return weights


def _estimate(laws: list[_Law], drawn: list[_Drawn], threshold: float, below: bool) -> Probability:
    n = sum(len(of.pull_off) for of in drawn)
    value = variance = total = total_variance = 0.0
    hits = 0
    for of, weight in zip(drawn, _weights(laws, drawn), strict=True):
        size = len(of.pull_off)
        if size < 2:
            continue
        inside = of.pull_off < threshold if below else of.pull_off > threshold
        hits += int(inside.sum())
        value += size / n * float((weight * inside).mean())
        total += size / n * float(weight.mean())
        variance += (size / n) ** 2 * float((weight * inside).var(ddof=1)) / size
        total_variance += (size / n) ** 2 * float(weight.var(ddof=1)) / size
    return Probability(value, variance**0.5, n, hits, total, total_variance**0.5)


def _tiltable(tables: Mapping[str, Any]) -> None:
    """Refuses what a tilt of heights does not know."""
    for table in ("substrate", "capillary", "van_der_waals", "electrostatic", "instability", "sweep"):
        if table in tables:
            raise SceneError(f"{table}: probabilities of rare patches are of independent asperities alone; leave the table out")
    surface, ensemble = tables.get("surface", {}), tables.get("ensemble", {})
    for key in ("asperities", "spectrum", "summits", "radii"):
        if key in surface and surface[key] != "common":
            raise SceneError(f"surface.{key}: probabilities of rare patches are of asperities of one radius; give asperity_radius")
    heights = surface.get("heights", "gaussian")
    name = heights.get("law") if isinstance(heights, Mapping) else heights
    if name not in _HEIGHTS:
        raise SceneError(f"surface.heights.law = {name!r}: a law of a formula is needed: {', '.join(_HEIGHTS)}")
    if tables.get("model", {}).get("history", "approach") == "loop":
        raise SceneError('model.history = "loop": "approach" or "retraction" is needed')
    if ensemble.get("sampling", "independent") != "independent":
        raise SceneError(f"ensemble.sampling = {ensemble['sampling']!r}: independent patches are needed")


def _law_of_heights(given: Any, sigma: float) -> Any:
    """The law of heights of a scene, of mean 0 and the standard deviation σ_s, as the program has it."""
    table = {"law": given} if isinstance(given, str) else dict(given)
    name = table["law"]
    if name == "gaussian":
        return stats.norm(scale=sigma)
    if name == "truncated":
        return stats.truncnorm(table.get("lower", -np.inf), table.get("upper", np.inf), scale=sigma)
    if name == "exponential":
        law = stats.expon()
    else:
        law = (stats.weibull_min if name == "weibull" else stats.lognorm)(table["shape"])
    scale = sigma / float(law.std())
    # The same law about its mean and in metres.
    return law.dist(*law.args, loc=-scale * float(law.mean()), scale=scale)


def _attraction(tables: Mapping[str, Any], low: float, high: float) -> tuple[Array, Array]:
    """Interferences (m) and the attraction of an asperity there (N), close where it jumps."""
    material, surface, model = tables["material"], tables["surface"], tables["model"]

    def number(table: Mapping[str, Any], key: str) -> float:
        return quantities.parsed(key, table[key])[0]

    if "reduced_modulus" in material:
        modulus = number(material, "reduced_modulus")
    else:
        bodies = zip(material["youngs_modulus"], material["poissons_ratio"], strict=True)
        modulus = 1.0 / sum((1.0 - ratio**2) / quantities.parsed("youngs_modulus", young)[0] for young, ratio in bodies)
    if "work_of_adhesion" in material:
        work = number(material, "work_of_adhesion")
    else:
        first, second = (quantities.parsed("surface_energy", one)[0] for one in material["surface_energy"])
        work = first + second - number(material, "interface_energy")
    law: dict[str, Any] = {
        "radius": number(surface, "asperity_radius"),
        "reduced_modulus": modulus,
        "work_of_adhesion": work,
        "equilibrium_spacing": number(material, "equilibrium_spacing"),
        "hardness": number(material, "hardness"),
        "poisson_ratio": float(material["poisson_ratio"]),
        "lubricant_thickness": number(surface, "lubricant_thickness") if "lubricant_thickness" in surface else 0.0,
        "law": model["law"],
        "path": model.get("history", "approach"),
    }

    def solved(at: Array) -> Array:
        values: Array = -single.asperity(interference=at, **law).external_force.values
        return values

    at = np.linspace(low, high, 2**16)
    values = solved(at)
    scale = float(values.max())
    if not scale > 0.0:
        raise SceneError(f"model.law = {model['law']!r}: an asperity of this law does not attract, so nothing pulls off")
    for _ in range(14):
        jumps = np.flatnonzero((np.abs(np.diff(values)) > 2e-3 * scale) & (values[1:] > -2.0 * scale))
        if not jumps.size:
            break
        middle = 0.5 * (at[jumps] + at[jumps + 1])
        at, values = np.insert(at, jumps + 1, middle), np.insert(values, jumps + 1, solved(middle))
    return at, values
