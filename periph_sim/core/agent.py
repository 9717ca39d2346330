"""Parties that act in a simulation, how they are notified of settled levels, and the queue of their events.

Events have one total order: by time, by phase, and by the order of scheduling.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter
from typing import final

from .state import State

Action = Callable[[], None]

# How a sampled party is notified after the wires settle: not at all, by its own request, or by one of its wires.
NOT_DUE, REQUESTED, BY_WIRE = range(3)


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

        line: the number that was given to `Wire.watch_pulls`.
        pulling: the mask of the parties that pull the line now; bit i is party i.
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


class Settleable:
    """An object, such as a wire, that takes its new level when all parties of a phase have acted.

    rank: its place in the order of settling, from `Kernel.rank`.
    following: the next object that settles in this phase.
    then: the next object that notifies its parties.
    """

    __slots__ = ("following", "rank", "then")

    rank: int
    following: Settleable | None
    then: Settleable | None

    def settle(self) -> None:
        """Take the new level, and set `due` of the parties that must be notified."""
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

    def notify(self, now: int) -> None:
        """Pass the settled levels to the party, and clear `due`."""
        self.due = NOT_DUE
        if self.plain:
            self.agent.sampled(now, self.levels)
        else:
            self.deliver(now)

    def deliver(self, now: int) -> None:
        """Call `agent.sampled`. During the call, the record that caused the change is the present record."""
        raise NotImplementedError

    def jump(self, bits: int) -> None:
        """Toggle the levels of the lines in the mask `bits` without notification, because their edges are skipped."""
        raise NotImplementedError


class Shortcut:
    """A sequence of events that was applied in one step and can be undone until its end."""

    __slots__ = ()

    def materialize(self) -> None:
        """Restore the state that would exist now if each event had been run."""
        raise NotImplementedError


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


NUMBERS = 1 << 56  # number of different ranks in each phase

_order = attrgetter("time", "rank")


@final
class Event:  # core: freelist 16
    """A scheduled event.

    time: the tick at which it runs.
    tag: the argument of the call `agent.act(tag)`.
    rank: orders the events of one tick, by phase and then by the order of scheduling.
    queued: True until the event runs or is cancelled.
    plain: True if the event calls a plain function (`Kernel.call_at`).
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


@final
class EventQueue:
    """The queued events, as a chain. first: the first event of the chain, or None."""

    STATE = State(chains="first")

    __slots__ = ("_latest", "_number", "first")

    def __init__(self) -> None:
        self.first: Event | None = None
        self._latest: Event | None = None  # the event that was queued last; the next one often follows it
        self._number = 0

    def insert(self, event: Event, time: int, tag: int) -> None:
        """Queue an event that is not queued, after all queued events of the same time and phase."""
        self._number += 1
        event.time = time
        event.rank = rank = event.phase * NUMBERS + self._number
        event.tag = tag
        first = self.first
        if first is None or first.time > time or (first.time == time and first.rank > rank):
            event.following, self.first = first, event
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

    def remove(self, event: Event) -> None:
        """Remove an event. Nothing happens if it is not queued."""
        if not event.queued:
            return
        event.queued = False
        before = self.first
        if before is event:
            self.first = event.following
        else:
            while before is not None and before.following is not event:
                before = before.following
            if before is not None:  # otherwise `take_all` has removed the event from the chain
                before.following = event.following
        event.following = None

    def take_all(self) -> list[Event]:
        """Remove all events and return them in order. Their attribute `queued` stays True."""
        events: list[Event] = []
        event = self.first
        while event is not None:
            events.append(event)
            event = event.following
        self.first = self._latest = None
        return events

    def put_back(self, events: list[Event]) -> None:
        """Queue events that `take_all` returned, in their order. The queue must be empty."""
        events.sort(key=_order, reverse=True)
        for event in events:
            event.following, self.first = self.first, event

    def restored(self) -> None:
        """Number the events of a restored queue in their order."""
        self._latest = None
        event = self.first
        while event is not None:
            self._number += 1
            event.rank = event.phase * NUMBERS + self._number
            event = event.following
