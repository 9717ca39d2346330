"""Scenes of one case share what is the same for all of them, and nothing that a run changes."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.scene.case.load import load
from periph_sim.scene.firmware_loader import _settings_of
from periph_sim.scene.scene import Scene
from periph_sim.sensors.numeric.q import constant_in
from periph_sim.timing.language.events import event_of
from periph_sim.timing.language.language import measure_of

TIMING = Path(__file__).parents[2] / "timing"
LENGTH = Fraction(1, 100)
SHARED = {"measures": measure_of, "events": event_of, "constants": constant_in, "settings": _settings_of}


def recorded_scene(changes: list[str]) -> tuple[Scene, list[Record]]:
    records: list[Record] = []

    def subscribe(recorder: Recorder, _: Timebase) -> None:
        recorder.subscribe(tuple(Kind), records.append)

    return Scene(load(TIMING / "imu_hil.toml", changes), subscribe), records


def test_a_second_scene_parses_and_works_out_nothing_anew():
    for _ in range(2):  # the first one may be the first of all
        before = {name: shared.cache_info() for name, shared in SHARED.items()}
        recorded_scene([])
        after = {name: shared.cache_info() for name, shared in SHARED.items()}
    for name in SHARED:
        assert after[name].hits > before[name].hits, name
        assert after[name].misses == before[name].misses, name


def test_scenes_one_after_the_other_and_side_by_side_make_the_same_records():
    changes: tuple[list[str], list[str]] = [], ["seed=7", "unit.dsp.settings.noise_seed=5"]
    alone = []
    for change in changes:
        scene, records = recorded_scene(change)
        scene.run(LENGTH)
        alone.append(records)
    assert alone[0] != alone[1]

    one, records_of_one = recorded_scene(changes[0])
    other, records_of_other = recorded_scene(changes[1])  # built before the first one runs
    other.run(LENGTH)
    one.run(LENGTH)
    assert [records_of_one, records_of_other] == alone
