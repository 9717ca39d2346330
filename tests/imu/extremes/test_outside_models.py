"""Extremes of time, clocks, lines, noise and inputs: each row of the report is measured."""

from __future__ import annotations

from fractions import Fraction
from functools import cache, partial
from typing import Any

import numpy as np
import pytest

from periph_sim.core.time import LAST_TICK, Clock, Timebase
from periph_sim.f28335.sci.module import Sci
from periph_sim.f28335.sci.options import SciOptions
from periph_sim.imu.extremes import OUTSIDE, outside_models, report
from periph_sim.imu.extremes.outside_models import (
    PHASES,
    allan_variances,
    baud_rates,
    exact_variance,
    imu_hil_clocks,
    received,
)
from periph_sim.imu.extremes.sweep import EVERY, ExtremeFinding
from periph_sim.imu.extremes.text_report import text
from periph_sim.imu.identification.allan import allan
from periph_sim.imu.noise import Gaussian
from periph_sim.scene.context import CaseTicks


@cache
def rows() -> dict[str, ExtremeFinding]:
    return {one.extreme: one for row in OUTSIDE.values() for one in row()}


def test_effect_of_each_extreme() -> None:
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
        "NaN in a sample": "refused",
        "models' period of 10 s, rounds of 20 ms": "refused",
        "baud rate of a fast sender": "exact",
        "baud rate of a slow sender": "exact",
        "Allan variance, offset of 1e+09": "agrees",
        "Allan variance, offset of 1e+15": "agrees",
        "Allan variance, ramp of 1e+03": "agrees",
        "Allan variance, ramp of 1e+09": "agrees",
        "imu_hil, unit +100000 ppm, controller -100000 ppm": "exact",
        "imu_hil, unit -100000 ppm, controller +100000 ppm": "exact",
    }
    assert all(one.arithmetic == EVERY for one in rows().values())


def test_limits_of_the_length_of_a_run_and_of_the_rate_of_a_sender() -> None:
    found = rows()
    assert found["length of a run, 150 MHz"].begins == pytest.approx((LAST_TICK + 1) / 3e9, rel=1e-9)
    assert found["length of a run, 28.636363 MHz x 5"].begins == pytest.approx(161.0434, rel=1e-6)
    assert found["baud rate of a fast sender"].begins == pytest.approx(3.896, abs=5e-4)
    assert found["baud rate of a slow sender"].begins == pytest.approx(-5.263, abs=5e-4)
    note = found["imu_hil, unit +100000 ppm, controller -100000 ppm"].note
    assert note.startswith("90 bytes as in the frames, 5 rounds")


def test_a_drifting_clock_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    def whole_ticks(base: Timebase, hz: Fraction) -> Clock:
        return Clock(base, Fraction(base.per_second, int(base.per_second / hz)))

    monkeypatch.setattr(outside_models, "Clock", whole_ticks)
    assert {one.happens for one in outside_models.clocks()} == {"off"}


def test_lines_that_depend_on_the_start_time_are_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    same = outside_models.i2c_edges

    def late(start: int) -> outside_models.Edges:
        return [(wire, tick + (start > 0), level) for wire, tick, level in same(start)]

    monkeypatch.setattr(outside_models, "i2c_edges", late)
    assert [one.happens for one in outside_models.lines_at_the_last_tick()] == ["off", "exact"]


def test_the_transfer_at_the_last_tick_is_a_transfer() -> None:
    edges = outside_models.i2c_edges(0)
    assert next(edge for edge in edges if edge[0] == "SDA")[2] == 0  # START
    assert len([edge for edge in edges if edge[0] == "SCL" and edge[2] == 1]) == 10  # address, NACK, STOP
    assert len(outside_models.uart_edges(0)) == 56


def test_late_samples_are_as_random_as_early_ones() -> None:
    far = Gaussian(1, "x").values(10**9, 4096)
    assert abs(far.mean()) < 4 / 64 and abs(far.var() - 1) < 0.1
    assert len(np.unique(far)) == 4096 and not np.isin(far, Gaussian(1, "x").values(0, 4096)).any()


def test_the_text_has_a_separate_table() -> None:
    shown = text(report(("float64",), samples=100, only=("clocks", "inputs")))
    assert "\ntime, clocks, lines and inputs, for any arithmetic\n" in shown
    assert "extremes: effect, and the first input with it" not in shown
    assert "\nclock +37 ppm, a day: 12960479520000 cycles, each within a tick;" in shown
    assert "\n NaN in a sample                          refused" in shown


@pytest.mark.parametrize(("bit", "all_received"), [("7.705", True), ("7.69", False), ("8.44", True), ("8.45", False)])
def test_every_phase_is_received_within_the_limit_of_the_rate_only(bit: str, all_received: bool):
    assert all(received(Fraction(bit), phase) for phase in range(PHASES)) == all_received


def test_a_receiver_that_votes_one_sample_earlier_is_detected(monkeypatch: pytest.MonkeyPatch):
    """The erratum shows samples 3 to 5 of the stop bit."""
    monkeypatch.setattr(outside_models, "Sci", partial(Sci, options=SciOptions(stop_vote_samples="3_4_5")))
    assert "off" in [one.happens for one in baud_rates()]


def test_a_sender_with_a_wrong_rate_is_detected(monkeypatch: pytest.MonkeyPatch):
    sent = outside_models.UartSender
    monkeypatch.setattr(
        outside_models,
        "UartSender",
        lambda kernel, recorder, line, bit: sent(kernel, recorder, line, bit * Fraction(1005, 1000)),
    )
    assert [one.happens for one in baud_rates()] == ["off", "off"]


def test_the_exact_variance_of_a_ramp_is_half_the_square_of_its_rise():
    """Averages of m samples of a ramp of 3 differ by 3 m; alternating samples change by 2."""
    assert exact_variance([3 * n for n in range(20)], 4) == Fraction((3 * 4) ** 2, 2)
    assert exact_variance([0, 2] * 8, 1) == 2 and exact_variance([0, 2] * 8, 2) == 0


class WithoutMean(np.ndarray):
    """Samples from which `mean` subtracts nothing."""

    def mean(self, *_: object) -> float:  # type: ignore[override]
        return 0.0


@pytest.mark.parametrize(
    ("spoiled", "happens"),
    [
        (lambda samples: samples.view(WithoutMean), ["agrees", "off", "agrees", "agrees"]),
        (lambda samples: samples.astype(np.float32).astype(np.float64), ["off", "off", "agrees", "off"]),
    ],
    ids=["an offset in the running sum", "samples of 24 bits"],
)
def test_lost_digits_are_detected(monkeypatch: pytest.MonkeyPatch, spoiled: Any, happens: list[str]):
    monkeypatch.setattr(outside_models, "allan", lambda samples, period: allan(spoiled(samples), period))
    assert [one.happens for one in allan_variances()] == happens


def happens_to_crystals() -> list[str]:
    return [one.happens for one in imu_hil_clocks()]


def test_rounds_of_another_clock_are_detected(monkeypatch: pytest.MonkeyPatch):
    plain = CaseTicks.exact_ticks
    monkeypatch.setattr(CaseTicks, "exact_ticks", lambda self, length, ppm: plain(self, length, ppm + 1))
    assert happens_to_crystals() == ["off", "off"]


def test_bytes_of_another_rate_are_detected(monkeypatch: pytest.MonkeyPatch):
    """An SCI that is ten percent off cannot receive from a host with the original rate."""
    plain = outside_models.load
    monkeypatch.setattr(outside_models, "load", lambda path, changes: plain(path, changes[:2]))
    assert happens_to_crystals() == ["off", "off"]
