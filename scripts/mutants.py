#!/usr/bin/env python3
"""Measures how many of the mistakes that `cargo mutants` can think of are caught by a test: a random sample, in one build.

    scripts/mutants.py --seed 2                        240 mutants, the report to target/mutants/report.md
    scripts/mutants.py --seed 7 --count 20             fewer
    scripts/mutants.py --seed 2 --only src/math        of some files only
    scripts/mutants.py --seed 2 --without src/math     of all others

Needs `cargo install cargo-mutants --locked` for the list, and `pip install tree-sitter tree-sitter-rust` to find the operands of an
operator. Nothing of cargo-mutants runs a test: all are in one build, each behind a switch (switches.py). Places in constants, and those
that do not compile, are left out and counted. Every test then runs once by itself, which tells its time and the mutants that it reaches;
after that, for each mutant, the tests that reach it, the quickest first, to the first that fails or does not end. What was found out is
kept: the same command goes on where it was ended, as long as the source is the same.
"""

import argparse
import collections
import hashlib
import json
import random
import subprocess

from switches import ROOT, TARGET, Build, Unfit, side_by_side

PLACE = TARGET / "mutants"
# The terminal's rooms.
LEFT_OUT = ("src/cli/", "src/main.rs")
# Files of the suite that take long, need an emulator or another processor, or only repeat what others check.
UNUSED = {"processors", "terminal", "instruction_sets", "interruption", "large_surfaces"}
# A test that takes more seconds of a processor by itself is not used.
SLOWEST = 8
# For one mutant, tests of so many seconds of a processor in all.
BUDGET = 20.0


def listed(only, without):
    """The mutants of the rooms, in an order that does not depend on anything but the source."""
    command = ["cargo", "mutants", "--list", "--json"]
    out = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    mutants = [m for m in json.loads(out) if m["file"].startswith(only) and not m["file"].startswith((*LEFT_OUT, *without))]
    return sorted(mutants, key=lambda m: (m["file"], m["span"]["start"]["line"], m["span"]["start"]["column"], m["name"]))


def edit(file, mutant, number):
    """What is inserted where: the range that is replaced, and by what, given what writes a range."""
    genre, replacement, active = mutant["genre"], mutant["replacement"], f"crate::mutant({number})"
    begin, end = (file.offset(mutant["span"][side]) for side in ("start", "end"))

    def node(*kinds):
        return file.node(begin, end, kinds)

    if genre == "FnValue":
        if "impl " in mutant["function"]["return_type"]:
            raise Unfit("returns an opaque type")
        body = node("function_item").child_by_field_name("body")
        value = "" if replacement == "()" else f" {replacement}"
        return (body.start_byte + 1, body.start_byte + 1), lambda _: f" if {active} {{ return{value}; }} "
    if genre == "BinaryOperator":
        whole = node("binary_expression", "compound_assignment_expr")
        operator = whole.child_by_field_name("operator")
        if begin != operator.start_byte:
            raise Unfit("another operator")
        left, right = whole.child_by_field_name("left"), whole.child_by_field_name("right")

        def switched(render):
            a, b = render(left.start_byte, left.end_byte), render(right.start_byte, right.end_byte)
            return f"(if {active} {{ {a} {replacement} {b} }} else {{ {render(whole.start_byte, whole.end_byte)} }})"

        return (whole.start_byte, whole.end_byte), switched
    if genre == "UnaryOperator":
        whole = node("unary_expression", "negative_literal")

        def without(render):
            return f"(if {active} {{ {render(end, whole.end_byte)} }} else {{ {render(whole.start_byte, whole.end_byte)} }})"

        return (whole.start_byte, whole.end_byte), without
    if genre == "MatchArmGuard":
        node("match_arm")
        return (begin, end), lambda render: f"(if {active} {{ {replacement} }} else {{ {render(begin, end)} }})"
    if genre == "MatchArm":
        pattern = node("match_arm").child_by_field_name("pattern")
        condition = pattern.child_by_field_name("condition")
        if condition is None:
            return (pattern.end_byte, pattern.end_byte), lambda _: f" if !{active}"
        return (condition.start_byte, condition.end_byte), lambda render: (
            f"!{active} && ({render(condition.start_byte, condition.end_byte)})"
        )
    if genre == "StructField":
        field = node("field_initializer")
        name, value = field.child_by_field_name("field"), field.child_by_field_name("value")
        base = next((node for node in field.parent.children if node.type == "base_field_initializer"), None)
        if base is None or value is None:
            raise Unfit("no base")
        other = file.text(base).removeprefix("..").strip()
        return (value.start_byte, value.end_byte), lambda render: (
            f"if {active} {{ ({other}).{file.text(name)} }} else {{ {render(value.start_byte, value.end_byte)} }}"
        )
    raise Unfit(genre)


