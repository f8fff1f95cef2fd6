#!/usr/bin/env python3
"""Plants the mistakes of tests/mutations.toml, and requires that the test that each names fails of it and passes without it.

    scripts/mutations.py              all, in one build, each behind a switch
    scripts/mutations.py sign         those whose description has "sign" in it
    scripts/mutations.py --check      only whether each still applies, and its test is there; builds nothing
    scripts/mutations.py --find       which test is the quickest to notice each, of all that reach it
    scripts/mutations.py --markdown   prints a table for the documentation

planting.py tells how the place of a mistake is named. The tree as it stands is copied to target/mutations and changed there (switches.py;
needs `pip install tree-sitter tree-sitter-rust`). Exit code 1 if a mistake survives, does not apply or does not compile.
"""

import argparse
import re
import sys
import time
import tomllib

from planting import Source, place, switched
from switches import PATIENCE, ROOT, TARGET, Build, Unfit, side_by_side

PLACE = TARGET / "mutations"
# Seconds of a processor after which a test is not the one to name.
SLOWEST = 8
# And after which a test without any mistake is taken not to end.
ENDLESS = 120


def read(path=ROOT / "tests" / "mutations.toml"):
    return tomllib.loads(path.read_text())["mutation"]


def tests_of(folder, prefix):
    """What the names of the tests in the files of a folder begin with, and end with."""
    tests = re.compile(r"#\[test\](?:\s*#\[[^\n]*)*\s*fn (\w+)\(")
    for path in sorted(folder.rglob("*.rs")):
        room = [part for part in path.relative_to(folder).with_suffix("").parts if part not in ("mod", "lib", "main")]
        yield from (("::".join([*prefix, *room, ""]), f"::{name}") for name in tests.findall(path.read_text()))


def problems(source, mutations):
    """Why mistakes cannot be planted, or their tests not run."""
    tests = [*tests_of(ROOT / "src", ["lib"]), *tests_of(ROOT / "tests" / "suite", [])]
    for mutation in mutations:
        try:
            mutation["file"] = place(source, mutation)[0].name
        except Unfit as reason:
            yield f"{mutation['mistake']}\n  {reason}"
        test = mutation["test"]
        if not any(test.startswith(begin) and test.endswith(end) for begin, end in tests):
            yield f"{mutation['mistake']}\n  there is no test {test}"


def judged(build, mutations):
    """For each mistake of a build what becomes of it: its test has to pass without it, and to fail with it."""
    tests = sorted({mutation["test"] for mutation in mutations})
    begun = time.monotonic()
    build.build_tests()
    print(f"the build of tests: {time.monotonic() - begun:.0f} s", flush=True)
    without = dict(zip(tests, side_by_side(lambda test: build.run(test, ENDLESS), tests), strict=True))

    def verdict(number):
        test = mutations[number]["test"]
        passes, seconds = without[test]
        if not passes:
            return "FAILS WITHOUT IT"
        passes, _ = build.run(test, PATIENCE[0] * seconds + PATIENCE[1], STICTION_MUTANT=str(number))
        return {True: "SURVIVED", False: "caught", None: "caught: does not end"}[passes]

    return side_by_side(lambda number: (number, verdict(number)), range(len(mutations)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="?", default="", help="part of the description of the mistakes to plant")
    parser.add_argument("--check", action="store_true", help="only check that each mistake still applies")
    parser.add_argument("--find", action="store_true", help="find the quickest test that notices each")
    parser.add_argument("--markdown", action="store_true", help="print a table for the documentation")
    arguments = parser.parse_args()
    mutations = [mutation for mutation in read() if arguments.only in mutation["mistake"]]
    if not mutations:
        parser.error(f"no mistake has {arguments.only!r} in its description")
    source = Source()
    if found := list(problems(source, mutations)):
        sys.exit("\n".join([*found, f"{len(found)} of {len(mutations)} mistakes have to be mended"]))
    if arguments.check:
        print(f"{len(mutations)} mistakes apply")
        return
    if arguments.markdown:
        print("| mistake | caught by |\n|---|---|")
        print("\n".join(f"| {mutation['mistake']} | `{mutation['test']}` |" for mutation in mutations))
        return
    begun = time.monotonic()
    build = Build(PLACE, mutations, lambda _, mutation, number: switched(source, mutation, number))
    print(f"the build of the library: {time.monotonic() - begun:.0f} s", flush=True)
    if left_out := [f"{mutation['mistake']}\n  {mutation['left out']}" for mutation in mutations if "left out" in mutation]:
        sys.exit("\n".join(left_out))
    if arguments.find:
        build.build_tests()
        tests = build.trace(SLOWEST)
        for number, mutation in enumerate(mutations):
            print(f"{mutation['mistake']}\n  {' by '.join(build.judge(number, tests))}", flush=True)
        return
    survived = 0
    for number, result in judged(build, mutations):
        survived += not result.startswith("caught")
        print(f"{mutations[number]['mistake']}\n  {result} by {mutations[number]['test']}", flush=True)
    print(f"{len(mutations)} mistakes planted in {time.monotonic() - begun:.0f} s")
    if survived:
        sys.exit(f"{survived} of {len(mutations)} mistakes were not caught as they should be")


if __name__ == "__main__":
    main()
