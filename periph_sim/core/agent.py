"""Agents, through which parties act in a simulation: their events, and the notification of settled levels.

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
    """Base of the objects through which parties act: at scheduled events, and when sampled lines have settled."""

    __slots__ = ()

    def act(self, tag: int) -> None:
        """Handle an event of this agent. tag: the tag with which the event was scheduled."""
        raise NotImplementedError(f"{type(self).__name__} schedules events but does not define act()")

    def sampled(self, now: int, levels: int) -> None:
        """Handle a change of the sampled lines. levels: the settled levels of the lines.

        It is also called, with the same levels as before, if a sample was requested (`Sampler.request_sample`) or the
        set of pulling parties has changed (`Wire.notify_on_pulls`).
        """
        raise NotImplementedError(f"{type(self).__name__} samples lines but does not define sampled()")

    def pulled(self, line: int, now: int, pulling: int) -> None:
        """Handle a change of the set of parties that pull a line. The level of the line may be the same as before.

        line: the number that was given to `Wire.watch_pulls`.
        pulling: the mask of the parties that pull the line now; bit i is party i.
        """
        raise NotImplementedError(f"{type(self).__name__} watches pulls of lines but does not define pulled()")


@final
class Call(Agent):
    """An agent that calls a function at its event. Rare events use it, so that they need no class of their own."""

    STATE = State("action", made=True)

    __slots__ = ("action",)

    def __init__(self, action: Action) -> None:
        self.action = action

    def act(self, tag: int) -> None:
        self.action()


class Settleable:
    """An object, such as a wire, that takes its new level at the end of a phase, when all agents have acted.

    rank: the place of this object in the order of settling, which `Kernel.rank` returned.
    following: the object that settles after this object in the same phase; None for the last object.
    then: the object that notifies its parties after this object; None for the last object.
    """

    __slots__ = ("following", "rank", "then")

    rank: int
    following: Settleable | None
    then: Settleable | None

    def settle(self) -> None:
        """Take the new level, and set `due` of the parties that must be notified."""
        raise NotImplementedError

    def notify_parties(self, now: int) -> None:
        """Notify the parties whose `due` was set by `settle` and that have not been notified since."""


class SampledParty:
    """A subscriber to the settled levels of lines. It passes these levels to an agent.

    due: how the party will be notified: NOT_DUE, REQUESTED or BY_WIRE.
    plain: True if the party is notified by a call of `agent.sampled`; False if it is notified by a call of `deliver`.
    following: of the parties that requested a sample, the one that is notified next; None for the last party.
    """

    __slots__ = ("agent", "due", "following", "levels", "plain", "rank")

    rank: int
    due: int
    plain: bool
    agent: Agent
    levels: int
    following: SampledParty | None

    def notify(self, now: int) -> None:
        """Pass the settled levels to the agent, and clear `due`."""
        self.due = NOT_DUE
        if self.plain:
            self.agent.sampled(now, self.levels)
        else:
            self.deliver(now)

    def deliver(self, now: int) -> None:
        """Call `agent.sampled`. During the call, `Recorder.cause` is the record that caused the change."""
        raise NotImplementedError

    def jump(self, bits: int) -> None:
        """Invert the levels of the lines in the mask `bits`. No party is notified, since a shortcut skips the edges."""
        raise NotImplementedError


class Shortcut:
    """A sequence of events that is skipped: the state after the events was set in one step, without running them."""

    __slots__ = ()

    def materialize(self) -> None:
        """Undo the step, and run the skipped events up to now. The state is then the same as without the shortcut."""
        raise NotImplementedError


def describe(agent: Agent) -> str:
    """Return the name of an agent for messages. For a `Call`, it is the name of the called function and its object."""
    if isinstance(agent, Call):
        action = agent.action
        owner: object = getattr(action, "__self__", None)
        name = getattr(action, "__qualname__", repr(action))
    else:
        owner, name = agent, type(agent).__name__
    who = getattr(owner, "name", None) or getattr(owner, "who", None)
    return f"{who} ({name})" if who else name


NUMBERS = 1 << 56  # number of different event ranks in each phase; a rank is phase * NUMBERS + a serial number

_order = attrgetter("time", "rank")


@final
class Event:  # core: freelist 16
    """A scheduled event.

    time: the tick at which the event runs.
    tag: the argument of the call `agent.act(tag)`.
    rank: the number by which the events of one tick are ordered: first by phase, then in the order of scheduling.
    queued: True until the event runs or is cancelled.
    plain: True if the event calls a plain function (`Kernel.call_at`).
    following: the next event in the queue; None for the last event.
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
    """The queued events, as a linked list. first: the first event of the list, or None if the queue is empty."""

    STATE = State(chains="first")

    __slots__ = ("_latest", "_number", "first")

    def __init__(self) -> None:
        self.first: Event | None = None
        self._latest: Event | None = None  # the event that was queued last; new events often come directly after it
        self._number = 0

    def insert(self, event: Event, time: int, tag: int) -> None:
        """Queue an event after all queued events of the same time and phase. The event must not be queued yet."""
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
            if before is not None:  # `before` is None if `take_all` has removed the event from the linked list
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
        """Give new ranks to the events of a restored queue. The order of the events does not change."""
        self._latest = None
        event = self.first
        while event is not None:
            self._number += 1
            event.rank = event.phase * NUMBERS + self._number
            event = event.following
