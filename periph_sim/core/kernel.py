"""The event kernel: integer time, one total order, nothing else.

Inside one tick the order is: wires settle after every single event; timers fire (TIMER,
which includes chips and agents); then the CPUs act (CPU); then probes look (PROBE).
Within a phase, first asked is first done. Two runs of one scene are therefore equal.

A CPU that runs ahead of the queue asks `quiet_until` how far it may go: up to that time,
not including it, nothing else can happen (a lease), so it may move `now` by itself. An agent
that has one thing to do after the other asks `run_ahead`, step by step: nothing is queued then.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from heapq import heappop, heappush
from typing import Protocol

from .chip import NEVER

TIMER, CPU, PROBE = range(3)
_PHASES = 4  # a queue key is time * _PHASES + phase

STORM = 100_000  # so many events inside one tick is a loop, not a design

Action = Callable[[], None]


class SimulationStuck(Exception):
    """Events kept causing events without time passing."""


class Settles(Protocol):
    """Something that comes to rest after the event that disturbed it: a wire."""

    def settle(self) -> None: ...


class Kernel:
    """events: how many were done, cancelled ones not counted; the measure of cost."""

    def __init__(self, start: int = 0) -> None:
        self.now = start
        self.events = 0
        self.unsettled: deque[Settles] = deque()  # what the present event disturbed, in order
        self._horizon = start
        self._number = 0
        self._queue: list[tuple[int, int, Action]] = []
        self._dead: set[int] = set()
        self._stop = False

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
        if self.unsettled or self._stop:
            return self.now
        if self._dead:
            self.next_time()  # takes what was cancelled off the head
        end = self._horizon + 1
        if not self._queue:
            return end
        due = self._queue[0][0] // _PHASES
        return due if due < end else end

    def run_ahead(self, time: int) -> bool:
        """Make it `time` at once, if nothing else can happen up to then; the caller goes on as if by an event."""
        unsettled = self.unsettled
        while unsettled:
            unsettled.popleft().settle()
        queue = self._queue
        if time > self._horizon or self._stop or (queue and queue[0][0] < (time + 1) * _PHASES):
            return False
        self.now = time
        self.events += 1
        return True

    def stop(self) -> None:
        """End the present `run_until` after the event that runs now."""
        self._stop = True

    def settled(self) -> None:
        """Let all wires come to rest now."""
        unsettled = self.unsettled
        steps = 0
        while unsettled:
            unsettled.popleft().settle()
            steps += 1
            if steps > STORM:
                raise SimulationStuck(f"wires did not come to rest at t={self.now} after {STORM} steps")

    def run_until(self, time: int) -> None:
        """Do everything due up to and including `time`; then it is `time` (earlier after `stop`)."""
        if time < self.now:
            raise ValueError(f"asked to run until t={time}, but it is already t={self.now}")
        self._horizon = time
        self._stop = False
        queue, dead, unsettled = self._queue, self._dead, self.unsettled
        self.settled()
        last = (time + 1) * _PHASES
        instant = in_this_tick = 0
        while queue and not self._stop:
            entry = heappop(queue)
            key, number, action = entry
            if key >= last:
                heappush(queue, entry)
                break
            if dead and number in dead:
                dead.remove(number)
                continue
            self.events += 1
            if key != instant:
                instant = key
                self.now = key // _PHASES
                in_this_tick = 0
            else:
                in_this_tick += 1
                if in_this_tick > STORM:
                    raise SimulationStuck(
                        f"{STORM} events at t={self.now} without time passing; the last: {describe(action)}"
                    )
            action()
            while unsettled:
                unsettled.popleft().settle()
                in_this_tick += 1
                if in_this_tick > STORM:
                    raise SimulationStuck(f"wires did not come to rest at t={self.now} after {STORM} steps")
        if not self._stop:
            self.now = time


def describe(action: Action) -> str:
    """Who an event belongs to, for messages."""
    owner = getattr(action, "__self__", None)
    name = getattr(action, "__qualname__", repr(action))
    who = getattr(owner, "name", None) or getattr(owner, "who", None)
    return f"{who} ({name})" if who else name
