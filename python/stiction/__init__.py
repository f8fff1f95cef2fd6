"""Adhesion of rough surfaces from explicit ensembles of asperities."""

from importlib.metadata import PackageNotFoundError, version

from .errors import FileError, SceneError, StictionError
from .results import Asperities, Comparison, FiniteSize, Run, Sweep, open_run

__all__ = ["Asperities", "Comparison", "FileError", "FiniteSize", "Run", "SceneError", "StictionError", "Sweep", "open_run"]

try:
    __version__ = version("stiction")
except PackageNotFoundError:  # a checkout that is not installed
    __version__ = "unknown"
