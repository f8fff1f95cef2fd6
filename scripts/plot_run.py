"""One page of pictures of a result of `stiction run`.

(a) external force F and adhesion force F_s over the separation h*, around the adhesive well: mean over the replicas,
    standard deviation of one replica, the statistical integral, and the pull-off of the mean curve;
(b) how far the means of both forces deviate from the integral, in standard errors, with the joint test's verdict;
(c) adhesion force of each regime, with an inset of the separations where contact sets in;
(d) pull-off forces of the single replicas, their mean, and the pull-off of the mean curve and of the integral.

Usage:
    python scripts/plot_run.py FILE.h5 [-o OUT.png] [--dpi N]

The picture goes beside FILE.h5, with the suffix .png, unless -o says otherwise.
Exit codes: 0 done; 2 the file cannot be read or is not such a result, or the picture cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "h5py>=3.8", "matplotlib>=3.7"]
# ///

import argparse
import math
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.artist import Artist  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402
from matplotlib.ticker import MaxNLocator, NullFormatter, StrMethodFormatter  # noqa: E402

FORMAT, MAJOR_VERSION = "stiction-run", 1
BLUE, VERMILION, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#E69F00", "#009E73", "#CC79A7"
BAND, DASH_DOT = "#BFDBEE", (0, (5, 1.2, 1, 1.2))
SEPARATION = "separation $h$* = $h/\\sigma$"
# Colour, line style and width of the curves of panel (c); the line styles tell them apart in grey as well.
CURVES = {
    "total": ("black", "-", 1.8),
    "noncontact": (BLUE, (0, (5, 1.5)), 1.6),
    "lubricant": (ORANGE, "-", 1.6),
    "elastic": (VERMILION, DASH_DOT, 1.6),
    "elastoplastic 1+2": (GREEN, (0, (1.2, 1.2)), 1.8),
    "plastic": (PURPLE, (0, (9, 2)), 1.2),
}
PAGE = (11.0, 8.0)
STYLE = {
    "font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.labelsize": 9, "legend.fontsize": 8,
    "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.linewidth": 0.7, "legend.frameon": False,
    "legend.handlelength": 2.8, "legend.columnspacing": 1.4, "legend.borderaxespad": 0.3, "axes.xmargin": 0.01,
    "axes.spines.top": False, "axes.spines.right": False, "axes.formatter.useoffset": False,
}
DATASETS = [
    "h_star", "separation", "regime", "ensemble/external_force_mean", "ensemble/external_force_std",
    "ensemble/adhesion_force_mean", "ensemble/contact_area_mean", "ensemble/regime_adhesion_force_mean",
    "replicas/asperity_count", "replicas/pull_off_force", "statistical/external_force",
    "statistical/adhesion_force", "statistical/regime_adhesion_force", "validation/z_adhesion_force",
    "validation/z_external_force", "validation/tested_adhesion_force", "validation/tested_external_force",
]
ATTRIBUTES = [
    "/title", "/law", "/path", "/adhesion_parameter", "/plasticity_index", "/nominal_area", "/replicas", "/seed",
    "/surface_height_std", "/ensemble/pull_off_force", "/ensemble/pull_off_separation",
    "/statistical/pull_off_force", "/validation/verdict", "/validation/p_value",
]


class RunError(Exception):
    """Why a file cannot be plotted."""


@dataclass
class Run:
    """What the page shows: the name of the file, attributes and datasets, both by path."""

    name: str
    attributes: dict[str, object]
    datasets: dict[str, np.ndarray]

    def __getitem__(self, path: str) -> np.ndarray:
        return self.datasets[path]


def text(value: object) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def read(path: Path) -> Run:
    """Reads a result, or says in a RunError what is wrong with the file."""
    if not path.is_file():
        raise RunError("no such file")
    try:
        if not h5py.is_hdf5(path):
            raise RunError("not an HDF5 file")
        with h5py.File(path, "r") as file:
            check_format(file)
            attributes = {name: attribute(file, name) for name in ATTRIBUTES}
            return Run(path.name, attributes, {name: dataset(file, name) for name in DATASETS})
    except OSError as error:
        raise RunError(f"cannot be read: {error}") from error


def check_format(file: h5py.File) -> None:
    if text(file.attrs.get("format", "")) != FORMAT:
        raise RunError(f"not a result of `stiction run`: its attribute `format` is not {FORMAT}")
    version = np.atleast_1d(file.attrs.get("format_version", 0))
    if version[0] != MAJOR_VERSION:
        raise RunError(f"its format version is {'.'.join(map(text, version))}; {MAJOR_VERSION}.x can be read here")


def attribute(file: h5py.File, path: str) -> object:
    group, name = path.rsplit("/", 1)
    try:
        return file[group or "/"].attrs[name]
    except KeyError:
        raise RunError(f"the attribute {name} of {group or '/'} is missing") from None


def dataset(file: h5py.File, path: str) -> np.ndarray:
    try:
        return file[path][()]
    except KeyError:
        raise RunError(f"the dataset /{path} is missing") from None


def si(largest: float) -> tuple[float, str]:
    """Factor and sign of the SI prefix for numbers up to `largest`."""
    exponent = math.floor(math.log10(largest) / 3) if largest > 0 and math.isfinite(largest) else 0
    exponent = min(max(exponent, -5), 3)
    return 1000.0**exponent, "fpnµm kMG"[exponent + 5].strip()


def newton(value: float) -> str:
    factor, sign = si(abs(value))
    return f"{value / factor:#.4g}".rstrip(".") + f" {sign}N"


def pull_off_place(run: Run) -> float:
    return float(run.attributes["/ensemble/pull_off_separation"] / run.attributes["/surface_height_std"])


def head(axes: Axes, title: str, handles: list[Artist], columns: int) -> None:
    """Title and legend above the panel, where no curve can be beneath them."""
    rows = math.ceil(len(handles) / columns)
    axes.set_title(title, pad=8.0 + 12.2 * rows)
    axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=columns)


def force_range(mean: np.ndarray, std: np.ndarray) -> tuple[float, float]:
    """Range of forces around the adhesive well; all of them where there is none."""
    std = np.nan_to_num(std)
    low, high = float((mean - std).min()), float((mean + std).max())
    if mean.min() >= 0.0:
        return low - 0.1 * (high - low), high + 0.1 * (high - low)
    depth = max(-1.6 * mean.min(), min(-1.1 * low, -2.6 * mean.min()))
    return -depth, max(0.1 * depth, min(1.05 * high, 0.8 * depth))


def pull_off_label(run: Run) -> str:
    force = run.attributes["/ensemble/pull_off_force"]
    if force <= 0.0:
        return "no pull-off: $F$ > 0 throughout"
    mean = run["ensemble/external_force_mean"]
    at_edge = " (edge)" if mean.argmin() in (0, mean.size - 1) else ""
    return f"pull-off: {newton(force)} at $h$* = {pull_off_place(run):.2f}{at_edge}"


def draw_forces(axes: Axes, run: Run) -> None:
    x, mean, std = run["h_star"], run["ensemble/external_force_mean"], run["ensemble/external_force_std"]
    low, high = force_range(mean, std)
    unit, sign = si(max(-low, high))
    handles = axes.plot(x, mean / unit, color=BLUE, linewidth=2.2, label="$F$, mean over replicas")
    if np.isfinite(std).any():
        edges = (mean - std) / unit, (mean + std) / unit
        for side in edges:
            axes.plot(x, side, color=BLUE, linewidth=0.4, zorder=1.5)
        handles.append(axes.fill_between(x, *edges, color=BAND, linewidth=0, zorder=1,
                                         label="± standard deviation of one replica"))
    handles += axes.plot(x, run["statistical/external_force"] / unit, color="black", linestyle=(0, (4, 2)),
                         linewidth=0.9, label="$F$, integral")
    place, force = pull_off_place(run), -run.attributes["/ensemble/pull_off_force"] / unit
    handles += axes.plot(place, force, "o", color="black", markerfacecolor="white", markersize=5.5, zorder=5,
                         label=pull_off_label(run), clip_on=False)
    handles += axes.plot(x, -run["ensemble/adhesion_force_mean"] / unit, color=VERMILION, linestyle=DASH_DOT,
                         linewidth=1.2, zorder=1.8, label="$-F_s$, mean over replicas")
    axes.axhline(0.0, color="0.5", linewidth=0.6, zorder=0.5)
    axes.set(ylim=(low / unit, high / unit), ylabel=f"force, compressive positive ({sign}N)")
    axes.tick_params(labelbottom=False)
    head(axes, "(a) External force $F$ and adhesion force $F_s$", handles, 2)


def shade(axes: Axes, x: np.ndarray, where: np.ndarray, color: str) -> None:
    """Shades runs of separations, each up to the middle between neighbours."""
    middles = np.concatenate([x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]])
    steps = np.diff(np.concatenate([[0], where.astype(int), [0]]))
    for first, after in zip(np.flatnonzero(steps == 1), np.flatnonzero(steps == -1)):
        axes.axvspan(middles[first], middles[after], color=color, linewidth=0, zorder=0)


def z_limit(run: Run) -> float:
    """Shows all z-scores that the joint test looks at, and the others up to 8."""
    def largest(z: np.ndarray) -> float:
        return float(np.abs(z[np.isfinite(z)]).max(initial=0.0))
    limit = 3.0
    for force in ("external_force", "adhesion_force"):
        z, tested = run[f"validation/z_{force}"], run[f"validation/tested_{force}"] != 0
        limit = max(limit, 1.1 * largest(z[tested]), min(1.1 * largest(z), 8.0))
    return limit


def draw_z(axes: Axes, run: Run) -> None:
    x, limit = run["h_star"], z_limit(run)
    marker = "." if x.size <= 20 else None
    handles = axes.plot(x, run["validation/z_external_force"], color=BLUE, linewidth=1.4, marker=marker, label="$F$")
    handles += axes.plot(x, run["validation/z_adhesion_force"], color=VERMILION, linestyle=DASH_DOT, linewidth=1.2,
                         marker=marker, label="$F_s$")
    for level in (-2.0, 0.0, 2.0):
        axes.axhline(level, color="0.35", linewidth=0.7, linestyle="-" if level == 0.0 else "--", zorder=1)
    out = [run[f"validation/tested_{force}_force"] == 0 for force in ("external", "adhesion")]
    for label, color, where in [("one of them left out of the joint test", "0.92", out[0] ^ out[1]),
                                ("both left out of the joint test", "0.82", out[0] & out[1])]:
        if where.any():
            shade(axes, x, where, color)
            handles.append(Patch(color=color, label=label))
    verdict, p_value = text(run.attributes["/validation/verdict"]), float(run.attributes["/validation/p_value"])
    p_value = f", p = {p_value:.3g}" if math.isfinite(p_value) else ""
    axes.set(ylim=(-limit, limit), xlabel=SEPARATION, ylabel="$z$")
    axes.set_title(f"(b) $z$ = (mean − integral) / standard error; joint test: {verdict}{p_value}")
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(-0.02, -0.27), ncols=2)


def by_regime(run: Run, table: str, total: str) -> dict[str, np.ndarray]:
    """Total adhesion force, and that of each regime that has any, the elastoplastic ones together."""
    curves = {"total": run[total]}
    for name, curve in zip(map(text, run["regime"]), run[table]):
        name = "elastoplastic 1+2" if name.startswith("elastoplastic") else name
        curves[name] = curves.get(name, 0.0) + curve
    return {name: curve for name, curve in curves.items() if name == "total" or np.any(curve != 0.0)}


def draw_curves(axes: Axes, x: np.ndarray, means: dict, integrals: dict, unit: float, step: int) -> list[Artist]:
    """Means as lines and integrals as dots, one every `step` separations."""
    handles, dots = [], []
    for name, curve in means.items():
        color, line, width = CURVES.get(name, ("0.4", "-", 1.0))
        handles += axes.plot(x, curve / unit, color=color, linestyle=line, linewidth=width, label=name)
    for name in means:
        dots = axes.plot(x[::step], integrals[name][::step] / unit, "o", color="black", markersize=2.2, zorder=3,
                         markerfacecolor="white", markeredgewidth=0.6, label="integral")
    return handles + dots


def draw_regimes(axes: Axes, run: Run) -> None:
    x = run["h_star"]
    means = by_regime(run, "ensemble/regime_adhesion_force_mean", "ensemble/adhesion_force_mean")
    integrals = by_regime(run, "statistical/regime_adhesion_force", "statistical/adhesion_force")
    largest = float(means["total"].max())
    unit, sign = si(largest)
    handles = draw_curves(axes, x, means, integrals, unit, max(1, x.size // 30))
    axes.set(xlabel=SEPARATION, ylabel=f"adhesion force ({sign}N)", ylim=(0.0, 1.08 * largest / unit))
    head(axes, "(c) Adhesion force $F_s$ of each regime, mean over replicas", handles, 4)
    draw_onset(axes, x, means, integrals, unit)


def draw_onset(axes: Axes, x: np.ndarray, means: dict, integrals: dict, unit: float) -> None:
    """An inset of the separations where noncontact asperities take over, if there are such and there is room."""
    total = integrals["total"]
    over = np.flatnonzero(integrals.get("noncontact", 0.0 * total) > 0.5 * total)
    if over.size < 5 or over[0] == 0 or not total[-1] > 0.0:
        return
    first, bottom, height, left = max(over[0] - x.size // 10, 0), 0.36, 0.56, 0.46
    beneath = x > x[0] + (left - 0.1) * (x[-1] - x[0])
    headroom = float(means["total"][beneath].max(initial=0.0)) / unit / (bottom - 0.14)
    if headroom > 1.7 * axes.get_ylim()[1]:
        return
    axes.set_ylim(0.0, max(headroom, axes.get_ylim()[1]))
    inset = axes.inset_axes((left, bottom, 0.985 - left, height))
    unit, sign = si(float(total[first]))
    draw_curves(inset, x, means, integrals, unit, max(1, (x.size - first) // 14))
    top = 1.6 * total[first] / unit
    inset.set(yscale="log", xlim=(x[first], x[-1]), ylim=(min(0.4 * total[-1] / unit, top / 30.0), top))
    inset.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    inset.yaxis.set_minor_formatter(NullFormatter())
    inset.set_title(f"onset of contact ({sign}N)", fontsize=8, loc="right", pad=3)


def bins(values: np.ndarray) -> np.ndarray:
    """Edges by the rule of Freedman and Diaconis, within reason; one bin for equal values."""
    low, high = float(values.min()), float(values.max())
    if not high > low:
        half = 0.02 * abs(low) or 1.0
        return np.array([low - half, low + half])
    quartiles = np.percentile(values, [25, 75])
    width = 2.0 * float(quartiles[1] - quartiles[0]) / values.size ** (1 / 3) or high - low
    return np.linspace(low, high, min(max(math.ceil((high - low) / width), 8), 40) + 1)


def draw_pull_off(axes: Axes, run: Run) -> None:
    values = run["replicas/pull_off_force"]
    unit, sign = si(float(np.abs(values).max()))
    mean, n = float(values.mean()), values.size
    error = f" ± {float(values.std(ddof=1)) / math.sqrt(n) / unit:.2g}" if n > 1 else ""
    edges = bins(values) / unit
    counts, _, bars = axes.hist(values / unit, bins=edges, color="0.85", edgecolor="0.45", linewidth=0.6)
    bars[0].set_label(f"{n} replica{'s' if n > 1 else ''}")
    lines = [(mean, f"their mean: {mean / unit:.4g}{error} {sign}N", "black", "-"),
             (run.attributes["/ensemble/pull_off_force"], "of the mean curve", BLUE, (0, (5, 1.5))),
             (run.attributes["/statistical/pull_off_force"], "of the integral", VERMILION, DASH_DOT)]
    handles = [bars[0]]
    for value, label, color, line in lines:
        label = label if ":" in label else f"{label}: {newton(value)}"
        handles.append(axes.axvline(value / unit, color=color, linestyle=line, linewidth=1.6, label=label))
    axes.set(xlabel=f"pull-off force, minus the smallest $F$ ({sign}N)", ylabel="replicas", xmargin=0.04)
    axes.set_ylim(0.0, 1.1 * counts.max())
    axes.yaxis.set_major_locator(MaxNLocator(nbins=6, integer=True))
    head(axes, "(d) Pull-off force", handles, 2)


def draw_texts(figure: Figure, run: Run) -> None:
    """Title and numbers of the scene above, what the model leaves out beneath."""
    attributes = run.attributes
    title = textwrap.wrap(text(attributes["/title"]) or run.name, 88, max_lines=2, placeholder=" …")
    figure.text(0.5, 0.985, "\n".join(title), ha="center", va="top", fontsize=12, weight="bold", parse_math=False)
    count = round(float(run["replicas/asperity_count"].mean()))
    numbers = (f"law {text(attributes['/law'])}, path {text(attributes['/path'])}, "
               f"λ = {attributes['/adhesion_parameter']:.4g}, ψ = {attributes['/plasticity_index']:.4g}, "
               f"N = {count}, {attributes['/replicas']} replicas, seed {attributes['/seed']}")
    figure.text(0.5, 0.981 - 0.027 * len(title), numbers, ha="center", va="top", fontsize=9.5)
    nearest = np.abs(run["separation"] - attributes["/ensemble/pull_off_separation"]).argmin()
    share = 100.0 * run["ensemble/contact_area_mean"][nearest] / attributes["/nominal_area"]
    place = "at pull-off" if attributes["/ensemble/pull_off_force"] > 0.0 else "at the smallest force"
    figure.text(0.5, 0.012, "independent asperities: no coupling through the substrate, no coalescence; "
                f"contact area {place} {share:.2g} % of the nominal area", ha="center", va="bottom", fontsize=8.5)


def draw(run: Run) -> Figure:
    figure = plt.figure(figsize=PAGE)

    def panel(left: float, bottom: float, width: float, height: float, **shared: Axes) -> Axes:
        """Axes placed in inches."""
        return figure.add_axes((left / PAGE[0], bottom / PAGE[1], width / PAGE[0], height / PAGE[1]), **shared)

    forces = panel(0.85, 3.15, 4.5, 3.3)
    draw_forces(forces, run)
    draw_z(panel(0.85, 1.2, 4.5, 1.55, sharex=forces), run)
    draw_regimes(panel(6.3, 4.0, 4.45, 2.65), run)
    draw_pull_off(panel(6.3, 1.2, 4.45, 1.65), run)
    draw_texts(figure, run)
    return figure


def dots_per_inch(argument: str) -> int:
    if not 20 <= int(argument) <= 1200:
        raise argparse.ArgumentTypeError("between 20 and 1200")
    return int(argument)


def main() -> int:
    parser = argparse.ArgumentParser(description="Pictures of a result of `stiction run`, on one page.")
    parser.add_argument("file", type=Path, metavar="FILE.h5", help="the result")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.png", help="default: beside the result, with .png")
    parser.add_argument("--dpi", type=dots_per_inch, default=200, metavar="N", help="dots per inch, default 200")
    arguments = parser.parse_args()
    output = arguments.output or arguments.file.with_suffix(".png")
    try:
        run = read(arguments.file)
        with plt.rc_context(STYLE):
            figure = draw(run)
            figure.savefig(output, dpi=arguments.dpi)
    except RunError as error:
        print(f"plot_run: {arguments.file}: {error}", file=sys.stderr)
        return 2
    except (OSError, ValueError) as error:
        print(f"plot_run: {output}: cannot be written: {error}", file=sys.stderr)
        return 2
    print(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
