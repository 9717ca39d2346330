"""`periph-sim trade`: one screen, JSON and error messages."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run

TIMING = Path(__file__).resolve().parents[3] / "timing"
RESPONDER = str(TIMING / "responder.toml")
QUICK = ("trade", RESPONDER, "--seconds", "0.02", "--row", "record .psr")


def test_a_trade_is_one_screen_and_its_last_line_recommends_a_row(periph_sim: Run):
    out = periph_sim.passes("trade", str(TIMING / "imu_hil_published.toml"), "--seconds", "0.05")
    lines = out.splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    text = " ".join(out.split())
    assert text.startswith("imu_hil_published: 50 ms, n-th occurrence and value against n-th of as given; ")
    assert "runs of 25 ms after the first 25 ms" in text
    rows = ["as given", "record .psr", "record .vcd"]
    assert [line.strip()[: len(row)] for row, line in zip(rows, lines[6:], strict=False)] == rows
    assert " recommended: " in text and text.index(" recommended: ") > text.rindex(" record .vcd ")


def test_json_is_one_object_with_every_row(periph_sim: Run):
    report = periph_sim(*QUICK, "--json").json_object
    assert [row["name"] for row in report["rows"]] == ["as given", "record .psr"]
    assert report["rows"][1]["time_error"] == {"amount": 0.0, "unit": "s", "place": ""}
    assert all(row["cost"]["cpu_s"] > 0 and row["cost"]["runs"] >= 5 for row in report["rows"])
    assert report["recommended"] == "as given" and (report["start_s"], report["timed_s"]) == (0.01, 0.01)


def test_a_table_is_a_row_of_a_case_that_has_one(periph_sim: Run):
    slave = str(TIMING / "variants" / "image_register_slave.toml")
    budget = 'budget=[{name="reaction", measure="reaction", max="1 us", coverage="40 %"}]'
    arguments = ("--row", "table", "--seconds", "0.02", "--json")
    report = periph_sim("trade", slave, "--set", budget, *arguments).json_object
    assert (report["table"]["budgets"], report["table"]["error"]["amount"], report["refused"]) == (["reaction"], 0, {})
    report = periph_sim("trade", slave, *arguments).json_object
    assert report["table"] is None and report["refused"]["table"].startswith("no budget has values: wrong bytes: ")
    report = periph_sim("trade", RESPONDER, *arguments).json_object
    assert report["table"] is None and report["refused"]["table"].startswith("unit dsp runs Python firmware")
    assert periph_sim(*QUICK, "--json").json_object["refused"] == {}


def test_rows_may_be_named_by_the_old_option(periph_sim: Run):
    report = periph_sim("trade", RESPONDER, "--seconds", "0.02", "--level", "record .psr", "--json").json_object
    assert [row["name"] for row in report["rows"]] == ["as given", "record .psr"]


def test_a_row_with_too_large_an_error_is_not_recommended(periph_sim: Run):
    published, image = (str(TIMING / f"imu_hil_{name}.toml") for name in ("published", "image"))
    row = ("--row", "Python of imu_hil_published", "--seconds", "0.04", "--json")
    result = periph_sim("trade", image, "--firmware", published, "--max-error", "1 us", *row).json_object
    assert result["rows"][1]["time_error"]["amount"] > 1e-6 and result["recommended"] == "as given"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((RESPONDER, "--max-error", "1"), "--max-error: '1' has no unit; write for instance"),
        ((RESPONDER, "--max-error", "-1 us"), "--max-error: '-1 us' is negative"),
        ((RESPONDER, "--row", "as givn"), "there is no row 'as givn' of this case; did you mean as given?"),
        ((RESPONDER, "--firmware", "nowhere.toml"), "nowhere.toml"),
        ((RESPONDER, "--seconds", "long"), "--seconds: "),
        ((RESPONDER, "--seconds", "0"), "nothing to compare: no budget is judged and nothing is read on I2C"),
        ((RESPONDER, "--set", "duraton=1 s"), "duraton"),
        (("nowhere.toml",), "nowhere.toml"),
    ],
)
def test_bad_input_is_one_error_message_with_status_2(
    periph_sim: Run, desk: Path, arguments: tuple[str, ...], message: str
):
    assert message in periph_sim.refused("trade", *arguments)
