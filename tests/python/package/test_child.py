"""The program as a child process as Windows has it, tried on this system."""

import _thread
import subprocess
import sys
import threading
import time

import pytest
from conftest import CONFIGS

import stiction
from stiction import child
from stiction.program import find

QUICK = CONFIGS / "quick.toml"


@pytest.fixture
def windows(monkeypatch):
    """What the package does on Windows. Ctrl-Break is SIGTERM here, and the program is no `stiction.exe`."""
    monkeypatch.setenv("STICTION", find())
    monkeypatch.setattr(child, "_WINDOWS", True)


def test_the_program_is_found_by_its_name_on_the_system(windows, monkeypatch, tmp_path):
    (tmp_path / "stiction").write_text("a script", encoding="utf-8")
    (tmp_path / "stiction").chmod(0o755)
    assert child.in_folder(tmp_path) is None
    (tmp_path / "stiction.exe").write_text("a program", encoding="utf-8")
    (tmp_path / "stiction.exe").chmod(0o755)
    assert child.in_folder(tmp_path) == str(tmp_path / "stiction.exe")
    monkeypatch.setattr(child, "_WINDOWS", False)
    assert child.in_folder(tmp_path) == str(tmp_path / "stiction")


def test_lines_go_on_after_an_interruption(windows, monkeypatch):
    monkeypatch.setattr(child, "_BETWEEN", 0.01)
    script = "import sys, time\nfor i in range(3): print(i, file=sys.stderr, flush=True); time.sleep(0.3)"
    process = subprocess.Popen([sys.executable, "-c", script], stderr=subprocess.PIPE, text=True)
    with process:
        lines = child.lines(process)
        assert next(lines) == "0\n"
        threading.Timer(0.1, _thread.interrupt_main).start()
        with pytest.raises(KeyboardInterrupt):
            next(lines)
        assert list(lines) == ["1\n", "2\n"]


def test_results_and_errors_are_the_same(windows, tmp_path):
    stiction.run(QUICK, tmp_path / "out.h5", replicas=8)
    with pytest.raises(stiction.StictionError, match="exists; give force=True to overwrite it"):
        stiction.run(QUICK, tmp_path / "out.h5", replicas=8)


def test_an_interruption_saves_what_was_done(windows, tmp_path):
    def interrupt():
        while not (tmp_path / "long.h5.partial").exists():
            time.sleep(0.01)
        _thread.interrupt_main()

    threading.Thread(target=interrupt, daemon=True).start()
    with pytest.raises(KeyboardInterrupt, match="replicas"):
        stiction.run(QUICK, tmp_path / "long.h5", replicas=1_000_000)
    assert [path.name for path in tmp_path.iterdir()] == ["long.h5.partial"]
