"""Many changed places of the source in one build, each behind `if crate::mutant(17) { changed } else { original }`, switched by an
environment variable; for mutants.py and mutations.py. Needs `pip install tree-sitter tree-sitter-rust`.

A change is a dictionary with the `file` that it is in; "left out" in it says why it is not in the build.
"""

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
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")
# The test program that all files of tests/suite are modules of.
SUITE = "suite"
# A test is ended after so many times the seconds of a processor that it takes, and some more.
PATIENCE = (3.0, 2.0)
# And after so many seconds, if it takes no processor.
WAIT = 300.0

SWITCH = """
/// Whether a change is switched on; for scripts/switches.py.
#[doc(hidden)]
#[inline]
pub fn mutant(number: usize) -> bool {
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicBool, Ordering};
    static SEEN: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];
    static ACTIVE: OnceLock<(usize, Option<std::ffi::OsString>)> = OnceLock::new();
    let (active, trace) = ACTIVE.get_or_init(|| {
        let active = std::env::var("STICTION_MUTANT").ok().and_then(|number| number.parse().ok());
        (active.unwrap_or(usize::MAX), std::env::var_os("STICTION_MUTANT_TRACE"))
    });
    if let Some(trace) = trace && !SEEN[number].swap(true, Ordering::Relaxed) {
        use std::io::Write;
        let file = std::fs::OpenOptions::new().append(true).create(true).open(trace);
        let _ = file.and_then(|mut file| file.write_all(format!("{number}\\n").as_bytes()));
    }
    *active == number
}
"""


class Unfit(Exception):
    """A place that cannot be switched."""


class File:
    """A source file with its tree."""

    def __init__(self, name):
        import tree_sitter_rust
        from tree_sitter import Language, Parser

        self.bytes = (ROOT / name).read_bytes()
        self.lines = self.bytes.decode().split("\n")
        self.starts = [0]
        for line in self.lines:
            self.starts.append(self.starts[-1] + len(line.encode()) + 1)
        self.root = Parser(Language(tree_sitter_rust.language())).parse(self.bytes).root_node

    def offset(self, place):
        line = place["line"] - 1
        return self.starts[line] + len(self.lines[line][: place["column"] - 1].encode())

    def text(self, node):
        return self.bytes[node.start_byte : node.end_byte].decode()

    def node(self, start, end, kinds):
        """The smallest node of some kinds that holds a range of bytes, where it is not evaluated by the compiler."""
        node = self.root.descendant_for_byte_range(start, end)
        while node is not None and node.type not in kinds:
            node = node.parent
        if node is None:
            raise Unfit("not found")
        above = node
        while above is not None:
            if above.type in ("const_item", "static_item", "array_type", "macro_invocation", "const_block"):
                raise Unfit(f"in a {above.type}")
            if above.type == "function_item" and re.search(rb"\bconst\b", self.bytes[above.start_byte : above.child_by_field_name("name").start_byte]):
                raise Unfit("in a const fn")
            above = above.parent
        return node


def rendered(file, edits):
    """The text of a file with all of its edits, those inside others in both of their branches."""

    def render(start, end, skip=None):
        inside = [e for e in edits if e is not skip and start <= e[0][0] and e[0][1] <= end]
        inside = [e for e in inside if skip is None or e[0] != skip[0] or edits.index(e) > edits.index(skip)]
        outer = []
        for e in sorted(inside, key=lambda e: (e[0][0], -e[0][1], edits.index(e))):
            if not outer or e[0][0] >= outer[-1][0][1]:
                outer.append(e)
        text, at = "", start
        for e in outer:
            text += file.bytes[at : e[0][0]].decode() + e[1](lambda a, b, e=e: render(a, b, e))
            at = e[0][1]
        return text + file.bytes[at:end].decode()

    return render(0, len(file.bytes))


