"""Decoded rows as text: a table, CSV or JSON lines."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ...core.registers import NamedByte
from ...traces.capture.sampling import rescaled
from ...traces.decode.event_rows import DETAILS, EVENTS, Rows
from ...traces.decode.table_columns import select
from .bulk_text import BLANK, NONE, Column, Digits, Literal, Numbers, Sparse, Words, numbered, text

MOST_DECIMALS = 12  # number of decimals of a second if no smaller number is exact
GAP = "  "


class Clock(NamedTuple):
    """Converter of positions in a capture to seconds: one position is `scale` units of 10**-decimals s.

    Times have at most twelve decimals, and fewer in captures that last for months. If the sample period in seconds has
    more decimals than that, times are rounded.
    """

    scale: Fraction
    decimals: int

    @staticmethod
    def for_rate(rate: Fraction, length: int = 0) -> Clock:
        """Return the converter for a sampling rate.

        length: the largest position. The number of decimals is reduced until the time of this position fits in 63 bits.
        """
        period = 1 / rate
        decimals = next((n for n in range(MOST_DECIMALS) if (period * 10**n).denominator == 1), MOST_DECIMALS)
        while decimals and length * period * 10**decimals >= 1 << 63:
            decimals -= 1
        return Clock(period * 10**decimals, decimals)

    def units(self, positions: Numbers) -> Numbers:
        """Convert positions to units of 10**-decimals s, rounded to the nearest unit. Results must fit in 63 bits."""
        return rescaled(positions, self.scale).astype(np.int64, copy=False)


def seconds_of(positions: Numbers, clock: Clock | None) -> list[str]:
    """Format positions as seconds. clock: None if the capture has no sample rate; the texts are then empty."""
    if clock is None:
        return [""] * len(positions)
    units = clock.units(positions).tolist()
    if not clock.decimals:
        return [str(seconds) for seconds in units]
    scale, decimals = 10**clock.decimals, clock.decimals
    return [f"{unit // scale}.{unit % scale:0{decimals}}" for unit in units]


class Named(NamedTuple):
    """Names of bytes.

    codes: for each row, an index into `texts`.
    texts: the names; the first one has no register and belongs to rows without a name.
    """

    codes: Numbers
    texts: Sequence[NamedByte]

    def column(self, style: str) -> Words:
        """Return the column of names. style: table, csv, json or transfer."""
        return Words(self.codes, lambda code: in_style(style, self.texts[code]))


def in_style(style: str, named: NamedByte) -> str:
    """Format the name of a byte as a text that is appended to the text of an event.

    If there is no name, return two empty cells in style csv, and "" in other styles.
    """
    if style == "csv":
        return "," + _csv(*named)
    if not named.register:
        return ""
    if style == "json":
        return f', "register": {json.dumps(named.register)}, "meaning": {json.dumps(named.meaning)}'
    text = ": ".join(filter(None, named))
    return f"({text})" if style == "transfer" else f", {text}"


EventFormat = Callable[[str, int | None, int, str], str]  # a function from event, value, bits and detail to a text


def said_in_transfer(event: int, value: int, bits: int, detail: int) -> str:
    """Format a row as `in_transfer` does. The arguments are the numbers in the columns of `Rows`."""
    return in_transfer(EVENTS[event], None if value < 0 else value, bits, DETAILS[detail])


def in_table(event: str, value: int | None, bits: int, detail: str) -> str:
    return f"{event:<14}{GAP}{_value(event, value, bits):<8}{GAP}{detail}".rstrip()


def in_csv(event: str, value: int | None, bits: int, detail: str) -> str:
    return _csv(event, "" if value is None else value, "" if value is None else bits, detail)


def in_json(event: str, value: int | None, bits: int, detail: str) -> str:
    return json.dumps({"event": event, "value": value, "bits": bits, "detail": detail})[1:-1]


def in_transfer(event: str, value: int | None, bits: int, detail: str) -> str:
    """Format an event in the notation of the I2C-bus specification: S, address, W or R, A or N, Sr, P."""
    marks = {"start": "S", "repeated start": "Sr", "ack": "A", "nack": "N", "stop": "P"}
    if value is None:
        return marks.get(event, event)
    if event == "cut":
        return f"[{value:0{bits}b}]" if bits else "[]"
    if event in ("frame", "word"):
        return f"{value:0{-(-bits // 4)}X}" + (f"({detail})" if detail else "")
    if event != "address":
        return f"{value:02X}"
    way, _, purpose = detail.partition(", ")
    return f"{value:02X} {way[0].upper()}" + (f"({purpose})" if purpose else "")


def _value(event: str, value: int | None, bits: int) -> str:
    """Format the value of an event in hexadecimal, or as bits if it is incomplete.

    If the value of a UART frame is a printable character, the character is added.
    """
    if value is None:
        return ""
    if event == "cut":
        return f"{value:0{bits}b}b" if bits else ""
    character = f" {chr(value)!r}" if event == "frame" and 0x20 <= value < 0x7F else ""
    return f"0x{value:0{-(-bits // 4)}X}{character}"


SHOWN: dict[str, EventFormat] = {"table": in_table, "csv": in_csv, "json": in_json}
TITLES = {"table": f"{'event':<14}{GAP}value\n", "csv": "event,value,bits,detail\n", "json": ""}
NAMED_TITLES = TITLES | {"csv": "event,value,bits,detail,register,meaning\n"}


def events(
    rows: Rows, buses: Sequence[str], clock: Clock | None, style: str, full: bool, named: Named | None
) -> Iterator[bytes]:
    """Yield a line for each row.

    buses: the name of each bus.
    clock: None if the capture has no sample rate.
    style: table or csv, with a first line of titles; or json, with an object on each line.
    full: True to show the end of each row, and positions beside times, in a table. CSV and JSON always show these.
    named: the names of bytes; None without --chip and --case.
    """
    titles, head = _head(rows, buses, clock, style, full)
    yield (titles + (TITLES if named is None else NAMED_TITLES)[style]).encode()
    names = [] if named is None else [named.column(style)]
    end = Literal("}\n" if style == "json" else "\n")
    yield from text([*head, events_column(rows, SHOWN[style]), *names, end], len(rows.at))


def transfers(
    rows: Rows,
    first: Numbers,
    buses: Sequence[str],
    clock: Clock | None,
    style: str,
    full: bool,
    named: Named | None,
) -> Iterator[bytes]:
    """Yield a line for each transfer, burst or selection in style table or csv.

    first: the rows with which transfers, bursts and selections begin.
    buses: the name of each bus.
    clock: None if the capture has no sample rate.
    full: True to show the end of each transfer, and positions beside times, in a table. CSV always shows these.
    named: the names of bytes; None without --chip and --case.
    """
    ends = np.maximum.reduceat(rows.end, first) if len(first) else rows.end
    titles, head = _head(select(rows, first)._replace(end=ends), buses, clock, style, full)
    yield f"{titles}transfer\n".encode()
    spaces = np.ones(len(rows.at), np.int64)
    spaces[first] = 0
    closes = np.zeros(len(rows.at), np.int64)
    closes[first[1:] - 1] = 1
    closes[-1:] = 1
    columns: list[Column] = [
        Sparse(head, first),
        Words(spaces, lambda count: " " * count),
        events_column(rows, in_transfer),
        *([] if named is None else [named.column("transfer")]),
        Words(closes, lambda count: "\n" * count),
    ]
    yield from text(columns, len(rows.at))


def _head(rows: Rows, buses: Sequence[str], clock: Clock | None, style: str, full: bool) -> tuple[str, list[Column]]:
    """Return the start of the title line, and the columns for time, position and bus to which these titles belong."""
    is_table = style == "table"
    pad = BLANK if is_table else NONE
    named: list[tuple[str, Digits | Words]] = [*_when(rows, clock, full or not is_table, pad)]
    if len(buses) > 1 or not is_table:
        shown: dict[str, Callable[[str], str]] = {"table": str, "csv": _csv, "json": json.dumps}
        named.append(("bus", Words(rows.bus.astype(np.int64), lambda bus: shown[style](buses[bus]), pad)))
    columns: list[Column] = [Literal("{")] if style == "json" else []
    titles = ""
    for name, column in named:
        if style == "json":
            columns += [Literal(f'"{name}": '), column, Literal(", ")]
        elif style == "csv":
            titles += f"{name},"
            columns += [column, Literal(",")]
        else:
            column.width = max(column.width, len(name))
            titles += f"{name:{'<' if name == 'bus' else '>'}{column.width}}{GAP}"
            columns += [column, Literal(GAP)]
    return titles, columns


def _when(rows: Rows, clock: Clock | None, full: bool, pad: bytes) -> list[tuple[str, Digits]]:
    """Return the titles and columns with the start and end of each row: positions in the capture, and times.

    Without a clock, there are no times. full: False to return only the start: its time or, without a clock, its
    position.
    """
    columns: list[tuple[str, Digits]] = []
    if clock is not None:
        columns.append(("time_s", Digits(clock.units(rows.at), clock.decimals, pad)))
        if full:
            columns.append(("end_s", Digits(clock.units(rows.end), clock.decimals, pad)))
    if full or clock is None:
        columns.append(("position", Digits(rows.at, 0, pad)))
    if full:
        columns.append(("end", Digits(rows.end, 0, pad)))
    return columns


def events_column(rows: Rows, shown: EventFormat) -> Words:
    """Return the column of events. The column has few different texts, even if there are many rows."""
    held = rows.value >= 0
    bits = np.where(held, rows.bits, 0).astype(np.int64)
    values, value = numbered(np.where(held, (bits << 32 | rows.value) + 1, 0))
    kinds = len(EVENTS) * len(DETAILS)

    def said(code: int) -> str:
        which, kind = divmod(code, kinds)
        event, detail = divmod(kind, len(DETAILS))
        packed = int(values[which]) - 1
        return shown(EVENTS[event], None if packed < 0 else packed & 0xFFFF_FFFF, max(packed, 0) >> 32, DETAILS[detail])

    return Words(value * kinds + rows.event.astype(np.int64) * len(DETAILS) + rows.detail, said)


def _csv(*cells: object) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow(cells)
    return line.getvalue()
