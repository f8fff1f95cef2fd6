"""Height maps as other programs write them: one summit of a known radius, whatever it comes in."""

import bz2
import gzip
import io
import lzma
import warnings
import zipfile

import h5py
import netCDF4
import numpy as np
import pandas as pd
import PIL.Image
import pint
import pytest
import scipy.io
import tifffile
import xarray

import stiction
from stiction import SceneError
from stiction.errors import FileError
from stiction.maps import lengths, surface
from stiction.maps.reading import read_map

# z(i, j) = 5 - ((i - 4)^2 + (j - 4)^2)/4 in nm on pixels of 10 nm: one summit, 1/R = 0.5 nm/(10 nm)^2.
J, K = np.mgrid[0:9, 0:9]
Z = 5.0 - ((K - 4) ** 2 + (J - 4) ** 2) / 4.0
PIXEL, RADIUS = 1e-8, 2e-7
GIVEN = {"pixel": "10 nm", "height_unit": "nm"}
# A second map, of which no two rows and columns are alike and which is not square.
ROUGH = np.random.default_rng(5).normal(size=(12, 10)).round(3)
UNITS = pint.UnitRegistry()


def rows(z=Z, separator="\t", decimal="."):
    lines = [separator.join(f"{height:g}".replace(".", decimal) for height in row) for row in z]
    return "\n".join(lines) + "\n"


def assert_summit(source, missing=0, **options):
    """The one summit, as it is found on what is read."""
    assert_read(source, missing, **options)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        found = stiction.find_asperities(source, level="none", **options)
    assert list(found.attrs["map_shape"]) == [9, 9] and found.attrs["missing_pixels"] == missing
    assert found.asperities.radius.values == pytest.approx([RADIUS], rel=1e-9)
    # Heights are above the mean of those that are known.
    known = Z.ravel()[missing:]
    assert found.height == pytest.approx([1e-9 * (5.0 - known.mean())], rel=1e-9)


def assert_read(source, missing=0, **options):
    """Heights and pixel of the map with the summit, of which the first height may be missing."""
    read = read_map(source, **options)
    expected = np.where(np.arange(81).reshape(9, 9) < missing, np.nan, 1e-9 * Z)
    np.testing.assert_allclose(read.heights, expected, rtol=1e-12, atol=1e-24)
    assert read.pixel == pytest.approx((PIXEL, PIXEL), rel=1e-12)


def written(tmp_path, content, name="scan.txt"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_the_summit_has_its_radius(tmp_path):
    """Of an array, a text, a file with a missing height, and an array that says all."""
    assert_summit(Z * 1e-9, pixel=PIXEL)
    assert_summit(Z, **GIVEN)
    assert_summit(Z.tolist(), pixel=("10 nm", "10 nm"), height_unit="nm")
    assert_summit(written(tmp_path, HEADERS["Gwyddion"] + rows()))
    z = Z.copy()
    z[0, 0] = -9999.0
    path = nc(tmp_path, z, {"_FillValue": -9999.0})
    assert_summit(path, missing=1)
    with xarray.open_dataset(path) as opened:
        assert_summit(opened, missing=1)


# Texts.

DIALECTS = {
    "tabs": (rows(), "utf-8"),
    "blanks": (rows(separator="  "), "utf-8"),
    "commas": (rows(separator=","), "utf-8"),
    "commas and blanks": (rows(separator=", "), "utf-8"),
    "semicolons": (rows(separator=";"), "utf-8"),
    "decimal commas, tabs": (rows(decimal=","), "utf-8"),
    "decimal commas, semicolons": (rows(separator=";", decimal=","), "utf-8"),
    "decimal commas, blanks": (rows(separator=" ", decimal=","), "utf-8"),
    "separators at the ends": ("".join(f"{line};\n" for line in rows(separator=";").splitlines()), "utf-8"),
    "quotes": ("".join(",".join(f'"{z:g}"' for z in row) + "\n" for row in Z), "utf-8"),
    "quotes and decimal commas": (
        "".join(",".join(f'"{z:g}"'.replace(".", ",") for z in row) + "\n" for row in Z),
        "utf-8",
    ),
    "CRLF": (rows().replace("\n", "\r\n"), "utf-8"),
    "CR": (rows().replace("\n", "\r"), "utf-8"),
    "byte order mark": (rows(), "utf-8-sig"),
    "UTF-16": (rows(), "utf-16"),
    "UTF-16 of Windows without a mark": (rows().replace("\n", "\r\n"), "utf-16-le"),
    "UTF-16, big end first": (rows(), "utf-16-be"),
    "Windows-1252": (f"# Länge 90 µm, 5 Å\n{rows()}", "cp1252"),
    "true minus signs": (rows().replace("-", "\u2212"), "utf-8"),
    "empty lines": (rows().replace("\n", "\n\n"), "utf-8"),
    "comments": (f"% of MATLAB\n// of C\n{rows()}# the end\n", "utf-8"),
    "exponents": ("".join("\t".join(f"{z:.6e}" for z in row) + "\n" for row in Z), "utf-8"),
    "a long header": ("".join(f"Key {n}; {n}\n" for n in range(60)) + rows(), "utf-8"),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_text_is_read_in_every_dialect(tmp_path, dialect):
    content, coding = DIALECTS[dialect]
    assert_read(written(tmp_path, content.encode(coding)), **GIVEN)


HEADERS = {
    "Gwyddion": "# Channel: Topography\n# Width: 90 nm\n# Height: 90 nm\n# Value units: nm\n",
    "Gwyddion, German": "# Kanal: Topografie\n# Breite: 0,090 µm\n# Höhe: 90 nm\n# Einheiten: nm\n",
    "Gwyddion, French": "# Canal : Hauteur\n# Largeur : 0,09 \u03bcm\n# Hauteur : 90,0 nm\n# Unités : nm\n",
    "Gwyddion, Russian": "# Канал: Высота\n# Ширина: 90 nm\n# Высота: 90 nm\n# Единицы измерения: nm\n",
    "Gwyddion, Japanese": "# チャネル：高さ\n# 幅： 90 nm\n# 高さ： 90 nm\n# 値の単位： nm\n",
    "without marks": "Width: 90 nm\nHeight: 90 nm\nValue units: nm\n",
}


@pytest.mark.parametrize("header", HEADERS)
def test_a_header_says_pixel_and_unit_in_every_language(tmp_path, header):
    assert_read(written(tmp_path, HEADERS[header] + rows()))
    assert_read(written(tmp_path, (HEADERS[header] + rows(decimal=",")).encode("utf-16")))


def test_wsxm_says_the_size_of_the_scan(tmp_path):
    header = (
        "WSxM file copyright UAM\nWSxM ASCII Matrix file\nX Amplitude: 900 Å\nY Amplitude: 0,09 µm\n"
        "Z Amplitude: 8 nm\nNumber of rows: 9\nNumber of columns: 9\n\n"
    )
    assert_read(written(tmp_path, header + rows()), height_unit="nm")
    shorter = header.replace("rows: 9", "rows: 10")
    with pytest.raises(SceneError, match="its header says 10 rows, and there are 9"):
        read_map(written(tmp_path, shorter + rows()), height_unit="nm")


def test_wsxm_points_have_their_units_at_the_axes(tmp_path):
    points = "".join(f"{10 * i}\t{10 * j}\t{Z[j, i]:g}\n" for j in range(9) for i in range(9))
    header = "WSxM file copyright UAM\nWSxM ASCII XYZ file\n\nX[nm]\tY[nm]\tZ[nm]\n\n"
    assert_read(written(tmp_path, header + points))


ESRI = "ncols 9\nnrows 9\nxllcorner 0.0\nyllcorner 0.0\ncellsize 10.0\n"


@pytest.mark.parametrize(
    ("header", "marked"),
    [
        (ESRI + "NODATA_value -9999\n", "-9999"),
        (ESRI.upper() + "nodata_value  -9999.0\n", "-9999"),
        (ESRI.replace(".", ",") + "NODATA_value -99999,0\n", "-99999"),
        (ESRI, "-9999"),
        ("# missing_value = 1e20\n", "1e20"),
        (ESRI + "NODATA_value -3.4028234663852886e+38\n", "-3.4028235e+38"),
    ],
)
def test_the_value_of_no_data_is_missing(tmp_path, header, marked):
    body = rows(separator=" ").split(" ", 1)[1]
    assert_read(written(tmp_path, f"{header}{marked} {body}", "scan.asc"), missing=1, **GIVEN)


def test_a_grid_of_esri_says_that_its_cellsize_has_no_unit(tmp_path):
    path = written(tmp_path, ESRI + rows(), "scan.asc")
    with pytest.raises(
        SceneError,
        match=r"scan\.asc: does not say how large .* \(its cellsize 10\.0 has no unit\), nor in which unit",
    ):
        read_map(path)


@pytest.mark.parametrize("mark", ["nan", "NaN", "", "#N/A", "N/A", "n/a", "NA", "--", "BAD", "null", "-nan", "1.#QNAN"])
@pytest.mark.parametrize("place", [(0, 0), (0, 5), (4, 0), (8, 8)])
def test_a_missing_height_is_missing_wherever_it_is(tmp_path, mark, place):
    cells = [[f"{z:g}" for z in row] for row in Z]
    cells[place[0]][place[1]] = mark
    read = read_map(written(tmp_path, "\n".join(";".join(row) for row in cells)), **GIVEN)
    assert np.argwhere(np.isnan(read.heights)).tolist() == [list(place)]
    there = ~np.isnan(read.heights)
    np.testing.assert_allclose(read.heights[there], 1e-9 * Z[there], rtol=1e-15)


@pytest.mark.parametrize("mark", ["x", "5_2.6", "1.2.3", "#REF!", "#DIV/0!", "0x10", "12:30", "inf", "1 2"])
@pytest.mark.parametrize("place", [(0, 0), (1, 0), (0, 4), (5, 8)])
def test_what_is_no_number_is_refused_with_line_and_column(tmp_path, mark, place):
    cells = [[f"{z:g}" for z in row] for row in Z]
    cells[place[0]][place[1]] = mark
    path = written(tmp_path, "# a header\n" + "\n".join("\t".join(row) for row in cells))
    with pytest.raises(SceneError, match=rf"scan\.txt: line {place[0] + 2}, column {place[1] + 1}: "):
        read_map(path, **GIVEN)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda lines: ["9 9", *lines], r"line 1: has 2 numbers, and most lines have 9"),
        (lambda lines: [lines[0].rsplit(" ", 1)[0], *lines[1:]], r"line 1: has 8 numbers"),
        (lambda lines: [*lines[:4], lines[4] + " 7", *lines[5:]], r"line 5: has 10 numbers"),
        (lambda lines: [*lines[:4], "half way", *lines[4:]], r"line 5: `half` is not a number"),
        (lambda lines: [*lines, "the end"], r"line 10: `the` is not a number"),
        (lambda lines: ["a b c d e f g h i", *lines], r"line 1, column 1: `a` is not a number; names of columns"),
        (lambda lines: ["9,5", *lines], r"line 1: "),
    ],
)
def test_no_line_of_numbers_vanishes(tmp_path, change, said):
    lines = change(rows(separator=" ").splitlines())
    with pytest.raises(SceneError, match=said):
        read_map(written(tmp_path, "\n".join(lines)), **GIVEN)


