"""`periph-sim decode` on the traces of the repository and with wrong options."""

from __future__ import annotations

import csv
import io
import json
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.traces import formats
from periph_sim.traces.decode import i2c
from tests.interfaces.commands.conftest import Run
from tests.traces.formats.make_traces import read_registers
from tests.traces.formats.writers import I2cWave, frame_bits, metadata, sr_file, uart_wave, zip_bytes

TRACES = Path(__file__).resolve().parents[3] / "traces"
NACK = TRACES / "nack.sr"
FRAMES = TRACES / "host_frames.sr"


def i2c_and_uart(folder: Path) -> str:
    """Write a capture of an I2C read during which two serial frames begin. The channels have unusual names."""
    bus = I2cWave(20, 5, idle=100)
    read_registers(bus, 0x53, 0x00, (0xE5,))
    bus.idle(400)
    line = uart_wave(
        [(Fraction(200), frame_bits(0x41)), (Fraction(800), frame_bits(0xF3))], Fraction(40), len(bus.samples)
    )
    samples = bytes(a | b << 2 for a, b in zip(bus.samples, line, strict=True))
    return sr_file(folder / "both.sr", ["clock", "data", "out, host"], "4 MHz", samples)


def test_an_idle_serial_line_beside_an_i2c_bus_is_a_note(periph_sim: Run, tmp_path: Path):
    """A recording of a case that uses I2C only has such an RX line, which never changes."""
    bus = I2cWave(20, 5, idle=100)
    read_registers(bus, 0x53, 0x00, (0xE5,))
    bus.idle(40)
    path = sr_file(tmp_path / "run.sr", ["SCL", "SDA", "RX"], "4 MHz", bytes(sample | 4 for sample in bus.samples))
    result = periph_sim("decode", path, "--transfers")
    assert result.status == 0 and result.err == "note: RX is high throughout: nothing to decode\n"
    assert result.out.splitlines() == ["    time_s  transfer", "0.00002500  S 53 W A 00 A Sr 53 R A E5 N P"]
    alone = periph_sim("decode", path, "--uart", "rx=RX,baud=auto")
    assert alone.status == 0 and alone.err == result.err and alone.out.split() == ["time_s", "event", "value"]


def test_a_serial_line_that_cannot_be_guessed_does_not_stop_the_others(periph_sim: Run, tmp_path: Path):
    frames = [(Fraction(10 + 100 * n), frame_bits(0x41 + n)) for n in range(8)]
    line = uart_wave(frames, Fraction(10), 900)
    path = sr_file(
        tmp_path / "two.sr", ["RX", "TX"], "1 MHz", bytes(bit | (n < 300) << 1 for n, bit in enumerate(line))
    )
    result = periph_sim("decode", path)
    assert result.status == 0 and "0x41 'A'" in result.out
    assert "note: TX is not decoded: " in result.err and "describe it with --uart" in result.err


def test_an_uncertain_guess_is_used_only_on_request(periph_sim: Run, tmp_path: Path):
    """The capture has one byte, which fits most rates and frame formats."""
    path = sr_file(
        tmp_path / "one.sr", ["RX"], "1 MHz", uart_wave([(Fraction(10), frame_bits(0x41))], Fraction(10), 400)
    )
    message = periph_sim.refused("decode", path)
    assert message.startswith("RX is not decoded: in doubt, guessed 100000 baud, 8n1 (")
    assert message.endswith("12% sure), which baud=auto would use; describe it with --uart")
    result = periph_sim("decode", path, "--uart", "rx=RX,baud=auto")
    assert result.status == 0 and "0x41 'A'" in result.out
    assert result.err.endswith("12% sure); in doubt, so better state them\n")


