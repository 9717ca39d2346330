"""The sensor head: an I2C master that reads several sensor chips periodically.

    start-up requests, schedule --> rounds of requests --> I2cController --> transfers --> values, checks, reports

A request writes a register pointer, with a STOP or a repeated START after it, and reads `count` bytes of one chip. All
requests of one period are a round. A round is due in every period. If a round is due while the previous round is still
running, the new round is left out and counts as missed.

Before the first round, the sensor head can set up its chips as drivers do: with start-up requests that read
identifications, and write rates, ranges and modes.

Source: section 3.4.2 and Figure A.2 (order, period) of the dissertation in CITATION.cff.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from random import Random

from ..bus.i2c.controller import I2cController
from ..bus.i2c.transfer import Transfer
from ..core.agent import Agent
from ..core.chip import NEVER
from ..core.kernel import Kernel
from ..core.state import State
from .sensor_rounds import Request, Round, Schedule

# Tags of events: the start-up requests begin, a round begins, the next transfer begins.
SET_UP, ROUND, NEXT = range(3)


class SensorHead(Agent):
    """An agent that makes the start-up requests and then the rounds of requests with a controller.

    missed: number of missed rounds.
    rounds: number of completed rounds, without the start-up.
    on_transfer: functions called with each transfer at its end, start-up included.
    on_round: functions called with each round at its end, without the start-up.
    on_due: functions called when a round begins or is missed, with the tick at which the round was due.
    on_missed: functions called when a round is missed, with the tick at which the round was due.
    """

    STATE = State("_number _round _left _random", ticks="_due", expires="_due")

    def __init__(
        self,
        kernel: Kernel,
        controller: I2cController,
        requests: list[Request],
        schedule: Schedule,
        *,
        startup: Sequence[Request] = (),
        by_stop: bool = False,
        seed: int = 0,
    ) -> None:
        self.who = controller.who
        self.controller = controller
        self.missed = 0
        self.rounds = 0
        self.on_transfer: list[Callable[[Transfer], None]] = []
        self.on_round: list[Callable[[Round], None]] = []
        self.on_due: list[Callable[[int], None]] = []
        self.on_missed: list[Callable[[int], None]] = []
        self._kernel = kernel
        self._requests = requests
        self.schedule = schedule
        self._by_stop = by_stop
        self._random: Random = Random(seed)
        self._first: int = kernel.now + schedule.first
        self._period: Fraction = Fraction(schedule.period)
        self._number = 0
        self._startup = startup
        self._round: Round | None = None
        self._left: list[Transfer] = []
        self._due: int = self._first  # the tick at which the next round is due, see `_plan`
        if startup:
            kernel.schedule(self._first - schedule.ahead, self, SET_UP)
        self._plan()

    @property
    def at_rest(self) -> bool:
        """True while neither a round nor the start-up is in progress."""
        return self._round is None

    def start_round(self, tick: int) -> None:
        """Schedule one more round, at `tick`.

        The schedule must be a list of starts (`Schedule.starts`), and all earlier rounds must have been due.
        """
        self._due = tick
        self._kernel.schedule(tick, self, ROUND)

    def act(self, tag: int) -> None:
        if tag == NEXT:
            self._next()
        elif tag == ROUND:
            self._begin(self._due)
        else:
            self._set_up()

    def _plan(self) -> None:
        """Schedule the next round, with its jitter.

        Set `_due` to the tick at which the round is due, without jitter. After the last start of a list, it is NEVER.
        """
        schedule = self.schedule
        if schedule.starts is not None:
            self._due = NEVER
            if self._number < len(schedule.starts):
                self._due = schedule.starts[self._number]
                self._kernel.schedule(self._due, self, ROUND)
        elif schedule.rounds is None or self._number < schedule.rounds:
            late = self._random.randrange(schedule.jitter + 1) if schedule.jitter else 0
            self._due = self._first + self._number * self._period.numerator // self._period.denominator
            self._kernel.schedule(self._due + late, self, ROUND)

    def _set_up(self) -> None:
        """Make the start-up requests, like a round that is not counted. Rounds that are due meanwhile are missed."""
        self._round = Round(0, self._kernel.now, self._kernel.now)
        self._left = [t for request in self._startup for t in request.transfers(self._by_stop)]
        self._next()

    def _begin(self, due: int) -> None:
        self._number += 1
        self._plan()
        for callback in self.on_due:
            callback(due)
        if self._round is not None:
            self.missed += 1
            for missed in self.on_missed:
                missed(due)
            return
        self._round = Round(self._number, due, self._kernel.now)
        self._left = [t for request in self._requests for t in request.transfers(self._by_stop)]
        self._next()

    def _next(self) -> None:
        self.controller.begin(self._left.pop(0), self._over)

    def _over(self, transfer: Transfer) -> None:
        current = self._round
        assert current is not None
        current.transfers += 1
        if not transfer.acked:
            current.nacked += 1
        for callback in self.on_transfer:
            callback(transfer)
        if self._left:
            self._kernel.schedule(self._kernel.now + self.schedule.gap, self, NEXT)
            return
        current.end = self._kernel.now
        self._round = None
        if not current.number:
            return
        self.rounds += 1
        for finished in self.on_round:
            finished(current)
