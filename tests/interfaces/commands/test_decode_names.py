"""`periph-sim decode --chip` and `--case`: the register of each byte, with names and scales of the data sheets."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Span
from tests.interfaces.commands.conftest import Run
from tests.scene.test_plugins import BAROMETER, PROJECT
from tests.traces.formats.make_traces import ROUND, read_registers
from tests.traces.formats.writers import I2cWave, sr_file

ROUND_SR = Path(__file__).resolve().parents[3] / "traces" / "imu_round.sr"
CHIPS = ("--chip", "itg3200", "--chip", "0x53=adxl345", "--chip", "hmc5883l")
# For each message of ROUND: its data registers in the order of the bytes, the scale, and the byte order, all from the
# data sheets.
SHEETS = (
    ("GYRO_XOUT_H GYRO_XOUT_L GYRO_YOUT_H GYRO_YOUT_L GYRO_ZOUT_H GYRO_ZOUT_L", 14.375, "deg/s", "big"),
    ("DATAX0 DATAX1 DATAY0 DATAY1 DATAZ0 DATAZ1", 256, "g", "little"),
    ("DXRA DXRB DZRA DZRB DYRA DYRB", 1090, "gauss", "big"),
)
ADC = """\
name = "adc"
duration = "1 ms"

[unit.dsp]
firmware = "still.py"
modules = ["I2C-A", "GPIO"]
pins = { DRDY = 12 }

[device.adc]
model = "registers"
address = 0x48
interrupt = { wire = "DRDY", register = "VALUE" }

[[device.adc.register]]
name = "VALUE"
at = 1
width = 16

[device.own]
model = "own.py"
address = 0x42
"""


OWN = """\
class Device:
    def __init__(self, bus):
        pass

    def on_write(self, byte):
        return True

    def on_read(self):
        return 0
