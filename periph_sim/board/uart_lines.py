"""Who listens to RX and TX where frames are recorded: a scene's wires go in, a UartMonitor for each comes out.

A frame is read as its sender sends it: on RX with the host's bit rate, where there is a host; else as SCI-A is set.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ..core.records import Kind
from ..core.wire import Wire
from ..decode.uart_line import Line
from ..f28335.sci_map import SCI_MAP
from ..lines.uart_monitor import UartMonitor
from ..lines.uart_peer import UartFormat
from .dsp import Dsp
from .site import Site

SCICCR = SCI_MAP["SCICCR"]
LINES = ("RX", "TX")


def listen_to_frames(
    site: Site, wires: Mapping[str, Wire], units: Mapping[str, Dsp], host_bit: Fraction | None
) -> None:
    """host_bit: ticks of a bit that the host sends; None without a host."""
    sci = next((dsp for dsp in units.values() if dsp.has("SCI-A")), None)

    def host_line() -> tuple[Fraction, UartFormat]:
        assert host_bit is not None
        return host_bit, UartFormat()

    def sci_line() -> tuple[Fraction, UartFormat]:
        assert sci is not None
        line = line_of(sci, site.kernel.now)
        return site.timebase.per_second / Fraction(line.baud), UartFormat(line.bits, line.parity, int(line.stop))

    for name in LINES:
        by_host = name == "RX" and host_bit is not None
        if name in wires and site.recorder.wants(Kind.FRAME, name) and (by_host or sci is not None):
            UartMonitor(site.kernel, site.recorder, wires[name], host_line if by_host else sci_line)


def line_of(dsp: Dsp, now: int) -> Line:
    """The rate and format that a unit's SCI-A is set to."""
    socket, cycle = dsp.socket("SCI-A"), dsp.clock.cycle_at(now)
    ccr = socket.peek(cycle, SCICCR.offset)
    brr = socket.peek(cycle, SCI_MAP["SCIHBAUD"].offset) << 8 | socket.peek(cycle, SCI_MAP["SCILBAUD"].offset)
    lspclk = dsp.control.sysclk_hz / dsp.control.lspclk_divider
    parity = "none"
    if SCICCR["PARITYENA"].of(ccr):
        parity = "even" if SCICCR["PARITY"].of(ccr) else "odd"
    bits, stop = SCICCR["SCICHAR"].of(ccr) + 1, SCICCR["STOPBITS"].of(ccr) + 1
    return Line(lspclk / (8 * (brr + 1) if brr else 16), bits, parity, stop)
