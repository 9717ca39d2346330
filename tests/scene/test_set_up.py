"""What scenes of one case share: a second one reads, parses and compiles nothing anew, and a changed file is seen."""

from __future__ import annotations

import os
import weakref
from dataclasses import dataclass
from pathlib import Path

import pytest

from periph_sim import Scene, load
from periph_sim.core.convert import keys_of
from periph_sim.f28335.gpio.settings import pin_settings_of
from periph_sim.imu import model_codes, near_gaussian
from periph_sim.imu.models import counts
from periph_sim.scene import firmware_loader
from periph_sim.scene.case import toml_file
from periph_sim.scene.firmware_loader import KEPT, shared
from periph_sim.timing.language.language import measure_of

SHARED = {
    "TOML": toml_file._tables,
    "settings": keys_of,
    "measures": measure_of,
    "routes": pin_settings_of,
    "noise": near_gaussian.first_of,
    "models": model_codes.model_codes,
    "operations": counts._counted,
}
CASE = """
name = "one"
duration = "1 ms"
[unit.dsp]
firmware = "mine.py"
modules = ["SCI-A"]
"""
FIRMWARE = "def main(dsp, settings):\n    dsp.compute({cycles})\n"


def misses() -> dict[str, int]:
    return {name: cached.cache_info().misses for name, cached in SHARED.items()}


@pytest.mark.parametrize("case", ["imu_hil", "responder", "two_dsps"])
def test_a_second_scene_makes_nothing_anew(case: str) -> None:
    def scene() -> None:
        one = load(f"timing/{case}.toml")
        Scene(one).run(one.duration / 1000)

    scene()
    before = misses()
    scene()
    assert misses() == before


def test_two_cases_of_one_file_share_no_table(tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    file.write_text(CASE, encoding="utf-8")
    changed = load(file, ["unit.dsp.ppm=30", "unit.dsp.modules.0=TIMER0"])
    plain = load(file)
    assert (changed.unit["dsp"].ppm, changed.unit["dsp"].modules) == (30, ("TIMER0",))
    assert (plain.unit["dsp"].ppm, plain.unit["dsp"].modules) == (0, ("SCI-A",))


def test_a_changed_case_is_seen_though_size_and_time_are_the_same(tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    for name in ("one", "two"):
        file.write_text(CASE.replace("one", name), encoding="utf-8")
        os.utime(file, ns=(1, 1))
        assert load(file).name == name


def test_changed_firmware_is_seen_and_unchanged_firmware_is_compiled_once(tmp_path: Path) -> None:
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


def test_module_variables_of_a_firmware_file_begin_anew_in_each_scene(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    counting = "seen = []\n\n\ndef main(dsp, settings):\n    seen.append(1)\n    dsp.compute(1000 * len(seen))\n"
    (tmp_path / "mine.py").write_text(counting, encoding="utf-8")
    scenes = [Scene(load(tmp_path / "case.toml")) for _ in range(2)]
    for scene in scenes:
        scene.run()
    assert scenes[0].units["dsp"].program.returned_at == scenes[1].units["dsp"].program.returned_at


@dataclass(frozen=True)
class Settings:
    value: int


def test_settings_are_made_once_for_scenes_that_say_the_same_and_kept_for_so_many_only() -> None:
    made = shared(Settings, {"value": 0}, "it")
    assert shared(Settings, {"value": 0}, "it") is made
    kept = weakref.ref(made)
    del made
    for value in range(1, KEPT + 1):
        shared(Settings, {"value": value}, "it")
    assert kept() is None


@dataclass
class Changeable:
    value: int


def test_settings_that_firmware_may_change_are_made_for_each_scene() -> None:
    one, other = (shared(Changeable, {"value": 0}, "it") for _ in range(2))
    assert one == other and one is not other
