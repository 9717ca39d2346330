"""The table of docs/traces.md names every file format."""

from __future__ import annotations

import re

from periph_sim.records.recording import recording_formats
from periph_sim.traces import formats
from tests.docs.pages import ROOT

PAGE = (ROOT / "docs" / "traces.md").read_text(encoding="utf-8")


def test_every_suffix_that_is_read_or_written_is_in_the_table():
    table = PAGE[: PAGE.index("\n## Decode")]
    named = set(re.findall(r"`(\.[\w.]+)`", table)) | {".csv", ".bin", ".txt", "/"}  # named by program
    there = {suffix for found in formats.formats().values() for suffix in found.SUFFIXES} | set(recording_formats())
    assert sorted(there - named) == []
