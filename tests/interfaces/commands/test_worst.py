"""`periph-sim worst` and `run --explain`: text, JSON, pictures, exit status and error messages."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree as xml

import pytest

from tests.interfaces.commands.conftest import Run
from tests.unwrapped import unwrapped

LATE = ("--seconds", "130 ms", "--set", "unit.dsp.settings.frame_cost=200 us", "--set", "host.first=4.24 ms")


@pytest.fixture
def case(desk: Path) -> str:
    """Copy the case imu_hil_published to the working folder and return its name."""
    text = (Path(__file__).parents[3] / "timing" / "imu_hil_published.toml").read_text(encoding="utf-8")
    (desk / "imu_hil.toml").write_text(text, encoding="utf-8")
    return "imu_hil.toml"


def test_all_budgets_are_explained_and_drawn(periph_sim: Run, case: str):
    result = periph_sim("worst", case, *LATE)
    assert (result.status, result.err) == (1, "")
    assert re.search(r"^stretch 9\d\.\d{3} us, at most 50\.000 us allowed, at 0\.\d{6} s$", result.out, re.MULTILINE)
    assert "v stretch: worst begins" in result.out and "span    [" in result.out
    assert "nacked rounds: 0: it never happened\n" in result.out
    assert max(map(len, result.out.splitlines())) < 160


def test_only_named_budgets_are_explained_and_judged(periph_sim: Run, case: str):
    result = periph_sim("worst", case, "response", *LATE)
    assert result.status == 0 and result.out.startswith("response 5.000 us, ") and "stretch 9" not in result.out
    assert periph_sim("worst", case, "response", "stretch", *LATE).status == 1


def test_json_has_a_chain_for_each_budget(periph_sim: Run, case: str):
    report = periph_sim("worst", case, "stretch", "nacked rounds", "--json", *LATE).json_object
    assert [*report["budgets"]] == ["stretch"]
    chain = report["budgets"]["stretch"]
    assert chain["length_us"] == pytest.approx(98, abs=2) and chain["steps"][0]["what"].startswith("repeated START")


def test_run_has_chains_only_on_request(periph_sim: Run, case: str):
    plain = periph_sim("run", case, "--json", *LATE).json_object
    asked = periph_sim("run", case, "--json", "--explain", *LATE).json_object
    assert not any("chain" in budget for budget in plain["budgets"])
    by_name = {budget["name"]: budget["chain"] for budget in asked["budgets"]}
    assert by_name["nacked rounds"] is None and by_name["stretch"]["length_us"] == pytest.approx(98, abs=2)
    message = unwrapped(periph_sim("run", case, "--explain", *LATE).out)
    assert re.search(
        r"287\.8\d\d us I2C-A\.I2CDXR written, 0x\w{4}, for which SCL was held 97\.8\d\d us \[imu_hil\.py:\d+", message
    )


def test_pictures_are_svg_with_lanes_of_wires_flags_and_firmware(periph_sim: Run, case: str, desk: Path):
    (desk / "out").mkdir()
    assert periph_sim("worst", case, "--svg", "out", *LATE).status == 1
    files = sorted(file.name for file in (desk / "out").iterdir())
    assert files == sorted(
        f"{name}.svg"
        for name in (
            *("model_execution", "response", "stretch", "round_complete"),
            *("schedule_slack", "data_age", "SCI_FIFO_high_water"),
        )
    )
    tree = xml.parse(desk / "out" / "stretch.svg").getroot()
    words = {element.text for element in tree.iter() if element.tag.endswith("text")}
    assert {"SCL", "SDA", "bytes", "XRDY", "irq", "span", "wait", "SCIRXINTA", "frame", "0x00"} <= words
    assert any(re.fullmatch(r"stretch: worst 9\d\.\d{3} us at 0\.\d{6} s", word or "") for word in words)


def test_pictures_appear_together_or_not_at_all(periph_sim: Run, case: str, desk: Path):
    (desk / "out").mkdir()
    (desk / "out" / "response.svg").mkdir()  # which a file cannot replace
    assert "response.svg" in periph_sim.refused("worst", case, "--svg", "out", *LATE)
    left = [file.name for file in (desk / "out").iterdir() if file.is_file()]
    assert not any(name.startswith(".") for name in left)


def test_the_picture_of_one_budget_may_be_a_file(periph_sim: Run, case: str, desk: Path):
    (desk / "out").mkdir()
    for place in ("out", "late.svg"):
        assert periph_sim("worst", case, "stretch", "--svg", place, *LATE).status == 1
    assert (desk / "late.svg").read_bytes() == (desk / "out" / "stretch.svg").read_bytes()
    result = periph_sim("worst", case, "nacked rounds", "--svg", "none.svg", *LATE)
    assert result.err == "none.svg: not written, since there is nothing to draw\n" and not Path("none.svg").exists()
    result = periph_sim("worst", case, "stretch", "response", "--svg", "late.svg")
    assert "--svg: late.svg is one file for 2 budgets; name one, or give a folder" in result.err


MISTAKES = {
    ("respons",): "imu_hil.toml: there is no budget 'respons'; did you mean response?",
    ("--svg", "nowhere"): "--svg: nowhere is no folder; create it, or give another, or an .svg file",
    ("--seconds", "ten"): "--seconds: 'ten' is no length of time; write for instance 20 ms (ns, us, ms, s, min, h, d)",
    ("--set", "sed=1"): "imu_hil.toml, --set 'sed=1': there is no key 'sed'; did you mean seed?",
}


@pytest.mark.parametrize(("arguments", "sentence"), MISTAKES.items())
def test_a_wrong_argument_is_one_error_message(periph_sim: Run, case: str, arguments: tuple[str, ...], sentence: str):
    assert periph_sim.refused("worst", case, *arguments) == sentence


def test_budgets_whose_pictures_would_share_a_file_are_refused(periph_sim: Run, case: str, desk: Path):
    text = Path(case).read_text(encoding="utf-8").replace('name = "stretch"', 'name = "response!"')
    Path(case).write_text(text, encoding="utf-8")
    assert "budgets 'response' and 'response!' would both be response.svg" in periph_sim.refused(
        "worst", case, "--seconds", "10 ms", "--svg", "."
    )
    assert not list(desk.glob("*.svg"))


def test_a_kept_silence_is_reported_as_expected(periph_sim: Run, desk: Path):
    (desk / "mute.py").write_text("def main(dsp, settings):\n    pass\n", encoding="utf-8")
    send = '[[serial.send]]\nname = "bad CRC"\nto = "SCI-A"\ntext = "x"\nat = "1 ms"\nexpect = "nothing"\n'
    unit = '[unit.dsp]\nfirmware = "mute.py"\nmodules = ["SCI-A"]\n'
    head = 'name = "mute"\nduration = "5 ms"\n'
    (desk / "mute.toml").write_text(f'{head}{unit}{send}within = "2 ms"\n', encoding="utf-8")
    result = periph_sim("worst", "mute.toml")
    assert (result.status, result.out) == (0, "bad CRC: no answer came, as expected\n")


def test_a_budget_without_a_measurement_is_reported(periph_sim: Run, case: str):
    result = periph_sim("worst", case, "response", "--seconds", "1 ms")
    assert result.status == 1 and result.out.startswith("response: nothing was measured")


@pytest.mark.parametrize("change", ["controller.ppm=-30", "inputs.rounds=['5 ms', '8 ms']"])
def test_the_slack_after_a_round_is_explained_from_the_due_time_of_this_round(periph_sim: Run, case: str, change: str):
    """The due time follows from the period of a controller with its own clock, or from a listed start."""
    message = periph_sim("worst", case, "schedule slack", "--seconds", "40 ms", "--set", change).out
    assert "a round is due\n" not in message  # the first transfer begins then
    assert (
        message.splitlines()[1].endswith("gyroscope (0x68 W)") and "0.000 us              controller: STOP" in message
    )
