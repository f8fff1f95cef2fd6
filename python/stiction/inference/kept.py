"""Simulated patches with their parameters, kept in a file as they are made."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from .. import files, stored
from ..errors import FileError, StictionError
from ..priors import Priors
from ..progress import Bar, work
from ..version import __version__
from .data import Measurements
from .emulator import ROW, Patches, simulate

__all__ = ["GROUP", "Kept", "partial", "source", "stating_what_is_kept"]

Array = NDArray[np.float64]
#: The group of files that has the patches.
GROUP = "simulated"
# Patches of a sweep, a second of most scenes, which an interruption loses; and parameter sets of one at most.
_OF_A_SWEEP, _POINTS = 1600, 16
# Numbers below are none that a patch has.
_TINY = float(np.finfo(float).tiny)


def partial(output: Path) -> Path:
    """Where the patches of an unfinished inference are kept."""
    return output.with_name(f"{output.name}.partial")


def source(output: Path, resume: bool, force: bool) -> Path | None:
    """The file whose patches are gone on with, if that is wanted.

    Raises
    ------
    FileError
        There is none, or there is one that nothing says what to do with.
    """
    if resume:
        found = [path for path in (partial(output), output) if path.exists()]
        if not found:
            raise FileError(f"{output}: neither it nor {partial(output).name} is there to go on with; leave resume=True out")
        return found[0]
    if not force and partial(output).exists():
        raise FileError(
            f"{partial(output)}: has the patches of an interrupted inference; resume=True goes on with them, force=True begins anew"
        )
    return None


@contextmanager
def stating_what_is_kept(output: Path | None, what: str) -> Iterator[None]:
    """States what an interruption, a full disk or a process that ended leaves in the file of an unfinished inference."""

    def kept() -> str:
        if output is None:
            return "; nothing was kept, as no output was named"
        return f"; {partial(output)} has {what}; resume=True goes on with them" if partial(output).exists() else "; nothing is kept yet"

    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"interrupted{kept()}") from None
    except OSError as error:
        raise StictionError(f"{error}{kept()}") from None
    except BrokenExecutor:
        raise StictionError(f"a process of the experiments was ended, such as for want of memory; fewer threads need less{kept()}") from None


@dataclass(frozen=True)
class _Piece:
    """The patches of a sweep under a set of conditions, rows of `ROW` patches, and whether they were made for other data."""

    condition: int
    patches: Patches
    is_former: bool


class Kept:
    """The patches of a scene, in the order in which they are made; what is there already is not made again.

    Parameters
    ----------
    priors : Priors
    measured : Measurements
    seed : int
    threads : int, optional
        As in `stiction.sweep`.
    path : path, optional
        The file that is written after each sweep.
    """

    def __init__(
        self, priors: Priors, measured: Measurements, seed: int, threads: int | None = None, path: Path | None = None
    ) -> None:
        self.priors, self.measured, self._seed, self._threads, self._path = priors, measured, seed, threads, path
        self._pieces: list[_Piece] = []
        self._found: list[_Piece] = []
        # Patches that were made, and the seconds they took.
        self._made, self._took = 0, 0.0

    @property
    def count(self) -> int:
        """Number of patches."""
        return sum(piece.patches.logs[..., 0].size for piece in self._pieces)

    def former(self) -> list[Patches] | None:
        """For each set of conditions the patches that were made for other data; None where there are none for one of them."""
        found = [self._joined(condition, True) for condition in range(len(self.measured.groups))]
        return [of for of in found if of is not None] if all(of is not None for of in found) else None

    def simulated(self, values: Array, replicas: int) -> list[Patches]:
        """Patches at some parameters for each set of conditions, `replicas`, a multiple of `ROW`, at each parameter set."""
        made, sets = [], len(values) * len(self.measured.groups)
        expected = sets * replicas * self._took / max(self._made, 1)
        with Bar("simulation", sets, "parameter sets", expected=expected) as bar:
            for condition in range(len(self.measured.groups)):
                step = min(max(_OF_A_SWEEP // replicas, 2), _POINTS)
                pieces = []
                for begin in range(0, len(values), step):
                    pieces.append(self._piece(condition, values[begin : begin + step], replicas))
                    bar.to(condition * len(values) + min(begin + step, len(values)))
                made.append(_sum(pieces))
        return made

    def _piece(self, condition: int, values: Array, replicas: int) -> Patches:
        rows = np.repeat(values, replicas // ROW, axis=0)
        if self._found:
            piece = self._found.pop(0)
            if piece.condition == condition and np.array_equal(piece.patches.values, rows):
                self._pieces.append(piece)
                return piece.patches
            # Another way from here on.
            self._found.clear()
        measured = self.measured
        seed = int(np.random.SeedSequence([self._seed, len(self._pieces)]).generate_state(1)[0] >> 1)
        begun = time.monotonic()
        with work(progress=False):
            made = simulate(
                self.priors, measured.outcomes, values, units=measured.units, replicas=replicas, seed=seed, threads=self._threads,
                floors=_TINY, conditions=measured.groups[condition].conditions,
            )  # fmt: skip
        patches = Patches(rows, made.logs.reshape(len(rows), ROW, -1))
        self._pieces.append(_Piece(condition, patches, False))
        if self._path is not None:
            with files.writing_hdf5(self._path, force=True) as part:
                self.dataset().to_netcdf(part, engine="h5netcdf", group=GROUP)
        self._made, self._took = self._made + rows.shape[0] * ROW, self._took + time.monotonic() - begun
        return patches

    def _joined(self, condition: int, is_former: bool) -> Patches | None:
        of = [piece.patches for piece in self._pieces if (piece.condition, piece.is_former) == (condition, is_former)]
        return _sum(of) if of else None

    def dataset(self) -> xarray.Dataset:
        """The patches as files have them: for each set of conditions rows of patches at the same parameters."""
        variables: dict[str, Any] = {}
        for place in range(len(self.measured.groups)):
            pieces = [(number, piece) for number, piece in enumerate(self._pieces) if piece.condition == place]
            if not pieces:
                continue
            row, patches = f"row_{place}", _sum([piece.patches for _, piece in pieces])
            lengths = [len(piece.patches.values) for _, piece in pieces]
            variables |= {
                f"parameters_{place}": ((row, "parameter"), patches.values, {"long_name": "parameters, SI units"}),
                f"log_outcome_{place}": ((row, "replica", "outcome"), patches.logs, {"long_name": "logarithms of outcomes, SI units"}),
                f"sweep_{place}": (row, np.repeat([number for number, _ in pieces], lengths), {"long_name": "number of the sweep"}),
                f"former_{place}": (row, np.repeat([int(piece.is_former) for _, piece in pieces], lengths), {"long_name": "made for other data"}),
            }
        conditions = [json.dumps(group.conditions, sort_keys=True) for group in self.measured.groups]
        attrs = {"conditions": "\n".join(conditions), "of_scene": self._of_scene(), "of_data": self._of_data()}
        return xarray.Dataset(variables, attrs=attrs)

    def take(self, path: str | os.PathLike[str]) -> None:
        """Takes the patches of a file: to go on where it ended if it is of these data and this seed, else as patches of other data.

        Raises
        ------
        FileError
            There is no such file, it has no patches, or they are of another scene or another version of the program.
        """
        found = stored.group(Path(path), GROUP, "has no simulated patches of `stiction infer`")
        if found.attrs.get("of_scene") != self._of_scene():
            raise FileError(
                f"{path}: its patches are of another scene, of other outcomes or of another version of the program; leave it out"
            )
        is_own = found.attrs["of_data"] == self._of_data()
        pieces = sorted(self._read(found), key=lambda numbered: numbered[0])
        self._found = [piece for _, piece in pieces if is_own and not piece.is_former]
        self._pieces = [_Piece(piece.condition, piece.patches, True) for _, piece in pieces if not is_own or piece.is_former]

    def _read(self, found: xarray.Dataset) -> Iterator[tuple[int, _Piece]]:
        own = [json.dumps(group.conditions, sort_keys=True) for group in self.measured.groups]
        for place, conditions in enumerate(str(found.attrs["conditions"]).split("\n")):
            if conditions not in own or f"sweep_{place}" not in found:
                continue
            numbers, former = found[f"sweep_{place}"].values, found[f"former_{place}"].values
            for number in np.unique(numbers):
                rows = numbers == number
                patches = Patches(found[f"parameters_{place}"].values[rows], found[f"log_outcome_{place}"].values[rows])
                yield int(number), _Piece(own.index(conditions), patches, bool(former[rows][0]))

    def _of_scene(self) -> str:
        """What patches depend on but for their parameters: the scene without the numbers that have priors."""
        tables = json.loads(json.dumps(self.priors.tables))
        for key in self.priors.keys:
            *path, last = key.split(".")
            table = tables
            for name in path:
                table = table[name]
            table[last] = None
        for name in ("format", "title", "ensemble", "output"):
            tables.pop(name, None)
        tables.get("calibration", {}).pop("outliers", None)
        return _digest([__version__, tables, self.priors.keys, self.measured.outcomes])

    def _of_data(self) -> str:
        groups = [
            [group.conditions, group.values.tolist(), group.errors.tolist(), group.kinds.tolist(), group.batches.tolist()]
            for group in self.measured.groups
        ]
        return _digest([groups, self._seed])


def _digest(of: Any) -> str:
    return hashlib.sha256(json.dumps(of, sort_keys=True, default=str).encode()).hexdigest()


def _sum(pieces: list[Patches]) -> Patches:
    return Patches(np.concatenate([of.values for of in pieces]), np.concatenate([of.logs for of in pieces]))
