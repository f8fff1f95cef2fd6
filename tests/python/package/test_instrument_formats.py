"""Maps in files of instruments: summits where they were put, x and y apart, in four formats. Two of them are written here, byte by byte,
from their published layouts (the file format of Gwyddion; ISO 25178-71), so that no reader is tested by its own writer alone."""

import struct
import sys

import numpy as np
import pytest
import SurfaceTopography
import xarray

import stiction

# Pixels that are not square, and not as many in x as in y.
DX, DY, NX, NY = 20e-9, 25e-9, 60, 40
# Column, row and height (m) of bumps on a flat; no two lie alike after a transposition or a reflection.
BUMPS = [(10, 8, 4e-9), (45, 12, 6e-9), (22, 30, 5e-9), (50, 33, 3e-9)]


def heights(missing=False):
    """Heights over y and x, m."""
    y, x = np.mgrid[0:NY, 0:NX]
    bumps = (height * np.exp(-((x - i) ** 2 + (y - j) ** 2) / 8.0) for i, j, height in BUMPS)
    flat = np.sum(list(bumps), axis=0)
    if missing:
        flat[20, 5] = np.nan
    return flat


def topography():
    return SurfaceTopography.Topography(heights().T, (NX * DX, NY * DY), unit="m")


def gwy(path):
    def component(name, kind, data):
        return name.encode() + b"\0" + kind.encode() + data

    def thing(name, components):
        content = b"".join(components)
        return name.encode() + b"\0" + struct.pack("<I", len(content)) + content

    unit = thing("GwySIUnit", [component("unitstr", "s", b"m\0")])
    field = thing(
        "GwyDataField",
        [
            component("xres", "i", struct.pack("<i", NX)),
            component("yres", "i", struct.pack("<i", NY)),
            component("xreal", "d", struct.pack("<d", NX * DX)),
            component("yreal", "d", struct.pack("<d", NY * DY)),
            component("si_unit_xy", "o", unit),
            component("si_unit_z", "o", unit),
            component("data", "D", struct.pack("<I", NX * NY) + heights().astype("<f8").tobytes()),
        ],
    )
    title = component("/0/data/title", "s", b"Height\0")
    path.write_bytes(b"GWYP" + thing("GwyContainer", [component("/0/data", "o", field), title]))


def sdf(path):
    header = {
        "ManufacID": "none", "CreateDate": "010120260000", "ModDate": "010120260000", "NumPoints": NX, "NumProfiles": NY,
        "Xscale": DX, "Yscale": DY, "Zscale": 1e-9, "Zresolution": 1e-12, "Compression": 0, "DataType": 7, "CheckType": 0,
    }  # fmt: skip
    lines = ["aISO-1.0", *(f"{name} = {value}" for name, value in header.items()), "*"]
    lines += [" ".join(f"{z / 1e-9:.12g}" for z in row) for row in heights()]
    path.write_text("\n".join([*lines, "*", ""]))


FORMATS = {
    "gwy": gwy,
    "sdf": sdf,
    "x3p": lambda path: topography().to_x3p(str(path)),
    "nc": lambda path: topography().to_netcdf(str(path)),
}


def summits(found):
    """Column, row and height of each asperity, by rows."""
    table = found.asperities
    places = zip(table.x.values / DX - 0.5, table.y.values / DY - 0.5, table.height.values, strict=True)
    # Ripples of rounding on the flat between the bumps are summits, too.
    return sorted((row, column, height) for column, row, height in places if height > 1e-9)


def assert_as_put(found):
    found_ones, put = summits(found), sorted((j, i, height) for i, j, height in BUMPS)
    assert len(found_ones) == len(put)
    mean = heights().mean()
    for (row, column, height), (j, i, top) in zip(found_ones, put, strict=True):
        assert abs(row - j) < 0.5 and abs(column - i) < 0.5
        assert height == pytest.approx(top - mean, rel=1e-3)


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_file_of_an_instrument_is_read_with_x_along_its_rows(suffix, tmp_path):
    path = tmp_path / f"scan.{suffix}"
    FORMATS[suffix](path)
    found = stiction.find_asperities(path, level="none")
    assert_as_put(found)
    assert list(found.attrs["map_shape"]) == [NY, NX]
    assert found.attrs["pixel_size"] == pytest.approx([DY, DX])
    assert found.attrs["map"].startswith("scan")


