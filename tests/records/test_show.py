"""Complete reports of races, causes and lints, for runs that are small enough to be computed by hand."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.records import lint as show_lint
from periph_sim.records import races_text_report as show_races
from periph_sim.records.cause_trace import why as show_why
from periph_sim.records.cause_trace.why import why
from periph_sim.records.lint import Finding, all_lints
from periph_sim.records.races import distances, races
from tests.records.scenes import by_hand, flag, read, write
from tests.records.test_races import RRDY, SCD
from tests.unwrapped import unwrapped

HEAD = """\
the run: cycles between reads and changes; SYSCLKOUT 150 MHz, which all accesses
  fall on"""
NOTES = """\
note: reads: recorded reads. polls: reads beside a change in skipped waits,
  reconstructed from the length of a pass. Columns 0 to more: reads and polls by
  the number of cycles to the nearest change.
note: A read that names a field is compared with the changes of that field. A
  read of the whole register, such as the read of a read-modify-write, is
  compared with the changes of all fields. Changes that an access of the
  firmware makes at once do not count."""

# A read, a read-modify-write of SCD, during which NACK is set, and two later reads. The write clears RRDY; changes by
# the firmware itself are not races.
ROWS = [
    flag(50, "RRDY", 1),
    read(80, RRDY, place="look:9"),
    read(100, RRDY, place="f:1"),
    flag(101, "NACK", 1),
    write(102, RRDY | SCD, place="f:1"),
    flag(102, "RRDY", 0, cause=5),
    read(1500, 0, place="main:7"),
    read(2500, 0, place="main:7"),
]


def test_races_as_a_table():
    assert show_races.text(races(by_hand(*ROWS))) == (
        f"""\
{HEAD}

 register      place   closest  cycles  field           at
 ─────────────────────────────────────────────────────────
 I2C-A.I2CSTR  f:1     before        1  NACK   0.000667 ms
                       after        50  RRDY   0.000667 ms
 I2C-A.I2CSTR  look:9  before       21  NACK   0.000533 ms
                       after        30  RRDY   0.000533 ms
 I2C-A.I2CSTR  main:7  before        -
                       after      1399  NACK   0.010000 ms

 register      place   reads  polls  0  <10  <100  <1k  <10k  more
 ─────────────────────────────────────────────────────────────────
 I2C-A.I2CSTR  f:1         1      0  0    1     0    0     0     0
 I2C-A.I2CSTR  look:9      1      0  0    0     1    0     0     0
 I2C-A.I2CSTR  main:7      2      0  0    0     0    0     2     0

read-modify-writes of flags that writing 1 clears:
  I2C-A.I2CSTR at f:1: 1 time, to clear SCD
    RRDY was cleared along with it 1 time, 0 of them never read since it rose;
      first at 0.000680 ms
    NACK rose between read and write 1 time; lost 0

{NOTES}
closest: 1 cycles; flags lost to read-modify-writes: 0 (cleared along: 1)"""
    )


def test_races_without_a_change_and_without_another_flag():
    assert show_races.text(races(by_hand(read(100), write(102, 0)))) == (
        f"""\
{HEAD}

 register      place  closest  cycles  field  at
 ───────────────────────────────────────────────
 I2C-A.I2CSTR  f:1    before        -
                      after         -

 register      place  reads  polls  0  <10  <100  <1k  <10k  more
 ────────────────────────────────────────────────────────────────
 I2C-A.I2CSTR  f:1        1      0  0    0     0    0     0     0

read-modify-writes of flags that writing 1 clears:
  I2C-A.I2CSTR at f:1: 1 time, to clear nothing; no other flag cleared, none
    rose in between

