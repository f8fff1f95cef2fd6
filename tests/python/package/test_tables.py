"""Tables of other programs are read in their dialects, slips named by line and column; quantities are the program's."""

import csv

import numpy as np
import pandas as pd
import pint
import pytest
from conftest import CONFIGS, ROOT

import stiction
from stiction import SceneError, quantities, tables
from stiction.errors import FileError

# Two columns as programs write them; all are of these numbers.
FORCES, RADII = [3.5e-6, 4e-6, 2.5e-7], [2e-8, 1.85e-8, 3e-8]
PLAIN = "force (uN),radius (nm)\n3.5,20\n4,18.5\n.25,3e1\n"
GERMAN = "Force (µN);Radius (nm)\r\n3,5;20\r\n4;18,5\r\n0,25;30,0\r\n"


def written(tmp_path, content, encoding="utf-8"):
    path = tmp_path / "table.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
    return path


def reported(function, *arguments, **named):
    with pytest.raises((SceneError, FileError)) as error:
        function(*arguments, **named)
    return str(error.value)


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        (PLAIN, "utf-8"),
        (PLAIN, "utf-8-sig"),
        (PLAIN, "utf-16"),
        (PLAIN, "utf-16-le"),
        (PLAIN, "utf-16-be"),
        (PLAIN.replace("\n", "\r"), "utf-8"),
        (PLAIN.replace("\n", "\r\n"), "utf-8-sig"),
        (PLAIN.replace(",", "\t"), "utf-16"),
        (PLAIN.replace(",", ";"), "utf-8"),
        (GERMAN, "cp1252"),
        (GERMAN, "utf-8"),
        (GERMAN.replace(";", "\t"), "utf-16"),
        ("sep=;\r\n" + GERMAN, "cp1252"),
        ("# of Monday; 5\" wafer\n\n" + GERMAN.replace("\r\n", "\n  # note\n"), "utf-8"),
        ('"Force\n[µN]", "Radius in nm"\n"3.5", "20"\n"4","18.5"\n0.25,30', "utf-8"),
        (GERMAN.replace(";", ";;"), "cp1252"),
        (GERMAN.replace("\r\n", ";\r\n"), "cp1252"),
        ("force_uN,radius_nm\n3.5,20\n4,18.5\n0.25,30\n", "utf-8"),
        ("FORCE uN,Radius / nm\n3.5,20\n4,18.5\n0.25,30\n", "utf-8"),
        ("force [μN],radius {Å}\n3.5,200\n4,185\n0.25,300\n", "utf-8"),
    ],
)  # fmt: skip
def test_every_dialect_is_read(text, encoding, tmp_path):
    table = stiction.read_table(written(tmp_path, text, encoding))
    assert list(table) == ["force", "radius"] and table.force.attrs == {"units": "N"}
    assert np.allclose(table.force, FORCES, rtol=1e-15, atol=0) and np.allclose(table.radius, RADII, rtol=1e-15, atol=0)


