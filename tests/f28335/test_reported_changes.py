"""Results of `pins` and `wake`, which state what may have changed, are correct and as narrow as possible."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest

from periph_sim.core.chip import ANY_CHANGED, NO_CHANGE, PINS_CHANGED, WAKE_CHANGED

from .i2c_registers import BB, OFFSET
from .i2c_rig import OTHER, OWN, Rig
from .sci_rig import SciRig, frame
from .spi_rig import HALF, SLAVE, SpiRig

RESULTS = {NO_CHANGE: "nothing", WAKE_CHANGED: "later", PINS_CHANGED: "outputs", ANY_CHANGED: "all"}


def counted(chip: Any) -> Counter[str]:
    """Return a counter of the results of all later calls of `pins` and `wake`; each call checks its result."""
    said: Counter[str] = Counter()

    def registers(now: int) -> list[int]:
        return [chip.peek(now, register.offset) for register in chip.MAP]

    def checked(name: str) -> None:
        call = getattr(chip, name)

        def checking(now: int, *levels: int) -> int:
            due = chip.next_wake <= now and name == "pins"
            before = [] if due else registers(now - 1)
            shown = chip.out, chip.next_wake
            result: int = call(now, *levels)
            said[f"{name}: {RESULTS[result]}"] += 1
            if due:
                assert result == ANY_CHANGED, "with a wake-up due, the result must be ANY_CHANGED"
            elif result != ANY_CHANGED:
                assert registers(now) == before
            if result == NO_CHANGE:
                assert (chip.out, chip.next_wake) == shown
            if result == WAKE_CHANGED:
                assert chip.out == shown[0]
            return result

        setattr(chip, name, checking)

    checked("pins")
    checked("wake")
    return said


def expected(pins: tuple[int, int, int, int], wakes: tuple[int, int]) -> dict[str, int]:
    """Return expected counts. pins: NO_, WAKE_, PINS_, ANY_CHANGED; wakes: PINS_, ANY_CHANGED."""
    names = ["pins: nothing", "pins: later", "pins: outputs", "pins: all", "wake: outputs", "wake: all"]
    return {name: count for name, count in zip(names, (*pins, *wakes), strict=True) if count}


def test_sci_flags_change_when_a_frame_is_complete():
    """Only one of the eight edges, that of the start bit, schedules a wake-up. RXRDY and RXINT change at wake-ups."""
    rig = SciRig(RXBKINTENA=1)
    said = counted(rig.chip)
    rig.send(frame(0x4B) + "1")
    assert said == expected((7, 0, 1, 0), (0, 2))
    assert rig.chip.pins(rig.now, 1) == NO_CHANGE  # RXD is unchanged


def test_sci_in_loop_back_is_not_changed_by_the_pin():
    """The only wake-up is at the tenth idle bit of the internal line."""
    rig = SciRig(LOOPBKENA=1)
    said = counted(rig.chip)
    rig.send(frame(0x4B) + "1")
    assert said == expected((8, 0, 0, 0), (0, 1))


def test_spi_slave_is_changed_by_spiclk_and_spiste_only():
    """SPISIMO changes seven times and is set once to the same level; SPISTE falls; SPICLK has sixteen edges."""
    rig = SpiRig({}, SLAVE, CLK_PHASE=1)
    rig.pin(rig.now, CLK=0)
    said = counted(rig.chip)
    rig.select()
    rig.exchange(0xAA)
    assert said == expected((8, 0, 0, 17), (0, 0))


def test_spi_master_is_not_changed_by_its_pins():
    """The wake-ups are those of two edges of SPISTE and sixteen of SPICLK."""
    rig = SpiRig()
    said = counted(rig.chip)
    rig.write("SPITXBUF", 0)
    for level in (0, 1, 0):
        rig.pin(rig.now + 10, SOMI=level)
    rig.wait(10)
    assert said == expected((3, 0, 0, 0), (0, 18))
    assert rig.get("INT_FLAG") == 1


def test_spi_applies_overdue_changes_before_a_change_of_its_pins():
    """SPISOMI rises one cycle after the last bit is due to be latched."""
    rig = SpiRig(SPICHAR=0)
    rig.pin(rig.now, SOMI=0)
    rig.write("SPITXBUF", 0)
    latch = rig.chip.next_wake + 2 * HALF
    assert rig.chip.pins(latch + 1, 0b1111) == ANY_CHANGED
    assert rig.chip.peek(latch + 1, 7) == 0


@pytest.mark.parametrize(
    ("address", "read", "pins", "wakes"), [(OTHER, 0, 48, (38, 2)), (OTHER, 1, 48, (38, 2)), (OWN, 0, 54, (36, 4))]
)
def test_i2c_edges_without_a_flag_change_outputs_only(address: int, read: int, pins: int, wakes: tuple[int, int]):
    """Flags change at START and STOP, and with a matching address (AAS) and a received byte (RRDY).

    Changes of SDA while SCL is low cause no wake-up.
    """
    rig = Rig(noise_filter_cycles=1).begin()
    found = counted(rig.chip)
    rig.address(address, read)
    rig.send(0xFF if address == OTHER else 0x35)
    rig.stop()
    rig.wait(100)
    edges = 2 * 18 + 2  # two of SCL for each bit, and one each for START and STOP
    assert found == expected((0, pins, 0, 0), wakes) and pins > sum(wakes) >= edges


def test_i2c_read_of_a_byte_changes_outputs_only_except_at_flags():
    """The five exceptions are BB, SDIR with AAS, XRDY, NACK and SCD."""
    rig = Rig(noise_filter_cycles=1).begin()
    said = counted(rig.chip)
    rig.begin_read()
    rig.write("I2CDXR", 0x35)
    rig.acked()
    rig.read_byte(ack=False)
    rig.stop()
    rig.wait(100)
    assert said == expected((0, 52, 0, 0), (35, 5))


def test_i2c_master_reports_any_change_only_at_flags():
    """Registers change four times: BB, XRDY, STT at the end of the START, and NACK with ARDY."""
    rig = Rig(noise_filter_cycles=1).begin()
    said = counted(rig.chip)
    rig.write_other()
    rig.wait(30_000)
    assert said == expected((0, 27, 0, 0), (36, 4))
    assert rig.chip.pins(rig.now, rig.line) == NO_CHANGE


@pytest.mark.parametrize("late", [0, 1, 40])
def test_i2c_applies_overdue_changes_before_a_change_of_its_pins(late: int):
    """The filter delays a START by 15 cycles; SCL falls when this is due or later, without a wake-up in between."""
    rig = Rig(noise_filter_cycles=1).begin()
    rig.wait(100)
    rig.chip.pins(rig.now, 0b01)
    due = rig.chip.next_wake
    assert due == rig.now + 15
    assert rig.chip.pins(due + late, 0b00) == ANY_CHANGED
    assert rig.chip.peek(due + late, 2) >> 12 & 1, "BB"


@pytest.mark.parametrize("access", ["peek", "read"])
def test_i2c_register_includes_changes_that_are_due(access: str):
    """The filter delays a START; the module is not woken when this is due."""
    rig = Rig(noise_filter_cycles=1).begin()
    rig.wait(100)
    rig.chip.pins(rig.now, 0b01)
    due = rig.chip.next_wake
    shown = [getattr(rig.chip, access)(now, OFFSET["I2CSTR"]) & BB for now in (due - 1, due)]
    assert shown == [0, BB]


@pytest.mark.parametrize("late", [1, 40])
def test_sci_applies_overdue_changes_before_a_change_of_its_pin(late: int):
    rig = SciRig()
    begin = rig.send("0 11010010")
    rig.drive(rig.now, "RXD", 1)
    due = rig.chip.next_wake
    assert due - begin > 9 * rig.bit
    assert rig.chip.pins(due + late, 0) == ANY_CHANGED
    assert rig.peek("SCIRXST") >> 6 & 1, "RXRDY"


def test_i2c_reports_each_byte_that_its_fifo_receives():
    """Flags change five times: BB, AAS, two received bytes and SCD. The first byte changes only the count."""
    rig = Rig(noise_filter_cycles=1).begin(fifos=(0x4000, 0x2002))
    said = counted(rig.chip)
    rig.start()
    rig.address(OWN, 0)
    rig.send(0x35)
    level = rig.peek("I2CFFRX") >> 8 & 0x1F
    rig.send(0x36)
    rig.stop()
    rig.wait(100)
    assert (level, said["wake: all"]) == (1, 5)


def test_i2c_reports_a_value_that_returns_after_an_access():
    """RRDY rises with the first of two equal bytes, is cleared by a read, and rises again with the second byte."""
    rig = Rig(noise_filter_cycles=1).begin()
    said = counted(rig.chip)
    rig.start()
    rig.address(OWN, 0)
    rig.send(0x35)
    rig.send_bits(0x35)
    shown = rig.peek("I2CSTR")
    assert rig.read("I2CDRR") == 0x35
    assert rig.peek("I2CSTR") != shown
    before = said["wake: all"]
    rig.wait(20)
    assert rig.peek("I2CSTR") == shown
    assert said["wake: all"] == before + 1
