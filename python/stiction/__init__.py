"""Adhesion of rough surfaces from explicit ensembles of asperities.

`run`, `sweep`, `compare`, `integral` and `check` take a scene: the path of a TOML file, or a dict of its tables.
`asperity` solves a single asperity, `read_table` reads a table of another program, `find_asperities` reads a measured surface, `open_run` opens any result. `stiction.plot` draws
results, `stiction.report` makes a page of them.
"""

from .assessment import assess_map
from .errors import FileError, SceneError, StictionError
from .experiments import check, compare, integral, run, sweep
from .maps import PowerSpectrum, SpectralMoments, combine_spectra, find_asperities, spectral_moments
from .opened import Asperities, Result, Run, Sweep, open_run
from .results import CrossCheck, PullOff
from .single import asperity
from .tables import read_table
from .version import __version__ as __version__

__all__ = [
    "Asperities",
    "CrossCheck",
    "FileError",
    "PowerSpectrum",
    "PullOff",
    "Result",
    "Run",
    "SceneError",
    "SpectralMoments",
    "StictionError",
    "Sweep",
    "asperity",
    "assess_map",
    "check",
    "combine_spectra",
    "compare",
    "find_asperities",
    "integral",
    "open_run",
    "read_table",
    "run",
    "spectral_moments",
    "sweep",
]
