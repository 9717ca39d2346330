"""Parties that act in a simulation, and what the kernel notifies them of."""

# core: compiled without checks for None

from __future__ import annotations

from collections.abc import Callable
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

    def notify(self, now: int) -> None:
        """Pass the settled levels to the party, and clear `due`."""
        self.due = NOT_DUE
        if self.plain:
            self.agent.sampled(now, self.levels)
        else:
            self.deliver(now)

    def deliver(self, now: int) -> None:
        """Call `agent.sampled` under the record that caused the change."""
        raise NotImplementedError

    def jump(self, bits: int) -> None:
        """Toggle these lines without notification; the changes belong to skipped edges."""
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
