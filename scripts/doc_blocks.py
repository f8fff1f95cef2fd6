"""Runs the commands and the Python of pages of the documentation, in order, in a folder of their own.

Usage:
    python scripts/doc_blocks.py [--only LANGUAGE]... PAGE...

Blocks ```sh are given to bash; those in ```python of a page are one program for this interpreter, which runs
behind the commands. The first block ```toml of a page is saved as first.toml and each further one appended to
it, as the tutorial says. The scenes and the map that ship with the source are there as in the source, in
configs/, and the map as scan.txt. What is behind `<!-- not run -->` is left out. Nothing but the standard
library is needed here. Exit codes: 0 all ran; 1 one failed, which ends it.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"^(?P<skip><!-- not run -->\n+)?```(?P<language>\w+)\n(?P<text>.*?)^```$",
                   re.MULTILINE | re.DOTALL)


def blocks(page, only):
    """Language, text and line of each block that is run."""
    whole = page.read_text(encoding="utf-8")
    found = [(match["language"], match["text"], whole[: match.start("text")].count("\n") + 1, match["skip"])
             for match in BLOCK.finditer(whole)]
    return [(language, text, line) for language, text, line, skip in found if language in only and not skip]


def run(page, folder, only):
    """Runs the blocks of a page in a folder: their number, and what its Python printed; the first that fails
    is an error."""
    shutil.copytree(ROOT / "configs", folder / "configs", dirs_exist_ok=True)
    shutil.copy(ROOT / "configs" / "maps" / "polished.txt", folder / "scan.txt")
    environment = {**os.environ, "MPLBACKEND": "agg",
                   "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    python, found = "", blocks(page, only)
    for language, text, line in found:
        print(f"{page.name}, line {line}: {language}", flush=True)
        if language == "python":
            # The lines of a traceback are the lines of the page.
            python += "\n" * (line - 1 - python.count("\n")) + text
        elif language == "toml":
            with open(folder / "first.toml", "a", encoding="utf-8") as scene:
                scene.write(("\n" if scene.tell() else "") + text)
        else:
            subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=environment, check=True)
    if not python:
        return len(found), ""
    done = subprocess.run([sys.executable, "-c", python], cwd=folder, env=environment, check=True,
                          stdout=subprocess.PIPE, encoding="utf-8")
    print(done.stdout, end="", flush=True)
    return len(found), done.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", action="append", choices=["sh", "python", "toml"],
                        help="blocks of this language alone")
    parser.add_argument("pages", nargs="+", type=Path)
    arguments = parser.parse_args()
    for page in arguments.pages:
        with tempfile.TemporaryDirectory(prefix="stiction-page-") as folder:
            try:
                run(page, Path(folder), set(arguments.only or ["sh", "python", "toml"]))
            except subprocess.CalledProcessError as error:
                sys.exit(f"{page}: failed with exit code {error.returncode}")


if __name__ == "__main__":
    main()
