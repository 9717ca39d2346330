"""Extremes of the baud rate: the largest error of a sender's rate at which an SCI receives 12 bytes in a row.

The receiver samples at eight times its own rate and counts from the first low sample of each start bit, which is up to
one sample late. Two of the three votes of the stop bit, samples 4 to 6 of 8, must see it: for a fast sender the first
two, before the next start bit, for a slow one the last two, after the last data bit. With a bit of b samples,

    fast   10 b >= 72 + 5        slow   9 b <= 72 + 4

Source: TI SPRUFZ5A section 1.2.7, figure 1-7.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ...bus.uart.sender import UartSender
from ...core.kernel import Kernel
from ...core.records import Recorder
from ...core.socket import Socket
from ...core.time import Clock, Timebase
from ...core.wire import Wire
from ...f28335.sci.module import Sci
from ...f28335.sci.register_map import SCI_MAP
from .finding import EVERY, Finding

SYSCLK = 150_000_000
BRR = 40  # 114 329 bit/s
SAMPLE = 4 * (BRR + 1)  # SYSCLKOUT cycles, with LSPCLK = SYSCLKOUT / 4
NOMINAL = 8  # samples a bit
PHASES = 16  # of a sample, at which the first start bit begins
BYTES = b"\x55\x00\x7f" * 4  # 12, whose last data bit differs from a stop bit
LIMITS = {"fast": Fraction(77, 10), "slow": Fraction(76, 9)}  # samples a bit
HALVINGS = 8  # of half a sample a bit
START = 10_000  # cycles


def baud_rates() -> Iterator[Finding]:
    """Compare the largest rate error at which every phase is received, found by bisection, with its exact limit."""
    for name, limit in LIMITS.items():
        good, bad = Fraction(NOMINAL), Fraction(NOMINAL) + (Fraction(1, 2) if limit > NOMINAL else -Fraction(1, 2))
        last = abs(bad - good) / (1 << HALVINGS)
        while abs(bad - good) > last:
            middle = (good + bad) / 2
            good, bad = (middle, bad) if all(received(middle, phase) for phase in range(PHASES)) else (good, middle)
        exact = min(good, bad) - Fraction(1, 8 * PHASES) <= limit <= max(good, bad) + Fraction(1, 8 * PHASES)
        found, meant = (float(100 * (NOMINAL / bit - 1)) for bit in (good, limit))
        note = f"12 bytes in a row are received up to {found:+.2f} %; the limit is {meant:+.3f} %"
        yield Finding(f"baud rate of a {name} sender", EVERY, "exact" if exact else "off", meant, "%", note=note)


def received(bit: Fraction, phase: int) -> bool:
    """True if an SCI receives all bytes without an error. bit: the sender's bit time, in samples of the receiver."""
    kernel, recorder, timebase = Kernel(), Recorder(), Timebase(SYSCLK)
    clock, line, sci = Clock(timebase, SYSCLK), Wire(kernel, "RX", recorder), Sci()
    socket = Socket(kernel, clock, recorder, "SCI-A", sci, lambda cycle, lines: None)
    sci.gate(0, True)
    for cycle, (register, value) in enumerate(
        (("SCILBAUD", BRR), ("SCICCR", 7), ("SCIFFTX", 0xE000), ("SCIFFRX", 0x2000), ("SCICTL1", 0x21))
    ):
        socket.write(cycle, SCI_MAP[register].offset, value)
    socket.inputs.listen(0, line)
    kernel.run_until(clock.tick(START + phase * SAMPLE // PHASES))
    UartSender(kernel, recorder, line, bit * SAMPLE * clock.tick(1)).send(BYTES, Fraction(0), lambda tick: None)
    kernel.run_until(clock.tick(START + 130 * NOMINAL * SAMPLE))
    cycle = clock.cycle_at(kernel.now)
    errors = socket.read(cycle, SCI_MAP["SCIRXST"].offset)
    words = [socket.read(cycle, SCI_MAP["SCIRXBUF"].offset) for _ in BYTES]
    return not errors & SCI_MAP["SCIRXST"]["RXERROR"].mask and bytes(word & 0xFF for word in words) == BYTES
