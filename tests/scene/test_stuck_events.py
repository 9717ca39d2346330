"""A line that stays low, as an event of budgets: told from the wires, whoever is the controller, or nobody.

SDA  ────┐ 1 ms                          ┌────
         └───────────── held ────────────┘
                             | 26 ms: stuck, since 25 ms are the most that SMBus allows
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim.processor.dsp import Dsp
from tests.scene.small import scene_with

HELD = {"kind": "hold", "wire": "SDA", "at": "1 ms"}
TO_STUCK = {"name": "to stuck", "measure": "from edge SDA fall to bus stuck", "max": "25 ms"}
COUNT = {"name": "stuck", "measure": "count of bus stuck", "max": 0}


def idle(dsp: Dsp) -> None:
    pass


def ran(monkeypatch: pytest.MonkeyPatch, length: str, budgets: list[dict[str, Any]], **more: Any):
    fault = [HELD | {"length": length}]
    scene = scene_with(monkeypatch, idle, ["I2C-A"], fault=fault, budget=budgets, duration="100 ms", **more)
    return scene.run(Fraction(1, 10))


@pytest.mark.parametrize(("length", "count"), [("24.9 ms", 0), ("25.1 ms", 1), ("60 ms", 1)])
def test_a_held_line_is_an_event_without_a_controller(monkeypatch, length: str, count: int):
    (stuck,) = ran(monkeypatch, length, [COUNT]).budgets
    assert stuck.worst == count


def test_the_event_has_the_instant_at_which_the_line_has_been_low_too_long(monkeypatch):
    (to_stuck,) = ran(monkeypatch, "60 ms", [TO_STUCK]).budgets
    assert (to_stuck.worst, to_stuck.at_s) == (25000.0, pytest.approx(0.001))


def test_rounds_of_a_master_say_how_long_a_line_may_be_low(monkeypatch):
    request = {"name": "read", "address": 0x50, "count": 1}
    rounds = {"period": "20 ms", "stuck_after": "5 ms", "request": [request]}
    (to_stuck,) = ran(monkeypatch, "10 ms", [TO_STUCK], rounds=rounds).budgets
    assert to_stuck.worst == 5000.0


def test_the_event_and_the_measure_count_the_same(monkeypatch):
    event, measure = ran(monkeypatch, "60 ms", [COUNT, {"name": "measure", "measure": "stuck", "max": 0}]).budgets
    assert event.worst == measure.worst == 1