@pytest.mark.parametrize("baud", [9600, 107_000, 230_400])
def test_a_stated_rate_that_does_not_fit_is_a_note_with_the_fitting_rate(periph_sim: Run, baud: int):
    result = periph_sim("decode", str(FRAMES), "--uart", f"rx=RX,baud={baud}")
    evidence = r"\d+ of \d+ frames have errors or edges between bits|most low pulses are [\d.]+ to [\d.]+ bits long"
    message = f"note: RX: ({evidence}) at {baud} baud, 8n1; the edges fit "
    assert result.status == 0 and re.fullmatch(message + "baud=115200\n", result.err)
    assert periph_sim("decode", str(FRAMES), "--uart", "rx=RX,baud=115200").err == ""


def test_buses_of_one_capture_are_distinguished_by_their_names(periph_sim: Run, tmp_path: Path):
    bus, other = I2cWave(20, 5), I2cWave(20, 5)
    bus.idle(100)
    read_registers(bus, 0x53, 0x00, (0xE5,))
    other.idle(160)
    read_registers(other, 0x50, 0x10, (0x77,))
    for wave in (bus, other):
        wave.idle(2400 - len(wave.samples))
    samples = bytes(a | b << 2 for a, b in zip(bus.samples, other.samples, strict=True))
    names = ["Sensor SCL", "Sensor SDA", "24LC515 SCL", "24LC515 SDA", "SDA_X"]
    path = sr_file(tmp_path / "two.sr", names, "4 MHz", samples)
    result = periph_sim("decode", path, "--transfers")
    assert [line.split(maxsplit=1)[1] for line in result.out.splitlines()] == [
        "bus                          transfer",
        "i2c Sensor SCL/Sensor SDA    S 53 W A 00 A Sr 53 R A E5 N P",
        "i2c 24LC515 SCL/24LC515 SDA  S 50 W A 10 A Sr 50 R A 77 N P",
    ]
    assert result.err == ("note: SDA_X is not decoded: which SCL belongs to it? give --i2c scl=CHANNEL,sda=CHANNEL\n")


def test_unrecorded_spans_and_an_impossible_rate_are_notes(periph_sim: Run, tmp_path: Path):
    (tmp_path / "gap.csv").write_text("Time [s],SCL,SDA\n0.0,1,1\n0.001,X,1\n0.002,1,1\n0.003,1,1\n")
    result = periph_sim("decode", str(tmp_path / "gap.csv"))
    assert result.status == 0
    assert result.err.startswith("note: SCL and SDA: 1 span was not recorded, 0.001000000 s in all, 0.001000000 s to ")
    result = periph_sim("decode", str(NACK), "--rate", "1 Hz")
    assert result.status == 0 and "start" in result.out
    assert "SCL would run at 0.025 Hz; expected 100 Hz to 5 MHz; then all times are wrong; state" in result.err


def test_a_glitch_in_samples_of_time_stamps_is_counted_on_their_grid(periph_sim: Run, tmp_path: Path):
    """The times are nanoseconds of a 125 MHz capture, so ten samples are 80 ns."""
    rows = [(0, 1), (80, 0), (160, 1), (800, 0), (808, 1), (9_000, 1)]
    text = "".join(f"{at / 1e9:.9f},1,{sda}\n" for at, sda in rows)
    (tmp_path / "spikes.csv").write_text("Time [s],SCL,SDA\n" + text)

    def starts(glitch: str) -> int:
        return periph_sim("decode", str(tmp_path / "spikes.csv"), "--glitch", glitch).out.count("start")

    assert [starts(glitch) for glitch in ("1", "2", "10", "11")] == [2, 1, 1, 0]
    assert [starts(glitch) for glitch in ("8ns", "9ns", "80ns", "81ns")] == [2, 1, 1, 0]


def test_each_line_is_an_event(periph_sim: Run):
    result = periph_sim("decode", str(NACK))
    assert result.status == 0 and result.err == ""
    assert result.out.splitlines()[:8] == [
        "    time_s  event           value",
        "0.00010000  start",
        "0.00011000  address         0x53      write",
        "0.00019000  nack",
        "0.00020500  stop",
        "0.00041000  start",
        "0.00042000  address         0x53      write",
        "0.00050000  nack",
    ]


