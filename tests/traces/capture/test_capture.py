"""The Capture: levels, look-ups, unknown spans, and what a rate may look like."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.capture.capture import BadCapture, Capture, Channel, Span, channel_of, rate_of

STATES = st.lists(st.sampled_from([0, 1, None]), min_size=1, max_size=40)


def capture(*channels: Channel, length: int = 10) -> Capture:
    return Capture(Path("x.sr"), Fraction(1), length, channels)


def test_levels_at_and_before_an_edge():
    line = channel_of("a", 0, [0, 3, 5], [1, 0, 1], 8)
    every = np.arange(8)
    assert line.at(every).tolist() == [1, 1, 1, 0, 0, 1, 1, 1]
    assert line.before(every).tolist() == [1, 1, 1, 1, 0, 0, 1, 1]


@given(STATES)
def test_states_come_back_as_levels_where_they_are_known(states: list[int | None]):
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


def test_of_several_states_at_one_position_the_last_counts():
    line = channel_of("a", 0, [0, 4, 4, 6, 6], [1, 0, 1, 0, 0], 8)
    assert (line.initial, line.edges.tolist(), line.levels.tolist()) == (1, [6], [0])


def test_known_spans_are_those_of_all_channels_asked_for():
    a = channel_of("a", 0, [0, 2, 4], [1, None, 0], 10)
    b = channel_of("b", 1, [3, 8], [1, None], 10)
    both = capture(a, b)
    assert both.known(a) == [Span(0, 2), Span(4, 10)]
    assert both.known(b) == [Span(3, 8)]
    assert both.known(a, b) == [Span(4, 8)]
    assert both.known() == [Span(0, 10)]


def test_a_line_that_never_says_a_level_is_unknown_throughout():
    line = channel_of("a", 0, [], [], 10)
    assert line.unknown == (Span(0, 10),) and capture(line).known(line) == []


def test_channels_by_name_last_part_of_a_name_index_and_digits():
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
def test_a_wrong_channel_names_the_right_ones(key: str | int, message: str):
    lines = capture(*(channel_of(name, n, [0], [1], 10) for n, name in enumerate(["SCL", "SDA", "dup", "dup"])))
    with pytest.raises(LookupError) as caught:
        lines.channel(key)
    assert str(caught.value) == message


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
def test_what_is_no_rate_is_refused(text: str):
    with pytest.raises(ValueError, match="is no sample rate; expected a number with or without Hz, kHz, MHz or GHz"):
        rate_of(text)


def test_what_a_damaged_file_holds_cannot_break_the_sentence():
    error = BadCapture(Path("x.vcd"), "line 1", "a\x1db\nc\u2028°", "a name", "mend it")
    assert str(error) == "x.vcd, line 1: found a\\x1db\\nc\\u2028°, expected a name; mend it"
