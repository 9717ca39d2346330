"""Decoded rows as the table that Saleae Logic 2 exports from its analyzers I2C, Async Serial and SPI.

    name,type,start_time,duration,"ack","address","read","data"
    "I2C","start",0.000100000,0.000000250,,,,
    "I2C","address",0.000110000,0.000078000,true,0x68,false,
    "I2C","data",0.000200000,0.000078000,true,,,0x1D

A START or STOP lasts one sample, an I2C byte from its first rising SCL to the falling SCL after its ACK, and a frame
from its start edge to the middle of its last stop bit. An address or byte without ACK bit is a "data" row with an
error, and incomplete bytes and breaks have no rows.

Source: saleae/i2c-analyzer, serial-analyzer and spi-analyzer, functions that call AddFrameV2.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ...traces.decode.event_rows import (
    ACK,
    ADDRESS,
    ADDRESS_LOW,
    AGAIN,
    DATA,
    DESELECT,
    DETAILS,
    FRAME,
    NACK,
    SELECT,
    START,
    STOP,
    WORD,
    Rows,
)
from ...traces.decode.table_columns import select
from .decode_buses import Bus
from .decoded_text import Clock, seconds_of

ANALYZERS = {"i2c": "I2C", "uart": "Async Serial", "spi": "SPI"}
COLUMNS = {"i2c": ("ack", "address", "read", "data"), "uart": ("data",), "spi": ("mosi", "miso")}
MARKS = {START: "start", AGAIN: "start", STOP: "stop", SELECT: "enable", DESELECT: "disable"}


class Line(NamedTuple):
    """A line of the table. at, end: its start and end, as positions. cells: a dictionary from titles to texts."""

    at: int
    end: int
    name: str
    kind: str
    cells: dict[str, str]


def in_logic2(rows: Rows, buses: Sequence[Bus], clock: Clock, sample: int) -> Iterator[bytes]:
    """Yield the lines of the table in order of time.

    rows: the rows of all buses; those of each bus are in order.
    sample: the length of a sample in positions, which are the unit of time of the capture.
    """
    lines: list[Line] = []
    protocols: list[str] = []
    name = ""
    for number, bus in enumerate(buses):
        own = select(rows, rows.bus == number)
        if bus.role == "miso" and number and bus.lines == buses[number - 1].lines:
            # The words of MOSI and MISO that an SPI bus transfers at the same time are in one row of the table.
            words = dict(zip(own.at.tolist(), zip(own.value.tolist(), own.bits.tolist(), strict=True), strict=True))
            for line in lines:
                if line.name == name and "mosi" in line.cells:
                    line.cells["miso"] = _hexadecimal(*words[line.at])
            continue
        protocols.append(bus.protocol)
        again = protocols.count(bus.protocol) - 1
        name = ANALYZERS[bus.protocol] + (f" [{again}]" if again else "")
        lines += _lines(own, name, bus, sample)
    lines.sort(key=lambda line: line.at)
    titles = [title for protocol in dict.fromkeys(protocols) for title in COLUMNS[protocol]]
    titles = [*dict.fromkeys(titles), *["error"] * any("error" in line.cells for line in lines)]
    yield (",".join(["name,type,start_time,duration", *(f'"{title}"' for title in titles)]) + "\n").encode()
    begins = seconds_of(np.array([line.at for line in lines], np.int64), clock)
    lengths = seconds_of(np.array([line.end - line.at for line in lines], np.int64), clock)
    for line, begin, length in zip(lines, begins, lengths, strict=True):
        cells = (f'"{line.name}"', f'"{line.kind}"', begin, length, *(line.cells.get(title, "") for title in titles))
        yield (",".join(cells) + "\n").encode()


def _lines(rows: Rows, name: str, bus: Bus, sample: int) -> Iterator[Line]:
    """Yield the lines of one bus, or of one data line of an SPI bus."""
    columns = (rows.event, rows.at, rows.end, rows.value, rows.bits, rows.detail)
    found = list(zip(*(column.tolist() for column in columns), strict=True))
    after = [*((event, end) for event, _, end, *_ in found[1:]), (STOP, 0)]  # the event and end of the next row
    for (event, at, end, value, bits, detail), (next_event, next_end) in zip(found, after, strict=False):
        if event in MARKS:
            yield Line(at, at + sample, name, MARKS[event], {})
        elif event in (ADDRESS, ADDRESS_LOW, DATA):
            read = DETAILS[detail].startswith("read")
            address = 0x78 | value >> 8 if bits == 10 else value
            if next_event not in (ACK, NACK):
                byte = address << 1 | read if event == ADDRESS else value & 0xFF
                yield Line(at, end, name, "data", {"data": f"0x{byte:02X}", "error": "missing ack/nak"})
            elif event == ADDRESS:
                cells = {"ack": _said(next_event == ACK), "address": f"0x{address:02X}", "read": _said(read)}
                yield Line(at, next_end, name, "address", cells)
            else:
                cells = {"ack": _said(next_event == ACK), "data": f"0x{value & 0xFF:02X}"}
                yield Line(at, next_end, name, "data", cells)
        elif event == FRAME:
            faults = DETAILS[detail]
            error = next((said for fault, said in FAULTS.items() if fault in faults), "")
            cells = {"data": _hexadecimal(value, bits)}
            middle = end - bus.glitch  # half a bit before the end of the last stop bit
            yield Line(at, middle, name, "data", cells | {"error": error} if error else cells)
        elif event == WORD:
            yield Line(at, end, name, "result", {bus.role: _hexadecimal(value, bits)})


FAULTS = {"parity error": "parity", "frame error": "framing"}  # if a frame has both faults, only "parity" is shown


def _said(flag: bool) -> str:
    return "true" if flag else "false"


def _hexadecimal(value: int, bits: int) -> str:
    return f"0x{value:0{2 * -(-bits // 8)}X}"
