"""`periph-sim decode`: filters, counts and glitches, compared with the annotations of another decoder."""

from __future__ import annotations

import csv
import json
import zipfile
from collections import Counter
from fractions import Fraction
from itertools import groupby, pairwise
from pathlib import Path

import numpy as np
import pytest

from tests.captures.test_captures_decode import RATES, TOO_LARGE, channel, load, options
from tests.captures.where import FOLDER, Said, capture_of, decoded, needs_captures, oracle
from tests.interfaces.commands.conftest import CommandResult, Run
from tests.traces.formats.writers import I2cWave, frame_bits, sr_file, uart_wave

TRACES = Path(__file__).resolve().parents[3] / "traces"
NAMES = [name for name in decoded("i2c") if name != TOO_LARGE]


def decode_arguments(name: str, *more: str) -> list[str]:
    """Return the arguments that decode a capture with the settings of the other decoder."""
    lines = ",".join(f"{line}={channel(name, called)}" for line, called in options(name, "i2c").items())
    rate = ["--rate", str(RATES[name])] if name in RATES else []
    return ["decode", str(capture_of(name)), "--i2c", lines, *rate, *more]


def transfers(name: str) -> list[list[Said]]:
    """Return the other decoder's annotations, one list for each START."""
    found: list[list[Said]] = []
    for message in oracle(name, "i2c"):
        if message.text == "Start":
            found.append([])
        if found and message.text not in ("Read", "Write"):
            found[-1].append(message)
    return found


def addresses(transfer: list[Said]) -> list[int]:
    return [int(message.text[-2:], 16) for message in transfer if message.text.startswith("Address")]


def refusals(transfer: list[Said]) -> int:
    pairs = pairwise(transfer)
    return sum(message.text == "NACK" and not before.text.startswith("Data read") for before, message in pairs)


@pytest.mark.parametrize("name", NAMES)
def test_counts_equal_those_of_another_decoder(periph_sim: Run, name: str):
    found: dict[str, Counter[str]] = {"all": Counter()}
    for transfer in transfers(name):
        own = [f"0x{address:02X}" for address in addresses(transfer)]
        for label in {"all", *own}:
            found.setdefault(label, Counter())["transfers"] += 1
        address = ""
        for before, message in zip([transfer[0], *transfer], transfer, strict=False):
            if message.text.startswith("Address"):
                address = f"0x{message.text[-2:]}"
            for label in ("all", address) if address else ():
                found[label]["bytes"] += message.text.startswith("Data")
                found[label]["read"] += message.text.startswith("Data read")
                found[label]["refused"] += message.text == "NACK" and not before.text.startswith("Data read")
    result = periph_sim(*decode_arguments(name, "--counts", "--format", "csv"))
    rows = {row["address"]: row for row in csv.DictReader(result.out.splitlines())}
    assert result.status == 0 and rows.keys() == found.keys()
    for label, counted in found.items():
        for column in ("transfers", "bytes", "read", "refused"):
            assert int(rows[label][column]) == counted[column], (label, column)
    whole = transfers(name)
    if all(transfer[-1].text == "Stop" for transfer in whole) and name not in RATES:
        busy = sum(transfer[-1].at - transfer[0].at for transfer in whole)
        assert rows["all"]["load_percent"] == str(round(100 * busy / load(name).length, 2))


@pytest.mark.parametrize("name", NAMES)
def test_filters_select_the_same_transfers_as_from_another_decoder(periph_sim: Run, name: str):
    whole = transfers(name)
    places = {address for transfer in whole for address in addresses(transfer)}
    wanted = {("--nacked",): [t for t in whole if refusals(t)], ("--first", "3"): whole[:3]}
    for address in places:
        of_address = [t for t in whole if address in addresses(t)]
        wanted["--address", hex(address)] = of_address
        wanted["--address", hex(address), "--nacked"] = [t for t in of_address if refusals(t)]
        wanted["--address", hex(address), "--first", "2"] = of_address[:2]
    for filters, kept in wanted.items():
        result = periph_sim(*decode_arguments(name, *filters, "--json"))
        lines = [json.loads(line) for line in result.out.splitlines()]
        assert [line["position"] for line in lines] == [transfer[0].at for transfer in kept], filters
        result = periph_sim(*decode_arguments(name, *filters, "--format", "sigrok"))
        starts = [int(line.split("-")[0]) for line in result.out.splitlines() if line.endswith(": Start")]
        assert starts == [transfer[0].at for transfer in kept], filters


