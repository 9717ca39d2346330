"""Proofs for all clocks of a controller within a range: the clocks that differ, and the results of their tables.

errors    -10 ...... -3.3 ... 3.3 ...... 10 ppm
lengths   |  gap + 1  |   gap   |  gap - 1  |      ticks; one table for each combination
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

from periph_sim.interfaces.reports.processes import results_of
from periph_sim.proof.clock_errors import clock_errors
from periph_sim.proof.free_run import NotClosed
from periph_sim.proof.stretch import Job
from periph_sim.proof.table_proof import TableProof, prove
from periph_sim.scene.case.inputs_table import InputsTable
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase, Case
from periph_sim.scene.controller import head_plan
from periph_sim.scene.plan import ScenePlan
from periph_sim.scene.scene import Scene
from tests.proof.proven_slave import write_slave
from tests.proof.test_closed_table import write_echo

WITHIN = Fraction(10)
# A pause of the controller between two requests, which is 50 us by its clock, and the reaction of the slave.
BUDGETS = """
[[budget]]
name = "pause"
measure = "from first bus STOP of round to bus START, next"
max = "{most}"

[[budget]]
name = "reaction"
measure = "reaction"
max = "1 us"
coverage = "40 %"
"""


def write_case(folder: Path, most: str = "60 us") -> Path:
    """Write the case of the register slave with a later first round. most: the limit of the pause."""
    case = write_slave(folder, BUDGETS.format(most=most))
    case.write_text(case.read_text(encoding="utf-8").replace('first = "5 ms"', 'first = "8 ms"'), encoding="utf-8")
    return case


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, TableProof]:
    """Return a case and its tables for all clocks within 10 ppm."""
    case = write_case(tmp_path_factory.mktemp("clocks"))
    return case, prove(Job(str(case)), WITHIN)


def lengths(case: Case, error: Fraction) -> object:
    assert case.controller is not None
    controller = case.controller.model_copy(update={"ppm": error})
    plan = head_plan(ScenePlan(case.model_copy(update={"controller": controller})).ticks)
    return plan.timing, plan.schedule.gap, plan.clear_after


def test_each_error_in_the_range_has_the_lengths_of_one_that_is_found(whole: tuple[Path, TableProof]):
    case, random = load(whole[0]), Random(3)
    errors = clock_errors(case, WITHIN)
    found = {lengths(case, error) for error in errors}
    assert len(found) == len(errors) == 4
    assert [(f"controller.ppm={float(error):.17g}",) for error in errors] == [part.changes for part in whole[1].parts]
    drawn = [Fraction(random.randrange(-10 * 10**9, 10 * 10**9 + 1), 10**9) for _ in range(1000)]
    assert {lengths(case, error) for error in [-WITHIN, WITHIN, *drawn]} == found


def test_a_range_with_too_many_clocks_is_refused(whole: tuple[Path, TableProof]):
    with pytest.raises(NotClosed, match=r"^the range has more than 500 clocks with different lengths in ticks$"):
        clock_errors(load(whole[0], ["controller.clear_after=10 ms"]), Fraction(1000))


def test_errors_of_an_empty_range_and_of_a_range_around_another_clock(whole: tuple[Path, TableProof]):
    case = load(whole[0], ["controller.ppm=50"])
    assert clock_errors(case, Fraction(0)) == [50]
    errors = clock_errors(case, Fraction(10))
    assert (min(errors) >= 40, max(errors) <= 60) == (True, True)


def test_ordinary_runs_with_any_clock_and_first_round_are_within_the_proof(whole: tuple[Path, TableProof]):
    path, proof = whole
    assert (proof.has_failed, proof.words()["reaction"], len(proof.parts)) == (False, "proven", 4)
    assert proof.words()["pause"] == "proven"
    assert {(*part.table.orbits, part.table.entries) for part in proof.parts} == {(80, 80, 160)}
    assert proof.again == 200
    worst, random = {name: one.verdict.worst for name, one in proof.worst().items()}, Random(4)
    seen: dict[str, list[float]] = {"reaction": [], "pause": []}
    per_second = proof.covered.phases.ticks_per_second
    for _ in range(30):
        case = load(path, [f"controller.ppm={random.uniform(-10, 10):.6f}"])
        starts = [proof.first + 1 + random.randrange(per_second // 500)]
        for _ in range(4):
            starts.append(starts[-1] + proof.apart + random.randrange(per_second // 1000) * random.randrange(2))
        inputs = InputsTable(rounds=tuple(Fraction(start, per_second) for start in starts))
        end = Fraction(starts[-1] + proof.apart, per_second)
        result = Scene(case.model_copy(update={"inputs": inputs, "duration": end})).run()
        for verdict in result.budgets:
            if verdict.name in seen and verdict.worst is not None:
                seen[verdict.name].append(verdict.worst)
    assert max(seen["reaction"]) == worst["reaction"]
    assert all(value <= worst["pause"] for value in seen["pause"] if worst["pause"] is not None)
    assert len(set(seen["pause"])) > 2


def test_tables_of_other_processes_are_those_of_one(whole: tuple[Path, TableProof]):
    with ProcessPoolExecutor(2) as pool:
        again = prove(Job(str(whole[0])), WITHIN, call_all=lambda make, calls: results_of(pool, make, calls))
    for one, other in zip(whole[1].parts, again.parts, strict=True):
        assert (one.changes, one.table) == (other.changes, other.table)


def test_a_limit_that_only_a_slow_clock_breaks(tmp_path: Path):
    """The pause is up to two ticks longer with a slow clock, and 50 us with an exact one."""
    case = write_case(tmp_path, "50.0002 us")
    assert prove(Job(str(case))).words()["pause"] == "proven"
    broken = prove(Job(str(case)), WITHIN)
    worst = broken.worst()["pause"]
    assert (broken.has_failed, broken.words()["pause"]) == (True, "broken")
    (change,) = worst.part.changes
    assert -10 <= float(change.removeprefix("controller.ppm=")) < -3
    run, covered = worst.run(), worst.part.covered
    end = Fraction(run.until, covered.phases.ticks_per_second)
    scene = covered.scene_of(covered.phases.inputs_at(run.starts), end, 1)
    (verdict,) = [one for one in scene.run().budgets if one.name == "pause"]
    assert (verdict.broken, verdict.worst) == (True, worst.verdict.worst)


def test_rounds_that_are_left_out_because_they_come_before_the_first_one_of_the_case(tmp_path: Path):
    """The first round of the table is soon after 7 ms, and `after` leaves it out, but not that of the case."""
    case = write_case(tmp_path)
    text = case.read_text(encoding="utf-8").replace('measure = "reaction"', 'measure = "reaction"\nafter = "7.5 ms"')
    case.write_text(text, encoding="utf-8")
    assert prove(Job(str(case))).words()["reaction"] == "proven"
    assert prove(Job(str(case)), Fraction(0)).not_proven()["reaction"] == "its `after` leaves out rounds of the table"


def test_a_first_round_before_the_first_rest_and_a_case_without_a_controller_are_refused(tmp_path: Path):
    (tmp_path / "early").mkdir()
    with pytest.raises(NotClosed, match=r"^the first start is free, .*: make `first` more than 7\.0000 ms$"):
        prove(Job(str(write_slave(tmp_path / "early"))), WITHIN)
    with pytest.raises(BadCase, match=r"--ppm needs a \[controller\]"):
        prove(Job(str(write_echo(tmp_path))), WITHIN)
    starts_up = ("controller.initialise=1 ms", 'controller.order=["gyroscope"]')
    with pytest.raises(BadCase, match=r"--ppm: the start-up of the chips would come at another tick"):
        prove(Job(str(write_case(tmp_path)), starts_up), WITHIN)
