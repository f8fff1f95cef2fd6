"""How accurate the solves of one asperity are, and how many evaluations they take, over lambda and delta: heat maps.

Asks `stiction asperity --law emd --diagnostics` for a grid of points, with and without starting tables, and computes the same
points with mpmath at 80 digits (scripts/reference_stability.py). Over lambda and the distance from the end of a branch, in
contact on retraction and before contact on approach, it draws

* the error in units of epsilon (1 + condition number), the largest of adhesion force, contact radius and external force (relative
  to contact force + adhesion force), with and without tables;
* the evaluations of the equations of a solve that starts from a table, and of one that is bracketed.

Usage:
    python scripts/stability.py [--stiction PROGRAM] [-o OUT.png] [--csv OUT.csv] [--lambdas N] [--distances N] [--dpi N]

The program is target/release/stiction unless --stiction names another. The picture goes to docs/stability.png unless -o says
otherwise. The points are printed as a table, worst case by branch and decade of distance.
Exit codes: 0 done; 1 the program failed, or a point is on another branch than the truth; 2 there is no such program, or an output
cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["matplotlib>=3.7", "mpmath>=1.3", "numpy"]
# ///

import argparse
import csv
import io
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from mpmath import mp, mpf

from reference_stability import EPSILON, emd_values, end, margin

ROOT = Path(__file__).resolve().parents[1]
BRANCHES = {"contact": "retraction", "noncontact": "approach"}
LAMBDA_RANGE = (-6.0, 6.0)  # decades
DISTANCE_RANGE = (-14.0, 6.0)
TABLES = 30.0  # largest |delta| of the starting tables; those of a scene reach as far as its heights
AMBIGUOUS = 4.0  # roundings of the inputs within which a point may be on either side of the end of a branch
ERROR_LEVELS = (0, 0.25, 0.5, 1, 1.5, 2, 3, 4, 6, 8, 10)
EVALUATION_LEVELS = (0, 1, 2, 4, 6, 8, 10, 15, 20, 30, 40, 50, 70)
COLUMNS = ["branch", "lambda", "distance", "delta", "error_tables", "error_bracketed", "evaluations_tables", "evaluations_bracketed",
           "safeguarded_tables"]


class ProgramError(Exception):
    """The program failed, or its answer is on another branch than the truth."""


def grid(branch, lambdas, distances):
    """Points (i, j, lambda, distance, delta), lambda by lambda: delta is the double next to the end of the branch -+ the distance."""
    logs = np.linspace(*LAMBDA_RANGE, lambdas)
    lams = [min(max(float(10.0**x), 1e-6), 1e6) for x in logs]
    for i, lam in enumerate(lams):
        place = end(BRANCHES[branch], mpf(lam))
        for j, x in enumerate(np.linspace(*DISTANCE_RANGE, distances)):
            delta = float(place + (1 if branch == "contact" else -1) * mpf(float(10.0**x)))
            yield i, j, lam, float(10.0**x), delta


def solve(program, points, path, tables):
    """What the program makes of the points: its rows as dictionaries."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "points.csv"
        table.write_text("lambda,delta\n" + "".join(f"{lam!r},{delta!r}\n" for _, _, lam, _, delta in points), encoding="utf-8")
        command = [str(program), "asperity", "--law", "emd", "--table", str(table), "--path", path, "--diagnostics"]
        done = subprocess.run(command + (["--tables", repr(TABLES)] if tables else []), capture_output=True, text=True)
    if done.returncode:
        raise ProgramError(f"{program} ended with {done.returncode}: {done.stderr.strip()}")
    return list(csv.DictReader(io.StringIO(done.stdout)))


def error(row, truth):
    """The largest error of a row in units of epsilon (1 + condition number)."""
    branch, (adhesion, external, radius), conditions = truth
    found = [mpf(float(row[name])) for name in ("adhesion_force", "contact_radius", "external_force")]
    sizes = (adhesion, radius, external + 2 * adhesion)
    exact = (adhesion, radius, external)
    errors = [abs(f - e) / (EPSILON * s * (1 + c)) for f, e, s, c in zip(found, exact, sizes, conditions) if s]
    return float(max(errors))


def measure(program, lambdas, distances):
    """All points as dictionaries with the names of COLUMNS; an error is NaN where delta, a double, is on the end of a branch."""
    out = []
    for branch, path in BRANCHES.items():
        points = list(grid(branch, lambdas, distances))
        answers = [solve(program, points, path, tables) for tables in (True, False)]
        for point, tabled, bracketed in zip(points, *answers):
            _, _, lam, distance, delta = point
            truth = emd_values(path, mpf(lam), mpf(delta))
            clear = margin("emd", path, mpf(lam), mpf(delta)) > AMBIGUOUS
            wrong = [row for row in (tabled, bracketed) if row["branch"] != truth[0]]
            if clear and wrong:
                raise ProgramError(f"lambda = {lam!r}, delta = {delta!r}: {wrong[0]['branch']} instead of {truth[0]}")
            errors = [error(row, truth) if clear and truth[0] == branch else float("nan") for row in (tabled, bracketed)]
            out.append(dict(zip(COLUMNS, (branch, lam, distance, delta, *errors, int(tabled["iterations"]),
                                          int(bracketed["iterations"]), int(tabled["safeguarded"])))))
    return out


