"""Load of the CPU or the bus: its busy time as a share of the run or of the busiest window.

    busy      ──┐__┌─────┐___┌─┐_________
    of the run                              all of it
    per 20 ms    |--- W ---|                the window of that length, wherever it begins, with the most in it

The busiest window begins with a busy stretch or ends with one, so only those are evaluated.
"""

# core: compiled

from __future__ import annotations

from collections import deque
from fractions import Fraction

from ...core.records import UNWANTED, Kind
from ...core.state import State
from ...core.time import NO_TIME
from ...form.c_types import BigInt
from .measure import MILLIONTHS, Measure
from .measured_scene import MeasuredScene

WAIT, ROUTINE = 0, 1  # tags of records of a CPU
BEGINS, ENDS = 0, 1  # and of records of a bus
BUS_TAGS = {"START": BEGINS, "STOP": ENDS, "arbitration lost": ENDS}


class Load(Measure):
    """Share of the time, in millionths. window: its length in seconds; None for the whole run."""

    STATE = State(ticks="_since _stretches _begins")
    looks_back = "the whole run"
    unit = "%"
    series = False

    def __init__(self, window: Fraction | None = None) -> None:
        super().__init__()
        self._seconds = window
        self._window = 0  # ticks
        self._busy = 0
        self._since = NO_TIME  # begin of the busy stretch under way
        self._began = 0
        self._stretches: deque[tuple[int, int]] = deque()  # those that a later window may overlap
        self._begins: deque[int] = deque()  # of windows that are not over yet

    def listen(self, scene: MeasuredScene) -> None:
        self._began = scene.began()
        if self._seconds is not None:
            self._window = round(self._seconds * scene.ticks_per_second())
            self._begins.append(self._began)

    def begins(self, at: int) -> None:
        """Begin a busy stretch, unless one is under way."""
        if self._since == NO_TIME:
            if self._window:
                self._pass(at)
                self._begins.append(at)
            self._since = at

    def ends(self, at: int) -> None:
        if self._since == NO_TIME:
            return
        self._busy += at - self._since
        if self._window:
            self._pass(at)
            self._stretches.append((self._since, at))
        self._since = NO_TIME
        if self._window:
            self._look(at - self._window)

    def _pass(self, now: int) -> None:
        """Evaluate the windows that are over by now."""
        while self._begins and self._begins[0] + self._window <= now:
            self._look(self._begins.popleft())
        while self._stretches and self._stretches[0][1] <= now - self._window:
            self._stretches.popleft()

    def _look(self, begin: int) -> None:
        """Evaluate the window that begins there, if it is inside the run."""
        if begin < self._began:
            return
        end = begin + self._window
        busy = 0
        for began, ended in self._stretches:
            busy += max(0, min(end, ended) - max(begin, began))
        if self._since != NO_TIME:
            busy += max(0, end - max(begin, self._since))
        part = _millionths(busy, self._window)
        if not self.count or part > self.worst:
            self.worst = self.least = part
            self.worst_at = self.least_at = begin
        self.count += 1

    def finish(self, now: int) -> None:
        busy = self._since != NO_TIME
        if self._window:
            self._pass(now)
            self._look(now - self._window)
            self.count = min(self.count, 1)
            return
        whole = now - self._began
        self.count = int(whole > 0)
        self.worst = self.least = _millionths(self._busy + (now - self._since if busy else 0), whole) if whole else 0
        self.worst_at = self.least_at = now

    def why_silent(self) -> str:
        return "the run is shorter than its window" if self._window else ""


def _millionths(busy: BigInt, whole: BigInt) -> BigInt:
    return (2 * busy * MILLIONTHS + whole) // (2 * whole)


class CpuLoad(Load):
    """Share of the time in which a CPU's firmware does not wait: outside of spins and IDLE."""

    STATE = State("_under_way")
    kinds = frozenset({Kind.IRQ, Kind.WAIT})

    def __init__(self, unit: str, window: Fraction | None = None) -> None:
        super().__init__(window)
        self._unit = unit
        self._under_way: list[int] = []  # waits and service routines, the inner ones last

    def listen(self, scene: MeasuredScene) -> None:
        super().listen(scene)
        self.begins(scene.began())

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if where != self._unit:
            return UNWANTED
        return WAIT if kind is Kind.WAIT else ROUTINE

    def on_record(self, tag: int, tick: int, value: int) -> None:
        under_way = self._under_way
        if value:
            under_way.append(tag)
        elif under_way and under_way[-1] == tag:
            under_way.pop()
        elif tag in under_way:
            del under_way[len(under_way) - 1 - under_way[::-1].index(tag) :]
        if under_way and under_way[-1] == WAIT:
            self.ends(tick)
        else:
            self.begins(tick)


class BusLoad(Load):
    """Share of the time between a START and its STOP, of any controller."""

    needs = "I2C-A"
    kinds = frozenset({Kind.BUS})

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        return BUS_TAGS.get(what, UNWANTED)

    def on_record(self, tag: int, tick: int, value: int) -> None:
        if tag == BEGINS:
            self.begins(tick)
        else:
            self.ends(tick)
