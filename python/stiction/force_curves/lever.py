"""A surface on a cantilever: force over the position of the piezo, both ways, with jumps."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import xarray
from numpy.typing import ArrayLike, NDArray

from .. import quantities
from ..errors import FileError, SceneError
from ..results import Run, is_preload

__all__ = ["force_curve", "of_run"]

Array = NDArray[np.float64]
APPROACH, RETRACTION = "approach", "retraction"
# How much further than a jump-off the piezo goes, over the length of its way until there.
_BEYOND = 0.1
_SAMPLES = {
    "piezo_position": ("m", "position of the base of the cantilever, h - F/k: the separation without deflection"),
    "separation": ("m", "separation h"),
    "deflection": ("m", "deflection of the cantilever F/k, away from the surface positive"),
    "force": ("N", "external force F, compressive positive"),
}
_JUMPS = {
    "jump_piezo_position": ("m", "position of the piezo at the jump"),
    "jump_separation": ("m", "separation h where the jump begins"),
    "jump_distance": ("m", "how far the tip jumps"),
    "jump_force": ("N", "external force before the jump"),
    "jump_force_after": ("N", "external force after the jump"),
}


def force_curve(approach: ArrayLike, retraction: ArrayLike, stiffness: float) -> xarray.Dataset:
    """The record of an instrument: a cantilever is brought close by its piezo, and pulled back.

    With the stiffness k the base of the cantilever is at z = h - F(h)/k. The piezo moves it steadily, and the tip follows for as long as z
    is monotone along the curve. Where dF/dh exceeds k it is not, and the tip jumps, at constant z, to the next separation on its
    way with this z. Between samples curves are straight.

    A tip that jumps off and finds no stop within the separations is free, at the force 0, and so is the approach from that far on.

    Parameters
    ----------
    approach, retraction : array_like (2, n)
        Separation, m, and external force, N, compressive positive, in any order of the separations.
    stiffness : float
        Of the cantilever, N/m; greater than 0.

    Returns
    -------
    xarray.Dataset
        Over `sample`, in the order of time: `piezo_position`, `separation` and `deflection` (m), `force` (N), with the coordinate `way`,
        ``approach`` or ``retraction``. A jump is two samples at one position of the piezo, and an entry over `jump`:
        `jump_piezo_position`, `jump_separation` where it begins, `jump_distance` (m), `jump_force` and `jump_force_after` (N), with the
        coordinate `jump_way`. `pull_off_force` (N) is the largest pull on retraction, 0 without one.

    Raises
    ------
    SceneError
        The stiffness is not greater than 0; or the tip has jumped in before the separations begin, or jumps in beyond their end.

    References
    ----------
    B. Cappella, G. Dietler, Surf. Sci. Rep. 34 (1999) 1, doi:10.1016/S0167-5729(99)00003-5.

    Examples
    --------
    A well of 2 N at 2 m, as steep as 1 N/m beyond: on half of that it jumps in from 4 m.

    >>> well = [[0, 1, 2, 3, 4, 5], [2, 0, -2, -1, 0, 0]]
    >>> curve = force_curve(well, well, stiffness=0.5)
    >>> curve.jump_way.values, curve.jump_separation.values, curve.jump_distance.values
    (array(['approach', 'retraction'], dtype='<U10'), array([4., 2.]), array([2.4, 4. ]))
    """
    if not (np.isfinite(stiffness) and stiffness > 0.0):
        raise SceneError(f"stiffness = {stiffness}: a cantilever has one greater than 0, such as 40 N/m")
    inward, outward = (np.asarray(way, float)[:, np.argsort(np.asarray(way, float)[0])] for way in (approach, retraction))
    inward, jumps_in, unstopped = _followed(inward[:, ::-1], stiffness)
    if unstopped:
        raise SceneError(f"stiffness = {_of(stiffness)}: the tip snaps in beyond the smallest separation; let [separation] begin at a smaller h")
    if jumps_in.size and jumps_in[0, 0] == inward[0, 0]:
        raise SceneError(
            f"stiffness = {_of(stiffness)}: the tip has snapped in before the largest separation; let [separation] end at a larger h"
        )
    outward, jumps_off, unstopped = _followed(outward, stiffness)
    if unstopped:
        # It comes to rest where nothing pulls.
        free = outward[0, -1] - outward[1, -1] / stiffness
        lowest = inward[0, -1] - inward[1, -1] / stiffness
        far = free + _BEYOND * (free - lowest)
        jumps_off = np.vstack([jumps_off, [*outward[:, -1], free, 0.0]])
        outward = np.hstack([outward, [[free, far], [0.0, 0.0]]])
        inward = np.hstack([[[far], [0.0]], inward])
    separation, force = np.hstack([inward, outward])
    ways = [APPROACH] * inward.shape[1] + [RETRACTION] * outward.shape[1]
    jumps = np.vstack([jumps_in, jumps_off])
    samples = (separation - force / stiffness, separation, force / stiffness, force)
    of_jumps = (jumps[:, 0] - jumps[:, 1] / stiffness, jumps[:, 0], np.abs(jumps[:, 2] - jumps[:, 0]), jumps[:, 1], jumps[:, 3])

    def variables(of: dict[str, tuple[str, str]], dimension: str, values: tuple[Array, ...]) -> dict[str, Any]:
        rows = zip(of.items(), values, strict=True)
        return {name: (dimension, array, {"units": unit, "long_name": words}) for (name, (unit, words)), array in rows}

    pull_off = ((), max(0.0, -float(outward[1].min())), {"units": "N", "long_name": "largest pull on retraction"})
    return xarray.Dataset(
        variables(_SAMPLES, "sample", samples) | variables(_JUMPS, "jump", of_jumps) | {"pull_off_force": pull_off},
        coords={
            "way": ("sample", np.array(ways)),
            "jump_way": ("jump", np.array([APPROACH] * len(jumps_in) + [RETRACTION] * len(jumps_off), dtype=np.array(ways).dtype)),
            "stiffness": ((), stiffness, {"units": "N m-1", "long_name": "stiffness of the cantilever"}),
        },
    )


def _followed(curve: Array, stiffness: float) -> tuple[Array, Array, bool]:
    """The samples of a curve (2, n) that a tip rests at on its way through them, its stops behind jumps among them; the jumps, with
    separation and force before and after, (jumps, 4); and whether it jumps from the last sample and nothing stops it."""
    separation, force = curve
    level = np.sign(separation[-1] - separation[0]) * (stiffness * separation - force)
    rests = np.flatnonzero(level >= np.maximum.accumulate(level))
    followed, jumps = [curve[:, :1]], []
    for before, after in itertools.pairwise(rests):
        if after > before + 1:
            share = (level[before] - level[after - 1]) / (level[after] - level[after - 1])
            stop = curve[:, after - 1] + share * (curve[:, after] - curve[:, after - 1])
            jumps.append([*curve[:, before], *stop])
            followed.append(stop[:, np.newaxis])
        followed.append(curve[:, [after]])
    return np.hstack(followed), np.array(jumps).reshape(-1, 4), bool(rests[-1] < separation.size - 1)


def _of(stiffness: float) -> str:
    return quantities.si(stiffness, "N m-1", 3)


def of_run(run: Run, stiffness: Any, replica: int, preload: Any) -> xarray.Dataset:
    """The force curve of a replica of a loop; see `Run.force_curve`."""
    if run.attrs["history"] != "loop":
        raise FileError(f'{run.path}: went one way; a force curve needs both, history = "loop" in [model]')
    if "replicas/external_force" not in run:
        raise FileError(
            f"{run.path}: has no curves of its replicas, and an instrument records one spot, no mean over spots; run with curves = true in [output]"
        )
    replicas = run.group("replicas")
    if not 0 <= replica < replicas.sizes["replica"]:
        raise SceneError(f"replica = {replica}: one from 0 to {replicas.sizes['replica'] - 1} is needed")
    spring = _stiffness(run, stiffness)
    spot = replicas.isel(replica=replica)
    separation = spot["separation"].values
    approach = np.array([separation, spot["external_force"].values])
    turn = _turn(run, spot, preload)
    if turn is None:
        pulled, pull_off = spot["retraction_external_force"].values, (spot["pull_off_separation"], -spot["pull_off_force"])
    else:
        spot = spot.isel(preload=turn)
        if "external_force_after_preload" not in spot:
            raise FileError(f"{run.path}: has no curves after preloads; an earlier version made it: make it again")
        pulled = spot["external_force_after_preload"].values
        pull_off = (spot["pull_off_after_preload_separation"], -spot["pull_off_after_preload"])
    retraction = np.array([separation, pulled])
    # What the file has between samples.
    approach = _with(approach, spot["approach_pull_off_separation"], -spot["approach_pull_off_force"])
    retraction = _with(retraction, *pull_off)
    if turn is not None:
        at = (spot["preload_separation"], spot["preload"])
        approach, retraction = (_with(way[:, way[0] > float(at[0])], *at) for way in (approach, retraction))
    found = force_curve(approach, retraction, spring)
    found.coords["replica"] = ((), replica, {"long_name": "index of the replica"})
    if turn is not None:
        found.coords["preload"] = spot["preload"].variable
    return found


def _with(curve: Array, separation: Any, force: Any) -> Array:
    """A curve with one more sample, if it is known."""
    added = np.array([[float(separation)], [float(force)]])
    return np.hstack([curve, added]) if np.isfinite(added).all() and float(separation) not in curve[0] else curve


def _stiffness(run: Run, given: Any) -> float:
    """A stiffness that is given, or the one of the scene."""
    if given is not None:
        try:
            return float(quantities.in_si("stiffness", given, "N/m"))
        except ValueError as error:
            raise SceneError(str(error)) from None
    of_scene = np.atleast_1d(run["replicas/stiffness"].values) if "replicas/stiffness" in run else np.array([])
    springs = of_scene[of_scene > 0.0]
    if springs.size == 1:
        return float(springs[0])
    known = f"the scene has {', '.join(_of(one) for one in springs)}; name one" if springs.size else "the scene has no spring"
    raise SceneError(f'stiffness: {known}, that of the cantilever, such as stiffness = "40 N/m"')


def _turn(run: Run, spot: xarray.Dataset, given: Any) -> int | None:
    """The preload that the patch turns at, by its index: one that is given, or the largest that it reaches; None at the smallest separation."""
    known = spot["preload"] if "preload" in spot else xarray.DataArray([np.nan])
    if given is None and known.isnull().all():
        return None
    if given is None:
        reached = np.isfinite(spot["preload_separation"].values)
        if not reached.any():
            raise FileError(f"{run.path}: replica {int(spot['replica'])} reaches no preload; take another replica")
        return int(np.where(reached, known, -np.inf).argmax())
    turn = int(np.flatnonzero(is_preload(known, given))[0])
    if not np.isfinite(spot["preload_separation"].values[turn]):
        raise SceneError(f"preload = {given}: replica {int(spot['replica'])} does not reach it; take another replica, or a smaller preload")
    return turn
