"""Export of decoded buses to other tools.

pcapng      Wireshark, tshark          a packet for each message, burst or selection (SPI), an interface for each line
hexdump     text2pcap, any script      the same bytes as text, each packet below its time
sigrok      scripts for sigrok-cli     a line for each event, `START-END i2c-1: Address write: 53`
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ...traces.decode.event_rows import (
    ADDRESS,
    ADDRESS_LOW,
    DESELECT,
    DETAILS,
    EVENTS,
    FRAME,
    SELECT,
    START,
    WORD,
    Rows,
)
from ...traces.decode.table_columns import select
from ...traces.formats import pcapng_writer as pcapng
from .bulk_text import NONE, Column, Digits, Literal, Numbers, Words, text
from .decoded_text import Clock, events_column, said_in_transfer

AGAIN, DATA = (EVENTS.index(name) for name in ("repeated start", "data"))
DECIMALS = 9  # number of decimals of a second; Wireshark does not show more
PER_LINE = 16  # number of bytes in a line of a dump

SIGROK = {
    "start": "Start",
    "repeated start": "Start repeat",
    "stop": "Stop",
    "ack": "ACK",
    "nack": "NACK",
    "break": "Break condition",
    "rejected start": "Rejected start",
}


class Packet(NamedTuple):
    """One packet of an export.

    time: in units of 10**-DECIMALS s.
    wire: the address byte and the data of a message, the bytes of a burst, or SPI words. A word is a whole number of
        bytes, the most significant one first.
    said: the packet in the notation of the I2C-bus specification, with ACKs and the final condition.
    """

    bus: int
    time: int
    wire: bytes
    flags: int
    said: str


def in_pcapng(
    rows: Rows, first: Numbers, buses: Sequence[str], protocols: Sequence[str], clock: Clock
) -> Iterator[bytes]:
    """Export to pcapng. protocols: the protocol of each bus; serial lines and SPI have no link type of their own."""
    yield pcapng.section()
    for name, protocol in zip(buses, protocols, strict=True):
        yield pcapng.interface(pcapng.I2C_LINUX if protocol == "i2c" else pcapng.USER0, name, DECIMALS)
    for one in packets(rows, first, clock):
        is_i2c = protocols[one.bus] == "i2c"
        content = pcapng.i2c_content(one.bus, one.flags, one.wire) if is_i2c else one.wire
        yield pcapng.packet(one.bus, one.time, content, one.said)


def in_hexdump(rows: Rows, first: Numbers, clock: Clock) -> Iterator[bytes]:
    """Export for `text2pcap -t %s.%f -l 209` (147 for a serial line or SPI), which adds the link type."""
    for one in packets(rows, first, clock):
        lines = [f"# {one.said}", f"{one.time // 10**DECIMALS}.{one.time % 10**DECIMALS:0{DECIMALS}}"]
        for begin in range(0, len(one.wire), PER_LINE):
            lines.append(f"{begin:06x}  {one.wire[begin : begin + PER_LINE].hex(' ')}")
        yield ("\n".join(lines) + "\n\n").encode()


def in_sigrok(rows: Rows, protocols: Sequence[str]) -> Iterator[bytes]:
    """Export in the form of `sigrok-cli --protocol-decoder-samplenum`. The ends are those of the bits, not estimates.

    Each SPI line has its own decoder, which prints only words: sigrok has no line for a selection.
    """
    rows = select(rows, (rows.event != SELECT) & (rows.event != DESELECT))
    decoders: list[str] = []
    for kind in protocols:
        decoders.append(f"{kind}-{sum(name.startswith(kind) for name in decoders) + 1}")
    columns: list[Column] = [
        Digits(rows.at, 0, NONE),
        Literal("-"),
        Digits(rows.end, 0, NONE),
        Literal(" "),
        Words(rows.bus.astype(np.int64), lambda bus: decoders[bus]),
        Literal(": "),
        events_column(rows, _as_sigrok_says),
        Literal("\n"),
    ]
    return text(columns, len(rows.at))


def _as_sigrok_says(event: str, value: int | None, bits: int, detail: str) -> str:
    if value is None:
        return SIGROK[event]
    if event == "cut":
        return f"Cut: {value:0{bits}b}" if bits else "Cut"
    if event in ("frame", "word"):
        return f"{value:02X}"
    way = detail.partition(", ")[0]
    return (
        f"{'Address' if event == 'address' else 'Data'} {way}: {value & 0xFF if event == 'address low' else value:02X}"
    )


def packets(rows: Rows, first: Numbers, clock: Clock) -> Iterator[Packet]:
    """Yield the packets in order of time. A packet is a burst, or a message of an I2C transfer.

    first: the rows with which transfers and bursts begin. A message without a complete address byte is left out.
    """
    conditions = np.flatnonzero((rows.event == START) | (rows.event == AGAIN))
    begins = np.union1d(first, conditions)
    times = Clock(clock.up * 10**DECIMALS, clock.down * 10**clock.decimals, DECIMALS).units(rows.at[begins]).tolist()
    bounds = [*begins.tolist(), len(rows.at)]
    columns = [column.tolist() for column in (rows.bus, rows.event, rows.value, rows.bits, rows.detail)]
    for number in np.argsort(rows.at[begins], kind="stable").tolist():  # transfers of several buses overlap
        begin, end, time = bounds[number], bounds[number + 1], times[number]
        own = [tuple(column[row] for column in columns) for row in range(begin, end)]
        wire, flags = bytearray(), 0
        for _, event, value, bits, detail in own:
            if event == ADDRESS:
                way, _, purpose = DETAILS[detail].partition(", ")
                high = 0x78 | value >> 8 if bits == 10 else value
                wire.append(high << 1 | (way == "read"))
                flags = pcapng.READ * (way == "read") | pcapng.TEN_BITS * (purpose == "10-bit")
            elif event in (ADDRESS_LOW, DATA, FRAME):
                wire.append(value & 0xFF)
            elif event == WORD:
                wire += value.to_bytes(-(-bits // 8), "big")
        if wire:
            bus = own[0][0]
            said = " ".join(said_in_transfer(*row[1:]) for row in own)
            yield Packet(bus, time, bytes(wire), flags, said)
