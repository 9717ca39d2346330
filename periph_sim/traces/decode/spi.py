"""SPI decoder: from a clock, one or two data lines and an optional chip select to words and edges of the chip select.

The decoder is a test oracle, so it shares no code with the SPI model.

    CS   ---________________---
    CLK  _____--__--__--_______      polarity 0, phase 0, three bits: 1 0 1 on MOSI
    MOSI ____----____----______
              |       |
              at      end

Rules:
- A bit is the level of a data line in the sample of a latching edge of the clock. Rising edges latch if polarity and
  phase are equal, otherwise falling edges. If a data line or CS changes in the same sample, its new level counts.
- A word begins at the first latching edge after the previous word. Without a chip select, the first word begins at the
  first latching edge of the capture. The first latching edge after a span in which the level of a line is unknown
  begins a word, too.
- With a chip select, latching edges are ignored while the chip select is inactive. A change of the chip select, the end
  of the capture or an unknown level ends a word; the bits of an incomplete word are an event "cut". If the chip select
  is active from the beginning, the first word begins at the first latching edge.

Polarity and phase are usually called CPOL and CPHA. TI's CLK_PHASE is the opposite of CPHA.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from msgspec import Struct

from ..capture.capture import Capture, Channel, Positions


class SpiFormat(Struct, frozen=True):
    """Format of the words and meaning of the clock's edges.

    bits: the number of bits of a word.
    polarity: the level of the clock between words (CPOL).
    phase: CPHA: 0 if data is latched at the first edge of a clock pulse, which leaves the level `polarity`; 1 if at the
        second edge, which returns to this level.
    lsb_first: True if the least significant bit comes first.
    active_high: True if the chip select is active at 1.
    """

    bits: int = 8
    polarity: int = 0
    phase: int = 0
    lsb_first: bool = False
    active_high: bool = False

    def __post_init__(self) -> None:
        if not 1 <= self.bits <= 64:
            raise ValueError(f"{self.bits} bits of a word; expected 1 to 64")
        for name, value in (("polarity", self.polarity), ("phase", self.phase)):
            if value not in (0, 1):
                raise ValueError(f"{name} is {value}; expected 0 or 1")


class Event(NamedTuple):
    """An event on the bus.

    kind: "select" or "deselect" if the chip select became active or inactive; "word"; "cut" for an incomplete word.
    at, end: the first and the last latching edge of a word. For "select" and "deselect", both are the edge of the chip
        select.
    mosi, miso: the word on the line. For "cut", the received bits with the last bit least significant. None for
        "select" and "deselect", and if the line is not used.
    bits: the number of received bits.
    """

    kind: str
    at: int
    end: int
    mosi: int | None = None
    miso: int | None = None
    bits: int = 0


def events(
    capture: Capture,
    format_: SpiFormat,
    clk: str | int = "CLK",
    mosi: str | int | None = "MOSI",
    miso: str | int | None = "MISO",
    cs: str | int | None = "CS",
    glitch: int = 0,
) -> list[Event]:
    """Decode all events of a capture, in the order in which they begin.

    clk, mosi, miso, cs: the channels; None for a line that is not used.
    glitch: pulses of any line that are shorter than this number of positions are removed first.

    Raise LookupError if a channel is missing or ambiguous, and ValueError if there is no data line.
    """
    if mosi is None and miso is None:
        raise ValueError("no data line; expected mosi, miso or both")
    lines = [None if name is None else capture.channel(name) for name in (clk, mosi, miso, cs)]
    found: list[Event] = []
    for span in capture.known(*(line for line in lines if line is not None)):
        clock, *others = (None if line is None else line.cut(span).without_glitches(glitch) for line in lines)
        assert clock is not None
        found += _events(format_, clock, *others)
    return found


def _events(
    format_: SpiFormat, clk: Channel, mosi: Channel | None, miso: Channel | None, cs: Channel | None
) -> list[Event]:
    """Decode the events of a span in which all lines are known."""
    latches = clk.edges[clk.levels == int(format_.polarity == format_.phase)]
    found: list[Event] = []
    if cs is None:
        runs = [latches]
    else:
        latches = latches[cs.at(latches) == format_.active_high]
        runs = np.split(latches, np.searchsorted(latches, cs.edges))
        for at, level in zip(cs.edges.tolist(), cs.levels.tolist(), strict=True):
            found.append(Event("select" if level == format_.active_high else "deselect", at, at))
    for run in runs:
        found += _words(format_, run, mosi, miso)
    return sorted(found, key=lambda event: event.at)


def _words(format_: SpiFormat, latches: Positions, mosi: Channel | None, miso: Channel | None) -> list[Event]:
    """Decode words from latching edges between which the chip select does not change."""
    streams = [None if line is None else line.at(latches).tolist() for line in (mosi, miso)]
    found: list[Event] = []
    for begin in range(0, len(latches), format_.bits):
        edges = latches[begin : begin + format_.bits]
        out, back = (None if bits is None else _number(format_, bits[begin : begin + format_.bits]) for bits in streams)
        kind = "word" if len(edges) == format_.bits else "cut"
        found.append(Event(kind, int(edges[0]), int(edges[-1]), out, back, len(edges)))
    return found


def _number(format_: SpiFormat, bits: list[int]) -> int:
    whole = len(bits) == format_.bits
    return int("".join(map(str, reversed(bits) if whole and format_.lsb_first else bits)), 2)
