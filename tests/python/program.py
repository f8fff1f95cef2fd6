"""Where the program is that is tested, $STICTION or what cargo has built, and the patch that several tests look at."""

import os
import re
from pathlib import Path

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
