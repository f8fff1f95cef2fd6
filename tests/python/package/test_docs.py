"""What the pages show runs: the Python of README and docs/python.md, the tutorial word by word, and the notebooks."""

import importlib.util
import json
import os
import re
import sys
from pathlib import Path
from urllib.parse import unquote

import pytest

from stiction.program import find

ROOT = Path(__file__).resolve().parents[3]
SPEC = importlib.util.spec_from_file_location("doc_blocks", ROOT / "scripts" / "doc_blocks.py")
doc_blocks = importlib.util.module_from_spec(SPEC)
sys.modules["doc_blocks"] = doc_blocks
SPEC.loader.exec_module(doc_blocks)


@pytest.mark.parametrize(
    "page, languages, count",
    [
        pytest.param("docs/tutorial.md", {"sh", "python", "toml"}, 5, marks=pytest.mark.slow),
        pytest.param("docs/python.md", {"python", "toml"}, 10, marks=pytest.mark.slow),
        ("README.md", {"python"}, 1),
    ],
)
def test_blocks_of_pages_run(page, languages, count, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", f"{Path(find()).parent}{os.pathsep}{os.environ['PATH']}")
    ran, printed = doc_blocks.run(ROOT / page, tmp_path, languages)
    assert ran >= count
    if page == "docs/python.md":
        shown = re.findall(r"^```text\n(.*?)^```$", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
        assert printed == "".join(shown)


def test_the_usual_tasks_take_five_lines_each():
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    tasks = page.split("## Ten usual tasks")[1].split("\n## ")[0]
    found = re.findall(r"^### .*?^```python\n(.*?)^```$", tasks, re.MULTILINE | re.DOTALL)
    assert len(found) == 10
    for task in found:
        assert len([line for line in task.splitlines() if line.strip()]) <= 5, task


def anchors(page: Path) -> set[str]:
    """Where links into a page may lead: its headings, by the rule of the site and of forges."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    plain = [re.sub(r"\[(.*?)\]\(.*?\)", r"\1", head) for head in re.findall(r"^#+ +(.*)$", text, re.MULTILINE)]
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in plain}


def links(page: Path) -> list[str]:
    """Relative links and pictures of a page or a notebook."""
    text = page.read_text(encoding="utf-8")
    if page.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        text = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
    text = re.sub(r"^ *```.*?^ *```$|`[^`\n]*`|\$+[^$]*\$+", "", text, flags=re.MULTILINE | re.DOTALL)
    return [link for link in re.findall(r"\]\(([^)\s]+)\)", text) if "://" not in link]


def test_links_of_pages_hold_in_the_repository():
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *ROOT.glob("docs/*.md"), *ROOT.glob("docs/*/*.md"),
             *ROOT.glob("docs/notebooks/*.ipynb")]  # fmt: skip
    broken, seen = [], 0
    for page in pages:
        for link in links(page):
            name, _, anchor = unquote(link).partition("#")
            to = (page.parent / name).resolve() if name else page
            seen += 1
            if not to.is_file() or (anchor and to.suffix == ".md" and anchor not in anchors(to)):
                broken.append(f"{page.relative_to(ROOT)}: {link}")
    assert seen > 300
    assert not broken, "\n".join(broken)
