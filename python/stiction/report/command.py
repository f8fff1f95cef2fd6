"""`stiction report FILE...`: one page to mail."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence
from pathlib import Path

from .. import stored
from ..progress import Bar
from ..terminal import ended, given_words
from .page import write

__all__ = ["main"]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stiction report",
        description="Write one self-contained HTML page about results: the number to quote, figures with their data, verdicts, "
        "the scene and how to make it again. Several results are side by side.",
        epilog="Examples: stiction report case_ii.h5 -o case_ii.html; stiction report dry.h5 wet.h5 -o lubricant.html. "
        "Exit codes: 0 done; 1 the page cannot be written; 2 the command or a file is wrong.",
    )
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help="results of stiction")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.html",
                        help="the page; by default next to the first file, with .html")  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite a page that is there")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Reads the command line, writes the page, and says where it is; returns the exit code."""
    parser = _parser()
    given = parser.parse_args(given_words(arguments))
    output = given.output or given.files[0].parent / f"{given.files[0].stem}.html"
    if output.suffix.lower() not in (".html", ".htm"):
        parser.error(f"--output {output}: a name that ends with .html is needed")
    return ended("stiction report", lambda: _write(given.files, output, given.force))


def _write(files: Sequence[Path], output: Path, force: bool) -> None:
    # A damaged file ends the command with one line.
    for file in files:
        stored.try_first(file)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with Bar("page"):
            page = write(files, output, force=force)
        print(page)
