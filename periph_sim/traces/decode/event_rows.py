"""Events of all protocols as rows with the same columns, so that several buses of a capture share one list.

I2cTable, UartTable, spi.Event --> Rows (numbers) --> in order of time

Source of the purposes of reserved addresses: UM10204, section 3.1.12, table "Reserved addresses", and sections 3.1.11
(10-bit), 3.1.13 (general call), 3.1.15 (START byte), 3.1.17 (device ID), 5.3 (Hs-mode).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import compress
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..capture.capture import Positions
from . import i2c_table, spi
from .i2c_table import I2cTable
from .table_columns import joined, select
from .uart import UartTable


def purpose_of(byte: int) -> str:
    """Return the purpose of a reserved address; "" for the address of a device.

    byte: the address byte, including the R/W bit.
    """
    high = byte >> 1
    if high == 0:
        return "START byte" if byte & 1 else "general call"
    if high < 4:
        return ("CBUS", "other bus format", "future use")[high - 1]
    if high < 8:
        return "Hs-mode controller code"
    if high >= 0x7C:
        return "device ID"
    return "10-bit" if high >= 0x78 else ""


# The names of events of I2C, in the order of `I2cRowKind`. EVENTS has the names of events of all protocols.
OF_I2C = ("start", "repeated start", "address", "address low", "data", "ack", "nack", "stop", "cut")
OF_SPI = ("select", "word", "deselect")
EVENTS = (*OF_I2C, "frame", "break", "rejected start", *OF_SPI)
FAULTS = [", ".join(compress(("parity error", "frame error", "glitch"), (n & 1, n & 2, n & 4))) for n in range(1, 8)]
# For each address byte, its direction and, for a reserved address, its purpose.
WAYS = [("read" if byte & 1 else "write") + (purpose_of(byte) and ", " + purpose_of(byte)) for byte in range(256)]
DETAILS = tuple(dict.fromkeys(("", "write", "read", *FAULTS, *WAYS)))
START, AGAIN, ADDRESS, ADDRESS_LOW, DATA, ACK, NACK, STOP, CUT = range(len(OF_I2C))
WRITE, READ = 1, 2  # indices into DETAILS
FRAME, BREAK, REJECTED, SELECT, WORD, DESELECT = range(len(OF_I2C), len(EVENTS))

OF_UART = np.array([FRAME, BREAK, CUT, REJECTED], np.uint8)  # for each `UartRowKind`, an index into EVENTS
# For each value of parity error + 2 * frame error + 4 * glitch, an index into DETAILS.
OF_FAULTS = np.array([0, *range(3, 10)], np.uint8)
OF_ADDRESS = np.array([DETAILS.index(way) for way in WAYS], np.uint8)  # for each address byte, an index into DETAILS


class Rows(NamedTuple):
    """A table of events: a tuple of columns, which are arrays of equal length.

    at, end  int64   positions, as in `I2cTable`, `UartTable` and `spi.Event`
    bus      uint8   number of the bus in the list of buses to decode; 0 until the buses are numbered
    event    uint8   index into EVENTS
    value    int32   address, byte or bits; -1 if there is no value. The type is int64 for a data line of an SPI bus
    bits     uint8   number of bits on the wire; but 10 for an "address" whose value has all ten bits (`i2c_rows`)
    detail   uint8   index into DETAILS
    """

    at: Positions
    end: Positions
    bus: NDArray[np.uint8]
    event: NDArray[np.uint8]
    value: NDArray[np.int32] | NDArray[np.int64]
    bits: NDArray[np.uint8]
    detail: NDArray[np.uint8]


def no_rows() -> Rows:
    """Return a table without rows, for a line without events."""
    kinds = (np.int64, np.int64, np.uint8, np.uint8, np.int32, np.uint8, np.uint8)
    return Rows._make(np.empty(0, kind) for kind in kinds)


def i2c_rows(table: I2cTable) -> Rows:
    """Return the rows of an I2C table.

    The detail of a complete or cut byte is its direction. The detail of a reserved address also states its purpose.

    To read from a 10-bit address, a controller sends both bytes of the address with R/W = 0 and, after a repeated
    START, only the upper byte with R/W = 1. The value of the row of this upper byte is the whole address, too, if the
    upper bits are those of the last complete 10-bit address in the same transfer.
    """
    is_byte = (table.bits >= 8) | (table.kind == i2c_table.I2cRowKind.CUT)
    detail = (table.read + np.uint8(1)) * is_byte
    value, bits = table.value.astype(np.int32), table.bits.copy()
    addresses = np.flatnonzero(table.kind == ADDRESS)
    byte = value[addresses] << 1 | table.read[addresses]
    detail[addresses] = OF_ADDRESS[byte]
    again = addresses[byte & 0xF9 == 0xF1]  # address bytes 11110xx with R/W = 1
    if len(again):
        lows, starts = np.flatnonzero(table.kind == ADDRESS_LOW), np.flatnonzero(table.kind == START)
        # `lows` has the rows of the second bytes of 10-bit addresses.
        before = np.searchsorted(lows, again)  # for each row in `again`, the number of rows of `lows` before it
        # `again` keeps the addresses that follow a second byte; `low` has the last second byte before each of them.
        again, low = again[before > 0], lows[before[before > 0] - 1]
        # True if the second address byte and the repeated address are in the same transfer.
        same = np.searchsorted(starts, low) == np.searchsorted(starts, again)
        same &= value[low] >> 8 == value[again] & 3
        value[again[same]] = value[low[same]]
        bits[again[same]] = 10
    return Rows(table.at, table.end, np.zeros_like(table.kind), table.kind, value, bits, detail)


def uart_rows(table: UartTable) -> Rows:
    """Return the rows of a UART table."""
    detail = OF_FAULTS[table.parity_error + 2 * table.frame_error + 4 * table.glitched]
    return Rows(table.at, table.end, np.zeros_like(table.kind), OF_UART[table.kind], table.value, table.bits, detail)


def spi_rows(events: Sequence[spi.Event], is_mosi: bool) -> Rows:
    """Return the rows of one data line of an SPI bus, and the rows of its chip select.

    Raise OverflowError for a word of 2**63 or more, which only a format of 64 bits allows: the column `value` cannot
    hold it.

    is_mosi: True for the line MOSI, False for MISO.
    """
    rows = []
    for one in events:
        value = one.mosi if is_mosi else one.miso
        rows.append((one.at, one.end, 0, EVENTS.index(one.kind), -1 if value is None else value, one.bits, 0))
    kinds = (np.int64, np.int64, np.uint8, np.uint8, np.int64, np.uint8, np.uint8)
    columns = zip(*rows, strict=True) if rows else [()] * len(kinds)
    return Rows._make(np.array(column, kind) for column, kind in zip(columns, kinds, strict=True))


def merged(parts: Sequence[Rows]) -> Rows:
    """Merge all rows in order of time. Rows at the same position are in the order of the parts."""
    if len(parts) == 1:
        return parts[0]
    rows = joined(parts)
    return select(rows, np.argsort(rows.at, kind="stable"))


def grouped(rows: Rows, silence: Sequence[int | None]) -> tuple[Rows, NDArray[np.int64]]:
    """Return the rows grouped by transfers, and the numbers of the rows with which transfers begin.

    silence: for each bus a number of positions; a longer time without events separates two transfers. For a bus with
        None, a transfer begins at each START of an I2C bus, or whenever the chip select of an SPI bus is asserted.

    Transfers are in the order of their first rows.
    """
    parts, keys = [], []
    for bus, quiet in enumerate(silence):
        part = select(rows, rows.bus == bus)
        if quiet is None:
            first = (part.event == START) | (part.event == SELECT)
            first[:1] = True  # an SPI transfer may begin before the capture, so that it has no row "select"
        else:
            first = np.concatenate(([True], part.at[1:] - np.maximum.accumulate(part.end)[:-1] > quiet))[: len(part.at)]
        parts.append(part)
        keys.append(part.at[first][np.cumsum(first) - 1] if len(part.at) else part.at)
    buses = np.concatenate([part.bus for part in parts])
    begins = np.concatenate(keys)
    order = np.lexsort((buses, begins))
    buses, begins = buses[order], begins[order]
    new = np.concatenate(([True], (np.diff(begins) != 0) | (np.diff(buses) != 0)))[: len(order)]
    return select(joined(parts), order), np.flatnonzero(new)


def refusals(rows: Rows) -> NDArray[np.bool_]:
    """Return a mask of the NACK rows in which a target does not acknowledge its address or a byte that it received.

    The NACK with which a controller ends a read is not in the mask. rows: rows as `grouped` returns them.
    """
    found: NDArray[np.bool_] = rows.event == NACK
    found[1:] &= (rows.event[:-1] != DATA) | (rows.detail[:-1] != READ)
    return found


def chosen(rows: Rows, first: NDArray[np.int64], addresses: Collection[int], refused: bool, most: int | None) -> Rows:
    """Return the rows of some transfers in order of time.

    rows, first: rows in which those of each transfer are contiguous, and the number of the first row of each transfer,
        both as `grouped` returns them.
    addresses: only transfers with at least one of these addresses are returned; empty if addresses do not matter.
    refused: True to return only transfers with a NACK of a target (`refusals`), not those in which only the controller
        sends a NACK to end a read.
    most: the maximum number of transfers; only the first ones are returned. None for all. A transfer on an SPI bus
        counts once, although each of its data lines has rows of this transfer.
    """
    lengths = np.diff(np.append(first, len(rows.at)))
    number = np.repeat(np.arange(len(first)), lengths)  # for each row, the number of its transfer
    kept = np.ones(len(first), bool)
    if addresses:
        has_address = (rows.event == ADDRESS) | (rows.event == ADDRESS_LOW)
        kept &= np.isin(np.arange(len(first)), number[has_address & np.isin(rows.value, list(addresses))])
    if refused:
        kept &= np.isin(np.arange(len(first)), number[refusals(rows)])
    if most is not None:
        begins = rows.at[first[kept]]
        shared = (rows.event[first[kept]] >= SELECT) & (np.diff(begins, prepend=-1) == 0)
        kept[kept] = np.cumsum(~shared) <= most
    some = select(rows, kept[number])
    return select(some, np.argsort(some.at, kind="stable"))
