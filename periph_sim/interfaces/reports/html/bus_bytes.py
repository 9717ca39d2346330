"""Bytes on the I2C bus as boxes of a timeline: begin, end, label and text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ....traces.decode import i2c

Box = tuple[int, int, str, str]  # begin, end (positions of the transfers), label, text


def bytes_of(transfers: Iterable[i2c.Transfer], end: int) -> Iterator[Box]:
    """Yield each condition, byte and ACK slot. end: end position for incomplete ones."""
    for transfer in transfers:
        for number, phase in enumerate(transfer.phases):
            start = phase.start
            name = "Sr" if number else "S"
            begins = phase.bytes[0].at if phase.bytes else end
            until = start.at + start.hold if start.hold is not None else begins
            yield start.at, min(until, begins), name, "repeated START" if number else "START"
            for place, byte in enumerate(phase.bytes):
                yield from _byte(phase, place, byte, end)
        if transfer.stop is not None and transfer.phases:
            since = transfer.stop.at - (transfer.stop.high or 0)
            yield since, transfer.stop.at, "P", "STOP"


def _byte(phase: i2c.Phase, place: int, byte: i2c.Byte, end: int) -> Iterator[Box]:
    if byte.value is None:
        bits = "".join(str(bit.value) for bit in byte.bits)
        last = byte.bits[-1]
        yield byte.at, end if last.high is None else last.at + last.high, bits, f"cut off: bits {bits}"
        return
    ninth = byte.bits[8] if len(byte.bits) > 8 else None
    last = byte.bits[7]
    until = end if last.high is None else last.at + last.high
    if place:
        who = "from the target" if phase.read else "from the controller"
        yield byte.at, until, f"0x{byte.value:02X}", f"byte {place} = 0x{byte.value:02X}\n{who}"
    else:
        address = f"0x{byte.value >> 1:02X}"
        way = "read" if byte.value & 1 else "write"
        yield byte.at, until, f"{address} {way[0].upper()}", f"address {address}, {way}"
    if ninth is not None:
        over = end if ninth.high is None else ninth.at + ninth.high
        yield ninth.at, over, "A" if byte.acked else "N", "ACK" if byte.acked else "NACK"
