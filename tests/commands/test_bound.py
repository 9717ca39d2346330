"""`periph-sim bound` as a user meets it: sums in text and JSON, exit status, and cases without a closed form."""

from __future__ import annotations

import json

import pytest

from tests.commands.conftest import Run
from tests.scene.runs import TIMING
from tests.unwrapped import unwrapped

CASE = str(TIMING / "imu_hil_published.toml")


def test_calculated_values_in_text_add_up(periph_sim: Run):
    came = periph_sim("bound", CASE, "--seconds", "0.1", "--set", "host.first=7 ms")
    assert came.status == 1 and came.err == ""
    first, assumed, _, head, _, *rest = came.out.splitlines()
    assert first == "imu_hil_published: data age may break its limit, by 14.365 ms; 0.1 s simulated to compare"
    assert assumed == "assumes rates as received, no frame left out, no other interrupt, no dependence on data"
    assert head.split() == ["measure", "calculated", "seen", "ratio", "values"]
    assert rest[0].split() == ["response", "<=", "5.000", "us", "5.000", "us", "1.000", "15"]
    text = came.out.split("\n\n")
    (round_,) = (block.splitlines() for block in text if block.startswith("round: at most"))
    terms = [line for line in round_[1:] if line[10].isdigit()]  # not where one goes on
    cycles = [int(line.split()[0]) for line in terms]
    assert round_[0] == f"round: at most {sum(cycles) / 150:.3f} us"
    assert unwrapped(" ".join(round_)).count("]") == len(terms) and round_[-1].endswith("]")


KEPT = """
[[budget]]
name = "data age"
measure = "age"
max = "40 ms"
"""


def test_a_calculated_value_beyond_a_limit_is_status_1_and_within_it_0(periph_sim: Run, tmp_path):
    broken = (TIMING / "imu_hil_published.toml").read_text(encoding="utf-8")
    whole, _, _ = broken.partition('[[budget]]\nname = "data age"')
    case = tmp_path / "imu_hil.toml"
    case.write_text(whole + KEPT, encoding="utf-8")
    came = periph_sim("bound", str(case), "--seconds", "0.1")
    assert came.status == 0
    first = "imu_hil_published: calculated values are within their limits; 0.1 s simulated to compare"
    assert came.out.startswith(f"{first}\n")
    rows = {line[:17].strip(): line.split() for line in came.out.splitlines()}
    assert rows["data age"][2:7] == ["max", "40.000", "ms", "39.366", "ms"] and rows["data age"][-1] == "holds"
    assert float(rows["data age"][7]) == pytest.approx(633.9, abs=0.1)
    assert "  not calculated: wrong bytes (bytes are data, not times)\n" in came.out
    assert all(len(line) <= 80 for line in came.out.split("\n\n")[2].splitlines())
    case.write_text(whole + KEPT.replace("40", "39"), encoding="utf-8")
    assert periph_sim("bound", str(case), "--seconds", "0.1").status == 1
    told = json.loads(periph_sim("bound", str(case), "--seconds", "0.1", "--json").out)
    (age,) = (limit for limit in told["limits"] if limit["budget"] == "data age")
    assert told["holds"] and not told["passed"] and age["spare"]["us"] == pytest.approx(-366.1, abs=0.1)


def test_as_json_each_sum_is_that_of_its_terms(periph_sim: Run):
    told = json.loads(periph_sim("bound", CASE, "--seconds", "0.1", "--json").out)
    assert told["holds"] and told["hung"] == []
    measures = [bound["measure"] for bound in told["calculated"]]
    assert measures[:7] == ["response", "stretch", "margin of I2CDXR", "round", "slack", "span:model", "age"]
    for bound in told["calculated"]:
        unit = "count" if "count" in bound["calculated"] else "cycles"
        parts = [term[unit] for term in bound["terms"]]
        assert bound["calculated"][unit] == pytest.approx(max([sum(parts), *(f[unit] for f in bound["floor"])]))
        assert bound["holds"] and (bound["ratio"] or 1) < 6
    counts = {one["measure"]: one["seen"]["count"] for one in told["calculated"] if "count" in one["calculated"]}
    assert counts == {"fifo high-water": 12, "overruns": 0, "missed rounds": 0, "nacked rounds": 0}
    assert all(deadline["spare"]["us"] > 0 for deadline in told["deadlines"])


def test_a_deadline_that_may_be_missed_is_status_1(periph_sim: Run):
    came = periph_sim(
        "bound", CASE, "--set", "unit.dsp.settings.model_cost=17379 us", "--set", "controller.first=20 ms"
    )
    assert came.status == 1 and came.err == ""
    assert came.out.startswith("imu_hil_published: nothing calculated: gyroscope asked up to ")
    assert "with model" in came.out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([str(TIMING / "uart_logger.toml")], "bounds count from a controller's requests, and there is no [controller]"),
        (
            [str(TIMING / "late_model.toml")],
            "even without a host gyroscope does not acknowledge its request at 5000.000 us",
        ),
        ([CASE, "--seconds", "x"], "--seconds: 'x'"),
        ([CASE, "--set", "controller.perod=1 ms"], "did you mean period?"),
        (["nowhere.toml"], "nowhere.toml"),
    ],
)
def test_what_cannot_be_is_one_sentence(periph_sim: Run, arguments: list[str], sentence: str):
    came = periph_sim("bound", *arguments)
    assert came.status == 2 and came.out == ""
    assert came.err.count("\n") == 1 and sentence in came.err
