"""The page `Will my pad stick?`, which computes scenes in the browser, and the command `stiction lab` that opens it.

The page is of static files: ``index.html`` with its style and modules, uPlot, and the program's core as WebAssembly,
``stiction.wasm``, which ``scripts/lab.sh`` of a checkout builds.
"""

from .server import Server, link

__all__ = ["Server", "link"]