def test_decimal_commas_are_in_all_numbers_or_in_none(tmp_path):
    path = written(tmp_path, "1\t2\t-0,75\t4\n1.5\t2\t3\t4\n1\t2\t3\t5\n7\t5\t6\t7\n")
    with pytest.raises(SceneError, match=r"line 1, column 3: `-0,75` is not a number; there are decimal points, too"):
        read_map(path, **GIVEN)


def test_commas_that_may_part_thousands_are_said(tmp_path):
    for body, said in (("1,234 2,500 3,125 4,000\n", 1), ("0,234 2,500 3,125 4,000\n", 0), ("1,2 2,500 3,125 4,000\n", 0)):
        read = read_map(written(tmp_path, 3 * body), **GIVEN)
        assert read.heights[0, 1] == 2.5e-9
        assert len(read.warnings) == said and all("if they part thousands" in one for one in read.warnings)
    with pytest.raises(SceneError, match=r"line 1, column 1: `1,234\.5` is not a number"):
        read_map(written(tmp_path, "1,234.5\t2\t3\t4\n" * 4), **GIVEN)


# Names of rows and columns.


@pytest.mark.parametrize("index", [True, False])
@pytest.mark.parametrize("header", [True, False])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_names_of_pandas_are_no_heights(tmp_path, index, header, separator):
    path = tmp_path / "scan.csv"
    pd.DataFrame(Z).to_csv(path, index=index, header=header, sep=separator)
    said = read_map(path, **GIVEN).warnings
    assert bool(said) == (index or header) and all("left out" in one for one in said)
    assert_read(path, **GIVEN)


def test_a_header_with_one_cell_fewer_has_the_names_of_columns(tmp_path):
    names = ",".join(str(i) for i in range(9))
    body = "".join(f"{j},{line}\n" for j, line in enumerate(rows(separator=",").splitlines()))
    assert_read(written(tmp_path, f"{names}\n{body}"), **GIVEN)
    with pytest.raises(SceneError, match=r"line 1: has 8 numbers, and most lines have 9"):
        read_map(written(tmp_path, f"{names[:-2]}\n{rows(separator=',')}"), **GIVEN)


def test_places_among_the_heights_are_refused(tmp_path):
    places = ",".join(f"{10 * i}" for i in range(9))
    down = "".join(f"{80 - 10 * j},{line}\n" for j, line in enumerate(rows(separator=",").splitlines()))
    for content, where in (
        (f"{places}\n{rows(separator=',')}", "line 1 goes evenly from 0 to 80"),
        (down, "column 1 goes evenly from 80 to 0"),
        (f",{places}\n{down}", "line 1 goes evenly"),
        (f"{','.join(str(i) for i in range(10))}\n{down}", "column 1 goes evenly"),
    ):
        with pytest.raises(SceneError, match=where):
            read_map(written(tmp_path, content), **GIVEN)


