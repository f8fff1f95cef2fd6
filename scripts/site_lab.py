"""The page of `stiction lab` as a part of the site: `lab/`, in the navigation under Start.

A hook of MkDocs (mkdocs.yml). `scripts/lab.sh` builds what it computes with; a site without it has no such page, and
docs/lab.md says so in the place of the link.
"""

import shutil
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.nav import Link, Navigation

PAGE = Path(__file__).resolve().parent.parent / "python" / "stiction" / "lab"
IS_BUILT = (PAGE / "stiction.wasm").is_file()
FIRST = "lab/index.html"
PLACE = "<!-- the page -->"
OPEN = f'<a class="md-button md-button--primary" href="{FIRST}">Will my pad stick?</a>'
MISSING = "*This site was built without the page itself.*"


def on_nav(nav: Navigation, **_: object) -> Navigation:
    """The navigation with a link to the page."""
    if IS_BUILT:
        start = next(item for item in nav.items if item.title == "Start")
        start.children.insert(1, Link("Will my pad stick?", FIRST))
    return nav


def on_page_markdown(markdown: str, **_: object) -> str:
    """The link to the page where docs/lab.md has its place."""
    return markdown.replace(PLACE, OPEN if IS_BUILT else MISSING)


def on_post_build(config: MkDocsConfig, **_: object) -> None:
    """Copies the page into the site."""
    if IS_BUILT:
        left = shutil.ignore_patterns("*.py", "__pycache__")
        shutil.copytree(PAGE, Path(config.site_dir) / "lab", dirs_exist_ok=True, ignore=left)
