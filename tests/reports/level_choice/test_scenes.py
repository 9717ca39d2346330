"""The scenes of timing/trade: right on edges, and what other levels make of each of them, as docs/fidelity.md says."""

from __future__ import annotations

import pytest

from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.docs.pages import ROOT
from tests.docs.scene_table import LEVELS, NAMES, SCENES, cell, outcome, rows

SHOWN = rows((ROOT / "docs" / "fidelity.md").read_text(encoding="utf-8"))
REFUSED = {  # why
    ("noise_spike", "byte"): "fault 0 (spike) may pull SCL and SDA edge by edge",
    ("stop_in_byte", "byte"): "fault 0 (condition) may pull SCL and SDA edge by edge",
}


@pytest.mark.parametrize("name", NAMES)
def test_on_edges_each_scene_is_what_its_budgets_say(name: str):
    case = load(SCENES / f"{name}.toml")
    result = Scene(case).run()
    assert case.budget and [verdict.name for verdict in result.budgets if not verdict.passed] == []


@pytest.mark.parametrize("name", NAMES)
def test_adaptive_is_exact_in_each(name: str):
    measured = [each for each in outcome(name, "adaptive").errors if each.measured]
    assert measured and all(each.exact for each in measured)


def test_the_page_has_every_scene():
    assert sorted(SHOWN) == NAMES


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", LEVELS)
def test_what_a_level_makes_of_it_is_what_the_page_says(name: str, level: str):
    """`python -m tests.docs.update fidelity` measures it anew."""
    assert SHOWN[name][LEVELS.index(level)] == cell(outcome(name, level))


@pytest.mark.parametrize(("name", "level"), REFUSED)
def test_a_level_refuses_a_scene_with_the_reason(name: str, level: str):
    assert REFUSED[name, level] in outcome(name, level).refused


def test_a_flag_that_byte_loses_is_one_that_edges_keep():
    lost = {each.name: each for each in outcome("lost_flag", "byte").errors}
    assert lost["lost flags"].worst == 1
    assert lost["count of access R I2C-A.I2CDRR"].worst == 1


def test_at_least_five_scenes_make_a_level_wrong_that_runs_them():
    """A table in which all is exact is no result."""
    wrong = {name for name in NAMES for level in LEVELS if cell(outcome(name, level)) not in ("exact", "refused")}
    assert len(wrong) >= 5
