"""An I2C bus without chips, on which both halves of a capture are played together, and the resulting events."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from fractions import Fraction

from periph_sim.bus.i2c.replayed_sides import Answer, I2cPlayer, ScriptedTarget
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire
from periph_sim.replay.i2c_script import controllers_half, moves, turns, usual_hold
from periph_sim.replay.report import Comparison, compare, i2c_words
from periph_sim.replay.wire_log import WireLog
from periph_sim.traces.decode import i2c
from periph_sim.traces.decode.i2c import Transfer
from periph_sim.traces.formats import Capture


class Bus:
    """SCL and SDA, a log of both, and the captured targets if there are answers."""

    def __init__(self, answers: dict[int, list[Answer]] | None = None, hold: int = 300) -> None:
        self.kernel = Kernel()
        self.timebase = Timebase()
        recorder = Recorder()
        self.scl, self.sda = (Wire(self.kernel, name, recorder) for name in ("SCL", "SDA"))
        self.log = WireLog(self.scl, self.sda)
        self.player = I2cPlayer(self.kernel, self.scl, self.sda)
        if answers is not None:
            ScriptedTarget(self.kernel, self.scl, self.sda, answers, hold)

    def events(self) -> list[i2c.Event]:
        return i2c.events(self.log.capture(self.timebase, self.kernel.now))


def both_halves(capture: Capture, transfers: list[Transfer]) -> Comparison:
    """Compare a capture with a replay of its controller's half and its targets' half on one bus."""
    assert capture.rate is not None
    answers: dict[int, list[Answer]] = defaultdict(list)
    for turn in turns(transfers):
        answers[turn.address].append(turn.answer)
    bus = Bus(answers, hold=100)
    per_position = bus.timebase.per_second / capture.rate
    hold = usual_hold(transfers)

    def play_from(index: int) -> Callable[[], None]:
        def plan() -> None:
            if index < len(transfers):
                begin = int(transfers[index].phases[0].start.at * per_position)
                edges = moves(controllers_half(transfers[index], hold), per_position)
                bus.kernel.call_at(begin, lambda: bus.player.play(edges, play_from(index + 1)))

        return plan

    play_from(0)()
    bus.kernel.run_until(int(capture.length * per_position))
    expected = [event for transfer in transfers for event in i2c.events_of(transfer)]
    return compare(i2c_words(expected, capture.rate), i2c_words(bus.events(), Fraction(bus.timebase.per_second)))
