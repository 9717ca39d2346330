"""Time, clocks, lines, sums of noise and inputs at their extremes: each row is what was tried, not what is believed."""

from __future__ import annotations

from fractions import Fraction
from math import fsum

import numpy as np
import pytest

from periph_sim.core.time import LAST_TICK, Clock, Timebase
from periph_sim.imu.extremes import report
from periph_sim.imu.extremes import time_and_bus as beside
from periph_sim.imu.extremes.finding import EVERY, Finding
from periph_sim.imu.extremes.text_report import text
from periph_sim.imu.noise import AxisNoise, Gaussian, NoiseTerms

ROWS = (beside.longest_run, beside.clocks, beside.lines_at_the_last_tick, beside.noise_sums, beside.inputs)


def rows() -> dict[str, Finding]:
    return {one.extreme: one for row in ROWS for one in row()}


def test_what_happens_at_each() -> None:
    assert {name: one.happens for name, one in rows().items()} == {
        "length of a run, 150 MHz": "refused",
        "length of a run, 28.636363 MHz x 5": "refused",
        "clock -100000 ppm, a day": "exact",
        "clock -37 ppm, a day": "exact",
        "clock +37 ppm, a day": "exact",
        "clock +100000 ppm, a day": "exact",
        "I2C transfer at the last tick": "exact",
        "UART burst at the last tick": "exact",
        "white noise, sample 10^9": "exact",
        "bias instability noise, sample 10^9": "exact",
        "random walk, 10^9 samples": "agrees",
        "NaN in an array": "refused",
        "models' period of 10 s, rounds of 20 ms": "refused",
    }
    assert all(one.arithmetic == EVERY for one in rows().values())


def test_the_longest_run_begins_to_be_refused_where_ticks_end() -> None:
    found = rows()
    assert found["length of a run, 150 MHz"].begins == pytest.approx((LAST_TICK + 1) / 3e9, rel=1e-9)
    assert found["length of a run, 28.636363 MHz x 5"].begins == pytest.approx(161.0434, rel=1e-6)


def test_a_clock_that_drifts_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    def whole_ticks(base: Timebase, hz: Fraction) -> Clock:
        return Clock(base, Fraction(base.per_second, int(base.per_second / hz)))

    monkeypatch.setattr(beside, "Clock", whole_ticks)
    assert {one.happens for one in beside.clocks()} == {"off"}


def test_lines_that_depend_on_the_hour_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    same = beside.i2c_edges

    def late(start: int) -> beside.Edges:
        return [(wire, tick + (start > 0), level) for wire, tick, level in same(start)]

    monkeypatch.setattr(beside, "i2c_edges", late)
    assert [one.happens for one in beside.lines_at_the_last_tick()] == ["off", "exact"]


def test_the_transfer_at_the_last_tick_is_a_transfer() -> None:
    edges = beside.i2c_edges(0)
    assert next(edge for edge in edges if edge[0] == "SDA")[2] == 0  # START
    assert len([edge for edge in edges if edge[0] == "SCL" and edge[2] == 1]) == 10  # address, NACK, STOP
    assert len(beside.uart_edges(0)) == 56


@pytest.mark.parametrize("steps", [1000, 1 << 16, 1 << 20])
def test_rounding_of_a_random_walk_stays_within_its_bound(steps: int) -> None:
    """One addition rounds by at most half a unit of the largest sum; n of them by at most n halves."""
    walk = AxisNoise(NoiseTerms(0.0, 0.0, 1.0), 1.0, 1, "walk")
    sums = walk.values(0, steps + 1)
    exact = fsum(Gaussian(1, "walk/random walk").values(0, steps))
    assert abs(sums[-1] - exact) <= steps * 2.0**-53 * np.abs(sums).max()


def test_samples_far_away_are_as_random_as_near_ones() -> None:
    far = Gaussian(1, "x").values(10**9, 4096)
    assert abs(far.mean()) < 4 / 64 and abs(far.var() - 1) < 0.1
    assert len(np.unique(far)) == 4096 and not np.isin(far, Gaussian(1, "x").values(0, 4096)).any()


def test_the_text_has_a_table_of_its_own_for_them() -> None:
    shown = text(report(("float64",), samples=100, only=("clocks", "inputs")))
    assert "\ntime, clocks, lines and inputs, for any arithmetic\n" in shown
    assert "extremes: effect, and the first input with it" not in shown
    assert "\nclock +37 ppm, a day: 12960479520000 cycles, each within a tick;" in shown
    assert "\n NaN in an array                          refused" in shown


def test_a_clock_of_37_ppm_gains_just_that_in_a_day() -> None:
    clock = Clock(Timebase(150_000_000), 150_000_000 * (1 + Fraction(37, 1_000_000)))
    day = 86_400 * 3_000_000_000
    assert clock.cycle_at(day) == 150_000_000 * 86_400 + 37 * 150 * 86_400
