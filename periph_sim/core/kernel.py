"""The event kernel: integer time, one total order, nothing else.

Inside one tick the order is: agents act (TIMER), then the pads of chips (PADS), the chips behind them (CHIP)
and the CPUs (CPU), then probes look (PROBE). Within a phase, first asked is first done. At the end of each phase
the wires settle: all that moved take their level, then each party that samples them is told once, of all
of them together. So nobody can tell in which order the parties of one phase acted, and two runs of one
scene are equal. What an answer moves in the same tick settles after it.

A CPU that runs ahead of the queue asks `quiet_until` how far it may go: up to that time,
not including it, nothing else can happen (a lease), so it may move `now` by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from operator import attrgetter
from typing import Protocol

from .chip import NEVER

TIMER, PADS, CHIP, CPU, PROBE = range(5)
_PHASES = 5  # a queue key is time * _PHASES + phase

STORM = 100_000  # so many events inside one tick is a loop, not a design

Action = Callable[[], None]


class SimulationStuck(Exception):
    """Events kept causing events without time passing."""


class Settles(Protocol):
    """What takes its new level when all who move it have acted: a wire. rank: see `Kernel.rank`."""

    @property
    def rank(self) -> int: ...

    def settle(self) -> None: ...


class Samples(Protocol):
    """Who is told of the settled levels."""

    due: bool  # to be told
    levels: int
    told: Callable[[int, int], None]  # with the tick and the levels

    @property
    def rank(self) -> int: ...


_rank = attrgetter("rank")


class Kernel:
    """events: how many were done, cancelled ones not counted; the measure of cost."""

    def __init__(self, start: int = 0) -> None:
        self.now = start
        self.events = 0
        self.unsettled: list[Settles] = []  # what moved in the present phase
        self.sampling: list[Samples] = []  # who is to be told of it
        self._horizon = start
        self._number = 0
        self._queue: list[tuple[int, int, Action]] = []
        self._dead: set[int] = set()
        self._stop = False
        self._ranks = 0

    def rank(self) -> int:
        """A place in the order in which wires settle and parties sample within an instant: first come, first served."""
        self._ranks += 1
        return self._ranks

    def at(self, time: int, action: Action, phase: int = TIMER) -> int:
        """Promise to call `action` at `time` (ticks). Returns the promise's number. ValueError if that is past."""
        if time < self.now:
            raise ValueError(f"{describe(action)}: asked for t={time}, but it is already t={self.now}")
        self._number = number = self._number + 1
        heappush(self._queue, (time * _PHASES + phase, number, action))
        return number

    def cancel(self, number: int) -> None:
        """Take back a promise that has not been kept yet."""
        self._dead.add(number)

    def next_time(self) -> int:
        """When the next live event is due (ticks), or NEVER."""
        queue, dead = self._queue, self._dead
        while queue and dead and queue[0][1] in dead:
            dead.remove(heappop(queue)[1])
        return queue[0][0] // _PHASES if queue else NEVER

    def quiet_until(self) -> int:
        """The first tick at which something else than the caller may act, or the end of this run."""
        if self.unsettled or self.sampling or self._stop:
            return self.now
        if self._dead:
            self.next_time()  # takes what was cancelled off the head
        end = self._horizon + 1
        if not self._queue:
            return end
        due = self._queue[0][0] // _PHASES
        return due if due < end else end

    def stop(self) -> None:
        """End the present `run_until` after the event that runs now."""
        self._stop = True

    def settle(self) -> None:
        """Let the wires come to rest, and tell those who sample them."""
        steps = 0
        while self.unsettled or self.sampling:
            if len(self.sampling) > 1:
                self.sampling.sort(key=_rank)
            wires, self.unsettled = self.unsettled, []
            if len(wires) > 1:
                wires.sort(key=_rank)
            for wire in wires:
                wire.settle()  # adds to those who sample
            parties, self.sampling = self.sampling, []
            now = self.now
            for party in parties:
                party.due = False
                party.told(now, party.levels)
            steps += 1
            if steps > STORM:
                raise SimulationStuck(f"wires did not come to rest at t={now} after {STORM} steps")

    def run_until(self, time: int) -> None:
        """Do everything due up to and including `time`; then it is `time` (earlier after `stop`)."""
        if time < self.now:
            raise ValueError(f"asked to run until t={time}, but it is already t={self.now}")
        self._horizon = time
        self._stop = False
        queue, dead = self._queue, self._dead
        last = (time + 1) * _PHASES
        phase, in_this_tick = -1, 0
        while not self._stop:
            key = queue[0][0] if queue else last
            if (self.unsettled or self.sampling) and key > phase:
                self.settle()  # may ask for something in this tick
                continue
            if key >= last:
                break
            _, number, action = heappop(queue)
            if dead and number in dead:
                dead.remove(number)
                continue
            self.events += 1
            phase = key
            now = key // _PHASES
            if now != self.now:
                self.now = now
                in_this_tick = 0
            else:
                in_this_tick += 1
                if in_this_tick > STORM:
                    raise SimulationStuck(
                        f"{STORM} events at t={now} without time passing; the last: {describe(action)}"
                    )
            action()
        self.settle()
        if not self._stop:
            self.now = time


def describe(action: Action) -> str:
    """Who an event belongs to, for messages."""
    owner = getattr(action, "__self__", None)
    name = getattr(action, "__qualname__", repr(action))
    who = getattr(owner, "name", None) or getattr(owner, "who", None)
    return f"{who} ({name})" if who else name
