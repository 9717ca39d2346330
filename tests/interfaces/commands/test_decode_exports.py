"""Decoded buses in the formats of other tools, read by those tools: tshark, text2pcap and sigrok-cli."""

from __future__ import annotations

import shutil
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run
from tests.traces.formats.sigrok import sigrok_says
from tests.traces.formats.writers import I2cWave, frame_bits, metadata, sr_file, uart_wave, zip_bytes

TRACES = Path(__file__).resolve().parents[3] / "traces"
needs_tshark = pytest.mark.skipif(
    shutil.which("tshark") is None or shutil.which("text2pcap") is None, reason="tshark and text2pcap are not installed"
)
needs_sigrok = pytest.mark.skipif(shutil.which("sigrok-cli") is None, reason="sigrok-cli is not installed")


@pytest.fixture
def mixed(tmp_path: Path) -> Path:
    """Two messages to the 10-bit address 0x2A5, a general call without ACK, and two serial frames."""
    bus = I2cWave(20, 5, idle=100).play("S F4+ A5+ 11+ Sr F5+ 22- P .100 S 00- P .400")
    frames = [(Fraction(200 + 400 * n), frame_bits(0x41 + n)) for n in range(2)]
    line = uart_wave(frames, Fraction(40), len(bus.samples))
    samples = bytes(a | b << 2 for a, b in zip(bus.samples, line, strict=True))
    return Path(sr_file(tmp_path / "mixed.sr", ["SCL", "SDA", "RX"], "4 MHz", samples))


I2C, UART = ("--i2c", "scl=SCL,sda=SDA"), ("--uart", "rx=RX,baud=100000")


def written(path: Path, style: str, *options: str) -> Path:
    """Write the output of decode in this format to a file beside the capture and return its path."""
    out = path.with_suffix(f".{style}")
    command = [sys.executable, "-m", "periph_sim", "decode", str(path), "--format", style]
    with out.open("wb") as file:
        subprocess.run([*command, *options], stdout=file, check=True)
    return out


def tshark(path: Path, *fields: str) -> list[list[str]]:
    command = ["tshark", "-r", str(path), "-T", "fields", *(word for field in fields for word in ("-e", field))]
    message = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return [line.split("\t") for line in message.splitlines()]


@needs_tshark
def test_tshark_reads_i2c_messages_and_serial_frames_from_pcapng(mixed: Path):
    path = written(mixed, "pcapng", *I2C, *UART)
    shown = tshark(
        path, "frame.time_epoch", "frame.interface_name", "i2c.addr", "i2c.flags", "data.data", "frame.comment"
    )
    assert shown == [
        ["0.000025000", "i2c SCL/SDA", "0x7a", "0x00000010", "f4a511", "S 7A W(10-bit) A 2A5 A 11 A"],
        ["0.000050000", "uart RX", "", "", "4142", "41 42"],
        ["0.000310000", "i2c SCL/SDA", "0x7a", "0x00000011", "f522", "Sr 2A5 R(10-bit) A 22 N P"],
        ["0.000535000", "i2c SCL/SDA", "0x00", "0x00000000", "00", "S 00 W(general call) N P"],
    ]


@needs_tshark
@pytest.mark.parametrize(
    ("options", "link_type", "times", "packets"),
    [
        (I2C, "209", ["0.000025000", "0.000310000", "0.000535000"], ["f4a511", "f522", "00"]),
        (UART, "147", ["0.000050000"], ["4142"]),
    ],
)
def test_text2pcap_makes_packets_of_a_hex_dump(
    mixed: Path, options: tuple[str, ...], link_type: str, times: list[str], packets: list[str]
):
    dump, made = written(mixed, "hexdump", *options), mixed.with_suffix(".made")
    subprocess.run(["text2pcap", "-q", "-l", link_type, "-t", "%s.%f", str(dump), str(made)], check=True)
    assert tshark(made, "frame.time_epoch", "data.data") == [list(pair) for pair in zip(times, packets, strict=True)]


@needs_sigrok
@pytest.mark.parametrize("name", ["imu_round", "nack", "i2c_eeprom_busy"])
def test_sigrok_lines_equal_those_of_sigrok_cli(name: str, tmp_path: Path):
    path = TRACES / f"{name}.sr"
    shutil.copy(path, tmp_path)
    ours = written(tmp_path / path.name, "sigrok", *I2C).read_text().splitlines()
    theirs = sigrok_says(path, "i2c:scl=SCL:sda=SDA").splitlines()

    def beginnings(lines: list[str]) -> set[tuple[str, str]]:
        split = (line.split(" ", 1) for line in lines)
        return {(span.partition("-")[0], message) for span, message in split}

    bits_and_ways = {message for _, message in beginnings(theirs)} & {
        f"i2c-1: {w}" for w in ("0", "1", "Write", "Read")
    }
    ours = [line for line in ours if "Cut" not in line]  # sigrok reports no bits outside of a byte
    assert beginnings(ours) == {one for one in beginnings(theirs) if one[1] not in bits_and_ways} and len(ours) > 10


def test_a_hex_dump_of_two_kinds_of_bus_is_rejected(periph_sim: Run, mixed: Path):
    message = "a hex dump holds one kind of bus; choose with --i2c, --uart or --spi, or write pcapng"
    assert periph_sim.refused("decode", str(mixed), *I2C, *UART, "--format", "hexdump") == message


def test_packets_need_a_sample_rate(periph_sim: Run, tmp_path: Path):
    path = tmp_path / "x.sr"
    unsaid = metadata(["SCL", "SDA"], "").replace(b"samplerate=\n", b"")
    path.write_bytes(zip_bytes({"version": b"2", "metadata": unsaid, "logic-1-1": bytes([3, 1, 3])}))
    assert periph_sim.refused("decode", str(path), "--format", "pcapng").endswith(
        "x.sr states no rate; packets have times, state --rate"
    )
    assert periph_sim("decode", str(path), "--format", "sigrok").out == "1-1 i2c-1: Start\n2-2 i2c-1: Stop\n"
