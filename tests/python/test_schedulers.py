"""The commands and the job script of docs/cluster.md for those without Slurm, run as they are printed: GNU parallel itself, and the script
with the variables that PBS, LSF and Grid Engine set for a task of an array.

The program is $STICTION, by default target/release/stiction.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from program import PROGRAM, ROOT
from same_bits import contents

SHARDS = 16


def snippets() -> list[str]:
    page = (ROOT / "docs" / "cluster.md").read_text(encoding="utf-8")
    section = page.split("## Without Slurm")[1].split("\n## ")[0]
    return re.findall(r"```sh\n(.*?)```", section, re.DOTALL)


@pytest.fixture
def site(tmp_path) -> tuple[Path, dict[str, str]]:
    """A folder with a quick scene under the name that the page has, and an environment whose PATH has the program."""
    (tmp_path / "configs").mkdir()
    scene = (ROOT / "configs" / "quick.toml").read_text(encoding="utf-8")
    (tmp_path / "configs" / "case_ii.toml").write_text(scene, encoding="utf-8")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "stiction").symlink_to(PROGRAM)
    environment = {**os.environ, "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}", "HOME": str(tmp_path)}
    return tmp_path, environment


def whole(folder: Path, environment: dict[str, str]) -> dict:
    subprocess.run(["stiction", "run", "configs/case_ii.toml", "-o", "whole.h5", "--quiet"], cwd=folder, env=environment,
                   check=True, capture_output=True)
    return contents(folder / "whole.h5")


def test_the_commands_for_gnu_parallel(site):
    if not shutil.which("parallel"):
        pytest.skip("no GNU parallel")
    folder, environment = site
    commands = snippets()[0]
    assert "parallel stiction run" in commands
    subprocess.run(["sh", "-ec", commands], cwd=folder, env=environment, check=True, capture_output=True)
    assert contents(folder / "case_ii.h5") == whole(folder, environment)


@pytest.mark.parametrize("task, directory", [
    ("PBS_ARRAY_INDEX", "PBS_O_WORKDIR"),
    pytest.param("LSB_JOBINDEX", None, marks=pytest.mark.slow),
    pytest.param("SGE_TASK_ID", "SGE_O_WORKDIR", marks=pytest.mark.slow),
])
def test_the_job_script_of_arrays(site, task, directory):
    folder, environment = site
    script = folder / "shard.sh"
    script.write_text(next(text for text in snippets() if text.startswith("#!")), encoding="utf-8")
    script.chmod(0o755)
    # PBS and Grid Engine start a task in the home folder, LSF where it was submitted.
    elsewhere = folder / "home"
    elsewhere.mkdir()
    for index in range(1, SHARDS + 1):
        variables = {task: str(index), **({directory: str(folder)} if directory else {})}
        subprocess.run([script], cwd=elsewhere if directory else folder, env={**environment, **variables}, check=True,
                       capture_output=True)
    merged = ["sh", "-ec", "stiction merge -o case_ii.h5 case_ii.*-of-16.shard"]
    assert merged[2] in (ROOT / "docs" / "cluster.md").read_text(encoding="utf-8")
    subprocess.run(merged, cwd=folder, env=environment, check=True, capture_output=True)
    assert contents(folder / "case_ii.h5") == whole(folder, environment)
