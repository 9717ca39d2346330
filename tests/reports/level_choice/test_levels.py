"""The levels of fidelity that a case can run at."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

from periph_sim.reports.level_choice.levels import REFERENCE, Level, fidelities_of
from periph_sim.scene.case.fidelity import Level as Word
from periph_sim.scene.case.load import load

TIMING = Path(__file__).resolve().parents[3] / "timing"


def levels(case: str, *changes: str) -> list[Level]:
    return [*fidelities_of(load(TIMING / f"{case}.toml", list(changes)))]


def test_every_word_of_fidelity_is_a_level_and_edge_is_the_reference():
    names = [level.name for level in levels("responder")]
    assert names[0] == REFERENCE and set(names) == set(get_args(Word))


def test_a_table_of_levels_for_each_bus_is_a_level_of_its_own():
    own = levels("imu_hil", 'fidelity={I2C-A = "byte", SCI-A = "edge"}')[-1]
    assert own == Level("I2C-A=byte SCI-A=edge", ())
    assert own.name not in [level.name for level in levels("imu_hil")]


def test_levels_with_the_records_of_edge_are_known():
    found = levels("imu_hil", 'fidelity={I2C-A = "adaptive", SCI-A = "edge"}')
    assert [level.name for level in found if level.same_records] == ["edge", "adaptive", "I2C-A=adaptive SCI-A=edge"]