def test_what_pandas_writes_is_read(tmp_path):
    frame = pd.DataFrame({"Tip": ["A", "B, old", 'C "new"'], "force (N)": FORCES, "radius (m)": RADII})
    for index in (True, False):
        for separator, decimal in ((",", "."), (";", ","), ("\t", ",")):
            frame.to_csv(tmp_path / "frame.csv", index=index, sep=separator, decimal=decimal)
            table = stiction.read_table(tmp_path / "frame.csv")
            assert table.tip.values.tolist() == frame.Tip.tolist()
            assert table.force.values.tolist() == FORCES and table.radius.values.tolist() == RADII
            assert ("row_name" in table) == index


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("force (uN)\n", "a header and a line for each row"),
        ("1,2\n3,4\n", "line 1: numbers, where the names of the columns belong"),
        ("# force\n1,2\n3,4\n", "line 2: numbers, where the names of the columns belong"),
        ("force (uN),x\n1,2\n3\n", "line 3: 1 cells, where the header has 2"),
        ("force (uN),x\n1,2,5\n", "line 2: 3 cells, where the header has 2; a number has a point"),
        ("force (uN),Force (nN)\n1,2\n", "line 1: the columns 1 and 2 are both `force`; leave one out"),
        ("pull-off force (uN),pull_off_force_uN\n1,2\n", "are both `pull_off_force`"),
        ("force (uN),\n1,2\n", "line 1: column 2 has no name"),
        ("force (furlong)\n1\n", "line 1, column 1 (force): unknown unit \"furlong\"; scenes have m, "),
        ("force (uN)\n1\n5_2.6\n", "line 3, column 1 (force): 5_2.6 is not a number"),
        ("force (uN)\n1\n1.2.3\n", "line 3, column 1 (force): 1.2.3 is not a number"),
        ("force (uN)\n1\ninf\n", "line 3, column 1 (force): inf is not a number"),
        ("force (uN)\n1\n1e999\n", "1e999 is not finite"),
        ("force (uN);x\n1,5;2\n1.5;2\n", "line 3, column 1 (force): 1.5, but line 2, column 1 has a decimal comma"),
        ("force (uN);x\n1.234,5;2\n", "1.234,5 is not a number"),
        ('force (uN),x\n"1,234",2\n', "1,234, but commas are between the columns; write all numbers with points"),
        ('force (uN),x\n"1,2\n', "line 2: unexpected end of data"),
        (b"PK\x03\x04rest", "is a workbook or an archive; save the sheet as CSV"),
        (b"\x89HDF\r\n\x1a\n", "is an HDF5 file"),
        (b"\x1f\x8b\x08", "is compressed"),
        (b"force\n\x81\x8d\n", "cannot be read as text"),
    ],
)
def test_what_is_no_table_is_refused_by_its_place(text, part, tmp_path):
    assert part in reported(stiction.read_table, written(tmp_path, text))
    assert "no such file" in reported(stiction.read_table, tmp_path / "none.csv")
    assert "cannot be read" in reported(stiction.read_table, tmp_path)


@pytest.mark.parametrize(
    "gap",
    ["", "NA", "n/a", "NaN", "null", "--", "-", "#N/A", "#NV", "#REF!", "#BEZUG!", "#DIV/0!", "#NAME?", "#NOM?"],
)
def test_gaps_are_neither_comments_nor_dropped(gap, tmp_path):
    for text, place in (
        (f"x;y\n1;2\n{gap};4\n", "line 3, column 1 (x)"),
        (f"x,y\n1,2\n3,{gap}\n", "line 3, column 2 (y)"),
        (f"x,y\n{gap},2\n3,4\n", "line 2, column 1 (x)"),
    ):
        found = reported(stiction.read_table, written(tmp_path, text))
        assert f"{place}: {gap or 'nothing'}: a gap; fill it, or take the line out" in found


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("sample,x\nA1,2\n#2 (repeat),3\n", 3),
        ("sample,x\n#1,2\n#2,3\n", 2),
        ("sample;x;\r\n\r\n  #1;2,5;\r\n", 3),
        ("sample\tx\nA1\t2\n#2\t3\t\t\n", 3),
        ("sample,x\nA1,2\n#2,\n", 3),
        ("x,y\n####,2\n3,4\n", 2),
        ("x\n3\n#####\n4\n", 3),
    ],
)
def test_a_row_that_begins_with_a_hash_is_not_dropped(text, line, tmp_path):
    assert f"table.csv, line {line}: " in reported(stiction.read_table, written(tmp_path, text))
    # Quotes make it a row, and what has other cells is a comment.
    text = '# a, b\nsample,x\n# of Monday, noon\n"#1",2\n# two, three, four\n  "#2 (repeat)",3\n#\n'
    table = stiction.read_table(written(tmp_path, text))
    assert table.sample.values.tolist() == ["#1", "#2 (repeat)"] and table.x.values.tolist() == [2, 3]
    assert stiction.read_table(written(tmp_path, "x\n3\n# note\n#\n#4\n5\n")).x.values.tolist() == [3, 5]


