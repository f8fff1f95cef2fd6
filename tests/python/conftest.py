"""Slow tests run where they are asked for, by `-m slow` or by a node id; results that several tests look at are made once in a session.

What is left out on this machine is said at the end, with what the tests of Rust and the cluster have left out: the lines of the file
$STICTION_SKIPPED. Where $STICTION_FORBID_SKIPS is set, leaving something out is a failure."""

import os
from pathlib import Path

import pytest
from filelock import FileLock

# What makes tests longer is for those who want to wait.
LONGER = ("STICTION_RARE", "STICTION_DAMAGES", "STICTION_POSTERIORS")
FORBIDDEN = bool(os.environ.get("STICTION_FORBID_SKIPS"))


def is_named(item, path, name):
    """Whether a test, or the function or class that it is of, has this node id."""
    own = item.nodeid.partition("::")[2]
    return item.path == path and own.startswith(name) and own[len(name) :][:1] in ("", "[", ":")


def pytest_collection_modifyitems(config, items):
    if config.option.markexpr or any(name in os.environ for name in LONGER):
        return
    parts = [argument.partition("::") for argument in config.args]
    ids = [((config.invocation_params.dir / path).resolve(), name) for path, _, name in parts if name]
    left = {item for item in items if item.get_closest_marker("slow") and not any(is_named(item, *one) for one in ids)}
    config.hook.pytest_deselected(items=list(left))
    items[:] = [item for item in items if item not in left]


@pytest.fixture(scope="session")
def shared(tmp_path_factory):
    """Makes what several tests look at once, whatever process they run in: `shared(name, make)` is the path of that name, which
    `make(path)` has written."""
    base = tmp_path_factory.getbasetemp()
    # Processes of pytest-xdist have folders of their own in that of the session.
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "shared"
    folder.mkdir(exist_ok=True)

    def get(name, make):
        path = folder / name
        # The program has a lock of its own, `.NAME.lock`.
        with FileLock(folder / f"{name}.filelock"):
            if not (folder / f"{name}.made").exists():
                make(path)
                (folder / f"{name}.made").touch()
        return path

    return get


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
