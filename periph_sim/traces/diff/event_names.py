"""Events on a bus as words without times, in groups.

    I2C   START, address 53 W, ACK, byte 1D, ACK, STOP     a group is a transfer
    UART  41, 0D FE, break                                 a group is one frame

Two captures of the same behaviour give the same words, even if their rates and timing differ.
"""

from __future__ import annotations

from typing import NamedTuple

from ..capture.capture import Capture
from ..decode import i2c, uart
from ..decode.i2c_table import I2cRowKind
from ..decode.uart import UartRowKind


class Event(NamedTuple):
    """An event. kind: its type. word: the text that is compared. at: its position in the capture."""

    kind: str
    word: str
    at: int


Group = list[Event]


def i2c_groups(capture: Capture, scl: str | int, sda: str | int) -> list[Group]:
    """Return the transfers of a capture from its first START on. Raise LookupError for a missing channel."""
    groups: list[Group] = []
    for event in i2c.events(capture, scl, sda):
        if event.kind is I2cRowKind.START:
            groups.append([])
        groups[-1].append(_i2c_event(event))
    return groups


def uart_groups(capture: Capture, channel: str | int, line: uart.Line) -> list[Group]:
    """Return each frame and break of a line as a group. Rejected starts are left out.

    Errors are those of `decode.uart.events`.
    """
    digits = (line.bits + 3) // 4
    events = uart.events(capture, channel, line)
    return [[_uart_event(event, digits)] for event in events if event.kind is not UartRowKind.REJECTED]


def _i2c_event(event: i2c.Event) -> Event:
    kind = i2c.NAMES[event.kind]
    detail = ""
    if event.kind is I2cRowKind.ADDRESS:
        detail = f" {event.value:02X} {'R' if event.read else 'W'}"
    elif event.kind is I2cRowKind.DATA:
        detail = f" {event.value:02X}"
    elif event.kind is I2cRowKind.CUT:
        detail = f" {event.value:0{event.bits}b}"
    return Event(kind, kind + detail, event.at)


def _uart_event(event: uart.Event, digits: int) -> Event:
    if event.kind is UartRowKind.FRAME:
        word = f"{event.value:0{digits}X}{' PE' * event.parity_error}{' FE' * event.frame_error}"
        return Event("frame", word, event.at)
    if event.kind is UartRowKind.BREAK:
        return Event("break", "break", event.at)
    received = f"{event.value:0{event.bits}b}"[::-1] if event.bits else ""
    return Event("cut frame", f"cut frame {received}", event.at)
