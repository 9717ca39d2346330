"""`periph-sim decode --format logic2` against a table exported by Logic 2 and against another decoder."""

from __future__ import annotations

import csv
from fractions import Fraction
from pathlib import Path

import pytest

from tests.captures.where import FOLDER, needs_captures, oracle
from tests.interfaces.commands.conftest import Run
from tests.interfaces.commands.test_decode_reports import NAMES, decode_arguments
from tests.interfaces.commands.test_decode_spi import EIGHT, LINES, recorded
from tests.traces.formats.writers import I2cWave, frame_bits, metadata, sr_file, uart_wave, zip_bytes

TRACES = Path(__file__).resolve().parents[3] / "traces"
I2C_TITLES = 'name,type,start_time,duration,"ack","address","read","data"'


@needs_captures
def test_frames_equal_those_exported_by_logic_2(periph_sim: Run):
    """Logic 2 rounds durations to two samples of 2 ns."""
    path = str(FOLDER / "uart_async115200_csv.csv")
    result = periph_sim("decode", path, "--uart", "rx=Channel 0,baud=115200", "--format", "logic2")
    theirs = (FOLDER / "uart_async115200_csv.saleae.csv").read_text("utf-8").splitlines()
    assert result.out.splitlines()[0] == theirs[0]
    ours = list(csv.reader(result.out.splitlines()[1:]))
    assert len(ours) == len(theirs) - 1 == 2240
    for own, their in zip(ours, csv.reader(theirs[1:]), strict=True):
        assert (own[1], float(own[2]), own[4:]) == (their[1], float(their[2]), their[4:])
        assert abs(float(own[3]) - float(their[3])) <= 4.1e-9


@pytest.mark.parametrize("name", NAMES)
def test_i2c_rows_equal_the_annotations_of_another_decoder(periph_sim: Run, name: str):
    """Logic 2 has a row for each START, STOP and byte; the ACK is in the row of its byte."""
    result = periph_sim(*decode_arguments(name, "--format", "logic2"))
    assert result.status == 0 and result.out.splitlines()[0] in (I2C_TITLES, f'{I2C_TITLES},"error"')
    ours = []
    for row in csv.DictReader(result.out.splitlines()):
        assert row["name"] == "I2C"
        if row["type"] == "address":
            ours.append(f"Address {'read' if row['read'] == 'true' else 'write'}: {int(row['address'], 16):02X}")
        else:
            ours.append({"start": "Start", "stop": "Stop"}.get(row["type"]) or f"Data: {int(row['data'], 16):02X}")
        if row["ack"]:
            ours.append("ACK" if row["ack"] == "true" else "NACK")
    theirs = [message.text for message in oracle(name, "i2c") if message.text not in ("Read", "Write")]
    for long, short in (("Start repeat", "Start"), ("Data read", "Data"), ("Data write", "Data")):
        theirs = [text.replace(long, short) for text in theirs]
    assert ours == theirs


def test_without_events_there_are_only_titles(periph_sim: Run, tmp_path: Path):
    path = sr_file(tmp_path / "idle.sr", ["SCL", "SDA"], "4 MHz", bytes([3]) * 100)
    assert periph_sim("decode", path, "--format", "logic2").out == f"{I2C_TITLES}\n"


def test_an_i2c_byte_lasts_from_its_first_rise_to_the_fall_after_its_ack(periph_sim: Run):
    result = periph_sim("decode", str(TRACES / "nack.sr"), "--format", "logic2", "--first", "1")
    assert result.out.splitlines() == [
        I2C_TITLES,
        '"I2C","start",0.00010000,0.00000025,,,,',
        '"I2C","address",0.00011000,0.00008500,false,0x53,false,',
        '"I2C","stop",0.00020500,0.00000025,,,,',
    ]


def test_a_byte_without_an_ack_slot_is_an_error_and_single_bits_are_omitted(periph_sim: Run, tmp_path: Path):
    """Logic 2's analyzer determines the direction with the ACK, so the row of a cut address has the whole byte."""
    path = I2cWave(20, 5, idle=100).play("S 1: P .100 S 10100110:").saved(tmp_path)
    lines = periph_sim("decode", path, "--format", "logic2").out.splitlines()
    assert lines[0] == f'{I2C_TITLES},"error"'
    assert [line.split(",")[1] + "," + ",".join(line.split(",")[4:]) for line in lines[1:]] == [
        '"start",,,,,',
        '"stop",,,,,',
        '"start",,,,,',
        '"data",,,,0xA6,missing ack/nak',
    ]


