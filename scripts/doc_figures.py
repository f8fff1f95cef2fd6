"""Figures of README and docs, computed anew and compared with the pages: those that take seconds each, a few
minutes in all.

Usage:
    python scripts/doc_figures.py [--write] [--program PATH] [PAGE...]

A figure is a piece of a page with `{}` where its numbers stand, or a block of what the program prints. Numbers
of pictures that take longer are those that their script left in them. With
--write numbers that differ are replaced in the pages. Only figures of the PAGEs named are looked at, if any
are. The program is target/release/stiction, or that of the environment variable STICTION, unless --program
says otherwise. Exit codes: 0 all agree, or were replaced; 1 some differ, or are not on their page; 2 the
program fails.
"""

import argparse
import functools
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from drawing import ROOT, digits

# A number as pages write it.
NUMBER = r"([-+−]?[0-9][0-9.]*(?:e-?[0-9]+|·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?)"
SCALARS = ["pull_off_force", "pull_off_separation", "peak_secant_stiffness",
           "peak_secant_stiffness_separation"]
CASES = ["case_i", "case_ii", "case_iii"]


class Program:
    """Runs the program in a folder of its own, each command once."""

    def __init__(self, path, folder):
        self.path, self.folder = path, folder
        # The scene of the README.
        scene = re.search(r"```toml\n(.*?)```", (ROOT / "README.md").read_text(), re.S)[1]
        (folder / "pad.toml").write_text(scene)
        # The scene of a diamond on gold, and the sum of two surfaces in the place of the map's spectrum.
        scene = re.search(r"```toml\n(title = \"A flat diamond.*?)```", (ROOT / "docs/measured.md").read_text(), re.S)[1]
        (folder / "gold.toml").write_text(scene)
        both = re.search(r"```toml\n(\[surface\]\nspectrum.*?)```", (ROOT / "docs/surfaces.md").read_text(), re.S)[1]
        of_map = (ROOT / "configs/surfaces/spectrum.toml").read_text()
        (folder / "two.toml").write_text(re.sub(r"\[surface\].*?(?=lubricant)", both, of_map, flags=re.S))

    @functools.cache
    def said(self, *arguments):
        # `stiction map` by this Python, as it need not be installed next to the program.
        command = [sys.executable, "-m", "stiction.assessment"] if arguments[0] == "map" else [self.path, arguments[0]]
        environment = {**os.environ, "STICTION": str(self.path)}
        run = subprocess.run([*command, *arguments[1:]], cwd=self.folder, capture_output=True, text=True, env=environment)
        if run.returncode:
            sys.exit(f"doc_figures.py: stiction {' '.join(arguments)}: {run.stderr.strip()}")
        return run.stdout

    @functools.cache
    def run(self, scene, sampling = "independent"):
        """The result of `stiction run configs/SCENE.toml`, with another sampling."""
        path = ROOT / "configs" / f"{scene}.toml"
        if sampling != "independent":
            text = path.read_text().replace("[ensemble]", f'[ensemble]\nsampling = "{sampling}"')
            path = self.folder / f"{scene}_{sampling}.toml"
            path.write_text(text)
        return self.file("run", path)

    @functools.cache
    def file(self, command, scene, *arguments):
        output = f"{len(list(self.folder.glob('*.h5')))}.h5"
        self.said(command, str(scene), *arguments, "-o", output)
        return h5py.File(self.folder / output)


@dataclass(frozen=True)
class Figure:
    """Numbers of a page: a text with `{}` in the place of each, and what they are now."""

    page: str
    text: str
    values: Callable[[Program], list[str]]

    def compared(self, page, program):
        """The page with the numbers as they are, and how they differ."""
        parts = [r"\s+".join(map(re.escape, re.split(r"\s+", part))) for part in self.text.split("{}")]
        found = re.findall(NUMBER.join(parts), page)
        if len(found) != 1:
            return page, [f"is there {len(found)} times: {self.text}"]
        match = re.search(NUMBER.join(parts), page)
        values = self.values(program)
        assert len(values) == len(parts) - 1, (self.text, values)
        differences = []
        for group in range(len(values), 0, -1):
            if match[group] != values[group - 1]:
                differences.insert(0,
                                   f"{match[group]} is now {values[group - 1]}: {self.text.splitlines()[0]}")
                page = page[: match.start(group)] + values[group - 1] + page[match.end(group) :]
        return page, differences


