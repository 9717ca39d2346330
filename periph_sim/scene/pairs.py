"""The RS-485 pairs of a scene with their transceivers and notes, built from [[transceiver]] tables.

Equal notes are combined into one note, which has the time of the first occurrence and the number of occurrences.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial

from ..bus.uart.frame_format import UartFormat
from ..bus.uart.reader import Line
from ..bus.uart.rs485 import Rs485Pair, Transceiver
from ..core.phrases import counted
from .case.wiring import OnPair, on_pairs
from .context import SceneContext


class Pairs:
    """The RS-485 pairs of a scene.

    sci_line: a function that takes a unit and a module, and returns the line function of this SCI. A line function
        returns the bit length and the format with which a party sends now.
    outside: for each party that drives a pair, but is not an SCI, its line function.
    """

    def __init__(self, context: SceneContext, sci_line: Callable[[str, str], Line]) -> None:
        self.outside: dict[str, Line] = {}
        self._context = context
        self._pairs: dict[str, Rs485Pair] = {}
        self._transceivers: dict[tuple[str, str], Transceiver] = {}
        self._notes: dict[str, tuple[int, int]] = {}  # maps a text to its first tick and its number of occurrences
        for one in on_pairs(context.case):
            self._add(one, sci_line(one.sci.unit, one.sci.module))

    def of(self, unit: str, module: str) -> Transceiver | None:
        """Return the transceiver of an SCI; None if the SCI has none."""
        return self._transceivers.get((unit, module))

    def lines(self) -> Mapping[str, Line]:
        """Return a line function for each pair, by its name. A pair is one wire in the scene.

        The line function returns the bit length and the format of the party that drives the pair now; of several
        parties, the one that has driven it longest. If no party drives the pair, it returns those of the pair's first
        SCI.
        """
        return {name: partial(self._line, pair) for name, pair in self._pairs.items()}

    def notes(self) -> list[str]:
        notes = []
        for text, (first, times) in self._notes.items():
            at = self._context.timebase.show(first - self._context.start)
            notes.append(f"{text}, first at {at} ({counted(times, 'time')})")
        return notes

    def _add(self, one: OnPair, line: Line) -> None:
        context, table, sci = self._context, one.table, one.sci
        if table.pair not in self._pairs:
            pair = Rs485Pair(context.kernel, context.recorder, context.wire(table.pair))
            pair.on_collision.append(partial(self._collided, table.pair))
            self._pairs[table.pair] = pair
        who = f"transceiver of {sci.unit}.{sci.module}"
        tx, rx, de = (context.wire(name) for name in (sci.tx, sci.rx, one.de_wire))
        at_first = int(table.pull == "up")
        transceiver = Transceiver(self._pairs[table.pair], who, tx, rx, de, line, table.hears_itself, at_first)
        transceiver.on_cut.append(partial(self._cut, one))
        self._transceivers[sci.unit, sci.module] = transceiver

    def _line(self, pair: Rs485Pair) -> tuple[Fraction, UartFormat]:
        lines = {one.driver.who: one.line for one in self._transceivers.values() if one.pair is pair} | self.outside
        return lines[pair.on[0].who if pair.on else next(iter(lines))]()

    def _note(self, tick: int, text: str) -> None:
        first, times = self._notes.get(text, (tick, 0))
        self._notes[text] = (first, times + 1)

    def _collided(self, pair: str, tick: int, who: tuple[str, ...]) -> None:
        self._note(tick, f"{pair}: {' and '.join(who)} drive at once")

    def _cut(self, one: OnPair, tick: int, ticks: int) -> None:
        sci = f"{one.sci.unit}.{one.sci.module}"
        if not ticks:
            self._note(tick, f"{one.table.pair}: {sci} sends a frame while {one.de_wire} holds its driver off")
            return
        self._note(tick, f"{one.table.pair}: {one.de_wire} switches the driver of {sci} off before its frame is over")
