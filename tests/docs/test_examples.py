"""The Python examples of pages run as printed, in a folder that looks like the repository."""

from __future__ import annotations

import doctest
from pathlib import Path

import pytest

from tests.docs.pages import ROOT, scratch


@pytest.mark.parametrize(("name", "least"), [("any_order", 4), ("outside", 13), ("python_api", 16)])
def test_every_example_prints_what_the_page_shows(
    name: str, least: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = ROOT / "docs" / f"{name}.md"
    text = page.read_text(encoding="utf-8")
    scratch(text, tmp_path)
    monkeypatch.chdir(tmp_path)
    examples = doctest.DocTestParser().get_doctest(text, {}, page.name, str(page), 0)
    message: list[str] = []
    results = doctest.DocTestRunner(verbose=False).run(examples, out=message.append)
    assert not results.failed, "".join(message)
    assert results.attempted >= least
