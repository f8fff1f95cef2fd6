"""`stiction lab`: the page that computes scenes in the browser."""

from __future__ import annotations

import argparse
import threading
import webbrowser
from collections.abc import Sequence
from pathlib import Path

from ..errors import FileError, StictionError
from ..terminal import ended, whole
from .server import Server, link

__all__ = ["main"]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction lab",
        description="Open the page `Will my pad stick?` in the browser: sliders for the keys of a pad, its pull-offs and its "
        "probability to stay adhered at once. The browser computes; nothing leaves this machine. Ctrl-C ends it.",
        epilog="Examples: stiction lab; stiction lab pad.toml; stiction lab --no-browser --port 8000. "
        "Exit codes: 1 the port is taken; 2 the command or the scene is wrong; 130 ended by Ctrl-C.",
    )
    parser.add_argument("scene", type=Path, nargs="?", metavar="SCENE.toml", help="the scene to begin with; by default the pad of the README")
    parser.add_argument("--port", type=whole, default=0, metavar="N", help="the port on 127.0.0.1; by default any that is free")
    parser.add_argument("--no-browser", action="store_true", help="only print the address")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, serves the page until it is interrupted; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(arguments)
    if not 0 <= given.port <= 65535:
        parser.error(f"--port {given.port}: a whole number from 0 to 65535 is needed")
    return ended("stiction lab", lambda: _serve(given.scene, given.port, not given.no_browser))


def _serve(scene: Path | None, port: int, opens: bool) -> None:
    text = None if scene is None else _text(scene)
    try:
        server = Server(port)
    except OSError as error:
        raise StictionError(f"port {port} of 127.0.0.1: {error.strerror}") from None
    with server:
        address = server.address if text is None else link(server.address, text)
        print(address, flush=True)
        if opens:
            # A browser of the terminal would wait for the server.
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        server.serve_forever()


def _text(scene: Path) -> str:
    try:
        return scene.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise FileError(f"{scene}: no text in UTF-8") from None
    except OSError as error:
        raise FileError(f"{scene}: {error.strerror}") from None
