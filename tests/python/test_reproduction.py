"""The script that reproduces the publication runs and finds what docs/publication.md says that it finds.

Needs the packages of scripts/requirements.txt. The program is $STICTION, by default target/release/stiction.
"""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow
SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


def run(script: str, *arguments: object) -> str:
    command = [sys.executable, SCRIPTS / script, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8")
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("reproduction")
    printed = run("reproduce_paper.py", "-o", folder, "--replicas", 8)
    assert "pull-off force" in printed
    return folder


@pytest.fixture(scope="module")
def rows(folder) -> list[dict]:
    with open(folder / "reproduction.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_every_figure_is_drawn(folder):
    for number in [1, 2, 4, 5, 6, 7, 8, 9]:
        picture = (folder / f"figure_{number}.svg").read_text(encoding="utf-8")
        assert 20_000 < len(picture) < 1_000_000 and picture.count('id="line2d') > 20


def test_every_number_has_a_verdict_and_a_reason_where_it_differs(rows):
    assert len(rows) > 55
    for row in rows:
        assert {row["verdict"], row["verdict with fits"]} & {"agree", "differ"}, row
        assert row["tolerance"] and (row["verdict"] != "differ" or row["reason"]), row


NUMBERS = [
    ("pull-off force", "I", 0.2469, 2.133),  # uN
    ("pull-off force", "II", 0.5622, 0.6443),  # mN
    ("pull-off force", "III", 75.64, 110.9),  # mN
    ("pull-off force", "III, 0.04 J/m^2", 6.090, None),  # mN, 6.0896 by 40-digit quadrature
    ("stiffest point h*", "I", 5.671, 5.733),
    ("stiffest point h*", "II", 3.222, 3.178),
    ("stiffest point h*", "III", 2.890, 2.705),
]


def test_numbers_are_those_of_the_readme(rows):
    for item, case, direct, fits in NUMBERS:
        (row,) = [row for row in rows if (row["item"], row["case"]) == (item, case)]
        assert float(row["here (direct)"]) == pytest.approx(direct, rel=1e-3), (item, case)
        assert fits is None or float(row["here with the paper's fits"]) == pytest.approx(fits, rel=1e-3), (item, case)


def test_the_published_pull_off_of_case_i_is_that_of_its_fit(rows):
    (row,) = [row for row in rows if (row["item"], row["case"]) == ("pull-off force", "I")]
    assert (row["verdict"], row["verdict with fits"]) == ("differ", "agree") and "f_sonc" in row["reason"]
