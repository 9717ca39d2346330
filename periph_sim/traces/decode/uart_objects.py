"""Conversion of rows of a UART table to the event objects of `decode.uart`."""

from __future__ import annotations

from . import uart
from .uart_table import UartRowKind, UartTable


def events_of_table(table: UartTable) -> list[uart.Event]:
    """Return the same events, in the same order, as `uart.events` finds in the table's capture."""
    return [
        _event(UartRowKind(kind), *rest) for kind, *rest in zip(*(column.tolist() for column in table), strict=True)
    ]


def _event(
    kind: UartRowKind, at: int, end: int, value: int, bits: int, parity: bool, frame: bool, glitched: bool, unsure: int
) -> uart.Event:
    if kind is UartRowKind.FRAME:
        return uart.Frame(at, end, value, parity, frame, glitched, unsure)
    if kind is UartRowKind.BREAK:
        return uart.Break(at, end)
    if kind is UartRowKind.REJECTED:
        return uart.RejectedStart(at, end)
    return uart.CutFrame(at, tuple(value >> place & 1 for place in range(bits)))
