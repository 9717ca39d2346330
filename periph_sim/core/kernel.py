"""The event kernel: integer time, one total order, nothing else.

Inside one tick the order is: agents act (TIMER), then the pads of chips (PADS), the chips behind them (CHIP)
and the CPUs (CPU), then probes look (PROBE). Within a phase, first asked is first done. At the end of each phase
the wires settle: all that moved take their level, then each party that samples them is told once, of all
of them together. So nobody can tell in which order the parties of one phase acted, and two runs of one
scene are equal. What an answer moves in the same tick settles after it.

A CPU that runs ahead of the queue asks `quiet_until` how far it may go: up to that time,
not including it, nothing else can happen (a lease), so it may move `now` by itself.

Who has to wait in the middle of its turn, as firmware does, may do what is due from there (`help`): its turn goes on as
soon as `released` says so. A plain function is never called from there: it may do anything, end that very turn, too.

A sequence of events whose intermediate states nobody observes can be applied in one step (`Shortcut`). Before anything
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
_NUMBERS = 1 << 56  # so many events before a number would reach the phase beside it

STORM = 100_000  # so many events inside one tick is a loop, not a design

Action = Callable[[], None]

# Whether a party is to be told of the levels as they settle: in its place among those who asked, or by a wire of its.
NOT_DUE, REQUESTED, BY_WIRE = range(3)

_order = attrgetter("time", "rank")


class SimulationStuck(Exception):
    """Events kept causing events without time passing."""


class Agent:
    """Who acts in a simulation: at the times that it asked for, and as the lines that it samples have settled."""

    __slots__ = ()

    def act(self, tag: int) -> None:
        """The time of an event has come that this agent asked for under `tag`."""
        raise NotImplementedError(f"{type(self).__name__} asks for events and does not say what it does then")

    def sampled(self, now: int, levels: int) -> None:
        """Lines have moved; `levels` is what they settled on."""
        raise NotImplementedError(f"{type(self).__name__} samples lines and does not say what it does then")

    def pulled(self, line: int, now: int, pulling: int) -> None:
        """Others pull a line than before: bit i of `pulling` is its party i. Its level may be the same."""
        raise NotImplementedError(f"{type(self).__name__} watches who pulls lines and does not say what it does then")


@final
class Call(Agent):
    """An agent that calls a function; what is not asked for often needs no class of its own."""

    STATE = State("action", made=True)

    __slots__ = ("action",)

    def __init__(self, action: Action) -> None:
        self.action = action

    def act(self, tag: int) -> None:
        self.action()


@final
class Event:  # core: freelist 16
    """What an agent asked for. rank: orders what comes at one time, by phase, then by number. queued: still to come.

    plain: the agent calls a function. following: what comes next after it.
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
    """What takes its new level when all who move it have acted: a wire. rank: see `Kernel.rank`.

    following: what settles after it in this phase. then: what hands on after it.
    """

    __slots__ = ("following", "rank", "then")

    rank: int
    following: Settleable | None
    then: Settleable | None

    def settle(self) -> None:
        """Take the level; whoever is to be told of it is `due`."""
        raise NotImplementedError

    def notify_parties(self, now: int) -> None:
        """All have settled: tell whom it made due, if nobody else did meanwhile."""


