"""The page lists for each statement what caught its mutants, and counts them."""

from __future__ import annotations

from tests.firmware_mutants.argued import ARGUMENTS, argument_of
from tests.firmware_mutants.page import page
from tests.firmware_mutants.trials import BROKEN, ENDED, MOVED, MOVED_IN_TIME, Trial, all_mutants

LINE = "pie.PIECTRL.ENPIE = 1"


def test_a_row_is_a_statement_and_a_cell_names_what_caught_the_mutant():
    mutants = [one for one in all_mutants("startup") if one.before == LINE][:5]
    kinds = [one.kind.split()[0] for one in mutants]
    assert kinds == ["deleted", "20", "300", "moved", "exchanged"]
    argument = argument_of(mutants[3])
    assert argument is not None
    trials = [
        Trial(mutants[0], "case", "data age", BROKEN),
        Trial(mutants[1], "case", "CPU load", MOVED),
        Trial(mutants[2], "case", "reaction", MOVED_IN_TIME),
        Trial(mutants[3]),
        Trial(mutants[4], "case", "NameError: no such name", ENDED),
    ]
    text = page({"startup": trials})
    number = ARGUMENTS.index(argument) + 1
    cells = f"**data age** | CPU load | reaction, *when* | [{number}] | *ends* |"
    assert f"| {mutants[0].line} | `{LINE}` | {cells}" in text
    assert "| `startup.py` | 5 | 1 | 1 | 1 | 1 | 1 | 0 | 100.0 % |" in text
    assert f" 5 of {len(all_mutants('startup'))} mutants were tried." in text
    assert f"\n{number}. {argument.why}" in text


def test_a_surviving_mutant_is_marked_in_its_cell():
    mutant = next(one for one in all_mutants("startup") if one.before == LINE)
    text = page({"startup": [Trial(mutant)]})
    assert f"`{LINE}` | SURVIVED |" in text and "| deleted | 1 | 0 | 0 | 0 | 0 | 0 | 1 | 0.0 % |" in text
