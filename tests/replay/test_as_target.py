"""What a firmware is told so that it answers as a captured target did."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.bus.i2c.scripted_target import Answer
from periph_sim.replay.as_target import as_target
from periph_sim.replay.i2c_script import Turn

END = 10_000


def write(begin: int, *, ack: bool = True, stop: int | None = None, address: int = 0x50) -> Turn:
    return Turn(address, False, Answer(ack, acks=(True,)), begin, begin + 10, stop)


def read(begin: int, data: bytes, *, ack: bool = True, stop: int | None = None, address: int = 0x50) -> Turn:
    return Turn(address, True, Answer(ack, data), begin, begin + 10, stop)


def test_replies_are_the_reads_that_were_answered_in_order():
    target = as_target(
        0x50,
        [read(0, b"\x01", stop=50), read(100, b"\xff", ack=False, stop=150), read(200, b"\x02\x03", stop=250)],
        END,
    )
    assert target.replies == [b"\x01", b"\x02\x03"] and target.busy == []


def test_a_refusal_after_a_write_is_a_busy_time_from_its_stop_to_midway_before_the_next_answer():
    turns = [
        write(0, stop=100),
        write(200, stop=300),
        write(400, ack=False, stop=450),
        write(500, ack=False),
        write(600, stop=700),
    ]
    target = as_target(0x50, turns, END)
    assert target.busy == [0, Fraction(510 + 600, 2) - 300, 0]
    assert target.asleep is None and target.refused == 0


def test_refusals_at_the_start_are_a_time_asleep():
    assert as_target(0x50, [write(10, ack=False), write(100)], END).asleep == Fraction(20 + 100, 2)
    assert as_target(0x50, [write(10, ack=False)], END).asleep == END


def test_refusals_at_the_end_last_to_the_end():
    assert as_target(0x50, [write(0, stop=100), write(200, ack=False)], END).busy == [END - 100]


def test_refusals_that_cannot_be_imitated_are_counted():
    """After a read, or after a write that a repeated START ended, the firmware has no busy time."""
    turns = [
        read(0, b"\x01", stop=100),
        write(200, ack=False),
        write(300),
        write(400, ack=False),
        write(500, ack=False),
    ]
    target = as_target(0x50, turns, END)
    assert target.refused == 3 and target.busy == [] and target.asleep is None


def test_other_addresses_do_not_count():
    turns = [write(0, stop=100), write(200, ack=False, address=0x51), read(300, b"\x01", address=0x51)]
    target = as_target(0x50, turns, END)
    assert target.busy == [0] and target.replies == [] and target.refused == 0
