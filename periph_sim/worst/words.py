"""Records in words: a record goes in, what happened as a phrase comes out."""

from __future__ import annotations

from collections.abc import Callable

from ..core.records import Kind, Record
from ..insight.maps import register_of


def happened(record: Record) -> str:
    """What a record says, without time and place in the firmware: "I2C-A.I2CSTR.SDIR set"."""
    return _SAID[record.kind](record)


def _edge(record: Record) -> str:
    by = f", pulled by {record.text}" if record.text and not record.value else ""
    return f"{record.where} {'rises' if record.value else 'falls'}{by}"


def _access(record: Record) -> str:
    way, _, register = record.what.partition(" ")
    return f"{register} {'read' if way == 'R' else 'written'}, {record.value:#x}"


def _flag(record: Record) -> str:
    module, what = record.where.partition(".")[2] or record.where, record.what
    if _is_bit(module, what):
        return f"{module}.{what} {'set' if record.value else 'cleared'}"
    return f"{module}.{what} = {record.value if record.value < 10 else f'{record.value:#x}'}"


def _is_bit(module: str, what: str) -> bool:
    name, _, field = what.partition(".")
    register = register_of(module, name)
    return register is not None and field in register and register[field].msb == register[field].lsb


def _bus(record: Record) -> str:
    """Value of an address: address, R/W, NACK from bit 2 down; of a byte: byte, NACK."""
    value, nack = record.value >> 1, record.value & 1
    if record.what == "address":
        read = "read" if value & 1 else "write"
        return f"{record.text}: address {value >> 1:02X} {read}, {'not acknowledged' if nack else 'acknowledged'}"
    if record.what == "byte":
        return f"{record.text}: byte {value:02X}"
    return f"{record.text}: {record.what}" if record.text else record.what


_SAID: dict[Kind, Callable[[Record], str]] = {
    Kind.EDGE: _edge,
    Kind.ACCESS: _access,
    Kind.FLAG: _flag,
    Kind.IRQ: lambda r: f"{r.what} {'entered' if r.value else 'left'}",
    Kind.SPAN: lambda r: f"span {r.what} {'begins' if r.value else 'ends'}",
    Kind.WAIT: lambda r: f"wait for {r.what} {'begins' if r.value else 'is over'}",
    Kind.BUS: _bus,
    Kind.FRAME: lambda r: f"byte {r.value:02X} from {r.where}",
    Kind.NOTE: lambda r: f"note: {r.text}" if r.text else f"note {r.what}",
}
