"""What an input says may have changed: what it leaves out did not change, and it says no more than it must."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest

from periph_sim.core.chip import ANY_CHANGED, NO_CHANGE, PINS_CHANGED, WAKE_CHANGED

from .i2c_registers import BB, OFFSET
from .i2c_rig import OTHER, OWN, Rig
from .sci_rig import SciRig, frame
from .spi_rig import HALF, SLAVE, SpiRig

LOOKS = {NO_CHANGE: "nothing", WAKE_CHANGED: "later", PINS_CHANGED: "outputs", ANY_CHANGED: "all"}


def counted(chip: Any) -> Counter[str]:
    """What each call of `pins` and `wake` from now on says, counted; AssertionError where it says too little."""
    said: Counter[str] = Counter()

    def registers(now: int) -> list[int]:
        return [chip.peek(now, register.offset) for register in chip.MAP]

    def checked(name: str) -> None:
        call = getattr(chip, name)

        def checking(now: int, *levels: int) -> int:
            due = chip.next_wake <= now and name == "pins"
            before = [] if due else registers(now - 1)
            shown = chip.out, chip.next_wake
            looks: int = call(now, *levels)
            said[f"{name}: {LOOKS[looks]}"] += 1
            if due:
                assert looks == ANY_CHANGED, "what was due may have changed anything"
            elif looks != ANY_CHANGED:
                assert registers(now) == before
            if looks == NO_CHANGE:
                assert (chip.out, chip.next_wake) == shown
            if looks == WAKE_CHANGED:
                assert chip.out == shown[0]
            return looks

        setattr(chip, name, checking)

    checked("pins")
    checked("wake")
    return said


def of(pins: tuple[int, int, int, int], wakes: tuple[int, int]) -> dict[str, int]:
    """pins: how many changed nothing, when it wakes, outputs, anything. wakes: how many changed outputs, anything."""
    names = ["pins: nothing", "pins: later", "pins: outputs", "pins: all", "wake: outputs", "wake: all"]
    return {name: count for name, count in zip(names, (*pins, *wakes), strict=True) if count}


def test_sci_looks_at_a_frame_when_it_is_complete():
    """Eight edges: the start bit's sets the time, RXRDY and RXINT come with it."""
    rig = SciRig(RXBKINTENA=1)
    said = counted(rig.chip)
    rig.send(frame(0x4B) + "1")
    assert said == of((7, 0, 1, 0), (0, 2))
    assert rig.chip.pins(rig.now, 1) == NO_CHANGE  # the level it has


def test_sci_in_loop_back_has_nothing_to_look_at_on_the_pin():
    """The wake-up is that of the tenth idle bit, inside."""
    rig = SciRig(LOOPBKENA=1)
    said = counted(rig.chip)
    rig.send(frame(0x4B) + "1")
    assert said == of((8, 0, 0, 0), (0, 1))


def test_spi_slave_looks_at_spiclk_and_spiste():
    """SPISIMO changes seven times and is set once to what it has; SPISTE falls; sixteen edges of SPICLK."""
    rig = SpiRig({}, SLAVE, CLK_PHASE=1)
    rig.pin(rig.now, CLK=0)
    said = counted(rig.chip)
    rig.select()
    rig.exchange(0xAA)
    assert said == of((8, 0, 0, 17), (0, 0))


def test_spi_master_has_nothing_to_look_at_on_its_pins():
    """Its wake-ups are two edges of SPISTE and sixteen of SPICLK."""
    rig = SpiRig()
    said = counted(rig.chip)
    rig.write("SPITXBUF", 0)
    for level in (0, 1, 0):
        rig.pin(rig.now + 10, SOMI=level)
    rig.wait(10)
    assert said == of((3, 0, 0, 0), (0, 18))
    assert rig.get("INT_FLAG") == 1


def test_spi_that_is_woken_late_has_done_at_a_pin_what_was_due_before_it():
    """SPISOMI rises in the cycle after the last bit was latched."""
    rig = SpiRig(SPICHAR=0)
    rig.pin(rig.now, SOMI=0)
    rig.write("SPITXBUF", 0)
    latch = rig.chip.next_wake + 2 * HALF
    assert rig.chip.pins(latch + 1, 0b1111) == ANY_CHANGED
    assert rig.chip.peek(latch + 1, 7) == 0


