"""How time and memory of `stiction run` grow: with asperities, separations, replicas and threads.

The scenes are configs/case_ii.toml with another nominal area (N = density times area), number of separations and number of
replicas, and are run on one thread unless threads are what varies. Measured are

    time       seconds of the ensemble phase (/diagnostics/seconds of the result) over N, S and replicas, each over three
               decades, for every way to sum that the program knows; the exponent is a least-squares slope of the logarithms
    threads    the same over threads, 1, 2, 4 ... up to the cores, in alternating runs, the least of fifteen,
               beside as many processes of one thread: what the machine gives
    memory     peak resident memory of the process over replicas
    start-up   wall time of configs/quick.toml without the ensemble phase and those after it, the least of ten

Usage:
    python scripts/scaling.py --stiction PROGRAM [-o OUT.png] [--csv OUT.csv] [--quick] [--dpi N]

Takes some minutes on an idle machine; --quick takes seconds and shows only that everything works.
Exit codes: 0 done; 1 a run failed; 2 PROGRAM or a package is missing, or an output cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "matplotlib>=3.7"]
# ///

import math
import os
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

# First, because it says which package is missing.
from measurement import CONFIGS, DIRECT, LONGEST_RUN, MOMENTS, PAGE, STYLES, Program, RunError, Table, main, panel
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, StrMethodFormatter

COLUMNS = (3, 0.7, 3.6, 2.85)  # of the page, inches


@dataclass(frozen=True)
class Series:
    """What one panel of times varies, and what it keeps."""

    name: str
    label: str
    values: tuple[int, ...]
    areas: int  # um^2
    separations: int
    replicas: int

    def scene(self, value: int) -> dict[str, int]:
        """Nominal area, separations and replicas of one point."""
        fixed = {"area": self.areas, "count": self.separations, "replicas": self.replicas}
        return fixed | {{"N": "area", "S": "count", "replicas": "replicas"}[self.name]: value}


@dataclass
class Plan:
    """Everything that is measured."""

    series: list[Series]
    repetitions: int  # of a point, as long as it is short
    threads: tuple[int, int, int]  # nominal area, separations, replicas
    thread_repetitions: int
    faster: int  # times as many replicas where sums are by moments
    memory: tuple[int, ...]  # replicas
    start_ups: int


HALF_DECADES = (1, 3, 10, 32, 100, 316, 1000)
FULL = Plan(
    series=[Series("N", "asperities per replica $N$", tuple(100 * x for x in HALF_DECADES), 0, 181, 4),
            Series("S", "separations $S$", tuple(10 * x for x in HALF_DECADES), 1000, 0, 4),
            Series("replicas", "replicas", (3, 10, 30, 100, 300, 1000, 3000), 100, 61, 0)],
    repetitions=9, threads=(1000, 181, 200), thread_repetitions=15, faster=10, memory=tuple(1000 * x for x in HALF_DECADES), start_ups=10,
)
QUICK = Plan(
    series=[Series("N", "asperities per replica $N$", (10, 100, 1000), 0, 31, 2),
            Series("S", "separations $S$", (10, 100, 1000), 10, 0, 2),
            Series("replicas", "replicas", (2, 20, 200), 10, 31, 0)],
    repetitions=1, threads=(100, 61, 40), thread_repetitions=1, faster=1, memory=(10, 100, 1000), start_ups=2,
)


@dataclass
class Results(Table):
    """Rows of the table, and what is drawn of them."""

    times: dict[tuple[str, str], list[tuple[float, float]]] = field(default_factory=dict)  # by series and sum
    exponents: dict[tuple[str, str], float] = field(default_factory=dict)
    threads: dict[str, dict[int, float]] = field(default_factory=dict)
    processes: dict[str, dict[int, float]] = field(default_factory=dict)
    memory: list[tuple[float, float]] = field(default_factory=list)
    start_up: dict[str, float] = field(default_factory=dict)  # by what it goes into


class Scaling(Program):
    """Runs by which growth is measured."""

    def seconds_side_by_side(self, scene: dict[str, int], solver: str, count: int) -> float:
        """The longest ensemble phase of so many processes at once, of one thread each, that share the replicas of a scene."""
        path, processes = self.write_scene(scene["area"], scene["count"], solver), {}
        for index in range(count):
            result = self.folder / f"beside{index}.h5"
            command = self.command(path, 1, scene["replicas"] // count)
            command[command.index(str(self.result))] = str(result)
            processes[result] = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, encoding="utf-8")
        for process in processes.values():
            _, error = process.communicate(timeout=LONGEST_RUN)
            if process.returncode:
                raise RunError(f"exit code {process.returncode}: {error.strip()}")
        return max(self.phases(result)["ensemble"] for result in processes)

    def memory(self, scene: dict[str, int], solver: str) -> float:
        """Peak resident memory of one run, in bytes."""
        command = self.command(self.write_scene(scene["area"], scene["count"], solver), 1, scene["replicas"])
        return self.cost(command).memory

    def start_up(self) -> dict[str, float]:
        """Wall time of a whole process without the ensemble phase and those after it, by what it goes into."""
        command = self.command(CONFIGS / "quick.toml", 1, None)
        begin = time.perf_counter()
        self.start(command)
        wall, phases = time.perf_counter() - begin, self.phases()
        names = list(phases)
        before = {name: phases[name] for name in names[:names.index("ensemble")]}
        return {"process, scene, file": wall - sum(phases.values())} | before

    def solvers(self) -> dict[str, str]:
        """The ways to sum that the program knows, with what a scene says to get them."""
        command = self.command(self.write_scene(10, 3, MOMENTS), 1, 2)
        done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=LONGEST_RUN)
        if done.returncode == 0:
            return {"direct": DIRECT, "moments": MOMENTS}
        if done.returncode != 2:
            raise RunError(f"exit code {done.returncode}: {done.stderr.strip()}")
        print(f"scaling: sums by moments are left out, the program does not know them ({' '.join(done.stderr.split())})", file=sys.stderr)
        return {"direct": ""}


def measure(path: Path, folder: Path, plan: Plan) -> Results:
    program, results = Scaling(path, folder), Results()
    solvers = program.solvers()
    for series in plan.series:
        for value in series.values:
            for name, solver in solvers.items():
                measure_time(program, plan, results, series, value, name, solver)
        for name in solvers:
            points = np.log(results.times.get((series.name, name), []))
            if len(points) < 2:
                continue
            # Only where time is more than what every run pays once: the upper two decades.
            upper = points[points[:, 0] >= points[-1, 0] - math.log(110.0)]
            results.exponents[series.name, name] = exponent = float(np.polyfit(*upper.T, 1)[0])
            results.add(f"exponent of {series.name}", f"sum = {name}", exponent, "1",
                        f"least-squares slope of log seconds over log {series.name}, upper two decades")
    measure_threads(program, plan, results, solvers)
    for replicas in plan.memory:
        scene = {"area": 1, "count": 2, "replicas": replicas}
        peak = program.memory(scene, solvers["direct"])
        results.memory.append((replicas, peak))
        results.add("peak resident memory", f"replicas = {replicas}", peak, "B", "one process, area of 1 um^2, 2 separations, 1 thread")
    results.start_up = min((program.start_up() for _ in range(plan.start_ups)), key=lambda parts: sum(parts.values()))
    what = ("wall time of the process less the ensemble phase and those after it, the file written included; "
            f"least of {plan.start_ups}, 1 thread")
    results.add("start-up", "configs/quick.toml", sum(results.start_up.values()), "s", what)
    for name, seconds in results.start_up.items():
        results.add("start-up", f"configs/quick.toml, {name}", seconds, "s", "part of it")
    return results


def measure_time(program: Scaling, plan: Plan, results: Results, series: Series, value: int, name: str, solver: str) -> None:
    """One point; short runs are repeated and the least is taken."""
    scene, seconds = series.scene(value), []
    while len(seconds) < plan.repetitions and sum(seconds) < 3.0:
        seconds.append(program.seconds(scene, solver))
    count, refusal = program.asperities(), program.refusal()
    x = count if series.name == "N" else value
    # A run that fell back to direct sums is no point of the other line.
    if not refusal:
        results.times.setdefault((series.name, name), []).append((x, min(seconds)))
    results.add(f"ensemble seconds over {series.name}", f"sum = {name}, {series.name} = {x:g}", min(seconds), "s",
                f"ensemble phase, N = {count:g}, S = {scene['count']}, {scene['replicas']} replicas, 1 thread, least of {len(seconds)}"
                + (f"; summed directly: {refusal}" if refusal else ""))


def measure_threads(program: Scaling, plan: Plan, results: Results, solvers: dict[str, str]) -> None:
    area, count, replicas = plan.threads
    repetitions = plan.thread_repetitions
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    numbers = sorted({min(2**i, cores) for i in range(cores.bit_length() + 1)})
    for name, solver in solvers.items():
        # Of the faster sums more, so that both take long enough to be timed.
        scene = {"area": area, "count": count, "replicas": replicas * (plan.faster if name == "moments" else 1)}
        seconds, core_seconds, beside = ({threads: math.inf for threads in numbers} for _ in range(3))
        for _ in range(repetitions):
            for threads in numbers:
                before = os.times()
                seconds[threads] = min(seconds[threads], program.seconds(scene, solver, threads))
                after = os.times()
                used = after.children_user + after.children_system - before.children_user - before.children_system
                core_seconds[threads] = min(core_seconds[threads], used)
                # What the machine has to give at that moment, to whoever asks.
                beside[threads] = min(beside[threads], program.seconds_side_by_side(scene, solver, threads))
        results.threads[name] = {threads: seconds[1] / seconds[threads] for threads in numbers}
        results.processes[name] = {threads: seconds[1] / beside[threads] for threads in numbers}
        for threads in numbers:
            what = f"ensemble phase, area of {area} um^2, S = {count}, {scene['replicas']} replicas, alternating runs, least of {repetitions}"
            results.add("seconds over threads", f"sum = {name}, threads = {threads}", seconds[threads], "s", what)
            # What other threads cost, also on a machine that has no core for them.
            results.add("core seconds over threads", f"sum = {name}, threads = {threads}", core_seconds[threads], "s",
                        f"user and system time of the whole process; {what}")
            results.add("speed-up of processes", f"sum = {name}, processes = {threads}", seconds[1] / beside[threads], "1",
                        f"as many processes of one thread that share the replicas, the longest; {what}")
            results.add("speed-up", f"sum = {name}, threads = {threads}", seconds[1] / seconds[threads], "1", what)


def draw_times(axes: Axes, letter: str, series: Series, results: Results) -> None:
    for (of, name), points in results.times.items():
        if of != series.name:
            continue
        color, marker, line = STYLES[name]
        x, y = np.array(points).T
        axes.plot(x, y, color=color, marker=marker, linestyle=line, linewidth=1.4, markersize=4.5,
                  label=f"{name}: exponent {results.exponents[of, name]:.2f}")
    points = results.times[series.name, "direct"]
    x, last = np.array([points[0][0], points[-1][0]]), points[-1]
    axes.plot(x, last[1] * x / last[0], color="0.75", linewidth=0.8, zorder=0, label="proportional")
    kept = {"N": f"$S$ = {series.separations}, {series.replicas} replicas",
            "S": f"{series.areas} µm², {series.replicas} replicas",
            "replicas": f"{series.areas} µm², $S$ = {series.separations}"}[series.name]
    axes.set(xscale="log", yscale="log", xlabel=series.label, ylabel="seconds of the ensemble phase")
    axes.set_title(f"({letter}) Time over {series.label.split()[-1]}; {kept}")
    axes.legend(loc="upper left")


def draw_threads(axes: Axes, results: Results) -> None:
    numbers = sorted(next(iter(results.threads.values())))
    for name, ratios in results.threads.items():
        color, marker, line = STYLES[name]
        axes.plot(numbers, [ratios[n] for n in numbers], color=color, marker=marker, linestyle=line, linewidth=1.4, markersize=4.5,
                  label=f"{name}: {ratios[numbers[-1]]:.2f} on {numbers[-1]}")
    most = [max(ratios[n] for ratios in results.processes.values()) for n in numbers]
    axes.plot(numbers, most, color="0.5", marker="_", linestyle=":", linewidth=1.0, zorder=1, label=f"processes: {most[-1]:.2f}")
    axes.plot(numbers, numbers, color="0.75", linewidth=0.8, zorder=0, label="ideal")
    axes.set(xlabel="threads", ylabel="speed-up of the ensemble phase", title="(d) Threads")
    axes.xaxis.set_major_locator(FixedLocator(numbers))
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper left")


def draw_memory(axes: Axes, results: Results) -> None:
    replicas, peak = np.array(results.memory).T
    slope = (peak[-1] - peak[0]) / (replicas[-1] - replicas[0])
    axes.plot(replicas, peak / 1e6, color="#0072B2", marker="o", linewidth=1.4, markersize=4.5,
              label=f"{peak[0] / 1e6:.0f} MB and {max(slope, 0.0):.0f} B per replica")
    axes.set(xscale="log", yscale="log", xlabel="replicas", ylabel="peak resident memory (MB)", title="(e) Memory; 1 µm², $S$ = 2")
    axes.set_ylim(1.0, max(1000.0, 2.0 * peak.max() / 1e6))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.legend(loc="upper left")


def draw_start_up(axes: Axes, results: Results) -> None:
    names, seconds = list(results.start_up), list(results.start_up.values())
    axes.barh(range(len(names)), [1e3 * value for value in seconds], height=0.4, color="0.8", edgecolor="0.5", linewidth=0.6)
    for index, (name, value) in enumerate(results.start_up.items()):
        axes.text(0.3, index - 0.24, f"{name}: {1e3 * value:.3g} ms", fontsize=8, va="bottom")
    axes.set(yticks=[], ylim=(len(names) - 0.4, -0.75), xlabel="milliseconds",
             title=f"(f) Start-up of configs/quick.toml: {1e3 * sum(seconds):.3g} ms")


def draw(plan: Plan, results: Results) -> Figure:
    figure = Figure(figsize=PAGE)
    for index, series in enumerate(plan.series):
        draw_times(panel(figure, index, COLUMNS), "abc"[index], series, results)
    draw_threads(panel(figure, 3, COLUMNS), results)
    draw_memory(panel(figure, 4, COLUMNS), results)
    draw_start_up(panel(figure, 5, COLUMNS), results)
    cores = max(max(ratios) for ratios in results.threads.values())
    figure.text(0.5, 0.015, "case II with other areas, separations and replicas; one thread but in (d), "
                f"{cores} core{'s' if cores > 1 else ''}; exponents over the upper two decades", ha="center", fontsize=8.5)
    return figure


if __name__ == "__main__":
    sys.exit(main("How time and memory of `stiction run` grow.", (FULL, QUICK), measure, draw))
