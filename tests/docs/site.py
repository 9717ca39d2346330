"""Hooks of mkdocs that make README and CONTRIBUTING pages of the site.

README.md       --> index.md         "docs/x.md" becomes "x.md"
CONTRIBUTING.md --> contributing.md
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
PAGES = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md"}
LINK = re.compile(r"\[([^\]]*)\]\((?!https?:|#)([^)#\s]+)(#[^)\s]*)?\)")


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that are files of the root folder."""
    from mkdocs.structure.files import File

    for source, page in PAGES.items():
        text = LINK.sub(_moved, (ROOT / source).read_text(encoding="utf-8"))
        files.append(File.generated(config, page, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Return the text of a page whose links to files of the root folder lead to their pages."""
    return LINK.sub(lambda link: _moved(link) if link[2].startswith("../") else link[0], markdown)


def _moved(link: re.Match[str]) -> str:
    """Return the link for the site: to a page beside this one, or only its text if it leads to another file."""
    text, path, rest = link[1], link[2].removeprefix("../").removeprefix("docs/"), link[3] or ""
    path = PAGES.get(path, path)
    return f"[{text}]({path}{rest})" if path in PAGES.values() or (ROOT / "docs" / path).is_file() else text
