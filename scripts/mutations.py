#!/usr/bin/env python3
"""Plants the mistakes of tests/mutations.toml one at a time and lists which tests catch each.

    scripts/mutations.py            all of them, about two minutes each on two cores
    scripts/mutations.py sign       those whose description has "sign" in it
    scripts/mutations.py --check    only whether each still applies; builds nothing
    scripts/mutations.py --markdown prints a table for the documentation

The tree as it stands is copied to target/mutations and changed there. Exit code 1 if a mistake survives or does not apply.
"""

import argparse
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TREE = ROOT / "target" / "mutations"
# A mistake may make a loop endless; that is then how it is caught.
MOST_SECONDS = 1800


def read(path=ROOT / "tests" / "mutations.toml"):
    return tomllib.loads(path.read_text())["mutation"]


def planted(mutation):
    """The changed text of the file of a mutation; an error if it does not apply."""
    text = (ROOT / mutation["file"]).read_text()
    count = text.count(mutation["find"])
    if count != 1 or mutation["find"] == mutation["replace"]:
        raise ValueError(f"{mutation['file']}: occurs {count} times, once is needed: {mutation['find']!r}")
    return text.replace(mutation["find"], mutation["replace"])


def copy_tree():
    shutil.rmtree(TREE, ignore_errors=True)
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    for name in subprocess.run(listed, cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\0"):
        source = ROOT / name
        if name and source.is_file():
            target = TREE / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target)


def failures(tests):
    """The failed tests, as program::test; or that it does not build, or does not end."""
    programs = [part for test in tests for part in (["--lib"] if test == "lib" else ["--test", test])]
    command = ["cargo", "test", "--release", "--no-fail-fast", "--target-dir", str(ROOT / "target"), *programs]
    try:
        run = subprocess.run(command, cwd=TREE, capture_output=True, text=True, timeout=MOST_SECONDS)
    except subprocess.TimeoutExpired:
        return ["(does not end)"]
    if "error: could not compile" in run.stderr:
        return ["(does not build)"]
    # Cargo names the programs on standard error, in the order in which these report on standard output.
    names = re.findall(r"Running (?:unittests )?(?:src|tests)/(\w+)\.rs", run.stderr)
    reports = re.split(r"^running \d+ tests?$", run.stdout, flags=re.MULTILINE)[1:]
    failed = []
    for name, report in zip(names, reports, strict=False):
        failed += [f"{name}::{test}" for test in re.findall(r"^test (\S+) \.\.\. FAILED$", report, flags=re.MULTILINE)]
    if run.returncode and not failed:
        sys.exit(f"the tests did not run: {run.stderr.strip().splitlines()[-1:]}")
    return failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="?", default="", help="part of the description of the mistakes to plant")
    parser.add_argument("--check", action="store_true", help="only check that each mistake still applies")
    parser.add_argument("--markdown", action="store_true", help="print a table for the documentation")
    arguments = parser.parse_args()
    mutations = [mutation for mutation in read() if arguments.only in mutation["mistake"]]
    if not mutations:
        parser.error(f"no mistake has {arguments.only!r} in its description")
    try:
        texts = [planted(mutation) for mutation in mutations]
    except ValueError as error:
        sys.exit(str(error))
    if arguments.check:
        print(f"{len(mutations)} mistakes apply")
        return
    copy_tree()
    survived = 0
    if arguments.markdown:
        print("| mistake | caught by |\n|---|---|")
    for mutation, text in zip(mutations, texts, strict=True):
        place = TREE / mutation["file"]
        place.write_text(text)
        caught = failures(mutation["tests"])
        place.write_text((ROOT / mutation["file"]).read_text())
        survived += not caught
        if arguments.markdown:
            more = f" and {len(caught) - 2} more" if len(caught) > 2 else ""
            names = ", ".join(f"`{name}`" for name in caught[:2])
            print(f"| {mutation['mistake']} | {names or '**nothing**'}{more} |", flush=True)
        else:
            print(f"{mutation['mistake']}\n  {', '.join(caught) or 'SURVIVED'}", flush=True)
    if survived:
        sys.exit(f"{survived} of {len(mutations)} mistakes survived")


if __name__ == "__main__":
    main()
