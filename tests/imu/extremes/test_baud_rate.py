"""The baud rate at its extremes: the limit is found where it should be, and another receiver's would be seen."""

from __future__ import annotations

from fractions import Fraction
from functools import partial

import pytest

from periph_sim.f28335.sci.module import Sci
from periph_sim.f28335.sci.options import SciOptions
from periph_sim.imu.extremes import baud_rate
from periph_sim.imu.extremes.baud_rate import PHASES, baud_rates, received


def test_both_limits_are_exact():
    assert [(one.extreme, one.happens, round(one.begins or 0, 3)) for one in baud_rates()] == [
        ("baud rate of a fast sender", "exact", 3.896),
        ("baud rate of a slow sender", "exact", -5.263),
    ]


@pytest.mark.parametrize(("bit", "all_received"), [("7.705", True), ("7.69", False), ("8.44", True), ("8.45", False)])
def test_within_the_limit_every_phase_is_received_and_beyond_it_not(bit: str, all_received: bool):
    assert all(received(Fraction(bit), phase) for phase in range(PHASES)) == all_received


def test_a_receiver_that_votes_one_sample_earlier_would_be_seen(monkeypatch: pytest.MonkeyPatch):
    """As the erratum draws it: samples 3 to 5 of the stop bit."""
    monkeypatch.setattr(baud_rate, "Sci", partial(Sci, options=SciOptions(stop_vote_samples="3_4_5")))
    assert "off" in [one.happens for one in baud_rates()]


def test_a_sender_whose_rate_is_off_would_be_seen(monkeypatch: pytest.MonkeyPatch):
    sent = baud_rate.UartSender
    monkeypatch.setattr(
        baud_rate,
        "UartSender",
        lambda kernel, recorder, line, bit: sent(kernel, recorder, line, bit * Fraction(1005, 1000)),
    )
    assert [one.happens for one in baud_rates()] == ["off", "off"]
