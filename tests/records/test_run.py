"""A recorded run: durations in units of time and in cycles, and the source of the length of a cycle."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise, product
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.records.register_maps import register_of
from periph_sim.records.run import WAY_OUT, CycleLength, NotInRun, Run
from periph_sim.traces import formats
from periph_sim.traces.formats.record_table import Columns
from tests.records.scenes import PER_SECOND, by_hand, written
from tests.refusals import refusal
from tests.traces.decode.drawing import drawn


@pytest.mark.parametrize(
    ("cycles", "said"),
    [
        (0, "0 ns (0 cycles)"),
        (1, "6.667 ns (1 cycle)"),
        (149, "993.333 ns (149 cycles)"),
        (150, "1 us (150 cycles)"),
        (149_999, "999.993 us (149999 cycles)"),
        (150_000, "1 ms (150000 cycles)"),
        (149_999_999, "1000 ms (149999999 cycles)"),
        (150_000_000, "1 s (150000000 cycles)"),
        (-150, "-1 us (-150 cycles)"),
        (-1, "-6.667 ns (-1 cycles)"),
        (45_000, "300 us (45000 cycles)"),
    ],
)
def test_a_duration_is_written_in_a_suitable_unit(cycles: int, said: str):
    assert by_hand().length(cycles * 20) == said


@pytest.mark.parametrize(("ticks", "cycles"), [(9, 0), (10, 0), (11, 1), (29, 1), (30, 2), (31, 2), (-11, -1)])
def test_cycles_are_rounded_to_nearest(ticks: int, cycles: int):
    assert by_hand().clock().cycles(0, ticks) == cycles


def access(cycle: int) -> tuple[Any, ...]:
    return cycle, Kind.ACCESS, "dsp", "R I2C-A.I2CSTR", 0, "f:1", 0


def test_the_length_of_a_cycle_has_its_source():
    assert by_hand(access(1), access(4)).cycles.how == "SYSCLKOUT 150 MHz, which all accesses fall on"
    one = "SYSCLKOUT taken as 150 MHz; the accesses fall on no one grid (an error of the crystal, or several)"
    assert by_hand(access(1)).cycles.how == by_hand().cycles.how == one
    slower = by_hand(access(0), access(3), access(6), access(10))
    slower.table.columns["tick"] = slower.table.tick * 3 // 2
    assert slower.cycles == CycleLength(Fraction(30), "SYSCLKOUT 100 MHz, the grid that all accesses fall on")
    finer = by_hand(access(0), access(3), access(4))
    finer.table.columns["tick"] = finer.table.tick - 1 * (finer.table.tick > 70)  # 0, 60, 79: not on a grid of cycles
    assert finer.cycles.how == one and finer.cycles.ticks == 20


# Queries of a run, compared with loops over its records ---------------------------------------------------------------

STATUS = register_of("I2C-A", "I2CSTR")
assert STATUS is not None
FIELDS = [STATUS["SCD"], STATUS["XSMT"]]  # 0 and 1 after reset


def random_records(draw: Random) -> list[Record]:
    """Records of two units in order of their numbers; numbers can be missing, and a tick can have several records."""
    found: list[Record] = []
    number = tick = 0
    for _ in range(draw.randrange(14)):
        number += draw.choice((1, 1, 3))
        tick += draw.choice((0, 20, 60))
        unit, cause = draw.choice(("dsp", "two")), draw.randrange(number + 1)
        value, place, name = draw.randrange(2), draw.choice(("f:1", "g:2")), draw.choice(("", "SCD", "BB"))
        way, register = draw.choice("RW"), draw.choice(("I2CSTR", "I2CSTR", "I2CMDR", "I2CNEW"))
        found.append(
            draw.choice(
                (
                    Record(number, tick, Kind.ACCESS, unit, f"{way} I2C-A.{register}", 0, place, cause, name),
                    Record(
                        number, tick, Kind.FLAG, f"{unit}.I2C-A", f"I2CSTR.{draw.choice(FIELDS).name}", value, "", cause
                    ),
                    Record(number, tick, Kind.IRQ, unit, "SCIRXINTA", value, "", cause),
                )
            )
        )
    return found


@pytest.mark.parametrize("seed", range(60))
def test_queries_agree_with_loops_over_the_records(seed: int):
    draw = Random(seed)
    records = random_records(draw)
    columns = Columns()
    for record in records:
        columns.add(record)
    run = Run(columns.table(PER_SECOND, 10_000, {"dsp": ("I2C-A",), "two": ("I2C-A",)}, {}))
    every = range(len(records))
    rows_of = {one.number: row for row, one in enumerate(records)}
    for number in range(45):
        assert run.row_of(number) == rows_of.get(number)

    def causes_at_once() -> Iterator[int]:
        for one in records:
            cause = rows_of.get(one.cause, -1)
            yield cause if cause >= 0 and records[cause].tick == one.tick else -1

    assert run.made_by(np.arange(len(records))).tolist() == [*causes_at_once()] if records else True
    for unit in ("dsp", "two"):
        accesses = [row for row in every if (records[row].kind, records[row].where) == (Kind.ACCESS, unit)]
        order = sorted(accesses, key=lambda row: records[row].cause)
        routines = {entry: [row for row in order if records[row].cause == entry] for entry in range(45)}
        follows = {a: b for rows in routines.values() for a, b in pairwise(rows)}
        rows, following = run.in_order(unit)
        assert (rows.tolist(), following[: len(rows)].tolist()) == (order, [follows.get(row, -1) for row in order])
        assert {entry: run.routine(unit, entry).tolist() for entry in routines} == routines
        ends = [row for row in every if (*records[row][2:4], records[row].value) == (Kind.IRQ, unit, 0)]
        ends = [row for row in ends if records[row].cause in rows_of]
        for after, before, routine in product((-1, 0, 3), (5, 99), (0, 1, 4)):
            within = [(row, rows_of[records[row].cause]) for row in ends if after < row < before]
            within = [(end, entry) for end, entry in within if records[entry].cause == routine]
            found = run.service(unit, routine, after, before)
            assert [*zip(*(column.tolist() for column in found), strict=True)] == within
        for f in FIELDS:
            name = f"I2CSTR.{f.name}"
            changes = [row for row in every if records[row][2:5] == (Kind.FLAG, f"{unit}.I2C-A", name)]
            assert run.changes(unit, "I2C-A", STATUS, f).tolist() == changes
            above = {row: [change for change in changes if change < row] for row in every}
            for row in every:
                assert run.changed_before(unit, "I2C-A", STATUS, f, row) == max(above[row], default=None)
                assert run.next(np.array(changes, np.int64), row) == min(
                    (change for change in changes if change > row), default=None
                )
            held = [records[above[row][-1]].value if above[row] else f.reset for row in every]
            assert run.values(unit, "I2C-A", STATUS, f, np.arange(len(records))).tolist() == held
            reads = run.accesses_of(unit, "R", "I2C-A", "I2CSTR").tolist()
            looks = [row for row in reads if records[row].field in ("", f.name)]
            assert run.looking_at(np.array(reads, np.int64), f).tolist() == looks
            for tick in range(0, 600, 20):
                up_to = [row for row in changes if records[row].tick <= tick]
                assert run.last(np.array(changes, np.int64), tick) == max(up_to, default=None)
    grouped = {(g.unit, g.way, g.module, g.register.name): g.rows.tolist() for g in run.accesses}
    expected: dict[tuple[str, ...], list[int]] = {}
    for row in every:
        one = records[row]
        if one.kind is Kind.ACCESS and not one.what.endswith("I2CNEW"):
            expected.setdefault((one.where, one.what[0], *one.what[2:].split(".")), []).append(row)
    assert grouped == expected
    places = dict(run.by_place(run.rows(Kind.ACCESS)))
    of_accesses = [row for row in every if records[row].kind is Kind.ACCESS]
    assert {place: rows.tolist() for place, rows in places.items()} == {
        place: [row for row in of_accesses if records[row].text == place]
        for place in {records[row].text for row in of_accesses}
    }


def test_rows_are_in_order_of_their_ticks_and_units_have_the_common_modules():
    columns = Columns()
    for number, tick in enumerate((60, 20, 40, 20), 1):
        columns.add(Record(number, tick, Kind.NOTE, "dsp", "x", 0, "", 0))
    run = Run(columns.table(PER_SECOND, 100, {"dsp": ("I2C-A", "pin:LED")}, {}))
    assert run.rows(Kind.NOTE).tolist() == [1, 3, 2, 0]
    assert run.units == {"dsp": ("I2C-A", "SYS", "PIE")}
    assert (run.at(3_000_001), run.seconds(1)) == ("1.000000 ms", Fraction(1, 3_000_000_000))


def test_clocks_of_several_units():
    """The clocks are those in the file, each with its changes, unless a frequency is given for all."""
    table = by_hand(access(1), access(4)).table
    slow, fast = Fraction(75_000_000), Fraction(150_000_000)
    alike = Run(replace(table, clocks={"dsp": [(0, fast)], "two": [(0, fast)]}))
    apart = Run(replace(table, clocks={"dsp": [(0, slow), (6000, fast)], "two": [(0, slow)]}))
    given = Run(replace(table, clocks={"dsp": [(0, fast)], "two": [(0, slow)]}), sysclk=slow)
    assert (alike.counts_alike, apart.counts_alike, given.counts_alike) == (True, False, True)
    assert alike.cycles == CycleLength(Fraction(20), "SYSCLKOUT 150 MHz")
    assert apart.cycles == CycleLength(Fraction(20), "SYSCLKOUT of dsp 75 MHz, from 0.002 ms on 150 MHz; two 75 MHz")
    assert given.cycles == CycleLength(Fraction(40), "SYSCLKOUT 75 MHz, as given")
    assert [apart.length(600, begin, unit) for begin, unit in ((0, "dsp"), (None, "dsp"), (0, "two"), (0, "SCL"))] == [
        "200 ns (15 cycles)", "200 ns (30 cycles)", "200 ns (15 cycles)", "200 ns"
    ]  # fmt: skip
    assert (alike.length(600, 0, "SCL"), given.length(600)) == ("200 ns (30 cycles)", "200 ns (15 cycles)")
    assert [run.clock("two").periods for run in (alike, apart, given)] == [(20,), (40,), (40,)]
    assert apart.clock("SCL").periods == (40, 20)
    assert [run.clock().begins for run in (apart, given, by_hand())] == [(0, 6000), (0,), (0,)]


# Files ----------------------------------------------------------------------------------------------------------------


def test_a_run_is_read_from_its_file_with_its_name(tmp_path: Path):
    path = written(tmp_path / "run.psr", (40, Kind.NOTE, "dsp", "x", 7), end=100, modules={"dsp": ("I2C-A",)})
    run = Run.read(str(path), Fraction(75_000_000))
    assert (run.name, run.units, run.table.end) == (str(path), {"dsp": ("I2C-A", "SYS", "PIE")}, 100)
    assert [(one.tick, one.value) for one in run.table.records(run.rows(Kind.NOTE))] == [(40, 7)]
    assert run.cycles.how == "SYSCLKOUT 75 MHz, as given"


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("none.psr", "there is no such file"),
        (".", "cannot be read (Is a directory)"),
        ("run.jsonl", "a run for other programs to read"),
        ("run.vcd", "not a recorded run"),
        ("capture.psr", "a capture of wires, with no accesses or flags"),
    ],
)
def test_a_file_that_is_not_a_run_is_rejected_with_advice(tmp_path: Path, name: str, sentence: str):
    for ending in ("jsonl", "vcd"):
        (tmp_path / f"run.{ending}").write_text("{}", encoding="utf-8")
    formats.write(drawn("SCL --_-"), tmp_path / "capture.psr")
    assert refusal(NotInRun, Run.read, tmp_path / name) == f"{tmp_path / name}: {sentence}; {WAY_OUT}"
