"""Windows: all records around the worst occurrence of each budget.

    case, verdicts --> ranges of ticks --> one more run, everything recorded --> kept records --> a Window for each
    recorded run, verdicts ------------------------------------------------------^

Runs are deterministic, so the second run has the same occurrences. It ends after the last range, or later
if the STOP of a wrong read comes later. The records in the ranges and shortly before them are kept. Of the earlier
records, only the last one with each combination of `kind`, `where` and `what` is kept: together they are the state at
the start of a range. The needed memory does not grow with the length of the run.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from ....bus.uart.frame_format import UartFormat
from ....core.records import RECORDED, Kind, Record, Recorder
from ....core.time import Timebase
from ....processor.user_code import output_muted
from ....records.run import Run
from ....scene.case.model import Case
from ....scene.firmware_loader import Firmware
from ....scene.plan import ScenePlan
from ....scene.scene import Scene
from ....timing.verdict import Verdict
from ....traces.capture.capture import Capture, Channel, Span, channel_of
from ....traces.drawing.capture_lanes import bit_of
from ....traces.formats.record_table import Clocks, Columns, RecordTable
from .assumed import advance, shortly_before
from .occurrence import event_of, is_interval, is_late, never_came, occurrence

if TYPE_CHECKING:
    from ....records.recording import Subscribe

AROUND = Fraction(5, 1000)  # seconds that are kept before and after an interval; enough for a transfer or a frame
# Seconds that are kept before and after an instant, or a reply that never came; enough for a period of rounds.
WIDE = Fraction(25, 1000)
END_KEPT = Fraction(1, 10)  # seconds of a long occurrence that are kept at each of its ends; the middle is not kept
LEAD = Fraction(25, 1000)  # seconds that are kept before a range, so that a transfer in progress is decoded
BITS = 18  # minimum extent of a picture in bits: two bytes with their ACKs
BIT = Fraction(1, 100_000)  # length of a bit in seconds if there is no SCL

WRONG_BYTES, I2C_BUS = "wrong bytes", "I2C"  # the measure that compares bytes with expected ones, and their bus
# Identification of a wrong byte. On I2C: I2C_BUS, the tick of the phase's START, and the position of the byte in the
# read, from 0. On a serial line: the wire, the tick of the start bit, and 0.
WrongByte = tuple[str, int, int]


@dataclass(frozen=True, eq=False)
class Window:
    """The worst occurrence of a verdict, with everything that was recorded around it. Times are ticks.

    begin, end: the ends of the occurrence; equal if it is an instant.
    drawn: the extent of a picture, which is the occurrence with some room on both sides.
    kept: the ranges of `records`: one, or two if the middle of a long occurrence was not kept.
    records: all records in these ranges, in order of time.
    before: the state before the first range: for each combination of `kind`, `where` and `what`, the last record, in
        order of time. These are levels of wires, values of fields, accesses, spans, service routines and others. If a
        span, wait or service routine has not ended, the value of its record is 1.
    edges: the edges of all wires of the scene; positions are ticks. Levels are known in `kept` and for some time before
        each range.
    start: the tick at which the run began, from which `verdict.at_s` counts.
    chain_texts: the texts of the steps of the explanation; empty without an explanation. A picture shows the fields
        that these texts name.
    modules: a dictionary from units to the names of their modules.
    clocks: the history of SYSCLKOUT of each unit.
    expected: a dictionary from each wrong byte to the expected value.
    formats: a dictionary from serial lines to the length of a bit in ticks and the frame format, at the end of the run.
    assumed: the options that decided undocumented behaviours in a failure or shortly before it; otherwise empty.
    """

    verdict: Verdict
    begin: int
    end: int
    drawn: Span
    kept: tuple[Span, ...]
    records: tuple[Record, ...]
    before: tuple[Record, ...]
    edges: Capture
    timebase: Timebase
    start: int
    chain_texts: tuple[str, ...] = ()
    modules: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    clocks: Clocks = field(default_factory=dict)
    expected: Mapping[WrongByte, int] = field(default_factory=dict)
    formats: Mapping[str, tuple[Fraction, UartFormat]] = field(default_factory=dict)
    assumed: tuple[str, ...] = ()

    @property
    def at(self) -> int:
        """The tick of the verdict's instant, which is time 0 of steps and pictures. It need not be `begin` or `end`."""
        return self.start + round((self.verdict.at_s or 0) * self.timebase.per_second)

    @cached_property
    def all_records(self) -> tuple[Record, ...]:
        """The last records before the first range, followed by the records in the ranges."""
        return (*self.before, *self.records)

    @cached_property
    def by_number(self) -> dict[int, Record]:
        """A dictionary from the numbers of records to the records, in order of number.

        The firmware places of these records have file paths, which the records in `run` lack.
        """
        return {record.number: record for record in sorted(self.all_records, key=lambda r: r.number)}

    @cached_property
    def run(self) -> Run:
        """The records as a recorded run, in which causes can be followed. The firmware places lack file paths."""
        columns = Columns()
        for record in self.by_number.values():
            columns.add(record)
        per_second = Fraction(self.timebase.per_second)
        return Run(columns.table(per_second, self.kept[-1].end, dict(self.modules), self.clocks))

    @property
    def hole(self) -> Span | None:
        """The middle of a long occurrence, for which no records were kept; None if all records were kept."""
        return Span(self.kept[0].end, self.kept[1].begin) if len(self.kept) > 1 else None

    @cached_property
    def expected_on_bus(self) -> dict[tuple[int, int], int]:
        """A dictionary from (tick of the phase's START, position) of each wrong byte on I2C to the expected value."""
        return {(tick, place): value for (bus, tick, place), value in self.expected.items() if bus == I2C_BUS}

    @cached_property
    def lows(self) -> dict[str, list[tuple[int, int]]]:
        """A dictionary from wires to their low times as (fall, rise). The last low time may end with the window."""
        found = {}
        for channel in self.edges.channels:
            moves = [*zip(channel.edges.tolist(), channel.levels.tolist(), strict=True), (self.kept[-1].end, 1)]
            found[channel.name] = [(fall, rise) for (fall, level), (rise, _) in pairwise(moves) if not level]
        return found

    def between(self, begin: int, end: int, *kinds: Kind) -> list[Record]:
        """Return the records from tick `begin` to tick `end`. kinds: the kinds to return; all kinds if empty."""
        return [r for r in self.records if begin <= r.tick <= end and (not kinds or r.kind in kinds)]


