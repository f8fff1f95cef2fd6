"""What shards and merges cost is measured and derived right, and extrapolated by the rates that are given.

The program is $STICTION, by default target/release/stiction.
"""

import sys

import pytest
from test_scaling import ROOT, quick

sys.path.insert(0, str(ROOT / "scripts"))
from measurement import Cost  # noqa: E402
from shard_costs import Merged, Replica, Results, Sizes, extrapolation, most_nodes, nodes  # noqa: E402

# Largest error of the derived bytes of a shard: counts take from one byte to several. A node more or less would be 20 %, a number of a
# record 1.2 % where there are most.
SHARE = 0.01


def test_quick_measurements_leave_a_table_a_picture_and_an_extrapolation(tmp_path):
    rows, printed = quick("shard_costs", tmp_path)
    of_merges = {"core seconds of a merge", "wall seconds of a merge", "peak resident memory of a merge", "bytes of all shards",
                 "bytes of the result"}
    assert {row["quantity"] for row in rows} == {
        *of_merges, "seconds per replica", "replicas per second and core", "seconds per asperity", "seconds before the replicas",
        "peak resident memory of a surface", "core seconds of a shard", "bytes of a node", "bytes of a replica", "bytes of a shard",
        "derived bytes of a shard", "largest error of derived bytes",
    }
    # Durations are not judged, on a machine that may be busy.
    assert all(row["what"] and float(row["value"]) >= 0.0 for row in rows)
    found = {(row["quantity"], row["setting"]): float(row["value"]) for row in rows}
    settings = [f"shards = {n}" for n in (1, 3, 10, 20)] + [f"replicas = {n}" for n in (1000, 4000, 16_000)]
    assert {setting for quantity, setting in found if quantity in of_merges} == set(settings)
    # 160 replicas, whatever the shards: of the same scene the result is equally large.
    assert len({found["bytes of the result", setting] for setting in settings[:4]}) == 1
    # Six scalars of 8 bytes and an index.
    per_replica = (found["bytes of the result", settings[-1]] - found["bytes of the result", settings[-2]]) / 12_000
    assert per_replica == pytest.approx(7 * 8, rel=0.01)
    assert all(2e6 < found["peak resident memory of a merge", setting] < 2e8 for setting in settings)
    derived = {setting: value for (quantity, setting), value in found.items() if quantity == "derived bytes of a shard"}
    assert set(derived) == {f"batches = {n}" for n in (1, 2, 6, 7, 20)}
    for setting, value in derived.items():
        assert value == pytest.approx(found["bytes of a shard", setting], rel=SHARE), setting
    assert found["largest error of derived bytes", "34 shards"] < SHARE
    lines = printed.splitlines()
    assert sum(line.startswith("| 1") for line in lines) == 8 and "nan" not in printed and "inf" not in printed


def test_a_range_of_batches_has_the_largest_nodes_that_it_covers():
    def covered(first: int, end: int) -> int:
        within = [(start, start + 2**level) for level in range(8) for start in range(0, 128, 2**level) if first <= start < start + 2**level <= end]
        return sum(not any(a <= start and stop <= b and (a, b) != (start, stop) for a, b in within) for start, stop in within)

    for first in range(0, 40):
        for end in range(first, 70):
            assert nodes(first, end) == covered(first, end)
            assert end == first or nodes(first, end) <= most_nodes(end - first)
    # From the second batch on, two of each level.
    assert all(nodes(1, 2**level - 1) == most_nodes(2**level - 2) == 2 * (level - 1) for level in range(2, 40))


def made_up() -> Results:
    """Round figures: 1 ms a replica of case II, 36 ns and 18 ns an asperity, merges of 1 s and 10 ms a shard, 1 µs a replica."""
    results = Results(sizes=Sizes(fixed=1000.0, node=40_960.0, replica=64.0), batches=1000, start=0.0)
    results.case_ii = {name: Replica(name, 7390.0, seconds, 0.0, 1e7) for name, seconds in (("direct", 3.6e-3), ("moments", 3.6e-4))}
    results.surfaces = [Replica("moments", 1e6, 0.036, 0.0, 1e7), Replica("moments", 1e7, 0.18, 0.0, 1e7)]
    results.over_shards = {n: Merged(Cost(2e7 + 1e4 * n, 9.0, 1.0 + 0.01 * n), 1, 200_000 + 8000 * 56) for n in (1, 10, 100, 1000)}
    results.over_replicas = {n: Merged(Cost(1e7 + 100.0 * n, 9.0, 1.0 + 1e-6 * n), 1, 100_000 + 56 * n) for n in (1000, 10**6)}
    return results


def test_an_extrapolation_is_what_its_rates_give():
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in extrapolation(made_up()).splitlines() if line.startswith("| 1")]
    found = {name: cells for name, *cells in rows}
    assert len(found) == 8
    # 1000 surfaces of 10^12 at 18 ns are 1.8e16 ns; 125 shards of one batch: a node and 1000 bytes each, and the records.
    assert found["1000 × 10¹² asperities"][:3] == ["5000 (c)", "78 (c)", "5.3 MB (e)"]
    # 1 s, 125 times 10 ms, 1000 times 1 µs.
    assert found["1000 × 10¹² asperities"][4] == "2.3 s (g)"
    assert found["1 × 10⁶ asperities"][:2] == ["1.0e-05 (b)", "1.6e-07 (b)"]
    # 10^8 replicas of 3.6 ms; 1000 shards, 1 s + 10 s + 100 s, 100 B of memory and 56 B of the result for each replica.
    assert found["10⁸ × case II, direct"][:2] == ["100 (a)", "1.6 (a)"]
    assert found["10⁸ × case II, moments"][0] == "10 (a)"
    assert found["10⁸ × case II, direct"][3:] == ["5.6 GB (f)", "110 s (g)", "10 GB (h)"]
