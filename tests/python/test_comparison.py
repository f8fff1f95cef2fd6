"""What the sweep over laws of `stiction compare` holds, read with h5py and xarray and checked with numpy and scipy, independently of the program.

Needs the packages of scripts/requirements.txt. The program is $STICTION, by default target/release/stiction.
"""

import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.integrate
import xarray
from program import PROGRAM, ROOT, documented_version

LAWS = ["hybrid", "isbl", "gw", "fit:paper"]
REPLICAS = 24
RADIUS, MODULUS, PULL = 3.33e-6, 85.29e9, np.pi * 0.09 * 3.33e-6  # of the quick scene; PULL is pi R w
APPROACH = (PULL**2 / (RADIUS * (4 / 3 * MODULUS) ** 2)) ** (1 / 3)  # the unit of approach
DIMENSIONS = {
    "integral": ("model_law", "separation_index"),
    "fit": ("model_law", "coefficient"),
    "replicas": ("model_law", "replica"),
}


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> tuple[Path, str]:
    """The file, and what the program printed."""
    folder = tmp_path_factory.mktemp("compare")
    assert PROGRAM.is_file(), f"no program {PROGRAM}: run `cargo build --release` or set STICTION"
    command = [PROGRAM, "compare", ROOT / "tests" / "data" / "quick.toml", "--laws", ",".join(LAWS), "--ensemble",
               "--replicas", str(REPLICAS), "-o", folder / "all.h5"]
    run = subprocess.run(command, capture_output=True, text=True, encoding="utf-8")
    assert run.returncode == 0, run.stderr
    assert [file.name for file in folder.iterdir()] == ["all.h5"]
    return folder / "all.h5", run.stdout


@pytest.fixture(scope="module")
def path(made) -> Path:
    return made[0]


@pytest.fixture(scope="module")
def file(path):
    with h5py.File(path, "r") as file:
        yield file


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_sees_laws_by_number(path, engine):
    with xarray.open_datatree(path, engine=engine) as tree:
        for group, dimensions in DIMENSIONS.items():
            law = tree[group].model_law
            names = dict(one.split(" ") for one in law.attrs["long_name"].partition(": ")[2].split(", "))
            assert [names[f"{number:g}"] for number in law.values] == LAWS
            for name, variable in tree[group].data_vars.items():
                assert variable.attrs["units"] and variable.attrs["long_name"], name
                assert variable.dims[0] == "model_law", name
            assert any(variable.dims == dimensions for variable in tree[group].data_vars.values())
        lowest = dict(zip(LAWS, tree["integral"].external_force.min("separation_index").values))
        assert lowest["hybrid"] < 0.0 < lowest["gw"]
        assert tree["integral"].regime_count.dims == ("model_law", "regime", "separation_index")


def test_root_attributes(file):
    assert file.attrs["format"] == "stiction-sweep" and list(file.attrs["format_version"]) == documented_version("sweep-format.md")
    assert file.attrs["sweep_keys"] == "model.law" and file.attrs["points"] == len(LAWS)
    assert file.attrs["replicas"] == REPLICAS and np.all(file["replicas/asperity_count"][()] == 739)


def test_differences_are_from_the_first_law(file):
    pull_off = file["replicas/pull_off_force"][()]
    difference = pull_off - pull_off[0]
    assert np.allclose(file["differences/pull_off_force_mean"], difference.mean(axis=1), rtol=1e-12, atol=0)
    error = difference.std(axis=1, ddof=1) / np.sqrt(REPLICAS)
    found = file["differences/pull_off_force_standard_error"]
    # Against itself all replicas agree: no error is known.
    assert np.isnan(found[0]) and np.allclose(found[1:], error[1:], rtol=1e-10, atol=1e-20)
    # Paired on the same asperities: far more precise than the laws themselves.
    assert error[LAWS.index("fit:paper")] < 0.5 * pull_off[0].std(ddof=1) / np.sqrt(REPLICAS)


def test_regimes_add_up(file):
    counts = file["integral/regime_count"][()].sum(axis=1)
    assert np.allclose(counts, 739, rtol=1e-12)
    adhesion = file["integral/regime_adhesion_force"][()].sum(axis=1)
    assert np.allclose(adhesion, file["integral/adhesion_force"], rtol=1e-12, atol=0)


