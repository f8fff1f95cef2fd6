"""Notebooks as pages of the site: what they say, compute and show, as it is in them.

A hook of MkDocs (mkdocs.yml): docs/notebooks/NAME.ipynb becomes the page notebooks/NAME.md, whose links are
checked like the links of any page. Pages link to the notebooks, which the repository has, and on the site to
their pages.
"""

import json
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page


def page(notebook: dict, name: str) -> str:
    """The Markdown of a notebook."""
    parts = []
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        parts.append(f"```python\n{source}\n```" if cell["cell_type"] == "code" else source)
        parts += [shown(output) for output in cell.get("outputs", [])]
    parts.insert(1,
                 f"This page is a notebook, [{name}]({name}), executed whenever the project is checked.")
    return "\n\n".join(part for part in parts if part) + "\n"


def shown(output: dict) -> str:
    """The output that a cell printed, drew or returned."""
    if output["output_type"] == "stream":
        return f"```text\n{''.join(output['text']).rstrip()}\n```"
    data = output.get("data", {})
    if "image/svg+xml" in data:
        drawing = "".join(data["image/svg+xml"])
        return f'<div class="figure">{"".join(drawing[drawing.index("<svg") :].splitlines())}</div>'
    if "image/png" in data:
        source = "".join(data["image/png"]).strip()
        return f'<img class="figure" alt="What the cell draws" src="data:image/png;base64,{source}">'
    if "text/html" in data:
        return f'<div class="output">{" ".join("".join(data["text/html"]).split())}</div>'
    return f"```text\n{''.join(data.get('text/plain', ''))}\n```"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """A page for each notebook, which itself is there for the taking."""
    for file in list(files):
        if file.src_uri.endswith(".ipynb"):
            path = Path(file.abs_src_path)
            text = page(json.loads(path.read_text(encoding="utf-8")), path.name)
            files.append(File.generated(config, str(Path(file.src_uri).with_suffix(".md")), content=text))
    return files


def on_page_markdown(markdown: str, page: Page, **_: object) -> str:
    """Links to notebooks as links to their pages, but for the one of a page to its own notebook."""
    own = Path(page.file.src_uri).stem
    return re.sub(r"\]\(((?:[\w-]+/)*)([\w-]+)\.ipynb\)",
                  lambda link: link[0] if link[2] == own else f"]({link[1]}{link[2]}.md)", markdown)
