"""`periph-sim decode FILE`: list the events on the buses of a capture, or export them to another tool.

pcapng      Wireshark, tshark          a packet for each message, burst or selection (SPI), an interface for each line
hexdump     text2pcap, any script      the same bytes as text, each packet below its time
sigrok      scripts for sigrok-cli     a line for each event, `START-END i2c-1: Address write: 53`
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import ceil
from pathlib import Path

import click
import numpy as np

from ...core.phrases import shorten
from ...traces.capture.capture import Capture
from ...traces.capture.sampling import sample_step
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
    grouped,
    merged,
)
from ...traces.decode.i2c_table import long_lows
from ...traces.decode.table_columns import select
from ...traces.formats import pcapng_writer as pcapng
from . import decoded_text as event_text
from .bulk_text import NONE, Column, Digits, Literal, Numbers, Words, text
from .command_frame import RATE, SALVAGE, command, read_capture, usage_errors_in_one_sentence
from .decode_buses import Bus, asked_for

EXPORTS = ("pcapng", "hexdump", "sigrok")
STYLES = ("table", "json", "csv", *EXPORTS)
A_SECOND = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9, "ps": 10**12}


@command("traces", "periph-sim decode capture.sr --i2c scl=0,sda=1")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--i2c", "i2cs", multiple=True, metavar="scl=CHANNEL,sda=CHANNEL", help="An I2C bus; by name or index.")
@click.option(
    "--uart",
    "uarts",
    multiple=True,
    metavar="rx=CHANNEL,baud=RATE,...",
    help="A serial line: rx= or tx= or both, baud=115200 or baud=auto, format=8n1, invert, vote.",
)
@click.option(
    "--spi",
    "spis",
    multiple=True,
    metavar="clk=CHANNEL,mosi=CHANNEL,...",
    help="An SPI bus: clk=, mosi= or miso= or both, cs=; cpol, cpha, bitorder, wordsize, cs_polarity as sigrok's.",
)
@click.option("--glitch", metavar="TIME", help="Ignore pulses shorter than '50ns'; a bare number counts samples.")
@RATE
@click.option("--format", "style", type=click.Choice(STYLES), default="table", show_default=True)
@SALVAGE
@click.option("--times", "full", is_flag=True, help="Add to the table the end of each row, and sample numbers.")
@click.option(
    "--transfers", "whole", is_flag=True, help="One line for each transfer, or burst of frames, instead of each event."
)
@click.option(
    "--json", "as_json", is_flag=True, help="Short for --transfers --format json: one object for each transfer."
)
def decode(
    file: Path,
    i2cs: tuple[str, ...],
    uarts: tuple[str, ...],
    spis: tuple[str, ...],
    glitch: str | None,
    rate: str | None,
    salvage: bool,
    style: str,
    full: bool,
    whole: bool,
    as_json: bool,
) -> None:
    """Decode the buses in FILE, a capture in any format.

    Without --i2c, --uart and --spi, channels named scl and sda, rx and tx are used. All buses share one list in order
    of time. pcapng is for Wireshark, hexdump for text2pcap, sigrok has the lines of sigrok-cli.
    """
    if as_json:
        if style not in ("table", "json"):
            raise click.ClickException(f"--json and --format {style} are two formats; give one of them")
        style, whole = "json", True
    with usage_errors_in_one_sentence():
        capture = read_capture(file, rate, salvage)
        shortest = 0 if glitch is None else _shortest(glitch, capture)
        found = asked_for(capture, i2cs, uarts, spis, shortest)
    for note in (*capture.notes, *(note for bus in found for note in bus.notes)):
        click.echo(f"note: {note}", err=True)
    found = [bus for bus in found if len(bus.rows.at)] or found[:1]
    for number, bus in enumerate(found):
        bus.rows.bus[:] = number
    with usage_errors_in_one_sentence():
        pieces = _text(found, capture, style, full, whole, shortest)
    for piece in pieces:
        sys.stdout.buffer.write(piece)
    sys.stdout.buffer.flush()


def _text(found: list[Bus], capture: Capture, style: str, full: bool, whole: bool, shortest: int) -> Iterator[bytes]:
    names, protocols = [bus.name for bus in found], [bus.protocol for bus in found]
    clock = None if capture.rate is None else event_text.Clock.for_rate(capture.rate, 2 * capture.length)
    rows = merged([bus.rows for bus in found])
    if style == "sigrok":
        return in_sigrok(rows, protocols)
    if not whole and style not in EXPORTS:
        return event_text.events(rows, names, clock, style, full)
    rows, first = grouped(rows, [bus.silence for bus in found])
    if style == "json":
        lows = [
            long_lows(capture, bus.lines[0], bus.lines[1], shortest) if bus.protocol == "i2c" else None for bus in found
        ]
        return event_text.transfer_lines(rows, first, names, protocols, lows, clock)
    if style not in EXPORTS:
        return event_text.transfers(rows, first, names, clock, style, full)
    if clock is None:
        raise click.ClickException(f"--format {style}: {capture.path} states no rate; packets have times, state --rate")
    if style == "pcapng":
        return in_pcapng(rows, first, names, protocols, clock)
    if len(set(protocols)) > 1:
        raise click.ClickException(
            "a hex dump holds one kind of bus; choose with --i2c, --uart or --spi, or write pcapng"
        )
    return in_hexdump(rows, first, clock)


def _shortest(text: str, capture: Capture) -> int:
    """Convert the value of --glitch to a number of positions. Shorter pulses are ignored as glitches."""
    match = re.fullmatch(r"\s*(\d{1,18}(?:\.\d{1,18})?)\s*([a-z]*)\s*", text)
    if not match or (match[2] and match[2] not in A_SECOND) or (not match[2] and not match[1].isdecimal()):
        raise click.ClickException(
            f"--glitch: {shorten(repr(text))} is no time; expected one such as 50ns, 1.5us, or whole samples"
        )
    if not match[2]:
        return int(match[1]) * sample_step(capture)
    if capture.rate is None:
        raise click.ClickException(f"--glitch: {capture.path} states no rate; expected whole samples, or state --rate")
    return ceil(Fraction(match[1]) * capture.rate / A_SECOND[match[2]])


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


def in_pcapng(
    rows: Rows, first: Numbers, buses: Sequence[str], protocols: Sequence[str], clock: event_text.Clock
) -> Iterator[bytes]:
    """Yield the pieces of a pcapng file.

    first: the rows with which transfers and bursts begin.
    protocols: the protocol of each bus. Serial lines and SPI have no link type of their own, so USER0 is used.
    """
    yield pcapng.section()
    for name, protocol in zip(buses, protocols, strict=True):
        yield pcapng.interface(pcapng.I2C_LINUX if protocol == "i2c" else pcapng.USER0, name, DECIMALS)
    for bus, time, wire, flags, said in packets(rows, first, clock):
        content = pcapng.i2c_content(bus, flags, wire) if protocols[bus] == "i2c" else wire
        yield pcapng.packet(bus, time, content, said)


def in_hexdump(rows: Rows, first: Numbers, clock: event_text.Clock) -> Iterator[bytes]:
    """Yield the packets as text for `text2pcap -t %s.%f -l 209`, which adds the link type.

    The link type is 209 for I2C, and 147 for a serial line or SPI.
    """
    for _, time, wire, _, said in packets(rows, first, clock):
        begins = range(0, len(wire), PER_LINE)
        lines = [f"# {said}", f"{time // 10**DECIMALS}.{time % 10**DECIMALS:0{DECIMALS}}"]
        lines += [f"{begin:06x}  {wire[begin : begin + PER_LINE].hex(' ')}" for begin in begins]
        yield ("\n".join(lines) + "\n\n").encode()


def in_sigrok(rows: Rows, protocols: Sequence[str]) -> Iterator[bytes]:
    """Yield lines in the form of `sigrok-cli --protocol-decoder-samplenum`.

    The end of an event is the actual end of its last bit, which sigrok only estimates. Each SPI line has its own
    decoder. Selections are left out, because sigrok has no line for them.
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
        event_text.events_column(rows, _as_sigrok_says),
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


