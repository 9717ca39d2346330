"""Scenes of one case share what is the same for all of them, and nothing that a run changes."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.core.convert import keys_of
from periph_sim.core.options import _defaults
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.scene.case.load import load
from periph_sim.scene.context import _exact_ticks
from periph_sim.scene.firmware_loader import BadSetting, load_firmware, settings_for
from periph_sim.scene.host_motion import encoding_of
from periph_sim.scene.scene import Scene
from periph_sim.sensors.shared_models import model_of
from periph_sim.timing.budgets import _nearest_tick
from periph_sim.timing.language.events import event_of
from periph_sim.timing.language.language import measure_of

TIMING = Path(__file__).parents[2] / "timing"
LENGTH = Fraction(1, 100)
SHARED = {
    "measures": measure_of,
    "events": event_of,
    "settings": keys_of,
    "lengths": _exact_ticks,
    "limits": _nearest_tick,
    "models": model_of,
    "options": _defaults,
}


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


def test_settings_of_a_host_are_read_once_for_all_scenes_that_say_the_same():
    encoding = encoding_of({"phi": "0.2 mrad"})
    assert encoding is encoding_of({"phi": "0.2 mrad"}) and encoding is not encoding_of({"phi": "0.3 mrad"})
    with pytest.raises(BadSetting):
        encoding_of({"phi": True})


def test_what_firmware_may_change_is_made_anew():
    firmware = load_firmware("imu_hil")
    one, other = (settings_for(firmware, {}) for _ in range(2))
    assert one == other and one is not other


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
