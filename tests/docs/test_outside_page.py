"""The examples of docs/outside.md, run as they stand, in a folder that looks like the repository."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.docs.examples import run_examples
from tests.docs.pages import ROOT


def test_every_example_gives_what_the_page_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    assert run_examples(ROOT / "docs" / "outside.md", tmp_path, monkeypatch) > 12
