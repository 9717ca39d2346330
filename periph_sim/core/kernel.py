"""The event kernel: integer time and one total order of events.

Within one tick the phases are: agents (TIMER), pads of chips (PADS), the chips themselves (CHIP), CPUs (CPU), probes
(PROBE). Within a phase, events run in the order scheduled. At the end of each phase the wires settle: all changed wires
take their levels, then each party that samples them is called once, with all new levels. So the order of the parties
within a phase is not observable, and two runs of one scene are equal. Changes that a response makes in the same tick
settle after it.

A CPU that runs ahead of the queue calls `quiet_until` for the end of its lease: before that tick nothing else can
happen, so it may advance `now` by itself.

An agent that blocks inside its own event, as firmware does, can run the event loop from there (`run_nested`) until its
wait is over (`released`). Plain callbacks are never run from a nested loop, because a callback may end the very event
that is blocked.

A sequence of events whose intermediate states are not observed can be applied in one step (`Shortcut`). Before anything
reads or changes an intermediate state, it must call `materialize`, which runs the skipped events up to now in their
normal order.
"""

# core: compiled without checks for None

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter
from typing import final

from .chip import NEVER
from .state import State

TIMER, PADS, CHIP, CPU, PROBE = range(5)
_AFTER_ALL = PROBE + 1  # all phases of an instant
_NUMBERS = 1 << 56  # number of ranks in each phase

STORM = 100_000  # more events than this in one tick are an endless loop

Action = Callable[[], None]

# How a sampled party is notified after the wires settle: not at all, by its own request, or by one of its wires.
NOT_DUE, REQUESTED, BY_WIRE = range(3)

_order = attrgetter("time", "rank")


class SimulationStuck(Exception):
    """Events kept causing events without time passing."""


class Agent:
    """A party that acts in a simulation: at its scheduled events, and when lines that it samples have settled."""

    __slots__ = ()

    def act(self, tag: int) -> None:
        """Called at the time of an event that was scheduled with this `tag`."""
        raise NotImplementedError(f"{type(self).__name__} schedules events but does not define act()")

    def sampled(self, now: int, levels: int) -> None:
        """Called when sampled lines have changed. levels: their settled levels."""
        raise NotImplementedError(f"{type(self).__name__} samples lines but does not define sampled()")

    def pulled(self, line: int, now: int, pulling: int) -> None:
        """Called when the set of parties that pull a line has changed; its level may be the same.

        pulling: bit i is party i of the line.
        """
        raise NotImplementedError(f"{type(self).__name__} watches pulls of lines but does not define pulled()")


@final
class Call(Agent):
    """An agent that calls a function, for events that are too rare to need their own class."""

    STATE = State("action", made=True)

    __slots__ = ("action",)

    def __init__(self, action: Action) -> None:
        self.action = action

    def act(self, tag: int) -> None:
        self.action()


@final
class Event:  # core: freelist 16
    """A scheduled event.

    rank: orders events of one time, by phase and then by number.
    queued: True until the event runs or is cancelled.
    plain: True if the agent calls a function.
    following: the next event in the queue.
    """

    STATE = State("agent plain phase queued tag", ticks="time", made=True)

    __slots__ = ("agent", "following", "phase", "plain", "queued", "rank", "tag", "time")

    time: int
    phase: int
    rank: int
    agent: Agent
    tag: int
    queued: bool
    plain: bool
    following: Event | None


class Settleable:
    """An object, such as a wire, that takes its new level when all parties of a phase have acted.

    rank: see `Kernel.rank`.
    following: the next one that settles in this phase. then: the next one that notifies its parties.
    """

    __slots__ = ("following", "rank", "then")

    rank: int
    following: Settleable | None
    then: Settleable | None

    def settle(self) -> None:
        """Take the new level and mark the parties to be notified as `due`."""
        raise NotImplementedError

    def notify_parties(self, now: int) -> None:
        """Notify the parties that `settle` marked and that have not been notified since."""


class SampledParty:
    """A subscriber to settled levels.

    due: how it will be notified: NOT_DUE, REQUESTED or BY_WIRE.
    plain: True if calling `agent.sampled` with `levels` is enough; otherwise `deliver` is called.
    following: the next party to be notified.
    """

    __slots__ = ("agent", "due", "following", "levels", "plain", "rank")

    rank: int
    due: int
    plain: bool
    agent: Agent
    levels: int
    following: SampledParty | None

    def deliver(self, now: int) -> None:
        raise NotImplementedError


class Shortcut:
    """A sequence of events that was applied in one step and can be undone until its end."""

    __slots__ = ()

    def materialize(self) -> None:
        """Restore the state that would exist now if each event had been run."""
        raise NotImplementedError


