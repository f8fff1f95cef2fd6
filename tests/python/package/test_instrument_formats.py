"""Maps in files of instruments: summits where they were put, x and y apart, in four formats. Two of them are written here, byte by byte,
from their published layouts (the file format of Gwyddion; ISO 25178-71), so that no reader is tested by its own writer alone."""

import struct
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
import SurfaceTopography
import xarray
from SurfaceTopography.IO.Reader import ChannelInfo

import stiction
from stiction.maps.reading import read_map

REAL = Path(__file__).resolve().parents[2] / "data" / "maps"

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


def masked(path):
    """A container of Gwyddion with a mask that marks the bumps as grains."""
    gwy(path)
    data = path.read_bytes()
    first = data[data.index(b"/0/data\0o") : data.index(b"/0/data/title")]
    grains = (heights() > 1e-9).astype("<f8").tobytes()
    mask = first.replace(b"/0/data", b"/0/mask").replace(heights().astype("<f8").tobytes(), grains)
    rest = data[data.index(b"/0/data\0o") :] + mask
    path.write_bytes(b"GWYPGwyContainer\0" + struct.pack("<I", len(rest)) + rest)


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


def bcr(path):
    """The text of BCR-STM: heights in steps of 1 pm."""
    header = {
        "fileformat": "bcrstm", "xpixels": NX, "ypixels": NY, "xlength": NX * DX * 1e9, "ylength": NY * DY * 1e9,
        "xunit": "nm", "yunit": "nm", "zunit": "nm", "bit2nm": 1e-3, "intelmode": 1,
    }  # fmt: skip
    lines = "".join(f"{name} = {value}\n" for name, value in header.items())
    data = np.rint(heights() / 1e-12).astype("<i2").tobytes()
    path.write_bytes(lines.encode().ljust(2048) + data)


WRITTEN = {**FORMATS, "bcr": bcr}
# What the files do not say.
UNSAID = {"pixel": (1.0, 1.0), "height_unit": "m"}


def assert_as_surface_topography(path, theirs, swapped=False):
    """Heights, missing ones and pixels of the package that knows the format."""
    channel = theirs.default_channel
    known = channel.physical_sizes is not None
    topography = theirs.topography(**({} if known else {"physical_sizes": channel.nb_grid_pts}))
    unit = {None: 1.0, "m": 1.0, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9}[topography.unit]
    read = read_map(path, **({} if topography.unit else UNSAID))
    expected = unit * np.ma.filled(topography.heights().astype(float), np.nan)
    np.testing.assert_allclose(read.heights, expected if swapped else expected.T, rtol=1e-12, atol=1e-24)
    if known and topography.unit:
        assert read.pixel == pytest.approx([unit * size for size in topography.pixel_size], rel=1e-12)
    assert read.source.startswith(str(path)) and read.name == path.name


@pytest.mark.parametrize("path", sorted(REAL.glob("*.[!m]*")), ids=lambda path: path.name)
def test_a_real_file_is_read_as_surface_topography_reads_it(path, tmp_path):
    inside = path
    if path.suffix == ".zip":
        with zipfile.ZipFile(path) as archive:
            inside = Path(archive.extract(archive.namelist()[0], tmp_path))
    # Of arrays of NumPy the first index is y here, and x there.
    assert_as_surface_topography(path, SurfaceTopography.open_topography(str(inside)), path.suffix == ".npy")


@pytest.mark.parametrize("suffix", WRITTEN)
def test_a_file_that_is_written_here_is_read_as_surface_topography_reads_it(suffix, tmp_path):
    path = tmp_path / f"scan.{suffix}"
    WRITTEN[suffix](path)
    assert_as_surface_topography(path, SurfaceTopography.open_topography(str(path)))


def test_sdf_with_decimal_commas_is_read_as_with_points(tmp_path):
    sdf(tmp_path / "scan.sdf")
    commas = tmp_path / "commas.sdf"
    commas.write_text((tmp_path / "scan.sdf").read_text().replace(".", ",").replace("aISO-1,0", "aISO-1.0"))
    np.testing.assert_array_equal(read_map(commas).heights, read_map(tmp_path / "scan.sdf").heights)
    assert_as_put(stiction.find_asperities(commas, level="none"))


def two_channels(path):
    """A container of Gwyddion with a second channel, twice as large in both directions."""
    gwy(path)
    data = path.read_bytes()
    first = data[data.index(b"/0/data\0o") :]
    second = first.replace(b"/0/data", b"/1/data").replace(b"Height\0", b"Second\0")
    for size in (NX * DX, NY * DY):
        second = second.replace(struct.pack("<d", size), struct.pack("<d", 2.0 * size))
    path.write_bytes(b"GWYPGwyContainer\0" + struct.pack("<I", len(first + second)) + first + second)


