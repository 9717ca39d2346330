"""Conversion of drawings to captures, one character per sample (`-` high, `_` low), and of events to tuples."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

from periph_sim.traces.capture.capture import Capture, Channel, channel_of
from periph_sim.traces.decode.i2c import Event

LEVELS = {"-": 1, "_": 0, "?": None}


def drawn(drawing: str, rate: int | None = 1_000_000) -> Capture:
    """Return the capture of a drawing. A line is a name and levels; `?` is unknown; `|` and spaces are ignored."""
    channels: list[Channel] = []
    length = 0
    for row in drawing.strip().splitlines():
        name, _, wave = row.strip().partition(" ")
        states = [LEVELS[mark] for mark in wave.replace(" ", "").replace("|", "")]
        length = length or len(states)
        assert len(states) == length, f"{name} has {len(states)} samples, the line above {length}"
        channels.append(channel_of(name, len(channels), range(length), states, length))
    return Capture(Path("drawing"), None if rate is None else Fraction(rate), length, tuple(channels))


def of_bytes(samples: bytes, names: tuple[str, ...], rate: int = 1_000_000) -> Capture:
    """Return a capture of these samples, with channel k in bit k."""
    channels = tuple(
        channel_of(name, bit, range(len(samples)), [sample >> bit & 1 for sample in samples], len(samples))
        for bit, name in enumerate(names)
    )
    return Capture(Path("samples"), Fraction(rate), len(samples), channels)


Plain = tuple[object, ...]


def plain(events: Iterable[Event]) -> list[Plain]:
    """Name and position of each I2C event, value and direction of each byte, and position of an address's R/W bit."""
    found: list[Plain] = []
    for event in events:
        more: Plain = ()
        if event.kind.name == "CUT":
            more = (tuple(event.value >> place & 1 for place in reversed(range(event.bits))),)
        elif event.kind.name in ("ADDRESS", "DATA"):
            more = event.value, event.read, *([event.last] if event.kind.name == "ADDRESS" else [])
        found.append((event.kind.name, event.at, *more))
    return found