def print_table(points):
    """The worst of every branch and range of distance."""
    print("| branch | distance from its end | points | error, tables | error, bracketed | evaluations, tables | bracketed | safeguarded |")
    print("|---|---|---|---|---|---|---|---|")
    edges = [1e-15, 1e-10, 1e-6, 1e-3, 1e-1, 1e1, 1e3, 2e6]
    for branch in BRANCHES:
        for low, high in zip(edges, edges[1:]):
            here = [p for p in points if p["branch"] == branch and low <= p["distance"] < high]
            if not here:
                continue
            # Of points on the end of a branch nothing is said; all may be that.
            errors = [f"{np.nanmax([p[name] for p in here] + [0.0]):.2f}" for name in COLUMNS[4:6]]
            most = [max(p[name] for p in here) for name in COLUMNS[6:8]]
            share = np.mean([p["safeguarded_tables"] for p in here])
            print(f"| {branch} | {low:.0e} to {high:.0e} | {len(here)} | {' | '.join(errors)} | {most[0]} | {most[1]} | {share:.1%} |")


def draw(points, lambdas, distances, path, dpi):
    """Rows: contact, noncontact; columns: errors with and without tables, evaluations with and without."""
    figure = Figure(figsize=(13.5, 7.2), layout="constrained")
    axes = figure.subplots(2, 4, sharex=True, sharey=True)
    titles = ("Error, from tables", "Error, bracketed", "Evaluations, from tables", "Evaluations, bracketed")
    names = ("in contact (retraction)", "before contact (approach)")
    for row, (branch, name) in enumerate(zip(BRANCHES, names)):
        own = [p for p in points if p["branch"] == branch]
        for column, (title, quantity) in enumerate(zip(titles, COLUMNS[4:8])):
            levels, colours = (ERROR_LEVELS, "viridis") if column < 2 else (EVALUATION_LEVELS, "cividis")
            values = np.array([p[quantity] for p in own], dtype=float).reshape(lambdas, distances)
            ax = axes[row, column]
            ax.set_facecolor("0.85")
            image = ax.imshow(values, origin="lower", aspect="auto", interpolation="nearest", cmap=colours,
                              norm=BoundaryNorm(levels, 256, extend="max"), extent=(*DISTANCE_RANGE, *LAMBDA_RANGE))
            ax.set_title(f"{title}\n{name}", fontsize=9, loc="left")
            ax.tick_params(labelsize=8)
            if column == 0:
                ax.set_ylabel(r"$\log_{10}\lambda$")
            if row == 1:
                ax.set_xlabel(r"$\log_{10}$ distance of $\Delta$ from the branch's end", fontsize=9)
            if column in (1, 3):
                label = r"$\varepsilon\,(1+\mathrm{cond})$" if column == 1 else "evaluations"
                bar = figure.colorbar(image, ax=axes[row, column - 1 : column + 1], pad=0.01, aspect=30)
                bar.set_label(label, fontsize=9)
                bar.set_ticks(levels, labels=[f"{level:g}" for level in levels])
                bar.ax.tick_params(labelsize=8)
    figure.savefig(path, dpi=dpi)


def write_csv(points, path):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(points)


def parse():
    parser = argparse.ArgumentParser(description="Error and evaluations of one asperity's solves over lambda and delta.")
    parser.add_argument("--stiction", type=Path, default=ROOT / "target" / "release" / "stiction", metavar="PROGRAM")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs" / "stability.png", metavar="OUT.png")
    parser.add_argument("--csv", type=Path, metavar="OUT.csv", help="also write the points")
    parser.add_argument("--lambdas", type=int, default=61, metavar="N", help="values of lambda")
    parser.add_argument("--distances", type=int, default=61, metavar="N", help="distances from the end of a branch")
    parser.add_argument("--dpi", type=int, default=110)
    arguments = parser.parse_args()
    if not arguments.stiction.is_file():
        parser.error(f"no program {arguments.stiction}: run `cargo build --release` or give --stiction")
    for path in filter(None, (arguments.output, arguments.csv)):
        if not path.resolve().parent.is_dir():
            parser.error(f"{path}: no such folder")
    if min(arguments.lambdas, arguments.distances) < 2:
        parser.error("at least 2 values of lambda and 2 distances are needed")
    return arguments


def main():
    arguments = parse()
    try:
        points = measure(arguments.stiction.resolve(), arguments.lambdas, arguments.distances)
    except (ProgramError, OSError) as problem:
        sys.exit(f"stability.py: {problem}")
    print_table(points)
    try:
        if arguments.csv:
            write_csv(points, arguments.csv)
        draw(points, arguments.lambdas, arguments.distances, arguments.output, arguments.dpi)
    except OSError as problem:
        print(f"stability.py: {problem}", file=sys.stderr)
        sys.exit(2)
    print(arguments.output)


if __name__ == "__main__":
    main()
