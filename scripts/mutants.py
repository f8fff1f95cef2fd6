#!/usr/bin/env python3
"""Measures how many of the mistakes that `cargo mutants` can think of are caught by a test: a random sample, in one build.

    scripts/mutants.py                      240 mutants drawn with seed 1, the report to target/mutants/report.md
    scripts/mutants.py --count 20 --seed 7  another sample
    scripts/mutants.py --only src/math      of some files only

Needs `cargo install cargo-mutants --locked` for the list, and `pip install tree-sitter tree-sitter-rust` to find the operands of an
operator. Nothing of cargo-mutants runs a test: the tree is copied to target/mutants with every sampled place as
`if crate::mutant(17) { mutated } else { original }`, so that there is one build for all. Places in constants, and those that do not
compile, are left out and counted. Every test then runs once by itself, which tells its time and the mutants that it reaches; after
that, for each mutant, the tests that reach it, the quickest first, to the first that fails or does not end.
"""

import argparse
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import tree_sitter_rust
from tree_sitter import Language, Parser

ROOT = Path(__file__).resolve().parent.parent
PLACE = ROOT / "target" / "mutants"
TREE = PLACE / "tree"
# The terminal's rooms.
LEFT_OUT = ("src/cli/", "src/main.rs", "src/output/progress.rs")
# Test programs that take long, need an emulator or another processor, or only repeat with random input what others check.
UNUSED = {"fuzz", "processors", "terminal", "instruction_sets", "interruption", "large_surfaces"}
# A test that takes more seconds of a processor by itself is not used.
SLOWEST = 8
# For one mutant, tests of so many seconds of a processor in all.
BUDGET = 20.0
# A test is ended after so many times the seconds of a processor that it takes, and some more.
PATIENCE = (3.0, 2.0)
# And after so many seconds, if it takes no processor.
WAIT = 120.0

