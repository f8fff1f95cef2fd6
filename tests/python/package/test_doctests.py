"""Examples in the docstrings of the package do what they say, from the folder of the repository, where their scenes are."""

import doctest
import importlib
import pkgutil

import pytest
from conftest import ROOT

import stiction

MODULES = [module.name for module in pkgutil.iter_modules(stiction.__path__, "stiction.") if not module.ispkg]
MODULES += ["stiction.force_curves.lever", "stiction.maps.combine", "stiction.maps.ellipsoids", "stiction.maps.find", "stiction.assessment.assess", "stiction.finite_size.patches", "stiction.finite_size.study", "stiction.sensitivity.indices", "stiction.sensitivity.study", "stiction.design.search", "stiction.inference.check", "stiction.inference.density"]


@pytest.mark.parametrize("name", ["stiction", *MODULES])
def test_examples_do_what_they_say(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS).failed == 0


@pytest.mark.parametrize(
    "name",
    sorted(
        set(stiction.__all__)
        & {"assess_map", "combine_spectra", "run", "sweep", "compare", "integral", "asperity", "find_asperities", "spectral_moments"}
    ),
)
def test_functions_have_an_example(name):
    assert ">>> " in getattr(stiction, name).__doc__
