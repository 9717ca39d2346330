"""A controller that clears the bus when a device holds SDA low or when a STOP is missing. A column is 10 ticks.

The controller's times are 2 columns low, 2 high, 1 hold and 3 bus free; it waits 6 columns before it clears the bus.
"""

from __future__ import annotations

from itertools import pairwise

import pytest

from periph_sim.bus.i2c.transfer import Phase, Transfer
from periph_sim.core.sampler import watch
from tests.bus.i2c_rig import UNIT, I2cRig
from tests.waves import play, tidy

WAIT = 6 * UNIT


def held(line: str = "sda", clear_after: int = WAIT) -> tuple[I2cRig, Transfer]:
    """A rig whose partner holds a line before the controller begins a write to 0x10, an address without a device."""
    rig = I2cRig(clear_after=clear_after)
    rig.partner[line].drive(0)
    rig.run_until(0)
    return rig, rig.begin(Phase(0x10, read=False))


def falls(rig: I2cRig) -> list[int]:
    return [tick for tick, name, level in rig.edges if name == "SCL" and not level]


def test_clocks_continue_until_sda_is_released_and_a_stop_and_the_transfer_follow():
    """A device releases SDA after the falling edge of the third clock. STOP, bus-free time and START follow."""
    rig, _ = held()
    diagram = """
    > sda  0..............1.............
    < SCL  1.....0.1.0.1.0.1.0.1.....0.1
    < SDA  0..............1...0..1..0...
    """
    assert play(diagram, rig, UNIT) == tidy(diagram)


@pytest.mark.parametrize("clocks", range(1, 10))
def test_as_many_clocks_as_needed_are_sent_up_to_nine(clocks: int):
    rig, transfer = held()

    def scl(tick: int, level: int) -> None:
        if not level and len(falls(rig)) == clocks:
            rig.partner["sda"].drive(1)

    watch([rig.wires["SCL"]], scl)
    rig.run_until(10_000)
    assert rig.over == [transfer]
    before = [tick for tick in falls(rig) if tick < transfer.phases[0].start_at]
    assert len(before) == clocks + 1  # the last one is the clock of the STOP


def test_nine_clocks_without_effect_are_repeated_later():
    rig, _ = held()
    rig.run_until(1500)
    found = falls(rig)
    assert len(found) >= 18 and rig.over == []
    assert [b - a for a, b in pairwise(found[:9])] == [4 * UNIT] * 8
    assert found[9] - found[8] == 4 * UNIT  # a STOP is attempted although SDA is still low
    assert found[10] - found[9] >= WAIT


def test_an_impossible_repeated_start_ends_the_transfer_with_a_stop():
    """The slave holds SDA low after the ACK of its pointer byte, so the read that should follow is lost."""
    rig = I2cRig(clear_after=WAIT)
    transfer = rig.begin(Phase(0x10, read=False, data=b"\x05"), Phase(0x10, read=True, count=1))
    rig.pull((33 * UNIT, "sda", 0))  # ACK of the address
    rig.pull((37 * UNIT + 1, "sda", 1))
    rig.pull((69 * UNIT, "sda", 0))  # ACK of the byte, and on
    rig.pull((110 * UNIT, "sda", 1))
    rig.run_until(3000)
    assert rig.over == [transfer] and transfer.lost and not transfer.acked
    assert len(transfer.phases[1].got) == 0
    assert all(wire.level for wire in rig.wires.values())


def test_a_bus_clear_that_ends_a_transfer_ends_the_check_for_stuck_lines():
    rig = I2cRig(stuck_after=10 * UNIT, clear_after=WAIT)
    transfer = rig.begin(Phase(0x10, read=False, data=b"\x05"), Phase(0x10, read=True, count=1))
    rig.pull((33 * UNIT, "sda", 0))  # ACK of the address
    rig.pull((37 * UNIT + 1, "sda", 1))
    rig.pull((69 * UNIT, "sda", 0))  # ACK of the byte, and on
    rig.pull((85 * UNIT, "sda", 1))
    rig.run_until(3000)
    assert rig.over == [transfer] and transfer.lost
    assert [tick for tick, _, _ in rig.stuck if tick > transfer.stop_at] == []


def test_without_clear_after_a_controller_waits_endlessly():
    rig, _ = held(clear_after=0)
    rig.run_until(10_000)
    assert falls(rig) == [] and rig.over == []


def test_a_bus_whose_scl_is_held_cannot_be_cleared():
    rig, _ = held("scl")
    rig.run_until(10_000)
    assert [name for _, name, _ in rig.edges] == ["SCL"]
