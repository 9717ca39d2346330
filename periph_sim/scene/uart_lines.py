"""Observers of UART lines: records of frames and of characters to SCIs.

A frame is read with the rate and format of its sender: those of the host, or the settings of the SCI whose TX is on the
wire. If no sender is known, it is read with the settings of the SCI whose RX is on the wire.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from fractions import Fraction
from functools import lru_cache, partial

from ..bus.uart.frame_format import UartFormat
from ..bus.uart.reader import Line, UartCounter, UartMonitor
from ..core.records import Kind, Recorder
from ..core.wire import Wire
from ..f28335.sci.register_map import SCI_MAP
from ..processor.dsp import Dsp
from ..traces.decode import uart_line
from .context import SceneContext

SCICCR = SCI_MAP["SCICCR"]


class UartLines:
    """Observers of the UART lines.

    senders: a dictionary from a wire to the rate and format of its sender, if the sender is not a unit.
    """

    def __init__(
        self,
        context: SceneContext,
        wires: Mapping[str, Wire],
        units: Mapping[str, Dsp],
        senders: Mapping[str, Line],
    ) -> None:
        self._wires = wires
        self._lines: dict[str, Line] = {}
        self._counters: dict[str, UartCounter] = {}
        self._heard = [sci.rx for sci in context.wiring.scis]
        for sci in context.wiring.scis:
            self._lines[sci.tx] = partial(sci_line, context, units[sci.unit], sci.module)
        for sci in context.wiring.scis:
            self._lines.setdefault(sci.rx, partial(sci_line, context, units[sci.unit], sci.module))
        self._lines |= senders
        for name, line in sorted(self._lines.items()):
            if context.recorder.wants(Kind.FRAME, name):
                UartMonitor(wires[name], line)

    def record_characters(self, recorder: Recorder) -> None:
        """Record the start bit of each character that SCIs receive, once for each receiving SCI.

        The record is made when the next character begins or the run ends, because `UartCounter` detects it then.
        """
        for name in self._heard:
            self._counter(name).topics.append(recorder.topic(Kind.RECEIVER, name, "character"))

    def on_character_from(self, wires: Collection[str], callback: Callable[[str, int], None]) -> None:
        """Call `callback(wire, tick)` for each character on each of these wires that leads to an SCI."""
        for name in dict.fromkeys(self._heard):
            if name in wires:
                self._counter(name).on_character.append(partial(callback, name))

    def _counter(self, name: str) -> UartCounter:
        if name not in self._counters:
            self._counters[name] = UartCounter(self._wires[name], self._lines[name])
        return self._counters[name]

    def finish(self, now: int) -> None:
        """Detect the last characters at tick `now`, the end of the run."""
        for counter in self._counters.values():
            counter.finish(now)


def sci_line(context: SceneContext, dsp: Dsp, module: str) -> tuple[Fraction, UartFormat]:
    """Return the bit length, in ticks, and the frame format that an SCI's present settings give."""
    return _ticks_and_format(context.timebase.per_second, *_settings(dsp, module))


def line_of(dsp: Dsp, module: str = "SCI-A") -> uart_line.Line:
    """Return the rate and the format that an SCI's present settings give."""
    return _line(*_settings(dsp, module))


def _settings(dsp: Dsp, module: str) -> tuple[int, int, Fraction, int]:
    """Return (SCICCR, SCIHBAUD and SCILBAUD as one number, SYSCLKOUT in Hz, divider of LSPCLK).

    The registers are read at cycle 0. This is correct, since only writes change them. A read at the present cycle would
    advance the chip before its turn in this tick, and subscribers to its flags would not be notified.
    """
    chip = dsp.sockets[module].chip
    ccr = chip.peek(0, SCICCR.offset)
    brr = chip.peek(0, SCI_MAP["SCIHBAUD"].offset) << 8 | chip.peek(0, SCI_MAP["SCILBAUD"].offset)
    return ccr, brr, dsp.control.sysclk_hz, dsp.control.lspclk_divider


# Cached, because it is called for each frame of each line, and settings hardly ever change.
@lru_cache(64)
def _ticks_and_format(
    per_second: int, ccr: int, brr: int, sysclk_hz: Fraction, divider: int
) -> tuple[Fraction, UartFormat]:
    line = _line(ccr, brr, sysclk_hz, divider)
    form = UartFormat(line.bits, line.parity, int(line.stop), bool(SCICCR["ADDRIDLE_MODE"].extract(ccr)))
    return per_second / Fraction(line.baud), form


def _line(ccr: int, brr: int, sysclk_hz: Fraction, divider: int) -> uart_line.Line:
    parity = "none"
    if SCICCR["PARITYENA"].extract(ccr):
        parity = "even" if SCICCR["PARITY"].extract(ccr) else "odd"
    bits, stop = SCICCR["SCICHAR"].extract(ccr) + 1, SCICCR["STOPBITS"].extract(ccr) + 1
    return uart_line.Line(sysclk_hz / divider / (8 * (brr + 1) if brr else 16), bits, parity, stop)
