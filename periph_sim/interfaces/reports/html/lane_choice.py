"""Choose the lanes that an explanation is about.

wires           named by the chain, or of the bus it mentions (SCL and SDA for an address, RX for a frame)
fields          those named by the chain or measured
service routines, spans, waits      those within the picture
registers       accesses that the chain names
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property

from ..explain.picture import flags_shown
from ..explain.window import Window

BUS = re.compile(r"\b(SCL|SDA|START|STOP|N?ACK|acknowledged|transfer|byte \d+)\b")
SERIAL = re.compile(r"\b(RX|TX|SCI\w*|frames?|host|FIFO)\b")


@dataclass(frozen=True, eq=False)
class LaneChoice:
    window: Window

    @cached_property
    def _text(self) -> str:
        return "\n".join((self.window.verdict.measure, *self.window.chain_texts))

    @cached_property
    def _flags(self) -> set[tuple[str, str]]:
        return set(flags_shown(self.window))

    @cached_property
    def bus(self) -> bool:
        """True if the occurrence is about the I2C bus, or if nothing shows what it is about."""
        return bool(BUS.search(self._text)) or not (self.serial or self.window.chain_texts)

    @cached_property
    def serial(self) -> bool:
        return bool(SERIAL.search(self._text))

    def names(self, word: str) -> bool:
        """True if the measure or the chain names a pin, or a register without a field."""
        return bool(re.search(rf"\b{re.escape(word)}\b(?!\.)", self._text))

    def flag(self, where: str, what: str) -> bool:
        return (where, what) in self._flags

    def within(self, begin: int, end: int) -> bool:
        """True if a range of ticks overlaps the picture."""
        return begin < self.window.drawn.end and end >= self.window.drawn.begin
