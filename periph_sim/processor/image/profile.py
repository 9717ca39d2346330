"""Profile of an image: time by stack of functions.

CallStack --called, returned--> Profile <--slept-- ImageProgram
                                   '-- stacks: (outermost, ..., innermost) -> ticks, and ticks asleep
"""

from __future__ import annotations

from collections import Counter

from msgspec import Struct

from .call_stack import CallListener

Stack = tuple[str, ...]


class FunctionTime(Struct, frozen=True):
    """Time of a function, in ticks. own: in its own code. total: with called functions and interrupts.

    waits: part of `own` asleep in IDLE or in a wait whose passes were skipped. calls: number of calls.
    """

    name: str
    calls: int
    own: int
    total: int
    waits: int


class Profile(CallListener):
    """stacks: ticks by stack. waits: part of them asleep. calls: number by function."""

    __slots__ = ("_since", "_stack", "calls", "stacks", "waits")

    def __init__(self) -> None:
        self.stacks: Counter[Stack] = Counter()
        self.waits: Counter[Stack] = Counter()
        self.calls: Counter[str] = Counter()
        self._stack: Stack = ()
        self._since = 0

    def called(self, name: str, tick: int) -> None:
        self._count(tick)
        self._stack = (*self._stack, name)
        self.calls[name] += 1

    def returned(self, name: str, tick: int) -> None:
        self._count(tick)
        self._stack = self._stack[:-1]

    def slept(self, ticks: int) -> None:
        """Count a time without instructions."""
        self.waits[self._stack] += ticks

    def finish(self, tick: int) -> None:
        """Count the time up to the end of the run."""
        self._count(tick)

    def _count(self, tick: int) -> None:
        if tick > self._since:
            self.stacks[self._stack] += tick - self._since
            self._since = tick

    def functions(self) -> list[FunctionTime]:
        """Return the times of all functions that were called, in descending order of their own time."""
        own, total, waits = (Counter[str]() for _ in range(3))
        for stack, ticks in self.stacks.items():
            if stack:
                own[stack[-1]] += ticks
            for name in set(stack):
                total[name] += ticks
        for stack, ticks in self.waits.items():
            if stack:
                waits[stack[-1]] += ticks
        found = [FunctionTime(name, self.calls[name], own[name], total[name], waits[name]) for name in self.calls]
        return sorted(found, key=lambda one: (-one.own, -one.total, one.name))
