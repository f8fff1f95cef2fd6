"""The pictures of coupled cases, from the shipped scenes made small: they are drawn, and the numbers that they keep are the files'.

The program is $STICTION, by default target/release/stiction.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

import h5py
import pytest
from program import PROGRAM, ROOT

SCRIPT = ROOT / "scripts" / "plot_coupling.py"
SCENES = ["case_i", "case_ii", "case_iii", "case_iii_loop", "patches"]
# Axes of each picture.
PANELS = {"cases": 6, "patch": 3, "loads": 2, "chart": 2, "force": 4}
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
def test_pictures_and_their_numbers_come_from_the_files(results, tmp_path):
    done = draw(results, "-o", tmp_path, "--dpi", 60)
    assert done.returncode == 0, done.stderr
    pictures = {name: tmp_path / f"coupled_{name}.svg" for name in PANELS}
    assert done.stdout.splitlines() == [str(path) for path in pictures.values()]
    texts = {name: path.read_text(encoding="utf-8") for name, path in pictures.items()}
    for name, panels in PANELS.items():
        assert ">(a)<" in texts[name] and texts[name].count('id="axes_') >= panels, name
    cases, patch = (json.loads(re.search("<!-- numbers: (.*) -->", texts[name])[1]) for name in ("cases", "patch"))
    assert list(cases) == ["I periodic", "I patch", "II periodic", "II patch", "III patch"]
    with h5py.File(results / "case_ii.h5") as file:
        independent, change = (file[f"coupling/scalar_{which}_mean"][1, 0] for which in ("independent", "difference"))
    with h5py.File(results / "case_iii_loop.h5") as file:
        loop = file["replicas/pull_off_force"][0]
    assert [float(text) for text in cases["II patch"][:2]] == pytest.approx([1e6 * independent, 1e6 * (independent + change)], rel=6e-3)
    assert float(patch["pull-off of the loop"][0]) == pytest.approx(1e3 * loop, rel=6e-3)
