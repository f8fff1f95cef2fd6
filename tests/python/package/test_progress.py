"""Progress in logs: lines of commands, and silence elsewhere."""

import re

from stiction import progress


def test_commands_without_a_terminal_have_lines(monkeypatch, capsys):
    monkeypatch.setattr(progress, "_APART", 0.0)
    monkeypatch.setattr(progress, "_command", "")
    assert list(progress.steps("abc", "letters", "letters")) == ["a", "b", "c"]
    assert capsys.readouterr().err == ""
    progress.of_command("stiction spell")
    assert list(progress.steps("abc", "words", "letters")) == ["a", "b", "c"]
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 3 and re.fullmatch(r"stiction spell: words: 2 of 3 letters, \d+ s so far, about \d+ s left", lines[1])
    list(progress.steps("abc", "", "letters", is_all=False))
    part = capsys.readouterr().err.splitlines()
    assert re.fullmatch(r"stiction spell: 2 of 3 letters, \d+ s so far", part[1])
    list(progress.steps("abc", "words", "letters", progress=False))
    assert capsys.readouterr().err == ""


def test_lines_are_a_minute_apart(monkeypatch, capsys):
    """Steps of 25 s: lines after 75 s, 150 s, 225 s."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    progress.of_command("stiction spell")
    for _ in progress.steps(range(10), "", "steps"):
        now[0] += 25.0
    assert re.findall(r"(\d+) of 10 steps, (\S+ \S+) so far", capsys.readouterr().err) == [("3", "75 s"), ("6", "2 min"), ("9", "4 min")]
