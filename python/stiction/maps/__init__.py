"""Measured surfaces: from a height map to its asperities.

`find_asperities` reads a map, levels and smooths it, finds its summits and writes the file that scenes take
their asperities from. NumPy and `scipy.ndimage` do the work.
"""

from .find import find_asperities

__all__ = ["find_asperities"]
