"""What an experiment that is divided over many machines costs: throughput of a core, sizes of shards and results, time and memory of merging.

All is measured on this machine with case II (configs/case_ii.toml), one thread a process:

    throughput   ensemble phase of case II, summed directly and by moments, and by moments of surfaces of a million and of ten million
                 asperities: the difference of runs of few and of many replicas, each the least of several; and the phase before it, of
                 the functionals of the joint test and the trial of sums by moments
    sizes        every shard of the series below against what docs/shards.md says that it holds: a node of the tree takes 8 bytes for
                 each word of its moments, a replica 8 for each word of its record and for its index
    merging      core seconds, wall time and peak resident memory of `stiction merge` over 1 to 1000 shards of the same 8000 replicas,
                 so that in the end a shard is one batch; of patches of 10 um^2, which are drawn in no time: what a merge costs depends
                 on the separations, regimes and functionals, which are those of case II, and not on asperities
    replicas     the same over 1000 to 1000000 replicas in 4 shards, of patches of 1 um^2 at 2 separations, which leave little but replicas

From these it prints, as Markdown, what larger experiments would cost, and from which measurement each figure comes.

Usage:
    python scripts/shard_costs.py --stiction PROGRAM [-o OUT.png] [--csv OUT.csv] [--quick] [--dpi N]

Takes five minutes on two idle cores and half a gigabyte of disk; --quick takes seconds and shows only that everything works.
Exit codes: 0 done; 1 a run failed; 2 PROGRAM or a package is missing, or an output cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "matplotlib>=3.7"]
# ///

import math
import os
import statistics
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

# First, because it says which package is missing.
from measurement import DIRECT, MOMENTS, PAGE, STYLES, Cost, Program, Table, main, panel
import h5py
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

COLUMNS = (2, 0.8, 5.35, 4.1)  # of the page, inches
BLUE, ORANGE = STYLES["direct"][0], STYLES["moments"][0]
BATCH = 8  # replicas
CURVES = 1000  # replicas, the first of a run, whose curves shards have for quantiles
CHUNK = 2**20  # asperities, more of which are shared by threads
DENSITY = 7.39  # asperities per um^2 of case II
# What larger experiments are divided into, at most.
NODE_CORES, SHARDS = 64, 1000


@dataclass(frozen=True)
class Patches:
    """Replicas of a patch of case II that are cheap to draw."""

    area: float  # um^2
    separations: int
    solver: str


@dataclass(frozen=True)
class Plan:
    """Everything that is measured."""

    case_ii: dict[str, tuple[int, int]]  # few and many replicas, by how they are summed
    surfaces: dict[float, tuple[int, int]]  # likewise by asperities
    repetitions: tuple[int, int]  # of both
    shards: tuple[int, ...]
    sharded: tuple[Patches, int]  # and its replicas
    replica_counts: tuple[int, ...]
    counted: tuple[Patches, int]  # and its shards
    merges: int


FULL = Plan(case_ii={"direct": (4, 68), "moments": (40, 1000)}, surfaces={1e6: (4, 36), 1e7: (4, 8)}, repetitions=(9, 3),
            shards=(1, 3, 10, 32, 100, 316, 1000), sharded=(Patches(10, 181, MOMENTS), 8000), replica_counts=(1000, 10_000, 100_000, 1_000_000),
            counted=(Patches(1, 2, DIRECT), 4), merges=5)
QUICK = Plan(case_ii={"direct": (4, 12), "moments": (4, 36)}, surfaces={1e4: (4, 36), 1e5: (4, 8)}, repetitions=(1, 1),
             shards=(1, 3, 10, 20), sharded=(Patches(10, 31, MOMENTS), 160), replica_counts=(1000, 4000, 16_000), counted=(Patches(1, 2, DIRECT), 4), merges=1)


def batches_of(shard: int, shards: int, batches: int) -> tuple[int, int]:
    """The first batch of a shard, and that behind its last."""
    return (shard - 1) * batches // shards, shard * batches // shards


def nodes(first: int, end: int) -> int:
    """Nodes of the tree that a range of batches covers as a whole."""
    count = 0
    while first < end:
        fitting = 1 << ((end - first).bit_length() - 1)
        first += min(first & -first, fitting) if first else fitting
        count += 1
    return count


def written(length: int) -> int:
    """Bytes of a whole number in the Postcard format."""
    return max(1, -(-length.bit_length() // 7))


@dataclass
class Sizes:
    """Bytes of the parts of a shard's file."""

    fixed: float  # what run it is of
    node: float
    replica: float
    curve: float = 0.0  # of each of the first replicas of a run besides, for quantiles

    def of(self, nodes: int, replicas: int, curves: int = 0) -> float:
        """Bytes of a shard that has the curves of so many of its replicas."""
        return self.fixed + self.node * nodes + self.replica * replicas + self.curve * curves

    @classmethod
    def derived(cls, shard: Path, result: Path) -> "Sizes":
        """Those of the scene of a shard of one batch, and of a result of it."""
        with h5py.File(result, "r") as file:
            separations, regimes = len(file["ensemble/separation"]), len(file["ensemble/regime"])
            scalars, asperities = len(file["ensemble/control"]) + len(file["ensemble/scalar"]), int(file["replicas/asperity_count"][0])

        def numbers(*lengths: int) -> int:
            """A count, and lists of so many numbers."""
            return 1 + sum(written(length) + 8 * length for length in lengths)

        thirds = scalars * (scalars + 1) * (scalars + 2) // 6
        # Four curves over replicas and over groups, three of each regime, 16 parts of the scalars, counts of what was solved.
        node = 8 * numbers(separations, separations) + 3 * numbers(regimes * separations, regimes * separations)
        node += 16 * numbers(scalars, scalars**2, thirds) + 40
        # Its numbers; of each batch the header of a frame and the lengths of four lists.
        sizes = cls(0.0, float(node), written(asperities) + 5 * 8 + 2 + 16 / BATCH, float(written(separations) + 8 * separations))
        sizes.fixed = shard.stat().st_size - sizes.of(1, BATCH, BATCH)
        return sizes


