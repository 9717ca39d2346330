"""What an answer says of each sort of thing: fields, wires, spans and interrupts, at and around their changes."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.f28335.cpu_timer import register_map as timer_map
from periph_sim.f28335.gpio import register_map as gpio_map
from periph_sim.f28335.i2c.register_map import I2C_MAP
from periph_sim.f28335.pie import register_map as pie_map
from periph_sim.f28335.sci.register_map import SCI_MAP
from periph_sim.f28335.spi.register_map import SPI_MAP
from periph_sim.f28335.system_control import register_map as clocks_map
from periph_sim.f28335.xint import register_map as xint_map
from periph_sim.records.cause_trace.text_report import text
from periph_sim.records.cause_trace.why import DEPTH, EFFECTS, why
from periph_sim.records.register_maps import is_status, one_clears, register_of, registers_of
from periph_sim.records.run import Run
from tests.records.cause_trace.test_causes import edge, flag, irq, read, write
from tests.records.scenes import CYCLE, by_hand


def span(cycle: int, value: int) -> tuple[Any, ...]:
    return cycle, Kind.SPAN, "dsp", "model", value, "f:1" if value else "", 0


def values(run: Run, name: str, *cycles: int) -> list[int | None]:
    return [why(run, f"{name}@{cycle * 20 / 3:.4f} ns").value for cycle in cycles]


def test_values_before_at_and_after_changes():
    run = by_hand(
        edge(10, 0, "c"), flag(20, "SCD", 1), span(30, 1), irq(40, 1), span(50, 0), edge(60, 1, ""), irq(70, 0, 4)
    )
    assert values(run, "SCL", 0, 9, 10, 59, 60, 99) == [1, 1, 0, 0, 1, 1]
    assert values(run, "I2CSTR.SCD", 19, 20, 99) == [0, 1, 1]
    assert values(run, "I2CSTR.XRDY", 5) == [1]  # as reset leaves it
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


def test_a_span_and_a_wire_have_no_reads_and_end_with_no_note():
    run = by_hand(span(30, 1), edge(40, 0, "c"))
    for name in ("model", "SCL"):
        told = text(why(run, f"{name}@1us"))
        assert told.endswith("\n  it did not change again") and "recorded read" not in told
    before = text(why(run, "model@100ns"))
    assert "  nothing changed it before; no record of it" in before
    assert "  changed  200 ns (30 cycles) after  dsp: span model begins at f:1" in before


@pytest.mark.parametrize("effects", [0, 1, EFFECTS, EFFECTS + 2])
def test_what_a_record_set_off_up_to_five(effects: int):
    rows = [flag(11 + n, "SCD", n % 2, 1) for n in range(effects)]
    answer = why(by_hand(edge(10, 0, "c"), *rows, flag(50, "BB", 1, 2)), "SCL@100ns")
    assert [step.record.number for step in answer.effects] == [2 + n for n in range(min(effects, 5))]


def test_reads_between_two_changes_that_looked_at_the_field():
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
    nobody = why(by_hand(flag(10, "SCD", 1), read(12, 0, "XRDY")), "I2CSTR.SCD@1us")
    assert (nobody.reader, nobody.reads, nobody.since, nobody.tick) == (None, 0, 10 * CYCLE, 3000)


def test_a_walk_goes_eight_causes_back_unless_said():
    rows = [flag(n, "SCD", n % 2, n - 1) for n in range(1, 15)]
    assert DEPTH == 8
    assert [len(why(by_hand(*rows), "I2CSTR.SCD@1us", *depth).back) for depth in ((), (0,), (3,), (99,))] == [
        9,
        1,
        4,
        14,
    ]


# Maps -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("module", "registers"),
    [
        ("I2C-A", I2C_MAP),
        ("SCI-A", SCI_MAP),
        ("SCI-C", SCI_MAP),
        ("TIMER2", timer_map.MAP),
        ("XINT", xint_map.XINT),
        ("GPIO", gpio_map.GPIO),
        ("SYS", clocks_map.MAP),
        ("PIE", pie_map.MAP),
        ("SPI-A", SPI_MAP),
        ("ADC", None),
        ("", None),
    ],
)
def test_the_registers_of_a_module(module: str, registers: object):
    assert registers_of(module) is registers


def test_registers_by_name_and_those_of_status():
    assert register_of("I2C-A", "I2CSTR") is I2C_MAP["I2CSTR"]
    assert (
        register_of("I2C-A", "I2CSRT") is None and register_of("SPI-A", "X") is None and register_of("ADC", "X") is None
    )
    status = [r.name for r in I2C_MAP.registers if is_status(r)]
    assert "I2CSTR" in status and not {"I2CDXR", "I2CDRR", "I2CCNT", "I2CPSC", "I2CMDR"} & {*status}
    cleared = ["SDIR", "NACKSNT", "SCD", "RRDY", "ARDY", "NACK", "AL"]
    assert [f.name for f in one_clears(I2C_MAP["I2CSTR"])] == cleared and one_clears(I2C_MAP["I2CMDR"]) == ()