def test_gw_is_the_integral_of_hertz_contacts(file):
    index = LAWS.index("gw")
    std, d = file["asperity_height_std"][index], file["integral/asperity_separation"][index]
    unit = 4 / 3 * MODULUS * np.sqrt(RADIUS) * std**1.5
    found = file["integral/contact_force"][index]
    for k in range(0, d.size, 15):
        h = d[k] / std
        density = lambda s: (s - h) ** 1.5 * np.exp(-0.5 * s * s) / np.sqrt(2 * np.pi)
        expected, error = scipy.integrate.quad(density, h, max(h, 0.0) + 12.0, points=[h + 0.3, max(h + 1, 0)], epsabs=0, epsrel=1e-11)
        assert found[k] == pytest.approx(739 * unit * expected, rel=1e-9)


def isbl(delta, thickness, critical, k):
    """F_s and P of one asperity in N at interferences in m, by equation B.2 and the fits of Kogut and Etsion as published."""
    spacing, x = 0.2e-9, np.maximum(delta, 1e-300) / critical
    u = spacing / np.maximum(spacing - delta - thickness, spacing)
    before = 8 / 3 * PULL * (u**2 - u**8 / 4)
    ratio, unit = spacing / critical, 4 / 3 * MODULUS * np.sqrt(RADIUS) * critical**1.5
    pieces = [delta < -thickness, delta < 0, x <= 1, x <= 6, x <= 110]
    adhesion = [before, 2 * PULL + 0 * x, 2 * PULL * 0.98 * x**0.298 * ratio**-0.29,
                2 * PULL * 0.79 * x**0.356 * ratio**-0.321, 2 * PULL * 1.19 * x**0.093 * ratio**-0.332]
    load = [0 * x, 0 * x, unit * x**1.5, unit * 1.03 * x**1.425, unit * 1.40 * x**1.263]
    return np.select(pieces, adhesion, 0.0), np.select(pieces, load, unit * 3 * x / k)


def summed(file, index, k, low, high, forces, order=1):
    """Sums over the asperities of forces at interferences from low to high, m, by the law and at the separation of these indices.

    The nodes are those of Gauss and Legendre in the root of this order.
    """
    std, d = file["asperity_height_std"][index], file["integral/asperity_separation"][index, k]
    low, high = (np.clip(end, -12 * std - d, 12 * std - d) for end in (low, high))
    nodes, weights = np.polynomial.legendre.leggauss(200)
    share = 0.5 * (nodes + 1)
    t = low + (high - low) * share**order
    jacobian = (high - low) * order * share ** (order - 1) * 0.5
    inside = np.clip(t, np.nextafter(low, high), np.nextafter(high, low))
    density = np.exp(-0.5 * ((t + d) / std) ** 2) / (np.sqrt(2 * np.pi) * std)
    return 739 * (weights * jacobian * density * forces(inside)).sum(axis=-1)


def test_isbl_is_its_published_integral(file):
    """Each smooth piece by itself; the one that begins with x^0.298 in the tenth root of x."""
    index = LAWS.index("isbl")
    critical = file["critical_interference"][index]
    ends = [-60e-9, -0.5e-9, 0.0, critical, 6 * critical, 110 * critical]
    forces = lambda delta: np.array(isbl(delta, 0.5e-9, critical, 0.454 + 0.41 * 0.27))
    for k in range(0, file["integral/separation"].shape[1], 15):
        sums = sum(summed(file, index, k, low, high, forces, 10 if low == 0.0 else 1) for low, high in zip(ends, ends[1:]))
        found = [file[f"integral/{name}"][index, k] for name in ["adhesion_force", "contact_force"]]
        assert found[0] == pytest.approx(sums[0], rel=1e-10)
        assert found[1] == pytest.approx(sums[1], rel=1e-10, abs=1e-300)


def fitted(p, delta):
    """f_snc, f_sel and f_f of the coefficients in nm and uN, as published."""
    sonc, a_nc, b_nc, onc, soc, a_c, b_c, p_c, f0, a_f, b_f, m_f, n_f = p
    f_snc = sonc + 2 * a_nc / np.pi * b_nc / (4 * (delta - onc) ** 2 + b_nc**2)
    f_sel = soc + np.maximum(a_c * delta + b_c, 0.0) ** p_c
    positive = np.maximum(delta, 0.0)
    return f_snc, f_sel, f0 + a_f * positive**m_f + b_f * positive**n_f


