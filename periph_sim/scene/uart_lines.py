"""The bit length and the frame format on an SCI's line, computed from the present settings of the SCI."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from ..bus.uart.frame_format import UartFormat
from ..f28335.sci.register_map import SCI_MAP
from ..processor.dsp import Dsp
from ..traces.decode import uart_line
from .context import SceneContext

SCICCR = SCI_MAP["SCICCR"]


def sci_line(context: SceneContext, dsp: Dsp, module: str) -> tuple[Fraction, UartFormat]:
    """Return the bit length, in ticks, and the frame format that an SCI's present settings give."""
    return _ticks_and_format(context.timebase.per_second, *_settings(dsp, module))


def line_of(dsp: Dsp, module: str = "SCI-A") -> uart_line.Line:
    """Return the rate and the format that an SCI's present settings give."""
    return _line(*_settings(dsp, module))


def _settings(dsp: Dsp, module: str) -> tuple[int, int, Fraction, int]:
    """Return (SCICCR, SCIHBAUD and SCILBAUD as one number, SYSCLKOUT in Hz, divider of LSPCLK).

    The registers are read at cycle 0. This is correct, since only writes and resets change them. A read at the present
    cycle would advance the state of the chip before its own event in this tick, so that subscribers to its flags would
    not be notified.
    """
    chip = dsp.sockets[module].chip
    ccr = chip.peek(0, SCICCR.offset)
    return ccr, rate_register(dsp, module), dsp.control.sysclk_hz, dsp.control.lspclk_divider


def rate_register(dsp: Dsp, module: str) -> int:
    """Return SCIHBAUD and SCILBAUD as one number."""
    chip = dsp.sockets[module].chip
    return chip.peek(0, SCI_MAP["SCIHBAUD"].offset) << 8 | chip.peek(0, SCI_MAP["SCILBAUD"].offset)


# The result is cached, because the function is called for each frame on each line and settings hardly ever change.
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
