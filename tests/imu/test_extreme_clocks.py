"""The flagship with crystals at their extremes: bytes and instants are exact, and a wrong one of either is seen."""

from __future__ import annotations

import pytest

from periph_sim.imu import extreme_clocks
from periph_sim.imu.extreme_clocks import imu_hil_clocks
from periph_sim.scene.context import CaseTicks


def happens() -> list[str]:
    return [one.happens for one in imu_hil_clocks()]


def test_both_ways_are_exact():
    rows = list(imu_hil_clocks())
    assert [(one.extreme, one.happens) for one in rows] == [
        ("imu_hil, unit +100000 ppm, controller -100000 ppm", "exact"),
        ("imu_hil, unit -100000 ppm, controller +100000 ppm", "exact"),
    ]
    assert rows[0].note.startswith("90 bytes as in the frames, 5 rounds")


def test_rounds_of_another_clock_would_be_seen(monkeypatch: pytest.MonkeyPatch):
    plain = CaseTicks.exact_ticks
    monkeypatch.setattr(CaseTicks, "exact_ticks", lambda self, length, ppm: plain(self, length, ppm + 1))
    assert happens() == ["off", "off"]


def test_bytes_of_another_rate_would_be_seen(monkeypatch: pytest.MonkeyPatch):
    """A host that keeps its own rate is not understood by an SCI that is ten percent off."""
    plain = extreme_clocks.load
    monkeypatch.setattr(extreme_clocks, "load", lambda path, changes: plain(path, changes[:2]))
    assert happens() == ["off", "off"]
