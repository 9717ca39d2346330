"""The activity of a CPU over time, from episodes given as text."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.records import TIMED_OUT, Kind, Record
from periph_sim.interfaces.reports.explain.chain import difference, parts_of
from periph_sim.interfaces.reports.explain.cpu_activity import all_episodes, episodes, phrase, timeline, units
from periph_sim.traces.capture.capture import Span
from tests.interfaces.reports.explain.made import drawn


def activity(window, begin=0, end=100):
    return " ".join(f"{one.begin}:{one.what or one.doing}" for one in timeline(window, "dsp", begin, end))


@pytest.mark.parametrize(
    ("episodes", "line"),
    [
        ([], "0:code"),
        (["span model 10 60"], "0:code 10:model 60:code"),
        (["span model 10 60", "irq SCI 20 30"], "0:code 10:model 20:SCI 30:model 60:code"),
        (["wait AAS 0 100", "irq SCI 20 50", "span frame 25 40"], "0:AAS 20:SCI 25:frame 40:SCI 50:AAS"),
        (["span model -40 40"], "0:model 40:code"),
        (["span model -90 40"], "0:model 40:code"),  # begun before the kept records
        (["wait AAS 80 -"], "0:code 80:AAS"),
        (["span model 10 20", "span model 30 40"], "0:code 10:model 20:code 30:model 40:code"),
    ],
)
def test_the_innermost_activity_is_reported(episodes, line):
    assert activity(drawn(*episodes)) == line


def test_activity_without_kept_records_is_unknown():
    window = drawn("span model 10 90", "irq SCI 70 80", kept=(Span(-50, 30), Span(60, 150)))
    assert activity(window) == "0:code 10:model 30:unknown 70:SCI 80:unknown 90:unknown"
    assert window.hole == Span(30, 60)
    again = drawn("wait AAS 10 90", "wait AAS 95 -", kept=(Span(-50, 30), Span(60, 150)))
    assert activity(again) == "0:code 10:AAS 30:unknown 90:unknown 95:AAS"


@pytest.mark.parametrize(
    ("kind", "counts"),
    [
        (Kind.ACCESS, True),
        (Kind.SPAN, True),
        (Kind.IRQ, True),
        (Kind.WAIT, True),
        (Kind.FLAG, False),
        (Kind.EDGE, False),
        (Kind.HOLD, False),
    ],
)
def test_units_are_those_with_records_of_their_firmware(kind: Kind, counts: bool):
    done = Record(9, 20, kind, "a unit", "what", 1, "f:1", 0)
    window = drawn("wait AAS 10 30")
    others = ["a unit"] if counts else []
    assert units(window) == ["dsp"]
    assert units(replace(window, records=(*window.records, done))) == [*others, "dsp"]
    assert units(replace(window, before=(done,))) == [*others, "dsp"]


def test_nested_episodes_at_a_tick_are_listed_from_the_outermost():
    window = drawn("wait AAS -90 100", "irq SCI 20 50", "span frame 25 40")
    assert [one.what for one in all_episodes(window, "dsp", 30, 31)] == ["AAS", "SCI", "frame"]
    assert [one.what for one in all_episodes(window, "dsp", 45, 46)] == ["AAS", "SCI"]
    assert all_episodes(window, "other", 45, 46) == []


def test_an_episode_has_the_episodes_that_it_preempts():
    window = drawn("wait AAS -90 100", "irq SCI 20 50", "span frame 25 -")
    found = {one.what: one for one in episodes(window, "dsp", 0, 60)}
    assert [r.what for r in found["SCI"].within] == ["AAS"]
    assert (found["SCI"].begin, found["SCI"].end, found["AAS"].begin) == (20, 50, -90)
    assert "AAS" not in {one.what for one in episodes(window, "dsp", 100, 120)}
    assert [one.what for one in episodes(window, "dsp", 0, 20)] == ["AAS"]  # SCI begins as they end


def test_a_wait_that_timed_out_is_marked_after_its_end():
    window = drawn("wait AAS 0 20", "wait AAS 30 50")
    ends = [r._replace(text=TIMED_OUT) if r.tick == 50 else r for r in window.records]
    window = replace(window, records=tuple(ends))
    gave_up = "wait for AAS gave up (timeout)"
    assert [str(one) for one in episodes(window, "dsp", 0, 60)] == ["wait for AAS", gave_up]
    assert [str(one) for one in episodes(window, "dsp", 0, 40)] == ["wait for AAS", "wait for AAS"]
    assert [str(one) for one in timeline(window, "dsp", 0, 60) if one.doing == "wait"] == ["wait for AAS", gave_up]
    assert [one.what for one in all_episodes(window, "dsp", 40, 41)] == ["AAS"]


TICKS = st.integers(-60, 140)


@given(
    st.lists(st.tuples(st.sampled_from(["span a", "irq b", "wait c"]), TICKS, st.integers(1, 60)), max_size=6), TICKS
)
def test_activities_leave_no_gap_and_parts_add_up(made, begin):
    """This holds for any records, even those that no CPU can produce."""
    window = drawn(*(f"{name} {first} {first + length}" for name, first, length in made))
    end = max(begin, 100)
    line = timeline(window, "dsp", begin, end)
    assert [one.begin for one in line] == [begin, *(one.end for one in line[:-1])] or begin == end
    assert sum(part.length for part in parts_of(line)) == end - begin
    assert all(one.length > 0 for one in line)


def test_differences_compare_parts_of_the_same_name():
    here, there = (
        parts_of(timeline(drawn(*made), "dsp", 0, 100))
        for made in (["span model 0 50", "irq SCI 10 30"], ["span model 0 50", "wait AAS 60 70"])
    )
    assert [(p.what or p.doing, p.length) for p in difference(here, there)] == [
        ("SCI", 20),
        ("code", 10),
        ("AAS", -10),
        ("model", -20),
    ]


NESTED = ("span _c_int00 -40 70", "span _main -30 60", "span _serve -20 30", "irq SCI 10 20", "span _model 40 50")


def names(found) -> list[tuple[str, int, int | None]]:
    return [(one.what, one.begin, one.end) for one in found]


def test_the_innermost_of_the_spans_open_at_the_begin_is_reported():
    assert names(episodes(drawn(*NESTED), "dsp", 0, 100)) == [("_serve", -20, 30), ("SCI", 10, 20), ("_model", 40, 50)]
    assert names(episodes(drawn(*NESTED), "dsp", -50, 100))[:2] == [("_c_int00", -40, 70), ("_main", -30, 60)]


@pytest.mark.parametrize(
    ("made", "line"),
    [
        (("irq SCI 10 20", "span _isr 10 19", "span _inner 12 15"), [("SCI", 10, 20), ("_inner", 12, 15)]),
        (("span _isr 10 20", "irq SCI 10 20"), [("SCI", 10, 20)]),  # as in an image, where both end in the same cycle
    ],
)
def test_the_span_of_a_service_routine_is_reported_as_the_routine(
    made: tuple[str, ...], line: list[tuple[str, int, int]]
):
    """All records of these windows have the same place, so the span that begins with the routine is its function."""
    assert names(episodes(drawn(*made), "dsp", 0, 100)) == line


@pytest.mark.parametrize(
    ("spans", "line"),
    [
        (("span a 10 20", "span b 30 -"), [("a", 10, 20), ("b", 30, 100)]),
        (("span a -40 -", "span b 10 40", "span c 20 30"),
         [("a", 0, 10), ("b", 10, 20), ("c", 20, 30), ("b", 30, 40), ("a", 40, 100)]),
        (("span a 10 50", "span b 10 49"), [("b", 10, 49), ("a", 49, 50)]),
        (("span a -40 -", "span b -20 120"), [("b", 0, 100)]),
    ],
)  # fmt: skip
def test_a_picture_shows_the_innermost_span(spans: tuple[str, ...], line: list[tuple[str, int, int]]):
    found = timeline(drawn(*spans, "irq SCI 5 95"), "dsp", 0, 100, (Kind.SPAN,))
    assert names(one for one in found if one.doing == "span") == line


@pytest.mark.parametrize(
    ("what", "message"), [("IDLE", "IDLE"), ("endless loop", "endless loop"), ("SDIR", "wait for SDIR")]
)
def test_a_wait_for_something_other_than_a_register_keeps_its_name(what: str, message: str):
    assert phrase("wait", what) == message
