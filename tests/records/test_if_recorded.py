"""A run that is not recorded has the two functions of a recording, and they do nothing."""

from __future__ import annotations

from periph_sim.core.records import Kind, Recorder
from periph_sim.core.time import Timebase
from periph_sim.records.if_recorded import if_recorded


def test_without_a_path_nothing_is_recorded():
    recorder = Recorder()
    with if_recorded(None, {}) as (subscribe, ended_at):
        subscribe(recorder, Timebase())
        ended_at(1000)
    assert not any(recorder.wants(kind) for kind in Kind)