def test_each_line_is_a_transfer(periph_sim: Run):
    assert periph_sim("decode", str(NACK), "--transfers").out.splitlines() == [
        "    time_s  transfer",
        "0.00010000  S 53 W N P",
        "0.00041000  S 53 W N P",
        "0.00072000  S 53 W A 00 A Sr 53 R A E5 N P",
    ]


def test_times_are_exact_and_ends_are_shown(periph_sim: Run):
    lines = periph_sim("decode", str(NACK), "--times").out.splitlines()
    assert lines[0].split() == ["time_s", "end_s", "position", "end", "event", "value"]
    assert lines[2].split() == ["0.00011000", "0.00018500", "440", "740", "address", "0x53", "write"]


def test_serial_frames_are_decoded_at_a_guessed_rate(periph_sim: Run):
    result = periph_sim("decode", str(FRAMES))
    assert result.err.startswith("note: RX: guessed 115200 baud, 8n1 (")
    assert result.out.splitlines()[3].split(maxsplit=2) == ["0.000474", "frame", "0x69 'i'"]
    stated = periph_sim("decode", str(FRAMES), "--uart", "rx=RX,baud=115200")
    assert stated.out == result.out and stated.err == ""


def test_a_line_is_a_burst_of_frames(periph_sim: Run):
    assert periph_sim("decode", str(FRAMES), "--uart", "rx=RX,baud=115200", "--transfers").out.splitlines() == [
        "  time_s  transfer",
        "0.000300  00 00 69 03 2F F9 00 00 00 00 18 FC",
        "0.005300  11 00 7A 03 40 F9 0C 00 F7 FF 15 FC",
    ]


def test_json_lines_hold_what_the_decoder_found(periph_sim: Run):
    result = periph_sim("decode", str(NACK), "--format", "json")
    objects = [json.loads(line) for line in result.out.splitlines()]
    events = i2c.events(formats.read(NACK))
    assert [found["position"] for found in objects] == [event.at for event in events]
    assert [found["value"] for found in objects if found["value"] is not None] == [
        event.value for event in events if event.kind.name in ("ADDRESS", "DATA")
    ]
    assert objects[1] == {
        "time_s": 0.00011,
        "end_s": 0.000185,
        "position": 440,
        "end": 740,
        "bus": "i2c SCL/SDA",
        "event": "address",
        "value": 0x53,
        "bits": 8,
        "detail": "write",
    }


