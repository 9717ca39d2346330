"""A trade of rows: their CPU times, rejected rows, and the recommended one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from itertools import count
from math import inf
from typing import Any

import numpy as np
import pytest

from periph_sim.interfaces.reports.trade import trade
from periph_sim.interfaces.reports.trade.cost import Cost
from periph_sim.interfaces.reports.trade.observe import Error, Errors, Observed
from periph_sim.interfaces.reports.trade.rows import AS_GIVEN, Row, rows_of
from periph_sim.interfaces.reports.trade.trade import (
    FEWEST,
    MOST,
    PATIENCE,
    Outcome,
    Trade,
    are_apart,
    as_json,
    costs_of,
    text,
)
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase, Case
from tests.scene.runs import TIMING

ROUND = Fraction(3, 100)
Times = Callable[[float], list[float]]
LATE = Row("late", ("seed=7",))  # `observing` sets its times
WRONG = Row("wrong", ("controller.perod=5 ms",))


@pytest.fixture(autouse=True)
def timed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let CPU times of rows decrease by 0.1 s from one row to the next."""

    def costs_of(rows: dict[str, object], start: Fraction, length: Fraction) -> dict[str, Cost]:
        return {name: Cost(1 - 0.1 * number, 0.01, 5) for number, name in enumerate(rows)}

    monkeypatch.setattr(trade, "costs_of", costs_of)


def traded(case: str, *names: str, length: Fraction = ROUND, max_error_s: float = inf) -> Trade:
    def make(more: Sequence[str]) -> Case:
        return load(TIMING / f"{case}.toml", [*more])

    rows = [*rows_of(make, []), LATE, WRONG]
    return trade.trade(make, [row for row in rows if row.name in names], length, max_error_s)


def observing(monkeypatch: pytest.MonkeyPatch, late: Times, recorded: float = 1.0) -> list[tuple[str, float, str]]:
    """Replace runs by values of one budget: 1 s except for the row LATE and recorded runs. Return the list of runs."""
    runs = []

    def observe(case: Case, length: Fraction, record: str = "") -> Observed:
        name = "late" if case.seed == 7 else AS_GIVEN
        runs.append((name, float(length), record))
        times = late(float(length)) if name == "late" else [recorded if record else 1.0]
        return Observed({"a": "pass"}, {"a": np.array(times)}, {}, {})

    monkeypatch.setattr(trade, "observe", observe)
    return runs


def test_rows_with_equal_errors_in_both_halves_are_not_run_longer(monkeypatch: pytest.MonkeyPatch):
    runs = observing(monkeypatch, lambda length: [1.5])
    found = traded("responder", AS_GIVEN, "late", length=Fraction(2))
    assert runs == [(level, length, "") for length in (1.0, 2.0) for level in (AS_GIVEN, "late")]
    assert (found.ran_s, found.changed) == (2.0, ()) and found.outcomes[1].errors.time == Error(0.5, "s", "a")
    message = (
        "responder: 2 s, n-th occurrence and value against n-th of as given; 1 s gives the same errors CPU time: 5"
    )
    assert " ".join("\n".join(text(found)).split()).startswith(message)


@pytest.mark.parametrize(
    ("late", "changed", "message"),
    [
        (lambda length: [1.5 if length < 2 else 1.7], (), "; 2 s gives the same errors CPU time: 5 runs"),
        (lambda length: [1 + length], ("late",), "; late changed since 2 s CPU time: 5 runs"),
    ],
)
def test_rows_are_run_twice_as_long_if_one_changes_in_the_second_half(
    monkeypatch: pytest.MonkeyPatch, late: Times, changed: tuple[str, ...], message: str
):
    observing(monkeypatch, late)
    found = traded("responder", AS_GIVEN, "late", length=Fraction(2))
    assert (found.ran_s, found.changed) == (4.0, changed) and message in " ".join("\n".join(text(found)).split())
    assert found.outcomes[1].errors.time.amount == pytest.approx(late(4.0)[0] - 1)


def test_a_recording_without_effect_has_the_errors_of_the_unrecorded_row(monkeypatch: pytest.MonkeyPatch):
    runs = observing(monkeypatch, lambda length: [1.5])
    found = traded("responder", AS_GIVEN, "record .psr", length=Fraction(2))
    assert runs[-2:] == [(AS_GIVEN, 1.1, ""), (AS_GIVEN, 1.1, ".psr")]
    assert found.outcomes[1].errors == found.outcomes[0].errors
    observing(monkeypatch, lambda length: [1.5], recorded=1.25)
    assert traded("responder", AS_GIVEN, "record .psr").outcomes[1].errors.time.amount == 0.25


def test_a_row_that_the_case_rejects_is_reported_with_the_reason():
    found = traded("imu_hil_spikes", AS_GIVEN, "late", "wrong")
    assert [outcome.row.name for outcome in found.outcomes] == [AS_GIVEN, "late"]
    assert [*found.refused] == ["wrong"] and "did you mean period" in found.refused["wrong"]
    assert "\nwrong is refused: " in "\n".join(text(found))


def test_a_run_without_events_is_rejected():
    with pytest.raises(
        BadCase, match="nothing to compare: no budget is judged and nothing is read on I2C in the first 0"
    ):
        traded("responder", AS_GIVEN, "late", length=Fraction(0))


