"""Derived records of a scene: each kind is produced where a budget asks for it, and as often as it happens."""

from __future__ import annotations

import pytest

from tests.scene.runs import run_file

BUDGET = 'budget=[{{name = "one", measure = "{}", max = {}}}]'


@pytest.mark.parametrize(
    ("measure", "limit", "count"),
    [
        (
            "value error of accelerometer",
            '"60 LSB"',
            3,
        ),  # one in each of three rounds, after the frames at 4, 24 and 44 ms
        ("value error of magnetometer at frame", '"20 LSB"', 3),
        ("model age", '"22 ms"', 9),  # three chips
        ("response", '"1 ms"', 9),
        ("round", '"3 ms"', 3),
    ],
)
def test_occurrences_are_recorded(measure: str, limit: str, count: int):
    (verdict,) = run_file("imu_moving", "0.05", BUDGET.format(measure, limit)).result.budgets
    assert verdict.count == count
