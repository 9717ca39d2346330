"""The test files and functions that docs/fidelity.md names exist."""

from __future__ import annotations

import re

from tests.docs.pages import ROOT

PAGE = (ROOT / "docs" / "fidelity.md").read_text(encoding="utf-8")


def test_every_test_file_and_case_named_on_the_page_exists():
    named = re.findall(r"\b(?:tests/[\w/.]+|timing/[\w/]+\.toml)\b", PAGE)
    assert len(named) > 10
    assert [path for path in named if not (ROOT / path).exists()] == []


def test_every_test_named_on_the_page_exists():
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py"))
    files = {path.name for path in (ROOT / "tests").rglob("test_*.py")}
    named = [name for name in re.findall(r"`(test_\w+(?:\.py)?)`", PAGE) if name not in files]
    assert len(named) >= 2
    assert [name for name in named if f"def {name}(" not in sources] == []


def test_each_row_of_a_table_with_proofs_names_a_test():
    """A row without a test would be an unverified claim."""
    tables = re.findall(r"^\|.*\| proved by \|\n\|[-|]+\n((?:\|.*\n)+)", PAGE, flags=re.MULTILINE)
    rows_of_both = [row for table in tables for row in table.splitlines()]
    assert len(tables) == 2 and len(rows_of_both) >= 25
    named = re.compile(r"`(?:tests/[\w/.]+|test_\w+)`")
    assert [row for row in rows_of_both if not named.search(row.rstrip("| ").rpartition("|")[2])] == []