@dataclass(frozen=True)
class Block:
    """A fenced block of a page that begins with a line: rows of what a command prints, `...` for those that
    are left out."""

    page: str
    first: str
    command: tuple[str, ...]

    def compared(self, page, program):
        match = re.search(rf"(?<=```text\n){re.escape(self.first)}.*?(?=```)", page, re.S)
        if not match:
            return page, [f"has no block that begins with {self.first}"]
        prompt, kept = "", match[0]
        if kept.startswith("$ "):
            prompt, kept = kept[: kept.index("\n") + 1], kept[kept.index("\n") + 1 :]
        said = program.said(*self.command).splitlines()
        try:
            pieces = [self.piece(piece.strip("\n").splitlines(), said) for piece in kept.split("  ...\n")]
        except LookupError as missing:
            return page, [f"has a row `{missing}` that the program does not print"]
        now = prompt + "\n  ...\n".join(pieces) + "\n"
        differences = [
            f"`{one}` is now `{other}`"
            for one, other in zip(match[0].splitlines(), now.splitlines(), strict=False)
            if one != other
        ]
        if now != match[0] and not differences:
            differences = [f"the block of {self.first} has other rows now"]
        return page[: match.start()] + now + page[match.end() :], differences

    @staticmethod
    def piece(kept, said):
        """The rows from the first label of a piece to its last, with the rows that go on from that."""

        def label(line):
            return line[2:20].strip()

        labels = [label(line) for line in kept if label(line)]
        ends = {name: [i for i, line in enumerate(said) if label(line) == name] for name in labels}
        for name, places in ends.items():
            if not places:
                raise LookupError(name)
        start, end = ends[labels[0]][0], ends[labels[-1]][-1] + 1
        # Lines that go on behind the last label, as far as they do on the page.
        for line in kept[max(i for i, line in enumerate(kept) if label(line)) + 1 :]:
            if not (line.strip() and said[end:] and said[end].strip()) or label(said[end]):
                break
            end += 1
        return "\n".join(said[start:end])


def power(value):
    """Two significant digits; from a thousand on with a power of ten."""
    if value < 1000.0:
        return digits(value, 2)
    mantissa, exponent = f"{value:.1e}".split("e+")
    return f"{mantissa}·10{str(int(exponent)).translate(str.maketrans('0123456789', '⁰¹²³⁴⁵⁶⁷⁸⁹'))}"


def error(run, scalar, controlled):
    name = "scalar_controlled_standard_error" if controlled else "scalar_standard_error"
    return float(run[f"ensemble/{name}"][SCALARS.index(scalar)])


def reductions(program):
    """The table of errors.md: ratios by which the variance of a mean is smaller with controls."""
    values = []
    for scalar in SCALARS:
        for case in CASES:
            plain, controlled = (error(program.run(case), scalar, kind) for kind in (False, True))
            ratio = (plain / controlled) ** 2
            values.append(f"{ratio:.2f}" if ratio < 9.995 else f"{ratio:.1f}")
    return values


def drawn(picture, *names):
    """Numbers that the script of a picture left in it (`save` of drawing.py), by their names."""

    def values(_):
        kept = re.search("<!-- numbers: (.*?) -->", (ROOT / "docs" / picture).read_text(encoding="utf-8"))
        return [number for name in names for number in json.loads(kept[1])[name]]

    return values


def first_probe(program):
    """Jump-in and pull-off of the first replica of the probe, after the first preload."""
    replicas = program.run("probe")["replicas"]
    snap, pull_off = replicas["snap_in_distance"][0, 0], replicas["pull_off_after_preload"][0, 0]
    return [digits(1e9 * snap), digits(1e6 * pull_off, 4)]


