"""Exceptions that carry the program's own message."""

import contextlib
from collections.abc import Iterator

__all__ = ["FileError", "SceneError", "StictionError", "written_at_end"]


class StictionError(Exception):
    """A command of the program failed.

    Attributes
    ----------
    exit_code : int
        The exit code of the program: 1 failed while running, 2 the command or the scene is wrong, 3 a check found
        a disagreement.
    """

    def __init__(self, message: str, exit_code: int = 1) -> None:
        super().__init__(message)
        self.exit_code = exit_code


class SceneError(StictionError):
    """The scene or an argument is wrong; nothing was computed or written."""

    def __init__(self, message: str, exit_code: int = 2) -> None:
        super().__init__(message, exit_code)


class FileError(StictionError):
    """A file cannot be read, or is no result of stiction."""

    def __init__(self, message: str, exit_code: int = 2) -> None:
        super().__init__(message, exit_code)


@contextlib.contextmanager
def written_at_end() -> Iterator[None]:
    """Work of several runs that writes its result at its end: an interruption states that nothing was kept."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted; nothing was kept, since the result is written at the end") from None
