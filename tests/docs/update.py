"""`python -m tests.docs.update` runs the commands of README and docs and writes their outputs into the pages."""

from __future__ import annotations

import tempfile
from pathlib import Path

from tests.docs.pages import PAGES, ROOT, refreshed


def main() -> None:
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            fresh = refreshed(text, Path(folder))
        if fresh != text:
            page.write_text(fresh, encoding="utf-8")
            print(f"{page.relative_to(ROOT)}: rewritten")


if __name__ == "__main__":
    main()
