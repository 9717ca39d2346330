"""`periph-sim decode FILE`: list the events on the buses of a capture, or export them to another tool.

pcapng      Wireshark, tshark          a packet for each message, burst or selection, an interface for each bus in use
hexdump     text2pcap, any script      the same bytes as text, each packet below its time
sigrok      scripts for sigrok-cli     a line for each event, `START-END i2c-1: Address write: 53`
logic2      scripts for Logic 2        a line for each condition, byte, frame or word, as Logic 2 exports its tables

The head of `__init__.py` in this package defines message, burst and selection.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from ...core.phrases import shorten
from ...traces.capture.capture import Capture
from ...traces.capture.sampling import sample_step
from ...traces.decode.event_rows import (
    ADDRESS,
    ADDRESS_LOW,
    AGAIN,
    DATA,
    DESELECT,
    DETAILS,
    FRAME,
    SELECT,
    START,
    WORD,
    Rows,
    chosen,
    grouped,
    merged,
)
from ...traces.decode.i2c_table import long_lows
from ...traces.decode.table_columns import select
from ...traces.formats import pcapng_writer as pcapng
from . import decode_reports
from . import decoded_text as event_text
from .bulk_text import NONE, Column, Digits, Literal, Numbers, Words, text
from .command_frame import command, i2c_address_given, read_capture, running_user_code
from .decode_buses import Bus, asked_for
from .decode_logic2 import in_logic2
from .decoded_json import transfer_lines
from .shared_options import RATE, SALVAGE

if TYPE_CHECKING:
    from .decode_names import RegisterNames

EXPORTS = ("pcapng", "hexdump", "sigrok", "logic2")
STYLES = ("table", "json", "csv", *EXPORTS)
A_SECOND = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9, "ps": 10**12}


@command(
    "traces",
    "periph-sim decode capture.sr --i2c scl=0,sda=1",
    "periph-sim decode capture.sr --uart rx=RX,baud=115200 --format csv",
)
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
@click.option("--glitches", "want_glitches", is_flag=True, help="List short pulses instead; --glitch sets the limit.")
@click.option("--counts", "want_counts", is_flag=True, help="Count transfers, bytes, refusals and load instead.")
@click.option("--address", "addresses", multiple=True, metavar="ADDRESS", help="Only I2C transfers with this address.")
@click.option("--nacked", is_flag=True, help="Only I2C transfers in which a target did not acknowledge.")
@click.option("--first", type=click.IntRange(min=1), metavar="N", help="Only the first N transfers.")
@click.option(
    "--chip",
    "chips",
    multiple=True,
    metavar="[ADDRESS=]MODEL",
    help="Name the registers of a chip by its model in cases: 0x68=itg3200.",
)
@click.option(
    "--case", "case_file", type=click.Path(path_type=Path), help="Name the registers of the chips of this case."
)
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
    want_glitches: bool,
    want_counts: bool,
    addresses: tuple[str, ...],
    nacked: bool,
    first: int | None,
    chips: tuple[str, ...],
    case_file: Path | None,
    rate: str | None,
    salvage: bool,
    style: str,
    full: bool,
    whole: bool,
    as_json: bool,
) -> None:
    """Decode the buses in FILE, a capture in any format.

    Without --i2c, --uart and --spi, channels named scl and sda, rx and tx are used. All buses share one list in order
    of time. pcapng is for Wireshark, hexdump for text2pcap, sigrok has the lines of sigrok-cli,
    logic2 those of Logic 2's tables.
    """
    if as_json:
        if style not in ("table", "json"):
            raise click.ClickException(f"--json and --format {style} are two formats; give one of them")
        style, whole = "json", True
    reports, names_given = want_counts + want_glitches, bool(chips) or case_file is not None
    if reports and (reports > 1 or style in EXPORTS or names_given or (whole and not as_json)):
        raise click.ClickException(
            "--counts and --glitches print their rows as table, csv or json; leave out --transfers, --chip and --case"
        )
    if names_given and style in EXPORTS:
        raise click.ClickException(f"--chip and --case: --format {style} has no place for the names of registers")
    if want_glitches and (addresses or nacked or first):
        raise click.ClickException("--glitches lists pulses of lines; leave out --address, --nacked and --first")
    wanted = [i2c_address_given("--address", text, 0x3FF) for text in addresses]
    capture = read_capture(file, rate, salvage)
    shortest = 0 if glitch is None else _shortest(glitch, capture)
    found = asked_for(capture, i2cs, uarts, spis, shortest)
    clock = None if capture.rate is None else event_text.Clock.for_rate(capture.rate, 2 * capture.length)
    _print_notes(*capture.notes, *(note for bus in found for note in bus.notes))
    if want_glitches:
        limit = None if glitch is None else shortest
        _print_notes(*decode_reports.glitch_notes(found, capture, limit))
        cells = decode_reports.glitches(found, capture, clock, limit)
        decode_reports.print_cells(decode_reports.GLITCHES, cells, style)
        return
    found = [bus for bus in found if len(bus.rows.at) or (want_counts and bus.is_decoded)] or found[:1]
    for number, bus in enumerate(found):
        bus.rows.bus[:] = number
    rows = merged([bus.rows for bus in found])
    silences = [bus.silence for bus in found]
    if wanted or nacked or first:
        rows = chosen(*grouped(rows, silences), wanted, nacked, first)
    if want_counts:
        cells = decode_reports.counts(*grouped(rows, silences), found, capture)
        decode_reports.print_cells(decode_reports.COUNTS, cells, style)
        return
    names = _names(capture, found, chips, case_file) if names_given else None
    pieces = _text(found, rows, capture, clock, style, full, whole, shortest, names)
    for piece in pieces:
        sys.stdout.buffer.write(piece)
    sys.stdout.buffer.flush()


def _print_notes(*notes: str) -> None:
    for note in notes:
        click.echo(f"note: {note}", err=True)


def _names(capture: Capture, found: list[Bus], chips: tuple[str, ...], case_file: Path | None) -> RegisterNames:
    from .decode_names import RegisterNames

    with running_user_code():
        names = RegisterNames(capture, found, chips, case_file)
    _print_notes(*names.notes)
    return names


def _text(
    found: list[Bus],
    rows: Rows,
    capture: Capture,
    clock: event_text.Clock | None,
    style: str,
    full: bool,
    whole: bool,
    shortest: int,
    names: RegisterNames | None,
) -> Iterator[bytes]:
    buses, protocols = [bus.name for bus in found], [bus.protocol for bus in found]
    if style == "sigrok":
        return in_sigrok(rows, protocols)
    if style in EXPORTS and clock is None:
        raise click.ClickException(f"--format {style}: {capture.path} states no rate; packets have times, state --rate")
    if style == "logic2":
        assert clock is not None
        return in_logic2(rows, found, clock, sample_step(capture))
    first = None
    if whole or style in EXPORTS:
        rows, first = grouped(rows, [bus.silence for bus in found])
    named = None if names is None else event_text.Named(names.column(rows), names.texts)
    if first is None:
        return event_text.events(rows, buses, clock, style, full, named)
    if style == "json":
        lows = [
            long_lows(capture, bus.lines[0], bus.lines[1], shortest) if bus.protocol == "i2c" else None for bus in found
        ]
        return transfer_lines(rows, first, buses, protocols, lows, clock, named)
    if style not in EXPORTS:
        return event_text.transfers(rows, first, buses, clock, style, full, named)
    assert clock is not None
    if style == "pcapng":
        return in_pcapng(rows, first, buses, protocols, clock)
    if len(set(protocols)) > 1:
        raise click.ClickException(
            "a hex dump holds one kind of bus; choose with --i2c, --uart or --spi, or write pcapng"
        )
    return in_hexdump(rows, first, clock)


def _shortest(text: str, capture: Capture) -> int:
    """Convert the value of --glitch to a number of positions, rounded up. Shorter pulses are ignored as glitches."""
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


DECIMALS = 9  # number of decimals of a second; Wireshark does not show more
PER_LINE = 16  # number of bytes in a line of a hex dump

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

    first: the rows with which transfers, bursts and selections begin.
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

    The end of an event is the actual end of its last bit, which sigrok only estimates. Each data line of an SPI bus is
    written as a separate decoder, such as spi-2. Selections are left out, because sigrok has no line for them.
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
    """Yield the packets in order of time. A packet is a message of an I2C transfer, a burst, or a selection.

    A packet is a tuple (bus, time, bytes, flags, text):

    bus: the number of the bus.
    time: the time of the first event in units of 10**-DECIMALS s.
    bytes: the address and data bytes of a message; the low eight bits of each frame of a burst on a serial line; or
        the SPI words. Each SPI word is padded to whole bytes, and its most significant byte comes first.
    flags: the flags of an I2C message; 0 for other packets.
    text: the events of the packet; for I2C, in the notation of the I2C-bus specification.

    A packet without a complete byte or word is left out.

    first: the rows with which transfers, bursts and selections begin.
    """
    begins = np.union1d(first, np.flatnonzero((rows.event == START) | (rows.event == AGAIN)))
    rounded = event_text.Clock(clock.scale * Fraction(10**DECIMALS, 10**clock.decimals), DECIMALS)
    times = rounded.units(rows.at[begins]).tolist()
    bounds = [*begins.tolist(), len(rows.at)]
    columns = [column.tolist() for column in (rows.bus, rows.event, rows.value, rows.bits, rows.detail)]
    # The packets are sorted, because transfers of several buses may overlap in time.
    for number in np.argsort(rows.at[begins], kind="stable").tolist():
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
