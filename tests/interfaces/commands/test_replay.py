"""`periph-sim replay`: output, exit status and error messages."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.traces.formats.psr import read_table
from tests.interfaces.commands.conftest import Run
from tests.replay.make_session import samples
from tests.replay.slow import one_read, slow_case
from tests.replay.test_i2c_master import endless_case
from tests.traces.formats.writers import frame_bits, sr_file, uart_wave

ROOT = Path(__file__).resolve().parents[3]
TRACES, CASES = ROOT / "traces", ROOT / "timing"
HOST_FRAMES, IMU_ROUND = str(TRACES / "host_frames.sr"), str(TRACES / "imu_round.sr")
NACK, BIT = str(TRACES / "nack.sr"), Fraction(2_000_000, 115_200)
MASTER = str(CASES / "captured_master.toml")
LOGGER, RESPONDER = str(CASES / "uart_logger.toml"), str(CASES / "responder.toml")


def test_a_uart_trace_is_replayed_into_the_sci(periph_sim: Run):
    status, out, err = periph_sim("replay", HOST_FRAMES, "--case", LOGGER, "--baud", "115200")
    assert (status, err) == (0, "")
    assert "uart_logger" in out and "PASS" in out and "24 of 24" in out and "FE 0, PE 0" in out


def test_json_is_one_object_with_all_results(periph_sim: Run):
    status, report = periph_sim.json("replay", HOST_FRAMES, "--case", LOGGER, "--map", "rx=0")
    assert status == 0
    assert (report["case"], report["kind"], report["verdict"]) == ("uart_logger", "uart", "pass")
    assert (report["events"], report["agreed"], report["bytes"], report["first_divergence"]) == (24, 24, 24, None)
    assert report["errors"] == {"FE": 0, "PE": 0, "BRKDT": 0, "OE": 0, "RXFFOVF": 0}
    assert report["capture"] == HOST_FRAMES and report["simulated_s"] > 0 and report["wall_s"] > 0


TENS = """
from dataclasses import dataclass

from periph_sim.firmware import sci_fifo_receiver


@dataclass
class Settings:
    brr: int = 40


def main(dsp, settings):
    sci = dsp.module("SCI-A")
    sci_fifo_receiver(dsp, settings.brr, 10)
    while True:
        dsp.spin(lambda: sci.SCIFFRX.RXFFST >= 10)
        for _ in range(10):
            sci.SCIRXBUF.all
