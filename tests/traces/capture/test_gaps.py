"""What nobody recorded, told: the spans between the known ones, of one line or of two."""

from __future__ import annotations

from dataclasses import replace

from periph_sim.traces.capture.gaps import gap_notes, gaps
from tests.traces.decode.drawing import drawn

LINES = drawn("""
    SCL ??--__--??__----
    SDA --__--??--??----
""")
SCL, SDA = LINES.channels


def test_the_spans_in_which_a_line_is_unknown():
    assert gaps(LINES, SCL) == [(0, 2), (8, 10)]
    assert gaps(LINES, SDA) == [(6, 8), (10, 12)]
    assert gaps(LINES, SCL, SDA) == [(0, 2), (6, 12)], "the spans of both, joined where they touch"
    assert gaps(drawn("SCL --__")) == []


def test_a_note_says_which_lines_how_long_and_where():
    assert gap_notes(LINES, SCL, SDA) == [
        "SCL and SDA: 2 spans were not recorded, 0.000008000 s in all, 0.000000000 s to 0.000002000 s, "
        "0.000006000 s to 0.000012000 s; nothing is decoded across them"
    ]
    assert gap_notes(replace(LINES, rate=None), SDA) == [
        "SDA: 2 spans were not recorded, 4 samples in all, sample 6 to sample 8, sample 10 to sample 12; "
        "nothing is decoded across them"
    ]
    known = drawn("SCL --__")
    assert gap_notes(known, *known.channels) == []


def test_of_many_spans_the_first_three_are_listed():
    capture = drawn("RX ?-?-?-?-?-?-?-")
    (note,) = gap_notes(capture, *capture.channels)
    assert note.startswith("RX: 7 spans were not recorded") and note.count(" to ") == 3 and "and 4 more" in note
