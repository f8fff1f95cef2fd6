"""Results of every kind, computed once by the program from the shipped scenes with few replicas."""

import contextlib
import html
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import stiction
from stiction import finite_size
from stiction.errors import StictionError
from stiction.program import call, find

ROOT = Path(__file__).resolve().parents[3]
CONFIGS = ROOT / "configs"

if "STICTION" not in os.environ:
    try:
        find()
    except StictionError:
        os.environ["STICTION"] = str(ROOT / "target" / "release" / "stiction")


def of_scene(name, replicas, **overrides):
    def make(path):
        stiction.run(CONFIGS / f"{name}.toml", path, replicas=replicas, **overrides)

    return make


TARGETS = [
    {"quantity": "pull_off_force", "relative_standard_error": 0.02}, {"quantity": "pull_off_separation", "standard_error": "20 pm"},
]  # fmt: skip
MADE = {
    "run": of_scene("quick", 100),
    "curves": of_scene("quick", 40, **{"output.curves": True}),
    "ending_law": of_scene("quick", 20, **{"model.law": "emd", "material.hardness": "1 GPa"}),
    "retraction": of_scene(
        "quick", 40, **{"model.law": "md_plastic", "model.history": "retraction", "separation.h_star": {"from": 1.5, "to": 6.0, "count": 91}}
    ),
    "loop": of_scene("loop", 20),
    "cycles": of_scene("loop", 4, **{"separation.cycles": 2}),
    "instability": of_scene("instability", 20),
    "preload": of_scene("preload", 4),
    "spots": of_scene("probe", 20),
    "springs": of_scene("instability", 8, **{"output.curves": True}),
    "device": of_scene("preload", 8, **{"device.restoring_force": "0.6 mN"}),
    "pressed_sweep": lambda path: stiction.sweep(
        CONFIGS / "first.toml", {"material.work_of_adhesion": ["20 mJ/m^2", "50 mJ/m^2"]}, path, replicas=12,
        **{"model.history": "loop", "instability.preload": ["1 mN", "30 mN", "10 N"], "device.restoring_force": "0.1 mN"},
    ),
    "yielding_sweep": lambda path: stiction.sweep(
        CONFIGS / "first.toml", {"material.work_of_adhesion": ["20 mJ/m^2", "50 mJ/m^2"]}, path, replicas=12,
        **{"model.history": "loop", "material.hardness": "1 GPa", "instability.preload": ["1 mN", "10 N"], "device.restoring_force": "2 uN",
           "surface.nominal_area": "100 um^2"},
    ),
    "missed_preload": of_scene("preload", 4, **{"instability.preload": "10 N", "device.restoring_force": "0.1 mN"}),
    "stopping": lambda path: stiction.run(CONFIGS / "target.toml", path, **{"ensemble.target": TARGETS}),
    "coupled": of_scene("coupled", 4, **{"surface.nominal_area": "30 um^2"}),
    "background": of_scene("slider", 20),
    "sweep": of_scene("sweep_lubricant", 8),
    "grid": lambda path: stiction.sweep(
        CONFIGS / "quick.toml",
        {"surface.lubricant_thickness": ["0 nm", "0.5 nm"], "material.hardness": ["1 GPa", "2 GPa", "4 GPa"]},
        path,
        replicas=20,
    ),
    "heat_map": lambda path: stiction.sweep(
        CONFIGS / "quick.toml",
        {"material.work_of_adhesion": ["10 mJ/m^2", "30 mJ/m^2", "90 mJ/m^2"], "material.hardness": ["1 GPa", "2 GPa", "4 GPa"]},
        path,
        replicas=8,
        **{"device.restoring_force": "30 uN"},
    ),
    "judged": lambda path: stiction.sweep(
        CONFIGS / "case_iii.toml",
        {"material.work_of_adhesion": ["1 mJ/m^2", "10 mJ/m^2", "90 mJ/m^2"], "surface.nominal_area": ["1 um^2", "10 um^2", "100 um^2"]},
        path,
        replicas=2,
    ),
    "sweep_of_one": lambda path: stiction.sweep(
        CONFIGS / "quick.toml", {"material.work_of_adhesion": ["10 mJ/m^2", "30 mJ/m^2"]}, path, replicas=4
    ),
    "comparison": lambda path: stiction.compare(
        CONFIGS / "quick.toml", ["hybrid", "emd", "fit:paper", "gw"], path, ensemble=True, replicas=40
    ),
    "finite_size": lambda path: finite_size.run(CONFIGS / "case_ii.toml", "30:3000:5", path, replicas=50),
    "alone": of_scene("loop", 0),
    "alone_sweep": of_scene("sweep_lubricant", 0),
    "asperities": lambda path: stiction.find_asperities(CONFIGS / "maps" / "polished.txt", path),
    "grid_of_three": lambda path: stiction.sweep(
        CONFIGS / "quick.toml",
        {"surface.lubricant_thickness": ["0 nm", "0.5 nm"], "material.hardness": ["1 GPa", "2 GPa"],
         "material.work_of_adhesion": ["10 mJ/m^2", "30 mJ/m^2", "90 mJ/m^2"]},
        path,
        replicas=10,
    ),
    "choice": lambda path: stiction.sweep(
        CONFIGS / "coupled.toml", {"substrate.coupling": ["none", "patch"]}, path, replicas=2
    ),
    "partial": lambda path: partial(path),
}  # fmt: skip


