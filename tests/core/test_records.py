"""Who is told of what: kinds, and of edges, flags and accesses the subjects that are enough."""

from __future__ import annotations

from periph_sim.core.records import Keeper, Kind, Listener, Record, Recorder


def test_a_sink_is_told_of_its_kinds_only():
    recorder, told = Recorder(), list[Record]()
    recorder.subscribe([Kind.BUS], told.append)
    recorder.emit(5, Kind.BUS, "controller", "START")
    recorder.emit(6, Kind.NOTE, "dsp", "duty")
    assert [(r.tick, r.what) for r in told] == [(5, "START")]
    assert recorder.wants(Kind.BUS) and not recorder.wants(Kind.NOTE)


def test_what_is_wanted_of_some_subjects_is_not_wanted_of_others():
    recorder = Recorder()
    recorder.subscribe([Kind.EDGE, Kind.BUS], print, only={Kind.EDGE: {"SCL"}})
    recorder.subscribe([Kind.EDGE], print, only={Kind.EDGE: {"TX"}})
    assert [recorder.wants(Kind.EDGE, wire) for wire in ("SCL", "TX", "SDA")] == [True, True, False]
    assert recorder.wants(Kind.EDGE)
    assert recorder.wants(Kind.BUS, "whoever")
    assert recorder.subjects(Kind.EDGE) == {"SCL", "TX"} and recorder.subjects(Kind.BUS) is None


def test_one_who_wants_all_makes_all_wanted():
    recorder = Recorder()
    recorder.subscribe([Kind.FLAG], print, only={Kind.FLAG: {"dsp.I2C-A.I2CSTR"}})
    recorder.subscribe([Kind.FLAG], print)
    assert recorder.wants(Kind.FLAG, "dsp.SCI-A.SCIRXST") and recorder.subjects(Kind.FLAG) is None
    assert recorder.subjects(Kind.ACCESS) == set()


def test_only_who_is_told_of_records_may_keep_what_it_finds_meanwhile():
    recorder = Recorder()
    recorder.subscribe([Kind.ACCESS], Listener())
    recorder.subscribe([Kind.ACCESS], Keeper())
    recorder.subscribe([Kind.WAIT], print)
    assert [recorder.tells_records(kind) for kind in (Kind.ACCESS, Kind.WAIT, Kind.SPAN)] == [False, True, False]
