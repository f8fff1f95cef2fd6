"""Whole pages: the figures that fit a result, put together."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from functools import partial, wraps
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..errors import FileError
from ..finite_size.study import is_study, study
from ..results import Asperities, Finding, Result, Run, Sweep
from . import coupled, loop, others, run
from .heat_map import heat_map, is_map
from .style import VERMILION, dressed, inches, lettered, plain
from .sweep import QUANTITIES, quantities_of, sweep

__all__ = ["OF_REPLICA", "of_replica", "page", "panels"]

Panel = Callable[..., Axes]

_WIDTH = "180mm"
# Below this width panels are stacked, inches. Above it there are two columns.
_NARROW = 4.8
_ROW = 2.55
_OF_ASPERITIES: dict[str, Panel] = {
    "asperities": others.asperities,
    "heights": others.heights,
    "relation": others.relation,
    "curvatures": others.curvatures,
}

#: Options of figures of a single replica.
OF_REPLICA = {"force_curve": ("replica", "stiffness", "preload")}

# Panels of sweeps over laws, and over the nominal area.
_OF_LAWS: dict[str, Panel] = {"comparison": others.comparison, "law_deviation": others.law_deviation}
_OF_STUDIES = {"sizes": others.sizes, "bias": others.bias, "scatter": others.scatter}
_OVER_CUTOFF: dict[str, Panel] = {
    "density_over_cutoff": others.density_over_cutoff,
    "radius_over_cutoff": others.radius_over_cutoff,
    "scatter_over_cutoff": others.scatter_over_cutoff,
}


def panels(result: Result) -> dict[str, Panel]:
    """The figures that fit a result, by their names; each takes the result and axes.

    Parameters
    ----------
    result : Run, Sweep or Asperities
    """
    if isinstance(result, Sweep):
        of_sweep: dict[str, Panel] = {name: partial(sweep, quantity=name) for name in quantities_of(result)}
        if is_map(result):
            of_sweep["heat_map"] = heat_map
        if is_study(result):
            return {name: _of_study(figure) for name, figure in _OF_STUDIES.items()} | of_sweep
        return _OF_LAWS | of_sweep if result.keys == ["model.law"] else of_sweep
    if isinstance(result, Asperities):
        return _OF_ASPERITIES | (_OVER_CUTOFF if "cutoffs" in result else {})
    if not isinstance(result, Run):
        return {}
    if not result.has_replicas:
        return {"integral": run.integral}
    drawn: dict[str, Panel] = {"force": run.force, "pull_off": run.pull_off}
    if "background" in result:
        drawn["attraction"] = run.attraction
    if "coupling" in result:
        drawn |= {
            "coupling": coupled.coupling,
            "coupling_difference": coupled.coupling_difference,
            "avalanches": coupled.avalanches,
        }
    if result.attrs["history"] == "loop":
        drawn |= {"contacts": loop.contacts, "energy": loop.energy}
    if "instability" in result:
        preloads = "instability/pull_off_after_preload_mean" in result and result["replicas/preload"].size >= 3
        # One spring after many preloads is no curve over the stiffness.
        springs = result["replicas/stiffness"].size if "replicas/stiffness" in result else 0
        if springs > (1 if preloads else 0):
            drawn["snaps"] = loop.snaps
        if preloads:
            drawn["preloads"] = loop.preloads
        if preloads and "device" in result:
            drawn["stuck"] = loop.stuck
    drawn |= {"regimes": run.regimes, "deviation": run.deviation}
    if "ensemble/target" in result:
        for target, estimate in enumerate(result["ensemble/target_estimate"].values):
            if str(estimate) == "plain":
                drawn["convergence"] = partial(others.convergence, target=target)
                drawn["standard_errors"] = partial(others.standard_errors, target=target)
                break
    return drawn


def of_replica(result: Result) -> dict[str, Panel]:
    """The figures of a single replica, which are drawn only where they are asked for, by their names."""
    is_loop = isinstance(result, Run) and result.has_replicas and result.attrs["history"] == "loop"
    return {"force_curve": loop.force_curve} if is_loop else {}


def _of_study(figure: Panel) -> Panel:
    """A figure of patches of several sizes that takes their sweep."""

    @wraps(figure)
    def drawn(result: Sweep, ax: Axes | None = None) -> Axes:
        return figure(study(result), ax)

    return drawn


def _by_default(known: dict[str, Panel], options: dict[str, Any]) -> list[str]:
    """The figures of a page: of sweeps over laws or the nominal area theirs, unless options of sweeps are given."""
    own = [name for name in known if name in _OF_LAWS | _OF_STUDIES]
    return own if own and not options else [name for name in known if name not in own]


@dressed
def page(
    result: Result,
    width: str | float | None = None,
    *,
    what: str | list[str] | None = None,
    title: bool = False,
    **options: Any,
) -> Figure:
    """The figures of a result on one page; an inference, sensitivity or design has one figure.

    Parameters
    ----------
    result : Run, Sweep, Asperities or Finding
    width : str or float, optional
        Width of the page: a text such as ``85mm``, or mm; 180mm by default, of a single figure 90mm. Up to 122mm figures are stacked
        in one column.
    what : str or list of str, optional
        Names of figures, from `panels`; by default all that are of more than one replica.
    title : bool
        Whether the title of the scene is above.
    **options
        For the figures: `x` and `by` of sweeps, `replica`, `stiffness` and `preload` of ``force_curve``.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    FileError
        There is no such figure for this kind of result, or it has not what the figure is of.
    """
    if isinstance(result, Finding):
        if what is not None or options:
            raise FileError(f"{result.path}: a result of `{result.format.made_by}` has one figure; leave out {', '.join(['what', *options])}")
        return _of_finding(result, width)
    fitting = panels(result)
    known = fitting | of_replica(result)
    names = _by_default(fitting, options) if what is None else [what] if isinstance(what, str) else list(what)
    for name in names:
        if name not in known:
            raise FileError(f"{name}: no figure of this result; it has {', '.join(known)}")
    wide = inches(width or ("90mm" if len(names) == 1 else _WIDTH))
    columns = 1 if wide < _NARROW or len(names) == 1 else 2
    rows = -(-len(names) // columns)
    height = rows * (_ROW if columns == 2 or wide >= _NARROW else min(_ROW, 0.78 * wide))
    figure = Figure(figsize=(wide, height + (0.3 if title else 0.0)))
    grid = figure.add_gridspec(rows, columns)
    for index, name in enumerate(names):
        # The last of an odd number has the row to itself.
        alone = columns == 2 and len(names) % 2 == 1 and index == len(names) - 1
        place = grid[index // columns, :] if alone else grid[index // columns, index % columns]
        # The legend of the first curves of a sweep holds for all.
        of_sweep = {"names": index == 0} if isinstance(result, Sweep) and name in QUANTITIES else {}
        own = {key: value for key, value in options.items() if isinstance(result, Sweep) or key in OF_REPLICA.get(name, ())}
        ax = known[name](result, figure.add_subplot(place), **own, **of_sweep)
        if len(names) > 1:
            lettered(ax, index)
    if title:
        text = result.title or result.path.name
        text = "".join(one if one.isprintable() else " " for one in text)
        figure.suptitle(
            "\n".join(textwrap.wrap(text, max(20, int(wide * 12)), max_lines=2)), fontsize=9, parse_math=False
        )
    if result.is_partial:
        attrs = result.attrs
        whole = f" of {attrs['replicas_of_whole_run']}" if "replicas_of_whole_run" in attrs else ""
        text = (
            plain(f"PARTIAL: {attrs.get('replicas', 'some')}{whole} replicas")
            if whole
            else "PARTIAL: some replicas are missing"
        )
        figure.text(0.995, 0.995, text, ha="right", va="top", color=VERMILION, fontsize=8, weight="bold")
    return figure


def _of_finding(result: Finding, width: str | float | None) -> Figure:
    """The figure of an inference, sensitivity, design or map; packages of all but the last need extras."""
    if result.format.kind == "inference":
        from ..inference.figures import page as posterior
        from ..inference.found import open_inference

        return posterior(open_inference(result.path), width)
    if result.format.kind == "sensitivity":
        from ..sensitivity.figure import draw

        return draw(result.tree.to_dataset(), width or "180mm")
    if result.format.kind == "map":
        from ..assessment.figure import draw as of_map

        return of_map(result.tree.to_dataset(), width or "180mm")
    from ..design.figure import draw as searched

    return searched(result.tree.to_dataset(), width or "90mm")
