"""The examples of docs/python_api.md, run as they stand, in a folder that looks like the repository."""

from __future__ import annotations

from pathlib import Path

import pytest

import periph_sim
from periph_sim.processor.python.firmware_view import FirmwareView
from tests.docs.examples import run_examples
from tests.docs.pages import ROOT

PAGE = ROOT / "docs" / "python_api.md"


def test_every_example_gives_what_the_page_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    assert run_examples(PAGE, tmp_path, monkeypatch) > 15


def test_every_public_name_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    assert [name for name in periph_sim.__all__ if f"`{name}`" not in text] == []


def test_every_call_that_firmware_has_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    calls = [name for name, what in vars(FirmwareView).items() if callable(what) and not name.startswith("_")]
    assert len(calls) > 10
    assert [name for name in calls if f"`dsp.{name}(" not in text] == []
