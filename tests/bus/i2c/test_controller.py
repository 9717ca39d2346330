"""The controller's edges on wires without other devices, as timing diagrams.

One column is 10 ticks; a bit is 2 columns low and 2 high. `sda` and `scl` are what the partner drives, SCL and SDA the
levels of the lines.
"""

from __future__ import annotations

import pytest

from periph_sim.bus.i2c.transfer import Phase, Transfer
from tests.bus.i2c_rig import TIMING, UNIT, I2cRig
from tests.waves import play, tidy


def played(diagram: str, *phases: Phase, **options: int) -> tuple[I2cRig, Transfer]:
    """Make a transfer of these phases and check the diagram. Return the rig and the transfer. options: of the rig."""
    rig = I2cRig(**options)
    transfer = rig.begin(*phases)
    drawn(rig, diagram)
    return rig, transfer


def drawn(rig: I2cRig, diagram: str) -> None:
    assert play(diagram, rig, UNIT) == tidy(diagram)


def test_address_0x53_to_write_and_a_byte_0x5a_both_acknowledged():
    rig, transfer = played(
        """
        > sda 1 .... .... .... .... .... .... .... .... 0... 1... .... .... .... .... .... .... .... 0... 1... .
        < SCL 1 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. .
        < SDA 0 .1.. .0.. .1.. .0.. .... .1.. .... .0.. .... 10.. .1.. .0.. .1.. .... .0.. .1.. .0.. .... 10.1 .
        """,
        Phase(0x53, read=False, data=b"\x5a"),
    )
    phase = transfer.phases[0]
    assert transfer.acked and phase.acks == [True] and transfer.wire_bytes == 2
    assert (phase.start_at, phase.answer_from, phase.answer_at) == (0, 37 * UNIT, 39 * UNIT)
    assert rig.over == [transfer] and transfer.stop_at == 76 * UNIT


def test_a_byte_0xaa_is_read_and_the_last_one_not_acknowledged():
    _, transfer = played(
        """
        > sda 1 .... .... .... .... .... .... .... .... 0... 1... 0... 1... 0... 1... 0... 1... 0... 1... .... .
        < SCL 1 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. .
        < SDA 0 .1.. .0.. .1.. .0.. .... .1.. .... .... 0... 1... 0... 1... 0... 1... 0... 1... 0... 1... .0.1 .
        """,
        Phase(0x53, read=True, count=1),
    )
    assert transfer.phases[0].got == b"\xaa" and transfer.phases[0].acks == [False]


def test_two_bytes_are_read_and_the_first_is_acknowledged_by_the_controller():
    rig = I2cRig()
    transfer = rig.begin(Phase(0x53, read=True, count=2))
    rig.pull((33 * UNIT + 1, "sda", 0), (37 * UNIT + 1, "sda", 1))
    rig.run_until(120 * UNIT)
    assert transfer.phases[0].got == b"\xff\xff" and transfer.phases[0].acks == [True, False]
    assert (70 * UNIT, "SDA", 0) in rig.edges and (74 * UNIT, "SDA", 1) in rig.edges  # the ACK, one hold after SCL fell


def test_an_address_that_is_not_acknowledged_is_followed_by_a_stop():
    _, transfer = played(
        """
        < SCL 1 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. .
        < SDA 0 .1.. .0.. .1.. .0.. .... .1.. .... .0.. .1.. .0.1 .
        """,
        Phase(0x53, read=False, data=b"\x01\x02"),
    )
    assert not transfer.acked and transfer.wire_bytes == 1


def test_a_repeated_start_changes_direction_without_a_stop():
    _, transfer = played(
        """
        > sda 1 .... .... .... .... .... .... .... .... 0... 1... .... .... .... .... .... .... .... .... .... ....
        < SCL 1 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1.
        < SDA 0 .1.. .0.. .1.. .0.. .... .1.. .... .0.. .... 1..0 .1.. .0.. .1.. .0.. .... .1.. .... .... .... .0.1
        """,
        Phase(0x53, read=False),
        Phase(0x53, read=True),
    )
    assert transfer.phases[1].start_at == 40 * UNIT
    assert [phase.acked for phase in transfer.phases] == [True, False]


def test_no_second_phase_follows_an_address_that_was_not_acknowledged():
    rig = I2cRig()
    transfer = rig.begin(Phase(0x53, read=False), Phase(0x53, read=True, count=1))
    rig.run_until(200 * UNIT)
    assert transfer.stop_at == 40 * UNIT
    assert transfer.phases[1].start_at < 0 and transfer.wire_bytes == 1


