"""The verdict on independence as a user of Python reads it: its figures follow from the scene and from the integral beside them. The script
that draws it works on a grid of seconds.

The program is $STICTION, by default target/release/stiction.
"""

import math
import subprocess
import sys

import h5py
import matplotlib.image
import numpy as np
import pytest
from program import PROGRAM, ROOT

SCRIPT = ROOT / "scripts" / "plot_independence.py"
MODULUS = 85.29e9  # of all scenes here
VERDICTS = {"case_i": "good", "case_ii": "a shift", "case_iii": "invalid"}


def draw(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, SCRIPT, *map(str, arguments)], capture_output=True, text=True, encoding="utf-8")


@pytest.mark.parametrize("case", VERDICTS)
def test_figures_follow_from_the_scene_and_the_integral(case, tmp_path):
    output = tmp_path / "out.h5"
    command = [PROGRAM, "run", ROOT / "configs" / f"{case}.toml", "--replicas", "2", "-o", output, "--quiet"]
    subprocess.run(command, check=True, capture_output=True)
    with h5py.File(output) as file:
        own, integral, root = file["independence"], file["integral"], file.attrs
        figure = {name: own[name][()] for name in own}
        assert all(own[name].shape == () and {"units", "long_name"} <= set(own[name].attrs) for name in own)
        side, sigma = math.sqrt(root["nominal_area"]), root["surface_height_std"]
        count = file["replicas/asperity_count"][0]
        c = 4 / math.pi * (math.log(1 + math.sqrt(2)) + (1 - math.sqrt(2)) / 3)
        stiffness = MODULUS * side / c
        separations, force = integral["separation"][()], integral["external_force"][()]
        # The mean square of one of N: between the separations beside the pull-off, where it changes by some per cent.
        square = integral["external_force_std"][()] ** 2 / count + (force / count) ** 2
        near = np.interp(integral.attrs["pull_off_separation"], separations, np.log(square))
        variance = 2 * math.pi * count / side**2 * math.exp(near) * math.log(2 * math.sqrt(count)) / (math.pi * MODULUS) ** 2
        slope = integral.attrs["peak_stiffness"]
        expected = {
            "patch_side": side,
            "substrate_stiffness": stiffness,
            "shift": -integral.attrs["pull_off_force"] / stiffness,
            "attractive_stiffness": slope,
            "longest_stable_wavelength": math.pi * MODULUS * side**2 / slope,
            "contact_share": integral["pull_off_contact_area"][()] / side**2,
            "closest_shift": force[0] / stiffness,
        }
        for name, value in expected.items():
            assert figure[name] == pytest.approx(value, rel=1e-12), name
        assert figure["fluctuation"] == pytest.approx(math.sqrt(variance), rel=2e-3)
        for name in ("shift", "closest_shift", "fluctuation"):
            assert figure[f"relative_{name}"] == pytest.approx(figure[name] / sigma, rel=1e-12)
        limits, beyond = own.attrs, figure["independent_from"]
        if not math.isnan(beyond):
            there = np.interp(beyond, separations, force)
            assert abs(there) / stiffness == pytest.approx(limits["good_relative_shift"] * sigma, rel=0.02)
        assert limits["verdict"] == VERDICTS[case]


def test_a_small_grid_leaves_a_picture(tmp_path):
    done = draw("-o", tmp_path / "page.png", "--steps", 4, "--dpi", 60)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[-1] == str(tmp_path / "page.png")
    for line, (case, verdict) in zip(lines, [("I", "good"), ("II", "a shift"), ("III", "invalid")], strict=False):
        assert line.startswith(f"case {case}: {verdict}; shift ")
    assert 0.1 < (matplotlib.image.imread(tmp_path / "page.png")[..., :3].min(axis=2) < 0.9).mean() < 0.95
