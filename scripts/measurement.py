"""What the scripts that measure the program have in common: scenes out of case II, runs and what they cost, the table, the command line."""

import argparse
import csv
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

try:
    import h5py
    from matplotlib import rc_context
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
except ImportError as error:
    print(f"{Path(sys.argv[0]).stem}: {error}; pip install -r scripts/requirements.txt", file=sys.stderr)
    sys.exit(2)

CONFIGS = Path(__file__).resolve().parents[1] / "configs"
PAGE = (11.0, 7.9)  # inches
HEADER = ["quantity", "setting", "value", "unit", "what"]
MOMENTS = '\n[solver]\nsummation = "moments"\ntolerance = 1e-9\n'
DIRECT = '\n[solver]\nsummation = "direct"\n'
STYLES = {"direct": ("#0072B2", "o", "-"), "moments": ("#D55E00", "s", (0, (5, 1.5)))}
STYLE = {
    "font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.labelsize": 9,
    "legend.fontsize": 8, "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.linewidth": 0.7,
    "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False,
}
# Starts a program and prints what it took: peak resident memory, wall time and core time. A process counts the memory of the one that
# started it as its own until it has been replaced, so that it has to be started by something small: not by a script with all its packages.
LAUNCHER = """
import os, sys, time
begin = time.perf_counter()
process = os.spawnv(os.P_NOWAIT, sys.argv[1], sys.argv[1:])
_, status, usage = os.wait4(process, 0)
print(usage.ru_maxrss, time.perf_counter() - begin, usage.ru_utime + usage.ru_stime)
sys.exit(os.waitstatus_to_exitcode(status) & 255)
"""
LONGEST_RUN = 120  # seconds; all runs are meant to take less than 20
KILOBYTE = 1 if sys.platform == "darwin" else 1024  # unit of ru_maxrss in bytes


class MeasurementError(Exception):
    """Why nothing can be measured."""


class RunError(Exception):
    """A run that failed."""


@dataclass
class Row:
    """One measured number."""

    quantity: str
    setting: str
    value: float
    unit: str
    what: str


@dataclass
class Table:
    """Measured numbers."""

    rows: list[Row] = field(default_factory=list)

    def add(self, *row: object) -> None:
        self.rows.append(Row(*row))

    def save(self, path: Path) -> None:
        with open(path, "w", newline="", encoding="utf-8") as file:
            lines = [[row.quantity, row.setting, f"{row.value:.6g}", row.unit, row.what] for row in self.rows]
            csv.writer(file, lineterminator="\n").writerows([HEADER, *lines])

    def show(self) -> None:
        width = max(len(row.quantity) for row in self.rows), max(len(row.setting) for row in self.rows)
        for row in self.rows:
            print(f"{row.quantity:{width[0]}}  {row.setting:{width[1]}}  {row.value:10.4g} {'' if row.unit == '1' else row.unit}".rstrip())


@dataclass
class Cost:
    """What a process took."""

    memory: float  # peak resident, bytes
    seconds: float  # wall time
    core_seconds: float  # user and system time


