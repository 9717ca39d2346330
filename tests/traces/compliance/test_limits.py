"""Decisions about a time from its number of samples are always true."""

from __future__ import annotations

from fractions import Fraction
from math import ceil

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.compliance.limits import Resolution, resolution_of
from tests.traces.capture.test_sampling import stamped

FOUR_MHZ = Resolution(Fraction(4 * 10**6), 1)  # 250 ns
EXACT = Resolution(Fraction(10**9), 0)


@pytest.mark.parametrize(
    ("resolution", "ns", "least", "most", "below", "above"),
    [
        (FOUR_MHZ, 4_000, 17, 15, 15, 17),  # 16 samples: 3.75 to 4.25 us
        (FOUR_MHZ, 4_700, 20, 17, 17, 20),  # 18.8 samples
        (FOUR_MHZ, 100, 2, -1, -1, 2),  # no number of samples proves less than 100 ns
        (FOUR_MHZ, 0, 1, -1, -1, 1),
        (EXACT, 4_000, 4_000, 4_000, 3_999, 4_001),
        (Resolution(Fraction(3 * 10**9), 0), 50, 150, 150, 149, 151),  # ticks of a 150 MHz system
        (Resolution(Fraction(24 * 10**6), 1), 50, 3, 0, 0, 3),  # 1.2 samples
        (Resolution(Fraction(10**6, 3), 0), 100, 1, 0, 0, 1),  # exact positions of 3 us
    ],
)
def test_thresholds_in_positions(resolution, ns, least, most, below, above):
    assert resolution.surely_at_least(ns) == least
    assert resolution.surely_at_most(ns) == most
    assert resolution.surely_below(ns) == below
    assert resolution.surely_above(ns) == above


RATES = st.fractions(Fraction(10**4), Fraction(10**9), max_denominator=7)


@given(
    RATES, st.integers(0, 20_000), st.integers(0, 10_000), st.fractions(0, 1, max_denominator=97), st.integers(0, 9_999)
)
def test_decisions_from_samples_are_true(rate, begin, length, phase, limit):
    """Two edges, `length` ns apart, are sampled at any rate and phase."""
    seen = [ceil(at * rate / 10**9 + phase) for at in (begin, begin + length)]
    n = seen[1] - seen[0]
    resolution = Resolution(rate, 1)
    assert n < resolution.surely_at_least(limit) or length >= limit
    assert n > resolution.surely_at_most(limit) or length <= limit
    assert n > resolution.surely_below(limit) or length < limit
    assert n < resolution.surely_above(limit) or length > limit


@given(RATES, st.integers(0, 10_000), st.integers(0, 9_999))
def test_exact_times_are_always_decided(rate, positions, limit):
    resolution = Resolution(rate, 0)
    length = positions * 10**9 / rate
    assert (positions >= resolution.surely_at_least(limit)) == (length >= limit)
    assert (positions <= resolution.surely_at_most(limit)) == (length <= limit)
    assert (positions <= resolution.surely_below(limit)) == (length < limit)
    assert (positions >= resolution.surely_above(limit)) == (length > limit)


def test_a_sampled_capture_has_a_slack_of_one_sample_and_a_simulated_one_none():
    assert resolution_of(stamped([8, 24], sampled=True)).slack == 1
    assert resolution_of(stamped([8, 24], exact=True)).slack == 0
    assert resolution_of(stamped([8, 24]), exact=True).slack == 0


def test_time_stamps_of_an_analyser_have_a_slack_of_their_grid():
    """The edges are samples at 125 MHz, written in nanoseconds, and begin at any sample."""
    assert resolution_of(stamped([11, 27, 67, 91])) == Resolution(Fraction(10**9), 8)
    assert resolution_of(stamped([11, 27, 67, 91])).period == 8
    assert resolution_of(stamped([8_000, 24_000], 10**12, exact=True), exact=False).slack == 16_000


def test_a_capture_without_a_rate_is_rejected():
    with pytest.raises(ValueError, match="stamps: limits need a time base and the file states no rate; state the rate"):
        resolution_of(stamped([8], None))
