"""One asperity in SI against closed forms."""

import numpy as np
import pint
import pytest
import xarray

import stiction
from stiction import SceneError

TIP = {"radius": 20e-9, "reduced_modulus": 60e9, "work_of_adhesion": 0.05, "equilibrium_spacing": 2e-10}


def test_hertz_is_its_closed_form():
    depth = np.array([1e-12, 1e-10, 3e-9])
    solved = stiction.asperity(**TIP, law="hertz", interference=depth)
    load = 4.0 / 3.0 * TIP["reduced_modulus"] * np.sqrt(TIP["radius"] * depth**3)
    assert np.allclose(solved.external_force, load, rtol=1e-13)
    assert np.allclose(solved.contact_radius, np.sqrt(TIP["radius"] * depth), rtol=1e-13)
    assert solved.external_force.attrs["units"] == "N" and list(solved.external_force.interference) == list(depth)


def test_pull_off_is_that_of_jkr_and_dmt():
    depth = np.linspace(-2e-10, 2e-10, 4001)
    unit = np.pi * TIP["radius"] * TIP["work_of_adhesion"]
    for law, factor in (("jkr", 1.5), ("dmt", 2.0)):
        solved = stiction.asperity(**TIP, law=law, path="retraction", interference=depth)
        assert float(-solved.external_force.min()) == pytest.approx(factor * unit, rel=1e-5)


def test_numbers_may_have_units_in_either_way():
    ureg = pint.UnitRegistry()
    plain = stiction.asperity(**TIP, interference=1e-10, hardness=5.5e9, poisson_ratio=0.2)
    texts = stiction.asperity(
        radius="20 nm", reduced_modulus="60 GPa", work_of_adhesion="50 mJ/m^2", equilibrium_spacing="2 Å",
        interference="0.1 nm", hardness="5.5 GPa", poisson_ratio=0.2,
    )  # fmt: skip
    quantities = stiction.asperity(
        radius=20 * ureg.nm, reduced_modulus=60 * ureg.GPa, work_of_adhesion=0.05 * ureg("N/m"),
        equilibrium_spacing=0.2 * ureg.nm, interference=0.1 * ureg.nm, hardness=5.5 * ureg.GPa, poisson_ratio=0.2,
    )  # fmt: skip
    assert plain.external_force.dims == () and float(plain.external_force) == float(texts.external_force)
    assert float(quantities.external_force) == pytest.approx(float(plain.external_force), rel=1e-13)


def test_arrays_broadcast_by_their_names():
    solved = stiction.asperity(**{**TIP, "radius": [10e-9, 20e-9]}, interference=np.linspace(-1e-9, 1e-9, 5))
    assert solved.adhesion_force.dims == ("radius", "interference") and solved.adhesion_force.shape == (2, 5)
    alone = stiction.asperity(**TIP, interference=0.5e-9)
    chosen = solved.external_force.sel(radius=20e-9, interference=0.5e-9, method="nearest")
    assert float(chosen) == pytest.approx(float(alone.external_force), rel=1e-12)
    named = xarray.DataArray([0.05, 0.1], dims="surface")
    both = stiction.asperity(**{**TIP, "work_of_adhesion": named}, interference=0.0)
    ratio = both.adhesion_parameter[1] / both.adhesion_parameter[0]
    assert both.adhesion_parameter.dims == ("surface",) and float(ratio) == pytest.approx(2 ** (2 / 3), rel=1e-12)


def test_plastic_tips_flow_and_lubricated_ones_pull_from_afar():
    plastic = stiction.asperity(
        **{**TIP, "radius": 1e-6}, interference=[1e-9, 3e-8, 5e-7], hardness=1e9, poisson_ratio=0.3
    )
    assert list(plastic.regime.values)[-1] == "plastic"
    wet = stiction.asperity(**TIP, interference=-1e-9, lubricant_thickness="2 nm")
    assert str(wet.regime.values) == "lubricant" and float(wet.adhesion_force) > 0.0


def test_wrong_arguments_are_named():
    with pytest.raises(SceneError, match=r"radius = '20': a number with a unit such as nm is needed"):
        stiction.asperity(**{**TIP, "radius": "20"}, interference=0.0)
    with pytest.raises(SceneError, match="reduced_modulus"):
        stiction.asperity(**{**TIP, "reduced_modulus": "60 nm"}, interference=0.0)
    with pytest.raises(SceneError, match="radius"):
        stiction.asperity(**{**TIP, "radius": -1.0}, interference=0.0)
    with pytest.raises(SceneError, match="nolaw"):
        stiction.asperity(**TIP, interference=0.0, law="nolaw")
    with pytest.raises(SceneError, match="interference: an array of 2 dimensions needs their names"):
        stiction.asperity(**TIP, interference=np.zeros((2, 2)))
    with pytest.raises(SceneError, match="interference"):
        stiction.asperity(**TIP, interference=pint.UnitRegistry()("3 s"))
