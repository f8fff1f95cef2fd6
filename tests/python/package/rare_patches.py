"""Patches by brute force, for probabilities of rare ones: heights, sums and maxima in numpy, without the program.

`python tests/python/package/rare_patches.py` prints a table: 200 seeds of each scene against
brute force or a closed form, some 40 minutes on one core.
"""

from __future__ import annotations

import functools
import sys
from dataclasses import dataclass

import numpy as np
from scipy import ndimage, stats

from stiction.design import Patches

RADIUS, MODULUS, WORK, SIGMA = 1e-6, 20e9, 0.02, 1.5e-9
#: Soft enough that the load of contact is nothing: the attraction is that of touch.
SOFT = 100.0
SEEDS = 200


def dmt(delta, modulus=MODULUS):
    """Attraction (N) at interferences (m) of Derjaguin, Muller and Toporov: 2πRΔγ less the load of Hertz."""
    load = 4.0 / 3.0 * modulus * np.sqrt(RADIUS) * np.maximum(delta, 0.0) ** 1.5
    return np.where(delta >= 0.0, 2.0 * np.pi * RADIUS * WORK - load, 0.0)


def _jkr_curve(modulus):
    """Contact radii from that of first touch on, with interference and attraction there (Johnson, Kendall, Roberts)."""
    touch = (2.0 * np.pi * WORK * RADIUS**2 / modulus) ** (1.0 / 3.0)
    a = touch * np.linspace(1.0, 12.0, 20_001)
    adhesion = np.sqrt(2.0 * np.pi * WORK * a / modulus)
    return a**2 / RADIUS - adhesion, 2.0 * modulus * a * adhesion - 4.0 / 3.0 * modulus * a**3 / RADIUS


def jkr(delta, modulus=MODULUS):
    """Attraction (N) at interferences (m) on approach: nothing before touch."""
    at, attraction = _jkr_curve(modulus)
    return np.where(delta >= 0.0, np.interp(delta, at - at[0], attraction), 0.0)


def falling(attraction, zero, z, threshold):
    """Pull-off of patches (n, asperities) for an attraction that jumps at touch and falls from there on.

    The largest sum is where an asperity just touches. Beyond `zero` asperities push, so that patches without enough of
    them so close together stay below the threshold: they count as 0.
    """
    z = -np.sort(-z, axis=1)
    least = int(np.ceil(threshold / float(attraction(np.array(0.0))))) - 1
    best = np.zeros(len(z))
    if least >= z.shape[1]:
        return best
    # At most what all taller ones pull, less the push of the highest four.
    one, most = float(attraction(np.array(0.0))), np.arange(least + 1, z.shape[1] + 1) * float(attraction(np.array(0.0)))
    near = z[:, : z.shape[1] - least] - z[:, least:] <= zero
    for place in range(min(least, 4)):
        pushed = attraction(z[:, place, None] - z[:, least:])
        most = most + np.where(pushed < 0.0, pushed - one, 0.0)
    row, last = np.nonzero(near & (most > threshold))
    last += least
    for first in range(0, row.size, 20_000):
        part = slice(first, first + 20_000)
        width = int(last[part].max(initial=0)) + 1
        taller = z[row[part], :width] - z[row[part], last[part]][:, None]
        sums = np.where(np.arange(width) <= last[part][:, None], attraction(np.maximum(taller, 0.0)), 0.0).sum(axis=1)
        np.maximum.at(best, row[part], sums)
    return best


def smooth(attraction, width, z, threshold):
    """Pull-off of patches (n, asperities) that may be above a threshold: the largest sum at separations of the tops, closer
    and closer about the best one. Others count as 0: the sum of the largest attractions within steps of half the width.
    """
    best = np.zeros(len(z))
    around = np.linspace(-0.25, 0.25, 65) * width
    fine = np.arange(z.min() - width, z.max() + width, width / 128.0)
    highest = ndimage.maximum_filter1d(attraction(fine - 0.5 * (z.min() + z.max())), 67)

    def most(delta):
        return np.interp(delta, fine - 0.5 * (z.min() + z.max()), highest, left=0.0, right=0.0)

    coarse = np.arange(-6.0 * SIGMA, 6.0 * SIGMA, 0.5 * width)
    bound = np.zeros((len(z), coarse.size))
    for column in z.T:
        bound += most(column[:, None] - coarse)
    row, place = np.nonzero(bound > threshold)
    for first in range(0, row.size, 2000):
        part = slice(first, first + 2000)
        of, at, step = z[row[part]], coarse[place[part]][:, None] + around, width / 128.0
        for _ in range(4):
            sums = attraction(of[:, :, None] - at[:, None, :]).sum(axis=1)
            chosen = at[np.arange(len(at)), sums.argmax(axis=1)]
            at, step = chosen[:, None] + step * np.linspace(-1.0, 1.0, 9), step / 4.0
        np.maximum.at(best, row[part], sums.max(axis=1))
    return best


