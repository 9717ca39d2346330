"""`periph-sim decode --json`: transfers and bursts as objects, and the purpose of reserved addresses."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run
from tests.traces.formats.writers import I2cWave, frame_bits, sr_file, uart_wave

NACK = Path(__file__).resolve().parents[3] / "traces" / "nack.sr"


def test_json_has_a_transfer_as_an_object(periph_sim: Run):
    result = periph_sim("decode", str(NACK), "--json")
    objects = [json.loads(line) for line in result.out.splitlines()]
    assert periph_sim("decode", str(NACK), "--transfers", "--format", "json").out == result.out
    assert [found["transfer"] for found in objects] == [
        line.split(maxsplit=1)[1] for line in periph_sim("decode", str(NACK), "--transfers").out.splitlines()[1:]
    ]
    plain = {"address_bits": 7, "reserved": None, "cut": None, "stretches": []}
    assert objects[2] == {
        "time_s": 0.00072,
        "end_s": 0.00111,
        "position": 2880,
        "end": 4440,
        "bus": "i2c SCL/SDA",
        "transfer": "S 53 W A 00 A Sr 53 R A E5 N P",
        "messages": [
            {
                "time_s": 0.00072,
                "position": 2880,
                "address": 0x53,
                "direction": "write",
                "acked": True,
                "bytes": [{"time_s": 0.00082, "position": 3280, "value": 0, "acked": True}],
                **plain,
            },
            {
                "time_s": 0.000915,
                "position": 3660,
                "address": 0x53,
                "direction": "read",
                "acked": True,
                "bytes": [{"time_s": 0.001015, "position": 4060, "value": 0xE5, "acked": False}],
                **plain,
            },
        ],
        "ended": "stop",
    }
    assert objects[0]["messages"][0]["acked"] is False


def test_json_has_a_burst_of_frames_as_an_object(periph_sim: Run, tmp_path: Path):
    """The capture has 0x4B at 100 kbaud with a spike of one sample in its first bit and another before the frame."""
    samples = bytearray(uart_wave([(Fraction(250), frame_bits(0x4B))], Fraction(40), 800))
    for at in (310, 100):
        samples[at] ^= 1
    path = sr_file(tmp_path / "spike.sr", ["RX"], "4 MHz", bytes(samples))
    result = periph_sim("decode", path, "--uart", "rx=RX,baud=100000", "--json")
    assert result.json_object["frames"] == [
        {"time_s": 0.000025, "position": 100, "event": "rejected start", "value": None, "bits": 0, "faults": []},
        {"time_s": 0.0000625, "position": 250, "event": "frame", "value": 0x4A, "bits": 8, "faults": ["glitch"]},
    ]


def wave(folder: Path, steps: str) -> str:
    return I2cWave(20, 5, idle=100).play(f"{steps} .60").saved(folder)


@pytest.mark.parametrize(
    ("steps", "text", "report"),
    [
        ("S 00+ 06+ P", "S 00 W(general call) A 06 A P", [(0, 7, "write", "general call")]),
        (
            "S 01- Sr A6+ P",
            "S 00 R(START byte) N Sr 53 W A P",
            [(0, 7, "read", "START byte"), (0x53, 7, "write", None)],
        ),
        (
            "S 09- Sr A7+ 12- P",
            "S 04 R(Hs-mode controller code) N Sr 53 R A 12 N P",
            [(4, 7, "read", "Hs-mode controller code"), (0x53, 7, "read", None)],
        ),
        (
            "S F8+ A6+ Sr F9+ 11+ 22+ 33- P",
            "S 7C W(device ID) A A6 A Sr 7C R(device ID) A 11 A 22 A 33 N P",
            [(0x7C, 7, "write", "device ID"), (0x7C, 7, "read", "device ID")],
        ),
        (
            "S F4+ A5+ Sr F5+ 12- P",
            "S 7A W(10-bit) A 2A5 A Sr 2A5 R(10-bit) A 12 N P",
            [(0x2A5, 10, "write", "10-bit"), (0x2A5, 10, "read", "10-bit")],
        ),
        (  # a read with other high bits: its lower address byte is unknown
            "S F4+ A5+ Sr F3+ 12- P",
            "S 7A W(10-bit) A 2A5 A Sr 79 R(10-bit) A 12 N P",
            [(0x2A5, 10, "write", "10-bit"), (0x79, 7, "read", "10-bit")],
        ),
    ],
)
def test_reserved_addresses_are_named(
    periph_sim: Run, tmp_path: Path, steps: str, text: str, report: list[tuple[int, int, str, str | None]]
):
    path = wave(tmp_path, steps)
    found = periph_sim("decode", path, "--json").json_object
    assert found["transfer"] == text
    keys = ("address", "address_bits", "direction", "reserved")
    assert [tuple(message[key] for key in keys) for message in found["messages"]] == report
    first = periph_sim("decode", path).out.splitlines()[2].split(maxsplit=3)
    assert first[1] == "address" and first[3] == f"{report[0][2]}, {report[0][3]}"


def test_a_10_bit_address_is_unknown_after_a_stop(periph_sim: Run, tmp_path: Path):
    path = wave(tmp_path, "S F4+ A5+ P S F5+ 12- P")
    result = periph_sim("decode", path, "--transfers").out.splitlines()
    assert [line.split(maxsplit=1)[1] for line in result[1:]] == [
        "S 7A W(10-bit) A 2A5 A P",
        "S 7A R(10-bit) A 12 N P",
    ]


def test_json_has_position_and_duration_of_clock_stretching(periph_sim: Run, tmp_path: Path):
    """SCL is held in the ACK slot of the address, before the second data byte, and before STOP, which is in no byte."""
    path = wave(tmp_path, "S 10100110: ~400 0: 11+ ~400 22+ ~400 P")
    (message,) = periph_sim("decode", path, "--json").json_object["messages"]
    first, second = message["stretches"]
    assert (first["byte"], first["bit"], second["byte"], second["bit"]) == (0, 9, 2, 1)
    for held in (first, second):
        assert (held["low"], held["low_s"]) == (420, 0.000105)
    assert second["position"] + second["low"] == message["bytes"][1]["position"]


def test_json_has_the_bits_of_an_incomplete_byte(periph_sim: Run, tmp_path: Path):
    found = periph_sim("decode", wave(tmp_path, "S A6+ 11:"), "--json").json_object
    assert found["ended"] == "cut off" and found["messages"][0]["cut"] == "11"
    assert found["messages"][0]["acked"] is True and found["messages"][0]["bytes"] == []
