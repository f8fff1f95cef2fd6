"""`stiction info` and `stiction validate` on HDF5 files of other programs: one line, exit code 2, and soon."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy
import pytest
from program import PROGRAM, ROOT

NOT_OURS = "is not a result of stiction: it has no attribute `format`"


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """A small result."""
    folder = tmp_path_factory.mktemp("result")
    scene = (ROOT / "tests/data/quick.toml").read_text().replace("count = 91", "count = 16").replace("replicas = 200", "replicas = 40")
    (folder / "scene.toml").write_text(scene)
    subprocess.run([PROGRAM, "run", "scene.toml"], cwd=folder, check=True, capture_output=True)
    return folder / "scene.h5"


def forged(result, folder):
    """A copy of the result, open for changes."""
    copy = folder / "forged.h5"
    copy.write_bytes(result.read_bytes())
    return h5py.File(copy, "r+")


def ask(command, file):
    return subprocess.run([PROGRAM, command, str(file)], capture_output=True, timeout=30)


def assert_refused(file, message, commands=("info", "validate")):
    for command in commands:
        answer = ask(command, file)
        error = answer.stderr.decode()
        assert answer.returncode == 2, (command, answer)
        assert message in error and error.count("\n") == 1 and error.startswith("stiction: "), error
        assert answer.stdout == b"" and error[:-1].isprintable(), answer


def assert_read(file, *parts):
    answer = ask("info", file)
    assert answer.returncode == 0 and answer.stderr == b"", answer
    for part in parts:
        assert part in answer.stdout.decode(), part


@pytest.mark.parametrize("libver", ["earliest", "latest"])
@pytest.mark.parametrize("userblock", [0, 512, 4096])
def test_files_of_others(tmp_path, libver, userblock):
    file = tmp_path / "other.h5"
    with h5py.File(file, "w", libver=libver, userblock_size=userblock) as other:
        # As netCDF-4 and pandas leave them, and with the names of ours.
        other.attrs["_NCProperties"] = "version=2,netcdf=4.9.2,hdf5=1.14.3"
        other.attrs["CLASS"] = numpy.bytes_("GROUP")
        rows = numpy.zeros(5, dtype=[("index", "<i8"), ("values", "<f8", (2,)), ("name", "S10")])
        other.create_dataset("table", data=rows)
        other["ensemble"] = numpy.arange(3)
        other.create_group("integral/external_force")
    assert_refused(file, NOT_OURS)


def test_an_empty_file_of_hdf5(tmp_path):
    file = tmp_path / "nothing.h5"
    h5py.File(file, "w").close()
    assert_refused(file, NOT_OURS)


@pytest.mark.parametrize(
    "value, message",
    [
        ("netcdf", 'has the format "netcdf", not "stiction-run"'),
        (numpy.bytes_("stiction-run"), "its attribute `format` is no text"),
        (["stiction-run", "stiction-run"], "its attribute `format` is no text"),
        (numpy.zeros(3), "its attribute `format` is no text"),
        (h5py.Empty("f8"), "its attribute `format` is no text"),
        ("x" * 60_000, "has the format"),
        ("\x1b[2J\n\x9b31m", "\\u{1b}[2J\\u{a}\\u{9b}31m"),
        (b"\xff\xfe\x80", "has the format"),
    ],
)
def test_formats_that_are_none(tmp_path, value, message):
    file = tmp_path / "other.h5"
    with h5py.File(file, "w") as other:
        if isinstance(value, bytes) and not isinstance(value, numpy.bytes_):
            other.attrs.create("format", value, dtype=h5py.string_dtype("utf-8"))
        else:
            other.attrs["format"] = value
    assert_refused(file, message)


@pytest.mark.parametrize(
    "version, message",
    [
        ([4, 0], "has format version 4.0; this program reads 3.x"),
        ([0, 9], "has format version 0.9"),
        ([1], "no attribute `format_version` of two numbers"),
        ([1, 0, 0], "no attribute `format_version` of two numbers"),
        ([1.0, 0.0], "no attribute `format_version` of two numbers"),
        ("1.0", "no attribute `format_version` of two numbers"),
        (numpy.zeros(8000, dtype="u4"), "no attribute `format_version` of two numbers"),
        (h5py.Empty("u4"), "no attribute `format_version` of two numbers"),
    ],
)
def test_versions_that_are_not_read(result, tmp_path, version, message):
    with forged(result, tmp_path) as file:
        file.attrs["format_version"] = version
    assert_refused(tmp_path / "forged.h5", message)


def test_newer_minor_versions_are_read(result, tmp_path):
    with forged(result, tmp_path) as file:
        file.attrs["format_version"] = numpy.array([3, 9], dtype="u8")
        file.attrs["novelty"] = numpy.zeros(2, dtype=[("a", "f8"), ("b", "S3")])
    assert_read(tmp_path / "forged.h5", "3, 9", "novelty")
    assert ask("validate", tmp_path / "forged.h5").returncode == 0


def test_attributes_of_any_kind_and_size_are_shown(result, tmp_path):
    with forged(result, tmp_path) as file:
        file.attrs["texts"] = ["a", "b"]
        file.attrs["raw"] = b"\xff\x1b[31m"
        file.attrs["invalid"] = numpy.array(b"\xff\x1b[31m", dtype=h5py.string_dtype("utf-8"))
        file.attrs["reference"] = file["ensemble"].ref
        file.attrs["complex"] = 1 + 2j
        file.attrs["nothing"] = h5py.Empty("f8")
        file.attrs["bool"] = True
        file.attrs["small"] = numpy.arange(17)
        file.attrs.create(b"\xff\xfename", 1.0)
    with h5py.File(tmp_path / "large.h5", "w", libver="latest") as file:
        source = h5py.File(result)
        for name in source:
            source.copy(name, file)
        for name, value in source.attrs.items():
            file.attrs[name] = value
        file.attrs["huge"] = numpy.zeros(2_000_000)
    answer = ask("info", tmp_path / "forged.h5")
    assert answer.returncode == 0 and b"\x1b" not in answer.stdout
    assert "... (17 numbers)" in answer.stdout.decode()
    assert_read(tmp_path / "large.h5", "... (2000000 numbers)")
    assert ask("validate", tmp_path / "large.h5").returncode == 0


@pytest.mark.parametrize("how", ["soft loop", "external", "dangling", "group", "named type"])
def test_links_and_other_objects_in_place_of_datasets(result, tmp_path, how):
    (tmp_path / "target.h5").write_bytes(result.read_bytes())
    with forged(result, tmp_path) as file:
        del file["ensemble/h_star"]
        match how:
            case "soft loop":
                file["ensemble/h_star"] = h5py.SoftLink("/ensemble/h_star")
            case "external":
                file["ensemble/h_star"] = h5py.ExternalLink("target.h5", "/ensemble/h_star")
            case "dangling":
                file["ensemble/h_star"] = h5py.SoftLink("/nowhere")
            case "group":
                file.create_group("ensemble/h_star")
            case "named type":
                file["ensemble/h_star"] = numpy.dtype("f8")
    message = "has a link `h_star` to elsewhere" if how in ("soft loop", "external", "dangling") else "lacks the dataset /ensemble/h_star"
    assert_refused(tmp_path / "forged.h5", message, ["validate"])
    assert_read(tmp_path / "forged.h5")


def test_a_pipe_behind_an_external_link_is_not_opened(result, tmp_path):
    os.mkfifo(tmp_path / "pipe.h5")
    with forged(result, tmp_path) as file:
        del file["integral"]
        file["integral"] = h5py.ExternalLink("pipe.h5", "/")
    assert_refused(tmp_path / "forged.h5", "has a link `integral` to elsewhere")


@pytest.mark.parametrize("how", ["external", "virtual"])
def test_values_in_other_files_are_not_read(result, tmp_path, how):
    (tmp_path / "secret").write_bytes(bytes(16 * 8))
    with forged(result, tmp_path) as file:
        del file["ensemble/h_star"]
        if how == "external":
            file.create_dataset("ensemble/h_star", (16,), "f8", external=[(str(tmp_path / "secret"), 0, 16 * 8)])
        else:
            layout = h5py.VirtualLayout((16,), "f8")
            layout[:] = h5py.VirtualSource(str(result), "ensemble/h_star", (16,))
            file.create_virtual_dataset("ensemble/h_star", layout)
    assert_refused(tmp_path / "forged.h5", "whose values are in other files, which are not read", ["validate"])


@pytest.mark.parametrize(
    "shape, dtype, options",
    [
        ((16,), "S8", {}),
        ((16,), h5py.string_dtype(), {}),
        ((16,), "i8", {}),
        ((16,), "c16", {}),
        ((16,), [("r", "f8")], {}),
        ((16,), h5py.ref_dtype, {}),
        ((16,), h5py.vlen_dtype("f8"), {}),
        ((16,), ("f8", (3,)), {}),
        ((16, 1), "f8", {}),
        ((), "f8", {}),
        ((0,), "f8", {}),
        ((2**40,), "f8", {"chunks": (1024,), "compression": "gzip"}),
        ((2**60,), "u1", {"chunks": (2**20,)}),
    ],
)
def test_datasets_of_other_kinds(result, tmp_path, shape, dtype, options):
    with forged(result, tmp_path) as file:
        del file["ensemble/external_force_mean"]
        file.create_dataset("ensemble/external_force_mean", shape, dtype, **options)
    assert_refused(tmp_path / "forged.h5", "/ensemble/external_force_mean", ["validate"])
    assert_read(tmp_path / "forged.h5", "external_force_mean")


def test_a_sea_of_zeros_is_not_believed(result, tmp_path):
    """All dimensions agree, and the file has not one of the values."""
    with forged(result, tmp_path) as file:
        for name in ("ensemble/separation", "ensemble/h_star"):
            del file[name]
            file.create_dataset(name, (2**45,), "f8", chunks=(2**16,), compression="gzip")
    assert_refused(tmp_path / "forged.h5", "/h_star that has more values than the file holds", ["validate"])


def test_repacked_results_are_read(result, tmp_path):
    """Chunked and compressed, as other tools rewrite files."""
    with forged(result, tmp_path) as file:
        for name in ("ensemble/external_force_mean", "integral/external_force", "validation/probe_external_force"):
            values = file[name][()]
            del file[name]
            file.create_dataset(name, data=values, chunks=True, compression="gzip", shuffle=True, fletcher32=True)
    before, after = ask("validate", result), ask("validate", tmp_path / "forged.h5")
    assert after.returncode == 0
    assert after.stdout.splitlines()[1:] == before.stdout.splitlines()[1:]


def test_many_links_and_attributes(result, tmp_path):
    with forged(result, tmp_path) as file:
        for i in range(3000):
            file.attrs[f"attribute {i}"] = i
            file.create_group(f"many/group {i}")
    assert_read(tmp_path / "forged.h5", "attribute 2999")


def test_an_unreadable_file(result):
    # Root reads everything, so nobody asks in its place, in a folder that they may enter.
    nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] if os.geteuid() == 0 else []
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        Path(folder).chmod(0o755)
        file, program = Path(folder, "mine.h5"), Path(folder, "stiction")
        file.write_bytes(result.read_bytes())
        shutil.copy(PROGRAM, program)
        file.chmod(0)
        for command in ("info", "validate"):
            answer = subprocess.run([*nobody, program, command, file], capture_output=True, text=True)
            assert answer.returncode == 2 and answer.stdout == "", answer
            assert "cannot be read: Permission denied" in answer.stderr and answer.stderr.count("\n") == 1, answer