def gold(program):
    """Pull-offs of a diamond from gold and their standard errors, µN, by work of adhesion, hardness and contact."""
    of = program.file("run", "gold.toml")["instability"]
    pairs = zip(*(of[f"pull_off_after_preload_{name}"][...].ravel() for name in ("mean", "standard_error")), strict=True)
    return [f"{1e6 * force:.2f}" for pair in pairs for force in pair]


def strata(program):
    """Ratios by which the variance of the mean external force of case II is smaller with strata, and with
    opposite heights."""

    def ratio(scheme, h_star):
        plain, other = program.run("case_ii"), program.run("case_ii", scheme)
        place = int(np.argmin(np.abs(plain["ensemble/h_star"][:] - h_star)))
        assert abs(plain["ensemble/h_star"][place] - h_star) < 1e-9, f"case II has no separation h* = {h_star}"
        errors = [run["ensemble/external_force_standard_error"][place] for run in (plain, other)]
        return (errors[0] / errors[1]) ** 2

    schemes = ("stratified", "antithetic")
    return [digits(ratio(scheme, h_star), 2) for h_star in (0.7, 1.0) for scheme in schemes]


def pull_offs(program):
    """The four pull-offs of case II, with their errors and intervals, µN."""
    run = program.run("case_ii")
    ensemble = run["ensemble"]
    curve = ensemble["external_force_mean"][:]
    error = ensemble["external_force_standard_error"][curve.argmin()]
    values = []
    for kind, decimals in (("controlled_", 2), ("", 1)):
        mean, own = (1e6 * ensemble[f"scalar_{kind}{name}"][0] for name in ("mean", "standard_error"))
        values += [f"{mean:.1f}", f"{own:.{decimals}f}", *(f"{1e6 * end:.1f}" for end in ensemble[f"scalar_{kind}interval"][0])]
    depths = [f"{1e6 * run[group].attrs['pull_off_force']:.1f}" for group in ("ensemble", "integral")]
    assert run["integral"].attrs["quadrature_error"] < 1e-12
    return [*values, depths[0], f"{1e6 * error:.1f}", depths[1]]


def fits(case, unit, decimals):
    """Pull-off of the integral and the h* of its stiffest point: directly and with the published fits."""

    def values(program):
        file = program.file("compare", ROOT / f"configs/{case}.toml", "--laws", "hybrid,fit:paper")
        force = file["integral/pull_off_force"][:]
        place = file["integral/peak_stiffness_separation"][:] / file["surface_height_std"][:]
        forces = [f"{value / unit:.{count}f}" for value, count in zip(force, decimals, strict=True)]
        ratio = force[1] / force[0]
        excess = f"{ratio:.1f}" if ratio > 2.0 else f"+{100 * (ratio - 1):.1f}"
        places = [f"{value:.2f}" for value in place]
        return [forces[0], places[0], forces[1], excess, places[1]]

    return values


def cycle(program):
    run = program.run("loop")
    energy = 1e12 * run["replicas/dissipated_energy"][:]
    there, back = [run[f"integral/{way}external_force"][:] for way in ("", "retraction_")]
    integral = 1e12 * np.trapezoid(there - back, run["ensemble/separation"][:])
    error = energy.std(ddof=1) / len(energy) ** 0.5
    return [f"{energy.mean():.2f}", f"{error:.2f}", f"{float(integral):.2f}",
            f"{100 * energy.std(ddof=1) / energy.mean():.1f}"]


def pulled(program):
    run = program.run("loop")["ensemble"]
    means = dict(zip(run["scalar"].asstr()[:], 1e6 * run["scalar_controlled_mean"][:], strict=True))
    return [f"{means[name]:.2f}" for name in ("pull_off_force", "approach_pull_off_force")]


def loop_pull_off(program):
    """Mean pull-off of the patches of the loop, and the integral's."""
    mean, _ = pulled(program)
    return [f"{float(mean):.1f}", f"{1e6 * program.run('loop')['integral'].attrs['pull_off_force']:.1f}"]


