"""`periph-sim bound` as a user meets it: sums in text and JSON, exit status, and cases without a closed form."""

from __future__ import annotations

import json

import pytest

from tests.board.runs import TIMING
from tests.commands.conftest import Run

CASE = str(TIMING / "imu_hil.toml")


def test_bounds_in_text_add_up(periph_sim: Run):
    came = periph_sim("bound", CASE, "--seconds", "0.1")
    assert came.status == 0 and came.err == ""
    first, _, head, *rest = came.out.splitlines()
    assert first == "imu_hil: the bounds hold; 0.1 s simulated beside them"
    assert head.split() == ["measure", "bound", "seen", "ratio", "values"]
    assert rest[0].split() == ["response", "<=", "5.000", "us", "5.000", "us", "1.000", "15"]
    text = came.out.split("\n\n")
    (round_,) = (block.splitlines() for block in text if block.startswith("round: at most"))
    cycles = [int(line.split()[0]) for line in round_[1:]]
    assert round_[0] == f"round: at most {sum(cycles) / 150:.3f} us"
    assert all("[" in line and line.endswith("]") for line in round_[1:])


def test_as_json_each_sum_is_that_of_its_terms(periph_sim: Run):
    told = json.loads(periph_sim("bound", CASE, "--seconds", "0.1", "--json").out)
    assert told["holds"] and told["hung"] == []
    assert [bound["measure"] for bound in told["bounds"]] == ["response", "round", "slack", "span:model", "age"]
    for bound in told["bounds"]:
        cycles = [term["cycles"] for term in bound["terms"]]
        assert bound["bound"]["cycles"] == pytest.approx(max([sum(cycles), *(f["cycles"] for f in bound["floor"])]))
        assert bound["holds"] and bound["ratio"] < 1.8 and bound["values"] > 0
    assert all(deadline["spare"]["us"] > 0 for deadline in told["deadlines"])


def test_a_deadline_that_may_be_missed_is_status_1(periph_sim: Run):
    came = periph_sim(
        "bound", CASE, "--set", "unit.dsp.settings.model_cost=17379 us", "--set", "controller.first=20 ms"
    )
    assert came.status == 1 and came.err == ""
    assert came.out.startswith("imu_hil: no bound: gyroscope asked up to ")
    assert "with model" in came.out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([str(TIMING / "uart_logger.toml")], "a bound of request and response needs a controller, which it has not"),
        ([str(TIMING / "late_model.toml")], "without a host the request of gyroscope is refused already"),
        ([CASE, "--seconds", "x"], "--seconds: 'x'"),
        ([CASE, "--set", "controller.perod=1 ms"], "did you mean period?"),
        (["nowhere.toml"], "nowhere.toml"),
    ],
)
def test_what_cannot_be_is_one_sentence(periph_sim: Run, arguments: list[str], sentence: str):
    came = periph_sim("bound", *arguments)
    assert came.status == 2 and came.out == ""
    assert came.err.count("\n") == 1 and sentence in came.err
