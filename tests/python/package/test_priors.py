"""Scenes with priors: what is drawn has the laws that are given, and what is wrong is named."""

import numpy as np
import pytest
from conftest import CONFIGS
from scipy import stats

from stiction import SceneError, priors, quantities

KEY = "material.work_of_adhesion"


def scene(**numbers):
    return {"material": {"work_of_adhesion": numbers}}


def test_laws_have_their_moments():
    """Against closed forms, at 10⁵ midpoints of the unit interval; the sums are off by less than 1e-3 of a standard deviation."""
    points = ((np.arange(100_000) + 0.5) / 100_000)[:, None]
    for given, transform, mean, std in [
        ({"prior": "uniform", "from": "10 mJ/m^2", "to": "40 mN/m"}, np.asarray, 0.025, 0.03 / np.sqrt(12)),
        ({"prior": "log_uniform", "from": 0.1, "to": 10.0}, np.log10, 0.0, 2 / np.sqrt(12)),
        ({"prior": "normal", "mean": "50 mJ/m^2", "std": "5 mJ/m^2"}, np.asarray, 0.05, 0.005),
        ({"prior": "log_normal", "median": "1 um", "log_std": 0.4}, np.log, np.log(1e-6), 0.4),
        # A half-normal law: mean √(2/π) σ and variance (1 − 2/π) σ².
        ({"prior": "normal", "mean": 0.0, "std": 2.0, "from": 0.0}, np.asarray, 2 * np.sqrt(2 / np.pi), 2 * np.sqrt(1 - 2 / np.pi)),
    ]:  # fmt: skip
        drawn = transform(priors.read(scene(**given)).draw(points)[:, 0])
        assert drawn.mean() == pytest.approx(mean, abs=1e-3 * std)
        assert drawn.std() == pytest.approx(std, rel=1e-3)


def test_densities_are_those_of_what_is_drawn():
    """A density of correlated log-normal numbers is that of scipy's joint normal law of their logarithms."""
    tables = {
        "material": {"work_of_adhesion": {"prior": "log_normal", "median": "50 mJ/m^2", "log_std": 0.3},
                     "hardness": {"prior": "log_normal", "median": "2 GPa", "log_std": 0.1}},
        "priors": {"correlation": [[KEY, "material.hardness", -0.7]]},
    }  # fmt: skip
    found = priors.read(tables)
    drawn = found.draw(np.random.default_rng(1).random((200, 2)))
    assert np.corrcoef(np.log(drawn).T)[0, 1] == pytest.approx(-0.7, abs=0.15)
    covariance = np.array([[0.09, -0.7 * 0.03], [-0.7 * 0.03, 0.01]])
    joint = stats.multivariate_normal(np.log([0.05, 2e9]), covariance).logpdf(np.log(drawn))
    np.testing.assert_allclose(found.log_density(drawn), joint - np.log(drawn).sum(axis=1), atol=1e-9)
    assert found.log_density([[-1.0, 2e9]])[0] == -np.inf


def test_a_scene_without_its_priors_is_one_of_the_program(tmp_path):
    text = (CONFIGS / "surfaces" / "file.toml").read_text(encoding="utf-8")
    path = tmp_path / "scene.toml"
    path.write_text(text.replace('hardness = "2.5 GPa"', 'hardness = { prior = "uniform", from = "2 GPa", to = "3 GPa" }'))
    found = priors.read(path)
    assert found.keys == ["material.hardness"]
    assert found.tables["material"]["hardness"] == "2500000000.0 Pa"
    assert found.tables["surface"]["heights"]["path"].startswith(str(tmp_path))
    assert found.axes([[2e9], [3e9]]) == {"material.hardness": ["2000000000.0 Pa", "3000000000.0 Pa"]}


@pytest.mark.parametrize(
    "given, told",
    [
        ({"prior": "loguniform"}, f"{KEY}.prior = 'loguniform': one of uniform, log_uniform"),
        ({"prior": "uniform", "from": "1 J/m^2"}, f"{KEY}.to is missing"),
        ({"prior": "uniform", "from": "1 J/m^2", "to": "2 Pa"}, "one dimension"),
        ({"prior": "uniform", "from": "1 J/m^2", "to": "2 J/m^2", "upto": 1}, f"{KEY}.upto: a prior that is uniform has from, to"),
        ({"prior": "log_uniform", "from": "0 J/m^2", "to": "2 J/m^2"}, "greater than 0"),
        ({"prior": "uniform", "from": "3 J/m^2", "to": "2 J/m^2"}, "more than `from`"),
        ({"prior": "normal", "mean": "3 J/m^2", "std": "-1 J/m^2"}, "greater than 0"),
        ({"prior": "uniform", "from": "3 furlong", "to": "2 m"}, "furlong is no unit"),
        ({"from": 1}, "no number of the scene has a prior"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(given, told):
    with pytest.raises(SceneError, match=told.replace("(", "\\(")):
        priors.read(scene(**given))


def test_correlations_that_no_numbers_have_are_refused():
    prior = {"prior": "normal", "mean": 0.0, "std": 1.0}
    tables = {"a": {"x": prior, "y": prior, "z": prior}}
    for pairs, told in [
        ([["a.x", "a.y", 0.9], ["a.y", "a.z", 0.9], ["a.x", "a.z", -0.9]], "too strong"),
        ([["a.x", "a.w", 0.1]], "two different keys"),
        ([["a.x", "a.y", 1.5]], "between -1 and 1"),
    ]:
        with pytest.raises(SceneError, match=told):
            priors.read({**tables, "priors": {"correlation": pairs}})


def test_units_of_scenes_are_read():
    for text, value in [("8.51 /um^2", (8.51e12, "/m^2")), ("100 um^2", (1e-10, "m^2")), ("2 µm", (2e-6, "m")),
                        ("0.2 zJ", (2e-22, "J")), ("18 cm^3/mol", (1.8e-5, "m^3/mol")), ("70 mN/m", (0.07, "J/m^2")),
                        ("3 angstrom", (3e-10, "m")), ("-2 kV", (-2000.0, "V"))]:  # fmt: skip
        number, unit = quantities.parsed("x", text)
        assert (pytest.approx(value[0], rel=1e-14), value[1]) == (number, unit)