def test_messages_of_one_transfer_share_its_load(periph_sim: Run, tmp_path: Path):
    """A write to 0x50, then a repeated START to the 10-bit address 0x2A5, whose device sends NACK for the data byte."""
    wave = I2cWave(20, 5, idle=100).play("S A0+ 11+")
    again = len(wave.samples) + 40
    wave.play("Sr F4+ A5+ 22- P")
    stop = len(wave.samples) - 20
    wave.idle(100)
    path = wave.saved(tmp_path)
    rows = csv.DictReader(periph_sim("decode", path, "--counts", "--format", "csv").out.splitlines())
    shares = {row["address"]: (row["transfers"], row["bytes"], row["refused"], row["load_percent"]) for row in rows}
    length = len(wave.samples)
    assert shares == {
        "all": ("1", "2", "1", str(round(100 * (stop - 100) / length, 2))),
        "0x50": ("1", "1", "0", str(round(100 * (again - 100) / length, 2))),
        "0x2A5": ("1", "1", "1", str(round(100 * (stop - again) / length, 2))),
    }
    assert len(periph_sim("decode", path, "--address", "0x2a5", "--transfers").out.splitlines()) == 2


def test_transfers_of_two_buses_that_begin_together_are_two(periph_sim: Run, tmp_path: Path):
    wave = I2cWave(20, 5, idle=100)
    wave.transfer(0xA6, 0x11)
    wave.idle(100)
    samples = bytes(levels | levels << 2 for levels in wave.samples)
    path = sr_file(tmp_path / "two.sr", ["SCL1", "SDA1", "SCL2", "SDA2"], "4 MHz", samples)
    buses = ("--i2c", "scl=0,sda=1", "--i2c", "scl=2,sda=3")
    lines = periph_sim("decode", path, *buses, "--first", "1", "--transfers").out.splitlines()
    assert [line.split()[1:3] for line in lines[1:]] == [["i2c", "SCL1/SDA1"]]


def test_serial_lines_have_frames_and_errors(periph_sim: Run, tmp_path: Path):
    bad = [*frame_bits(0x55)[:-1], 0]
    frames = [(Fraction(100), frame_bits(0x41)), (Fraction(200), bad), (Fraction(1000), frame_bits(0x42))]
    path = sr_file(tmp_path / "line.sr", ["RX"], "1 MHz", uart_wave(frames, Fraction(10), 2000))
    result = periph_sim("decode", path, "--uart", "rx=RX,baud=100000", "--counts")
    assert result.out.splitlines()[-2].split() == ["uart", "RX", "all", "2", "3", "1", "15.0"]
    few = periph_sim("decode", path, "--uart", "rx=RX,baud=100000", "--first", "1", "--transfers")
    assert few.out.splitlines()[1:] == ["0.000100  41 55(frame error)"]
    none = periph_sim("decode", path, "--uart", "rx=RX,baud=100000", "--nacked", "--counts", "--format", "csv")
    assert none.out.splitlines()[1:] == ["uart RX,all,0,0,,,0,0.0"]


def test_an_incomplete_byte_is_an_error_and_a_glitch_is_none(periph_sim: Run, tmp_path: Path):
    path = I2cWave(20, 5, idle=100).play("S 1:").saved(tmp_path)
    cut = csv.DictReader(periph_sim("decode", path, "--counts", "--format", "csv").out.splitlines())
    assert [row["errors"] for row in cut] == ["1"]
    samples = bytearray(uart_wave([(Fraction(100), frame_bits(0x55))], Fraction(10), 300))
    samples[114] ^= 1  # one of the three samples of the first data bit
    path = sr_file(tmp_path / "glitch.sr", ["RX"], "1 MHz", bytes(samples))
    line = ("decode", path, "--uart", "rx=RX,baud=100000,vote")
    assert "glitch" in periph_sim(*line).out
    assert periph_sim(*line, "--counts", "--json").json_object["errors"] == 0