def test_an_array_has_y_first(tmp_path):
    assert_as_put(stiction.find_asperities(heights(), pixel=(DX, DY), level="none"))
    assert_as_put(stiction.find_asperities(heights().tolist(), pixel=("20 nm", "25 nm"), level="none"))


def test_a_topography_has_x_first_and_is_transposed():
    assert_as_put(stiction.find_asperities(topography(), level="none"))
    nanometres = topography().to_unit("nm")
    assert_as_put(stiction.find_asperities(nanometres, level="none"))
    with pytest.raises(stiction.SceneError, match="no unit"):
        stiction.find_asperities(SurfaceTopography.Topography(heights().T, (NX * DX, NY * DY)))
    with pytest.raises(stiction.SceneError, match="line scan"):
        stiction.find_asperities(SurfaceTopography.UniformLineScan(heights()[0], NX * DX, unit="m"))


@pytest.mark.parametrize("dims", [("y", "x"), ("x", "y")])
def test_a_data_array_names_its_axes_and_has_its_pixels(dims):
    coordinates = {
        "x": ("x", 20.0 * np.arange(NX), {"units": "nm"}),
        "y": ("y", 25.0 * np.arange(NY), {"units": "nm"}),
    }
    array = xarray.DataArray(heights() / 1e-9, dims=("y", "x"), coords=coordinates, attrs={"units": "nm"})
    assert_as_put(stiction.find_asperities(array.transpose(*dims), level="none"))
    uneven = array.assign_coords(x=20.0 * np.arange(NX) ** 1.1)
    with pytest.raises(stiction.SceneError, match="coordinate x is not evenly spaced"):
        stiction.find_asperities(uneven)


def test_missing_pixels_are_nan_or_masked():
    whole = stiction.find_asperities(heights(), pixel=(DX, DY), level="none")
    for holey in (heights(missing=True), np.ma.masked_invalid(heights(missing=True))):
        found = stiction.find_asperities(holey, pixel=(DX, DY), level="none")
        assert found.attrs["missing_pixels"] == 1 and whole.attrs["missing_pixels"] == 0
        assert [place[:2] for place in summits(found)] == [place[:2] for place in summits(whole)]


def test_a_file_that_is_none_is_named(tmp_path):
    (tmp_path / "scan.gwy").write_bytes(b"GWYP nothing")
    with pytest.raises(stiction.SceneError, match=r"scan\.gwy: SurfaceTopography cannot read it"):
        stiction.find_asperities(tmp_path / "scan.gwy")


def test_without_the_extra_the_message_names_it(tmp_path, monkeypatch):
    gwy(tmp_path / "scan.gwy")
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with pytest.raises(stiction.SceneError, match=r"pip install stiction\[maps\]"):
        stiction.find_asperities(tmp_path / "scan.gwy")


@pytest.mark.parametrize(
    ("map", "options", "message"),
    [
        (np.zeros(5), {"pixel": 1e-8}, "^map: a line scan has a spectrum"),
        (np.zeros((5, 5, 3)), {"pixel": 1e-8}, "2 dimensions"),
        (np.zeros((5, 5)), {}, "pixel: an array does not say"),
        (np.zeros((5, 5)), {"pixel": (1, 2, 3)}, "a width, or a width and a height"),
        (np.zeros((5, 5)), {"pixel": 1e-8, "channel": "z"}, "only files and datasets have channels"),
        (np.zeros((5, 5)), {"pixel": 1e-8}, "^map: .* at least 8 of each"),
        (np.zeros((9, 9)), {"pixel": 1e-8}, "^map: .* flat"),
        (heights(), {"pixel": 1e-8, "level": "cubic"}, "level"),
        ("nope.gwy", {}, "no such file"),
    ],
)
def test_an_argument_that_is_wrong_is_named(map, options, message):
    with pytest.raises(stiction.SceneError, match=message):
        stiction.find_asperities(map, **options)
