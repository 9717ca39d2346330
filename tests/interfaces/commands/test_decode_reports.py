"""`periph-sim decode`: filters, counts and glitches, against counts of another decoder's annotations."""

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
from tests.interfaces.commands.conftest import Came, Run
from tests.traces.formats.writers import I2cWave, frame_bits, sr_file, uart_wave

TRACES = Path(__file__).resolve().parents[3] / "traces"
NAMES = [name for name in decoded("i2c") if name != TOO_LARGE]


def asked(name: str, *more: str) -> list[str]:
    """The arguments with which `decode` reads a capture as the other decoder did."""
    lines = ",".join(f"{line}={channel(name, called)}" for line, called in options(name, "i2c").items())
    rate = ["--rate", str(RATES[name])] if name in RATES else []
    return ["decode", str(capture_of(name)), "--i2c", lines, *rate, *more]


def transfers(name: str) -> list[list[Said]]:
    """The other decoder's annotations, a list for each START."""
    found: list[list[Said]] = []
    for said in oracle(name, "i2c"):
        if said.text == "Start":
            found.append([])
        if found and said.text not in ("Read", "Write"):
            found[-1].append(said)
    return found


def addresses(transfer: list[Said]) -> list[int]:
    return [int(said.text[-2:], 16) for said in transfer if said.text.startswith("Address")]


def refusals(transfer: list[Said]) -> int:
    pairs = pairwise(transfer)
    return sum(said.text == "NACK" and not before.text.startswith("Data read") for before, said in pairs)


@pytest.mark.parametrize("name", NAMES)
def test_counts_are_those_of_the_other_decoder(periph_sim: Run, name: str):
    found: dict[str, Counter[str]] = {"all": Counter()}
    for transfer in transfers(name):
        own = [f"0x{address:02X}" for address in addresses(transfer)]
        for label in {"all", *own}:
            found.setdefault(label, Counter())["transfers"] += 1
        address = ""
        for before, said in zip([transfer[0], *transfer], transfer, strict=False):
            if said.text.startswith("Address"):
                address = f"0x{said.text[-2:]}"
            for label in ("all", address) if address else ():
                found[label]["bytes"] += said.text.startswith("Data")
                found[label]["read"] += said.text.startswith("Data read")
                found[label]["refused"] += said.text == "NACK" and not before.text.startswith("Data read")
    came = periph_sim(*asked(name, "--counts", "--format", "csv"))
    rows = {row["address"]: row for row in csv.DictReader(came.out.splitlines())}
    assert came.status == 0 and rows.keys() == found.keys()
    for label, counted in found.items():
        for column in ("transfers", "bytes", "read", "refused"):
            assert int(rows[label][column]) == counted[column], (label, column)
    whole = transfers(name)
    if all(transfer[-1].text == "Stop" for transfer in whole) and name not in RATES:
        busy = sum(transfer[-1].at - transfer[0].at for transfer in whole)
        assert rows["all"]["load_percent"] == str(round(100 * busy / load(name).length, 2))


@pytest.mark.parametrize("name", NAMES)
def test_filters_keep_the_transfers_of_the_other_decoder(periph_sim: Run, name: str):
    whole = transfers(name)
    places = {address for transfer in whole for address in addresses(transfer)}
    wanted = {("--nacked",): [t for t in whole if refusals(t)], ("--first", "3"): whole[:3]}
    for address in places:
        of_address = [t for t in whole if address in addresses(t)]
        wanted["--address", hex(address)] = of_address
        wanted["--address", hex(address), "--nacked"] = [t for t in of_address if refusals(t)]
        wanted["--address", hex(address), "--first", "2"] = of_address[:2]
    for filters, kept in wanted.items():
        came = periph_sim(*asked(name, *filters, "--json"))
        lines = [json.loads(line) for line in came.out.splitlines()]
        assert [line["position"] for line in lines] == [transfer[0].at for transfer in kept], filters
        came = periph_sim(*asked(name, *filters, "--format", "sigrok"))
        starts = [int(line.split("-")[0]) for line in came.out.splitlines() if line.endswith(": Start")]
        assert starts == [transfer[0].at for transfer in kept], filters


def test_messages_of_one_transfer_share_its_load(periph_sim: Run, tmp_path: Path):
    """A write to 0x50, then after a repeated START to the 10-bit address 0x2A5, which refuses its second byte."""
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
    came = periph_sim("decode", path, "--uart", "rx=RX,baud=100000", "--counts")
    assert came.out.splitlines()[-2].split() == ["uart", "RX", "all", "2", "3", "1", "15.0"]
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
    assert periph_sim(*line, "--counts", "--json").told["errors"] == 0


