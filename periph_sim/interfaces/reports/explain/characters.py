"""Characters on serial lines around an occurrence, divided into their bits.

FRAME records, formats of the lines --> when a character begins and ends, and each of its bits
edges ------------------------------> the levels of its data bits

S 1 0 0 0 0 0 1 0 P T       start bit, data bits from the least significant one, parity bit, stop bit
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ....core.records import Kind
from .window import Window

Bit = tuple[int, int, str]  # the start and end in ticks and the text of one bit, or of all data bits together


class Character(NamedTuple):
    """A character on a serial line. Times are ticks.

    error: True if its parity or a stop bit is wrong.
    expected: the expected value; None if the value is right or nothing is expected.
    bits: all bits: "S" for the start bit, "0" or "1" for a data bit, "A" for the address bit, "P" for the parity bit,
        "T" for a stop bit; empty if the format of the line is unknown.
    """

    wire: str
    begin: int
    end: int
    value: int
    error: bool
    expected: int | None
    bits: tuple[Bit, ...]

    @property
    def text(self) -> str:
        """The value and, if it is wrong, the expected value: "0x45", "0x45 not 0x4F"."""
        return f"0x{self.value:02X}{'' if self.expected is None else f' not 0x{self.expected:02X}'}"

    def parts(self) -> Iterator[Bit]:
        """Yield the start bit, all data bits together, and each following bit. Without bits, yield the character."""
        data = [bit for bit in self.bits if bit[2].isdecimal()]
        if not data:
            yield self.begin, self.end, self.text
            return
        yield self.bits[0]
        yield data[0][0], data[-1][1], self.text
        yield from self.bits[1 + len(data) :]


def characters(window: Window) -> list[Character]:
    """Return the complete characters on all serial lines, in the order in which they end."""
    found = []
    begun: dict[str, int] = {}
    for record in window.records:
        wire = record.where
        if record.kind is Kind.FRAME and record.what == "begin":
            begun[wire] = record.tick
        elif record.kind is Kind.FRAME and record.what in ("end", "error") and wire in begun:
            begin = begun.pop(wire)
            expected = window.expected.get((wire, begin, 0))
            bits = _bits(window, wire, begin, record.tick)
            found.append(Character(wire, begin, record.tick, record.value, record.what == "error", expected, bits))
    return found


def _bits(window: Window, wire: str, begin: int, end: int) -> tuple[Bit, ...]:
    """Return the bits of a character; () if the format of the line is unknown or gives a character another length."""
    if wire not in window.formats:
        return ()
    bit, form = window.formats[wire]
    halves = form.half_bits(bit)
    if abs(begin + halves[-1] - end) > bit / 2 + 1:
        return ()
    texts = "S" + "D" * form.bits + "A" * form.address + "P" * (form.parity != "none") + "T" * form.stop
    levels = window.edges.channel(wire).at(begin + np.array(halves[1::2]))
    return tuple(
        (begin + halves[2 * n], begin + halves[2 * n + 2], f"{level}" if text == "D" else text)
        for n, (text, level) in enumerate(zip(texts, levels.tolist(), strict=True))
    )
