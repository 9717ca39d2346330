"""Measures of the time in a state.

They measure the duration of each occurrence of the state, the sum of these durations, or the share of this sum in the
run or in its busiest window.

    wire SCL low   ──┐______┌──────┐___┌──     each: 6 and 3      time in: 9
                       |--- W ---|             share of any W: the share in the busiest window W

If the state already holds when the run begins, it is not known when it began. The time from the start of the run to the
end of the state is then part of the sum, but not a value of "each". If the state lasts for the whole run, however, the
length of the run is a value of "each".
"""

# core: compiled

from __future__ import annotations

from collections import deque
from fractions import Fraction
from typing import TYPE_CHECKING, final

from msgspec import Struct

from ...core.records import Kind
from ...core.state import State
from ...core.time import NO_TIME
from ...form.c_types import BigInt
from ..language.matcher import EVERYTHING, Matcher
from .event import EventMeasure
from .measure import MILLIONTHS, MeasuredScene

if TYPE_CHECKING:
    from .event import TopicTests

WAIT, ROUTINE = 0, 1  # indices in `StateEvents.nests`


class StateEvents(Struct, frozen=True):
    """The events that define a state.

    enters: the events that begin the state.
    leaves: the events that end the state. A record that is also an event in `enters` does not end the state.
    nests: the events of waits and of service routines, which define the state of a CPU without `enters` and `leaves`.
        A record of such an event has the value 1 at the start and 0 at the end of the wait or routine. Waits and
        routines can be nested. The CPU is idle while the innermost of them is a wait.
    is_idle: for the state of a CPU: True if the state is "idle", False if it is "busy".
    """

    text: str
    enters: tuple[Matcher, ...] = ()
    leaves: tuple[Matcher, ...] = ()
    nests: tuple[Matcher, ...] = ()
    is_idle: bool = False

    @property
    def free(self) -> bool:
        """True if the state is a span whose name is not checked against the spans of the firmware."""
        return bool(self.enters) and self.enters[0].free

    def holds(self, scene: MeasuredScene) -> bool:
        """Return True if a scene in which nothing has happened yet is in this state."""
        if self.nests:
            return not self.is_idle
        first = self.enters[0]
        (place, *_) = first.where or ("",)
        if first.kind is Kind.EDGE:
            return scene.wire(place).level == first.want
        if first.kind is Kind.FLAG:
            return first.mask == EVERYTHING and scene.value_of(place, first.what) == first.want
        return first.kind is Kind.BUS and first.what == "STOP"  # a bus without any START is free, as after a STOP


@final
class BusiestWindow:
    """Finds the window of a given length in which a state lasts longest.

    At least one window with the largest share begins or ends together with the state or the run. So only such windows
    are evaluated.

    most: the largest share so far of the state in a window, in millionths; -1 until the first window is over.
    begin: the tick at which this window begins.
    """

    STATE = State(ticks="_since _stretches _begins")

    def __init__(self, length: int, began: int) -> None:
        self.length = length
        self.most = -1
        self.begin = NO_TIME
        self._began = began
        self._since = NO_TIME  # the tick since which the state holds; NO_TIME if it does not hold
        # (begin, end) of past intervals in the state. Intervals that no unfinished window can overlap are removed.
        self._stretches: deque[tuple[int, int]] = deque()
        self._begins: deque[int] = deque([began])  # the ticks at which unfinished windows begin

    def begins(self, at: int) -> None:
        self._pass(at)
        self._begins.append(at)
        self._since = at

    def ends(self, at: int) -> None:
        self._pass(at)
        self._stretches.append((self._since, at))
        self._since = NO_TIME
        self._look(at - self.length)

    def finish(self, now: int) -> None:
        self._pass(now)
        self._look(now - self.length)

    def _pass(self, now: int) -> None:
        """Evaluate the windows that are over by now."""
        while self._begins and self._begins[0] + self.length <= now:
            self._look(self._begins.popleft())
        while self._stretches and self._stretches[0][1] <= now - self.length:
            self._stretches.popleft()

    def _look(self, begin: int) -> None:
        """Evaluate the window that begins at the tick `begin`. Do nothing if this tick is before the run."""
        if begin < self._began:
            return
        end = begin + self.length
        busy = 0
        for began, ended in self._stretches:
            busy += max(0, min(end, ended) - max(begin, began))
        if self._since != NO_TIME:
            busy += max(0, end - max(begin, self._since))
        share = _millionths(busy, self.length)
        if share > self.most:
            self.most, self.begin = share, begin


