"""Time that went into code without a name, which nothing was recorded of: told by what the firmware did next."""

from __future__ import annotations

import pytest

from periph_sim.explain.chain import Chain
from periph_sim.explain.explain import explain
from periph_sim.firmware import start_pin
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from tests.records.scenes import line_of
from tests.scene.small import case

UNIT = {"firmware": "pulse", "modules": ["GPIO"], "pins": {"GOOD": 34}}


def pulse(dsp: Dsp, cycles: int) -> None:
    start_pin(dsp, 34)
    dsp.set_pin(34)
    dsp.compute(cycles)
    dsp.clear_pin(34)


def high(cycles: int) -> Chain:
    programs = {"dsp": Firmware("pulse", lambda dsp, settings: pulse(dsp, cycles), None)}
    budget = {"name": "high", "measure": "from edge GOOD rise to edge GOOD fall", "max": "100 ns"}
    made = case("1 ms", unit={"dsp": UNIT}, budget=[budget])
    return explain(made, Scene(made, programs=programs).run().budgets, programs=programs)["high"].chain


def test_a_long_computation_has_the_place_of_the_access_behind_it():
    blamed = high(20_000).blamed
    assert blamed is not None and blamed.place is not None
    assert str(blamed) == "code before GPIO.GPBCLEAR written"
    assert f"{blamed.place.function}:{blamed.place.line}" == line_of(pulse, 4)


@pytest.mark.parametrize("cycles", [20, 150, 151, 20_000])
def test_the_parts_add_up_to_the_whole(cycles: int):
    chain = high(cycles)
    assert sum(part.length for part in chain.parts) == chain.length


def test_a_short_one_has_none():
    """1 us is told as other code, what takes more by the access behind it."""
    assert [str(part) for part in high(130).parts] == ["other code", "hardware, after GPIO.GPBCLEAR written"]
    assert "code before GPIO.GPBCLEAR written" in map(str, high(200).parts)