def test_empty_lines_are_gaps_of_one_column_alone(tmp_path):
    found = reported(stiction.read_table, written(tmp_path, "\nx\n1\n\n3\n\n\n"))
    assert "line 4, column 1 (x): nothing: a gap" in found
    assert stiction.read_table(written(tmp_path, "\nx,y\n1,2\n\n3,4\n\n\n")).y.values.tolist() == [2, 4]
    assert "line 3, column 1 (x): nothing: a gap" in reported(stiction.read_table, written(tmp_path, "x\ty\n1\t2\n\t\n"))


def test_names_are_guessed():
    assert (
        tables.meant("pull_of_force", ["pull_off_force", "pull_off_separation"])
        == "; did you mean pull_off_force?"
    )
    assert (tables.meant("force", ["pull_off_separation", "pull_off_force"]) == "; did you mean pull_off_force?")
    assert tables.meant("colour", ["pull_off_force"]) == ""


def test_a_table_is_of_asperities_and_of_heights(tmp_path):
    """A row of a table is an asperity, as one by one; heights and radii of a scene are its columns."""
    path = written(
        tmp_path,
        "Radius (nm);reduced_modulus GPa;work_of_adhesion mJ/m²;equilibrium_spacing Å;interference nm\n20;60;50;2;0,1\n10;60;50;2;0,2\n",
    )
    solved = stiction.asperity(**stiction.read_table(path))
    alone = [
        stiction.asperity(
            radius=r, reduced_modulus=60e9, work_of_adhesion=0.05, equilibrium_spacing=2e-10, interference=d
        )
        for r, d in ((2e-8, 1e-10), (1e-8, 2e-10))
    ]
    assert solved.external_force.dims == ("row",)
    assert np.allclose(solved.external_force, [float(one.external_force) for one in alone], rtol=1e-13)
    numbers = np.random.default_rng(1).normal(0, 1.7, 200)
    heights = stiction.read_table(written(tmp_path, "z (nm)\n" + "".join(f"{value:.6f}\n" for value in numbers)))
    given = {"surface.heights": heights.z}
    own = {"surface.heights": np.array([float(f"{value:.6f}e-9") for value in numbers])}
    pull_offs = [
        stiction.run(CONFIGS / "quick.toml", replicas=4, seed=1, progress=False, **one).pull_off.mean_over_patches
        for one in (given, own)
    ]
    assert pull_offs[0] == pull_offs[1]


ASPERITY = "radius (nm),reduced_modulus (GPa),work_of_adhesion (mJ/m^2),equilibrium_spacing (nm),interference (nm)"


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("radius (nm)", "radius (GPa)", "radius: the column has the unit Pa; m or a multiple is needed, such as radius (nm)"),
        ("radius (nm)", "radius", "radius: the column has no unit, and other columns have theirs; m or a multiple"),
        ("radius (nm)", "radius (%)", "radius: the column has no unit"),
        ("radius (nm)", "radus (nm)", "radus: no argument of asperity; did you mean radius?"),
        ("radius (nm)", "temperature (K)", 'temperature: no argument of asperity; leave it out, of a table by .drop_vars("temperature")'),
        ("radius (nm)", "", "row_name: no argument of asperity"),
        ("radius (nm)", "law", "law: one text for all asperities is needed"),
        ("radius (nm)", "hardness (GPa)", "radius is missing; needed besides what is given: radius (m)"),
        ("interference (nm)", "poisson_ratio (nm)", "interference is missing"),
    ],
)  # fmt: skip
def test_a_table_with_other_columns_is_no_table_of_asperities(old, new, part, tmp_path):
    table = stiction.read_table(written(tmp_path, f"{ASPERITY.replace(old, new)}\n20,52,50,0.2,0.1\n"))
    assert part in reported(stiction.asperity, **table)


