"""The closed table as a row of a trade: which cases have it, its error against a run, and the budgets left out."""

from __future__ import annotations

from dataclasses import asdict
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from periph_sim.interfaces.reports.trade import table_row
from periph_sim.interfaces.reports.trade.observe import Error
from periph_sim.interfaces.reports.trade.rows import HAS_TABLE, rows_of
from periph_sim.interfaces.reports.trade.table_row import Tabulated, tabulated
from periph_sim.interfaces.reports.trade.trade import as_json, text, trade
from periph_sim.proof.scenarios import Scenarios
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from tests.proof.proven_slave import write_slave
from tests.scene.runs import TIMING

REACTION = """
[[budget]]
name = "reaction"
measure = "reaction"
max = "1 us"
coverage = "40 %"
"""


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw few seeds only."""
    monkeypatch.setattr(table_row, "SEEDS", 20)


def made(case: Path, *changes: str) -> Tabulated:
    return tabulated(case, changes, load(case, changes))


def test_the_table_agrees_with_a_run_and_names_what_it_leaves_out(tmp_path: Path):
    case = write_slave(tmp_path, REACTION)
    table = made(case, "controller.rounds=7")
    assert (table.budgets, table.moved, table.rounds) == (("reaction",), "rounds", 7)
    assert table.error == Error(0.0, "s", "reaction")  # this budget was compared
    assert table.left_out == {"wrong bytes": "it has one number for the whole run"}
    found = trade(
        lambda changes: load(case, changes), [*rows_of(lambda changes: load(case, changes), [])[:1]], Fraction(1, 50)
    )
    lines = "\n".join(text(found, table))
    (row,) = (line.split() for line in lines.splitlines() if line.startswith(" table "))
    assert row[:6] == ["table", "1", "of", "2", "none", "-"]
    assert "worst values in 7 rounds of 20 seeds" in " ".join(lines.split())
    assert "\ntable leaves out wrong bytes: it has one number for the whole run\n" in lines
    assert as_json(found, table)["table"] == asdict(table)
    assert (as_json(found)["table"], found.best.row.name) == (None, "as given")


def test_a_value_that_differs_from_the_run_is_its_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    right = Scenarios.values

    def wrong(self: Scenarios, starts: NDArray[np.int64]) -> dict[str, NDArray[np.float64]]:
        found = right(self, starts)
        found["reaction"][0, 3] -= 2.5
        return found

    monkeypatch.setattr(Scenarios, "values", wrong)
    error = made(write_slave(tmp_path, REACTION)).error
    assert (round(error.amount, 10), error.place) == (2.5e-6, "reaction")


def test_a_table_without_a_value_is_refused(tmp_path: Path):
    with pytest.raises(BadCase, match=r"^no budget has values: wrong bytes: it has one number for the whole run$"):
        made(write_slave(tmp_path, ""))


@pytest.mark.parametrize(
    ("case", "reason"),
    [
        ("variants/image_register_slave", ""),
        ("responder", "unit dsp runs Python firmware, "),
        ("imu_hil_image", "rounds and frames start independently of each other"),
        ("variants/image_blink", "no start is free"),
    ],
)
def test_the_row_exists_for_cases_with_a_table(case: str, reason: str):
    (row,) = (row for row in rows_of(lambda _: load(TIMING / f"{case}.toml"), []) if row.name == "table")
    assert reason in row.missing
    assert (row == HAS_TABLE) == (not reason)
