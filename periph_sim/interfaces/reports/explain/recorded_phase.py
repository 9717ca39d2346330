"""A phase of a transfer, as the records around an occurrence show it."""

from __future__ import annotations

from dataclasses import dataclass

from ....core.records import Record


@dataclass(frozen=True)
class RecordedPhase:
    """A phase of a transfer according to the records: from a START or repeated START to the next START or STOP.

    name: the name of the addressed device; "" if unknown.
    start: "START" or "repeated START".
    answered: the tick at which SCL falls after the ACK bit of the address; None if the phase or the records end before
        this tick.
    data: the records of the bytes after the address.
    """

    name: str
    begin: int
    end: int
    address: int
    read: bool
    acked: bool
    answered: int | None
    start: str
    data: tuple[Record, ...]

    def __str__(self) -> str:
        """Format the phase: "gyroscope (0x68 R)", or "0x68 R" if no name is known."""
        asked = f"0x{self.address:02X} {'R' if self.read else 'W'}"
        return f"{self.name} ({asked})" if self.name else asked
