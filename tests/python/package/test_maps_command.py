"""`stiction asperities`: the file that scenes read, the summary, the picture, and what is refused."""

import html
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from conftest import CONFIGS, ROOT

import stiction
import stiction.report
from stiction.maps.layout import VARIABLES
from stiction.program import call

MAP = CONFIGS / "maps" / "polished.txt"
UNITS = ("--pixel", "30 nm", "--height-unit", "nm")


def unbroken(text):
    return " ".join(text.split())


def heights():
    """The shipped map, nm."""
    return np.loadtxt(MAP)


def values(path):
    """Every dataset of a file by its path."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, one: found.update({name: one[()]}) if isinstance(one, h5py.Dataset) else None)
    return found


def test_the_file_is_the_one_that_the_program_is_tested_with(tmp_path):
    """tests/data/polished.h5, which the tests of the program read: equal datasets, attributes, chunks and
    values."""
    stiction.find_asperities(MAP, tmp_path / "map.h5").close()
    with h5py.File(tmp_path / "map.h5") as own, h5py.File(ROOT / "tests" / "data" / "polished.h5") as given:
        names = []
        given.visit(names.append)
        assert set(own.attrs) == set(given.attrs)
        for name in set(given.attrs) - {"created", "map_source", "program_version"}:
            one, other = own.attrs[name], given.attrs[name]
            assert one == other if isinstance(other, str) else one == pytest.approx(other, rel=1e-12), name
        for name in names:
            one, other = own[name], given[name]
            if isinstance(other, h5py.Group):
                continue
            for of in ("dtype", "chunks", "fletcher32", "shuffle", "compression", "compression_opts"):
                assert getattr(one, of) == getattr(other, of), (name, of)
            assert {key: one.attrs[key] for key in ("units", "long_name")} == {
                key: other.attrs[key] for key in ("units", "long_name")
            }
            # Heights are differences: of these the largest counts.
            scale = (np.nanmax(np.abs(other[()])) if name.endswith(("height", "curvature_xy", "skewness")) else 0.0)
            np.testing.assert_allclose(one[()], other[()], rtol=1e-12, atol=1e-12 * scale, err_msg=name)


def test_the_program_reads_what_the_package_writes(tmp_path, monkeypatch):
    """Every part of the file: `validate` reads all of it, and it has each name of the page with its units."""
    steps = {"level_rows": "median", "smooth": "200 nm", "prominence": "0.2 nm", "min_distance": "90 nm", "cutoffs": 4}
    with stiction.find_asperities(MAP, tmp_path / "map.h5", **steps) as found:
        assert found.attrs["level_rows"] == "median" and found.attrs["min_distance"] == pytest.approx(90e-9)
    said = call(["validate", str(tmp_path / "map.h5")])
    assert "asperities of a measured surface" in said and "whole: all of it was read" in said
    assert set(values(tmp_path / "map.h5")) == set(VARIABLES)
    page = (ROOT / "docs" / "asperity-file.md").read_text(encoding="utf-8")
    rows = {}
    for group in re.findall(r"<!-- schema: asperities (\w+) -->(.*?)<!-- end -->", page, flags=re.DOTALL):
        for row in re.findall(r"^\| `(\w+)` \| (.*?) \| (\S+) \| (.*) \|$", group[1], flags=re.MULTILINE):
            rows[f"{group[0]}/{row[0]}"] = row[1:]
    assert rows.keys() == VARIABLES.keys()
    for name, (dimensions, units, meaning) in rows.items():
        own = VARIABLES[name]
        assert (own.units, own.long_name) == (units, meaning), name
        assert own.dimensions in (tuple(re.findall(r"`(\w+)`", dimensions)), ()), name


def test_kinds_of_files_give_one_result(command):
    """Whatever the kind of file, one map has one result."""
    np.save("map.npy", heights())
    with h5py.File("map.h5", "w") as file:
        for name in ("forward", "backward"):
            file[f"scan/{name}"] = heights()
    summary = command(MAP, "-o", "text.h5")
    for part in ("pixels", "levelled", "alpha", "of summits", "of moments", "density", "eta R sigma_s", "text.h5"):
        assert part in summary
    command("map.npy", *UNITS, "-o", "npy.h5")
    command("map.h5", "--channel", "scan/forward", "--pixel", "0.03 um,30 nm", "--height-unit", "nm", "-o", "hdf5.h5")
    expected = values("text.h5")
    for name in ("npy.h5", "hdf5.h5"):
        own = values(name)
        assert own.keys() == expected.keys()
        for path, one in own.items():
            np.testing.assert_array_equal(one, expected[path], err_msg=f"{name} {path}")
    with h5py.File("hdf5.h5") as file:
        assert "scan/forward" in file.attrs["map_source"] and file.attrs["map"] == "map.h5"


def test_without_an_output_nothing_is_written(command):
    assert "written" not in command(MAP, "--level", "quadratic")
    assert os.listdir() == []


def test_missing_heights_are_left_out(command):
    """A missing height is left out with its surroundings, and said."""
    z = heights()
    z.ravel()[::41] = np.nan
    np.save("map.npy", z)
    assert "warning           2.4 % of the heights are missing" in command("map.npy", *UNITS, "-o", "map.h5")
    command(MAP, "-o", "whole.h5")
    with h5py.File("map.h5") as part, h5py.File("whole.h5") as whole:
        assert "2.4 % of the heights are missing" in part.attrs["warnings"]
        # A missing pixel takes 9 with it.
        assert part.attrs["nominal_area"] / whole.attrs["nominal_area"] == pytest.approx(1 - 9 / 41, abs=0.01)
        # Of 213 summits about 170 are left: the density changes by no more than 5 standard errors of what is
        # lost.
        density = [float(file["measured/asperity_density"][()]) for file in (part, whole)]
        assert density[0] / density[1] == pytest.approx(1.0, abs=5 * (0.22 / 0.78 / 213) ** 0.5)


def test_a_single_summit_has_no_scatter_of_heights(command):
    y, x = np.mgrid[-4:5, -4:5]
    np.save("map.npy", 5.0 - (x**2 + y**2) / 4.0)
    said = unbroken(command("map.npy", "--pixel", "10 nm", "--height-unit", "nm", "--level", "none"))
    assert "mean radius 200.0 nm" in said and "eta R sigma_s – " in said


@pytest.mark.parametrize("level", ["none", "plane"])
def test_the_file_has_the_map_that_was_searched(level, command):
    """The heights that were given less their mean or their plane, NaN where they are missing; asperities on
    their pixels."""
    z = heights()[:-3]
    z[0, 5], z[7, 9] = np.nan, np.nan
    np.savetxt("map.txt", z)
    command("map.txt", "--pixel", "30 nm,20 nm", "--height-unit", "nm", "-o", "map.h5", "--level", level)
    rows, columns = np.indices(z.shape)
    basis = np.stack([np.ones(z.size), rows.ravel(), columns.ravel()][: 1 if level == "none" else 3], axis=1)
    known = ~np.isnan(z.ravel())
    fit = np.linalg.lstsq(basis[known], z.ravel()[known], rcond=None)[0]
    with h5py.File("map.h5") as file:
        assert file.attrs["height_unit"] == "nm" and file.attrs["missing_pixels"] == 2
        np.testing.assert_allclose(file["map/height"], 1e-9 * (z - (basis @ fit).reshape(z.shape)), rtol=0, atol=1e-21)
        np.testing.assert_allclose(file["map/x"], (np.arange(z.shape[1]) + 0.5) * 30e-9, rtol=1e-12)
        np.testing.assert_allclose(file["map/y"], (np.arange(z.shape[0]) + 0.5) * 20e-9, rtol=1e-12)
        places = [(file[f"asperities/{name}"][()] / size).astype(int) for name, size in (("y", 20e-9), ("x", 30e-9))]
        np.testing.assert_array_equal(file["map/height"][()][tuple(places)], file["asperities/height"])


def test_a_smoothed_map_is_reported_as_such(command):
    """What the options do to the file and the summary: the border that is left out, the prominence of each,
    and the series, whose row at the cut-off of the map is what is measured on it."""
    said = command(MAP, "-o", "map.h5", "--smooth", "0.2 um", "--prominence", "300 pm", "--cutoffs", "5")
    for part in (
        "smoothed Gaussian, cut-off 200.0 nm; 4 x 4 pixels",
        "prominent by 300.0 pm or more",
        "k1/k2 = ",
        "200.0 nm *",
    ):
        assert part in unbroken(said)
    with h5py.File("map.h5") as file:
        assert file.attrs["border"].tolist() == [4, 4]
        assert file.attrs["nominal_area"] == pytest.approx((184 * 30e-9) ** 2, rel=1e-12)
        assert file["asperities/prominence"][()].min() >= 3e-10 and file["asperities/height"].size > 20
        cutoffs = file["cutoffs/cutoff"][()]
        assert (cutoffs.size == 6 and cutoffs[0] == 60e-9 and cutoffs[-1] == pytest.approx(48 * 30e-9, rel=1e-12))
        place = cutoffs.tolist().index(2e-7)
        for name in ("asperity_density", "asperity_radius", "asperity_height_std", "asperity_curvature_std"):
            assert file[f"cutoffs/{name}"][place] == file[f"measured/{name}"][()]
    said = command(MAP, "-o", "map.h5", "--force")
    assert not any(word in said for word in ("smoothed", "prominent", "cut-off", "rows levelled"))
    with h5py.File("map.h5") as file:
        assert ("cutoffs" not in file and "prominence" not in file["asperities"] and file.attrs["smooth"] == 0.0)


def test_rows_are_levelled_before_the_plane(command):
    """Offsets of rows make false summits and are warned of; levelled, the summits are the ones of the map
    before them, less the medians of its rows above the plane, and the warning is gone."""
    z = heights()
    rows, columns = np.indices(z.shape)
    terms = np.stack([np.ones(z.size), rows.ravel(), columns.ravel()], axis=1)
    plane = (terms @ np.linalg.lstsq(terms, z.ravel(), rcond=None)[0]).reshape(z.shape)
    np.save("map.npy", z + np.random.default_rng(1).normal(scale=2.0, size=(z.shape[0], 1)))
    np.save("levelled.npy", z - np.median(z - plane, axis=1, keepdims=True))
    assert "rows are offset against each other" in unbroken(command("map.npy", *UNITS, "-o", "offset.h5"))
    said = command("map.npy", *UNITS, "--level-rows", "median", "-o", "rows.h5")
    assert "rows levelled     less the median of each row" in said and "offset" not in said
    command("levelled.npy", *UNITS, "-o", "expected.h5")
    own, expected = values("rows.h5"), values("expected.h5")
    np.testing.assert_array_equal(own["asperities/x"], expected["asperities/x"])
    np.testing.assert_allclose(own["asperities/height"], expected["asperities/height"], rtol=0, atol=1e-20)
    assert values("offset.h5")["asperities/x"].size != own["asperities/x"].size


def test_summits_that_are_apart_in_the_file(command):
    said = command(MAP, "-o", "map.h5", "--min-distance", "0.3 um")
    assert "300.0 nm or more from a higher one" in unbroken(said)
    with h5py.File("map.h5") as file:
        places = np.column_stack([file["asperities/x"], file["asperities/y"]])
        distance = np.hypot(*(places[:, None] - places).T)
        assert distance[distance > 0.0].min() >= 0.3e-6 * (1 - 1e-6) and 20 < len(places) < 213


def test_a_picture_has_the_map_after_each_step(command):
    """As measured, rows levelled, levelled, smoothed and prominent: five panels with the numbers of their
    summits."""
    steps = ("--level-rows", "differences", "--smooth", "200 nm", "--prominence", "1 nm")
    command(MAP, *steps, "--figure", "steps.svg", "-o", "map.h5")
    picture = Path("steps.svg").read_text(encoding="utf-8")
    with h5py.File("map.h5") as file:
        count = file["asperities/height"].size
    titles = re.findall(r">\s*([\w ]+: \d+ summits)\s*<", picture)
    assert [title.split(":")[0] for title in titles] == ["as measured", "rows levelled", "levelled", "smoothed", "prominent"]
    assert titles[-1] == f"prominent: {count} summits" and titles[0] == "as measured: 206 summits"
    before = os.listdir()
    assert "figure" in command(MAP, "--figure", "steps.tiff", code=2)
    assert "steps.svg: exists" in command(MAP, "--figure", "steps.svg", code=2)
    assert os.listdir() == before


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (
            ("--smooth", "59 nm"),
            "--smooth 59.00 nm is below two pixels, which is the shortest wave of the map; "
            "give 60.00 nm or more",
        ),
        (("--smooth", "2.9 um"), "--smooth 2.900 µm is above half the shorter side of the map; give 2.880 µm or less"),
        (("--smooth", "-1 nm"), "a cut-off wavelength is above 0"),
        (("--smooth", "200"), 'such as "10 nm"'),
        (("--prominence", "1 um"), "--prominence 1.000 µm: no summit has that; the most prominent one has "),
        (("--prominence", "-1 nm"), "a prominence is between 0 and 1e6 m"),
        (("--prominence", "much"), "a length with its unit is needed"),
        (("--min-distance", "0 nm"), "a distance is above 0"),
        (("--cutoffs", "1"), "--cutoffs 1: a number from 2 to 100 is needed"),
        (("--level", "cubic"), "known: none, plane, quadratic"),
        (("--level-rows", "mean"), "known: median, differences"),
        (("--pixel", "1"), "a length with its unit is needed"),
    ],
)
def test_options_that_are_not_possible_are_refused(arguments, part, command):
    assert part in command(MAP, "-o", "out.h5", *arguments, code=2)
    assert os.listdir() == []


def test_maps_that_are_none_are_refused(command):
    """In a line that names the map; nothing is written."""
    row = "\t".join(["1.5"] * 10) + "\n"
    slope = "".join("\t".join([str(i * i)] * 10) + "\n" for i in range(10))
    few = "".join(f"0 {i} 3 0 {i % 3} 2 5 1\n" for i in range(8))
    maps = {"flat": row * 10, "small": row * 5, "slope": slope, "few": few}
    for name, text in maps.items():
        Path(f"{name}.txt").write_text(text, encoding="utf-8")
    np.save("line.npy", np.where(np.arange(10) == 4, 1.0, np.full((10, 10), np.nan)))
    before = sorted(os.listdir())
    units = ("--pixel", "1 nm", "--height-unit", "nm", "-o", "out.h5")
    parts = {"flat.txt": "the levelled map is flat", "small.txt": "5 rows and 10 columns; at least 8",
             "slope.txt": "no summit", "line.npy": "10 of 100 heights are known"}  # fmt: skip
    for name, part in parts.items():
        assert f"{name}: " in (said := command(name, *units, code=2)) and part in said
    assert "--cutoffs 3: there is no room" in command("few.txt", *units, "--cutoffs", "3", code=2)
    assert sorted(os.listdir()) == before


def test_an_existing_output_is_kept_unless_forced(command):
    Path("out.h5").write_text("kept", encoding="utf-8")
    assert "out.h5: exists; --force overwrites it" in command(MAP, "-o", "out.h5", code=2)
    assert Path("out.h5").read_text(encoding="utf-8") == "kept"
    command(MAP, "-o", "out.h5", "--force")
    assert values("out.h5")["asperities/height"].size == 213
    np.save("map.npy", heights())
    before = Path("map.npy").read_bytes()
    assert "is an input" in command("map.npy", *UNITS, "-o", "map.npy", "--force", code=2)
    assert Path("map.npy").read_bytes() == before


@pytest.mark.parametrize(
    ("change", "part"),
    [
        (lambda z: z[::3, ::3], "pixels are too coarse for the summits"),
        (lambda z: z[:50, :50], "few summits"),
        (lambda z: np.round(z / 0.5) * 0.5, "of neighbouring pixels are equally high"),
        (lambda z: z + 3.0 * np.sin(0.4 * np.arange(z.shape[1])), "mean square slopes along x and y differ"),
        (lambda z: z**3, "heights are far from Gaussian"),
        (lambda z: z[np.maximum.accumulate(np.where(np.arange(len(z)) % 50 < 2, -1, np.arange(len(z))))],
         "repeat the one before"),
    ],
)  # fmt: skip
def test_what_the_map_does_not_show_is_warned_of(change, part, command):
    np.save("map.npy", np.ascontiguousarray(change(heights())))
    assert part in unbroken(command("map.npy", "--pixel", "10 nm", "--height-unit", "nm"))


def test_maps_in_a_wrong_unit_are_warned_of(command):
    """Nanometres as metres and the other way round, with the factor that would do; the shipped map has no
    warning."""
    assert "warning" not in command(MAP)
    np.save("map.npy", heights())
    np.save("metres.npy", 1e-9 * heights())
    said = unbroken(command("map.npy", "--pixel", "30 nm", "--height-unit", "m"))
    assert (
        "slopes are 7.9e+06 on average, as on no surface" in said
        and "1e-9 times as high they would be 7.9e-03" in said
    )
    said = unbroken(command("metres.npy", "--pixel", "30 nm", "--height-unit", "nm"))
    assert "slopes are 7.9e-12 on average" in said and "1e9 times as high they would be 7.9e-03" in said


def test_a_result_shows_its_summits_and_names_the_moments(command):
    """print(find_asperities(...)) has density, radius and heights as the command has them, of summits and by
    moments."""
    found = stiction.find_asperities(MAP)
    shown, said = str(found), command(MAP)
    for label, group in (("density", "density"), ("1/mean curvature", "radius"), ("height std", "height_std")):
        line = next(line for line in shown.splitlines() if line.strip().startswith(label))
        own = re.match(rf"\s*{re.escape(label)}\s+([\d.]+).* of the summits, ([\d.]+).* by moments$", line)
        theirs = re.search(rf"^  {re.escape(label)}\s+([\d.]+) \S+\s+([\d.]+) ", said, flags=re.MULTILINE)
        assert [float(own[i]) for i in (1, 2)] == pytest.approx([float(theirs[i]) for i in (1, 2)], rel=1e-3), label
        factor = {"density": 1e-12, "radius": 1e6, "height_std": 1e9}[group]
        of = [float(found.tree[one][f"asperity_{group}"]) * factor for one in ("measured", "equivalent")]
        assert [float(own[i]) for i in (1, 2)] == pytest.approx(of, rel=1e-3), label


def test_large_maps_take_seconds_and_a_dozen_of_their_size():
    """1024 x 1024 pixels: time of the processor, and memory that is allocated, over 8 bytes of a pixel."""
    script = """
