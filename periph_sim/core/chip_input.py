"""What a chip was given: a cycle and a record go in; its place in the order in which inputs act comes out."""

# core: compiled

from __future__ import annotations

from typing import Protocol, final

from .state import State


@final
class Input:
    """What a chip was given. cycle: from which on it has effect. cause: the record. following: the next one."""

    STATE = State(cycles="cycle", records="cause", made=True)

    __slots__ = ("cause", "cycle", "following")

    def __init__(self) -> None:
        self.cycle = self.cause = 0
        self.following: Input | None = None

    def comes_before(self, other: Input) -> bool:
        """By cycle; by record, where they are of one cycle."""
        return self.cycle < other.cycle or (self.cycle == other.cycle and self.cause < other.cause)


class WriteOrigins(Protocol):
    """mark: of a write to come. out_mark: of the write that the outputs show now; 0 where that is none."""

    mark: int
    out_mark: int
