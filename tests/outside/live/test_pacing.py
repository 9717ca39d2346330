"""Pacing by a clock, for which the test has its own."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim.outside.live.pacing import Pacer
from tests.outside.sessions import refuses


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def paced(pace: str = "1", when_late: Any = "slip") -> tuple[Pacer, Clock]:
    clock = Clock()
    pacer = Pacer(1000, Fraction(pace), when_late, clock)
    assert pacer.wait(0) == 0.0  # the clock starts
    return pacer, clock


@pytest.mark.parametrize(("pace", "wait"), [("1", 2.0), ("2", 1.0), ("0.5", 4.0), ("0", 0.0)])
def test_waits(pace: str, wait: float) -> None:
    pacer, clock = paced(pace)
    assert pacer.wait(2000) == pytest.approx(wait)
    clock.now += 0.25
    assert pacer.wait(2000) == pytest.approx(max(0.0, wait - 0.25))
    clock.now += 10
    assert pacer.wait(2000) == 0.0


def late_by(pacer: Pacer, clock: Clock, tick: int, lateness: float) -> None:
    clock.now += pacer.wait(tick) + lateness
    pacer.reached(tick)


@pytest.mark.parametrize(
    ("when_late", "last"),
    [("slip", "later than 50 ms: 2 times, 2 slips"), ("catch-up", "later than 50 ms: 2 times, caught up")],
)
def test_text_of_the_histogram(when_late: str, last: str) -> None:
    pacer, clock = paced(when_late=when_late)
    for tick, lateness in enumerate([0.0, 0.00009, 0.00011, 0.0499, 0.0501, 2.0], start=1):
        late_by(pacer, clock, 10_000 * tick, lateness)
    assert pacer.counts == [2, 1, 0, 0, 0, 0, 0, 0, 1, 1, 0, 1]
    assert pacer.percentile(0.99) == pacer.worst == pytest.approx(2.0)
    assert [pacer.percentile(share) for share in (0.2, 0.5, 0.6)] == [0.0001, 0.0002, 0.05]
    assert pacer.text() == [
        "lateness: 99 % of 6 steps within 2e+03 ms, worst 2e+03 ms",
        "         2  up to 0.1 ms",
        "         1  up to 0.2 ms",
        "         1  up to 50 ms",
        "         1  up to 100 ms",
        "         1  beyond 1e+03 ms",
        last,
    ]


def test_time_before_the_first_wait_is_not_late() -> None:
    clock = Clock()
    pacer = Pacer(1000, Fraction(2), "slip", clock)
    pacer.reached(5000)
    assert pacer.counts == [0] * 12
    assert pacer.wait(3000) == 0.0, "the clock starts with the first call, at any tick"
    assert pacer.wait(4000) == pytest.approx(0.5)


def test_slip_accepts_lateness_and_catch_up_recovers_it() -> None:
    for when_late, wait in (("slip", 0.1), ("catch-up", 0.0)):
        pacer, clock = paced("1", when_late)
        late_by(pacer, clock, 100, 0.200)
        assert pacer.wait(200) == pytest.approx(wait)
        assert (pacer.late, pacer.slips) == (1, int(when_late == "slip"))
        assert pacer.text()[-1].startswith("later than 50 ms: 1 time, ")


def test_stop_ends_the_session() -> None:
    pacer, clock = paced("1", "stop")
    refuses(r"simulated time is 200.0 ms late, and --when-late is stop", late_by, pacer, clock, 100, 0.200)


def test_full_speed_is_never_late_and_a_pace_below_0_is_refused() -> None:
    pacer, clock = paced("0")
    late_by(pacer, clock, 100, 5.0)
    assert (pacer.text(), pacer.worst) == ([], 0.0)
    refuses("pace -1: expected 0, as fast as it can, or more", Pacer, 1000, Fraction(-1))