class Program:
    """Runs scenes in a temporary folder."""

    def __init__(self, path: Path, folder: Path) -> None:
        # Absolute, because a path without a folder would be looked up on the PATH.
        self.path, self.folder, self.result = path.resolve(), folder, folder / "result.h5"
        self.case_ii = (CONFIGS / "case_ii.toml").read_text(encoding="utf-8")

    def write_scene(self, area: float, count: int, solver: str) -> Path:
        text, scene = self.case_ii, self.folder / "scene.toml"
        for pattern, replacement in [(r'(?m)^nominal_area = "[^"]*"', f'nominal_area = "{area:.9g} um^2"'),
                                     (r"from = [\d.]+, to = 8.0, count = \d+", f"from = -1.0, to = 8.0, count = {count}")]:
            text, changes = re.subn(pattern, replacement, text)
            if changes != 1:
                raise MeasurementError(f"{CONFIGS / 'case_ii.toml'}: {pattern} is not there once")
        scene.write_text(text + solver, encoding="utf-8")
        return scene

    def command(self, scene: Path, threads: int, replicas: int | None) -> list[str]:
        given = [] if replicas is None else ["--replicas", str(replicas)]
        return [str(self.path), "run", str(scene), "-o", str(self.result), "--force", "--quiet", "--threads", str(threads), *given]

    def start(self, command: list[str]) -> str:
        try:
            done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=LONGEST_RUN)
        except subprocess.TimeoutExpired:
            raise RunError(f"a run took longer than {LONGEST_RUN} s: {' '.join(command[1:])}") from None
        if done.returncode:
            raise RunError(f"exit code {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def phases(self, result: Path | None = None) -> dict[str, float]:
        """Seconds of the phases of a run, by default the last, in their order."""
        with h5py.File(result or self.result, "r") as file:
            return dict(zip((name.decode() for name in file["diagnostics/phase"][()]), file["diagnostics/seconds"][()].tolist()))

    def seconds(self, scene: dict[str, int], solver: str, threads: int = 1) -> float:
        self.start(self.command(self.write_scene(scene["area"], scene["count"], solver), threads, scene["replicas"]))
        return self.phases()["ensemble"]

    def refusal(self) -> str | None:
        """Why the last run summed directly although it was asked to compress; None if it did as it was asked."""
        with h5py.File(self.result, "r") as file:
            text = file["ensemble"].attrs.get("sum_refusal")
            return text.decode() if isinstance(text, bytes) else text

    def asperities(self) -> float:
        with h5py.File(self.result, "r") as file:
            return float(file["replicas/asperity_count"][()].mean())

    def cost(self, command: list[str]) -> Cost:
        printed = self.start([sys.executable, "-I", "-S", "-c", LAUNCHER, *command])
        memory, seconds, core_seconds = map(float, printed.split()[-3:])
        return Cost(memory * KILOBYTE, seconds, core_seconds)


def panel(figure: Figure, index: int, columns: tuple[int, float, float, float]) -> Axes:
    """A panel of a page of two rows, whose columns are so many, begin at a place, have a distance and a width, inches."""
    (w, h), (count, first, distance, width) = PAGE, columns
    left, bottom = first + distance * (index % count), 4.65 - 3.75 * (index // count)
    return figure.add_axes((left / w, bottom / h, width / w, 2.75 / h))


def main(about: str, plans: tuple[Any, Any], measure: Callable[[Path, Path, Any], Table], draw: Callable[[Any, Any], Figure]) -> int:
    """Reads the command line, measures a plan, the second with --quick, and leaves a table and a picture of what `measure` finds with a
    program in a temporary folder. Returns the exit code."""
    name = Path(sys.argv[0]).stem
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--stiction", type=Path, required=True, metavar="PROGRAM", help="the program, built with --release")
    parser.add_argument("-o", "--output", type=Path, default=Path(f"{name}.png"), metavar="OUT.png", help=f"default: {name}.png")
    parser.add_argument("--csv", type=Path, metavar="OUT.csv", help="all points; default: beside OUT.png")
    parser.add_argument("--quick", action="store_true", help="small scenes, for seconds instead of minutes")
    parser.add_argument("--dpi", type=int, default=200, metavar="N", help="dots per inch, default 200")
    arguments = parser.parse_args()
    plan, table = plans[arguments.quick], arguments.csv or arguments.output.with_suffix(".csv")
    try:
        if not arguments.stiction.is_file():
            raise MeasurementError(f"no such program: {arguments.stiction}")
        for output in (arguments.output, table):
            # Minutes later would be too late to say so.
            if not output.resolve().parent.is_dir():
                raise MeasurementError(f"no such folder: {output.parent}")
        with tempfile.TemporaryDirectory() as folder:
            results = measure(arguments.stiction, Path(folder), plan)
        results.save(table)
        with rc_context(STYLE):
            draw(plan, results).savefig(arguments.output, dpi=arguments.dpi)
    except (RunError, subprocess.TimeoutExpired) as error:
        print(f"{name}:", *str(error).split(), file=sys.stderr)
        return 1
    except (MeasurementError, OSError, ValueError) as error:
        print(f"{name}:", *str(error).split(), file=sys.stderr)
        return 2
    results.show()
    print(arguments.output)
    return 0
