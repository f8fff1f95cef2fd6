"""Measured surfaces: from a height map to its asperities.

`find_asperities` reads a map, levels and smooths it, finds its summits and writes the file that scenes take
their asperities from; `spectral_moments` takes the moments of profiles, of line scans too. NumPy and `scipy.ndimage` do the work.
"""

from .find import find_asperities
from .moments import SpectralMoments, spectral_moments

__all__ = ["SpectralMoments", "find_asperities", "spectral_moments"]
