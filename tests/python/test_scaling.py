"""The script that measures how a run grows works, on scenes of seconds; it and others that measure refuse what they cannot do.

The program is $STICTION, by default target/release/stiction.
"""

import csv
import os
import stat
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import pytest
from program import PROGRAM, ROOT

MEASURING = ["scaling", "shard_costs"]


def run(script: str, *arguments: object) -> subprocess.CompletedProcess:
    path = ROOT / "scripts" / f"{script}.py"
    return subprocess.run([sys.executable, path, *map(str, arguments)], capture_output=True, text=True, encoding="utf-8")


def quick(script: str, folder: Path) -> tuple[list[dict[str, str]], str]:
    """The table that a script leaves beside a picture of something, and what it prints."""
    assert PROGRAM.is_file(), f"no program {PROGRAM}: run `cargo build --release` or set STICTION"
    done = run(script, "--stiction", PROGRAM, "-o", folder / "page.png", "--csv", folder / "points.csv", "--quick", "--dpi", 60)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == str(folder / "page.png")
    assert 0.02 < (matplotlib.image.imread(folder / "page.png")[..., :3].min(axis=2) < 0.9).mean() < 0.4
    with open(folder / "points.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert set(rows[0]) == {"quantity", "setting", "value", "unit", "what"}
    return rows, done.stdout


def test_quick_measurements_leave_a_table_and_a_picture(tmp_path):
    rows, _ = quick("scaling", tmp_path)
    assert {row["quantity"] for row in rows} == {
        *(f"{what} {over}" for what in ("ensemble seconds over", "exponent of") for over in ("N", "S", "replicas")),
        "seconds over threads", "core seconds over threads", "speed-up", "speed-up of processes", "peak resident memory", "start-up",
    }
    # Durations are not judged here, on a machine that may be busy; their signs and the memory's order of magnitude are.
    for row in rows:
        assert row["what"] and (row["quantity"].startswith("exponent") or float(row["value"]) > 0.0), row
        assert row["quantity"] != "peak resident memory" or 2e6 < float(row["value"]) < 2e8, row


def stand_in(folder: Path, code: int) -> Path:
    """A program that fails at once."""
    program = folder / "stand-in"
    program.write_text(f"#!/bin/sh\necho 'it does not work' >&2\nexit {code}\n", encoding="utf-8")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return program


@pytest.mark.skipif(os.name != "posix", reason="the stand-in is a shell script")
@pytest.mark.parametrize("script", MEASURING)
@pytest.mark.parametrize("code", [1, 2])
def test_a_run_that_fails_ends_with_1(tmp_path, script, code):
    done = run(script, "--stiction", stand_in(tmp_path, code), "-o", tmp_path / "page.png", "--quick")
    assert done.returncode == 1 and not (tmp_path / "page.png").exists()
    assert "it does not work" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize("script", MEASURING)
def test_what_cannot_be_done_ends_with_2(tmp_path, script):
    for arguments in [(), ("--stiction", tmp_path / "absent"), ("--stiction", sys.executable, "-o", tmp_path / "absent" / "page.png"),
                      ("--stiction", sys.executable, "--csv", tmp_path / "absent" / "points.csv", "-o", tmp_path / "page.png")]:
        done = run(script, *arguments)
        assert done.returncode == 2 and done.stderr and "Traceback" not in done.stderr, arguments
    assert not list(tmp_path.iterdir())
