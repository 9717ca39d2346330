"""Random small scenes: every observable of the level is what an edge run of the same scene measures."""

from __future__ import annotations

import numpy as np
import pytest

from periph_sim.levels.schedule import schedule, structure_of
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


FOUND = {  # by random scenes: what differed once
    "SCD ends the last wait for XRDY": 48,
    "AAS is missed": 334,
    "the models are cut off by the end of the run": 941,
    "the age of a frame that edges have forgotten": 437,
    "an interrupt while the first read of a wait waits for a write": 337,
}


@pytest.mark.parametrize("name", FOUND)
def test_what_random_scenes_found(name: str):
    case, changes, rounds = scene(FOUND[name])
    found = compare(case, rounds, changes)
    assert not found.refused and not found.differ


@pytest.mark.parametrize("first", ["1432 ms", "1500 ms", "20 s"])
def test_a_first_frame_behind_the_end_of_the_run_never_comes(first: str):
    """Of 32 bits of ticks, 1431.66 ms long, and of more than one such length."""
    found = compare(load(TIMING / "imu_hil_published.toml", [f"host.first={first}"]), 5, [])
    assert not found.refused and not found.differ


PLAIN = {
    "one service routine in many places": ({}, ["host.jitter=1 ms", "host.paced_by=pause"]),
    "several a round": ({}, ["host.period=3 ms", "unit.dsp.settings.frame_cost=20 us", "unit.dsp.ppm=30"]),
    "NACK windows": ({"unit.dsp.settings.model_cost": (1_000, 17_700_000)}, ["controller.ppm=-30"]),
    "hang windows": ({}, ["host.period=3 ms", "unit.dsp.settings.frame_cost=300 us"]),
    "a late first frame": ({"host.first": (0, 60_000_000)}, []),
}


@pytest.mark.parametrize("name", PLAIN)
def test_rounds_by_table_come_to_what_rounds_read_by_read_come_to(name: str, monkeypatch: pytest.MonkeyPatch):
    ranges, changes = PLAIN[name]
    structure = structure_of(load(TIMING / "imu_hil_published.toml", changes))
    random = np.random.default_rng(1)
    ranges = {"host.first": (0, 22_000_000), "seed": (0, 9)} | ranges
    given = {key: random.integers(*range_, 400) for key, range_ in ranges.items()}
    by_table = schedule(structure, given, rounds=7)
    monkeypatch.setattr("periph_sim.levels.schedule.rounds.plain_rounds", lambda *_: None)
    by_read = schedule(structure, given, rounds=7)
    assert by_table.hung_at.tolist() == by_read.hung_at.tolist()
    assert by_table.refused.tolist() == by_read.refused.tolist()
    for one, other in zip(by_table.values(), by_read.values(), strict=True):
        assert one.worst.tolist() == other.worst.tolist(), one.name
        assert one.least.tolist() == other.least.tolist(), one.name
        assert one.count.tolist() == other.count.tolist(), one.name
    assert bool(by_read["nacked"].worst.any()) == name.endswith("windows")
    assert bool(by_read.hung.any()) == (name == "hang windows")
