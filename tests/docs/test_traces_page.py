"""docs/traces.md: its picture is what its command draws, and its table of formats names every format there is."""

from __future__ import annotations

import re
from pathlib import Path

from periph_sim.records.recording import recording_formats
from periph_sim.traces import formats
from tests.docs.pages import ROOT, commands, output, scratch

PAGE = (ROOT / "docs" / "traces.md").read_text(encoding="utf-8")
PICTURE = ROOT / "docs" / "pictures" / "wrong_byte.svg"


def test_the_picture_is_what_the_command_draws(tmp_path: Path):
    shown = [command for command, _ in commands(PAGE) if "--svg" in command]
    assert len(shown) == 1 and "(pictures/wrong_byte.svg)" in PAGE
    scratch(PAGE, tmp_path)
    output(shown[0], tmp_path)
    assert (tmp_path / "wrong.svg").read_text(encoding="utf-8") == PICTURE.read_text(encoding="utf-8")


def test_every_suffix_that_is_read_or_written_is_in_the_table():
    table = PAGE[: PAGE.index("\n## Decode")]
    named = set(re.findall(r"`(\.[\w.]+)`", table)) | {".csv", ".bin", ".txt", "/"}  # those by what wrote them
    there = {suffix for found in formats.formats().values() for suffix in found.SUFFIXES} | set(recording_formats())
    assert sorted(there - named) == []