@output_muted()
def windows(
    case: Case,
    verdicts: Iterable[Verdict],
    length: Fraction | None = None,
    programs: Mapping[str, Firmware] | None = None,
) -> list[Window]:
    """Run the case once more. Return a Window for each verdict that has an instant, in the order of the verdicts.

    length: the duration of the original run in seconds; None for the duration that the case states.
    programs: a dictionary from units to firmware that is given as functions, as for the Scene of the original run.

    Raise the errors of a Scene and its run.
    """
    wanted = [verdict for verdict in verdicts if verdict.at_s is not None]
    if not wanted:
        return []
    plan = ScenePlan(case)
    timebase, start = plan.ticks.timebase, plan.ticks.start
    end = start + timebase.ticks(case.duration if length is None else length, "nearest")
    keeper = _Keeper(wanted, timebase, start, end)
    failures = [shortly_before(one.begin, one.end, timebase) if one.verdict.broken else None for one in keeper.wanted]

    def subscribe(recorder: Recorder, _: Timebase) -> None:
        recorder.subscribe(RECORDED, keeper.add)
        if any(verdict.measure == WRONG_BYTES for verdict in wanted):
            recorder.subscribe((Kind.DATA,), keeper.expect, things={(Kind.DATA, "expected byte")})

    scene = Scene(plan, subscribe, programs)
    until = keeper.ends
    assumed = advance(scene, until, failures)
    while keeper.awaits_bytes and until < keeper.end:
        until = min(2 * until, keeper.end)
        scene.advance(until)
    found = keeper.windows_of_scene(case, scene)
    return [replace(window, assumed=names) for window, names in zip(found, assumed, strict=True)]


@output_muted()
def windows_of_replay(
    case: Case,
    verdicts: Iterable[Verdict],
    timebase: Timebase,
    start: int,
    end: int,
    repeat: Callable[[Subscribe, int], Scene],
) -> list[Window]:
    """Return a Window for each verdict of a replay that has an instant.

    start, end: the tick from which the instants count, and the last tick of the replay.
    repeat: a function that repeats the replay and returns its scene. Its arguments are a function that subscribes to
        the records, and the tick at which the repeated replay ends.
    """
    keeper = _Keeper(verdicts, timebase, start, end)
    scene = repeat(lambda recorder, _: recorder.subscribe(RECORDED, keeper.add), keeper.ends)
    return keeper.windows_of_scene(case, scene)


def windows_of_table(
    case: str, table: RecordTable, timebase: Timebase, verdicts: Iterable[Verdict], start: int
) -> list[Window]:
    """Return windows from a run that was recorded with all kinds of records.

    start: the tick at which the run began.
    """
    keeper = _Keeper(verdicts, timebase, start, table.end)
    for record in table.records():
        keeper.add(record)
    return keeper.windows(case, dict.fromkeys(table.texts("where", table.rows(Kind.EDGE))), table.modules, table.clocks)


