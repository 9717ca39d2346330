"""The scenes of timing/trade: right on edges, and what the level "byte" makes of each of them."""

from __future__ import annotations

from functools import cache
from math import inf
from pathlib import Path

import pytest

from periph_sim.reports.trade.levels import REFERENCE, level_of
from periph_sim.reports.trade.trade import Outcome, Trade, trade
from periph_sim.scene.case.discover import cases_below
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

SCENES = Path(__file__).resolve().parents[3] / "timing" / "trade"
NAMES = sorted(path.stem for path in cases_below(SCENES))

# The worst error in cycles at level "byte"; where it is refused, why.
BYTE: dict[str, float | str] = {
    "arbitration": 0,  # edge by edge: the F28335 that is a master takes no whole bytes
    "clock_gate": inf,
    "lost_flag": inf,
    "nack_interrupt": 748,
    "noise_spike": "fault 0 (spike) may pull SCL and SDA edge by edge",
    "pad_look": inf,
    "reset_in_byte": 1617,
    "sci_grid": 0,  # SCI frames are edges at every level but `schedule`
    "stop_in_byte": "fault 0 (condition) may pull SCL and SDA edge by edge",
    "zero_hold": 0,
}


@cache
def traded(name: str) -> Trade:
    path = SCENES / f"{name}.toml"
    return trade(
        lambda more: load(path, list(more)),
        [level_of(REFERENCE), level_of("adaptive"), level_of("byte")],
        load(path).duration,
    )


def outcome(name: str, level: str) -> Outcome:
    return next(each for each in traded(name).outcomes if each.level.name == level)


@pytest.mark.parametrize("name", NAMES)
def test_on_edges_each_scene_is_what_its_budgets_say(name: str):
    case = load(SCENES / f"{name}.toml")
    result = Scene(case).run()
    assert case.budget and [verdict.name for verdict in result.budgets if not verdict.passed] == []


@pytest.mark.parametrize("name", NAMES)
def test_adaptive_is_exact_in_each(name: str):
    assert all(each.exact for each in outcome(name, "adaptive").errors)


def test_every_scene_says_what_byte_makes_of_it():
    assert sorted(BYTE) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_what_byte_makes_of_it(name: str):
    found, expected = outcome(name, "byte"), BYTE[name]
    if isinstance(expected, str):
        assert expected in found.refused
    else:
        assert not found.refused and found.worst == expected
        assert all(each.exact for each in found.errors) == (not expected)


def test_a_flag_that_byte_loses_is_one_that_edges_keep():
    lost = {each.name: each for each in outcome("lost_flag", "byte").errors}
    assert lost["lost flags"].worst == 1
    assert lost["count of access R I2C-A.I2CDRR"].worst == 1


def test_at_least_six_scenes_make_byte_wrong_or_are_refused():
    assert sum(BYTE[name] != 0 for name in NAMES) >= 6
