"""Straight-line code of a run: records of the firmware go in; what ran between two instants, and how evenly, comes out.

    accesses, spans, waits --> marks: when, where in the firmware, and whose statements ran since the mark before

Two rounds are laid beside each other, mark by mark: code that took another number of cycles in the second one, or went
another way, is not constant.
"""

from __future__ import annotations

import sys
from bisect import bisect_left, bisect_right
from fractions import Fraction
from functools import cache
from types import CodeType, FrameType
from typing import NamedTuple

from msgspec import Struct

from ...processor.source_location import is_ours


class Ran(NamedTuple):
    """Statements of a function that ran. begin, end: its lines before and after, where it went on from one to the other
    without returning; 0: all of it may have run."""

    code: CodeType
    begin: int = 0
    end: int = 0


Stack = list[tuple[FrameType, int]]  # frames and their lines, the outermost first


class Mark(Struct, frozen=True):
    """waited: the time up to here was a wait's. ran: what ran since the mark before."""

    tick: int
    what: str
    waited: bool
    ran: frozenset[Ran]


class CodeTrace:
    """Marks of one CPU, in order of time. depth: frames from the outermost on that do not count, being interrupted."""

    def __init__(self, depth: int = 0) -> None:
        self.marks: list[Mark] = []
        self._ticks: list[int] = []  # of the marks
        self._depth = depth
        self._uneven: dict[int, str] = {}  # a mark's number -> what is not constant about the code before it
        self._last: Stack = []

    def note(self, tick: int, what: str, waited: bool = False) -> None:
        """The firmware, which is running now, has come to this point.

        Not for a write, which lands while other code runs.
        """
        stack = firmware_stack()[self._depth :]
        self.marks.append(Mark(tick, what, waited, between(self._last, stack)))
        self._ticks.append(tick)
        self._last = stack

    def amend(self, tick: int) -> None:
        """The last mark was not the last of its kind: it moves to `tick`."""
        last, stack = self.marks[-1], firmware_stack()[self._depth :]
        self.marks[-1] = Mark(tick, last.what, last.waited, last.ran | between(self._last, stack))
        self._ticks[-1] = tick
        self._last = stack

    def forget(self) -> None:
        """Let go of the firmware's frames."""
        self._last = []

    def compare(self, first: int, second: int, cycle: Fraction) -> None:
        """Lay the marks from number `second` on beside those from `first` up to there. cycle: ticks of one."""
        marks = self.marks
        for place in range(1, second - first):
            now, again = marks[first + place], (marks + [None] * (second - first))[second + place]
            before, before_again = marks[first + place - 1], marks[second + place - 1]
            why = ""
            if again is None:
                why = f"the code before {now.what} ran once only"
            elif now.what != again.what or now.waited != again.waited:
                why = f"one round came to {now.what}, the next to {again.what}"
            elif not now.waited:
                cycles = [round((to.tick - since.tick) / cycle) for since, to in ((before, now), (before_again, again))]
                if cycles[0] != cycles[1]:
                    why = f"the code before {now.what} took {cycles[0]} cycles once and {cycles[1]} another time"
            if why:
                self._uneven[first + place] = self._uneven[second + place] = why
            if again is None or now.what != again.what:
                break

    def uneven(self, begin: int, end: int) -> tuple[str, ...]:
        """What is not constant about the code between two instants."""
        found = [self._uneven[place] for place in self._inside(begin, end) if place in self._uneven]
        return tuple(dict.fromkeys(found))

    def ran(self, begin: int, end: int) -> frozenset[Ran]:
        """What ran between two instants."""
        return frozenset().union(*(self.marks[place].ran for place in self._inside(begin, end)))

    def _inside(self, begin: int, end: int) -> range:
        """The marks behind `begin`, up to the first that is not before `end`."""
        ticks = self._ticks
        return range(bisect_right(ticks, begin), min(bisect_left(ticks, end) + 1, len(ticks)))


_ours = cache(is_ours)  # of a few files, frame by frame of every access


def firmware_stack() -> Stack:
    """Where the firmware is; frames of our own are left out."""
    found = []
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        if not _ours(frame.f_code.co_filename):
            found.append((frame, frame.f_lineno))
        frame = frame.f_back
    return found[::-1]


def between(before: Stack, now: Stack) -> frozenset[Ran]:
    """What ran between two stacks: functions that returned, that were called, and the one that did both."""
    same = 0
    while same < min(len(before), len(now)) and before[same][0] is now[same][0]:
        same += 1
    ran = {Ran(frame.f_code) for frame, _ in (*before[same:], *now[same:])}
    if same:
        ran.add(Ran(now[same - 1][0].f_code, before[same - 1][1], now[same - 1][1]))
    return frozenset(ran)
