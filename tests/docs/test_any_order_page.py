"""The figures of the table in docs/any_order.md."""

from __future__ import annotations

import pytest

from tests.docs import limits_table
from tests.docs.limits_table import HIGHEST, RATES, TABLE, USUAL, figures, refreshed_limits
from tests.docs.pages import ROOT
from tests.profiles import explores

PAGE = ROOT / "docs" / "any_order.md"
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")] for line in TABLE.findall(PAGE.read_text())[0].splitlines()
]


def test_the_text_names_the_highest_rates_of_the_table() -> None:
    highest = [next(row[0] for row in reversed(ROWS) if row[column] == "right") for column in (4, 8)]
    text = f"The highest rate that was right is {highest[0]}, and {highest[1]} with the most expensive code"
    assert text in PAGE.read_text()


@pytest.mark.uncounted
@pytest.mark.parametrize("rate", RATES if explores() else ("400 kHz",))
def test_the_table_has_the_measured_figures(rate: str) -> None:
    found = {row[0]: row[1:] for row in ROWS}
    assert figures(rate, HIGHEST) == found[rate][4:]
    if explores():
        assert figures(rate, USUAL) == found[rate][:4]


def test_every_row_of_the_table_is_measured_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits_table, "figures", lambda rate, code: ["measured"] * 4)
    fresh = TABLE.findall(refreshed_limits(PAGE.read_text()))[0].splitlines()
    assert fresh == [f"| {rate} | {' | '.join(['measured'] * 8)} |" for rate in RATES]
    assert [row[0] for row in ROWS] == list(RATES)
    assert refreshed_limits("no table") == "no table"
