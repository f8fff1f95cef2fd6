"""What the package writes is whole or as it was before: with full disks, kills, links and files that are there."""

import os
import resource
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import xarray
from conftest import CONFIGS
from matplotlib import pyplot

import stiction
from stiction import FileError, files
from stiction.plot.command import main as plot
from stiction.program import find
from stiction.report.command import main as report

QUICK = CONFIGS / "quick.toml"
WRITERS = {
    "result.save": lambda run, path: run.save(path, force=True),
    "plot": lambda run, path: plot([str(run.path), "-o", str(path), "--force"]),
    "report": lambda run, path: report([str(run.path), "-o", str(path), "--force"]),
}
ENDINGS = {"result.save": ".h5", "plot": ".png", "report": ".html"}


@pytest.fixture(autouse=True)
def closed():
    yield
    pyplot.close("all")


@contextmanager
def longest(length):
    """No file gets longer, as on a disk that is full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (length, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def names(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("length", [20_000, 60_000])
def test_a_full_disk_leaves_the_file_that_was_there(result, writer, length, tmp_path, capsys):
    run, path = result("run"), tmp_path / f"mine{ENDINGS[writer]}"
    path.write_text("mine")
    with longest(length):
        try:
            assert WRITERS[writer](run, path) == 1
            said = capsys.readouterr().err
        except OSError as error:
            said = f"{error}\n"
    assert said.count("\n") == 1 and str(path) in said and "File too large" in said and "-> None" not in said
    assert path.read_text() == "mine" and names(tmp_path) == [path.name]


def test_a_full_temporary_folder_is_named_with_its_error(tmp_path):
    """As libhdf5 reports it."""
    with pytest.raises(OSError, match=r"No space left on device: '.*whole\.h5'") as error, files.writing_hdf5(tmp_path / "mine.h5"):
        raise RuntimeError("Set slist enabled failed (file write failed: time = now\n, file descriptor = 12, errno = 28, error message = 'No space')")
    assert error.value.errno == 28 and names(tmp_path) == []
    with pytest.raises(RuntimeError, match=r"^other$"), files.writing_hdf5(tmp_path / "mine.h5"):
        raise RuntimeError("other")


def test_results_of_python_itself_are_written_so_too(tmp_path):
    path = tmp_path / "mine.h5"
    path.write_text("mine")
    with pytest.raises(OSError), files.writing_hdf5(path, force=True) as part:
        # In another folder, as libhdf5 may crash where it cannot write.
        assert part.parent != tmp_path
        xarray.Dataset({"x": ("n", np.arange(1e5))}).to_netcdf(part, engine="h5netcdf")
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.getrlimit(resource.RLIMIT_FSIZE)[1],) * 2)
    assert path.read_text() == "mine" and names(tmp_path) == ["mine.h5"]


def test_a_kill_leaves_the_file_that_was_there(tmp_path):
    path = tmp_path / "mine.txt"
    path.write_text("mine")
    code = (
        "import os, sys, stiction.files as files\n"
        "with files.writing(sys.argv[1], force=True) as part:\n"
        "    part.write_text('half')\n"
        "    os.kill(os.getpid(), 9)\n"
    )
    assert subprocess.run([sys.executable, "-c", code, path]).returncode == -signal.SIGKILL
    assert path.read_text() == "mine"


def test_an_error_leaves_nothing(tmp_path):
    with pytest.raises(ZeroDivisionError), files.writing(tmp_path / "a.txt") as part:
        part.write_text("half")
        _ = 1 / 0
    with pytest.raises(OSError, match=r"a\.txt: nothing has been written"), files.writing(tmp_path / "a.txt"):
        pass
    assert names(tmp_path) == []


def test_who_comes_second_overwrites_nothing(tmp_path):
    path = tmp_path / "a.txt"
    with pytest.raises(FileError, match="exists; force=True overwrites it"), files.writing(path) as first:
        with files.writing(path) as second:
            assert first != second and first.suffix == ".txt"
            second.write_text("second")
        first.write_text("first")
    assert path.read_text() == "second" and names(tmp_path) == ["a.txt"]
    with files.writing(path, force=True) as part:
        part.write_text("third")
    assert path.read_text() == "third" and path.stat().st_mode & 0o777 == 0o666 & ~umask()


def umask():
    before = os.umask(0)
    os.umask(before)
    return before


@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("target", ["victim", "nothing"])
def test_links_are_not_followed(result, writer, target, tmp_path, capsys):
    (tmp_path / "victim").write_text("victim")
    path = tmp_path / f"a{ENDINGS[writer]}"
    path.symlink_to(tmp_path / target)
    # What one could guess of the name of the unfinished file.
    for guess in (f"{path.name}.part", f".{path.name}.part", f"{path.name}.tmp"):
        (tmp_path / guess).symlink_to(tmp_path / "victim")
    try:
        assert WRITERS[writer](result("run"), path) == 2
        line = capsys.readouterr().err
    except FileError as error:
        line = str(error)
    assert f"{path}: is a symbolic link, which is not followed" in line
    path.unlink()
    WRITERS[writer](result("run"), path)
    assert (tmp_path / "victim").read_text() == "victim" and path.is_file() and not path.is_symlink()


@pytest.mark.parametrize("how", ["itself", "hard link"])
def test_an_input_is_never_replaced(result, how, tmp_path, capsys):
    content = result("run").path.read_bytes()
    for main, ending in ((plot, ".png"), (report, ".html")):
        source = tmp_path / f"a{ending}"
        source.write_bytes(content)
        output = source
        if how == "hard link":
            output = tmp_path / f"b{ending}"
            os.link(source, output)
        assert main([str(source), "-o", str(output), "--force"]) == 2
        assert f"{output}: is an input, {source}; name another output" in capsys.readouterr().err
        assert source.read_bytes() == output.read_bytes() == content
    with stiction.open_run(tmp_path / "a.png") as run, pytest.raises(FileError, match="is an input"):
        run.save(tmp_path / "a.png", force=True)


def test_what_a_scene_is_made_from_is_never_replaced(tmp_path, monkeypatch, capsys):
    pytest.importorskip("emcee")
    from stiction.inference.command import main as infer
    from stiction.sensitivity.command import main as sensitivity

    monkeypatch.chdir(tmp_path)
    heights = '\n[surface.heights]\nlaw = "file"\npath = "heights.h5"\n'
    prior = '[material]\nwork_of_adhesion = { prior = "uniform", from = "1 mJ/m^2", to = "2 mJ/m^2" }\n'
    given = {"scene.h5": prior + heights, "heights.h5": "heights", "data.csv": "pull_off_force (uN)\n1.0\n"}
    for name, text in given.items():
        (tmp_path / name).write_text(text)
    for main, arguments in ((sensitivity, ["scene.h5"]), (infer, ["data.csv", "scene.h5"])):
        for output in ("scene.h5", "heights.h5", "./heights.h5", *(["data.csv"] if main is infer else [])):
            assert main([*arguments, "-o", output, "--force"]) == 2
            assert "is an input" in capsys.readouterr().err
    assert {name: (tmp_path / name).read_text() for name in names(tmp_path)} == given


@pytest.mark.parametrize("name", ["folder.png", "pipe.png", "a\0.png"])
def test_what_is_no_file_is_refused(name, tmp_path):
    (tmp_path / "folder.png").mkdir()
    os.mkfifo(tmp_path / "pipe.png")
    with pytest.raises(FileError, match=r"not a regular file|character NUL"):
        files.check(tmp_path / name, force=True)


FORKED = """
import os, sys, stiction
run = stiction.run(sys.argv[1], replicas=4)
child = os.fork()
if not child:
    del run
    sys.exit()
