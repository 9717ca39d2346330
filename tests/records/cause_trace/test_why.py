"""Why a thing stood as it did: values against a count by hand, causes recorded and inferred, names, bad questions."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.records import Kind
from periph_sim.firmware import start_i2c
from periph_sim.processor.dsp import Dsp
from periph_sim.records.cause_trace.text_report import as_json, said, text
from periph_sim.records.cause_trace.why import why
from periph_sim.records.run import NotInRun, Run
from periph_sim.scene.case.load import load
from tests.records.scenes import ADDRESS, CYCLE, PER_SECOND, asks, by_hand, line_of, ran, recorded
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


def test_a_write_is_the_recorded_cause_with_its_place(run: Run):
    answer = why(run, "I2C-A.I2CMDR.IRS@0.5ms")
    gave, wrote = answer.back[:2]
    assert (answer.value, gave.record.kind, gave.known) == (1, Kind.FLAG, "")
    assert (wrote.record.what, wrote.record.text, wrote.known) == ("W I2C-A.I2CMDR", line_of(turn_on), "recorded")
    assert "0: the module is held in reset. [SPRUG03B table 5]" in text(answer)


def test_an_edge_that_a_filter_delays_is_the_recorded_cause_and_the_party_behind_it_is_inferred(run: Run):
    answer = why(run, "BB@1.001ms")
    gave, edge, party = answer.back
    assert (edge.record.where, edge.record.value, edge.known) == ("SDA", 0, "recorded")
    assert gave.record.tick - edge.record.tick == 15 * CYCLE  # the filter of one module clock, IPSC = 14
    assert (party.record.where, party.record.what, party.known) == ("controller", "START", "inferred")
    assert "SDA falls, pulled low by controller" in text(answer)


def test_behind_a_write_stands_what_the_firmware_read_before_it(run: Run):
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


def test_who_read_it_next_and_when_it_changed_again(run: Run):
    answer = why(run, "I2CSTR.BB@1.001ms")
    assert answer.reader is not None and answer.changed is not None
    assert 0 <= answer.reader.record.tick - answer.since < 30 * CYCLE
    assert answer.reader.record.value & 0x1000 and answer.reads >= 1
    assert (answer.changed.record.what, answer.changed.record.value) == ("I2CSTR.BB", 0)
    free = why(run, "I2CSTR.BB@2.9ms")
    assert free.changed is None and "it did not change again" in text(free)


def test_before_its_first_change_a_field_is_as_reset_left_it(run: Run):
    answer = why(run, "I2CSTR.BB@0.5ms")
    assert (answer.value, answer.back) == (0, ()) and "as reset left it" in text(answer)
    assert answer.changed is not None and answer.changed.record.value == 1
    assert why(run, "I2CCNT.ICDC@1ms").value == 0


@pytest.mark.parametrize("name", ["BB", "i2cstr.bb", "I2CA.I2CSTR.BB", "dsp.I2C-A.I2CSTR.BB", "DSP.I2CA.I2CSTR.bb"])
def test_units_hyphens_and_case_may_be_left_out(run: Run, name: str):
    assert why(run, f"{name}@1.001 ms").subject.name == "dsp.I2C-A.I2CSTR.BB"


def test_wires_and_spans(run: Run):
    assert [why(run, f"SDA@{time}").value for time in ("0.9ms", "1.001ms")] == [1, 0]
    inside = why(run, "work@1.01ms")
    assert inside.value == 1 and "in it since" in text(inside)
    assert why(run, "dsp.work@2ms").value == 0


def test_an_interrupt_goes_back_to_the_flag_of_its_module_and_the_edge(emulator: Run):
    (entered, *_) = [r for r in emulator.records(emulator.rows(Kind.IRQ)) if r.value]
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


def test_a_step_after_step_walk_may_be_cut_short(emulator: Run):
    assert len(why(emulator, "SCIRXINTA@3.1ms", depth=0).back) == 1
    assert len(why(emulator, "SCIRXINTA@3.1ms", depth=2).back) == 3


def test_a_rising_wire_was_released_by_who_held_it():
    run = by_hand(
        (10, Kind.EDGE, "SDA", "level", 0, "controller", 0),
        (20, Kind.EDGE, "SDA", "level", 1, "", 0),
    )
    assert "SDA rises, released by controller" in text(why(run, "SDA@1us"))


def test_steps_of_registers_name_their_section_of_the_manual_and_no_others_do(run: Run):
    answer = why(run, "I2C-A.I2CSTR.SCD@2ms")
    told = {step.record.kind: said(run, step) for step in answer.back}
    assert set(told) >= {Kind.FLAG, Kind.EDGE}
    assert told[Kind.FLAG].endswith("[SPRUG03B table 10]")
    assert not any("[" in words for kind, words in told.items() if kind is not Kind.FLAG)


@given(cycle=st.integers(0, 60), changes=st.lists(st.integers(1, 30), min_size=1, max_size=6))
def test_the_value_is_that_of_the_last_change(cycle: int, changes: list[int]):
    at = [sum(changes[: n + 1]) for n in range(len(changes))]
    run = by_hand(*((c, Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB", (n + 1) % 2, "", 0) for n, c in enumerate(at)), end=300)
    answer = why(run, f"BB@{cycle * CYCLE / 3} ns")
    passed = [n for n, c in enumerate(at) if c * CYCLE <= int(cycle * CYCLE / 3 * 3)]
    assert abs(answer.tick - cycle * CYCLE) <= 1
    if answer.tick == cycle * CYCLE:
        assert answer.value == (len(passed) % 2)
        assert answer.since == (at[passed[-1]] * CYCLE if passed else 0)


@pytest.mark.parametrize(
    ("question", "said"),
    [
        ("I2C-A.I2CSTR.XRYD@1ms", "did you mean I2C-A.I2CSTR.XRDY or"),
        ("XRDY", "expected NAME@TIME"),
        ("SDA@1", "has no unit"),
        ("SDA@1 parsec", "unit 'parsec' is none of"),
        ("SDA@4ms", "4ms is outside the run, which goes from 0 to 3.000000 ms"),
        ("SDA@-1ms", "outside the run"),
        ("NACK@1ms", "may mean dsp.I2C-A.I2CIER.NACK, dsp.I2C-A.I2CSTR.NACK; give one of them"),
        ("zzzz@1ms", "it has fields of dsp.I2C-A, dsp.SYS, dsp.PIE; wires"),
    ],
)
def test_a_question_that_cannot_be_answered_says_what_would_do(run: Run, question: str, said: str):
    with pytest.raises(NotInRun) as caught:
        why(run, question)
    assert said in str(caught.value)


def test_as_json_has_the_same_steps(run: Run):
    found = as_json(why(run, "I2C-A.I2CMDR.IRS@0.5ms"))
    assert found["value"] == 1 and found["source"] == "SPRUG03B table 5"
    assert [step["kind"] for step in found["back"]][:2] == ["flag", "access"]


def test_cycles_come_from_the_accesses_or_are_stated():
    access = (Kind.ACCESS, "dsp", "R I2C-A.I2CSTR", 0, "f:1", 0)
    assert by_hand((1, *access), (4, *access)).cycles.ticks == CYCLE
    slower = by_hand((0, *access), (3, *access), (6, *access), (10, *access))
    slower.table.columns["tick"] = slower.table.tick * 3 // 2
    assert (slower.cycles.ticks, slower.cycles.how.split(",")[0]) == (30, "SYSCLKOUT 100 MHz")
    assert "taken as 150 MHz" in by_hand().cycles.how
    assert Run(by_hand().table, sysclk=PER_SECOND / 40).cycles.ticks == 40


def test_with_two_units_the_unit_has_to_be_named():
    run = recorded(load(TIMING / "two_dsps.toml", []), "0.001")
    with pytest.raises(NotInRun, match=r"may mean head\.I2C-A\.I2CMDR\.IRS, imu\.I2C-A\.I2CMDR\.IRS; give one"):
        why(run, "I2CA.I2CMDR.IRS@0.9ms")
    assert [why(run, f"{unit}.I2CA.I2CMDR.IRS@0.9ms").subject.unit for unit in ("imu", "head")] == ["imu", "head"]
