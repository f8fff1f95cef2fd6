"""One page of pictures of a result of `stiction asperities`.

(a) places of the summits, their colour by height;
(b) heights of the summits, with the density that Nayak's theory gives a Gaussian surface of the same spectral moments
    (P. R. Nayak, J. Lubr. Technol. 93 (1971) 398) and the Gaussian of the equivalent surface;
(c) curvature of each summit over its height, with the means of both;
(d) curvatures, with the mean and that of the equivalent surface.

Usage:
    python scripts/plot_asperities.py FILE.h5 [-o OUT.png] [--dpi N]

The picture goes beside FILE.h5, with the suffix .png, unless -o says otherwise.
Exit codes: 0 done; 2 the file cannot be read or is not such a result, or the picture cannot be written.
"""

# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=1.24", "scipy>=1.10", "h5py>=3.8", "matplotlib>=3.7"]
# ///

import math
import sys
import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import erf

from plot_page import BLUE, DASHED, DASH_DOT, VERMILION, Result, main, panel, si

PAGE = (11.0, 8.2)  # inches
BAR = "0.86"


class Asperities(Result):
    """A result of `stiction asperities`."""

    format, major_version, made_by = "stiction-asperities", 2, "a result of `stiction asperities`"


def nayak(s: np.ndarray, alpha: float) -> np.ndarray:
    """Probability density of summit heights over the standard deviation of the surface; for alpha > 3/2."""
    c = 2.0 * alpha - 3.0
    rise = np.exp(-alpha * s**2 / c) * math.sqrt(3.0 * c) / alpha * s
    middle = 3.0 * math.sqrt(2.0 * math.pi) / (2.0 * alpha) * np.exp(-0.5 * s**2)
    middle = middle * (1.0 + erf(math.sqrt(1.5 / c) * s)) * (s**2 - 1.0)
    rest = math.sqrt(2.0 * math.pi * alpha / (3.0 * (alpha - 1.0))) * np.exp(-alpha * s**2 / (2.0 * (alpha - 1.0)))
    rest = rest * (1.0 + erf(math.sqrt(alpha / (2.0 * (alpha - 1.0) * c)) * s))
    return math.sqrt(3.0) / (2.0 * math.pi) * (rise + middle + rest)


def head(axes: Axes, title: str, rows: int = 1) -> None:
    """Title and legend above the panel, where nothing can be beneath them."""
    axes.set_title(title, pad=8.0 + 12.2 * rows)
    axes.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=2)


def draw_map(figure: Figure, axes: Axes, file: Asperities) -> None:
    height, width = np.asarray(file.attribute("/", "map_shape")) * np.asarray(file.attribute("/", "pixel_size"))
    unit, sign = si(max(height, width))
    z_unit, z_sign = si(float(np.abs(file["asperities/height"]).max()))
    size = min(max(3000.0 / file["asperities/asperity"].size, 1.0), 30.0)
    dots = axes.scatter(file["asperities/x"] / unit, file["asperities/y"] / unit, size, file["asperities/height"] / z_unit,
                        cmap="cividis")
    axes.set(xlim=(0.0, width / unit), ylim=(height / unit, 0.0), aspect="equal", xlabel=f"x ({sign}m)",
             ylabel=f"y ({sign}m), as the rows of the map")
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)
    axes.set_title(f"(a) {file['asperities/asperity'].size} summits", pad=8.0)
    figure.colorbar(dots, ax=axes, label=f"height above the mean plane ({z_sign}m)", shrink=0.85, pad=0.02)


def draw_heights(axes: Axes, file: Asperities) -> None:
    heights, alpha, m0 = file["asperities/height"], float(file["surface/alpha"]), float(file["surface/m0"])
    unit, sign = si(float(np.abs(heights).max()))
    mean, std = float(file["equivalent/asperity_height_mean"]), float(file["equivalent/asperity_height_std"])
    count = min(max(round(2.0 * heights.size ** (1 / 3)), 8), 40)
    axes.hist(heights / unit, count, density=True, color=BAR, edgecolor="0.5", linewidth=0.6, label="summits")
    spread = max(std, float(heights.std()))
    z = np.linspace(min(mean - 4.0 * std, heights.min() - spread), max(mean + 4.0 * std, heights.max() + spread), 400)
    if alpha > 1.5:
        axes.plot(z / unit, nayak(z / math.sqrt(m0), alpha) / math.sqrt(m0) * unit, color=BLUE, linewidth=1.8,
                  label=f"Nayak, α = {alpha:.3g}")
    if std > 0.0:
        density = np.exp(-0.5 * ((z - mean) / std) ** 2) / (std * math.sqrt(2.0 * math.pi))
        axes.plot(z / unit, density * unit, color=VERMILION, linestyle=DASHED, linewidth=1.3, label="equivalent Gaussian")
    axes.axvline(float(file["measured/asperity_height_mean"]) / unit, color="black", linewidth=1.0, label="mean of summits")
    axes.set(xlabel=f"height above the mean plane ({sign}m)", ylabel=f"density (1/{sign}m)")
    head(axes, "(b) Heights of the summits", 2)


