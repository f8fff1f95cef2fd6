"""Messages of the program speak of arguments of Python, not of the command line."""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import stiction
from stiction import SceneError
from stiction.program import call, options

QUICK = Path(__file__).resolve().parents[3] / "configs" / "quick.toml"
TIP = {"radius": 20e-9, "reduced_modulus": 60e9, "work_of_adhesion": 0.05, "equilibrium_spacing": 2e-10}


def refused(function, *arguments, **named):
    with pytest.raises(SceneError) as error:
        function(*arguments, **named)
    assert error.value.exit_code == 2
    text = str(error.value)
    assert "--" not in text and "Usage" not in text and not text.startswith(("stiction:", "error:"))
    return text


def test_numbers_that_will_not_do_are_named():
    assert "'-3' for 'replicas" in refused(stiction.run, QUICK, replicas=-3)
    assert "'2.5' for 'replicas" in refused(stiction.run, QUICK, replicas=2.5)
    assert "0 is not in 1..=4096" in refused(stiction.run, QUICK, threads=0)
    assert "counts none" in refused(stiction.finite_size, QUICK, "none")
    assert "ensemble" in refused(stiction.compare, QUICK, ["hybrid"], replicas=5)


def test_an_output_that_exists_is_overwritten_by_force_alone(tmp_path):
    output = tmp_path / "run.h5"
    stiction.run(QUICK, output, replicas=5)
    text = refused(stiction.run, QUICK, output, replicas=6)
    assert "exists; give force=True to overwrite it, or another output" in text
    assert stiction.run(QUICK, output, replicas=6, force=True).pull_off.replicas == 6


def test_arguments_of_a_single_asperity_are_named():
    assert refused(stiction.asperity, **TIP, interference=[]) == "interference: the array is empty"
    for value in (None, float("nan"), -1.0, "20 nN", "nm", "1.2.3 nm", object()):
        assert "radius" in refused(stiction.asperity, **{**TIP, "radius": value}, interference=0.0)
    assert "nolaw" in refused(stiction.asperity, **TIP, interference=0.0, law="nolaw")
    assert "approach, retraction" in refused(stiction.asperity, **TIP, interference=0.0, path="sideways")
    assert "poisson_ratio is missing" in refused(stiction.asperity, **TIP, interference=0.0, hardness=1e9)


def test_options_of_false_and_none_are_left_out():
    assert list(options(seed=None, force=False, resume=True, height_unit="nm")) == [
        "--resume",
        "--height-unit=nm",
    ]
    assert call(["--version"]).startswith("stiction ")


INTERRUPTED = """
import sys, stiction
output = sys.argv[1] or None
try:
    stiction.run(sys.argv[2], output, replicas=1_000_000, progress=True)
except KeyboardInterrupt as interruption:
    print(interruption)
"""


@pytest.mark.parametrize("named", [True, False])
def test_an_interruption_says_what_was_kept(named, tmp_path):
    output = str(tmp_path / "long.h5") if named else ""
    process = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED, output, QUICK],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "TMPDIR": str(tmp_path)},
        # A shell that runs tests in the background has them ignore it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    shown = ""
    # What is interrupted before its first batch is done keeps nothing.
    while not re.search(r"\| *[1-9]\d*/", shown):
        read = process.stderr.read(1)
        assert read, shown
        shown += read
    process.send_signal(signal.SIGINT)
    told, _ = process.communicate(timeout=60)
    if named:
        assert f"kept in {output}.checkpoint; resume=True goes on" in told.replace("\n", " ")
    else:
        assert told == "nothing was kept, as no output was named\n"
        assert not list(tmp_path.iterdir())