def contact(program):
    run = program.run("loop")
    sigma = run.attrs["surface_height_std"]
    return [f"{run[f'replicas/{name}_separation'][:].mean() / sigma:.2f}"
            for name in ("detachment", "touchdown")]


def spectrum(program):
    """Mean pull-off of the Gaussian surface of the shipped map's spectrum, µN."""
    return [digits(1e6 * program.run("surfaces/spectrum")["ensemble/scalar_controlled_mean"][0], 2)]


def surface_energy(program):
    run = program.file("run", ROOT / "configs/sweep_surface_energy.toml")
    values = []
    for point in (0, 2, 3):
        mean, error = [1e3 * float(run[f"ensemble/scalar_{name}"][point, 0])
                       for name in ("mean", "standard_error")]
        integral = 1e3 * float(run["integral/pull_off_force"][point])
        decimals = 3 if mean < 10 else 2
        place = float(run["integral/peak_stiffness_separation"][point] / run["surface_height_std"][point])
        values += [f"{mean:.{decimals}f}", f"{error:.{decimals}f}", f"{integral:.{decimals}f}",
                   f"{place:.2f}"]
    return values


def sizes(program):
    """Of case II, the sizes at which the bias is 10 and 5 %, between three sizes of the default ones."""
    from stiction import finite_size

    os.environ["STICTION"] = str(program.path)
    study = finite_size.study(finite_size.run(ROOT / "configs/case_ii.toml", "1000,3162,10000", progress=False))
    return [power(float(study["count_at_accuracy"].sel(accuracy=accuracy))) for accuracy in (0.1, 0.05)]


def scientific(value):
    """Two significant digits; below 0.01 with a power of ten."""
    if value >= 0.01:
        return digits(value, 2)
    mantissa, exponent = f"{value:.1e}".split("e-")
    return f"{mantissa}·10⁻{str(int(exponent)).translate(str.maketrans('0123456789', '⁰¹²³⁴⁵⁶⁷⁸⁹'))}"


def independence(case, metres):
    """The row of a case: shift in nm and in sigma, attraction, fluctuation, longest stable wavelength in a
    unit, per cent in contact."""

    def values(program):
        own = program.file("compare", ROOT / "configs" / f"{case}.toml", "--laws", "hybrid")["independence"]
        of = {name: abs(float(own[name][0])) for name in own if name not in ("model_law", "verdict")}
        shift = 1e9 * of["shift"]
        return [
            scientific(shift) if shift < 0.01 else digits(shift),
            scientific(of["relative_shift"]),
            scientific(of["relative_attractive_stiffness"]),
            scientific(of["relative_fluctuation"]),
            digits(of["longest_stable_wavelength"] / metres,
                   3 if metres == 1e-6 and case == "case_ii" else 2),
            scientific(100.0 * of["contact_share"]),
        ]

    return values


GAINS = "\n".join(f"| {name} | {{}} | {{}} | {{}} |" for name in (
    "pull-off force", "pull-off separation", "peak secant stiffness", "its separation"))
FOUR = "\n".join((
    "| {} ± {} | mean over patches, with [control variates](#control-variates) | the summary; `run.pull_off`; "
    "`scalar_controlled_mean` | {} to {} | quoting |",
    "| {} ± {} | the plain mean of the table of replicas | `run.replicas`; `scalar_mean` | {} to {} | statistics of your own |",
    "| {} ± {} | depth of the mean curve |",))
DEPTH = "| {} | depth of the integral's curve |"