def test_units_of_columns_are_those_of_arguments(tmp_path):
    """N/m is an energy per area; a table without any unit is in SI; labels are left out by name."""
    text = f"tip,{ASPERITY.replace('mJ/m^2', 'mN/m')},poisson_ratio\nA,20,52,50,0.2,0.1,0.3\n"
    table = stiction.read_table(written(tmp_path, text))
    assert "tip: no argument" in reported(stiction.asperity, **table)
    of = stiction.asperity(**table.drop_vars("tip"), hardness="5 GPa").external_force
    plain = "radius,reduced_modulus,work_of_adhesion,equilibrium_spacing,interference\n20e-9,52e9,50e-3,0.2e-9,0.1e-9\n"
    own = stiction.read_table(written(tmp_path, plain))
    assert np.allclose(of, stiction.asperity(**own, hardness="5 GPa", poisson_ratio=0.3).external_force, rtol=1e-13)
    table["poisson_ratio"].attrs["units"] = "Pa"
    assert "poisson_ratio: the column has the unit Pa; a number without unit is needed" in reported(
        stiction.asperity, **table.drop_vars("tip"), hardness="5 GPa"
    )


def units():
    with (ROOT / "tests" / "data" / "units.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


# Units of files in the list, and as scenes write them.
OF_FILES = {"m2": "m^2", "m-2": "/m^2", "J m-2": "J/m^2", "N m-1": "N/m", "m3 mol-1": "m^3/mol"}


@pytest.mark.parametrize("row", units(), ids=lambda row: row["text"])
def test_quantities_are_those_of_the_program(row):
    """The list that the tests of src/scene/units.rs read as well, to the last bit; what is no quantity is refused."""
    wanted = float(row["si"]) if row["si"] else None
    try:
        number, unit = quantities.parsed("x", row["text"])
    except ValueError:
        number, unit = None, ""
    if not quantities.of_one_dimension([unit, OF_FILES.get(row["unit"], row["unit"])]):
        number = None
    assert number == wanted


def test_every_unit_is_in_the_list():
    listed = {row["text"] for row in units()}
    assert not [name for name in quantities._UNITS if name not in ("", "%") and f"2.5 {name}" not in listed]


def test_pint_has_every_dimension_of_scenes():
    of = pint.UnitRegistry()
    for value, wanted in [
        (of("3 kV"), (3e3, "V")), (of("2 zJ"), (2e-21, "J")), (of.Quantity(20, "degC"), (293.15, "K")), (of("300 K"), (300.0, "K")),
        (of("30 degree"), (np.pi / 6, "rad")), (of("0.5 rad"), (0.5, "rad")), (of("18 cm**3/mol"), (1.8e-5, "m^3/mol")),
        (of("5 kN/m"), (5e3, "N/m")), (of("50 mJ/m**2"), (0.05, "N/m")), (of("10 percent"), (0.1, "1")), (of("8 /um**2"), (8e12, "/m^2")),
        (of("5 GPa"), (5e9, "Pa")), (of("3 um**2"), (3e-12, "m^2")), (of("2 nN"), (2e-9, "N")), (of("3 nm"), (3e-9, "m")),
    ]:  # fmt: skip
        number, unit = quantities.parsed("x", value)
        assert number == pytest.approx(wanted[0], rel=1e-14) and unit == wanted[1]
        assert quantities.in_si("x", value, wanted[1]) == pytest.approx(wanted[0], rel=1e-14)
    assert quantities.in_si("x", ["1 nm", 2 * of.nm, 3e-9], "m").tolist() == pytest.approx([1e-9, 2e-9, 3e-9])
    assert quantities.in_si("x", np.array([10, 12]) * of.nm, "m").tolist() == pytest.approx([1e-8, 1.2e-8])
