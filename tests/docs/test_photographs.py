"""Every picture of a report on a page shows the current report."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import pytest

from tests.docs.pages import written
from tests.docs.photographs import Photograph, digest, digest_in, photographs, with_digest


@pytest.mark.long  # the commands run in other processes, whose lines are not counted
@pytest.mark.parametrize("photograph", [*photographs()], ids=lambda photograph: photograph.file.stem)
def test_a_photograph_shows_the_current_report(photograph: Photograph, tmp_path: Path) -> None:
    report = written(photograph.page, photograph.command, photograph.report, tmp_path)
    assert digest_in(photograph.file.read_bytes()) == digest(report, photograph.budget), (
        "run `python -m tests.docs.update` and look at it"
    )


def test_there_is_one_photograph() -> None:
    assert [photograph.file.name for photograph in photographs()] == ["report.png"]


def test_a_digest_is_added_to_a_picture_and_read_back() -> None:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0))
    rest = chunk(b"IDAT", zlib.compress(b"\0\0")) + chunk(b"IEND", b"")
    value = "0123456789abcdef" * 4
    marked = with_digest(head + rest, value)
    assert marked.startswith(head) and marked.endswith(rest)
    assert marked[len(head) : -len(rest)] == chunk(b"tEXt", b"Source digest\0" + value.encode())
    assert digest_in(marked) == value and digest_in(head + rest) == ""


PAGE = (
    '<style>{style}</style><dl class="provenance">{commit}</dl><ul class="failures"><li>{why}</li></ul>'
    '<section class="budget" id="c1b1">{one}</section><section class="budget" id="c1b2">{two}</section>'
    "<script>x</script>"
)
SAID = {"style": "a", "commit": "1", "why": "late", "one": "7", "two": "8"}


@pytest.mark.parametrize(("part", "counts"), [("style", 1), ("why", 1), ("one", 1), ("commit", 0), ("two", 0)])
def test_only_a_change_of_the_shown_parts_makes_a_photograph_out_of_date(part: str, counts: int) -> None:
    before, after = (digest(PAGE.format(**message), "c1b1") for message in (SAID, SAID | {part: "other"}))
    assert (before != after) == bool(counts)
