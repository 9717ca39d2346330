"""Inputs of a chip that have not had their effect yet, ordered by cycle and record."""

# core: compiled

from __future__ import annotations

from typing import Protocol, final

from .state import State


@final
class Input:
    """One input of a chip. cycle: when its effect begins. cause: its record. following: the next input."""

    STATE = State(cycles="cycle", records="cause", made=True)

    __slots__ = ("cause", "cycle", "following")

    def __init__(self) -> None:
        self.cycle = self.cause = 0
        self.following: Input | None = None

    def comes_before(self, other: Input) -> bool:
        """Return True if this input comes first: by cycle, and by record within one cycle."""
        return self.cycle < other.cycle or (self.cycle == other.cycle and self.cause < other.cause)


class WriteOrigins(Protocol):
    """mark: record of the next write. out_mark: record of the write that the outputs show now; 0 for none."""

    mark: int
    out_mark: int
