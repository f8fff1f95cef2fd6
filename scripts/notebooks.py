"""Executes notebooks of the documentation; an error in a cell is an error, and so is another text than the
one they show.

Usage:
    python scripts/notebooks.py [--write] NOTEBOOK...

Each runs in a folder of its own, where configs/ is as in the source. With --write the notebooks get the
outputs. Bars of progress and other lines of standard error are left out. Figures, and the HTML of tables, are
not compared: they differ from one version of matplotlib and pandas to the next.
Exit codes: 0 all ran, 1 a cell failed or its text is another one.
"""

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

import nbclient
import nbformat

ROOT = Path(__file__).resolve().parent.parent


def executed(path):
    """The notebook with the outputs of its cells and nothing that differs from time to time."""
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory(prefix="stiction-notebook-") as folder:
        shutil.copytree(ROOT / "configs", Path(folder) / "configs")
        nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3",
                                resources={"metadata": {"path": folder}}).execute()
    notebook.metadata = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    for number, cell in enumerate(notebook.cells):
        cell.id = f"cell-{number}"
        cell.metadata = {}
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if kept(output)]
    return notebook


def kept(output):
    if output.output_type == "stream":
        return output.name == "stdout"
    output.metadata = {}
    # A bar of progress is a widget or a text of tqdm.
    return not any("widget" in kind for kind in output.get("data", {}))


def texts(notebook):
    """The source of each cell, and what it prints or returns as text."""
    found = []
    for cell in notebook.cells:
        printed = [output.text for output in cell.get("outputs", []) if output.output_type == "stream"]
        returned = [output.data["text/plain"] for output in cell.get("outputs", [])
                    if output.output_type == "execute_result"]
        found.append((cell.source, "\n".join(printed + returned)))
    return found


def main():
    parser = argparse.ArgumentParser(description="Executes notebooks of the documentation.")
    parser.add_argument("--write", action="store_true", help="keep the outputs in the notebooks")
    parser.add_argument("notebooks", nargs="+", type=Path)
    arguments = parser.parse_args()
    for path in arguments.notebooks:
        print(path, flush=True)
        shown = texts(nbformat.read(path, as_version=4))
        try:
            notebook = executed(path)
        except nbclient.exceptions.CellExecutionError as error:
            sys.exit(f"{path}: {error}")
        if arguments.write:
            nbformat.write(notebook, path)
            continue
        for (source, old), (_, new) in zip(shown, texts(notebook), strict=True):
            if new != old:
                sys.exit(f"{path}: the cell\n\n{source}\n\nshows\n\n{old}\n\nthere, and now\n\n{new}")


if __name__ == "__main__":
    main()
