"""Measures of events: the records that they need, unfinished occurrences, and reasons why nothing was measured."""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain, cycle

import pytest

from periph_sim.core.records import Kind
from periph_sim.timing.language.events import matcher
from periph_sim.timing.measures.event import subjects_of
from periph_sim.timing.measures.factory import measure_named
from tests.timing.events_by_hand import ONE, feed, played, records, summary

RISES = "10 edge SCL level 1\n20 edge SCL level 0\n25 edge SCL level 1\n60 edge SCL level 1"


def test_a_period_has_the_time_of_its_begin_and_an_unfinished_one_counts():
    period = played("period of edge SCL rise", RISES)
    assert summary(period) == (35, 25, 15, 2)
    assert period.unfinished(70) == [(10, 60)] and period.close(70) == ""
    assert period.close(96) == "'edge SCL rise' did not come again before the run ended" and period.worst == 36
    assert measure_named("period of edge SCL rise", ONE).unfinished(70) == []


@pytest.mark.parametrize(
    ("text", "of", "missing"),
    [
        ("period of edge SCL rise", "", "no event matched 'edge SCL rise'"),
        (
            "period of edge SCL rise",
            "5 edge SCL level 1",
            "'edge SCL rise' was seen 1 time, which makes no measurement",
        ),
        ("from edge SCL rise to edge SCL fall", "5 edge SCL level 1", "no event matched 'edge SCL fall'"),
        ("from edge SCL rise to edge SCL fall", "5 edge SCL level 0", "no event matched 'edge SCL rise'"),
        ("from edge SCL rise to edge SCL fall", "", "no event matched 'edge SCL rise' and 'edge SCL fall'"),
        (
            "from edge SCL rise to edge SCL fall",
            "5 edge SCL level 0\n6 edge SCL level 1",
            "no 'edge SCL rise' was followed by 'edge SCL fall'",
        ),
        (
            "from edge SCL rise to edge SCL fall, same transfer",
            "1 bus c START 0\n5 edge SCL level 1\n6 bus c START 0\n7 edge SCL level 0",
            "no 'edge SCL rise' was followed by 'edge SCL fall' in the same transfer",
        ),
        ("period of span modle begin", "", "no event matched 'span modle begin'; the run had no span"),
        (
            "period of span modle begin",
            "1 span dsp model 1",
            "no event matched 'span modle begin'; did you mean model?",
        ),
        (
            "period of span x begin",
            "1 span dsp model 1\n2 span dsp filter 1",
            "no event matched 'span x begin'; the run had spans filter, model",
        ),
        ("level of SCI-A.SCIFFRX.RXFFST at edge SCL rise", "", "no event matched 'edge SCL rise'"),
        ("time in modle", "", "no event matched 'span modle begin'; the run had no span"),
        ("time in modle", "1 span dsp model 1", "no event matched 'span modle begin'; did you mean model?"),
        (
            "from span modle begin to span modle end",
            "1 span dsp model 1",
            "no event matched 'span modle begin' and 'span modle end'; did you mean model?",
        ),
        ("count of span modle end", "1 span dsp model 1", "no event matched 'span modle end'; did you mean model?"),
        ("level of SCI-A.SCIFFRX.RXFFST", "", "no event matched 'flag SCI-A.SCIFFRX.RXFFST change'"),
        (
            "interrupt latency SCIRXINTA",
            "",
            "no event matched 'flag PIE.PIEIFR9.INTx1 rise' and 'interrupt SCIRXINTA enter'",
        ),
        ("slack", "", "no round was completed"),
        ("each time in wire SCL low", "", "'wire SCL low' was never entered and left"),
    ],
)
def test_the_reason_why_nothing_was_measured(text: str, of: str, missing: str):
    assert played(text, of, 99, level=0).missing() == missing


def test_a_jitter_needs_two_values():
    jitter = measure_named("jitter of edge SCL rise", ONE)
    assert jitter.missing() == "no event matched 'edge SCL rise'"
    feed(jitter, records("5 edge SCL level 1\n6 edge SCL level 1"))
    assert jitter.silent and jitter.missing() == "there was only one value, and a jitter needs two"
    feed(jitter, records("9 edge SCL level 1\n10 edge SCL level 1"))
    assert summary(jitter) == (2, 6, 2, 2)  # periods of 1, 3 and 1


