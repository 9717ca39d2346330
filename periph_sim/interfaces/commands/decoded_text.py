"""Decoded rows as text: a table, CSV or JSON lines.

In JSON, each transfer is an object on a line of its own. A message lasts from a START or repeated START to the next
condition:

    I2C    {..., "messages": [{"address": 83, "direction": "write", "acked": true, "bytes": [...]}], "ended": "stop"}
    UART   {..., "frames": [{"value": 65, ...}]}
    SPI    {..., "words": [{"value": 159, "bits": 8, ...}], "cut": null}

These lines are built as text without a JSON encoder, because a dense capture has a hundred thousand bytes.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ...traces.decode.event_rows import ADDRESS, ADDRESS_LOW, CUT, DETAILS, EVENTS, START, WORD, Rows
from ...traces.decode.i2c_table import LongLows
from ...traces.decode.table_columns import select
from .bulk_text import BLANK, NONE, Column, Digits, Literal, Numbers, Sparse, Words, numbered, text

MOST_DECIMALS = 12  # maximum number of decimals of a second; used if the sample period has no finite number of decimals
GAP = "  "


class Clock(NamedTuple):
    """Converter of positions in a capture to seconds: one position is `up / down` units of 10**-decimals s.

    The conversion is exact if the sample period in seconds has at most twelve decimals. Otherwise, times are rounded to
    picoseconds, or to larger units in captures that are longer than a hundred days.
    """

    up: int
    down: int
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
        scaled = period * 10**decimals
        return Clock(scaled.numerator, scaled.denominator, decimals)

    def units(self, positions: Numbers) -> Numbers:
        """Convert positions to the nearest number of units. If products exceed 63 bits, Python's integers are used."""
        if not len(positions) or int(positions.max()) * 2 * self.up + self.down < 1 << 63:
            return (positions * (2 * self.up) + self.down) // (2 * self.down)
        exact = [(2 * at * self.up + self.down) // (2 * self.down) for at in positions.tolist()]
        return np.array(exact, np.int64)


Shown = Callable[[str, int | None, int, str], str]  # a function from event, value, bits and detail to a text


def said_in_transfer(event: int, value: int, bits: int, detail: int) -> str:
    """Return the text of a row as `in_transfer` does. The arguments are the cells of the row."""
    return in_transfer(EVENTS[event], None if value < 0 else value, bits, DETAILS[detail])


def in_table(event: str, value: int | None, bits: int, detail: str) -> str:
    return f"{event:<14}{GAP}{_value(event, value, bits):<8}{GAP}{detail}".rstrip()


def in_csv(event: str, value: int | None, bits: int, detail: str) -> str:
    return _csv(event, "" if value is None else value, "" if value is None else bits, detail)


def in_json(event: str, value: int | None, bits: int, detail: str) -> str:
    return json.dumps({"event": event, "value": value, "bits": bits, "detail": detail})[1:]


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


SHOWN: dict[str, Shown] = {"table": in_table, "csv": in_csv, "json": in_json}
TITLES = {"table": f"{'event':<14}{GAP}value\n", "csv": "event,value,bits,detail\n", "json": ""}


def events(rows: Rows, buses: Sequence[str], clock: Clock | None, style: str, full: bool) -> Iterator[bytes]:
    """Yield a line for each row.

    buses: the name of each bus.
    clock: None if the capture has no sample rate.
    style: table or csv, with a first line of titles; or json, with an object on each line.
    full: True to show the end of each row, and positions beside times, in a table. CSV and JSON always show these.
    """
    titles, head = _head(rows, buses, clock, style, full)
    yield (titles + TITLES[style]).encode()
    yield from text([*head, events_column(rows, SHOWN[style]), Literal("\n")], len(rows.at))


def transfers(
    rows: Rows, first: Numbers, buses: Sequence[str], clock: Clock | None, style: str, full: bool
) -> Iterator[bytes]:
    """Yield a line for each transfer or burst in style table or csv.

    first: the rows with which transfers and bursts begin.
    buses, clock, style, full: as for `events`.
    """
    ends = np.maximum.reduceat(rows.end, first) if len(first) else rows.end
    titles, head = _head(select(rows, first)._replace(end=ends), buses, clock, style, full)
    yield f"{titles}transfer\n".encode()
    spaces = np.ones(len(rows.at), np.int64)
    spaces[first] = 0
    closes = np.zeros(len(rows.at), np.int64)
    closes[first[1:] - 1] = 1
    closes[-1:] = 1
    columns = (
        Sparse(head, first),
        Words(spaces, lambda count: " " * count),
        events_column(rows, in_transfer),
        Words(closes, lambda count: "\n" * count),
    )
    yield from text(columns, len(rows.at))


def _head(rows: Rows, buses: Sequence[str], clock: Clock | None, style: str, full: bool) -> tuple[str, list[Column]]:
    """Return the begin of the title line, and the columns for time, position and bus to which these titles belong."""
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
    """Return the name and the column of each time and position that is shown."""
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


def events_column(rows: Rows, shown: Shown) -> Words:
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


AGAIN, ACK, NACK, STOP = (EVENTS.index(name) for name in ("repeated start", "ack", "nack", "stop"))
ACKED = {ACK: "true", NACK: "false"}


def transfer_lines(
    rows: Rows,
    first: Numbers,
    buses: Sequence[str],
    protocols: Sequence[str],
    lows: Sequence[LongLows | None],
    clock: Clock | None,
) -> Iterator[bytes]:
    """Yield a JSON line for each transfer or burst.

    first: the rows with which transfers and bursts begin.
    buses, protocols: the name and the protocol of each bus.
    lows: the long low phases of each I2C bus; None for other buses.
    clock: None if the capture has no sample rate.
    """
    table = _Table(rows, clock)
    ends = np.maximum.reduceat(rows.end, first) if len(first) else rows.end
    bounds = [*first.tolist(), len(rows.at)]
    stretches = [None if found is None else _stretches(rows, bus, found, clock) for bus, found in enumerate(lows)]
    names = [json.dumps(name) for name in buses]
    over = zip(_times(ends, clock), ends.tolist(), strict=True)
    for begin, end, (time, position) in zip(bounds, bounds[1:], over, strict=False):
        bus = table.bus[begin]
        own = stretches[bus]
        if own is not None:
            whole = table.messages(begin, end, own)
        else:
            whole = table.words(begin, end) if protocols[bus] == "spi" else table.frames(begin, end)
        when = table.span(begin, time, position)
        said = " ".join(table.said(row) for row in range(begin, end))
        yield f'{{{when}, "bus": {names[bus]}, "transfer": "{said}", {whole}}}\n'.encode()


def _stretches(rows: Rows, bus: int, lows: LongLows, clock: Clock | None) -> dict[int, list[str]]:
    """Return a dictionary from rows of bytes to the long low phases of SCL in these bytes.

    The text of a low phase is a JSON object without its end. The caller adds the number of the byte in the message and
    closes the object.
    """
    own = np.flatnonzero((rows.bus == bus) & (rows.value >= 0))
    starts = np.searchsorted(lows.rises, rows.at[own])  # for each byte, the index of the rise of its first bit
    place = np.searchsorted(starts, lows.which, side="right") - 1
    bits = lows.which - np.append(starts, 0)[place] + 1
    within = (place >= 0) & (bits <= 9)
    place, bits, lengths = place[within], bits[within], lows.lengths[within]
    falls = lows.rises[lows.which[within]] - lengths
    by_row: dict[int, list[str]] = {}
    columns = (own[place], bits, falls, lengths)
    found = zip(*(column.tolist() for column in columns), _times(falls, clock), _times(lengths, clock), strict=True)
    for row, bit, fall, length, time, low in found:
        times = f'"time_s": {time}, "low_s": {low}, ' if time else ""
        said = f'{{{times}"position": {fall}, "low": {length}, "bit": {bit}, "byte": '
        by_row.setdefault(row, []).append(said)
    return by_row


def _times(positions: Numbers, clock: Clock | None) -> list[str]:
    """Format positions as seconds. clock: None if the capture has no sample rate; the texts are then empty."""
    if clock is None:
        return [""] * len(positions)
    units = clock.units(positions).tolist()
    if not clock.decimals:
        return [str(seconds) for seconds in units]
    scale, decimals = 10**clock.decimals, clock.decimals
    return [f"{unit // scale}.{unit % scale:0{decimals}}" for unit in units]


class _Table:
    """Columns of rows as lists, with methods that format a row as JSON."""

    def __init__(self, rows: Rows, clock: Clock | None) -> None:
        self._at = rows.at.tolist()
        self._time = _times(rows.at, clock)
        self.bus = rows.bus.tolist()
        self._event = rows.event.tolist()
        self._value = rows.value.tolist()
        self._bits = rows.bits.tolist()
        self._detail = rows.detail.tolist()
        # Cache from the cells of a row to its text. There are few different texts, even if there are many rows.
        self._said: dict[tuple[int, int, int, int], str] = {}

    def when(self, row: int) -> str:
        time = self._time[row]
        return f'"time_s": {time}, "position": {self._at[row]}' if time else f'"position": {self._at[row]}'

    def span(self, row: int, end_time: str, end: int) -> str:
        """Format the JSON keys for the begin and the end of a transfer.

        row: the first row of the transfer.
        end_time: the time of the end; "" if the capture has no sample rate.
        end: the position of the end.
        """
        times = f'"time_s": {self._time[row]}, "end_s": {end_time}, ' if end_time else ""
        return f'{times}"position": {self._at[row]}, "end": {end}'

    def said(self, row: int) -> str:
        """Format a row in the notation of the I2C-bus specification: `S`, `53 W`, `A`."""
        key = self._event[row], self._value[row], self._bits[row], self._detail[row]
        if key not in self._said:
            self._said[key] = said_in_transfer(*key)
        return self._said[key]

    def frames(self, begin: int, end: int) -> str:
        return f'"frames": [{", ".join(map(self._frame, range(begin, end)))}]'

    def _frame(self, row: int) -> str:
        value = self._value[row] if self._value[row] >= 0 else "null"
        event, faults = EVENTS[self._event[row]], DETAILS[self._detail[row]]
        marks = json.dumps(faults.split(", ") if faults else [])
        return (
            f'{{{self.when(row)}, "event": "{event}", "value": {value}, "bits": {self._bits[row]}, "faults": {marks}}}'
        )

    def words(self, begin: int, end: int) -> str:
        """Format the words of an SPI selection, and the bits of an incomplete last word, as JSON keys."""
        whole, cut = [], "null"
        for row in range(begin, end):
            value, bits = self._value[row], self._bits[row]
            if self._event[row] == WORD:
                whole.append(f'{{{self.when(row)}, "value": {value}, "bits": {bits}}}')
            elif self._event[row] == CUT:
                cut = f'"{value:0{bits}b}"'
        return f'"words": [{", ".join(whole)}], "cut": {cut}'

    def messages(self, begin: int, end: int, stretches: dict[int, list[str]]) -> str:
        starts = [row for row in range(begin, end) if self._event[row] in (START, AGAIN)]
        messages = (self._message(a, b, stretches) for a, b in zip(starts, [*starts[1:], end], strict=True))
        ended = "stop" if self._event[end - 1] == STOP else "cut off"
        return f'"messages": [{", ".join(messages)}], "ended": "{ended}"'

    def _message(self, begin: int, end: int, stretches: dict[int, list[str]]) -> str:
        address, bits, direction, reserved, acked, cut = "null", "null", "null", "null", "null", "null"
        data: list[str] = []
        held: list[str] = []
        byte = 0
        for row in range(begin + 1, end):
            event, value = self._event[row], self._value[row]
            if value < 0:
                continue
            answer = ACKED.get(self._event[row + 1], "null") if row + 1 < end else "null"
            if event == ADDRESS:
                way, _, purpose = DETAILS[self._detail[row]].partition(", ")
                address, direction, acked = str(value), f'"{way}"', answer
                bits = "10" if self._bits[row] == 10 else "7"
                reserved = f'"{purpose}"' if purpose else "null"
            elif event == ADDRESS_LOW:
                address, bits, acked = str(value), "10", answer
            elif event == CUT:
                cut = f'"{value:0{self._bits[row]}b}"'
            else:
                data.append(f'{{{self.when(row)}, "value": {value}, "acked": {answer}}}')
            held += [f"{said}{byte}}}" for said in stretches.get(row, ())]
            byte += 1
        return (
            f'{{{self.when(begin)}, "address": {address}, "address_bits": {bits}, "direction": {direction}, '
            f'"reserved": {reserved}, "acked": {acked}, "bytes": [{", ".join(data)}], "cut": {cut}, '
            f'"stretches": [{", ".join(held)}]}}'
        )
