"""Measures of named events: a measure's text and a scope go in, a Measure that listens to just those records comes out.

    text --language--> Said --events--> Matchers --> Measure, told of records of their kinds only

Each class says what it measures. Of two events at one time the one recorded first is the earlier one.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable

from ..core.records import Kind, Record, Subjects
from ..core.time import NO_TIME
from ..devices.sensor_head import Round
from ..f28335.pie_map import LINES
from .events import Event, Matcher, matcher, start_of_transfer
from .language import Said, measure_of, name_text
from .measures import MILLIONTHS, Counter, Happenings, Measure
from .names import BadEvent, Scope
from .of_events import OfEvents, span_hint, subjects_of
from .race_measures import ClearedAlong, LostFlags, Race, clearing, losing, raced
from .states import EachTimeIn, State, TimeIn
from .value_measures import ValueDeviation


class Between(OfEvents):
    """From each event to the next of another kind; with a rule, only to one in the same transfer or round.

    A transfer lasts from its START to the next transfer's START, so that what firmware does about a STOP belongs
    to it; a round from its first START to the next round's.
    """

    def __init__(self, begin: Matcher, end: Matcher, rule: str, start: Matcher | None) -> None:
        super().__init__(begin, end)
        self._begin, self._end = begin, end
        self._rule = rule
        self._start = start
        if start is not None:
            self.kinds |= {start.kind}
        self._per_group = 1  # STARTs
        self._starts = 0
        self._waiting = array("q")

    def listen(self, scene: Happenings) -> None:
        if self._rule == "same round":
            self._per_group = scene.transfers_in_round()
            self._starts = -scene.startup_transfers()

    def in_groups_of(self, transfers: int) -> None:
        """How many transfers a round has, where no scene says it."""
        self._per_group = transfers

    def record(self, record: Record) -> None:
        if self._start is not None and self._start.fits(record):
            if self._starts % self._per_group == 0:
                del self._waiting[:]
            self._starts += 1
        self.hear(record)
        if self._end.fits(record):
            self.seen[1] += 1
            if self._waiting:
                for began in self._waiting:
                    self.take(record.tick - began, began)
                del self._waiting[:]
        if self._begin.fits(record):
            self.seen[0] += 1
            if self._start is None or self._starts > 0:
                self._waiting.append(record.tick)

    def waits(self) -> tuple[int, str]:
        if self._start is not None or not self._waiting:  # in a transfer or round, not every first has a second
            return NO_TIME, ""
        return self._waiting[0], f"{self._begin.text!r} still waited for {self._end.text!r} when the run ended"

    def missing(self) -> str:
        if all(self.seen):
            where = "" if self._start is None else f" in the {self._rule}"
            return f"no {self._begin.text!r} was followed by {self._end.text!r}{where}"
        return super().missing()


class Period(OfEvents):
    """From an event to the next of its kind."""

    def __init__(self, event: Matcher) -> None:
        super().__init__(event)
        self._event = event
        self._last = NO_TIME

    def record(self, record: Record) -> None:
        self.hear(record)
        if self._event.fits(record):
            self.seen[0] += 1
            last, self._last = self._last, record.tick
            if last != NO_TIME:
                self.passed(record.tick - last, last)

    def passed(self, period: int, began: int) -> None:
        self.take(period, began)

    def waits(self) -> tuple[int, str]:
        return self._last, f"{self.matchers[0].text!r} did not come again before the run ended"


class Jitter(Period):
    """How much a period differs from the one before (cycle-to-cycle jitter)."""

    def __init__(self, event: Matcher) -> None:
        super().__init__(event)
        self._before = NO_TIME

    def passed(self, period: int, began: int) -> None:
        before, self._before = self._before, period
        if before != NO_TIME:
            self.take(abs(period - before), began)

    def waits(self) -> tuple[int, str]:
        return NO_TIME, ""


class EventCount(Counter):
    """How often an event happened. Zero counts, but for names that are free text, where it may be a slip."""

    def __init__(self, event: Matcher) -> None:
        super().__init__()
        self.kinds = frozenset({event.kind})
        self.event = event
        self._spans: set[str] = set()

    @property
    def subjects(self) -> Subjects:
        return subjects_of([self.event])

    def record(self, record: Record) -> None:
        if self.event.fits(record):
            self.one_more(record.tick)
        elif self.event.free:
            self._spans.add(record.what)

    @property
    def silent(self) -> bool:
        return self.event.free and not self.count

    def missing(self) -> str:
        return f"no event matched {self.event.text!r}; {span_hint(self.event, self._spans)}"


class Level(OfEvents):
    """Value of a register field whenever it changed: the words in a FIFO, the bits left to count."""

    unit = "value"

    def __init__(self, change: Matcher) -> None:
        super().__init__(change)
        self._change = change

    def record(self, record: Record) -> None:
        if self._change.fits(record):
            self.seen[0] += 1
            self.take(record.value, record.tick)


class Load(Measure):
    """A part of the run's time, in millionths."""

    unit = "%"
    series = False

    def _came_to(self, busy: int, whole: int, at: int) -> None:
        self.count = int(whole > 0)
        self.worst = self.least = (2 * busy * MILLIONTHS + whole) // (2 * whole) if whole else 0
        self.worst_at = self.least_at = at


