"""A case without the budgets that a single phase cannot break."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim import BadCase
from periph_sim.proof.stretch import PERCENTILE, CoveredCase, Job
from tests.proof.pair_cases import write_lonely

BUDGETS = {
    "percentile": 'measure = "age"\np95 = "1 s"',
    "both": 'measure = "age"\np95 = "1 s"\nmax = "2 s"',
    "share": 'measure = "cpu load"\nmax = "40 %"',
    "some": 'measure = "overruns"\nmax = 3',
    "none": 'measure = "overruns"\nmax = 0',
    "value": 'measure = "round"\nmax = "1 s"',
}


def covered(folder: Path, *names: str) -> CoveredCase:
    """Return the case of `write_lonely` with these budgets only."""
    path = write_lonely(folder)
    text, _, _ = path.read_text(encoding="utf-8").partition("[[budget]]")
    budgets = [f'[[budget]]\nname = "{name}"\n{BUDGETS[name]}\n' for name in names]
    path.write_text(text + "".join(budgets), encoding="utf-8")
    return CoveredCase(Job(str(path)))


def test_a_budget_that_no_single_phase_can_break_is_left_out(tmp_path: Path) -> None:
    found = covered(tmp_path, *BUDGETS)
    assert [budget.name for budget in found.case.budget] == ["both", "none", "value"]
    assert all(budget.p95 is None for budget in found.case.budget)
    not_whole = {
        "percentile": PERCENTILE,
        "both": PERCENTILE,
        "share": "it is a share of a whole run",
        "some": "it counts the events of a whole run",
    }
    assert found.not_whole == not_whole
    left_out = {name: reason for name, reason in not_whole.items() if name != "both"}
    assert found.left_out == left_out | {"p95 of both": PERCENTILE}


def test_a_case_whose_budgets_are_all_left_out_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadCase, match=r"no budget that a single round .* \(share: it is a share of a whole run\)"):
        covered(tmp_path, "share")
