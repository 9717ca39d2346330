"""Subscriptions to records: by kind, and for edges, flags and accesses also by subject."""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind, Listener, Record, Recorder, RecordSink


def test_a_sink_receives_records_of_its_kinds_only():
    recorder, received = Recorder(), list[Record]()
    recorder.subscribe([Kind.BUS], received.append)
    recorder.emit(5, Kind.BUS, "controller", "START")
    recorder.emit(6, Kind.NOTE, "dsp", "duty")
    assert [(r.tick, r.what) for r in received] == [(5, "START")]
    assert recorder.wants(Kind.BUS) and not recorder.wants(Kind.NOTE)


def test_a_subscription_to_some_subjects_excludes_the_others():
    recorder = Recorder()
    recorder.subscribe([Kind.EDGE, Kind.BUS], print, only={Kind.EDGE: {"SCL"}})
    recorder.subscribe([Kind.EDGE], print, only={Kind.EDGE: {"TX"}})
    assert [recorder.wants(Kind.EDGE, wire) for wire in ("SCL", "TX", "SDA")] == [True, True, False]
    assert recorder.wants(Kind.EDGE)
    assert recorder.wants(Kind.BUS, "controller")
    assert recorder.subjects(Kind.EDGE) == {"SCL", "TX"} and recorder.subjects(Kind.BUS) is None


def test_a_subscription_without_subjects_includes_all_of_them():
    recorder = Recorder()
    recorder.subscribe([Kind.FLAG], print, only={Kind.FLAG: {"dsp.I2C-A.I2CSTR"}})
    recorder.subscribe([Kind.FLAG], print)
    assert recorder.wants(Kind.FLAG, "dsp.SCI-A.SCIRXST") and recorder.subjects(Kind.FLAG) is None
    assert recorder.subjects(Kind.ACCESS) == set()


def test_records_are_made_as_objects_for_callbacks_only():
    recorder = Recorder()
    recorder.subscribe([Kind.ACCESS], Listener())
    recorder.subscribe([Kind.ACCESS], RecordSink())
    recorder.subscribe([Kind.WAIT], print)
    assert [recorder.makes_records(kind) for kind in (Kind.ACCESS, Kind.WAIT, Kind.SPAN)] == [False, True, False]


class TagListener(Listener):
    """Listener that stores the topics for which a tag is requested, and the times of its records."""

    def __init__(self) -> None:
        self.topics: list[tuple[Kind, str, str]] = []
        self.times: list[int] = []

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        self.topics.append((kind, where, what))
        return 1

    def on_record(self, tag: int, tick: int, value: int) -> None:
        self.times.append(tick)


@pytest.mark.parametrize("topics_first", [True, False])
def test_a_listener_that_names_its_topics_is_asked_for_no_other_tags(topics_first: bool):
    recorder, one = Recorder(), TagListener()

    def topics() -> None:
        for kind, where, what in ((Kind.FLAG, "dsp.I2C-A", "I2CSTR.XRDY"), (Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB")):
            recorder.topic(kind, where, what)
        recorder.topic(Kind.BUS, "controller", "I2CSTR.XRDY")

    if topics_first:
        topics()
    recorder.subscribe([Kind.FLAG, Kind.BUS], one, things={(Kind.FLAG, "I2CSTR.XRDY"), (Kind.BUS, "STOP")})
    topics()
    recorder.emit(1, Kind.FLAG, "dsp.I2C-A", "I2CSTR.XRDY", 1)
    recorder.emit(2, Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB", 1)
    recorder.emit(3, Kind.BUS, "controller", "STOP")
    assert one.topics == [(Kind.FLAG, "dsp.I2C-A", "I2CSTR.XRDY"), (Kind.BUS, "controller", "STOP")]
    assert one.times == [1, 3]