@pytest.mark.parametrize("digits", [3, 4])
def test_places_that_are_rounded_are_refused(tmp_path, digits):
    """Pixels of 5 um/512, as um of a few digits."""
    places = [f"{5.0 * i / 512:.{digits}f}" for i in range(10)]
    down = [f"{place},{line}" for place, line in zip(places, rows(ROUGH, ",").splitlines(), strict=False)]
    for lines, where in (([",".join(places), *rows(ROUGH, ",").splitlines()], "line 1"), (down, "column 1")):
        with pytest.raises(SceneError, match=f"{where} goes evenly from"):
            read_map(written(tmp_path, "\n".join(lines)), **GIVEN)


@pytest.mark.parametrize("z", [0.5 * K + 0.25 * J, 1.0 * K, 1.0 * J, np.zeros((9, 9)), ROUGH])
def test_heights_are_no_names(tmp_path, z):
    """A plane has rows and columns that rise evenly: all of them."""
    read = read_map(written(tmp_path, rows(z)), **GIVEN)
    np.testing.assert_allclose(read.heights, 1e-9 * z, rtol=1e-12)
    assert read.warnings == []


# Lists of points.


def points(order="xyz", scale=10.0):
    places = [(scale * i, scale * j, Z[j, i]) for j in range(9) for i in range(9)]
    return [" ".join(f"{place['xyz'.index(axis)]:.10g}" for axis in order) for place in places]


def test_a_regular_list_of_points_is_a_map(tmp_path):
    header = "# Channel: Topography\n# Lateral units: nm\n# Value units: nm\n"
    assert_read(written(tmp_path, header + "\n".join(points())))
    assert_read(written(tmp_path, "\n".join(points())), **GIVEN)
    shuffled = list(np.random.default_rng(1).permutation(points()))
    assert_read(written(tmp_path, "\n".join(shuffled)), **GIVEN)
    assert_read(written(tmp_path, "z y x\n" + "\n".join(points("zyx"))), **GIVEN)
    assert_read(written(tmp_path, "X (um), Y (um), Z (nm)\n" + "\n".join(points(scale=0.01)).replace(" ", ", ")))
    table = pd.DataFrame([line.split() for line in points()], columns=["x", "y", "height"])
    table.to_csv(tmp_path / "list.csv")
    assert_read(tmp_path / "list.csv", **GIVEN)


def test_points_that_are_not_there_are_missing(tmp_path):
    assert_read(written(tmp_path, "\n".join(points()[1:])), missing=1, **GIVEN)
    said = read_map(written(tmp_path, "\n".join(points()[1:])), **GIVEN).warnings
    assert said == ["1 of 81 places of the grid have no point: missing"]


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([*points(), points()[7]], "1 of its points x, y, z have the place of another one"),
        ([*points(), "3.3 44 1"], "are no grid"),
        ([f"{x} 0 1" for x in range(9)], "line scan"),
        (["x y z", *(f"{line} 7" for line in points())], "its header names 3 columns, and there are 4"),
        ([f"{x} {y} 0" for x, y in np.random.default_rng(2).random((40, 2))], "are no grid"),
    ],
)
def test_points_that_are_no_grid_are_refused(tmp_path, lines, said):
    with pytest.raises(SceneError, match=said):
        read_map(written(tmp_path, "\n".join(lines)), **GIVEN)


@pytest.mark.parametrize("content", ["1\n2\n3\n4\n", "0 1\n1 2\n2 1\n3 3\n", "1 2 3 4 5 6 7 8\n"])
def test_a_line_scan_is_for_the_spectrum(tmp_path, content):
    with pytest.raises(SceneError, match="a line scan has a spectrum, but no asperities"):
        read_map(written(tmp_path, content), **GIVEN)


def test_several_maps_of_a_text_have_names(tmp_path):
    of = "# Channel: {}\n# Width: 90 nm\n# Height: 90 nm\n# Value units: nm\n{}\n"
    assert_read(written(tmp_path, of.format("Z", rows()) + "# Channel: none\n"))
    path = written(tmp_path, of.format("Z", rows()) + of.format("Phase", rows(ROUGH[:9, :9])))
    with pytest.raises(SceneError, match="has 2 channels that may be maps; name the channel, one of 0: Z, 1: Phase"):
        read_map(path)
    assert_read(path, channel="Z")
    assert stiction.find_asperities(path, channel="Z").attrs["map"] == "scan.txt"
    np.testing.assert_allclose(read_map(path, channel=1).heights, 1e-9 * ROUGH[:9, :9])
    assert read_map(path, channel="Phase").source == f"{path}, channel Phase"
    with pytest.raises(SceneError, match="has no channel X; it has 0: Z, 1: Phase"):
        read_map(path, channel="X")


# Packed files.


def test_packed_files_are_unpacked(tmp_path):
    text = (HEADERS["Gwyddion"] + rows()).encode()
    (tmp_path / "scan.txt.gz").write_bytes(gzip.compress(text))
    array = io.BytesIO()
    np.save(array, Z)
    with zipfile.ZipFile(tmp_path / "scan.zip", "w") as archive:
        archive.writestr("__MACOSX/._scan.npy", b"junk")
        archive.writestr("data/scan.npy", array.getvalue())
    assert_read(tmp_path / "scan.txt.gz")
    assert_read(tmp_path / "scan.zip", **GIVEN)
    assert read_map(tmp_path / "scan.zip", **GIVEN).source == str(tmp_path / "scan.zip")
    with zipfile.ZipFile(tmp_path / "two.zip", "w") as archive:
        archive.writestr("a.txt", text)
        archive.writestr("b.txt", text)
    with pytest.raises(SceneError, match=r"two\.zip: holds 2 files, of which one has to be unpacked: a\.txt, b\.txt"):
        read_map(tmp_path / "two.zip")
    for suffix, packed in (("bz2", bz2.compress(text)), ("xz", lzma.compress(text))):
        (tmp_path / f"scan.txt.{suffix}").write_bytes(packed)
        assert_read(tmp_path / f"scan.txt.{suffix}")
    (tmp_path / "cut.txt.gz").write_bytes(gzip.compress(text)[:-20])
    with pytest.raises(SceneError, match=r"cut\.txt\.gz: is damaged"):
        read_map(tmp_path / "cut.txt.gz")


LFS = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"


def picture(form):
    """A picture as Pillow writes it."""
    file = io.BytesIO()
    PIL.Image.fromarray(np.rint(40 * (Z + 5)).astype("u1")).save(file, form)
    return file.getvalue()