class TimeIn(EventMeasure):
    """Time in a state, from its start to its end. For a span, the time in service routines is included.

    form: each   the duration of each occurrence of the state, except of one that had begun before the run
          time   the sum of all durations
          share  the share of the state in the run, or in the busiest window, in millionths
    window: the length of the window in seconds; None for the run.
    """

    STATE = State("_whole _windows _under_way", ticks="_since")

    def __init__(self, state: StateEvents, form: str, window: Fraction | None = None) -> None:
        super().__init__(*state.enters, *state.leaves, *state.nests)
        self.state = state
        self.series = form == "each"
        self._is_share: bool = form == "share"
        if self._is_share:
            self.unit = "%"
            self.looks_back = "the whole run"
        self._nests = bool(state.nests)
        self._is_idle: bool = state.is_idle
        self._under_way: list[int] = []  # the waits and service routines in progress, the innermost of them last
        self._enters = len(state.enters)  # number of events that begin the state; `matchers` begins with these events
        self._since = NO_TIME
        self._whole = False  # True if the state in progress began during the run, not before it
        self._began = 0
        self._entered = False  # True if the state has occurred at least once
        self._lasted = 0  # for a share, the total duration of the state so far; the share is computed at the run's end
        self._seconds = window
        self._windows: BusiestWindow | None = None

    @property
    def silent(self) -> bool:
        """True if nothing was measured. If the state never occurred, a sum has the measured value 0.

        If the state is a span whose name is not checked, a sum of 0 does not count as measured, because the name may be
        misspelled.
        """
        return not self.count and (self.series or self._is_share or self.state.free)

    def listen(self, scene: MeasuredScene) -> None:
        self._began = scene.began
        if self._seconds is not None:
            self._windows = BusiestWindow(round(self._seconds * scene.ticks_per_second), self._began)
        if self.state.holds(scene):
            self._begins(self._began, False)

    def on_record(self, tag: int, tick: int, value: int) -> None:
        """Handle a record that may begin or end the state. If the record can do both, it begins the state.

        The events of a state are never limited to one event in a group.
        """
        if self.spans is not None and self._names[tag]:
            self.spans.add(self._names[tag])
        plan = self._plans[tag]
        enters = leaves = False
        one: TopicTests
        for one in plan:
            if self._nests:
                enters = self._is_idle == self._waits(one.place, value)
                leaves = not enters
            elif one.test is not None and one.test.fits(value):
                if one.place < self._enters:
                    enters = True
                else:
                    leaves = True
        if enters:
            if self._since == NO_TIME:
                self._begins(tick, True)
        elif leaves and self._since != NO_TIME:
            self._ends(tick)

    def _waits(self, place: int, value: int) -> bool:
        """Store the start or the end of a wait or service routine. Return True if the CPU waits after this event.

        place: WAIT or ROUTINE. value: 1 for the start, 0 for the end.
        """
        under_way = self._under_way
        if value:
            under_way.append(place)
        elif under_way and under_way[-1] == place:
            under_way.pop()
        elif place in under_way:
            del under_way[len(under_way) - 1 - under_way[::-1].index(place) :]
        return bool(under_way) and under_way[-1] == WAIT

    def _begins(self, at: int, seen: bool) -> None:
        self._since, self._whole = at, seen
        if self._windows is not None:
            self._windows.begins(at)
        self._entered = True
        if not self.series and not self._is_share:
            if not self.count:
                self.worst_at = self.least_at = at
            self.count += 1

    def _ends(self, at: int) -> None:
        """Handle the end of the state in progress at tick `at`, because the state is left or the run ends."""
        since, self._since = self._since, NO_TIME
        if self._windows is not None:
            self._windows.ends(at)
        if self._is_share:
            self._lasted += at - since
        elif not self.series:
            self.worst = self.least = self.worst + at - since
        elif self._whole:
            self.take(at - since, since)

    def finish(self, now: int) -> None:
        if self._windows is not None:
            windows = self._windows
            windows.finish(now)
            self._be_share(windows.most, windows.begin)
            return
        if self._since != NO_TIME and not self.series:
            self._ends(now)
        if self._is_share:
            whole = now - self._began
            self._be_share(_millionths(self._lasted, whole) if whole else -1, now)

    def _be_share(self, share: int, at: int) -> None:
        """Take the share as the only value.

        Take no value if the share is -1, or if the state is a span with an unchecked name that never began. This name
        may be misspelled, so a share of 0 proves nothing.
        """
        self.count = int(share >= 0 and (self._entered or not self.state.free))
        self.worst = self.least = max(0, share)
        self.worst_at = self.least_at = at

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return [] if self._since == NO_TIME or self._is_share else [(now - self._since, self._since)]

    def unfinished_text(self) -> str:
        return f"{self.state.text!r} still lasted when the run ended"

    def why_silent(self) -> str:
        if self._windows is not None and self._windows.most < 0:
            return "the run is shorter than its window"
        if self.state.free:
            return self.unmatched(list(self.state.enters[:1]))
        return "" if self._is_share else f"{self.state.text!r} was never entered and left"


def _millionths(busy: BigInt, whole: BigInt) -> BigInt:
    return (2 * busy * MILLIONTHS + whole) // (2 * whole)
