"""The examples of docs/schedule.md, run as they stand, in a folder that looks like the repository."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim import schedule
from tests.docs.examples import run_examples
from tests.docs.pages import ROOT

PAGE = ROOT / "docs" / "schedule.md"


def test_every_example_gives_what_the_page_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    assert run_examples(PAGE, tmp_path, monkeypatch) > 12


def test_every_observable_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    observables = schedule(ROOT / "timing" / "imu_hil_published.toml", rounds=1)
    assert len(observables) > 10
    assert [name for name in observables if f"`{name}`" not in text] == []
