"""``result.plot``: the figures that fit a result, as methods."""

from __future__ import annotations

from functools import partial
from typing import Any

from matplotlib.figure import Figure

from ..results import Result
from .pages import of_replica, page, panels

__all__ = ["Plot"]


class Plot:
    """Draws a result: called the whole page, by a name of `panels` one figure into `ax`."""

    def __init__(self, result: Result) -> None:
        self._result = result
        self._panels = panels(result) | of_replica(result)

    def __call__(self, width: str | float | None = None, **options: Any) -> Figure:
        """The page of the result; see `page`."""
        return page(self._result, width, **options)

    def __getattr__(self, name: str) -> Any:
        known = self.__dict__.get("_panels", {})
        if name not in known:
            raise AttributeError(f"no figure `{name}` of this result; it has {', '.join(known)}")
        drawn: Any = partial(known[name], self._result)
        return drawn

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._panels]
