"""Sentences about changed figures, from two baselines of a budget."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.interfaces.reports.baselines.compare import compare, explain, moved_accesses
from periph_sim.interfaces.reports.baselines.event_chain import PART, EventLine, Wanted
from periph_sim.interfaces.reports.baselines.files import Baseline, Figures
from periph_sim.interfaces.reports.baselines.outcome import occurrence

MS = 3_000_000  # ticks
CHAIN = ["0 START", "100 W"]


def case(budgets: dict[str, dict[str, Any]], **more: Any) -> Baseline:
    """Build a baseline of time budgets, each with a worst and a least occurrence, and these figures besides defaults.

    A cycle is 20 ticks.
    """
    usual = {"measure": "it", "unit": "time", "count": 3, "worst": 200, "worst_at": 60, "least": 100, "least_at": 90}
    figures = {name: Figures(**{**usual, "chain_of": "worst", "chain": [], **given}) for name, given in budgets.items()}
    one = {"case": "one", "simulated": 6000, "ticks_per_second": 3_000_000_000, "ticks_per_cycle": 20, "events": 1}
    return Baseline(**{**one, "counts": {}, "budgets": figures, **more})


def changed(before: Baseline, now: Baseline, tolerance: int = 0) -> list[str]:
    return [f"{change.text}{' (note)' if change.note else ''}" for change in compare(before, now, tolerance)]


@pytest.mark.parametrize(
    ("unit", "was", "result", "expected"),
    [
        ("time", 200, 300, "b worst 10 -> 15 cycles"),
        ("count", 2, 3, "b worst 2 -> 3"),
        ("words", 2, 3, "b worst 2 -> 3 words"),
        ("%", 1255, 1452, "b worst 0.1255 -> 0.1452 %"),
        ("LSB", 1_500_000, 2_000_000, "b worst 1.500000 -> 2.000000 LSB"),
    ],
)
def test_a_changed_value_is_reported_with_its_unit(unit: str, was: int, result: int, expected: str):
    assert changed(case({"b": {"unit": unit, "worst": was}}), case({"b": {"unit": unit, "worst": result}})) == [
        expected
    ]


@pytest.mark.parametrize(
    ("figure", "now", "expected"),
    [
        ("case", "two", "case one -> two"),
        ("simulated", 6001, "simulated 6000 -> 6001"),
        ("ticks_per_second", 1, "ticks_per_second 3000000000 -> 1"),
        ("ticks_per_cycle", 10, "ticks_per_cycle 20 -> 10"),
        ("events", 2, "events 1 -> 2 (note)"),
        ("counts", {"sci_bytes": 5}, "sci bytes 0 -> 5"),
        ("counts", {"polls_skipped": 5}, "polls skipped 0 -> 5 (note)"),
    ],
)
def test_changed_figures_of_the_case_are_reported(figure: str, now: Any, expected: str):
    assert changed(case({}), case({}, **{figure: now})) == [expected]


def test_a_missing_count_is_reported_as_0():
    assert changed(case({}, counts={"nacks": 2, "starts": 1}), case({}, counts={"starts": 1})) == ["nacks 2 -> 0"]


def test_new_and_removed_budgets_are_reported():
    expected = ["new: a new budget, not in the baseline", "gone: in the baseline, but not a budget of the case"]
    assert changed(case({"gone": {}, "same": {}}), case({"new": {}, "same": {}})) == expected


@pytest.mark.parametrize(
    ("before", "now", "expected", "kept"),
    [
        (["a", "b"], ["a", "c"], f"first among bytes {PART + 1} to {2 * PART} of the run", ("b", "c")),
        (["a", "b"], ["c", "d"], f"first among bytes 1 to {PART} of the run", ("a", "c")),
        (["a"], ["a", "b"], f"first among bytes {PART + 1} to {2 * PART} of the run", ("none", "b")),
        (["a", "b"], ["a"], f"first among bytes {PART + 1} to {2 * PART} of the run", ("b", "none")),
        ([], ["a", "b"], "--update-baseline adds them", (None, "a")),
    ],
)
def test_the_first_part_of_the_bus_bytes_that_differs_is_reported(
    before: list[str], now: list[str], expected: str, kept: tuple[str | None, str]
):
    (change,) = compare(case({}, bus_bytes=before), case({}, bus_bytes=now))
    assert change.text.endswith(expected) and change.note == (not before)
    assert (change.before, change.now) == kept
    assert compare(case({}, bus_bytes=now), case({}, bus_bytes=now)) == []


@pytest.mark.parametrize(
    ("now", "tolerance", "expected"),
    [
        ({}, 0, []),
        ({"measure": "that"}, 0, ["b measure it -> that"]),
        ({"unit": "words"}, 0, ["b unit time -> words"]),
        ({"worst": 220, "count": 4}, 0, ["b worst 10 -> 11 cycles", "b count 3 -> 4"]),
        ({"worst": 220}, 1, []),
        ({"worst": 221}, 1, ["b worst 10 -> 11.05 cycles"]),
        ({"worst": 180}, 1, []),
        ({"worst": 179}, 1, ["b worst 10 -> 8.95 cycles"]),
        ({"worst": 240}, 1, ["b worst 10 -> 12 cycles"]),
        ({"worst_at": 80}, 0, ["b worst at 3 -> 4 cycles"]),
        ({"worst_at": 8000}, 1, []),
        ({"worst": None}, 1, ["b worst 10 cycles -> nothing measured"]),
        ({"worst_at": None}, 0, ["b worst at 3 cycles -> never"]),
        ({"count": 4}, 1, ["b count 3 -> 4"]),
    ],
)
def test_changed_figures_of_a_budget_beyond_the_tolerance_are_reported(
    now: dict[str, Any], tolerance: int, expected: list[str]
):
    assert changed(case({"b": {}}), case({"b": now}), tolerance) == expected


NUMBER = {"unit": "words", "count": 7, "worst": 7, "worst_at": 60, "least": 7, "least_at": 60}


@pytest.mark.parametrize(
    ("before", "now", "expected"),
    [
        ({}, {"count": 8, "worst": 8, "least": 8}, "worst"),  # a count is its only number
        ({}, {"worst": 8, "least": 8}, "worst"),
        ({}, {"count": 8}, "count"),
        ({"count": 2}, {"count": 8, "worst": 8, "least": 8}, "worst, count"),
        ({}, {"count": 8, "worst": 8}, "worst, count"),
        ({}, {"count": 8, "worst": 8, "least": 8, "least_at": 90}, "worst, least, least at, count"),
        ({"least": 5}, {"count": 8, "worst": 8, "least": 8}, "worst, least, count"),
        ({"unit": "time"}, {"unit": "time", "count": 8, "worst": 8, "least": 8}, "worst, least, count"),
    ],
)
def test_a_changed_number_of_a_budget_is_reported_once(before: dict[str, Any], now: dict[str, Any], expected: str):
    changes = compare(case({"b": NUMBER | before}), case({"b": NUMBER | now}))
    assert ", ".join(change.figure.replace("_", " ") for change in changes) == expected


def why(before: dict[str, Any], now: dict[str, Any], first_wrong: str = "") -> dict[str, str]:
    """Return the explanations by figure."""
    then, result = case({"b": before}), case({"b": now})
    changes = compare(then, result)
    explain(changes, then, result, first_wrong)
    return {change.figure: change.why for change in changes}


LATER, MOVED = ["0 START", "140 W"], "W 2 cycles later"


@pytest.mark.parametrize(
    ("before", "now", "expected"),
    [
        ({"chain": CHAIN}, {"worst": 240, "least": 80, "chain": LATER}, {"worst": MOVED, "least": ""}),
        ({"chain": CHAIN}, {"worst": 240, "chain": CHAIN}, {"worst": "no event of its chain moved"}),
        (
            {"chain": CHAIN, "chain_of": "least"},
            {"worst": 240, "least": 80, "chain": LATER, "chain_of": "least"},
            {"worst": "", "least": MOVED},
        ),
        ({"chain": CHAIN, "chain_of": "least"}, {"worst": 240, "chain": LATER}, {"worst": ""}),
        ({"chain": CHAIN}, {"worst": 240}, {"worst": ""}),
        ({}, {"worst": 240, "chain": CHAIN}, {"worst": "first at 0.000020 ms; in the baseline there was none"}),
        (
            {"chain_of": "least"},
            {"least": 80, "chain": CHAIN, "chain_of": "least"},
            {"least": "first at 0.000030 ms; in the baseline there was none"},
        ),
        ({"worst_at": None}, {"worst": 240, "worst_at": None, "chain": CHAIN}, {"worst": ""}),
    ],
)
def test_a_worst_value_is_explained_by_its_chain(before: dict[str, Any], now: dict[str, Any], expected: dict[str, str]):
    assert why(before, now) == expected


def test_the_first_wrong_byte_explains_wrong_bytes_where_there_were_none():
    wrong = {"measure": "wrong bytes", "unit": "bytes", "least": 200, "least_at": 60, "chain": CHAIN}
    now = wrong | {"worst": 3, "least": 3}
    assert why(wrong | {"worst": 0, "least": 0}, now, "byte 7")["worst"] == "byte 7"
    assert why(wrong | {"worst": 0, "least": 0}, now)["worst"] == "no event of its chain moved"
    assert why(wrong | {"worst": 1, "least": 1}, now, "byte 7")["worst"] == "no event of its chain moved"
    other = {"measure": "errors"}
    assert (
        why(wrong | other | {"worst": 0, "least": 0}, now | other, "byte 7")["worst"] == "no event of its chain moved"
    )


def test_changes_of_new_and_removed_budgets_and_of_the_case_are_not_explained():
    then, now = case({"gone": {"chain": CHAIN}}), case({"new": {"chain": LATER}}, events=2)
    changes = compare(then, now)
    explain(changes, then, now, "byte 7")
    assert [change.why for change in changes] == [""] * 3
    assert str(changes[-1]) == "events 1 -> 2"
    changes[-1].why = "it is so"
    assert str(changes[-1]) == "events 1 -> 2: it is so"


def moved(before: dict[str, Any], now: dict[str, Any], tolerance: int = 0, lines: list[str] = LATER) -> list[str]:
    chain = {"b": EventLine(lines, [""] * len(lines))}
    return [str(one) for one in moved_accesses(case({"b": before}), case({"b": now}), chain, tolerance)]


HOLDS = [f"b holds, but an access moved: {MOVED}"]


@pytest.mark.parametrize(
    ("before", "now", "expected"),
    [
        ({"chain": CHAIN}, {}, HOLDS),
        ({}, {}, []),
        ({"chain": CHAIN}, {"measure": "that"}, []),
        ({"chain": CHAIN}, {"chain_of": "least"}, []),
        ({"chain": CHAIN}, {"worst_at": None}, []),
        ({"chain": CHAIN, "worst_at": None}, {}, []),
        ({"chain": CHAIN}, {"worst_at": 60 + 3 * MS - 1}, []),
        ({"chain": CHAIN}, {"worst_at": 60 + MS - 1}, HOLDS),  # the same occurrence, since it moved by less than 1 ms
        ({"chain": CHAIN, "worst_at": 60 + MS - 1}, {}, HOLDS),
        ({"chain": CHAIN}, {"worst_at": 60 + MS}, []),
        ({"chain": CHAIN, "chain_of": "least"}, {"chain_of": "least", "worst_at": 3 * MS}, HOLDS),
    ],
)
def test_a_moved_access_is_reported_if_the_figures_hold(
    before: dict[str, Any], now: dict[str, Any], expected: list[str]
):
    assert moved(before, now) == expected


@pytest.mark.parametrize(("tolerance", "expected"), [(0, HOLDS), (1, HOLDS), (2, [])])
def test_an_access_may_move_by_the_tolerance(tolerance: int, expected: list[str]):
    assert moved({"chain": CHAIN}, {}, tolerance) == expected


def test_each_moved_access_is_reported_once_and_at_most_three_per_case():
    def chains(*later: int) -> dict[str, EventLine]:
        return {f"b{n}": EventLine(["0 START", f"{100 + 20 * by} W"], ["", ""]) for n, by in enumerate(later)}

    budgets = case({f"b{n}": {"chain": CHAIN} for n in range(6)})
    expected = moved_accesses(budgets, budgets, chains(1, 1, 2, 0, 3, 4))
    assert [(one.budget, one.text.rpartition("W ")[2]) for one in expected] == [
        ("b0", "1 cycle later"),
        ("b2", "2 cycles later"),
        ("b4", "3 cycles later"),
    ]
    unknown = case({"b1": {}})
    assert moved_accesses(budgets, unknown, chains(1)) == moved_accesses(unknown, budgets, chains(1)) == []


@pytest.mark.parametrize(
    ("figures", "wanted"),
    [
        ({}, Wanted("it", 60, 200)),
        ({"chain_of": "least"}, Wanted("it", 90, 100)),
        ({"unit": "words"}, Wanted("it", 60, 0)),
        ({"worst": None}, None),
        ({"worst_at": None}, None),
        ({"chain_of": "least", "worst": None, "worst_at": None}, Wanted("it", 90, 100)),
    ],
)
def test_the_chain_explains_the_occurrence_that_the_limit_concerns(figures: dict[str, Any], wanted: Wanted | None):
    assert occurrence(case({"b": figures}).budgets["b"]) == wanted