SWITCH = """
/// Whether a mutant is switched on; for scripts/mutants.py.
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


def listed(only):
    """The mutants of the rooms, in an order that does not depend on anything but the source."""
    command = ["cargo", "mutants", "--list", "--json"]
    out = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    mutants = [m for m in json.loads(out) if m["file"].startswith(only) and not m["file"].startswith(LEFT_OUT)]
    return sorted(mutants, key=lambda m: (m["file"], m["span"]["start"]["line"], m["span"]["start"]["column"], m["name"]))


class File:
    """A source file with its tree."""

    def __init__(self, name):
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

    def node(self, mutant, kinds):
        """The smallest node of some kinds that holds the place of a mutant."""
        start, end = self.offset(mutant["span"]["start"]), self.offset(mutant["span"]["end"])
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


def edit(file, mutant, number):
    """What is inserted where: rising pairs of an offset and a text; None at the place of a copy means the text of a range."""
    genre, replacement, active = mutant["genre"], mutant["replacement"], f"crate::mutant({number})"
    if genre == "FnValue":
        if "impl " in mutant["function"]["return_type"]:
            raise Unfit("returns an opaque type")
        body = file.node(mutant, ("function_item",)).child_by_field_name("body")
        value = "" if replacement == "()" else f" {replacement}"
        return (body.start_byte + 1, body.start_byte + 1), lambda _: f" if {active} {{ return{value}; }} "
    if genre == "BinaryOperator":
        node = file.node(mutant, ("binary_expression", "compound_assignment_expr"))
        operator = node.child_by_field_name("operator")
        if file.offset(mutant["span"]["start"]) != operator.start_byte:
            raise Unfit("another operator")
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
        between = (file.text(operator), replacement)

        def switched(render):
            a, b = render(left.start_byte, left.end_byte), render(right.start_byte, right.end_byte)
            return f"(if {active} {{ {a} {between[1]} {b} }} else {{ {a} {between[0]} {b} }})"

        return (node.start_byte, node.end_byte), switched
    if genre == "UnaryOperator":
        node = file.node(mutant, ("unary_expression", "negative_literal"))
        begin = file.offset(mutant["span"]["end"])

        def without(render):
            inner = render(begin, node.end_byte)
            sign = file.bytes[node.start_byte : begin].decode()
            return f"(if {active} {{ {inner} }} else {{ {sign}{inner} }})"

        return (node.start_byte, node.end_byte), without
    if genre == "MatchArmGuard":
        start, end = file.offset(mutant["span"]["start"]), file.offset(mutant["span"]["end"])
        file.node(mutant, ("match_arm",))
        return (start, end), lambda render: f"(if {active} {{ {replacement} }} else {{ {render(start, end)} }})"
    if genre == "MatchArm":
        pattern = file.node(mutant, ("match_arm",)).child_by_field_name("pattern")
        condition = pattern.child_by_field_name("condition")
        if condition is None:
            return (pattern.end_byte, pattern.end_byte), lambda _: f" if !{active}"
        return (condition.start_byte, condition.end_byte), lambda render: (
            f"!{active} && ({render(condition.start_byte, condition.end_byte)})"
        )
    if genre == "StructField":
        field = file.node(mutant, ("field_initializer",))
        name, value = field.child_by_field_name("field"), field.child_by_field_name("value")
        base = next((node for node in field.parent.children if node.type == "base_field_initializer"), None)
        if base is None or value is None:
            raise Unfit("no base")
        other = file.text(base).removeprefix("..").strip()
        return (value.start_byte, value.end_byte), lambda render: (
            f"if {active} {{ ({other}).{file.text(name)} }} else {{ {render(value.start_byte, value.end_byte)} }}"
        )
    raise Unfit(genre)


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


def write_tree(sample):
    """Writes the copy with the switches; mutants that are no more taken are those with a reason."""
    files, edits = {}, {}
    for number, mutant in enumerate(sample):
        if "left out" in mutant:
            continue
        file = files.setdefault(mutant["file"], None) or File(mutant["file"])
        files[mutant["file"]] = file
        try:
            edits.setdefault(mutant["file"], []).append(edit(file, mutant, number))
        except Unfit as reason:
            mutant["left out"] = str(reason)
    for name in {mutant["file"] for mutant in sample}:
        file = files.get(name) or File(name)
        text = rendered(file, edits.get(name, []))
        if not (TREE / name).exists() or (TREE / name).read_text() != text:
            (TREE / name).write_text(text)


def copy_tree(count):
    listing = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    for name in subprocess.run(listing, cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\0"):
        source = ROOT / name
        if name and source.is_file():
            (TREE / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, TREE / name)
    library = TREE / "src" / "lib.rs"
    library.write_text(library.read_text() + SWITCH.replace("COUNT", str(count)))


def cargo(arguments, **more):
    command = ["cargo", *arguments, "--release", "--message-format=json", "--target-dir", str(PLACE / "target")]
    run = subprocess.run(command, cwd=TREE, capture_output=True, text=True, **more)
    return run.returncode, [json.loads(line) for line in run.stdout.splitlines() if line.startswith("{")], run.stderr


def switches(lines):
    return {int(number) for number in re.findall(r"crate::mutant\((\d+)\)", "\n".join(lines))}


def weed_out(sample):
    """Leaves out what does not compile, until the rest does."""
    while True:
        code, messages, errors = cargo(["check", "--lib"])
        if code == 0:
            return
        wrong = set()
        for message in messages:
            message = message.get("message", {})
            if message.get("level") != "error":
                continue
            for span in message.get("spans", []):
                lines = (TREE / span["file_name"]).read_text().split("\n") if span["file_name"].startswith("src/") else []
                first, last = span["line_start"] - 1, span["line_end"]
                own = switches(lines[first:last])
                # An arm that is missing is told of the whole match.
                wrong |= own or switches(lines[max(first - 12, 0) : last + 12])
        wrong = {number for number in wrong if number < len(sample) and "left out" not in sample[number]}
        if not wrong:
            sys.exit(f"the tree does not compile: {errors[-3000:]}")
        for number in wrong:
            sample[number]["left out"] = "does not compile"
        write_tree(sample)


def programs(targets):
    """The built test programs by name."""
    selection = ["--lib", "--bins", *(part for target in targets for part in ("--test", target))]
    code, messages, errors = cargo(["test", "--no-run", *selection])
    if code:
        sys.exit(errors[-3000:])
    built = [m for m in messages if m.get("reason") == "compiler-artifact" and m.get("executable") and m["profile"]["test"]]
    return {("lib" if "lib" in m["target"]["kind"] else m["target"]["name"]): m["executable"] for m in built}


def run_test(program, test, limit, **environment):
    """Runs one test by itself, with a limit of seconds of a processor for each of its processes: whether it passes, or None when it
    does not end; and the seconds of a processor that it took."""
    command = [program, "--exact", test, "--test-threads", "1"]
    own = {**os.environ, "CARGO_MANIFEST_DIR": str(TREE), "RUST_BACKTRACE": "0", **environment}
    seconds = math.ceil(limit)
    child = subprocess.Popen(
        command,
        cwd=TREE,
        env=own,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds)),
    )
    begun, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        code = child.wait(WAIT)
    except subprocess.TimeoutExpired:
        # The group of this test, and what it has started.
        os.killpg(child.pid, signal.SIGKILL)
        child.wait()
        return None, time.monotonic() - begun
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    taken = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return (None if -code in (signal.SIGXCPU, signal.SIGKILL) else code == 0), taken


def trace(names):
    """Every test that can be used: program, name, seconds, and the mutants that it reaches."""
    tests = []
    for name, program in names.items():
        listing = subprocess.run([program, "--list"], cwd=TREE, capture_output=True, text=True).stdout
        ignored = subprocess.run([program, "--list", "--ignored"], cwd=TREE, capture_output=True, text=True).stdout
        known, slow = ({line.removesuffix(": test") for line in out.splitlines() if line.endswith(": test")} for out in (listing, ignored))
        for test in sorted(known - slow):
            reached = PLACE / "reached"
            reached.unlink(missing_ok=True)
            passed, seconds = run_test(program, test, SLOWEST, STICTION_MUTANT_TRACE=str(reached))
            numbers = {int(line) for line in reached.read_text().split()} if reached.exists() else set()
            if passed:
                tests.append({"program": name, "path": program, "test": test, "seconds": seconds, "reaches": sorted(numbers)})
            else:
                print(f"not used: {name}::{test} ({'slow' if passed is None else 'fails by itself'})", flush=True)
    return sorted(tests, key=lambda test: test["seconds"])


def judge(number, tests):
    """What becomes of a mutant, and by which test."""
    spent, tried = 0.0, 0
    for test in tests:
        if number not in test["reaches"]:
            continue
        if spent > BUDGET:
            return "survived", f"{tried} tests within the budget"
        limit = PATIENCE[0] * test["seconds"] + PATIENCE[1]
        passed, seconds = run_test(test["path"], test["test"], limit, STICTION_MUTANT=str(number))
        if not passed:
            return ("caught" if passed is False else "timed out"), f"{test['program']}::{test['test']}"
        spent, tried = spent + test["seconds"], tried + 1
    return ("survived", f"{tried} tests reach it") if tried else ("not reached", "")


def report(sample, results):
    lines = ["| mutant | what became of it | by |", "|---|---|---|"]
    lines += [f"| `{sample[n]['name']}` | {result} | {by} |" for n, (result, by) in sorted(results.items())]
    counts = {}
    for result, _ in results.values():
        counts[result] = counts.get(result, 0) + 1
    left = {}
    for mutant in sample:
        if "left out" in mutant:
            left[mutant["left out"]] = left.get(mutant["left out"], 0) + 1
    lines += ["", f"{len(results)} mutants: {counts}; left out: {left}"]
    (PLACE / "report.md").write_text("\n".join(lines) + "\n")
    return lines[-1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=240, help="mutants to draw, those that are left out included")
    parser.add_argument("--seed", type=int, default=1, help="of the sample")
    parser.add_argument("--only", default="src/", help="beginning of the path of the files to draw from")
    parser.add_argument("--tests", default="", help="test programs to use, by commas; all that are quick without it")
    parser.add_argument("--build", action="store_true", help="only build")
    arguments = parser.parse_args()
    everything = listed(arguments.only)
    sample = random.Random(arguments.seed).sample(everything, min(arguments.count, len(everything)))
    PLACE.mkdir(parents=True, exist_ok=True)
    copy_tree(len(sample))
    write_tree(sample)
    weed_out(sample)
    print(f"{len(everything)} mutants are listed, {len(sample)} drawn, {sum('left out' in m for m in sample)} left out", flush=True)
    targets = sorted(path.stem for path in (ROOT / "tests").glob("*.rs") if path.stem not in UNUSED)
    names = programs(arguments.tests.split(",") if arguments.tests else targets)
    if arguments.build:
        return
    tests = trace(names)
    print(f"{len(tests)} tests, {sum(test['seconds'] for test in tests):.0f} s", flush=True)
    results = {}
    for number, mutant in enumerate(sample):
        if "left out" not in mutant:
            results[number] = judge(number, tests)
            print(f"{number} {mutant['name']}: {' by '.join(results[number])}", flush=True)
            last = report(sample, results)
    print(last)


if __name__ == "__main__":
    main()
