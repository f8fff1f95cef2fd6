"""The engine for xarray, and tables of single replicas."""

import tomllib

import h5py
import numpy as np
import pytest
import xarray
from conftest import CONFIGS

import stiction
from stiction.backend import StictionBackend

QUICK = tomllib.loads((CONFIGS / "quick.toml").read_text(encoding="utf-8")) | {
    "separation": {"h_star": {"from": 1.0, "to": 6.0, "count": 11}}, "ensemble": {"replicas": 8, "seed": 1},
}  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return stiction.run(QUICK, tmp_path_factory.mktemp("backend") / "run.h5")


def test_only_results_are_guessed(run, tmp_path):
    other, text = tmp_path / "other.h5", tmp_path / "text.h5"
    with h5py.File(other, "w") as file:
        file["z"] = [1.0]
    text.write_text("no")
    backend = StictionBackend()
    assert backend.guess_can_open(run.path) and backend.guess_can_open(str(run.path))
    for no in (other, text, tmp_path, tmp_path / "none.h5", "https://example.org/run.h5", 3, None):
        assert not backend.guess_can_open(no)


def test_h_star_selects_in_all_ways_of_opening(run):
    tree = xarray.open_datatree(run.path, engine=StictionBackend)
    part = xarray.open_datatree(run.path, engine=StictionBackend, group="ensemble")
    group = xarray.open_dataset(run.path, engine=StictionBackend, group="ensemble")
    for opened in (tree["ensemble"].to_dataset(), part.to_dataset(), group, run.ensemble):
        forces = opened.external_force_mean
        chosen = forces.sel(h_star=2.6, method="nearest")
        assert float(chosen) == float(forces[3]) and float(chosen.h_star) == pytest.approx(2.5)
        assert float(forces.sel(separation=float(forces.separation[3]))) == float(forces[3])


def test_an_option_that_is_not_known_is_an_error(run):
    with pytest.raises(TypeError, match="colour"):
        xarray.open_datatree(run.path, engine=StictionBackend, colour="red")


def test_replicas_are_rows_with_their_law_or_point():
    laws = stiction.compare(QUICK, ["hybrid", "emd"], ensemble=True)
    table = laws.replicas.to_dataframe()
    assert table.index.names == ["model_law", "replica"] and len(table) == 2 * 8
    thicknesses = [0.0, 0.5e-9, 1e-9]
    points = stiction.sweep(QUICK, {"surface.lubricant_thickness": ["0 nm", "0.5 nm", "1 nm"]})
    table = points.replicas.to_dataframe()
    assert table.index.names == ["surface_lubricant_thickness", "replica"] and len(table) == 3 * 8
    assert np.allclose(table.index.levels[0], thicknesses)
    one = points.ensemble.sel(surface_lubricant_thickness=0.5e-9)
    assert one.external_force_mean.ndim == 1
