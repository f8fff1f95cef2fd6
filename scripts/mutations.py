#!/usr/bin/env python3
"""Plants the mistakes of tests/mutations.toml, and requires that the test that each names fails of it and passes without it.

    scripts/mutations.py              all: most in one build, each behind a switch, and after them those in constants, each in a build of its own
    scripts/mutations.py sign         those whose description has "sign" in it
    scripts/mutations.py --together   only those in the one build, which is quick
    scripts/mutations.py --check      only whether each still applies, and its test is there; builds nothing
    scripts/mutations.py --find       which test is the quickest to notice each, of all that reach it
    scripts/mutations.py --markdown   prints a table for the documentation

The tree as it stands is copied to target/mutations and changed there (switches.py; needs `pip install tree-sitter tree-sitter-rust`). A
mistake is switched with the whole body of its function; what is outside of functions is a constant. Exit code 1 if a mistake survives or
does not apply.
"""

import argparse
import os
import sys
import time
import tomllib

from switches import PATIENCE, ROOT, TARGET, Build, Unfit, side_by_side

PLACE = TARGET / "mutations"
# Seconds of a processor after which a test is not the one to name.
SLOWEST = 8
# And after which a test without any mistake is taken not to end.
ENDLESS = 120


def read(path=ROOT / "tests" / "mutations.toml"):
    return tomllib.loads(path.read_text())["mutation"]


def wrong(mutation):
    """Why a mistake cannot be planted, or its test not run; nothing if both can."""
    count = (ROOT / mutation["file"]).read_text().count(mutation["find"])
    if count != 1 or mutation["find"] == mutation["replace"]:
        return f"{mutation['file']}: occurs {count} times, once is needed: {mutation['find']!r}"
    program, _, test = mutation["test"].partition("::")
    files = (ROOT / "src").rglob("*.rs") if program == "lib" else [ROOT / "tests" / "suite" / f"{program}.rs"]
    if not any(f"fn {test.split('::')[-1]}(" in path.read_text() for path in files):
        return f"{mutation['mistake']}: there is no test {mutation['test']}"
    return None


def changed_part(file, mutation):
    """The range of bytes that a mistake changes, and what is there then."""
    find, replace = mutation["find"].encode(), mutation["replace"].encode()
    same = len(os.path.commonprefix([find, replace]))
    tail = len(os.path.commonprefix([find[same:][::-1], replace[same:][::-1]]))
    begin = file.bytes.index(find)
    return begin + same, begin + len(find) - tail, replace[same : len(replace) - tail]


def switched(file, mutation, number):
    """A mistake behind its switch, with the body of its function."""
    begin, end, replacement = changed_part(file, mutation)
    body = file.node(begin, end, ("function_item",)).child_by_field_name("body")
    low, high = body.start_byte, body.end_byte
    if not low < begin <= end < high:
        raise Unfit("not in a body")
    mistaken = (file.bytes[low:begin] + replacement + file.bytes[end:high]).decode()
    return (low, high), lambda render: f"{{ if crate::mutant({number}) {mistaken} else {render(low, high)} }}"


def replaced(file, mutation, _):
    """A mistake as it is."""
    begin, end, replacement = changed_part(file, mutation)
    return (begin, end), lambda _: replacement.decode()


def judged(build, mutations, numbers):
    """For each of some mistakes of a build what becomes of it: its test has to pass without it, and to fail with it."""
    tests = sorted({mutations[number]["test"] for number in numbers})
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

    return side_by_side(lambda number: (number, verdict(number)), numbers)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="?", default="", help="part of the description of the mistakes to plant")
    parser.add_argument("--together", action="store_true", help="leave out what needs a build of its own")
    parser.add_argument("--check", action="store_true", help="only check that each mistake still applies")
    parser.add_argument("--find", action="store_true", help="find the quickest test that notices each")
    parser.add_argument("--markdown", action="store_true", help="print a table for the documentation")
    arguments = parser.parse_args()
    mutations = [mutation for mutation in read() if arguments.only in mutation["mistake"]]
    if not mutations:
        parser.error(f"no mistake has {arguments.only!r} in its description")
    if problems := [problem for problem in map(wrong, mutations) if problem]:
        sys.exit("\n".join(problems))
    if arguments.check:
        print(f"{len(mutations)} mistakes apply")
        return
    if arguments.markdown:
        print("| mistake | caught by |\n|---|---|")
        print("\n".join(f"| {mutation['mistake']} | `{mutation['test']}` |" for mutation in mutations))
        return
    begun = time.monotonic()
    build = Build(PLACE, mutations, switched)
    print(f"the build of the library: {time.monotonic() - begun:.0f} s", flush=True)
    together = [number for number, mutation in enumerate(mutations) if "left out" not in mutation]
    alone = [number for number, mutation in enumerate(mutations) if "left out" in mutation]
    if arguments.find:
        build.build_tests()
        tests = build.trace(SLOWEST)
        for number in together:
            print(f"{mutations[number]['mistake']}\n  {' by '.join(build.judge(number, tests))}", flush=True)
        return
    results = {}

    def note(number, result):
        results[number] = result
        print(f"{mutations[number]['mistake']}\n  {result} by {mutations[number]['test']}", flush=True)

    for number, result in judged(build, mutations, together + ([] if arguments.together else alone)):
        # Those that are not planted in this build are only seen to let their tests pass.
        if number in together or result != "SURVIVED":
            note(number, result)
    print(f"{len(together)} mistakes in one build: {time.monotonic() - begun:.0f} s", flush=True)
    for number in [] if arguments.together else alone:
        one = {key: value for key, value in mutations[number].items() if key != "left out"}
        ((_, result),) = judged(Build(PLACE, [one], replaced), [one], [0])
        note(number, "caught" if result == "FAILS WITHOUT IT" else result)
    if arguments.together and alone:
        print(f"{len(alone)} mistakes in constants are left to scripts/mutations.py without --together:")
        print("\n".join(f"  {mutations[number]['mistake']} ({mutations[number]['left out']})" for number in alone))
    print(f"{len(results)} mistakes planted in {time.monotonic() - begun:.0f} s")
    if survived := [number for number, result in results.items() if not result.startswith("caught")]:
        sys.exit(f"{len(survived)} of {len(results)} mistakes were not caught as they should be")


if __name__ == "__main__":
    main()