import time, tracemalloc, numpy as np
from stiction.maps.surface import Steps, found_on
from stiction.maps.reading import HeightMap
z = 1e-9 * np.random.default_rng(0).normal(size=(1024, 1024))
of = HeightMap(z, (1e-8, 1e-8), "map", "array"), Steps(level_rows="median", smooth=8e-8, prominence=1e-11)
found_on(HeightMap(z[:64, :64], (1e-8, 1e-8), "map", "array"), Steps())
start = time.process_time()
found_on(*of)
took = time.process_time() - start
tracemalloc.start()
found_on(*of)
print(took, tracemalloc.get_traced_memory()[1] / z.nbytes)
"""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, env=environment)
    took, memory = map(float, done.stdout.split())
    assert took < 2.0 and memory < 11.0, done.stdout


def test_the_page_of_a_result_has_the_command_that_makes_it(command):
    """With every step: what `stiction report` has to paste makes the asperities again."""
    Path("scan.txt").write_bytes(MAP.read_bytes())
    steps = {"level_rows": "median", "smooth": "0.15 um", "prominence": "0.1 nm", "min_distance": "0.2 um"}
    found = stiction.find_asperities("scan.txt", "scan.h5", level="quadratic", cutoffs=3, **steps)
    (pasted,) = re.findall(r"<pre>stiction asperities (.*?)</pre>", stiction.report.page([found]), re.DOTALL)
    before = values("scan.h5")
    found.close()
    os.remove("scan.h5")
    command(*shlex.split(html.unescape(pasted)))
    again = values("scan.h5")
    assert again.keys() == before.keys()
    for path, one in before.items():
        np.testing.assert_array_equal(again[path], one, err_msg=path)


@pytest.mark.parametrize("radius", ["mean_curvature", "equivalent"])
def test_the_mean_radius_is_that_of_the_scene(radius, command):
    """The program prints it of the file, for both radii that a scene may take."""
    said = command(MAP, "-o", "polished.h5")
    shown = re.search(rf'([\d.]+) µm  R of a run: radius = "{radius}"', said)
    scene = (CONFIGS / "surfaces" / "measured.toml").read_text(encoding="utf-8")
    scene = scene.replace('sample = "bootstrap"', f'sample = "bootstrap", radius = "{radius}"')
    Path("scene.toml").write_text(scene, encoding="utf-8")
    assert f"mean radius {shown[1]} µm" in unbroken(call(["check", "scene.toml"]))


@pytest.mark.parametrize("coding", ["gbk", "ascii", "cp932", "latin-1"])
def test_an_output_without_a_micro_sign_has_another_one(coding, command, monkeypatch):
    """The file is written, and the summary has the numbers that it has in UTF-8."""
    said = command(MAP)
    monkeypatch.setenv("PYTHONIOENCODING", coding)
    words = [sys.executable, "-m", "stiction.maps", str(MAP), "-o", "out.h5"]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(words, capture_output=True, env=environment)
    assert (done.returncode, done.stderr) == (0, b"") and "µm" in said and Path("out.h5").is_file()
    plain = said if coding == "latin-1" else said.replace("µ", "u")
    assert done.stdout.decode(coding).splitlines()[: len(said.splitlines())] == plain.splitlines()
    done = subprocess.run([*words[:3], "µ-σ-Ж.txt"], capture_output=True, env=environment)
    assert done.returncode == 2 and b"Traceback" not in done.stderr and done.stderr.count(b"\n") == 1