@final
class Kernel:
    """The queue of events and the loop that runs them.

    shortcut: the sequence of events that is skipped now, or None.
    events: the number of events that were run.
    nested_owner: the agent whose nested loop runs events now; None for the outer loop.
    released: True if the nested loop is to return after the present event.
    outer_loop: the event loop that runs when no agent runs a nested one.
    fault: an exception of another party in a nested loop, to be raised in the outer loop.
    """

    STATE = State(ticks="now", chains="_first")

    def __init__(self, start: int = 0) -> None:
        self.now = start
        self.events = 0
        self.shortcut: Shortcut | None = None
        self.nested_owner: object = None
        self.released = False
        self.outer_loop: object = None
        self.fault: BaseException | None = None
        self._unsettled: Settleable | None = None  # changed in this phase, by rank: the first of a chain
        self._notifying: Settleable | None = None  # settled, parties not notified yet: likewise
        self._sampling: SampledParty | None = None  # parties that requested a sample, by rank
        self._settling = False  # True while the wires take their levels
        self._phase = TIMER  # of the last event
        self._horizon = start
        self._bound = start  # events before this time run now,
        self._bound_rank = 0  # and those at this time with a lower rank
        self._at = -1  # time of the last event
        self._in_this_tick = 0  # number of events before it in its tick
        self._number = 0
        self._first: Event | None = None  # queued events, in order: the first of a chain
        self._latest: Event | None = None  # scheduled last; the next one often follows it
        self._stop = False
        self._ranks = 0

    def rank(self) -> int:
        """Return the next place in the order in which wires settle and parties sample within an instant."""
        self._ranks += 1
        return self._ranks

    def call_at(self, time: int, action: Action, phase: int = TIMER) -> Event:
        """Schedule a call of `action` at `time` (ticks) and return the event. ValueError if that is past."""
        event = self.schedule(time, Call(action), 0, phase)
        event.plain = True
        return event

    def schedule(self, time: int, agent: Agent, tag: int = 0, phase: int = TIMER) -> Event:
        """Schedule `agent.act(tag)` at `time` (ticks) and return the event. ValueError if that is past."""
        event = self.event(agent, phase)
        self.reschedule(event, time, tag)
        return event

    def event(self, agent: Agent, phase: int = TIMER) -> Event:
        """Return a new event that is not queued, for `reschedule`."""
        event: Event = Event.__new__(Event)
        event.agent = agent
        event.phase = phase
        event.queued = False
        event.plain = False
        event.following = None
        return event

    def reschedule(self, event: Event, time: int, tag: int) -> None:
        """Schedule an event that is not queued, so that an agent with one event at a time needs only one object.

        ValueError if `time` is past, or the event is queued.
        """
        if time < self.now or event.queued:
            self._refuse(event, time)
        self._number += 1
        event.time = time
        event.rank = rank = event.phase * _NUMBERS + self._number
        event.tag = tag
        first = self._first
        if first is None or first.time > time or (first.time == time and first.rank > rank):
            event.following, self._first = first, event
        else:
            before = self._latest
            if (
                before is None
                or not before.queued
                or before.time > time
                or (before.time == time and before.rank > rank)
            ):
                before = first
            after = before.following
            while after is not None and (after.time < time or (after.time == time and after.rank < rank)):
                before, after = after, after.following
            event.following, before.following = after, event
        event.queued = True
        self._latest = event

    def _refuse(self, event: Event, time: int) -> None:
        who = describe(event.agent)
        if time < self.now:
            raise ValueError(f"{who}: cannot schedule an event at t={time}, because it is already t={self.now}")
        raise ValueError(f"{who}: cannot schedule at t={time} an event that is already queued for t={event.time}")

    def cancel(self, event: Event) -> None:
        """Remove an event from the queue. Nothing happens if it is not queued."""
        if not event.queued:
            return
        event.queued = False
        before = self._first
        if before is event:
            self._first = event.following
        else:
            while before is not None and before.following is not event:
                before = before.following
            if before is not None:  # else a replay has taken it out
                before.following = event.following
        event.following = None

    def next_time(self) -> int:
        """Return the time of the next event (ticks), or NEVER."""
        return NEVER if self._first is None else self._first.time

    def quiet_until(self) -> int:
        """Return the first tick at which anything but the caller may act, or the end of this run."""
        if self._unsettled is not None or self._sampling is not None or self._stop:
            return self.now
        end = self._horizon + 1
        event = self._first
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
        """Notify `party` of its levels when the wires have settled; once, even if requested several times."""
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
                party.due = NOT_DUE
                if party.plain:
                    party.agent.sampled(self.now, party.levels)
                else:
                    party.deliver(self.now)
                party = next_party
            self._notify_parties()
            steps += 1
            if steps > STORM:
                self._stuck(f"wires did not settle at t={self.now} after {STORM} steps")

    def _notify_parties(self) -> None:
        """Notify the listeners of all wires that have settled."""
        wire = self._notifying
        while wire is not None:
            self._notifying = wire.then
            wire.notify_parties(self.now)
            wire = self._notifying

    def _stuck(self, why: str) -> None:
        raise SimulationStuck(why)

    def run_until(self, time: int) -> None:
        """Run all events up to and including `time`; then `now` is `time`, or earlier after `stop`."""
        if time < self.now:
            raise ValueError(f"cannot run until t={time}, because it is already t={self.now}")
        self._horizon = time
        self._stop = False
        self._do(time, _AFTER_ALL)
        if not self._stop:
            self.now, self._phase = time, _AFTER_ALL
        self.materialize()

    def run_nested(self, owner: object) -> bool:
        """Run events inside the event of `owner`, which is blocked. Return True when `released` is set.

        Return False if the outer loop must go on: no event is left, or the next one calls a plain function.
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
        """Run the events before `time`, and those at `time` in phases before `before`; then settle."""
        bound, rank, at, in_this_tick = self._bound, self._bound_rank, self._at, self._in_this_tick
        self._bound, self._bound_rank, self._at, self._in_this_tick = time, before * _NUMBERS, -1, 0
        while self._next(True):
            pass
        self.settle()
        self._bound, self._bound_rank, self._at, self._in_this_tick = bound, rank, at, in_this_tick

    def _next(self, in_outer_loop: bool) -> bool:
        """Settle the wires and run the next event. Return False if there is none, or another loop must run it."""
        if self._stop:
            return False
        event = self._first
        if (self._unsettled is not None or self._sampling is not None) and (
            event is None or event.time > self._at or event.phase > self._phase
        ):
            self.settle()  # may schedule an event in this tick, or stop the run
            if self._stop:
                return False
            event = self._first
        if event is None or (event.plain and not in_outer_loop):
            return False
        time = event.time
        if time >= self._bound and (time > self._bound or event.rank >= self._bound_rank):
            return False
        self._first, event.following = event.following, None
        event.queued = False
        self.events += 1
        self._phase = event.phase
        if time != self.now:
            self._in_this_tick = 0
        else:
            self._in_this_tick += 1
            if self._in_this_tick > STORM:
                last = describe(event.agent)
                self._stuck(f"{STORM} events at t={self.now} without time passing; the last: {last}")
        self.now = self._at = time
        event.agent.act(event.tag)
        return True

    def materialize(self) -> None:
        """Run the events that are skipped now; call this before reading or changing their intermediate states."""
        if self.shortcut is not None:
            self.shortcut.materialize()

    def replay(self, since: int, agent: Agent, tag: int) -> None:
        """Go back to `since`, run `agent.act(tag)` and all events that result, and return to now.

        Of the present tick, only the phases before the present one are run; later events are queued.
        """
        now, phase, stop = self.now, self._phase, self._stop
        owner, outer, self.nested_owner = self.nested_owner, self.outer_loop, None
        self._notify_parties()
        self.settle()
        later = self._taken_out()
        self.now, self._stop = since, False
        self.schedule(since, agent, tag)
        self._do(now, phase)
        self.now, self._phase, self._stop = now, phase, stop
        self.nested_owner, self.outer_loop = owner, outer
        events = self._taken_out()
        events.extend([event for event in later if event.queued and event not in events])
        events.sort(key=_order, reverse=True)
        for event in events:
            event.following, self._first = self._first, event

    def restored(self) -> None:
        """Number the events of a restored queue in their order."""
        self._latest = self._unsettled = self._sampling = None
        event = self._first
        while event is not None:
            self._number += 1
            event.rank = event.phase * _NUMBERS + self._number
            event = event.following

    def _taken_out(self) -> list[Event]:
        """Remove all events from the queue and return them in order."""
        events: list[Event] = []
        event = self._first
        while event is not None:
            events.append(event)
            event = event.following
        self._first = self._latest = None
        return events


def describe(agent: Agent) -> str:
    """Return the owner of an agent's events as a text for messages."""
    if isinstance(agent, Call):
        action = agent.action
        owner: object = getattr(action, "__self__", None)
        name = getattr(action, "__qualname__", repr(action))
    else:
        owner, name = agent, type(agent).__name__
    who = getattr(owner, "name", None) or getattr(owner, "who", None)
    return f"{who} ({name})" if who else name
