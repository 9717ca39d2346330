"""Names and times in questions: register maps of a recording, the meaning of a name, and messages about bad names."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.records.register_maps import is_status, one_clears, register_of, registers_of
from periph_sim.records.run import NotInRun, Run
from periph_sim.records.subject import asked, groups_of, named, subjects
from tests.records.cause_trace.test_causes import edge
from tests.records.scenes import CYCLE, by_hand, flag
from tests.refusals import refusal


def span(cycle: int, name: str, value: int = 1) -> tuple[Any, ...]:
    return cycle, Kind.SPAN, "dsp", name, value, "", 0


def refused(run: Run, question: str) -> str:
    return refusal(NotInRun, asked, run, question)


def test_the_closest_spelling_of_a_name_is_preferred():
    """A name is compared exactly, then by its last part, then both without regard to hyphens and case."""
    run = by_hand(span(1, "model"), span(2, "MODEL"), span(3, "Deep.model"), edge(4, 0, "c"), span(5, "scl"))
    for name, meant in (
        ("dsp.model", "dsp.model"),
        ("DSP.model", "DSP.model"),
        ("dsp.Model", ""),
        ("MODEL", "dsp.MODEL"),
        ("Deep.model", "dsp.Deep.model"),
        ("deep.MODEL", "dsp.Deep.model"),
        ("SCL", "SCL"),
        ("scl", "dsp.scl"),
        ("i2ca.i2cstr.xrdy", "dsp.I2C-A.I2CSTR.XRDY"),
        ("BB", "dsp.I2C-A.I2CSTR.BB"),
        ("DSP.I2CA.I2CSTR.bb", "dsp.I2C-A.I2CSTR.BB"),
    ):
        if name == "DSP.model" or not meant:
            assert f"{name!r} may mean dsp.model, dsp.MODEL; give one of them" in refused(run, f"{name}@1us")
        else:
            assert named(run, name).name == meant, name
    assert "'model' may mean dsp.model, dsp.Deep.model; give one of them" in refused(run, "model@1us")


@pytest.mark.parametrize(("count", "more"), [(2, ""), (8, ""), (9, ", ...")])
def test_at_most_eight_of_many_candidates_are_listed(count: int, more: str):
    run = by_hand(*(span(n + 1, f"s{n}.x") for n in range(count)))
    names = ", ".join(f"dsp.s{n}.x" for n in range(min(count, 8)))
    assert refused(run, "x@1us") == f"the run: 'x' may mean {names}{more}; give one of them"


@pytest.mark.parametrize(
    ("question", "said"),
    [
        ("SCLL@1us", "the run: nothing in the run is called 'SCLL'; did you mean SCL or RSFULL or LSPCLK?"),
        ("scll@1us", "the run: nothing in the run is called 'scll'; did you mean SCL or RSFULL or LSPCLK?"),
        (
            "I2CSTR.XRDDY@1us",
            "the run: nothing in the run is called 'I2CSTR.XRDDY'; did you mean I2CSTR.XRDY or I2CSTR.RRDY or "
            "I2CSTR.ARDY?",
        ),
        (
            "qqqqqqq@1us",
            "the run: nothing in the run is called 'qqqqqqq'; it has fields of dsp.I2C-A, dsp.SYS, dsp.PIE; wires SCL",
        ),
        (  # a wire has no part before its name
            "x.SCL@1us",
            "the run: nothing in the run is called 'x.SCL'; it has fields of dsp.I2C-A, dsp.SYS, dsp.PIE; wires SCL",
        ),
        ("SCL", "'SCL': expected NAME@TIME, as in I2C-A.I2CSTR.XRDY@12.345ms or SDA@3us"),
        (" @1us", "' @1us': expected NAME@TIME, as in I2C-A.I2CSTR.XRDY@12.345ms or SDA@3us"),
        ("SCL@67us", "the run: 67us is outside the run, which goes from 0 to 0.066667 ms"),
        ("SCL@1", "'1' has no unit; write for instance 1 ms (ns, us, ms, s, min, h, d)"),
        ("SCL@1 parsec", "'1 parsec': unit 'parsec' is none of ns, us, ms, s, min, h, d"),
        ("NACK@1us", "the run: 'NACK' may mean dsp.I2C-A.I2CIER.NACK, dsp.I2C-A.I2CSTR.NACK; give one of them"),
    ],
)
def test_an_unknown_name_is_rejected_with_the_nearest_ones(question: str, said: str):
    assert refused(by_hand(edge(10, 0, "c")), question) == said


def test_the_message_of_a_run_without_wires_says_none():
    assert refused(by_hand(flag(1, "SCD", 1)), "qqqqqqq@1us").endswith(
        "fields of dsp.I2C-A, dsp.SYS, dsp.PIE; wires none"
    )


def test_the_first_and_the_last_tick_are_part_of_the_run():
    run = by_hand(edge(10, 0, "c"), end=15)  # 100 ns
    assert [asked(run, f"SCL@{time}")[1] for time in ("0 ns", "100 ns")] == [0, 15 * CYCLE]
    assert "outside the run" in refused(run, "SCL@100.334 ns") and "outside the run" in refused(run, "SCL@-0.1 ns")


@pytest.mark.parametrize(
    ("time", "tick"),
    [
        ("80 ns", 240),  # no change would be written as this time
        ("66 ns", 198),
        ("66.7 ns", 200),  # 66 2/3 ns
        ("66.6 ns", 199),
        ("67 ns", 200),
        ("0.067us", 200),
        ("0.0000667 ms", 200),
        ("0.07us", 200),
        ("0.1us", 200),  # both changes would be written so: the earlier one is chosen
        ("133.3 ns", 400),
        ("100 ns", 300),  # between the two changes
        ("6_7 ns", 200),
        (" 67 ns ", 200),
    ],
)
def test_a_rounded_time_means_the_change_that_is_written_so(time: str, tick: int):
    """The changes are at 66 2/3 and 133 1/3 ns."""
    assert asked(by_hand(edge(10, 0, "c"), edge(20, 1, "")), f"SCL@{time}")[1] == tick


def test_a_rounded_time_means_the_nearer_of_two_changes():
    run = by_hand(flag(1499, "SCD", 1), flag(1501, "SCD", 0))  # 9.99333 and 10.00667 us
    assert asked(run, "I2CSTR.SCD@9.99 us")[1] == 1499 * CYCLE
    assert asked(run, "I2CSTR.SCD@10.01 us")[1] == 1501 * CYCLE


@pytest.mark.parametrize(("cycle", "meant"), [(36, True), (38, False)])
def test_a_rounded_time_means_a_change_within_half_of_the_last_digit(cycle: int, meant: bool):
    """The change is at 240 or 253 1/3 ns. 0.2 us is the rounded value of 150 to 250 ns."""
    assert asked(by_hand(flag(cycle, "SCD", 1)), "I2CSTR.SCD@0.2us")[1] == (cycle * CYCLE if meant else 600)


def test_times_are_rounded_to_a_microsecond_at_most():
    run = by_hand(flag(1499, "SCD", 1))
    assert asked(run, "I2CSTR.SCD@10 us")[1] == 1499 * CYCLE
    late = by_hand(flag(1520, "SCD", 1))
    assert asked(late, "I2CSTR.SCD@0.01 ms")[1] == 30_000  # the last digit is 10 us


def test_the_subjects_of_a_run_are_listed_once():
    run = by_hand(edge(1, 0, "c"), span(2, "model"), edge(3, 1, ""), span(4, "model", 0), edge(5, 0, "c"))
    found = [one for one in subjects(run) if one.kind is not Kind.FLAG]
    assert [(one.kind, one.name, one.unit, one.where, one.what) for one in found] == [
        (Kind.EDGE, "SCL", "", "SCL", "level"),
        (Kind.SPAN, "dsp.model", "dsp", "dsp", "model"),
    ]
    fields = [one for one in subjects(run) if one.kind is Kind.FLAG]
    assert len({one.name for one in fields}) == len(fields) > 100
    (xrdy,) = [one for one in fields if one.what == "I2CSTR.XRDY"]
    assert (xrdy.name, xrdy.unit, xrdy.where, xrdy.module) == ("dsp.I2C-A.I2CSTR.XRDY", "dsp", "dsp.I2C-A", "I2C-A")
    assert xrdy.register is not None and xrdy.register.name == "I2CSTR" and xrdy.field is xrdy.register["XRDY"]


@pytest.mark.parametrize(
    ("module", "status", "cleared"),
    [
        ("I2C-A", "I2CSTR I2CFFTX I2CFFRX", {"I2CSTR": "SDIR NACKSNT SCD RRDY ARDY NACK AL"}),
        ("SCI-B", "SCICTL2 SCIRXST SCIRXBUF SCIFFTX SCIFFRX SCIFFCT", {}),
        ("TIMER1", "TCR", {"TCR": "TIF"}),
        ("XINT", "", {}),
        ("GPIO", "", {}),
        ("SYS", "PLLSTS SCSR WDCR", {"SCSR": "WDOVERRIDE", "WDCR": "WDFLAG"}),
        ("PIE", "", {"PIEACK": "PIEACK"}),
    ],
)
def test_registers_with_flags_of_hardware_and_fields_that_writing_1_clears(
    module: str, status: str, cleared: dict[str, str]
):
    registers = registers_of(module)
    assert registers is not None
    assert " ".join(one.name for one in registers if is_status(one)) == status
    fields = {one.name: " ".join(f.name for f in one_clears(one)) for one in registers}
    assert {name: names for name, names in fields.items() if names} == cleared


def test_other_modules_and_registers_are_unknown():
    assert [registers_of(module) for module in ("EPWM1", "", "SYSX", "I2")] == [None] * 4
    assert [register_of(*name) for name in (("EPWM1", "TBPRD"), ("I2C-A", "SCICCR"))] == [None] * 2


def access(unit: str, what: str) -> tuple[Any, ...]:
    return 1, Kind.ACCESS, unit, what, 0, "f:1", 0, ""


@pytest.mark.parametrize(
    ("name", "found"),
    [
        (None, ["one W I2CSTR", "one R I2CSTR", "two R I2CSTR"]),  # all status registers
        ("I2C-A.I2CSTR", ["one W I2CSTR", "one R I2CSTR", "two R I2CSTR"]),
        ("two.i2ca.i2cstr", ["two R I2CSTR"]),
        ("one.I2C-A.I2CSTR.scd", ["one W I2CSTR SCD", "one R I2CSTR SCD"]),
        ("I2CA.I2CCNT.ICDC", ["two W I2CCNT ICDC"]),
    ],
)
def test_a_name_means_a_register_of_all_units_or_of_one_or_a_field(name: str | None, found: list[str]):
    accesses = ("W I2C-A.I2CSTR", "R I2C-A.I2CSTR")
    run = by_hand(
        *(access("one", what) for what in accesses), access("two", accesses[1]), access("two", "W I2C-A.I2CCNT")
    )
    found_groups = [
        (group.unit, group.way, group.register.name, *([f.name] if f else [])) for group, f in groups_of(run, name)
    ]
    assert [" ".join(one) for one in found_groups] == found


@pytest.mark.parametrize(
    ("name", "nearest"),
    [
        ("I2C-A.I2CSRT", "I2C-A.I2CSTR"),
        ("I2CSRT", "I2C-A.I2CSTR"),
        ("dsp.I2C-A.I2CSRT", "dsp.I2C-A.I2CSTR"),
        ("dsp.I2C-A.I2CSTR.SCDD", "dsp.I2C-A.I2CSTR"),
    ],
)
def test_a_register_that_was_never_accessed_is_rejected_with_the_closest_name_in_the_same_form(name: str, nearest: str):
    said = refusal(NotInRun, groups_of, by_hand(access("dsp", "R I2C-A.I2CSTR")), name)
    assert said.startswith(f"the run: the firmware never accessed {name!r}; ")
    assert nearest in said
