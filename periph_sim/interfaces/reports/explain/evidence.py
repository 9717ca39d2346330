"""Queries of the records in a Window that all explanations use: the bus, and the firmware and the flags of a unit.

Window, case --> Evidence: phases on the bus, low phases of SCL, accesses, changes of flags, and Steps for these
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import islice, pairwise

from ....core.phrases import addressed
from ....core.records import Kind, Record
from ....devices.targets import eeprom
from ....f28335.i2c.descriptor import I2C_A
from ....records.cause_trace.causes import Link, holders, walk_back, wire_rows
from ....records.record_text import IN_FIRMWARE, BusByte, bus_byte, happened
from ....scene.case.model import Case
from ....scene.context import CaseTicks
from .chain import Chain, FirmwarePlace, Part, Step, place_of
from .cpu_activity import CODE, DOING, Stretch, all_episodes, episodes, phrase, timeline, units
from .window import Window

I2C, SCI = I2C_A.name, "SCI-A"
SMALL = Fraction(1, 100)  # a wait or a service routine is listed if it takes more than this share of an occurrence
LONG = Fraction(1, 10**6)  # in seconds; code without a record that takes longer than this is listed separately
BACK = 16  # maximum number of causes that are followed back from an end of an occurrence
MOST = 12  # maximum number of listed service routines, spans and waits of an occurrence; the longest are listed


@dataclass(frozen=True)
class RecordedPhase:
    """A phase of a transfer in the records: from a START or repeated START to the next one, a STOP or lost arbitration.

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
        asked = addressed(self.address, self.read)
        return f"{self.name} ({asked})" if self.name else asked


