"""Derived records of a scene: each kind is produced where a budget asks for it, and refused where no part makes it."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import pytest

from periph_sim.processor.dsp import Dsp
from periph_sim.scene.case.model import BadCase, Case
from periph_sim.scene.scene import Scene
from periph_sim.timing.measures.registry import MEASURES
from tests.scene.runs import run_file
from tests.scene.small import scene_with
from tests.timing.events_by_hand import make

BUDGET = 'budget=[{{name = "one", measure = "{}", max = {}}}]'


@pytest.mark.parametrize(
    ("measure", "limit", "count"),
    [
        (
            "value error of accelerometer",
            '"60 LSB"',
            3,
        ),  # one in each of three rounds, after the frames at 4, 24 and 44 ms
        ("value error of magnetometer at frame", '"20 LSB"', 3),
        ("model age", '"22 ms"', 9),  # three chips
        ("response", '"1 ms"', 9),
        ("round", '"3 ms"', 3),
    ],
)
def test_occurrences_are_recorded(measure: str, limit: str, count: int):
    (verdict,) = run_file("imu_moving", "0.05", BUDGET.format(measure, limit)).result.budgets
    assert verdict.count == count


def alone(measure: str, limit: object, module: str = "I2C-A") -> Case:
    """One unit with nothing around it, and one budget."""
    unit = {"firmware": "responder", "modules": [module]}
    budget = {"name": "b", "measure": measure, "max": limit}
    return Case.model_validate({"name": "alone", "duration": "1 ms", "unit": {"dsp": unit}, "budget": [budget]})


@pytest.mark.parametrize("measure", MEASURES)
def test_every_measure_says_what_it_needs(measure):
    kind = make(measure)
    limit = "1 ms" if kind.unit == "time" else 0
    case = alone(measure, limit, "GPIO" if kind.needs == "I2C-A" else "I2C-A")
    needs = "[controller], or [rounds] for a unit that is the master," if kind.needs == "rounds" else kind.needs
    with pytest.raises(BadCase, match=re.escape(f"'{measure}' needs {needs} in the scene, which has none")):
        Scene(case)


def test_a_span_needs_nothing_but_its_firmware():
    assert Scene(alone("span:model", "1 ms")).run().verdict == "fail"  # it was never measured


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