def test_events_of_several_buses_are_in_order_of_time(periph_sim: Run, tmp_path: Path):
    options = ("--i2c", "scl=clock,sda=data", "--uart", "rx=2,baud=100000")
    result = periph_sim("decode", i2c_and_uart(tmp_path), *options, "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(result.out)))
    times = [Fraction(row["time_s"]) for row in rows]
    assert times == sorted(times)
    assert [(row["bus"], row["value"]) for row in rows if row["value"]] == [
        ("i2c clock/data", str(0x53)),
        ("uart out, host", str(0x41)),
        ("i2c clock/data", "0"),
        ("uart out, host", str(0xF3)),
        ("i2c clock/data", str(0x53)),
        ("i2c clock/data", str(0xE5)),
    ]
    result = periph_sim("decode", i2c_and_uart(tmp_path), *options, "--transfers")
    assert [line.split(maxsplit=1)[1] for line in result.out.splitlines()] == [
        "bus             transfer",
        "i2c clock/data  S 53 W A 00 A Sr 53 R A E5 N P",
        "uart out, host  41 F3",
    ]
    for style in ("csv", "json"):
        result = periph_sim("decode", i2c_and_uart(tmp_path), *options, "--transfers", "--format", style)
        read = csv.DictReader(io.StringIO(result.out)) if style == "csv" else map(json.loads, result.out.splitlines())
        assert [row["transfer"] for row in read] == ["S 53 W A 00 A Sr 53 R A E5 N P", "41 F3"]


def test_frames_with_errors_and_cut_frames_are_marked(periph_sim: Run, tmp_path: Path):
    frames = [
        (Fraction(50), [*frame_bits(0x31, 8, "odd")[:-1], 0]),
        (Fraction(400), [0] * 14),
        (Fraction(700), [0, 1, 0]),
    ]
    path = sr_file(tmp_path / "line.sr", ["RX"], "1 MHz", uart_wave(frames, Fraction(10), 738))
    result = periph_sim("decode", path, "--uart", "rx=RX,baud=100000,format=8e1")
    assert [line.split(maxsplit=1)[1] for line in result.out.splitlines()[1:]] == [
        "frame           0x31 '1'  parity error, frame error",
        "frame           0x00      frame error",
        "break",
        "cut             101b",
    ]


@pytest.fixture
def spike(tmp_path: Path) -> str:
    """A capture of 0x4B at 100 kbaud with a spike of one sample in its first bit and another before the frame."""
    samples = bytearray(uart_wave([(Fraction(250), frame_bits(0x4B))], Fraction(40), 800))
    samples[250 + 60] ^= 1
    samples[100] ^= 1
    return sr_file(tmp_path / "spike.sr", ["RX"], "4 MHz", bytes(samples))


def test_glitched_frames_and_rejected_starts_are_marked(periph_sim: Run, spike: str):
    assert periph_sim("decode", spike, "--uart", "rx=RX,baud=100000").out.splitlines()[1:] == [
        "0.00002500  rejected start",
        "0.00006250  frame           0x4A 'J'  glitch",
    ]
    asked = ("decode", spike, "--uart", "rx=RX,baud=100000", "--transfers")
    assert periph_sim(*asked).out.splitlines()[1:] == ["0.00002500  rejected start 4A(glitch)"]


def test_a_vote_of_three_samples_ignores_a_glitch(periph_sim: Run, spike: str):
    result = periph_sim("decode", spike, "--uart", "rx=RX,baud=100000,vote")
    assert result.out.splitlines()[-1] == "0.00006250  frame           0x4B 'K'  glitch"
    assert "vote=3; expected vote without a value" in periph_sim.refused(
        "decode", spike, "--uart", "rx=RX,baud=100000,vote=3"
    )


def test_glitches_are_filtered_on_request(periph_sim: Run, spike: str):
    asked = ("decode", spike, "--uart", "rx=RX,baud=100000", "--transfers")
    for shortest in ("2", "300ns", "0.26us"):
        assert periph_sim(*asked, "--glitch", shortest).out.splitlines()[1:] == ["0.00006250  4B"]
    assert periph_sim(*asked, "--glitch", "250ns").out.split()[-1] == "4A(glitch)"


def test_without_a_rate_positions_are_shown(periph_sim: Run, tmp_path: Path):
    path = tmp_path / "no_rate.sr"
    bus = I2cWave(4, 1, idle=10)
    read_registers(bus, 0x53, 0x00, (0xE5,))
    unsaid = metadata(["SCL", "SDA"], "").replace(b"samplerate=\n", b"")
    path.write_bytes(zip_bytes({"version": b"2", "metadata": unsaid, "logic-1-1": bytes(bus.samples)}))
    result = periph_sim("decode", str(path), "--transfers")
    assert result.out.splitlines() == ["position  transfer", "      10  S 53 W A 00 A Sr 53 R A E5 N P"]
    assert periph_sim("decode", str(path), "--transfers", "--rate", "1 MHz").out.split()[2] == "0.000010"
    assert "states no rate" in periph_sim("decode", str(path), "--glitch", "50ns").err


def test_an_idle_bus_is_no_error(periph_sim: Run, tmp_path: Path):
    path = sr_file(tmp_path / "idle.sr", ["SCL", "SDA"], "1 MHz", bytes([3]) * 100)
    for more in ((), ("--transfers",), ("--times",)):
        assert len(periph_sim.passes("decode", path, *more).splitlines()) == 1
    assert periph_sim("decode", path, "--format", "json").out == ""
    assert periph_sim("decode", path, "--format", "json", "--transfers").out == ""


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--i2c", "scl=SCL"), "--i2c scl=SCL: sda is missing; expected scl=CHANNEL,sda=CHANNEL"),
        (("--i2c", "scl=SCL,sda=SCL"), "--i2c scl=SCL,sda=SCL: two lines are one channel; expected a channel each"),
        (("--i2c", "scl=SCL,sad=SDA"), "--i2c scl=SCL,sad=SDA: there is no 'sad'; did you mean sda?"),
        (("--i2c", "scl=SCK,sda=SDA"), "there is no channel 'SCK'; did you mean SCL?"),
        (("--uart", "baud=9600"), "--uart baud=9600: rx or tx is missing; expected rx=CHANNEL,baud=RATE"),
        (("--uart", "rx=SDA,baud=fast"), "'fast' is no baud rate; expected a number, or auto"),
        (("--uart", "rx=SDA,baud=0"), "baud is 0; expected more than 0"),
        (
            ("--uart", "rx=SDA,baud=9600,format=8x1"),
            "'8x1' is no frame; expected data bits, one of n, o, e, m, s, and stop",
        ),
        (("--uart", "rx=SDA,baud=9600,format=77n1"), "77 data bits; expected 1 to 16"),
        (("--uart", "rx=SDA,baud=9600,invert=yes"), "invert=yes; expected invert without a value"),
        (("--uart", "rx=SDA,rx=SCL,baud=9600"), "rx is given twice; expected once"),
        (("--uart", "rx=,baud=9600"), "rx has no value; expected rx=..."),
        (("--uart", "rx=SDA,baud=9000000"), "0.44 samples a bit at 9000000 baud; expected at least 2"),
        (
            ("--glitch", "50 parsecs"),
            "--glitch: '50 parsecs' is no time; expected one such as 50ns, 1.5us, or whole samples",
        ),
        (("--glitch", "1.5"), "--glitch: '1.5' is no time"),
        (("--rate", "quick"), "--rate: 'quick' is no sample rate"),
        (("--format", "xml"), "'xml' is not one of"),
        (("--format", "csv", "--json"), "--json and --format csv are two formats; give one of them"),
    ],
)
def test_a_wrong_option_is_one_error_message(periph_sim: Run, options: tuple[str, ...], sentence: str):
    assert sentence in periph_sim.refused("decode", str(NACK), *options)


