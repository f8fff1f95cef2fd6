"""A web server of the page's files for this machine alone, and links that hold a scene."""

from __future__ import annotations

import base64
import functools
import zlib
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlsplit

from ..errors import FileError

__all__ = ["CORE", "FOLDER", "Server", "link"]

FOLDER = Path(__file__).resolve().parent
CORE = FOLDER / "stiction.wasm"
# What the page is made of; other files of the folder are not served.
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".wasm": "application/wasm",
}


def link(page: str, scene: str) -> str:
    """The address of the page with a scene: its text, compressed, behind the ``#``.

    Parameters
    ----------
    page : str
        The address of the page.
    scene : str
        The text of the scene.

    Examples
    --------
    >>> link("http://127.0.0.1/", "a = 1")
    'http://127.0.0.1/#scene=S1SwVTAEAA'
    """
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    packed = packer.compress(scene.encode()) + packer.flush()
    return f"{page}#scene={base64.urlsafe_b64encode(packed).decode().rstrip('=')}"


class Server(ThreadingHTTPServer):
    """Serves the page on 127.0.0.1.

    Parameters
    ----------
    port : int
        The port; 0 is any that is free.

    Raises
    ------
    FileError
        The package has no ``stiction.wasm``.
    OSError
        The port is taken.
    """

    daemon_threads = True

    def __init__(self, port: int = 0) -> None:
        if not CORE.is_file():
            raise FileError(
                f"{CORE}: no such file: this installation was built without the page's core; "
                "in a checkout scripts/lab.sh builds it"
            )
        super().__init__(("127.0.0.1", port), functools.partial(_Handler, directory=str(FOLDER)))

    @property
    def address(self) -> str:
        """The address of the page."""
        return f"http://127.0.0.1:{self.server_port}/"


class _Handler(SimpleHTTPRequestHandler):
    """Files of the page, always asked for anew, and no lines of log."""

    extensions_map = _TYPES

    def send_head(self):  # type: ignore[no-untyped-def]
        path = urlsplit(self.path).path
        if path != "/" and Path(path).suffix not in _TYPES:
            self.send_error(404)
            return None
        return super().send_head()

    def end_headers(self) -> None:
        self.send_header("Cache-Control", "no-cache")
        super().end_headers()

    def log_message(self, format: str, *args: object) -> None:
        pass