def packets(rows: Rows, first: Numbers, clock: event_text.Clock) -> Iterator[tuple[int, int, bytes, int, str]]:
    """Yield the packets in order of time. A packet is a burst, or a message of an I2C transfer.

    A packet consists of the number of the bus, the time in units of 10**-DECIMALS s, bytes, the flags of an I2C
    message, and a text in the notation of the I2C-bus specification, with ACKs and the final condition. The bytes are
    the address byte and the data of a message, the bytes of a burst, or SPI words. An SPI word is padded to whole
    bytes, and its most significant byte comes first. A message without a complete address byte is left out.

    first: the rows with which transfers and bursts begin.
    """
    begins = np.union1d(first, np.flatnonzero((rows.event == START) | (rows.event == AGAIN)))
    times = (
        event_text.Clock(clock.up * 10**DECIMALS, clock.down * 10**clock.decimals, DECIMALS)
        .units(rows.at[begins])
        .tolist()
    )
    bounds = [*begins.tolist(), len(rows.at)]
    columns = [column.tolist() for column in (rows.bus, rows.event, rows.value, rows.bits, rows.detail)]
    for number in np.argsort(rows.at[begins], kind="stable").tolist():  # transfers of several buses may overlap
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
            said = " ".join(event_text.said_in_transfer(*row[1:]) for row in own)
            yield own[0][0], time, bytes(wire), flags, said
