"""Pins that firmware gives to a module and that the case has no wire for."""

from __future__ import annotations

import pytest

from periph_sim.firmware import sci_fifo_receiver
from periph_sim.processor.dsp import Dsp
from tests.scene.small import scene_with


def receives_on_gpio36(dsp: Dsp) -> None:
    sci_fifo_receiver(dsp, 40, 12)
    gpio = dsp.module("GPIO")
    dsp.eallow()
    gpio.GPAMUX2.GPIO28 = 0
    gpio.GPBMUX1.GPIO36 = 1  # SCIRXDA
    dsp.compute(10)


def test_an_input_on_another_pin_than_the_wire_is_noted_with_the_key_to_add(monkeypatch: pytest.MonkeyPatch):
    result = scene_with(monkeypatch, receives_on_gpio36, ["SCI-A", "GPIO"], host={}).run()
    notes = [note for note in result.notes if "has no wire" in note]
    assert notes == [
        "dsp: SCI-A has RX on GPIO36, where the case has no wire; add pins = { RX = 36 } to the unit",
    ]


def test_a_module_without_pins_is_not_noted(monkeypatch: pytest.MonkeyPatch):
    result = scene_with(monkeypatch, lambda dsp: dsp.compute(10), ["SCI-A", "GPIO"], host={}).run()
    assert [note for note in result.notes if "has no wire" in note] == []
