"""Inputs of a chip that have not had their effect yet, ordered by cycle and record."""

# core: compiled

from __future__ import annotations

from typing import Protocol, final

from .state import State

MAX_INPUTS = 64  # inputs that may wait; a chip that never wakes needs no more


@final
class Input:
    """One input of a chip.

    cycle: the cycle in which its effect begins.
    cause: the number of the record of the input.
    following: the next input in the chain.
    """

    STATE = State(cycles="cycle", records="cause", made=True)

    __slots__ = ("cause", "cycle", "following")

    def __init__(self) -> None:
        self.cycle = self.cause = 0
        self.following: Input | None = None

    def comes_before(self, other: Input) -> bool:
        """Return True if this input is before `other`, in order of cycles, and of records within one cycle."""
        return self.cycle < other.cycle or (self.cycle == other.cycle and self.cause < other.cause)


@final
class WaitingInputs:
    """The inputs of a chip that wait for their effect, in order of cycles, and of records within one cycle.

    last_cause: the number of the record of the last input that had its effect.
    """

    STATE = State("_count _last", records="last_cause", chains="_first")

    __slots__ = ("_count", "_first", "_last", "_spare", "last_cause")

    def __init__(self) -> None:
        self.last_cause = 0
        self._count = 0
        self._first: Input | None = None
        self._last: Input | None = None
        self._spare: Input | None = None  # a chain of inputs to use again

    def add(self, cycle: int, cause: int) -> None:
        """Add an input that has its effect from `cycle` on. cause: the number of its record; 0: nothing is added."""
        given = self._spare
        if not cause:
            return
        if given is None:
            given = Input()
        else:
            self._spare = given.following
        given.cycle, given.cause = cycle, cause
        before = self._last
        if before is not None and given.comes_before(before):  # this is rare
            before, after = None, self._first
            while after is not None and not given.comes_before(after):
                before, after = after, after.following
        if before is None:
            given.following, self._first = self._first, given
        else:
            given.following, before.following = before.following, given
        if given.following is None:
            self._last = given
        self._count += 1
        if self._count > MAX_INPUTS:
            self._take_first()

    def cause_at(self, cycle: int) -> int:
        """Return the number of the record of the last input that had its effect by `cycle`."""
        while self._first is not None and self._first.cycle <= cycle:
            self.last_cause = self._first.cause
            self._take_first()
        return self.last_cause

    def _take_first(self) -> None:
        """Remove the first waiting input."""
        first = self._first
        assert first is not None
        self._first = first.following
        if first.following is None:
            self._last = None
        first.following, self._spare = self._spare, first
        self._count -= 1


class WriteOrigins(Protocol):
    """Origins of writes to a chip, as numbers of records.

    mark: the record of the next write.
    out_mark: the record of the write that the outputs show now; 0 for none.
    """

    mark: int
    out_mark: int
