"""docs/python_api.md names every public name and every call of firmware."""

from __future__ import annotations

import periph_sim
from periph_sim.processor.python.firmware_view import FirmwareView
from tests.docs.pages import ROOT

PAGE = (ROOT / "docs" / "python_api.md").read_text(encoding="utf-8")


def test_every_public_name_is_on_the_page():
    assert [name for name in periph_sim.__all__ if f"`{name}`" not in PAGE] == []


def test_every_call_that_firmware_has_is_on_the_page():
    calls = [name for name, what in vars(FirmwareView).items() if callable(what) and not name.startswith("_")]
    assert len(calls) > 10
    assert [name for name in calls if f"`dsp.{name}(" not in PAGE] == []