def windows_of_edges(edges: Capture, timebase: Timebase, verdicts: Iterable[Verdict], start: int) -> list[Window]:
    """Return windows from the wires of a run. The only records in these windows are edges.

    edges: the edges of all wires; positions are ticks.
    start: the tick at which the run began.
    """
    keeper = _Keeper(verdicts, timebase, start, edges.length - 1)
    moves = [
        (at, c.name, to) for c in edges.channels for at, to in zip(c.edges.tolist(), c.levels.tolist(), strict=True)
    ]
    for number, (at, name, to) in enumerate(sorted(moves), 1):
        keeper.add(Record(number, at, Kind.EDGE, name, "level", to, "", 0))
    return keeper.windows(str(edges.path), [channel.name for channel in edges.channels], {}, {})


@dataclass(frozen=True)
class _Wanted:
    """The occurrence of a verdict and the ranges of ticks whose records are kept for its window."""

    verdict: Verdict
    begin: int
    end: int
    kept: tuple[Span, ...]


class _Keeper:
    """Receiver of all records of a run in order of creation, which keeps the records around some occurrences."""

    def __init__(self, verdicts: Iterable[Verdict], timebase: Timebase, start: int, end: int) -> None:
        self._timebase = timebase
        self._start, self.end = start, end
        self.wanted = [self._want(verdict) for verdict in verdicts if verdict.at_s is not None]
        lead = timebase.ticks(LEAD, "nearest")
        self._ranges: list[Span] = []  # in order of time; ranges that touch or overlap are merged
        for span in sorted(Span(max(s.begin - lead, start), s.end) for one in self.wanted for s in one.kept):
            if self._ranges and span.begin <= self._ranges[-1].end:
                self._ranges[-1] = Span(self._ranges[-1].begin, max(self._ranges[-1].end, span.end))
            else:
                self._ranges.append(span)
        self._records: list[Record] = []
        self._before: list[dict[object, Record]] = []  # the last records before each range that has begun
        self._seen: dict[object, Record] = {}
        self._expected: dict[WrongByte, int] = {}

    @property
    def ends(self) -> int:
        """The tick after which no record is kept."""
        return self._ranges[-1].end - 1 if self._ranges else self._start

    @property
    def awaits_bytes(self) -> bool:
        """True if the expected bytes of a wrong read are not known yet. They are recorded at the STOP of the read."""
        known = {tick for _, tick, _ in self._expected}
        return any(one.verdict.measure == WRONG_BYTES and one.begin not in known for one in self.wanted)

    def _want(self, verdict: Verdict) -> _Wanted:
        begin, end = occurrence(verdict, self._timebase, self._start)
        around = self._timebase.ticks(AROUND if is_interval(verdict) and not never_came(verdict) else WIDE, "nearest")
        first, last = max(begin - around, self._start), min(end + around, self.end)
        at_each_end = self._timebase.ticks(END_KEPT, "nearest")
        kept: tuple[Span, ...] = (Span(first, last + 1),)
        if end - begin > 2 * at_each_end:
            kept = Span(first, begin + at_each_end), Span(end - at_each_end, last + 1)
        return _Wanted(verdict, begin, end, kept)

    def add(self, record: Record) -> None:
        """Add a record. Records come in order of time, except that a CPU may be ahead by a few cycles."""
        tick, thing = record.tick, record[2:5]
        while len(self._before) < len(self._ranges) and tick >= self._ranges[len(self._before)].begin:
            self._before.append(dict(self._seen))
        if self._before:
            begin, end = self._ranges[len(self._before) - 1]
            if tick < begin:  # this record came after records with later ticks
                self._before[-1][thing] = record
            elif tick < end:
                self._records.append(record)
        self._seen[thing] = record

    def expect(self, record: Record) -> None:
        """Add a record of an expected byte. Its value is the byte's position in the read times 256, plus the byte."""
        place, value = divmod(record.value, 256)
        self._expected[I2C_BUS, record.tick, place] = value

    def windows_of_scene(self, case: Case, scene: Scene) -> list[Window]:
        modules = {name: unit.modules for name, unit in case.unit.items()}
        found = self.windows(case.name, scene.wires, modules, scene.clocks())
        return [replace(window, formats=scene.uart.formats()) for window in found]

    def windows(
        self, name: str, wires: Collection[str], modules: Mapping[str, tuple[str, ...]], clocks: Clocks
    ) -> list[Window]:
        self._before += [self._seen] * (len(self._ranges) - len(self._before))  # no record came in the remaining ranges
        self._records.sort(key=lambda r: r.tick)
        found = (self._window(one, name, wires) for one in self.wanted)
        return [_with_stretch(replace(window, modules=modules, clocks=clocks)) for window in found]

    def _between(self, begin: int, end: int) -> list[Record]:
        """Return the records from tick `begin` up to, but not including, tick `end`."""
        first, last = (bisect_left(self._records, tick, key=lambda r: r.tick) for tick in (begin, end))
        return self._records[first:last]

    def _window(self, one: _Wanted, name: str, wires: Collection[str]) -> Window:
        begins = [max(span.begin, self._start) for span in one.kept]
        ranges = [max(n for n, ours in enumerate(self._ranges) if ours.begin <= begin) for begin in begins]
        first = one.kept[0].begin
        early: dict[object, Record] = {r[2:5]: r for r in self._between(self._ranges[ranges[0]].begin, first)}
        channels = tuple(self._channel(wire, i, one, ranges) for i, wire in enumerate(wires))
        per_second = Fraction(self._timebase.per_second)
        edges = Capture(Path(name), per_second, one.kept[-1].end, channels, sampled=False)
        return Window(
            verdict=one.verdict,
            begin=one.begin,
            end=one.end,
            drawn=self._drawn(one, bit_of(edges, self._timebase.ticks(BIT, "nearest"))),
            kept=one.kept,
            records=tuple(r for span in one.kept for r in self._between(*span)),
            before=tuple(sorted({**self._before[ranges[0]], **early}.values(), key=lambda r: r.tick)),
            edges=edges,
            timebase=self._timebase,
            start=self._start,
            expected=self._expected,
        )

    def _drawn(self, one: _Wanted, bit: int) -> Span:
        """Return the range of ticks that the picture of an occurrence shows. bit: the length of a bit, in ticks.

        An interval is in the middle of the picture. An instant is after the first sixth of the picture. But if the
        instant is the end of a wait that was too long, as for a missed round, the picture begins where the first of the
        ranges `one.kept`, whose records are kept, begins.
        """
        begin = one.kept[0].begin if is_late(one.verdict) else one.begin
        end = one.end
        least, long = BITS * bit, end - begin
        room = max((least - long) // 2 if long else least // 6, long // 10)
        earliest, latest = one.kept[0].begin, one.kept[-1].end - 1
        first = max(begin - room, earliest)
        last = min(max(end + room, first + least), latest)
        return Span(max(min(first, last - least), earliest), last + 1)

    def _channel(self, wire: str, index: int, one: _Wanted, ranges: list[int]) -> Channel:
        """Return the edges of a wire. Between two ranges, the level is unknown."""
        states: dict[int, int | None] = {}
        over = one.kept[0].end
        for place, span in zip(ranges, one.kept, strict=True):
            since, until = self._ranges[place]
            near = [r for r in self._between(since + 1, until) if r.kind is Kind.EDGE and r.where == wire]
            if not states or since > over:
                last = self._before[place].get((Kind.EDGE, wire, "level"))
                states |= {over: None} if states else {}
                states[since] = near[0].value ^ 1 if near else 1 if last is None else last.value
            states |= {r.tick: r.value for r in near if r.tick < span.end}
        return channel_of(wire, index, states.keys(), states.values(), one.kept[-1].end)


def _with_stretch(window: Window) -> Window:
    """Return a window whose occurrence is the stretch, if the verdict is about a stretch; else the window itself.

    Before this call, the occurrence begins with a phase. The stretch is the end of the longest low time of SCL in this
    phase, as long as the worst value.
    """
    event = event_of(window.verdict)
    if event is None or event.how != "stretch" or window.begin == window.end:
        return window
    starts = [r.tick for r in window.records if r.kind is Kind.BUS and r.what in ("repeated START", "STOP")]
    end = window.kept[-1].end
    over = min((tick for tick in starts if tick > window.begin), default=end)
    lows = [(fall, rise) for fall, rise in window.lows["SCL"] if window.begin <= fall < over and rise < end]
    if not lows:
        return window
    fall, rise = max(lows, key=lambda low: low[1] - low[0])
    begin = max(fall, rise - (window.end - window.begin))
    room, middle = (window.drawn.end - window.drawn.begin) // 2, (begin + rise) // 2
    drawn = Span(max(middle - room, window.start), min(middle + room, end))
    return replace(window, begin=begin, end=rise, drawn=drawn)