@pytest.mark.parametrize(("gives_up", "phases"), [(True, 1), (False, 2)])
def test_after_a_refused_byte_it_ends_the_transfer_or_begins_the_next_phase(gives_up: bool, phases: int):
    rig = I2cRig(gives_up=gives_up)
    transfer = rig.begin(Phase(0x53, read=False, data=b"\x01\x02"), Phase(0x53, read=True, count=1))
    rig.pull((33 * UNIT, "sda", 0))  # acknowledges the address and no other byte
    rig.pull((37 * UNIT, "sda", 1))
    rig.run_until(400 * UNIT)
    assert transfer.phases[0].acked and transfer.phases[0].acks == [False]
    assert sum(phase.start_at >= 0 for phase in transfer.phases) == phases
    refused = [("byte", 0x01 << 1 | 1), ("NACK", 1)]
    assert [mark for mark in rig.marks if mark[0] in ("byte", "NACK")][:2] == refused
    assert rig.marks.count(("NACK", 0)) == (not gives_up)  # the address of the read phase


def test_the_nack_of_the_reading_controller_is_not_recorded_as_a_nack_of_the_target():
    rig = I2cRig()
    rig.begin(Phase(0x53, read=True, count=1))
    rig.pull((33 * UNIT, "sda", 0), (37 * UNIT, "sda", 1))
    rig.run_until(400 * UNIT)
    assert [what for what, _ in rig.marks] == ["START", "address", "byte", "STOP"]


def test_the_controller_waits_while_the_partner_holds_scl_low_and_measures_the_stretch():
    _, transfer = played(
        """
        > scl 1 .... .... .... .... .... .... .... .... .0.....1.. .... ..
        > sda 1 .... .... .... .... .... .... .... .... 0......... .1.. ..
        < SCL 1 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0.1. 0......1.0 .1.. ..
        < SDA 0 .1.. .0.. .1.. .0.. .... .1.. .... .0.. .......... ..1. ..
        """,
        Phase(0x53, read=False),
    )
    assert transfer.phases[0].stretch == 5 * UNIT
    assert transfer.acked and transfer.stop_at == 45 * UNIT


def test_a_partner_that_releases_scl_at_the_same_tick_does_not_stretch():
    rig = I2cRig()
    transfer = rig.begin(Phase(0x53, read=False))
    rig.pull((2 * UNIT, "scl", 0))
    rig.pull((3 * UNIT, "scl", 1))  # scheduled first, so it runs before the controller releases SCL
    rig.run_until(60 * UNIT)
    assert transfer.phases[0].stretch == 0
    assert transfer.stop_at == 40 * UNIT


def test_a_low_sda_while_a_one_is_sent_loses_arbitration_and_releases_the_bus():
    rig, transfer = played(
        """
        > sda 1 .... .0.. .... .... .
        < SCL 1 0.1. 0.1. .... .... .
        < SDA 0 .1.. .0.. .... .... .
        """,
        Phase(0x7F, read=True, count=1),
    )
    assert transfer.lost and not transfer.acked and rig.over == [transfer]
    assert rig.wires["SDA"].held_by() == ["partner"] and rig.wires["SCL"].held_by() == []


def test_no_byte_is_in_progress_while_the_transfer_after_a_lost_address_waits_for_the_bus():
    rig = I2cRig()
    transfer = rig.begin(Phase(0x7F, read=True, count=1))
    rig.pull((6 * UNIT, "sda", 0))
    rig.run_until(15 * UNIT)
    assert transfer.lost and rig.controller.bytes_under_way() == 0
    rig.begin(Phase(0x7F, read=True, count=1))
    rig.run_until(30 * UNIT)
    assert rig.controller.bytes_under_way() == 0


def test_a_low_sda_while_a_zero_is_sent_does_not_lose_arbitration():
    rig = I2cRig()
    transfer = rig.begin(Phase(0x00, read=False))
    rig.pull((3 * UNIT, "sda", 0))
    rig.run_until(60 * UNIT)
    assert not transfer.lost and transfer.acked  # SDA is still low in the ACK slot


def test_the_next_start_waits_for_the_last_stop_and_the_bus_free_time():
    rig = I2cRig()
    first = rig.begin(Phase(0x53, read=False))
    rig.run_until(first.stop_at if first.stop_at >= 0 else 40 * UNIT)
    second = rig.begin(Phase(0x53, read=False))
    rig.run_until(100 * UNIT)
    assert second.phases[0].start_at - first.stop_at == TIMING.free


def test_the_controller_waits_for_the_transfer_of_another_one_even_while_both_lines_are_high():
    rig = I2cRig()
    rig.pull((0, "sda", 0))  # START
    rig.pull((5, "scl", 0), (8, "sda", 1))
    rig.pull((12, "scl", 1))  # a long 1: both lines are high, but the bus is not free
    rig.pull((400, "scl", 0), (410, "sda", 0), (420, "scl", 1))
    rig.pull((430, "sda", 1))  # STOP
    rig.run_until(50)
    transfer = rig.begin(Phase(0x53, read=False))
    rig.run_until(1000)
    assert transfer.phases[0].start_at == 430 + TIMING.free