{NOTES}
closest: no change to be near to; flags lost to read-modify-writes: 0 (cleared along: 0)"""
    )


def test_races_with_an_unfilled_wait_and_without_read_modify_writes():
    run = by_hand(read(100), read(110), flag(507, "RRDY", 1), read(513, RRDY))
    assert distances(run)[2] == 1
    report = show_races.text(races(run))
    assert [line.split() for line in report.splitlines()[5:7]] == [
        [STR, "f:1", "before", "397", "RRDY", "0.000733", "ms"],
        ["after", "6", "RRDY", "0.003420", "ms"],
    ]
    assert report.splitlines()[10].split() == [STR, "f:1", *["3", "0", "0", "1", "0", "2", "0", "0"]]
    assert report.splitlines()[11:] == [
        "",
        *NOTES.splitlines(),
        "note: 1 skipped waits with a change in them do not show how long a pass is;",
        "  there only the recorded reads count",
        "closest: 6 cycles; flags lost to read-modify-writes: 0 (cleared along: 0)",
    ]


def shave(cycles: int, at_cycle: int, field: str) -> dict[str, Any]:
    return {"cycles": cycles, "read_at_s": pytest.approx(at_cycle / 150e6, rel=1e-12), "field": field}


def place(name: str, reads: int, before: Any, after: Any, histogram: tuple[int, ...]) -> dict[str, Any]:
    more = {"polls": 0, "unplaced": 0, "histogram": histogram, "alone": 0}
    return {"unit": "dsp", "register": STR, "place": name, "reads": reads, "before": before, "after": after, **more}


STR = "I2C-A.I2CSTR"


def test_races_as_json():
    found = show_races.as_json(races(by_hand(*ROWS)))
    assert found.pop("places") == [
        place("f:1", 1, shave(1, 100, "NACK"), shave(50, 100, "RRDY"), (0, 1, 0, 0, 0, 0)),
        place("look:9", 1, shave(21, 80, "NACK"), shave(30, 80, "RRDY"), (0, 0, 1, 0, 0, 0)),
        place("main:7", 2, None, shave(1399, 1500, "NACK"), (0, 0, 0, 0, 2, 0)),
    ]
    flags = [
        {"flag": "RRDY", "rose": 0, "lost_between": 0, "along": 1, "unseen": 0, "lost": (), "cleared": (2040,)},
        {"flag": "NACK", "rose": 1, "lost_between": 0, "along": 0, "unseen": 0, "lost": (), "cleared": ()},
    ]
    assert found.pop("modifies") == [
        {
            "unit": "dsp",
            "register": STR,
            "place": "f:1",
            "count": 1,
            "meant": ("SCD",),
            "doubt": (),
            "lost": 0,
            "flags": [{**flags[0], "first_s": pytest.approx(102 / 150e6)}, {**flags[1], "first_s": None}],
        }
    ]
    assert unwrapped(" ".join(f"note: {note}" for note in found.pop("notes"))) == unwrapped(NOTES)
    assert found == {
        "run": "the run",
        "cycle_ticks": 20.0,
        "cycle_from": "SYSCLKOUT 150 MHz, which all accesses fall on",
        "closest": 1,
        "lost": 0,
        "cleared_along": 1,
        "decades": ["0", "1..9", "10..99", "100..999", "1000..9999", "10000.."],
    }


def test_the_intended_flag_is_reported_as_uncertain_if_there_are_two():
    """RRDY and SCD are 1 and are written as 1, so either can be the intended one."""
    both = flag(10, "RRDY", 1), flag(20, "SCD", 1), read(100, RRDY | SCD), write(102, RRDY | SCD)
    report = show_races.text(races(by_hand(*both)))
    assert " I2C-A.I2CSTR at f:1: 1 time, to clear one of SCD, RRDY, all set each time; no other flag" in unwrapped(
        report
    )


def test_with_two_units_registers_are_shown_with_their_unit():
    of = by_hand(*ROWS)
    of.table.modules["other"] = ("I2C-A",)
    report = show_races.text(races(of))
    assert " dsp.I2C-A.I2CSTR  f:1 " in report and "  dsp.I2C-A.I2CSTR at f:1: 1 time, to clear SCD" in report


# Why ------------------------------------------------------------------------------------------------------------


def test_why_before_the_first_change():
    text = show_why.text(why(by_hand(*ROWS), "I2CSTR.RRDY@100ns")).splitlines()
    assert text[:4] == [
        "dsp.I2C-A.I2CSTR.RRDY at 0.000100 ms: 0, as reset left it",
        "  RRDY, R/W1C: I2CDRR holds an unread byte. [SPRUG03B table 10]",
        "",
        "back:",
    ]
    assert "changed 333.333 ns (50 cycles) after dsp.I2C-A.I2CSTR.RRDY set [SPRUG03B table 10]" in unwrapped(
        " ".join(text)
    )
    assert "  no recorded reads that looked at it before that change" in text


def test_why_counts_the_reads_until_the_next_change():
    text = show_why.text(why(by_hand(*ROWS), "I2CSTR.RRDY@500ns")).splitlines()
    assert text[0] == "dsp.I2C-A.I2CSTR.RRDY at 0.000500 ms: 1 since 0.000333 ms, 166.667 ns (25 cycles) before"
    assert text[text.index("forward:") + 1 :][:5] == [
        "  read     200 ns (30 cycles) after      dsp: I2C-A.I2CSTR read, 0x0008 at",
        "                                           look:9",
        "  changed  346.667 ns (52 cycles) after  dsp.I2C-A.I2CSTR.RRDY cleared",
        "                                           [SPRUG03B table 10]",
        "  2 recorded reads that looked at it before that change",
    ]
    once = show_why.text(why(by_hand(*ROWS[:2], *ROWS[3:4]), "I2CSTR.RRDY@500ns"))
    assert "  1 recorded read that looked at it before the end of the run\n  it did not change again\n" in once


def test_why_as_json_has_the_distance_of_each_step():
    found = show_why.as_json(why(by_hand(*ROWS), "I2CSTR.RRDY@50us"))
    back = [(step["record"], step["cycles_from_value"], step["cause_of"], step["aside"]) for step in found["back"]]
    first, cause, *_ = found["back"]
    assert (first["known"], first["because"]) == (None, None)
    assert (cause["known"], cause["because"]) == ("recorded", "in the same cycle")
    assert back == [
        (6, 0, None, False),
        (5, 0, 6, False),
        (3, -2, 5, True),  # the read of the read-modify-write, and the change of RRDY that it saw
        (1, -52, 3, True),
        (2, -22, 5, False),
        (1, -52, 2, False),
    ]
    assert (found["value"], found["tick"], found["since_s"]) == (0, 150_000, pytest.approx(102 / 150e6))
    assert (found["reads_before_change"], found["next_change"]) == (2, None)
    assert (found["next_read"]["record"], found["next_read"]["cycles_from_value"]) == (7, 1398)
    assert (found["cycle_ticks"], found["ticks_per_second"]) == (20.0, "3000000000")


# Lints ----------------------------------------------------------------------------------------------------------


def test_findings_as_text_and_as_json():
    run = by_hand(*ROWS)
    once = Finding("read-only", "dsp", "f:1", 1, 2040, "writes BB", "table 10")
    twice = Finding("xrdy-alone", "dsp", "g:2", 2, 30_000, "loads it", "table 8")
    count = len(all_lints())
    assert show_lint.text(run, [once, twice]).splitlines() == [
        "dsp f:1: writes BB [table 10]",
        "  read-only, once at 0.000680 ms",
        "dsp g:2: loads it [table 8]",
        "  xrdy-alone, 2 times, first at 0.010000 ms",
        f"the run: 2 findings by {count} lints",
    ]
    assert show_lint.text(run, [once]).endswith(f"\nthe run: 1 finding by {count} lints")
    assert show_lint.text(run, []) == f"the run: nothing found by {count} lints"
    found = show_lint.as_json(run, [twice])
    assert found["findings"] == [
        {
            "lint": "xrdy-alone",
            "unit": "dsp",
            "place": "g:2",
            "count": 2,
            "first_s": 1e-5,
            "text": "loads it",
            "source": "table 8",
        }
    ]
    assert found["run"] == "the run" and found["lints"] == {name: one.says for name, one in all_lints().items()}
