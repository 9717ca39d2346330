"""Sampling of captures with time stamps: the grid of their edges, exact captures, and conversion to samples."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import BadCapture, Capture, Channel, Span, channel_of
from periph_sim.traces.capture.sampling import (
    LONGEST_PAUSE,
    exact_time,
    grid_of,
    is_exact,
    on_samples,
    rate_text,
    resampled,
    sample_step,
    stamp_notes,
)
from tests.refusals import refusal
from tests.traces.formats.looks import edges

GHZ3 = Fraction(3 * 10**9)


def ticks(edges: list[int], length: int, rate: Fraction | None = GHZ3, unknown: tuple[Span, ...] = ()) -> Capture:
    channel = Channel("a", 0, 1, np.array(edges, np.int64), unknown)
    return Capture(Path("x"), rate, length, (channel,), sampled=False)


def test_an_edge_is_moved_to_the_first_sample_at_or_after_it():
    capture = resampled(ticks([1, 125, 126, 1000], 1001), Fraction(24 * 10**6))  # a sample is 125 ticks
    assert (capture.rate, capture.length, capture.sampled) == (24_000_000, 9, True)
    assert capture.channels[0].edges.tolist() == [2, 8]  # 1 and 125 are both at 1, so this pulse is lost
    assert capture.notes == ("channel a: pulses that fall between two samples of 24 MHz are lost: 1",)


@given(st.sets(st.integers(1, 10**6), max_size=30), st.fractions(Fraction(1, 50), 50), st.integers(0, 10**13))
def test_every_sample_has_the_level_of_its_time(places: set[int], ratio: Fraction, far: int):
    edges = sorted(place + far for place in places)
    before = ticks(edges, far + 10**6 + 1)
    after = resampled(before, ratio * GHZ3)
    (channel,) = after.channels
    assert not len(channel.edges) or channel.edges[-1] < after.length
    for edge in edges:
        sample = -int(-edge * ratio // 1)
        for n in range(max(sample - 2, 0), sample + 2):
            instant = np.array([n / ratio // 1], np.int64)  # the last tick at or before sample n
            assert channel.at(np.array([n]))[0] == before.channels[0].at(instant)[0]


def test_unknown_spans_are_resampled():
    capture = resampled(ticks([], 1000, unknown=(Span(0, 9), Span(500, 1000))), GHZ3 / 10)
    assert capture.channels[0].unknown == (Span(0, 1), Span(50, 100))
    assert capture.length == 100


def test_the_same_rate_changes_nothing():
    capture = resampled(ticks([3, 7], 10), GHZ3)
    assert (capture.length, capture.channels[0].edges.tolist(), capture.notes) == (10, [3, 7], ())


def test_a_capture_without_a_rate_cannot_be_resampled():
    assert refusal(BadCapture, resampled, ticks([], 10, None), GHZ3) == (
        "x, its rate: found none stated, expected positions with a time; state the rate at which it was captured"
    )


@pytest.mark.parametrize(
    ("rate", "text"),
    [(4 * 10**6, "4 MHz"), (3 * 10**9, "3 GHz"), (115_200, "115200 Hz"), (Fraction(10**6, 3), "1000000/3 Hz")],
)
def test_rates_as_text(rate: int | Fraction, text: str):
    assert rate_text(Fraction(rate)) == text


PICOSECONDS = 10**12


def stamped(at: list[int], rate: int | None = 10**9, sampled: bool = False, exact: bool = False) -> Capture:
    length = at[-1] + 9 if at else 9
    line = channel_of("SCL", 0, [0, *at], [n & 1 for n in range(len(at) + 1)], length)
    return Capture(Path("stamps"), None if rate is None else Fraction(rate), length, (line,), sampled, exact=exact)


def test_the_step_is_the_coarsest_grid_that_holds_all_edges():
    """The edges are samples at 125 MHz, written in nanoseconds, and begin at any sample."""
    assert grid_of(stamped([11, 27, 67, 91]).channels) == sample_step(stamped([11, 27, 67, 91])) == 8


@pytest.mark.parametrize("at", [[], [5]])
def test_with_fewer_than_two_edges_the_step_is_one_position(at: list[int]):
    assert sample_step(stamped(at)) == 1


def test_times_finer_than_those_of_any_analyser_are_exact():
    fine = [6_667, 13_333, 20_001]
    assert is_exact(stamped(fine, PICOSECONDS)) and sample_step(stamped(fine, PICOSECONDS)) == 1
    assert not is_exact(stamped([8_000, 24_000], PICOSECONDS))
    assert not is_exact(stamped(fine, PICOSECONDS, sampled=True))
    assert is_exact(stamped([8, 24], exact=True)) and sample_step(stamped([8, 24], exact=True)) == 1


def test_a_note_has_the_inferred_grid():
    (note,) = stamp_notes(stamped([11, 27, 67]))
    assert note.startswith("the file gives times, not samples; all its edges are multiples of 8 ns apart")
    assert stamp_notes(stamped([8, 24], sampled=True)) == stamp_notes(stamped([8, 24], exact=True)) == []
    assert stamp_notes(stamped([8, 24], None)) == []


@given(st.sets(st.integers(1, 10**6), min_size=2, max_size=30), st.integers(1, 1000), st.integers(0, 999))
def test_no_edge_is_lost_on_the_samples_of_the_grid(at: set[int], step: int, offset: int):
    given = stamped([step * edge + offset for edge in sorted(at)])
    ready = on_samples(given)
    assert ready.sampled and len(ready.channels[0].edges) == len(at)
    times = [edge / ready.rate * 10**9 for edge in ready.channels[0].edges.tolist()]
    grid = grid_of(given.channels)
    assert all(0 <= t - (step * e + offset) < grid for t, e in zip(times, sorted(at), strict=True))
    assert ready.rate == given.rate / grid and ("samples of" in " ".join(ready.notes)) == (grid > 1)


def test_a_session_of_time_stamps_has_the_rate_of_their_grid(tmp_path: Path):
    """A second in nanoseconds on a grid of 125 MHz is written as 125 million samples, not as a thousand million."""
    capture = stamped([8 * n for n in (1, 5, 900, 10**5)])
    notes = formats.write(capture, tmp_path / "a.sr")
    assert notes == ("times are written as samples of 125 MHz, the slowest rate that has one at every edge",)
    again = formats.read(tmp_path / "a.sr")
    assert (again.rate, again.sampled) == (125 * 10**6, True)
    assert edges(again) == {"SCL": [0, 1, 5, 900, 10**5]}


def test_the_property_exact_is_written_and_read(tmp_path: Path):
    capture = stamped([8, 24], exact=True)
    formats.write(capture, tmp_path / "a.psr")
    assert formats.read(tmp_path / "a.psr").exact
    formats.write(replace(capture, exact=False), tmp_path / "b.psr")
    assert not formats.read(tmp_path / "b.psr").exact


def test_a_long_pause_is_accepted_only_if_the_rest_is_as_long():
    at = np.arange(1, 10**4) * 10**4
    line = Channel("SCL", 0, 1, np.append(at, at[-1] + LONGEST_PAUSE + 3))
    capture = Capture(Path("x.vcd"), Fraction(10**9), int(line.edges[-1]) + 1, (line,), sampled=False)
    assert on_samples(capture).sampled
    longer = replace(capture, length=3 * capture.length)
    with pytest.raises(BadCapture, match=f"--window 0..{capture.length}, or"):
        on_samples(longer)
    assert on_samples(replace(longer, exact=True)).sampled


@pytest.mark.parametrize(
    ("text", "time"),
    [
        ("1970-01-01T00:00:02.050Z", (2050, 3)),
        ("1970-01-01 02:00:00+02:00", (0, 0)),
        ("1969-12-31T23:59:59.75Z", (-25, 2)),
        ("1969-12-31T23:59:55.25Z", (-475, 2)),
        ("1969-12-31T23:59:55", (-5, 0)),
        ("-0.25", (-25, 2)),
    ],
)
def test_a_fraction_of_a_second_is_added_even_before_1970(text: str, time: tuple[int, int]):
    assert exact_time(text) == time
