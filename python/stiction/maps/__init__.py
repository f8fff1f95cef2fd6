"""Measured surfaces: from a height map to its asperities.

`find_asperities` reads a map, levels and smooths it, finds its summits and writes the file that scenes take
their asperities from; `spectral_moments` takes the moments of profiles, of line scans too;
`combine_spectra` joins scans of several sizes. NumPy and `scipy.ndimage` do the work.
"""

from .combine import PowerSpectrum, ScanSpectrum, combine_spectra
from .find import find_asperities
from .moments import SpectralMoments, spectral_moments

__all__ = ["PowerSpectrum", "ScanSpectrum", "SpectralMoments", "combine_spectra", "find_asperities", "spectral_moments"]