"""


@pytest.fixture
def tens(tmp_path: Path) -> str:
    """A case whose firmware takes ten words at a time, with settable baud rate and frame format."""
    (tmp_path / "tens.py").write_text(TENS)
    case = tmp_path / "tens.toml"
    unit = f'[unit.dsp]\nfirmware = "{tmp_path / "tens.py"}"\nmodules = ["SCI-A"]\n'
    case.write_text(f'name = "tens"\nduration = "1 s"\n{unit}')
    return str(case)


def test_unread_words_in_the_fifo_are_a_note_and_no_divergence(periph_sim: Run, tens):
    status, report = periph_sim.json("replay", HOST_FRAMES, "--case", tens)
    assert status == 0 and (report["events"], report["bytes"]) == (24, 20)
    assert not any(report[of_i2c] for of_i2c in ("transfers", "captured_transfers", "nacks", "captured_stretch_us"))
    assert "words still unread in the FIFO: 4" in report["notes"]


def test_a_divergence_has_exit_status_1_and_its_place(periph_sim: Run, tens):
    """The firmware receives eight data bits and the capture is read with seven, so each eighth bit is a stop bit."""
    status, out, _ = periph_sim("replay", HOST_FRAMES, "--case", tens, "--baud", "115200", "--frame", "7n1")
    assert status == 1 and "FAIL" in out and "0 of " in out
    assert "first wrong byte" in out and "expected 00 FE at 0.000300 s" in out and "found 00 at" in out
    notes = periph_sim(
        "replay", HOST_FRAMES, "--case", tens, "--baud", "115200", "--frame", "7n1", "--json"
    ).json_object
    assert notes["notes"][0].startswith("read at 115200 baud, 7n1, ") and len(notes["notes"]) > 1
    line = TENS.splitlines().index("            sci.SCIRXBUF.all") + 1
    assert f"the firmware was at tens.py:{line}, in main" in out


def test_a_wrong_baud_rate_is_a_note(periph_sim: Run, tens):
    _, out, _ = periph_sim(
        "replay", HOST_FRAMES, "--case", tens, "--baud", "115200", "--set", "unit.dsp.settings.brr=42"
    )
    assert "note: the SCI runs at 109012 baud, -5.4 % off the line's 115200" in out


@pytest.mark.parametrize(("oscclk", "noted"), [("30.6 MHz", False), ("30.601 MHz", True)])
def test_a_baud_rate_within_two_percent_is_no_note(periph_sim: Run, tens, oscclk: str, noted: bool):
    """BRR = 99 gives 46875 baud with a crystal of 30 MHz."""
    changes = ["--set", "unit.dsp.settings.brr=99", "--set", f"unit.dsp.oscclk={oscclk}"]
    _, out, _ = periph_sim("replay", HOST_FRAMES, "--case", tens, "--baud", "46875", *changes)
    assert ("% off the line's" in out) == noted


@pytest.mark.parametrize(
    "arguments",
    [[NACK, RESPONDER], [NACK, RESPONDER, "--loop", "open"], [NACK, MASTER], [HOST_FRAMES, LOGGER]],
    ids=["closed", "open", "master", "uart"],
)
def test_simulated_time_is_counted_from_the_start_of_the_case(periph_sim: Run, arguments):
    capture, case, *loop = arguments
    line = ["replay", capture, "--case", case, *loop, "--json"]
    reports = [periph_sim(*line, "--set", f"start={at}").json_object for at in ("0 s", "10 s")]
    assert reports[0]["simulated_s"] == reports[1]["simulated_s"] < 1
    assert reports[0]["agreed"] == reports[1]["agreed"] > 0


def test_a_replay_is_recorded(periph_sim: Run, tmp_path):
    status, _, _ = periph_sim("replay", HOST_FRAMES, "--case", LOGGER, "--record", str(tmp_path / "run.psr"))
    table = read_table(tmp_path / "run.psr")
    assert status == 0 and "R SCI-A.SCIRXBUF" in table.names["what"]
    assert {unit: clock[-1][1] for unit, clock in table.clocks.items()} == {"dsp": 150_000_000}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--map", "rx=4"], "there is no channel '4'; it has RX"),
        (["--baud", "115200", "--frame", "9n1"], "'9n1' is no line format; expected data bits 1 to 8"),
        (["--baud", "115200", "--frame", "8m1"], "'8m1' is no line format; expected data bits 1 to 8, n, o or e, and"),
        (["--baud", "900000"], "samples a bit at 900000 baud; expected at least 2"),
        (["--first", "3"], "--first is for I2C captures; this one is not mapped so"),
        (["--frame", "8n1"], "--frame needs --baud"),
        (["--rate", "fast"], "--rate: 'fast' is no sample rate"),
        (["--address", "0x80"], "--address: '0x80' is no 7-bit address"),
        (["--set", "unit.dsp.modules=['GPIO']"], "no unit has SCI-A, which this capture is for"),
        (["--set", "unit.dsp.firmware=nobody"], "there is no firmware 'nobody'"),
        (["--record", "run.xyz"], "no recording is written as '.xyz'"),
    ],
)
def test_bad_input_is_one_error_message_with_exit_status_2(periph_sim: Run, arguments, message):
    assert message in periph_sim.refused("replay", HOST_FRAMES, "--case", LOGGER, *arguments)


def test_a_file_that_is_no_capture_and_a_missing_case_are_errors(periph_sim: Run, tmp_path):
    noise = tmp_path / "noise.bin"
    noise.write_bytes(bytes(range(256)))
    status, _, err = periph_sim("replay", str(noise), "--case", LOGGER)
    assert status == 2 and "noise.bin, " in err and "found" in err and "expected" in err
    assert "none.toml: cannot be read" in periph_sim.refused(
        "replay", HOST_FRAMES, "--case", str(tmp_path / "none.toml")
    )


def test_lines_without_a_transfer_are_refused(periph_sim: Run, tmp_path):
    quiet = sr_file(tmp_path / "quiet.sr", ["SCL", "SDA"], "1 MHz", b"\x03" * 100)
    assert "no I2C transfer on 'SCL' and 'SDA'; neither line changes in the capture" in periph_sim.refused(
        "replay", quiet, "--case", RESPONDER
    )


@pytest.mark.parametrize(
    ("capture", "case", "message"),
    [
        (TRACES / "nack.sr", RESPONDER, "SCL would run at 0.025 Hz; expected 100 Hz to 5 MHz; state the right rate"),
        (HOST_FRAMES, LOGGER, "0.00 samples a bit at 114329.3 baud; expected at least 2, so the rate of 1 Hz or"),
    ],
)
def test_an_impossible_rate_is_an_error_before_the_run(periph_sim: Run, capture, case, message):
    assert message in periph_sim.refused("replay", str(capture), "--case", case, "--rate", "1 Hz")


def test_unrecorded_spans_are_a_note(periph_sim: Run, tmp_path):
    rows = ["Time [s],SCL,SDA", "0.000000,1,1", "0.001000,X,1", "0.002000,1,1", "0.003000,1,0", "0.003010,0,0"]
    (tmp_path / "gap.csv").write_text("\n".join(rows) + "\n")
    _, _, err = periph_sim("replay", str(tmp_path / "gap.csv"), "--case", RESPONDER)
    assert "no whole address byte" in err
    bits = "".join(f"0.00{3100 + 20 * n},0,{n & 1}\n0.00{3110 + 20 * n},1,{n & 1}\n" for n in range(9))
    (tmp_path / "gap.csv").write_text("\n".join(rows) + "\n" + bits + "0.004000,0,0\n0.004010,1,0\n0.004020,1,1\n")
    report = periph_sim("replay", str(tmp_path / "gap.csv"), "--case", RESPONDER, "--json").json_object
    message = "SCL and SDA: 1 span was not recorded, 0.001000000 s in all"
    assert any(note.startswith(message) for note in report["notes"])


def test_the_verdict_line_states_its_scope(periph_sim: Run):
    def line(*arguments: str) -> tuple[object, str]:
        status, out, _ = periph_sim("replay", *arguments)
        return status, out.splitlines()[0].partition(".sr: ")[2]

    filled = "timing and protocol only; "
    assert line(IMU_ROUND, "--case", RESPONDER) == (0, f"PASS: {filled}the data came from the capture")
    assert line(NACK, "--case", RESPONDER) == (0, f"PASS: {filled}the data and the refusals came from the capture")
    first = line(IMU_ROUND, "--case", RESPONDER, "--first", "2")
    assert first == (0, f"PASS for 42 of 63 events, 2 of 3 transfers: {filled}the data came from the capture")
    assert line(IMU_ROUND, "--case", MASTER, "--as", "master")[1] == f"PASS: {filled}the requests came from the capture"
    assert line(NACK, "--case", RESPONDER, "--address", "0x53") == (1, "FAIL")
    assert line(NACK, "--case", RESPONDER, "--first", "2") == (
        1,
        "NOT JUDGED: nothing was required of the firmware: 53 is not acknowledged in the capture",
    )


def test_ambiguous_frames_are_no_failure_unless_strict(periph_sim: Run, tmp_path):
    line = bytearray(uart_wave([(Fraction(60), frame_bits(0x4F)), (Fraction(300), frame_bits(0x41))], BIT, 700))
    line[60 + int(Fraction(11, 2) * BIT)] ^= 1
    path = sr_file(tmp_path / "glitch.sr", ["RX"], "2 MHz", bytes(line))
    arguments = ("replay", path, "--case", LOGGER, "--baud", "115200")
    status, out, _ = periph_sim(*arguments)
    assert status == 0 and "glitch.sr: AMBIGUOUS (1 of 2 ambiguous)" in out.splitlines()[0]
    assert periph_sim(*arguments, "--strict")[0] == 1


def test_an_i2c_trace_is_replayed_against_firmware(periph_sim: Run):
    status, out, err = periph_sim("replay", IMU_ROUND, "--case", RESPONDER)
    assert (status, err) == (0, "")
    assert "PASS" in out and "63 of 63" in out and re.search(r"answered by the firmware +address 68\n", out)
    assert "note: an agent answers for 1E, 53, as captured" in out
    assert re.search(r"^assumes \d+ undocumented behaviours \(-v lists them\)$", out, re.MULTILINE)


def test_channels_address_and_number_of_transfers_can_be_given(periph_sim: Run):
    arguments = ("--map", "scl=0,sda=1", "--address", "0x53", "--first", "2", "--longest-low", "2 us", "--json")
    status, report = periph_sim.json("replay", IMU_ROUND, "--case", RESPONDER, *arguments)
    assert status == 0 and report["addresses"] == ["53"] and (report["events"], report["nacks"]) == (42, 2)
    assert report["lag_worst_us"] > 100, "each low phase is 3 us shorter"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["--map", "scl=SDA,sda=SCL"],
            "imu_round.sr: SCL and SDA are swapped: 0 of 98 STARTs on them have a whole address, "
            "and 6 of 6 the other way round; give --map scl=SCL,sda=SDA",
        ),
        (["--baud", "9600"], "--baud is for UART captures; this one is not mapped so"),
        (["--longest-low", "10"], "--longest-low: '10' has no unit"),
        (["--longest-low", "0 us"], "--longest-low: expected more than 0"),
        (["--set", "unit.dsp.modules=['GPIO']"], "no unit has I2C-A, which this capture is for"),
        (["--address", "0x50", "--address", "0x51"], "firmware responder answers one address; 2 are given"),
        (["--set", "unit.dsp.settings.style=guess"], "unit.dsp.settings.style"),
    ],
)
def test_bad_input_for_i2c_is_one_error_message_with_exit_status_2(periph_sim: Run, arguments, message):
    assert message in periph_sim.refused("replay", IMU_ROUND, "--case", RESPONDER, *arguments)


# Roles and loops ---------------------------------------------------------------------

WRONG = ("--set", "unit.dsp.settings.replies=['e4']")
NACK, SESSION = str(TRACES / "nack.sr"), str(TRACES / "imu_session.sr")
IMU, MASTER = str(CASES / "imu_hil_published.toml"), str(CASES / "captured_master.toml")


@pytest.mark.parametrize(
    ("arguments", "loop", "role"),
    [
        (["--case", RESPONDER], "closed", "slave"),
        (["--case", RESPONDER, "--loop", "open"], "open", "slave"),
        (["--case", RESPONDER, "--loop", "closed", "--as", "slave"], "closed", "slave"),
        (["--case", MASTER, "--as", "master"], "closed", "master"),
    ],
)
def test_a_trace_agrees_in_each_role_and_loop(periph_sim: Run, arguments, loop, role):
    status, report = periph_sim.json("replay", IMU_ROUND, *arguments)
    assert (status, report["loop"], report["role"], report["agreed"]) == (0, loop, role, 63)


@pytest.mark.parametrize("loop", ["closed", "open"])
def test_a_divergence_is_reported_with_the_chip_events_and_a_picture(periph_sim: Run, tmp_path, loop):
    svg = tmp_path / "wrong.svg"
    status, out, err = periph_sim("replay", NACK, "--case", RESPONDER, *WRONG, "--loop", loop, "--svg", str(svg))
    assert (status, err) == (1, "") and "first wrong byte" in out and "expected data read E5 at 0.001015 s" in out
    history = out.partition("the chip around the first wrong byte")[2]
    assert "W I2C-A.I2CDXR" in history and "00E4" in history and "I2C-A.I2CSTR.AAS" in history
    assert history.count("R I2C-A.I2CSTR       5600") <= 2, "polls that give the same are shown once"
    assert svg.read_text().startswith("<?xml") and "data read E4" in svg.read_text()
    periph_sim("replay", NACK, "--case", RESPONDER, *WRONG, "--loop", loop, "--svg", str(tmp_path))
    assert (tmp_path / "divergence.svg").read_text() == svg.read_text()
    report = periph_sim("replay", NACK, "--case", RESPONDER, *WRONG, "--loop", loop, "--json").json_object
    (divergence,) = report["divergences"]
    assert divergence["kind"] == "byte" and {"at_s", "what", "value"} == set(divergence["history"][0])


def test_without_a_divergence_no_picture_is_written(periph_sim: Run, tmp_path):
    svg = tmp_path / "none.svg"
    status, _, err = periph_sim("replay", NACK, "--case", RESPONDER, "--svg", str(svg))
    assert status == 0 and not svg.exists() and "not written, since there is no divergence to draw" in err
    status, _, err = periph_sim(
        "replay", NACK, "--case", RESPONDER, *WRONG, "--svg", str(tmp_path / "no" / "where.svg")
    )
    assert status == 2 and "where.svg" in err and "expected a place that can be written to" in err
    for place in (tmp_path / "nowhere", tmp_path / "wrong.png"):
        assert (
            f"--svg: {place} is no folder; create it, or give another, or an .svg file"
            in periph_sim.refused("replay", NACK, "--case", RESPONDER, *WRONG, "--svg", str(place))
            and not place.exists()
        )


def test_a_tolerance_makes_a_difference_in_time_a_failure(periph_sim: Run, tmp_path):
    case = str(slow_case(tmp_path))
    trace = sr_file(tmp_path / "read.sr", ["SCL", "SDA"], "4 MHz", samples(one_read()))
    slow = ("replay", trace, "--case", case, "--set", "unit.dsp.settings.wait=100")
    status, out, _ = periph_sim(*slow)
    assert status == 0 and "first difference in time" in out and "341.4 sample periods" in out
    assert periph_sim(*slow, "--tolerance", "80 us")[0] == 1 and periph_sim(*slow, "--tolerance", "90 us")[0] == 0
    assert (
        periph_sim(*slow, "--tolerance", "12000 cycles")[0] == 1
        and periph_sim(*slow, "--tolerance", "13500 cycles")[0] == 0
    )


def test_a_session_from_two_files_equals_that_from_one(periph_sim: Run, tmp_path):
    low = ("--longest-low", "5 us", "--baud", "115200")
    status, out, _ = periph_sim("replay", SESSION, "--case", IMU, *low)
    assert status == 0 and "189 of 189" in out and "data age" in out and "23.933 ms" in out
    assert "note:" not in out  # rounds are recognized from the bus
    one = periph_sim("replay", SESSION, "--case", IMU, *low, "--json").json_object
    lines = ("--map", "scl=SCL,sda=SDA", "--uart-file", f"{SESSION},rx=RX", "--json")
    two = periph_sim("replay", SESSION, "--case", IMU, *low, *lines).json_object
    assert two["budgets"] == one["budgets"] and two["kind"] == one["kind"] == "session"
    early = periph_sim("replay", SESSION, "--case", IMU, *low, *lines, "--offset", "-1 ms").json_object
    ages = [next(v["worst"] for v in found["budgets"] if v["measure"] == "age") for found in (two, early)]
    assert ages[1] - ages[0] == pytest.approx(1000, abs=2)


def test_without_sci_in_the_case_a_session_is_its_i2c_capture(periph_sim: Run):
    report = periph_sim("replay", SESSION, "--case", RESPONDER, "--json").json_object
    assert report["kind"] == "i2c"


def test_a_master_that_does_not_return_fails_after_the_patience_given(periph_sim: Run, tmp_path):
    """main computes for ever after the last STOP; the only pause in the script is 92 us."""
    case = endless_case(tmp_path, "while True: dsp.compute(1000)")
    status, out, _ = periph_sim("replay", NACK, "--case", str(case), "--as", "master", "--patience", "30 ms")
    assert status == 1 and "19 of 19" in out
    assert "computes at line 6 of endless.py: the replay ends there, after 30." in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([IMU_ROUND, "--loop", "half"], "'half' is not one of"),
        ([IMU_ROUND, "--tolerance", "3"], "--tolerance: '3' has no unit"),
        ([IMU_ROUND, "--loop", "open", "--longest-low", "2 us"], "--longest-low is for --loop closed"),
        ([IMU_ROUND, "--as", "master", "--loop", "open"], "--loop open is for a slave; as master the firmware"),
        ([IMU_ROUND, "--as", "master", "--address", "0x53"], "--address is for a slave"),
        ([IMU_ROUND, "--offset", "1 ms"], "--offset needs --uart"),
        ([IMU_ROUND, "--uart-file", HOST_FRAMES, "--offset", "1"], "--offset: '1' has no unit"),
        ([IMU_ROUND, "--uart-file", HOST_FRAMES, "--offset", ""], "--offset: '' has no unit"),
        ([IMU_ROUND, "--uart-file", f"{HOST_FRAMES},rx=7"], "there is no channel '7'"),
        ([IMU_ROUND, "--uart-file", f"{HOST_FRAMES},scl=0"], "--uart-file scl=0: there is no 'scl'; it has rx, rate"),
        ([IMU_ROUND, "--uart-file", IMU_ROUND], "which channel is RX? give --uart-file FILE,rx=CHANNEL"),
        ([IMU_ROUND, "--uart-file", f"{HOST_FRAMES},rate=quick"], "'quick' is no sample rate"),
        ([IMU_ROUND, "--uart-file", HOST_FRAMES, "--loop", "open"], "are for --loop closed --as slave"),
        ([IMU_ROUND, "--uart-file", HOST_FRAMES, "--case", RESPONDER], "no unit has SCI-A"),
        ([HOST_FRAMES, "--uart-file", HOST_FRAMES], "--uart-file needs an I2C capture"),
        ([HOST_FRAMES, "--loop", "open"], "--loop is for I2C captures"),
        ([HOST_FRAMES, "--tolerance", "1 us"], "--tolerance is for I2C captures"),
        ([IMU_ROUND, "--frame", "8n1"], "--frame is for UART captures"),
    ],
)
def test_contradictory_options_are_one_error_message_with_exit_status_2(periph_sim: Run, arguments, message):
    assert message in periph_sim.refused("replay", "--case", IMU, *arguments)


def test_the_page_shows_both_sides_of_the_first_divergence(periph_sim: Run, tmp_path):
    html = tmp_path / "wrong.html"
    status, _, err = periph_sim("replay", NACK, "--case", RESPONDER, *WRONG, "--html", str(html))
    assert (status, err) == (1, "")
    text = html.read_text(encoding="utf-8")
    assert "expected data read E5 at 0.001015 s of the capture" in text and "captured SDA" in text
    both = str(tmp_path / "both.svg")
    assert "--svg and --html both name" in periph_sim.refused(
        "replay", NACK, "--case", RESPONDER, "--html", both, "--svg", both
    )
