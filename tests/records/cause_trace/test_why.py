"""Answers to `why`: values compared with a simple computation, causes, effects, names, and bad questions."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.records import Kind
from periph_sim.firmware import start_i2c
from periph_sim.processor.dsp import Dsp
from periph_sim.records.cause_trace.why import DEPTH, EFFECTS, as_json, said, text, why
from periph_sim.records.run import NotInRun, Run
from periph_sim.scene.case.load import load
from tests.records.cause_trace.test_causes import edge, irq
from tests.records.scenes import ADDRESS, CYCLE, asks, by_hand, flag, line_of, ran, read, recorded, write
from tests.scene.runs import TIMING


def turn_on(i2c: Any) -> None:
    i2c.I2CMDR.IRS = 1


def main(dsp: Dsp) -> None:
    start_i2c(dsp)
    i2c = dsp.module("I2C-A")
    i2c.I2COAR.all = ADDRESS
    turn_on(i2c)
    dsp.spin(lambda: i2c.I2CSTR.BB == 1)
    dsp.compute(3000, "work")
    dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
    i2c.I2CCNT.all = 0x15


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Run:
    return ran(monkeypatch, main, "3 ms", **asks(0x23, write="01", count=0))


@pytest.fixture(scope="module")
def emulator() -> Run:
    return recorded(load(TIMING / "imu_hil_published.toml", []), "0.004")


def test_the_recorded_cause_of_a_change_is_the_write_with_its_place(run: Run):
    answer = why(run, "I2C-A.I2CMDR.IRS@0.5ms")
    gave, wrote = answer.back[:2]
    assert (answer.value, gave.record.kind, gave.known) == (1, Kind.FLAG, "")
    assert (wrote.record.what, wrote.record.text, wrote.known) == ("W I2C-A.I2CMDR", line_of(turn_on), "recorded")
    assert "0: the module is held in reset. [SPRUG03B table 5]" in text(answer)


def test_the_recorded_cause_is_the_edge_before_the_filter_and_its_party_is_inferred(run: Run):
    answer = why(run, "BB@1.001ms")
    gave, edge, party = answer.back
    assert (edge.record.where, edge.record.value, edge.known) == ("SDA", 0, "recorded")
    assert gave.record.tick - edge.record.tick == 15 * CYCLE  # the filter of one module clock, IPSC = 14
    assert (party.record.where, party.record.what, party.known) == ("controller", "START", "inferred")
    assert "SDA falls, pulled low by controller" in text(answer)


def test_the_cause_of_a_write_is_what_the_firmware_read_before_it(run: Run):
    answer = why(run, "ICDC@2.9ms")
    steps = [(step.record.kind, step.record.what, step.known) for step in answer.back]
    assert steps[:4] == [
        (Kind.FLAG, "I2CCNT.ICDC", ""),
        (Kind.ACCESS, "W I2C-A.I2CCNT", "recorded"),
        (Kind.ACCESS, "R I2C-A.I2CSTR", "inferred"),
        (Kind.FLAG, "I2CSTR.SCD", "inferred"),
    ]
    assert answer.back[4].record.where == "SDA" and answer.back[4].record.value == 1  # the STOP
    assert "0x15 since" in text(answer)


def test_an_answer_has_the_next_read_and_the_next_change(run: Run):
    answer = why(run, "I2CSTR.BB@1.001ms")
    assert answer.reader is not None and answer.changed is not None
    assert 0 <= answer.reader.record.tick - answer.since < 30 * CYCLE
    assert answer.reader.record.value & 0x1000 and answer.reads >= 1
    assert (answer.changed.record.what, answer.changed.record.value) == ("I2CSTR.BB", 0)
    free = why(run, "I2CSTR.BB@2.9ms")
    assert free.changed is None and "it did not change again" in text(free)


def test_the_chain_of_an_interrupt_leads_to_the_flag_of_its_module_and_the_edge(emulator: Run):
    (entered, *_) = [r for r in emulator.table.records(emulator.rows(Kind.IRQ)) if r.value]
    answer = why(emulator, f"{entered.what}@{entered.tick * 10**9 // int(emulator.per_second) + 1}ns")
    kinds = [(step.record.kind, step.record.where) for step in answer.back]
    assert kinds[:4] == [
        (Kind.IRQ, "dsp"),
        (Kind.FLAG, "dsp.PIE"),
        (Kind.FLAG, "dsp.SCI-A"),
        (Kind.EDGE, "RX"),
    ]
    assert answer.effects and all(step.record.cause == entered.number for step in answer.effects)
    read = answer.effects[0].record
    assert read.kind is Kind.ACCESS and "in it" in text(answer)


def test_only_steps_of_registers_cite_a_section_of_the_manual(run: Run):
    answer = why(run, "I2C-A.I2CSTR.SCD@2ms")
    shown = {step.record.kind: said(run, step) for step in answer.back}
    assert set(shown) >= {Kind.FLAG, Kind.EDGE}
    assert shown[Kind.FLAG].endswith("[SPRUG03B table 10]")
    assert not any("[" in words for kind, words in shown.items() if kind is not Kind.FLAG)


@given(cycle=st.integers(0, 60), changes=st.lists(st.integers(1, 30), min_size=1, max_size=6))
def test_the_value_is_the_one_of_the_last_change(cycle: int, changes: list[int]):
    at = [sum(changes[: n + 1]) for n in range(len(changes))]
    run = by_hand(*((c, Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB", (n + 1) % 2, "", 0) for n, c in enumerate(at)), end=300)
    answer = why(run, f"BB@{cycle * CYCLE / 3} ns")
    passed = [n for n, c in enumerate(at) if c * CYCLE <= int(cycle * CYCLE / 3 * 3)]
    assert abs(answer.tick - cycle * CYCLE) <= 1
    if answer.tick == cycle * CYCLE:
        assert answer.value == (len(passed) % 2)
        assert answer.since == (at[passed[-1]] * CYCLE if passed else 0)


def test_the_json_has_the_same_steps(run: Run):
    found = as_json(why(run, "I2C-A.I2CMDR.IRS@0.5ms"))
    assert found["value"] == 1 and found["source"] == "SPRUG03B table 5"
    assert [step["kind"] for step in found["back"]][:2] == ["flag", "access"]


def test_with_two_units_a_name_without_its_unit_is_ambiguous():
    run = recorded(load(TIMING / "two_dsps.toml", []), "0.001")
    with pytest.raises(NotInRun, match=r"may mean head\.I2C-A\.I2CMDR\.IRS, imu\.I2C-A\.I2CMDR\.IRS; give one"):
        why(run, "I2CA.I2CMDR.IRS@0.9ms")
    assert [why(run, f"{unit}.I2CA.I2CMDR.IRS@0.9ms").subject.unit for unit in ("imu", "head")] == ["imu", "head"]


def span(cycle: int, value: int) -> tuple[Any, ...]:
    return cycle, Kind.SPAN, "dsp", "model", value, "f:1" if value else "", 0


def values(run: Run, name: str, *cycles: int) -> list[int | None]:
    return [why(run, f"{name}@{cycle * 20 / 3:.4f} ns").value for cycle in cycles]


def test_values_before_at_and_after_a_change():
    run = by_hand(
        edge(10, 0, "c"), flag(20, "SCD", 1), span(30, 1), irq(40, 1), span(50, 0), edge(60, 1, ""), irq(70, 0, 4)
    )
    assert values(run, "SCL", 0, 9, 10, 59, 60, 99) == [1, 1, 0, 0, 1, 1]
    assert values(run, "I2CSTR.SCD", 19, 20, 99) == [0, 1, 1]
    assert values(run, "I2CSTR.XRDY", 5) == [1]  # the value after reset
    assert values(run, "model", 29, 30, 49, 50) == [0, 1, 1, 0]
    assert values(run, "SCIRXINTA", 39, 40, 69, 70) == [0, 1, 1, 0]
    rises = by_hand(edge(10, 1, ""))
    assert values(rises, "SCL", 5, 15) == [0, 1]


@pytest.mark.parametrize(
    ("name", "at", "said"),
    [
        ("SCL", 5, "SCL at 0.000033 ms: high from the start"),
        ("SCL", 15, "SCL at 0.000100 ms: low since 0.000067 ms, 33.333 ns (5 cycles) before"),
        ("model", 5, "dsp.model at 0.000033 ms: not in it from the start"),
        ("model", 36, "dsp.model at 0.000240 ms: in it since 0.000200 ms, 40 ns (6 cycles) before"),
        ("SCIRXINTA", 45, "dsp.SCIRXINTA at 0.000300 ms: in it since 0.000267 ms, 33.333 ns (5 cycles) before"),
        ("ICDC", 5, "dsp.I2C-A.I2CCNT.ICDC at 0.000033 ms: 0, as reset left it"),
        ("ICDC", 55, "dsp.I2C-A.I2CCNT.ICDC at 0.000367 ms: 0x20 since 0.000333 ms, 33.333 ns (5 cycles) before"),
    ],
)
def test_the_first_line_of_an_answer(name: str, at: int, said: str):
    count = 50, Kind.FLAG, "dsp.I2C-A", "I2CCNT.ICDC", 0x20, "", 0
    run = by_hand(edge(10, 0, "c"), span(30, 1), irq(40, 1), count)
    assert text(why(run, f"{name}@{at * 20 / 3:.4f} ns")).splitlines()[0] == said


def test_answers_about_spans_and_wires_have_no_note_about_reads():
    run = by_hand(span(30, 1), edge(40, 0, "c"))
    for name in ("model", "SCL"):
        shown = text(why(run, f"{name}@1us"))
        assert shown.endswith("\n  it did not change again") and "recorded read" not in shown
    before = text(why(run, "model@100ns"))
    assert "  nothing changed it before; no record of it" in before
    assert "  changed  200 ns (30 cycles) after  dsp: span model begins at f:1" in before


@pytest.mark.parametrize("effects", [0, 1, EFFECTS, EFFECTS + 2])
def test_at_most_five_effects_of_a_record_are_listed(effects: int):
    rows = [flag(11 + n, "SCD", n % 2, 1) for n in range(effects)]
    answer = why(by_hand(edge(10, 0, "c"), *rows, flag(50, "BB", 1, 2)), "SCL@100ns")
    assert [step.record.number for step in answer.effects] == [2 + n for n in range(min(effects, 5))]


def test_reads_of_the_field_between_two_changes_are_counted():
    rows = [
        read(5, 0, "SCD"),
        flag(10, "SCD", 1),
        read(11, 0, "XRDY"),
        read(12, 0),
        write(13, 0),
        read(14, 0, "SCD"),
        flag(20, "SCD", 0),
        read(21, 0, "SCD"),
    ]
    for cycle, reader, reads, changed in ((7, 1, 1, 2), (15, 4, 2, 7), (25, 8, 1, None)):
        answer = why(by_hand(*rows), f"I2CSTR.SCD@{cycle * 20 / 3:.4f} ns")
        assert answer.reader is not None and (answer.reader.record.number, answer.reads) == (reader, reads)
        assert (answer.changed and answer.changed.record.number) == changed
    unread = why(by_hand(flag(10, "SCD", 1), read(12, 0, "XRDY")), "I2CSTR.SCD@1us")
    assert (unread.reader, unread.reads, unread.since, unread.tick) == (None, 0, 10 * CYCLE, 3000)


def test_a_walk_has_eight_causes_by_default():
    rows = [flag(n, "SCD", n % 2, n - 1) for n in range(1, 15)]
    assert DEPTH == 8
    assert [len(why(by_hand(*rows), "I2CSTR.SCD@1us", *depth).back) for depth in ((), (0,), (3,), (99,))] == [
        9,
        1,
        4,
        14,
    ]
