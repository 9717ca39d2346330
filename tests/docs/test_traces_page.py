"""docs/traces.md: its table of formats names every format there is."""

from __future__ import annotations

import re

from periph_sim.records.recording import recording_formats
from periph_sim.traces import formats
from tests.docs.pages import ROOT

PAGE = (ROOT / "docs" / "traces.md").read_text(encoding="utf-8")


def test_every_suffix_that_is_read_or_written_is_in_the_table():
    table = PAGE[: PAGE.index("\n## Decode")]
    named = set(re.findall(r"`(\.[\w.]+)`", table)) | {".csv", ".bin", ".txt", "/"}  # those by what wrote them
    there = {suffix for found in formats.formats().values() for suffix in found.SUFFIXES} | set(recording_formats())
    assert sorted(there - named) == []
