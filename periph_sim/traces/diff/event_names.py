"""Events on a bus as words without times, in groups.

    I2C   START, address 53 W, ACK, byte 1D, ACK, STOP     a group is a transfer
    UART  41, 0D FE, break                                 a group is one frame

Two captures of the same behaviour give the same words, even if their rates and timing differ.
"""

from __future__ import annotations

from typing import NamedTuple

from ..capture.capture import Capture
from ..decode import i2c, uart


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
        if isinstance(event, i2c.Start):
            groups.append([])
        groups[-1].append(_i2c_event(event))
    return groups


def uart_groups(capture: Capture, channel: str | int, line: uart.Line) -> list[Group]:
    """Return each frame and break of a line as a group. Rejected starts are left out.

    Errors are those of `decode.uart.events`.
    """
    digits = (line.bits + 3) // 4
    events = uart.events(capture, channel, line)
    return [[_uart_event(event, digits)] for event in events if not isinstance(event, uart.RejectedStart)]


def _i2c_event(event: i2c.Event) -> Event:
    match event:
        case i2c.Start(at):
            return Event("START", "START", at)
        case i2c.RepeatedStart(at):
            return Event("repeated START", "repeated START", at)
        case i2c.Address(at, value, read):
            return Event("address", f"address {value:02X} {'R' if read else 'W'}", at)
        case i2c.Data(at, value):
            return Event("byte", f"byte {value:02X}", at)
        case i2c.Ack(at):
            return Event("ACK", "ACK", at)
        case i2c.Nack(at):
            return Event("NACK", "NACK", at)
        case i2c.Stop(at):
            return Event("STOP", "STOP", at)
        case i2c.Cut(at, bits):
            return Event("cut byte", f"cut byte {''.join(map(str, bits))}", at)


def _uart_event(event: uart.Frame | uart.Break | uart.CutFrame, digits: int) -> Event:
    match event:
        case uart.Frame(at, _, value, parity_error, frame_error):
            return Event("frame", f"{value:0{digits}X}{' PE' * parity_error}{' FE' * frame_error}", at)
        case uart.Break(at):
            return Event("break", "break", at)
        case uart.CutFrame(at, bits):
            return Event("cut frame", f"cut frame {''.join(map(str, bits))}", at)