def test_without_events_the_counts_are_0(periph_sim: Run, tmp_path: Path):
    path = sr_file(tmp_path / "idle.sr", ["SCL", "SDA"], "4 MHz", bytes([3]) * 100)
    assert periph_sim("decode", path, "--counts", "--format", "csv").out.splitlines()[1:] == [
        "i2c SCL/SDA,all,0,0,0,0,0,0.0"
    ]
    assert periph_sim("decode", path, "--nacked", "--transfers").out == "    time_s  transfer\n"


def test_a_silent_bus_is_counted_and_a_line_that_is_not_decoded_is_not(periph_sim: Run, tmp_path: Path):
    wave = I2cWave(20, 5, idle=100)
    wave.transfer(0xA6, 0x11)
    samples = bytes(levels | 0b111100 | 0b1000000 * (n % 9 == 8) for n, levels in enumerate(wave.samples))
    path = sr_file(tmp_path / "silent.sr", ["SCL1", "SDA1", "SCL2", "SDA2", "RX", "TX"], "4 MHz", samples)
    lines = periph_sim("decode", path, "--counts", "--format", "csv").out.splitlines()
    assert [line.split(",")[:3] for line in lines[1:3]] == [
        ["i2c SCL1/SDA1", "all", "1"],
        ["i2c SCL1/SDA1", "0x53", "1"],
    ]
    assert lines[3:] == ["i2c SCL2/SDA2,all,0,0,0,0,0,0.0", "uart RX,all,0,0,,,0,0.0", "uart TX,all,0,0,,,0,0.0"]
    path = sr_file(tmp_path / "part.sr", ["SCL1", "SDA1", "SCL"], "4 MHz", samples)
    lines = periph_sim("decode", path, "--counts", "--format", "csv").out.splitlines()
    assert {line.split(",")[0] for line in lines[1:]} == {"i2c SCL1/SDA1"}, "a zero would say that SCL was decoded"


def test_swapped_lines_are_a_note(periph_sim: Run):
    result = periph_sim("decode", str(TRACES / "imu_round.sr"), "--i2c", "scl=SDA,sda=SCL", "--counts")
    assert result.status == 0 and result.err == (
        "note: SCL and SDA are swapped: 0 of 98 STARTs on them have a whole address, and 6 of 6 the other way round; "
        "give --i2c scl=SCL,sda=SDA\n"
    )
    assert periph_sim("decode", str(TRACES / "imu_round.sr")).err == ""


# Glitches ------------------------------------------------------------------------


def content(capture: str | Path) -> tuple[list[str], bytearray]:
    """Return the names and the samples of a sigrok file."""
    archive = zipfile.ZipFile(capture)
    names = [line.split("=")[1] for line in archive.read("metadata").decode().splitlines() if line.startswith("probe")]
    return names, bytearray().join(archive.read(name) for name in archive.namelist() if name.startswith("logic-1"))


def short_pulses(capture: str | Path, limit: int) -> list[tuple[int, str, str, int]]:
    """Count the runs of equal samples shorter than `limit`, sample by sample, in a sigrok file of one chunk."""
    names, samples = content(capture)
    found = []
    for bit, name in enumerate(names):
        at = 0
        runs = [(level, len(list(run))) for level, run in groupby(byte >> bit & 1 for byte in samples)]
        for level, length in runs[:-1]:
            if at and length < limit:
                found.append((at, name, "high" if level else "low", length))
            at += length
    return sorted(found)


