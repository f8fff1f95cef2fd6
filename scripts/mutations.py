#!/usr/bin/env python3
"""Plants the mistakes of tests/mutations.toml, and requires that the test that each names fails of it and
passes without it.

    scripts/mutations.py              all, in one build, each behind a switch
    scripts/mutations.py sign         those whose description has "sign" in it
    scripts/mutations.py --check      only whether each still applies, and its test is there; builds nothing

The tree is copied to target/mutations and changed there (planting.py). The copy has the additions of CONTRIBUTING.md,
too, whose tests are run. Exit code 1 if a mistake survives, does not apply or does not compile, or a test of additions fails.
"""

import argparse
import concurrent.futures
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import threading
import tomllib
from pathlib import Path

from planting import ROOT, Unfit, edits_of, rendered, source

TARGET = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")
TREE, OWN = TARGET / "mutations" / "tree", TARGET / "mutations" / "target"
# The seconds of a processor that a test may take without a mistake; with it, this many times what it took,
# and some more.
ENDLESS, PATIENCE = 120.0, (3.0, 2.0)
# After this many seconds a test is ended even if it takes no processor.
WAIT = 300.0
# The tests that additions are for: laws, scaling of radii, keys, sweeps, laws of heights.
ADDED = ("laws::laws_jump_where_and_as_much_as_documented", "laws::laws_are_smooth_between_the_ends_of_their_pieces",
         "bad_scenes::examples_of_all_keys_are_scenes", "bad_scenes::keys::defaults_are_what_holds_without_the_key",
         "lib::scene::sweep::tests::every_key_that_can_be_swept_is_one_of_scenes",
         "populations::laws_of_heights_have_one_density_probability_and_score",
         "populations::heights_are_drawn_from_their_law")
SWITCH = """
/// Whether a mistake is planted; for scripts/mutations.py.
#[doc(hidden)]
#[inline]
pub fn mutant(number: usize) -> bool {
    static ACTIVE: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
    let read = || std::env::var("STICTION_MUTANT").ok().and_then(|number| number.parse().ok());
    *ACTIVE.get_or_init(|| read().unwrap_or(usize::MAX)) == number
}
"""


def tests_of(folder, prefix):
    """Beginnings and ends of the names of the tests in the files of a folder."""
    tests = re.compile(r"#\[test\](?:\s*#\[[^\n]*)*\s*fn (\w+)\(")
    for path in sorted(folder.rglob("*.rs")):
        room = [part for part in path.relative_to(folder).with_suffix("").parts
                if part not in ("mod", "lib", "main")]
        yield from (("::".join([*prefix, *room, ""]), f"::{name}")
                    for name in tests.findall(path.read_text()))


def planted(mutations):
    """The edits of each file, and why mistakes cannot be planted, or their tests not run."""
    items, edits, problems = source(), {}, []
    tests = [*tests_of(ROOT / "src", ["lib"]), *tests_of(ROOT / "tests" / "suite", [])]
    for number, mutation in enumerate(mutations):
        try:
            file, own = edits_of(items, mutation, number)
            edits.setdefault(file.name, (file, []))[1].extend(own)
        except Unfit as reason:
            problems.append(f"{mutation['mistake']}\n  {reason}")
        if not any(mutation["test"].startswith(begin) and mutation["test"].endswith(end) for begin,
                   end in tests):
            problems.append(f"{mutation['mistake']}\n  there is no test {mutation['test']}")
    return edits, problems


def additions():
    """The hunks of the diffs of CONTRIBUTING.md by their files: lines before and after; none before in a new file."""
    hunks = {}
    for diff in re.findall(r"^```diff\n(.*?)^```$", (ROOT / "CONTRIBUTING.md").read_text(), re.M | re.S):
        for file, rest in re.findall(r"^\+\+\+ b/(\S+)\n(.*?)(?=^--- |\Z)", diff, re.M | re.S):
            for hunk in re.split(r"^@@.*@@\n", rest, flags=re.M)[1:]:
                lines = hunk.splitlines(keepends=True)
                before, after = ("".join(line[1:] for line in lines if line[0] in kinds) for kinds in (" -", " +"))
                hunks.setdefault(file, []).append((before, after))
    return hunks


def with_additions(name, text, hunks):
    """A file with the hunks of additions."""
    for before, after in hunks.pop(name, ()):
        # Functions with planted mistakes stand there several times.
        if before not in text:
            sys.exit(f"CONTRIBUTING.md: an addition to {name} does not apply:\n{before}")
        text = text.replace(before, after)
    return text


def write(edits):
    """Copies the source with its switches; files that are as they were are left alone, so that little is
    built again."""
    listing = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listing, cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\0")
    names = {name for name in names if name and (ROOT / name).is_file()}
    hunks = additions()
    for name in [name for name, [first, *_] in hunks.items() if not first[0]]:
        (TREE / name).parent.mkdir(parents=True, exist_ok=True)
        (TREE / name).write_text(hunks.pop(name)[0][1])
        names.add(name)
    for old in TREE.glob("src/**/*.rs"):
        if str(old.relative_to(TREE)) not in names:
            old.unlink()
    for name in names:
        path = TREE / name
        if not (ROOT / name).is_file():
            continue
        text = (ROOT / name).read_bytes()
        if name in edits:
            text = rendered(*edits[name]).encode()
        if name in hunks:
            text = with_additions(name, text.decode(), hunks).encode()
        if name == "src/lib.rs":
            text += SWITCH.encode()
        if not path.is_file() or path.read_bytes() != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text)
            shutil.copymode(ROOT / name, path)


