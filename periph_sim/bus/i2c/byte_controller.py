"""An I2C controller whose bytes may pass without edges: it asks before each, and goes on where the edges would end.

RELEASE --edge by edge--> BIT_END ...
   +----seven bits at once--> RELEASE of the eighth              WholeBytes
   +----EIGHTH --> NINTH --> next byte, STOP or START            ByteLevel
"""

# core: compiled

from __future__ import annotations

from .byte_level import ByteLevel
from .controller import NO_BYTE, RELEASE, STUCK, I2cController
from .edge_play import BITS
from .line_events import NOTHING, SCL, SDA
from .whole_bytes import ONES, WholeBytes

EIGHTH, NINTH = STUCK + 1, STUCK + 2


class ByteController(I2cController):
    """whole_bytes: what lets bytes pass. It is given before the first transfer."""

    __slots__ = ("_in_steps", "_steps", "whole_bytes")

    whole_bytes: WholeBytes
    _steps: ByteLevel | None
    _in_steps: bool

    def let_pass(self, whole_bytes: WholeBytes) -> None:
        """From now on it is asked about each byte."""
        self.whole_bytes = whole_bytes
        self._steps = whole_bytes if isinstance(whole_bytes, ByteLevel) else None
        self._in_steps = False  # behind a byte that went in steps: SDA follows without an edge

    def act(self, tag: int) -> None:
        if tag == EIGHTH:
            self._eighth_over()
        elif tag == NINTH:
            self._ninth_over()
        else:
            I2cController.act(self, tag)

    def _release(self) -> None:
        if self._index != NO_BYTE:
            if self._bit == 0:
                tag = RELEASE if self._steps is None else EIGHTH
                if self.whole_bytes.passes(self._low_time, self._high, self._hold, tag):
                    return
            elif self._bit == BITS:
                self.whole_bytes.over()
        I2cController._release(self)

    def _low(self, sda: int) -> None:
        if not self._in_steps:
            I2cController._low(self, sda)
            return
        assert self._steps is not None
        self._sda_level = sda
        self._steps.follows(sda)
        self._then(self._kernel.now + self._low_time, RELEASE)

    # As a party ------------------------------------------------------------------

    def pulls(self, line: int) -> int:
        return self._scl_mask if line == SCL else self._sda_mask

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        """Its filter sees each level of a bit; nothing else is under way."""
        return self._guard is None and self._filter <= min(high, hold, low - hold)

    def byte(self) -> int:
        return ONES if self._receiving else self._byte

    def goes_on(self, shown: int) -> bool:
        """Else it loses arbitration on the way."""
        return self._receiving or shown == self._byte

    def stand(self, shown: int, bit: int, fell: int) -> None:
        level = shown >> (BITS - bit) & 1
        self._bit, self._in = bit, shown >> (BITS + 1 - bit)
        self._sda_level = self.byte() >> (BITS - bit) & 1
        self._lines = SDA if level else 0
        self._sda_seen, self._sda_event, self._sda_moved = level, NOTHING, fell + self._hold
        self._scl_seen, self._scl_moved = SCL, fell
        if bit and self._index == 0:
            self._phase.answer_at = self._kernel.now

    def edge(self, tick: int, levels: int) -> None:
        moved = self._lines ^ levels
        if moved & SCL:
            self._scl_seen, self._scl_moved = self._lines & SCL, tick
        if moved & SDA:
            self._sda_seen, self._sda_moved, self._sda_event = levels >> 1, tick, NOTHING
        self._lines = levels

    # A byte in two steps ------------------------------------------------------------

    def _eighth_over(self) -> None:
        assert self._steps is not None
        own = self._ack_level() if self._receiving else 1
        shown = self._steps.eighth(own)
        self._bit, self._in, self._sda_level = BITS + 1, shown if shown >= 0 else -1 - shown, own
        if shown < 0:  # SCL is held: the rest goes by edges
            self._then(self._kernel.now + self._low_time, RELEASE)
        else:
            self._then(self._kernel.now + self._low_time + self._high, NINTH)

    def _ninth_over(self) -> None:
        assert self._steps is not None
        self._in_steps = True
        self._byte_end(self._steps.ninth() == 0)
        self._in_steps = False