# Records that must be made --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("events", "needed"),
    [
        (["edge SCL rise"], {Kind.EDGE: {"SCL"}}),
        (["edge SCL rise", "edge SDA fall"], {Kind.EDGE: {"SCL", "SDA"}}),
        (["edge SCL rise or edge SDA fall"], {Kind.EDGE: {"SCL", "SDA"}}),
        (["flag I2C-A.I2CSTR.XRDY rise"], {Kind.FLAG: {"dsp.I2C-A.I2CSTR"}}),
        (["access W I2C-A.I2CDXR"], {Kind.ACCESS: {"dsp.I2C-A.I2CDXR"}}),
        (["frame TX"], {Kind.FRAME: {"TX"}}),
        (["bus START"], {}),
        (["interrupt SCIRXINTA enter", "edge SCL rise"], {Kind.EDGE: {"SCL"}}),
        (["span model begin"], {}),
        (["note lost"], {}),
        ([], {}),
    ],
)
def test_the_records_that_events_need(events: list[str], needed: dict[Kind, set[str]]):
    assert subjects_of([matcher(event, ONE) for event in events]) == needed


def test_an_event_of_a_group_also_needs_the_begin_and_end_of_the_group():
    burst = measure_named("period of last frame TX error of burst", ONE)
    assert (burst.kinds, burst.subjects) == ({Kind.FRAME}, {Kind.FRAME: {"TX"}})
    transfer = measure_named("period of first edge SCL rise of transfer", ONE)
    assert (transfer.kinds, transfer.subjects) == ({Kind.EDGE, Kind.BUS}, {Kind.EDGE: {"SCL"}})


# Groups ---------------------------------------------------------------------------------------------------------------


STARTS = "\n".join(
    f"{at} bus c START 0\n{at + 1} edge SCL level 1\n{at + 2} edge SCL level 1" for at in range(0, 80, 10)
)


@pytest.mark.parametrize(
    ("event", "at"),
    [
        ("first edge SCL rise of round", [31, 51, 71]),
        ("2nd edge SCL rise of round", [32, 52, 72]),
        ("3rd edge SCL rise of round", [41, 61]),
        ("last edge SCL rise of round", [42, 62, 72]),
        ("5th edge SCL rise of round", []),
        ("first edge SCL rise of transfer", [at + 1 for at in range(0, 80, 10)]),
        ("last bus START of round", [40, 60, 70]),
        ("first bus START of round", [30, 50, 70]),
    ],
)
def test_rounds_begin_after_the_transfers_of_the_start_up(event: str, at: list[int]):
    def rounds_of_two_after_three_transfers() -> Callable[[], bool]:
        return chain([False] * 3, cycle([True, False])).__next__

    period = played(f"period of {event}", STARTS, 99, keep=True, rounds_at_start=rounds_of_two_after_three_transfers)
    assert period.all_kept()[1].tolist() == at[:-1]
    assert period.first_seen == len(at) and period.seen(0) == period.seen(1) == bool(at)


def test_the_latency_to_the_first_access_ignores_accesses_of_other_units():
    of = """
        10 flag   dsp.PIE PIEIFR9.INTx1 1
        20 irq    dsp     SCIRXINTA     1
        25 access imu     R_SCI-A.SCIRXBUF 1
        31 access dsp     R_SCI-A.SCIRXBUF 1
        40 irq    dsp     SCIRXINTA     1
        44 access dsp     R_SCI-A.SCIRXBUF 1
    """
    measure = played("interrupt latency SCIRXINTA to first access", of)
    assert summary(measure) == (21, 10, 21, 1) and measure.unfinished(99) == []  # the second entry had no request


def test_an_access_before_the_entry_of_the_routine_is_not_its_first():
    of = "10 flag dsp.PIE PIEIFR9.INTx1 1\n20 irq dsp SCIRXINTA 1\n31 access dsp R_SCI-A.SCIRXBUF 1\n"
    of += "70 flag dsp.PIE PIEIFR9.INTx1 1\n72 access dsp W_I2C-A.I2CDXR 1\n75 irq dsp SCIRXINTA 1\n"
    measure = played("interrupt latency SCIRXINTA to first access", f"{of}80 access dsp R_SCI-A.SCIRXBUF 1")
    assert summary(measure) == (21, 10, 10, 2)
