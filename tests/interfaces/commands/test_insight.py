"""`why`, `races` and `lint` as a user meets them: on a recording, and on what is none."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run
from tests.scene.runs import TIMING
from tests.unwrapped import unwrapped


@pytest.fixture
def recording(desk: Path, periph_sim: Run) -> str:
    came = periph_sim("run", str(TIMING / "imu_hil_no_sdir.toml"), "--seconds", "0.03", "--record", "x.psr")
    assert came.status == 1
    return "x.psr"


def test_why_says_cause_meaning_and_reader(recording: str, periph_sim: Run):
    came = periph_sim("why", recording, "I2CA.I2CSTR.XRDY@5.3ms")
    assert came.status == 0 and came.err == ""
    first, meaning, *rest = came.out.splitlines()
    assert first.startswith("dsp.I2C-A.I2CSTR.XRDY at 5.300000 ms: 0 since ")
    assert meaning == "  XRDY, R: I2CDXR can take a byte. [SPRUG03B table 10]"
    assert re.search(r"dsp: I2C-A.I2CDXR written, 0x\w+ at batch_read:", unwrapped(" ".join(rest)))
    told = periph_sim("why", recording, "I2CA.I2CSTR.XRDY@5.3ms", "--json").told
    assert told["value"] == 0 and told["next_change"]["value"] == 1 and len(told["back"]) > 2


@pytest.fixture
def hang(desk: Path, periph_sim: Run) -> str:
    """A frame whose routine takes 200 us falls into a read: SCD = 1 clears SDIR, and the wait for it never ends."""
    late = ("--set", "unit.dsp.settings.frame_cost=200 us", "--set", "host.first=4 ms")
    periph_sim("run", str(TIMING / "imu_hil_published.toml"), "--seconds", "0.012", *late, "--record", "h.psr")
    return "h.psr"


def test_why_of_a_hang_goes_to_the_read_modify_write_and_the_routine(hang: str, periph_sim: Run):
    back = unwrapped(periph_sim("why", hang, "I2C-A.I2CSTR.SDIR@6ms").out.partition("forward:")[0])
    assert "I2C-A.I2CSTR written, 0x5638 (SCD = 1) at batch_read:" in back and "SCIRXINTA left" in back
    assert "I2CMDR.IRS" not in back
    (first, *_) = periph_sim("why", hang, "SCL@6ms").out.splitlines()
    assert first.endswith("pulled low first by controller, held now by dsp.GPIO33")


def test_races_tells_the_flag_that_a_hang_came_of(hang: str, periph_sim: Run):
    came = periph_sim("races", hang, "--no-lost")
    assert came.status == 1 and "SDIR was cleared along with it 1 time, 1 of them never read" in unwrapped(came.out)


def test_why_says_addresses_and_bytes_as_people_write_them(recording: str, periph_sim: Run):
    out = periph_sim("why", recording, "SDA@5.001ms").out + periph_sim("why", recording, "SCL@5.292ms").out
    assert "controller: START (gyroscope)" in out and "controller: 0x68 R ACK (gyroscope)" in out
    assert "0x1a" not in out and " 0x0 " not in out


def test_races_in_a_table_and_as_json(recording: str, periph_sim: Run):
    came = periph_sim("races", recording, "--register", "I2C-A.I2CSTR")
    assert came.status == 0 and " closest  cycles " in came.out and "batch_read:" in came.out
    told = periph_sim("races", recording, "--json").told
    assert {place["register"] for place in told["places"]} >= {"I2C-A.I2CSTR"} and told["lost"] == 0


@pytest.mark.parametrize(
    ("limit", "status"), [(["--least", "1"], 1), (["--least", "0"], 0), (["--no-lost"], 0), ([], 0)]
)
def test_races_may_be_limited(recording: str, periph_sim: Run, limit: list[str], status: int):
    assert periph_sim("races", recording, *limit).status == status


def test_lint_exits_with_1_where_something_is_found(recording: str, periph_sim: Run):
    came = periph_sim("lint", recording)
    assert came.status == 1 and "loads I2CDXR as slave on XRDY alone" in came.out
    told = periph_sim("lint", recording, "--json").told
    assert [found["lint"] for found in told["findings"]] == [
        "without-effect",
        "receive-register-unread",
        "without-effect",
        "without-effect",
        "xrdy-alone",
    ]


def test_lint_exits_with_0_where_nothing_is(desk: Path, periph_sim: Run):
    periph_sim("run", str(TIMING / "responder.toml"), "--seconds", "0.02", "--record", "y.psr")
    came = periph_sim("lint", "y.psr")
    assert (came.status, came.out) == (0, "y.psr: nothing found by 13 lints\n")


@pytest.mark.parametrize("command", [["why", "NO", "SDA@1ms"], ["races", "NO"], ["lint", "NO"]])
@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("lines.jsonl", "lines.jsonl: a run for other programs to read; record one with periph-sim run CASE --record"),
        ("nack.sr", "nack.sr: not a recorded run; record one with periph-sim run CASE --record RUN.psr"),
        ("none.psr", "none.psr: there is no such file; record one with"),
        ("bare.psr", "bare.psr: a capture of wires, with no accesses or flags; record one with"),
        ("cut.psr", "cut.psr, the archive: found a broken zip ("),
    ],
)
def test_what_is_no_recorded_run_is_refused(desk: Path, periph_sim: Run, command: list[str], name: str, said: str):
    trace = TIMING.parent / "traces" / "nack.sr"
    periph_sim("convert", str(trace), "bare.psr")
    Path("lines.jsonl").write_text('{"periph-sim": 2}\n')
    Path("cut.psr").write_bytes(Path("bare.psr").read_bytes()[:-100])
    given = str(trace) if name == "nack.sr" else name
    assert said in periph_sim.refused(*[given if part == "NO" else part for part in command])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["why", "x.psr", "XRYD@1ms"], "did you mean"),
        (["why", "x.psr", "SDA@1s"], "outside the run, which goes from 0 to 30.000000 ms"),
        (["races", "x.psr", "--register", "I2C-A.I2CSRT"], "did you mean I2C-A.I2CSTR"),
        (["lint", "x.psr", "--bound", "soon"], "--bound"),
        (["lint", "x.psr", "--sysclk", "0"], "--sysclk"),
    ],
)
def test_mistakes_are_one_sentence(recording: str, periph_sim: Run, arguments: list[str], said: str):
    assert said in periph_sim.refused(*arguments)
