"""The class Capture: levels, look-up of channels, unknown spans, pulses; and rates as text."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces.capture.capture import BadCapture, Capture, Channel, Span, channel_of, gap_notes, gaps, rate_of
from tests.profiles import examples
from tests.refusals import refusal
from tests.traces.decode.drawing import drawn
from tests.traces.decode.random_lines import captures

STATES = st.lists(st.sampled_from([0, 1, None]), min_size=1, max_size=40)


def capture(*channels: Channel, length: int = 10) -> Capture:
    return Capture(Path("x.sr"), Fraction(1), length, channels)


def test_levels_at_and_before_an_edge():
    line = channel_of("a", 0, [0, 3, 5], [1, 0, 1], 8)
    every = np.arange(8)
    assert line.at(every).tolist() == [1, 1, 1, 0, 0, 1, 1, 1]
    assert line.before(every).tolist() == [1, 1, 1, 1, 0, 0, 1, 1]


@given(STATES)
def test_states_are_returned_as_levels_where_they_are_known(states: list[int | None]):
    line = channel_of("a", 0, range(len(states)), states, len(states))
    unknown = {place for hole in line.unknown for place in range(*hole)}
    assert unknown == {place for place, state in enumerate(states) if state is None}
    levels = line.at(np.arange(len(states))).tolist()
    assert [(levels[p]) for p in range(len(states)) if p not in unknown] == [s for s in states if s is not None]
    assert all(edge not in unknown for edge in line.edges.tolist())


@given(STATES, st.integers(0, 39), st.integers(1, 40))
def test_a_cut_keeps_the_levels_within(states: list[int | None], begin: int, end: int):
    line = channel_of("a", 0, range(len(states)), states, len(states))
    end = min(end, len(states))
    if begin < end:
        within = np.arange(begin, end)
        part = line.cut(Span(begin, end))
        assert part.at(within).tolist() == line.at(within).tolist()
        assert all(begin < edge < end for edge in part.edges.tolist())


def test_the_last_of_several_states_at_one_position_is_kept():
    line = channel_of("a", 0, [0, 4, 4, 6, 6], [1, 0, 1, 0, 0], 8)
    assert (line.initial, line.edges.tolist(), line.levels.tolist()) == (1, [6], [0])


def test_known_spans_are_those_in_which_all_given_channels_are_known():
    a = channel_of("a", 0, [0, 2, 4], [1, None, 0], 10)
    b = channel_of("b", 1, [3, 8], [1, None], 10)
    both = capture(a, b)
    assert both.known(a) == [Span(0, 2), Span(4, 10)]
    assert both.known(b) == [Span(3, 8)]
    assert both.known(a, b) == [Span(4, 8)]
    assert both.known() == [Span(0, 10)]


def test_a_line_without_any_level_is_unknown_throughout():
    line = channel_of("a", 0, [], [], 10)
    assert line.unknown == (Span(0, 10),) and capture(line).known(line) == []


def test_channels_are_found_by_name_last_part_of_a_name_index_and_digits():
    lines = capture(*(channel_of(name, n, [0], [1], 10) for n, name in enumerate(["tb.scl", "tb.sda", "5", "SCL"])))
    assert [lines.channel(key).index for key in ("tb.scl", "sda", "5", "SCL", "3", 1)] == [0, 1, 2, 3, 3, 1]


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("SDL", "x.sr: there is no channel 'SDL'; did you mean SDA or SCL?"),
        (7, "x.sr: there is no channel 7; it has SCL (index 0), SDA (index 1), dup (index 2), dup (index 3)"),
        ("dup", "x.sr: 'dup' names 2 channels: dup (index 2), dup (index 3)"),
    ],
)
def test_an_unknown_or_ambiguous_channel_is_rejected_with_the_existing_ones(key: str | int, message: str):
    lines = capture(*(channel_of(name, n, [0], [1], 10) for n, name in enumerate(["SCL", "SDA", "dup", "dup"])))
    assert refusal(LookupError, lines.channel, key) == message


@pytest.mark.parametrize(
    ("text", "rate"),
    [
        ("4 MHz", 4_000_000),
        ("500 kHz", 500_000),
        ("12000000", 12_000_000),
        (" 1.5MHz ", 1_500_000),
        ("1 GHz", 10**9),
        ("1 Hz", 1),
        ("0", 0),
        ("2e6", 2_000_000),
        ("33.333 Hz", Fraction(33333, 1000)),
    ],
)
def test_rates_are_exact(text: str, rate: int | Fraction):
    assert rate_of(text) == rate


@pytest.mark.parametrize("text", ["", "fast", "4 MBd", "-1 Hz", "1e999999999"])
def test_invalid_rates_are_rejected(text: str):
    with pytest.raises(ValueError, match="is no sample rate; expected a number with or without Hz, kHz, MHz or GHz"):
        rate_of(text)


def test_control_characters_of_a_damaged_file_are_escaped_in_the_message():
    error = BadCapture(Path("x.vcd"), "line 1", "a\x1db\nc\u2028°", "a name", "mend it")
    assert str(error) == "x.vcd, line 1: found a\\x1db\\nc\\u2028°, expected a name; mend it"


LINES = drawn("""
    SCL ??--__--??__----
    SDA --__--??--??----
""")
SCL, SDA = LINES.channels


def test_the_spans_in_which_a_line_is_unknown():
    assert gaps(LINES, SCL) == [(0, 2), (8, 10)]
    assert gaps(LINES, SDA) == [(6, 8), (10, 12)]
    assert gaps(LINES, SCL, SDA) == [(0, 2), (6, 12)], "adjacent spans of the two lines are joined"
    assert gaps(drawn("SCL --__")) == []


def test_a_note_about_unknown_spans_has_lines_durations_and_times():
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


def test_a_note_lists_the_first_three_of_many_spans():
    capture = drawn("RX ?-?-?-?-?-?-?-")
    (note,) = gap_notes(capture, *capture.channels)
    assert note.startswith("RX: 7 spans were not recorded") and note.count(" to ") == 3 and "and 4 more" in note


@pytest.mark.parametrize(
    ("before", "shortest", "after"),
    [
        ("__-_______----____", 2, "__________----____"),
        ("__--_-____----____", 3, "__________----____"),
        ("___---______---___", 3, "___---______---___"),
        ("__-_------___-____", 3, "____------________"),  # the last edge of a bounce is kept
        ("-_----_-_-_-______", 2, "------------______"),
        ("-_", 9, "-_"),  # the time before the first and after the last edge is not a pulse
        ("-_-", 9, "---"),
        ("--__--", 1, "--__--"),
        ("------", 4, "------"),
    ],
)
def test_short_pulses_are_removed_with_both_edges(before: str, shortest: int, after: str):
    line = drawn(f"X {before}").channel("X").without_glitches(shortest)
    expected = drawn(f"X {after}").channel("X")
    assert (line.initial, line.edges.tolist(), line.levels.tolist()) == (
        expected.initial,
        expected.edges.tolist(),
        expected.levels.tolist(),
    )


@given(captures(("X",)))
@settings(max_examples=examples(40), deadline=None)
def test_no_remaining_pulse_is_short_and_the_last_level_is_kept(capture: Capture):
    line = capture.channel("X")
    line = line.without_glitches(4)
    assert all(b - a >= 4 for a, b in zip(line.edges[:-1].tolist(), line.edges[1:].tolist(), strict=True))
    assert len(line.edges) % 2 == len(capture.channel("X").edges) % 2
    again = line.without_glitches(4)
    assert again.edges.tolist() == line.edges.tolist()