@dataclass(frozen=True)
class Replica:
    """What one replica of a scene takes on one core, and a run before its replicas."""

    sum: str
    asperities: float
    seconds: float
    before: float  # seconds of functionals and trial
    memory: float

    def per_asperity(self) -> float:
        return self.seconds / self.asperities


@dataclass
class Merged:
    """What merging took."""

    cost: Cost
    shard_bytes: int
    result_bytes: int


@dataclass
class Results(Table):
    """Rows of the table, what is drawn of them, and what is extrapolated from them."""

    case_ii: dict[str, "Replica"] = field(default_factory=dict)  # by how it is summed
    surfaces: list["Replica"] = field(default_factory=list)  # from the smallest
    start: float = 0.0  # core seconds of a shard of hardly any asperities
    shard_sizes: list[tuple[int, int, float]] = field(default_factory=list)  # batches, bytes, derived bytes
    sizes: Sizes | None = None
    over_shards: dict[int, Merged] = field(default_factory=dict)
    over_replicas: dict[int, Merged] = field(default_factory=dict)
    batches: int = 0

    def show(self) -> None:
        super().show()
        print(extrapolation(self))


class Shards(Program):
    """Shards and merges of them."""

    def shards(self, patches: Patches, replicas: int, count: int) -> tuple[list[Path], list[float]]:
        """All shards of some replicas, made on all cores, and the core seconds of each."""
        scene = self.write_scene(patches.area, patches.separations, patches.solver)
        files = [self.folder / f"{count}-{index}.shard" for index in range(1, count + 1)]

        def make(index: int) -> float:
            command = self.command(scene, 1, replicas)
            command[command.index(str(self.result))] = str(files[index])
            return self.cost([*command, "--shard", f"{index + 1}/{count}"]).core_seconds

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return files, list(pool.map(make, range(count)))

    def merge(self, files: list[Path], times: int) -> Merged:
        """The least of several merges, in core seconds."""
        command = [str(self.path), "merge", *map(str, files), "-o", str(self.result), "--force", "--quiet", "--threads", "1"]
        cost = min((self.cost(command) for _ in range(times)), key=lambda cost: cost.core_seconds)
        return Merged(cost, sum(file.stat().st_size for file in files), self.result.stat().st_size)


def measure(path: Path, folder: Path, plan: Plan) -> Results:
    program, results = Shards(path, folder), Results()
    measure_throughput(program, plan, results)
    measure_shards(program, plan, results)
    patches, count = plan.counted
    for replicas in plan.replica_counts:
        files, _ = program.shards(patches, replicas, count)
        merged = results.over_replicas[replicas] = program.merge(files, plan.merges)
        add_merge(results, plan, f"replicas = {replicas}", f"{count} shards, {about(patches)}", merged)
    return results


