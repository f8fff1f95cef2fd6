"""What the program depends on, by the lists of deny.toml, without a network: licences, sources, checksums, and where `unsafe` is.

`cargo deny check` knows more, known vulnerabilities above all, but has to fetch them.
"""

import json
import re
import subprocess
import tomllib
from pathlib import Path

import pytest
from program import ROOT

DENY = tomllib.loads((ROOT / "deny.toml").read_text())
CRATES_IO = "registry+https://github.com/rust-lang/crates.io-index"


def packages():
    """Everything that is built here, dependencies of tests and builds included."""
    host = re.search(r"host: (.*)", subprocess.check_output(["rustc", "-vV"], text=True))[1]
    command = ["cargo", "metadata", "--locked", "--offline", "--format-version", "1", "--all-features", "--filter-platform", host]
    metadata = json.loads(subprocess.check_output(command, cwd=ROOT))
    return [package for package in metadata["packages"] if package["source"] is not None]


def allowed(expression):
    """Whether an SPDX expression can be met with the allowed licences alone."""
    tokens = re.findall(r"[()]|[^\s()]+", expression.replace("/", " OR "))

    def alternatives():
        met = conjunction()
        while tokens and tokens[0] == "OR":
            tokens.pop(0)
            met = conjunction() or met
        return met

    def conjunction():
        met = licence()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            met = licence() and met
        return met

    def licence():
        if tokens[0] == "(":
            tokens.pop(0)
            met = alternatives()
            assert tokens.pop(0) == ")"
            return met
        name = tokens.pop(0)
        if tokens and tokens[0] == "WITH":
            name = f"{name} {tokens.pop(0)} {tokens.pop(0)}"
        return name in DENY["licenses"]["allow"]

    met = alternatives()
    assert not tokens, expression
    return met


@pytest.mark.parametrize(
    "expression, met",
    [
        ("MIT", True),
        ("GPL-3.0-only", False),
        ("MIT/Apache-2.0", True),
        ("GPL-3.0-only OR MIT", True),
        ("GPL-3.0-only AND MIT", False),
        ("(MIT OR GPL-3.0-only) AND Unicode-3.0", True),
        ("MIT OR GPL-3.0-only AND LGPL-2.1-only", True),
        ("Apache-2.0 WITH LLVM-exception", True),
        ("GPL-3.0-only WITH GCC-exception-3.1", False),
    ],
)
def test_expressions_are_understood(expression, met):
    assert allowed(expression) == met


def test_licences_are_allowed():
    clarified = {entry["name"]: entry for entry in DENY["licenses"]["clarify"]}
    found = packages()
    assert len(found) > 100
    for package in found:
        expression = package["license"]
        if expression is None:
            entry = clarified[package["name"]]
            expression = entry["expression"]
            text = (Path(package["manifest_path"]).parent / entry["license-files"][0]["path"]).read_text()
            # What the file says has to be the licence that it is taken for.
            assert expression == "BSD-3-Clause" and "covered by the 3-clause BSD License" in text, package["name"]
        assert allowed(expression), f"{package['name']}: {expression}"


def test_sources_are_the_registry_with_checksums():
    lock = tomllib.loads((ROOT / "Cargo.lock").read_text())
    assert {package["source"] for package in packages()} == {CRATES_IO}
    for package in lock["package"]:
        if package["name"] != "stiction":
            assert package["source"] == CRATES_IO and re.fullmatch("[0-9a-f]{64}", package["checksum"]), package["name"]
    banned = {entry["name"] for entry in DENY["bans"]["deny"]}
    assert banned.isdisjoint(package["name"] for package in lock["package"])


def test_no_version_is_left_open():
    manifest = tomllib.loads((ROOT / "Cargo.toml").read_text())
    targets = manifest.get("target", {}).values()
    tables = [table.get(kind, {}) for table in [manifest, *targets] for kind in ("dependencies", "dev-dependencies", "build-dependencies")]
    requirements = {name: value if isinstance(value, str) else value.get("version") for table in tables for name, value in table.items()}
    assert len(requirements) > 20
    for name, requirement in requirements.items():
        assert requirement and "*" not in requirement and ">" not in requirement, name


def test_unsafe_is_in_the_named_places_only():
    """The lint `unsafe_code` denies it elsewhere; this is of what switches the lint off."""
    manifest = tomllib.loads((ROOT / "Cargo.toml").read_text())
    assert manifest["lints"]["rust"]["unsafe_code"] == "deny"
    assert manifest["lints"]["clippy"]["undocumented_unsafe_blocks"] == "deny"
    files = [path for folder in ("src", "tests", "benches") for path in (ROOT / folder).rglob("*.rs")] + [ROOT / "build.rs"]
    assert len(files) > 80
    named = {ROOT / "src" / name for name in ("output/scales.rs", "math/instruction_set.rs", "cli/terminal.rs", "elementary.rs", "lab/abi.rs")}
    # Signals to other processes on Windows.
    named.add(ROOT / "tests/common/program.rs")
    for path in files:
        code = re.sub(r"//.*", "", path.read_text())
        found = re.search(r"\bunsafe\b|\bunsafe_code\b", code) is not None
        assert found == (path in named), path


def test_licences_of_what_is_linked_in_are_reported():
    """Every crate of the program stands in THIRD-PARTY-LICENSES; versions may be those of before an update."""
    tree = ["cargo", "tree", "--locked", "--offline", "--edges", "normal,no-proc-macro", "--prefix", "none", "--target", "x86_64-unknown-linux-gnu"]
    linked = {line.split()[0] for line in subprocess.check_output(tree, cwd=ROOT, text=True).splitlines() if line}
    reported = (ROOT / "THIRD-PARTY-LICENSES").read_text(encoding="utf-8")
    assert len(linked) > 100
    missing = {name for name in linked if not re.search(rf"^  {re.escape(name)} \d", reported, re.MULTILINE)}
    assert not missing, f"{missing}: make THIRD-PARTY-LICENSES anew, by `cargo about generate about.hbs --output-file THIRD-PARTY-LICENSES`"
    for text in ("The HDF Group", "Jean-loup Gailly", "Rust's standard library"):
        assert text in reported
