"""Explanations on the page: a Chain made by hand, and what is told of it."""

from __future__ import annotations

from pathlib import Path

from periph_sim.core.time import Timebase
from periph_sim.interfaces.reports.explain import chain
from periph_sim.interfaces.reports.html.explanation import Share, Step, explanation
from tests.interfaces.reports.html.made import US, budget

VERDICT = budget("response", 8.0).verdict
PLACE = chain.FirmwarePlace("batch_read", 98, Path("/home/somebody/imu_hil.py"))


def test_steps_and_shares_are_told_with_their_places_but_not_with_folders() -> None:
    told = explanation(
        chain.Chain(
            VERDICT,
            Timebase(150_000_000),
            8 * US,
            (chain.Step(-2 * US, "START"), chain.Step(1 * US, "wait", 6000, PLACE)),
            (chain.Part("interrupt", "SCIRXINTA", 6 * US, 3, PLACE), chain.Part("wait", "AAS", 2 * US)),
            typical=5 * US,
            more=(chain.Part("interrupt", "SCIRXINTA", 3 * US), chain.Part("wait", "AAS", -1)),
        )
    )
    place = "imu_hil.py:98 (batch_read)"
    assert told.steps == (Step(-6000, "-2.000 us", "", "START", ""), Step(3000, "1.000 us", "2.000 us", "wait", place))
    assert told.shares == (
        Share("SCIRXINTA in 3 times", "6.000 us", 75.0, place, "+3.000 us"),
        Share("wait for AAS", "2.000 us", 25.0, "", ""),  # a third of a nanosecond less is not worth a word
    )
    assert told.typical == "5.000 us"


def test_an_occurrence_without_length_has_no_shares() -> None:
    told = explanation(chain.Chain(VERDICT, Timebase(150_000_000), 0, ()))
    assert (told.steps, told.shares, told.typical) == ((), (), "")
