"""What sources declare of their numbers and of the steps of pixels: used, or refused by name, whatever the format."""

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.io
import tifffile
import xarray
from test_reading import GIVEN, PIXEL, ROUGH, Z, assert_read, assert_summit

import stiction
from stiction import SceneError
from stiction.maps.reading import read_map

# Whole numbers of which 0.25 n + 3 is the map in nm.
COUNTS = np.rint(4 * (Z - 3)).astype("i2")
SCALED = {"scale_factor": 0.25, "add_offset": 3.0, "units": "nm"}
# z(i, j) = −((j − 7)² + (i − 6)²)/4 nm with pixels of 10 x 20 nm: 1/R is the mean of 1/200 and 1/800 nm.
ROW, COLUMN = np.mgrid[0:14, 0:16]
LONG, LONG_RADIUS = -((COLUMN - 7.0) ** 2 + (ROW - 6.0) ** 2) / 4.0, 320e-9


# Pictures of TIFF.


def gdal(*items):
    body = "".join(f'<Item name="{name}"{more}>{value}</Item>' for name, more, value in items)
    return (42112, "s", 0, f"<GDALMetadata>{body}</GDALMetadata>", True)


def test_scale_offset_unit_and_missing_of_gdal_are_used(tmp_path):
    """NODATA is of numbers as they are stored; items of other bands are not of this one."""
    path = tmp_path / "scan.tif"
    counts = COUNTS.copy()
    counts[0, 0] = -32768
    of_band = ' sample="0" role="{}"'.format
    items = (
        ("SCALE", of_band("scale"), 0.25),
        ("OFFSET", of_band("offset"), 3),
        ("SCALE", ' sample="1" role="scale"', 7),
    )
    for more, options in (((), GIVEN), ((("UNITTYPE", of_band("unittype"), "nm"),), {"pixel": PIXEL})):
        tifffile.imwrite(path, counts, extratags=[(42113, "s", 0, "-32768", True), gdal(*items, *more)])
        assert_summit(path, missing=1, **options)
    tifffile.imwrite(path, COUNTS, extratags=[gdal(("SCALE", of_band("scale"), "a quarter"))])
    with pytest.raises(SceneError, match=r"scan\.tif: its page: its attribute scale_factor is 'a quarter', and"):
        read_map(path, **GIVEN)


def test_a_mark_that_numbers_cannot_have_marks_none(tmp_path):
    """−9999 is 241 in eight bits."""
    z = np.arange(120, 240, dtype="u1").reshape(12, 10) + np.uint8(10)
    tifffile.imwrite(tmp_path / "scan.tif", z, photometric="minisblack", extratags=[(42113, "s", 0, "-9999", True)])
    np.testing.assert_allclose(read_map(tmp_path / "scan.tif", **GIVEN).heights, 1e-9 * z)


def imagej(path, counts, **calibration):
    metadata = {"unit": "nm", "cf": 0, **calibration}
    tifffile.imwrite(path, counts, imagej=True, resolution=(0.1, 0.1), metadata=metadata)


def test_the_calibration_of_imagej_is_used(tmp_path):
    path = tmp_path / "scan.tif"
    counts = (COUNTS.astype(int) + 32768).astype("u2")
    imagej(path, counts, c0=3.0 - 8192.0, c1=0.25, vunit="nm")
    assert_summit(path)
    imagej(path, counts, c0=(3.0 - 8192.0) / 1e3, c1=0.25 / 1e3, vunit="\\u00B5m")
    np.testing.assert_allclose(read_map(path).heights, 1e-9 * Z, atol=1e-20)
    imagej(path, counts, c0=3.0 - 8192.0, c1=0.25, vunit="Gray Value")
    with pytest.raises(SceneError, match="does not say in which unit"):
        read_map(path)
    assert_read(path, height_unit="nm")
    imagej(path, counts, c0=3.0 - 8192.0, c1=0.25, vunit="V")
    with pytest.raises(SceneError, match="its heights are in V"):
        read_map(path)
    imagej(path, counts, **(dict(c0=1.0, c1=0.25, vunit="nm") | {"cf": 4}))
    with pytest.raises(SceneError, match=r"calibration by ImageJ \(cf=4\) is no straight line"):
        read_map(path)


