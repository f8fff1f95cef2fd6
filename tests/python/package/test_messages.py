"""Messages of the program speak of arguments of Python, not of the command line."""

import signal
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray
from conftest import begun

import stiction
from stiction import SceneError, design, quantities
from stiction.design import command as design_command
from stiction.finite_size import command as finite_size_command
from stiction.inference import posterior
from stiction.program import call, options
from stiction.sensitivity import command as sensitivity_command
from stiction.sensitivity import sensitivity

QUICK = Path(__file__).resolve().parents[3] / "configs" / "quick.toml"
TIP = {"radius": 20e-9, "reduced_modulus": 60e9, "work_of_adhesion": 0.05, "equilibrium_spacing": 2e-10}


def refused(function, *arguments, **named):
    with pytest.raises(SceneError) as error:
        function(*arguments, **named)
    assert error.value.exit_code == 2
    text = str(error.value)
    assert "--" not in text and "Usage" not in text and not text.startswith(("stiction:", "error:"))
    return text


def test_numbers_that_will_not_do_are_named():
    assert refused(stiction.run, QUICK, replicas=-3).startswith("replicas = -3: a whole number from 0 to ")
    assert refused(stiction.run, QUICK, replicas=2.5).startswith("replicas = 2.5: a whole number from 0 to ")
    assert refused(stiction.run, QUICK, threads=0) == "threads = 0: a whole number from 1 to 4096 is needed"
    assert "ensemble" in refused(stiction.compare, QUICK, ["hybrid"], replicas=5)


@pytest.mark.parametrize("name, value", [("seed", -1), ("seed", 2**63), ("threads", 0), ("threads", 2.0)])
def test_settings_of_several_runs_are_refused_before_the_first(name, value):
    """As the program refuses them, which would be asked much later, or not at all."""
    message = f"{name} = {value}: a whole number from {'0 to 9223372036854775807' if name == 'seed' else '1 to 4096'} is needed"
    if isinstance(value, int):
        assert refused(stiction.run, QUICK, **{name: value}) == message
    for function, arguments in (
        (design.probability, {"above": "1 uN"}), (sensitivity, {}), (posterior.infer, {"scene": QUICK}),
    ):  # fmt: skip
        assert refused(function, QUICK, **arguments, **{name: value}) == message


@pytest.mark.parametrize(
    "given, message",
    [
        ("169 GPA", 'unknown unit "GPA"; did you mean "GPa"?'),
        ("3 mn/m", 'unknown unit "mn/m"; did you mean "mN/m" or "MN/m"?'),
        # 1 HV is 1 kgf/mm², 9.80665 N on 1e-6 m².
        ("1200 HV", 'unknown unit "HV"; 1 HV is 9.807 MPa: 11.77 GPa'),
        ("11 HV", 'unknown unit "HV"; 1 HV is 9.807 MPa: 107.9 MPa'),
        ("85 N/mm2", 'unknown unit "N/mm2"; did you mean "MPa"?'),
        ("50 erg/cm2", 'unknown unit "erg/cm2"; did you mean "mJ/m^2"?'),
        ("3 furlong", 'unknown unit "furlong"; scenes have m, m^2, '),
    ],
)
def test_a_unit_that_is_none_is_answered_by_the_one_that_was_meant(given, message):
    with pytest.raises(ValueError) as error:
        quantities.parsed("value", given)
    assert str(error.value).startswith(f"value = {given!r}: {message}")


def test_small_quantities_and_single_things_read_well():
    assert quantities.si(8.735e-19, "J") == "0.8735 aJ"
    assert quantities.with_error(2.41e-17, 3.2e-18, "J") == "24.1 ± 3.2 aJ"
    assert [quantities.counted(number, "patch") for number in (1, 2)] == ["1 patch", "2 patches"]


@pytest.mark.parametrize(
    "command, words, message",
    [
        (design_command, ["--above", "-5 uN"], "above = '-5 uN': a force greater than 0 with a unit is needed"),
        (design_command, ["--above", "5 uN", "--error", "5%"], "argument --error: 5%: a number without a unit is needed"),
        (sensitivity_command, ["--replicas", "-5"], "replicas = -5: at least 2 patches are needed"),
        (sensitivity_command, ["--replicas", "five"], "argument --replicas: five: a whole number is needed"),
        (finite_size_command, ["--replicas", "-5"], "replicas = -5: a whole number from 0 to "),
    ],
)
def test_commands_name_the_option_and_what_would_do(command, words, message, capsys):
    """Also of a quantity that begins as an option does."""
    scene = QUICK.parent / "inference" / "sensitivity.toml" if command is sensitivity_command else QUICK
    try:
        code = command.main([str(scene), *words])
    except SystemExit as ended:
        code = ended.code
    assert code == 2 and message in capsys.readouterr().err


def test_an_output_that_exists_is_overwritten_by_force_alone(tmp_path):
    output = tmp_path / "run.h5"
    stiction.run(QUICK, output, replicas=5)
    text = refused(stiction.run, QUICK, output, replicas=6)
    assert "exists; give force=True to overwrite it, or another output" in text
    assert stiction.run(QUICK, output, replicas=6, force=True).pull_off.replicas == 6


