"""Replay of one side of a bus: the edges of the master player, and the answers of the scripted target.

In the diagrams, one column is 10 ticks; `scl` and `sda` are what a partner drives.
"""

from __future__ import annotations

import pytest

from periph_sim.bus.i2c.controller import I2cController
from periph_sim.bus.i2c.replayed_sides import Answer, I2cPlayer, Move, ScriptedTarget
from periph_sim.bus.i2c.transfer import BusTiming, Phase, Transfer
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import NO_TIME
from periph_sim.core.wire import Wire
from tests.waves import play, tidy

UNIT = 10
SCL, SDA = True, False
START_AND_TWO_BITS = [
    Move(0, SDA, 0),
    Move(2 * UNIT, SCL, 0),
    Move(2 * UNIT, SCL, 1),
    Move(2 * UNIT, SCL, 0),
    Move(UNIT, SDA, 1),
    Move(UNIT, SCL, 1),
    Move(2 * UNIT, SCL, 0),
]


class PlayerRig:
    def __init__(self) -> None:
        self.kernel = Kernel()
        recorder = Recorder()
        self.wires = {name: Wire(self.kernel, name, recorder) for name in ("SCL", "SDA")}
        self.partner = {name.lower(): wire.attach("partner") for name, wire in self.wires.items()}
        self.player = I2cPlayer(self.kernel, self.wires["SCL"], self.wires["SDA"])
        self.done: list[int] = []

    def begin(self, moves: list[Move]) -> None:
        self.player.play(moves, lambda: self.done.append(self.kernel.now))

    def drive(self, now: int, signal: str, level: int) -> None:
        self.kernel.call_at(now, lambda: self.partner[signal].drive(level))

    def run_until(self, time: int) -> None:
        self.kernel.run_until(time)

    def show(self, signal: str) -> int:
        return self.wires[signal].level


def drawn(rig: PlayerRig, diagram: str) -> None:
    assert play(diagram, rig, UNIT) == tidy(diagram)


def test_moves_are_made_at_their_times():
    rig = PlayerRig()
    rig.begin(START_AND_TWO_BITS)
    drawn(
        rig,
        """
        < SCL 1 . 0 . 1 . 0 . 1 . 0 .
        < SDA 0 . . . . . . 1 . . . .
        """,
    )
    assert rig.done == [10 * UNIT]
    assert (rig.player.delay, rig.player.longest, rig.player.waiting_since) == (0, 0, NO_TIME)


def test_a_clock_held_low_delays_all_later_moves():
    rig = PlayerRig()
    rig.begin(START_AND_TWO_BITS)
    drawn(
        rig,
        """
        > scl 1 . . 0 . . . 1 . . . . 0
        < SCL 1 . 0 . . . . 1 . 0 . 1 0
        < SDA 0 . . . . . . . . . 1 . .
        """,
    )
    # The player releases SCL at 4 and it rises at 7: 3 columns. The low level at 12, in a high phase, is not a stretch.
    assert (rig.player.delay, rig.player.longest) == (3 * UNIT, 3 * UNIT)


def asked(answers: dict[int, list[Answer]], *transfers: list[Phase]) -> list[Transfer]:
    """Make the transfers one after the other on a bus with these answers, by address, and return them."""
    kernel, recorder = Kernel(), Recorder()
    scl, sda = Wire(kernel, "SCL", recorder), Wire(kernel, "SDA", recorder)
    ScriptedTarget(kernel, scl, sda, answers, hold=30)
    controller = I2cController(kernel, recorder, scl, sda, BusTiming(100, 100, 20, 100, 100, 100, 200))
    done: list[Transfer] = []
    for phases in transfers:
        controller.begin(Transfer("test", phases), done.append)
        kernel.run_until(kernel.now + 100_000)
    assert len(done) == len(transfers) and scl.level == sda.level == 1
    return done


def test_a_read_gets_the_bytes_of_the_answer_and_then_ones():
    (done,) = asked({0x53: [Answer(True, b"\x12\x80")]}, [Phase(0x53, read=True, count=3)])
    assert done.acked and done.phases[0].got == b"\x12\x80\xff"


def test_a_write_is_acknowledged_byte_by_byte_as_the_answer_says():
    (done,) = asked({0x53: [Answer(True, acks=(True, False))]}, [Phase(0x53, read=False, data=b"\x01\x02")])
    assert done.acked and done.phases[0].acks == [True, False]
    (done,) = asked({0x53: [Answer(True)]}, [Phase(0x53, read=False, data=b"\x01\x02")])
    assert done.phases[0].acks == [True, True]


def test_answers_go_in_order_across_transfers_and_repeated_starts():
    answers = {0x53: [Answer(False), Answer(True), Answer(True, b"\xaa")], 0x68: [Answer(True, b"\x55")]}
    first, second, third, fourth = asked(
        answers,
        [Phase(0x53, read=False, data=b"\x00")],
        [Phase(0x53, read=False, data=b"\x00"), Phase(0x53, read=True, count=1)],
        [Phase(0x68, read=True, count=1)],
        [Phase(0x68, read=True, count=1)],
    )
    assert not first.acked
    assert second.acked and second.phases[1].got == b"\xaa"
    assert third.phases[0].got == b"\x55"
    assert not fourth.acked, "no answer is left"


def test_an_address_without_answers_is_not_acknowledged():
    (done,) = asked({0x53: [Answer(True)]}, [Phase(0x54, read=True, count=1)])
    assert not done.acked


@pytest.mark.parametrize(
    ("stretches", "where"),
    [
        (((-1, 8, 700),), "address ACK"),
        (((0, 0, 700),), "first bit of the data"),
        (((0, 8, 700),), "data ACK"),
        (((1, 3, 700),), "within a byte"),
    ],
)
@pytest.mark.parametrize("read", [True, False])
def test_it_stretches_at_the_place_given_by_the_answer(stretches: tuple, where: str, read: bool):
    """The controller's own low phase is 100 ticks, so a stretch of 700 ticks delays it by 600."""
    phase = Phase(0x53, read, data=b"" if read else b"\x01\x02", count=2 if read else 0)
    (done,) = asked({0x53: [Answer(True, b"\x12\x34", stretches=stretches)]}, [phase])
    assert done.acked and done.phases[0].stretch == 600
    assert done.phases[0].got == (b"\x12\x34" if read else b"")


def test_a_stretch_belongs_to_one_answer():
    answers = [Answer(True, stretches=((0, 0, 700),)), Answer(True)]
    first, second = asked({0x53: answers}, [Phase(0x53, False, b"\x01")], [Phase(0x53, False, b"\x01")])
    assert (first.phases[0].stretch, second.phases[0].stretch) == (600, 0)