def borrow():
    """Links the dependencies that the source's own target directory has."""
    there = TARGET / "release"
    if (OWN / "release").exists() or not there.exists():
        return

    def others(folder, names):
        if folder == str(there / "deps"):
            return [name for name in names if "stiction" in name
                    or Path(name).suffix not in (".rlib", ".rmeta", ".so", ".d")]
        return [name for name in names if name.startswith("stiction-")]

    for part in (".fingerprint", "build", "deps"):
        shutil.copytree(there / part, OWN / "release" / part, ignore=others, copy_function=os.link,
                        symlinks=True)


def built():
    """Builds the unit tests, `lib`, and the suite: their programs."""
    command = ["cargo", "test", "--no-run", "--lib", "--test", "suite", "--release", "--message-format=json"]
    # Cargo knows builds apart by what libhdf5 is built with, too.
    environment = {"CMAKE": str(ROOT / "scripts" / "cmake"), **os.environ}
    run = subprocess.run([*command, "--target-dir", str(OWN)], cwd=TREE, env=environment, capture_output=True,
                         text=True)
    messages = [json.loads(line) for line in run.stdout.splitlines() if line.startswith("{")]
    if run.returncode:
        sys.exit("".join(message["message"]["rendered"] for message in messages
                         if "message" in message)[-6000:] + run.stderr[-2000:])
    made = [message for message in messages if message.get("executable") and message["profile"]["test"]]
    return {"lib" if "lib" in message["target"]["kind"] else "suite": message["executable"]
            for message in made}


def run(programs, test, limit, mutant=""):
    """Runs one test by itself within seconds of a processor: whether it passes, None when it does not end,
    and its seconds."""
    seconds, name = math.ceil(limit), test.removeprefix("lib::")
    child = subprocess.Popen(
        [programs["suite" if name == test else "lib"], "--exact", name, "--include-ignored", "--test-threads", "1"],
        cwd=TREE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
        env={**os.environ, "CARGO_MANIFEST_DIR": str(TREE), "RUST_BACKTRACE": "0", "STICTION_MUTANT": mutant},
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds)),
    )  # fmt: skip
    # Ends the group of this test: it and what it has started.
    timer = threading.Timer(WAIT, os.killpg, (child.pid, signal.SIGKILL))
    timer.start()
    _, status, usage = os.wait4(child.pid, 0)
    timer.cancel()
    child.returncode = code = os.waitstatus_to_exitcode(status)
    return (None if -code in (signal.SIGXCPU, signal.SIGKILL) else code == 0), usage.ru_utime + usage.ru_stime


def judged(programs, mutations):
    """The verdict on each mistake: its test has to pass without it, and to fail with it."""
    tests = sorted({mutation["test"] for mutation in mutations})

    def verdict(number):
        passes, seconds = without[mutations[number]["test"]]
        if not passes:
            return "FAILS WITHOUT IT"
        limit = PATIENCE[0] * seconds + PATIENCE[1]
        passes, _ = run(programs, mutations[number]["test"], limit, str(number))
        return {True: "SURVIVED", False: "caught", None: "caught: does not end"}[passes]

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        without = dict(zip(tests, pool.map(lambda test: run(programs, test, ENDLESS), tests), strict=True))
        yield from zip(mutations, pool.map(verdict, range(len(mutations))), strict=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="?", default="",
                        help="part of the description of the mistakes to plant")
    parser.add_argument("--check", action="store_true", help="only check that each mistake still applies")
    arguments = parser.parse_args()
    mutations = tomllib.loads((ROOT / "tests" / "mutations.toml").read_text())["mutation"]
    mutations = [mutation for mutation in mutations if arguments.only in mutation["mistake"]]
    if not mutations:
        parser.error(f"no mistake has {arguments.only!r} in its description")
    edits, problems = planted(mutations)
    if problems:
        sys.exit("\n".join([*problems, f"{len(problems)} of {len(mutations)} mistakes have to be mended"]))
    write(edits)
    if arguments.check:
        print(f"{len(mutations)} mistakes apply")
        return
    borrow()
    survived, programs = 0, built()
    failed = [test for test in ADDED if not run(programs, test, ENDLESS)[0]]
    print(f"{len(ADDED) - len(failed)} of {len(ADDED)} tests of additions passed", *failed, sep="\n  ", flush=True)
    for mutation, result in judged(programs, mutations):
        survived += not result.startswith("caught")
        print(f"{mutation['mistake']}\n  {result} by {mutation['test']}", flush=True)
    print(f"{len(mutations)} mistakes planted")
    if survived or failed:
        sys.exit(f"{survived} of {len(mutations)} mistakes were not caught as they should be, {len(failed)} tests failed")


if __name__ == "__main__":
    main()