def workbook():
    """A sheet of Office Open XML is a zip file."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("xl/worksheets/sheet1.xml", "<worksheet/>")
    return file.getvalue()


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("scan.xlsx", workbook, "is a workbook; save the sheet as CSV"),
        ("scan.xls", lambda: b"\xd0\xcf\x11\xe0" + bytes(60), "is a workbook; save the sheet as CSV"),
        ("scan.jpg", lambda: picture("JPEG"), "is a picture: colours are no heights"),
        ("scan.png", lambda: picture("PNG"), "is a picture: colours are no heights"),
        ("scan.bmp", lambda: picture("BMP"), "is a picture: colours are no heights"),
        ("scan.txt", lambda: LFS.encode(), "is a pointer of Git LFS, not the file; run `git lfs pull`"),
        ("scan.npy", lambda: LFS.encode(), "is a pointer of Git LFS"),
    ],
)
def test_files_that_are_no_maps_are_known(tmp_path, name, content, said):
    with pytest.raises(SceneError) as error:
        read_map(written(tmp_path, content(), name), **GIVEN)
    assert str(error.value).startswith(f"{tmp_path / name}: {said}") and "\n" not in str(error.value)


@pytest.mark.parametrize("content", [LFS.encode(), picture("PNG"), picture("JPEG")])
def test_a_table_is_no_picture_and_no_pointer(tmp_path, content):
    path = written(tmp_path, content)
    with pytest.raises(FileError, match=r"is a picture: colours|is a pointer of Git LFS"):
        stiction.read_table(path)


def test_a_folder_is_no_map(tmp_path):
    for path, said in ((tmp_path, "is a folder; name a file in it"), (tmp_path / "none", "no such file")):
        with pytest.raises(SceneError, match=f": {said}$"):
            read_map(path)


def test_a_text_of_a_spreadsheets_name_is_read(tmp_path):
    """LabVIEW writes texts with the ending .xls."""
    assert_read(written(tmp_path, rows(), "scan.xls"), **GIVEN)


# NumPy, HDF5 and netCDF.


def test_archives_of_numpy_have_names(tmp_path):
    np.savez(tmp_path / "one.npz", z=Z)
    np.savez_compressed(tmp_path / "two.npz", other=ROUGH, z=Z)
    assert_read(tmp_path / "one.npz", **GIVEN)
    assert_read(tmp_path / "two.npz", channel="z", **GIVEN)
    with pytest.raises(SceneError, match="name the channel, one of 0: other, 1: z"):
        read_map(tmp_path / "two.npz", **GIVEN)
    np.save(tmp_path / "objects.npy", np.array([{}, {}]), allow_pickle=True)
    with pytest.raises(SceneError, match=r"objects\.npy: .*[Oo]bject"):
        read_map(tmp_path / "objects.npy", **GIVEN)


def test_what_is_beside_the_one_map_of_an_archive_is_said(tmp_path):
    path = tmp_path / "scan.npz"
    np.savez(path, x=np.arange(9.0), y=np.arange(9.0), z=Z, pixel=np.array(10.0), note=np.array("none"))
    assert_read(path, **GIVEN)
    read = read_map(path, **GIVEN)
    assert read.channel == "z"
    assert read.warnings == ["of its arrays z is read; there are x, y, pixel, note, too"]
    with pytest.raises(SceneError, match=r"its pixels are \(its arrays x, y, pixel, note have no units\); give pixel="):
        read_map(path, height_unit="nm")
    for channel in ("z", 0):
        assert read_map(path, channel=channel, **GIVEN).warnings == []
    with pytest.raises(SceneError, match="a line scan has a spectrum"):
        read_map(path, channel="x", **GIVEN)
    with pytest.raises(SceneError, match="has no array w; it has 0: z"):
        read_map(path, channel="w", **GIVEN)
    np.savez(path, x=np.arange(9.0), z=Z, phase=Z)
    with pytest.raises(SceneError, match="has 2 arrays that may be maps; name the channel, one of 0: z, 1: phase"):
        read_map(path, **GIVEN)


def test_an_archive_is_not_read_where_it_is_too_large(tmp_path):
    path = tmp_path / "scan.npz"
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (1 << 20, 1 << 20)})
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("z.npy", header.getvalue())
    with pytest.raises(SceneError, match=r"scan\.npz: has 1048576 x 1048576 pixels"):
        read_map(path, **GIVEN)


def in_hdf5(path, variables):
    """Variables as MATLAB 7.3 writes them: columns first, behind 512 bytes of its own."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in variables.items():
            file[name] = values.T
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\2IM")


MATLABS = {
    "5": scipy.io.savemat,
    "compressed": lambda path, variables: scipy.io.savemat(path, variables, do_compression=True),
    "4": lambda path, variables: scipy.io.savemat(path, variables, format="4"),
    "7.3": in_hdf5,
}


@pytest.mark.parametrize("version", MATLABS)
def test_rows_of_matlab_go_along_y(tmp_path, version):
    path = tmp_path / "scan.mat"
    MATLABS[version](path, {"z": ROUGH, "x": np.arange(10.0).reshape(1, -1)})
    read = read_map(path, **GIVEN)
    assert read.heights.shape == (12, 10) and read.channel == "z"
    np.testing.assert_allclose(read.heights, 1e-9 * ROUGH, rtol=1e-15)
    MATLABS[version](path, {"z": Z})
    assert_read(path, **GIVEN)
    MATLABS[version](path, {"z": Z, "phase": ROUGH})
    with pytest.raises(SceneError, match="that may be maps; name the channel, one of 0: "):
        read_map(path, **GIVEN)
    assert_read(path, channel="z", **GIVEN)


def test_variables_of_matlab_that_are_no_maps_are_left_out(tmp_path):
    path = tmp_path / "scan.mat"
    scipy.io.savemat(path, {"z": Z, "note": "nm", "info": {"a": 1.0}, "cells": np.array([[1, "a"]] * 2, dtype=object)})
    assert_read(path, **GIVEN)
    scipy.io.savemat(path, {"note": "nm"})
    with pytest.raises(SceneError, match=r"scan\.mat: has no array of two dimensions that holds numbers"):
        read_map(path, **GIVEN)
    (tmp_path / "text.mat").write_text(rows())
    assert_read(tmp_path / "text.mat", **GIVEN)


def nc(tmp_path, z=Z, attrs=None, coordinates=True, writer="NETCDF4", dtype="f8"):
    """A map in a file of netCDF by the library of the Unidata, or in one of h5py."""
    path = tmp_path / "scan.nc"
    attrs = {"units": "nm", **(attrs or {})}
    if writer == "h5py":
        with h5py.File(path, "w") as file:
            file["z"] = z.astype(dtype)
            file["z"].attrs.update(attrs)
            for axis, name in enumerate("yx" if coordinates else ""):
                file[name] = 10.0 * np.arange(9)
                file[name].attrs["units"] = np.bytes_("nm")
                file[name].make_scale(name)
                file["z"].dims[axis].attach_scale(file[name])
        return path
    with netCDF4.Dataset(path, "w", format=writer) as file:
        for name in "yx":
            file.createDimension(name, 9)
            if coordinates:
                file.createVariable(name, "f8", (name,))[:] = 10.0 * np.arange(9)
                file[name].units = "nm"
        variable = file.createVariable("z", dtype, ("y", "x"), fill_value=attrs.pop("_FillValue", None))
        variable.setncatts(attrs)
        variable.set_auto_maskandscale(False)
        variable[:] = z
    return path


