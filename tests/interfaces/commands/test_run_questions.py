"""`run --questions`: the report, its exit status, JSON and rejected input."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.interfaces.reports.questions import text_report
from tests.interfaces.commands.conftest import Run
from tests.interfaces.reports.questions.small import CASE, LATE, written

HERE = ("run", "small.toml", "--questions", "--jobs", "1")
BROKEN = ("--set", "budget.work.max=183.333 ns")  # 27.5 cycles
GATE = "dsp.sci.clock_gate_access"


@pytest.fixture(autouse=True)
def folder(here: Path) -> None:
    written(Path())


def test_all_budgets_hold_whatever_the_answers_are(periph_sim: Run) -> None:
    out = periph_sim.passes(*HERE)
    assert " work     1 us  0.280 us  holds whatever the answers are" in out.splitlines()
    assert " ".join(out.split()).startswith(
        "small: 24 runs of 20.000 us: the case as it is, 8 other answers one at a time, and 15 pairs, to 5 open "
        "questions"
    )
    assert "Other combinations were not tried." in " ".join(out.split()) and "first difference" not in out


def test_a_budget_that_depends_on_an_answer_is_explained(periph_sim: Run) -> None:
    result = periph_sim(*HERE, *BROKEN)
    lines = result.out.splitlines()
    assert result.status == 1 and max(map(len, lines)) <= 80
    message = " ".join(result.out.split())
    assert "depends on [7]: broken (0.193 us); [15]: broken (0.187 us)" in message
    assert (
        "[7] dsp.system.pf2_write_ws = 15, not 0 first difference: dsp: SCI-A.SCIHBAUD written, 0x0007 at main:5: "
        "at 0.100 us as it is, at 0.200 us with this answer"
    ) in message
    assert "[15] dsp.system.pf2_read_ws = 15, not 2; dsp.system.pf2_write_ws = 1, not 0 first difference:" in message
    assert "at 0.187 us with the first alone, at 0.193 us with both" in message
    assert lines[lines.index("Questions to decide, and how:") + 1].startswith("  dsp.system.pf2_write_ws: What does a")
    assert message.endswith("Measure a row of reads with a CPU timer.")


def test_a_broken_budget_shows_the_answers_under_which_it_holds(periph_sim: Run) -> None:
    result = periph_sim(*HERE, "--set", "budget.work.max=90 ns")
    assert result.status == 1 and "broken as it is; [2]: holds (0.080 us)" in result.out
    result = periph_sim(*HERE, "--set", "budget.work.max=10 ns")
    assert result.status == 1 and "broken whatever the answers are" in result.out


def test_a_question_that_is_not_varied_is_named(periph_sim: Run) -> None:
    written(Path(), CASE + LATE)
    result = periph_sim(*HERE)
    assert result.status == 1 and "dsp.sci.brr_write_effect" in result.out.partition("Not varied, because")[2]
    assert "nothing as it is; dsp.SCI-A.SCIHBAUD" in " ".join(result.out.split())


def test_more_runs_than_can_be_named_are_counted(periph_sim: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text_report, "MOST_NAMED", 1)
    monkeypatch.setattr("periph_sim.interfaces.reports.questions.first_difference.MOST_EXPLAINED", 1)
    message = periph_sim(*HERE, *BROKEN).out
    assert "depends on [7]: broken (0.193 us); 1 more" in " ".join(message.split())
    assert "1 more run with other verdicts; --json lists them" in message and "[15]" not in message


def test_json_has_every_run_and_the_differences(periph_sim: Run) -> None:
    status, report = periph_sim.json(*HERE, *BROKEN)
    assert status == 1 and report["schema"] == "periph-sim run --questions"
    assert report["runs"][0] == {"answers": {}, "verdict": "pass", "first_difference": None}
    assert report["runs"][7]["answers"] == {"dsp.system.pf2_write_ws": 15} and report["runs"][7]["verdict"] == "fail"
    first = report["runs"][7]["first_difference"]
    assert first["base"]["at_s"] == pytest.approx(0.1e-6) and first["other"]["at_s"] == pytest.approx(0.2e-6)
    work = report["budgets"]["work"]
    assert (work["holds"], work["verdict"], work["unit"]) == (False, "seen", "us")
    assert work["departures"][0] == {"number": 7, "word": "broken", "found": "0.193 us"}
    assert report["questions"][GATE] == {
        "question": "What a CPU access does while the module's clock is off.",
        "experiment": "Read a register with the module's clock off.",
        "registers": [],
        "default": "reads_0",
        "others": ["accessible"],
    }


def test_the_output_is_the_same_with_any_number_of_workers(periph_sim: Run) -> None:
    one, two = (periph_sim("run", "small.toml", "--questions", *BROKEN, "--jobs", jobs) for jobs in ("1", "2"))
    assert one == two and one.status == 1


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (
            ("--questions", "--record", "a.psr"),
            "--record is for one run, and --questions makes many; leave one of them out",
        ),
        (("--questions", "--html", "a.html"), "--html is for one run"),
        (("--questions", "--explain"), "--explain is for one run"),
        (("--questions", "-v"), "--verbose is for one run"),
        (("--jobs", "2"), "--jobs needs --questions, since a single run takes one process; leave it out"),
        (("--questions", "--set", "budgets.x=1"), "there is no key 'budgets'"),
        (("--questions", "--set", "unit.dsp.firmware=none.py"), "there is no firmware file 'none.py'"),
        (("--questions", "--set", "budget=[]"), "the case has no budget that an answer could break"),
    ],
)
def test_a_contradiction_of_options_is_one_error_message(
    periph_sim: Run, arguments: tuple[str, ...], sentence: str
) -> None:
    assert sentence in periph_sim.refused("run", "small.toml", *arguments)
    assert not Path("a.psr").exists() and not Path("a.html").exists()