def test_channels_with_unknown_names_must_be_mapped(periph_sim: Run, tmp_path: Path):
    path = sr_file(tmp_path / "plain.sr", ["0", "1"], "1 MHz", bytes([3]) * 100)
    assert "no channels are named scl and sda, rx or tx, it has 0 (index 0), 1 (index 1)" in periph_sim.refused(
        "decode", path
    )


def test_a_missing_file_is_an_error(periph_sim: Run, tmp_path: Path):
    assert "gone.sr, the file: found no such file or directory" in periph_sim.refused(
        "decode", str(tmp_path / "gone.sr")
    )


def test_a_pipe_that_its_reader_closes_is_no_error(tmp_path: Path):
    bus = I2cWave(2, 1)
    bus.start()
    for _ in range(20_000):
        bus.byte(0x55)
    path = sr_file(tmp_path / "long.sr", ["SCL", "SDA"], "1 MHz", bytes(bus.samples))
    with subprocess.Popen(
        [sys.executable, "-m", "periph_sim", "decode", path], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as running:
        assert running.stdout is not None and running.stderr is not None
        running.stdout.readline()
        running.stdout.close()
        assert running.stderr.read() == b""
        assert running.wait(timeout=60) == 0


def test_a_damaged_file_is_read_up_to_the_damage_on_request(periph_sim: Run, tmp_path: Path):
    path = tmp_path / "short.sr"
    path.write_bytes((TRACES / "imu_round.sr").read_bytes()[:6000])
    assert "--salvage" in periph_sim.refused("decode", str(path))
    result = periph_sim("decode", str(path), "--salvage", "--transfers")
    assert result.status == 0 and "note: " in result.err and "are dropped" in result.err
    assert result.out.splitlines()[1].endswith("S 68 W A 1D A Sr 68 R A 00 A 12 A FF A F3 A 00 A 05 N P")
    assert result.out.splitlines()[2].endswith("FB A [111111]")
