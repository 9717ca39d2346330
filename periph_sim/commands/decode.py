"""`periph-sim decode FILE`: the events on the buses of a capture, a line each."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Iterator
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import NamedTuple

import click

from ..core.nearest import near
from ..decode.i2c_table import i2c_table
from ..decode.rows import Rows, grouped, i2c_rows, merged, uart_rows
from ..decode.uart_line import line_of, width_of
from ..decode.uart_table import uart_table
from ..formats.capture import Capture
from . import event_text
from .inputs import RATE, SALVAGE, read_capture
from .trouble import told_plainly

A_SECOND = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9, "ps": 10**12}
UART_LINES = ("rx", "tx")


class Decoded(NamedTuple):
    """One bus. silence: positions without a frame that end a burst of frames; None for I2C."""

    name: str
    rows: Rows
    silence: int | None = None


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--i2c", "i2cs", multiple=True, metavar="scl=CHANNEL,sda=CHANNEL", help="An I2C bus; by name or index.")
@click.option(
    "--uart",
    "uarts",
    multiple=True,
    metavar="rx=CHANNEL,baud=RATE,...",
    help="A serial line: rx= or tx= or both, baud=115200 or baud=auto, format=8n1, invert.",
)
@click.option("--glitch", metavar="TIME", help="Leave out pulses shorter than '50ns'; a bare number counts samples.")
@RATE
@click.option("--format", "style", type=click.Choice(["table", "json", "csv"]), default="table", show_default=True)
@SALVAGE
@click.option("--times", "full", is_flag=True, help="In the table, too: where each row ends, and sample numbers.")
@click.option("--transfers", "whole", is_flag=True, help="A line a transfer, or burst of frames, not a line an event.")
def decode(
    file: Path,
    i2cs: tuple[str, ...],
    uarts: tuple[str, ...],
    glitch: str | None,
    rate: str | None,
    salvage: bool,
    style: str,
    full: bool,
    whole: bool,
) -> None:
    """Decode the buses in FILE, a capture in any format.

    Without --i2c and --uart, channels called scl and sda, rx and tx are taken. The times of several buses stand in
    one list.
    """
    with told_plainly():
        capture = read_capture(file, rate, salvage)
        shortest = 0 if glitch is None else _shortest(glitch, capture)
        if not i2cs and not uarts:
            i2cs, uarts = _by_name(capture)
        found = [_i2c(capture, text, shortest) for text in i2cs]
        found += [bus for text in uarts for bus in _uart(capture, text, shortest)]
    for note in capture.notes:
        click.echo(f"note: {note}", err=True)
    for number, bus in enumerate(found):
        bus.rows.bus[:] = number
    _print(_text(found, capture, style, full, whole))


def _text(found: list[Decoded], capture: Capture, style: str, full: bool, whole: bool) -> Iterator[bytes]:
    names = [bus.name for bus in found]
    clock = None if capture.rate is None else event_text.Clock.of(capture.rate, 2 * capture.length)
    rows = merged([bus.rows for bus in found])
    if whole:
        rows, first = grouped(rows, [bus.silence for bus in found])
        return event_text.transfers(rows, first, names, clock, style, full)
    return event_text.events(rows, names, clock, style, full)


def _print(pieces: Iterable[bytes]) -> None:
    try:
        for piece in pieces:
            sys.stdout.buffer.write(piece)
        sys.stdout.buffer.flush()
    except BrokenPipeError:  # who reads has seen enough; what is left must not be written at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _by_name(capture: Capture) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The options for channels whose names say what they are."""
    called: dict[str, list[int]] = {}
    for channel in capture.channels:
        called.setdefault(channel.name.rpartition(".")[2].casefold(), []).append(channel.index)
    sure = {name: indices[0] for name, indices in called.items() if len(indices) == 1}
    i2cs = (f"scl={sure['scl']},sda={sure['sda']}",) if {"scl", "sda"} <= sure.keys() else ()
    uarts = tuple(f"{name}={sure[name]},baud=auto" for name in UART_LINES if name in sure)
    if not i2cs and not uarts:
        names = ", ".join(f"{channel.name} (index {channel.index})" for channel in capture.channels)
        raise click.ClickException(
            f"{capture.path}: no channels are called scl and sda, rx or tx, it has {names}; "
            "say which they are, as in --i2c scl=0,sda=1 or --uart rx=0,baud=auto"
        )
    return i2cs, uarts


