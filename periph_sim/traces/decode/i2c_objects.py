"""Conversion of rows of an I2C table to the event objects of `decode.i2c`."""

from __future__ import annotations

from collections.abc import Callable

from . import i2c
from .i2c_table import I2cRowKind, I2cTable

PLAIN: dict[I2cRowKind, Callable[[int], i2c.Event]] = {
    I2cRowKind.START: i2c.Start,
    I2cRowKind.REPEATED_START: i2c.RepeatedStart,
    I2cRowKind.ACK: i2c.Ack,
    I2cRowKind.NACK: i2c.Nack,
    I2cRowKind.STOP: i2c.Stop,
}


def events_of_table(table: I2cTable) -> list[i2c.Event]:
    """Return the same events, in the same order, as `i2c.events` finds in the table's capture."""
    columns = (table.kind, table.at, table.last, table.value, table.bits, table.read)
    return [_event(I2cRowKind(kind), *rest) for kind, *rest in zip(*(c.tolist() for c in columns), strict=True)]


def _event(kind: I2cRowKind, at: int, last: int, value: int, bits: int, read: bool) -> i2c.Event:
    if kind is I2cRowKind.ADDRESS:
        return i2c.Address(at, value, read, last)
    if kind is I2cRowKind.DATA or kind is I2cRowKind.ADDRESS_LOW:
        return i2c.Data(at, value & 0xFF, read)
    if kind is I2cRowKind.CUT:
        return i2c.Cut(at, tuple(value >> place & 1 for place in range(bits - 1, -1, -1)))
    return PLAIN[kind](at)