def measure_throughput(program: Shards, plan: Plan, results: Results) -> None:
    of_case, of_surfaces = plan.repetitions
    for name, solver in {"direct": DIRECT, "moments": MOMENTS}.items():
        replica = results.case_ii[name] = measure_replica(program, 1000, solver, plan.case_ii[name], of_case)
        what = f"case II, ensemble phase of {plan.case_ii[name][1]} replicas less that of {plan.case_ii[name][0]}, 1 thread, least of {of_case}"
        results.add("seconds per replica", f"sum = {name}", replica.seconds, "s", what)
        results.add("replicas per second and core", f"sum = {name}", 1.0 / replica.seconds, "1/s", what)
    for asperities, replicas in plan.surfaces.items():
        replica = measure_replica(program, asperities / DENSITY, MOMENTS, replicas, of_surfaces)
        results.surfaces.append(replica)
        what = f"case II of another area, {replica.sum} sums, {replicas[1]} replicas and {replicas[0]}, 1 thread, least of {of_surfaces}"
        setting = f"asperities = {replica.asperities:g}"
        results.add("seconds per asperity", setting, replica.per_asperity(), "s", f"ensemble phase, {what}")
        results.add("seconds before the replicas", setting, replica.before, "s", f"functionals of the joint test and trial of sums by moments, {what}")
        results.add("peak resident memory of a surface", setting, replica.memory, "B", what)


def measure_replica(program: Shards, area: float, solver: str, replicas: tuple[int, int], repetitions: int) -> Replica:
    """The difference of runs of few and of many replicas, in turns."""
    few, many = ({"area": area, "count": 181, "replicas": count} for count in replicas)
    least = [math.inf, math.inf]
    for _ in range(repetitions):
        least = [min(seconds, program.seconds(scene, solver)) for seconds, scene in zip(least, (few, many))]
    # Of the run of many, whose trial is on as many replicas as any.
    before = program.phases()["test functionals"]
    asperities, refusal = program.asperities(), program.refusal()
    cost = program.cost(program.command(program.write_scene(area, 181, solver), 1, few["replicas"]))
    seconds = (least[1] - least[0]) / (replicas[1] - replicas[0])
    if seconds <= 0.0:
        # A busy machine.
        seconds = least[1] / replicas[1]
    return Replica("direct" if refusal or solver == DIRECT else "moments", asperities, seconds, before, cost.memory)


def measure_shards(program: Shards, plan: Plan, results: Results) -> None:
    patches, replicas = plan.sharded
    results.batches = batches = replicas // BATCH
    shards: list[tuple[int, int, int]] = []
    for count in plan.shards:
        files, seconds = program.shards(patches, replicas, count)
        shards += [(*batches_of(i + 1, count, batches), file.stat().st_size) for i, file in enumerate(files)]
        merged = results.over_shards[count] = program.merge(files, plan.merges)
        add_merge(results, plan, f"shards = {count}", f"{replicas} replicas, {about(patches)}", merged)
    # The last ones are those of one batch.
    results.sizes = sizes = Sizes.derived(files[0], program.result)
    results.start = statistics.median(seconds)
    results.add("core seconds of a shard", "batches = 1", results.start, "s", f"median of {len(seconds)}, {about(patches)}")
    results.add("bytes of a node", f"separations = {patches.separations}", sizes.node, "B", "8 for each number of its moments: derived")
    results.add("bytes of a replica", "in a shard", sizes.replica, "B", "8 for each number of its record: derived")
    errors = []
    for first, end, size in shards:
        curves = max(0, min(end * BATCH, CURVES) - first * BATCH)
        derived = sizes.of(nodes(first, end), (end - first) * BATCH, curves)
        errors.append(abs(derived / size - 1.0))
        results.shard_sizes.append((end - first, size, derived))
    for count in dict.fromkeys(count for count, _, _ in results.shard_sizes):
        of_count = [(size, derived) for other, size, derived in results.shard_sizes if other == count]
        for name, values in zip(("bytes of a shard", "derived bytes of a shard"), zip(*of_count)):
            results.add(name, f"batches = {count}", statistics.mean(values), "B", f"mean of {len(values)}, {about(patches)}")
    results.add("largest error of derived bytes", f"{len(errors)} shards", max(errors), "1", "relative; a shard of one batch gave the rest")


def about(patches: Patches) -> str:
    return f"{patches.area:g} um^2 of case II at {patches.separations} separations"


