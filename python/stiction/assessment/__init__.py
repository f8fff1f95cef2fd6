"""One answer from a map: cut-offs, pull-off of patches of the area asked for, and whether it can be trusted."""

from .assess import assess_map

__all__ = ["assess_map"]