class Kept:
    """What was found out so far, for the same source and sample."""

    def __init__(self, arguments, build):
        self.path = PLACE / "kept.json"
        texts = (path.read_bytes() for path in sorted(build.tree.rglob("*.rs")))
        key = hashlib.sha256(b"".join(texts) + repr(arguments).encode()).hexdigest()
        kept = json.loads(self.path.read_text()) if self.path.exists() else {}
        self.values = kept if kept.get("key") == key else {"key": key, "tests": None, "results": {}}

    def save(self):
        fresh = self.path.with_suffix(".new")
        fresh.write_text(json.dumps(self.values))
        fresh.rename(self.path)


def report(sample, results):
    """Counts, and the mutants that are not caught, to a file; the counts."""
    left = collections.Counter(mutant["left out"] for mutant in sample if "left out" in mutant)
    counts = collections.Counter(result for result, _ in results.values())
    caught = counts["caught"] + counts["does not end"]
    lines = [
        f"{len(sample)} mutants are drawn, {left.total()} left out {dict(left)}, {len(results)} judged {dict(counts)}: "
        f"{caught} of {len(results)} are caught, {caught / max(len(results), 1):.1%}.",
        "",
        "| place | mutation | not caught by |",
        "|---|---|---|",
    ]
    for number, (result, by) in sorted(results.items(), key=lambda item: sample[int(item[0])]["name"]):
        if result in ("not caught", "not reached"):
            place, _, name = sample[int(number)]["name"].partition(": ")
            lines.append(f"| {place.removeprefix('src/')} | `{name}` | {by or 'any test'} |")
    (PLACE / "report.md").write_text("\n".join(lines) + "\n")
    return lines[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=240, help="mutants to draw, those that are left out included")
    parser.add_argument("--seed", type=int, required=True, help="of the sample")
    parser.add_argument("--only", default="src/", help="beginning of the path of the files to draw from")
    parser.add_argument("--without", action="append", default=[], help="beginning of the path of files not to draw from")
    arguments = parser.parse_args()
    everything = listed(arguments.only, arguments.without)
    sample = random.Random(arguments.seed).sample(everything, min(arguments.count, len(everything)))
    build = Build(PLACE, sample, lambda *place: [edit(*place)])
    print(f"{len(everything)} mutants are listed, {len(sample)} drawn, {sum('left out' in m for m in sample)} left out", flush=True)
    build.build_tests()
    kept = Kept(arguments, build)
    if kept.values["tests"] is None:
        kept.values["tests"] = build.trace(SLOWEST, UNUSED)
        kept.save()
    tests, results = kept.values["tests"], kept.values["results"]
    print(f"{len(tests)} tests, {sum(test['seconds'] for test in tests):.0f} s", flush=True)
    left = [number for number, mutant in enumerate(sample) if "left out" not in mutant and str(number) not in results]
    judged = side_by_side(lambda number: (number, build.judge(number, tests, BUDGET)), left)
    for number, result in judged:
        results[str(number)] = result
        kept.save()
        print(f"{number} {sample[number]['name']}: {' by '.join(result)}", flush=True)
        report(sample, results)
    print(report(sample, results))


if __name__ == "__main__":
    main()
