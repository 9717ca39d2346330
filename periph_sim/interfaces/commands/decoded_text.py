"""Decoded rows as text: a table, CSV or JSON lines."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ...traces.decode.event_rows import DETAILS, EVENTS, Rows
from .bulk_text import BLANK, NONE, Column, Digits, Literal, Numbers, Sparse, Words, numbered, text

MOST_DECIMALS = 12  # if the sample period is no decimal fraction: picoseconds
GAP = "  "


class Clock(NamedTuple):
    """Converts positions in a capture to seconds: one position is `up / down` units of 10**-decimals s.

    Exact where the period is a decimal fraction of up to twelve digits, else rounded to picoseconds (coarser
    in captures of over a hundred days).
    """

    up: int
    down: int
    decimals: int

    @staticmethod
    def for_rate(rate: Fraction, length: int = 0) -> Clock:
        """Return the converter of positions to seconds.

        length: the largest position. The number of decimals is reduced until its time fits 63 bits.
        """
        period = 1 / rate
        decimals = next((n for n in range(MOST_DECIMALS) if (period * 10**n).denominator == 1), MOST_DECIMALS)
        while decimals and length * period * 10**decimals >= 1 << 63:
            decimals -= 1
        scaled = period * 10**decimals
        return Clock(scaled.numerator, scaled.denominator, decimals)

    def units(self, positions: Numbers) -> Numbers:
        """Convert to the nearest number of units; values beyond 63 bits are computed one by one."""
        if self.down == 1 and not self._large(positions):
            return positions * self.up
        if not self._large(positions):
            return (positions * (2 * self.up) + self.down) // (2 * self.down)
        exact = [(2 * at * self.up + self.down) // (2 * self.down) for at in positions.tolist()]
        return np.array(exact, np.int64)

    def _large(self, positions: Numbers) -> bool:
        return bool(len(positions)) and int(positions.max()) * 2 * self.up + self.down >= 1 << 63


Shown = Callable[[str, int | None, int, str], str]  # event, value, bits, detail -> text


def in_table(event: str, value: int | None, bits: int, detail: str) -> str:
    return f"{event:<14}{GAP}{_value(event, value, bits):<8}{GAP}{detail}".rstrip()


def in_csv(event: str, value: int | None, bits: int, detail: str) -> str:
    return _csv(event, "" if value is None else value, "" if value is None else bits, detail)


def in_json(event: str, value: int | None, bits: int, detail: str) -> str:
    import json

    return json.dumps({"event": event, "value": value, "bits": bits, "detail": detail})[1:]


def in_transfer(event: str, value: int | None, bits: int, detail: str) -> str:
    """Format as in the I2C-bus specification: S, address, W or R, A or N for the answer, Sr, P."""
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
    """Format a byte in hexadecimal, with a frame's printable character; an incomplete byte as bits."""
    if value is None:
        return ""
    if event == "cut":
        return f"{value:0{bits}b}b" if bits else ""
    character = f" {chr(value)!r}" if event == "frame" and 0x20 <= value < 0x7F else ""
    return f"0x{value:0{-(-bits // 4)}X}{character}"


SHOWN: dict[str, Shown] = {"table": in_table, "csv": in_csv, "json": in_json}
TITLES = {"table": f"{'event':<14}{GAP}value\n", "csv": "event,value,bits,detail\n", "json": ""}
CLOSED = {"table": "\n", "csv": "\n", "json": '"}\n'}  # the end of a transfer's line


def events(rows: Rows, buses: Sequence[str], clock: Clock | None, style: str, full: bool) -> Iterator[bytes]:
    """Yield a line for each row. style: table or csv, after a line of titles; or json, an object for each line.

    full: also in a table, the end of each row and positions in addition to times. clock: None without a time base.
    """
    titles, head = _head(rows, buses, clock, style, full)
    yield (titles + TITLES[style]).encode()
    yield from text([*head, events_column(rows, SHOWN[style]), Literal("\n")], len(rows.at))


def transfers(
    rows: Rows, first: Numbers, buses: Sequence[str], clock: Clock | None, style: str, full: bool
) -> Iterator[bytes]:
    """Yield a line for each group of rows, which begin at the rows `first`; arguments as for `events`."""
    ends = np.maximum.reduceat(rows.end, first) if len(first) else rows.end
    titles, head = _head(rows.select(first)._replace(end=ends), buses, clock, style, full)
    if style == "json":
        head.append(Literal('"transfer": "'))
    else:
        titles += "transfer\n"
    yield titles.encode()
    spaces = np.ones(len(rows.at), np.int64)
    spaces[first] = 0
    closes = np.zeros(len(rows.at), np.int64)
    closes[first[1:] - 1] = 1
    closes[-1:] = 1
    columns = (
        Sparse(head, first),
        Words(spaces, lambda count: " " * count),
        events_column(rows, in_transfer),
        Words(closes, lambda count: CLOSED[style] * count),
    )
    yield from text(columns, len(rows.at))


def _head(rows: Rows, buses: Sequence[str], clock: Clock | None, style: str, full: bool) -> tuple[str, list[Column]]:
    """Return the columns of time and bus, and their part of the line of titles."""
    columns: list[Column] = []
    if style == "table":
        titles = ""
        for name, column in _when(rows, clock, full, BLANK):
            column.width = max(column.width, len(name))
            columns += [column, Literal(GAP)]
            titles += f"{name:>{column.width}}{GAP}"
        if len(buses) > 1:
            bus = _buses(rows, buses, BLANK)
            columns += [bus, Literal(GAP)]
            titles += f"{'bus':<{bus.width}}{GAP}"
        return titles, columns
    when = _when(rows, clock, True, NONE)
    if style == "csv":
        for _, column in when:
            columns += [column, Literal(",")]
        columns += [_buses(rows, [_csv(bus) for bus in buses], NONE), Literal(",")]
        return "".join(f"{name}," for name, _ in when) + "bus,", columns
    import json

    for name, column in when:
        columns += [Literal(f'{", " if columns else "{"}"{name}": '), column]
    columns += [Literal(', "bus": '), _buses(rows, [json.dumps(bus) for bus in buses], NONE), Literal(", ")]
    return "", columns


def _when(rows: Rows, clock: Clock | None, full: bool, pad: bytes) -> list[tuple[str, Digits]]:
    """Return columns of time and position, with their names."""
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


def _buses(rows: Rows, buses: Sequence[str], pad: bytes) -> Words:
    return Words(rows.bus.astype(np.int64), lambda bus: buses[bus], pad)


def events_column(rows: Rows, shown: Shown) -> Words:
    """Return the column of events: few different texts, however many rows."""
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
    import csv
    import io

    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow(cells)
    return line.getvalue()