@dataclass(frozen=True)
class Scene:
    """A scene of the table: law, asperities, threshold (N), stiffness (Pa), and the probability if it is a closed form."""

    law: str
    count: int
    threshold: float
    modulus: float = MODULUS
    truth: float | None = None
    #: Separation of the scene if it is one, in σ.
    height: float | None = None
    below: bool = False

    def tables(self):
        """What stands in a file of it."""
        h = {"from": "-1 nm", "to": "20 nm", "count": 85}
        if self.height is not None:
            h = {"from": f"{self.height * SIGMA!r} m", "to": f"{(self.height + 3.0) * SIGMA!r} m", "count": 13}
        return {
            "material": {"reduced_modulus": f"{self.modulus!r} Pa", "hardness": "1 TPa", "poisson_ratio": 0.3,
                         "work_of_adhesion": f"{WORK} J/m^2", "equilibrium_spacing": "0.3 nm"},
            "surface": {"asperity_radius": f"{RADIUS!r} m", "asperity_density": "1 /um^2", "asperity_height_std": f"{SIGMA!r} m",
                        "mean_plane_offset": "0 nm", "nominal_area": f"{self.count} um^2"},
            "model": {"law": self.law},
            "separation": {"h": h},
            "ensemble": {"replicas": 10},
        }  # fmt: skip


def solver(scene):
    """A function from heights (n, asperities) to pull-off, of the law of a scene."""
    if scene.law == "hybrid":
        at, values = Patches(scene.tables(), seed=1)._asperity

        def attraction(delta):
            return np.interp(delta, at, values)

        strong = at[values > 0.5 * values.max()]
        return lambda z: smooth(attraction, float(strong[-1] - strong[0]), z, scene.threshold)
    law = dmt if scene.law == "dmt" else jkr

    def attraction(delta):
        return law(delta, scene.modulus)

    delta = np.linspace(0.0, 20.0 * SIGMA, 200_001)
    zero = float(delta[attraction(delta) > 0.0].max())
    if scene.height is None:
        return lambda z: falling(attraction, zero, z, scene.threshold)
    # The number above the closest separation, of which each pulls alike.
    one, least = float(attraction(np.array(0.0))), scene.height * SIGMA
    return lambda z: one * (z > least).sum(axis=1)


def brute(scene, solve, patches, seed=11, size=20_000):
    """The probability by brute force, and its standard error."""
    rng, hits = np.random.default_rng(seed), 0
    size = max(min(size, 2_000_000 // scene.count), 1)
    for _ in range(-(-patches // size)):
        hits += int((solve(rng.normal(0.0, SIGMA, (size, scene.count))) > scene.threshold).sum())
    n = -(-patches // size) * size
    return hits / n, np.sqrt(hits) / n


ONE = 2.0 * np.pi * RADIUS * WORK


def _counted(law, count, height, least, below=False):
    """A scene in which asperities above a height count, a binomial number: so many at least, or fewer."""
    one = float((dmt if law == "dmt" else jkr)(np.array(0.0), SOFT))
    number = stats.binom(count, stats.norm.sf(height))
    truth = float(number.cdf(least - 1) if below else number.sf(least - 1))
    return Scene(law, count, (least - 0.5) * one, SOFT, truth, height, below)


#: Scenes, and the patches of brute force (none where there is a closed form).
SCENES = {
    "dmt, 5000, counted": (_counted("dmt", 5000, 4.7, 1), 0),
    "jkr, 5000, counted": (_counted("jkr", 5000, 2.5, 57), 0),
    "dmt, 100, counted": (_counted("dmt", 100, 2.5, 6), 0),
    "dmt, 100": (Scene("dmt", 100, 631.46e-9), 2_000_000),
    "dmt, 10": (Scene("dmt", 10, 4.2 * ONE), 20_000_000),
    "jkr, 10": (Scene("jkr", 10, 1.97 * ONE), 4_000_000),
    "hybrid, 10": (Scene("hybrid", 10, 3.23 * ONE), 2_000_000),
    "hybrid, 100": (Scene("hybrid", 100, 7.25 * ONE), 400_000),
    "jkr, 100": (Scene("jkr", 100, 2.64 * ONE), 4_000_000),
    "dmt, 100, fewer": (_counted("dmt", 100, 1.5, 1, below=True), 0),
}


def estimates(scene, seeds, error=0.1):
    """Probabilities by `design`, a seed each, from one pilot of the program."""
    patches = Patches(scene.tables(), seed=1)
    # The laws of a threshold are the same for all seeds.
    patches._tilts.mixture = functools.cache(patches._tilts.mixture)
    found = []
    for seed in seeds:
        patches.reseed(seed)
        found.append(patches.probability(scene.threshold, below=scene.below, error=error))
    return found


def summary(found, truth):
    """Mean over truth, its standard error, and the share of intervals that hold the truth."""
    values = np.array([one.value for one in found]) / truth
    held = np.mean([one.interval[0] <= truth <= one.interval[1] for one in found])
    return float(values.mean()), float(values.std(ddof=1) / len(found) ** 0.5), float(held)


def main():
    """Prints the table."""
    for name in sys.argv[1:] or SCENES:
        scene, number = SCENES[name]
        truth, error = (scene.truth, 0.0) if scene.truth else brute(scene, solver(scene), number)
        found = estimates(scene, range(SEEDS))
        mean, spread, held = summary(found, truth)
        print(
            f"| {name} | {truth:.3e} ± {100 * error / truth:.1f} % | {mean:.3f} ± {spread:.3f} | {100 * held:.1f} % "
            f"| {np.mean([one.replicas for one in found]):.0f} | {np.mean([one.effective for one in found]):.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