def test_a_channel_is_chosen_by_name_or_number(tmp_path):
    path = tmp_path / "scan.gwy"
    two_channels(path)
    first = read_map(path)
    assert first.source == f"{path}, channel Height"
    assert first.warnings == ["of its heights the channel Height is read; there are Second, too"]
    for channel in ("Height", 0):
        assert_as_put(stiction.find_asperities(path, channel=channel, level="none"))
    for channel in ("Second", 1, "1"):
        second = read_map(path, channel=channel)
        assert second.source == f"{path}, channel Second" and second.warnings == []
        assert second.pixel == pytest.approx((2.0 * DX, 2.0 * DY))
    with pytest.raises(stiction.SceneError, match="has no channel Z; it has 0: Height, 1: Second"):
        read_map(path, channel="Z")


def test_a_single_pixel_is_refused_of_an_instrument_with_two_steps(tmp_path):
    gwy(tmp_path / "scan.gwy")
    for source in (tmp_path / "scan.gwy", topography()):
        with pytest.raises(stiction.SceneError, match=r"steps of 20\.00 nm along x and 25\.00 nm along y.*leave pixel"):
            read_map(source, pixel="20 nm")


def test_a_mask_of_grains_is_said_to_leave_heights_out(tmp_path):
    path = tmp_path / "scan.gwy"
    masked(path)
    count = int(np.count_nonzero(heights() > 1e-9))
    (said,) = read_map(path).warnings
    assert said.startswith(f"the mask in the file leaves {count} of {NX * NY} heights out") and "Remove Mask" in said
    assert np.isnan(read_map(path, channel=0).heights).sum() == count and len(read_map(path, channel=0).warnings) == 1
    gwy(path)
    assert read_map(path).warnings == []
    with pytest.raises(stiction.SceneError, match="has no summit; the mask in the file leaves"):
        masked(path)
        stiction.find_asperities(path, level="none")


@pytest.mark.parametrize(
    ("name", "begins", "said"),
    [
        ("scan.gsf", b"Gwyddion Simple Field 1.0\nXRes = 2\nYRes = 2\n" + bytes(20), "Gwyddion Simple Field.*as .gwy"),
        ("scan.sur", b"DSCOMPRESSED" + bytes(500), "compressed surface of Digital Surf.*without compression"),
        ("scan.sxm", b":NANONIS_VERSION:\n2\n:SCANIT_END:\n\x1a\x04" + bytes(500), "scan of Nanonis.*as .gwy"),
        ("scan.nms", bytes(4000), "NanoFocus, whose pixels.*wrong unit: export it"),
    ],
)
def test_formats_that_are_not_read_have_advice(tmp_path, name, begins, said):
    (tmp_path / name).write_bytes(begins)
    with pytest.raises(stiction.SceneError, match=said):
        read_map(tmp_path / name, pixel=1e-8, height_unit="nm")


class Voltages(SurfaceTopography.IO.ReaderBase):
    """A reader of channels in nm, in V and in no unit that is known, as files of Bruker and Agilent have them."""

    _format = "spm"

    @property
    def channels(self):
        def channel(index, name, unit, data_unit):
            return ChannelInfo(
                self, index, name=name, dim=2, nb_grid_pts=(NX, NY), physical_sizes=(NX * DX * 1e9, NY * DY * 1e9),
                unit=unit, data_unit=data_unit,
            )  # fmt: skip

        return [channel(0, "Deflection", "nm", "V"), channel(1, "Phase", ("nm", None), None), channel(2, "Z", "nm", "nm")]

    def topography(self, channel_index=None, **_):
        data = heights().T / 1e-9
        return SurfaceTopography.Topography(data, (NX * DX * 1e9, NY * DY * 1e9), unit=self.channels[channel_index].unit)


def test_a_channel_that_is_no_height_needs_a_factor(tmp_path, monkeypatch):
    monkeypatch.setattr(SurfaceTopography, "open_topography", lambda _: Voltages())
    path = tmp_path / "scan.spm"
    path.write_bytes(bytes(9))
    assert read_map(path).source == f"{path}, channel Z" and read_map(path).warnings == []
    with pytest.raises(stiction.SceneError, match=r'its heights are in V, which .* give factor, such as factor="0\.5 nm/V"'):
        read_map(path, channel="Deflection")
    with pytest.raises(stiction.SceneError, match=r'does not say in which unit its heights are; give height_unit="nm"'):
        read_map(path, channel="Phase")
    for options in ({"channel": 0, "factor": "2 nm/V"}, {"channel": 1, "factor": 2, "height_unit": "nm"}):
        volts = read_map(path, **options)
        np.testing.assert_allclose(volts.heights, 2.0 * heights(), rtol=1e-12)
        assert volts.pixel == pytest.approx((DX, DY))


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
    coordinates = {"x": ("x", 20.0 * np.arange(NX), {"units": "nm"}), "y": ("y", 25.0 * np.arange(NY), {"units": "nm"})}
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
