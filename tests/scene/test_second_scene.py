"""Scenes of one case share what is the same for all of them, and nothing that a run changes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import pytest

from periph_sim import PreparedScene, Scene, load
from periph_sim.core.convert import keys_of
from periph_sim.core.options import _defaults
from periph_sim.core.records import Record
from periph_sim.imu.host_frames import encoding_of
from periph_sim.imu.model_codes import model_codes
from periph_sim.processor.python.waits import comparison_of
from periph_sim.scene.case.load import _loaded
from periph_sim.scene.firmware_loader import BadSetting, load_firmware, settings_for
from periph_sim.timing.budget_plan import _nearest_tick
from periph_sim.timing.language.events import event_of
from periph_sim.timing.language.language import measure_of
from tests.scene.runs import TIMING, recorded

LENGTH = Fraction(1, 100)
SHARED = {"cases": _loaded, "settings": keys_of, "models": model_codes, "options": _defaults}
OF_TEXTS = {"measures": measure_of, "events": event_of, "limits": _nearest_tick}


def recorded_scene(changes: list[str]) -> tuple[Scene, list[Record]]:
    return recorded(load(TIMING / "imu_hil.toml", changes))


def works_nothing_out(make: Callable[[], object], shared: Mapping[str, Any]) -> None:
    """All of it was there before."""
    before = {name: one.cache_info() for name, one in shared.items()}
    make()
    for name, one in shared.items():
        after = one.cache_info()
        assert after.hits > before[name].hits, name
        assert after.misses == before[name].misses, name


def test_a_second_scene_parses_and_works_out_nothing_anew():
    recorded_scene([])
    works_nothing_out(lambda: recorded_scene([]), SHARED)
    prepared = PreparedScene(TIMING / "imu_hil.toml")
    first, second = prepared.scene(), prepared.scene(["seed=5"])  # another case with the same budgets
    for one, other in zip(first.limits, second.limits, strict=True):
        assert one.plan.limits is other.plan.limits
        assert one.measure is not other.measure


def test_a_case_with_other_budgets_shares_what_their_texts_say():
    recorded_scene([])
    works_nothing_out(lambda: recorded_scene(["budget.response.why=another reason"]), OF_TEXTS)


def test_a_second_run_takes_no_wait_of_the_firmware_apart():
    if sys.gettrace() is not None:
        pytest.skip("where lines are counted or a debugger runs, waits are evaluated and not taken apart")

    def run() -> None:
        Scene(load(TIMING / "imu_hil.toml")).run(LENGTH)

    run()
    works_nothing_out(run, {"waits": comparison_of})


def test_who_changes_a_case_changes_it_for_nobody_else():
    path = TIMING / "imu_hil.toml"
    one, other = load(path), load(path)
    assert one == other and one.budget is other.budget
    one.unit["dsp"].settings["arithmetic"] = "float64"
    one.unit["dsp"].pins.clear()
    one.host.motion["angles"].pop()
    one.unit.clear()
    assert other == load(path) != one


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


def test_scenes_that_run_alternately_make_the_records_of_each_alone():
    alone, records_alone = recorded_scene([])
    alone.run(LENGTH)
    both = [recorded_scene([]) for _ in range(2)]
    step = LENGTH * alone.timebase.per_second / 50  # waits, computations and service routines are cut by it
    for part in range(1, 51):
        for scene, _ in both:
            scene.advance(scene.start + int(step * part))
    assert [records for _, records in both] == [records_alone, records_alone] != [[], []]
