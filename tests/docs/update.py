"""Run the commands of README and docs and write their outputs into the pages: `python -m tests.docs.update [PAGE ...]`.

A page is named by its stem: `python -m tests.docs.update README why`. Without a name: all of them.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.docs.pages import PAGES, ROOT, refreshed


def main(names: list[str]) -> None:
    unknown = set(names) - {page.stem for page in PAGES}
    if unknown:
        sys.exit(f"there is no page {', '.join(sorted(unknown))}; pages are {', '.join(page.stem for page in PAGES)}")
    for page in PAGES:
        if names and page.stem not in names:
            continue
        text = page.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            fresh = refreshed(text, Path(folder))
        if fresh != text:
            page.write_text(fresh, encoding="utf-8")
            print(f"{page.relative_to(ROOT)}: rewritten")


if __name__ == "__main__":
    main(sys.argv[1:])