@pytest.mark.parametrize(
    ("address", "read", "pins", "wakes"), [(OTHER, 0, 48, (38, 2)), (OTHER, 1, 48, (38, 2)), (OWN, 0, 54, (36, 4))]
)
def test_i2c_edges_without_a_flag_move_outputs_alone(address: int, read: int, pins: int, wakes: tuple[int, int]):
    """Flags rise with START and STOP, and with the address (AAS) and the byte (RRDY) that are for us.

    Changes of SDA while SCL is low wake nobody.
    """
    rig = Rig(noise_filter_cycles=1).begin()
    found = counted(rig.chip)
    rig.address(address, read)
    rig.send(0xFF if address == OTHER else 0x35)
    rig.stop()
    rig.wait(100)
    edges = 2 * 18 + 2  # SCL up and down with each bit, once more for START and STOP
    assert found == of((0, pins, 0, 0), wakes) and pins > sum(wakes) >= edges


def test_i2c_byte_read_moves_outputs_alone():
    """But for BB, SDIR with AAS, XRDY, NACK and SCD."""
    rig = Rig(noise_filter_cycles=1).begin()
    said = counted(rig.chip)
    rig.ask()
    rig.write("I2CDXR", 0x35)
    rig.acked()
    rig.take(ack=False)
    rig.stop()
    rig.wait(100)
    assert said == of((0, 52, 0, 0), (35, 5))


def test_i2c_master_is_looked_at_where_a_flag_moves():
    """BB, with the START, XRDY, and NACK with ARDY of an address without an answer; STT falls with the START's end."""
    rig = Rig(noise_filter_cycles=1).begin()
    said = counted(rig.chip)
    rig.write_other()
    rig.wait(30_000)
    assert said == of((0, 27, 0, 0), (36, 4))
    assert rig.chip.pins(rig.now, rig.line) == NO_CHANGE


@pytest.mark.parametrize("late", [0, 1, 40])
def test_i2c_edge_told_after_something_was_due_brings_that_first(late: int):
    """The filter holds a START back for 15 cycles; SCL's fall comes when it is due, or later, and nobody woke it."""
    rig = Rig(noise_filter_cycles=1).begin()
    rig.wait(100)
    rig.chip.pins(rig.now, 0b01)
    due = rig.chip.next_wake
    assert due == rig.now + 15
    assert rig.chip.pins(due + late, 0b00) == ANY_CHANGED
    assert rig.chip.peek(due + late, 2) >> 12 & 1, "BB"


@pytest.mark.parametrize("look", ["peek", "read"])
def test_i2c_register_shows_what_is_due_in_that_cycle(look: str):
    """The START that the filter held back; nobody woke the module for it."""
    rig = Rig(noise_filter_cycles=1).begin()
    rig.wait(100)
    rig.chip.pins(rig.now, 0b01)
    due = rig.chip.next_wake
    shown = [getattr(rig.chip, look)(now, OFFSET["I2CSTR"]) & BB for now in (due - 1, due)]
    assert shown == [0, BB]


@pytest.mark.parametrize("late", [1, 40])
def test_sci_edge_told_after_something_was_due_brings_that_first(late: int):
    rig = SciRig()
    begin = rig.send("0 11010010")
    rig.drive(rig.now, "RXD", 1)
    due = rig.chip.next_wake
    assert due - begin > 9 * rig.bit
    assert rig.chip.pins(due + late, 0) == ANY_CHANGED
    assert rig.peek("SCIRXST") >> 6 & 1, "RXRDY"


def test_i2c_is_looked_at_as_bytes_come_into_its_fifo():
    """BB, AAS, two bytes, of which the second reaches RXFFIL, and SCD: the FIFO's level is all that the first moves."""
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


def test_i2c_is_looked_at_also_where_an_edge_brings_back_what_it_showed_before_an_access():
    """Two equal bytes: RRDY rises with the first, the CPU's read clears it, and the second shows the same again."""
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
