"""What is kept around writes that clear flags tells the same of them as all records do, whatever comes before them."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.core.records import Kind, Recorder
from periph_sim.records.lost_flags import ReadModifyWrite
from periph_sim.records.races import modifies_of
from periph_sim.records.run import NotInRun, Run
from periph_sim.timing.measures.around_writes import AroundWrites
from periph_sim.traces.formats.record_table import Columns

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

PLACES = ("f:1", "g:9")
STATUS = st.sampled_from([0x00, 0x02, 0x20, 0x22])

# Cycles behind the access before, what, its place, the field that it names, what is read or written.
access = st.tuples(
    st.integers(0, 30), st.sampled_from(ACCESSES), st.sampled_from(PLACES), st.sampled_from(FIELDS), STATUS
)
few = st.lists(access, max_size=3)
flags = st.sets(st.sampled_from(["SCD", "NACK", "XRDY"]))
gap = st.sampled_from([1, 40])
# Rises, accesses, cycles; a read and a write that belong together, with what comes between them; what that clears.
modify = st.tuples(flags, few, gap, st.sampled_from(PLACES), st.sampled_from(FIELDS), flags, few, flags)


class Both:
    """All records of a run, and those that stay."""

    def __init__(self) -> None:
        self.all, self.around, self.recorder = Columns(), AroundWrites(), Recorder()
        self.around.cycle_is(Fraction(CYCLE))
        for party in (self.all, self.around):
            self.recorder.subscribe(KINDS, party)
        self.now = 0

    def access(self, what: str, value: int, place: str, field: str) -> int:
        return self.recorder.emit(self.now, Kind.ACCESS, "dsp", what, value, place, field)

    def accesses(self, of: list[tuple[int, str, str, str, int]], step: int) -> None:
        for later, what, place, field, value in of:
            self.now += later * step
            self.access(what, value, place, field)

    def flag(self, name: str, value: int, cause: int = 0) -> None:
        self.recorder.cause = cause
        self.recorder.emit(self.now, Kind.FLAG, "dsp.I2C-A", f"I2CSTR.{name}", value)
        self.recorder.cause = 0

    def modifies(self, columns: Columns) -> set[ReadModifyWrite]:
        table = columns.table(Fraction(HZ * CYCLE), self.now, {"dsp": ("I2C-A",)})
        assert (table.number[1:] > table.number[:-1]).all()
        try:
            return set(modifies_of(Run(table, sysclk=HZ)))
        except NotInRun:
            return set()


@settings(max_examples=300)
@given(st.lists(modify, max_size=4))
def test_what_stays_tells_the_same_of_every_write(of: list[Any]):
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
    assert both.modifies(both.around) == both.modifies(both.all)


def test_polls_that_no_write_follows_do_not_stay():
    both = Both()
    for _ in range(1000):
        both.now += 100 * CYCLE
        both.access("R I2C-A.I2CSTR", 0, "f:1", "SCD")
    assert len(both.around) == 0
    both.now += 100 * CYCLE
    both.access("W I2C-A.I2CSTR", 0x20, "f:2", "")
    assert len(both.around) == 2 and len(both.all) == 1001


def test_a_flag_that_writing_1_does_not_clear_is_no_matter():
    both = Both()
    both.flag("BB", 1)
    both.flag("SCD", 1)
    assert len(both.around) == 1
