"""What is left out on this machine is said at the end, with what the tests of Rust and the cluster have left out: the lines of the file
$STICTION_SKIPPED. Where $STICTION_FORBID_SKIPS is set, leaving something out is a failure."""

import os
from pathlib import Path

FORBIDDEN = bool(os.environ.get("STICTION_FORBID_SKIPS"))


def left_out(reporter) -> list[str]:
    listed = os.environ.get("STICTION_SKIPPED")
    lines = Path(listed).read_text(encoding="utf-8").splitlines() if listed and Path(listed).exists() else []
    for report in reporter.stats.get("skipped", []):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
        lines.append(f"{report.nodeid}: {reason.removeprefix('Skipped: ')}")
    return lines


def pytest_terminal_summary(terminalreporter):
    lines = left_out(terminalreporter)
    terminalreporter.section("left out on this machine")
    for line in lines or ["nothing"]:
        terminalreporter.line(line)


def pytest_sessionfinish(session, exitstatus):
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if FORBIDDEN and exitstatus == 0 and left_out(reporter):
        session.exitstatus = 1
