"""A run that was interrupted and resumed leaves what Python reads like any other result.

The program is $STICTION, by default target/release/stiction.
"""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
import xarray
from program import PROGRAM, ROOT
from same_bits import contents


pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")


def run(folder: Path, *arguments: str) -> subprocess.Popen:
    assert PROGRAM.is_file(), f"no program {PROGRAM}: run `cargo build --release` or set STICTION"
    command = [PROGRAM, "run", "scene.toml", *arguments]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_resumed_run_reads_like_any_other(tmp_path, number):
    scene = (ROOT / "tests" / "data" / "quick.toml").read_text(encoding="utf-8")
    scene = scene.replace("replicas = 200", "replicas = 800").replace("curves = false", "curves = true")
    (tmp_path / "scene.toml").write_text(scene, encoding="utf-8")
    assert run(tmp_path, "-o", "whole.h5").wait() == 0
    interrupted = run(tmp_path, "--checkpoint", "0")
    while not (tmp_path / "scene.h5.partial").exists() and interrupted.poll() is None:
        time.sleep(0.001)
    interrupted.send_signal(number)
    _, message = interrupted.communicate()
    assert interrupted.returncode == 130 and "--resume" in message and not (tmp_path / "scene.h5").exists()
    assert run(tmp_path, "--resume").wait() == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["scene.h5", "scene.toml", "whole.h5"]

    whole, resumed = contents(tmp_path / "whole.h5"), contents(tmp_path / "scene.h5")
    assert list(whole) == list(resumed) and len([name for name in whole if ": " not in name]) > 50
    for name, values in whole.items():
        assert values == resumed[name], name
    with xarray.open_datatree(tmp_path / "scene.h5", engine="h5netcdf") as tree:
        assert tree["replicas"].external_force.dims == ("replica", "separation")
        assert int(tree["diagnostics"].resumptions) == 1
        # The deepest point of each curve lies between its separations, so no higher than the deepest of these.
        deepest = -tree["replicas"].external_force.min("separation")
        assert bool((tree["replicas"].pull_off_force >= deepest * (1 - 1e-12)).all())
