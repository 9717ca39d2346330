"""Traffic on the buses around an occurrence: rows of the protocol table, and bytes as boxes of a timeline.

 time    bus      what
 0.0 us  I2C      START 0x68 R ACK  12 ACK  34 NACK  STOP
80.0 us  RX       01 00 7F ...                                characters with only short pauses between them are one row
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import NamedTuple

from ....traces.decode import i2c
from ....traces.decode.i2c_table import I2cRowKind
from ....traces.drawing.capture_lanes import labelled_events
from ..explain.characters import characters
from ..explain.window import Window

LONGEST = 24  # maximum number of SCI characters in a row of the protocol table; further characters begin a new row


class Row(NamedTuple):
    """A row of the protocol table. In JSON, a row is a list of these values.

    at, end: the start and the end in ticks from the origin of the timeline.
    bus: "I2C", or the wire of SCI characters.
    start: "START", "Sr" for a repeated START, or "" for characters.
    address: the address, as in "0x68"; "" for characters, and if it is incomplete.
    way: the direction, "R" or "W"; "" for characters, and if the address is incomplete.
    ack: the answer to the address, "ACK" or "NACK"; "" if there is none.
    data: for each byte, the value in hexadecimal, the answer, and the expected value if the byte is wrong, else "". For
        a character, "error" or "" takes the place of the answer.
    stop: True if the row ends with a STOP.
    """

    at: int
    end: int
    bus: str
    start: str
    address: str
    way: str
    ack: str
    data: tuple[tuple[str, str, str], ...]
    stop: bool


def rows(window: Window, seen: Callable[[int, int], bool], zero: int) -> list[Row]:
    """Return the rows of the protocol table in order of time.

    seen: a function that returns True if a range of ticks, given by its start and end, is shown.
    zero: the tick from which the times of rows are counted.
    """
    names = {channel.name for channel in window.edges.channels}
    found = [*(_i2c_rows(window) if {"SCL", "SDA"} <= names else ()), *_frame_rows(window)]
    kept = sorted((row for row in found if seen(row.at, row.end)), key=lambda row: (row.at, row.bus))
    return [row._replace(at=row.at - zero, end=row.end - zero) for row in kept]


def _i2c_rows(window: Window) -> Iterator[Row]:
    last_kept = window.kept[-1].end - 1
    for transfer in i2c.transfers(window.edges):
        for number, phase in enumerate(transfer.phases):
            over = transfer.stop if number == len(transfer.phases) - 1 else transfer.phases[number + 1].start
            whole = [byte for byte in phase.bytes if byte.value is not None]
            head, data = whole[:1], whole[1:]
            yield Row(
                at=phase.start.at,
                end=last_kept if over is None else over.at,
                bus="I2C",
                start="Sr" if number else "START",
                address="" if phase.address is None else f"0x{phase.address:02X}",
                way="" if phase.read is None else "R" if phase.read else "W",
                ack=_ack(head[0].acked) if head else "",
                data=tuple(
                    (f"{byte.value:02X}", _ack(byte.acked), _hex(window.expected_on_bus.get((phase.start.at, place))))
                    for place, byte in enumerate(data)
                ),
                stop=over is not None and over is transfer.stop,
            )


def _ack(acked: bool | None) -> str:
    return "" if acked is None else "ACK" if acked else "NACK"


def _hex(value: int | None) -> str:
    return "" if value is None else f"{value:02X}"


def _frame_rows(window: Window) -> list[Row]:
    """Return the rows of the SCI characters on each wire.

    A new row begins after a pause of at least one character's length, and after LONGEST characters.
    """
    found: dict[str, list[Row]] = {}
    for one in characters(window):
        byte = (_hex(one.value), "error" if one.error else "", _hex(one.expected))
        rows = found.setdefault(one.wire, [])
        if rows and one.begin - rows[-1].end < one.end - one.begin and len(rows[-1].data) < LONGEST:
            rows[-1] = rows[-1]._replace(end=one.end, data=(*rows[-1].data, byte))
        else:
            rows.append(Row(one.begin, one.end, one.wire, "", "", "", "", (byte,), False))
    return [row for rows in found.values() for row in rows]


Box = tuple[int, int, str, str, bool]  # begin and end as positions in the capture, label, text, True for a wrong byte


def bytes_of(
    transfers: Iterable[i2c.Transfer], end: int, expected: Mapping[tuple[int, int], int] | None = None
) -> Iterator[Box]:
    """Yield a box for each condition, byte and ACK bit.

    end: the position at which incomplete boxes end.
    expected: the expected values of wrong data bytes. The key of a byte is (position of the last START or repeated
        START before the byte, number of data bytes between the address and the byte).
    """
    for transfer in transfers:
        for (event, label, place, wrong), span in zip(
            labelled_events(transfer, expected), _extents(transfer, end), strict=True
        ):
            text = i2c.NAMES[event.kind]
            if event.kind is I2cRowKind.CUT:
                text = f"cut off: bits {label}"
            elif event.kind is I2cRowKind.ADDRESS:
                text = f"address 0x{event.value:02X}, {'read' if event.read else 'write'}"
            elif event.kind is I2cRowKind.DATA:
                text = f"byte {place} = {label}\nfrom the {'target' if event.read else 'controller'}"
            yield *span, label, text, wrong


def _extents(transfer: i2c.Transfer, end: int) -> Iterator[tuple[int, int]]:
    """Yield the start and the end of each event of a transfer, in the order of `i2c.events_of`."""
    for phase in transfer.phases:
        start = phase.start
        begins = phase.bytes[0].at if phase.bytes else end
        yield start.at, begins if start.hold is None else min(start.at + start.hold, begins)
        for byte in phase.bytes:
            over = [end if bit.high is None else bit.at + bit.high for bit in byte.bits]
            yield byte.at, over[:8][-1]
            if len(over) > 8:
                yield byte.bits[8].at, over[8]
    if transfer.stop is not None and transfer.phases:
        yield transfer.stop.at - (transfer.stop.high or 0), transfer.stop.at
