"""What a release is made by: the workflow of the forge, the recipe of conda-forge, and the versions that they name."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml
from program import ROOT

WORKFLOW = ROOT / ".github" / "workflows" / "ci.yml"
RECIPE = ROOT / "scripts" / "conda" / "recipe.yaml"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CRATE = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["package"]
# conda-forge has matplotlib without its graphical interfaces under another name.
OTHER_NAMES = {"matplotlib-base": "matplotlib"}


def linted(program, *options):
    path = Path(sys.executable).with_name(program)
    if not path.exists():
        pytest.skip(f"{program} is not installed")
    return subprocess.run([path, *options], capture_output=True, text=True)


def test_the_workflow_has_the_form_that_the_forge_reads():
    read = linted("check-jsonschema", "--builtin-schema", "vendor.github-workflows", WORKFLOW)
    assert read.returncode == 0, read.stdout + read.stderr


def test_the_workflow_gives_nobody_more_than_it_has_to():
    found = linted("zizmor", "--offline", "--no-progress", WORKFLOW)
    assert found.returncode == 0, found.stdout + found.stderr


def test_jobs_of_the_workflow_run_what_is_there():
    text = WORKFLOW.read_text(encoding="utf-8")
    named = set(re.findall(r"(?<![\w/.-])((?:scripts|docs|configs|tests|\.ci)/[\w./-]*\w)", text))
    assert {"scripts/oldest", ".ci/run", "docs/requirements.txt"} <= named
    assert [path for path in sorted(named) if not (ROOT / path).exists()] == []


def test_every_python_that_the_package_claims_is_tested():
    claimed = {line.rsplit(" ", 1)[1] for line in PROJECT["classifiers"] if re.search(r"Python :: 3\.\d+$", line)}
    tested = set(yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))["jobs"]["python"]["strategy"]["matrix"]["python"])
    assert claimed == tested and PROJECT["requires-python"] == f">={min(claimed, key=lambda version: int(version[2:]))}"


def test_a_release_waits_for_every_check():
    jobs = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))["jobs"]
    assert set(jobs["publish"]["needs"]) == set(jobs) - {"publish", "site-published"}


def test_the_oldest_rust_is_that_of_the_crate():
    jobs = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))["jobs"]
    assert jobs["oldest"]["env"]["RUSTUP_TOOLCHAIN"] == CRATE["rust-version"]


@pytest.mark.parametrize("platform", ["linux-64", "linux-aarch64", "osx-64", "osx-arm64"])
def test_the_recipe_of_conda_has_the_requirements_of_the_package(platform):
    conda = pytest.importorskip("rattler_build", reason="py-rattler-build is not installed")
    variants = conda.VariantConfig.from_yaml("c_compiler: [c]\nc_stdlib: [s]\nrust_compiler: [rust]\npython: ['3.12.*']\n")
    system = conda.RenderConfig(platform=conda.PlatformConfig(target_platform=platform))
    [rendered] = conda.Stage0Recipe.from_file(RECIPE).render(variants, system)
    recipe = rendered.recipe.to_dict()
    required = [requirement.split(" ", 1) for requirement in recipe["requirements"]["run"] if " " in requirement]
    assert sorted(OTHER_NAMES.get(name, name) + version for name, version in required) == sorted(PROJECT["dependencies"])
    assert recipe["package"]["version"] == CRATE["version"]
    assert {"LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY-LICENSES"} <= set(recipe["about"]["license_file"])
