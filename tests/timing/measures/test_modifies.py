"""Flags cleared by read-modify-writes, found during a run, agree with those found in the recording of the whole run."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.core.records import Kind, Recorder
from periph_sim.core.time import NO_TIME
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.records.cleared_flags import Cleared
from periph_sim.records.read_modify_write import LostFlag, modifies_of, read_modify_writes
from periph_sim.records.run import NotInRun, Run
from periph_sim.records.subject import groups_of
from periph_sim.timing.measures.modifies import Modifies
from periph_sim.traces.formats.record_table import Columns

I2CSTR = PART.by_name["I2C-A"].registers["I2CSTR"]
ONES = ("SDIR", "NACKSNT", "SCD", "RRDY", "ARDY", "NACK", "AL")  # flags that writing 1 clears
CYCLE = 20  # ticks
HZ = Fraction(150_000_000)
KINDS = (Kind.ACCESS, Kind.FLAG)
ACCESSES = (
    "R I2C-A.I2CSTR",
    "R I2C-A.I2CSTR",
    "W I2C-A.I2CSTR",
    "R PIE.PIEACK",
    "W PIE.PIEACK",
    "R I2C-A.I2CMDR",
    "W I2C-A.I2CDXR",
)
FIELDS = ("", "SCD", "NACK")

PLACES = ("f:1", "g:9", "h (m.c:7, 0x009001)", "h (m.c:7, 0x009003)", "h (m.c:8, 0x009005)")
STATUS = st.sampled_from([0x00, 0x02, 0x20, 0x22])

# Cycles after the access before, access, its place, the field that it names, the value that is read or written.
access = st.tuples(
    st.integers(0, 30), st.sampled_from(ACCESSES), st.sampled_from(PLACES), st.sampled_from(FIELDS), STATUS
)
few = st.lists(access, max_size=3)
flags = st.sets(st.sampled_from(["SCD", "NACK", "XRDY"]))
gap = st.sampled_from([1, 40])
# Flags that are set, accesses, cycles; then a read-modify-write: place, field, flags set and accesses between its read
# and its write, flags that the write clears.
modify = st.tuples(flags, few, gap, st.sampled_from(PLACES), st.sampled_from(FIELDS), flags, few, flags)


def every(kind: Kind, where: str, what: str) -> bool:
    return True


class Both:
    """All records of a run, and the read-modify-writes that are found during the run."""

    def __init__(self) -> None:
        self.all, self.made, self.recorder = Columns(), Modifies(every, every, True), Recorder()
        self.made.set_clocks(CYCLE, [(0, Fraction(1))])
        for party in (self.all, self.made):
            self.recorder.subscribe(KINDS, party)
        self.now = 0

    def access(self, what: str, value: int, place: str, field: str) -> int:
        return self.recorder.emit(self.now, Kind.ACCESS, "dsp", what, value, place, field)

    def modify(self, read: int, wrote: int, field: str = "", routine: int = 0) -> int:
        """Add a read, 100 cycles after the last record, and its write at the same place. Return the write's number."""
        self.now += 100 * CYCLE
        self.access("R I2C-A.I2CSTR", read, "f:1", field)
        self.now += 2 * CYCLE
        self.recorder.cause = routine
        number = self.access("W I2C-A.I2CSTR", wrote, "f:1", field)
        self.recorder.cause = 0
        return number

    def accesses(self, of: list[tuple[int, str, str, str, int]], step: int) -> None:
        for later, what, place, field, value in of:
            self.now += later * step
            self.access(what, value, place, field)

    def flag(self, name: str, value: int, cause: int = 0) -> None:
        self.recorder.cause = cause
        self.recorder.emit(self.now, Kind.FLAG, "dsp.I2C-A", f"I2CSTR.{name}", value)
        self.recorder.cause = 0

    def flags(self) -> list[LostFlag]:
        """The lost flags that are found in the recording."""
        table = self.all.table(Fraction(HZ * CYCLE), self.now, {"dsp": ("I2C-A",)}, {})
        try:
            run = Run(table, sysclk=HZ)
            of_status = [group for group, _ in groups_of(run, None)]
            return [flag for modify in modifies_of(run, of_status) for flag in modify.flags]
        except NotInRun:
            return []

    def lost(self) -> list[int]:
        return sorted(tick for flag in self.flags() for tick in flag.lost)

    def cleared(self, name: str) -> list[int]:
        return sorted(tick for flag in self.flags() if flag.flag == name for tick in flag.cleared)

    def worked_out(self, name: str = "") -> list[int]:
        """Ticks at which flags were lost, or flag `name` was cleared, computed from the meaning of the records."""
        table = self.all.table(Fraction(HZ * CYCLE), self.now, {"dsp": ("I2C-A",)}, {})
        found = read_modify_writes(Run(table, sysclk=HZ), "dsp")
        of = {record.number: record for record in table.records()}
        pairs = [(of[int(table.number[r])], of[int(table.number[w])]) for r, w in zip(*found[:2], strict=True)]
        pairs = [(read, write) for read, write in pairs if write.what == "W I2C-A.I2CSTR"]
        ticks = []
        for read, write in pairs:
            place = [pair for pair in pairs if pair[1].text == write.text]
            for flag in ("NACK", "SCD"):
                bit = I2CSTR[flag].mask
                named = {w.field for _, w in place} - {""}
                proven = {f for f in ONES if any(w.value & ~r.value & I2CSTR[f].mask for r, w in place)}
                always = {f for f in ONES if all(w.value & I2CSTR[f].mask for _, w in place)}
                changes = [r for r in of.values() if r.what == f"I2CSTR.{flag}"]
                rises = [r.number for r in changes if r.value and r.number < write.number]
                falls = [r for r in changes if not r.value and (r.cause, r.tick) == (write.number, write.tick)]
                own = {r.number for r, _ in place}
                looks = [r.number for r in of.values() if r.what == "R I2C-A.I2CSTR" and r.field in ("", flag)]
                seen = [number for number in looks if number < read.number and number not in own]
                between = max(rises, default=-1) > read.number
                along = not between and read.value & bit and flag not in (named or proven or always)
                unseen = along and max(seen, default=-1) < max(rises, default=-1)
                if falls and (between or (unseen if not name else along)) and name in ("", flag):
                    ticks.append(write.tick)
        return sorted(ticks)


