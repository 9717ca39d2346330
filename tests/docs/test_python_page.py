"""The examples of docs/python_api.md, run as they stand, in a folder that looks like the repository."""

from __future__ import annotations

import doctest
from pathlib import Path

import pytest

import periph_sim
from periph_sim.processor.python.firmware_view import FirmwareView
from tests.docs.pages import ROOT, scratch

PAGE = ROOT / "docs" / "python_api.md"


def test_every_example_gives_what_the_page_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    text = PAGE.read_text(encoding="utf-8")
    scratch(text, tmp_path)
    monkeypatch.chdir(tmp_path)
    page = doctest.DocTestParser().get_doctest(text, {}, PAGE.name, str(PAGE), 0)
    said: list[str] = []
    results = doctest.DocTestRunner(verbose=False).run(page, out=said.append)
    assert results.attempted > 15 and not results.failed, "".join(said)


def test_every_public_name_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    assert [name for name in periph_sim.__all__ if f"`{name}`" not in text] == []


def test_every_call_that_firmware_has_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    calls = [name for name, what in vars(FirmwareView).items() if callable(what) and not name.startswith("_")]
    assert len(calls) > 10
    assert [name for name in calls if f"`dsp.{name}(" not in text] == []
