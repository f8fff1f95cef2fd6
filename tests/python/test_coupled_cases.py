"""The pictures of coupled cases, from the shipped scenes made small: they are drawn, and the table has what the files have.

The program is $STICTION, by default target/release/stiction.
"""

import re
import subprocess
import sys
from pathlib import Path

import h5py
import pytest
from program import PROGRAM, ROOT

SCRIPT = ROOT / "scripts" / "plot_coupling.py"
SCENES = ["case_i", "case_ii", "case_iii", "case_iii_loop", "patches"]
SMALL = {
    r'nominal_area = "1?000? um\^2"': 'nominal_area = "20 um^2"',
    r"surface.nominal_area = .*": 'surface.nominal_area = ["5 um^2", "10 um^2"]',
    r"(surface.surface_height_std = .*)count = \d+": r'\1count = 2',
    r'from = "0.65 nm"': 'from = "1.3 nm"',
    r"(h_star = .*)count = \d+": r"\1count = 15",
    r"replicas = \d+": "replicas = 2",
}


def draw(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, SCRIPT, *map(str, arguments)], capture_output=True, text=True, encoding="utf-8")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    for name in SCENES:
        scene = (ROOT / "configs" / "coupled" / f"{name}.toml").read_text()
        for pattern, replacement in SMALL.items():
            scene = re.sub(pattern, replacement, scene)
        (folder / f"{name}.toml").write_text(scene)
        command = [PROGRAM, "run", folder / f"{name}.toml", "-o", folder / f"{name}.h5", "--quiet"]
        subprocess.run(command, check=True, capture_output=True)
    return folder


@pytest.mark.slow
def test_pictures_and_table_come_from_the_files(results, tmp_path):
    done = draw(results, "-o", tmp_path, "--dpi", 60)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    for line, name in zip(lines, ["cases", "patch", "chart"], strict=False):
        assert line == str(tmp_path / f"coupled_{name}.svg")
        picture = Path(line).read_text(encoding="utf-8")
        assert len(picture) > 20_000 and ">(a)<" in picture and picture.count('id="axes_') >= 4
    rows = [line.split(" | ") for line in lines if re.match(r"\| I+ ", line)]
    assert [row[0] for row in rows] == ["| I", "| I", "| II", "| II", "| III"]
    with h5py.File(results / "case_ii.h5") as file:
        expected = file["coupling/scalar_independent_mean"][1, 0]
        reported, prefix = re.match(r"([0-9.]+) ([nµm])N", rows[3][2]).groups()
        assert float(reported) * {"n": 1e-9, "µ": 1e-6, "m": 1e-3}[prefix] == pytest.approx(expected, rel=6e-3)
