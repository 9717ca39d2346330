"""The event kernel: integer time and one total order of events.

Within one tick the phases are: agents (TIMER), pads of chips (PADS), the chips themselves (CHIP), CPUs (CPU), probes
(PROBE). Within a phase, events run in the order scheduled. At the end of each phase the wires settle: all changed wires
take their levels, then each party that samples them is called once, with all new levels. So the order in which parties
act within a phase is not observable, and two runs of one scene are equal. If a party changes a wire in such a call, the
wire settles after these calls, in the same tick.

A CPU may run ahead of the queue. `quiet_until` returns the tick before which no other party can act; until then, the
CPU may advance `now` by itself.

An agent that blocks inside its own event, as firmware does, can run the event loop from there (`run_nested`) until its
wait is over (`released`). Plain callbacks are never run from a nested loop, because a callback may end the very event
that is blocked.

A sequence of events whose intermediate states are not observed can be applied in one step (`Shortcut`). Code that reads
or changes an intermediate state must first call `materialize`, which runs the skipped events up to now in their normal
order.
"""

# core: compiled without checks for None

from __future__ import annotations

from typing import final

from .agent import (
    NUMBERS,
    REQUESTED,
    Action,
    Agent,
    Call,
    Event,
    EventQueue,
    SampledParty,
    Settleable,
    Shortcut,
    describe,
)
from .chip import NEVER
from .state import State

TIMER, PADS, CHIP, CPU, PROBE = range(5)
_AFTER_ALL = PROBE + 1  # a number above those of all phases of a tick

STORM = 100_000  # maximum number of events, or of settling steps, in one tick; more are considered an endless loop


class SimulationStuck(Exception):
    """Error: events cause further events, or wires change each other, without end in the same tick."""


