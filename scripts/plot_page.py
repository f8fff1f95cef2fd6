"""What the scripts that draw a page of pictures have in common: looks, SI prefixes, reading a result, the command line."""

import argparse
import math
import sys
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

PAGE = (11.0, 8.0)  # inches
BLUE, VERMILION, GREEN = "#0072B2", "#D55E00", "#009E73"
DASHED, DASH_DOT = (0, (5, 1.5)), (0, (5, 1.2, 1, 1.2))
STYLE = {
    "font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.labelsize": 9,
    "legend.fontsize": 8, "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.linewidth": 0.7,
    "legend.frameon": False, "legend.handlelength": 2.8, "legend.columnspacing": 1.1,
    "legend.borderaxespad": 0.3, "axes.spines.top": False, "axes.spines.right": False,
    "axes.formatter.useoffset": False,
}


class FileError(Exception):
    """Why a file cannot be plotted."""


class Result:
    """A result that is open for reading, of a format in one major version."""

    format, major_version, made_by = "", 0, ""
    # What looks different from STYLE.
    style: dict[str, object] = {}

    def __init__(self, file: h5py.File) -> None:
        self.file = file
        if file.attrs.get("format") != self.format:
            raise FileError(f"not {self.made_by}: its attribute `format` is not {self.format}")
        version = np.atleast_1d(file.attrs.get("format_version", 0))
        if version[0] != self.major_version:
            raise FileError(f"its format version is {version[0]}.x, this script reads {self.major_version}.x")

    def __getitem__(self, path: str) -> np.ndarray:
        if not isinstance(self.file.get(path), h5py.Dataset):
            raise FileError(f"the dataset /{path} is missing")
        return self.file[path][()]

    def attribute(self, group: str, name: str) -> object:
        if group not in self.file or name not in self.file[group].attrs:
            raise FileError(f"the attribute {name} of {group} is missing")
        return self.file[group].attrs[name]


def panel(figure: Figure, left: float, bottom: float, width: float, height: float, **shared: Axes) -> Axes:
    """Axes at a place of a figure, inches."""
    w, h = figure.get_size_inches()
    return figure.add_axes((left / w, bottom / h, width / w, height / h), **shared)


def si(largest: float) -> tuple[float, str]:
    """Factor and sign of the SI prefix for numbers up to `largest`."""
    exponent = math.floor(math.log10(largest) / 3) if largest > 0 and math.isfinite(largest) else 0
    exponent = min(max(exponent, -5), 3)
    return 1000.0**exponent, "fpnµm kMG"[exponent + 5].strip()


def main(about: str, kind: type[Result], draw: Callable[..., Figure], options: dict[str, dict] | None = None) -> int:
    """Reads the command line, draws the result that it names, and says where the picture is. `options` are further ones by their names,
    whose values `draw` gets behind the result. Returns the exit code."""
    options = options or {}
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("file", type=Path, metavar="FILE.h5", help="the result")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.png", help="default: beside FILE.h5")
    for name, option in options.items():
        parser.add_argument(f"--{name}", **option)
    parser.add_argument("--dpi", type=int, default=200, metavar="N", help="dots per inch, default 200")
    arguments = parser.parse_args()
    output = arguments.output or arguments.file.with_suffix(".png")
    try:
        if not arguments.file.is_file() or not h5py.is_hdf5(arguments.file):
            raise FileError("not an HDF5 file" if arguments.file.is_file() else "no such file")
        with h5py.File(arguments.file, "r") as file, rc_context({**STYLE, **kind.style}):
            draw(kind(file), *(getattr(arguments, name) for name in options)).savefig(output, dpi=arguments.dpi)
    except (FileError, OSError, ValueError) as error:
        print(f"{Path(sys.argv[0]).stem}: {arguments.file}:", *str(error).split(), file=sys.stderr)
        return 2
    print(output)
    return 0
