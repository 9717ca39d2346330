"""Run the commands of README and docs, write outputs and measured figures to the pages, and draw their pictures:
`python -m tests.docs.update [PAGE ...]`.

A page is named by its stem: `python -m tests.docs.update README why`. Without a name, all pages are updated.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.docs import commands, keys, live_picture
from tests.docs.limits_table import refreshed_limits
from tests.docs.pages import PAGES, ROOT, refreshed, written
from tests.docs.photographs import digest, digest_in, photographs, taken
from tests.docs.pictures import draw, pictures


def main(names: list[str]) -> None:
    unknown = set(names) - {page.stem for page in PAGES}
    if unknown:
        sys.exit(f"there is no page {', '.join(sorted(unknown))}; pages are {', '.join(page.stem for page in PAGES)}")
    for page in PAGES:
        if names and page.stem not in names:
            continue
        text = page.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            fresh = refreshed_limits(refreshed(text, Path(folder)))
        if fresh != text:
            page.write_text(fresh, encoding="utf-8")
            print(f"{page.relative_to(ROOT)}: rewritten")
    for index in (keys, commands):
        fresh = index.page()
        if (not names or index.PAGE.stem in names) and index.PAGE.read_text(encoding="utf-8") != fresh:
            index.PAGE.write_text(fresh, encoding="utf-8")
            print(f"{index.PAGE.relative_to(ROOT)}: rewritten")
    for picture in pictures():
        if names and picture.page.stem not in names:
            continue
        with tempfile.TemporaryDirectory() as folder:
            drawn = draw(picture, Path(folder))
        if not picture.file.is_file() or picture.file.read_text(encoding="utf-8") != drawn:
            picture.file.write_text(drawn, encoding="utf-8")
            print(f"{picture.file.relative_to(ROOT)}: drawn")
    for one in photographs():
        if names and one.page.stem not in names:
            continue
        with tempfile.TemporaryDirectory() as folder:
            report = written(one.page, one.command, one.report, Path(folder))
            if not one.file.is_file() or digest_in(one.file.read_bytes()) != digest(report, one.budget):
                one.file.write_bytes(taken(Path(folder) / one.report, one.budget))
                print(f"{one.file.relative_to(ROOT)}: photographed")
    if not names or live_picture.PAGE.stem in names:
        there = live_picture.PICTURE
        if not there.is_file() or digest_in(there.read_bytes()) != live_picture.digest_now():
            there.write_bytes(live_picture.taken())
            print(f"{there.relative_to(ROOT)}: photographed")


if __name__ == "__main__":
    main(sys.argv[1:])
