"""Serial lines of a scene: the parties of [serial], RS-485 pairs, and records of receivers and lines.

    [host] or [serial] -----------------------> RX --> SCI --> TX
    [serial] --> RS-485 pair --transceiver----> RX --> SCI --> TX --transceiver--> RS-485 pair

    SciMonitor    makes the records of an SCI's receiver
    UartMonitor   makes the FRAME records of a line: an RX, a TX or a pair
    UartCounter   reports the characters on the RX of an SCI

A frame, which is one UART character here, is read with the rate and format of its sender. These are the settings in
[host] or [serial], or the register settings of the SCI whose TX is on the wire. If no sender is known, as behind a
transceiver, a frame is read with the register settings of the SCI whose RX is on the wire.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, cast

from ..core.records import Kind
from .context import SceneContext

if TYPE_CHECKING:
    from ..bus.uart.frame_format import UartFormat
    from ..bus.uart.reader import Line, UartCounter
    from ..core.wire import Wire
    from ..f28335.sci.module import Sci
    from ..processor.dsp import Dsp
    from ..timing.measures.measure import MeasuredScene
    from .host import HostAgent
    from .pairs import Pairs
    from .serial.side import SerialSide


LARGEST_DIFFERENCE = Fraction(1, 20)  # maximum relative difference of two rates; above it, a stop bit can be missed


class UartSide:
    """The serial lines of a scene.

    has_sci: True if a unit has an SCI.
    """

    def __init__(
        self,
        context: SceneContext,
        wires: Mapping[str, Wire],
        units: Mapping[str, Dsp],
        host: HostAgent | None,
        serial: SerialSide | None,
        measured: MeasuredScene | None,
    ) -> None:
        """host: the host on RX; None if there is none.

        serial: the parties of the table [serial]; None if there is none.
        measured: the scene as measures see it, to which the events that trigger sends of [serial] subscribe.
        """
        self._units = units
        self._serial = serial
        self._scis = context.wiring.scis
        self.has_sci = bool(self._scis)
        self._recorder = context.recorder
        self._per_second = context.timebase.per_second
        self._wires = wires
        self._pairs: Pairs | None = None
        self._lines: dict[str, Line] = {}  # maps a wire to the function that returns its rate and format
        # `_own` maps (unit, module) to the function that returns the rate and format that this SCI is set to.
        self._own: Mapping[tuple[str, str], Line] = {}
        self._counters: dict[str, UartCounter] = {}
        self._counted: dict[str, int] = {}  # maps a wire to the number of characters decoded from its levels
        self._sent: dict[str, int] = {}
        if self._scis:
            from .uart_lines import sci_line

            lines = {
                (sci.unit, sci.module): partial(sci_line, context, units[sci.unit], sci.module) for sci in self._scis
            }
            self._lines = {sci.rx: lines[sci.unit, sci.module] for sci in reversed(self._scis)}
            self._lines |= {sci.tx: lines[sci.unit, sci.module] for sci in self._scis}
            self._own = lines
        if host is not None:
            self._lines["RX"] = host.line
        if serial is not None or context.case.transceiver:
            from .pairs import Pairs

            self._pairs = Pairs(context, lambda unit, module: lines[unit, module])
        if serial is not None and self._pairs is not None and measured is not None:
            serial.attach(context, self._pairs)
            serial.listen(measured)
            self._lines |= serial.lines()
        if self._pairs is not None:
            self._lines |= self._pairs.lines()
        for name, line in sorted(self._lines.items()):
            if context.recorder.wants(Kind.FRAME, name):
                from ..bus.uart.reader import UartMonitor

                UartMonitor(wires[name], line)

    def formats(self) -> dict[str, tuple[Fraction, UartFormat]]:
        """Return the present bit length, in ticks, and frame format of each line."""
        return {name: line() for name, line in self._lines.items()}

    @property
    def characters(self) -> int:
        """The number of characters that the parties in the table [serial] and the outside party have sent."""
        counted = sum(count for wire, count in self._counted.items() if wire not in self._sent)
        return counted + sum(self._sent.values()) + (0 if self._serial is None else self._serial.characters)

    def count(self, wires: Collection[str]) -> None:
        """Start to decode and count the characters that the outside party sends to SCIs.

        wires: the wires that the outside party drives. Wires that are not at the RX of an SCI are ignored.
        """
        for name in dict.fromkeys(sci.rx for sci in self._scis if sci.rx in wires):
            self._counter(name).on_character.append(partial(self._came, name))

    def _counter(self, name: str) -> UartCounter:
        from ..bus.uart.reader import UartCounter

        if name not in self._counters:
            self._counters[name] = UartCounter(self._wires[name], self._lines[name])
        return self._counters[name]

    def sent(self, wire: str, count: int) -> None:
        """Add `count` characters that the outside party sends on a wire as bytes, and not as levels.

        From then on, `characters` does not include the characters decoded from the levels of this wire, so that no
        character counts twice.
        """
        self._sent[wire] = self._sent.get(wire, 0) + count

    def _came(self, wire: str, tick: int) -> None:
        self._counted[wire] = self._counted.get(wire, 0) + 1

    def sent_by_units(self) -> int:
        """Return the number of characters that the SCIs of units have sent."""
        return sum(chip.frames_sent for chip in self._chips())

    def errors(self) -> dict[str, int]:
        """Return, for each kind of error, the number of characters that SCIs received with it; {} without an SCI."""
        if not self._scis:
            return {}
        chips = self._chips()
        return {
            "framing error": sum(chip.framing_errors for chip in chips),
            "parity error": sum(chip.parity_errors for chip in chips),
        }

    def _chips(self) -> list[Sci]:
        return [cast("Sci", self._units[sci.unit].sockets[sci.module].chip) for sci in self._scis]

    def notes(self) -> list[str]:
        """Return notes on unequal rates, on errors on RS-485 pairs, and on sends and replies of [serial]."""
        notes = [] if self._pairs is None else self._pairs.notes()
        for sci in self._scis:
            from .uart_lines import rate_register

            (sent, _), (own, _) = self._lines[sci.rx](), self._own[sci.unit, sci.module]()
            if abs(own / sent - 1) > LARGEST_DIFFERENCE and rate_register(self._units[sci.unit], sci.module):
                rates = [float(self._per_second / bit) for bit in (sent, own)]
                notes.append(
                    f"{sci.unit} {sci.module}: characters on {sci.rx} come at {rates[0]:.0f} baud, but SCIHBAUD, "
                    f"SCILBAUD and LSPCLK give {rates[1]:.0f}; correct the registers, or the baud of the sender"
                )
        return notes + ([] if self._serial is None else self._serial.notes())

    def finish(self, now: int) -> None:
        """Let the counters report the last characters. now: the tick at which the run ends."""
        for counter in self._counters.values():
            counter.finish(now)

    def record_receivers(self) -> None:
        """Start recording the waiting words and losses of SCIs' receivers, and the characters on their RX lines.

        A character makes one record for each SCI on its line. The tick of the record is that of the start bit, but the
        record is made only when the next character begins, or at the end of the run if the character is complete then,
        because `UartCounter` reports the character then.
        """
        from .sci_monitor import SciMonitor

        for sci in self._scis:
            SciMonitor(self._units[sci.unit], sci.module, self._recorder)
        for sci in self._scis:
            self._counter(sci.rx).topics.append(self._recorder.topic(Kind.RECEIVER, sci.rx, "character"))