class Evidence:
    """Queries of the records around an occurrence.

    window: the window of the occurrence.
    unit: the unit whose firmware and flags the queries are about; by default the first unit with firmware records.
    span: a function that formats a length in ticks.
    """

    def __init__(self, window: Window, case: Case, unit: str | None = None) -> None:
        self.window = window
        self.case = case
        self.span = window.timebase.show
        there = [name for name in case.unit if name in units(window)] or [*case.unit]
        self.unit = unit or (there[0] if there else "")

    def for_unit(self, unit: str) -> Evidence:
        """Return the evidence about another unit."""
        return Evidence(self.window, self.case, unit)

    # Firmware ---------------------------------------------------------------------

    def timeline(self, begin: int, end: int) -> list[Stretch]:
        return [part for one in timeline(self.window, self.unit, begin, end) for part in self._between_accesses(one)]

    def _between_accesses(self, one: Stretch) -> list[Stretch]:
        """Divide a stretch of unnamed code at the actions of the firmware that were recorded (see `_done`).

        A part that is longer than LONG is named after the next action, or after the last action if no other follows.
        """
        if one.doing != CODE or one.where:
            return [one]
        least = self.window.timebase.ticks(LONG, "nearest")
        found = []
        for last, then in pairwise((None, *self._done, None)):
            begin = one.begin if last is None else max(last.tick, one.begin)
            end = one.end if then is None else min(then.tick, one.end)
            near = then or last
            if near is not None and end - begin > least:
                access = near.kind is Kind.ACCESS
                activity = happened(near).partition(",")[0] if access else phrase(DOING[near.kind], near.what)
                what = f"code {'after' if then is None else 'before'} {activity}"
                found.append(Stretch(begin, end, CODE, what, near.text, begin))
            elif begin < end:
                found.append(replace(one, begin=begin, end=end))
        return found

    @cached_property
    def _done(self) -> list[Record]:
        """The accesses, starts of spans and starts of waits outside service routines, if their place is known."""
        records = [r for r in self.window.all_records if r.where == self.unit and r.kind in IN_FIRMWARE]
        found, routines = [], 0
        for record in sorted(records, key=in_time):
            if record.kind is Kind.IRQ:
                routines = max(0, routines + (1 if record.value else -1))
            elif not routines and record.text and (record.value or record.kind is Kind.ACCESS):
                found.append(record)
        return found

    def activity_at(self, tick: int) -> Stretch | None:
        """Return the innermost service routine, span or wait in progress at a tick; None if there is none."""
        return next(reversed(all_episodes(self.window, self.unit, tick, tick + 1)), None)

    def doing_at(self, tick: int) -> tuple[str, FirmwarePlace | None]:
        """Return the firmware's activity at a tick as a phrase, and its place.

        If no service routine, span or wait is in progress, the phrase names the last access before the tick, if any.
        """
        part = self.blame_at(tick)
        if part is not None:
            return f"{part}, begun {self.span(part.length)} before", part.place
        last = next((r for r in reversed(self._done) if r.tick <= tick and r.kind is Kind.ACCESS), None)
        if last is None or tick - last.tick <= self.slip:
            return "other code", None
        what = happened(last).partition(",")[0]
        return f"other code, {self.span(tick - last.tick)} after {what}", place_of(last.text)

    def doing_step(self, tick: int) -> Step:
        """Return a step for the firmware's activity at a tick."""
        what, place = self.doing_at(tick)
        return self.say(tick, f"{self.unit}: {what}", None, place)

    def blame_at(self, tick: int) -> Part | None:
        """Return the firmware's activity at a tick as a cause; None if no activity is in progress."""
        top = self.activity_at(tick)
        return None if top is None else Part(top.doing, top.what, tick - top.begin, 1, place_of(top.where))

    def accesses(self, begin: int, end: int, what: str) -> list[Record]:
        """Return the accesses with the text `what`, such as "R I2C-A.I2CDRR", from tick `begin` to tick `end`.

        The last such access before the window is included if it is in this range.
        """
        alike = (r for r in self.window.all_records if (r.kind, r.where, r.what) == (Kind.ACCESS, self.unit, what))
        return [r for r in alike if begin <= r.tick <= end]

    def flags(self, begin: int, end: int, *fields: str) -> list[Record]:
        """Return the changes of some fields of the unit's SCI-A from tick `begin` to tick `end`."""
        changes = self.window.between(begin, end, Kind.FLAG)
        return [r for r in changes if r.where == f"{self.unit}.{SCI}" and r.what in fields]

    def last_access(self, tick: int, what: str) -> Record | None:
        """Return the last access `what`, such as "R I2C-A.I2CDRR", up to a tick; None if there is no such access."""
        return self.last(tick, Kind.ACCESS, self.unit, what)

    def last_change(self, tick: int, field: str, module: str = I2C) -> tuple[Record, Record] | None:
        """Return the last change of a field up to a tick, and the access that caused the change at the same tick.

        If no access caused the change, the second record is the change itself. Return None if there was no change.
        """
        change = self.last(tick, Kind.FLAG, f"{self.unit}.{module}", field)
        if change is None:
            return None
        cause = self.window.by_number.get(change.cause, change)
        return change, cause if cause.kind is Kind.ACCESS and cause.tick == change.tick else change

    def last_set(self, tick: int, field: str) -> Record | None:
        """Return the last change of a field of the I2C module up to a tick.

        Return None if this change cleared the field, or if the field has not changed.
        """
        change = self.last(tick, Kind.FLAG, f"{self.unit}.{I2C}", field)
        return change if change is not None and change.value else None

    def last(self, tick: int, kind: Kind, where: str, what: str | None = None) -> Record | None:
        """Return the last record up to a tick with these values of `kind`, `where` and `what`; None if there is none.

        The record may be from before the window. If `what` is None, only `kind` and `where` must match.
        """
        run = self.window.run
        row = run.last(run.rows(kind, where, what), tick)
        return None if row is None else self.window.by_number[int(run.table.number[row])]

    # Bus --------------------------------------------------------------------------

    @cached_property
    def phases(self) -> list[RecordedPhase]:
        """All phases of transfers whose START or repeated START is in the window."""
        found: list[RecordedPhase] = []
        records = [r for r in self.window.records if r.kind is Kind.BUS]
        starts = [i for i, r in enumerate(records) if r.what in ("START", "repeated START")]
        for i in starts:
            over = next((j for j in range(i + 1, len(records)) if records[j].what in ENDS), len(records))
            inside = records[i + 1 : over]
            address = next((r for r in inside if r.what == "address"), None)
            sent = NO_ADDRESS if address is None else bus_byte(address) or NO_ADDRESS
            end = records[over].tick if over < len(records) else self.window.kept[-1].end - 1
            found.append(
                RecordedPhase(
                    name=self.devices.get(sent.value, records[i].text),
                    begin=records[i].tick,
                    end=end,
                    address=sent.value,
                    read=bool(sent.read),
                    acked=sent.acked,
                    answered=None if address is None else address.tick,
                    start=records[i].what,
                    data=tuple(r for r in inside if r.what == "byte"),
                )
            )
        return found

    def phase_at(self, tick: int) -> RecordedPhase | None:
        """Return the phase that is in progress on the bus at a tick; None if there is none."""
        return next((p for p in reversed(self.phases) if p.begin <= tick <= p.end), None)

    @cached_property
    def devices(self) -> dict[int, str]:
        """A dictionary from addresses to the names of the case's devices. A memory may have several addresses."""
        tables = self.case.device.items()
        names = {table.address: name for name, table in tables if table.address is not None}
        for name, table in tables:
            if table.model in eeprom.MODELS:
                first = eeprom.FIRST if table.address is None else table.address
                names |= dict.fromkeys(range(first, first + eeprom.blocks_of(table.model)), name)
        return names

    def holder_at(self, tick: int) -> str:
        """Return the unit or device that holds SCL low at a tick.

        If the records do not name the holder, return the device that the transfer addresses. Without a transfer, or if
        the address is not that of a device, return the unit.
        """
        run = self.window.run
        row = run.last(wire_rows(run, "SCL"), tick)
        names = () if row is None else holders(run, row, run.record(row))
        named = [name.partition(".")[0] for name in names if name != "controller"]
        phase = self.phase_at(tick)
        return named[0] if named else self.unit if phase is None else self.devices.get(phase.address, self.unit)

    @cached_property
    def low(self) -> int:
        """The low time of SCL for a bit without stretching, in ticks; 0 if it is unknown.

        If the case has no controller, this is the shortest low phase of SCL in the window.
        """
        table = self.case.controller
        if table is None:
            end = self.window.kept[-1].end
            return min((rise - fall for fall, rise in self.window.lows.get("SCL", []) if rise < end), default=0)
        return self.window.timebase.ticks(table.low or Fraction(1, 2) / table.rate, "nearest")

    def due_before(self, due: int) -> int:
        """Return the tick at which the previous round was due; `due` if there are no rounds.

        due: the tick at which a round is due.
        """
        ticks, controller = CaseTicks(self.case, self.window.timebase, self.window.start), self.case.controller
        starts = ticks.starts("rounds") or ()
        table = controller or self.case.rounds
        ppm = Fraction(0) if controller is None else controller.ppm
        period = 0 if table is None else int(ticks.exact_ticks(table.period, ppm))
        return max((start for start in starts if start < due), default=due - period)

    def stretches(self, begin: int, end: int) -> list[tuple[int, int]]:
        """Return the stretches of SCL between two ticks.

        Each is a pair of ticks: the end of the controller's own low time, and the rise of SCL. A low time that is only
        one tick longer than the controller's is no stretch, because the ticks of edges may be rounded.
        """
        return [
            (max(fall + self.low, begin), min(rise, end))
            for fall, rise in self.window.lows.get("SCL", [])
            if fall + self.low < end and begin < rise and rise - fall > self.low + 1 > 1
        ]

    def low_since(self, wire: str, tick: int) -> int | None:
        """Return the last tick, up to `tick`, at which a wire fell; None if the wire is high or does not exist."""
        return next((fall for fall, rise in self.window.lows.get(wire, []) if fall <= tick < rise), None)

    # Causes -----------------------------------------------------------------------

    def walk(self, record: Record, depth: int = BACK) -> Iterator[tuple[Record, Link]]:
        """Yield a record and its causes, going back in time, each with its link (see `records.cause_trace`).

        If a link is `aside`, its record is not a cause. It explains the record that was yielded before.
        """
        row = self.window.run.row_of(record.number)
        for link in walk_back(self.window.run, row, depth) if row is not None else ():
            yield self.window.by_number[link.record.number], link

    def causes(self, record: Record, since: int) -> list[Step]:
        """Return steps for the causes of a record.

        The two nearest causes are included, together with records whose links are `aside` (see `walk`). Earlier causes
        are included if they are not before tick `since`. Of consecutive edges and events of the bus, only the last one
        is included.
        """
        steps, number, effect = [], 0, record
        for cause, link in islice(self.walk(record), 1, None):
            near = number < 2 or (cause.tick >= since and not link.aside)
            if near and not (cause.kind in ON_WIRES and effect.kind in ON_WIRES):
                steps.append(self.step(cause, f"{happened(cause)} ({link.because.partition(';')[0]})"))
            number, effect = (number, effect) if link.aside else (number + 1, cause)
        return steps

    # Steps ------------------------------------------------------------------------

    def chain(self, steps: tuple[Step, ...], parts: tuple[Part, ...] = (), blame: Part | None = None) -> Chain:
        """Build the explanation of this occurrence. parts: empty if the occurrence has no length."""
        return Chain(
            verdict=self.window.verdict,
            timebase=self.window.timebase,
            length=self.window.end - self.window.begin,
            steps=steps,
            parts=parts,
            blame=blame,
            assumed=self.window.assumed,
        )

    def step(self, record: Record, what: str = "") -> Step:
        """Convert a record to a Step. what: the text of the step; "" for the text of the record."""
        place = place_of(record.text) if record.kind in (*IN_FIRMWARE, Kind.FLAG) else None
        return self.say(record.tick, what or happened(record), None, place)

    def named(self, record: Record) -> str:
        """Return the text of a record without details. For a START, return the text of the phase that begins there."""
        phase = next((p for p in self.phases if (p.begin, p.start) == (record.tick, record.what)), None)
        return happened(record).partition(",")[0] if phase is None else f"{phase.start}, {phase}"

    def say(self, tick: int, what: str, length: int | None = None, place: FirmwarePlace | None = None) -> Step:
        at = tick - self.window.at
        return Step(0 if abs(at) <= self.slip else at, what, length, place)

    @property
    def slip(self) -> int:
        """The maximum error, in ticks, of an instant in a verdict. Such instants are rounded to 0.1 ns."""
        return self.window.timebase.per_second // 10**10 + 1

    def episode_step(self, one: Stretch, end: int) -> Step:
        """Convert a service routine, span or wait to a Step. If it goes on after tick `end`, the Step says so."""
        what = f"{one.what} entered" if one.doing == "interrupt" else str(one)
        if one.doing == "interrupt" and one.within:
            below = one.within[-1]
            activity, place = phrase(DOING[below.kind], below.what), place_of(below.text)
            article = "the " if activity.startswith("wait") else ""
            what += f", preempting {article}{activity}{f' at {place.spot}' if place else ''}"
        if one.end > end:
            return self.say(one.begin, f"{what}, which goes on", None, place_of(one.where))
        return self.say(one.begin, what, one.end - one.begin, place_of(one.where))

    def story(self, begin: int, end: int, waits: bool = True) -> list[Step]:
        """Return steps for the firmware's activities between two ticks.

        The activities are all spans, the first service routine, other service routines that are long (see SMALL) and,
        if `waits` is True, long waits. At most MOST activities are included. The flag that requested the first service
        routine has a step, too.
        """
        least = (end - begin) * SMALL
        found = [one for one in episodes(self.window, self.unit, begin, end) if waits or one.doing != "wait"]
        routines = [one for one in found if one.doing == "interrupt"]
        optional = [one for one in found if one.doing == "wait" or one in routines[1:]]
        shown = [one for one in found if one not in optional or _inside(one, begin, end) > least]
        longest = sorted(shown, key=lambda one: -_inside(one, begin, end))[:MOST]
        requests = [step for one in routines[:1] for step in self._request(one.begin)]
        return [*requests, *(self.episode_step(one, end) for one in shown if one in longest)]

    def _request(self, tick: int) -> list[Step]:
        """Return a step for the module's flag that requested the interrupt whose service routine begins at a tick."""
        walks = [self.walk(r, 2) for r in self.window.between(tick, tick, Kind.IRQ) if r.where == self.unit]
        asked = ((cause, link) for walk in walks for cause, link in walk if cause.kind is Kind.FLAG and not link.aside)
        of_module = ((cause, link) for cause, link in asked if not cause.where.endswith(".PIE"))
        return [self.step(cause, f"{happened(cause)} ({link.because})") for cause, link in of_module]


def in_time(record: Record) -> tuple[int, int]:
    """Return a sort key that orders records by time, and records of the same tick by their creation."""
    return record.tick, record.number


ON_WIRES = (Kind.EDGE, Kind.HOLD, Kind.BUS, Kind.FRAME)
NO_ADDRESS = BusByte(0, acked=False, read=False)  # for a phase that ended before its address was complete
ENDS = ("START", "repeated START", "STOP", "arbitration lost")


def _inside(one: Stretch, begin: int, end: int) -> int:
    return min(end, one.end) - max(begin, one.begin)
