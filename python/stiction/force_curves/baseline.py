"""The pull-off force of one recorded curve: its lowest force under the baseline of the retraction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import FileError

__all__ = ["PullOff", "pull_off"]

Array = NDArray[np.float64]
# A baseline is sought in the outer half, quarter, eighth and sixteenth of a branch, of so many samples at least.
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
        By how much the slope of the approach, continued to the turn, differs from that of the retraction, N, beyond
        what deviations of the approach hide.
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

    def at(self, x: Array) -> Array:
        return self.level + self.slope * (x - self.outer.mean())

    def noise(self, place: float) -> float:
        """What deviations hide at a place: twice the largest, and as much again for each length beyond the line."""
        reach = float(np.abs(place - self.outer).min() / np.ptp(self.outer))
        return 2.0 * (1.0 + reach) * self.deviation


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
    x, force = retraction[:, ::-1]
    lines = _baselines(x, force, is_sloped=is_sloped)
    if not lines:
        raise FileError("has no baseline on retraction; let it end farther from the surface")
    # A steep line hides the pull-off that another one shows.
    place = float(x[max(int((force - line.at(x)).argmin()) for line in lines)])
    own = min(lines, key=lambda line: line.noise(place))
    over, mismatch = force - own.at(x), 0.0
    if is_sloped:
        others = _baselines(*approach, is_sloped=True)
        if not others:
            raise FileError("has no baseline on approach, which its slope needs; or take slope none")
        turn = float(x[-1])
        other = min(others, key=lambda line: line.noise(turn))
        change = abs(own.slope - other.slope) * abs(turn - float(own.outer.mean()))
        mismatch = max(0.0, change - other.noise(turn))
    return PullOff(-float(over.min()), own.noise(place), mismatch)


def _baselines(x: Array, force: Array, *, is_sloped: bool) -> list[_Baseline]:
    """Lines through outer parts of a branch, farthest samples first, that the force in contact stands out of."""
    found = []
    for part in _PARTS:
        outer, forces = x[: x.size // part], force[: x.size // part]
        if outer.size < _FEWEST or np.ptp(outer) == 0.0:
            continue
        away, level = outer - outer.mean(), float(forces.mean())
        slope = float(away @ (forces - level) / (away @ away))
        contact = float((force - level - slope * (x - outer.mean())).max())
        if contact <= _STANDS_OUT * abs(slope) * float(np.ptp(outer)):
            continue
        kept = slope if is_sloped else 0.0
        found.append(_Baseline(outer, level, kept, float(np.abs(forces - level - kept * away).max())))
    return found