@pytest.mark.parametrize(
    "sizes",
    [{"PhysicalSizeXUnit": "nm", "PhysicalSizeX": 10, "PhysicalSizeYUnit": "\u00b5m", "PhysicalSizeY": 0.02},
     {"PhysicalSizeX": 0.01, "PhysicalSizeY": 0.02}],
)  # fmt: skip
def test_the_pixel_of_ome_is_used(tmp_path, sizes):
    path = tmp_path / "scan.ome.tif"
    tifffile.imwrite(path, LONG.astype("f4"), metadata={"axes": "YX", **sizes})
    assert read_map(path, height_unit="nm").pixel == pytest.approx((1e-8, 2e-8))
    assert_long_radius(path, height_unit="nm")


def test_images_of_ome_with_other_pixels_say_none(tmp_path):
    path = tmp_path / "scan.ome.tif"
    with tifffile.TiffWriter(path, ome=True) as file:
        for size in (0.01, 0.02):
            metadata = {"axes": "YX", "PhysicalSizeX": size, "PhysicalSizeY": size}
            file.write(Z.astype("f4"), metadata=metadata, photometric="minisblack")
    with pytest.raises(SceneError, match="does not say how large its pixels are"):
        read_map(path, channel=0, height_unit="nm")


def test_metadata_of_ome_without_pixels_say_none(tmp_path):
    """Files of a set have a reference to another one in the place of their own metadata."""
    text = '<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06"><BinaryOnly MetadataFile="a.ome"/></OME>'
    tifffile.imwrite(tmp_path / "scan.ome.tif", Z.astype("f4"), description=text, metadata=None)
    assert_read(tmp_path / "scan.ome.tif", **GIVEN)


def test_numbers_of_pictures_are_no_heights(tmp_path):
    """Numbers that fall where a picture is brighter, and places in a palette."""
    path, grey = tmp_path / "scan.tif", np.rint(40 * (Z + 5)).astype("u1")
    tifffile.imwrite(path, grey, photometric="miniswhite")
    with pytest.raises(SceneError, match=r"is a picture: its numbers fall where it is brighter \(MinIsWhite\); save"):
        read_map(path, **GIVEN)
    tifffile.imwrite(path, grey, photometric="palette", colormap=np.zeros((3, 256), "u2"))
    with pytest.raises(SceneError, match="is a picture: its numbers are places in a palette of colours; save"):
        read_map(path, **GIVEN)
    tifffile.imwrite(path, grey, photometric="minisblack")
    np.testing.assert_allclose(read_map(path, **GIVEN).heights, 1e-9 * grey)


# Attributes of CF.


def test_attributes_of_cf_that_nothing_has_decoded_are_applied(tmp_path):
    """Of an array of whole numbers, of its coordinates, and of a file that was opened without scaling."""
    counts = COUNTS.copy()
    counts[0, 0] = -9999
    places = {axis: (axis, np.arange(9), {"scale_factor": 10.0, "units": "nm"}) for axis in "xy"}
    z = xarray.DataArray(counts, dims=("y", "x"), coords=places, attrs={**SCALED, "_FillValue": -9999}, name="z")
    assert_summit(z, missing=1)
    assert_summit(z.to_dataset(), missing=1)
    z.to_netcdf(tmp_path / "scan.nc")
    with xarray.open_dataset(tmp_path / "scan.nc", mask_and_scale=False) as opened:
        assert "scale_factor" in opened.z.attrs
        assert_summit(opened, missing=1)
    # What is scaled already is not scaled again.
    with xarray.open_dataset(tmp_path / "scan.nc") as opened:
        assert_summit(opened, missing=1)


def test_numbers_that_are_written_as_texts_are_numbers(tmp_path):
    path = tmp_path / "scan.h5"
    for kind in (str, np.bytes_, lambda text: np.array([text], dtype=h5py.string_dtype())):
        with h5py.File(path, "w") as file:
            file["z"] = COUNTS
            file["z"].attrs.update({name: kind(str(value)) for name, value in SCALED.items()})
        assert_read(path, pixel=PIXEL)
    with h5py.File(path, "a") as file:
        file["z"].attrs["scale_factor"] = "0,25"
    with pytest.raises(SceneError, match=r"scan\.h5: z: its attribute scale_factor is '0,25', and a number is needed"):
        read_map(path, pixel=PIXEL)
    with pytest.raises(SceneError, match=r"its attribute add_offset is .*, and a number is needed"):
        read_map(xarray.DataArray(COUNTS, attrs={"add_offset": [1.0, 2.0]}), pixel=PIXEL)


