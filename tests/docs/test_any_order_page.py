"""docs/any_order.md: the figures of its table."""

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


def test_the_highest_rates_are_those_of_the_table() -> None:
    highest = [next(row[0] for row in reversed(ROWS) if row[column] == "right") for column in (4, 8)]
    told = f"The highest rate that was right is {highest[0]}, and {highest[1]} with the most expensive code"
    assert told in PAGE.read_text()


@pytest.mark.uncounted
@pytest.mark.parametrize("rate", RATES if explores() else ("400 kHz",))
def test_the_table_says_what_is_measured(rate: str) -> None:
    found = {row[0]: row[1:] for row in ROWS}
    assert figures(rate, HIGHEST) == found[rate][4:]
    if explores():
        assert figures(rate, USUAL) == found[rate][:4]


def test_the_table_is_made_anew_rate_by_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits_table, "figures", lambda rate, code: ["measured"] * 4)
    fresh = TABLE.findall(refreshed_limits(PAGE.read_text()))[0].splitlines()
    assert fresh == [f"| {rate} | {' | '.join(['measured'] * 8)} |" for rate in RATES]
    assert [row[0] for row in ROWS] == list(RATES)
    assert refreshed_limits("no table") == "no table"
