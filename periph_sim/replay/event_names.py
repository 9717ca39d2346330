"""Names of the decoders' events, for comparison and display: "address 50 read", "ACK", "00 FE"."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from ..traces.decode import i2c
from .compare import Happened


def i2c_words(events: Iterable[i2c.Event], per_second: Fraction, origin: int = 0) -> list[Happened]:
    """Convert I2C events. origin: the position at which the capture began."""
    return [Happened(_i2c(event), (event.at - origin) / per_second) for event in events]


def _i2c(event: i2c.Event) -> str:
    match event:
        case i2c.Start():
            return "START"
        case i2c.RepeatedStart():
            return "repeated START"
        case i2c.Address(_, value, read, _):
            return f"address {value:02X} {'read' if read else 'write'}"
        case i2c.Data(_, value, read):
            return f"data {'read' if read else 'write'} {value:02X}"
        case i2c.Ack():
            return "ACK"
        case i2c.Nack():
            return "NACK"
        case i2c.Stop():
            return "STOP"
        case i2c.Cut(_, bits):
            return f"cut off after {''.join(map(str, bits))}"


def byte_words(value: int, frame_error: bool, parity_error: bool) -> str:
    """Format a received word: 55, 00 FE, 41 PE."""
    return f"{value:02X}{' FE' if frame_error else ''}{' PE' if parity_error else ''}"