def test_references_among_attributes_are_left_alone(tmp_path):
    """To objects and regions, arrays of them and empty attributes: of the map, its places, groups and the file."""
    path = tmp_path / "scan.h5"
    with h5py.File(path, "w") as file:
        file["scan/z"], file["scan/x"], file["scan/y"] = Z, 10.0 * np.arange(9), 10.0 * np.arange(9)
        for item in (file, file["scan"], file["scan/z"], file["scan/x"]):
            item.attrs["positions"] = file["scan/x"].ref
            item.attrs["region"] = file["scan/z"].regionref[2:4, :]
            item.attrs.create("all", [file["scan/x"].ref, file["scan/y"].ref], dtype=h5py.ref_dtype)
            item.attrs["none"] = h5py.Empty("f8")
        for name in "xyz":
            file[f"scan/{name}"].attrs["units"] = "nm"
    assert_summit(path)


# Steps of pixels.


def assert_long_radius(source, **options):
    found = stiction.find_asperities(source, **options)
    assert found.asperities.radius.values == pytest.approx([LONG_RADIUS], rel=1e-6)


def with_places(tmp_path, name, units=None):
    """A file or an array with steps of 10 along x and 20 along y, in nm or without a unit."""
    x, y = 10.0 * np.arange(16), 20.0 * np.arange(14)
    attrs, path = {"units": units} if units else {}, tmp_path / name
    array = xarray.DataArray(LONG, dims=("y", "x"), coords={"x": ("x", x, attrs), "y": ("y", y, attrs)}, name="z")
    grids = dict(zip("xy", np.meshgrid(x, y), strict=True))
    geo = {"extratags": [(33550, "d", 3, (10.0, 20.0, 0.0), True)]}
    tags = {"geo.tif": geo, "print.tif": {"resolution": (2.0, 1.0), "resolutionunit": 1}}
    if name in tags:
        tifffile.imwrite(path, LONG.astype("f4"), **tags[name])
    elif name == "nm.tif":
        tifffile.imwrite(path, LONG.astype("f4"), imagej=True, resolution=(0.1, 0.05), metadata={"unit": "nm"})
    elif name == "ome.tif":
        metadata = {"axes": "YX", "PhysicalSizeX": 0.01, "PhysicalSizeY": 0.02}
        tifffile.imwrite(tmp_path / "scan.ome.tif", LONG.astype("f4"), metadata=metadata)
        return tmp_path / "scan.ome.tif"
    elif name.endswith(".npz"):
        kinds = {"xyz": {"x": x, "y": y, "z": LONG}, "turned": {"x": x, "y": y, "z": LONG.T},
                 "grids": {"X_um": grids["x"], "Y_um": grids["y"], "z": LONG},
                 "ij": {"x": grids["x"].T, "y": grids["y"].T, "z": LONG.T}}  # fmt: skip
        np.savez(path, **kinds[path.stem])
    elif name.endswith(".mat"):
        places = {"X": grids["x"], "Y": grids["y"]} if path.stem == "grids" else {"x": x, "y": y}
        scipy.io.savemat(path, {**places, "z": LONG})
    elif name.endswith(".nc"):
        array.to_netcdf(path)
    elif name.endswith(".h5"):
        nexus(path, path.stem, x, y, attrs)
    elif name == "esri.asc":
        rows = "\n".join(" ".join(f"{height:g}" for height in row) for row in LONG)
        path.write_text(f"ncols 16\nnrows 14\nxllcorner 0\nyllcorner 0\ndx 10.0\ndy 20.0\nNODATA_value -9999\n{rows}\n")
    elif name == "frame":
        return pd.DataFrame(LONG, index=y, columns=x)
    elif name == "texts":
        return pd.DataFrame(LONG, index=y, columns=[f"{place:g}" for place in x])
    elif name == "points":
        return np.column_stack([grids["x"].ravel(), grids["y"].ravel(), LONG.ravel()])
    else:
        return array
    return path


def nexus(path, kind, x, y, attrs):
    """NXdata with names of its axes: of the group, as NeXus has them now, and in one text at the signal, as it had."""
    with h5py.File(path, "w") as file:
        group = file.create_group("entry/data")
        group["z"], group["fast"], group["slow"] = LONG, x, y
        for name in ("fast", "slow"):
            group[name].attrs.update(attrs)
        if kind == "group":
            group.attrs.update({"NX_class": "NXdata", "signal": "z", "axes": ["slow", "fast"]})
        else:
            group["z"].attrs["axes"] = "slow:fast"