def add_merge(results: Results, plan: Plan, setting: str, what: str, merged: Merged) -> None:
    what = f"{what}, 1 thread, files in the memory of the system, least of {plan.merges}"
    results.add("core seconds of a merge", setting, merged.cost.core_seconds, "s", what)
    results.add("wall seconds of a merge", setting, merged.cost.seconds, "s", what)
    results.add("peak resident memory of a merge", setting, merged.cost.memory, "B", what)
    results.add("bytes of all shards", setting, merged.shard_bytes, "B", what)
    results.add("bytes of the result", setting, merged.result_bytes, "B", what)


@dataclass
class Rates:
    """What merging takes, as straight lines through what was measured."""

    seconds: float  # of any merge
    seconds_per_shard: float
    seconds_per_node: float
    seconds_per_replica: float
    memory: float
    memory_per_shard: float
    memory_per_replica: float
    result: float  # bytes
    result_per_replica: float

    @classmethod
    def of(cls, results: Results) -> "Rates":
        shards, replicas, batches = results.over_shards, results.over_replicas, results.batches
        (few, one), (most, all_of_them) = min(shards.items()), max(shards.items())
        (fewest, small), (largest, large) = min(replicas.items()), max(replicas.items())

        def per_replica(of: str) -> float:
            value = {"seconds": lambda merged: merged.cost.core_seconds, "memory": lambda merged: merged.cost.memory,
                     "result": lambda merged: merged.result_bytes}[of]
            return max(value(large) - value(small), 0.0) / (largest - fewest)

        # Shards of more batches have more nodes. Relative errors count; a rate that would be negative is none.
        count = {n: sum(nodes(*batches_of(i, n, batches)) for i in range(1, n + 1)) for n in shards}
        seconds = np.array([merged.cost.core_seconds for merged in shards.values()])
        columns = np.array([[1.0, n, count[n]] for n in shards])
        rates, kept = np.zeros(3), [0, 1, 2]
        while kept:
            rates[kept] = np.linalg.lstsq(columns[:, kept] / seconds[:, None], np.ones(len(seconds)), rcond=None)[0]
            negative = [i for i in kept if rates[i] < 0.0]
            rates[negative] = 0.0
            kept = [i for i in kept if i not in negative]
            if not negative:
                break
        memory = max(all_of_them.cost.memory - one.cost.memory, 0.0) / (most - few)
        own = batches * BATCH
        return cls(*rates.tolist(), per_replica("seconds"), one.cost.memory - own * per_replica("memory"), memory, per_replica("memory"),
                   one.result_bytes - own * per_replica("result"), per_replica("result"))


def extrapolation(results: Results) -> str:
    """What larger experiments would cost, as a table in Markdown with its sources."""
    rates, sizes = Rates.of(results), results.sizes
    lines = [f"Of nodes of {NODE_CORES} such cores, in at most {SHARDS} shards:", "",
             "| experiment | core-hours | node-hours | bytes of all shards | bytes of the result | merge | memory of the merge |",
             "|---|---|---|---|---|---|---|"]
    longest = []
    for asperities in (1e6, 1e9, 1e12):
        # From the nearest surface that was measured.
        replica = min(results.surfaces, key=lambda replica: abs(math.log(replica.asperities / asperities)))
        seconds, source = asperities * replica.per_asperity(), "b" if replica == results.surfaces[0] else "c"
        for replicas in (1, 1000):
            name = f"{number(replicas)} × {number(asperities)} asperities"
            lines.append(experiment(results, rates, name, replicas, seconds, replica.before, source))
        if asperities > CHUNK:
            longest.append(f"{duration(BATCH * seconds / NODE_CORES)} of {number(asperities)} asperities")
    for name, replica in results.case_ii.items():
        lines.append(experiment(results, rates, f"{number(1e8)} × case II, {name}", 10**8, replica.seconds, replica.before, "a"))
    sources = [
        f"a: {' and '.join(f'{1e3 * replica.seconds:.3g} ms {name}' for name, replica in results.case_ii.items())} for each replica, "
        f"and for each shard d and {' and '.join(f'{replica.before:.2g} s' for replica in results.case_ii.values())}.",
        *(f"{letter}: {1e9 * replica.per_asperity():.3g} ns for each asperity of a replica of {number(replica.asperities)}, {replica.sum} at 181 "
          f"separations, and for each shard d and {replica.before:.2g} s, which is mostly the trial of sums by moments."
          for letter, replica in zip("bc", results.surfaces)),
        f"d: {results.start:.2g} core seconds of a shard of one batch of hardly any asperities.",
        f"e: derived: {bytes_of(sizes.node)} for each node of the tree, at most two of a level, {sizes.replica:.0f} B for each replica, and "
        f"{bytes_of(sizes.of(1, BATCH) - sizes.node)} more for each shard; {bytes_of(sizes.curve)} for each of the first {CURVES} replicas.",
        f"f: {bytes_of(rates.result)} and {rates.result_per_replica:.0f} B for each replica, from merges of up to {number(max(results.over_replicas))} replicas.",
        f"g: {rates.seconds:.2g} s, {1e3 * rates.seconds_per_shard:.2g} ms for each shard, {1e3 * rates.seconds_per_node:.2g} ms for each node in it, "
        f"{1e6 * rates.seconds_per_replica:.2g} µs for each replica; files in the memory of the system, else what reading them takes too.",
        f"h: {bytes_of(rates.memory)}, {bytes_of(rates.memory_per_shard)} for each shard, {rates.memory_per_replica:.0f} B for each replica.",
    ]
    batch = f"A batch of {BATCH} replicas, the least that a shard has, takes one node {' and '.join(longest)}, all its cores at one surface."
    return "\n".join([*lines, "", *(f"* {source}" for source in sources), "", batch])


