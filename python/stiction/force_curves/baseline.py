"""The pull-off force of one recorded curve: its lowest force under the baseline of the retraction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import FileError

__all__ = ["PullOff", "pull_off"]

Array = NDArray[np.float64]
# A baseline is sought in the outer half, quarter and eighth of a branch, of so many samples at least.
_PARTS, _FEWEST = (2, 4, 8), 4
# A force that the baseline's largest deviation hides is up to this many times it; contact rises above a baseline
# by more than this many times the rise of the baseline itself.
_SEEN, _STANDS_OUT = 2.0, 3.0


@dataclass(frozen=True)
class PullOff:
    """What a curve gives.

    Attributes
    ----------
    force : float
        The pull-off force, N.
    noise : float
        What deviations of the baseline hide, N.
    mismatch : float
        By how much the pull-off changes with the slope of the approach in the place of that of the retraction, N,
        beyond what deviations of the approach hide.
    """

    force: float
    noise: float
    mismatch: float

    @property
    def resolution(self) -> float:
        """The force, N, below which the curve shows none."""
        return self.noise + 2.0 * self.mismatch


@dataclass(frozen=True)
class _Baseline:
    """A line through the outer samples of a branch, and what its deviations hide at some place, N."""

    level: float
    slope: float
    centre: float
    noise: float

    def at(self, x: Array) -> Array:
        return self.level + self.slope * (x - self.centre)


def pull_off(approach: Array, retraction: Array, *, is_sloped: bool) -> PullOff:
    """The pull-off force of a curve.

    Parameters
    ----------
    approach, retraction : array (2, n)
        What the slope of the baseline follows, and the force, N, in the order of time.
    is_sloped : bool
        Whether baselines have a slope. The approach is then needed, too: its baseline has to have the slope of that
        of the retraction, else the latter is no baseline.

    Raises
    ------
    FileError
        A branch has no baseline.
    """
    x, force = retraction
    own = _baseline(x[::-1], force[::-1], is_sloped=is_sloped)
    if own is None:
        raise FileError("has no baseline on retraction; let it end farther from the surface")
    over = force - own.at(x)
    lowest, mismatch = int(over.argmin()), 0.0
    if is_sloped:
        other = _baseline(*approach, is_sloped=True, place=float(x[lowest]))
        if other is None:
            raise FileError("has no baseline on approach, which its slope needs; or take slope none")
        change = abs(own.slope - other.slope) * abs(float(x[lowest]) - own.centre)
        mismatch = max(0.0, change - other.noise)
    return PullOff(-float(over[lowest]), own.noise, mismatch)


def _baseline(x: Array, force: Array, *, is_sloped: bool, place: float | None = None) -> _Baseline | None:
    """The baseline of a branch, farthest samples first: of lines through outer parts the one that hides least at a
    place, by default that of the lowest force. None where the force in contact does not stand out of it."""
    found = []
    for part in _PARTS:
        outer, forces = x[: x.size // part], force[: x.size // part]
        length = float(np.ptp(outer)) if outer.size >= _FEWEST else 0.0
        if length == 0.0:
            continue
        centre, level = float(outer.mean()), float(forces.mean())
        slope = float((outer - centre) @ (forces - level) / ((outer - centre) @ (outer - centre)))
        fitted = _Baseline(level, slope, centre, 0.0)
        if float((force - fitted.at(x)).max()) <= _STANDS_OUT * abs(slope) * length:
            continue
        line = fitted if is_sloped else _Baseline(level, 0.0, centre, 0.0)
        beyond = (float(x[(force - line.at(x)).argmin()]) if place is None else place) - outer
        # Beyond its length a curved baseline leaves its line as the square of the distance.
        reach = max(1.0, float(np.abs(beyond).min()) / length)
        noise = _SEEN * reach**2 * float(np.abs(forces - line.at(outer)).max())
        found.append(_Baseline(level, line.slope, centre, noise))
    return min(found, key=lambda line: line.noise, default=None)
