"""Formatting of records as text, and decoding of the values of BUS records.

The value of a BUS record with a byte is the byte, shifted left by one; its lowest bit is the acknowledge bit, 1 for
NACK. Examples of a record's kind, `what` and value, and of its text. The last record also has `field` = "SCD":

BUS address 0x1A1               "controller: 0x68 W NACK (gyroscope)"
BUS byte 0x22                   "controller: 0x11 ACK (gyroscope)"
FLAG I2CSTR.SDIR 1              "I2C-A.I2CSTR.SDIR set"
ACCESS W I2C-A.I2CSTR 0x5638    "I2C-A.I2CSTR written, 0x5638 (SCD = 1)"
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..core.phrases import addressed
from ..core.records import TIMED_OUT, Kind, Record
from ..core.registers import Field
from .register_maps import register_of

GAVE_UP = "gave up (timeout)"
IN_FIRMWARE = (Kind.ACCESS, Kind.IRQ, Kind.SPAN, Kind.WAIT)  # `text`: a place in the firmware, "" or TIMED_OUT


class BusByte(NamedTuple):
    """A byte on the bus with its acknowledge bit.

    value: the value of the byte; for an address byte, the 7-bit address without the R/W bit.
    read: the R/W bit of an address byte; None for other bytes.
    """

    value: int
    acked: bool
    read: bool | None = None

    def __str__(self) -> str:
        """Return the byte as text: "0x68 R ACK", "0x11 NACK"."""
        byte = f"0x{self.value:02X}" if self.read is None else addressed(self.value, self.read)
        return f"{byte} {'ACK' if self.acked else 'NACK'}"


def bus_byte(record: Record) -> BusByte | None:
    """Return the byte of a BUS record; None for a record without a byte, such as START and STOP."""
    value, acked = record.value >> 1, not record.value & 1
    if record.what == "address":
        return BusByte(value >> 1, acked, bool(value & 1))
    return BusByte(value, acked) if record.what == "byte" else None


def on_the_bus(record: Record) -> str:
    """Return what was on the line at a BUS or FRAME record as text: "START", "0x68 R ACK", "0x55", "frame", "cut"."""
    if record.kind is Kind.FRAME:
        return (
            "frame" if record.what == "begin" else record.what if record.what in PAIR_PARTS else f"0x{record.value:02X}"
        )
    carried = bus_byte(record)
    return record.what if carried is None else str(carried)


def happened(record: Record) -> str:
    """Return a record as text without its unit, time and place in the firmware: "I2C-A.I2CSTR.SDIR set"."""
    return _SAID[record.kind](record)


def happened_where(record: Record) -> str:
    """Return a record as text with its unit: "dsp.I2C-A.I2CSTR.SDIR set", "dsp: SCIRXINTA entered at sci_received:76".

    If the record has a place in the firmware, the text ends with this place. FLAG records have a place only if they are
    changes of variables.
    """
    said = happened(record)
    if record.kind is Kind.FLAG:
        unit, dot, _ = record.where.partition(".")
        return f"{unit}{dot}{said}{f' at {record.text}' if record.text else ''}"
    if record.kind not in IN_FIRMWARE:
        return f"{record.where}: {said}" if record.kind is Kind.NOTE else said
    has_place = record.text and not has_timed_out(record)
    return f"{record.where}: {said}{f' at {record.text}' if has_place else ''}"


def number(value: int) -> str:
    """Return a field's value as text: decimal up to 9, else hexadecimal."""
    return str(value) if 0 <= value < 10 else f"{value:#x}"


def _edge(record: Record) -> str:
    by = f", pulled low by {record.text}" if record.text and not record.value else ""
    return f"{record.where} {'rises' if record.value else 'falls'}{by}"


def _access(record: Record) -> str:
    way, _, name = record.what.partition(" ")
    f = _field(*name.partition(".")[::2], record.field)
    named = "" if f is None else f" ({f.name} = {number(f.extract(record.value))})"
    return f"{name} {'read' if way == 'R' else 'written'}, {record.value:#06x}{named}"


def _flag(record: Record) -> str:
    module = record.where.partition(".")[2] or record.where
    f = _field(module, *record.what.partition(".")[::2])
    if f is not None and f.msb == f.lsb:
        return f"{module}.{record.what} {'set' if record.value else 'cleared'}"
    return f"{module}.{record.what} = {number(record.value)}"


def _field(module: str, register: str, name: str) -> Field | None:
    known = register_of(module, register)
    return known[name] if known is not None and name in known else None


def has_timed_out(record: Record) -> bool:
    """Return True if the record is the end of a wait that timed out."""
    return record.kind is Kind.WAIT and not record.value and record.text == TIMED_OUT


def _wait(record: Record) -> str:
    return f"wait for {record.what} {'begins' if record.value else GAVE_UP if has_timed_out(record) else 'is over'}"


def _frame(record: Record) -> str:
    if record.what in PAIR_PARTS:
        return f"{record.where}: {PAIR_PARTS[record.what]}, {record.text}"
    return f"{record.where}: {on_the_bus(record)}{FRAME_PARTS[record.what]}"


FRAME_PARTS = {"byte": "", "begin": " begins", "end": " is over", "error": " is over, with an error"}
PAIR_PARTS = {"cut": "a frame is cut by its driver", "collision": "a collision"}

_SAID: dict[Kind, Callable[[Record], str]] = {
    Kind.EDGE: _edge,
    Kind.HOLD: lambda r: f"{r.where} stays low, held by {r.text}",
    Kind.ACCESS: _access,
    Kind.FLAG: _flag,
    Kind.IRQ: lambda r: f"{r.what} {'entered' if r.value else 'left'}",
    Kind.SPAN: lambda r: f"span {r.what} {'begins' if r.value else 'ends'}",
    Kind.WAIT: _wait,
    Kind.BUS: lambda r: f"{r.where}: {on_the_bus(r)}{f' ({r.text})' if r.text else ''}",
    Kind.FRAME: _frame,
    Kind.NOTE: lambda r: f"note: {r.text}" if r.text else f"note {r.what}",
}
