"""Scenes with priors: what is drawn has the laws that are given, and what is wrong is named."""

import numpy as np
import pytest
from conftest import CONFIGS
from scipy import stats

from stiction import SceneError, priors

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


def test_covariances_are_those_of_what_is_drawn():
    """2·10⁵ draws: a sample covariance is off by 4.5 of its standard errors with a probability of 7e-6 each; fixed seed."""
    covariance = np.array([[0.09, -0.021, 0.0], [-0.021, 0.01, 0.0], [0.0, 0.0, 4.0]])
    tables = {
        "material": {"work_of_adhesion": {"prior": "log_normal", "median": "50 mJ/m^2", "log_std": 0.3},
                     "hardness": {"prior": "log_normal", "median": "2 GPa", "log_std": 0.1},
                     "poisson_ratio": {"prior": "normal", "mean": 7.0, "std": 2.0}},
        "priors": {"keys": ["material.hardness", KEY], "covariance": [[0.01, -0.021], [-0.021, 0.09]]},
    }  # fmt: skip
    found = priors.read(tables)
    random = np.random.default_rng(1)
    for drawn in (found.draw(random.random((200_000, 3))), found.of_scores(random.standard_normal((200_000, 3)))):
        natural = found.natural(drawn)
        assert np.array_equal(natural[:, 0], np.log(drawn[:, 0])) and np.array_equal(natural[:, 2], drawn[:, 2])
        errors = np.sqrt((np.outer(np.diag(covariance), np.diag(covariance)) + covariance**2) / 200_000)
        assert (np.abs(np.cov(natural.T) - covariance) < 4.5 * errors).all()


def test_a_correlation_of_other_laws_is_that_of_their_normal_scores():
    """Spearman's of 2·10⁵ draws of a Gaussian copula is (6/π) arcsin(ρ/2), within 4.5 standard errors (7e-6)."""
    uniform = {"prior": "uniform", "from": 0.0, "to": 1.0}
    found = priors.read({"a": {"x": uniform, "y": uniform}, "priors": {"keys": ["a.x", "a.y"], "correlation": [[1, 0.6], [0.6, 1]]}})
    rank = stats.spearmanr(found.draw(np.random.default_rng(2).random((200_000, 2)))).statistic
    assert abs(rank - 6.0 / np.pi * np.arcsin(0.3)) < 4.5 / np.sqrt(200_000)


def test_a_fixed_number_is_no_prior():
    found = priors.read({"material": {"work_of_adhesion": {"prior": "fixed", "value": "50 mJ/m^2"}}, "a": {"x": {"prior": "normal", "mean": 1, "std": 1}}})
    assert found.keys == ["a.x"] and found.tables["material"]["work_of_adhesion"] == "50 mJ/m^2"


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
    "given, reported",
    [
        ({"prior": "loguniform"}, f"{KEY}.prior = 'loguniform': one of uniform, log_uniform"),
        ({"prior": "uniform", "from": "1 J/m^2"}, f"{KEY}.to is missing"),
        ({"prior": "uniform", "from": "1 J/m^2", "to": "2 Pa"}, "one dimension"),
        ({"prior": "uniform", "from": "1 J/m^2", "to": "2 J/m^2", "upto": 1}, f"{KEY}.upto: a prior that is uniform has from, to"),
        ({"prior": "log_uniform", "from": "0 J/m^2", "to": "2 J/m^2"}, "greater than 0"),
        ({"prior": "uniform", "from": "3 J/m^2", "to": "2 J/m^2"}, "more than `from`"),
        ({"prior": "normal", "mean": "3 J/m^2", "std": "-1 J/m^2"}, "greater than 0"),
        ({"prior": "uniform", "from": "3 furlong", "to": "2 m"}, "unknown unit \"furlong\""),
        ({"from": 1}, "no number of the scene has a prior"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(given, reported):
    with pytest.raises(SceneError, match=reported.replace("(", "\\(")):
        priors.read(scene(**given))


@pytest.mark.parametrize(
    "given, reported",
    [
        ({"keys": ["a.x", "a.w"], "correlation": [[1, 0], [0, 1]]}, "a.w has no prior; a.x, a.y, a.z have one"),
        ({"keys": ["a.x", "a.y", "a.z"], "correlation": [[1, 0.9, -0.9], [0.9, 1, 0.9], [-0.9, 0.9, 1]]}, "not positive definite"),
        ({"keys": ["a.x", "a.y"], "correlation": [[1, 0.5]]}, "a row for each of the 2 different keys"),
        ({"keys": ["a.x", "a.x"], "correlation": [[1, 0], [0, 1]]}, "different keys"),
        ({"keys": ["a.x", "a.y"], "correlation": [[2, 0], [0, 1]]}, "with itself is 1"),
        ({"keys": ["a.x", "a.y"], "covariance": [[2, 0], [0, 1]]}, "a.x has the variance 2, but its prior 1"),
        ({"keys": ["a.x", "a.z"], "covariance": [[1, 0], [0, 1]]}, "the prior of a.z is uniform; give `correlation`"),
        ({"correlation": [[1]]}, "either `correlation` or `covariance`"),
    ],
)
def test_wrong_correlations_are_refused(given, reported):
    prior = {"prior": "normal", "mean": 0.0, "std": 1.0}
    tables = {"a": {"x": prior, "y": prior, "z": {"prior": "uniform", "from": 0, "to": 1}}}
    with pytest.raises(SceneError, match=reported):
        priors.read({**tables, "priors": given})
