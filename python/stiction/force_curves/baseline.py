"""The pull-off force of one recorded curve: its lowest force under the baseline of the retraction."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..errors import FileError

__all__ = ["PullOff", "pull_off"]

Array = NDArray[np.float64]
# A baseline is sought in the outer half, quarter, eighth and sixteenth of a branch, of at least this number of samples.
_PARTS, _FEWEST = (2, 4, 8, 16), 4
# Contact rises above a baseline by more than this many times the rise of the baseline itself.
_STANDS_OUT = 3.0


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
        By how much the slope of the approach, or none, differs from that of the retraction at the turn, N, beyond
        noise.
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
    """A line through the outer samples of a branch, by their mean and slope, and their largest deviation, N."""

    outer: Array
    level: float
    slope: float
    deviation: float

    @property
    def centre(self) -> float:
        return float(self.outer.mean())

    def above(self, x: Array, force: Array) -> Array:
        """The force minus the line, N."""
        return force - self.level - self.slope * (x - self.centre)

    def noise(self, place: float) -> float:
        """What deviations hide at a place: a line that they tilt is farther off beyond its length."""
        reach = float(np.abs(place - self.outer).min() / np.ptp(self.outer))
        return max(2.0, 1.0 + 2.0 * reach) * self.deviation


def pull_off(approach: Array, retraction: Array, *, is_sloped: bool) -> PullOff:
    """The pull-off force of a curve.

    Parameters
    ----------
    approach, retraction : array (2, n)
        What the slope of the baseline follows, and the force, N, in the order of time.
    is_sloped : bool
        Whether the baseline has a slope. The approach is then needed, too: its baseline has to have the slope of
        that of the retraction.

    Raises
    ------
    FileError
        A branch has no baseline.
    """
    x, force = retraction[:, ::-1]
    lines = _baselines(x, force)
    if not lines:
        raise FileError("has no baseline on retraction; let it end farther from the surface")
    # A steep line hides the pull-off that another one shows.
    place, turn = float(x[max(int(line.above(x, force).argmin()) for line in lines)]), float(x[-1])
    own = min(lines, key=lambda line: line.noise(place))
    if is_sloped:
        others = _baselines(*approach)
        if not others:
            raise FileError(
                "has no baseline on approach that confirms the slope of the retraction; take slope none"
            )
        used, other = own, min(others, key=lambda line: line.noise(turn))
    else:
        used = other = replace(own, slope=0.0)
    change = abs(own.slope - other.slope) * abs(turn - own.centre)
    lowest = float(used.above(x, force).min())
    return PullOff(-lowest, own.noise(place), max(0.0, change - other.noise(turn)))


def _baselines(x: Array, force: Array) -> list[_Baseline]:
    """Lines through outer parts of a branch, farthest samples first, that the force in contact stands out of."""
    samples, found = np.arange(x.size, dtype=float), []
    for count in (x.size // part for part in _PARTS):
        if count < _FEWEST or np.ptp(x[:count]) == 0.0:
            continue
        # On a stiff surface the tip stays where it is, so contact is known by samples.
        trend = _line(samples, force, count)
        if trend.above(samples, force).max() > _STANDS_OUT * abs(trend.slope) * count:
            found.append(_line(x, force, count))
    return found


def _line(x: Array, force: Array, count: int) -> _Baseline:
    outer, forces = x[:count], force[:count]
    away, level = outer - outer.mean(), float(forces.mean())
    slope = float(away @ (forces - level) / (away @ away))
    return _Baseline(outer, level, slope, float(np.abs(forces - level - slope * away).max()))
