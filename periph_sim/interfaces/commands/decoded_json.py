"""Decoded transfers as JSON: each transfer, burst or selection is an object on a line of its own.

A message lasts from a START or repeated START to the next condition. The head of `__init__.py` in this package defines
burst and selection. Keys of the objects:

    I2C    {..., "messages": [{"address": 83, "direction": "write", "acked": true, "bytes": [...]}], "ended": "stop"}
    UART   {..., "frames": [{"value": 65, ...}]}
    SPI    {..., "words": [{"value": 159, "bits": 8, ...}], "cut": null}

These lines are built as text without a JSON encoder, because a dense capture has a hundred thousand bytes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

import numpy as np

from ...traces.decode.event_rows import (
    ACK,
    ADDRESS,
    ADDRESS_LOW,
    AGAIN,
    CUT,
    DETAILS,
    EVENTS,
    NACK,
    START,
    STOP,
    WORD,
    Rows,
)
from ...traces.decode.i2c_table import LongLows
from .bulk_text import Numbers
from .decoded_text import Clock, Named, in_style, said_in_transfer, seconds_of

ACKED = {ACK: "true", NACK: "false"}


def transfer_lines(
    rows: Rows,
    first: Numbers,
    buses: Sequence[str],
    protocols: Sequence[str],
    lows: Sequence[LongLows | None],
    clock: Clock | None,
    named: Named | None,
) -> Iterator[bytes]:
    """Yield a JSON line for each transfer, burst or selection.

    first: the rows with which transfers, bursts and selections begin.
    buses, protocols: the name and the protocol of each bus.
    lows: the unusually long low phases of SCL of each I2C bus; None for other buses.
    clock: None if the capture has no sample rate.
    named: the names of bytes; None without --chip and --case.
    """
    table = _Table(rows, clock, named)
    ends = np.maximum.reduceat(rows.end, first) if len(first) else rows.end
    bounds = [*first.tolist(), len(rows.at)]
    stretches = [None if found is None else _stretches(rows, bus, found, clock) for bus, found in enumerate(lows)]
    names = [json.dumps(name) for name in buses]
    over = zip(seconds_of(ends, clock), ends.tolist(), strict=True)
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
    """Return a dictionary from the index of a byte's row to the long low phases of SCL in this byte.

    The text of a low phase is a JSON object without its end. The caller adds the number of the byte in the message and
    closes the object.
    """
    own = np.flatnonzero((rows.bus == bus) & (rows.value >= 0))
    # For each byte, the index in `lows.rises` of the first rising SCL of this byte.
    starts = np.searchsorted(lows.rises, rows.at[own])
    place = np.searchsorted(starts, lows.which, side="right") - 1
    bits = lows.which - np.append(starts, 0)[place] + 1
    within = (place >= 0) & (bits <= 9)
    place, bits, lengths = place[within], bits[within], lows.lengths[within]
    falls = lows.rises[lows.which[within]] - lengths
    by_row: dict[int, list[str]] = {}
    columns = (own[place], bits, falls, lengths)
    found = zip(
        *(column.tolist() for column in columns), seconds_of(falls, clock), seconds_of(lengths, clock), strict=True
    )
    for row, bit, fall, length, time, low in found:
        times = f'"time_s": {time}, "low_s": {low}, ' if time else ""
        said = f'{{{times}"position": {fall}, "low": {length}, "bit": {bit}, "byte": '
        by_row.setdefault(row, []).append(said)
    return by_row


class _Table:
    """Columns of rows as lists, with methods that format a row as JSON."""

    def __init__(self, rows: Rows, clock: Clock | None, named: Named | None) -> None:
        self._at = rows.at.tolist()
        self._time = seconds_of(rows.at, clock)
        self.bus = rows.bus.tolist()
        self._event = rows.event.tolist()
        self._value = rows.value.tolist()
        self._bits = rows.bits.tolist()
        self._detail = rows.detail.tolist()
        # Cache from the cells of a row to its text. There are few different texts, even if there are many rows.
        self._said: dict[tuple[int, int, int, int], str] = {}
        self._named = None if named is None else (named.codes.tolist(), named.texts)

    def when(self, row: int) -> str:
        time = self._time[row]
        return f'"time_s": {time}, "position": {self._at[row]}' if time else f'"position": {self._at[row]}'

    def span(self, row: int, end_time: str, end: int) -> str:
        """Format the JSON keys for the start and the end of a transfer.

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
        return self._said[key] + self._name(row, "transfer")

    def _name(self, row: int, style: str) -> str:
        """Return the name of a row's byte as `in_style` formats it; "" if there is none."""
        return "" if self._named is None else in_style(style, self._named[1][self._named[0][row]])

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
                data.append(f'{{{self.when(row)}, "value": {value}, "acked": {answer}{self._name(row, "json")}}}')
            held += [f"{said}{byte}}}" for said in stretches.get(row, ())]
            byte += 1
        return (
            f'{{{self.when(begin)}, "address": {address}, "address_bits": {bits}, "direction": {direction}, '
            f'"reserved": {reserved}, "acked": {acked}, "bytes": [{", ".join(data)}], "cut": {cut}, '
            f'"stretches": [{", ".join(held)}]}}'
        )
