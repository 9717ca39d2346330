"""STP in repeat mode: the STOP follows a byte that is waiting in I2CDXR, or else the byte being sent."""

from __future__ import annotations

import pytest

from ..i2c_bus import SLOT, Bench, Target


def begun() -> tuple[Bench, Target]:
    """Return a bench that sends the first byte of a transfer in repeat mode, with I2CDXR empty."""
    b = Bench(Target())
    b.mode("MST TRX RM STT")
    b.w("I2CDXR", 0x11)
    b.after("XRDY", 4)
    return b, b.target


@pytest.mark.rule("I2C-050", "I2C-059", "I2C-061")
def test_a_waiting_byte_is_sent_before_the_stop() -> None:
    b, target = begun()
    b.w("I2CDXR", 0x22)
    b.set("STP")
    assert b.decoded_after(40 * SLOT) == "S 50W A 11 A 22 A P"
    assert target.got == [0x11, 0x22]


@pytest.mark.rule("I2C-050", "I2C-059", "I2C-061")
def test_without_a_waiting_byte_the_stop_follows_the_byte_being_sent() -> None:
    b, target = begun()
    b.set("STP")
    assert b.decoded_after(40 * SLOT) == "S 50W A 11 A P"
    assert (target.got, b.flag("MST"), b.flag("SCD")) == ([0x11], 0, 1)
