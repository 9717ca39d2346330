"""Serial lines of a scene: outside parties, pairs, and records of receivers and lines.

[host], [serial] --> RX, or a pair --transceiver--> RX --> SCI --> SciMonitor: records of its receiver
TX of an SCI, pairs --> UartLines: frames, characters
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial
from typing import TYPE_CHECKING, cast

from .context import SceneContext

if TYPE_CHECKING:
    from ..core.wire import Wire
    from ..f28335.sci.module import Sci
    from ..processor.dsp import Dsp
    from ..timing.measures.measure import MeasuredScene
    from .host import HostAgent
    from .pairs import Pairs
    from .serial.side import SerialSide
    from .uart_lines import UartLines


class UartSide:
    """The serial lines of a scene. host: the host on RX, or None. serial: the parties in the table [serial]."""

    def __init__(
        self,
        context: SceneContext,
        wires: Mapping[str, Wire],
        units: Mapping[str, Dsp],
        host: HostAgent | None,
        serial: SerialSide | None,
        events: MeasuredScene,
    ) -> None:
        self._units = units
        self._serial = serial
        self._scis = context.wiring.scis
        self.has_sci = bool(self._scis)
        self._recorder = context.recorder
        self._pairs: Pairs | None = None
        self._lines: UartLines | None = None
        self._counted: dict[str, int] = {}  # from a wire to the number of characters that came from outside
        self._sent: dict[str, int] = {}
        senders = {} if host is None else {"RX": host.line}
        if serial is not None or context.case.transceiver:
            self._pairs = self._pairs_of(context)
        if serial is not None and self._pairs is not None:
            serial.attach(context, self._pairs)
            serial.listen(events)
            senders |= serial.lines()
        if self._pairs is not None:
            senders |= self._pairs.lines()
        if self._scis or senders:
            from .uart_lines import UartLines

            self._lines = UartLines(context, wires, units, senders)

    def _pairs_of(self, context: SceneContext) -> Pairs:
        from .pairs import Pairs
        from .uart_lines import sci_line

        return Pairs(context, lambda unit, module: partial(sci_line, context, self._units[unit], module))

    @property
    def characters(self) -> int:
        """The number of characters that the parties in the table [serial] and the outside party have sent."""
        counted = sum(count for wire, count in self._counted.items() if wire not in self._sent)
        return counted + sum(self._sent.values()) + (0 if self._serial is None else self._serial.characters)

    def count(self, wires: Collection[str]) -> None:
        """Count the characters on each of these wires that leads to an SCI. The outside party drives these wires."""
        if self._lines is not None:
            self._lines.on_character_from(wires, self._came)

    def sent(self, wire: str, count: int) -> None:
        """Add characters that the outside party has sent on a wire as bytes.

        The characters that `count` finds on this wire are ignored, so that none is counted twice.
        """
        self._sent[wire] = self._sent.get(wire, 0) + count

    def _came(self, wire: str, tick: int) -> None:
        self._counted[wire] = self._counted.get(wire, 0) + 1

    def sent_by_units(self) -> int:
        """Return the number of characters that the SCIs of units have sent."""
        return sum(cast("Sci", self._units[sci.unit].sockets[sci.module].chip).frames_sent for sci in self._scis)

    def notes(self) -> list[str]:
        """Return notes on errors on RS-485 pairs, and on sends that never began."""
        told = [] if self._pairs is None else self._pairs.notes()
        return told + ([] if self._serial is None else self._serial.notes())

    def finish(self, now: int) -> None:
        """Complete the counts of characters at tick `now`, the end of the run."""
        if self._lines is not None:
            self._lines.finish(now)

    def record_receivers(self) -> None:
        """Start recording the waiting words and losses of SCIs' receivers, and the characters that SCIs receive."""
        from .sci_monitor import SciMonitor

        for sci in self._scis:
            SciMonitor(self._units[sci.unit], sci.module, self._recorder)
        if self._lines is not None:
            self._lines.record_characters(self._recorder)
