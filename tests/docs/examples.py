"""Python examples of a page: a page goes in; they are run as they stand, in a folder that looks like the repository."""

from __future__ import annotations

import doctest
from pathlib import Path

import pytest

from tests.docs.pages import scratch


def run_examples(page: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """How many there are. AssertionError, with what differs, where one gives something else than the page shows."""
    text = page.read_text(encoding="utf-8")
    scratch(text, folder)
    monkeypatch.chdir(folder)
    examples = doctest.DocTestParser().get_doctest(text, {}, page.name, str(page), 0)
    said: list[str] = []
    results = doctest.DocTestRunner(verbose=False).run(examples, out=said.append)
    assert not results.failed, "".join(said)
    return results.attempted
