"""Decoder of asynchronous serial frames: from the edges of one line to frames and breaks.

An oracle: it shares no code with the SCI model.

           ___     ___ ___ ___ ... ___ ___
    idle      \\___/___X___X___X ...___/        start bit, data (least significant first), parity, stop
            |   '   '   '   '        '
            at  mid-bit: where each bit is sampled

Rules: a falling edge starts a frame. Each bit is sampled once, in its middle (the first sample not before
it, the bits counted from half a sample before the first low one, since the edge is between two samples), or
three times around it, and the majority counts. A start bit that is sampled high is a rejected start. Only the
first stop bit is checked, and the next falling edge after its sample starts the next frame. A low phase of at
least a whole frame is a break, in addition to its frame.

A pulse of less than half a bit is a glitch. If it is at a place at which receivers sample a bit, they may
read that bit either way, and the line does not show which.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..capture.capture import Capture
from .uart_line import PARITIES, Line
from .uart_table import UartRowKind, UartTable, uart_table

__all__ = ["PARITIES", "Break", "CutFrame", "Event", "Frame", "Line", "RejectedStart", "events"]


@dataclass(frozen=True, slots=True)
class Frame:
    """at: the start edge. end: the end of its last stop bit. value: the first data bit is the least significant.

    glitched: True with a glitch between the start edge and the end of the first stop bit. unsure: the bits that
    receivers may read differently because of a glitch, as a mask: bit 0 the start bit, then data, parity and the
    first stop bit.
    """

    at: int
    end: int
    value: int
    parity_error: bool
    frame_error: bool
    glitched: bool = False
    unsure: int = 0


@dataclass(frozen=True, slots=True)
class Break:
    """The line was low from `at` to `end`, a whole frame or longer."""

    at: int
    end: int


@dataclass(frozen=True, slots=True)
class CutFrame:
    """A frame cut by the end of the capture or of its known part. bits: data bits received, least significant first."""

    at: int
    bits: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class RejectedStart:
    """The line left idle at `at`, but not for a start bit; `end`: its first return."""

    at: int
    end: int


Event = Frame | Break | CutFrame | RejectedStart


def events(capture: Capture, channel: str | int, line: Line, vote: bool = False) -> list[Event]:
    """Decode the events of one channel, in the order of their begins, a frame before the break it is part of.

    vote: each bit is the majority of three samples. LookupError for a missing channel; ValueError if the capture has
    no rate, or under two samples a bit.
    """
    return events_of_table(uart_table(capture, channel, line, vote=vote))


def events_of_table(table: UartTable) -> list[Event]:
    """Return the rows of a table as events."""
    return [
        _event(UartRowKind(kind), *rest) for kind, *rest in zip(*(column.tolist() for column in table), strict=True)
    ]


def _event(
    kind: UartRowKind, at: int, end: int, value: int, bits: int, parity: bool, frame: bool, glitched: bool, unsure: int
) -> Event:
    if kind is UartRowKind.FRAME:
        return Frame(at, end, value, parity, frame, glitched, unsure)
    if kind is UartRowKind.BREAK:
        return Break(at, end)
    if kind is UartRowKind.REJECTED:
        return RejectedStart(at, end)
    return CutFrame(at, tuple(value >> place & 1 for place in range(bits)))