NONE = (0, NO_TIME)


def summary(cleared: Cleared) -> tuple[int, int]:
    return cleared.count, cleared.first


def counted(ticks: list[int]) -> tuple[int, int]:
    return len(ticks), ticks[0] if ticks else NO_TIME


@settings(max_examples=200)
@given(st.lists(modify, max_size=6))
def test_flags_found_during_a_run_are_those_found_in_its_recording(of: list[Any]):
    both = Both()
    for rises, before, cycles, place, field, late, between, cleared in of:
        for name in rises:
            both.flag(name, 1)
        both.accesses(before, CYCLE)
        both.now += cycles * CYCLE
        both.access("R I2C-A.I2CSTR", 0x22, place, field)
        for name in late:
            both.flag(name, 1)
        both.accesses(between, 1)
        both.now += 2 * CYCLE
        wrote = both.access("W I2C-A.I2CSTR", 0x22, place, field)
        for name in cleared:
            both.flag(name, 0, wrote)
    both.made.finish()
    assert summary(both.made.cleared()) == counted(both.lost()) and both.lost() == both.worked_out()
    for name in ("SCD", "NACK"):
        assert summary(both.made.cleared(name)) == counted(both.cleared(name))
        assert both.cleared(name) == both.worked_out(name)


def along(routine: int = 0, field: str = "") -> Both:
    """SCD is cleared by writing back all that was read. NACK was set before, and no read has looked at it."""
    both = Both()
    both.flag("NACK", 1)
    both.flag("NACK", 0, both.modify(0x22, 0x22, field, routine))
    return both


def test_only_the_flag_cleared_along_with_the_named_one_is_lost():
    both = along(field="SCD")
    both.flag("SCD", 0, both.recorder.number - 1)
    both.made.finish()
    assert (
        summary(both.made.cleared()) == counted(both.lost()) == (1, 102 * CYCLE) == summary(both.made.cleared("NACK"))
    )
    assert summary(both.made.cleared("SCD")) == counted(both.cleared("SCD")) == NONE


def test_only_a_read_at_another_place_counts_as_having_read_the_flag():
    both = along()
    both.flag("NACK", 1)
    both.modify(0x22, 0x20)  # reads the flag and does not clear it
    both.flag("NACK", 0, both.modify(0x22, 0x20))
    both.modify(0x00, 0x20)  # shows that this place intends to clear only SCD
    both.made.finish()
    assert both.lost() == [102 * CYCLE, 306 * CYCLE] and summary(both.made.cleared()) == (2, 102 * CYCLE)


@pytest.mark.parametrize(("later", "by_the_write"), [(1, True), (0, False)])
def test_a_flag_cleared_later_or_by_another_cause_is_not_cleared_by_the_write(later: int, by_the_write: bool):
    both = Both()
    both.flag("NACK", 1)
    both.access("R I2C-A.I2CSTR", 0x22, "f:1", "SCD")
    wrote = both.access("W I2C-A.I2CSTR", 0x22, "f:1", "SCD")
    both.now += later
    both.flag("NACK", 0, wrote if by_the_write else 0)
    both.made.finish()
    assert summary(both.made.cleared()) == counted(both.lost()) == NONE


def test_a_write_in_another_routine_does_not_belong_to_the_read():
    both = along(routine=7, field="SCD")
    both.made.finish()
    assert summary(both.made.cleared()) == counted(both.lost()) == NONE


def test_polls_without_a_following_write_are_not_kept():
    both = Both()
    for _ in range(1000):
        both.now += 100 * CYCLE
        both.access("R I2C-A.I2CSTR", 0, "f:1", "SCD")
    recent = both.made.recent["dsp"]
    assert recent.oldest is recent.newest is not None


def test_writes_are_counted_with_or_without_a_read():
    both = along()
    both.now += 50 * CYCLE
    both.access("W I2C-A.I2CSTR", 0x20, "f:2", "")
    both.access("W I2C-A.I2CDXR", 0x20, "f:3", "")
    assert both.made.writes == 2
