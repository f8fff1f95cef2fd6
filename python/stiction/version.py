"""The version of the package."""

from importlib.metadata import PackageNotFoundError, version

__all__ = ["__version__"]

try:
    __version__ = version("stiction")
except PackageNotFoundError:  # a checkout that is not installed
    __version__ = "unknown"
