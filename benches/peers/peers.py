"""The solve of one asperity by SciPy, NumPy and the package Adhesion: time and error.

The work is that of src/asperity/emd.rs: adhesion force and external force of the extended Maugis-Dugdale law at given
adhesion parameter lambda and scaled approach delta, in contact (Maugis 1992) and before it (Shi and Polycarpou 2005).
All but Adhesion solve the same equations in the same parameters, the angle theta = arccos(a/c) and the gap
epsilon = h_0/Z_0 - 1, in forms in which nothing cancels: what differs is the solver, not the formulas.

    SciPy brentq            one call per asperity, at several tolerances
    SciPy find_root         scipy.optimize.elementwise.find_root (Chandrupatla) over whole arrays, at several tolerances
    NumPy Newton            whole arrays, closed-form start, clipped steps, several numbers of iterations
    NumPy Newton, table     the same from a start that is interpolated between points of the curve
    Adhesion                PyPI package, contact only, at its own tolerance: force at a radius, and at an approach

Time: the least of several repetitions over rising approaches, contact from first touch to 10, before contact from -30 to
just before first touch. What depends on lambda alone (folds, first touch, table) is made before and not timed, as in
benches/solve.rs. Error: the largest over the rows of tests/data/single_asperity.csv on the branch, all lambdas, of the
adhesion force relative to itself and of the external force relative to the sum of load and adhesion force.

Usage:
    python benches/peers/peers.py [-o FILE.csv] [--stiction PROGRAM]

Writes CSV with the header panel,method,setting,seconds,error,what; scripts/work_precision.py draws it.
Exit codes: 0 done; 1 PROGRAM failed; 2 a package or file is missing, or the output cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "scipy>=1.10"]
# ///
# Adhesion is installed without what it depends on (pip install --no-deps Adhesion==0.93) and left out where it is absent.

import argparse
import csv
import importlib.metadata
import math
import platform
import runpy
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

try:
    import numpy as np
    import scipy
    from scipy.optimize import brentq
except ImportError as error:
    print(f"peers: {error}; pip install -r benches/peers/requirements.txt", file=sys.stderr)
    sys.exit(2)
try:
    from scipy.optimize.elementwise import find_root
except ImportError:
    find_root = None  # SciPy before 1.15

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "tests" / "data" / "single_asperity.csv"
HEADER = ["panel", "method", "setting", "seconds", "error", "what"]
EPSILON = float(np.finfo(float).eps)
TINY = 1e-300  # keeps a division by zero out where nothing is left to correct
STRESS_RATIO = 1.03  # sigma_0 Z_0 over the work of adhesion
LAMBDAS = (0.9, 0.1)  # timed: the first is the one of case II
DEEPEST, FURTHEST = 10.0, -30.0  # approaches that are timed
REPETITIONS, MOST_SECONDS = 9, 1.0  # of one run, so that the whole takes less than a minute
ONE, MANY = 400, 4096  # asperities per run: one call each; whole arrays, small enough for the caches

# (sin t cos t - t cos 2t)/t^3 and (t sin t + cos t - 1)/t^2 as power series in t^2, which do not cancel as the closed forms do.
QUADRATIC = [4.0 * (-4.0) ** n * (2 * n + 2) / math.factorial(2 * n + 3) for n in range(16)]
LINEAR = [(-1.0) ** n * (2 * n + 1) / math.factorial(2 * n + 2) for n in range(13)]
SERIES_BELOW, SERIES_TERMS = 0.4, 8  # for single angles the closed forms are faster above


class PeerError(Exception):
    """Why nothing can be measured."""


def horner(coefficients: list[float], x):
    value = coefficients[-1] * x + coefficients[-2]
    for coefficient in coefficients[-3::-1]:
        value *= x
        value += coefficient
    return value


class Contact:
    """Delta(theta), which falls from infinity at 0 to the end of the stable branch."""

    name = "contact"

    def __init__(self, lam: float) -> None:
        self.lam, self.k = lam, 4.0 / 3.0 * lam
        self.first_touch = self.approach(0.5 * math.pi)
        self.end = 0.5 * math.pi
        # The slope over cos theta, which vanishes at first touch for every lambda, changes sign at the fold, if there is one.
        if self.slopes(np.float64(self.end))[1] > 0.0:
            self.end = brentq(lambda angle: float(self.slopes(np.float64(angle))[1]), 1e-3 / (1.0 + lam), self.end, xtol=1e-15)
        self.lowest = self.approach(self.end)

    def outer(self, angle, sin, quadratic, linear, sqrt):
        """Radius of the adhesive zone, and the root that its derivative needs."""
        g, kq = self.lam * angle, self.k * linear
        root = sqrt(g * (kq * kq * g + 2.0 * quadratic))
        return 2.0 / (angle * (kq * g + root)), root

    def single(self, angle: float) -> tuple[float, float, float]:
        """Adhesive radius, sin and cos of one angle."""
        sin, cos, square = math.sin(angle), math.cos(angle), angle * angle
        if angle < SERIES_BELOW:
            quadratic, linear = horner(QUADRATIC[:SERIES_TERMS], square), horner(LINEAR[:SERIES_TERMS], square)
        else:
            quadratic = (sin * cos - angle * (cos * cos - sin * sin)) / (angle * square)
            linear = (angle * sin + cos - 1.0) / square
        return self.outer(angle, sin, quadratic, linear, math.sqrt)[0], sin, cos

    def approach(self, angle: float) -> float:
        outer, sin, cos = self.single(angle)
        radius = outer * cos
        return radius * radius - self.k * outer * sin

    def many(self, angles: np.ndarray):
        square = angles * angles
        sin, cos = np.sin(angles), np.cos(angles)
        return *self.outer(angles, sin, horner(QUADRATIC, square), horner(LINEAR, square), np.sqrt), sin, cos

    def approaches(self, angles: np.ndarray) -> np.ndarray:
        outer, _, sin, cos = self.many(angles)
        radius = outer * cos
        return radius * radius - self.k * outer * sin

    def slopes(self, angles: np.ndarray):
        """Delta, its slope over cos theta, and cos theta."""
        outer, root, sin, cos = self.many(angles)
        shrink = outer * self.lam * (2.0 * outer * sin + self.k) / root
        radius = outer * cos
        radius_slope = -(cos * cos * shrink + outer * sin)
        return radius * radius - self.k * outer * sin, 2.0 * outer * radius_slope + self.k * (shrink * sin - outer), cos

    def forces(self, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Adhesion force and external force."""
        outer, _, sin, cos = self.many(angles)
        adhesion = self.lam * outer * outer * (sin * cos + angles)
        return adhesion, (outer * cos) ** 3 - adhesion

    def force(self, angle: float) -> tuple[float, float]:
        outer, sin, cos = self.single(angle)
        adhesion = self.lam * outer * outer * (sin * cos + angle)
        return adhesion, (outer * cos) ** 3 - adhesion

    def bracket(self, delta: float) -> tuple[float, float]:
        low = self.end
        while self.approach(low) < delta:
            low *= 0.25
        return low, self.end

    def brackets(self, deltas: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.full_like(deltas, self.bracket(deltas.max())[0]), np.full_like(deltas, self.end)

    def parts(self, deltas: np.ndarray):
        """One monotone branch."""
        return [(self, slice(None))]

    def start(self, deltas: np.ndarray) -> np.ndarray:
        """Limits of small angles, with the contact radius taken from the distance to the end of the branch, and the end itself."""
        radius = np.sqrt(np.maximum(deltas - self.lowest, 0.0))
        inverse = np.cbrt(2.0 / 3.0 * self.lam * radius * radius + (2.0 / 3.0 * self.lam * self.lam * radius) ** 1.5)
        return 1.0 / (1.0 / self.end + inverse)

    def table(self, lowest: float, highest: float, nodes: int) -> tuple[np.ndarray, np.ndarray]:
        """Angles over the distance to the end of the branch, in which they are smooth."""
        highest *= 1.1
        low = brentq(lambda angle: self.approach(angle) - highest, *self.bracket(highest))
        angles = 1.0 / np.linspace(1.0 / self.end, 1.0 / low, nodes)
        places = np.sqrt(np.maximum(self.approaches(angles) - self.lowest, 0.0))
        places[0] = 0.0
        return places, angles

    def interpolated(self, deltas: np.ndarray, table: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        return np.interp(np.sqrt(np.maximum(deltas - self.lowest, 0.0)), *table)

    def newton(self, deltas: np.ndarray, angles: np.ndarray, iterations: int) -> np.ndarray:
        """Newton for sqrt(Delta - end) in 1/theta, which is nearly straight at both ends of the branch."""
        wanted = np.sqrt(np.maximum(deltas - self.lowest, 0.0))
        for _ in range(iterations):
            delta, reduced, cos = self.slopes(angles)
            place = np.sqrt(np.maximum(delta - self.lowest, 0.0))
            slope = np.minimum(cos * reduced, -TINY)
            step = (deltas - delta) / slope * (2.0 * place / (place + wanted + TINY))
            angles = np.clip(angles / np.clip(1.0 - step / angles, 0.25, 4.0), 0.0, self.end)
        return angles


class Noncontact:
    """-Delta(epsilon) on one of its monotone branches: the outermost one, or the one next to contact inside the fold."""

    B, PEAK = 4.0 * (math.pi - 2.0) / (3.0 * math.pi), 8.0 / (3.0 * STRESS_RATIO)

    def __init__(self, lam: float, low: float, high: float) -> None:
        self.lam, self.low, self.high = lam, low, high
        self.spacing = 2.0 * STRESS_RATIO / (math.pi * lam)
        self.least = self.distance(low, math.sqrt) if low > 0.0 else 0.0
        self.rise = 4.0 / 3.0 * math.sqrt(16.0 * lam / STRESS_RATIO * 4.0 / math.pi)  # of -Delta with sqrt(epsilon), at 0

    def terms(self, gaps, sqrt):
        u = 1.0 / (1.0 + gaps)
        v = u * u
        v3 = v * v * v
        rest = gaps * (2.0 + gaps) * v  # 1 - z^-2, without cancellation
        sixth = rest * (1.0 + v + v * v)  # 1 - z^-6
        stress = self.lam * self.PEAK * u * v * sixth
        work = 4.0 / (3.0 * math.pi) * v * (4.0 - v3)
        root = sqrt(stress)
        g = self.B * stress * root
        total = sqrt(g * g + work)
        return u, v, v3, sixth, stress, root, total, work / (g + total)

    def distance(self, gaps, sqrt=np.sqrt):
        *_, root, _, y = self.terms(gaps, sqrt)
        return self.spacing * gaps + 4.0 / 3.0 * root * y

    def slopes(self, gaps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """-Delta and its slope times sqrt(stress), which stays finite where the gap closes; and sqrt(stress)."""
        u, v, v3, sixth, stress, root, total, y = self.terms(gaps, np.sqrt)
        stress_slope = self.lam * self.PEAK * v * v * (9.0 * v3 - 3.0)
        work_slope = -32.0 / (3.0 * math.pi) * u * v * sixth
        y_slope = (0.5 * work_slope - 1.5 * self.B * root * stress_slope * y) / total
        pull = 4.0 / 3.0 * root * y
        return self.spacing * gaps + pull, self.spacing * root + 4.0 / 3.0 * (stress * y_slope + 0.5 * stress_slope * y), root

    def forces(self, gaps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        adhesion = 0.5 * math.pi * self.terms(gaps, np.sqrt)[-1] ** 2
        return adhesion, -adhesion

    def force(self, gap: float) -> tuple[float, float]:
        adhesion = 0.5 * math.pi * self.terms(gap, math.sqrt)[-1] ** 2
        return adhesion, -adhesion

    def approach(self, gap: float) -> float:
        return -self.distance(gap, math.sqrt)

    def approaches(self, gaps: np.ndarray) -> np.ndarray:
        return -self.distance(gaps)

    def bracket(self, delta: float) -> tuple[float, float]:
        return self.low, min(self.high, -delta / self.spacing * (1.0 + 4.0 * EPSILON))

    def brackets(self, deltas: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.full_like(deltas, self.low), np.minimum(self.high, -deltas / self.spacing * (1.0 + 4.0 * EPSILON))

    def start(self, deltas: np.ndarray) -> np.ndarray:
        """Outside a fold the gap without deformation; else the limit of small gaps, whose stress grows like the gap."""
        if self.low > 0.0:
            return np.maximum(-deltas / self.spacing, self.low)
        root = -2.0 * deltas / (self.rise + np.sqrt(self.rise**2 - 4.0 * self.spacing * deltas))
        return np.minimum(root * root, self.high)

    def place(self, deltas: np.ndarray) -> np.ndarray:
        """What the gap is a smooth function of."""
        return np.sqrt(np.maximum(-deltas - self.least, 0.0)) if self.low > 0.0 else -deltas

    def table(self, lowest: float, highest: float, nodes: int) -> tuple[np.ndarray, np.ndarray]:
        high = brentq(lambda gap: self.approach(gap) - lowest, *self.bracket(lowest))
        if self.low > 0.0:
            gaps = self.low + np.concatenate([[0.0], np.geomspace(1e-4 * self.low, high - self.low, nodes - 1)])
        else:
            low = brentq(lambda gap: self.approach(gap) - 0.9 * highest, *self.bracket(0.9 * highest))
            gaps = np.geomspace(low, high, nodes)
        return self.place(self.approaches(gaps)), gaps

    def interpolated(self, deltas: np.ndarray, table: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        return np.interp(self.place(deltas), *table)

    def newton(self, deltas: np.ndarray, gaps: np.ndarray, iterations: int) -> np.ndarray:
        """Newton in epsilon for sqrt(-Delta - fold) outside a fold, else in sqrt(epsilon) for -Delta."""
        folded, top = self.low > 0.0, self.brackets(deltas)[1]
        wanted = self.place(deltas) if folded else None
        for _ in range(iterations):
            distance, slope, root = self.slopes(gaps)
            step = -(distance + deltas) / np.maximum(slope, TINY) * root
            if folded:
                place = self.place(-distance)
                least = self.low + 0.1 * (gaps - self.low)  # at the fold itself a step would be 0/0
                gaps = np.clip(gaps + step * (2.0 * place / (place + wanted + TINY)), least, top)
            else:
                change = np.clip(0.5 * step / gaps, -0.75, 3.0)
                gaps = np.minimum(gaps * (1.0 + change) ** 2, top)
        return gaps


class Before:
    """The curve before contact: its branch or branches."""

    name = "before contact"
    OUTSIDE_FOLD = 0.4  # outside the outer fold for every lambda

    def __init__(self, lam: float) -> None:
        whole = Noncontact(lam, 0.0, math.inf)
        gaps = np.geomspace(1e-9 / (1e-3 + lam), self.OUTSIDE_FOLD, 4000)
        falling = np.flatnonzero(whole.slopes(gaps)[1] < 0.0)
        self.fold, self.outer, self.inner = -math.inf, whole, whole
        if falling.size:
            at = falling[-1]
            fold = brentq(lambda gap: float(whole.slopes(np.float64(gap))[1]), gaps[at], gaps[min(at + 1, gaps.size - 1)], xtol=1e-16)
            self.outer, self.inner = Noncontact(lam, fold, math.inf), Noncontact(lam, 0.0, fold)
            self.fold = -self.outer.least

    def parts(self, deltas: np.ndarray):
        if not math.isfinite(self.fold):
            return [(self.outer, slice(None))]
        # The approaches rise, so that two slices do, as in the Rust solver; the rows of the reference do, too.
        first = int(np.searchsorted(deltas, self.fold, side="right"))
        parts = [(self.outer, slice(0, first)), (self.inner, slice(first, None))]
        return [(part, which) for part, which in parts if deltas[which].size]


# A method: from the rising approaches and the law of one lambda to the adhesion and external forces.
Solver = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def by_parts(law, deltas: np.ndarray, solve: Callable) -> tuple[np.ndarray, np.ndarray]:
    adhesion, external = np.empty_like(deltas), np.empty_like(deltas)
    for index, (part, which) in enumerate(law.parts(deltas)):
        adhesion[which], external[which] = solve(index, part, deltas[which])
    return adhesion, external


def with_brentq(xtol: float, rtol: float) -> Callable:
    def prepare(law, deltas: np.ndarray) -> Solver:
        def one(part, delta: float) -> tuple[float, float]:
            try:
                root = brentq(lambda x: part.approach(x) - delta, *part.bracket(delta), xtol=xtol, rtol=rtol)
                return part.force(root)
            except (ValueError, RuntimeError):
                return math.nan, math.nan

        def solve(_, part, deltas):
            return np.array([one(part, delta) for delta in deltas.tolist()]).T

        return lambda deltas: by_parts(law, deltas, solve)

    return prepare


def with_find_root(tolerance: float) -> Callable:
    tolerances = {"xatol": 0.0, "xrtol": tolerance, "fatol": 0.0, "frtol": 0.0}

    def prepare(law, deltas: np.ndarray) -> Solver:
        def solve(_, part, deltas):
            found = find_root(lambda x, d: part.approaches(x) - d, part.brackets(deltas), args=(deltas,), tolerances=tolerances)
            return part.forces(np.where(found.success, found.x, np.nan))

        return lambda deltas: by_parts(law, deltas, solve)

    return prepare


def with_newton(iterations: int, nodes: int | None) -> Callable:
    def prepare(law, deltas: np.ndarray) -> Solver:
        tables = []
        if nodes:
            for part, which in law.parts(deltas):
                tables.append(part.table(float(deltas[which][0]), float(deltas[which][-1]), nodes))

        def solve(index, part, deltas):
            start = part.interpolated(deltas, tables[index]) if tables else part.start(deltas)
            return part.forces(part.newton(deltas, start, iterations))

        return lambda deltas: by_parts(law, deltas, solve)

    return prepare


class Package:
    """PyPI Adhesion, which gives load and approach at a contact radius."""

    def __init__(self) -> None:
        self.version = importlib.metadata.version("Adhesion")
        # Run as a file: importing it as part of the package would import all that the package depends on.
        module = importlib.metadata.distribution("Adhesion").locate_file("Adhesion/ReferenceSolutions/MaugisDugdale.py")
        self.load_and_displacement = runpy.run_path(str(module))["load_and_displacement"]

    def at_radius(self, lam: float, radius):
        """Scaled load and approach: with R = 1, E_r = 3/4 and a work of adhesion of 1/pi every unit is 1, and sigma_0 is lambda/2."""
        return self.load_and_displacement(radius, 1.0, 0.75, 1.0 / math.pi, 0.5 * lam)

    def forces_at_radii(self, law: Contact, radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        external = np.array([self.guarded(lambda radius=radius: self.at_radius(law.lam, radius)[0]) for radius in radii.tolist()])
        return radii**3 - external, external

    def prepare(self, law: Contact, _) -> Solver:
        """The approach is met by brentq in the radius, at the tolerances that the package uses within."""
        outer, _, cos = law.single(law.end)
        least = max(outer * cos, 1e-9)

        def one(delta: float) -> float:
            most = 2.0 + 1.5 * math.sqrt(max(delta, 0.0))
            return brentq(lambda radius: float(self.at_radius(law.lam, radius)[1]) - delta, least, most)

        def solve(deltas: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            radii = np.array([self.guarded(lambda delta=delta: one(delta)) for delta in deltas.tolist()])
            return self.forces_at_radii(law, radii)

        return solve

    @staticmethod
    def guarded(solve: Callable[[], float]) -> float:
        try:
            return float(solve())
        except (ValueError, RuntimeError):  # no change of sign, or no convergence
            return math.nan


class Rows:
    """The reference values of one branch and one lambda."""

    def __init__(self, rows: list[dict]) -> None:
        def column(name: str) -> np.ndarray:
            return np.array([float(row[name]) for row in rows])

        self.deltas, self.radii = column("delta"), column("contact_radius")
        self.adhesion, self.external = column("adhesion_force"), column("external_force")
        self.conditions = column("adhesion_condition"), column("external_condition")

    def errors(self, forces: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Per row: the larger relative error of the two forces, and the larger one in units of epsilon (1 + condition number)."""
        adhesion = np.abs(forces[0] - self.adhesion) / self.adhesion
        # The external force crosses zero; load plus adhesion force, the sum of magnitudes that it is made of, does not.
        external = np.abs(forces[1] - self.external) / (self.external + 2.0 * self.adhesion)
        units = [error / (EPSILON * (1.0 + condition)) for error, condition in zip((adhesion, external), self.conditions)]
        return np.maximum(adhesion, external), np.maximum(*units)


def read_reference() -> dict[str, dict[float, Rows]]:
    with open(REFERENCE, newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    branches: dict = {"contact": {}, "noncontact": {}}
    for row in table:
        branches[row["branch"]].setdefault(float(row["lambda"]), []).append(row)
    return {branch: {lam: Rows(rows) for lam, rows in groups.items()} for branch, groups in branches.items()}


def worst(groups: dict[float, Rows], forces: Callable[[float, Rows], tuple]) -> tuple[float, str]:
    """Largest error over all rows, and a phrase with the errors in units of epsilon (1 + condition number) and the failures."""
    pairs = [rows.errors(forces(lam, rows)) for lam, rows in groups.items()]
    errors, units = (np.concatenate(column) for column in zip(*pairs))
    failed = int(np.sum(~np.isfinite(errors)))
    text = f"worst of {errors.size} rows: {np.nanmax(units):.3g} eps (1 + cond)"
    return float(np.nanmax(errors)), text + (f"; {failed} rows failed" if failed else "")


def least_seconds(run: Callable[[], object]) -> tuple[float, int]:
    """Least of several repetitions, and their number."""
    run()
    times, begin = [], time.perf_counter()
    while len(times) < REPETITIONS and time.perf_counter() - begin < MOST_SECONDS:
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times), len(times)


def approaches(law, count: int) -> np.ndarray:
    """Rising approaches to be timed, in the middles of equal intervals."""
    first_touch = law.first_touch if isinstance(law, Contact) else Contact(law.outer.lam).first_touch
    low, high = (first_touch, DEEPEST) if isinstance(law, Contact) else (FURTHEST, first_touch)
    return low + (high - low) * (np.arange(count) + 0.5) / count


def measure(kind: type, groups: dict[float, Rows], prepare: Callable, count: int) -> tuple[float, float, str]:
    """Seconds per solve at the first lambda, worst error, and what was run."""
    error, text = worst(groups, lambda lam, rows: prepare(kind(lam), rows.deltas)(rows.deltas))
    seconds, repetitions = [], 0
    for lam in LAMBDAS:
        law = kind(lam)
        deltas = approaches(law, count)
        solver = prepare(law, deltas)
        least, repetitions = least_seconds(lambda: solver(deltas))
        seconds.append(least / count)
    here, _ = worst({LAMBDAS[0]: groups[LAMBDAS[0]]}, lambda lam, rows: prepare(kind(lam), rows.deltas)(rows.deltas))
    others = ", ".join(f"{1e9 * value:.4g} ns at lambda = {lam}" for value, lam in zip(seconds[1:], LAMBDAS[1:]))
    return seconds[0], error, (f"{kind.name}: {count} rising approaches at lambda = {LAMBDAS[0]}, least of {repetitions} repetitions "
                               f"({others}); {text}; relative error at lambda = {LAMBDAS[0]} alone: {here:.2g}")


def solvers(iterations: range) -> list[tuple[str, str, Callable, int]]:
    """Method, setting, what makes its solver, and how many asperities one run takes."""
    found = [("SciPy brentq", f"xtol = rtol = {tol:.0e}", with_brentq(tol, tol), ONE) for tol in (1e-3, 1e-5, 1e-7, 1e-9, 1e-12)]
    found += [("SciPy brentq", "default tolerances", with_brentq(2e-12, 4.0 * EPSILON), ONE),
              ("SciPy brentq", "rtol = 4 eps", with_brentq(1e-300, 4.0 * EPSILON), ONE)]
    if find_root:
        found += [("SciPy find_root", f"xrtol = {tol:.0e}", with_find_root(tol), MANY) for tol in (1e-2, 1e-4, 1e-6, 1e-9, 1e-12, 1e-15)]
    found += [("NumPy Newton", f"{k} iteration{'s' if k > 1 else ''}", with_newton(k, None), MANY) for k in iterations]
    found += [("NumPy Newton, table", f"{k} iteration{'s' if k > 1 else ''}, 256 nodes", with_newton(k, 256), MANY) for k in (1, 2, 3, 4)]
    return found


def with_package(package: Package, groups: dict[float, Rows]) -> list[tuple[str, float, float, str]]:
    """Settings of the package: in its own direction, and at a given approach."""
    count, lam = ONE // 4, LAMBDAS[0]
    law = Contact(lam)
    solve, deltas = package.prepare(law, None), approaches(law, count)
    load = solve(deltas)
    radii = np.cbrt(load[0] + load[1])
    forces = {"at a radius": (lambda: package.forces_at_radii(law, radii),
                              lambda lam, rows: package.forces_at_radii(Contact(lam), rows.radii)),
              "at an approach": (lambda: solve(deltas),
                                 lambda lam, rows: package.prepare(Contact(lam), None)(rows.deltas))}
    found = []
    for setting, (timed, checked) in forces.items():
        seconds, repetitions = least_seconds(timed)
        error, text = worst(groups, checked)
        found.append((setting, seconds / count, error, f"contact: {count} forces {setting} at lambda = {lam}, one call each, "
                      f"least of {repetitions} repetitions; {text}; Adhesion {package.version}"))
    return found


def with_stiction(program: Path, branches: dict) -> tuple[float, float, str]:
    """The error of the program over all rows, and the time of its whole ensemble phase over the solves in it."""
    try:
        import h5py
    except ImportError as error:
        raise PeerError(f"{error}: --stiction needs h5py") from error

    def run(*arguments: object) -> str:
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, encoding="utf-8")
        if done.returncode:
            raise RuntimeError(f"{program}: {done.stderr.strip()}")
        return done.stdout

    errors, units = [], []
    with tempfile.TemporaryDirectory() as folder:
        for branch, path in (("contact", "retraction"), ("noncontact", "approach")):
            for lam, rows in branches[branch].items():
                table = Path(folder) / "table.csv"
                table.write_text("lambda,delta\n" + "".join(f"{lam!r},{delta!r}\n" for delta in rows.deltas.tolist()), encoding="utf-8")
                found = list(csv.DictReader(run("asperity", "--law", "emd", "--path", path, "--table", table).splitlines()))
                forces = [np.array([float(row[name]) for row in found]) for name in ("adhesion_force", "external_force")]
                if any(row["branch"] != branch for row in found):
                    raise RuntimeError(f"{program}: rows of the reference are on another branch")
                error, unit = rows.errors(forces)
                errors.append(error.max())
                units.append(unit.max())
        result, times = Path(folder) / "quick.h5", []
        for _ in range(5):
            run("run", ROOT / "configs" / "quick.toml", "-o", result, "--threads", 1, "--force", "--quiet")
            with h5py.File(result, "r") as file:
                phases = [name.decode() for name in file["phase"][()]]
                solves = int(file["diagnostics/contact_solves"][()]) + int(file["diagnostics/noncontact_solves"][()])
                times.append(float(file["diagnostics/seconds"][phases.index("ensemble")]) / solves)
                version = file.attrs["program_version"]
    return min(times), float(max(errors)), (
        f"both branches: ensemble phase of configs/quick.toml on one thread over its {solves} solves, drawing, sorting and summing "
        f"included, least of 5 repetitions; worst of all rows: {max(units):.3g} eps (1 + cond); stiction {version}")


def rows_of(arguments: argparse.Namespace) -> list[list]:
    branches, table = read_reference(), []
    versions = f"Python {platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__}"

    def add(method: str, setting: str, seconds: float, error: float, what: str) -> None:
        table.append(["peers", method, setting, f"{seconds:.4g}", f"{error:.4g}", what])
        print(f"{method:36} {setting:24} {1e9 * seconds:10.4g} ns  {error:9.2e}", file=sys.stderr)

    # As many iterations as bring the hardest row down to rounding.
    for kind, branch, iterations in ((Contact, "contact", range(1, 7)), (Before, "noncontact", range(1, 11))):
        for method, setting, prepare, count in solvers(iterations):
            seconds, error, what = measure(kind, branches[branch], prepare, count)
            add(f"{method}, {kind.name}", setting, seconds, error, f"{what}; {versions}")
    try:
        package = Package()
    except importlib.metadata.PackageNotFoundError:
        print("peers: Adhesion is left out; pip install --no-deps Adhesion==0.93", file=sys.stderr)
    else:
        for setting, *rest, what in with_package(package, branches["contact"]):
            add("Adhesion, contact", setting, *rest, f"{what}; {versions}")
    if arguments.stiction:
        add("stiction", "ensemble phase", *with_stiction(arguments.stiction, branches))
    return table


def main() -> int:
    parser = argparse.ArgumentParser(description="Time and error of one solve by SciPy, NumPy and Adhesion.")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.csv", help="default: standard output")
    parser.add_argument("--stiction", type=Path, metavar="PROGRAM", help="add this program's error and time")
    arguments = parser.parse_args()
    try:
        if arguments.output and not arguments.output.resolve().parent.is_dir():
            raise PeerError(f"no such folder: {arguments.output.parent}")
        if arguments.stiction and not arguments.stiction.is_file():
            raise PeerError(f"no such program: {arguments.stiction}")
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            table = rows_of(arguments)
        with open(arguments.output, "w", newline="", encoding="utf-8") if arguments.output else sys.stdout as file:
            csv.writer(file, lineterminator="\n").writerows([HEADER, *table])
    except (PeerError, OSError, KeyError) as error:
        print("peers:", *str(error).split(), file=sys.stderr)
        return 2
    except RuntimeError as error:
        print("peers:", *str(error).split(), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