def test_a_second_transfer_at_the_same_time_is_rejected():
    rig = I2cRig()
    rig.begin(Phase(0x53, read=False))
    with pytest.raises(ValueError, match="controller: asked for transfer 'test' while 'test' runs"):
        rig.begin(Phase(0x53, read=False))


def test_scl_held_low_too_long_is_reported_once_with_the_party_that_holds_it():
    rig = I2cRig(stuck_after=50 * UNIT)
    rig.begin(Phase(0x53, read=False))
    rig.pull((6 * UNIT, "scl", 0))
    rig.run_until(1000 * UNIT)
    assert rig.stuck == [(57 * UNIT, "SCL", ["partner"])]


def test_sda_held_low_before_a_start_is_reported_with_the_party_that_holds_it():
    rig = I2cRig(stuck_after=50 * UNIT)
    rig.partner["sda"].drive(0)
    rig.begin(Phase(0x53, read=False))
    rig.run_until(60 * UNIT)
    assert rig.stuck == [(50 * UNIT, "SDA", ["partner"])]


def test_a_bus_that_another_controller_uses_is_not_stuck():
    rig = I2cRig(stuck_after=50 * UNIT)
    rig.pull((0, "sda", 0))
    for i in range(40):
        rig.pull((UNIT + 2 * i * UNIT, "scl", 0), (2 * UNIT + 2 * i * UNIT, "scl", 1))
    rig.pull((85 * UNIT, "sda", 1))
    rig.run_until(1)
    transfer = rig.begin(Phase(0x53, read=False))
    rig.run_until(300 * UNIT)
    assert rig.stuck == []
    assert transfer.phases[0].start_at == 85 * UNIT + TIMING.free


def test_a_line_released_in_time_is_not_reported():
    rig = I2cRig(stuck_after=50 * UNIT)
    transfer = rig.begin(Phase(0x53, read=False))
    rig.pull((6 * UNIT, "scl", 0), (56 * UNIT, "scl", 1))
    rig.run_until(200 * UNIT)
    assert rig.stuck == [] and transfer.phases[0].stretch == 49 * UNIT


def test_any_first_byte_can_be_sent():
    rig = I2cRig()
    rig.begin(Phase(0, read=False, address_byte=0x01))  # the START byte
    rig.run_until(60 * UNIT)
    sda = {tick // UNIT: level for tick, name, level in rig.edges if name == "SDA"}
    assert sda == {0: 0, 30: 1, 38: 0, 40: 1}


@pytest.mark.parametrize(
    ("before", "width", "seen"),
    [(1, 9, "00"), (8, 9, "00"), (15, 9, "00"), (8, 20, "00"), (10, 20, "80"), (12, 13, "80")],
)
def test_a_level_shorter_than_the_filter_is_not_read(before: int, width: int, seen: str):
    """The target sends zeros but releases SDA for `width` ticks.

    The release begins `before` ticks before the end of the first bit's high phase. The filter width is 10 ticks.
    """
    rig = I2cRig(filter_width=10)
    transfer = rig.begin(Phase(0x10, read=True, count=1))
    rig.pull((33 * UNIT, "sda", 0))  # ACK, and eight zeros
    sampled = 41 * UNIT  # SCL falls after the first bit
    rig.pull((sampled - before, "sda", 1), (sampled - before + width, "sda", 0), (69 * UNIT, "sda", 1))
    rig.run_until(2000)
    assert transfer.phases[0].got.hex() == seen


def test_spikes_on_an_idle_bus_are_not_a_start_or_stop():
    """If the spike, 20 ticks before the START is due, counted as a STOP, the bus free time would begin again."""
    rig = I2cRig(filter_width=10)
    rig.pull((80, "sda", 0), (88, "sda", 1))
    rig.run_until(100)
    transfer = rig.begin(Phase(0x10, read=False))
    rig.run_until(2000)
    assert transfer.phases[0].start_at == 100


def test_a_spike_shortly_after_a_stop_does_not_cancel_it():
    """The spike begins 3 ticks after the STOP and lasts 4. The bus stays free."""
    rig = I2cRig(filter_width=10)
    first = rig.begin(Phase(0x10, read=False))
    rig.run_until(390)
    rig.pull((403, "sda", 0), (407, "sda", 1))
    rig.run_until(500)
    assert first.stop_at == 400
    second = rig.begin(Phase(0x10, read=False))
    rig.run_until(2000)
    assert second.phases[0].start_at == 500
