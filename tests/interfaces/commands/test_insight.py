"""`why`, `races` and `lint` on a recording and on files that are no recording."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run
from tests.scene.runs import TIMING
from tests.unwrapped import unwrapped


@pytest.fixture
def recording(desk: Path, periph_sim: Run) -> str:
    result = periph_sim("run", str(TIMING / "imu_hil_no_sdir.toml"), "--seconds", "0.03", "--record", "x.psr")
    assert result.status == 1
    return "x.psr"


def test_why_shows_cause_and_meaning_of_a_flag(recording: str, periph_sim: Run):
    result = periph_sim("why", recording, "I2CA.I2CSTR.XRDY@5.3ms")
    assert result.status == 0 and result.err == ""
    first, meaning, *rest = result.out.splitlines()
    assert first.startswith("dsp.I2C-A.I2CSTR.XRDY at 5.300000 ms: 0 since ")
    assert meaning == "  XRDY, R: I2CDXR can take a byte. [SPRUG03B table 10]"
    assert re.search(r"dsp: I2C-A.I2CDXR written, 0x\w+ at batch_read:", unwrapped(" ".join(rest)))
    report = periph_sim("why", recording, "I2CA.I2CSTR.XRDY@5.3ms", "--json").json_object
    assert report["value"] == 0 and report["next_change"]["value"] == 1 and len(report["back"]) > 2


@pytest.fixture
def hang(desk: Path, periph_sim: Run) -> str:
    """Record a hang: a frame's 200 us routine delays a read; SCD = 1 then clears SDIR, which is awaited for ever."""
    late = ("--set", "unit.dsp.settings.frame_cost=200 us", "--set", "host.first=4 ms")
    periph_sim("run", str(TIMING / "imu_hil_published.toml"), "--seconds", "0.012", *late, "--record", "h.psr")
    return "h.psr"


def test_why_traces_a_hang_to_the_read_modify_write_and_the_routine(hang: str, periph_sim: Run):
    back = unwrapped(periph_sim("why", hang, "I2C-A.I2CSTR.SDIR@6ms").out.partition("forward:")[0])
    assert "I2C-A.I2CSTR written, 0x5638 (SCD = 1) at batch_read:" in back and "SCIRXINTA left" in back
    assert "I2CMDR.IRS" not in back
    (first, *_) = periph_sim("why", hang, "SCL@6ms").out.splitlines()
    assert first.endswith("pulled low first by controller, held now by dsp.GPIO33")


def test_races_reports_the_flag_that_caused_a_hang(hang: str, periph_sim: Run):
    result = periph_sim("races", hang, "--no-lost")
    assert result.status == 1 and "SDIR was cleared along with it 1 time, 1 of them never read" in unwrapped(result.out)


def test_why_shows_addresses_and_bytes_in_two_digit_hexadecimal(recording: str, periph_sim: Run):
    out = periph_sim("why", recording, "SDA@5.001ms").out + periph_sim("why", recording, "SCL@5.292ms").out
    assert "controller: START (gyroscope)" in out and "controller: 0x68 R ACK (gyroscope)" in out
    assert "0x1a" not in out and " 0x0 " not in out


def test_races_prints_a_table_or_json(recording: str, periph_sim: Run):
    result = periph_sim("races", recording, "--register", "I2C-A.I2CSTR")
    assert result.status == 0 and " closest  cycles " in result.out and "batch_read:" in result.out
    report = periph_sim("races", recording, "--json").json_object
    assert {place["register"] for place in report["places"]} >= {"I2C-A.I2CSTR"} and report["lost"] == 0


@pytest.mark.parametrize(
    ("limit", "status"), [(["--least", "1"], 1), (["--least", "0"], 0), (["--no-lost"], 0), ([], 0)]
)
def test_options_limit_the_races_that_fail(recording: str, periph_sim: Run, limit: list[str], status: int):
    assert periph_sim("races", recording, *limit).status == status


def test_lint_exits_with_1_if_it_finds_something(recording: str, periph_sim: Run):
    result = periph_sim("lint", recording)
    assert result.status == 1 and "loads I2CDXR as slave on XRDY alone" in result.out
    report = periph_sim("lint", recording, "--json").json_object
    assert [found["lint"] for found in report["findings"]] == [
        "without-effect",
        "receive-register-unread",
        "without-effect",
        "without-effect",
        "xrdy-alone",
    ]


def test_lint_exits_with_0_if_it_finds_nothing(desk: Path, periph_sim: Run):
    periph_sim("run", str(TIMING / "responder.toml"), "--seconds", "0.02", "--record", "y.psr")
    result = periph_sim("lint", "y.psr")
    assert (result.status, result.out) == (0, "y.psr: nothing found by 13 lints\n")


@pytest.mark.parametrize("command", [["why", "NO", "SDA@1ms"], ["races", "NO"], ["lint", "NO"]])
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("lines.jsonl", "lines.jsonl: a run for other programs to read; record one with periph-sim run CASE --record"),
        ("nack.sr", "nack.sr: not a recorded run; record one with periph-sim run CASE --record RUN.psr"),
        ("none.psr", "none.psr: there is no such file; record one with"),
        ("bare.psr", "bare.psr: a capture of wires, with no accesses or flags; record one with"),
        ("cut.psr", "cut.psr, the archive: found a broken zip ("),
    ],
)
def test_a_file_that_is_no_recorded_run_is_rejected(
    desk: Path, periph_sim: Run, command: list[str], name: str, message: str
):
    trace = TIMING.parent / "traces" / "nack.sr"
    periph_sim("convert", str(trace), "bare.psr")
    Path("lines.jsonl").write_text('{"periph-sim": 2}\n')
    Path("cut.psr").write_bytes(Path("bare.psr").read_bytes()[:-100])
    given = str(trace) if name == "nack.sr" else name
    assert message in periph_sim.refused(*[given if part == "NO" else part for part in command])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["why", "x.psr", "XRYD@1ms"], "did you mean"),
        (["why", "x.psr", "SDA@1s"], "outside the run, which goes from 0 to 30.000000 ms"),
        (["races", "x.psr", "--register", "I2C-A.I2CSRT"], "did you mean I2C-A.I2CSTR"),
        (["lint", "x.psr", "--bound", "soon"], "--bound"),
        (["lint", "x.psr", "--sysclk", "0"], "--sysclk"),
    ],
)
def test_a_wrong_argument_is_one_error_message(recording: str, periph_sim: Run, arguments: list[str], message: str):
    assert message in periph_sim.refused(*arguments)
