"""Compliance of real I2C captures: no verdict is given that the sampling rate does not allow."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.traces import formats
from periph_sim.traces.compliance import Mode, Verdict, check
from tests.captures.test_captures_replay_i2c import lines
from tests.captures.where import capture_of, decoded, needs_captures

NS = 10**9


@pytest.mark.parametrize("mode", Mode)
@pytest.mark.parametrize("name", decoded("i2c"))
def test_decided_values_are_at_least_a_sample_from_their_limit(name, mode):
    capture = formats.read(capture_of(name))
    report = check(capture, *lines(name), mode, exact=False)
    sample = report.resolution.period
    assert sample > 0 and report.starts
    for row in report.rows:
        if row.verdict is Verdict.PASS:
            assert row.least is not None and row.most is not None
            if row.bounds.least is not None:
                assert row.least * NS / capture.rate - sample >= row.bounds.least
            if row.bounds.most is not None and not row.excused:
                assert row.most * NS / capture.rate + sample <= row.bounds.most
        if row.verdict is Verdict.FAIL:
            worst = Fraction(row.worst[0].length) * NS / capture.rate
            low = row.bounds.least is not None and worst + sample <= row.bounds.least
            high = row.bounds.most is not None and worst - sample >= row.bounds.most
            assert low or high
    assert str(report) and report.row("tr").verdict is Verdict.NOT_IN_CAPTURE


@needs_captures
def test_a_400_khz_bus_fails_the_limits_of_100_khz():
    """Three devices of an e-book reader. At 4 MHz, the times are too close to the limits of Fast-mode to decide."""
    capture = formats.read(capture_of("i2c_trekstor_accel_pmic_rtc"))
    assert check(capture, mode=Mode.STANDARD).symbols_with(Verdict.FAIL) == [
        "fSCL",
        "tHD;STA",
        "tLOW",
        "tHIGH",
        "tSU;STA",
        "tSU;STO",
    ]
    fast = check(capture, mode=Mode.FAST)
    assert fast.verdict is Verdict.UNDECIDABLE and "tSU;DAT" in fast.symbols_with(Verdict.PASS)


@needs_captures
def test_a_bus_5_percent_too_fast_is_found_at_125_mhz():
    capture = formats.read(capture_of("i2c_mdfu_write_csv"))
    report = check(capture, *lines("i2c_mdfu_write_csv"), Mode.STANDARD, exact=False)
    assert report.symbols_with(Verdict.FAIL) == ["fSCL"] and report.resolution.period == 8
    assert report.row("tVD;DAT").excused > 0, "the target sends late in phases that it stretches"


@needs_captures
def test_a_100_khz_bus_sampled_at_500_khz_cannot_be_judged():
    report = check(formats.read(capture_of("i2c_bh1750_hres")), *lines("i2c_bh1750_hres"), Mode.STANDARD)
    assert report.verdict is Verdict.UNDECIDABLE and not report.symbols_with(Verdict.FAIL)
