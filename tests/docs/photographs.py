"""Pictures of HTML reports on the pages: each mark on a page describes one Photograph.

<!-- photographed: COMMAND -> REPORT.html #BUDGET -->
![what it shows](pictures/NAME.png)

The pixels of a page depend on the browser's version and fonts. So a picture contains the digest of the HTML, style
and script that it shows: it is out of date if these have changed, whatever its pixels are.
"""

from __future__ import annotations

import re
import shutil
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from tests.docs.pages import PAGES

if TYPE_CHECKING:
    from playwright.sync_api import Page

MARK = re.compile(r"^<!-- photographed: (.+) -> (\S+) #(\w+) -->\n!\[[^\]]*\]\((\S+)\)$", re.MULTILINE)
PARTS = (r'<ul class="failures">.*?</ul>', r"<style>.*?</style>", r"<script>.*?</script>")
APART = "header dl, header details, header > p { display: none !important }"  # commit, wall time: not constant
KEY = b"Source digest"
SIGNATURE_AND_HEAD = 8 + 25  # bytes of a PNG that come before all others
WIDTH = 1400


class Photograph(NamedTuple):
    """The page that shows a picture, the command that writes `report`, the id of the budget's section, and the file."""

    page: Path
    command: str
    report: str
    budget: str
    file: Path


def photographs() -> Iterator[Photograph]:
    for page in PAGES:
        for command, report, budget, shown in MARK.findall(page.read_text(encoding="utf-8")):
            yield Photograph(page, command, report, budget, (page.parent / shown).resolve())


def digest(report: str, budget: str) -> str:
    """Return the digest of everything that a photograph of this budget shows."""
    parts = (*PARTS, rf'<section class="budget" id="{budget}">.*?</section>')
    found = [re.search(part, report, re.DOTALL) for part in parts]
    assert all(found), f"the report lacks one of {parts}"
    return sha256("".join(one[0] for one in found if one).encode()).hexdigest()


def digest_in(png: bytes) -> str:
    """Return the digest that `with_digest` wrote, or ""."""
    found = re.search(re.escape(KEY) + rb"\0([0-9a-f]{64})", png)
    return found[1].decode() if found else ""


def with_digest(png: bytes, value: str) -> bytes:
    """Return the picture with an additional tEXt chunk [PNG specification, 11.3.3.3]."""
    chunk = b"tEXt" + KEY + b"\0" + value.encode()
    framed = struct.pack(">I", len(chunk) - 4) + chunk + struct.pack(">I", zlib.crc32(chunk))
    return png[:SIGNATURE_AND_HEAD] + framed + png[SIGNATURE_AND_HEAD:]


@contextmanager
def opened(url: str, width: int) -> Iterator[Page]:
    """Open a page in a new browser."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme="light")
        page.goto(url)
        yield page
        browser.close()


def taken(report: Path, budget: str) -> bytes:
    """Return the head of a report and one budget as PNG."""
    with opened(report.as_uri(), WIDTH) as page:
        page.add_style_tag(content=APART)
        box = page.locator(f"#{budget}").bounding_box()
        assert box is not None
        height = round(box["y"] + box["height"]) + 8
        png = page.screenshot(clip={"x": 0, "y": 0, "width": WIDTH, "height": height}, full_page=True)
    return with_digest(png, digest(report.read_text(encoding="utf-8"), budget))
