"""A controller that clears a bus on which somebody holds SDA, or of which nobody gave the STOP. A column is 10 ticks.

The controller's times are 2 columns low, 2 high, 1 hold, 3 free; it waits 6 columns before it clears.
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
    """Somebody holds a line before the controller is asked for a write to 0x10, where nobody is."""
    desk = I2cRig(clear_after=clear_after)
    desk.partner[line].drive(0)
    desk.run_until(0)
    return desk, desk.begin(Phase(0x10, read=False))


def falls(desk: I2cRig) -> list[int]:
    return [tick for tick, name, level in desk.edges if name == "SCL" and not level]


def test_clocks_go_on_until_sda_is_let_go_and_then_a_stop_and_the_transfer():
    """A device lets go behind the third clock's fall: STOP, bus-free time, START."""
    desk, _ = held()
    diagram = """
    > sda  0..............1.............
    < SCL  1.....0.1.0.1.0.1.0.1.....0.1
    < SDA  0..............1...0..1..0...
    """
    assert play(diagram, desk, UNIT) == tidy(diagram)


@pytest.mark.parametrize("clocks", range(1, 10))
def test_so_many_clocks_as_are_needed_up_to_nine(clocks: int):
    desk, transfer = held()

    def scl(tick: int, level: int) -> None:
        if not level and len(falls(desk)) == clocks:
            desk.partner["sda"].drive(1)

    watch([desk.wires["SCL"]], scl)
    desk.run_until(10_000)
    assert desk.over == [transfer]
    before = [tick for tick in falls(desk) if tick < transfer.phases[0].start_at]
    assert len(before) == clocks + 1  # and that of the STOP


def test_nine_clocks_that_do_not_help_are_tried_again_later():
    desk, _ = held()
    desk.run_until(1500)
    found = falls(desk)
    assert len(found) >= 18 and desk.over == []
    assert [b - a for a, b in pairwise(found[:9])] == [4 * UNIT] * 8
    assert found[9] - found[8] == 4 * UNIT  # the STOP is tried all the same
    assert found[10] - found[9] >= WAIT


def test_a_repeated_start_that_cannot_be_made_ends_the_transfer_with_a_stop():
    """The slave holds SDA low behind its pointer byte's ACK: the read that was to follow is lost."""
    desk = I2cRig(clear_after=WAIT)
    transfer = desk.begin(Phase(0x10, read=False, data=b"\x05"), Phase(0x10, read=True, count=1))
    desk.pull((33 * UNIT, "sda", 0))  # ACK of the address
    desk.pull((37 * UNIT + 1, "sda", 1))
    desk.pull((69 * UNIT, "sda", 0))  # ACK of the byte, and on
    desk.pull((110 * UNIT, "sda", 1))
    desk.run_until(3000)
    assert desk.over == [transfer] and transfer.lost and not transfer.acked
    assert len(transfer.phases[1].got) == 0
    assert all(wire.level for wire in desk.wires.values())


def test_a_bus_clear_that_ends_a_transfer_ends_the_check_for_stuck_lines():
    desk = I2cRig(stuck_after=10 * UNIT, clear_after=WAIT)
    transfer = desk.begin(Phase(0x10, read=False, data=b"\x05"), Phase(0x10, read=True, count=1))
    desk.pull((33 * UNIT, "sda", 0))  # ACK of the address
    desk.pull((37 * UNIT + 1, "sda", 1))
    desk.pull((69 * UNIT, "sda", 0))  # ACK of the byte, and on
    desk.pull((85 * UNIT, "sda", 1))
    desk.run_until(3000)
    assert desk.over == [transfer] and transfer.lost
    assert [tick for tick, _, _ in desk.stuck if tick > transfer.stop_at] == []


def test_without_clear_after_a_controller_waits_for_ever():
    desk, _ = held(clear_after=0)
    desk.run_until(10_000)
    assert falls(desk) == [] and desk.over == []


def test_a_bus_whose_scl_is_held_cannot_be_cleared():
    desk, _ = held("scl")
    desk.run_until(10_000)
    assert [name for _, name, _ in desk.edges] == ["SCL"]