def _i2c(capture: Capture, text: str, shortest: int) -> Decoded:
    given = _pairs("--i2c", text, ("scl", "sda"))
    for name in ("scl", "sda"):
        if name not in given:
            raise click.ClickException(f"--i2c {text}: {name} is missing; expected scl=CHANNEL,sda=CHANNEL")
    try:
        scl, sda = capture.channel(given["scl"]), capture.channel(given["sda"])
    except LookupError as error:
        raise click.ClickException(f"--i2c {text}: {error.args[0]}") from None
    if scl is sda:
        raise click.ClickException(f"--i2c {text}: both are channel {scl.name}; expected two channels")
    return Decoded(f"i2c {scl.name}/{sda.name}", i2c_rows(i2c_table(capture, scl.index, sda.index, shortest)))


def _uart(capture: Capture, text: str, shortest: int) -> Iterator[Decoded]:
    given = _pairs("--uart", text, (*UART_LINES, "baud", "format", "invert"))
    if not given.keys() & set(UART_LINES):
        raise click.ClickException(f"--uart {text}: rx or tx is missing; expected rx=CHANNEL,baud=RATE")
    if given.get("invert"):
        raise click.ClickException(f"--uart {text}: invert={given['invert']}; expected invert without a value")
    baud, shape = given.get("baud", "auto"), given.get("format")
    for name in UART_LINES:
        if name not in given:
            continue
        try:
            wire = capture.channel(given[name])
            if baud == "auto":
                from ..decode.uart_guess import guess

                guessed = guess(capture, wire.index, shape, "invert" in given or None, shortest)
                click.echo(f"note: {wire.name}: {guessed}", err=True)
                line = guessed.line
            else:
                line = line_of(baud, shape or "8n1", "invert" in given)
            table = uart_table(capture, wire.index, line, shortest)
            yield Decoded(f"uart {wire.name}", uart_rows(table), round(line.frame * width_of(capture, line.baud)))
        except (LookupError, ValueError) as error:
            raise click.ClickException(f"--uart {text}: {error.args[0]}") from None


def _pairs(option: str, text: str, known: tuple[str, ...]) -> dict[str, str]:
    """`a=1,b` as a dict; what has no `=` has the value ''."""
    given: dict[str, str] = {}
    for part in text.split(","):
        name, equals, value = part.partition("=")
        name = name.strip().casefold()
        if name not in known:
            raise click.ClickException(f"{option} {text}: there is no {name!r}; {near(name, known)}")
        if name in given:
            raise click.ClickException(f"{option} {text}: {name} is given twice; expected once")
        if name != "invert" and not value.strip():
            raise click.ClickException(f"{option} {text}: {name} has no value; expected {name}=...")
        given[name] = value.strip() or equals
    return given


def _shortest(text: str, capture: Capture) -> int:
    """Positions; a pulse of fewer is a glitch."""
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([a-z]*)\s*", text)
    if not match or (match[2] and match[2] not in A_SECOND) or (not match[2] and not match[1].isdecimal()):
        raise click.ClickException(f"--glitch: {text!r} is no time; expected one such as 50ns, 1.5us, or whole samples")
    if not match[2]:
        return int(match[1])
    if capture.rate is None:
        raise click.ClickException(f"--glitch: {capture.path} states no rate; expected whole samples, or state --rate")
    return ceil(Fraction(match[1]) * capture.rate / A_SECOND[match[2]])
