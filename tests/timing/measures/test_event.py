"""Measures of named events on hand-made records, and the same functions applied to a whole table."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim import timing
from periph_sim.core.records import Kind, Record
from periph_sim.core.time import NO_TIME
from periph_sim.timing.language.language import FORMS
from periph_sim.timing.language.scope import BadEvent, Scope
from periph_sim.timing.measures.factory import measure_named
from tests.scene.small import sentence_of
from tests.timing.events_by_hand import BARE, NO_BUS, ONE, TWO, pairs, played, records, summary, table

WRITES = "from flag I2C-A.I2CSTR.XRDY rise to access W I2C-A.I2CDXR"

BUS = """
     5 flag   dsp.I2C-A  I2CSTR.XRDY     1
    10 bus    controller START           0
    20 flag   dsp.I2C-A  I2CSTR.XRDY     1
    50 access dsp        W_I2C-A.I2CDXR  1
    60 flag   dsp.I2C-A  I2CSTR.XRDY     1
    70 flag   dsp.I2C-A  I2CSTR.XRDY     0
    80 bus    controller STOP            0
   100 bus    controller START           0
   110 access dsp        W_I2C-A.I2CDXR  1
   120 flag   dsp.I2C-A  I2CSTR.XRDY     1
   130 bus    controller repeated_START  0
   140 access dsp        W_I2C-A.I2CDXR  1
   200 bus    controller START           0
   210 access dsp        W_I2C-A.I2CDXR  1
