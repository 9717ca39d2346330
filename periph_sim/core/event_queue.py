"""The queue of scheduled events, in one total order: by time, by phase, and by the order of scheduling."""

# core: compiled without checks for None

from __future__ import annotations

from operator import attrgetter
from typing import final

from .agent import Agent
from .state import State

NUMBERS = 1 << 56  # number of ranks in each phase

_order = attrgetter("time", "rank")


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
        """Remove all events and return them in order. They still count as queued."""
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
