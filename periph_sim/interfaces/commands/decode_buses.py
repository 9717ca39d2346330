"""The buses that `periph-sim decode` decodes according to its options, with their decoded rows.

--i2c scl=0,sda=1          --> channels --> i2c_table  --> Bus: rows, and notes on their limitations
--uart rx=2,baud=auto,...  --> channels --> uart_table -->
--spi clk=3,mosi=4,...     --> channels --> spi        --> a Bus for each data line
no option                  --> channels named scl and sda, rx and tx; uncertain guesses are reported, but not used
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import ceil
from typing import NamedTuple

import click

from ...traces.capture.capture import Capture, Channel, gap_notes, listed
from ...traces.capture.channel_names import buses_named, channels_given, pairs_given
from ...traces.decode import spi
from ...traces.decode.event_rows import Rows, i2c_rows, no_rows, spi_rows, uart_rows
from ...traces.decode.i2c_table import i2c_table, impossible_rate, swapped_lines
from ...traces.decode.uart import uart_table, width_of
from ...traces.decode.uart_line import Line, line_of

BUS_LINES, UART_LINES = ("scl", "sda"), ("rx", "tx")
FLAGS = ("invert", "vote")  # settings without a value
SPI_LINES = {"clk": "clk", "mosi": "mosi", "miso": "miso", "cs": "cs", "simo": "mosi", "somi": "miso", "ste": "cs"}
SPI_MODES = {  # names and values as in sigrok's decoder; the first value is the default
    "cpol": ("0", "1"),
    "cpha": ("0", "1"),
    "bitorder": ("msb-first", "lsb-first"),
    "cs_polarity": ("active-low", "active-high"),
}
SPIKE = Fraction(100, 10**9)  # seconds; default limit of glitches: twice tSP (UM10204, table 10), as in `compliance`
MAX_WORD = 32  # maximum number of bits of an SPI word
# Without the option --uart, a guess of a line's settings is used only if its certainty is at least SURE.
# In a test with 34 real lines, guesses with a certainty above SURE were right, and most other guesses were wrong.
SURE = 0.5


class Bus(NamedTuple):
    """A bus, or one data line of an SPI bus.

    protocol: i2c, uart or spi.
    silence: the number of positions without a frame or word after which a burst ends; None if transfers begin at STARTs
        or selections.
    notes: sentences on the limitations of the decoding.
    lines: all lines: SCL and SDA, the serial line, or clock, data and chip select.
    glitch: the default limit for glitches (shorter pulses), in positions. For a serial line that is decoded, it is half
        a bit. For other buses, it is SPIKE, or 0 if the capture has no sample rate.
    role: mosi or miso; "" for other buses.
    is_decoded: False if the lines are not decoded, so that the absence of rows does not mean silence.
    """

    protocol: str
    name: str
    rows: Rows
    silence: int | None
    notes: list[str]
    lines: tuple[Channel, ...]
    glitch: int
    role: str = ""
    is_decoded: bool = True


def asked_for(
    capture: Capture, i2cs: tuple[str, ...], uarts: tuple[str, ...], spis: tuple[str, ...], shortest: int
) -> list[Bus]:
    """Decode the buses that the options name. Without options, decode the buses whose channels have usual names.

    i2cs, uarts, spis: the values of the options --i2c, --uart and --spi.
    shortest: pulses of fewer positions are ignored as glitches.

    Raise ClickException if an option is invalid or names a channel that the capture does not have. Without options,
    raise ClickException if there is neither a channel named as a serial line nor a pair named as I2C, or if a serial
    line cannot be decoded and no bus has an event.
    """
    if i2cs or uarts or spis:
        serial = (bus for text in uarts for bus in _uart(capture, text, shortest))
        spi_buses = (bus for text in spis for bus in _spi(capture, text, shortest))
        return [*(_i2c(capture, text, shortest) for text in i2cs), *serial, *spi_buses]
    named = buses_named(capture)
    buses = [_i2c_of(capture, scl, sda, shortest) for scl, sda in named.i2c]
    if not buses and not named.uart:
        raise click.ClickException(
            f"{capture.path}: no channels are named scl and sda, rx or tx, it has {listed(capture.channels)}; "
            "name them, as in --i2c scl=0,sda=1, --uart rx=0,baud=auto or --spi clk=0,mosi=1,miso=2,cs=3"
        )
    failed: list[str] = []
    for wire in named.uart:
        try:
            buses.append(_frames(capture, wire, {}, shortest, doubtful=False))
        except ValueError as error:
            failed.append(f"{wire.name} is not decoded: {error}; describe it with --uart")
            buses.append(_nothing(capture, wire, failed[-1])._replace(is_decoded=False))
    if failed and not any(len(bus.rows.at) for bus in buses):
        raise click.ClickException("; ".join(failed))
    for wire in named.left_over:
        other = "SDA" if "scl" in wire.name.casefold() else "SCL"
        note = f"{wire.name} is not decoded: which {other} belongs to it? give --i2c scl=CHANNEL,sda=CHANNEL"
        buses.append(_nothing(capture, wire, note)._replace(is_decoded=False))
    return buses


# I2C -----------------------------------------------------------------------------


def _i2c(capture: Capture, text: str, shortest: int) -> Bus:
    given = pairs_given("--i2c", text, BUS_LINES)
    for name in BUS_LINES:
        if name not in given:
            raise click.ClickException(f"--i2c {text}: {name} is missing; expected scl=CHANNEL,sda=CHANNEL")
    lines = channels_given(capture, "--i2c", text, given, dict(zip(BUS_LINES, BUS_LINES, strict=True)))
    return _i2c_of(capture, lines["scl"], lines["sda"], shortest)


def _i2c_of(capture: Capture, scl: Channel, sda: Channel, shortest: int) -> Bus:
    rows = i2c_rows(i2c_table(capture, scl.index, sda.index, shortest))
    notes = gap_notes(capture, scl, sda)
    if wrong := impossible_rate(capture, scl.index):
        notes.append(f"{wrong}; then all times are wrong; state the rate with --rate")
    if swapped := swapped_lines(capture, scl.index, sda.index):
        notes.append(f"{swapped}; give --i2c scl={sda.name},sda={scl.name}")
    return Bus("i2c", f"i2c {scl.name}/{sda.name}", rows, None, notes, (scl, sda), _spike(capture))


def _spike(capture: Capture) -> int:
    return ceil((capture.rate or 0) * SPIKE)


# UART ----------------------------------------------------------------------------


def _uart(capture: Capture, text: str, shortest: int) -> Iterator[Bus]:
    given = pairs_given("--uart", text, (*UART_LINES, "baud", "format"), FLAGS)
    if not given.keys() & set(UART_LINES):
        raise click.ClickException(f"--uart {text}: rx or tx is missing; expected rx=CHANNEL,baud=RATE")
    for name in FLAGS:
        if given.get(name):
            raise click.ClickException(f"--uart {text}: {name}={given[name]}; expected {name} without a value")
    for name in UART_LINES:
        if name in given:
            try:
                yield _frames(capture, capture.channel(given[name]), given, shortest)
            except (LookupError, ValueError) as error:
                raise click.ClickException(f"--uart {text}: {error.args[0]}") from None


def _frames(capture: Capture, wire: Channel, given: dict[str, str], shortest: int, doubtful: bool = True) -> Bus:
    """Decode a serial line. If it has no edges, there is nothing to decode, and its settings are not checked.

    given: the settings that the user states, as a dictionary from names to values. If the rate is missing or "auto",
        all missing settings are guessed.
    shortest: pulses of fewer positions are ignored as glitches.
    doubtful: True if an uncertain guess may be used.

    Raise ValueError if the settings are invalid or cannot be guessed, if `doubtful` is False and the guess is
    uncertain, or if the capture is too coarse for the rate.
    """
    notes = gap_notes(capture, wire)
    if not len(wire.edges):
        level = "high" if wire.initial else "low"
        return _nothing(capture, wire, f"{wire.name} is {level} throughout: nothing to decode")
    baud, shape = given.get("baud", "auto"), given.get("format")
    if baud == "auto":
        from ...traces.decode.uart_guess import guess

        guessed = guess(capture, wire.index, shape, "invert" in given or None, shortest)
        if guessed.sure < SURE and not doubtful:
            raise ValueError(f"in doubt, {guessed}, which baud=auto would use")
        notes.append(f"{wire.name}: {guessed}" + ("; in doubt, so better state them" if guessed.sure < SURE else ""))
        line = guessed.line
    else:
        line = line_of(baud, shape or "8n1", "invert" in given)
    rows = uart_rows(uart_table(capture, wire.index, line, shortest, "vote" in given))
    if baud != "auto":
        notes += _rate_notes(capture, wire, line, shortest)
    bit = width_of(capture, line.baud)
    return Bus("uart", f"uart {wire.name}", rows, round(line.frame * bit), notes, (wire,), ceil(bit / 2))


def _rate_notes(capture: Capture, wire: Channel, line: Line, shortest: int) -> list[str]:
    from ...traces.decode.uart_doubt import rate_doubt

    doubt = rate_doubt(capture, wire.index, line, shortest)
    if doubt is None:
        return []
    evidence, other = doubt
    shape = "" if other.shape == line.shape else f",format={other.shape}"
    return [f"{wire.name}: {evidence}; the edges fit baud={other.baud}{shape}"]


def _nothing(capture: Capture, wire: Channel, note: str) -> Bus:
    return Bus("uart", f"uart {wire.name}", no_rows(), 0, [note], (wire,), _spike(capture))


# SPI -----------------------------------------------------------------------------


def _spi(capture: Capture, text: str, shortest: int) -> Iterator[Bus]:
    given = pairs_given("--spi", text, (*SPI_LINES, *SPI_MODES, "wordsize"))
    lines = channels_given(capture, "--spi", text, given, SPI_LINES)
    if "clk" not in lines or not lines.keys() & {"mosi", "miso"}:
        missing = "mosi or miso" if "clk" in lines else "clk"
        raise click.ClickException(f"--spi {text}: {missing} is missing; expected clk=CHANNEL,mosi=CHANNEL,...")
    format_ = _spi_format(text, given)
    clk, mosi, miso, cs = (lines[line].index if line in lines else None for line in ("clk", "mosi", "miso", "cs"))
    assert clk is not None
    events = spi.events(capture, format_, clk, mosi, miso, cs, shortest)
    words = [event.end - event.at for event in events if event.kind == "word"]
    silence = None if "cs" in lines else max(words, default=0)
    notes = gap_notes(capture, *lines.values())
    for line in ("mosi", "miso"):
        if line in lines:
            rows = spi_rows(events, line == "mosi")
            wires = tuple(lines.values())
            yield Bus("spi", f"spi {lines[line].name}", rows, silence, notes, wires, _spike(capture), line)
            notes = []


def _spi_format(text: str, given: dict[str, str]) -> spi.SpiFormat:
    mode: dict[str, int] = {}
    for name, values in SPI_MODES.items():
        value = given.get(name, values[0])
        if value not in values:
            raise click.ClickException(f"--spi {text}: {name} is {value}; expected {' or '.join(values)}")
        mode[name] = values.index(value)
    size = given.get("wordsize", "8")
    if not (size.isascii() and size.isdecimal() and len(size) < 3 and 1 <= int(size) <= MAX_WORD):
        raise click.ClickException(f"--spi {text}: wordsize is {size}; expected 1 to {MAX_WORD} bits")
    return spi.SpiFormat(int(size), mode["cpol"], mode["cpha"], bool(mode["bitorder"]), bool(mode["cs_polarity"]))