class SampledParty:
    """Who is told of the settled levels. due: whether it is to be told, and by whom. following: who is told after it.

    plain: all there is to it is that its agent is told `levels`, its lines as they have settled; else `tell` tells.
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
    """A sequence of events that was applied in one step, and can be undone as long as it is not over."""

    __slots__ = ()

    def materialize(self) -> None:
        """Bring everything into the state that it would have now if each event had been run."""
        raise NotImplementedError


@final
class Kernel:
    """shortcut: the sequence of events that is skipped now, or None. events: the number of events that were run.
    helper: in whose turn events are done now; None: in nobody's. released: its turn goes on after the present event.
    home: where the events are done that no helper does, for those who know the way there. fault: raised in a helper's
    turn, and not its own: to be raised at home.
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
        self._unsettled: Settleable | None = None  # what moved in the present phase, by rank: the first of a chain
        self._notifying: Settleable | None = None  # what has settled, and did not tell its own yet: likewise
        self._sampling: SampledParty | None = None  # who else is to be told of it, by rank
        self._settling = False  # the wires take their levels
        self._phase = TIMER  # of the event done last
        self._horizon = start
        self._bound = start  # what is due up to then is done now,
        self._bound_rank = 0  # and of that time itself what is below this rank
        self._at = -1  # of the event done last
        self._in_this_tick = 0  # how many came before it
        self._number = 0
        self._first: Event | None = None  # what is still to come, in order: the first of a chain
        self._latest: Event | None = None  # asked for last; the next one often comes behind it
        self._stop = False
        self._ranks = 0

    def rank(self) -> int:
        """A place in the order in which wires settle and parties sample within an instant: first come, first served."""
        self._ranks += 1
        return self._ranks

    def call_at(self, time: int, action: Action, phase: int = TIMER) -> Event:
        """Promise to call `action` at `time` (ticks). Returns the promise. ValueError if that is past."""
        event = self.schedule(time, Call(action), 0, phase)
        event.plain = True
        return event

    def schedule(self, time: int, agent: Agent, tag: int = 0, phase: int = TIMER) -> Event:
        """Promise to call `agent.act(tag)` at `time` (ticks). Returns the promise. ValueError if that is past."""
        event = self.event(agent, phase)
        self.reschedule(event, time, tag)
        return event

    def event(self, agent: Agent, phase: int = TIMER) -> Event:
        """What `renew` makes a promise of."""
        event: Event = Event.__new__(Event)
        event.agent = agent
        event.phase = phase
        event.queued = False
        event.plain = False
        event.following = None
        return event

    def reschedule(self, event: Event, time: int, tag: int) -> None:
        """Promise the agent of `event`, which is new, was kept or taken back, another one: an agent with one at a time
        needs no further object. ValueError if `time` is past, or the event is still to come.
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
            raise ValueError(f"{who}: asked for t={time}, but it is already t={self.now}")
        raise ValueError(f"{who}: asked for t={time} by an event that comes at t={event.time}")

    def cancel(self, event: Event) -> None:
        """Take back a promise; one that was kept stays kept."""
        if not event.queued:
            return
        event.queued = False
        before = self._first
        if before is event:
            self._first = event.following
        else:
            while before is not None and before.following is not event:
                before = before.following
            if before is not None:  # else it waits behind a replay
                before.following = event.following
        event.following = None

    def next_time(self) -> int:
        """When the next event is due (ticks), or NEVER."""
        return NEVER if self._first is None else self._first.time

    def quiet_until(self) -> int:
        """The first tick at which something else than the caller may act, or the end of this run."""
        if self._unsettled is not None or self._sampling is not None or self._stop:
            return self.now
        end = self._horizon + 1
        event = self._first
        return end if event is None or event.time > end else event.time

    def stop(self) -> None:
        """End the present `run_until` after the event that runs now."""
        self._stop = True

    def moved(self, wire: Settleable) -> None:
        """`wire` settles at the end of the present phase."""
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
        """`party` is to be told of the levels as they settle; once, however often it is asked."""
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
        """Let the wires come to rest, and tell those who sample them."""
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
                self._stuck(f"wires did not come to rest at t={self.now} after {STORM} steps")

    def _notify_parties(self) -> None:
        """What has settled tells those who listen to it."""
        wire = self._notifying
        while wire is not None:
            self._notifying = wire.then
            wire.notify_parties(self.now)
            wire = self._notifying

    def _stuck(self, why: str) -> None:
        raise SimulationStuck(why)

    def run_until(self, time: int) -> None:
        """Do everything due up to and including `time`; then it is `time` (earlier after `stop`)."""
        if time < self.now:
            raise ValueError(f"asked to run until t={time}, but it is already t={self.now}")
        self._horizon = time
        self._stop = False
        self._do(time, _AFTER_ALL)
        if not self._stop:
            self.now, self._phase = time, _AFTER_ALL
        self.materialize()

    def run_nested(self, owner: object) -> bool:
        """Do what is due in the middle of `helper`'s turn. True when that goes on.

        False: the rest is done at home, since nothing is left, or it is a plain function's turn.
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
        """Everything that is due up to `time`, there before this phase; nothing is unsettled behind it."""
        bound, rank, at, in_this_tick = self._bound, self._bound_rank, self._at, self._in_this_tick
        self._bound, self._bound_rank, self._at, self._in_this_tick = time, before * _NUMBERS, -1, 0
        while self._next(True):
            pass
        self.settle()
        self._bound, self._bound_rank, self._at, self._in_this_tick = bound, rank, at, in_this_tick

    def _next(self, in_outer_loop: bool) -> bool:
        """Let the wires settle, and do the next event. False if there is none, or it is not to be done here."""
        if self._stop:
            return False
        event = self._first
        if (self._unsettled is not None or self._sampling is not None) and (
            event is None or event.time > self._at or event.phase > self._phase
        ):
            self.settle()  # may ask for something in this tick, or stop the run
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
        """Go back to `since`, where `agent.act(tag)` was due, and do all that comes of it up to now.

        Of now itself the phases before the present one: what comes in this one does so beside who asked.
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
        came = self._taken_out()
        came.extend([event for event in later if event.queued and event not in came])
        came.sort(key=_order, reverse=True)
        for event in came:
            event.following, self._first = self._first, event

    def restored(self) -> None:
        """The queue has been restored: number its events in their order."""
        self._latest = self._unsettled = self._sampling = None
        event = self._first
        while event is not None:
            self._number += 1
            event.rank = event.phase * _NUMBERS + self._number
            event = event.following

    def _taken_out(self) -> list[Event]:
        """All events that are still to come; the kernel has none of them any more."""
        events: list[Event] = []
        event = self._first
        while event is not None:
            events.append(event)
            event = event.following
        self._first = self._latest = None
        return events


def describe(agent: Agent) -> str:
    """Who an event belongs to, for messages."""
    if isinstance(agent, Call):
        action = agent.action
        owner: object = getattr(action, "__self__", None)
        name = getattr(action, "__qualname__", repr(action))
    else:
        owner, name = agent, type(agent).__name__
    who = getattr(owner, "name", None) or getattr(owner, "who", None)
    return f"{who} ({name})" if who else name
