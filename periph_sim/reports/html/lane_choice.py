"""Which lanes an explanation is about: a Window with what its chain says goes in, yes or no for a lane comes out.

wires           named by the chain, or those of the bus that it tells of (SCL and SDA of an address, RX of a frame)
fields          those that the chain names or the measure is about
service routines, spans, waits      those within the picture
registers       accesses that the chain names
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property

from ...explain.picture import flags_shown
from ...explain.window import Window

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
        """Of I2C, also where nothing says what the occurrence is about."""
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
        """True if the picture has a part of what lasts from one tick to another."""
        return begin < self.window.drawn.end and end >= self.window.drawn.begin
