"""`periph-sim prove --questions`: a table or the phases are run again with other answers to open questions.

answers: default, AAS at the ninth fall, AAS at the eighth rise --> one table or coverage per answer
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pytest

from periph_sim.interfaces.reports.questions import explore
from periph_sim.interfaces.reports.questions.question import Question, questions_of
from periph_sim.scene.scene import Scene
from tests.interfaces.commands.conftest import Run
from tests.proof.proven_slave import write_slave
from tests.scene.runs import TIMING

TRIED = {"dsp.i2c.aas_sdir_point"}
NEAR = ("--phases", "0.30 ms to 0.31 ms", "--step", "997")


@pytest.fixture(autouse=True)
def few_questions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only one question is varied, because each answer takes a table or a coverage."""

    def some(scene: Scene, names: Iterable[str]) -> dict[str, Question]:
        return questions_of(scene, sorted(TRIED.intersection(names)))

    monkeypatch.setattr(explore, "questions_of", some)


def test_a_table_is_made_with_each_answer(periph_sim: Run, tmp_path: Path):
    """With AAS one bit later, the slave reads I2CSTR before AAS is set, and waits for an interrupt that never comes."""
    case = write_slave(tmp_path)
    status, shown = periph_sim.json("prove", str(case), "--table", "--questions", "--jobs", "1")
    assert (status, [one["answers"] for one in shown["runs"]]) == (
        1,
        [{}, {"dsp.i2c.aas_sdir_point": "rise8"}, {"dsp.i2c.aas_sdir_point": "fall9"}],
    )
    budgets = shown["budgets"]
    assert {name: one["verdict"] for name, one in budgets.items()} == {
        "wrong bytes": "proven", "reaction": "proven", "round": "proven", "slack": "seen",
    }  # fmt: skip
    assert [each["word"] for each in budgets["wrong bytes"]["departures"]] == ["broken"]
    assert shown["runs"][2]["first_difference"]["base"]["event"] == "dsp.I2C-A.I2CSTR.AAS set"
    assert shown["not_covered"]["load"] == "it is a share of a whole run"


def test_the_text_names_budgets_that_depend_on_an_answer_and_proven_ones(periph_sim: Run, tmp_path: Path):
    result = periph_sim("prove", str(write_slave(tmp_path)), "--table", "--questions", "--jobs", "1")
    text = " ".join(result.out.split())
    assert text.startswith("image_register_slave: 3 tables of 80 starts: the case as it is, 2 other answers one at a")
    assert "wrong bytes 0 650 proven as it is; [2]: broken (650)" in text
    assert "worst: of all these tables." in text
    assert "not covered: load: it is a share of a whole run" in result.out.splitlines()


def test_phases_are_run_with_each_answer(periph_sim: Run):
    """The worst values with the default answers are those of `prove` without --questions."""
    case = str(TIMING / "responder.toml")
    plain = periph_sim("prove", case, *NEAR, "--json").json_object["budgets"]
    result = periph_sim("prove", case, "--questions", "--jobs", "1", *NEAR)
    text = " ".join(result.out.split())
    assert result.status == 1
    assert text.startswith("responder: 3 coverages of 3 phases: the case as it is, 2 other answers one at a time")
    assert {name: one["worst"] for name, one in plain.items()} == {
        "wrong bytes": 0, "nacked rounds": 0, "missed rounds": 0,
    }  # fmt: skip
    assert "wrong bytes 0 640 depends on [2]: broken (640) nacked rounds 0 0 holds whatever the answers are" in text
    assert "[2] dsp.i2c.aas_sdir_point = fall9, not fall8 first difference: dsp.I2C-A.I2CSTR.AAS set: at" in text
    assert "holds: at these phases, in the states that their runs reached" in text


def test_a_case_without_a_table_is_refused(periph_sim: Run):
    case = str(TIMING / "responder.toml")
    assert periph_sim.refused("prove", case, "--table", "--questions", "--jobs", "1").startswith(
        f"{case}: it has no closed table: unit dsp runs Python firmware"
    )


@pytest.mark.parametrize("option", [["--save"], ["--witness", "."], ["--svg", "."], ["--cluster", "localhost:1"]])
def test_an_option_without_effect_is_refused(option: list[str], periph_sim: Run):
    assert f"{option[0]} has no effect with --questions; remove it" in periph_sim.refused(
        "prove", str(TIMING / "responder.toml"), "--questions", *option
    )
