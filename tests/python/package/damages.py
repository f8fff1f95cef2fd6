"""Ways to damage a result: each takes the open file and what of it is damaged."""

import inspect

import h5py
import numpy as np

# What HDF5 itself keeps of dimensions.
SCALES = ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid")
SOME = 2**45


def again(file, path, **how):
    """Makes a dataset anew, with its attributes."""
    attributes = {name: value for name, value in file[path].attrs.items() if name not in SCALES}
    del file[path]
    made = file.create_dataset(path, **how)
    for name, value in attributes.items():
        made.attrs[name] = value


class OfDatasets:
    def missing(file, path):
        del file[path]

    def renamed(file, path):
        file.move(path, f"{path}_")

    def texts(file, path):
        again(file, path, data=np.full(file[path].shape, "a$b_\n", dtype=object), dtype=h5py.string_dtype())

    def complex(file, path):
        again(file, path, data=np.full(file[path].shape, 1j))

    def compound(file, path):
        again(file, path, data=np.zeros(file[path].shape, dtype=[("a", "f8"), ("b", "i4")]))

    def lists(file, path):
        again(file, path, shape=file[path].shape, dtype=h5py.vlen_dtype("f8"))

    def scalar(file, path):
        again(file, path, data=1.0)

    def without_values(file, path):
        again(file, path, data=h5py.Empty("f8"))

    def shorter(file, path):
        again(file, path, data=np.zeros((0,) * max(file[path].ndim, 1)))

    def longer(file, path):
        again(file, path, data=np.ones(tuple(length + 1 for length in file[path].shape) or (2,)))

    def deeper(file, path):
        again(file, path, data=np.ones((1, *file[path].shape)))

    def not_a_number(file, path):
        again(file, path, data=np.full(file[path].shape, np.nan))

    def infinite(file, path):
        again(file, path, data=np.full(file[path].shape, np.inf))

    def without_dimensions(file, path):
        again(file, path, data=file[path][()], dtype=file[path].dtype)

    def without_attributes(file, path):
        for name in set(file[path].attrs) - set(SCALES):
            del file[path].attrs[name]

    def odd_unit(file, path):
        file[path].attrs["units"] = "days since $x$"

    def odd_name(file, path):
        file[path].attrs["long_name"] = "a $ b \\frac{ : 0 $a, 1 b$"

    def odd_scale(file, path):
        file[path].attrs["_FillValue"] = file[path].attrs["scale_factor"] = "x"

    def a_group(file, path):
        del file[path]
        file.create_group(path)

    def a_type(file, path):
        del file[path]
        file[path] = np.dtype("f8")

    def a_sea_of_zeros(file, path):
        again(file, path, shape=(SOME,), dtype="f8", chunks=(2**16,), compression="gzip")


class Elsewhere:
    """What a file leads to that is not in it, or is a circle."""

    def soft_loop(file, path):
        del file[path]
        file[path] = h5py.SoftLink(f"/{path}")

    def dangling(file, path):
        del file[path]
        file[path] = h5py.SoftLink("/nowhere")

    def external_link(file, path):
        del file[path]
        file[path] = h5py.ExternalLink("secret.h5", "/secret")

    def external_storage(file, path):
        again(file, path, shape=file[path].shape or (1,), dtype="f8", external=[("secret", 0, 8 * file[path].size)])

    def virtual(file, path):
        length = file[path].size
        layout = h5py.VirtualLayout((length,), "f8")
        layout[:] = h5py.VirtualSource("secret.h5", "secret", (length,))
        del file[path]
        file.create_virtual_dataset(path, layout)


class OfGroups:
    def missing(file, path):
        del file[path]

    def a_dataset(file, path):
        del file[path]
        file[path] = np.ones(3)


class Circles:
    def in_itself(file, path):
        file[path]["again"] = file[path]

    def in_the_root(file, path):
        file[path]["root"] = file["/"]

    def by_a_soft_link(file, path):
        file[path]["soft"] = h5py.SoftLink("/")


class OfAttributes:
    def missing(file, path, name):
        del file[path].attrs[name]

    def text(file, path, name):
        file[path].attrs[name] = "a $\\frac{ b\n\x1b[2J"

    def without_value(file, path, name):
        file[path].attrs[name] = h5py.Empty("f8")

    def numbers(file, path, name):
        file[path].attrs[name] = np.zeros((2, 2))

    def not_a_number(file, path, name):
        file[path].attrs[name] = np.nan


def ways(kind):
    """The functions of a class, by their names."""
    return dict(inspect.getmembers(kind, inspect.isfunction))


def places(path):
    """Paths of the datasets and of the groups of a file, and paths and names of their attributes."""
    datasets, groups, attributes = [], [], []
    with h5py.File(path) as file:
        file.visititems(lambda name, item: (groups if isinstance(item, h5py.Group) else datasets).append(name))
        for name in ["/", *groups]:
            attributes += [(name, attribute) for attribute in file[name].attrs if not attribute.startswith("_")]
    return datasets, groups, attributes


def cases(path):
    """All damages of a file: the class, the name of the way, and where."""
    datasets, groups, attributes = places(path)
    listed = [(kind, way, (name,)) for kind in (OfDatasets, Elsewhere) for way in ways(kind) for name in datasets]
    listed += [(kind, way, (name,)) for kind in (OfGroups, Circles) for way in ways(kind) for name in groups]
    return listed + [(OfAttributes, way, where) for way in ways(OfAttributes) for where in attributes]
