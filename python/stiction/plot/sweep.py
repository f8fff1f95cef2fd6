"""Figures of sweeps: a number of each point over one key, with a curve for each value of another."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.transforms import ScaledTranslation

from .. import quantities
from ..errors import FileError
from ..results import Sweep
from .style import (
    COLORS,
    DASHED,
    GREY,
    LINES,
    MARKERS,
    MODEL_RANGE,
    dressed,
    folded,
    is_noise,
    label,
    legend,
    logarithmic,
    marked_invalid,
    new_axes,
    places,
    plain,
    probability,
    scaled,
    steady,
)

__all__ = ["QUANTITIES", "sweep"]


class Quantity(NamedTuple):
    """A quantity over the points of a sweep: its words, unit, dataset of the integral, and its name in files."""

    words: str
    unit: str
    of_integral: str | None = None
    dataset: str = ""


QUANTITIES = {
    "pull_off_force": Quantity("pull-off force", "N", "pull_off_force"),
    "pull_off_excess": Quantity("excess over the integral", "%"),
    "pull_off_scatter": Quantity("patch-to-patch standard deviation", "%"),
    "pull_off_separation": Quantity("pull-off separation $h^*$", "", "pull_off_separation"),
    "peak_secant_stiffness": Quantity("largest stiffness", "N m-1", "peak_stiffness"),
    "stuck": Quantity("probability to stay adhered", "", dataset="stuck_probability"),
}
# Most curves that can be distinguished.
_MOST = len(COLORS)


def quantities_of(result: Sweep) -> list[str]:
    """The quantities of a sweep, without those that are rounding alone; of integrals alone those that they have."""
    names = [name for name, of in QUANTITIES.items() if result.has_replicas or of.of_integral]
    # The integral and the separation of pull-off are of whole loops.
    left_out = set() if "device" in result else {"stuck"}
    if result.has_replicas and result.after_largest_preload is not None:
        left_out |= {"pull_off_excess", "pull_off_separation"}
    names = [name for name in names if name not in left_out]
    # Both are in per cent.
    relative = [name for name in names if QUANTITIES[name].unit == "%" and is_noise(of_points(result, name)[0], 100.0)]
    return [name for name in names if name not in relative]


def of_points(
    result: Sweep, quantity: str, preload: Any = None
) -> tuple[xarray.DataArray, xarray.DataArray, xarray.DataArray | None]:
    """Mean, standard error and integral of a quantity at all points; without replicas the integral in the place of the mean.

    A probability has in the place of the error how far its 95 % interval reaches below and above, over `range_end`. Forces and
    probabilities follow the preload, by default the largest that is reached.
    """
    pressed = result.after_preload(preload)
    if not result.has_replicas:
        integral = result[f"integral/{QUANTITIES[quantity].of_integral}"]
        if quantity.endswith("separation"):
            integral = integral / result["surface_height_std"]
        return integral, xarray.full_like(integral, np.nan), None
    name = (
        "pull_off_force" if quantity.startswith("pull_off_e") or quantity == "pull_off_scatter" else quantity
    )
    if quantity == "stuck":
        of = result["device"].to_dataset() if pressed is None else pressed
        share, low, high = (of[f"stuck_probability{end}"] for end in ("", "_low", "_high"))
        return share, xarray.concat([share - low, high - share], "range_end"), None
    if pressed is not None and quantity == "pull_off_force":
        return pressed["mean_over_patches"], pressed["standard_error"], None
    if pressed is not None and quantity == "pull_off_scatter":
        return _scatter(pressed["std"] / pressed["mean_over_patches"], pressed["count"])
    scalars = result["ensemble"].to_dataset().sel(scalar=name)
    mean, error = scalars["scalar_controlled_mean"], scalars["scalar_controlled_standard_error"]
    if quantity == "pull_off_excess":
        integral = result["integral/pull_off_force"]
        integral = integral.where(integral > 0.0)
        return 100.0 * (mean / integral - 1.0), 100.0 * error / integral, None
    if quantity == "pull_off_scatter":
        replicas = result["replicas/pull_off_force"]
        return _scatter(replicas.std("replica", ddof=1) / replicas.mean("replica"), replicas.sizes["replica"])
    integral_name = QUANTITIES[quantity].of_integral
    integral = result[f"integral/{integral_name}"]
    if quantity.endswith("separation"):
        sigma = result["surface_height_std"]
        return mean / sigma, error / sigma, integral / sigma
    return mean, error, integral


def model_range(result: Sweep, quantity: str, preload: Any = None) -> tuple[xarray.DataArray, xarray.DataArray] | None:
    """The smallest and the largest of a quantity by any plastic contact, at points where contacts yield; None where there are none."""
    found, name = result.model_range_after(preload), QUANTITIES[quantity].dataset or quantity
    if found is None or name not in found:
        return None
    of = found[name]
    return of.min("plastic_contact"), of.max("plastic_contact")


def words_of(result: Sweep, quantity: str, preload: Any = None) -> str:
    """A quantity in words, with the restoring force and the preload that it is of, where all points have one."""
    words = QUANTITIES[quantity].words
    if quantity == "stuck":
        force = result.restoring_force
        words += "\nunder the restoring force" if force is None else f"\nunder {quantities.si(force, 'N', 3)}"
    pressed = result.after_preload(preload)
    if pressed is not None and quantity in ("stuck", "pull_off_force", "pull_off_scatter"):
        loads = np.unique(pressed["preload"].values[np.isfinite(pressed["preload"].values)])
        after = quantities.si(loads[0], "N", 3) if loads.size == 1 else "the largest preload reached"
        words += f"{' ' if quantity == 'stuck' else chr(10)}after {after}"
    return words


def invalid_points(result: Sweep) -> xarray.DataArray:
    """Points whose asperities are taken as independent and may not be."""
    invalid: xarray.DataArray = result["independence/verdict"].astype(str) == "invalid"
    if "substrate.coupling" in result.keys:
        coupled = result["substrate_coupling"].astype(str) != "none"
        return invalid.where(~coupled, False)
    return xarray.zeros_like(invalid) if "coupling" in result else invalid


def _scatter(relative: xarray.DataArray, count: Any) -> tuple[xarray.DataArray, xarray.DataArray, None]:
    """A relative standard deviation of some patches and its standard error, in per cent."""
    scatter = 100.0 * relative
    return scatter, scatter / np.sqrt(2.0 * np.maximum(count - 1, 1)), None


def axes_of(result: Sweep, x: str | None, by: str | None) -> tuple[str, str | None]:
    """The keys for the axis and for the curves, as they are named or as the values vary; `x` is a key."""
    known = (
        [str(name) for name in result.points.dims] if result.attrs["sweep_mode"] == "grid" else result.keys
    )
    known = [key.replace(".", "_") for key in result.keys] or known
    for option, key in (("x", x), ("by", by)):
        if key is not None and key.replace(".", "_") not in known:
            raise FileError(f"{option} = {key}: not a key of this sweep; it has {', '.join(result.keys)}")
    varying = [name for name in known if np.unique(result[name].values).size > 1] or known
    across = (
        x.replace(".", "_")
        if x
        else next((name for name in varying if by is None or name != by.replace(".", "_")), known[0])
    )
    rest = [name for name in varying if name != across]
    if by is None and result.attrs["sweep_mode"] == "grid" and rest:
        by = min(rest, key=lambda name: np.unique(result[name].values).size)
    return across, by.replace(".", "_") if by else None


def _curves(result: Sweep, across: str, by: str | None) -> tuple[str, list[tuple[str, dict[str, Any]]]]:
    """The name of the key that distinguishes curves, if it is one, and words and the chosen indices of each; keys that are neither are at
    each of their values."""
    if result.attrs["sweep_mode"] != "grid":
        return _of_zip(result, across, by)
    others = [str(dim) for dim in result.points.dims if dim != across]
    others.sort(key=lambda name: name != by)
    sizes = [result.points.sizes[name] for name in others]
    if int(np.prod(sizes)) > _MOST:
        most = f"{int(np.prod(sizes))} curves; up to {_MOST} can be distinguished"
        raise FileError(f"{most}: name the key with most values for the axis (x)")
    varying = [name for name, size in zip(others, sizes, strict=True) if size > 1]
    words = ", ".join(plain(str(result[name].attrs.get("long_name", name))) for name in varying)
    curves = []
    for place in np.ndindex(*sizes):
        chosen = dict(zip(others, place, strict=True))
        texts = (plain(result.key_text(name, result[name].values[chosen[name]], 3)) for name in varying)
        curves.append((", ".join(texts), chosen))
    return words, curves


def _of_zip(result: Sweep, across: str, by: str | None) -> tuple[str, list[tuple[str, dict[str, Any]]]]:
    """The curves of points that are not a grid: one curve, or, where several points share a place, one for each value of another key."""
    points, place = str(next(iter(result.points.dims))), result[across].values
    keys = [key.replace(".", "_") for key in result.keys]
    for other in [by] if by else [name for name in keys if name != across]:
        values = list(dict.fromkeys(result[other].values))
        found = [np.flatnonzero(result[other].values == value) for value in values]
        if not by and np.unique(place).size == place.size:
            break
        if len(values) <= _MOST and all(np.unique(place[of]).size == of.size for of in found):
            texts = (plain(result.key_text(other, value, 3)) for value in values)
            return plain(str(result[other].attrs.get("long_name", other))), [(text, {points: of}) for text, of in zip(texts, found, strict=True)]
    return "", [("", {})]


class _Shown(NamedTuple):
    """The drawn numbers of a quantity: at all points, or as arrays at the points of one curve."""

    mean: Any
    error: Any
    integral: Any
    by_contact: Any
    invalid: Any

    def of(self, chosen: dict[str, Any], factor: float) -> _Shown:
        """The arrays of a curve, in units of the axis; the error keeps its dimension of ends."""

        def values(array: xarray.DataArray) -> Any:
            return array.isel(chosen).values.ravel() / factor

        ends = [self.error.sizes[end] for end in self.error.dims if end == "range_end"]
        error = self.error.isel(chosen).values.reshape(*ends, -1) / factor
        by_contact = None if self.by_contact is None else [values(end) for end in self.by_contact]
        return _Shown(values(self.mean), error, None if self.integral is None else values(self.integral), by_contact, self.invalid.isel(chosen).values.ravel())


def _drawn(ax: Axes, places: Any, of: _Shown, place: int, aside: Any) -> tuple[Any, list[Any]]:
    """Draws a curve at its places, moved aside so that curves that coincide are all seen; returns it, and the marks of invalid points."""
    order, color = np.argsort(places), COLORS[place]
    x, mean = places[order], of.mean[order]
    drawn = ax.errorbar(x, mean, of.error[..., order], color=color, marker=MARKERS[place], linestyle=LINES[place],
                        linewidth=0.0 if of.integral is not None else 0.9, elinewidth=1.0)  # fmt: skip
    moved: list[Any] = [drawn[0], *drawn[1], *drawn[2]]
    if of.by_contact is not None:
        low, high = of.by_contact
        moved.append(ax.vlines(x, low[order], high[order], color=color, alpha=0.3, linewidth=4.0, zorder=0.9))
    for artist in moved:
        artist.set_transform(aside)
    if of.integral is not None:
        ax.plot(x, of.integral[order], color=color, linestyle=DASHED, linewidth=1.0)
    return drawn, list(marked_invalid(ax, x, mean, of.invalid[order]))


@dressed
def sweep(
    result: Sweep,
    ax: Axes | None = None,
    *,
    quantity: str = "pull_off_force",
    x: str | None = None,
    by: str | None = None,
    preload: Any = None,
    shown: Sequence[str] = (),
) -> Axes:
    """A number of each point over a key of the sweep: mean over replicas with its standard error (of a probability its 95 % interval), and the integral's.

    Parameters
    ----------
    result : Sweep
    ax : matplotlib.axes.Axes, optional
    quantity : str
        ``pull_off_force``, ``pull_off_excess`` (of the mean over the integral), ``pull_off_scatter``, ``pull_off_separation``,
        ``peak_secant_stiffness``, or of a scene with ``[device]`` ``stuck``, the probability to stay adhered.
    x, by : str, optional
        The key for the axis, or a number of the points that follows from the keys, such as
        ``asperity_plasticity_index``; and the first of the keys that distinguish the curves. By default the
        first that varies, and the one with fewest values.
    preload : str or float, optional
        The preload of the scene after which the surfaces are pulled apart; by default the largest that is reached.
    shown : sequence of str
        Entries of the legend that another panel has.

    Raises
    ------
    FileError
        There is no such quantity or key, or there are more curves than can be distinguished.
    SceneError
        The scene has no such preload.
    """
    require(quantity)
    ax = new_axes(ax)
    points, follows = result.points, None
    if x is not None and x not in result.keys and x in points.data_vars and points[x].dims:
        # A number that follows from the keys, in the place of the key along which it varies.
        follows, of, x = x, points[x], None
        if result.attrs["sweep_mode"] == "grid":
            x = next((str(dim) for dim in of.dims if not np.allclose(of, of.isel({dim: [0]}), rtol=1e-12, atol=0.0)), None)
    across, by = axes_of(result, x, by)
    shown_of = _Shown(*of_points(result, quantity, preload), model_range(result, quantity, preload), invalid_points(result))
    mean, integral, unit = shown_of.mean, shown_of.integral, QUANTITIES[quantity].unit
    factor, sign = scaled(unit, mean) if unit not in ("", "%") else (1.0, unit)
    key = result[follows or across]
    choices = list(dict.fromkeys(key.values)) if key.dtype.kind == "U" else []
    if choices:
        key = key.copy(data=[choices.index(name) for name in key.values])
    key_factor, key_sign = scaled(str(key.attrs.get("units", "1")), key)
    handles: list[Any] = []
    marks: list[Any] = []
    title, curves = _curves(result, across, by)
    for place, (name, chosen) in enumerate(curves):
        at = key.isel({dim: of for dim, of in chosen.items() if dim in key.dims}).values.ravel() / key_factor
        drawn, invalid = _drawn(ax, at, shown_of.of(chosen, factor), place, _aside(ax, place - 0.5 * (len(curves) - 1)))
        handles += [drawn] if name else []
        marks = invalid or marks
        drawn.set_label(name)
        drawn[0].set_clip_on(quantity != "stuck")
    if integral is not None:
        handles += [
            Line2D([], [], color=GREY, marker="o", linewidth=0, label="mean over patches"),
            Line2D([], [], color=GREY, linestyle=DASHED, linewidth=1.0, label="integral"),
        ]
    if shown_of.by_contact is not None:
        handles.append(Line2D([], [], color=GREY, alpha=0.5, linewidth=4.0, label=MODEL_RANGE))
    handles += marks
    steady(ax, mean / factor)
    if quantity == "stuck":
        probability(ax, "")
    elif not logarithmic(ax, "y", mean) and quantity == "pull_off_excess":
        ax.axhline(0.0, color=GREY, linewidth=0.5, zorder=0.5)
    if choices:
        ax.set_xticks(range(len(choices)), [plain(name) for name in choices])
        ax.margins(x=0.2)
    else:
        places(ax, key.values / key_factor)
    ax.set(xlabel=label(plain(key.attrs.get("long_name", key.name)), plain(key_sign)), ylabel=folded(label(words_of(result, quantity, preload), sign)))
    handles = [handle for handle in handles if handle.get_label() not in shown]
    if handles:
        legend(ax, handles, title=title if handles[0].get_label() == curves[0][0] else None)
    return ax


def require(quantity: str) -> None:
    """Refuses a quantity that sweeps do not have."""
    if quantity not in QUANTITIES:
        raise FileError(f"quantity = {quantity}: known are {', '.join(QUANTITIES)}")


def _aside(ax: Axes, steps: float) -> Any:
    """The place of data, shifted by steps of two points to the right."""
    figure: Any = ax.figure
    return ax.transData + ScaledTranslation(2.0 * steps / 72.0, 0.0, figure.dpi_scale_trans)
