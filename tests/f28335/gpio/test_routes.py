"""Default pins of signals, and notes about pins that are assigned to modules that are not modelled."""

from __future__ import annotations

import pytest

from periph_sim.core.chip import joined
from periph_sim.f28335.gpio.pin_mux_table import FUNCTIONS
from periph_sim.f28335.gpio.settings import INPUTS, OUTPUTS, module_of, note_for
from periph_sim.f28335.parts.f28335 import PART


def test_every_signal_that_is_not_modelled_has_a_module():
    names = {name for row in FUNCTIONS for name in row} - {"", "GPIO", *INPUTS, *OUTPUTS}
    assert {module_of(name) for name in names} == {"ePWM", "eCAP", "eQEP", "eCAN", "McBSP", "ADC", "XINTF"}
    assert [module_of(name) for name in ("TZ1", "MFSXB", "EPWMSYNCO", "XREADY")] == ["ePWM", "McBSP", "ePWM", "XINTF"]


def test_pins_of_one_unmodelled_module_are_joined_to_one_note():
    """The pins are those that TI's InitXintf assigns to XINTF, and two of McBSP."""
    notes = [note_for(pin, 3) for pin in range(28, 88) if FUNCTIONS[pin][2].startswith("X")]
    notes_seen = joined((0, note) for note in [*notes, note_for(20, 2), note_for(21, 2)] if note is not None)
    texts = [note.text for _, note in notes_seen]
    assert len(notes) > 42 and len(texts) == 2
    assert texts[0].startswith(
        "pins are assigned to XINTF, which is not modelled, and stay high-impedance: GPIO28 (XZCS6), "
    )
    assert (
        texts[-1]
        == "pins are assigned to McBSP, which is not modelled, and stay high-impedance: GPIO20 (MDXA), GPIO21 (MDRA)"
    )


@pytest.mark.parametrize("signal", PART.pins)
def test_the_default_pin_of_a_signal_is_one_that_the_multiplexer_offers(signal: str) -> None:
    assert signal in FUNCTIONS[PART.pins[signal]]