def draw_relation(axes: Axes, file: Asperities) -> None:
    heights, curvature = file["asperities/height"], 1.0 / file["asperities/radius"]
    (unit, sign), (per_unit, _) = si(float(np.abs(heights).max())), si(float(file["measured/asperity_radius"]))
    axes.plot(heights / unit, curvature * per_unit, "o", color=BLUE, markersize=2.5, alpha=0.6, markeredgewidth=0.0)
    axes.axhline(per_unit / float(file["measured/asperity_radius"]), color="black", linewidth=1.0)
    axes.axvline(float(file["measured/asperity_height_mean"]) / unit, color="black", linewidth=1.0)
    correlation = np.corrcoef(heights, curvature)[0, 1] if heights.size > 2 else math.nan
    axes.set_title(f"(c) Higher summits are sharper: correlation {correlation:.2f}" if correlation > 0.0 else
                   f"(c) Curvature over height: correlation {correlation:.2f}", pad=8.0)
    _, radius_sign = si(float(file["measured/asperity_radius"]))
    axes.set(xlabel=f"height above the mean plane ({sign}m)", ylabel=f"mean curvature (1/{radius_sign}m)", ylim=(0.0, None))


def draw_curvatures(axes: Axes, file: Asperities) -> None:
    curvature = 1.0 / file["asperities/radius"]
    measured, theory = float(file["measured/asperity_radius"]), float(file["equivalent/asperity_radius"])
    unit, sign = si(measured)
    count = min(max(round(2.0 * curvature.size ** (1 / 3)), 8), 40)
    axes.hist(curvature * unit, count, color=BAR, edgecolor="0.5", linewidth=0.6)
    for radius, label, color, line in [(measured, "mean", "black", "-"), (theory, "by the moments", VERMILION, DASH_DOT)]:
        axes.axvline(unit / radius, color=color, linestyle=line, linewidth=1.6,
                     label=f"{label}: $R$ = {radius / unit:.4g} {sign}m")
    axes.set(xlabel=f"mean curvature (1/{sign}m)", ylabel="summits", xlim=(0.0, None))
    head(axes, "(d) Curvatures of the summits")


def draw_texts(figure: Figure, file: Asperities) -> None:
    name = textwrap.shorten(str(file.attribute("/", "map")), 90)
    figure.text(0.5, 0.985, f"Asperities of {name}", ha="center", va="top", size=12, weight="bold", parse_math=False)
    sigma, density = math.sqrt(float(file["surface/m0"])), float(file["measured/asperity_density"])
    unit, sign = si(sigma)
    numbers = (f"σ = {sigma / unit:.4g} {sign}m, η = {1e-12 * density:.4g} /µm² "
               f"({1e-12 * float(file['equivalent/asperity_density']):.4g} by the moments), "
               f"levelled by {file.attribute('/', 'level')}, {file.attribute('/', 'missing_pixels')} heights missing")
    figure.text(0.5, 0.952, numbers, ha="center", va="top", fontsize=9.5)
    warnings = [textwrap.shorten(line, 170) for line in str(file.attribute("/", "warnings")).splitlines()]
    figure.text(0.06, 0.012, "\n".join(f"warning: {line}" for line in warnings[:3]), fontsize=8, color=VERMILION,
                parse_math=False)


def draw(file: Asperities) -> Figure:
    figure = Figure(figsize=PAGE)

    draw_map(figure, panel(figure, 0.7, 4.2, 4.9, 3.0), file)
    draw_heights(panel(figure, 6.4, 4.35, 4.3, 2.45), file)
    draw_relation(panel(figure, 0.7, 0.95, 4.55, 2.5), file)
    draw_curvatures(panel(figure, 6.4, 0.95, 4.3, 2.3), file)
    draw_texts(figure, file)
    return figure


if __name__ == "__main__":
    sys.exit(main("Pictures of a result of `stiction asperities`, on one page.", Asperities, draw))
