"""Where the program is that is tested, $STICTION or what cargo has built, how it is called, and the patch that several tests look at."""

import os
import re
import subprocess
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("STICTION", ROOT / "target" / "release" / "stiction")).resolve()
PATCH = """[material]
reduced_modulus = "85.29 GPa"
hardness = "2.5 GPa"
poisson_ratio = 0.27
work_of_adhesion = "0.09 J/m^2"
equilibrium_spacing = "0.2 nm"

[surface]
asperity_radius = "3.33 um"
asperity_density = "7.39 /um^2"
surface_height_std = "1.619 nm"
nominal_area = "300 um^2"
lubricant_thickness = "0.5 nm"
"""


def documented_version(page: str) -> list[int]:
    """Major and minor version of the layout that a page of the documentation describes."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return [int(number) for number in re.search(r"its layout, version (\d+)\.(\d+)", text).groups()]


def ask(*arguments: object, folder: Path | None = None) -> subprocess.CompletedProcess:
    """What the program says to arguments, which it has to understand."""
    assert PROGRAM.is_file(), f"no program {PROGRAM}: run `cargo build --release` or set STICTION"
    done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=folder, capture_output=True, text=True, encoding="utf-8")
    assert done.returncode == 0, done.stderr
    return done


def run_scene(folder: Path, text: str, *arguments: object) -> tuple[Path, str]:
    """The result of a scene, and what the program printed; both files are in the folder afterwards."""
    (folder / "scene.toml").write_bytes(text.encode())
    return folder / "result.h5", ask("run", "scene.toml", "-o", "result.h5", "--force", "--quiet", *arguments, folder=folder).stdout


def changed(path: Path, *changes: tuple[str, str]) -> str:
    """The text of a scene with other words, which it has to have."""
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


def close(actual, expected, scale, tolerance=1e-12) -> bool:
    """Whether two arrays differ by no more than `tolerance` of `scale`."""
    return bool(np.all(np.abs(np.asarray(actual) - np.asarray(expected)) <= tolerance * np.asarray(scale)))
