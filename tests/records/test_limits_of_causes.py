"""Limits of the search for causes: distances, numbers and times within which a record counts as a cause."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.records import Kind
from periph_sim.f28335.i2c.descriptor import FLAGS
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.records.cause_trace import causes
from periph_sim.records.cause_trace.why import why
from periph_sim.records.read_modify_write import read_modify_writes
from tests.records.cause_trace.test_causes import RRDY, SCD, count, counted, edge, hold, irq, numbers, walk
from tests.records.scenes import by_hand, flag, read, write


@pytest.mark.parametrize("written_at", [1010, 37_600, 10**9])
def test_a_read_is_the_cause_of_a_write_however_much_code_is_between_them(written_at: int):
    """37 600 cycles are a little more than the 250 us of the model."""
    steps = walk(flag(5, "SCD", 1), read(10, SCD, "SCD"), count(written_at), counted(written_at, 3))
    assert numbers(steps) == ["4", "3", "2", "1"]


def test_a_walk_has_the_reason_why_it_ended(monkeypatch: pytest.MonkeyPatch):
    def ends(*rows: tuple[Any, ...], depth: int = 8) -> str:
        return why(by_hand(*rows, end=10_000), "ICDC@60us", depth).ends

    looked = flag(5, "SCD", 1), read(10, SCD, "SCD"), count(2000), counted(2000, 3)
    assert ends(*looked) == "no record of a cause of it"
    assert ends(*looked, depth=2) == "2 causes were asked for; --depth gives more"
    assert ends(*looked[1:3], counted(2000, 2)) == "nothing that this access read had changed before it"
    assert ends(*looked[2:3], counted(2000, 1)) == "its routine had read nothing before it"
    assert ends() == ""
    monkeypatch.setattr(causes, "MOST_ACCESSES", 3)
    many = [*looked[:2], *(count(100 * n) for n in range(1, 4)), count(2000)]
    assert ends(*many, counted(2000, 6)).endswith("in the 3 accesses before it; no more were searched")
    assert ends(*looked[:2], count(100), count(200), count(2000), counted(2000, 5)) == "no record of a cause of it"
    three_before = count(100), count(200), count(300), count(2000)
    assert ends(*three_before, counted(2000, 4)) == "its routine had read nothing before it"


@pytest.mark.parametrize(("others", "found"), [(9_999, True), (10_000, False)])
def test_ten_thousand_accesses_before_a_write_are_searched_for_a_read(others: int, found: bool):
    writes = [count(20 + n) for n in range(others + 1)]
    run = by_hand(flag(5, "SCD", 1), read(10, SCD, "SCD"), *writes, counted(20 + others, 3 + others), end=20_000)
    answer = why(run, "ICDC@120us", 2)
    assert [step.record.number for step in answer.back] == [4 + others, 3 + others, *([2] if found else [])]
    more = "its routine read nothing else in the 10000 accesses before it; no more were searched"
    assert answer.ends == ("2 causes were asked for; --depth gives more" if found else more)


@pytest.mark.parametrize(("others", "found"), [(7, True), (8, False)])
def test_the_last_eight_reads_are_considered(others: int, found: bool):
    """Only the first of the reads saw a change, that of SCD."""
    looks = [read(20 + n, 0, "BB", f"g:{n}") for n in range(others)]
    rows = [flag(4, "ARDY", 1), flag(5, "SCD", 1), read(10, SCD, "SCD"), *looks, count(50)]
    steps = walk(*rows, counted(50, len(rows)))
    main = [step.record.number for step in steps if not step.aside]
    assert main[2:] == ([3, 2] if found else [2 + 1 + others])


def test_the_first_record_of_a_run_can_be_a_cause():
    """SCD is set in the first record. The first read saw that, the second one nothing."""
    steps = walk(flag(5, "SCD", 1), read(10, SCD, "SCD"), read(12, 0, "BB", "g:2"), count(20), counted(20, 4))
    assert numbers(steps) == ["5", "4", "(3)", "2", "1"]


@pytest.mark.parametrize(
    ("line", "module", "fields"),
    [
        ("I2CINT1A", "I2C-A", 2 * len(FLAGS)),
        ("I2CINT2A", "I2C-A", 4),
        ("SCIRXINTB", "SCI-B", 8),
        ("SCITXINTC", "SCI-C", 4),
        ("TINT0", "TIMER0", 2),
        ("TINT1", "", 0),
        ("", "", 0),
        ("XINT1", "XINT", 0),
        ("SPITXINTA", "SPI-A", 2),
    ],
)
def test_fields_that_request_an_interrupt(line: str, module: str, fields: int):
    found = {name: len(interrupt.fields) for name, interrupt in PART.requesters(line).items()}
    assert found == ({module: fields} if module else {})


# Read-modify-writes -----------------------------------------------------------------------------------------------


def pairs(*rows: tuple[Any, ...]) -> list[tuple[int, int]]:
    """Numbers of the read and the write of each read-modify-write in these records."""
    found = read_modify_writes(by_hand(*rows), "dsp")
    return [(r + 1, w + 1) for r, w in zip(found.reads.tolist(), found.writes.tolist(), strict=True)]


def other(cycle: int) -> tuple[Any, ...]:
    return cycle, Kind.ACCESS, "dsp", "R I2C-A.I2CDRR", 0, "h:1", 0


@pytest.mark.parametrize(
    ("rows", "found"),
    [
        ([read(10, 0, "SCD"), write(14, SCD, "SCD")], [(1, 2)]),
        ([read(10, 0, "SCD"), write(15, SCD, "SCD")], []),
        ([read(10, 0, "SCD"), write(12, SCD, "NACK")], []),
        ([read(10, 0, "SCD"), write(12, SCD, "SCD", "f:2")], []),
        ([read(10, 0, "SCD"), write(12, SCD, "SCD", routine=7)], []),
        ([write(10, 0, "SCD"), write(12, SCD, "SCD")], []),
        ([read(10, 0, "SCD"), other(11), other(11), write(12, SCD, "SCD")], [(1, 4)]),
        ([read(10, 0, "SCD"), other(11), other(11), other(11), write(12, SCD, "SCD")], []),
        ([read(10, 0, "SCD"), read(11, 0, "SCD"), write(12, SCD, "SCD")], [(2, 3)]),
        ([read(10, 0, "SCD"), write(12, SCD, "SCD"), write(13, SCD, "SCD")], [(1, 2)]),
        (
            [read(10, 0, "SCD"), read(11, 0, "SCD"), write(12, SCD, "SCD"), write(13, SCD, "SCD")],
            [(2, 3), (1, 4)],
        ),
    ],
)
def test_a_read_belongs_to_a_write_of_its_place_within_four_cycles_and_three_accesses(rows, found):
    assert pairs(*rows) == found


def test_the_read_of_a_write_and_the_rows_of_such_reads():
    of = by_hand(read(10, 0, "SCD"), other(11), write(12, SCD, "SCD"), read(20, 0, "BB"))
    made = read_modify_writes(of, "dsp")
    assert [made.read_of(row) for row in range(5)] == [None, None, 0, None, None]
    assert [row in made.reads for row in range(5)] == [True, False, False, False, False]


# Wires ------------------------------------------------------------------------------------------------------------

MOVES = (
    edge(10, 0, "a"),
    hold(20, "a, b"),
    hold(30, "b"),
    hold(40, "b, c, d"),
    edge(50, 1, ""),
    edge(60, 0, "e"),
)


def test_the_parties_that_hold_and_that_moved_a_wire():
    run = by_hand(*MOVES)
    rows = causes.wire_rows(run, "SCL").tolist()
    assert rows == [0, 1, 2, 3, 4, 5]
    parties = [(causes.holders(run, row, run.record(row)), causes.mover(run, row, run.record(row))) for row in rows]
    assert parties == [
        (("a",), "a"),
        (("a", "b"), "b"),
        (("b",), "a"),
        (("b", "c", "d"), "d"),
        (("b", "c", "d"), "d"),
        (("e",), "e"),
    ]
    first = by_hand(edge(10, 1, ""))
    assert (causes.holders(first, 0, first.record(0)), causes.mover(first, 0, first.record(0))) == ((), "")


def test_the_cause_of_a_held_wire_is_the_last_act_or_the_begin_of_the_hold():
    acts = [(5 * n + 2, Kind.BUS, who, "byte", n, "", 0) for n, who in ((1, "b"), (2, "b"))]
    run = by_hand(acts[0], edge(10, 0, "a"), acts[1], hold(20, "a, b"), hold(30, "b"))
    assert numbers([*why(run, "SCL@167ns").back]) == ["4", "3"]  # b also pulls: the cause is the last act of b
    assert numbers([*why(run, "SCL@250ns").back]) == [
        "5",
        "4",
        "3",
    ]  # only b still pulls: the cause is the begin of its pull


# The run ----------------------------------------------------------------------------------------------------------

ROWS = st.lists(st.integers(0, 9), max_size=12)


@given(ROWS, st.integers(-1, 10), st.none() | st.integers(0, 12))
def test_the_last_row_up_to_a_tick_is_that_of_a_linear_search(cycles: list[int], tick: int, before: int | None):
    run = by_hand(*(edge(cycle, n % 2, "") for n, cycle in enumerate(sorted(cycles))))
    rows = run.rows(Kind.EDGE, "SCL")
    fits = [row for row in rows.tolist() if run.table.tick[row] <= 20 * tick and (before is None or row < before)]
    assert run.last(rows, 20 * tick, before) == (fits[-1] if fits else None)
    after = tick
    later = [row for row in rows.tolist() if row > after]
    assert run.next(rows, after) == (later[0] if later else None)


def test_the_row_of_a_number():
    run = by_hand(edge(1, 0, ""), edge(2, 1, ""))
    assert [run.row_of(number) for number in (-1, 0, 1, 2, 3)] == [None, None, 0, 1, None]
    assert by_hand().row_of(1) is None


def test_a_record_is_made_by_its_cause_only_at_the_same_tick():
    run = by_hand(write(5, SCD, "SCD"), flag(5, "SCD", 0, 1), flag(6, "RRDY", 0, 1), flag(7, "BB", 1, 0))
    assert run.made_by(np.arange(4)).tolist() == [-1, 0, -1, -1]
    assert by_hand().made_by(np.arange(0)).tolist() == []


def test_rows_are_in_the_order_of_their_ticks():
    run = by_hand(flag(9, "SCD", 1), flag(5, "SCD", 0), flag(9, "SCD", 1), flag(5, "SCD", 1))
    assert run.rows(Kind.FLAG, "dsp.I2C-A", "I2CSTR.SCD").tolist() == [1, 3, 0, 2]


def test_the_value_before_a_row():
    from periph_sim.f28335.i2c.register_map import I2CSTR

    run = by_hand(flag(5, "XRDY", 0), read(6, 0), flag(7, "XRDY", 1), read(8, 0x10))
    assert run.values("dsp", "I2C-A", I2CSTR, I2CSTR["XRDY"], np.arange(5)).tolist() == [1, 0, 0, 1, 1]


def test_accesses_are_grouped_by_runs_of_routines():
    """First the accesses of the main program, then those of each run of a service routine, each with its successor."""
    reads = [read(cycle, 0, routine=routine) for cycle, routine in ((1, 0), (3, 2), (4, 0), (6, 5), (7, 2))]
    run = by_hand(reads[0], irq(2, 1), reads[1], reads[2], irq(5, 1, 3), reads[3], reads[4])
    in_order, following = run.in_order("dsp")
    assert (in_order.tolist(), following.tolist()) == ([0, 3, 2, 6, 5], [3, -1, 6, -1, -1])
    assert [run.routine("dsp", entry).tolist() for entry in (0, 2, 5, 9)] == [[0, 3], [2, 6], [5], []]
    nothing, _ = by_hand().in_order("dsp")
    assert nothing.tolist() == []


def test_reads_that_include_a_field():
    from periph_sim.f28335.i2c.register_map import I2CSTR

    run = by_hand(read(1, 0, "SCD"), read(2, RRDY, "RRDY"), read(3, 0))
    reads = run.accesses_of("dsp", "R", "I2C-A", "I2CSTR")
    assert run.looking_at(reads, I2CSTR["SCD"]).tolist() == [0, 2]
    assert [(place, rows.tolist()) for place, rows in run.by_place(reads)] == [("f:1", [0, 1, 2])]
