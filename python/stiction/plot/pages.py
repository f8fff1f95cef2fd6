"""Whole pages: the figures that fit a result, put together."""

from __future__ import annotations

import difflib
import textwrap
from collections.abc import Callable
from functools import partial, wraps
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.layout_engine import ConstrainedLayoutEngine

from ..errors import FileError
from ..finite_size.study import is_study, study
from ..results import Asperities, Finding, Result, Run, Sweep
from . import coupled, loop, others, run
from .heat_map import heat_map, is_map
from .style import VERMILION, dressed, inches, legend_rows, lettered, plain
from .sweep import QUANTITIES, quantities_of, sweep

__all__ = ["OF_RUNS", "OF_SWEEPS", "of_replica", "page", "panels"]

Panel = Callable[..., Axes]

_WIDTH = "180mm"
# Below this width panels are stacked, inches. Above it there are two columns.
_NARROW = 4.8
# Heights of a row without legends, of a line of a legend, and what a map needs more, inches.
_AXES, _LINE, _MAP = 2.05, 0.14, 0.8
_OF_ASPERITIES: dict[str, Panel] = {
    "asperities": others.asperities,
    "heights": others.heights,
    "relation": others.relation,
    "curvatures": others.curvatures,
}

#: Options of figures of runs.
OF_RUNS = {"force_curve": ("replica", "stiffness", "preload"), "pull_off": ("preload",)}
#: Options of figures of sweeps.
OF_SWEEPS = ("x", "by", "preload")

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
        drawn |= {"contacts": loop.contacts} | ({"energy": loop.energy} if loop.loses_energy(result) else {})
    if "instability" in result:
        preloads = "instability/pull_off_after_preload_mean" in result and result["replicas/preload"].size >= 2
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
        For the figures: `x`, `by` and `preload` of sweeps, `preload` of ``pull_off``, `replica`, `stiffness` and `preload` of
        ``force_curve``.

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
            near = [one for one in known if name.startswith(one)] or difflib.get_close_matches(name, known, 1)
            raise FileError(f"{name}: no figure of this result{f', is {near[0]} meant?' if near else ';'} it has {', '.join(known)}")
    taken = {name: OF_SWEEPS if name in {*QUANTITIES, "heat_map"} and isinstance(result, Sweep) else OF_RUNS.get(name, ()) for name in names}
    for option in options:
        if not any(option in of for of in taken.values()):
            raise FileError(_without_option(result, option))
    wide = inches(width or ("90mm" if len(names) == 1 else _WIDTH))
    columns = 1 if wide < _NARROW or len(names) == 1 else 2
    rows = -(-len(names) // columns)
    figure = Figure(figsize=(wide, rows * _AXES))
    grid = figure.add_gridspec(rows, columns)
    drawn: list[Axes] = []
    for index, name in enumerate(names):
        # The last of an odd number has the row to itself.
        alone = columns == 2 and len(names) % 2 == 1 and index == len(names) - 1
        place = grid[index // columns, :] if alone else grid[index // columns, index % columns]
        own = {key: value for key, value in options.items() if key in taken[name]}
        if isinstance(result, Sweep) and name in QUANTITIES:
            own["shown"] = [words.get_text() for ax in drawn if (known_by := ax.get_legend()) for words in known_by.get_texts()]
        drawn.append(known[name](result, figure.add_subplot(place), **own))
        if len(names) > 1:
            lettered(drawn[-1], index)
    _give_room(figure, grid, [drawn[row * columns : (row + 1) * columns] for row in range(rows)], title)
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


def _without_option(result: Result, option: str) -> str:
    """The error of an option that none of the figures has."""
    if option in ("x", "by") and not isinstance(result, Sweep):
        return f"{option}: this is no sweep, whose keys it names"
    having = [name for name, of in OF_RUNS.items() if option in of] if isinstance(result, Run) else [*QUANTITIES, "heat_map"]
    return f"{option}: it is of {' and '.join(having)} alone, and none of these is drawn"


def _give_room(figure: Figure, grid: GridSpec, rows: list[list[Axes]], title: bool) -> None:
    """Makes rows of a page higher by the lines of their legends, so that no legend takes room from its axes, and rows with maps."""
    heights = [_AXES + _LINE * max(legend_rows(ax) for ax in row) + (_MAP if any(ax.images for ax in row) else 0.0) for row in rows]
    grid.set_height_ratios(heights)
    figure.set_figheight(sum(heights) + (0.3 if title else 0.0))
    # Legends above the highest panels are a pixel higher than the layout takes them for.
    engine = figure.get_layout_engine()
    if isinstance(engine, ConstrainedLayoutEngine):
        engine.set(h_pad=0.06)


def _of_finding(result: Finding, width: str | float | None) -> Figure:
    """The figure of an inference, sensitivity, design or map; packages of all but the last need extras."""
    if result.format.kind == "calibration":
        from ..inference.calibrated import open_calibration
        from ..inference.figures import ranks

        return ranks(open_calibration(result.path), width)
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