def experiment(results: Results, rates: Rates, name: str, replicas: int, seconds: float, before: float, source: str) -> str:
    """A row of the table: of replicas that take so many core seconds each, and each shard so many before them."""
    sizes, batches = results.sizes, math.ceil(replicas / BATCH)
    shards = min(batches, SHARDS)
    count = sum(nodes(*batches_of(index, shards, batches)) for index in range(1, shards + 1))
    core_hours = (replicas * seconds + shards * (before + results.start)) / 3600.0
    # Rows of states end within a row: half of one is left over on average.
    of_shards = shards * sizes.of(0, 0) + count * sizes.node + replicas * sizes.replica + min(replicas, CURVES) * sizes.curve
    merge = rates.seconds + shards * rates.seconds_per_shard + count * rates.seconds_per_node + replicas * rates.seconds_per_replica
    memory = rates.memory + shards * rates.memory_per_shard + replicas * rates.memory_per_replica
    cells = [f"{rounded(core_hours)} ({source})", f"{rounded(core_hours / NODE_CORES)} ({source})", f"{bytes_of(of_shards)} (e)",
             f"{bytes_of(rates.result + replicas * rates.result_per_replica)} (f)", f"{duration(merge)} (g)", f"{bytes_of(memory)} (h)"]
    return f"| {name} | {' | '.join(cells)} |"


def number(value: float) -> str:
    exponent = round(math.log10(value))
    return f"{value:.0f}" if value < 1e5 else "10" + str(exponent).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))


def rounded(value: float) -> str:
    """Two digits are all that an extrapolation has."""
    if value == 0.0:
        return "0"
    digits = 1 - math.floor(math.log10(abs(value)))
    value = round(value, digits)
    return f"{value:.{max(digits, 0)}f}" if value >= 1e-3 else f"{value:.1e}"


def bytes_of(value: float) -> str:
    prefix = min(max(int(math.log10(max(value, 1.0)) / 3), 0), 5)
    return f"{rounded(value / 1000.0**prefix)} {['B', 'kB', 'MB', 'GB', 'TB', 'PB'][prefix]}"


def duration(seconds: float) -> str:
    for unit, length in (("d", 86400.0), ("h", 3600.0), ("min", 60.0), ("s", 1.0)):
        if seconds >= 2.0 * length:
            return f"{rounded(seconds / length)} {unit}"
    return f"{rounded(seconds)} s"


def draw_throughput(axes: Axes, results: Results) -> None:
    replicas = [*results.case_ii.values(), *results.surfaces]
    for name, (color, marker, line) in STYLES.items():
        points = [(replica.asperities, 1.0 / replica.per_asperity()) for replica in replicas if replica.sum == name]
        axes.plot(*zip(*points), color=color, marker=marker, linestyle=line, linewidth=1.4, markersize=4.5,
                  label=f"{name}; case II: {1.0 / results.case_ii[name].seconds:.0f} replicas/s")
    axes.set(xscale="log", yscale="log", xlabel="asperities of a replica", ylabel="asperities per second",
             title="(a) Throughput of a core; $S$ = 181")
    low, high = (f(1.0 / replica.per_asperity() for replica in replicas) for f in (min, max))
    axes.set_ylim(0.5 * low, 6.0 * high)
    axes.legend(loc="upper left")


