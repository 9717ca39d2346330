"""The level "byte" of a bus: a byte that the controller begins goes in; what its edges would do comes out in two steps.

    SCL  _|~|_|~|_ ... _|~|_|~|_
          1   2         8  ^9  ^
                     eighth    ninth

The steps are where the eighth bit is over, and where the ACK's clock is. START and STOP are edges as ever, and so is a
byte for which a slave holds SCL. Seven bits pass as in `whole_bytes`, but nothing is played again: what meddles in the
middle of a byte finds it as it was at the last step. The edges that end it are given to each module with the cycles in
which it would sample them; their effects can be seen from the step on, so by up to the noise filter's width early, and
what comes with SCL's ninth rise, such as NACK, when that clock is over.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Mapping

from ...core.kernel import Agent, Kernel
from ...core.time import NO_TIME
from ...core.wire import Wire
from .edge_play import BITS
from .line_events import SCL, SDA
from .whole_bytes import ByteParty, WholeBytes


class ByteLevel(WholeBytes):
    """passed: bytes that went in two steps."""

    __slots__ = ("_acks",)

    def __init__(
        self, kernel: Kernel, scl: Wire, sda: Wire, controller: ByteParty | None, stand_in: Mapping[Agent, ByteParty]
    ) -> None:
        super().__init__(kernel, scl, sda, controller, stand_in)
        self._acks = 1

    def _takes(self, party: ByteParty) -> bool:
        return party.steps()

    def passes(self, low: int, high: int, hold: int, tag: int) -> bool:
        """Whether the byte goes in steps; the controller acts on `tag` as the eighth bit is over."""
        controller = self._controller
        assert controller is not None
        shown = self._showing(controller, low, high, hold, False)
        if shown < 0:
            return False
        now = self._kernel.now
        self._since, self._shown = now, shown
        times = self._steady
        times.since, times.low, times.high = now, low, high
        self._stand(BITS, now + BITS * (low + high) - low)
        self._kernel.ask(now + BITS * (low + high) + high, controller, tag)
        return True

    def eighth(self, ack: int) -> int:
        """The eighth bit is over: what it showed as a byte, or -1 - that where a module holds SCL now.

        ack: what the controller puts on SDA for the ninth.
        """
        now, shown, last, high = self._kernel.now, self._shown, self._sda.pulling, self._steady.high
        assert self._controller is not None
        party: ByteParty
        for party in self._parties:
            party.heard(shown, self._steady)
        self._edge(now - high, 0, last)
        clock = self._controller.pulls(SCL)
        self._edge(now, clock, last)
        self._acks = ack
        self._edge(now, clock, self._sda_pulls(ack))
        self._since = NO_TIME
        for party in self._parties:
            if party.holds():
                return -1 - shown
        return shown

    def ninth(self) -> int:
        """The ACK's clock is over: its level."""
        assert self._controller is not None
        now, clock, pulls = self._kernel.now, self._controller.pulls(SCL), self._sda_pulls(self._acks)
        self._edge(now - self._steady.high, 0, pulls)
        self._edge(now, clock, pulls)
        self.passed += 1
        return 0 if pulls else 1

    def follows(self, level: int) -> None:
        """SDA, behind the fall of SCL that ends a byte. level: what the controller puts on it."""
        assert self._controller is not None
        self._edge(self._kernel.now, self._controller.pulls(SCL), self._sda_pulls(level))

    def _sda_pulls(self, controller: int) -> int:
        """Who pulls SDA. controller: the level it puts there."""
        assert self._controller is not None
        pulling: int = 0 if controller else self._controller.pulls(SDA)
        party: ByteParty
        for party in self._parties:
            if party.pulls_sda():
                pulling |= party.pulls(SDA)
        return pulling

    def _edge(self, tick: int, scl: int, sda: int) -> None:
        """The lines are pulled so from `tick` on, and each party hears of it."""
        self._scl.jump(scl)
        self._sda.jump(sda)
        levels: int = (0 if scl else SCL) | (0 if sda else SDA)
        party: ByteParty
        for party in self._parties:
            party.edge(tick, levels)
