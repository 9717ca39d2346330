"""Complete answers to `why`: as text, each record with its distance and how it is known, and as JSON."""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind
from periph_sim.core.text_table import paragraph
from periph_sim.records.cause_trace.why import SKIPPED, as_json, text, why
from periph_sim.records.run import Run
from tests.records.cause_trace.test_causes import count, counted, edge, flag, read
from tests.records.scenes import CYCLE, by_hand

SET, READ, WRITTEN, CHANGED, READ_NEXT, CHANGED_NEXT = range(1, 7)  # numbers of the records
NOTE = paragraph(SKIPPED)  # the last lines of an answer
TABLE_10, TABLE_18 = "[SPRUG03B table 10]", "[SPRUG03B table 18]"


@pytest.fixture
def run() -> Run:
    """SCD is set and read, and I2CCNT is written. The firmware reads it back, and after a byte it counts down."""
    return by_hand(
        flag(1000, "SCD", 1),
        read(1015, 0x20, "SCD"),
        count(1030),
        counted(1033, WRITTEN),
        (1045, Kind.ACCESS, "dsp", "R I2C-A.I2CCNT", 6, "f:3", 0, "ICDC"),
        (1183, Kind.FLAG, "dsp.I2C-A", "I2CCNT.ICDC", 5, "", CHANGED),
        end=3000,
    )


def test_an_answer_as_text(run: Run):
    assert text(why(run, "ICDC@7.22us")).splitlines() == [
        "dsp.I2C-A.I2CCNT.ICDC at 0.007220 ms: 6 since 0.006887 ms, 333.333 ns (50 cycles) before",
        f"  ICDC, R/W: Bytes to move; 0 is 65536. {TABLE_18}",
        "",
        "back:",
        f"  #4  0.006887 ms                dsp.I2C-A.I2CCNT.ICDC = 6 {TABLE_18}",
        "  #3  20 ns (3 cycles) before    dsp: I2C-A.I2CCNT written, 0x0006 at f:9",
        "                                 [recorded: the last input that had taken",
        "                                   effect]",
        "  #2  120 ns (18 cycles) before  dsp: I2C-A.I2CSTR read, 0x0020 (SCD = 1) at f:1",
        "                                 [inferred: the read before it that saw the",
        "                                   newest change]",
        f"  #1  220 ns (33 cycles) before  dsp.I2C-A.I2CSTR.SCD set {TABLE_10}",
        "                                 [inferred: the last change of what it read]",
        "  the walk ends here: no record of a cause of it",
        "",
        "forward:",
        "  set off  1 us (150 cycles) after  dsp.I2C-A.I2CCNT.ICDC = 5",
        f"                                      {TABLE_18}",
        "  read     80 ns (12 cycles) after  dsp: I2C-A.I2CCNT read, 0x0006 (ICDC = 6) at",
        "                                      f:3",
        "  changed  1 us (150 cycles) after  dsp.I2C-A.I2CCNT.ICDC = 5",
        f"                                      {TABLE_18}",
        "  1 recorded read that looked at it before that change",
        *NOTE,
    ]


@pytest.mark.parametrize(
    ("question", "reads"),
    [
        ("I2CSTR.BB@7us", "1 recorded read"),
        ("I2CSTR.SCD@7us", "2 recorded reads"),
        ("I2CMDR.IRS@7us", "no recorded reads"),
    ],
)
def test_the_end_of_an_answer_has_the_number_of_reads(question: str, reads: str):
    run = by_hand(flag(1000, "BB", 1), flag(1000, "SCD", 1), read(1010, 0x1020, "SCD"), read(1020, 0x1020, ""))
    said = text(why(run, question)).splitlines()
    last = f"  {reads} that looked at it before the end of the run"
    assert said[-4:] == [last, "  it did not change again", *NOTE]


def test_an_answer_about_a_wire_has_no_reads_and_names_the_party_that_released_it():
    run = by_hand(edge(10, 0, "controller"), edge(20, 1, ""))
    low, high = (text(why(run, f"SCL@{time}")).splitlines() for time in ("0.1us", "0.2us"))
    assert low[3:] == [
        "  #1  0.000067 ms  SCL falls, pulled low by controller",
        "  the walk ends here: no record of a cause of it",
        "",
        "forward:",
        "  changed  66.667 ns (10 cycles) after  SCL rises, released by controller",
    ]
    assert high[3:5] == [
        "  #2  0.000133 ms  SCL rises, released by controller",
        "  the walk ends here: no record of a cause of it",
    ]
    assert high[-1] == "  it did not change again"


def test_a_field_without_a_description_is_shown_with_access_and_source():
    run = by_hand((1000, Kind.FLAG, "dsp.GPIO", "GPADAT.GPIO3", 1, "", 0), modules=("GPIO",))
    assert text(why(run, "GPADAT.GPIO3@7us")).splitlines()[1] == "  GPIO3, R/W [SPRUFB0D Figures 65 to 67]"


def test_the_steps_of_an_answer_as_json(run: Run):
    found = as_json(why(run, "ICDC@7.22us"))
    first = 1033 * CYCLE
    assert (found["tick"], found["since_s"], found["value"]) == (1083 * CYCLE, first / 3e9, 6)
    assert (found["source"], found["doc"]) == (TABLE_18[1:-1], "Bytes to move; 0 is 65536.")
    back = found["back"]
    assert isinstance(back, list)
    keys = ("record", "tick", "cycles_from_value", "known", "because", "cause_of", "aside")
    assert [tuple(step[key] for key in keys) for step in back] == [
        (CHANGED, first, 0, None, None, None, False),
        (WRITTEN, first - 3 * CYCLE, -3, "recorded", "the last input that had taken effect", CHANGED, False),
        (READ, first - 18 * CYCLE, -18, "inferred", "the read before it that saw the newest change", WRITTEN, False),
        (SET, first - 33 * CYCLE, -33, "inferred", "the last change of what it read", READ, False),
    ]
    after = {key: found[key] for key in ("next_read", "next_change")}
    assert [(step["record"], step["cycles_from_value"]) for step in after.values() if isinstance(step, dict)] == [
        (READ_NEXT, 12),
        (CHANGED_NEXT, 150),
    ]
    assert (found["reads_before_change"], found["set_off"]) == (1, [found["next_change"]])


def test_the_json_of_a_wire_has_no_register_entries():
    found = as_json(why(by_hand(edge(10, 0, "controller")), "SCL@0.1us"))
    assert (found["doc"], found["source"], found["next_read"], found["next_change"]) == (None, None, None, None)
    assert (found["pulled_by"], found["held_by"]) == (["controller"], ["controller"])