os.waitpid(child, 0)
print(run.path.exists(), run.save(sys.argv[2]).exists())
"""


def test_a_forked_child_deletes_nothing_of_its_parent(tmp_path):
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    command = [sys.executable, "-c", FORKED, str(QUICK), str(tmp_path / "kept.h5")]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.stdout.split() == ["True", "True"], done
    assert names(tmp_path) == ["kept.h5"]


@pytest.mark.parametrize("how", [">&-", ">/dev/full"])
def test_a_name_that_cannot_be_printed_is_an_error(result, how, tmp_path):
    command = f'"{sys.executable}" -m stiction.plot "{result("run").path}" -o "{tmp_path / "a.png"}" {how}'
    done = subprocess.run(["sh", "-c", command], capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.count("\n") == 1, done
    assert done.stderr.startswith("stiction plot: ") and "standard output" in done.stderr


def test_the_program_is_not_taken_from_the_folder_at_hand(monkeypatch, tmp_path):
    program = Path(find())
    (tmp_path / "stiction").write_text("#!/bin/sh\nexit 1\n")
    (tmp_path / "stiction").chmod(0o755)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("STICTION")
    monkeypatch.setattr("sysconfig.get_path", lambda *_: str(tmp_path / "none"))
    monkeypatch.setattr(sys, "executable", str(tmp_path / "none" / "python"))
    for before in (".", ""):
        monkeypatch.setenv("PATH", f"{before}{os.pathsep}{program.parent}")
        assert find() == str(program)
        monkeypatch.setenv("PATH", before)
        with pytest.raises(stiction.StictionError, match="pip install stiction"):
            find()