def test_without_events_there_are_no_counts(periph_sim: Run, tmp_path: Path):
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


def test_swapped_lines_are_noted(periph_sim: Run):
    came = periph_sim("decode", str(TRACES / "imu_round.sr"), "--i2c", "scl=SDA,sda=SCL", "--counts")
    assert came.status == 0 and came.err == (
        "note: SCL and SDA are swapped: 0 of 98 STARTs on them have a whole address, and 6 of 6 the other way round; "
        "give --i2c scl=SCL,sda=SDA\n"
    )
    assert periph_sim("decode", str(TRACES / "imu_round.sr")).err == ""


# Glitches ------------------------------------------------------------------------


def content(capture: str | Path) -> tuple[list[str], bytearray]:
    """The names and the samples of a sigrok file."""
    archive = zipfile.ZipFile(capture)
    names = [line.split("=")[1] for line in archive.read("metadata").decode().splitlines() if line.startswith("probe")]
    return names, bytearray().join(archive.read(name) for name in archive.namelist() if name.startswith("logic-1"))


def short_pulses(capture: str | Path, limit: int) -> list[tuple[int, str, str, int]]:
    """The runs of equal samples of a sigrok file of one chunk that are shorter than `limit`: counted one by one."""
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
    """Spikes of one to three samples are added to a capture of ours at places drawn by a seed."""
    names, samples = content(TRACES / capture)
    random = np.random.default_rng(7)
    for at in random.integers(10, len(samples) - 10, 25).tolist():
        for place in range(at, at + int(random.integers(1, 4))):
            samples[place] ^= 1 << int(random.integers(len(names)))
    path = sr_file(tmp_path / "spikes.sr", names, "4 MHz", bytes(samples))
    came: Came = periph_sim("decode", path, "--glitches", "--glitch", "3", "--format", "csv")
    rows = list(csv.DictReader(came.out.splitlines()))
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
    came = periph_sim("decode", path, "--glitches", "--format", "csv")
    assert came.err == "note: i2c SCL/SDA: pulses shorter than 100 ns\n"
    assert came.out.splitlines() == [
        "time_s,line,pulse,width_s,other_lines",
        "0.00000100,SDA,low,0.00000004,SCL high",
        "0.00000300,SDA,low,0.00000006,SCL low",
    ]
    first = json.loads(periph_sim("decode", path, "--glitches", "--json").out.splitlines()[0])
    assert (first["time_s"], first["width_s"]) == (1e-6, 4e-8)
    assert periph_sim("decode", path, "--glitches", "--glitch", "50ns", "--format", "csv").out.count("SDA") == 1


def test_a_line_that_is_not_decoded_has_the_limit_of_other_lines(periph_sim: Run, tmp_path: Path):
    path = sr_file(tmp_path / "idle.sr", ["SCL", "SDA", "RX"], "50 MHz", bytes([7] * 50 + [5] * 2 + [7] * 48))
    came = periph_sim("decode", path, "--glitches", "--format", "csv")
    assert (came.status, came.out.splitlines()[1:]) == (0, ["0.00000100,SDA,low,0.00000004,SCL high"])
    assert came.err.endswith("note: uart RX: pulses shorter than 100 ns\n")


def test_a_limit_below_a_sample_is_said(periph_sim: Run):
    came = periph_sim("decode", str(TRACES / "imu_round.sr"), "--glitches")
    assert came.status == 0 and came.err == (
        "note: i2c SCL/SDA: pulses shorter than 250 ns; none can be seen, since no sample is shorter; state --glitch\n"
    )


@needs_captures
def test_glitches_of_a_serial_line_are_shorter_than_half_a_bit(periph_sim: Run):
    path = str(FOLDER / "uart_glitch_0x45.sr")
    came = periph_sim("decode", path, "--uart", "rx=RX,baud=115200", "--glitches", "--format", "csv")
    assert came.out.splitlines()[1:] == ["0.0000060,RX,low,0.0000015,", "0.0000075,RX,high,0.0000005,"]


@pytest.mark.parametrize(
    ("options", "said"),
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
def test_what_does_not_fit_is_one_sentence(periph_sim: Run, options: list[str], said: str):
    assert periph_sim.refused("decode", str(TRACES / "nack.sr"), *options) == said
