"""A case at level `schedule`: the verdicts of an edge run, wherever it ends; what the level lacks is not judged."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.levels.judged import judged as judged_case
from periph_sim.levels.schedule import BadSchedule, structure_of
from periph_sim.levels.schedule.inputs import inputs_of
from periph_sim.levels.schedule.journal import Journal
from periph_sim.levels.schedule.rounds import Rounds
from periph_sim.levels.schedule.scheduled_scene import ScheduledScene
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.firmware_loader import load_firmware
from periph_sim.scene.scene import Scene
from periph_sim.timing.values import values_of
from periph_sim.timing.verdict import FAIL, NOT_JUDGED, PASS
from tests.levels.schedule.judged import cut, judged
from tests.profiles import explores
from tests.scene.runs import TIMING

SEEDS = range(1000) if explores() else range(8)
PUBLISHED = TIMING / "imu_hil_published.toml"
LACKS = ("wrong bytes", "SCI FIFO high-water", "SCI overruns")


@pytest.mark.long
@pytest.mark.parametrize("seed", SEEDS)
def test_verdicts_of_a_random_scene_are_those_of_edges_wherever_it_ends(seed: int):
    case, length = cut(seed)
    try:
        differ = judged(case, length)
    except BadSchedule as refused:
        assert "the module answers for firmware that is still elsewhere" in str(refused)
        return
    assert not differ


WINDOWS = {
    "NACK": ["unit.dsp.settings.model_cost=17100 us to 17500 us", "seed=7"],
    "hang": ["unit.dsp.settings.frame_cost=300 us", "host.period=3 ms", "seed=4"],
    "stretch": ["unit.dsp.settings.frame_cost=60 us", "host.period=3 ms"],
}


@pytest.mark.parametrize("name", WINDOWS)
def test_windows_have_the_verdicts_of_edges(name: str):
    case = load(PUBLISHED, WINDOWS[name])
    assert not judged(case, Fraction(1, 10))
    result = ScheduledScene(case).run(Fraction(1, 10))
    assert result.verdict == FAIL
    assert bool(result.stuck) == (name == "hang")


def test_a_hang_in_the_last_read_of_a_round():
    assert not judged(*cut(334))  # found by random scenes


def test_a_stretch_that_the_end_of_the_run_cuts_off():
    case = load(PUBLISHED, WINDOWS["stretch"])
    structure, journal = structure_of(case), Journal()
    Rounds(structure, inputs_of(structure, {}, 20), journal).run()
    bytes_ = [pair for made in journal.made for pair in zip(made.let_go, made.rise, strict=True)]
    let_go, rise = next((let_go, rise) for let_go, rise in bytes_ if rise > let_go + 100)
    for end in (let_go, (let_go + rise) // 2, rise - 1, rise, rise + 1):
        assert not judged(case, Fraction(end, structure.per_second)), end


def test_what_the_level_does_not_tell_is_not_judged_and_says_which_level_does():
    case = load(PUBLISHED, ["fidelity=schedule", "duration=1 s"])
    result, edge = judged_case(case).run(), Scene(load(PUBLISHED, ["duration=1 s"])).run()
    lacking = [verdict for verdict in result.budgets if verdict.verdict == NOT_JUDGED]
    assert [verdict.name for verdict in lacking] == list(LACKS)
    assert all(verdict.found.endswith('"edge" and "adaptive" do') and verdict.worst is None for verdict in lacking)
    others = [(one, other) for one, other in zip(result.budgets, edge.budgets, strict=True) if one not in lacking]
    assert len(others) == 8 and all(one == other for one, other in others)
    assert (result.verdict, result.fidelity, edge.verdict) == (NOT_JUDGED, "schedule", PASS)
    assert (result.wire_bytes, result.sci_bytes) == (edge.wire_bytes, edge.sci_bytes)


@pytest.mark.parametrize("name", ["imu_moving", "imu_models", "imu_hil_drift", "imu_hil_400k"])
def test_a_shipped_case_has_the_verdicts_of_edges_joined_conditions_too(name: str):
    case = load(TIMING / f"{name}.toml")
    scene = judged_case(case.model_copy(update={"fidelity": "schedule"}), keep_values=True)
    result, edge = scene.run(Fraction(1, 10)), Scene(case).run(Fraction(1, 10))
    lacking = {verdict.name for verdict in result.budgets if verdict.found.endswith('"edge" and "adaptive" do')}
    told = [(one, other) for one, other in zip(result.budgets, edge.budgets, strict=True) if one.name not in lacking]
    assert told and all(one == other for one, other in told)
    assert ("fresh and right" in lacking) == (name == "imu_moving")
    kept = dict(zip((limit.budget.name for limit in scene.limits), values_of(scene.limits, scene.start), strict=True))
    assert all(kept[budget] is None for budget in lacking)
    assert any(values is not None for values in kept.values()) == (name != "imu_moving")  # there, counts alone


def test_a_case_of_budgets_that_the_level_tells_passes_and_says_what_its_terms_are_of():
    case = load(PUBLISHED, ["fidelity=schedule", "duration=1 s"])
    case = case.model_copy(update={"budget": tuple(one for one in case.budget if one.name not in LACKS)})
    result = judged_case(case, keep_values=True).run()
    assert result.verdict == PASS
    # Two rounds from 5 ms on without the host, and twice two frames and a period more without requests.
    assert case.host is not None and case.host.period == Fraction(20, 1000)
    assert result.terms_s == pytest.approx(0.045 + 2 * (float(case.host.first) + 0.06))
    assert result.events > 0


def test_values_are_kept_where_they_are_wanted():
    case = load(PUBLISHED, ["fidelity=schedule"])
    scene = judged_case(case, keep_values=True)
    scene.run(Fraction(1, 10))
    kept = {limit.budget.name: limit.measure.kept for limit in scene.limits}
    values = kept["data age"]
    assert values is not None and len(values[0]) == 15
    assert [verdict.name for verdict in scene.typical()][:2] == ["model execution", "response"]


@pytest.mark.parametrize(
    ("name", "changes", "said"),
    [
        ("responder", [], "it has no [host] or no [controller]"),
        ("imu_hil_glitches", [], "it has [fault]"),
        ("trade/sci_grid", [], 'the level "schedule" tells none of these; it tells response, stretch,'),
        ("imu_hil_published", ["unit.dsp.settings.model_cost=45 ms"], "the module answers for firmware that is still"),
    ],
)
def test_what_the_level_does_not_describe_is_refused_with_the_reason(name: str, changes: list[str], said: str):
    with pytest.raises(BadCase) as error:
        judged_case(load(TIMING / f"{name}.toml", ["fidelity=schedule", *changes])).run()
    assert said in str(error.value) and '"edge"' in str(error.value)


def test_who_wants_wires_or_firmware_of_its_own_is_refused():
    case = load(PUBLISHED, ["fidelity=schedule"])
    with pytest.raises(BadCase, match=r'"schedule" has neither wires nor records.*here use "edge"'):
        Scene(case)
    with pytest.raises(BadCase, match="knows the firmware imu_hil, and none that is given as a function"):
        judged_case(case, None, {"dsp": load_firmware("imu_hil")})
