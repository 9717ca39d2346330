"""The examples of docs/schedule.md, run as they stand, in a folder that looks like the repository."""

from __future__ import annotations

import doctest
from pathlib import Path

import pytest

from periph_sim import schedule
from tests.docs.pages import ROOT, scratch

PAGE = ROOT / "docs" / "schedule.md"


def test_every_example_gives_what_the_page_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    text = PAGE.read_text(encoding="utf-8")
    scratch(text, tmp_path)
    monkeypatch.chdir(tmp_path)
    page = doctest.DocTestParser().get_doctest(text, {}, PAGE.name, str(PAGE), 0)
    said: list[str] = []
    results = doctest.DocTestRunner(verbose=False).run(page, out=said.append)
    assert results.attempted > 12 and not results.failed, "".join(said)


def test_every_observable_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    observables = schedule(ROOT / "timing" / "imu_hil_published.toml", rounds=1)
    assert len(observables) > 10
    assert [name for name in observables if f"`{name}`" not in text] == []
