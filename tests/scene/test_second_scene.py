"""Scenes of one case share all data that runs do not change, and nothing else; changes of files take effect."""

from __future__ import annotations

import os
import sys
import weakref
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from pathlib import Path
from typing import Any

from periph_sim import PreparedScene, Scene, load
from periph_sim.core.convert import keys_of
from periph_sim.core.options import _defaults
from periph_sim.core.records import Record
from periph_sim.f28335.gpio.settings import pin_settings_of
from periph_sim.imu import model_codes
from periph_sim.processor.python.waits import comparison_of
from periph_sim.scene import firmware_loader
from periph_sim.scene.case.load import _loaded
from periph_sim.scene.firmware_loader import KEPT, load_firmware, settings_for, shared
from periph_sim.timing.budget_plan import _nearest_tick
from periph_sim.timing.language.events import event_of
from periph_sim.timing.language.language import measure_of
from tests.scene.runs import TIMING, recorded

LENGTH = Fraction(1, 100)
SHARED = {
    "cases": _loaded,
    "settings": keys_of,
    "routes": pin_settings_of,
    "models": model_codes.model_codes,
    "options": _defaults,
    "waits": comparison_of,
}
CASE = """
name = "one"
duration = "1 ms"
[unit.dsp]
firmware = "mine.py"
modules = ["SCI-A"]
"""
FIRMWARE = "def main(dsp, settings):\n    dsp.compute({cycles})\n"
OF_TEXTS = {"measures": measure_of, "events": event_of, "limits": _nearest_tick}


def recorded_scene(changes: list[str]) -> tuple[Scene, list[Record]]:
    return recorded(load(TIMING / "imu_hil.toml", changes))


def check_reuse(make: Callable[[], object], shared: Mapping[str, Any]) -> None:
    """Check that a second call finds all of its shared data in the caches."""
    make()
    before = {name: one.cache_info() for name, one in shared.items()}
    make()
    for name, one in shared.items():
        after = one.cache_info()
        assert after.hits > before[name].hits, name
        assert after.misses == before[name].misses, name


def test_a_second_scene_reuses_all_shared_data():
    def scenes() -> None:
        for case in ("imu_hil", "responder", "two_dsps"):
            Scene(load(TIMING / f"{case}.toml")).run(LENGTH)

    traced = sys.gettrace() is not None  # waits are then evaluated and not analysed
    check_reuse(scenes, {name: one for name, one in SHARED.items() if name != "waits" or not traced})


def test_budgets_of_scenes_with_other_settings_share_their_plans_and_not_their_measures():
    prepared = PreparedScene(TIMING / "imu_hil.toml")
    first, second = prepared.scene(), prepared.scene(["seed=5"])  # another case with the same budgets
    for one, other in zip(first.limits, second.limits, strict=True):
        assert one.plan.limits is other.plan.limits
        assert one.measure is not other.measure


def test_a_case_with_other_budgets_reuses_parsed_texts():
    reasons = count()
    check_reuse(lambda: recorded_scene([f"budget.response.why=reason {next(reasons)}"]), OF_TEXTS)


def test_changes_of_a_loaded_case_do_not_affect_others():
    path = TIMING / "imu_hil.toml"
    one, other = load(path), load(path)
    assert one == other and one.budget is other.budget
    one.unit["dsp"].settings["arithmetic"] = "float64"
    one.unit["dsp"].pins.clear()
    one.host.motion["angles"].pop()
    one.unit.clear()
    assert other == load(path) != one


@dataclass(frozen=True)
class Settings:
    value: int


def test_equal_settings_are_created_once_and_a_limited_number_is_kept():
    made = shared(Settings, {"value": 0}, "it")
    assert shared(Settings, {"value": 0}, "it") is made is not shared(Settings, {"value": -1}, "it")
    kept = weakref.ref(made)
    del made
    for value in range(1, KEPT + 1):
        shared(Settings, {"value": value}, "it")
    assert kept() is None


def test_settings_that_firmware_may_change_are_created_for_each_scene():
    firmware = load_firmware("imu_hil")
    one, other = (settings_for(firmware, {}) for _ in range(2))
    assert one == other and one is not other


def test_scenes_one_after_the_other_and_side_by_side_give_the_same_records():
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


def test_scenes_that_run_alternately_give_the_records_of_each_alone():
    alone, records_alone = recorded_scene([])
    alone.run(LENGTH)
    both = [recorded_scene([]) for _ in range(2)]
    step = LENGTH * alone.timebase.per_second / 50  # it divides waits, computations and service routines
    for part in range(1, 51):
        for scene, _ in both:
            scene.advance(scene.start + int(step * part))
    assert [records for _, records in both] == [records_alone, records_alone] != [[], []]


def test_two_cases_of_one_file_share_no_table(tmp_path: Path):
    file = tmp_path / "case.toml"
    file.write_text(CASE, encoding="utf-8")
    changed = load(file, ["unit.dsp.ppm=30", "unit.dsp.modules.0=TIMER0"])
    plain = load(file)
    assert (changed.unit["dsp"].ppm, changed.unit["dsp"].modules) == (30, ("TIMER0",))
    assert (plain.unit["dsp"].ppm, plain.unit["dsp"].modules) == (0, ("SCI-A",))


def test_a_changed_case_is_read_again_although_size_and_time_are_equal(tmp_path: Path):
    file = tmp_path / "case.toml"
    for name in ("one", "two"):
        file.write_text(CASE.replace("one", name), encoding="utf-8")
        os.utime(file, ns=(1, 1))
        assert load(file).name == name


def test_changed_firmware_is_read_again_and_unchanged_firmware_is_compiled_once(tmp_path: Path):
    file = tmp_path / "case.toml"
    file.write_text(CASE, encoding="utf-8")
    program = tmp_path / "mine.py"
    ended, compiled = [], []
    for cycles in (1000, 1000, 3000):
        program.write_text(FIRMWARE.format(cycles=cycles), encoding="utf-8")
        before = firmware_loader._code_of.cache_info().misses
        scene = Scene(load(file))
        scene.run()
        ended.append(scene.units["dsp"].program.returned_at)
        compiled.append(firmware_loader._code_of.cache_info().misses - before)
    assert ended[0] == ended[1]
    assert ended[2] - ended[1] == 2000
    assert compiled == [1, 0, 1]
    assert set(tmp_path.iterdir()) == {file, program}


def test_module_variables_of_a_firmware_file_are_new_in_each_scene(tmp_path: Path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    counting = "seen = []\n\n\ndef main(dsp, settings):\n    seen.append(1)\n    dsp.compute(1000 * len(seen))\n"
    (tmp_path / "mine.py").write_text(counting, encoding="utf-8")
    scenes = [Scene(load(tmp_path / "case.toml")) for _ in range(2)]
    for scene in scenes:
        scene.run()
    assert scenes[0].units["dsp"].program.returned_at == scenes[1].units["dsp"].program.returned_at