UNITLESS = ["xyz.npz", "turned.npz", "grids.npz", "ij.npz", "xyz.mat", "grids.mat", "geo.tif", "print.tif", "scan.nc",
            "group.h5", "signal.h5", "array", "esri.asc", "frame", "texts", "points"]  # fmt: skip
WITH_UNIT = ["nm.tif", "ome.tif", "scan.nc", "group.h5", "signal.h5", "array"]
SOURCES = [*((name, None) for name in UNITLESS), *((name, "nm") for name in WITH_UNIT)]


@pytest.mark.parametrize(("name", "units"), SOURCES)
def test_a_single_pixel_is_refused_where_the_source_has_two_steps(tmp_path, name, units):
    """10 x 20 nm make R = 320 nm; a pixel of 10 nm would make 200 nm."""
    source = with_places(tmp_path, name, units)
    for pixel in ("10 nm", 1e-8, ["10 nm"]):
        with pytest.raises(SceneError, match=r"along x and .* along y, and a single pixel is square; .*10 nm,20 nm"):
            read_map(source, pixel=pixel, height_unit="nm")
    assert_long_radius(source, pixel="10 nm,20 nm", height_unit="nm")
    assert read_map(source, pixel="10 nm,20 nm", height_unit="nm").heights.shape == (14, 16)
    if units:
        assert_long_radius(source, height_unit="nm")


@pytest.mark.parametrize("units", [("nm", None), (None, "nm"), ("px", "px"), ("px", None)])
def test_steps_of_which_one_has_a_unit_are_two_steps(units):
    coordinates = {
        axis: (axis, step * np.arange(count), {"units": unit} if unit else {})
        for axis, step, count, unit in zip("xy", (10.0, 20.0), (16, 14), units, strict=True)
    }
    z = xarray.DataArray(LONG, dims=("y", "x"), coords=coordinates)
    with pytest.raises(SceneError, match="steps of 10 along x and 20 along y, and a single pixel is square"):
        read_map(z, **GIVEN)
    assert_long_radius(z, pixel="10 nm,20 nm", height_unit="nm")


def test_x_and_y_of_a_dataset_are_places_of_its_map():
    grids = dict(zip(("pos_x", "pos_y"), np.meshgrid(10.0 * np.arange(16), 20.0 * np.arange(14)), strict=True))
    opened = xarray.Dataset({"z": (("b", "a"), LONG), **{name: (("b", "a"), grid) for name, grid in grids.items()}})
    with pytest.raises(SceneError, match="steps of 10 along x and 20 along y"):
        read_map(opened, channel="z", **GIVEN)
    for name in grids:
        opened[name].attrs["units"] = "nm"
    assert_long_radius(opened, channel="z", height_unit="nm")


def test_names_with_x_and_y_need_not_be_places(tmp_path):
    """Slopes along x are a map of their own."""
    np.savez(tmp_path / "scan.npz", slope_x=ROUGH, height=ROUGH)
    with h5py.File(tmp_path / "scan.h5", "w") as file:
        file["slope_x"], file["height"] = ROUGH, ROUGH
    for name in ("scan.npz", "scan.h5"):
        with pytest.raises(SceneError, match=r"2 .*s that may be maps; name the channel"):
            read_map(tmp_path / name, **GIVEN)


def test_x_that_is_no_place_is_none(tmp_path):
    """As long as no side, or of two dimensions and constant along none."""
    np.savez(tmp_path / "scan.npz", x=np.arange(5.0), y=np.arange(7.0), z=ROUGH)
    np.testing.assert_allclose(read_map(tmp_path / "scan.npz", **GIVEN).heights, 1e-9 * ROUGH)
    np.savez(tmp_path / "scan.npz", x=ROUGH, y=ROUGH, z=ROUGH)
    np.testing.assert_allclose(read_map(tmp_path / "scan.npz", **GIVEN).heights, 1e-9 * ROUGH)


def test_topostats_says_its_pixel_in_nanometres(tmp_path):
    path = tmp_path / "scan.topostats"
    with h5py.File(path, "w") as file:
        file["image"], file["pixel_to_nm_scaling"], file["topostats_file_version"] = Z, 10.0, 0.2
    assert_summit(path)
