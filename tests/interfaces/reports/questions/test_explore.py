"""Exploration of answers: which are run alone and in pairs, and the result for each budget."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import pytest

from periph_sim.interfaces.reports.questions.dependence import RUN
from periph_sim.interfaces.reports.questions.explore import explore
from periph_sim.scene.case.model import BadCase
from tests.interfaces.reports.questions.small import (
    CASE,
    FIRMWARE,
    LATE,
    LENGTH,
    answers,
    by_name,
    departures,
    explored,
    written,
)

READ, WRITE, LANDS, GATE = "system.pf2_read_ws", "system.pf2_write_ws", "system.write_lands", "sci.clock_gate_access"
BRR = "sci.brr_write_effect"
OTHERS = [(GATE, "accessible"), *((READ, n) for n in (0, 1, 3, 15)), (WRITE, 1), (WRITE, 15), (LANDS, 4)]


def limited(cycles: float) -> str:
    """Return a change that sets the limit of the budget work, in cycles."""
    return f"budget.work.max={cycles * 1000 / 150:.3f} ns"


def test_each_other_answer_is_run_alone_and_related_ones_in_pairs(tmp_path: Path) -> None:
    result = explored(written(tmp_path))
    pairs = [dict(pair) for pair in combinations(OTHERS, 2) if pair[0][0] != pair[1][0] and pair[0][0] != GATE]
    assert answers(result) == [{}, *(dict([one]) for one in OTHERS), *pairs, {GATE: "accessible", BRR: "at_once"}]
    assert (result.count(1), result.count(2)) == (len(OTHERS), len(pairs) + 1)


def test_a_budget_that_no_answer_breaks_holds(tmp_path: Path) -> None:
    (work,) = by_name(explored(written(tmp_path))).values()  # and there is no row for runs that end normally
    assert work.holds and not work.departures
    assert work.worst is not None and work.worst.worst == pytest.approx((14 + 13 + 15) / 150, abs=0.001)


def test_a_budget_that_an_answer_breaks_depends_on_it_and_the_answer_is_in_no_pair(tmp_path: Path) -> None:
    result = explored(written(tmp_path), limited(27.5))
    assert departures(result, "work") == [({WRITE: 15}, "broken"), ({READ: 15, WRITE: 1}, "broken")]
    assert not by_name(result)["work"].holds
    assert [one for one in answers(result) if one.get(WRITE) == 15] == [{WRITE: 15}]


def test_a_pair_may_break_a_budget_that_neither_answer_breaks_alone(tmp_path: Path) -> None:
    result = explored(written(tmp_path), limited(29.5))
    broken = [each for each, word in departures(result, "work") if word == "broken"]
    assert broken == [{READ: 3, WRITE: 15}, {READ: 15, WRITE: 15}]
    assert not by_name(result)["work"].holds


def test_a_budget_that_is_broken_may_hold_under_an_answer(tmp_path: Path) -> None:
    result = explored(written(tmp_path), limited(13.5))
    work = by_name(result)["work"]
    assert work.word == "broken" and not work.holds
    assert departures(result, "work") == [
        ({READ: 0}, "seen"),
        ({READ: 1}, "seen"),
        *(({READ: n, other: value}, "seen") for n, other, value in ((0, WRITE, 1), (0, LANDS, 4), (1, LANDS, 4))),
    ]


def test_an_answer_that_the_case_or_a_change_states_is_replaced(tmp_path: Path) -> None:
    result = explored(written(tmp_path), limited(27.5), "unit.dsp.options.system.pf2_write_ws=15")
    assert by_name(result)["work"].word == "broken" and ({WRITE: 0}, "seen") in departures(result, "work")
    assert [one[WRITE] for one in answers(result) if [*one] == [WRITE]] == [0, 14]


def test_a_question_that_arises_only_with_another_answer_is_varied_with_it(tmp_path: Path) -> None:
    result = explored(written(tmp_path))
    assert f"dsp.{BRR}" not in result.default.unknowns
    assert {GATE: "accessible", BRR: "at_once"} in answers(result) and {BRR: "at_once"} not in answers(result)
    assert result.not_varied == () and f"dsp.{BRR}" in {one.name for one in result.questions}


def test_a_question_is_named_but_not_varied_if_the_other_answer_breaks_a_budget(tmp_path: Path) -> None:
    result = explored(written(tmp_path, CASE + LATE))
    assert departures(result, "late") == [({GATE: "accessible"}, "broken")]
    assert result.not_varied == (f"dsp.{BRR}",) and BRR not in {name for one in answers(result) for name in one}


@pytest.mark.parametrize(
    ("then", "word", "found"),
    [
        ("raise ValueError('no')", "cannot be made", "ValueError"),
        ("dsp.spin(lambda: sci.SCIRXST.RXRDY)", "stuck", "dsp waits for SCI-A.SCIRXST.RXRDY"),
    ],
)
def test_a_run_that_fails_without_a_broken_budget_has_a_row_of_its_own(
    tmp_path: Path, then: str, word: str, found: str
) -> None:
    result = explored(written(tmp_path, firmware=FIRMWARE.replace("sci.SCILBAUD.all = 7", then)))
    assert departures(result, RUN) == [({GATE: "accessible"}, word)]
    run = by_name(result)[RUN]
    assert found in run.departures[0].found and not run.holds and by_name(result)["work"].holds


def test_the_runs_are_the_same_with_any_number_of_workers(tmp_path: Path) -> None:
    file = written(tmp_path)
    one, two = (explore(file, [limited(27.5)], LENGTH, jobs) for jobs in (1, 2))
    assert answers(one) == answers(two) and one.not_varied == two.not_varied
    assert by_name(one) == by_name(two)


def test_progress_is_shown_for_answers_and_for_pairs(tmp_path: Path) -> None:
    from collections.abc import Callable, Iterator
    from contextlib import contextmanager

    shares: dict[str, list[float]] = {}

    @contextmanager
    def bar(step: str) -> Iterator[Callable[[float], None]]:
        yield shares.setdefault(step, []).append

    explore(written(tmp_path), [], LENGTH, 1, bar)
    assert [*shares] == ["8 answers", "15 pairs"]
    assert all(done[-1] == 1 and done == sorted(done) for done in shares.values())


@pytest.mark.parametrize(
    ("case", "firmware", "sentence"),
    [
        (CASE.partition("[[budget]]")[0], FIRMWARE, "the case has no budget that an answer could break"),
        (CASE, "def main(dsp, settings):\n    dsp.compute(10)\n", "the run depends on no undocumented behaviour"),
    ],
)
def test_a_case_without_budgets_or_questions_is_refused(
    tmp_path: Path, case: str, firmware: str, sentence: str
) -> None:
    with pytest.raises(BadCase, match=sentence) as error:
        explored(written(tmp_path, case, firmware))
    assert "\n" not in str(error.value)
