"""Budgets whose measure missed occasions. With too few measured ones they are not judged, which is never a pass."""

from __future__ import annotations

import pytest

from periph_sim.bus.i2c.transfer import Phase
from periph_sim.core.time import NO_TIME
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.budgets import BudgetJudge
from tests.scene.runs import run_file
from tests.timing.judges import judge
from tests.timing.measures.hand_made_run import GYRO, HandMadeRun, read, wrote


def never(address: int) -> Phase:
    """A read that was requested but never begun, because the phase before it was refused."""
    return Phase(address, read=True, count=6)


def limit(run: HandMadeRun, name: str, **more: str | int) -> BudgetJudge:
    """A budget on the measure of this run."""
    budget = Budget.model_validate({"name": "b", "measure": name, **more})
    made = judge(budget)
    made.measure = run.measure
    return made


@pytest.mark.parametrize(
    ("answered", "asked", "verdict"), [(9, 10, "pass"), (8, 10, "not judged"), (1, 1, "pass"), (89, 99, "not judged")]
)
def test_nine_tenths_of_the_occasions_are_enough(answered: int, asked: int, verdict: str):
    run = HandMadeRun("response")
    for at in range(asked):
        phase = read(GYRO, at=at, answer_from=at, answer_at=at + 1 if at < answered else NO_TIME)
        run.transfer(phase)
    v = limit(run, "response", max="1 us").verdict()
    assert (v.verdict, v.measured, v.occasions) == (verdict, answered, asked)
    assert v.passed == (verdict == "pass") and not v.broken
    assert v.counted == (str(answered) if answered == asked else f"{answered} of {asked}")
    assert v.found == ("" if v.passed else f"measured {answered} of {asked} reads asked, less than 90 %")


def test_a_broken_limit_fails_even_if_little_was_measured():
    run = HandMadeRun("response")
    run.transfer(read(GYRO, answer_from=0, answer_at=4000))
    run.transfer(wrote(GYRO, acked=False), never(GYRO))
    assert limit(run, "response", max="1 us").verdict().verdict == "fail"


def test_coverage_sets_the_required_part_of_the_occasions():
    run = HandMadeRun("response")
    run.transfer(read(GYRO, answer_from=0, answer_at=1))
    run.transfer(wrote(GYRO, acked=False), never(GYRO))
    assert limit(run, "response", max="1 us", coverage="50 %").verdict().passed
    assert not limit(run, "response", max="1 us", coverage="50.1 %").verdict().passed
    with pytest.raises(ValueError, match="'half' is not a share from 0 % to 100 %; write for instance '90 %'"):
        limit(run, "response", max="1 us", coverage="half")


def test_a_request_is_an_occasion_even_if_it_was_never_sent():
    response, stretch, wrong = HandMadeRun("response"), HandMadeRun("stretch"), HandMadeRun("wrong bytes")
    for run in (response, stretch, wrong):
        run.transfer(wrote(GYRO, acked=False, at=5), never(GYRO))
    assert [t.measure.occasions for t in (response, stretch, wrong)] == [1, 2, 6]
    assert [t.measure.measured for t in (response, stretch, wrong)] == [0, 0, 0]


@pytest.mark.parametrize("name", ["round", "nacked rounds"])
def test_missed_rounds_are_occasions(name: str):
    run = HandMadeRun(name)
    run.round(due=10, end=20)
    run.misses(due=30)
    run.round(due=50, end=60)
    assert (run.measure.measured, run.measure.occasions) == (2, 3)


def test_missed_rounds_shows_the_number_of_due_rounds():
    run = HandMadeRun("missed rounds")
    for due in (10, 20, 30):
        run.round(due, due + 5)
    run.misses(40)
    v = limit(run, "missed rounds", max=1).verdict()
    assert (v.verdict, v.worst, v.count, v.counted) == ("pass", 1, 4, "4")


@pytest.mark.parametrize("name", ["fifo high-water", "overruns"])
@pytest.mark.parametrize(("received", "verdict"), [(10, "pass"), (9, "pass"), (8, "not judged")])
def test_characters_that_the_sci_does_not_receive_are_not_measured(name: str, received: int, verdict: str):
    run = HandMadeRun(name)
    for n in range(10):
        run.character(n, n < received)
    run.words(3, 1)
    v = limit(run, name, max=5).verdict()
    assert (v.verdict, v.measured, v.occasions) == (verdict, received, 10)


@pytest.mark.parametrize("name", ["response", "stretch", "wrong bytes"])
def test_a_head_without_acknowledge_most_of_the_time_is_not_judged(name: str):
    """The models prevent the firmware from serving four of five rounds."""
    limit = 999 if name == "wrong bytes" else '"9 s"'
    budget = f'budget=[{{name="b", measure="{name}", max={limit}}}]'
    ran = run_file("imu_hil_published", "0.3", budget, "unit.dsp.settings.model_cost=95 ms")
    (v,) = ran.result.budgets
    assert (ran.result.verdict, v.verdict) == ("fail", "not judged")
    assert v.occasions is not None and 0 < 10 * v.measured < 9 * v.occasions
