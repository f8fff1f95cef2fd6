"""Which of the maps of a source is meant."""

from __future__ import annotations

from ..errors import SceneError

__all__ = ["named", "numbered"]


def numbered(channel: str | None, names: list[str], what: str, called: str = "") -> int:
    """The place of the channel of a name or number, or of the only one; messages begin with `called`.

    Raises
    ------
    SceneError
        None is named, or there is none of the name; the message lists them.
    """
    listed = ", ".join(f"{number}: {name}" for number, name in enumerate(names[:40]))
    if channel is None and len(names) == 1:
        return 0
    if channel is None:
        raise SceneError(
            f"{called}has {len(names)} {what}s that may be maps; name the channel, one of {listed}"
            if names
            else f"{called}has no {what} of two dimensions that holds numbers"
        )
    if channel in names:
        return names.index(channel)
    if channel.isdecimal() and int(channel) < len(names):
        return int(channel)
    raise SceneError(f"{called}has no {what} {channel}; it has {listed or 'none that may be a map'}")


def named(channel: str | None, names: list[str], what: str, called: str = "") -> str:
    """The name that `numbered` finds.

    Raises
    ------
    SceneError
        As `numbered`.
    """
    return names[numbered(channel, names, what, called)]
