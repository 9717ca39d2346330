"""The player's edges, drawn. One column is 10 ticks; `scl` and `sda` are what a partner does to the lines."""

from __future__ import annotations

from periph_sim.bus.i2c.player import I2cPlayer, Move
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


def test_moves_are_made_in_their_time():
    rig = PlayerRig()
    rig.begin(START_AND_TWO_BITS)
    drawn(
        rig,
        """
        < SCL 1 . 0 . 1 . 0 . 1 . 0 .
        < SDA 0 . . . . . . 1 . . . .
        """,
    )
    assert rig.done == [10 * UNIT] and not rig.player.busy
    assert (rig.player.delay, rig.player.longest, rig.player.waiting_since) == (0, 0, NO_TIME)


def test_a_clock_held_low_moves_all_that_follows():
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
    # Let go at 4, rose at 7: 3 columns. What the partner does at 12, in the high phase, is no stretch.
    assert (rig.player.delay, rig.player.longest) == (3 * UNIT, 3 * UNIT)
