"""A trade of rows: how long they run, which are refused, and which one is recommended."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import inf
from pathlib import Path

import numpy as np
import pytest

from periph_sim.interfaces.reports.trade import trade as module
from periph_sim.interfaces.reports.trade.observe import Error, Errors, Observed
from periph_sim.interfaces.reports.trade.rows import AS_GIVEN, Row, rows_of
from periph_sim.interfaces.reports.trade.trade import Cost, Outcome, Trade, as_json, text, trade
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase, Case

TIMING = Path(__file__).resolve().parents[4] / "timing"
ROUND = Fraction(3, 100)
Times = Callable[[float], list[float]]
LATE = Row("late", ("seed=7",))  # of which `observing` says the times
WRONG = Row("wrong", ("controller.perod=5 ms",))


@pytest.fixture(autouse=True)
def timed(monkeypatch: pytest.MonkeyPatch) -> None:
    """CPU times of rows fall by a tenth of a second from one to the next."""

    def costs_of(rows: dict[str, object], start: Fraction, length: Fraction) -> dict[str, Cost]:
        return {name: Cost(1 - 0.1 * number, 0.01, 5) for number, name in enumerate(rows)}

    monkeypatch.setattr(module, "costs_of", costs_of)


def traded(case: str, *names: str, length: Fraction = ROUND, max_error_s: float = inf) -> Trade:
    def make(more: Sequence[str]) -> Case:
        return load(TIMING / f"{case}.toml", [*more])

    rows = [*rows_of(make, []), LATE, WRONG]
    return trade(make, [row for row in rows if row.name in names], length, max_error_s)


def observing(monkeypatch: pytest.MonkeyPatch, late: Times, recorded: float = 1.0) -> list[tuple[str, float, str]]:
    """Replace runs by values of one budget: 1 s, but for the row LATE and recorded runs. Return the list of runs."""
    runs = []

    def observe(case: Case, length: Fraction, record: str = "") -> Observed:
        name = "late" if case.seed == 7 else AS_GIVEN
        runs.append((name, float(length), record))
        times = late(float(length)) if name == "late" else [recorded if record else 1.0]
        return Observed({"a": "pass"}, {"a": np.array(times)}, {}, {})

    monkeypatch.setattr(module, "observe", observe)
    return runs


def test_rows_that_are_the_same_in_half_of_the_run_are_not_run_longer(monkeypatch: pytest.MonkeyPatch):
    runs = observing(monkeypatch, lambda length: [1.5])
    found = traded("responder", AS_GIVEN, "late", length=Fraction(2))
    assert runs == [(level, length, "") for length in (1.0, 2.0) for level in (AS_GIVEN, "late")]
    assert (found.ran_s, found.changed) == (2.0, ()) and found.outcomes[1].errors.time == Error(0.5, "s", "a")
    said = "responder: 2 s, n-th occurrence and value against n-th of as given; 1 s gives the same errors CPU time: 5"
    assert " ".join(text(found).split()).startswith(said)


def test_a_row_that_changes_in_the_second_half_is_run_twice_as_long(monkeypatch: pytest.MonkeyPatch):
    observing(monkeypatch, lambda length: [1.5 if length < 2 else 1.7])
    found = traded("responder", AS_GIVEN, "late", length=Fraction(2))
    assert (found.ran_s, found.changed) == (4.0, ()) and found.outcomes[1].errors.time.amount == pytest.approx(0.7)


def test_a_row_that_goes_on_changing_is_named(monkeypatch: pytest.MonkeyPatch):
    observing(monkeypatch, lambda length: [1 + length])
    found = traded("responder", AS_GIVEN, "late", length=Fraction(2))
    assert (found.ran_s, found.changed) == (4.0, ("late",)) and "; late changed since 2 s CPU time: 5 runs" in " ".join(
        text(found).split()
    )


def test_a_recording_that_changes_nothing_has_the_errors_of_the_unrecorded_row(monkeypatch: pytest.MonkeyPatch):
    runs = observing(monkeypatch, lambda length: [1.5])
    found = traded("responder", AS_GIVEN, "record .psr", length=Fraction(2))
    assert runs[-2:] == [(AS_GIVEN, 1.1, ""), (AS_GIVEN, 1.1, ".psr")]
    assert found.outcomes[1].errors == found.outcomes[0].errors
    observing(monkeypatch, lambda length: [1.5], recorded=1.25)
    assert traded("responder", AS_GIVEN, "record .psr").outcomes[1].errors.time.amount == 0.25


def test_a_row_that_a_case_refuses_is_reported_with_the_reason():
    found = traded("imu_hil_spikes", AS_GIVEN, "late", "wrong")
    assert [outcome.row.name for outcome in found.outcomes] == [AS_GIVEN, "late"]
    assert [*found.refused] == ["wrong"] and "did you mean period" in found.refused["wrong"]
    assert "\nwrong is refused: " in text(found)


def test_a_run_in_which_nothing_occurs_is_refused():
    with pytest.raises(
        BadCase, match="nothing to compare: no budget is judged and nothing is read on I2C in the first 0"
    ):
        traded("responder", AS_GIVEN, "late", length=Fraction(0))


def test_values_of_another_arithmetic_differ_and_its_times_do_not():
    found = traded("imu_hil", "arithmetic=float64", AS_GIVEN, length=Fraction(1, 10))
    errors = found.outcomes[1].errors
    assert 0 < errors.value.amount <= 4 and errors.value.unit == "LSB" and errors.time == Error(0, "s")
    assert errors.judged > 15 and errors.differ == ()


def outcome(name: str, cpu_s: float, time_s: float = 0, differ: Sequence[str] = (), record: str = "") -> Outcome:
    errors = Errors(5, tuple(differ), Error(time_s, "s", "a"), Error(0, "LSB"))
    return Outcome(Row(name, record=record), errors, Cost(cpu_s, 0.1, 5))


@pytest.mark.parametrize(
    ("others", "max_error_s", "best"),
    [
        ([outcome("quick", 1.0)], inf, "quick"),
        ([outcome("as quick", 3.1), outcome("slow", 5)], inf, "exact"),
        ([outcome("as quick", 1.1), outcome("quick", 1.0)], inf, "as quick"),
        ([outcome("quick", 1.0, differ=["a"])], inf, "exact"),
        ([outcome("quick", 1.0, record=".psr")], inf, "exact"),
        ([outcome("off", 1.0, 2e-6), outcome("quick", 2.0, 1e-6)], 1e-6, "quick"),
    ],
)
def test_the_cheapest_row_that_judges_alike_is_recommended(others: list[Outcome], max_error_s: float, best: str):
    found, why = module._best([outcome("exact", 3.0), *others], max_error_s)
    assert found.row.name == best
    assert why.startswith(
        "its budgets agree with the most accurate row" if best != "exact" else "it is the most accurate"
    )


def test_budgets_that_judge_otherwise_and_the_place_of_errors_are_named():
    rows = (outcome("exact", 3.0), outcome("late", 1.0, 2e-6, differ=["margin", "age"]), outcome("as late", 1.05))
    said = text(Trade("mine", 2.0, (), 0.1, 1.0, rows, {}, rows[0], "why")).splitlines()
    assert [line.split() for line in said[6:9]] == [
        [*["exact", "5", "of", "5", "reference", "reference", "3", "3.3%"]],
        [*["late", "3", "of", "5", "2", "us", "none", "1", "10.0%"]],
        [*["as", "late", "5", "of", "5", "none", "none", "1.05", "9.5%"]],
    ]
    assert said[9:] == [
        "late judges differently: margin, age",
        "largest errors of times: late in a",
        "same cost within their spread: late and as late",
        "recommended: exact: why",
    ]


def test_json_has_every_row_and_infinite_errors_as_text(monkeypatch: pytest.MonkeyPatch):
    observing(monkeypatch, lambda length: [])
    told = as_json(traded("responder", AS_GIVEN, "late"))
    assert told["recommended"] == "late" and told["refused"] == {} and told["ran_s"] == 0.03
    given, late = told["rows"]  # type: ignore[misc]
    assert (
        given["changes"] == []
        and late["changes"] == ["seed=7"]
        and given["cost"] == {"cpu_s": 1.0, "spread_s": 0.01, "runs": 5}
    )
    assert late["time_error"] == {"amount": "infinite", "unit": "s", "place": "a"}