"""


def drawn(folder: Path, *transfers: Sequence[int], reads: Sequence[tuple[int, int, Sequence[int]]] = ()) -> str:
    """Write a capture of transfers with these bytes, then of reads, each an address, a pointer and the values."""
    wave = I2cWave(20, 5, idle=100)
    for values in transfers:
        wave.transfer(*values, nack_last=bool(values[0] & 1))
        wave.idle(100)
    for address, pointer, values in reads:
        read_registers(wave, address, pointer, values)
        wave.idle(100)
    return wave.saved(folder)


def named(periph_sim: Run, file: str, *options: str) -> list[tuple[str, str, str]]:
    """Return the byte, the register and the meaning of each data row."""
    result = periph_sim("decode", file, "--format", "csv", *options)
    assert result.status == 0
    rows = list(csv.DictReader(result.out.splitlines()))
    return [(f"{int(row['value']):02X}", row["register"], row["meaning"]) for row in rows if row["event"] == "data"]


def test_a_round_has_the_registers_and_quantities_of_the_data_sheets(periph_sim: Run):
    expected = []
    for (_, pointer, values), (registers, scale, unit, order) in zip(ROUND, SHEETS, strict=True):
        names = registers.split()
        expected.append((f"{pointer:02X}", "pointer", names[0]))
        for place, (name, value) in enumerate(zip(names, values, strict=True)):
            meaning = ""
            if place % 2:
                pair = values[place - 1 : place + 1]
                word = int.from_bytes(pair, "big" if order == "big" else "little", signed=True)
                meaning = f"{word} = {word / scale:.4g} {unit}"
            expected.append((f"{value:02X}", name, meaning))
    assert named(periph_sim, str(ROUND_SR), *CHIPS) == expected


def test_each_format_has_the_names_on_request_only(periph_sim: Run):
    first = ("--first", "1", "--chip", "0x68=itg3200")
    result = periph_sim("decode", str(ROUND_SR), *first)
    assert "address         0x68      read, itg3200\n" in result.out
    assert "data            0xF3      read, GYRO_YOUT_L: -13 = -0.9043 deg/s\n" in result.out
    assert result.err == (
        "note: itg3200: no write to its registers before its data; quantities are at the scale after power-on\n"
    )
    transfer = (
        "S 68 W(itg3200) A 1D(pointer: GYRO_XOUT_H) A Sr 68 R(itg3200) A 00(GYRO_XOUT_H) A "
        "12(GYRO_XOUT_L: 18 = 1.252 deg/s) A FF(GYRO_YOUT_H) A F3(GYRO_YOUT_L: -13 = -0.9043 deg/s) A "
        "00(GYRO_ZOUT_H) A 05(GYRO_ZOUT_L: 5 = 0.3478 deg/s) N P"
    )
    assert periph_sim("decode", str(ROUND_SR), *first, "--transfers").out.splitlines()[1].endswith(transfer)
    whole = periph_sim("decode", str(ROUND_SR), *first, "--json").json_object
    assert whole["transfer"] == transfer
    byte = whole["messages"][1]["bytes"][1]
    assert (byte["value"], byte["register"], byte["meaning"]) == (0x12, "GYRO_XOUT_L", "18 = 1.252 deg/s")
    events = [
        json.loads(line)
        for line in periph_sim("decode", str(ROUND_SR), *first, "--format", "json").out.split("\n")[:-1]
    ]
    assert [event.get("register") for event in events[:4]] == [None, "itg3200", None, "pointer"]
    plain = periph_sim("decode", str(ROUND_SR), "--first", "1", "--json").out
    assert "itg3200" not in plain and "register" not in plain


def test_quantities_use_the_scale_that_the_controller_sets(periph_sim: Run, tmp_path: Path):
    """ADXL345: 16 g in 10 bits is 32 LSB/g; left-justified, the lowest bit is bit 6; full resolution is 256 LSB/g."""
    file = drawn(
        tmp_path,
        *((0xA6, 0x31, 0x03), (0xA6, 0x32), (0xA7, 0x40, 0x00)),
        *((0xA6, 0x31, 0x07), (0xA6, 0x32), (0xA7, 0x00, 0x08)),
        *((0xA6, 0x31, 0x0B), (0xA6, 0x32), (0xA7, 0x00, 0x01)),
    )
    result = periph_sim("decode", file, "--chip", "adxl345", "--transfers")
    assert result.err == ""
    assert re.findall(r"DATAX1: ([^)]*)|DATA_FORMAT: ([^)]*)", result.out) == [
        ("", "Range=0x3"),
        ("64 = 2 g", ""),
        ("", "Justify=0x1 Range=0x3"),
        ("2048 = 1 g", ""),
        ("", "FULL_RES=0x1 Range=0x3"),
        ("256 = 1 g", ""),
    ]


def test_the_register_pointer_increments_as_in_the_device(periph_sim: Run, tmp_path: Path):
    """HMC5883L: 0x03 follows 0x08. -4096 means an overflow. Registers that do not exist are called reserved."""
    file = drawn(tmp_path, reads=[(0x1E, 0x07, (0xF0, 0x00, 0xF0, 0x00)), (0x1E, 0x0C, (0x33, 0x10))])
    assert named(periph_sim, file, "--chip", "hmc5883l") == [
        ("07", "pointer", "DYRA"),
        ("F0", "DYRA", ""),
        ("00", "DYRB", "-4096 = overflow"),
        ("F0", "DXRA", ""),
        ("00", "DXRB", "-4096 = overflow"),
        ("0C", "pointer", "IRC"),
        ("33", "IRC", ""),
        ("10", "CRA", "DO=0x4"),
    ]
    file = drawn(tmp_path, (0xD0, 0x3D, 0x00))
    assert named(periph_sim, file, "--chip", "itg3200") == [("3D", "pointer", "0x3d"), ("00", "0x3d", "reserved")]


def test_a_memory_wraps_in_its_page_and_has_blocks(periph_sim: Run, tmp_path: Path):
    """A second write follows at once: the recorded memory acknowledged it, so the model must not be busy."""
    file = drawn(tmp_path, (0xA4, 0x0E, 1, 2, 3), (0xA4, 0x10, 4))
    assert [row[1:] for row in named(periph_sim, file, "--chip", "24c16")] == [
        ("pointer", "0x020e"),
        ("0x020e", ""),
        ("0x020f", ""),
        ("0x0200", ""),
        ("pointer", "0x0210"),
        ("0x0210", ""),
    ]


def test_an_unknown_register_has_no_name(periph_sim: Run, tmp_path: Path):
    """Without a name: bytes before the first pointer, an address without ACK, and bytes that the model refuses."""
    file = drawn(tmp_path, (0xA1, 0x11))
    assert named(periph_sim, file, "--chip", "24c02") == [("11", "", "")]
    nack = str(ROUND_SR.with_name("nack.sr"))
    result = periph_sim("decode", nack, "--chip", "adxl345", "--transfers", "--first", "1")
    assert result.out.splitlines()[1].split(maxsplit=1)[1] == "S 53 W N P"
    file = drawn(tmp_path, (0xDE, 0x00, 0x30, 0x50, 0x59))  # a clock whose WEL latch is not set
    assert named(periph_sim, file, "--chip", "isl12026")[1:] == [
        ("30", "pointer", "SC"),
        ("50", "", ""),
        ("59", "", ""),
    ]
    file = drawn(tmp_path, (0xDE, 0x00, 0x3F, 0x02), (0xDE, 0x00, 0x3F, 0x06), (0xDE, 0x00, 0x32, 0x95))
    assert named(periph_sim, file, "--chip", "isl12026")[3:] == [
        *[("00", "pointer", ""), ("3F", "pointer", "SR"), ("06", "SR", "RWEL=0x1 WEL=0x1")],
        *[("00", "pointer", ""), ("32", "pointer", "HR"), ("95", "HR", "MIL=0x1 H=0x15")],
    ]


def test_a_byte_that_the_captured_device_refused_changes_nothing(periph_sim: Run, tmp_path: Path):
    wave = I2cWave(20, 5, idle=100)
    for values in ((0xA6, 0x31, 0x03), (0xA6, 0x32)):
        for value in ((0xA6, 0x32), (0xA7, 0x40, 0x00)):
            wave.transfer(*value, nack_last=bool(value[0] & 1))
        wave.transfer(*values, nack_last=True)
    wave.transfer(0xA7, 0x40, 0x00, nack_last=True)
    path = wave.saved(tmp_path)
    result = periph_sim("decode", path, "--chip", "adxl345", "--transfers")
    assert [line.split(maxsplit=1)[1] for line in result.out.splitlines()[3:]] == [
        "S 53 W(adxl345) A 31(pointer: DATA_FORMAT) A 03 N P",
        "S 53 W(adxl345) A 32(pointer: DATAX0) A P",
        "S 53 R(adxl345) A 40(DATAX0) A 00(DATAX1: 64 = 0.25 g) N P",
        "S 53 W(adxl345) A 32 N P",
        "S 53 R(adxl345) A 40 A 00 N P",
    ]


def test_after_a_gap_of_the_capture_the_register_is_unknown(periph_sim: Run, tmp_path: Path):
    """The lines are unknown between two transfers, where the pointer and the scale may have changed."""
    file = drawn(tmp_path, (0xA6, 0x31, 0x03), (0xA6, 0x32), (0xA7, 0x40, 0x00), (0xA6, 0x32), (0xA7, 0x40, 0x00))
    capture = formats.read(Path(file))
    starts = [json.loads(line)["position"] for line in periph_sim("decode", file, "--json").out.splitlines()]
    holes = tuple(Span(start - 60, start - 40) for start in (starts[2], starts[4]))
    lines = tuple(replace(line, unknown=holes) for line in capture.channels)
    formats.write(replace(capture, channels=lines), tmp_path / "gaps.vcd")
    result = periph_sim("decode", str(tmp_path / "gaps.vcd"), "--chip", "adxl345", "--transfers")
    assert [line.split(maxsplit=1)[1] for line in result.out.splitlines()[3:]] == [
        "S 53 R(adxl345) A 40 A 00 N P",
        "S 53 W(adxl345) A 32(pointer: DATAX0) A P",
        "S 53 R(adxl345) A 40 A 00 N P",
    ]
    assert "scale" not in result.err, "no quantity is shown"
    whole = periph_sim("decode", file, "--chip", "adxl345", "--transfers")
    assert whole.out.count("40(DATAX0) A 00(DATAX1: 64 = 2 g) N P") == 2
    lines = tuple(replace(line, unknown=(Span(starts[1] - 60, starts[1] - 40),)) for line in capture.channels)
    formats.write(replace(capture, channels=lines), tmp_path / "gap.vcd")
    result = periph_sim("decode", str(tmp_path / "gap.vcd"), "--chip", "adxl345", "--transfers")
    assert result.out == whole.out and result.err.endswith(
        "note: adxl345: no write to its registers since a gap; quantities are at the scale before the gap\n"
    )


def test_a_case_names_its_own_devices(periph_sim: Run, desk: Path):
    (desk / "adc.toml").write_text(ADC, "utf-8")
    (desk / "own.py").write_text(OWN, "utf-8")
    file = drawn(desk, reads=[(0x48, 0x01, (0x12, 0x34, 0)), (0x42, 0x01, (0x12,))])
    result = periph_sim("decode", file, "--case", "adc.toml", "--transfers")
    assert result.status == 0 and [line.split(maxsplit=1)[1] for line in result.out.splitlines()[1:]] == [
        "S 48 W(adc) A 01(pointer: VALUE) A Sr 48 R(adc) A 12(VALUE) A 34(VALUE: 0x1234) A 00(0x03: not in the map) "
        "N P",
        "S 42 W(own) A 01 A Sr 42 R(own) A 12 N P",
    ]


def test_option_chip_replaces_the_device_of_the_case(periph_sim: Run):
    case = ROUND_SR.parents[1] / "timing" / "imu_chips.toml"
    result = periph_sim("decode", str(ROUND_SR), "--case", str(case), "--chip", "itg3200", "--transfers")
    assert re.findall(r"S (\w\w) W\((\w+)\)", result.out) == [
        ("68", "itg3200"),
        ("53", "accelerometer"),
        ("1E", "magnetometer"),
    ]


def test_each_bus_has_a_device_of_its_own(periph_sim: Run, tmp_path: Path):
    waves = []
    for idle, pointer in ((100, 0x32), (2000, 0x34)):
        wave = I2cWave(20, 5, idle=idle)
        wave.transfer(0xA6, pointer)
        read_registers(wave, 0x53, pointer, (1,))
        wave.idle(5000 - len(wave.samples))
        waves.append(wave.samples)
    samples = bytes(one | other << 2 for one, other in zip(*waves, strict=True))
    path = sr_file(tmp_path / "two.sr", ["SCL1", "SDA1", "SCL2", "SDA2"], "4 MHz", samples)
    assert named(periph_sim, path, "--chip", "adxl345") == [
        *[("32", "pointer", "DATAX0")] * 2,
        *[("01", "DATAX0", "")],
        *[("34", "pointer", "DATAY0")] * 2,
        *[("01", "DATAY0", "")],
    ]


def test_a_strict_case_does_not_stop_decoding_at_a_refused_write(periph_sim: Run, desk: Path):
    unit = ADC.partition("[device.adc]")[0]
    (desk / "clock.toml").write_text(f'strict = true\n{unit}[device.clock]\nmodel = "isl12026"\n', "utf-8")
    file = drawn(desk, (0xDE, 0x00, 0x30, 0x50))
    assert named(periph_sim, file, "--case", "clock.toml")[1:] == [("30", "pointer", "SC"), ("50", "", "")]


def test_a_chip_of_a_plugin_has_names_from_its_own_file(periph_sim: Run, here: Path):
    (here / "pyproject.toml").write_text(PROJECT, "utf-8")
    (here / "barometer.py").write_text(BAROMETER, "utf-8")
    file = drawn(here, reads=[(0x77, 0x00, (0x12, 0x34))])
    assert named(periph_sim, file, "--chip", "barometer") == [
        ("00", "pointer", "P0"),
        ("12", "P0", ""),
        ("34", "P1", ""),
    ]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--chip", "itg3000"], "--chip itg3000: there is no chip 'itg3000'; did you mean itg3200?"),
        (["--chip", "0x1e=itg3200"], "--chip: itg3200 has no address 0x1e; it can have 0x68 or 0x69"),
        (["--chip", "=itg3200"], "--chip: '' is no 7-bit address; expected 0 to 0x7F, right-aligned"),
        (["--chip", "itg3200", "--chip", "0x68=itg3200"], "--chip: itg3200 has the address 0x68 too"),
        (
            ["--chip", "0x48=registers"],
            "--chip 0x48=registers: a case describes this device; name the case with --case",
        ),
        (
            ["--chip", "itg3200", "--format", "sigrok"],
            "--chip and --case: --format sigrok has no place for the names of registers",
        ),
        (
            ["--case", "none.toml"],
            "none.toml: cannot be read (No such file or directory); give the path of a case file",
        ),
    ],
)
def test_a_wrong_chip_is_one_error_message(periph_sim: Run, options: list[str], message: str):
    assert periph_sim.refused("decode", str(ROUND_SR), *options) == message
