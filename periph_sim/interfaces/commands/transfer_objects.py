"""Decoded transfers as JSON, one object per line.

    I2C    {..., "messages": [{"address": 83, "direction": "write", "acked": true, "bytes": [...]}], "ended": "stop"}
    UART   {..., "frames": [{"value": 65, ...}]}
    SPI    {..., "words": [{"value": 159, "bits": 8, ...}], "cut": null}

A message is from a START, or repeated START, to the next condition. Lines are built as text: a
dense capture has a hundred thousand bytes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

import numpy as np

from ...traces.decode.event_rows import ADDRESS, ADDRESS_LOW, CUT, DETAILS, EVENTS, START, WORD, Rows
from ...traces.decode.scl_times import LongLows
from .bulk_text import Numbers
from .decoded_text import Clock, in_transfer

AGAIN, ACK, NACK, STOP = (EVENTS.index(name) for name in ("repeated start", "ack", "nack", "stop"))
ACKED = {ACK: "true", NACK: "false"}
AT_ONCE = 1000  # number of lines that are yielded together


def transfer_lines(
    rows: Rows,
    first: Numbers,
    buses: Sequence[str],
    protocols: Sequence[str],
    lows: Sequence[LongLows | None],
    clock: Clock | None,
) -> Iterator[bytes]:
    """Yield a line for each transfer or burst, which begin at rows `first`. lows: of each I2C bus; None for others."""
    table = _Table(rows, clock)
    ends = np.maximum.reduceat(rows.end, first) if len(first) else rows.end
    bounds = [*first.tolist(), len(rows.at)]
    stretches = [_Stretches(rows, bus, found, clock) if found else None for bus, found in enumerate(lows)]
    names = [json.dumps(name) for name in buses]
    over = zip(_times(ends, clock), ends.tolist(), strict=True)
    lines: list[str] = []
    for begin, end, (time, position) in zip(bounds, bounds[1:], over, strict=False):
        bus = table.bus[begin]
        own = stretches[bus]
        if own is not None:
            whole = table.messages(begin, end, own)
        else:
            whole = table.words(begin, end) if protocols[bus] == "spi" else table.frames(begin, end)
        when = table.span(begin, time, position)
        said = " ".join(table.said(row) for row in range(begin, end))
        lines.append(f'{{{when}, "bus": {names[bus]}, "transfer": "{said}", {whole}}}\n')
        if len(lines) == AT_ONCE:
            yield "".join(lines).encode()
            lines.clear()
    yield "".join(lines).encode()


class _Stretches:
    """The long low phases of one bus as JSON, by the row of their byte.

    The number of the byte in its message is added later.
    """

    def __init__(self, rows: Rows, bus: int, lows: LongLows, clock: Clock | None) -> None:
        own = np.flatnonzero((rows.bus == bus) & (rows.value >= 0))
        starts = np.searchsorted(lows.rises, rows.at[own])  # the rises of first bits
        place = np.searchsorted(starts, lows.which, side="right") - 1
        bits = lows.which - np.append(starts, 0)[place] + 1
        within = (place >= 0) & (bits <= 9)
        place, bits, lengths = place[within], bits[within], lows.lengths[within]
        falls = lows.rises[lows.which[within]] - lengths
        self.by_row: dict[int, list[str]] = {}
        columns = (own[place], bits, falls, lengths)
        found = zip(*(column.tolist() for column in columns), _times(falls, clock), _times(lengths, clock), strict=True)
        for row, bit, fall, length, time, low in found:
            times = f'"time_s": {time}, "low_s": {low}, ' if time else ""
            said = f'{{{times}"position": {fall}, "low": {length}, "bit": {bit}, "byte": '
            self.by_row.setdefault(row, []).append(said)


def _times(positions: Numbers, clock: Clock | None) -> list[str]:
    """Format seconds exactly; empty if positions have no time."""
    if clock is None:
        return [""] * len(positions)
    units = clock.units(positions).tolist()
    if not clock.decimals:
        return [str(seconds) for seconds in units]
    scale, decimals = 10**clock.decimals, clock.decimals
    return [f"{unit // scale}.{unit % scale:0{decimals}}" for unit in units]


class _Table:
    """Columns as lists, with rows as JSON."""

    def __init__(self, rows: Rows, clock: Clock | None) -> None:
        self._at = rows.at.tolist()
        self._time = _times(rows.at, clock)
        self.bus = rows.bus.tolist()
        self._event = rows.event.tolist()
        self._value = rows.value.tolist()
        self._bits = rows.bits.tolist()
        self._detail = rows.detail.tolist()
        self._said: dict[tuple[int, int, int, int], str] = {}  # cache: few different ones, however many rows

    def when(self, row: int) -> str:
        time = self._time[row]
        return f'"time_s": {time}, "position": {self._at[row]}' if time else f'"position": {self._at[row]}'

    def span(self, row: int, end_time: str, end: int) -> str:
        """Format the keys of an event of `--format json`."""
        times = f'"time_s": {self._time[row]}, "end_s": {end_time}, ' if end_time else ""
        return f'{times}"position": {self._at[row]}, "end": {end}'

    def said(self, row: int) -> str:
        """Format the row in the notation of the I2C-bus specification: `S`, `53 W`, `A`."""
        key = self._event[row], self._value[row], self._bits[row], self._detail[row]
        if key not in self._said:
            event, value, bits, detail = key
            self._said[key] = in_transfer(EVENTS[event], None if value < 0 else value, bits, DETAILS[detail])
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
        """Format the words of one selection, and the bits of an incomplete last word."""
        whole, cut = [], "null"
        for row in range(begin, end):
            value, bits = self._value[row], self._bits[row]
            if self._event[row] == WORD:
                whole.append(f'{{{self.when(row)}, "value": {value}, "bits": {bits}}}')
            elif self._event[row] == CUT:
                cut = f'"{value:0{bits}b}"'
        return f'"words": [{", ".join(whole)}], "cut": {cut}'

    def messages(self, begin: int, end: int, stretches: _Stretches) -> str:
        starts = [row for row in range(begin, end) if self._event[row] in (START, AGAIN)]
        messages = (self._message(a, b, stretches) for a, b in zip(starts, [*starts[1:], end], strict=True))
        ended = "stop" if self._event[end - 1] == STOP else "cut off"
        return f'"messages": [{", ".join(messages)}], "ended": "{ended}"'

    def _message(self, begin: int, end: int, stretches: _Stretches) -> str:
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
            held += [f"{said}{byte}}}" for said in stretches.by_row.get(row, ())]
            byte += 1
        return (
            f'{{{self.when(begin)}, "address": {address}, "address_bits": {bits}, "direction": {direction}, '
            f'"reserved": {reserved}, "acked": {acked}, "bytes": [{", ".join(data)}], "cut": {cut}, '
            f'"stretches": [{", ".join(held)}]}}'
        )