WRITERS = ["NETCDF4", "NETCDF3_CLASSIC", "h5py"]


@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("attribute", ["_FillValue", "missing_value"])
def test_the_marks_of_cf_are_missing_heights(tmp_path, writer, attribute):
    z = Z.copy()
    z[0, 0] = -9999.0
    for mark in (-9999.0, np.array([-9999.0])):
        assert_read(nc(tmp_path, z, {attribute: mark}, writer=writer), missing=1)


@pytest.mark.parametrize("writer", WRITERS)
def test_scale_and_offset_of_cf_are_applied(tmp_path, writer):
    """Whole numbers of 0.25 nm: not to scale them makes R = 50 nm."""
    attrs = {"scale_factor": 0.25, "add_offset": 3.0}
    assert_read(nc(tmp_path, np.rint(4 * (Z - 3)), attrs, writer=writer, dtype="i2"))
    packed = np.rint(4 * (Z - 3))
    packed[0, 0] = -32000
    assert_read(nc(tmp_path, packed, {**attrs, "_FillValue": np.int16(-32000)}, writer=writer, dtype="i2"), missing=1)


FLOATS = [{"valid_min": -3.0}, {"valid_range": [-3.0, 5.0]}, {"valid_range": [-3.0, 5.0], "valid_min": 2.0}]
SCALED = {"scale_factor": 0.25, "add_offset": 3.0}
WHOLE = [
    {"valid_min": np.int16(-24), **SCALED},
    {"valid_range": np.array([-24, 8], dtype="i2"), **SCALED},
    {"valid_min": -3.0, "valid_max": 5.0, **SCALED},
    {"valid_max": np.int16(24), "scale_factor": -0.25, "add_offset": 3.0},
    {"valid_range": [-3.0, 5.0], "scale_factor": -0.25, "add_offset": 3.0},
]


@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("limits", FLOATS)
@pytest.mark.parametrize("dtype", ["f4", "f8"])
def test_what_is_beyond_the_limits_of_cf_is_missing(tmp_path, writer, limits, dtype):
    z = Z.copy()
    z[0, 0] = -3.25
    path = nc(tmp_path, z, limits, writer=writer, dtype=dtype)
    assert_read(path, missing=1)
    with xarray.open_dataset(path, engine="h5netcdf" if writer != WRITERS[1] else "scipy") as opened:
        assert_read(opened, missing=1)
        assert opened.z.values[0, 0] == -3.25
    assert_read(nc(tmp_path, Z, {"valid_max": "none", "valid_range": [-9.0]}, writer=writer, dtype=dtype))


@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("limits", WHOLE)
def test_limits_of_cf_are_of_numbers_as_they_are_stored(tmp_path, writer, limits):
    """The largest is 5 nm, and the least of the others -3 nm; limits of floats are of scaled numbers."""
    packed = np.rint((Z - 3) / limits["scale_factor"])
    packed[0, 0] = np.sign(limits["scale_factor"]) * -25
    assert_read(nc(tmp_path, packed, limits, writer=writer, dtype="i2"), missing=1)


@pytest.mark.parametrize("writer", WRITERS[:2])
def test_limits_of_unsigned_numbers_are_unsigned(tmp_path, writer):
    packed = np.rint(40 * (Z + 3)).astype("i2")
    packed[0, 0] = 251
    limits = {"valid_range": np.array([0, -6], dtype="i1"), "_Unsigned": "true"}
    attrs = {"scale_factor": 0.025, "add_offset": -3.0, **limits}
    packed = np.minimum(packed, 250 + (packed == 251)).astype("u1").view("i1")
    path = nc(tmp_path, packed, attrs, writer=writer, dtype="i1")
    read = read_map(path)
    assert np.argwhere(np.isnan(read.heights)).tolist() == [[0, 0]]
    assert np.nanmax(read.heights) == pytest.approx(1e-9 * (250 * 0.025 - 3.0))


UNITS_OF_WRITERS = ["nm", np.bytes_("nm"), np.array([b"nm"]), np.array("nm", dtype=h5py.string_dtype()),
                    np.array(["nm"], dtype=h5py.string_dtype()), "nanometer", "Nanometers", np.array(b"nm", "S8")]  # fmt: skip


@pytest.mark.parametrize("units", UNITS_OF_WRITERS, ids=repr)
def test_units_are_read_whatever_wrote_them(tmp_path, units):
    assert_read(nc(tmp_path, attrs={"units": units}, writer="h5py"))


def test_xarrays_own_file_has_pixel_and_unit(tmp_path):
    z = xarray.DataArray(Z / 1e3, dims=("y", "x"), attrs={"units": "micrometer"}, name="z")
    z = z.assign_coords({name: (name, 10.0 * np.arange(9), {"units": "nm"}) for name in "xy"})
    for engine, name in (("h5netcdf", "a.nc"), ("netcdf4", "b.nc"), ("scipy", "c.nc")):
        z.to_netcdf(tmp_path / name, engine=engine)
        assert_read(tmp_path / name)
    z.transpose("x", "y").to_netcdf(tmp_path / "d.nc")
    assert_read(tmp_path / "d.nc")
    z.expand_dims("time").to_netcdf(tmp_path / "e.nc")
    assert_read(tmp_path / "e.nc")


@pytest.mark.parametrize("transposed", [False, True])
def test_x_and_y_of_a_file_need_not_be_coordinates(tmp_path, transposed):
    with netCDF4.Dataset(tmp_path / "scan.nc", "w") as file:
        for name, dim in (("y", "ny"), ("x", "nx")):
            file.createDimension(dim, 9)
            file.createVariable(name, "f8", (dim,))[:] = (10.0 if name == "y" else 20.0) * np.arange(9)
            file[name].units = "nm"
        file.createVariable("z", "f8", ("nx", "ny") if transposed else ("ny", "nx"))[:] = Z
        file["z"].units = "nm"
    assert read_map(tmp_path / "scan.nc").pixel == pytest.approx((2e-8, 1e-8))
    with h5py.File(tmp_path / "scan.h5", "w") as file:
        file["x"], file["y"], file["z"] = 0.01 * np.arange(9), 0.01 * np.arange(9), Z
        for name, unit in (("x", "um"), ("y", "um"), ("z", "nm")):
            file[name].attrs["Units"] = unit
    assert_read(tmp_path / "scan.h5")


def test_the_pixel_that_is_given_goes_before_that_of_the_file(tmp_path):
    path = nc(tmp_path)
    read = read_map(path, pixel="20 nm")
    assert read.pixel == (2e-8, 2e-8)
    assert any("pixel is 20.00 nm x 20.00 nm, and the map says 10.00 nm x 10.00 nm" in said for said in read.warnings)
    bare = nc(tmp_path, coordinates=False)
    assert_read(bare, pixel="10 nm")
    with pytest.raises(SceneError, match="does not say how large its pixels are; give pixel="):
        read_map(bare)


