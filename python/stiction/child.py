"""The program as a child process: how it is begun, read and interrupted, on Windows and elsewhere."""

from __future__ import annotations

import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, Any

__all__ = ["begun", "in_folder", "interrupt", "lines"]

# Whether the system is Windows.
_WINDOWS = sys.platform == "win32"
# Seconds between looks at what a child has written, on Windows.
_BETWEEN = 0.05


def in_folder(folder: str | os.PathLike[str]) -> str | None:
    """The program in a folder, if it is there. `shutil.which` would look at the folder at hand first, on Windows."""
    path = Path(folder, "stiction.exe" if _WINDOWS else "stiction")
    return str(path) if path.is_file() and os.access(path, os.X_OK) else None


def begun(command: Sequence[str], given: IO[str], out: IO[str]) -> subprocess.Popen[str]:
    """A process that ends with this one, however that ends; its standard error is read by `lines`."""
    # Windows interrupts groups of processes: in one of its own the child is not interrupted before this process wants it.
    group = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0) if _WINDOWS else 0
    return subprocess.Popen(
        command, stdin=given, stdout=out, stderr=subprocess.PIPE, text=True, encoding="utf-8",
        env={**os.environ, "STICTION_PARENT": str(os.getpid())}, creationflags=group,
    )  # fmt: skip


def interrupt(process: subprocess.Popen[str]) -> None:
    """Has a child save what is done and end. On a terminal it has had the same signal, elsewhere than on Windows; of two that come
    together it takes one."""
    if not _WINDOWS:
        process.send_signal(signal.SIGINT)
        return
    try:
        process.send_signal(getattr(signal, "CTRL_BREAK_EVENT", signal.SIGTERM))
    except OSError:
        # Without a console nothing can be sent; what was saved before is kept.
        process.terminate()


def lines(process: subprocess.Popen[str]) -> Iterator[str]:
    """The lines of standard error. After an interruption they go on where they were."""
    assert process.stderr is not None
    return _Looked(process.stderr) if _WINDOWS else iter(process.stderr)


class _Looked(Iterator[str]):
    """Lines that a thread reads: on Windows an interruption would wait for the end of a read, but ends a sleep."""

    def __init__(self, stream: IO[str]) -> None:
        self._read: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        threading.Thread(target=self._fill, args=(stream,), daemon=True).start()

    def _fill(self, stream: Any) -> None:
        for line in stream:
            self._read.put(line)
        self._read.put(None)

    def __next__(self) -> str:
        while True:
            try:
                line = self._read.get_nowait()
            except queue.Empty:
                time.sleep(_BETWEEN)
                continue
            if line is None:
                raise StopIteration
            return line
