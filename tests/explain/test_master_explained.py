"""Where a unit is the master: a device that stretches is who held SCL, and polls of one that is busy are one line."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim.explain.explain import explain
from periph_sim.explain.text_report import text
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene

SCRIPT = ["50 W 00 10 11 22", "50 W", "50 W", "50 W", "50 W 00 10 Sr 50 R 2"]
REQUEST = {"address": 0x50, "pointer": 0, "count": 0}


def told(measure: str, **device: Any) -> str:
    """The explanation of one budget of a script of transfers."""
    settings = {"script": SCRIPT, "pauses": ["0 s"] * 4 + ["100 us"]}
    unit = {"firmware": "captured_master", "modules": ["I2C-A"], "settings": settings}
    tables = {
        "name": "script",
        "duration": "2 ms",
        "unit": {"dsp": unit},
        "device": {"memory": {"model": "24lc64", "write_time": "400 us", **device}},
        "rounds": {
            "period": "2 ms",
            "ack_polling": True,
            "request": [{**REQUEST, "write": "10 11 22"}, {**REQUEST, "write": "10", "count": 2}],
        },
        "budget": [{"name": "it", "measure": measure, "max": "1 s"}],
    }
    case = Case.model_validate(tables)
    scene = Scene(case)
    result = scene.run()
    explained = explain(case, result.budgets, (), Fraction(2, 1000))["it"]
    assert explained.chain is not None
    return "\n".join(text(explained.chain))


@pytest.mark.parametrize("measure", ["stretch", "response"])
def test_the_device_that_stretches_is_named(measure: str):
    shown = told(measure, stretch={"length": "30 us", "access": "read", "bytes": [1]})
    assert "repeated START, memory (0x50 R)" in shown
    assert "the controller lets go of SCL; memory holds it low" in shown
    assert "25.000 us" in shown and "SCL held low by memory" in shown  # 30 us, of which 5 are the master's own low
    assert "dsp holds it low" not in shown


def test_polls_that_are_refused_are_one_line():
    shown = told("round")
    assert shown.count("not acknowledged") == 1
    assert "memory (0x50 W), not acknowledged, 3 times" in shown
