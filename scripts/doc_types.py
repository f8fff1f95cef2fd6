#!/usr/bin/env python3
"""Checks that every public struct, enum and trait of the library is used in a doctest.

    cargo doc --release --no-deps --lib && scripts/doc_types.py [target/doc/stiction]

The public ones are those that the list of all items has, `all.html` of `cargo doc`; items behind
`#[doc(hidden)]` are not among them. A type is used where its name is in a doctest, that is in Rust code
of a doc comment under src, on a line that readers see and outside of comments and `use`. Where two types have
one name the doctest has to name the module as well. Prints the types that no doctest uses, and fails if there
are any.
"""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ITEM = re.compile(r'<a href="([\w/]*?)(struct|enum|trait)\.(\w+)\.html">')
COMMENT = re.compile(r"^\s*//[/!] ?(.*)$")
# Words of a fence for code that is compiled; anything else, such as `toml` or `text`, is no doctest.
COMPILED = {"", "rust", "no_run", "should_panic"}


def doctests(source):
    """The doctests of a source file."""
    block = None
    for line in source.splitlines():
        comment = COMMENT.match(line)
        if comment is None:
            block = None
        elif comment[1].startswith("```"):
            if block is None:
                block = (set(comment[1][3:].split(",")), [])
            else:
                if block[0] <= COMPILED:
                    yield "\n".join(block[1])
                block = None
        elif block is not None:
            block[1].append(comment[1])


def used(doctest):
    """The names that a doctest uses where readers see it."""
    seen = [line for line in doctest.splitlines() if not re.match(r"\s*#( |$)", line)]
    code = re.sub(r"//.*", "", "\n".join(seen))
    return set(re.findall(r"\w+", re.sub(r"\buse [^;]*;", "", code)))


def main(pages):
    types = [(module.strip("/").replace("/", "::"), name)
             for module, _, name in ITEM.findall((pages / "all.html").read_text())]
    if not types:
        sys.exit(f"{pages / 'all.html'} lists no types")
    sources = [path.read_text() for path in sorted(ROOT.glob("src/**/*.rs"))]
    tests = [(test, used(test)) for source in sources for test in doctests(source)]
    count = collections.Counter(name for _, name in types)

    def is_shown(module, name):
        own = module.rpartition("::")[2]
        return any(name in names and (count[name] == 1 or f"{own}::" in test) for test, names in tests)

    missing = ["::".join(filter(None, kind)) for kind in types if not is_shown(*kind)]
    for path in missing:
        print(f"{path} is public, and no doctest uses it: give it one, or hide it by #[doc(hidden)]")
    if missing:
        sys.exit(1)
    print(f"{len(types)} public types, each in a doctest")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "target/doc/stiction")
