"""`periph-sim diff`: exit status, text, JSON, captures of different rates, UART and error messages."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run
from tests.traces.formats.writers import I2cWave, sr_file

ROOT = Path(__file__).parents[3]
IMU_ROUND = str(ROOT / "traces" / "imu_round.sr")
NACK = str(ROOT / "traces" / "nack.sr")
HOST_FRAMES = str(ROOT / "traces" / "host_frames.sr")


def wave(path: Path, *, rate: str = "4 MHz", half: int = 20, lead: int = 50, pause: int = 100, last: int = 0x22) -> str:
    """Write a capture of two transfers, separated by `pause` samples. `last` is the last byte."""
    drawn = I2cWave(half, half // 5, idle=lead)
    for byte in (0x33, last):
        drawn.transfer(0xA6, 0x11, byte)
        drawn.idle(pause)
    return sr_file(path, ["SCL", "SDA"], rate, bytes(drawn.samples))


def test_a_capture_and_itself_are_equal(periph_sim: Run):
    out = periph_sim.passes("diff", IMU_ROUND, IMU_ROUND)
    assert out.splitlines()[-1] == "EQUAL: 63 events, all within 500 ns"


def test_another_sample_rate_and_another_start_are_no_difference(periph_sim: Run, tmp_path: Path):
    a = wave(tmp_path / "a.sr")
    b = wave(tmp_path / "b.sr", rate="8 MHz", half=40, lead=7_000, pause=200)
    result = periph_sim("diff", a, b)
    assert result.status == 0 and "EQUAL: 16 events" in result.out
    assert "offset +862.500 us: B's time" in result.out


def test_a_later_transfer_is_one_change_of_lateness(periph_sim: Run, tmp_path: Path):
    """The pause is 12 samples of 250 ns longer, which is 3 us."""
    a, b = wave(tmp_path / "a.sr"), wave(tmp_path / "b.sr", pause=112)
    result = periph_sim("diff", a, b)
    assert result.status == 1
    assert "lateness changes: 1\n  +3.000 us from event 8: START, +3.000 us, " in result.out
    assert "first difference: event 8: START, +3.000 us, " in result.out and "after STOP" in result.out
    assert result.out.splitlines()[-1] == (
        "DIFFERENT: 0 missing, 0 inserted, 0 changed, 8 of 16 off by more than 500 ns, 1 change of lateness"
    )
    assert periph_sim("diff", a, b, "--tolerance", "3us").status == 0


def test_a_changed_byte_is_reported_with_both_values(periph_sim: Run, tmp_path: Path):
    a, b = wave(tmp_path / "a.sr"), wave(tmp_path / "b.sr", last=0x23)
    result = periph_sim("diff", a, b)
    assert result.status == 1 and "event 13: byte 22 changed to byte 23, +0.000 us" in result.out
    assert "every event" not in result.out
    assert "every event: 16" in periph_sim("diff", a, b, "--all").out


def test_a_missing_transfer_is_one_line(periph_sim: Run):
    """A has reads of three devices; B has two addresses without ACK and a shorter read of the second device."""
    result = periph_sim("diff", IMU_ROUND, NACK)
    assert result.status == 1
    assert (
        "  events 0 to 20: START, address 68 W, ACK, byte 1D, ACK, repeated START, address 68 R, ACK, ...: "
        "missing in B, at A 0.000100000 s\n"
        "  events 21 to 28: START, address 53 W, NACK, STOP, START, address 53 W, NACK, STOP: inserted in B, at B "
    ) in result.out
    assert "event 37: byte FB changed to byte E5" in result.out


def test_json_lists_the_differences_or_all_events(periph_sim: Run, tmp_path: Path):
    a, b = wave(tmp_path / "a.sr"), wave(tmp_path / "b.sr", pause=112)
    found = periph_sim("diff", a, b, "--json").json_object
    assert (found["equal"], found["events"], found["late"], len(found["entries"])) == (False, 16, 8, 8)
    (point,) = found["change_points"]
    assert (point["number"], point["after"], point["a"], point["step_s"]) == (8, 7, "START", 3e-6)
    assert len(periph_sim("diff", a, b, "--json", "--all").json_object["entries"]) == 16


def test_channels_of_b_can_be_mapped(periph_sim: Run, tmp_path: Path):
    a = wave(tmp_path / "a.sr")
    drawn = I2cWave(20, 4, idle=9)
    drawn.transfer(0xA6)
    renamed = sr_file(tmp_path / "b.sr", ["clock", "data"], "4 MHz", bytes(drawn.samples))
    assert periph_sim("diff", a, renamed).status == 2
    result = periph_sim("diff", a, renamed, "--map-b", "scl=clock,sda=data")
    assert result.status == 1 and "12 missing, 0 inserted" in result.out


def test_uart_frames_are_compared(periph_sim: Run):
    assert "EQUAL: 24 events" in periph_sim.passes(
        "diff", HOST_FRAMES, HOST_FRAMES, "--uart", "rx=RX,baud=115200,format=8n1"
    )
    assert "frame" in periph_sim.passes("diff", HOST_FRAMES, HOST_FRAMES, "--uart", "baud=115200")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([IMU_ROUND], "Missing argument 'B'"),
        ([IMU_ROUND, "none.sr"], "none.sr, the file: found no such file or directory"),
        ([IMU_ROUND, HOST_FRAMES], "host_frames.sr: the lines found are rx; give --uart baud=RATE"),
        (
            [IMU_ROUND, IMU_ROUND, "--uart", "baud=9600"],
            "imu_round.sr: the lines found are scl and sda; map the channel",
        ),
        ([IMU_ROUND, NACK, "--tolerance", "3"], "--tolerance: '3' has no unit"),
        ([IMU_ROUND, NACK, "--tolerance", "-1us"], "--tolerance: '-1us' is negative"),
        ([IMU_ROUND, NACK, "--tolerance", "20 cycles"], "--tolerance in cycles: captures state no SYSCLKOUT; give"),
        ([IMU_ROUND, NACK, "--map", "scl=9,sda=1"], "there is no channel '9'"),
        ([IMU_ROUND, NACK, "--rate-b", "x"], "--rate-b: 'x' is no sample rate"),
        (
            [HOST_FRAMES, HOST_FRAMES, "--uart", "baud=fast"],
            "--uart baud=fast: 'fast' is no baud rate; expected a number",
        ),
        ([HOST_FRAMES, HOST_FRAMES, "--uart", "rx=RX"], "the rate is not stated; expected baud=RATE, such as baud="),
        ([HOST_FRAMES, HOST_FRAMES, "--uart", "baud=auto"], "--uart baud=auto: the rate is not stated; expected baud="),
        ([HOST_FRAMES, HOST_FRAMES, "--uart", "bauds=9600"], "there is no 'bauds'; did you mean baud?"),
        ([HOST_FRAMES, HOST_FRAMES, "--uart", "baud=9600,format=8x1"], "'8x1' is no frame; expected data bits"),
        ([HOST_FRAMES, HOST_FRAMES, "--uart", "rx"], "--uart rx: rx has no value; expected rx=..."),
        ([HOST_FRAMES, HOST_FRAMES, "--uart", "baud=900000"], "samples a bit at 900000 baud; expected at least 2"),
        ([HOST_FRAMES, HOST_FRAMES, "--uart", "rx=RX,baud=9600", "--map", "rx=0"], "both name the channel of rx"),
    ],
)
def test_bad_input_is_one_error_message_with_status_2(periph_sim: Run, arguments: list[str], message: str):
    assert message in periph_sim.refused("diff", *arguments)


def test_two_idle_captures_are_an_error(periph_sim: Run, tmp_path: Path):
    quiet = sr_file(tmp_path / "quiet.sr", ["SCL", "SDA"], "1 MHz", b"\x03" * 100)
    assert "no I2C transfer in either" in periph_sim.refused("diff", quiet, quiet)


@pytest.mark.parametrize("command", [("diff", IMU_ROUND), ("compliance", "--mode", "fast")])
def test_a_capture_without_a_sample_rate_is_an_error(periph_sim: Run, tmp_path: Path, command: tuple[str, ...]):
    rateless = wave(tmp_path / "rateless.sr", rate="0")
    assert re.search(r"rateless\.sr: .*the file states no", periph_sim.refused(*command, rateless))
    option = "--rate-b" if command[0] == "diff" else "--rate"
    assert periph_sim(*command, rateless, option, "1 MHz").status in (0, 1)
