"""`periph-sim extremes`: tables, JSON, a picture, and refused arguments."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run

QUICK = ("extremes", "--arithmetic", "float64", "--arithmetic", "q16", "--only", "roll rate", "--samples", "100")


def test_tables_of_range_costs_and_extremes(periph_sim: Run) -> None:
    came = periph_sim(*QUICK)
    assert (came.status, came.err) == (0, "")
    assert "1789 to 1807" in came.out and "float64 in software" in came.out
    assert "roll rate  deg/s  full scale 2283  wraps 2283" in came.out
    assert "not explained" in came.out and "measured: 250 us, 37500 cycles" in came.out


def test_one_json_object(periph_sim: Run) -> None:
    found = json.loads(periph_sim(*QUICK, "--json").out)
    assert [one["name"] for one in found["arithmetics"]] == ["float64", "q16"]
    assert [one["happens"] for one in found["findings"]] == ["full scale", "wraps"]
    assert [one["guessed"] for one in found["arithmetics"]] == [True, False]
    assert found["arithmetics"][1]["operations"]["sincos"] == 5
    biases = [one for one in found["parameters"] if one["name"] == "gyroscope.bias"]
    assert biases == [
        {"name": "gyroscope.bias", "value": [-3.1, 3.6, 0.04], "unit": "deg/s", "source": "dissertation, Table 4.1"}
    ]


def test_a_picture_is_written_completely_or_not_at_all(periph_sim: Run, desk: Path) -> None:
    came = periph_sim(*QUICK, "--plot", "trade.svg")
    assert came.status == 0 and came.out.endswith("written: trade.svg\n")
    assert (desk / "trade.svg").read_text(encoding="utf-8").startswith("<?xml")
    assert periph_sim(*QUICK, "--plot", "nowhere/trade.svg").status == 2
    assert not list(desk.glob("**/.trade*"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--arithmetic", "float16"), "there is no arithmetic 'float16'; did you mean"),
        (("--arithmetic", "q20", "--samples", "100"), "gyroscope: -32768 does not fit Q20"),
        (("--only", "rol rate"), "there is no extreme 'rol rate'; did you mean roll rate"),
        (("--plot", "trade.png"), "trade.png: the picture is SVG"),
        (("--parameters", "none.toml"), "none.toml: cannot be read"),
        (("--samples", "1"), "--samples"),
        (("--seed", "-1"), "--seed"),
    ],
)
def test_wrong_arguments_give_one_sentence_and_status_2(
    periph_sim: Run, desk: Path, arguments: tuple, message: str
) -> None:
    came = periph_sim("extremes", *arguments)
    assert came.status == 2 and came.out == ""
    assert message in came.err and "Traceback" not in came.err


def test_tables_in_the_boot_rom_cost_a_wait_state_per_read(periph_sim: Run) -> None:
    came = periph_sim(*QUICK, "--tables", "boot ROM")
    assert "tables of the libraries are in boot ROM" in came.out
    assert "1829 to 1847" in came.out  # 5 sincos cost 4 more each, 2 atan2 6 more, 2 sqrt 4 more


def test_parameters_of_a_file_change_the_costs(periph_sim: Run, desk: Path) -> None:
    (desk / "turned.toml").write_text('[magnetometer]\nspherical = "rotation"\n', encoding="utf-8")
    came = periph_sim(*QUICK, "--parameters", "turned.toml")
    assert came.status == 0 and "1789 to 1807" not in came.out
