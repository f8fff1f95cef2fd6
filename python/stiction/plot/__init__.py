"""Figures of results: functions that draw into axes, pages of them, and the command `stiction plot`.

Each function takes a result and, as `ax`, the axes to draw into, and returns the axes. `page` puts together what fits a result, and
`panels` names it. `stiction.plot.style` has the one style, a style sheet of matplotlib.
"""

from .coupled import avalanches, coupling, coupling_difference
from .heat_map import heat_map
from .loop import contacts, energy, force_curve, preloads, snaps, stuck
from .others import (
    asperities,
    bias,
    comparison,
    convergence,
    curvatures,
    density_over_cutoff,
    heights,
    law_deviation,
    radius_over_cutoff,
    relation,
    scatter,
    scatter_over_cutoff,
    sizes,
    standard_errors,
)
from .pages import page, panels
from .run import attraction, deviation, force, integral, pull_off, regimes
from .sweep import sweep

__all__ = [
    "asperities", "attraction", "avalanches", "bias", "comparison", "contacts", "convergence", "coupling", "coupling_difference", "curvatures",
    "density_over_cutoff", "deviation", "energy", "force", "force_curve", "heat_map", "heights", "integral", "law_deviation", "page", "panels", "preloads", "pull_off",
    "radius_over_cutoff", "regimes", "relation", "scatter", "scatter_over_cutoff", "sizes", "snaps", "standard_errors", "stuck", "sweep",
]  # fmt: skip