@pytest.mark.parametrize("capture", ["imu_round.sr", "nack.sr"])
def test_glitches_are_the_short_runs_of_samples(periph_sim: Run, capture: str, tmp_path: Path):
    """Spikes of one to three samples are added to a recorded capture at seeded random places."""
    names, samples = content(TRACES / capture)
    random = np.random.default_rng(7)
    for at in random.integers(10, len(samples) - 10, 25).tolist():
        for place in range(at, at + int(random.integers(1, 4))):
            samples[place] ^= 1 << int(random.integers(len(names)))
    path = sr_file(tmp_path / "spikes.sr", names, "4 MHz", bytes(samples))
    result: CommandResult = periph_sim("decode", path, "--glitches", "--glitch", "3", "--format", "csv")
    rows = list(csv.DictReader(result.out.splitlines()))
    ours = [(row["time_s"], row["line"], row["pulse"], row["width_s"]) for row in rows]
    expected = [
        (f"{at / 4e6:.8f}", line, pulse, f"{width / 4e6:.8f}") for at, line, pulse, width in short_pulses(path, 3)
    ]
    assert len(expected) > 10 and ours == expected
    levels = {row["line"]: row["other_lines"] for row in rows}
    assert levels.keys() <= set(names) and all(other[-3:] in ("low", "igh") for other in levels.values())


def test_a_glitch_has_the_level_of_the_other_line(periph_sim: Run, tmp_path: Path):
    samples = bytes([3] * 50 + [1] * 2 + [3] * 48 + [2] * 50 + [0] * 3 + [2] * 47)
    path = sr_file(tmp_path / "two.sr", ["SCL", "SDA"], "50 MHz", samples)
    result = periph_sim("decode", path, "--glitches", "--format", "csv")
    assert result.err == "note: i2c SCL/SDA: pulses shorter than 100 ns\n"
    assert result.out.splitlines() == [
        "time_s,line,pulse,width_s,other_lines",
        "0.00000100,SDA,low,0.00000004,SCL high",
        "0.00000300,SDA,low,0.00000006,SCL low",
    ]
    first = json.loads(periph_sim("decode", path, "--glitches", "--json").out.splitlines()[0])
    assert (first["time_s"], first["width_s"]) == (1e-6, 4e-8)
    assert periph_sim("decode", path, "--glitches", "--glitch", "50ns", "--format", "csv").out.count("SDA") == 1


def test_a_line_that_is_not_decoded_has_the_limit_of_other_lines(periph_sim: Run, tmp_path: Path):
    path = sr_file(tmp_path / "idle.sr", ["SCL", "SDA", "RX"], "50 MHz", bytes([7] * 50 + [5] * 2 + [7] * 48))
    result = periph_sim("decode", path, "--glitches", "--format", "csv")
    assert (result.status, result.out.splitlines()[1:]) == (0, ["0.00000100,SDA,low,0.00000004,SCL high"])
    assert result.err.endswith("note: uart RX: pulses shorter than 100 ns\n")


def test_a_limit_shorter_than_a_sample_is_a_note(periph_sim: Run):
    result = periph_sim("decode", str(TRACES / "imu_round.sr"), "--glitches")
    assert result.status == 0 and result.err == (
        "note: i2c SCL/SDA: pulses shorter than 250 ns; none can be seen, since no sample is shorter; state --glitch\n"
    )


@needs_captures
def test_glitches_of_a_serial_line_are_shorter_than_half_a_bit(periph_sim: Run):
    path = str(FOLDER / "uart_glitch_0x45.sr")
    result = periph_sim("decode", path, "--uart", "rx=RX,baud=115200", "--glitches", "--format", "csv")
    assert result.out.splitlines()[1:] == ["0.0000060,RX,low,0.0000015,", "0.0000075,RX,high,0.0000005,"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--counts", "--glitches"],
            "--counts and --glitches print their rows as table, csv or json; leave out --transfers, --chip and --case",
        ),
        (
            ["--counts", "--transfers"],
            "--counts and --glitches print their rows as table, csv or json; leave out --transfers, --chip and --case",
        ),
        (["--glitches", "--nacked"], "--glitches lists pulses of lines; leave out --address, --nacked and --first"),
        *(
            (
                ["--glitches", "--glitch", width],
                "--glitches with --glitch 0: no pulse is shorter; give --glitch a greater width",
            )
            for width in ("0ns", "0")
        ),
        (["--address", "0x400"], "--address: '0x400' is no 10-bit address; expected 0 to 0x3FF, right-aligned"),
    ],
)
def test_a_contradiction_of_options_is_one_error_message(periph_sim: Run, options: list[str], message: str):
    assert periph_sim.refused("decode", str(TRACES / "nack.sr"), *options) == message
