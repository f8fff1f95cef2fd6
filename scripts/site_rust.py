"""The pages of the library, with their own search, as a part of the site: `api/`, in the navigation under Reference.

A hook of MkDocs (mkdocs.yml). `cargo doc --no-deps --lib` makes them; a site without them has no such link.
"""

import os
import shutil
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.nav import Link, Navigation

ROOT = Path(__file__).resolve().parent.parent
PAGES = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "doc"
FIRST = "stiction/index.html"


def on_nav(nav: Navigation, **_: object) -> Navigation:
    """The navigation with a link to the library."""
    if (PAGES / FIRST).is_file():
        reference = next(item for item in nav.items if item.title == "Reference")
        reference.children.append(Link("Rust API", f"api/{FIRST}"))
    return nav


def on_post_build(config: MkDocsConfig, **_: object) -> None:
    """Copies the pages into the site."""
    if (PAGES / FIRST).is_file():
        shutil.copytree(PAGES, Path(config.site_dir) / "api", dirs_exist_ok=True)
