"""A UART frame in two events: its first fall and its last rise are edges as ever; those between are told behind.

    wire  ~~|___|~~|___|~~~~~~|__|~~~~   every edge an event
    wire  ~~|____________________|~~~~   the same frame: the edges between are told as the last one comes
            ^ asked here         ^ over

Who receives frames is not done with one before its stop bit, so nobody can tell, unless somebody records edges, pulls
the line, looks at it, or meddles with a receiver in the middle. Where that may be, the frame passes edge by edge; where
somebody looks or meddles after all (`catch_up`), the edges up to now are told, and the rest of the frame is sent edge
by edge.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING

from ...core.kernel import TIMER, Agent, Kernel
from ...core.shortcuts import Untold, shortcuts_of
from ...core.wire import Sampler, Wire

if TYPE_CHECKING:
    from ...core.shortcuts import Shortcuts


class FrameParty(Agent):
    """One who listens to a UART line alone, and can be told late of the edges inside a frame."""

    __slots__ = ()

    def hears_whole(self, first: int, second: int, last: int) -> bool:
        """Whether a frame with edges at these ticks, and others between, does nothing to it before its last.

        It is heard like any other where this does not hold.
        """
        raise NotImplementedError

    def hears(self, tick: int, level: int) -> None:
        """The line has been at `level` since `tick`."""
        self.sampled(tick, level)

    def untold(self, frames: WholeFrames | None) -> None:
        """A frame passes so from now on, or no longer: who looks at this party meanwhile is to `settle` it first."""


class FrameSender(Agent):
    """Who sends frames that may pass."""

    __slots__ = ()

    def take_back(self, edges: list[int]) -> None:
        """Of the edges that were to pass, these ticks are still to come, and are its own again."""
        raise NotImplementedError


class WholeFrames(Untold):
    """Of one line. known: who may be on it, as its parties are called: units, which say before what their pins do
    there, and those that send frames. stand_in: for agents that are no party, who is one for them.

    frames: how many were sent. passed: how many of them in two events.
    """

    __slots__ = (
        "_between",
        "_kernel",
        "_known",
        "_mask",
        "_may_be",
        "_parties",
        "_phase",
        "_sender",
        "_shortcuts",
        "_stand_in",
        "_told",
        "_version",
        "_wire",
        "frames",
        "passed",
    )

    _shortcuts: Shortcuts

    def __init__(
        self, kernel: Kernel, wire: Wire, known: Collection[str], stand_in: Mapping[Agent, FrameParty]
    ) -> None:
        self.frames = self.passed = 0
        self._kernel = kernel
        self._shortcuts = shortcuts_of(kernel)
        self._wire = wire
        self._may_be = frozenset(known)
        self._stand_in = stand_in
        self._parties: list[FrameParty] = []
        self._known = False  # all that listen are these, and who may pull is no stranger
        self._version = -1  # of the wire, when it was looked through
        self._sender: FrameSender | None = None  # of the frame that passes now
        self._mask = 0  # its hold on the wire
        self._phase = TIMER  # in which its edges come
        self._between: list[int] = []  # ticks of this frame's edges between its first and its last,
        self._told = 0  # and how many of them have been told

    def passes(self, sender: FrameSender, mask: int, between: list[int], last: int, phase: int = TIMER) -> bool:
        """Whether the edges between the fall that `sender` is about to make and the rise at tick `last` pass untold.

        mask: its hold on the wire. phase: in which these edges would come.
        """
        self.frames += 1
        wire = self._wire
        if not wire.quiet() or wire.pulling:
            return False
        if wire.version != self._version:
            self._look(mask)
        if not self._known or mask != self._mask:
            return False
        now = self._kernel.now
        second: int = between[0] if between else last
        party: FrameParty
        for party in self._parties:
            if not party.hears_whole(now, second, last):
                return False
        self._sender, self._between, self._told, self._phase = sender, between, 0, phase
        self._shortcuts.begin(self)
        for party in self._parties:
            party.untold(self)
        return True

    def over(self) -> None:
        """The last edge of a frame is about to be made."""
        if self._sender is not None:
            self.passed += 1
            self._end()

    def settle(self) -> None:
        count: int
        between, count = self._between, len(self._between)
        if self._told == count or between[self._told] > self._kernel.now:
            return
        recorder = self._wire.recorder
        outer, recorder.cause = recorder.cause, 0  # whoever looks is not why the line moved
        now = self._kernel.now if self._kernel._phase > self._phase else self._kernel.now - 1
        while self._told < count and between[self._told] <= now:
            tick: int = between[self._told]
            self._told += 1
            party: FrameParty
            for party in self._parties:
                party.hears(tick, self._told & 1)
        recorder.cause = outer

    def catch_up(self) -> None:
        sender = self._sender
        assert sender is not None
        self._end()
        if self._told & 1:
            self._wire.jump(0)
        sender.take_back(self._between[self._told :])

    def strangers(self) -> set[str]:
        """Who may pull the line and is none of those known."""
        return {who for who in self._wire.parties() if who.partition(".")[0] not in self._may_be}

    def _end(self) -> None:
        self.settle()
        self._sender = None
        self._shortcuts.end(self)
        party: FrameParty
        for party in self._parties:
            party.untold(None)

    def _look(self, mask: int) -> None:
        """Who is on the line now. mask: of the sender."""
        wire = self._wire
        self._version, self._mask = wire.version, mask
        found = [self._party(ear.agent) if isinstance(ear, Sampler) else None for ear in wire.ears()]
        self._parties = [party for party in found if party is not None]
        self._known = not wire.recorded and len(self._parties) == len(found) and not self.strangers()

    def _party(self, agent: Agent) -> FrameParty | None:
        return agent if isinstance(agent, FrameParty) else self._stand_in.get(agent)