class Build:
    """A copy of the source with its switches, built beside the target directory of the source."""

    def __init__(self, place, changes, edit):
        self.place, self.changes, self.edit = place, changes, edit
        self.tree, self.target = place / "tree", place / "target"
        # What libhdf5 is built with is part of what cargo tells builds apart by.
        self.environment = {"CMAKE": str(ROOT / "scripts" / "cmake"), **os.environ}
        self.copy()
        self.borrow()
        self.write()
        self.weed_out()

    def copy(self):
        listing = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listing, cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\0")
        files = {name for name in names if name and (ROOT / name).is_file()}
        changed = {change["file"] for change in self.changes}
        for name in files - changed:
            self.put(name, (ROOT / name).read_bytes())
        for old in self.tree.glob("src/**/*.rs"):
            if str(old.relative_to(self.tree)) not in files:
                old.unlink()

    def put(self, name, text):
        """Writes a file, unless it is there, so that as little as possible is built again."""
        path = self.tree / name
        if name == "src/lib.rs":
            text += SWITCH.replace("COUNT", str(len(self.changes))).encode()
        if path.is_file() and path.read_bytes() == text:
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text)
        if (ROOT / name).exists():
            shutil.copymode(ROOT / name, path)

    def borrow(self):
        """Links what the source's own target directory has of its dependencies, which are the same."""
        own, there = self.target / "release", TARGET / "release"
        if own.exists() or not there.exists():
            return

        def others(folder, names):
            if folder == str(there / "deps"):
                return [name for name in names if "stiction" in name or Path(name).suffix not in (".rlib", ".rmeta", ".so", ".d")]
            return [name for name in names if name.startswith("stiction-")]

        for part in (".fingerprint", "build", "deps"):
            shutil.copytree(there / part, own / part, ignore=others, copy_function=os.link, symlinks=True)

    def write(self):
        """Writes the files with their switches; changes that cannot be switched are left out, with the reason."""
        edits = {change["file"]: [] for change in self.changes}
        files = {name: File(name) for name in edits}
        for number, change in enumerate(self.changes):
            if "left out" in change:
                continue
            try:
                edits[change["file"]] += self.edit(files[change["file"]], change, number)
            except Unfit as reason:
                change["left out"] = str(reason)
        for name, of_file in edits.items():
            self.put(name, rendered(files[name], of_file).encode())

    def cargo(self, *arguments):
        command = ["cargo", *arguments, "--release", "--message-format=json", "--target-dir", str(self.target)]
        run = subprocess.run(command, cwd=self.tree, env=self.environment, capture_output=True, text=True)
        return run.returncode, [json.loads(line) for line in run.stdout.splitlines() if line.startswith("{")], run.stderr

    def weed_out(self):
        """Leaves out what does not compile, until the rest does."""
        while True:
            code, messages, errors = self.cargo("build", "--lib")
            if code == 0:
                return
            wrong = set()
            for message in messages:
                message = message.get("message", {})
                if message.get("level") != "error":
                    continue
                for span in message.get("spans", []):
                    lines = (self.tree / span["file_name"]).read_text().split("\n") if span["file_name"].startswith("src/") else []
                    first, last = span["line_start"] - 1, span["line_end"]
                    # An arm that is missing is told of the whole match.
                    wrong |= switches(lines[first:last]) or switches(lines[max(first - 12, 0) : last + 12])
            wrong = {number for number in wrong if number < len(self.changes) and "left out" not in self.changes[number]}
            if not wrong:
                sys.exit(f"the tree does not compile: {errors[-3000:]}")
            for number in wrong:
                self.changes[number]["left out"] = "does not compile"
            self.write()

    def build_tests(self):
        """Builds the unit tests, `lib`, and the suite."""
        code, messages, errors = self.cargo("test", "--no-run", "--lib", "--test", SUITE)
        if code:
            sys.exit(errors[-3000:])
        built = [m for m in messages if m.get("reason") == "compiler-artifact" and m.get("executable") and m["profile"]["test"]]
        self.programs = {("lib" if "lib" in m["target"]["kind"] else SUITE): m["executable"] for m in built}

    def command(self, test):
        """Runs one test, named as in the suite, or lib:: and as in the unit tests."""
        is_unit = test.startswith("lib::")
        name = test.removeprefix("lib::")
        return [self.programs["lib" if is_unit else SUITE], "--exact", name, "--test-threads", "1"]

    def tests(self, unused=()):
        """Names of all tests that are not ignored, but for those of files of the suite that are `unused`."""

        def listed(program, *more):
            listing = subprocess.run([self.programs[program], "--list", *more], cwd=self.tree, capture_output=True, text=True).stdout
            return {line.removesuffix(": test") for line in listing.splitlines() if line.endswith(": test")}

        names = sorted(
            ("lib::" if program == "lib" else "") + test for program in self.programs for test in listed(program) - listed(program, "--ignored")
        )
        return [name for name in names if name.split("::")[0] not in unused]

    def run(self, test, limit, **switch):
        """Runs one test by itself, with a limit of seconds of a processor for each of its processes: whether it passes, or None when it
        does not end; and the seconds of a processor that it took."""
        seconds = math.ceil(limit)
        child = subprocess.Popen(
            self.command(test),
            cwd=self.tree,
            env={**self.environment, "CARGO_MANIFEST_DIR": str(self.tree), "RUST_BACKTRACE": "0", **switch},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds)),
        )
        # Ends the group of this test: it and what it has started.
        timer = threading.Timer(WAIT, os.killpg, (child.pid, signal.SIGKILL))
        timer.start()
        _, status, usage = os.wait4(child.pid, 0)
        timer.cancel()
        child.returncode = code = os.waitstatus_to_exitcode(status)
        return (None if -code in (signal.SIGXCPU, signal.SIGKILL) else code == 0), usage.ru_utime + usage.ru_stime

    def trace(self, slowest, unused=()):
        """Every test that takes at most so many seconds of a processor: its name, its seconds, and the changes that it reaches; the quickest
        first."""

        def traced(test):
            reached = self.place / f"reached-{test.replace('::', '-')}"
            reached.unlink(missing_ok=True)
            passed, seconds = self.run(test, slowest, STICTION_MUTANT_TRACE=str(reached))
            numbers = sorted({int(line) for line in reached.read_text().split()}) if reached.exists() else []
            reached.unlink(missing_ok=True)
            if not passed:
                print(f"not used: {test} ({'slow' if passed is None else 'fails by itself'})", flush=True)
            return {"test": test, "seconds": seconds, "reaches": numbers, "is used": bool(passed)}

        return sorted((test for test in side_by_side(traced, self.tests(unused)) if test["is used"]), key=lambda test: test["seconds"])

    def judge(self, number, tests, budget=math.inf):
        """What becomes of a change by the tests that reach it, of so many seconds in all, and by which test."""
        spent, tried = 0.0, 0
        for test in tests:
            if number not in test["reaches"]:
                continue
            if spent > budget:
                return "not caught", f"{tried} tests of {budget:g} s in all"
            limit = PATIENCE[0] * test["seconds"] + PATIENCE[1]
            passed, _ = self.run(test["test"], limit, STICTION_MUTANT=str(number))
            if not passed:
                return ("caught" if passed is False else "does not end"), test["test"]
            spent, tried = spent + test["seconds"], tried + 1
        return ("not caught", f"all {tried} tests that reach it") if tried else ("not reached", "")


def switches(lines):
    return {int(number) for number in re.findall(r"crate::mutant\((\d+)\)", "\n".join(lines))}


def side_by_side(work, items):
    """Results of `work` for each of the items, in their order, on all processors."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(work, items)
