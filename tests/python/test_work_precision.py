"""The work-precision diagrams are drawn from tables that are right, and refused from those that are not."""

import math
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "work_precision.py"
HEADER = "panel,method,setting,seconds,error,what\n"


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, SCRIPT, *map(str, arguments)], capture_output=True, text=True, encoding="utf-8")


def table() -> str:
    lines = ["sums,direct,,0.012,2e-16,one replica"]
    lines += [f"sums,moments,tolerance = 1e-{t},{2e-4 * t},{10.0**-t},one replica" for t in (3, 6, 9, 12)]
    for method, scatter in [("plain", 0.14), ("control variates", 0.03)]:
        lines += [f"monte_carlo,{method},{n} replicas,{0.012 * n},{scatter / math.sqrt(n)},case II" for n in (32, 128, 512)]
    lines += [f"integral,panels,{n} panels,{2e-5 * n},{10.0 ** (-n / 3)},case II" for n in (4, 8, 16, 32)]
    lines += ["integral,adaptive,tolerance 1e-13,3e-3,0,an error of nothing"]
    for branch, factor in [("contact", 1.0), ("before contact", 0.5)]:
        lines += [f'peers,"brentq, {branch}",default,{2e-5 * factor},1e-9,"one, sentence"']
        lines += [f'peers,"Newton, {branch}",{k} iterations,{1e-7 * k * factor},{10.0 ** -(2**k)},words' for k in (1, 2, 3, 4)]
    return HEADER + "\n".join(lines) + "\n"


def coverage(path: Path, quarter: tuple[slice, slice] = (slice(None), slice(None))) -> float:
    """Share of the pixels that are not white."""
    return float((matplotlib.image.imread(path)[..., :3][quarter].min(axis=2) < 0.9).mean())


def test_a_page_is_drawn_from_one_file_or_several(tmp_path):
    first, second = tmp_path / "first.csv", tmp_path / "second.csv"
    lines = table().splitlines(keepends=True)
    first.write_text("".join(lines[:12]), encoding="utf-8")
    second.write_text(HEADER + "".join(lines[12:]), encoding="utf-8")
    done = run(first, second, "--dpi", 60)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == str(tmp_path / "first.png")
    assert 0.02 < coverage(tmp_path / "first.png") < 0.4
    whole = tmp_path / "whole.csv"
    whole.write_text(table(), encoding="utf-8")
    done = run(whole, "-o", tmp_path / "page.png", "--dpi", 60)
    assert done.returncode == 0, done.stderr
    assert coverage(tmp_path / "page.png") == coverage(tmp_path / "first.png")


@pytest.mark.parametrize("panel", ["sums", "monte_carlo", "integral", "peers"])
def test_panels_without_measurements_are_left_empty(tmp_path, panel):
    path = tmp_path / "one.csv"
    path.write_text(HEADER + f"{panel},method,,0.1,1e-3,a single point\n", encoding="utf-8")
    done = run(path, "--dpi", 40)
    assert done.returncode == 0, done.stderr
    assert coverage(tmp_path / "one.png") > 0.005


@pytest.mark.parametrize(
    "text, reason",
    [
        ("", "first line"),
        ("method,seconds\n", "first line"),
        (HEADER, "no rows"),
        (HEADER + "speed,a,b,1,1,c\n", "unknown panel"),
        (HEADER + "sums,a,b,1,1\n", "line 2 has 5 fields"),
        (HEADER + "sums,a,b,quick,1,c\n", "line 2"),
        (HEADER + "sums,a,b,0,1,c\n", "seconds must be positive"),
        (HEADER + "sums,a,b,1,-1,c\n", "not negative"),
        (HEADER + "sums,a,b,1,nan,c\n", "finite"),
        (b"\xff\xfe\x00", "utf-8"),
    ],
)
def test_wrong_tables_end_with_2_and_say_why(tmp_path, text, reason):
    path = tmp_path / "wrong.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    done = run(path)
    assert done.returncode == 2 and not list(tmp_path.glob("*.png"))
    assert done.stderr.startswith("work_precision: ") and str(path) in done.stderr and reason in done.stderr
    assert "Traceback" not in done.stderr


def test_what_cannot_be_read_or_written_ends_with_2(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(table(), encoding="utf-8")
    absent = tmp_path / "absent"
    for arguments in [(absent,), (path, "-o", absent / "page.png"), (path, "-o", tmp_path / "page.unknown"), ()]:
        done = run(*arguments)
        assert done.returncode == 2 and done.stderr and "Traceback" not in done.stderr