def test_datasets_are_named_by_path_or_number(tmp_path):
    with h5py.File(tmp_path / "scan.h5", "w") as file:
        file["forward/height"], file["forward/phase"] = Z, ROUGH
        file["forward/height"].attrs["units"] = "nm"
        file["note"] = "text"
        file.create_dataset("table", data=np.zeros(3, dtype=[("a", "f8")]))
    path = tmp_path / "scan.h5"
    with pytest.raises(SceneError, match="one of 0: forward/height, 1: forward/phase"):
        read_map(path, pixel=PIXEL)
    for channel in ("forward/height", "/forward/height", 0):
        assert_read(path, pixel=PIXEL, channel=channel)
    assert read_map(path, pixel=PIXEL, channel=0).source == f"{path}, channel forward/height"
    with pytest.raises(SceneError, match="has no dataset back; it has 0: forward/height"):
        read_map(path, pixel=PIXEL, channel="back")


def test_datasets_that_are_elsewhere_or_too_large_are_refused(tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["z"] = Z
    path = tmp_path / "scan.h5"
    with h5py.File(path, "w") as file:
        file["link"] = h5py.ExternalLink("other.h5", "z")
        layout = h5py.VirtualLayout((9, 9), "f8")
        layout[:] = h5py.VirtualSource("other.h5", "z", (9, 9))
        file.create_virtual_dataset("virtual", layout)
        file.create_dataset("huge", (1 << 20, 1 << 20), chunks=(64, 64), dtype="f8")
    for channel, said in (("link", "no dataset link"), ("virtual", "other files"), ("huge", "more values than|pixels")):
        with pytest.raises(SceneError, match=said):
            read_map(path, channel=channel, **GIVEN)


# Pictures.


def test_tiff_has_heights_and_perhaps_a_pixel(tmp_path):
    path = tmp_path / "scan.tif"
    tifffile.imwrite(path, Z.astype("f4"))
    assert_read(path, **GIVEN)
    # 1e6 pixels per cm are 10 nm; 72 per inch are for printing.
    tifffile.imwrite(path, Z.astype("f8"), resolution=(1e6, 1e6), resolutionunit="CENTIMETER")
    assert_read(path, height_unit="nm")
    tifffile.imwrite(path, Z.astype("f4"), imagej=True, resolution=(100.0, 100.0), metadata={"unit": "um"})
    assert_read(path, height_unit="nm")
    tifffile.imwrite(path, Z.astype("f4"), resolution=(72, 72), resolutionunit="INCH")
    with pytest.raises(SceneError, match="does not say how large its pixels are, nor in which unit"):
        read_map(path)
    z = Z.astype("f4")
    z[0, 0] = -9999.0
    tifffile.imwrite(path, z, extratags=[(42113, "s", 0, "-9999", True)])
    assert_read(path, missing=1, **GIVEN)
    tifffile.imwrite(path, np.zeros((9, 9, 3), "u1"), photometric="rgb")
    with pytest.raises(SceneError, match="is a picture of 9 x 9 x 3 values"):
        read_map(path, **GIVEN)
    tifffile.imwrite(path, np.stack([ROUGH[:9, :9], Z]).astype("f4"), photometric="minisblack", metadata=None)
    assert_read(path, channel=1, **GIVEN)
    with pytest.raises(SceneError, match="name the channel, one of 0: page 0, 1: page 1"):
        read_map(path, **GIVEN)


# Arrays, units, factors.

NAMES = {
    1e-9: ["nm", "nanometer", "nanometre", "nanometers", "Nanometers", "NanoMeters", "[nm]", " nm ", "(nm)"],
    1e-6: ["um", "\u00b5m", "\u03bcm", "~m", "micron", "microns", "micrometer", "Micrometres", "MICRO_METER"],
    1e-10: ["\u00c5", "\u212b", "A\u030a", "angstrom", "Angstroms", "ångström"],
    1e-12: ["pm", "picometer"],
    1e-3: ["mm"],
    1.0: ["m", "meter", "metres"],
}


@pytest.mark.parametrize(("size", "name"), [(size, name) for size, names in NAMES.items() for name in names])
def test_units_have_many_names(size, name):
    assert lengths.metres(name) == size
    assert_read(Z * 1e-9 / size, height_unit=name, pixel=f"{1e-8 / size:.10g} {name.strip(' []()')}")
    assert_read(xarray.DataArray(Z * 1e-9 / size, dims=("y", "x"), attrs={"units": name}), pixel=PIXEL)


@pytest.mark.parametrize("name", ["V", "deg", "A", "Nm", "nM", "NM", "mol", "nm/s", "", "s"])
def test_other_units_are_none_of_length(name):
    assert lengths.metres(name) is None
    with pytest.raises(SceneError, match=r"height_unit = .*: a unit of length is needed"):
        read_map(Z, pixel=PIXEL, height_unit=name)


def test_lengths_of_steps_have_many_names_too():
    for name in ("nm", "nanometers", "\u00c5ngstr\u00f6m", "\u03bcm", "~m"):
        steps = surface.steps_of(
            "plane", None, smooth=f"2.5e2 {name}", prominence=f"\u22120 {name}", min_distance="1e-1um", cutoffs=None
        )
        assert steps.smooth == pytest.approx(250 * lengths.metres(name), rel=1e-15)
        assert (steps.prominence, steps.min_distance) == (0.0, 1e-7)
    for smooth in ("250", "250 V", "1e999 nm", "2,5 nm", [1, 2], np.nan, 3 * UNITS.volt):
        with pytest.raises(SceneError, match=r"^smooth = "):
            surface.steps_of("plane", None, smooth=smooth, prominence=None, min_distance=None, cutoffs=None)


NM = UNITS.nanometer
PIXELS = [
    1e-8, (1e-8, 1e-8), [1e-8], np.array([1e-8, 1e-8]), np.float64(1e-8), np.array(1e-8), "10 nm", "10 nm,10 nm",
    "10nm, 0.01 um", ["10 nm", "0.01 \u03bcm"], "1e1 nm", 10 * NM, np.array([10, 10]) * NM, np.array([10.0]) * NM,
    np.array(["10 nm", "10 nm"]), np.array([10 * NM, "10 nm"], dtype=object), [10 * NM, 0.01 * UNITS.um], (10 * NM, "10 nm"), xarray.DataArray(1e-8),
]  # fmt: skip


@pytest.mark.parametrize("pixel", PIXELS, ids=repr)
def test_a_pixel_is_given_in_any_shape(pixel):
    assert_read(Z * 1e-9, pixel=pixel)
    assert read_map(Z * 1e-9, pixel=(1e-8, 2e-8)).pixel == (1e-8, 2e-8)


@pytest.mark.parametrize(
    "pixel",
    [(1, 2, 3), [], 0.0, -1e-8, np.nan, "10", "10 kg", "x", 10 * UNITS.volt, pytest.param(object(), id="object"), "10 nm;3 nm", 1e9],
    ids=repr,
)
def test_a_pixel_that_is_none_is_named(pixel):
    with pytest.raises(SceneError, match=r"^pixel"):
        read_map(Z * 1e-9, pixel=pixel)


def test_heights_of_pint_are_scaled_once():
    assert_read(Z * NM, pixel=10 * NM)
    assert_read(Z * NM, pixel=np.array([10, 10]) * NM, height_unit="nm")
    assert_read(Z / 1e3 * UNITS.micrometer, pixel=10 * NM, height_unit="nm")
    assert_read(Z * NM, pixel=10 * NM, height_unit=UNITS.nanometer)
    for unit in (1 * NM, np.array([1.0]) * NM, np.array(["nm"]), np.array("nm"), [NM], b"nm"):
        assert_read(Z, pixel=10 * NM, height_unit=unit)
    with pytest.raises(SceneError, match="map: its heights are in V, which is no unit of length; give factor"):
        read_map(Z * UNITS.volt, pixel=PIXEL)
    assert_read(Z / 2 * UNITS.volt, pixel=PIXEL, factor="2 nm/V")


@pytest.mark.parametrize(
    "options",
    [
        {"factor": "0.5 nm"},
        {"factor": "0.5 nm/V"},
        {"factor": "5e-4 um / count"},
        {"factor": 0.5, "height_unit": "nm"},
        {"factor": "0.5", "height_unit": "nm"},
        {"factor": 5e-10},
        {"factor": 0.5 * NM},
        {"factor": 0.5 * NM / UNITS.volt},
        {"height_unit": "0.5 nm"},
    ],
    ids=repr,
)
def test_a_factor_makes_heights_of_counts(options):
    assert_read(2 * Z, pixel=PIXEL, **options)


def test_a_factor_makes_heights_of_volts(tmp_path):
    path = nc(tmp_path, Z / 2, {"units": "V"})
    for options in ({"factor": "2 nm/V"}, {"factor": 2, "height_unit": "nm"}, {"factor": "2 nm"}):
        assert_read(path, **options)
    for options in ({}, {"height_unit": "nm"}):
        with pytest.raises(
            SceneError,
            match=r'its heights are in V, which is no unit of length; give factor, such as factor="0\.5 nm/V"',
        ):
            read_map(path, **options)
    with pytest.raises(SceneError, match=r"factor = '2 nm/rad': .* has its heights in V"):
        read_map(path, factor="2 nm/rad")
    with pytest.raises(SceneError, match="is a length, and height_unit"):
        read_map(path, factor="2 nm/V", height_unit="nm")
    # Of heights in nm a number is a calibration, and a length per volt is none.
    assert_read(nc(tmp_path, Z / 2), factor=2)
    with pytest.raises(SceneError, match="has its heights in nm"):
        read_map(nc(tmp_path), factor="2 nm/V")


@pytest.mark.parametrize("factor", ["nm/V", "two", 0, np.nan, "0 nm/V", 3 * UNITS.kelvin, pytest.param(object(), id="object")], ids=repr)
def test_a_factor_that_is_none_is_named(factor):
    with pytest.raises(SceneError, match=r"^factor"):
        read_map(Z, pixel=PIXEL, factor=factor)


def test_a_mask_leaves_heights_out(tmp_path):
    mask = np.zeros((9, 9), dtype=bool)
    mask[0, 0] = True
    z = np.where(mask, 500.0, Z)
    np.save(tmp_path / "mask.npy", mask)
    np.savetxt(tmp_path / "mask.txt", mask.astype(int), fmt="%d")
    for given in (mask, mask.astype(int), mask.tolist(), tmp_path / "mask.npy", str(tmp_path / "mask.txt")):
        assert_read(z, missing=1, mask=given, **GIVEN)
    with pytest.raises(SceneError, match=r"^mask: has the shape 3 x 9, and the map 9 x 9"):
        read_map(Z, mask=mask[:3], **GIVEN)
    with pytest.raises(SceneError, match=r"^map: 0 of 81 heights are known"):
        read_map(Z, mask=np.ones((9, 9)), **GIVEN)


def test_arrays_of_xarray_say_what_they_are():
    z = xarray.DataArray(Z, dims=("y", "x"), attrs={"units": "nanometer"}, name="z")
    placed = z.assign_coords({name: (name, 0.01 * np.arange(9), {"units": "micrometer"}) for name in "xy"})
    assert_read(placed)
    data = placed.to_dataset()
    assert_read(data)
    assert read_map(data).source == "z"
    both = data.assign(phase=placed)
    assert_read(both, channel="z")
    assert_read(both, channel=0)
    with pytest.raises(
        SceneError, match="map: has 2 variables that may be maps; name the channel, one of 0: z, 1: phase"
    ):
        read_map(both)
    with pytest.raises(SceneError, match="map: has no variable of two dimensions"):
        read_map(xarray.Dataset())
    # Numbers of pixels are no places.
    with pytest.raises(SceneError, match="pixel: an array does not say how large"):
        read_map(z.assign_coords(x=np.arange(9), y=np.arange(9)))
    with pytest.raises(SceneError, match=r"how large its pixels are; give"):
        read_map(z.assign_coords(x=np.arange(9.0), y=np.arange(9.0)))


def test_coordinates_without_units_have_none(tmp_path):
    z = xarray.DataArray(Z, dims=("y", "x"), attrs={"units": "nm"}, name="z")
    bare = z.assign_coords(x=10.0 * np.arange(9), y=10.0 * np.arange(9))
    bare.to_netcdf(tmp_path / "scan.nc")
    for source in (bare, bare.to_dataset(), tmp_path / "scan.nc"):
        with pytest.raises(SceneError, match=r'x has steps of 10, but no attribute units such as "m"\); give pixel='):
            read_map(source)
        assert_read(source, pixel="10 nm")
    for axis in "xy":
        bare[axis] = bare[axis] / 1e9
        bare[axis].attrs["units"] = "m"
    assert_read(bare)
    with pytest.raises(SceneError, match="coordinate x is not evenly spaced"):
        read_map(z.assign_coords(x=np.arange(9) ** 2, y=np.arange(9)), pixel=PIXEL)


@pytest.mark.parametrize("start", [0.0, 1e3, -1e3])
@pytest.mark.parametrize("sign", [1, -1])
def test_coordinates_in_single_precision_are_even(tmp_path, start, sign):
    """At 1000 um they are rounded to 0.06 nm, a hundredth of a pixel."""
    places = (start + sign * 0.01 * np.arange(9)).astype("f4")
    z = xarray.DataArray(Z, dims=("y", "x"), attrs={"units": "nm"}, name="z")
    z = z.assign_coords({axis: (axis, places, {"units": "um"}) for axis in "xy"})
    z.to_netcdf(tmp_path / "scan.nc")
    for source in (z, tmp_path / "scan.nc"):
        assert read_map(source).pixel == pytest.approx((PIXEL, PIXEL), rel=1e-2)
        assert_read(source, pixel="10 nm")


def test_coordinates_that_agree_with_the_pixel_are_taken():
    """A stage that is off by less than half a pixel; a line that is left out is more."""
    z = xarray.DataArray(Z, dims=("y", "x"), attrs={"units": "nm"}, name="z")
    off = np.arange(9) + 0.4 * (np.arange(9) % 2)
    lost = np.delete(np.arange(10.0), 5)
    for places, agree in ((off, True), (off[::-1], True), (lost, False), (np.arange(9.0) ** 2, False)):
        uneven = z.assign_coords(x=("x", 10.0 * places, {"units": "nm"}), y=("y", 10.0 * np.arange(9), {"units": "nm"}))
        with pytest.raises(SceneError, match=r"^map: its coordinate x is not evenly spaced"):
            read_map(uneven)
        if agree:
            assert_read(uneven, pixel="10 nm")
        else:
            with pytest.raises(SceneError, match="its coordinate x is not evenly spaced"):
                read_map(uneven, pixel="10 nm")


@pytest.mark.parametrize(
    ("source", "said"),
    [
        (np.zeros(9), "^map: a line scan"),
        (np.zeros((1, 9)), "^map: a line scan"),
        (np.zeros((9, 9, 3)), r"^map: an array of 2 dimensions \(y, x\) is needed, and this has 3: 9 x 9 x 3"),
        (np.float64(3.0), "^map: a single number"),
        (np.where(Z == 5.0, np.inf, Z), "^map: 1 of its heights are infinite, the first in row 4, column 4"),
        (Z.astype(complex), "^map: real numbers"),
        ([["a", "b"]], "^map: an array of real numbers"),
        (Z * np.nan, "^map: 0 of 81 heights are known"),
    ],
)
def test_arrays_that_are_no_maps_are_refused(source, said):
    with pytest.raises(SceneError, match=said):
        read_map(source, pixel=PIXEL)


def test_all_that_a_file_does_not_say_is_asked_for_at_once(tmp_path):
    np.save(tmp_path / "scan.npy", Z)
    for path in (tmp_path / "scan.npy", written(tmp_path, rows())):
        asked = r'does not say how large its pixels are, nor in which unit its heights are; give pixel="10 nm" and height_unit="nm"'
        with pytest.raises(SceneError, match=asked):
            stiction.find_asperities(path)
        with pytest.raises(SceneError, match=r'does not say in which unit its heights are; give height_unit="nm"'):
            read_map(path, pixel=PIXEL)
        with pytest.raises(SceneError, match=r'does not say how large its pixels are; give pixel="10 nm"'):
            read_map(path, height_unit="nm")


# Warnings.


def test_a_pixel_that_is_the_whole_scan_is_warned_of(tmp_path):
    path = written(tmp_path, HEADERS["Gwyddion"] + rows())
    assert read_map(path).warnings == read_map(path, pixel="10 nm").warnings == []
    for pixel in ("90 nm", ("90 nm", "90 nm")):
        said = read_map(path, pixel=pixel).warnings
        assert said == [
            "pixel is 90.00 nm x 90.00 nm, which is the whole scan: one of its 9 x 9 pixels is 10.00 nm x 10.00 nm"
        ]
    # What finds the asperities hands it on, as a warning or in the file.
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = stiction.find_asperities(path, pixel="90 nm")
    handed_on = [*(str(one.message) for one in caught), str(found.attrs["warnings"])]
    assert any("which is the whole scan" in one for one in handed_on)


def rough(pixels, slope, pixel):
    """A Gaussian surface with waves of 8 pixels and longer, and a slope."""
    noise = np.fft.fft2(np.random.default_rng(8).normal(size=(pixels, pixels)))
    q = np.hypot(*np.meshgrid(np.fft.fftfreq(pixels), np.fft.fftfreq(pixels)))
    z = np.fft.ifft2(np.where((q > 0) & (q < 1 / 8), noise * np.maximum(q, 1 / 64) ** -1.8, 0.0)).real
    return z * slope * pixel / np.std(np.diff(z))


@pytest.mark.parametrize(
    ("pixel", "slope"),
    # A hard disk, a wafer, etched silicon, blasted steel, and polished glass under an optical profiler.
    [(2e-9, 0.02), (1e-8, 1e-3), (2e-8, 0.3), (1e-6, 0.5), (8e-7, 1e-3)],
)
def test_a_pixel_that_is_right_is_not_warned_of(pixel, slope):
    z = rough(256, slope, pixel)
    assert read_map(z, pixel=pixel).warnings == []
    if pixel < 1e-7:
        said = read_map(z, pixel=1e4 * pixel).warnings
        assert len(said) == 1 and "is the whole scan, the pixel is" in said[0]


@pytest.mark.parametrize("mark", [-9999.0, -32768.0, 1e20, np.finfo("f4").max, 9.969209968386869e36])
def test_marks_of_missing_heights_that_nothing_declares_are_warned_of(mark):
    z = Z.copy()
    z[0, :2] = mark
    said = read_map(z, **GIVEN).warnings
    assert any(one.startswith("2 of the heights are") and "mask" in one for one in said)
    # Counts of an instrument reach their ends, too.
    counts = np.linspace(-32768, 32767, 81).reshape(9, 9)
    assert not any("mark missing ones" in one for one in read_map(counts, **GIVEN).warnings)


def test_names_and_sources(tmp_path):
    np.save(tmp_path / "scan.npy", Z)
    read = read_map(tmp_path / "scan.npy", **GIVEN)
    assert (read.name, read.source) == ("scan.npy", str(tmp_path / "scan.npy"))
    assert read_map(Z, **GIVEN).source == "array"
    found = stiction.find_asperities(nc(tmp_path))
    written_down = [found.attrs[name] for name in ("map", "map_source", "height_unit")]
    assert written_down == ["scan.nc", f"{tmp_path / 'scan.nc'}, channel z", ""]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("scan.txt", b"", "is empty"),
        ("scan.txt", b"only words\n", "holds no row of numbers"),
        ("scan.txt", b"nan nan nan nan\n" * 4, "0 of 16 heights are known"),
        ("scan.npy", b"\x93NUMPY\x01\x00", "is damaged"),
        ("scan.h5", b"\x89HDF\r\n\x1a\n" + bytes(100), "is damaged"),
        ("scan.nc", b"CDF\x01" + bytes(5), "is damaged"),
        ("scan.tif", b"II*\0" + bytes(5), "is damaged"),
        ("scan.npz", b"PK\x03\x04", "is damaged"),
        ("scan.zip", b"PK\x03\x04", "is damaged"),
        ("scan.doc", b"PK\x03\x04" + bytes(4), "SurfaceTopography cannot read it: none of its formats"),
        ("scan.nid", bytes(range(256)), "SurfaceTopography cannot read it: none of its formats"),
    ],
)
def test_a_file_that_is_no_map_is_named(tmp_path, name, content, said):
    path = written(tmp_path, content, name)
    with pytest.raises(SceneError, match=said) as caught:
        read_map(path, **GIVEN)
    assert str(caught.value).startswith(str(path)) and "\n" not in str(caught.value)
