"""Compares two results bit by bit, in all that does not tell of the run itself: python same_bits.py A.h5 B.h5. Exit code 1: they differ."""

import sys

import h5py
import numpy as np

# How long it took, on what, when, in how many sittings.
OF_THE_RUN = "diagnostics"
OF_THE_ROOT = {"created"}


def contents(path: str) -> dict[str, tuple]:
    """Type, shape and bytes of every dataset and attribute by its name."""
    found = {}

    def take(name: str, item: h5py.HLObject) -> None:
        if name.startswith(OF_THE_RUN):
            return
        if isinstance(item, h5py.Dataset):
            found[name] = bits(item[()])
        for key in item.attrs:
            # References point to places in their own file.
            if key not in OF_THE_ROOT and key not in ("REFERENCE_LIST", "DIMENSION_LIST"):
                found[f"{name}: {key}"] = bits(item.attrs[key])

    with h5py.File(path) as file:
        take("", file)
        file.visititems(take)
    return found


def bits(value: object) -> tuple:
    array = np.asarray(value)
    return array.dtype.str, array.shape, array.tolist() if array.dtype.kind == "O" else array.tobytes()


def main() -> int:
    first, second = (contents(path) for path in sys.argv[1:])
    differ = [name for name in first.keys() | second.keys() if first.get(name) != second.get(name)]
    datasets = [name for name in first if ": " not in name]
    if differ or len(datasets) < 50:
        print(f"{len(differ)} of {len(first)} differ, {len(datasets)} datasets: {', '.join(sorted(differ)[:20])}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