"""


@pytest.mark.parametrize(
    ("rule", "durations"),
    [
        ("next", [(45, 5), (30, 20), (50, 60), (20, 120)]),
        ("last", [(30, 20), (50, 60), (20, 120)]),
        ("in order", [(45, 5), (90, 20), (80, 60), (90, 120)]),
        ("same transfer", [(30, 20), (20, 120)]),
        ("same round", [(30, 20), (50, 60), (20, 120)]),
        ("in order, same round", [(30, 20), (50, 60), (20, 120)]),
    ],
)
def test_durations_under_each_pairing_rule(rule: str, durations: list[tuple[int, int]]):
    of = records(BUS)
    measure = played(f"{WRITES}, {rule}", of, keep=True, transfers=2)
    worst = max(durations, key=lambda pair: pair[0])
    assert summary(measure) == (worst[0], worst[1], min(durations)[0], len(durations)) and pairs(measure) == durations
    found = timing.between(
        table(of), "flag I2C-A.I2CSTR.XRDY rise", "access W I2C-A.I2CDXR", rule=rule, transfers_in_round=2
    )
    assert list(zip(found.duration.tolist(), found.start.tolist(), strict=True)) == durations


ALPHABET = [
    (Kind.EDGE, "SCL", "level", 1),
    (Kind.EDGE, "SCL", "level", 0),
    (Kind.ACCESS, "dsp", "W I2C-A.I2CDXR", 7),
    (Kind.BUS, "controller", "START", 0),
    (Kind.BUS, "controller", "repeated START", 0),
    (Kind.BUS, "controller", "STOP", 0),
]
EVENTS = st.sampled_from(
    ["edge SCL rise", "edge SCL change", "access W I2C-A.I2CDXR", "bus START", "bus STOP", "bus address 0x68 read"]
)


@given(
    st.lists(st.tuples(st.integers(0, 3), st.sampled_from(ALPHABET)), max_size=40),
    EVENTS,
    EVENTS,
    st.sampled_from(["", "next", "last", "in order"]),
    st.sampled_from(["", "same transfer", "same round"]),
    st.integers(1, 3),
)
def test_measures_during_a_run_agree_with_functions_on_its_table(
    drawn, begin: str, end: str, pairing: str, same: str, transfers: int
):
    tick, of = 0, [Record(1, 0, Kind.BUS, "controller", "byte", 0, "", 0)]  # shows that there is a controller
    for step, (kind, where, what, value) in drawn:
        tick += step
        of.append(Record(len(of) + 1, tick, kind, where, what, value, "", 0))
    rules = ", ".join(filter(None, (pairing, same)))
    measure = played(f"from {begin} to {end}, {rules}".removesuffix(", "), of, keep=True, transfers=transfers)
    if measure.missing().endswith("in order, next or last"):
        with pytest.raises(BadEvent, match="it is not known which belong together"):
            timing.between(table(of), begin, end, rule=rules, transfers_in_round=transfers)
    else:
        found = timing.between(table(of), begin, end, rule=rules, transfers_in_round=transfers)
        assert pairs(measure) == list(zip(found.duration.tolist(), found.start.tolist(), strict=True))
    period = played(f"period of {begin}", of, keep=True)
    assert [c.tolist() for c in period.all_kept()] == [c.tolist() for c in timing.periods(table(of), begin)]


def test_functions_on_a_table_reject_unknown_rules_and_rounds_of_unknown_size():
    of = table(records(BUS))
    with pytest.raises(BadEvent, match="'rond' where transfer, round or unit is expected; did you mean round"):
        timing.between(of, "bus START", "bus STOP", rule="same rond")
    with pytest.raises(BadEvent, match="same round needs transfers_in_round, 1 or more"):
        timing.between(of, "bus START", "bus STOP", rule="same round")
    with pytest.raises(BadEvent, match="there is no wire 'SLC'; did you mean SCL"):
        timing.periods(of, "edge SLC rise")


def test_an_event_at_the_same_tick_counts_if_it_was_recorded_later():
    of = "10 edge SCL level 1\n10 edge SCL level 0\n20 edge SCL level 0\n20 edge SCL level 1\n25 edge SCL level 0"
    assert summary(played("from edge SCL rise to edge SCL fall", of)) == (5, 20, 0, 2)


EDGES = "100 edge SCL level 1\n200 edge SCL level 1\n330 edge SCL level 1\n400 edge SCL level 1"


def test_period_and_jitter():
    assert summary(played("period of edge SCL rise", EDGES)) == (130, 200, 70, 3)
    assert summary(played("jitter of edge SCL rise", EDGES)) == (60, 330, 30, 2)


def test_counts():
    assert summary(played("count of edge SCL rise", EDGES)) == (4, 100, 4, 4)
    none = played("count of edge SCL fall", EDGES)
    assert (summary(none), none.silent) == ((0, NO_TIME, 0, 0), False)
    assert played("count of span modle begin").silent


NACKED = """
    10 bus controller START 0
    20 bus controller NACK  0
    30 bus controller STOP  0
    40 bus controller START 0
    50 bus controller NACK  0
    60 bus controller STOP  0
