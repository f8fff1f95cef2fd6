"""Damaged and odd results end in one clear line and exit code 2, or are drawn; other files are not shown."""

import csv
import math
import os
import random
import time
import zlib

import damages
import h5py
import numpy as np
import pytest
from matplotlib import pyplot

import stiction
from stiction import FileError
from stiction.plot.command import main as plot
from stiction.program import call
from stiction.report.command import main as report

KINDS = ["run", "loop", "coupled", "sweep", "comparison", "alone", "asperities"]
# How many damages of each kind of file are tried: 2, or STICTION_DAMAGES of them, or "all".
GIVEN = os.environ.get("STICTION_DAMAGES", "2")
COUNT = math.inf if GIVEN == "all" else int(GIVEN)
# Of a processor; reading and drawing whole results takes one to two.
SECONDS = 12.0
SECRET = 123456.789


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with files that damaged results lead to."""
    np.full(100_000, SECRET).tofile(tmp_path / "secret")
    with h5py.File(tmp_path / "secret.h5", "w") as file:
        file["secret"] = np.full(100_000, SECRET)
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    pyplot.close("all")


def damaged(source, folder, kind, way, where):
    copy = folder / f"{source.stem}_{zlib.crc32(repr((way, where)).encode())}.h5"
    copy.write_bytes(source.read_bytes())
    with h5py.File(copy, "r+") as file:
        damages.ways(kind)[way](file, *where)
    return copy


def said(main, file, output, capsys):
    """The exit code and the line of a command, which is read by people."""
    before = time.process_time()
    code = main([str(file), "-o", str(output)])
    assert time.process_time() - before < SECONDS
    # Progress comes after two seconds, of a slow machine too.
    line = "".join(line for line in capsys.readouterr().err.splitlines(keepends=True) if " so far" not in line)
    if code == 0:
        assert line == "" and output.exists()
    else:
        assert code == 2 and line.count("\n") == 1 and line[:-1].isprintable(), (code, line)
        assert line.startswith(("stiction plot: ", "stiction report: ")) and str(file) in line
        assert not output.exists()
    return code, line


QUICK = ["run", "comparison", "alone", "asperities"]


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name not in QUICK)) for name in KINDS])
def test_every_damage_ends_in_a_line_or_a_figure(result, name, folder, capsys):
    source = result(name).path
    cases = damages.cases(source)
    chosen = random.Random(7).sample(cases, min(COUNT, len(cases)))
    for number, (kind, way, where) in enumerate(chosen):
        file = damaged(source, folder, kind, way, where)
        codes = [
            said(main, file, folder / f"{number}{ending}", capsys)[0]
            for main, ending in ((plot, ".svg"), (report, ".html"))
        ]
        if kind in (damages.Elsewhere, damages.Circles):
            assert codes == [2, 2], (way, where)
        for output in folder.glob(f"{number}.*"):
            assert f"{SECRET:.6g}" not in output.read_text(encoding="utf-8")
            output.unlink()
        file.unlink()


H_STAR = "ensemble/h_star"
ELSEWHERE = "whose values are in other files, which are not read"


@pytest.mark.parametrize(
    "kind, way, where, message",
    [
        (damages.OfDatasets, "missing", H_STAR, "is damaged or not whole: something is missing"),
        (damages.OfDatasets, "compound", "ensemble/scalar", "/ensemble/scalar that holds neither numbers nor texts"),
        (damages.OfDatasets, "without_values", H_STAR, "has a dataset /ensemble/h_star without values"),
        (damages.OfDatasets, "a_type", H_STAR, "has /ensemble/h_star, which is neither a group nor a dataset"),
        (damages.OfDatasets, "a_sea_of_zeros", H_STAR, "/ensemble/h_star that has more values than the file holds"),
        (damages.Elsewhere, "soft_loop", H_STAR, "has a link /ensemble/h_star to elsewhere, which is not followed"),
        (damages.Elsewhere, "external_link", H_STAR, "has a link /ensemble/h_star to elsewhere"),
        (damages.Elsewhere, "external_storage", H_STAR, ELSEWHERE),
        (damages.Elsewhere, "virtual", H_STAR, ELSEWHERE),
        (damages.Circles, "in_itself", "ensemble", "has the group /ensemble/again twice"),
        (damages.Circles, "in_the_root", "ensemble", "has the group /ensemble/root twice"),
        (damages.OfGroups, "missing", "integral", "lacks the group /integral"),
    ],
)
def test_the_line_says_what_is_wrong(result, kind, way, where, message, folder, capsys):
    file = damaged(result("run").path, folder, kind, way, (where,))
    for main, ending in ((plot, ".png"), (report, ".html")):
        code, line = said(main, file, folder / f"a{ending}", capsys)
        assert code == 2 and message in line
    if kind in (damages.Elsewhere, damages.Circles):
        with pytest.raises(FileError, match=r"elsewhere|other files|twice"):
            stiction.open_run(file)


def test_what_xarray_has_copied_is_read(result, folder):
    with stiction.open_run(result("run").path) as run:
        run.tree.load()
        run.tree.to_netcdf(folder / "copy.h5", engine="h5netcdf")
        with stiction.open_run(folder / "copy.h5") as copy:
            assert copy.pull_off == run.pull_off


def test_a_file_of_many_groups_is_refused_soon(result, folder, capsys):
    file = folder / "many.h5"
    file.write_bytes(result("run").path.read_bytes())
    with h5py.File(file, "r+") as opened:
        for number in range(3000):
            opened.create_group(f"many/{number}")
    code, line = said(plot, file, folder / "a.png", capsys)
    assert code == 2 and "more than 1000 groups and datasets" in line


@pytest.mark.slow
def test_names_with_dollars_are_no_formulas(result, folder, capsys):
    odd = "$\\frac{$_\n\x1b[2J"
    for name in ("comparison", "run"):
        file = folder / f"{name}.h5"
        file.write_bytes(result(name).path.read_bytes())
        with h5py.File(file, "r+") as opened:
            for where in opened:
                if f"{where}/regime" in opened:
                    opened[f"{where}/regime"][...] = [f"{odd}{i}" for i in range(opened[f"{where}/regime"].size)]
            for law in [opened[path] for path in ("model_law", *(f"{where}/model_law" for where in opened)) if path in opened]:
                law.attrs["long_name"] = "law: " + ", ".join(f"{i} {odd}{i}" for i in range(19))
            opened.attrs["title"] = opened.attrs["warnings"] = odd
        assert (plot([str(file), "--title"]) == 0 and said(report, file, folder / f"{name}.html", capsys)[0] == 0)
    with h5py.File(result("sweep").path) as opened:
        key = opened.attrs["sweep_keys"].replace(".", "_")
    file = folder / "sweep.h5"
    file.write_bytes(result("sweep").path.read_bytes())
    with h5py.File(file, "r+") as opened:
        opened[key].attrs["units"], opened[key].attrs["long_name"] = odd, f"a {odd}"
    assert said(plot, file, folder / "sweep.svg", capsys)[0] == 0
    assert "a $\\frac{$_" in (folder / "sweep.svg").read_text(encoding="utf-8")


def test_texts_of_the_programs_tables_are_no_formulas(result, folder):
    file = folder / "scalars.h5"
    file.write_bytes(result("run").path.read_bytes())
    with h5py.File(file, "r+") as opened:
        opened["ensemble/scalar"][...] = ["=1+1", "-a", "-1", "b"]
    rows = list(csv.reader(call(["info", "--csv", "--by", "scalar", str(file)]).splitlines()))
    assert [row[0] for row in rows[1:]] == ["'=1+1", "'-a", "-1", "b"]


@pytest.mark.slow
def test_a_file_that_is_read_without_an_end_is_refused(result, folder):
    """A heap of texts with an object of the length 0: libhdf5 does not come back from it, here or in the program."""
    with result("run") as run:
        content = bytearray(run.path.read_bytes())
    heap = content.index(b"GCOL")
    content[heap + 16 : heap + 32] = bytes(16)
    (folder / "endless.h5").write_bytes(content)
    with pytest.raises(FileError, match=r"^endless.h5: is damaged: libhdf5 reads it without an end$"):
        stiction.open_run("endless.h5")
