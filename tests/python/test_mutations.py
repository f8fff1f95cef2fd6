"""The planted mistakes of tests/mutations.toml still apply to the source."""

import subprocess
import sys

from program import ROOT

SCRIPT = ROOT / "scripts" / "mutations.py"


def run(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, SCRIPT, *arguments], capture_output=True, text=True, encoding="utf-8")


def test_every_mistake_applies():
    done = run("--check")
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.split()[0]) >= 10


def test_a_mistake_that_is_not_there_is_named():
    done = run("--check", "no such mistake")
    assert done.returncode == 2 and "no such mistake" in done.stderr