class CpuLoad(Load):
    """The CPU's part in computations and service routines; waits in spins and IDLE are the rest.

    A computation counts from its begin on, whole; a service routine when it is left.
    """

    kinds = frozenset({Kind.IRQ})

    def __init__(self, unit: str) -> None:
        super().__init__()
        self._unit = unit
        self._depth = 0
        self._entered = 0
        self._twice = 0  # computations of service routines, which are in the routines' own time, too

    def listen(self, scene: Happenings) -> None:
        self._cycles: Callable[[], tuple[int, int]] = lambda: scene.cpu_cycles(self._unit)
        self._began = self._cycles()

    def record(self, record: Record) -> None:
        if record.where != self._unit:
            return
        if record.value:
            if not self._depth:
                self._entered = self._cycles()[0]
            self._depth += 1
        elif self._depth:
            self._depth -= 1
            if not self._depth:
                self._twice += self._cycles()[0] - self._entered

    def finish(self, now: int) -> None:
        busy, passed = (now - before for now, before in zip(self._cycles(), self._began, strict=True))
        self._came_to(min(busy - self._twice, passed), passed, now)


class BusLoad(Load):
    """The part of the time between a START of the controller and its STOP."""

    needs = "controller"
    kinds = frozenset({Kind.BUS})

    def __init__(self) -> None:
        super().__init__()
        self._busy = 0
        self._since = NO_TIME
        self._began = 0

    def listen(self, scene: Happenings) -> None:
        self._began = scene.began()

    def record(self, record: Record) -> None:
        if record.what == "START":
            self._since = record.tick
        elif self._since != NO_TIME and record.what in ("STOP", "arbitration lost"):
            self._over(record.tick)

    def _over(self, now: int) -> None:
        self._busy += now - self._since
        self._since = NO_TIME

    def finish(self, now: int) -> None:
        if self._since != NO_TIME:
            self._over(now)
        self._came_to(self._busy, now - self._began, now)


class Slack(Measure):
    """From a round's last STOP to the moment at which the next round is due; negative where it came too late."""

    needs = "controller"

    def listen(self, scene: Happenings) -> None:
        self._period = scene.round_period()
        scene.listen_rounds(self._round)

    def _round(self, over: Round) -> None:
        self.take(over.due + self._period - over.end, over.end)

    def missing(self) -> str:
        return "no round was completed"


def make_of_events(text: str, scope: Scope) -> Measure:
    """The measure that a text names. BadEvent if it names none, or events that this scene cannot have."""
    said = measure_of(text)
    return _MADE[said.form](said, scope)


def _between(said: Said, scope: Scope) -> Measure:
    begin, end = (matcher(event, scope) for event in said.events)
    if said.rule == "next":
        return Between(begin, end, said.rule, None)
    if not scope.controller:
        raise BadEvent(f"{said.rule!r} needs a controller in the scene, which has none; write next")
    return Between(begin, end, said.rule, start_of_transfer(scope))


def _level(said: Said, scope: Scope) -> Measure:
    text = f"flag {name_text(said.unit, said.name)} change"
    return Level(matcher(Event("flag", text, said.unit, said.name, "change"), scope))


def _latency(said: Said, scope: Scope) -> Measure:
    """From the rise of its flag in PIEIFR, when the module asks, to the first instruction of its service routine."""
    unit = scope.vector(said.unit, said.name)
    if said.name not in LINES:
        raise BadEvent(f"{said.name} does not come through the PIE, so nothing records when it was asked for")
    group, line = LINES[said.name]
    asked = f"PIE.PIEIFR{group}.INTx{line}"
    begin = Event("flag", f"flag {name_text(said.unit, asked)} rise", unit, asked, "rise")
    end = Event("interrupt", f"interrupt {name_text(said.unit, said.name)} enter", unit, said.name, "enter")
    return Between(matcher(begin, scope), matcher(end, scope), "next", None)


def _state(said: Said, scope: Scope) -> State:
    assert said.state is not None
    enters, leaves = ([matcher(e, scope) for e in events] for events in (said.state.enters, said.state.leaves))
    return State(said.state.text, tuple(enters), tuple(leaves))


_MADE: dict[str, Callable[[Said, Scope], Measure]] = {
    "from": _between,
    "period": lambda said, scope: Period(matcher(said.events[0], scope)),
    "jitter": lambda said, scope: Jitter(matcher(said.events[0], scope)),
    "count": lambda said, scope: EventCount(matcher(said.events[0], scope)),
    "level": _level,
    "interrupt": _latency,
    "time": lambda said, scope: TimeIn(_state(said, scope)),
    "each": lambda said, scope: EachTimeIn(_state(said, scope)),
    "cpu": lambda said, scope: CpuLoad(scope.unit(said.unit)),
    "bus": lambda said, scope: BusLoad(),
    "slack": lambda said, scope: Slack(),
    "race": lambda said, scope: Race(raced(said.unit, said.name, scope)),
    "cleared": lambda said, scope: ClearedAlong(clearing(said.unit, said.name, scope)),
    "value": lambda said, scope: ValueDeviation(said.name, said.rule == "frame"),
    "lost": lambda said, scope: LostFlags(losing(said.unit, said.name, scope)),
}