@final
class Kernel:
    """The queue of events and the loop that runs them.

    shortcut: the active shortcut, whose events are skipped, or None.
    events: the number of events that were run.
    nested_owner: the agent whose nested loop runs events now; None for the outer loop.
    released: set by an event to make the nested loop return, because the wait of its owner is over.
    outer_loop: the coroutine of the event loop that runs when no agent runs a nested one. It is set by agents.
    fault: an exception that an event in a nested loop raised. It is no error of the firmware that blocks there, so the
        outer loop raises it again.
    """

    STATE = State("_queue", ticks="now")

    def __init__(self, start: int = 0) -> None:
        self.now = start
        self.events = 0
        self.shortcut: Shortcut | None = None
        self.nested_owner: object = None
        self.released = False
        self.outer_loop: object = None
        self.fault: BaseException | None = None
        # The next three attributes are heads of linked lists, which are ordered by rank. None: the list is empty.
        self._unsettled: Settleable | None = None  # the first of the wires that changed in this phase
        self._notifying: Settleable | None = None  # the first settled wire that still has to notify its listeners
        self._sampling: SampledParty | None = None  # the first of the parties that requested a sample
        self._settling = False  # True while the wires take their levels
        self._phase = TIMER  # the phase of the event that was started last
        self._horizon = start  # the tick at which the present `run_until` ends
        self._bound = start  # the present loop runs all events before this time
        self._bound_rank = 0  # the present loop also runs the events at `_bound` whose rank is below this
        self._at = -1  # the time of the event that the present loop started last; -1 before its first event
        self._in_this_tick = 0  # number of events that were started in the present tick, not counting the first of them
        self._queue = EventQueue()
        self._stop = False
        self._ranks = 0

    def rank(self) -> int:
        """Return a new rank. Wires settle, and parties that requested a sample are notified, in the order of rank."""
        self._ranks += 1
        return self._ranks

    def call_at(self, time: int, action: Action, phase: int = TIMER) -> None:
        """Schedule a call of `action` at `time` (ticks). Raise ValueError if `time` is past."""
        self.schedule(time, Call(action), 0, phase).plain = True

    def schedule(self, time: int, agent: Agent, tag: int = 0, phase: int = TIMER) -> Event:
        """Schedule `agent.act(tag)` at `time` (ticks) and return the event. Raise ValueError if `time` is past."""
        event = self.event(agent, phase)
        self.reschedule(event, time, tag)
        return event

    def event(self, agent: Agent, phase: int = TIMER) -> Event:
        """Return a new event that is not queued yet; `reschedule` queues it."""
        event: Event = Event.__new__(Event)
        event.agent = agent
        event.phase = phase
        event.queued = False
        event.plain = False
        event.following = None
        return event

    def reschedule(self, event: Event, time: int, tag: int) -> None:
        """Queue an event that is not queued, such as one that has run. So an agent can use one Event object repeatedly.

        Raise ValueError if `time` is past, or if the event is queued.
        """
        if time < self.now or event.queued:
            self._refuse(event, time)
        self._queue.insert(event, time, tag)

    def _refuse(self, event: Event, time: int) -> None:
        who = describe(event.agent)
        if time < self.now:
            raise ValueError(f"{who}: cannot schedule an event at t={time}, because it is already t={self.now}")
        raise ValueError(f"{who}: cannot schedule at t={time} an event that is already queued for t={event.time}")

    def cancel(self, event: Event) -> None:
        """Remove an event from the queue. Nothing happens if it is not queued."""
        self._queue.remove(event)

    def next_time(self) -> int:
        """Return the time of the next event (ticks); NEVER if the queue is empty."""
        first = self._queue.first
        return NEVER if first is None else first.time

    def next_event(self) -> Event | None:
        """Return the next event; None if the queue is empty. `Event.following` leads to the later events."""
        return self._queue.first

    def quiet_until(self) -> int:
        """Return the first tick at which a party other than the calling CPU may act.

        The result is at most the tick after the end of this run. It is `now` if the run is about to stop or if wires
        have not settled.
        """
        if self._unsettled is not None or self._sampling is not None or self._stop:
            return self.now
        end = self._horizon + 1
        event = self._queue.first
        return end if event is None or event.time > end else event.time

    def stop(self) -> None:
        """End the present `run_until` after the event that runs now."""
        self._stop = True

    def moved(self, wire: Settleable) -> None:
        """Let `wire` settle at the end of the present phase."""
        before = self._unsettled
        if before is None or before.rank > wire.rank:
            wire.following = before
            self._unsettled = wire
            return
        after = before.following
        while after is not None and after.rank < wire.rank:
            before, after = after, after.following
        wire.following, before.following = after, wire

    def request_sample(self, party: SampledParty) -> None:
        """Notify `party` of its levels when the wires have settled: once, even after several requests.

        A party that requests this while wires take their levels is notified after the parties that requested it before.
        """
        if party.due:
            return
        party.due = REQUESTED
        before = self._sampling
        if before is None or (before.rank > party.rank and not self._settling):
            party.following = before
            self._sampling = party
            return
        after = before.following
        while after is not None and (after.rank < party.rank or self._settling):
            before, after = after, after.following
        party.following, before.following = after, party

    def settle(self) -> None:
        """Settle all wires and notify the parties that sample them."""
        steps = 0
        while self._unsettled is not None or self._sampling is not None:
            wire = self._unsettled
            self._unsettled = None
            self._settling = True
            self._notifying = wire
            while wire is not None:
                wire.then = next_wire = wire.following
                wire.settle()
                wire = next_wire
            self._settling = False
            party = self._sampling
            self._sampling = None
            while party is not None:
                next_party = party.following
                party.notify(self.now)
                party = next_party
            self._notify_parties()
            steps += 1
            if steps > STORM:
                raise SimulationStuck(f"wires did not settle at t={self.now} after {STORM} steps")

    def _notify_parties(self) -> None:
        """Notify the listeners of all wires that have settled."""
        wire = self._notifying
        while wire is not None:
            self._notifying = wire.then
            wire.notify_parties(self.now)
            wire = self._notifying

    def run_until(self, time: int) -> None:
        """Run all events up to and including tick `time`.

        Afterwards `now` is `time`, or the tick of the event that called `stop`. Raise ValueError if `time` is past.
        """
        if time < self.now:
            raise ValueError(f"cannot run until t={time}, because it is already t={self.now}")
        self._horizon = time
        self._stop = False
        self._do(time, _AFTER_ALL)
        if not self._stop:
            self.now, self._phase = time, _AFTER_ALL
        self.materialize()

    def run_nested(self, owner: object) -> bool:
        """Run the event loop for `owner`, which is blocked inside its own event.

        Return True as soon as an event has set `Kernel.released`, because the wait of `owner` is over. Return False if
        this run has no further event or was stopped, or if the next event is a plain callback. Only the outer loop runs
        plain callbacks, because they may end the event in which `owner` is blocked.
        """
        self.nested_owner = owner
        self.released = False
        while self._next(False):
            if self.released:
                self.nested_owner = None
                return True
        self.nested_owner = None
        return False

    def _do(self, time: int, before: int) -> None:
        """Run the events before tick `time`, and those at `time` in the phases before phase `before`; then settle."""
        bound, rank, at, in_this_tick = self._bound, self._bound_rank, self._at, self._in_this_tick
        self._bound, self._bound_rank, self._at, self._in_this_tick = time, before * NUMBERS, -1, 0
        while self._next(True):
            pass
        self.settle()
        self._bound, self._bound_rank, self._at, self._in_this_tick = bound, rank, at, in_this_tick

    def _next(self, in_outer_loop: bool) -> bool:
        """Settle the wires if the phase is over; then run the next event and return True.

        Return False, without running an event, if this loop must end: the run was stopped, no event is left before the
        end of this loop, or the next event is a plain callback and this loop is a nested one.
        """
        if self._stop:
            return False
        event = self._queue.first
        if (self._unsettled is not None or self._sampling is not None) and (
            event is None or event.time > self._at or event.phase > self._phase
        ):
            self.settle()  # a notified party may schedule an event in this tick, or stop the run
            if self._stop:
                return False
            event = self._queue.first
        if event is None or (event.plain and not in_outer_loop):
            return False
        time = event.time
        if time >= self._bound and (time > self._bound or event.rank >= self._bound_rank):
            return False
        self._queue.first, event.following = event.following, None
        event.queued = False
        self.events += 1
        self._phase = event.phase
        if time != self.now:
            self._in_this_tick = 0
        else:
            self._in_this_tick += 1
            if self._in_this_tick > STORM:
                last = describe(event.agent)
                raise SimulationStuck(f"{STORM} events at t={self.now} without time passing; the last: {last}")
        self.now = self._at = time
        event.agent.act(event.tag)
        return True

    def materialize(self) -> None:
        """Run the events up to now that a shortcut has skipped, if one is active.

        Call this before reading or changing a state that a shortcut may have skipped.
        """
        if self.shortcut is not None:
            self.shortcut.materialize()

    def replay(self, since: int, agent: Agent, tag: int) -> None:
        """Run skipped events: go back to tick `since`, call `agent.act(tag)`, and run the events that this call causes.

        Events before the present tick, and those in earlier phases of the present tick, are run. Others stay queued.
        """
        now, phase, stop = self.now, self._phase, self._stop
        owner, outer, self.nested_owner = self.nested_owner, self.outer_loop, None
        self._notify_parties()
        self.settle()
        later = self._queue.take_all()
        self.now, self._stop = since, False
        self.schedule(since, agent, tag)
        self._do(now, phase)
        self.now, self._phase, self._stop = now, phase, stop
        self.nested_owner, self.outer_loop = owner, outer
        events = self._queue.take_all()
        events.extend([event for event in later if event.queued and event not in events])
        self._queue.put_back(events)

    def restored(self) -> None:
        """Discard unsettled wires and requested samples, because snapshots contain settled states only."""
        self._unsettled = self._sampling = None