def test_another_arithmetic_changes_values_and_no_times():
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
def test_the_cheapest_row_with_equal_verdicts_is_recommended(others: list[Outcome], max_error_s: float, best: str):
    found, why = trade._best([outcome("exact", 3.0), *others], max_error_s)
    assert found.row.name == best
    assert why.startswith(
        "its budgets agree with the most accurate row" if best != "exact" else "it is the most accurate"
    )


def test_budgets_with_other_verdicts_and_the_place_of_errors_are_named():
    rows = (outcome("exact", 3.0), outcome("late", 1.0, 2e-6, differ=["margin", "age"]), outcome("as late", 1.05))
    message = [*text(Trade("mine", 2.0, (), 0.1, 1.0, rows, {}, rows[0], "why"))]
    assert [line.split() for line in message[6:9]] == [
        [*["exact", "5", "of", "5", "reference", "reference", "3", "3.3%"]],
        [*["late", "3", "of", "5", "2", "us", "none", "1", "10.0%"]],
        [*["as", "late", "5", "of", "5", "none", "none", "1.05", "9.5%"]],
    ]
    assert message[9:] == [
        "late judges differently: margin, age",
        "largest errors of times: late in a",
        "same cost within their spread: late and as late",
        "recommended: exact: why",
    ]


def test_json_has_every_row_and_infinite_errors_as_text(monkeypatch: pytest.MonkeyPatch):
    observing(monkeypatch, lambda length: [])
    shown = as_json(traded("responder", AS_GIVEN, "late"))
    assert shown["recommended"] == "late" and shown["refused"] == {} and shown["ran_s"] == 0.03
    given, late = shown["rows"]  # type: ignore[misc]
    assert (
        given["changes"] == []
        and late["changes"] == ["seed=7"]
        and given["cost"] == {"cpu_s": 1.0, "spread_s": 0.01, "runs": 5}
    )
    assert late["time_error"] == {"amount": "infinite", "unit": "s", "place": "a"}


CASE = load(TIMING / "responder.toml")
ROWS = {"slow": (CASE, ""), "quick": (CASE, ".psr")}


def costs(
    monkeypatch: pytest.MonkeyPatch, slow: float, quick: float, jitter: float, each_s: float = 0.0
) -> dict[str, Cost]:
    """Return the costs of two rows with these CPU times plus or minus `jitter`. A clock call takes `each_s`."""
    number = count()

    def cpu_s(case: object, record: str, start: Fraction, length: Fraction) -> float:
        return (quick if record else slow) + jitter * (-1) ** (next(number) // 2)

    clock = count(0, each_s)
    monkeypatch.setattr(trade, "_cpu_s", cpu_s)
    monkeypatch.setattr(trade, "process_time", lambda: float(next(clock)))
    return costs_of(ROWS, Fraction(1, 100), Fraction(2, 100))


def test_rows_that_differ_by_more_than_their_spread_are_not_repeated(monkeypatch: pytest.MonkeyPatch):
    found = costs(monkeypatch, slow=2.0, quick=1.0, jitter=0.1)
    assert {name: cost.runs for name, cost in found.items()} == {"slow": FEWEST, "quick": FEWEST}
    assert found["slow"].cpu_s == pytest.approx(2.1) and found["slow"].spread_s == pytest.approx(0.2 / FEWEST**0.5)
    assert found["quick"].is_below(found["slow"]) and not found["slow"].is_below(found["quick"])


@pytest.mark.parametrize(("slow", "each_s", "runs"), [(1.01, 0.0, MOST), (1.0, PATIENCE * 0.6, FEWEST + 1)])
def test_rows_that_differ_by_less_than_their_spread_are_repeated_for_a_limited_time(
    monkeypatch: pytest.MonkeyPatch, slow: float, each_s: float, runs: int
):
    found = costs(monkeypatch, slow=slow, quick=1.0, jitter=0.1, each_s=each_s)
    assert {cost.runs for cost in found.values()} == {runs} and not are_apart([*found.values()])


class Scene:
    """A replacement of Scene that records its calls."""

    start = 7

    def __init__(self, done: list[str]) -> None:
        self.timebase = self
        self._done = done

    def ticks(self, seconds: Fraction, rounding: str) -> int:
        return int(seconds * 1000)

    def advance(self, until: int) -> None:
        self._done.append(f"advance to {until}")

    def run(self, length: Fraction) -> None:
        self._done.append(f"run {length}")


def test_cpu_time_includes_the_run_and_the_recording_but_not_the_start(monkeypatch: pytest.MonkeyPatch):
    done: list[str] = []

    @contextmanager
    def built(case: object, record: str) -> Iterator[Any]:
        done.append("build")
        yield Scene(done)
        done.append(f"write {record}")

    def clock() -> float:
        done.append("clock")
        return float(len(done))

    monkeypatch.setattr(trade, "built", built)
    monkeypatch.setattr(trade, "process_time", clock)
    seconds = trade._cpu_s(CASE, ".psr", Fraction(1, 10), Fraction(1, 2))
    assert done == ["build", "advance to 107", "clock", "run 1/2", "write .psr", "clock"]
    assert seconds == (6 - 3) / 0.5