"""


@pytest.mark.parametrize(
    ("clauses", "missing", "not_judged"),
    [
        ("given bus NACK", "", ""),
        ("given bus NACK byte", "no event matched 'bus NACK byte'", ""),
        ("given bus stuck, given bus byte", "no event matched 'bus stuck' and 'bus byte'", ""),
        ("given span modle end", "no event matched 'span modle end'; the run had no span", ""),
        ("unless bus stuck", "", ""),
        ("unless bus NACK", "", "2 events matched 'bus NACK', which 'unless' excludes"),
        ("unless 2nd bus START of round", "", "1 event matched '2nd bus START of round', which 'unless' excludes"),
    ],
)
@pytest.mark.parametrize("form", ["from bus START to bus STOP", "count of bus START"])
def test_a_clause_that_prevents_a_judgement_is_given_as_the_reason(
    form: str, clauses: str, missing: str, not_judged: str
):
    of = played(f"{form}, {clauses}", NACKED, 100, transfers=2)
    assert (of.silent, of.missing() if of.silent else "", of.not_judged) == (missing != "", missing, not_judged)


def test_levels():
    of = "10 flag dsp.SCI-A SCIFFRX.RXFFST 3\n20 flag dsp.SCI-A SCIFFRX.RXFFST 9\n30 flag dsp.SCI-A SCIFFRX.RXFFIL 20"
    assert summary(played("level of SCI-A.SCIFFRX.RXFFST", of)) == (9, 20, 3, 2)


def test_interrupt_latency_is_from_the_pie_flag_to_the_service_routine():
    of = """
        10 flag dsp.PIE PIEIFR9.INTx1 1
        20 flag dsp.PIE PIEIFR9.INTx1 0
        26 irq  dsp     SCIRXINTA     1
        30 flag dsp.PIE PIEIFR9.INTx2 1
        50 irq  dsp     SCIRXINTA     0
        60 flag dsp.PIE PIEIFR9.INTx1 1
        70 irq  dsp     SCIRXINTA     1
    """
    assert summary(played("interrupt latency SCIRXINTA", of)) == (16, 10, 10, 2)


@pytest.mark.parametrize(
    ("text", "scope", "sentence"),
    [
        ("from edge SCL rise to edge SCL fall, same round", BARE, "'same round' needs [controller] or [rounds] in the"),
        ("from edge RX rise to edge RX fall, same transfer", NO_BUS, "'same transfer' needs SCL and SDA in the scene"),
        (
            "interrupt latency INT13",
            TWO,
            "nothing in the scene asks for the interrupt 'INT13'; did you mean I2CINT1A or TINT0?",
        ),
        (
            "interrupt latency INT13",
            Scope({"dsp": ("XINT",)}),
            "INT13 does not come through the PIE, so nothing records when it was asked for",
        ),
        ("stack high-water", ONE, "no unit runs an image, which this measure needs; give a unit image in place of"),
        ("stack high-water of dsp", ONE, "dsp runs Python firmware; this measure needs a unit that runs an image"),
        ("cpu load", Scope(), "the scene has no unit"),
        ("cpu load of imy", TWO, "there is no unit 'imy'; did you mean imu?"),
        ("cpu load", TWO, "head and imu have it; say whose is meant"),
        (
            "value of bus byte, unless bus NACK",
            ONE,
            "'value of bus byte, unless bus NACK': value of takes a record event, not 'bus byte'; write count of the",
        ),
        ("sum of record data sample or frame", ONE, "'sum of record data sample or frame': sum of takes a record e"),
    ],
)
def test_measures_that_need_missing_parts_of_the_scene_are_rejected(text: str, scope, sentence: str):
    assert sentence_of(BadEvent, lambda: measure_named(text, scope)).startswith(sentence)


IMAGE = replace(ONE, images={"dsp": None})
EXAMPLES = ["from frame to frame", "period of frame", "jitter of frame", "count of frame"]
EXAMPLES += [
    "sum of record receiver received",
    "level of I2C-A.I2CSTR.XRDY",
    "calls of _isr",
    "stack high-water",
    "interrupt latency SCIRXINTA",
    "reaction",
    "busy time of 0x50",
    "gap between rounds",
]
EXAMPLES += ["margin of I2CDXR", "SCL held per transfer", "time in model"]
EXAMPLES += ["each time in wire SCL low", "share of any 2 ms in cpu idle", "cpu load", "bus load", "slack"]
EXAMPLES += ["race I2C-A.I2CSTR.XRDY", "lost flags", "cleared along I2C-A.I2CSTR.SDIR", "age of gyroscope"]
EXAMPLES += ["model age of magnetometer", "value error of gyroscope"]


@pytest.mark.parametrize(("form", "text"), list(zip(FORMS, EXAMPLES, strict=True)))
def test_every_form_makes_a_documented_measure_that_begins_empty(form: str, text: str):
    made = measure_named(text, IMAGE)
    assert (made.__doc__ or "").strip()
    assert summary(made) == (0, NO_TIME, 0, 0)
    assert made.unit in ("time", "count", "value", "%", "cycles", "flags", "LSB")