def partial(path):
    """A shard, which is a run of which a half is missing."""
    call(["run", str(CONFIGS / "quick.toml"), "--replicas", "64", "--shard", "1/2", "-o", str(path), "--quiet"])


@pytest.fixture(scope="session")
def result(shared):
    """The result of a name of `MADE`, opened; each is computed when it is first asked for."""
    return lambda name: stiction.open_run(shared(f"{name}.h5", MADE[name]))


@pytest.fixture
def command(tmp_path, monkeypatch):
    """Runs `stiction asperities` in an empty folder; its lines have at most 80 columns."""
    monkeypatch.chdir(tmp_path)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}

    def run(*arguments, code=0):
        words = [sys.executable, "-m", "stiction.maps", *map(str, arguments)]
        done = subprocess.run(words, capture_output=True, text=True, encoding="utf-8", env=environment)
        assert done.returncode == code, done.stderr
        assert all(len(line) <= 80 for line in done.stdout.splitlines()[1:])
        return done.stderr if code else done.stdout

    return run


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium without network but for servers of this machine."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="no selenium, so no page was opened in a browser")
    program, driver = shutil.which("chromium") or shutil.which("google-chrome"), shutil.which("chromedriver")
    if not (program and driver):
        pytest.skip("no Chromium with its driver, so no page was opened in a browser")
    options = webdriver.ChromeOptions()
    options.binary_location = program
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    opened = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    yield opened
    opened.quit()


@contextlib.contextmanager
def begun(code, *arguments, folder):
    """A Python that runs a scene with progress, once the first batch is done: what is interrupted before keeps nothing."""
    code = f"from stiction import progress\nprogress._FIRST = progress._APART = progress._MOST = 0.1\n{code}"
    process = subprocess.Popen(
        [sys.executable, "-c", code, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "TMPDIR": str(folder)},
        # A shell that runs tests in the background has them ignore it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    shown = ""
    while not re.search(r"\b[1-9]\d* of", shown):
        read = process.stderr.read(1)
        assert read, shown
        shown += read
    with process:
        yield process


def assert_opens(path, words, folder, has_figure=True):
    """`stiction info`, `plot` and `report` open the file of a command in Python: its words are there, and its figure if it has one."""
    from stiction import program
    from stiction.plot import command as plot
    from stiction.report import command as report

    assert words in program.call(["info", str(path)])
    assert plot.main([str(path), "-o", str(folder / "opened.svg"), "--force"]) == (0 if has_figure else 2)
    assert not has_figure or "<svg" in (folder / "opened.svg").read_text(encoding="utf-8")
    assert report.main([str(path), "-o", str(folder / "opened.html"), "--force"]) == 0
    page = (folder / "opened.html").read_text(encoding="utf-8")
    assert html.escape(words) in page and ("<svg" in page) == has_figure