def test_fits_are_their_coefficients(file):
    """The integral's sums of the regimes that the fits are for. Before interference 0 an elastic asperity has no contact force."""
    index, thickness = LAWS.index("fit:paper"), 0.5e-9
    coefficients, ranges = file["fit/coefficients"][index], file["fit/range"][index]
    f_snc, f_sel, f_f = (lambda delta, i=i: 1e-6 * fitted(coefficients, 1e9 * delta)[i] for i in range(3))
    regimes = list(file["integral/regime"].asstr())
    kink = -1e-9 * coefficients[6] / coefficients[5]  # where f_sel begins to rise as a power

    def pulled(k, end):
        return summed(file, index, k, ranges[1, 0], kink, f_sel) + summed(file, index, k, kink, end, f_sel, order=10)

    for k in range(0, file["integral/separation"].shape[1], 15):
        adhesion, external = (
            dict(zip(regimes, file[f"integral/regime_{name}_force"][index, :, k])) for name in ["adhesion", "external"]
        )
        before = summed(file, index, k, -60e-9, ranges[0, 1] - thickness, lambda delta: f_snc(delta + thickness))
        assert adhesion["noncontact"] == pytest.approx(before, rel=1e-10)
        elastic = pulled(k, ranges[1, 1])
        assert adhesion["elastic"] == pytest.approx(elastic, rel=1e-10)
        pressed = summed(file, index, k, *ranges[2], f_f, order=10)
        assert external["elastic"] == pytest.approx(pressed - pulled(k, 0.0), rel=0, abs=1e-10 * elastic)


def solve(file, folder, delta, path="approach"):
    """Adhesion force and external force in uN of single dry asperities at delta in nm, by `stiction asperity`."""
    lam, scaled = file["adhesion_parameter"][0], delta * 1e-9 / APPROACH
    table = folder / "table.csv"
    table.write_text("lambda,delta\n" + "".join(f"{lam:.17g},{x:.17g}\n" for x in scaled))
    command = [PROGRAM, "asperity", "--law", "emd", "--table", table, "--path", path]
    run = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=True)
    rows = [line.split(",") for line in run.stdout.splitlines()[1:]]
    return np.array([[float(row[3]), float(row[4])] for row in rows]).T * PULL * 1e6


def test_residuals_are_those_against_single_asperities(file, tmp_path):
    index = LAWS.index("fit:paper")
    ranges, coefficients = file["fit/range"][index] * 1e9, file["fit/coefficients"][index]
    for i in range(3):
        inwards = 1e-9 * np.diff(ranges[i])[0]  # contact begins at the end of the first range
        delta = np.linspace(ranges[i, 0] + inwards * (i > 0), ranges[i, 1] - inwards, 2001)
        adhesion, external = solve(file, tmp_path, delta)
        residuals = fitted(coefficients, delta)[i] - (external if i == 2 else adhesion)
        unit = 1e6 * file["fit/largest_force"][index, i]
        assert np.abs(external if i == 2 else adhesion).max() == pytest.approx(unit, rel=1e-4)
        for name, value in [("largest", np.abs(residuals).max()), ("rms", np.sqrt(np.mean(residuals**2)))]:
            assert file[f"fit/{name}_residual"][index, i] * 1e6 == pytest.approx(value, rel=1e-2, abs=1e-6 * unit)


def test_laws_without_a_fit_have_no_coefficients(file):
    assert np.all(np.isnan(file["fit/coefficients"][0])) and np.all(np.isnan(file["fit/range"][1]))


def test_validity_is_said(file, made):
    warnings = file.attrs["warnings"].splitlines()
    assert "lambda = 0.899 is above 0.1 (at model.law = isbl)" in warnings
    assert "psi of sigma_s = 0.793 is above 0.6 (at model.law = gw)" in warnings
    printed = made[1].partition("not valid here")[2].partition("warning")[0].split("  ")
    notes = [" ".join(text.split()) for text in printed if text.strip()]
    of = {law: notes[notes.index(law) + 1 :] for law in LAWS if law in notes}
    assert "hybrid" not in of and of["isbl"][0].startswith("lambda = 0.899 is above 0.1")
    assert of["fit:paper"][0] == "f_snc is off by up to 33.74 % of its largest"
    assert any(note.startswith("psi of sigma_s = 0.793 is above 0.6") for note in of["gw"]) and any("no lubricant" in note for note in of["gw"])
