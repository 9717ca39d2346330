"""A capture on the samples of another rate: edges go to the first sample at or after them."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.capture.capture import channel_of_edges
from periph_sim.traces.capture.resample import rate_text, resampled
from periph_sim.traces.formats import BadCapture, Capture, Span

GHZ3 = Fraction(3 * 10**9)


def ticks(edges: list[int], length: int, rate: Fraction | None = GHZ3, unknown: tuple[Span, ...] = ()) -> Capture:
    channel = channel_of_edges("a", 0, 1, np.array(edges, np.int64), unknown)
    return Capture(Path("x"), rate, length, (channel,), sampled=False)


def test_an_edge_goes_to_the_first_sample_at_or_after_it():
    capture = resampled(ticks([1, 125, 126, 1000], 1001), Fraction(24 * 10**6))  # a sample is 125 ticks
    assert (capture.rate, capture.length, capture.sampled) == (24_000_000, 9, True)
    assert capture.channels[0].edges.tolist() == [2, 8]  # 1 and 125 both at 1: a pulse that no sample sees
    assert capture.notes == ("channel a: pulses that fall between two samples of 24 MHz are lost: 1",)


@given(st.sets(st.integers(1, 10**6), max_size=30), st.fractions(Fraction(1, 50), 50), st.integers(0, 10**13))
def test_every_sample_shows_the_level_of_its_instant(places: set[int], ratio: Fraction, far: int):
    edges = sorted(place + far for place in places)
    before = ticks(edges, far + 10**6 + 1)
    after = resampled(before, ratio * GHZ3)
    (channel,) = after.channels
    assert not len(channel.edges) or channel.edges[-1] < after.length
    for edge in edges:
        sample = -int(-edge * ratio // 1)
        for n in range(max(sample - 2, 0), sample + 2):
            instant = np.array([n / ratio // 1], np.int64)  # the level at n samples holds from the tick at or before it
            assert channel.at(np.array([n]))[0] == before.channels[0].at(instant)[0]


def test_unknown_stretches_move_along():
    capture = resampled(ticks([], 1000, unknown=(Span(0, 9), Span(500, 1000))), GHZ3 / 10)
    assert capture.channels[0].unknown == (Span(0, 1), Span(50, 100))
    assert capture.length == 100


def test_the_same_rate_changes_nothing():
    capture = resampled(ticks([3, 7], 10), GHZ3)
    assert (capture.length, capture.channels[0].edges.tolist(), capture.notes) == (10, [3, 7], ())


def test_without_a_rate_there_is_nothing_to_count_in():
    with pytest.raises(BadCapture) as caught:
        resampled(ticks([], 10, None), GHZ3)
    assert str(caught.value) == (
        "x, its rate: found none stated, expected positions with a time; state the rate at which it was captured"
    )


@pytest.mark.parametrize(
    ("rate", "text"),
    [(4 * 10**6, "4 MHz"), (3 * 10**9, "3 GHz"), (115_200, "115200 Hz"), (Fraction(10**6, 3), "1000000/3 Hz")],
)
def test_rates_as_text(rate: int | Fraction, text: str):
    assert rate_text(Fraction(rate)) == text
