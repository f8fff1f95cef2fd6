"""Progress: lines in logs, bars on terminals and in notebooks, and silence elsewhere."""

import os
import pty
import re
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest

from stiction import progress
from stiction.design import command as design


@pytest.fixture
def log(monkeypatch, capsys):
    """The lines of a command so far; they come a hundredth of a second apart."""
    for name in ("_FIRST", "_APART", "_MOST"):
        monkeypatch.setattr(progress, name, 0.01)
    monkeypatch.setattr(progress, "_log", progress._Log())

    def lines():
        return capsys.readouterr().err.splitlines()

    return lines


def spelled(words="words", **options):
    for _ in progress.steps("abc", words, "letters", **options):
        time.sleep(0.05)


def test_commands_without_a_terminal_have_lines(log):
    spelled()
    assert log() == []
    spelled(progress=True)
    assert any(re.fullmatch(r"stiction: words: 2 of 3 letters, 0 s so far, about 0 s left", line) for line in log())
    progress.of_command("stiction spell")
    spelled()
    lines = log()
    assert lines[0] == "stiction spell: words: 0 of 3 letters, 0 s so far"
    assert any(re.fullmatch(r"stiction spell: words: 2 of 3 letters, \d+ s so far, about \d+ s left", line) for line in lines)
    spelled(progress=False)
    assert log() == []


def test_work_without_a_count_has_lines_too(log):
    """Also while it is silent."""
    progress.of_command("stiction spell")
    with progress.Bar("thinking"):
        time.sleep(0.1)
    assert log()[0] == "stiction spell: thinking: 0 s so far"
    with progress.Bar("guesses", 9, "letters", at_most=True) as bar:
        bar.to(4)
        time.sleep(0.1)
    assert log()[-1] == "stiction spell: guesses: 4 of at most 9 letters, 0 s so far"


def test_the_expected_time_is_shown_until_a_step_is_done(log):
    progress.of_command("stiction spell")
    with progress.Bar("guesses", 4, "letters", expected=300.0) as bar:
        time.sleep(0.1)
        bar.to(2)
        time.sleep(0.1)
    lines = log()
    assert lines[0] == "stiction spell: guesses: 0 of 4 letters, 0 s so far, about 5 min left"
    assert lines[-1] == "stiction spell: guesses: 2 of 4 letters, 0 s so far, about 0 s left"


def test_work_has_its_words_before_others_and_decides_for_them(log):
    progress.of_command("stiction spell")
    with progress.work("batch 2"):
        spelled()
        assert log()[0].startswith("stiction spell: batch 2: words: 0 of 3 letters")
        with progress.work("page 3", progress=False):
            spelled()
    assert log() == []
    spelled()
    assert log()[0].startswith("stiction spell: words: 0")


@pytest.mark.parametrize("first, expected", [(1.0, [1, 11, 31, 71, 131, 191]), (None, [10, 30, 70, 130, 190, 250])])
def test_lines_become_rarer(first, expected, monkeypatch, capsys):
    """At last one a minute; those of long commands begin at once, the others' with those of the program."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    lines, times = progress._Log(apart=first), []
    for _ in expected:
        now[0] += lines.wait()
        times.append(now[0])
        lines.write("a line")
    assert times == expected and capsys.readouterr().err == "stiction: a line\n" * len(expected)


ON_TERMINAL = """
import sys, time
from stiction import progress
from stiction.design import command as design
progress._SHOWN = 0.1
with progress.work("another scene.toml: batch 1 of at most 8: condition 11 of 12"):
    for _ in progress.steps(range(30), "", "points"):
        time.sleep(0.02)
    with progress.Bar("density"):
        time.sleep(0.5)
    with progress.Bar("posterior", 30, "points", expected=300.0):
        time.sleep(0.5)
"""


def test_a_terminal_has_one_line_that_goes():
    """Of 80 columns, whatever the words."""
    main, terminal = pty.openpty()
    termios.tcsetwinsize(main, (24, 80))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen([sys.executable, "-c", ON_TERMINAL], stderr=terminal, env=environment) as process:
        os.close(terminal)
        shown = b""
        while True:
            try:
                shown += os.read(main, 65536)
            except OSError:
                break
    os.close(main)
    assert process.returncode == 0
    parts = shown.decode().split("\r")
    assert "\n" not in shown.decode() and max(map(len, parts)) <= 80
    assert any(part.startswith("batch 1 of at most 8: condition 11 of 12: ") and re.search(r"\d+ of 30 points, 00:00, 00:00 left", part) for part in parts)
    assert any("density: 00:00" in part for part in parts)
    assert any("posterior: " in part and "0 of 30 points, 00:00, about 5 min left" in part for part in parts)
    # Nothing is left of it.
    assert parts[-1].strip() == "" and parts[-2].strip() == ""


def test_points_of_a_sweep_are_one_bar(monkeypatch):
    """Whole points, with a part of the one at hand."""
    from stiction import program

    seen = []
    monkeypatch.setattr(program.Bar, "to", lambda bar, done: (seen.append((bar._total, bar._unit, done)), setattr(bar, "done", done)))
    bars = program._Bars(progress=False)
    for run, phase, done, total in [
        ("point 1 of 2", "integral", None, None), ("point 1 of 2", "ensemble", 0, 400), ("point 1 of 2", "ensemble", 100, 400),
        ("point 1 of 2", "ensemble", 400, 400), ("point 1 of 2", "cross-check", None, None), ("point 2 of 2", "integral", None, None),
        ("point 2 of 2", "ensemble", 200, 400),
    ]:  # fmt: skip
        bars.show({"run": run, "phase": phase, "done": done, "total": total})
    assert seen == [(2, "points", done) for done in (0, 0, 0.25, 0.99, 0.99, 1, 1.5)]


def test_a_command_of_several_runs_names_its_stages(log, monkeypatch):
    """In order, with counts where there are some, and as plain lines."""
    begin = progress.of_command
    monkeypatch.setattr(progress, "of_command", lambda name, first: begin(name, 0.01))
    quick = Path(__file__).resolve().parents[3] / "configs" / "quick.toml"
    assert design.main([str(quick), "--above", "0.16 mN", "--error", "0.3"]) == 0
    lines = log()
    stages = [re.fullmatch(r"stiction design: ([a-z ]+): (\d+ of \d+ patches, )?\d+ s so far(, about \d+ s left)?", line) for line in lines]
    assert list(dict.fromkeys(found[1] for found in stages)) == ["patches of the scene itself", "heights to sample", "trial", "sampling"]
    assert all(bool(found[2]) == (found[1] in ("trial", "sampling")) for found in stages)


def test_an_inference_names_batch_and_stage(log, monkeypatch, tmp_path):
    """Up to the end of the simulations over the priors, where the test ends it."""
    posterior = pytest.importorskip("stiction.inference.posterior")

    class Enough(Exception):
        pass

    def ended(*_):
        raise Enough

    monkeypatch.setattr(posterior, "_check_scatter", ended)
    monkeypatch.setattr(posterior, "_POINTS", 4)
    folder = Path(__file__).resolve().parents[3] / "configs" / "inference"
    with pytest.raises(Enough):
        posterior.infer(folder / "first.csv", folder / "first.toml", progress=True)
    shown = [line.removeprefix("stiction: ") for line in log()]
    assert shown[0].startswith("trial patches: ")
    assert any(re.match(r"over the priors: simulation: \d+ of 16 parameter sets, ", line) for line in shown)
