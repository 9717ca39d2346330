"""What a figure that changed is told as: two baselines of one budget go in, the sentence comes out."""

from __future__ import annotations

import pytest

from periph_sim.reports.baselines.compare import compare
from periph_sim.reports.baselines.figures import Baseline, Figures


def baseline(unit: str, worst: int) -> Baseline:
    """One budget, of which `worst` is the only number; a cycle is 20 ticks."""
    figures = Figures(
        measure="it", unit=unit, count=1, worst=worst, worst_at=60, least=worst, least_at=60, chain_of="worst", chain=[]
    )
    return Baseline(
        case="one", simulated=6000, ticks_per_second=3_000_000_000, ticks_per_cycle=20, events=1, counts={},
        budgets={"b": figures},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("unit", "was", "came", "told"),
    [
        ("time", 200, 300, "b worst 10 -> 15 cycles"),
        ("count", 2, 3, "b worst 2 -> 3"),
        ("words", 2, 3, "b worst 2 -> 3 words"),
        ("%", 1255, 1452, "b worst 0.1255 -> 0.1452 %"),
        ("LSB", 1_500_000, 2_000_000, "b worst 1.500000 -> 2.000000 LSB"),
    ],
)
def test_a_changed_value_is_told_with_its_unit(unit: str, was: int, came: int, told: str):
    changes = compare(baseline(unit, was), baseline(unit, came))
    assert changes[0].text == told
