"""`periph-sim decode FILE`: list the events on the buses of a capture."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from fractions import Fraction
from math import ceil
from pathlib import Path

import click

from ...core.shorten import shorten
from ...traces.capture.capture import Capture
from ...traces.capture.sampling import sample_step
from ...traces.decode.event_rows import grouped, merged
from ...traces.decode.i2c_table import long_lows
from . import decoded_text as event_text
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
    """Convert the value of --glitch to a number of positions. Pulses that are shorter are glitches."""
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
