"""Links between pages lead to existing files and headings."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.docs.pages import PAGES, ROOT

LINK = re.compile(r"\]\((?!https?:)([^)#\s]*)(?:#([^)\s]+))?\)")
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
ALL = [*PAGES, ROOT / "CONTRIBUTING.md"]


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings as GitHub forms them."""
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", ALL, ids=lambda page: page.stem)
def test_each_link_leads_to_a_file_and_a_heading(page: Path):
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    wrong = []
    for path, anchor in LINK.findall(text):
        aim = page.parent / path if path else page
        if not aim.exists() or (anchor and anchor not in anchors(aim)):
            wrong.append(f"{path}#{anchor}")
    assert wrong == []


def test_anchors_are_formed_as_on_github(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text('# `[unit.NAME.code]`\n```\n# no heading\n```\n## Why "199 of 300"?\n', encoding="utf-8")
    assert anchors(page) == {"unitnamecode", "why-199-of-300"}
