"""Spikes: what an input must ignore is put aside, told, and judged for its length only."""

from __future__ import annotations

import pytest

from periph_sim.traces.compliance import Mode, Verdict, check
from tests.traces.compliance.bus import EASY, Spike, drawn, sampled

FAST = EASY[Mode.FAST]


@pytest.mark.parametrize(
    ("line", "after", "length", "fails"),
    [
        ("SCL", 300, 50, []),  # high phase: a spike, however placed
        ("SCL", 300, 51, ["tSP"]),
        ("SCL", 300, 100, ["tSP"]),
        ("SCL", 300, 101, ["fSCL", "tLOW", "tHIGH"]),  # no spike any more: a clock too short in every way
        ("SDA", 300, 50, []),
        ("SDA", 300, 51, ["tSP"]),
        ("SCL", 1_300, 50, []),  # low phase
        ("SCL", 1_300, 51, ["tSP"]),
    ],
)
def test_a_spike_by_its_length(line, after, length, fails):
    """Behind the fourth rise; SCL is high for 900 ns."""
    report = check(drawn(FAST.but(spike=Spike(line, 3, after, length))), "SCL", "SDA", Mode.FAST)
    assert report.symbols_with(Verdict.FAIL) == fails
    assert report.row("tSP").count == (length <= 100)


def test_while_scl_is_low_sda_may_change_as_often_as_it_likes():
    """51 ns is no spike there: both sides may hand SDA over. 50 ns is one, and moves no set-up time."""
    easy = check(drawn(FAST), "SCL", "SDA", Mode.FAST).row("tSU;DAT")
    for length, count in ((50, 1), (51, 0)):
        report = check(drawn(FAST.but(spike=Spike("SDA", 3, 900 + 1_000, length))), "SCL", "SDA", Mode.FAST)
        assert report.row("tSP").count == count
        assert report.row("tSU;DAT").count == easy.count + 1 - count, "no change in this low phase but this one"


def test_standard_mode_knows_no_spikes():
    bus = EASY[Mode.STANDARD].but(spike=Spike("SCL", 3, 2_000, 30))
    report = check(drawn(bus), "SCL", "SDA", Mode.STANDARD)
    assert report.symbols_with(Verdict.FAIL) == ["fSCL", "tLOW", "tHIGH"]
    assert report.row("tSP").verdict is Verdict.NO_LIMIT


@pytest.mark.parametrize(("length", "verdict"), [(30, Verdict.PASS), (45, Verdict.UNDECIDABLE), (70, Verdict.FAIL)])
def test_sampled_at_100_mhz_a_spike_within_10_ns_of_the_limit_is_undecidable(length, verdict):
    capture = sampled(drawn(FAST.but(spike=Spike("SCL", 3, 300, length))), 100 * 10**6)
    assert check(capture, "SCL", "SDA", Mode.FAST).row("tSP").verdict is verdict


def test_one_low_sample_at_4_mhz_may_be_a_spike_and_fails_no_clock():
    """It is surely shorter than tLOW, but a spike is allowed to be."""
    capture = sampled(drawn(FAST.but(spike=Spike("SCL", 3, 400, 40))), 4 * 10**6, phase=60)
    shortest = check(capture, "SCL", "SDA", Mode.FAST).row("tLOW")
    if shortest.least == 1:
        assert shortest.verdict is Verdict.UNDECIDABLE
    assert shortest.verdict is not Verdict.FAIL


def test_where_nothing_is_seen_a_slow_capture_cannot_say_so():
    assert check(sampled(drawn(FAST), 4 * 10**6), "SCL", "SDA", Mode.FAST).row("tSP").verdict is Verdict.UNDECIDABLE
    assert check(sampled(drawn(FAST), 100 * 10**6), "SCL", "SDA", Mode.FAST).row("tSP").verdict is Verdict.NOT_SEEN
