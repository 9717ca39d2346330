"""Who listens to RX and TX: a scene's wires go in; frames are recorded where wanted, characters on RX counted.

A frame is read as its sender sends it: on RX with the host's bit rate, where there is a host; else as SCI-A is set.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

from ..bus.uart.monitor import Line, UartMonitor
from ..bus.uart.sender import UartFormat
from ..bus.uart_counter import UartCounter
from ..core.records import Kind
from ..core.wire import Wire
from ..f28335.sci.register_map import SCI_MAP
from ..processor.dsp import Dsp
from ..traces.decode import uart_format as uart_line
from .context import SceneContext

SCICCR = SCI_MAP["SCICCR"]
LINES = ("RX", "TX")


class UartLines:
    """host_bit: ticks of a bit that the host sends; None without a host."""

    def __init__(
        self, context: SceneContext, wires: Mapping[str, Wire], units: Mapping[str, Dsp], host_bit: Fraction | None
    ) -> None:
        self._context, self._wires = context, wires
        self._sci = next((dsp for dsp in units.values() if dsp.has("SCI-A")), None)
        self._host_bit = host_bit
        self._counter: UartCounter | None = None
        for name in LINES:
            line = self._line(name)
            if line is not None and context.recorder.wants(Kind.FRAME, name):
                UartMonitor(context.kernel, context.recorder, wires[name], line)

    def on_character(self, told: Callable[[int], None]) -> None:
        """`told(tick)` of each character on RX, as `UartCounter` does."""
        line = self._line("RX")
        if line is None:
            return
        if self._counter is None:
            self._counter = UartCounter(self._wires["RX"], line)
        self._counter.told.append(told)

    def finish(self, now: int) -> None:
        """The run is over."""
        if self._counter is not None:
            self._counter.finish(now)

    def _line(self, name: str) -> Line | None:
        """How a wire's sender sends; None where the scene has no such wire, or nobody knows."""
        if name not in self._wires:
            return None
        if name == "RX" and self._host_bit is not None:
            bit = self._host_bit
            return lambda: (bit, UartFormat())
        return None if self._sci is None else self._sci_line

    def _sci_line(self) -> tuple[Fraction, UartFormat]:
        assert self._sci is not None
        line = line_of(self._sci, self._context.kernel.now)
        return self._context.timebase.per_second / Fraction(line.baud), UartFormat(
            line.bits, line.parity, int(line.stop)
        )


def line_of(dsp: Dsp, now: int) -> uart_line.Line:
    """The rate and format that a unit's SCI-A is set to."""
    socket, cycle = dsp.socket("SCI-A"), dsp.clock.cycle_at(now)
    ccr = socket.peek(cycle, SCICCR.offset)
    brr = socket.peek(cycle, SCI_MAP["SCIHBAUD"].offset) << 8 | socket.peek(cycle, SCI_MAP["SCILBAUD"].offset)
    lspclk = dsp.control.sysclk_hz / dsp.control.lspclk_divider
    parity = "none"
    if SCICCR["PARITYENA"].of(ccr):
        parity = "even" if SCICCR["PARITY"].of(ccr) else "odd"
    bits, stop = SCICCR["SCICHAR"].of(ccr) + 1, SCICCR["STOPBITS"].of(ccr) + 1
    return uart_line.Line(lspclk / (8 * (brr + 1) if brr else 16), bits, parity, stop)