FIGURES = [
    Block("README.md", "  pull-off ", ("run", "pad.toml", "--above", "100 nN", "-o", "pad.h5")),
    Block("docs/index.md", "  pull-off ", ("run", "pad.toml", "--above", "100 nN", "-o", "pad.h5")),
    Block("docs/probe.md", "  pull-off ", ("run", str(ROOT / "configs/probe.toml"), "-o", "probe.h5")),
    Block("docs/tutorial.md", "  pull-off ", ("run", str(ROOT / "configs/first.toml"), "-o", "first.h5")),
    Block("docs/laws.md", "$ stiction compare configs/case_ii.toml",
          ("compare", str(ROOT / "configs/case_ii.toml"), "--laws", "hybrid,emd,isbl,sbl")),
    Figure("docs/publication.md", "| case I: pull-off, stiffest at h* | {} µN, {} | {} µN ({} times), {} |",
           fits("case_i", 1e-6, (3, 3))),
    Figure("docs/publication.md", "| case II | {} mN, {} | {} mN ({} %), {} | 0.6 mN",
           fits("case_ii", 1e-3, (3, 3))),
    Figure("docs/publication.md", "| case III | {} mN, {} | {} mN ({} %), {} | 93.5 mN",
           fits("case_iii", 1e-3, (1, 1))),
    Block("docs/errors.md", "  pull-off ", ("run", str(ROOT / "configs/target.toml"), "-o", "target.h5")),
    Figure("docs/errors.md", GAINS, reductions),
    Figure("docs/errors.md", FOUR, lambda program: pull_offs(program)[:-1]),
    Figure("docs/errors.md", DEPTH, lambda program: pull_offs(program)[-1:]),
    Figure(
        "docs/errors.md",
        "falls {} times at h* = 0.7 in case II (antithetic: {}), {} times at h* = 1 ({}) "
        "and not at all from h* = 2.5.",
        strata,
    ),
    Block("docs/hysteresis.md", "  pull-off          mean", ("run", str(ROOT / "configs/loop.toml"), "-o", "loop.h5")),
    Figure("docs/hysteresis.md",
           "{} ± {} pJ per cycle (integral: {} pJ), with a standard deviation of {} % from patch to patch", cycle),
    Figure("docs/hysteresis.md",
           "Pulled off at {} µN after the cycle, where the approach has its minimum at {} µN", pulled),
    Figure("docs/hysteresis.md", "contact ends at h* = {} on average, where it had begun at {}.", contact),
    Figure("docs/force-curves.md", "this replica jumps in over {} nm, and detaches at\n{} µN", first_probe),
    Figure("docs/measured.md", "".join(
        f"| {work} J/m², {hardness} GPa | {{}} ± {{}} µN | {{}} ± {{}} µN |\n"
        for work in ("0.18", "0.265") for hardness in (2, 3)), gold),
    Block("docs/my-afm-map.md", "  material ", ("map", str(ROOT / "configs/maps/polished.txt"), "--above", "3 uN")),
    Block("docs/surfaces.md", "  N   ", ("check", "two.toml")),
    Block("docs/hysteresis.md", "  pull-off          after", ("run", str(ROOT / "configs/preload.toml"), "-o", "preload.h5")),
    Figure(
        "docs/sweeps.md",
        "| 0.04 | 6.3 mN | {} ± {} mN | {} mN | 2.82 | {} |\n"
        "| 0.09 | 19.9 mN | {} ± {} mN | {} mN | 2.75 | {} |\n"
        "| 0.14 | 35.8 mN | {} ± {} mN | {} mN | 2.80 | {} |",
        surface_energy,
    ),
    Block("docs/independence.md", "  pull-off ", ("run", str(ROOT / "configs/coupled.toml"), "-o", "coupled.h5")),
    Block("docs/independence.md", "  independence ", ("check", str(ROOT / "configs/case_ii.toml"))),
    Figure("docs/independence.md", "| case I | {} nm = {} σ | {} | {} σ | {} m | {} % | good |",
           independence("case_i", 1.0)),
    Figure("docs/independence.md", "| case II | {} nm = {} σ | {} | {} σ | {} µm | {} % | a shift |",
           independence("case_ii", 1e-6)),
    Figure("docs/independence.md", "| case III | {} nm = {} σ | {} | {} σ | {} µm | {} % | invalid |",
           independence("case_iii", 1e-6)),
    Figure("docs/finite-size.md", "| case II | {} | {} |", sizes),
    Figure("docs/concepts.md", "{} µN in place of {} in the [loop of case I]", loop_pull_off),
    Figure("docs/coupling.md", "At h* = 6.1 one of {} asperities touches. At 6.0 the attraction is stiffer than k_s: "
           "{} touch, {} of them in one avalanche.",
           drawn("coupled_loads.svg", "asperities", "after", "largest avalanche")),
    Figure("docs/coupling.md", "**the pull-off is {} mN,**", drawn("coupled_patch.svg", "pull-off of the loop")),
    Figure("docs/independence.md", "where {} of {} asperities come to touch, and is pulled off where the half-space "
           "jumps off, with {} mN.", lambda program: drawn("coupled_loads.svg", "after", "asperities")(program)
           + drawn("coupled_patch.svg", "pull-off of the loop")(program)),
    Figure("docs/independence.md", "| I, `good` | patch | {} nN → {} nN ({} ± {} %) | {} → {} |",
           drawn("coupled_cases.svg", "I patch")),
    Figure("docs/independence.md", "| II, `a shift` | patch | {} µN → {} µN ({} ± {} %) | {} → {} |",
           drawn("coupled_cases.svg", "II patch")),
    Figure("docs/independence.md", "| II | repeated square | {} µN → {} µN ({} ± {} %) | {} → {} |",
           drawn("coupled_cases.svg", "II periodic")),
    Figure("docs/independence.md", "| III, `invalid` | patch | {} mN → {} mN | {} → {} |",
           drawn("coupled_cases.svg", "III patch")),
    *(Figure("docs/humidity.md", f"| {rh} | {{}} {unit} | {{}} {unit} | {{}} mJ/m² | {{}} % | {{}} % |",
             drawn("humidity.svg", rh))
      for rh, unit in (("0.4", "kPa"), ("0.7", "kPa"), ("0.8", "kPa"), ("0.9", "MPa"), ("0.95", "MPa"))),
    *(Figure("docs/plastic.md", f"| {case} | {branch} |" + 4 * " {} ± {} ({}) |", drawn("plastic.svg", f"{case} {branch}"))
      for case in ("I", "II") for branch in ("approach", "unloading")),
    Figure("docs/surfaces.md", "exponential heights pull off with {} µN instead of {} µN per 100 µm²",
           drawn("surfaces.svg", "exponential", "gaussian")),
    Figure("docs/surfaces.md", "{} % for Gaussian heights", drawn("surfaces.svg", "gaussian excess")),
    Figure("docs/surfaces.md", "The shipped one has {} µN", drawn("surfaces.svg", "measured patch")),
    Figure("docs/surfaces.md", "the Gaussian surface of its spectrum {} µN", spectrum),
    Figure("docs/surfaces.md", "the standard deviations of their patches are {} and",
           drawn("surfaces.svg", "measured deviation")),
    Figure("docs/surfaces.md", "by the integral {} MPa instead of {}.",
           drawn("surfaces.svg", "nayak integral", "gaussian integral")),
]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", nargs="*", metavar="PAGE", help="such as docs/errors.md")
    parser.add_argument("--write", action="store_true", help="replace the numbers that differ")
    default = os.environ.get("STICTION", ROOT / "target/release/stiction")
    parser.add_argument("--program", type=Path, default=Path(default), help="the program")
    arguments = parser.parse_args()
    differences = 0
    with tempfile.TemporaryDirectory() as folder:
        program = Program(arguments.program.resolve(), Path(folder))
        for figure in FIGURES:
            if arguments.pages and figure.page not in arguments.pages:
                continue
            path = ROOT / figure.page
            page, found = figure.compared(path.read_text(), program)
            print("\n".join(f"{figure.page}: {difference}" for difference in found),
                  end="\n" if found else "")
            differences += len(found)
            if arguments.write and page != path.read_text():
                path.write_text(page)
    of = f"{len(FIGURES)} pieces" if not arguments.pages else "the pages named"
    print(f"{differences} differences in {of}" + (", written" if arguments.write and differences else ""))
    return 1 if differences and not arguments.write else 0


if __name__ == "__main__":
    sys.exit(main())