def test_arguments_of_a_single_asperity_are_named():
    assert refused(stiction.asperity, **TIP, interference=[]) == "interference: the array is empty"
    for value in (None, float("nan"), -1.0, "20 nN", "nm", "1.2.3 nm", object()):
        assert "radius" in refused(stiction.asperity, **{**TIP, "radius": value}, interference=0.0)
    assert "nolaw" in refused(stiction.asperity, **TIP, interference=0.0, law="nolaw")
    assert "approach, retraction" in refused(stiction.asperity, **TIP, interference=0.0, path="sideways")
    assert "poisson_ratio is missing" in refused(stiction.asperity, **TIP, interference=0.0, hardness=1e9)


def cyclic():
    table = {"a": 1}
    table["b"] = {"c": [table]}
    return table


@pytest.mark.parametrize(
    "change, message",
    [
        ({"model": {3: "hybrid"}}, "3: the name of a key or table is a text, not a int"),
        ({4: {"law": "hybrid"}}, "4: the name of a key or table is a text, not a int"),
        ({"model": cyclic()}, "model: a table or list in it holds itself"),
        ({"sweep": ["a"]}, "sweep is a list: a table is needed, a dict"),
        ({"surface": {"heights": [1e-9 + 1e-9j]}}, "surface.heights: real numbers are needed, not complex ones"),
        ({"surface": {"heights": np.array([1e-9j])}}, "surface.heights: real numbers are needed, not complex ones"),
        ({"surface": {"radii": [[1e-9], [1e-9, 2e-9]]}}, "surface.radii: an array of real numbers is needed"),
        ({"surface": {"radii": np.ma.masked_equal([1e-9, 2e-9], 2e-9)}}, "surface.radii: an array of one dimension of finite lengths"),
        ({"title": "\udc80"}, "half of a surrogate pair is no character"),
    ],
)
def test_scenes_that_are_no_scenes_are_refused(change, message):
    scene = {**tomllib.loads(QUICK.read_text()), **change}
    assert message in refused(stiction.sweep, scene, {"material.hardness": ["1 GPa", "2 GPa"]})


def test_names_that_are_none_are_refused(tmp_path):
    for output in ("a\0.h5", "\ud800.h5"):
        assert "a text cannot have the character NUL, nor half of a surrogate pair" in refused(stiction.run, QUICK, tmp_path / output)
    assert "no such file" in refused(stiction.run, "a\0.toml")
    assert not list(tmp_path.iterdir())


def test_complex_numbers_are_no_lengths(tmp_path):
    assert "radius: real numbers" in refused(stiction.asperity, **{**TIP, "radius": [1e-9j]}, interference=0.0)
    heights = xarray.DataArray([[1e-9j, 0.0], [0.0, 0.0]], dims=("y", "x"))
    assert "map: real numbers" in refused(stiction.find_asperities, heights, pixel="1 nm")
    assert "map: real numbers" in refused(stiction.find_asperities, heights.values, pixel="1 nm")
    assert "interference: real" in refused(stiction.asperity, **TIP, interference=xarray.DataArray([1j], dims="x"))


def test_options_of_false_and_none_are_left_out():
    assert list(options(seed=None, force=False, resume=True, height_unit="nm")) == ["--resume", "--height-unit=nm"]
    assert call(["--version"]).startswith("stiction ")


INTERRUPTED = """
import sys, stiction
output = sys.argv[1] or None
try:
    stiction.run(sys.argv[2], output, replicas=1_000_000, progress=True)
except KeyboardInterrupt as interruption:
    print(interruption)
"""


@pytest.mark.parametrize("named", [True, False])
def test_an_interruption_says_what_was_kept(named, tmp_path):
    output = str(tmp_path / "long.h5") if named else ""
    with begun(INTERRUPTED, output, QUICK, folder=tmp_path) as process:
        process.send_signal(signal.SIGINT)
        reported, _ = process.communicate(timeout=60)
    if named:
        assert f"kept in {output}.partial; resume=True goes on" in reported.replace("\n", " ")
    else:
        assert reported == "nothing was kept, as no output was named\n"
        assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_the_program_ends_with_python(how, tmp_path):
    """However Python ends: what was done is kept, and the output is free."""
    with begun(INTERRUPTED, tmp_path / "long.h5", QUICK, folder=tmp_path) as process:
        (program,) = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text(encoding="utf-8").split()
        process.send_signal(how)
        assert process.wait() == -how
        process.stderr.close()
        given_up = time.monotonic() + 30.0
        while Path(f"/proc/{program}").exists() and time.monotonic() < given_up:
            time.sleep(0.05)
    assert not Path(f"/proc/{program}").exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["long.h5.partial"]


SEVERAL = """
import sys
from stiction.design import probability
try:
    probability(sys.argv[1], above="0.2 mN", error=0.01, progress=True)
except KeyboardInterrupt as interruption:
    print(interruption)
"""


def test_an_interruption_of_several_runs_states_that_nothing_was_kept(tmp_path):
    with begun(SEVERAL, QUICK, folder=tmp_path) as process:
        process.send_signal(signal.SIGINT)
        reported, _ = process.communicate(timeout=60)
    assert reported == "interrupted; nothing was kept, since the result is written at the end\n"
