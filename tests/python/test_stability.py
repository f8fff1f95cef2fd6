"""The script that draws error and evaluations over lambda and delta works, on a grid of seconds, and refuses what it cannot do.

The program is $STICTION, by default target/release/stiction.
"""

import csv
import os
import stat
import subprocess
import sys

import matplotlib.image
import pytest
from program import PROGRAM, ROOT

SCRIPT = ROOT / "scripts" / "stability.py"
GRID = ("--lambdas", 4, "--distances", 5)


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, SCRIPT, *map(str, arguments)], capture_output=True, text=True, encoding="utf-8")


def test_a_small_grid_leaves_a_picture_and_is_met(tmp_path):
    assert PROGRAM.is_file(), f"no program {PROGRAM}: run `cargo build --release` or set STICTION"
    done = run("--stiction", PROGRAM, "-o", tmp_path / "page.png", "--csv", tmp_path / "points.csv", "--dpi", 60, *GRID)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == str(tmp_path / "page.png")
    assert 0.1 < (matplotlib.image.imread(tmp_path / "page.png")[..., :3].min(axis=2) < 0.9).mean() < 0.95
    with open(tmp_path / "points.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * 4 * 5 and {row["branch"] for row in rows} == {"contact", "noncontact"}
    judged = [row for row in rows if row["error_bracketed"] != "nan"]
    # Doubles on the end of a branch are not judged: at distances of 1e-14 they are common, else there are none.
    assert all(float(row["distance"]) < 1e-13 for row in rows if row not in judged) and len(judged) >= 32
    for row in judged:
        assert 0.0 <= float(row["error_tables"]) <= 10.0 and float(row["error_bracketed"]) <= 10.0, row
        assert 2 <= int(row["evaluations_bracketed"]) <= 70, row
    assert any(row["evaluations_tables"] == "1" for row in rows) and any(row["safeguarded_tables"] == "1" for row in rows)


@pytest.mark.skipif(os.name != "posix", reason="the stand-in is a shell script")
def test_a_program_that_fails_ends_with_1(tmp_path):
    program = tmp_path / "stand-in"
    program.write_text("#!/bin/sh\necho 'it does not work' >&2\nexit 2\n", encoding="utf-8")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    done = run("--stiction", program, "-o", tmp_path / "page.png", *GRID)
    assert done.returncode == 1 and not (tmp_path / "page.png").exists()
    assert "it does not work" in done.stderr and "Traceback" not in done.stderr


def test_what_cannot_be_done_ends_with_2(tmp_path):
    absent = tmp_path / "absent" / "page.png"
    for arguments in [("--stiction", tmp_path / "absent"), ("--stiction", sys.executable, "-o", absent),
                      ("--stiction", sys.executable, "--csv", absent, "-o", tmp_path / "page.png"),
                      ("--stiction", sys.executable, "-o", tmp_path / "page.png", "--lambdas", 1)]:
        done = run(*arguments)
        assert done.returncode == 2 and done.stderr and "Traceback" not in done.stderr, arguments
    assert not list(tmp_path.iterdir())
