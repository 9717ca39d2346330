"""Random small scenes: every observable of the level is what an edge run of the same scene measures."""

from __future__ import annotations

import numpy as np
import pytest

from periph_sim.levels.schedule import schedule
from periph_sim.scene.case.load import load
from tests.levels.schedule.scenes import compare, scene
from tests.profiles import explores
from tests.scene.runs import TIMING

SEEDS = range(1000) if explores() else range(12)


@pytest.mark.long
@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_scene_comes_to_what_edges_come_to(seed: int):
    case, changes, rounds = scene(seed)
    found = compare(case, rounds, changes)
    assert not found.differ, (changes, rounds)


# NACK and hang windows, stretches and missed rounds: each by what makes it.
WINDOWS = {
    "models outlast the slack": (["unit.dsp.settings.model_cost=17100 us to 17500 us", "seed=7"], "nacked"),
    "I2CSTR is written behind SDIR": (["unit.dsp.settings.frame_cost=300 us", "host.period=3 ms", "seed=4"], "hung"),
    "a service routine holds SCL": (["unit.dsp.settings.frame_cost=60 us", "host.period=3 ms"], "stretched"),
}


@pytest.mark.parametrize("name", WINDOWS)
def test_windows_are_met_where_edges_meet_them(name: str):
    changes, what = WINDOWS[name]
    found = compare(load(TIMING / "imu_hil_published.toml", changes), 6, changes)
    assert not found.refused and not found.differ
    assert getattr(found, what)


def test_the_shipped_case_is_equal_with_its_clocks_jitter_and_drawn_costs():
    case = load(TIMING / "imu_hil.toml")
    found = compare(case, 4, [])
    assert not found.refused and not found.differ


def test_every_scenario_of_a_call_is_that_scenario_alone():
    case = load(TIMING / "imu_hil_published.toml", ["host.jitter=1 ms", "host.paced_by=pause"])
    changes = {
        "seed": np.arange(40) % 7,
        "host.first": np.arange(40) * 523_111,
        "host.ppm": np.arange(40) % 3 * 50.5,
        "unit.dsp.ppm": np.arange(40) % 4 * -20,
        "host.period": 9_000_000 + np.arange(40) * 71_000,
        "unit.dsp.settings.model_cost": 250_000 + np.arange(40) * 430_000,
    }
    together = schedule(case, changes, rounds=8)
    assert together["nacked"].worst.any() and not together["nacked"].worst.all()
    for one in range(40):
        alone = schedule(case, {name: values[one] for name, values in changes.items()}, rounds=8)
        for name, values in together.items():
            mine = alone[name]
            of_all = values.worst[one], values.least[one], values.count[one]
            assert of_all == (mine.worst[0], mine.least[0], mine.count[0]), (one, name)
