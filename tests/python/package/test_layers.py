"""Files of the package import files below them only."""

import ast
import graphlib
from pathlib import Path

import stiction

FOLDER = Path(stiction.__file__).parent


def module(*names: str) -> Path | None:
    """The file of a module below the package."""
    path = FOLDER.joinpath(*names)
    return next((one for one in (path.with_suffix(".py"), path / "__init__.py") if one.is_file()), None)


def imported(path: Path) -> set[Path]:
    """The files that a file takes names from: at its top, in functions, or for types alone."""
    package, found = path.relative_to(FOLDER).parent.parts, set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = (*package[: len(package) + 1 - node.level], *(node.module or "").split("."))
            base = tuple(name for name in base if name)
            found |= {module(*base, name.name) or module(*base) for name in node.names}
    return found - {None}


def test_no_files_import_each_other_in_a_circle():
    graph = {path: imported(path) for path in FOLDER.rglob("*.py")}
    assert sum(map(len, graph.values())) > 200
    graphlib.TopologicalSorter(graph).prepare()
