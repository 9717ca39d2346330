"""Each word of docs/glossary.md is used on the pages, and none of the words that it replaces is."""

from __future__ import annotations

import re

import pytest

from tests.docs.pages import PAGES, ROOT

GLOSSARY = ROOT / "docs" / "glossary.md"
TEXT = GLOSSARY.read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in TEXT.splitlines()
    if re.match(r"\| (?!word)\w", line)
]
WORDS = [(name, replaced) for name, _, replaced in ROWS]
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
OTHERS = [page for page in [*PAGES, ROOT / "CONTRIBUTING.md"] if page != GLOSSARY]
PROSE = {page.stem: FENCED.sub("", page.read_text(encoding="utf-8")).lower() for page in OTHERS}


def word(text: str) -> re.Pattern[str]:
    return re.compile(rf"\b{re.escape(text)}(?:s|es)?\b")


@pytest.mark.parametrize("name", [name for name, _ in WORDS])
def test_a_word_of_the_glossary_is_used(name: str):
    for one in re.sub(r", of .*| \(.*", "", name).split(", "):
        assert any(word(one).search(text) for text in PROSE.values()), one


@pytest.mark.parametrize(("name", "replaced"), [(name, replaced) for name, replaced in WORDS if replaced])
def test_no_page_uses_a_replaced_word(name: str, replaced: str):
    used = {(one, page) for one in replaced.split(", ") for page, text in PROSE.items() if word(one).search(text)}
    assert used == set(), f"the word is {name}"


def test_the_whole_table_is_read():
    assert len(WORDS) > 30
