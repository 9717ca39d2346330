"""A controller whose period is shorter than a round: the rounds that did not begin are never left unsaid."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.scene.runs import TIMING

JUDGED = "budget=[{name='stretch', measure='stretch', max='1 ms'}, {name='missed', measure='missed rounds', max=99}]"


@pytest.mark.parametrize(("period", "missed"), [("5 ms", 0), ("1 ms", 12)])
def test_missed_rounds_that_no_budget_judges_are_noted(period: str, missed: int):
    changes = [f"controller.period='{period}'", "budget=[{name='stretch', measure='stretch', max='1 ms'}]"]
    result = Scene(load(TIMING / "responder.toml", changes)).run(Fraction(25, 1000))
    assert result.verdict == "pass" and result.counts["missed"] == missed
    assert result.notes == [
        "controller: 12 rounds that were due every 1000.000 us did not begin, because the one before was still "
        "running; a budget on 'missed rounds' judges that"
    ] * bool(missed)


def test_where_a_budget_judges_them_there_is_no_note():
    result = Scene(load(TIMING / "responder.toml", ["controller.period='1 ms'", JUDGED])).run(Fraction(25, 1000))
    assert result.counts["missed"] == 12 and result.notes == []