def test_the_bytes_of_a_10_bit_address_are_an_address_and_data(periph_sim: Run, tmp_path: Path):
    path = I2cWave(20, 5, idle=100).play("S F4+ A5+ Sr F5+ 22- P").saved(tmp_path)
    rows = list(csv.reader(periph_sim("decode", path, "--format", "logic2").out.splitlines()[1:]))
    assert [row[1:2] + row[4:] for row in rows if row[1] in ("address", "data")] == [
        ["address", "true", "0x7A", "false", ""],
        ["data", "true", "", "", "0xA5"],
        ["address", "true", "0x7A", "true", ""],
        ["data", "false", "", "", "0x22"],
    ]


def test_spi_lines_share_their_rows(periph_sim: Run, tmp_path: Path):
    flash = recorded(tmp_path, EIGHT, (0x9F, 0x00), (0x12, 0x34))
    lines = periph_sim("decode", flash, "--spi", LINES, "--format", "logic2").out.splitlines()
    assert lines[0] == 'name,type,start_time,duration,"mosi","miso"'
    one = [[line.split(",")[1], *line.split(",")[4:]] for line in lines[1:5]]
    assert one == [
        ['"enable"', "", ""],
        ['"result"', "0x9F", "0x00"],
        ['"result"', "0x12", "0x34"],
        ['"disable"', "", ""],
    ]
    first = periph_sim("decode", flash, "--spi", LINES, "--first", "1", "--transfers").out.splitlines()
    assert [line.split()[1:3] for line in first[1:]] == [["spi", "MOSI"], ["spi", "MISO"]], "one transfer, two lines"
    lines = periph_sim("decode", flash, "--spi", "clk=CLK,miso=MISO,cs=CS", "--format", "logic2").out.splitlines()
    assert lines[2].endswith(",,0x00")
    apart = ("--spi", "clk=CLK,mosi=MOSI,cs=CS", "--spi", "clk=CLK,miso=MISO,cs=CS")
    lines = periph_sim("decode", flash, *apart, "--format", "logic2").out.splitlines()
    assert [line.rpartition('"result"')[2].split(",")[3:] for line in lines[3:5]] == [["0x9F", ""], ["", "0x00"]]


def test_several_buses_share_one_table(periph_sim: Run, tmp_path: Path):
    wave = I2cWave(20, 5, idle=100)
    wave.transfer(0xA6, 0x11)
    wave.idle(2000)
    bad = [*frame_bits(0x55)[:-1], 0]
    line = uart_wave([(Fraction(200), frame_bits(0x41)), (Fraction(900), bad)], Fraction(40), len(wave.samples))
    samples = bytes(a | b << 2 for a, b in zip(wave.samples, line, strict=True))
    path = sr_file(tmp_path / "mixed.sr", ["SCL", "SDA", "RX"], "4 MHz", samples)
    uart = ("--uart", "rx=RX,baud=100000", "--uart", "tx=RX,baud=100000")
    lines = periph_sim("decode", path, "--i2c", "scl=0,sda=1", *uart, "--format", "logic2").out.splitlines()
    assert lines[0] == f'{I2C_TITLES},"error"'
    times = [float(line.split(",")[2]) for line in lines[1:]]
    assert times == sorted(times)
    names = [line.partition(",")[0] for line in lines[1:]]
    assert {name: names.count(name) for name in names} == {'"I2C"': 4, '"Async Serial"': 2, '"Async Serial [1]"': 2}
    assert lines[-1].split(",")[3] == f"{9.5 * 40 / 4e6:.8f}", "up to the middle of the stop bit"
    assert lines[-1].split(",")[1:2] + lines[-1].split(",")[4:] == ['"data"', "", "", "", "0x55", "framing"]


def test_a_capture_without_rate_has_no_times(periph_sim: Run, tmp_path: Path):
    path = tmp_path / "no_rate.sr"
    unsaid = metadata(["SCL", "SDA"], "").replace(b"samplerate=\n", b"")
    path.write_bytes(zip_bytes({"version": b"2", "metadata": unsaid, "logic-1-1": bytes([3, 3, 1, 3, 3])}))
    for options, message in (
        (("--format", "logic2"), f"--format logic2: {path} states no rate; packets have times, state --rate"),
        (("--glitches",), f"--glitches: {path} states no rate; state --rate, or the width with --glitch in samples"),
    ):
        assert periph_sim.refused("decode", str(path), *options) == message
    result = periph_sim("decode", str(path), "--glitches", "--glitch", "2", "--format", "csv")
    assert result.out.splitlines()[1:] == ["2,SDA,low,1,SCL high"]
    assert periph_sim("decode", str(path), "--counts", "--json").json_object["transfers"] == 1