def most_nodes(batches: int) -> int:
    """Nodes of the tree that no range of so many batches has more of: two of each level, as far as they fit."""
    levels = (batches + 2).bit_length() - 2
    return 2 * levels + (batches - 2 * (2**levels - 1) >= 2**levels)


def draw_sizes(axes: Axes, plan: Plan, results: Results) -> None:
    sizes, of_shards = results.sizes, sorted(set(results.shard_sizes))
    batches = np.unique(np.geomspace(1, 100 * results.batches, 60).astype(int)).tolist()
    axes.plot(batches, [sizes.of(most_nodes(b), BATCH * b) for b in batches], color="0.6", linewidth=0.9, zorder=0,
              label="at most: two nodes of each level")
    axes.plot(batches, [sizes.replica * BATCH * b for b in batches], color="0.4", linewidth=0.9, linestyle=":", zorder=0,
              label="records of replicas alone")
    axes.plot([b for b, _, _ in of_shards], [size for _, size, _ in of_shards], color=BLUE, marker="o", linestyle="", markersize=4.5,
              label="measured")
    axes.plot([b for b, _, _ in of_shards], [derived for _, _, derived in of_shards], color="black", marker="_", linestyle="",
              markersize=9, markeredgewidth=0.9, label="derived")
    axes.set(xscale="log", yscale="log", xlabel=f"batches of {BATCH} replicas in a shard", ylabel="bytes of a shard",
             title=f"(b) Size of a shard; $S$ = {plan.sharded[0].separations}")
    low = min(size for _, size, _ in of_shards)
    axes.set_ylim(0.2 * low, 3000.0 * low)
    axes.legend(loc="upper left")


def draw_merge(axes: Axes, merged: dict[int, Merged], label: str, title: str) -> None:
    """Time on the left, memory on the right."""
    x = list(merged)
    seconds, memory = ([value(merged[n].cost) for n in x] for value in (lambda cost: cost.core_seconds, lambda cost: cost.memory / 1e6))
    axes.plot(x, seconds, color=BLUE, marker="o", linewidth=1.4, markersize=4.5, label=f"time: {seconds[-1]:.2g} s at {number(x[-1])}")
    beside = axes.twinx()
    beside.plot(x, memory, color=ORANGE, marker="s", linestyle=STYLES["moments"][2], linewidth=1.4, markersize=4.5)
    axes.plot([], [], color=ORANGE, marker="s", linestyle=STYLES["moments"][2], linewidth=1.4, markersize=4.5,
              label=f"memory: {memory[-1]:.3g} MB at {number(x[-1])}")
    axes.set(xscale="log", yscale="log", xlabel=label, title=title)
    axes.set_ylabel("core seconds of the merge", color=BLUE)
    axes.set_ylim(0.3 * min(seconds), max(30.0 * min(seconds), 10.0 * max(seconds)))
    beside.set(yscale="log", ylim=(0.3 * min(memory), max(30.0 * min(memory), 10.0 * max(memory))))
    beside.set_ylabel("peak resident memory (MB)", color=ORANGE)
    beside.spines["right"].set_visible(True)
    beside.yaxis.set_minor_formatter(NullFormatter())
    axes.legend(loc="upper left")


def draw(plan: Plan, results: Results) -> Figure:
    figure = Figure(figsize=PAGE)
    draw_throughput(panel(figure, 0, COLUMNS), results)
    draw_sizes(panel(figure, 1, COLUMNS), plan, results)
    patches, replicas = plan.sharded
    draw_merge(panel(figure, 2, COLUMNS), results.over_shards, "shards", f"(c) Merging {replicas} replicas; $S$ = {patches.separations}")
    patches, shards = plan.counted
    draw_merge(panel(figure, 3, COLUMNS), results.over_replicas, "replicas", f"(d) Merging {shards} shards; $S$ = {patches.separations}")
    figure.text(0.5, 0.015, f"case II; (b) and (c) with patches of {plan.sharded[0].area:g} µm², (d) of {plan.counted[0].area:g} µm²; "
                "one thread a process", ha="center", fontsize=8.5)
    return figure


if __name__ == "__main__":
    sys.exit(main("What an experiment that is divided over many machines costs.", (FULL, QUICK), measure, draw))
